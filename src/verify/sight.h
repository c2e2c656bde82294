/* SPDX-License-Identifier: Apache-2.0 */
/* What a place sees of a surface, and where guards may stand. */
#pragma once

#include "starguard/verify.h"
#include "verify/signs.h"
#include "verify/surface.h"

/* ---- what a sensor limits, apart from what stands in its way (sensor.c) ---- */
/* All rules of the verifier, and all exact for finite doubles below 1e100. */

/* The limits of a view. */
typedef struct verify_view {
    double range, near; /* vertices farther away, or nearer, count as not seen */
    starg_face_rule rule;
    const double *direction; /* of a cone of view, or NULL */
    double cosine;           /* of half the cone's opening */
    bool framed;             /* by planes of a rectangular view */
    double planes[4][3];
    double depth; /* largest along `ahead`, with framed; above 1e100: any */
    const double *ahead;
    const starg_guards *needs; /* faces have densities of their own, and depth is any; NULL: none */
    double steepest;           /* cosine of the incidence; 0: any */
} verify_view;

/* Is the angle at p between `direction` (not zero) and q at most that of the cosine? q = p counts
 * as within. */
bool verify_in_cone(const double p[3], const double direction[3], double cosine, const double q[3]);

/* What a face needs of its own; NULL: nothing. */
const starg_face_need *verify_need_of(const starg_guards *guards, size_t face);

/* Is q, from p, at most so deep in the framed view? */
bool verify_is_near(const verify_view *view, const double p[3], double depth, const double q[3]);

/* Is q at a distance, and in a direction, in which the view from p holds vertices? */
bool verify_in_view(const verify_view *view, const double p[3], const double q[3]);

/* Is a triangle in the plane of t, all of it or a part with these corners, seen from p, strictly on
 * its inner side, at an incidence that the view allows? */
bool verify_faces(const verify_view *view, const double p[3], const double *const t[3],
                  const double *const corners[3]);

/* Are p and q, as seen from the centroid of the triangle, at least as far apart as the angle of
 * this cosine? */
bool verify_apart(const double *const t[3], const double p[3], const double q[3], double cosine);

/* ---- patches: the parts that faces are seen in, or the faces (patches.c) ---- */

/* A point between the vertices of a face, rounded; their numbers ascend. */
typedef struct verify_mix {
    uint32_t vertex[3];
    double weight[3], at[3]; /* weights are whole, VERIFY_UNIT in sum */
} verify_mix;

/* The point of a face with these weights by its vertices, VERIFY_UNIT in sum. */
verify_mix verify_mix_of(const verify_surface *surface, uint32_t face, const uint32_t weight[3]);

/* The same as a spot, which needs the point as long; `blur` is that of the surface: by how much
 * coordinates of points between vertices are off. */
verify_spot verify_mix_spot(const verify_surface *surface, const verify_mix *mix, double blur);
double verify_blur(const verify_surface *surface);

typedef struct verify_patches {
    size_t count, point_count;
    size_t *first;      /* by face, and one more: its first patch */
    uint32_t *face;     /* by patch */
    uint32_t *corner;   /* 3 by patch: vertices, or vertex_count + number of a point */
    double *share;      /* by patch, of the area of its face */
    verify_mix *points; /* between vertices */
    double blur;        /* of these */
} verify_patches;

/* A part of a face while it is halved. */
typedef struct verify_part {
    uint32_t face, index[3]; /* vertices, or points as of verify_patches */
    uint32_t weight[3][3];   /* of corners, by the vertices of the face; VERIFY_UNIT in sum */
    double share;
} verify_part;

typedef struct verify_parts {
    const verify_surface *surface;
    STARG_ARRAY(verify_part) list; /* face by face */
    STARG_ARRAY(verify_mix) mixes;
} verify_parts;

verify_part verify_part_of(const verify_surface *surface, uint32_t face);

/* The square of the length of the edge from corner k to the next, in doubles as the page says. */
double verify_edge_square(const verify_surface *surface, const verify_part *part, int k);

/* Halves that edge, if its ends are not too close: the first half keeps corner k. Errors: MEMORY.
 */
starg_status verify_halve(verify_parts *own, const verify_part *part, int k, verify_part half[2],
                          bool *halved);
/* Errors: ARGUMENT (too many), MEMORY, CANCELLED. */
starg_status verify_parts_add(verify_parts *own, const verify_part *part);
void verify_parts_free(verify_parts *own);

/* The parts become the patches of the surface, in place of those before; of the backs of faces that
 * count from either side, they are those of the fronts. Faces without parts have no patches.
 * Errors: MEMORY. */
starg_status verify_patches_set(const verify_parts *own, verify_surface *surface);
void verify_patches_free(verify_patches *patches);
STARG_DROP(verify_patches, verify_patches)

/* Cuts the faces of the model until no edge is longer than that. Errors: those of verify_parts_add.
 */
starg_status verify_patches_create(verify_surface *surface, double longest);

/* A vertex, or a point between some. */
verify_spot verify_spot_of(const verify_surface *surface, uint32_t index);

static inline size_t verify_patch_count(const verify_surface *surface) {
    return surface->patches != NULL ? surface->patches->count : surface->face_count;
}

static inline size_t verify_spot_count(const verify_surface *surface) {
    return surface->vertex_count + (surface->patches != NULL ? surface->patches->point_count : 0);
}

/* The patches of a face are those from its first to before that of the next. */
static inline size_t verify_first_patch(const verify_surface *surface, size_t face) {
    return surface->patches != NULL ? surface->patches->first[face] : face;
}

static inline size_t verify_patch_face(const verify_surface *surface, size_t patch) {
    return surface->patches != NULL ? surface->patches->face[patch] : patch;
}

static inline double verify_patch_share(const verify_surface *surface, size_t patch) {
    return surface->patches != NULL ? surface->patches->share[patch] : 1;
}

/* Its corners: vertices, or points between some. */
static inline const uint32_t *verify_patch_corners(const verify_surface *surface, size_t patch) {
    return (surface->patches != NULL ? surface->patches->corner : surface->faces) + 3 * patch;
}

static inline void verify_patch_spots(const verify_surface *surface, size_t patch,
                                      verify_spot spots[3]) {
    for (int i = 0; i < 3; i++)
        spots[i] = verify_spot_of(surface, verify_patch_corners(surface, patch)[i]);
}

/* ---- what one point sees, by a map of directions (sight.c) ---- */

/* Working memory for points, one at a time; one thread. */
typedef struct verify_sight verify_sight;

starg_status verify_sight_create(const verify_surface *surface, verify_sight **out);
void verify_sight_free(verify_sight *sight);
STARG_DROP(verify_sight, verify_sight)

/* Computes what p, which must lie off the surface, sees. Vertices out of view and isolated vertices
 * count as not seen. On success `vertices` and `patches` point to a byte per element, 1 if seen,
 * valid until the next call. Errors: MEMORY (sets no detail: runs on any thread). */
starg_status verify_look(verify_sight *sight, const double p[3], const verify_view *view,
                         const uint8_t **vertices, const uint8_t **patches);

/* ---- the scene of a guards result as the verifier sees it (space.c) ---- */

/* The surface of the model and of the obstacles of a result, which faces out of its free space; of
 * a plain solid verify_surface_create. `obstacles` has one mesh for each that the result names.
 * Errors: MESH, ARGUMENT (other obstacles than those of the result), MEMORY, CANCELLED. */
starg_status verify_space_create(starg_context *context, const starg_mesh *mesh,
                                 const starg_mesh *const *obstacles, size_t obstacle_count,
                                 const starg_guards *guards, verify_surface **out);
