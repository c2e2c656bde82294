/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces bounded by triangles that lie in two places at once (cones.c divides them, peel.c chooses
 * the cuts). */
#pragma once

#include "core/context.h"
#include "core/rng.h"
#include "geometry/bvh.h"
#include "star/certified/search.h"
#include "visibility/kernel.h"

#define NOWHERE UINT32_MAX

/* ---- faces in one of two places as the input of a search for planes (planes.c) ---- */

/* To a cube of about unit size. */
typedef struct twin_frame {
    double origin[3], scale;
} twin_frame;

twin_frame twin_frame_of(const double *places, const uint32_t *corners, size_t count);

/* `corners` are those of triangles, `count` in all. Errors: MEMORY. */
starg_status twin_region(starg_context *context, const double *places, size_t vertices,
                         const uint32_t *corners, size_t count, const twin_frame *frame,
                         region *out);

/* Guards that see all of a surface in both of its places, which are looked at in a random order;
 * *blind is one where there is none, or -1. Errors: MEMORY, and those of kernel_find. */
starg_status twin_kernels(starg_context *context, const kernel_faces surfaces[2], starg_rng *rng,
                          double guards[2][3], int *blind);

/* ---- cones ---- */

typedef STARG_ARRAY(uint32_t) number_list;

typedef struct cone_piece {
    number_list triangles;
    int attempts;
    bool done;
    double centers[2][3];
} cone_piece;

typedef struct cone_builder {
    starg_context *context;
    STARG_ARRAY(double) places[2];  /* x 3 */
    STARG_ARRAY(number_list) about; /* per vertex: triangles; some have left it */
    number_list corners;            /* x 3 */
    number_list sides;              /* x 2: the pieces before and behind a triangle, or NOWHERE */
    STARG_ARRAY(cone_piece) pieces;
    STARG_ARRAY(double) heights; /* per vertex, of the piece that is cut */
    region_scratch scratch;
    starg_rng rng;
    double balance; /* what a cut in the middle counts, beside what is seen */
    size_t work;    /* faces of pieces for which cuts were sought */
} cone_builder;

/* A name for an edge, whichever way it runs, and the order of names. */
static inline uint64_t cones_edge_name(uint32_t u, uint32_t v) {
    return u < v ? (uint64_t)u << 32 | v : (uint64_t)v << 32 | u;
}
static inline int cones_by_edge_name(const void *left, const void *right) {
    uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

/* A state of the builder. Vertices stay where they are, so that their number tells which there are;
 * lists of triangles follow from the sides. */
typedef struct cone_state {
    size_t vertices;
    number_list corners, sides;
    STARG_ARRAY(cone_piece) pieces; /* without their triangles */
} cone_state;

/* A directed edge of a piece's boundary, and the triangle to its left. */
typedef struct side_edge {
    uint64_t edge;
    uint32_t triangle;
} side_edge;

typedef STARG_ARRAY(side_edge) edge_list;

/* Where a cut passes: a vertex, or a point of an edge. */
typedef struct cut_node {
    uint32_t from, to; /* NOWHERE: at the vertex */
    double share;      /* of the way */
} cut_node;

/* Loops, with what is above on the left. */
typedef struct cut_loops {
    STARG_ARRAY(cut_node) nodes; /* one loop after the other */
    number_list lengths;
} cut_loops;

/* A loop in one place. */
typedef struct loop_places {
    STARG_ARRAY(double) points; /* x 3 */
    double normal[3], mean[3], extent;
} loop_places;

void cones_free(cone_builder *b) STARG_PRIVATE(cones_free);
/* Remembers a state, and goes back to it; random numbers go on. Errors: MEMORY. */
starg_status cones_save(const cone_builder *b, cone_state *out) STARG_PRIVATE(cones_save);
starg_status cones_restore(cone_builder *b, const cone_state *state) STARG_PRIVATE(cones_restore);
void cones_free_state(cone_state *state) STARG_PRIVATE(cones_free_state);
/* Where a vertex is in one of both places. */
const double *cones_place_of(const cone_builder *b, int end, uint32_t vertex)
    STARG_PRIVATE(cones_place_of);
/* The corners of a triangle, counter-clockwise seen from outside of the piece. */
void cones_corners_of(const cone_builder *b, uint32_t triangle, uint32_t which, uint32_t out[3])
    STARG_PRIVATE(cones_corners_of);
starg_status cones_add_vertex(cone_builder *b, const double from[2][3], uint32_t *out)
    STARG_PRIVATE(cones_add_vertex);
starg_status cones_add_triangle(cone_builder *b, const uint32_t corners[3], const uint32_t sides[2])
    STARG_PRIVATE(cones_add_triangle);
/* Divides an edge in all its triangles; `share` of the way from u to v. */
starg_status cones_split_edge(cone_builder *b, uint32_t u, uint32_t v, double share)
    STARG_PRIVATE(cones_split_edge);
/* A new piece without triangles. */
starg_status cones_open_piece(cone_builder *b, int attempts, uint32_t *out)
    STARG_PRIVATE(cones_open_piece);
/* Corners of all triangles of a piece, outward. */
starg_status cones_list_faces(const cone_builder *b, uint32_t which, number_list *out)
    STARG_PRIVATE(cones_list_faces);
/* Heights of vertices over a plane of one place. */
void cones_find_heights(cone_builder *b, int end, const number_list *faces, const double normal[3],
                        const double point[3], double *out) STARG_PRIVATE(cones_find_heights);
/* Heights over a plane that leaves less of the piece unseen in one place, if one is found. */
starg_status cones_search_plane(cone_builder *b, uint32_t which, int end, const number_list *faces,
                                double *heights, bool *found) STARG_PRIVATE(cones_search_plane);
/* Heights over a random plane, between two of the corners. */
void cones_draw_plane(cone_builder *b, int end, const number_list *faces, double *heights)
    STARG_PRIVATE(cones_draw_plane);
/* Cuts near an end of an edge go through it. */
void cones_snap(const number_list *faces, double *heights) STARG_PRIVATE(cones_snap);
void cones_free_loops(cut_loops *loops) STARG_PRIVATE(cones_free_loops);
/* All directed edges of a piece, ascending. */
starg_status cones_list_edges(const cone_builder *b, uint32_t which, edge_list *out)
    STARG_PRIVATE(cones_list_edges);
/* The triangle across an edge, or NOWHERE. */
uint32_t cones_across(const edge_list *edges, uint32_t u, uint32_t v) STARG_PRIVATE(cones_across);
/* Do two heights lie on different sides of the cut, neither on it? Their product may underflow. */
static inline bool cones_are_opposite(double p, double q) {
    return (p < 0 && q > 0) || (p > 0 && q < 0);
}
/* Follows the cut at height 0. *simple: there is one, and no node is passed twice. */
starg_status cones_find_loops(const cone_builder *b, uint32_t which, const edge_list *edges,
                              const double *heights, cut_loops *out, bool *simple)
    STARG_PRIVATE(cones_find_loops);
/* A loop in one place. */
starg_status cones_place_loop(const cone_builder *b, int end, const cut_node *nodes, size_t count,
                              loop_places *out) STARG_PRIVATE(cones_place_loop);
/* A point from which the loop, seen along its normal, is passed to the left: the one farthest from
 * the lines of its edges. *room: its distance, over the extent; at most 0: there is none. */
starg_status cones_find_hub(cone_builder *b, const loop_places *loop, double hub[3], double *room)
    STARG_PRIVATE(cones_find_hub);
/* Is a hub inside, and sees it all nodes of its loop? */
bool cones_is_inside(const bvh *tree, const loop_places *loop, const double hub[3])
    STARG_PRIVATE(cones_is_inside);
/* What is reached from the left side of a loop without crossing it goes to piece `fresh`. */
starg_status cones_part(cone_builder *b, uint32_t which, const edge_list *edges,
                        const cut_node *loop, size_t count, uint32_t fresh)
    STARG_PRIVATE(cones_part);

/* ---- cuts (cone_cuts.c) ---- */

/* The point with the most room below the planes of faces, its room as a share of their size, the
 * root of their area, and how much of that it sees. */
typedef struct side_view {
    double point[3], room, area, seen;
} side_view;

/* Outward, twice as long as the triangle's area. */
void cones_find_normal(const cone_builder *b, int end, const uint32_t corner[3], double out[3])
    STARG_PRIVATE(cones_find_normal);
/* The half-space below a plane with an outward normal, as a row of a linear program of which the
 * fourth variable is the distance from the planes. */
void cones_put_row(const double normal[3], const double point[3], double *row)
    STARG_PRIVATE(cones_put_row);
/* Sees faces from the point with the most room below them and below `further` rows, `count` x 5;
 * it is sought about `center`. Errors: MEMORY. */
starg_status cones_see(const cone_builder *b, int end, const number_list *faces,
                       const double *further, size_t count, const double center[3], double extent,
                       side_view *out) STARG_PRIVATE(cones_see);
/* Heights over the plane of a face at a notch, an edge where the solid turns by more than half a
 * turn: such cuts leave no ledges. What looks up to the plane is above, and so are the faces in it,
 * which the loops then pass on the side of the notch. *found: there is a notch. */
void cones_draw_notch(cone_builder *b, uint32_t which, int end, const number_list *faces,
                      const edge_list *edges, double *heights, bool *found)
    STARG_PRIVATE(cones_draw_notch);
/* What hangs together above the cut, or through faces that lie in it: sets of vertices. `flat`:
 * vertices of such faces. */
void cones_find_parts(const number_list *faces, const double *heights, bool through, uint32_t *part,
                      uint8_t *flat) STARG_PRIVATE(cones_find_parts);
/* The same heights where all but one part is below. `vertices`: of the piece. */
void cones_keep_part(const number_list *vertices, const double *heights, uint32_t *part,
                     uint32_t root, double *out) STARG_PRIVATE(cones_keep_part);
/* Faces that lie in the cut come to be below it, but for their vertices next to what is above. */
void cones_drop_flat(const number_list *faces, const uint8_t *flat, double *heights)
    STARG_PRIVATE(cones_drop_flat);
/* The faces on one side of a cut; those that it crosses are on both. Errors: MEMORY. */
starg_status cones_list_side(const cone_builder *b, const number_list *faces, const double *heights,
                             bool below, number_list *out) STARG_PRIVATE(cones_list_side);
/* Divides the edges that cross the cut of b->heights, and gives what is above to a new piece.
 * *done: the cut is one loop, `rim`. Errors: MEMORY. */
starg_status cones_part_leaf(cone_builder *b, uint32_t which, const number_list *faces,
                             edge_list *edges, cut_loops *rim, uint32_t *leaf, bool *done)
    STARG_PRIVATE(cones_part_leaf);

/* ---- cuts that keep one of the two places star-shaped (peel.c), and walls of these that span two
 * loops of the same length at once (web.c) ---- */

/* PEEL_BROKEN: the leaf is off, but no wall fits; the pieces are of no use any more. */
typedef enum peel_verdict { PEEL_DONE, PEEL_NOTHING, PEEL_BROKEN } peel_verdict;

/* Cuts a piece that has no kernel in the place `end`. A kernel in the other place is kept in what
 * is left and in all that is taken off. PEEL_NOTHING: no cut was found. Errors: MEMORY, CANCELLED.
 */
starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out)
    STARG_PRIVATE(cones_peel);

/* Triangles that span a loop. Corners below `count` are the loop's nodes, those from there on the
 * points of a ring inside. */
typedef struct cone_web {
    size_t count;
    STARG_ARRAY(double) ring; /* x 3: unit directions, one for each node */
    number_list triangles;    /* x 3: to the left of the loop, passed as the loop is */
} cone_web;

/* Spans a loop that is given by the directions of its nodes. *found: there is a web; false where
 * the loop passes itself or goes round most of the sphere. Errors: MEMORY. */
starg_status cones_find_web(starg_context *context, const double *directions, size_t count,
                            cone_web *out, bool *found) STARG_PRIVATE(cones_find_web);
void cones_free_web(cone_web *web) STARG_PRIVATE(cones_free_web);
