/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between solids, and morphs of solids: tetrahedra that follow their surface. */
#pragma once

#include "core/context.h"
#include "core/memory.h"
#include "starguard/morph.h"
#include "starguard/solidmap.h"

/* ---- mesh deformation: tetrahedra that follow a morph (deform.c) ---- */

/* Tetrahedra of A at their current places, and which vertices are on the surface. */
typedef struct deform_mesh {
    starg_context *context;
    size_t fixed;                     /* vertices of the surface, which come first */
    const uint32_t *surface;          /* their numbers in the morph's mesh; borrowed */
    STARG_ARRAY(double) rest;         /* x 3: positions in A */
    STARG_ARRAY(double) now;          /* x 3: current positions */
    STARG_ARRAY(uint32_t) tetrahedra; /* x 4 */
} deform_mesh;

/* An edge: both vertices, the lower one in the upper half. */
typedef uint64_t deform_edge;

static inline deform_edge deform_edge_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* The corners of the six edges of a tetrahedron. */
extern const int DEFORM_EDGES[6][2];

/* Is the edge in the ascending list? */
bool deform_edge_in(const deform_edge *list, size_t count, deform_edge edge);
/* Sorts a list and removes duplicates. */
void deform_edges_sort(deform_edge *list, size_t *count);

/* Inserts a vertex into the middle of every edge of the ascending list, which splits its
 * tetrahedra; skips edges where a part would have no volume in A (split.c). Errors: MEMORY. */
starg_status deform_split(deform_mesh *c, const deform_edge *edges, size_t count);

/* Inserts a vertex into the middle of every tetrahedron with all corners on the surface, unless a
 * part would have no volume in A (split.c). Errors: MEMORY. */
starg_status deform_fill_flat(deform_mesh *c);

/* Splits what leaves no freedom where the surface bends: edges and tetrahedra inside whose corners
 * are all on it. Errors: MEMORY. */
starg_status deform_free_surface(const starg_morph *m, deform_mesh *c);

/* Moves the surface to B and each inner vertex as far as its neighbours on average. Tetrahedra may
 * be inverted. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status deform_harmonic(const starg_morph *m, deform_mesh *c);

/* Where the vertices pass: straight from one row of places to the next. */
typedef struct deform_path {
    STARG_ARRAY(double) times;  /* ascending, above 0 */
    STARG_ARRAY(double) places; /* x 3 per vertex, a row for each time */
} deform_path;

/* Moves the inner vertices of `c`, initially as in A, along with the morph to B. *inverted is 0, or
 * the number of tetrahedra that could not be kept positive near `*reached`. With a path (or NULL),
 * initially empty, steps are shorter, and every tetrahedron is proven to be positive at every
 * moment of each. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status deform(const starg_morph *m, deform_mesh *c, deform_path *path, size_t *inverted,
                    double *reached);

static inline void deform_free(deform_mesh *c) {
    RELEASE(c->rest.data, c->now.data, c->tetrahedra.data);
}

/* ---- tetrahedra whose surface comes as near to B as they allow (approach.c) ---- */

/* How far the surface is off B in the end. */
typedef struct approach_result {
    size_t inverted; /* tetrahedra: 0 on success */
    size_t strayed;  /* vertices of the surface that are off B's surface in A's faces */
    double farthest; /* the farthest, in diagonals of B */
} approach_result;

/* Moves the vertices, whose surface is in place in B, until every tetrahedron is positive, and then
 * those of the surface back: to their places, or to others on that surface. `a` has the faces that
 * c->surface refers to. Springs of a high strength (1 and more) keep the surface where it is, of a
 * low one let tetrahedra unfold. Errors: MEMORY, CANCELLED. */
starg_status approach(deform_mesh *c, const starg_mesh *a, double strength, approach_result *out);

/* ---- maps of tetrahedra without inversions, and with little distortion (unfold.c) ---- */

/* Springs that draw the first vertices instead of fixing them. */
typedef struct unfold_springs {
    size_t count;          /* of vertices; 0: none */
    const double *targets; /* count x 3 */
    double strength; /* energy if all are off by `length`; that of all tetrahedra is about 3 */
    double length;
    void (*move)(void *user); /* may change the targets, between rounds */
    void *user;
} unfold_springs;

/* Tetrahedra in two places. All arrays are the caller's. */
typedef struct unfold_problem {
    starg_context *context;
    size_t vertex_count, fixed; /* the first `fixed` vertices do not move */
    size_t count;
    const uint32_t *tetrahedra; /* count x 4 */
    const double *rest;         /* vertex_count x 3: all tetrahedra are positive there */
    double *now;                /* vertex_count x 3: to be moved */
    double until;               /* on starg_clock(), where relaxation ends; 0: it does not */
    unfold_springs springs;     /* none, or fixed = 0 and one for each vertex of the surface */
} unfold_problem;

/* Is a tetrahedron positive where it is now, exactly? */
bool unfold_is_positive(const unfold_problem *p, size_t tetrahedron);

/* Moves vertices until all tetrahedra are positive, or for so many steps of descent; *inverted is
 * the number of those left. Errors: MEMORY, CANCELLED. */
starg_status unfold(const unfold_problem *p, size_t steps, size_t *inverted);

/* Lowers the distortion of tetrahedra that are all positive, and stay so, in at most so many steps
 * of descent. Errors: MEMORY, CANCELLED. */
starg_status unfold_relax(const unfold_problem *p, size_t steps);

/* ---- tetrahedra that fill both ends of a morph (solids.c) ---- */

/* Initial tetrahedra per vertex, unless others are asked for. */
#define SOLIDS_DENSITY 1.0

/* The vertices of A in use, in order, are the first of the tetrahedra: c->fixed and c->surface.
 * *surface is the caller's, also on failure. Errors: MEMORY. */
starg_status solids_list_surface(const starg_mesh *a, deform_mesh *c, uint32_t **surface);

/* Checks that both ends bound a solid without self-intersections, and fills A with tetrahedra that
 * keep its surface. `c` is empty but for its context; *surface, to which it refers, and *solid are
 * the caller's, also on failure. Errors: MESH, SOLVER (no TetGen), MEMORY, CANCELLED. */
starg_status solids_fill(const starg_morph *m, double density, deform_mesh *c, starg_solid **solid,
                         uint32_t **surface);

/* The same for A alone: B in A's connectivity may meet itself. */
starg_status solids_fill_first(const starg_morph *m, double density, deform_mesh *c,
                               starg_solid **solid, uint32_t **surface);

/* Is the last end no solid without self-intersections? Errors: MEMORY. */
starg_status solids_last_meets_itself(const starg_morph *m, bool *out);

/* Checks that the last end bounds a solid without self-intersections. Errors: MESH, MEMORY. */
starg_status solids_check_last(const starg_morph *m);

/* Checks that no faces of a surface pass through one another; `what` it is called. Errors: MESH,
 * MEMORY. */
starg_status solids_check_crossings(starg_context *context, const starg_mesh *mesh,
                                    const char *what);

/* Divides the tetrahedra of A so that their surface is an overlay: its vertices come first, in its
 * order, and c->surface is the caller's to set (solid_overlay.c). Errors: MESH (parts of A too thin
 * for doubles), MEMORY. */
starg_status solids_divide(deform_mesh *c, const starg_mesh *a, const starg_overlay *overlay);

/* One of the two places of tetrahedra that are known not to overlap: a copy. Errors: MEMORY. */
starg_status solids_place(const deform_mesh *c, const double *places, starg_tetmesh **out);

/* ---- star-shaped solids, seen from a point of each kernel (solid_stars.c) ---- */

/* A point in the interior of the kernel of a solid, proven; *found: there is one. At the first
 * attempt, 0, its coordinates have few digits where the kernel is roomy, so that differences to
 * simple coordinates are exact; at others it is a random one near that. The faces of `mesh` may
 * look inward. Errors: MEMORY, CANCELLED. */
starg_status stars_center(starg_context *context, const starg_mesh *mesh, uint64_t attempt,
                          double center[3], bool *found);

/* Fills two solids with the same faces, A and the images of its vertices, by cones over the faces
 * about a point in each: one of `centers` (2 x 3), or of the kernels if that is NULL or does not
 * see all. *found: both see all faces strictly, by exact signs; else `c` is as it was, empty but
 * for its context. *surface, to which it refers, is the caller's. Errors: MESH, MEMORY, CANCELLED.
 */
starg_status stars_fill(const starg_mesh *a, const double *images, const double *centers,
                        deform_mesh *c, uint32_t **surface, bool *found);

/* ---- morphs of solids (solid_path.c) ---- */

/* Tetrahedra at both ends, and their way. */
typedef struct solid_path {
    deform_mesh mesh;
    uint32_t *surface; /* the morph's numbers of the first vertices */
    deform_path keys;
    uint32_t *labels; /* of cones of star-shaped ends: all 0; else NULL */
} solid_path;

void solid_path_free(solid_path *path);

/* ---- maps between solids (solid_map.c) ---- */

/* The images of A's vertices on a ball of radius 1 or a cube of edge 2 (solid_shape.c); a block of
 * the context. Errors: MESH, SOLVER, MEMORY, CANCELLED. */
starg_status solid_map_shape(starg_context *context, const starg_mesh *a, starg_solid_shape shape,
                             double **images);

/* Puts tetrahedra, positive in both places, into pieces, and measures; `cut`: divides them where
 * that saves pieces. Errors: MESH, MEMORY, CANCELLED. */
starg_status solid_map_finish(starg_context *context, const deform_mesh *c, bool cut,
                              starg_solid_map **out);

/* The same for cones: a label for each tetrahedron, and the last `count` vertices see one piece
 * each. Errors: MEMORY, CANCELLED. */
starg_status solid_map_finish_cones(starg_context *context, const deform_mesh *c,
                                    const uint32_t *labels, size_t count, starg_solid_map **out);

/* Exponents of the extents of both places, as units of length. */
void solid_map_exponents(const starg_solid_map *map, int out[2]);

/* The largest over the smallest singular value of a tetrahedron's map, and its volume in A, in
 * those units. */
double solid_map_ratio(const starg_solid_map *map, size_t t, const int exponents[2],
                       double *volume);

STARG_DROP_RESULT(starg_solid_map)
