/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary of what a closed surface that intersects itself encloses. */
#pragma once

#include "mesh/mesh.h"

#define UNION_STAGE "union"

/* What a face of a union is. */
enum {
    UNION_PART = 1, /* part of a face of the mesh       */
    UNION_FRESH = 2 /* made in the last round           */
};

/* Triangles that bound something: around every point off them the winding number is defined.
 * Edges may have any number of them. */
typedef struct union_surface {
    starg_context *context;
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(uint32_t) origin; /* per face: the one of the mesh that it is (a part of) */
    STARG_ARRAY(uint8_t) flags;   /* per face                                             */
} union_surface;

static inline size_t union_face_count(const union_surface *surface) {
    return surface->origin.count;
}

static inline const double *union_corner(const union_surface *surface, uint32_t face, int k) {
    return surface->vertices.data + 3 * (size_t)surface->faces.data[3 * (size_t)face + (size_t)k];
}

typedef struct union_report {
    size_t pairs;          /* of faces that meet away from common corners, at the start    */
    size_t rounds;         /* of arrangement and rounding                                  */
    double moved;          /* how far a new point is at most from where exact points lie   */
    size_t contacts, grew; /* of the last round; how often there were more than before */
    bool chosen;           /* winding numbers have been counted                            */
    size_t most;           /* faces that a surface had in the first rounds, at most */
} union_report;

/* Makes the boundary of the region where the winding number of `mesh` is positive: a surface whose
 * faces meet in common corners and edges only. The mesh's vertices come first, some of them
 * unused; its faces that meet no others stay. Errors: MESH (rounding makes new intersections each
 * time), RANGE (the coordinates are too wide for exact points), MEMORY, CANCELLED, TIME. */
starg_status union_of_mesh(starg_context *context, const starg_mesh *mesh, double merge,
                           union_surface *out, union_report *report);

/* The faces of a mesh. Errors: MEMORY. */
starg_status union_surface_make(starg_context *context, const starg_mesh *mesh, union_surface *out);
void union_surface_free(union_surface *surface);
