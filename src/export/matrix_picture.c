/* SPDX-License-Identifier: Apache-2.0 */
/* A distance matrix as a picture: grey by rank, a square of pixels per entry, names at the left and
 * above. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "export/export.h"
#include "starguard/picture.h"

static const char STAGE[] = "picture";

/* Sides in pixels. Names stand beside cells of at least NAMED_CELL, and of longer ones the middle
 * is left out. */
enum { MOST_ROWS = 8192, WIDTH = 1200, LARGEST_CELL = 24, NAMED_CELL = 10, GAP = 6, LONGEST = 40 };

typedef struct layout {
    size_t cell, frame, width; /* of a cell, of the names' room, of the picture */
    starg_lettering style;
} layout;

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

/* ---- names ---- */

static void shorten(const char *name, char shown[LONGEST + 1]) {
    size_t length = strlen(name), half = (LONGEST - 3) / 2;
    if (length <= LONGEST)
        snprintf(shown, LONGEST + 1, "%s", name);
    else
        snprintf(shown, LONGEST + 1, "%.*s...%s", (int)half, name, name + length - half);
}

static layout plan(const char *const *names, size_t rows) {
    size_t cell = WIDTH / rows < LARGEST_CELL ? WIDTH / rows : LARGEST_CELL;
    layout l = {.cell = cell > 0 ? cell : 1, .style = {.ink = {50, 50, 50}}};
    l.style.height = fmin(9, 0.6 * (double)cell);
    for (size_t i = 0; names != NULL && l.cell >= NAMED_CELL && i < rows; i++) {
        char shown[LONGEST + 1];
        shorten(names[i], shown);
        size_t room = (size_t)ceil(starg_lettering_length(&l.style, shown)) + 2 * GAP;
        l.frame = l.frame < room ? room : l.frame;
    }
    l.width = l.frame + rows * l.cell;
    return l;
}

static void draw_names(const layout *l, const char *const *names, size_t rows, uint8_t *rgb) {
    const starg_canvas canvas = {.rgb = rgb, .width = l->width, .height = l->width};
    for (size_t i = 0; i < rows; i++) {
        char shown[LONGEST + 1];
        starg_lettering style = l->style;
        double edge = (double)(l->frame - GAP);
        double middle = (double)l->frame + ((double)i + 0.5) * (double)l->cell;
        shorten(names[i], shown);
        starg_lettering_draw(&canvas, &style, shown, edge - starg_lettering_length(&style, shown),
                             middle);
        style.rising = true;
        starg_lettering_draw(&canvas, &style, shown, middle, edge);
    }
}

/* ---- public function ---- */

starg_status starg_matrix_picture_write(starg_context *context, const double *values, size_t rows,
                                        const char *const *names, const char *path) {
    SCOPED double *sorted = NULL;
    SCOPED uint8_t *rgb = NULL;
    size_t entries = rows * rows;
    if (rows == 0 || rows > MOST_ROWS)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a matrix of %zu rows cannot be drawn; it needs 1 to %d", rows,
                          MOST_ROWS);
    for (size_t i = 0; i < entries; i++)
        if (isnan(values[i]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "row %zu, column %zu is not a number", i / rows, i % rows);
    const layout l = plan(names, rows);
    NEW(context, STAGE, sorted, entries);
    NEW(context, STAGE, rgb, 3 * l.width * l.width);
    memcpy(sorted, values, entries * sizeof *sorted);
    qsort(sorted, entries, sizeof *sorted, by_value);
    memset(rgb, 255, 3 * l.width * l.width);
    for (size_t i = 0; i < entries; i++) {
        if (i % rows == 0)
            TRY(starg_check_cancel(context, STAGE));
        fill_cell(rgb, l.width, l.frame + i % rows * l.cell, l.frame + i / rows * l.cell, l.cell,
                  grey(sorted, entries, values[i]));
    }
    if (l.frame > 0)
        draw_names(&l, names, rows, rgb);
    return starg_png_write(context, path, rgb, l.width, l.width);
}
