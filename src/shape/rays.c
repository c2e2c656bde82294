/* SPDX-License-Identifier: Apache-2.0 */
/* Rays inside a solid.
 *
 * Which boundary triangles a ray meets is decided exactly, so no ray passes between two of them;
 * only the length is rounded. Cost: O(log n) per ray. */
#include "shape/measures.h"

#include "geometry/intersect.h"
#include "geometry/vec3.h"

enum { FIRST_STEP = -5, LAST_STEP = 1 }; /* powers of two of the length */

typedef struct ray {
    const ray_caster *caster;
    const double *from;
    double to[3], direction[3];
    double nearest; /* of the boundary met so far */
} ray;

/* Distance along the ray to a triangle that it meets. If the ray lies in its plane, its nearest
 * corner is used. */
static double reach(const ray *r, const double *const corner[3]) {
    double p[3][3], normal[3], least = INFINITY;
    for (int c = 0; c < 3; c++) {
        vec3_subtract(corner[c], r->from, p[c]);
        for (int k = 0; k < 3; k++)
            p[c][k] *= r->caster->scale;
        least = fmin(least, vec3_dot(p[c], r->direction));
    }
    vec3_triangle_normal(p[0], p[1], p[2], normal);
    double along = vec3_dot(normal, r->direction), t = vec3_dot(normal, p[0]) / along;
    return fmax(0, isfinite(t) && t > least ? t : least) / r->caster->scale;
}

static bool meet(void *user, size_t rank) {
    ray *r = user;
    const bvh *tree = r->caster->sight.tree;
    const uint32_t *face = tree->faces + 3 * (size_t)tree->order[rank];
    const double *corner[3];
    for (int k = 0; k < 3; k++)
        corner[k] = tree->vertices + 3 * (size_t)face[k];
    if (segment_meets_triangle(r->from, r->to, corner[0], corner[1], corner[2]))
        r->nearest = fmin(r->nearest, reach(r, corner));
    return true;
}

starg_status ray_caster_create(starg_context *context, const starg_tetmesh *mesh, ray_caster *out) {
    *out = (ray_caster){.scale = ldexp(1, -tetmesh_exponent(mesh))};
    starg_status status = tet_sight_create(context, mesh, &out->sight);
    if (status == STARG_OK) {
        const bvh_box *box = &out->sight.tree->nodes[0].box;
        out->length = vec3_distance(box->lower, box->upper);
    }
    return status;
}

void ray_caster_free(ray_caster *caster) {
    tet_sight_free(&caster->sight);
}

/* The boundary is usually near: tries short segments first. */
double ray_length(const ray_caster *caster, const double from[3], const double direction[3]) {
    ray r = {.caster = caster, .from = from, .nearest = INFINITY};
    vec3_copy(direction, r.direction);
    for (int step = FIRST_STEP; step <= LAST_STEP && r.nearest > caster->length; step++) {
        vec3_along(from, ldexp(caster->length, step), direction, r.to);
        bvh_query_segment(caster->sight.tree, from, r.to, meet, &r);
    }
    return fmin(r.nearest, caster->length);
}
