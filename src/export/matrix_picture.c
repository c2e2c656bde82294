/* SPDX-License-Identifier: Apache-2.0 */
/* A distance matrix as a picture: grey by rank, a square of pixels per entry. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "export/png.h"
#include "starguard/picture.h"

static const char STAGE[] = "picture";

enum { MOST_ROWS = 8192, WIDTH = 1200, LARGEST_CELL = 24 };

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Number of smaller entries in the sorted list. */
static size_t count_smaller(const double *sorted, size_t count, double value) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (sorted[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* 0 for the smallest entries, 255 for the largest. */
static uint8_t grey(const double *sorted, size_t count, double value) {
    size_t most = count_smaller(sorted, count, sorted[count - 1]);
    size_t smaller = count_smaller(sorted, count, value);
    return most > 0 ? (uint8_t)(255 * smaller / most) : 0;
}

static void fill_cell(uint8_t *rgb, size_t width, size_t left, size_t top, size_t side,
                      uint8_t level) {
    for (size_t y = top; y < top + side; y++)
        memset(rgb + 3 * (y * width + left), level, 3 * side);
}

starg_status starg_matrix_picture_write(starg_context *context, const double *values, size_t rows,
                                        const char *path) {
    starg_status status = STARG_OK;
    double *sorted = NULL;
    uint8_t *rgb = NULL;
    size_t entries = rows * rows;
    if (rows == 0 || rows > MOST_ROWS)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a matrix of %zu rows cannot be drawn; it needs 1 to %d", rows,
                          MOST_ROWS);
    for (size_t i = 0; i < entries; i++)
        if (isnan(values[i]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "row %zu, column %zu is not a number", i / rows, i % rows);
    size_t cell = WIDTH / rows < LARGEST_CELL ? WIDTH / rows : LARGEST_CELL;
    cell = cell > 0 ? cell : 1;
    size_t width = rows * cell;
    STARG_NEW(context, STAGE, sorted, entries);
    STARG_NEW(context, STAGE, rgb, 3 * width * width);
    memcpy(sorted, values, entries * sizeof *sorted);
    qsort(sorted, entries, sizeof *sorted, by_value);
    for (size_t i = 0; i < entries; i++) {
        if (i % rows == 0)
            STARG_TRY(starg_check_cancel(context, STAGE));
        fill_cell(rgb, width, i % rows * cell, i / rows * cell, cell,
                  grey(sorted, entries, values[i]));
    }
    STARG_TRY(starg_png_write(context, path, rgb, width, width));
done:
    starg_release(context, sorted);
    starg_release(context, rgb);
    return status;
}
