/* SPDX-License-Identifier: Apache-2.0 */
/* Samples under the moves of mesh/halfedges.h.
 *
 * Invariants: every point has a depth, which grows by one per cut, up to MAX_DEPTH; points whose
 * faces change become dirty. */
#include "skeleton/skeleton.h"

static const char STAGE[] = "surface samples";

enum { MAX_DEPTH = 12 };

static starg_status add_point(sample_mesh *m, const double p[3], uint8_t depth) {
    for (int k = 0; k < 3; k++)
        PUSH(m->context, STAGE, &m->points, p[k]);
    PUSH(m->context, STAGE, &m->depth, depth);
    PUSH(m->context, STAGE, &m->dirty, true);
    return STARG_OK;
}

starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    const starg_mesh mesh = {.context = context,
                             .vertex_count = samples->point_count,
                             .face_count = samples->face_count,
                             .vertices = samples->points,
                             .faces = samples->faces};
    SCOPED uint32_t *faces = samples->faces;
    *m = (sample_mesh){.context = context};
    m->points.data = samples->points;
    m->points.count = m->points.capacity = 3 * samples->point_count;
    *samples = (surface_samples){0};
    TRY(wings_create(context, &mesh, &topology));
    TRY(halfedges_create(topology, &mesh, STAGE, &m->net));
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        PUSH(context, STAGE, &m->depth, 0);
        PUSH(context, STAGE, &m->dirty, true);
    }
    return STARG_OK;
}

void sample_mesh_give(sample_mesh *m, surface_samples *samples) {
    *samples = (surface_samples){.point_count = sample_mesh_points(m),
                                 .face_count = m->net.corners.count / 3,
                                 .points = m->points.data,
                                 .faces = m->net.corners.data};
    m->points.data = NULL;
    m->net.corners.data = NULL;
    sample_mesh_free(m);
}

starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy) {
    *copy = (sample_mesh){.context = m->context};
    TRY(halfedges_copy(&m->net, &copy->net));
    for (uint32_t v = 0; v < sample_mesh_points(m); v++) {
        TRY(add_point(copy, sample_mesh_at(m, v), m->depth.data[v]));
        copy->dirty.data[v] = m->dirty.data[v];
    }
    return STARG_OK;
}

void sample_mesh_free(sample_mesh *m) {
    RELEASE(m->points.data, m->depth.data, m->dirty.data);
    halfedges_free(&m->net);
    *m = (sample_mesh){0};
}

static void mark_face(sample_mesh *m, uint32_t f) {
    for (size_t k = 0; k < 3; k++)
        m->dirty.data[m->net.corners.data[3 * (size_t)f + k]] = true;
}

void sample_mesh_flip(sample_mesh *m, uint32_t h) {
    mark_face(m, h / 3);
    mark_face(m, halfedges_twin(&m->net, h) / 3);
    halfedges_flip(&m->net, h);
}

static uint8_t max_depth(uint8_t a, uint8_t b) {
    return a > b ? a : b;
}

starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]) {
    uint32_t p;
    uint8_t depth = max_depth(m->depth.data[halfedges_start(&m->net, h)],
                              m->depth.data[halfedges_end(&m->net, h)]);
    if (depth == MAX_DEPTH)
        return STARG_OK;
    mark_face(m, h / 3);
    mark_face(m, halfedges_twin(&m->net, h) / 3);
    TRY(add_point(m, place, depth + 1));
    return halfedges_split_edge(&m->net, h, &p);
}

uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f) {
    const uint32_t *v = m->net.corners.data + 3 * (size_t)f;
    return max_depth(max_depth(m->depth.data[v[0]], m->depth.data[v[1]]), m->depth.data[v[2]]);
}

starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]) {
    uint32_t p;
    uint8_t depth = sample_mesh_depth(m, f);
    if (depth == MAX_DEPTH)
        return STARG_OK;
    mark_face(m, f);
    TRY(add_point(m, place, depth + 1));
    return halfedges_split_face(&m->net, f, &p);
}
