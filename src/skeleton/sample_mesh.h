/* The samples of a surface as a mesh that moves: edges turn, edges and faces are split. It stays a
 * closed manifold of the same topology. */
#ifndef STARG_SKELETON_SAMPLE_MESH_H
#define STARG_SKELETON_SAMPLE_MESH_H

#include "core/memory.h"
#include "mesh/topology.h"
#include "skeleton/samples.h"

/* A halfedge is named by its corner; none is NULL or TOPOLOGY_NONE but `leaving` of lone points. */
typedef struct sample_mesh {
    starg_context *context;
    STARG_ARRAY(double) points; /* x, y, z, one after the other */
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(uint32_t) twins;   /* of each halfedge                                     */
    STARG_ARRAY(uint32_t) leaving; /* of each point: a halfedge that leaves it             */
    STARG_ARRAY(uint8_t) depth;    /* of each point: how often what it lies on was cut     */
    STARG_ARRAY(bool) dirty;       /* of each point: have faces there changed?             */
} sample_mesh;

static inline size_t sample_mesh_points(const sample_mesh *m) {
    return m->points.count / 3;
}

static inline const double *sample_mesh_at(const sample_mesh *m, uint32_t v) {
    return m->points.data + 3 * (size_t)v;
}

static inline uint32_t sample_mesh_tail(const sample_mesh *m, uint32_t h) {
    return m->faces.data[h];
}

static inline uint32_t sample_mesh_head(const sample_mesh *m, uint32_t h) {
    return m->faces.data[corner_next(h)];
}

static inline uint32_t sample_mesh_apex(const sample_mesh *m, uint32_t h) {
    return m->faces.data[corner_previous(h)];
}

/* Takes the samples over; all points are dirty. Errors: MEMORY. */
starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m);
/* Hands the points and faces out. */
void sample_mesh_give(sample_mesh *m, surface_samples *samples);
/* `copy` is empty or freed. Errors: MEMORY. */
starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy);
void sample_mesh_free(sample_mesh *m);

/* Faces u v w and v u x, with h from u to v, become w u x and x v w; w x must be no edge. */
void sample_mesh_flip(sample_mesh *m, uint32_t h);
/* Puts a point on an edge, or into a face, unless what it lies on was cut a dozen times before.
 * Errors: MEMORY. */
starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]);
starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]);

/* The greatest depth of a face's corners. */
uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f);
/* The halfedge from v to w, or TOPOLOGY_NONE. */
uint32_t sample_mesh_halfedge(const sample_mesh *m, uint32_t v, uint32_t w);

#endif
