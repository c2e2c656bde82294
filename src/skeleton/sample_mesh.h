/* SPDX-License-Identifier: Apache-2.0 */
/* The samples of a surface as a mesh that moves: halfedges, with what a sample carries besides. */
#ifndef STARG_SKELETON_SAMPLE_MESH_H
#define STARG_SKELETON_SAMPLE_MESH_H

#include "mesh/halfedges.h"
#include "skeleton/samples.h"

typedef struct sample_mesh {
    starg_context *context;
    mesh_halfedges net;
    STARG_ARRAY(double) points; /* x, y, z, one after the other */
    STARG_ARRAY(uint8_t) depth; /* of each point: how often what it lies on was cut     */
    STARG_ARRAY(bool) dirty;    /* of each point: have faces there changed?             */
} sample_mesh;

static inline size_t sample_mesh_points(const sample_mesh *m) {
    return m->points.count / 3;
}

static inline const double *sample_mesh_at(const sample_mesh *m, uint32_t v) {
    return m->points.data + 3 * (size_t)v;
}

/* Takes the samples over; all points are dirty. Errors: MEMORY. */
starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m);
/* Hands the points and faces out. */
void sample_mesh_give(sample_mesh *m, surface_samples *samples);
/* `copy` is empty or freed. Errors: MEMORY. */
starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy);
void sample_mesh_free(sample_mesh *m);

/* As halfedges_flip. */
void sample_mesh_flip(sample_mesh *m, uint32_t h);
/* Puts a point on an edge, or into a face, unless what it lies on was cut a dozen times before.
 * Errors: MEMORY. */
starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]);
starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]);

/* The greatest depth of a face's corners. */
uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f);

#endif
