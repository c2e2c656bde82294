/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between surfaces: matched on the sphere, improved, laid over each other. */
#pragma once

#include <stddef.h>

#include "core/fields.h"
#include "mesh/topology.h"
#include "sphere/sphere.h"
#include "starguard/morph.h"

/* ---- straight lines on a triangulated surface (walk.c) ---- */

/* A point of a surface: barycentric coordinates in a face, each at least 0, summing to 1. */
typedef struct surface_point {
    uint32_t face;
    double coordinates[3];
} surface_point;

/* Its place in space. */
void surface_place(const starg_mesh *mesh, const surface_point *point, double out[3]);

/* The gradient, in the point's face, of a function with these slopes along the three coordinates;
 * false for a zero-area face. */
bool surface_gradient(const starg_mesh *mesh, const surface_point *point, const double slopes[3],
                      double out[3]);

/* Moves a point by a vector in its face's plane, unfolded over the edges it crosses; stops at a
 * zero-area face, at a border, and after a great many faces. */
void surface_walk(const starg_mesh *mesh, const mesh_topology *topology, const double step[3],
                  surface_point *point);

/* ---- extremities, the ends of a shape's limbs: features for orientation (extremities.c) ---- */

enum { EXTREMITIES_MOST = 16 };

typedef struct extremity_list {
    size_t count;
    uint32_t vertices[EXTREMITIES_MOST];
} extremity_list;

/* Finds the extremities of a surface, most extreme first. Errors: MEMORY, CANCELLED. */
starg_status extremities_find(const sphere *s, extremity_list *out);

/* ---- point location on a spherical embedding (locate.c) ---- */

typedef struct locator {
    const sphere *sphere; /* borrowed */
    mesh_topology *topology;
} locator;

/* Errors: MEMORY. */
starg_status locator_create(starg_context *context, const sphere *s, locator *out);
void locator_free(locator *l);

/* The face whose spherical triangle contains the direction, exactly (one of them on an edge), and
 * the barycentric coordinates of its central projection into the flat triangle. `start` is the face
 * to begin at. */
uint32_t locate(const locator *l, const double direction[3], uint32_t start, double coordinates[3]);

/* ---- rotates one spherical embedding to match another (align.c) ---- */

/* Corresponding vertices: `from` on the first surface, `to` on the second. */
typedef struct landmark_list {
    const uint32_t *from, *to;
    size_t count;
} landmark_list;

/* Extremities that seem to correspond. */
typedef struct feature_pairs {
    size_t count;
    uint32_t from[EXTREMITIES_MOST], to[EXTREMITIES_MOST];
} feature_pairs;

/* Rotates the directions of `from`. Without landmarks, `features` receives pairs of extremities
 * that are close in space. Errors: MEMORY, CANCELLED. */
starg_status align_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                           feature_pairs *features);

/* ---- landmarks on the sphere, and files of them (landmarks.c) ---- */

/* Moves the directions of the present vertices of `from`, which include all landmarks, until each
 * landmark coincides with its counterpart on `to`, every triangle positive all the way. `met` tells
 * whether that succeeded. Errors: MEMORY, CANCELLED. */
starg_status landmarks_meet(sphere *from, const sphere *to, const landmark_list *landmarks,
                            bool *met);

/* Fails with MESH and names the landmark farthest from its counterpart. */
starg_status landmarks_contradict(sphere *from, const sphere *to, const landmark_list *landmarks);

/* ---- a map between two embedded surfaces, improved (distortion.c, descend.c, flow.c) ---- */

typedef struct composition {
    sphere *from;
    const locator *to;
    uint8_t *kept;         /* per vertex: a fixed landmark */
    surface_point *points; /* per vertex its image on the second surface */
    double *images;        /* per vertex its place there, scaled to equal areas */
    double scale;          /* of the second surface */
    double floor;          /* added to squared edges to limit the influence of needles; per level */
} composition;

/* The first fundamental form of a triangle with edges u, w from its apex. */
typedef struct triangle_form {
    double u[3], w[3];
    double e, f, g, area; /* twice the area, squared */
} triangle_form;

triangle_form triangle_form_of(const double apex[3], const double p[3], const double q[3],
                               double floor);

/* A place for a vertex, and the energy of its triangles there. */
typedef struct trial {
    surface_point point;
    double image[3], direction[3];
    double energy;
    double slope[3],
        spherical_slope[3]; /* gradients with respect to the image and to the direction */
} trial;

/* The vertex in place; the vertex moved to a point of the second surface. Energy not computed
 * yet. */
void trial_here(const composition *c, uint32_t v, trial *t);
void trial_at(const composition *c, const surface_point *point, trial *t);
/* Computes the energy, and on request the slopes. */
void trial_measure(const composition *c, uint32_t v, bool with_slopes, trial *t);
/* Is every spherical triangle at the vertex positive? Exact. */
bool trial_is_valid(const composition *c, uint32_t v, const trial *t);
/* The worst roundness of the spherical triangles at the vertex: 1 for equilateral ones. */
double trial_roundness(const composition *c, uint32_t v, const trial *t);
/* Moves the vertex there. */
void trial_accept(composition *c, uint32_t v, const trial *t);

/* Locates the images of all present vertices; of one, starting from a nearby face. */
void composition_locate_all(composition *c);
void composition_locate(composition *c, uint32_t v, uint32_t start);
/* Distance from a vertex's image to the nearest one of its neighbours. */
double composition_nearest(const composition *c, uint32_t v);
/* The sum of all triangles' energies. */
double composition_energy(const composition *c);

/* Moves each vertex downhill, `sweeps` times (descend.c). Errors: CANCELLED. */
starg_status composition_descend(composition *c, int sweeps);

/* Moves all vertices together, as rigidly as possible, `steps` times, each followed by some descent
 * (flow.c). Errors: SOLVER, MEMORY, CANCELLED. */
starg_status composition_flow(composition *c, int steps);

/* ---- low-distortion map from one spherically embedded surface to another (compose.c) ---- */

/* Moves the directions of `from` until the landmarks coincide with their counterparts and the map
 * from surface to surface, by way of the sphere, distorts little; every triangle stays positive.
 * `met` tells whether all landmarks were met. Errors: SOLVER (no room in doubles), MEMORY,
 * CANCELLED. */
starg_status compose_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                             bool *met);

/* ---- the overlay of two triangulations of the sphere (overlay.c) ---- */

enum { OVERLAY_CORNERS = 6 }; /* of the intersection of two triangles, at most */

/* One of the two triangulations: a mesh whose faces are positive triangles on the sphere. */
typedef struct overlay_side {
    const starg_mesh *mesh; /* as given */
    uint32_t *faces;        /* the same, counter-clockwise seen from outside of the sphere */
    const double *directions;
    mesh_topology *topology; /* of `faces` */
} overlay_side;

/* A point of a surface: weights of the corners of an oriented face, each at least 0. */
typedef struct overlay_place {
    uint32_t face;
    double weight[3];
} overlay_place;

/* A vertex of the overlay: a vertex of either, of both, or a crossing of two edges. `key` are a
 * vertex (or OVERLAY_NONE) or an edge of each side, by its lower halfedge. */
#define OVERLAY_NONE   UINT64_MAX
#define OVERLAY_VERTEX (UINT64_C(1) << 40)
typedef struct overlay_node {
    uint64_t key[2];
    overlay_place place[2];
} overlay_node;

/* The intersection of a face of A and a face of B, a strictly convex polygon. */
typedef struct overlay_cell {
    uint32_t face[2];
    uint32_t count, corner[OVERLAY_CORNERS]; /* counter-clockwise nodes */
} overlay_cell;

typedef struct sphere_overlay {
    starg_context *context;
    overlay_side side[2];
    STARG_ARRAY(overlay_node) nodes;
    STARG_ARRAY(overlay_cell) cells;
} sphere_overlay;

/* Finds nodes and cells (overlay.c). Errors: MESH (a face folds), MEMORY, CANCELLED. */
starg_status overlay_create(starg_context *context, const starg_mesh *const meshes[2],
                            const double *const directions[2], sphere_overlay **out);
void overlay_free(sphere_overlay *own);
STARG_DROP(overlay, sphere_overlay)

/* Changes the directions of an embedding of A so that the faces of B, on the same vertices, are
 * positive as well, as far as it can (overlay_share.c). Errors: MEMORY, CANCELLED. */
starg_status overlay_share(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                           double *directions);

/* Moves nodes within their faces and along their edges so that the cells can be cut into triangles
 * about their first corners, exactly positive on both sides (overlay_room.c); *moved: any had to.
 * Errors: SOLVER (too thin for doubles), MEMORY, CANCELLED. */
starg_status overlay_make_room(sphere_overlay *own, bool *moved);

/* ---- a map and its file (map.c, map_json.c) ---- */

/* MAP.json as a starg_map. */
extern const starg_fields map_file_fields;

/* Fills in the distortion of the map. Errors: MEMORY. */
starg_status map_measure(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map);

/* Positions of `count` points by faces and barycentric coordinates. */
void map_place(const starg_mesh *mesh, size_t count, const uint32_t *faces,
               const double *coordinates, double *positions);

/* Gives a map that keeps vertices directions of A's embedding, changed so that B's faces are
 * positive too, for both surfaces. Errors: MESH (not of genus 0), SOLVER, MEMORY, CANCELLED. */
starg_status map_share_directions(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                  starg_map *map);

/* starg_map_overlay; *moved: corners had to be moved, so that not all are in the directions of the
 * map (map_overlay.c). */
starg_status map_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map, bool *moved);

/* Frees its arrays (map_overlay.c). */
void map_free_overlay(starg_overlay *overlay);

/* A copy scaled to a unit cube about the origin. Errors: MESH (no extent), MEMORY. */
starg_status map_unit_copy(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

STARG_DROP_RESULT(starg_map)

/* ---- lines of numbers, with comments from '#' on (parse_numbers.c) ---- */

/* The numbers of a line, apart by white space or commas, and how many there are; `most` + 1 if it
 * has more, or anything else. The line loses its comment. */
size_t parse_numbers(char *line, double *values, size_t most);
