/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of tables and curves: reads back what they show. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "core/rng.h"
#include "export/export.h"
#include "starguard/picture.h"
#include "support.h"

static char folder[64];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/test_chart_XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder); /* fails if a test has left anything */
}

static uint8_t *read_file(const char *name, size_t *size) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    uint8_t *bytes = calloc(1 << 20, 1);
    assert_non_null(bytes);
    *size = fread(bytes, 1, (1 << 20) - 1, file);
    fclose(file);
    unlink(path);
    return bytes;
}

static size_t big_endian(const uint8_t *bytes) {
    return (size_t)bytes[0] << 24 | (size_t)bytes[1] << 16 | (size_t)bytes[2] << 8 | bytes[3];
}

static int paeth(int left, int above, int corner) {
    int estimate = left + above - corner;
    int a = abs(estimate - left), b = abs(estimate - above), c = abs(estimate - corner);
    return a <= b && a <= c ? left : b <= c ? above : corner;
}

/* The grey levels of a PNG that has one IDAT chunk after its header and only Paeth rows. */
static uint8_t *decode(const uint8_t *png, size_t side) {
    size_t stride = 3 * side + 1;
    uLongf size = stride * side;
    uint8_t *rows = malloc(size), *grey = malloc(side * side);
    assert_true(rows != NULL && grey != NULL);
    assert_int_equal(big_endian(png + 16), side);
    assert_int_equal(big_endian(png + 20), side);
    const uint8_t *data = png + 33;
    assert_memory_equal(data + 4, "IDAT", 4);
    assert_int_equal(uncompress(rows, &size, data + 8, big_endian(data)), Z_OK);
    assert_int_equal(size, stride * side);
    for (size_t y = 0; y < side; y++) {
        uint8_t *row = rows + y * stride;
        assert_int_equal(row[0], 4);
        for (size_t i = 1; i < stride; i++) {
            int left = i > 3 ? row[i - 3] : 0, above = y > 0 ? row[i - stride] : 0;
            int corner = i > 3 && y > 0 ? row[i - stride - 3] : 0;
            row[i] = (uint8_t)(row[i] + paeth(left, above, corner));
        }
        for (size_t x = 0; x < side; x++) {
            assert_true(row[3 * x + 1] == row[3 * x + 2] && row[3 * x + 2] == row[3 * x + 3]);
            grey[y * side + x] = row[3 * x + 1];
        }
    }
    free(rows);
    return grey;
}

/* Greys are in the order of the values; the least is black, the largest white. */
static void matrix_shows_ranks(void **state) {
    (void)state;
    enum { ROWS = 20, CELL = 24, SIDE = ROWS * CELL };
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(4, 0, 0);
    double values[ROWS * ROWS];
    char path[256];
    size_t size;
    for (size_t i = 0; i < ROWS * ROWS; i++)
        values[i] = i / ROWS == i % ROWS ? 0 : exp(20 * starg_rng_unit(&rng));
    snprintf(path, sizeof path, "%s/m.png", folder);
    test_ok(context, starg_matrix_picture_write(context, values, ROWS, NULL, path));
    uint8_t *png = read_file("m.png", &size), *grey = decode(png, SIDE);
    uint8_t darkest = 255, lightest = 0;
    for (size_t i = 0; i < ROWS * ROWS; i++) {
        uint8_t here = grey[(i / ROWS * CELL + CELL / 2) * SIDE + i % ROWS * CELL + CELL / 2];
        assert_true(here == grey[i / ROWS * CELL * SIDE + i % ROWS * CELL]);
        darkest = here < darkest ? here : darkest;
        lightest = here > lightest ? here : lightest;
        for (size_t k = 0; k < i; k++) {
            uint8_t there = grey[k / ROWS * CELL * SIDE + k % ROWS * CELL];
            assert_true(values[i] < values[k] ? here <= there : here >= there);
        }
    }
    assert_int_equal(darkest, 0);
    assert_int_equal(lightest, 255);
    free(grey);
    free(png);
    test_context_free(context);
}

/* The ink of a text on a white square, in which it begins at the left of the middle or, rising, at
 * the bottom of it. */
enum { INK_SIDE = 61 };
static void write_ink(const char *text, bool rising, uint8_t ink[INK_SIDE * INK_SIDE]) {
    static uint8_t rgb[INK_SIDE * INK_SIDE * 3];
    const starg_canvas canvas = {.rgb = rgb, .width = INK_SIDE, .height = INK_SIDE};
    const starg_lettering style = {.height = 12, .rising = rising};
    memset(rgb, 255, sizeof rgb);
    starg_lettering_draw(&canvas, &style, text, rising ? 30.5 : 5, rising ? 56 : 30.5);
    for (size_t i = 0; i < (size_t)INK_SIDE * INK_SIDE; i++)
        ink[i] = (uint8_t)(255 - rgb[3 * i]);
}

/* No two characters look alike, none leaves its place, and a rising one is turned by a right angle.
 */
static void letters_differ_and_turn(void **state) {
    (void)state;
    enum { FIRST = '!', LAST = '~' };
    static uint8_t all[LAST - FIRST + 1][INK_SIDE * INK_SIDE], turned[INK_SIDE * INK_SIDE];
    const starg_lettering style = {.height = 12};
    for (int c = FIRST; c <= LAST; c++) {
        const char text[2] = {(char)c, '\0'};
        uint8_t *ink = all[c - FIRST];
        size_t right = 5 + (size_t)starg_lettering_length(&style, text), count = 0;
        write_ink(text, false, ink);
        write_ink(text, true, turned);
        for (size_t i = 0; i < (size_t)INK_SIDE * INK_SIDE; i++) {
            size_t x = i % INK_SIDE, y = i / INK_SIDE;
            count += ink[i] > 127;
            assert_true(ink[i] == 0 || (x >= 3 && x <= right && y >= 22 && y <= 43));
            assert_true(abs(ink[i] - turned[(INK_SIDE - 1 - x) * INK_SIDE + y]) <= 1);
        }
        assert_true(count > 0);
        for (int d = FIRST; d < c; d++) {
            size_t unlike = 0;
            for (size_t i = 0; i < (size_t)INK_SIDE * INK_SIDE; i++)
                unlike += abs(ink[i] - all[d - FIRST][i]) > 127;
            assert_true(unlike > 1);
        }
    }
}

/* A text may leave its canvas on every side; characters outside of ASCII are boxes, one each. */
static void letters_may_leave_the_canvas(void **state) {
    (void)state;
    uint8_t *rgb = malloc(3 * 9 * 7); /* a sanitizer watches its ends */
    assert_non_null(rgb);
    memset(rgb, 255, 3 * 9 * 7);
    const starg_canvas canvas = {.rgb = rgb, .width = 9, .height = 7};
    for (int rising = 0; rising < 2; rising++) {
        const starg_lettering style = {.height = 12, .rising = rising, .halo = 3};
        for (double x = -40; x < 40; x += 7)
            for (double y = -40; y < 40; y += 7)
                starg_lettering_draw(&canvas, &style, "W_\xc3\xa4 9", x, y);
        assert_true(starg_lettering_length(&style, "\xc3\xa4") ==
                    starg_lettering_length(&style, "a"));
    }
    free(rgb);
}

/* With names the cells move to the lower right, and each row and column has a name, of which a long
 * one is shortened. */
static void matrix_has_names(void **state) {
    (void)state;
    enum { ROWS = 3, CELL = 24 };
    static const char *const names[ROWS] = {
        "cat.off", "a-name-of-a-model-that-is-by-far-longer-than-is-good-for-a-picture.off", "i"};
    starg_context *context = test_context(1);
    const double values[ROWS * ROWS] = {0, 1, 2, 1, 0, 3, 2, 3, 0};
    char path[256];
    size_t size, dark[2 * ROWS] = {0};
    snprintf(path, sizeof path, "%s/n.png", folder);
    test_ok(context, starg_matrix_picture_write(context, values, ROWS, names, path));
    uint8_t *png = read_file("n.png", &size);
    size_t side = big_endian(png + 16), frame = side - (size_t)ROWS * CELL;
    uint8_t *grey = decode(png, side);
    assert_true(frame > 150 && frame < 350); /* forty characters */
    for (size_t i = 0; i < ROWS * ROWS; i++) {
        size_t y = frame + i / ROWS * CELL, x = frame + i % ROWS * CELL;
        assert_int_equal(grey[y * side + x], grey[(y + CELL - 1) * side + x + CELL - 1]);
        assert_true((grey[y * side + x] == 0) == (i / ROWS == i % ROWS));
    }
    for (size_t i = 0; i < frame; i++)
        for (size_t k = 0; k < (size_t)ROWS * CELL; k++) {
            dark[k / CELL] += grey[(frame + k) * side + i] < 128;
            dark[ROWS + k / CELL] += grey[i * side + frame + k] < 128;
        }
    for (int k = 0; k < 2; k++) {
        const size_t *d = dark + (ptrdiff_t)k * ROWS;
        assert_true(d[1] > 3 * d[0] && d[0] > 3 * d[2] && d[2] > 0);
    }
    free(grey);
    free(png);
    test_context_free(context);
}

static void matrix_refuses(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double bad[4] = {0, 1, NAN, 0}, same[4] = {5, 5, 5, 5};
    char path[256];
    size_t size;
    snprintf(path, sizeof path, "%s/r.png", folder);
    assert_int_equal(starg_matrix_picture_write(context, bad, 2, NULL, path), STARG_ERROR_ARGUMENT);
    assert_int_equal(starg_matrix_picture_write(context, bad, 0, NULL, path), STARG_ERROR_ARGUMENT);
    assert_int_equal(starg_matrix_picture_write(context, bad, 8193, NULL, path),
                     STARG_ERROR_ARGUMENT);
    assert_int_equal(access(path, F_OK), -1);
    test_ok(context, starg_matrix_picture_write(context, same, 2, NULL, path));
    free(read_file("r.png", &size));
    assert_int_equal(starg_matrix_picture_write(context, same, 2, NULL, "/nowhere/r.png"),
                     STARG_ERROR_WRITE);
    test_context_free(context);
}

static size_t count_of(const char *text, const char *word) {
    size_t count = 0;
    for (; (text = strstr(text, word)) != NULL; text++)
        count++;
    return count;
}

static void chart_has_its_curves(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double x[3] = {0, 0.5, 1}, y[3] = {1, 0.25, 0};
    const starg_curve curves[2] = {{"mean", x, y, 3, true}, {"<a&b>", x, x, 3, false}};
    char path[256];
    size_t size;
    snprintf(path, sizeof path, "%s/c.svg", folder);
    test_ok(context, starg_chart_write(context, curves, 2, "recall", "precision", path));
    char *svg = (char *)read_file("c.svg", &size);
    /* the corners of the axes are (64, 504) and (544, 24) */
    assert_non_null(strstr(svg, "\"64.000,24.000 304.000,384.000 544.000,504.000\""));
    assert_non_null(strstr(svg, "\"64.000,504.000 304.000,264.000 544.000,24.000\""));
    assert_non_null(strstr(svg, ">recall<"));
    assert_non_null(strstr(svg, ">precision<"));
    assert_non_null(strstr(svg, ">&lt;a&amp;b><"));
    assert_int_equal(count_of(svg, "<text"), count_of(svg, "</text>"));
    assert_int_equal(count_of(svg, "#000000"), 2);
    free(svg);
    assert_int_equal(starg_chart_write(context, curves, 2, "x", "y", "/nowhere/c.svg"),
                     STARG_ERROR_WRITE);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matrix_shows_ranks),      cmocka_unit_test(matrix_has_names),
        cmocka_unit_test(letters_differ_and_turn), cmocka_unit_test(letters_may_leave_the_canvas),
        cmocka_unit_test(matrix_refuses),          cmocka_unit_test(chart_has_its_curves)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
