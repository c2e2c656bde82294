/* SPDX-License-Identifier: Apache-2.0 */
/* Curves in the unit square as an SVG: axes with ticks at tenths, and a legend to the right. */
#include <stdio.h>

#include "mesh/formats/io.h"
#include "starguard/picture.h"

static const char STAGE[] = "chart";

enum { SIDE = 480, LEFT = 64, TOP = 24, BELOW = 56, LEGEND = 200, LEGEND_STEP = 18 };

/* Names come from files: escapes characters that are special in XML. */
static void write_text(FILE *stream, const char *text) {
    for (; *text != '\0'; text++) {
        if (*text == '&')
            fputs("&amp;", stream);
        else if (*text == '<')
            fputs("&lt;", stream);
        else
            fputc((unsigned char)*text < ' ' ? ' ' : *text, stream);
    }
}

static double across(double x) {
    return LEFT + SIDE * x;
}

static double down(double y) {
    return TOP + SIDE * (1 - y);
}

static void write_axes(FILE *stream, const char *x_label, const char *y_label) {
    fprintf(stream,
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" "
            "stroke=\"#888\"/>\n",
            LEFT, TOP, SIDE, SIDE);
    for (int i = 0; i <= 10; i += 2) {
        double value = i / 10.0;
        fprintf(stream, "<line x1=\"%d\" y1=\"%g\" x2=\"%d\" y2=\"%g\" stroke=\"#ddd\"/>\n", LEFT,
                down(value), LEFT + SIDE, down(value));
        fprintf(stream, "<text x=\"%d\" y=\"%g\" text-anchor=\"end\">%.1f</text>\n", LEFT - 8,
                down(value) + 4, value);
        fprintf(stream, "<text x=\"%g\" y=\"%d\" text-anchor=\"middle\">%.1f</text>\n",
                across(value), TOP + SIDE + 18, value);
    }
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", LEFT + SIDE / 2,
            TOP + SIDE + 42);
    write_text(stream, x_label);
    fprintf(stream,
            "</text>\n<text transform=\"translate(18 %d) rotate(-90)\" "
            "text-anchor=\"middle\">",
            TOP + SIDE / 2);
    write_text(stream, y_label);
    fputs("</text>\n", stream);
}

static void write_style(FILE *stream, const starg_curve *curve, size_t index) {
    uint8_t rgb[3] = {0, 0, 0};
    if (!curve->strong)
        starg_distinct_color(index, rgb);
    fprintf(stream, " fill=\"none\" stroke=\"#%02X%02X%02X\" stroke-width=\"%g\"/>\n", rgb[0],
            rgb[1], rgb[2], curve->strong ? 3.0 : 1.2);
}

static void write_curve(FILE *stream, const starg_curve *curve, size_t index) {
    fputs("<polyline points=\"", stream);
    for (size_t i = 0; i < curve->count; i++)
        fprintf(stream, "%s%.3f,%.3f", i > 0 ? " " : "", across(curve->x[i]), down(curve->y[i]));
    fputs("\"", stream);
    write_style(stream, curve, index);
}

static void write_legend(FILE *stream, const starg_curve *curve, size_t index) {
    size_t y = TOP + 8 + LEGEND_STEP * index;
    fprintf(stream, "<polyline points=\"%d,%zu %d,%zu\"", LEFT + SIDE + 16, y, LEFT + SIDE + 40, y);
    write_style(stream, curve, index);
    fprintf(stream, "<text x=\"%d\" y=\"%zu\">", LEFT + SIDE + 48, y + 4);
    write_text(stream, curve->name);
    fputs("</text>\n", stream);
}

starg_status starg_chart_write(starg_context *context, const starg_curve *curves, size_t count,
                               const char *x_label, const char *y_label, const char *path) {
    starg_output output;
    size_t height = TOP + SIDE + BELOW, needed = TOP + 16 + LEGEND_STEP * count;
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_c_locale_enter(context, &locale));
    TRY(starg_output_open(context, STAGE, path, &output));
    FILE *stream = output.stream;
    fprintf(stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%zu\" "
            "font-family=\"sans-serif\" font-size=\"13\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            LEFT + SIDE + LEGEND, height > needed ? height : needed);
    write_axes(stream, x_label, y_label);
    for (int strong = 0; strong < 2; strong++)
        for (size_t i = 0; i < count; i++)
            if (curves[i].strong == (strong == 1))
                write_curve(stream, &curves[i], i);
    for (size_t i = 0; i < count; i++)
        write_legend(stream, &curves[i], i);
    fputs("</svg>\n", stream);
    return starg_output_commit(&output);
}
