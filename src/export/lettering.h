/* SPDX-License-Identifier: Apache-2.0 */
/* Text in pictures, drawn with strokes of its own. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct starg_canvas {
    uint8_t *rgb; /* height rows of width x 3 bytes */
    size_t width, height;
} starg_canvas;

typedef struct starg_lettering {
    double height; /* of capitals, in pixels */
    bool rising;   /* from the bottom to the top instead of from left to right */
    uint8_t ink[3];
    double halo; /* width of a white rim in pixels, or 0 */
} starg_lettering;

/* Length of a text in pixels. Bytes of UTF-8 beyond ASCII make one box per character. */
double starg_lettering_length(const starg_lettering *style, const char *text);

/* Draws a text whose first character begins at (x, y), the middle of its capitals' height at the
 * start. What is outside of the canvas is left out. */
void starg_lettering_draw(const starg_canvas *canvas, const starg_lettering *style,
                          const char *text, double x, double y);
