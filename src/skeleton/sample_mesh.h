/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of a surface as a changing mesh: halfedges with the attributes of samples. */
#pragma once

#include "mesh/halfedges.h"
#include "skeleton/samples.h"

typedef struct sample_mesh {
    starg_context *context;
    mesh_halfedges net;
    STARG_ARRAY(double) points; /* x, y, z of each */
    STARG_ARRAY(uint8_t) depth; /* per point: how often its edge or face was cut */
    STARG_ARRAY(bool) dirty;    /* per point: have its faces changed? */
} sample_mesh;

static inline size_t sample_mesh_points(const sample_mesh *m) {
    return m->points.count / 3;
}

static inline const double *sample_mesh_at(const sample_mesh *m, uint32_t v) {
    return m->points.data + 3 * (size_t)v;
}

/* Takes ownership of the samples; all points are dirty. Errors: MEMORY. */
starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m);
/* Returns the points and faces. */
void sample_mesh_give(sample_mesh *m, surface_samples *samples);
/* `copy` must be empty or freed. Errors: MEMORY. */
starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy);
void sample_mesh_free(sample_mesh *m);

/* As halfedges_flip. */
void sample_mesh_flip(sample_mesh *m, uint32_t h);
/* Inserts a point into an edge or a face, unless that was cut MAX_DEPTH times before. Errors:
 * MEMORY. */
starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]);
starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]);

/* The greatest depth of a face's corners. */
uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f);
