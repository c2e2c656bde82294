/* SPDX-License-Identifier: Apache-2.0 */
/* Point location on the sphere by walking.
 *
 * From a face the walk crosses an edge that separates it from the direction. On non-Delaunay
 * triangulations such a walk can cycle; edges are tried from a corner chosen by a hash of the step,
 * and after as many steps as there are faces all faces are tried in turn. The cones of the faces
 * cover all directions, and all signs are exact: one is always found. */
#include "morph/surface_map.h"

#include "core/rng.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const double ORIGIN[3];

starg_status locator_create(starg_context *context, const sphere *s, locator *out) {
    *out = (locator){.sphere = s};
    return topology_create(context, s->mesh, &out->topology);
}

void locator_free(locator *l) {
    topology_free(l->topology);
}

static const double *direction_of(const locator *l, uint32_t halfedge) {
    return l->sphere->directions + 3 * (size_t)l->sphere->mesh->faces[halfedge];
}

/* A halfedge that has x strictly on its outer side; TOPOLOGY_NONE if the face contains x. */
static uint32_t way_out(const locator *l, uint32_t face, const double x[3], uint64_t step) {
    uint32_t turn = (uint32_t)(starg_hash64(step) % 3);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t h = 3 * face + (k + turn) % 3;
        if (orient3d(direction_of(l, h), direction_of(l, corner_next(h)), x, ORIGIN) < 0)
            return h;
    }
    return TOPOLOGY_NONE;
}

static uint32_t find_face(const locator *l, const double x[3], uint32_t face) {
    size_t count = l->sphere->mesh->face_count;
    for (size_t step = 0; step < count; step++) {
        uint32_t h = way_out(l, face, x, step);
        if (h == TOPOLOGY_NONE)
            return face;
        face = l->topology->twin[h] / 3;
    }
    for (uint32_t f = 0; f < count; f++)
        if (way_out(l, f, x, 0) == TOPOLOGY_NONE)
            return f;
    return face;
}

uint32_t locate(const locator *l, const double x[3], uint32_t start, double coordinates[3]) {
    uint32_t face = find_face(l, x, start);
    double sum = 0;
    for (uint32_t k = 0; k < 3; k++) {
        double w = vec3_triple(x, direction_of(l, 3 * face + (k + 1) % 3),
                               direction_of(l, 3 * face + (k + 2) % 3));
        coordinates[k] = w > 0 ? w : 0;
        sum += coordinates[k];
    }
    for (int k = 0; k < 3; k++)
        coordinates[k] = sum > 0 ? coordinates[k] / sum : 1.0 / 3;
    return face;
}
