/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates for guards that are bound to faces: hung up at a distance from some, or standing above
 * some.
 *
 * Stages: places on the faces, as many for equal areas (every so much area one, at points of a
 * low-discrepancy sequence); from each, a step along the normal, to either side, or up. Those where
 * no guard may stand are dropped, and if too many are, there are more places, a few times.
 *
 * Cost: O(faces) and a few questions for each candidate. */
#include <math.h>

#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "visibility/scene.h"

enum { ROUNDS = 4 };

/* The part of x behind the point. */
static double fraction_of(double x) {
    return x - floor(x);
}

/* Point i of a plane sequence in the triangle. */
static void place_on(const double *const t[3], size_t i, double out[3]) {
    double u = fraction_of(0.5 + 0.7548776662466927 * (double)i);
    double v = fraction_of(0.5 + 0.5698402909980532 * (double)i);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    for (int k = 0; k < 3; k++)
        out[k] = t[0][k] + u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k]);
}

static starg_status push_if_allowed(starg_context *context, const candidate_shape *shape,
                                    const double from[3], double step, const double direction[3],
                                    candidate_points *points) {
    double p[3];
    vec3_along(from, step, direction, p);
    return candidates_allowed(shape->solid, p, shape->clearance)
               ? candidates_push(context, points, p, NULL)
               : STARG_OK;
}

/* Between the clearance and the largest distance, to either side. */
static starg_status hang(starg_context *context, const candidate_shape *shape,
                         const double *const t[3], const double at[3], candidate_points *points) {
    double normal[3];
    double step = 0.5 * (shape->clearance + shape->solid->space.mount_distance);
    vec3_triangle_normal(t[0], t[1], t[2], normal);
    double length = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        normal[k] /= length;
    TRY(push_if_allowed(context, shape, at, step, normal, points));
    return push_if_allowed(context, shape, at, -step, normal, points);
}

/* In the upper part of the height, from where more is seen. */
static starg_status stand(starg_context *context, const candidate_shape *shape, size_t i,
                          const double at[3], candidate_points *points) {
    double up[3], share = 1 - 0.5 * fraction_of(0.25 + 0.6180339887498949 * (double)i);
    near_faces_up(&shape->solid->space, up);
    return push_if_allowed(context, shape, at, share * shape->solid->space.height, up, points);
}

static starg_status sample(starg_context *context, const candidate_shape *shape, size_t count,
                           candidate_points *points) {
    const starg_solid *solid = shape->solid;
    const near_faces *faces = solid->mount.count > 0 ? &solid->mount : &solid->over;
    double all = 0, passed = 0;
    size_t index = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t f = 0; f < faces->count; f++) {
            const double *t[3];
            for (size_t k = 0; k < 3; k++)
                t[k] = faces->tree->vertices + 3 * (size_t)faces->corners[3 * f + k];
            double area = vec3_triangle_area(t[0], t[1], t[2]);
            (pass == 0) ? (all += area) : (passed += area);
            while (pass == 1 && area > 0 && index < count &&
                   ((double)index + 0.5) * all <= passed * (double)count) {
                double at[3];
                place_on(t, index, at);
                TRY(solid->mount.count > 0 ? hang(context, shape, t, at, points)
                                           : stand(context, shape, index, at, points));
                index++;
            }
            if (f % 1024 == 0)
                TRY(starg_check_cancel(context, "candidates"));
        }
    return STARG_OK;
}

/* The nearest place, on either side where guards hang. */
static starg_status stand_before(starg_context *context, const candidate_shape *shape,
                                 uint32_t patch, size_t index, candidate_points *out) {
    const starg_solid *solid = shape->solid;
    const near_faces *bound = solid->mount.count > 0 ? &solid->mount : &solid->over;
    const double *t[3];
    double middle[3] = {0}, at[3];
    for (size_t k = 0; k < 3; k++)
        vec3_along(middle, 1.0 / 3, solid_patch_corner(solid, patch, k), middle);
    uint32_t nearest = bvh_nearest_triangle(bound->tree, middle);
    bvh_nearest(bound->tree, middle, at);
    for (size_t k = 0; k < 3; k++)
        t[k] = bound->tree->vertices + 3 * (size_t)bound->corners[3 * nearest + k];
    out->data.count = 0;
    return solid->mount.count > 0 ? hang(context, shape, t, at, out)
                                  : stand(context, shape, index, at, out);
}

starg_status near_candidates_before(starg_context *context, const candidate_shape *shape,
                                    const starg_visibility_options *view, const uint32_t *patches,
                                    size_t count, candidate_points *points) {
    const starg_visibility_options around = sensor_around(view);
    SCOPED_BY(candidates_free) candidate_points found = {0};
    SCOPED_BY(scene_drop) visibility_scene *scene = NULL;
    if (count == 0 || (shape->solid->mount.count == 0 && shape->solid->over.count == 0))
        return STARG_OK;
    TRY(scene_create(context, shape->solid, &scene));
    TRY(scene_add_sights(scene));
    for (size_t i = 0; i < count; i++) {
        TRY(stand_before(context, shape, patches[i], i, &found));
        for (const double *p = found.data.data; p < found.data.data + found.data.count; p += 3)
            if (scene_sees_patch(scene, p, patches[i], &around))
                TRY(candidates_push(context, points, p, NULL));
    }
    return STARG_OK;
}

starg_status near_candidates(starg_context *context, const candidate_shape *shape, size_t wanted,
                             candidate_points *points) {
    size_t count = wanted;
    for (int round = 0; round < ROUNDS; round++, count *= 3) {
        points->data.count = 0;
        TRY(sample(context, shape, count, points));
        if (10 * candidates_count(points) >= 5 * wanted)
            break;
    }
    return STARG_OK;
}
