/* SPDX-License-Identifier: Apache-2.0 */
/* Distance between two surfaces. A triangle is bisected at its longest edge until no edge is longer
 * than the step, and the distance is measured at that edge's midpoint: every point of a part is
 * closer than the step to it, and the distance to a surface changes no faster than the point moves.
 * For the same reason, parts that cannot exceed the largest distance so far are skipped.
 *
 * Invariant: skipped parts do not exceed the result, so it does not depend on the order of the
 * threads. Cost: look-ups of O(log n), in the number of parts of about the size of the largest
 * distance, at most area / step^2. */

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "tetra/generate.h"

static const char STAGE[] = TETRA_STAGE;

enum { DEEPEST = 40 };

typedef struct survey {
    const starg_mesh *from;
    const bvh *to;
    double step;
    _Atomic double greatest; /* so far */
} survey;

static void raise(survey *s, double distance) {
    double before = atomic_load(&s->greatest);
    while (distance > before && !atomic_compare_exchange_weak(&s->greatest, &before, distance))
        continue;
}

static void look_at(survey *s, const double a[3], const double b[3], const double c[3], int depth) {
    double ab = vec3_distance(a, b), bc = vec3_distance(b, c), ca = vec3_distance(c, a);
    if (bc > ab && bc >= ca) {
        look_at(s, b, c, a, depth);
        return;
    }
    if (ca > ab && ca > bc) {
        look_at(s, c, a, b, depth);
        return;
    }
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * a[k] + 0.5 * b[k];
    double here = bvh_distance(s->to, middle);
    raise(s, here);
    double reach = fmax(0.5 * ab, vec3_distance(middle, c));
    if (ab <= s->step || depth == DEEPEST || here + reach <= atomic_load(&s->greatest))
        return;
    look_at(s, a, middle, c, depth + 1);
    look_at(s, middle, b, c, depth + 1);
}

static starg_status survey_face(starg_context *context, void *shared, void *scratch, size_t face) {
    survey *s = shared;
    const double *p[3];
    (void)context;
    (void)scratch;
    for (size_t k = 0; k < 3; k++)
        p[k] = s->from->vertices + 3 * (size_t)s->from->faces[3 * face + k];
    look_at(s, p[0], p[1], p[2], 0);
    return STARG_OK;
}

static starg_status measure_one_way(starg_context *context, const starg_mesh *from, const bvh *to,
                                    double step, double *out) {
    survey s = {.from = from, .to = to, .step = step};
    starg_parallel_loop loop = {
        .stage = STAGE, .count = from->face_count, .shared = &s, .item = survey_face};
    starg_status status = starg_parallel_for(context, &loop);
    *out = atomic_load(&s.greatest);
    return status;
}

starg_status tetra_measure(starg_context *context, const tetra_shape *shape,
                           const starg_tetmesh *mesh, double step, double *to_surface,
                           double *from_surface) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *boundary = NULL;
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    TRY(starg_tetmesh_surface(context, mesh, &boundary, NULL));
    TRY(bvh_create(context, boundary->vertices, boundary->faces, boundary->face_count, &tree));
    TRY(measure_one_way(context, boundary, shape->tree, step, to_surface));
    return measure_one_way(context, shape->mesh, tree, step, from_surface);
}
