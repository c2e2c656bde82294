/* SPDX-License-Identifier: Apache-2.0 */
/* Which vertices and faces of a solid does a point see? [YL11, section 3.1]
 *
 * A vertex q is visible from p when the segment p q meets the boundary in q alone. A face is
 * visible when its three vertices are and p lies strictly on its inner side; under the stricter
 * rule "whole" every point of it must be visible. A point that is not strictly inside the solid
 * sees nothing. All of it is decided exactly: every engine gives the same bits. */
#ifndef STARGUARD_VISIBILITY_H
#define STARGUARD_VISIBILITY_H

#include <stddef.h>

#include "bits.h"
#include "context.h"
#include "fields.h"
#include "solid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_visibility_engine {
    STARG_VISIBILITY_GRID = 0,     /* a grid over the directions from the point          */
    STARG_VISIBILITY_BVH = 1,      /* each segment against a bounding volume hierarchy   */
    STARG_VISIBILITY_SWEEP = 2,    /* the paper's sweep by angle                         */
    STARG_VISIBILITY_CONTOURS = 3, /* layers counted across contours; else by the grid   */
    STARG_VISIBILITY_FASTEST = 4   /* contours or the grid, whichever suits the point    */
} starg_visibility_engine;

typedef enum starg_target { STARG_TARGET_FACES = 0, STARG_TARGET_VERTICES = 1 } starg_target;

typedef enum starg_face_rule {
    STARG_FACES_VERTICES = 0, /* the three vertices are visible                      */
    STARG_FACES_WHOLE = 1     /* every point of the face is visible                  */
} starg_face_rule;

typedef struct starg_visibility_options {
    starg_visibility_engine engine;
    starg_target target;       /* what a column of the result stands for            */
    starg_face_rule face_rule; /* for STARG_TARGET_FACES                            */
    double range;              /* vertices (all three of a face) at most this far; INFINITY: any */
    double cone;               /* full opening angle of the view in degrees, above 0; 360: all
                                  around. A vertex is within it when the angle to its direction,
                                  whose cosine is held against that of half the opening, is small
                                  enough. With STARG_FACES_WHOLE at most 180, or 360            */
    const double *directions;  /* with a cone below 360: count x 3, where each point looks, of any
                                  length but 0; not kept                                        */
} starg_visibility_options;

/* The fastest engine, faces, by vertices, any distance, all around. */
STARG_API void starg_visibility_options_default(starg_visibility_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_visibility_options_fields(void);

/* The cosine of half an opening angle in degrees: the number that decides. */
STARG_API double starg_cone_cosine(double degrees);

/* Computes what each of `count` points (count x 3 doubles) sees: a matrix of count rows with one
 * column per face (or vertex). `options` may be NULL. Parallel over the points.
 * Errors: ARGUMENT (range negative or NaN, a cone that is no angle, a point or
 * direction that is not finite), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_visibility(starg_context *context, const starg_solid *solid,
                                        const double *points, size_t count,
                                        const starg_visibility_options *options, starg_bits **out);

/* Computes what is potentially visible from each of `count` boxes (count x 6 doubles, the lower
 * corner before the upper one): a matrix of count rows with one column per face (or vertex), where
 * a 0 says for certain that no point of the closed box that is strictly inside the solid sees it. A
 * 1 says nothing for certain: the smaller the box, the fewer are too many. Of the options only
 * `target` and `range` are asked; what sees a face by either rule is in the row; the cone must be
 * 360. `options` may be NULL. Parallel over the boxes.
 * Errors: ARGUMENT (range negative or NaN, a cone, a box with corners that are not finite or in the
 * wrong order), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_visibility_region(starg_context *context, const starg_solid *solid,
                                               const double *boxes, size_t count,
                                               const starg_visibility_options *options,
                                               starg_bits **out);

#ifdef __cplusplus
}
#endif

#endif
