/* SPDX-License-Identifier: Apache-2.0 */
/* Turns a projected scene into pixels. */
#pragma once

#include "core/context.h"

/* Samples per pixel and axis. */
enum { STARG_RASTER_SAMPLES = 3 };

typedef struct starg_raster_ball {
    double center[3];
    uint8_t rgb[3];
} starg_raster_ball;

/* Positions are in samples: x to the right, y down from the upper left corner, z towards the
 * viewer. Directions have y up, so that (x, y, z) is a right-handed frame. */
typedef struct starg_raster_scene {
    size_t width, height; /* pixels */
    const double *positions;
    const uint32_t *faces;
    size_t face_count;
    const float *normals;       /* face_count x 3 corners x 3 */
    const uint8_t *face_colors; /* face_count x 3, or NULL for the neutral colour */
    double opacity;
    const uint32_t *lines; /* line_count x 2 indices into positions */
    size_t line_count;
    double line_radius;
    const starg_raster_ball *balls;
    size_t ball_count;
    double ball_radius;
} starg_raster_scene;

/* Draws into height x width x 3 bytes. Errors: MEMORY, CANCELLED. */
starg_status starg_raster_draw(starg_context *context, const starg_raster_scene *scene,
                               uint8_t *rgb);
