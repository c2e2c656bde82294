/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of points and segments of one plane, exact. */
#ifndef STARG_MESH_UNION_TRIANGULATION_H
#define STARG_MESH_UNION_TRIANGULATION_H

#include "geometry/exact_points.h"

#define TRIANGULATION_NONE UINT32_MAX

/* The line of a segment: through two vertices, or where the plane meets that of a face. */
typedef struct triangulation_carrier {
    const double *corner[3]; /* the third is NULL for a line */
} triangulation_carrier;

/* Halfedge 3 t + k runs from corner k of triangle t to the next one. */
typedef struct triangulation {
    starg_context *context;
    exact_points *points;
    const double *plane[3]; /* a face in the plane                                        */
    int u, v;               /* the coordinates of the projection, in which that face turns left */
    STARG_ARRAY(uint32_t) corner;  /* point per halfedge                                  */
    STARG_ARRAY(uint32_t) twin;    /* per halfedge; NONE on the border                    */
    STARG_ARRAY(uint32_t) carrier; /* per halfedge: of the segment on it, or NONE         */
    STARG_ARRAY(triangulation_carrier) carriers;
    STARG_ARRAY(uint32_t) at;   /* per point: a halfedge that starts there, or NONE       */
    STARG_ARRAY(uint32_t) used; /* the points that have one                               */
    STARG_ARRAY(uint64_t) crossed;
    uint32_t last; /* where the next walk starts */
} triangulation;

/* Once for many triangulations: memory for all. */
static inline triangulation triangulation_make(exact_points *points) {
    return (triangulation){.context = points->context, .points = points};
}
void triangulation_free(triangulation *t);

/* Starts anew: a plane, given by a face in it, and three points that enclose all others in its
 * projection, counter-clockwise. Errors of this and the following: MEMORY. */
starg_status triangulation_begin(triangulation *t, const double *const plane[3], int u, int v,
                                 const uint32_t enclosing[3]);
/* Makes a point a vertex. */
starg_status triangulation_insert(triangulation *t, uint32_t point);
/* Makes a segment, which lies on its carrier, a chain of edges. Its ends are vertices. Where it
 * crosses an earlier one, there is a vertex then. */
starg_status triangulation_constrain(triangulation *t, uint32_t a, uint32_t b,
                                     triangulation_carrier carrier);
/* Flips edges that are on no segment until no angle opposite to one is needlessly large. */
starg_status triangulation_improve(triangulation *t);

#endif
