/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of meshes and points, drawn by a small software renderer. */
#ifndef STARGUARD_PICTURE_H
#define STARGUARD_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "guard.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_picture_options {
    size_t width, height;       /* pixels, 16 to 8192 each                                    */
    double azimuth, elevation;  /* degrees; direction of the camera from the centre */
    int up;                     /* axis that points up: 0, 1 or 2                             */
    double opacity;             /* of the surface, 0 to 1 */
    const uint8_t *face_colors; /* face_count x 3 RGB, or NULL for a neutral grey             */
    const double *points;       /* point_count x 3; drawn as shaded balls                     */
    size_t point_count;
    const uint8_t *point_colors;  /* point_count x 3, or NULL for distinct colours             */
    double point_radius;          /* as a fraction of the bounding box's diagonal              */
    bool point_numbers;           /* numbers beside points, where none covers a nearer one     */
    const starg_guards *views;    /* outlines of where these look, if they look one way      */
    const char *const *row_names; /* written into the rows of a sheet, or NULL */
} starg_picture_options;

/* 1200 x 900, azimuth 35, elevation 20, up axis 1 (y), opacity 0.35, radius 0.012. */
STARG_API void starg_picture_options_default(starg_picture_options *options);

/* Draws `mesh` in an orthographic view that fits it, and writes a PNG with a white background.
 * `options` may be NULL. The same input gives the same bytes.
 * Errors: ARGUMENT, WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_picture_write(starg_context *context, const starg_mesh *mesh,
                                           const starg_picture_options *options, const char *path);

/* The same in memory; free with starg_picture_bytes_free. Errors: ARGUMENT, MEMORY, CANCELLED. */
STARG_API starg_status starg_picture_encode(starg_context *context, const starg_mesh *mesh,
                                            const starg_picture_options *options, uint8_t **png,
                                            size_t *size);
STARG_API void starg_picture_bytes_free(starg_context *context, uint8_t *png);

/* Draws rows x columns meshes, row by row, into one PNG of at most 16384 pixels per side. Errors:
 * ARGUMENT, WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_picture_sheet_write(starg_context *context,
                                                 const starg_mesh *const *meshes, size_t rows,
                                                 size_t columns,
                                                 const starg_picture_options *options,
                                                 const char *path);

/* The i-th of a sequence of distinct colours, used for guards and pieces. */
STARG_API void starg_distinct_color(size_t index, uint8_t rgb[3]);

/* Draws a square distance matrix as a PNG, one cell per entry: the smallest is black, the largest
 * white, and greys follow the rank, so that the contrast does not depend on the distribution.
 * `names` (one per row, or NULL) stand beside the rows and columns of up to 120 rows.
 * Errors: ARGUMENT (over 8192 rows, an entry that is not a number), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_matrix_picture_write(starg_context *context, const double *values,
                                                  size_t rows, const char *const *names,
                                                  const char *path);

/* One curve of a chart: points in the unit square, x ascending. */
typedef struct starg_curve {
    const char *name; /* for the legend */
    const double *x, *y;
    size_t count;
    bool strong; /* drawn thick and black, on top */
} starg_curve;

/* Draws curves over axes from 0 to 1 as an SVG. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_chart_write(starg_context *context, const starg_curve *curves,
                                         size_t count, const char *x_label, const char *y_label,
                                         const char *path);

#ifdef __cplusplus
}
#endif

#endif
