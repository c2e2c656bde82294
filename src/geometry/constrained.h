/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation: a mesh of a plane whose edges are flipped, for points of any kind, and
 * the triangulation of a planar straight-line graph in doubles. */
#pragma once

#include "core/memory.h"

/* ---- a mesh of part of a plane ---- */

#define PLANAR_NONE UINT32_MAX

/* On which side of the way from a to b is c? Exact: above 0 on its left. */
typedef int (*planar_turn)(const void *points, uint32_t a, uint32_t b, uint32_t c);

/* Halfedge 3 t + k runs from corner k of triangle t to the next one; triangles turn left. */
typedef struct planar {
    starg_context *context;
    const char *stage;
    planar_turn turn;
    const void *points;
    STARG_ARRAY(uint32_t) corner; /* vertex per halfedge                                     */
    STARG_ARRAY(uint32_t) twin;   /* per halfedge; NONE on the border                        */
    STARG_ARRAY(uint32_t) mark;   /* per halfedge: what it is on, or NONE: it may be flipped */
    STARG_ARRAY(uint32_t) at;     /* per vertex: a halfedge that starts there, or NONE       */
    STARG_ARRAY(uint64_t) crossed;
    uint32_t last; /* the triangle set last */
} planar;

static inline uint32_t planar_next(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t planar_previous(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

static inline uint32_t planar_start(const planar *m, uint32_t h) {
    return m->corner.data[h];
}

static inline uint32_t planar_end(const planar *m, uint32_t h) {
    return m->corner.data[planar_next(h)];
}

static inline uint32_t planar_tip(const planar *m, uint32_t h) {
    return m->corner.data[planar_previous(h)];
}

/* The next halfedge from the same vertex, counter-clockwise, or NONE. */
static inline uint32_t planar_around(const planar *m, uint32_t h) {
    return m->twin.data[planar_previous(h)];
}

/* No triangles any more. */
void planar_clear(planar *m);
void planar_free(planar *m);

/* A triangle whose corners are to be set, which are numbers below the count of `at`. Errors:
 * MEMORY.
 */
starg_status planar_add(planar *m, uint32_t *triangle);
void planar_set(planar *m, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c);

/* Halfedge h lies against `twin` (or on the border), with that mark. */
void planar_link(planar *m, uint32_t h, uint32_t twin, uint32_t mark);

/* What lies beyond a halfedge, while triangles are rearranged. */
typedef struct planar_rim {
    uint32_t twin, mark;
} planar_rim;

static inline planar_rim planar_rim_of(const planar *m, uint32_t h) {
    return (planar_rim){m->twin.data[h], m->mark.data[h]};
}

/* Do the two triangles at a halfedge without a mark form a strictly convex quadrangle? */
bool planar_can_flip(const planar *m, uint32_t h);

/* (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c). */
void planar_flip(planar *m, uint32_t h);

/* The halfedge from a to b, or NONE. */
uint32_t planar_find(const planar *m, uint32_t a, uint32_t b);

/* Lists the edges that the way from a to b crosses, the first of them h, up to a vertex on it:
 * *target; or up to a halfedge that has a mark or is on the border: *blocked, else NONE. Errors:
 * MEMORY. */
starg_status planar_march(planar *m, uint32_t h, uint32_t a, uint32_t b, uint32_t *target,
                          uint32_t *blocked);

/* Flips the listed edges until a b is one. Edges that are crossed after their flip, too, are
 * flipped at once, where *done is false if none can be any more; or, with `dice`, every other time
 * at random: some sequence of flips always leads to the end, and no circle lasts. Errors: MEMORY,
 * CANCELLED. */
starg_status planar_flip_away(planar *m, uint32_t a, uint32_t b, bool dice, bool *done);

/* ---- a planar straight-line graph in doubles ---- */

/* Marks the outside of a hull edge. */
#define CONSTRAINED_NONE UINT32_MAX

/* Edge k runs from corner k to the next. */
typedef struct constrained_triangle {
    uint32_t corners[3]; /* counter-clockwise */
    uint32_t beyond[3];  /* the triangle across each edge, or NONE */
    int32_t turns[3];    /* winding number here minus that across the edge */
    bool fixed[3];       /* the edge belongs to the graph */
} constrained_triangle;

typedef STARG_ARRAY(constrained_triangle) constrained_triangles;

/* An edge of the graph. The winding number is higher by `turns` on its left than on its right. */
typedef struct constrained_edge {
    uint32_t from, to;
    int32_t turns;
} constrained_edge;

/* Distinct edges, and more vertices, in the plane of coordinates `u` and `v` of the points (x 3).
 */
typedef struct constrained_graph {
    const double *points;
    int u, v;
    const constrained_edge *edges;
    size_t edge_count;
    const uint32_t *loose;
    size_t loose_count;
} constrained_graph;

/* Triangulates the convex hull of the graph's vertices with all of its edges; Delaunay up to those
 * and to rounding. *done is false if the graph is not plane: coincident vertices, crossing edges,
 * or an edge through a vertex. With all vertices collinear there are no triangles; *done is then
 * true if no edge has turns. Errors: MEMORY. */
starg_status constrained_triangulate(starg_context *context, const constrained_graph *graph,
                                     constrained_triangles *out, bool *done);
