/* SPDX-License-Identifier: Apache-2.0 */
/* A surface cut along all its intersections: a complex of triangles with exact corners. */
#pragma once

#include "geometry/bvh.h"
#include "geometry/constrained.h"
#include "geometry/exact_points.h"
#include "mesh/union/union.h"

/* ---- which faces of a surface meet away from common corners, and where (contacts.c) ---- */

typedef struct union_contact {
    uint32_t face[2];
    uint32_t
        end[2]; /* points: the ends of what they share; the same one twice for a single point */
    bool coplanar, overlap; /* in one plane; and with a common area, which has no ends */
} union_contact;

typedef STARG_ARRAY(union_contact) union_contacts;

/* Lists the pairs of which one face is fresh, or all pairs. Errors: MEMORY, CANCELLED, TIME. */
starg_status union_find_contacts(const union_surface *surface, const bvh *tree, bool all,
                                 union_contacts *out);

/* Fills in the ends. `point` gives the number of each vertex of these faces among the points, to
 * which new ones are added. Errors: MEMORY. */
starg_status union_find_ends(const union_surface *surface, const uint32_t *point,
                             exact_points *points, union_contact *contact);

/* ---- constrained triangulation of points and segments of a plane, exact (triangulation.c) ---- */

/* The line of a segment: through two vertices, or where the plane meets that of a face. */
typedef struct triangulation_carrier {
    const double *corner[3]; /* the third is NULL for a line */
} triangulation_carrier;

/* Marks are numbers of carriers, vertices numbers of points. */
typedef struct triangulation {
    planar mesh;
    exact_points *points;
    const double *plane[3]; /* a face in the plane                                        */
    int u, v;               /* the coordinates of the projection, in which that face turns left */
    STARG_ARRAY(triangulation_carrier) carriers;
    STARG_ARRAY(uint32_t) used; /* the points that are vertices                           */
} triangulation;

/* Once for many triangulations: memory for all. */
static inline triangulation triangulation_make(exact_points *points) {
    return (triangulation){.mesh = {.context = points->context, .stage = UNION_STAGE},
                           .points = points};
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

/* ---- a surface cut along its intersections: triangles with exact corners (arrangement.c) ---- */

typedef struct union_triangle {
    uint32_t corner[3]; /* a vertex of the surface, or vertex count + index into `added`       */
    uint32_t face;      /* a face of the surface that holds it                                 */
    int layers;         /* faces on it that turn as it does, minus those that do not: above 0  */
    bool whole;         /* it is that face                                                     */
} union_triangle;

/* Triangles meet in common corners and edges only. */
typedef struct union_complex {
    starg_context *context;
    const union_surface *surface;
    exact_points points;
    STARG_ARRAY(union_triangle) triangles;
    STARG_ARRAY(uint32_t) added; /* points that are no vertices of the surface */
    STARG_ARRAY(uint32_t) name;  /* per point: as `corner` calls it            */
} union_complex;

/* Cuts a surface with these contacts, whose ends it fills in. Errors: RANGE, MEMORY, CANCELLED. */
starg_status union_arrange(const union_surface *surface, union_contacts *contacts,
                           union_complex *out);
void union_complex_free(union_complex *complex);

/* The exact place of a corner. */
void union_complex_place(const union_complex *complex, uint32_t corner, exact_point *out);
const double *union_complex_rounded(const union_complex *complex, uint32_t corner);

/* ---- which triangles of a cut surface separate inside from outside (windings.c) ---- */

/* Sets keep[t] for every triangle t with a winding number below 1 in front and of 1 or more behind.
 * `tree` is over the complex's surface. Errors: MEMORY, CANCELLED, TIME. */
starg_status union_choose(const union_complex *complex, const bvh *tree, bool *keep);
