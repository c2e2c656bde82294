/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier's model: a copy with oriented shells, and winding numbers. */
#ifndef STARG_VERIFY_SURFACE_H
#define STARG_VERIFY_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/context.h"
#include "starguard/mesh.h"

typedef struct verify_surface {
    starg_context *context;
    size_t vertex_count, face_count;
    const double *vertices;    /* of the mesh, which must outlive the surface, or own_vertices */
    uint32_t *faces;           /* counter-clockwise seen from outside of the solid */
    double lower[3], upper[3]; /* bounds of the vertices in use */

    /* of scenes (verify/space.h) */
    int ambient;                        /* the winding number far away */
    size_t model_vertices, model_faces; /* copies, and those of obstacles, follow */
    double *importance;                 /* by face: how much its area counts; NULL: 1 each */
    size_t backs; /* above 0: face f of the model counts from either side, and face backs + f is its
                     back */
    double *own_vertices; /* freed with the surface */
} verify_surface;

/* Is the face a target? */
static inline bool verify_is_target(const verify_surface *surface, size_t face) {
    return surface->importance == NULL || surface->importance[face] > 0;
}

/* Checks that every edge has as many faces in both directions (after welding coincident vertices if
 * necessary), gives vertices at which faces are not all connected across edges a copy for each
 * further group, and orients shells. Errors: MESH, MEMORY, CANCELLED. */
starg_status verify_surface_create(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out);
/* Same with all shells facing outward, also those of cavities, or as given. */
typedef enum verify_facing { VERIFY_NESTED, VERIFY_OUTWARD, VERIFY_AS_GIVEN } verify_facing;
starg_status verify_surface_facing(starg_context *context, const starg_mesh *mesh,
                                   verify_facing facing, verify_surface **out);
/* The faces of any mesh, with coincident vertices welded; without checks or reorientation. */
starg_status verify_surface_welded(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out);
/* Same for arbitrary triangles, unchanged and without checks. Takes ownership of `faces`, a block
 * of the context, also on failure. Errors: MEMORY. */
starg_status verify_surface_wrap(starg_context *context, const double *vertices,
                                 size_t vertex_count, uint32_t *faces, size_t face_count,
                                 verify_surface **out);
void verify_surface_free(verify_surface *surface);

/* By directed edge 3 f + k, from corner k of face f to the next: the opposite one. `surface` has
 * been checked. *twin is a block of the context. Errors: MEMORY. */
starg_status verify_find_twins(const verify_surface *surface, uint32_t **twin);

/* The corners of a face. */
static inline void verify_corners(const verify_surface *surface, size_t face, const double *t[3]) {
    for (size_t i = 0; i < 3; i++)
        t[i] = surface->vertices + 3 * (size_t)surface->faces[3 * face + i];
}

/* Winding number of `count` faces (NULL: all), which form a closed surface, about p; *on_surface: p
 * lies on one of them, and the number is undefined. Exact. */
int verify_winding(const verify_surface *surface, const uint32_t *faces, size_t count,
                   const double p[3], bool *on_surface);

#endif
