/* SPDX-License-Identifier: Apache-2.0 */
/* Measures how completely a descriptor represents the shape. According to [YL11, section 5.1]:
 * completely.
 *
 * Stages: the boundary points that it contains; their distances to the model's surface; random
 * points of the surface, uniform in area, and their distances to the nearest of these points.
 *
 * The first distances are rounding errors if the tetrahedra keep the model's surface, otherwise
 * their distance from it. The second ones show the sampling density of the guards: they fall as the
 * number of directions grows, and stay large where no guard is close.
 *
 * Cost: O(log n) per point and sample. */

#include "core/parallel.h"
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/bvh.h"
#include "geometry/kd_tree.h"
#include "geometry/vec3.h"
#include "starguard/descriptor.h"

static const char STAGE[] = "reconstruct";

enum { SAMPLES = 16384, CHUNK = 256 };

starg_status starg_descriptor_points(starg_context *context, const starg_descriptor *d,
                                     double **out) {
    size_t width = d->direction_count;
    double *points = NULL;
    *out = NULL;
    NEW(context, STAGE, points, 3 * d->guard_count * width);
    for (size_t i = 0; i < width; i++) {
        double direction[3];
        starg_descriptor_direction(width, i, direction);
        for (size_t g = 0; g < d->guard_count; g++)
            vec3_along(d->guards[g].position, d->distances[g * width + i], direction,
                       points + 3 * (g * width + i));
    }
    *out = points;
    return STARG_OK;
}

void starg_descriptor_points_free(starg_context *context, double *points) {
    (void)context;
    RELEASE(points);
}

typedef struct comparison {
    const starg_mesh *mesh;
    uint64_t seed;
    double *points;
    size_t count;
    bvh *surface;
    kd_tree tree;      /* of the points */
    double extent;     /* unit of length */
    double *sums;      /* cumulative face areas */
    double *to, *from; /* one distance per point; per sample */
} comparison;

static const double *corner(const comparison *c, size_t face, size_t k) {
    return starg_mesh_vertices(c->mesh) + 3 * (size_t)starg_mesh_faces(c->mesh)[3 * face + k];
}

static starg_status sum_areas(starg_context *context, comparison *c) {
    size_t count = starg_mesh_face_count(c->mesh);
    double lower[3], upper[3], sum = 0;
    starg_mesh_bounds(c->mesh, lower, upper);
    c->extent = vec3_distance(lower, upper);
    NEW(context, STAGE, c->sums, count);
    for (size_t f = 0; c->extent > 0 && f < count; f++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            for (size_t a = 0; a < 3; a++)
                p[k][a] = (corner(c, f, k)[a] - lower[a]) / c->extent;
        c->sums[f] = sum += vec3_triangle_area(p[0], p[1], p[2]);
    }
    if (!(sum > 0))
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the mesh has no area");
    return STARG_OK;
}

/* The square root makes the points uniform. */
static void sample(const comparison *c, size_t index, double out[3]) {
    starg_rng rng = starg_rng_make(c->seed, STREAM_RECONSTRUCT, index);
    size_t low = 0, high = starg_mesh_face_count(c->mesh) - 1;
    double goal = c->sums[high] * starg_rng_unit(&rng);
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (c->sums[middle] > goal)
            high = middle;
        else
            low = middle + 1;
    }
    double far = sqrt(starg_rng_unit(&rng)), along = starg_rng_unit(&rng);
    for (int k = 0; k < 3; k++)
        out[k] = (1 - far) * corner(c, low, 0)[k] +
                 far * ((1 - along) * corner(c, low, 1)[k] + along * corner(c, low, 2)[k]);
}

static starg_status measure_chunk(starg_context *context, void *shared, void *scratch,
                                  size_t chunk) {
    const comparison *c = shared;
    size_t first = chunk * CHUNK, past = first + CHUNK;
    double p[3], squared;
    (void)context, (void)scratch;
    for (size_t i = first; i < past && i < c->count; i++)
        c->to[i] = bvh_distance(c->surface, c->points + 3 * i) / c->extent;
    for (size_t i = first; i < past && i < SAMPLES; i++) {
        sample(c, i, p);
        size_t nearest = kd_tree_nearest(&c->tree, p, &squared);
        c->from[i] = vec3_distance(p, c->points + 3 * nearest) / c->extent;
    }
    return STARG_OK;
}

static void summarise(const double *values, size_t count, double *mean, double *largest) {
    *mean = *largest = 0;
    for (size_t i = 0; i < count; i++) {
        *mean += values[i] / (double)count;
        *largest = fmax(*largest, values[i]);
    }
}

static starg_status measure(starg_context *context, comparison *c, starg_reconstruction *out) {
    size_t most = c->count > SAMPLES ? c->count : SAMPLES;
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = (most + CHUNK - 1) / CHUNK, .shared = c, .item = measure_chunk};
    NEW(context, STAGE, c->to, c->count);
    NEW(context, STAGE, c->from, SAMPLES);
    TRY(starg_parallel_for(context, &loop));
    *out = (starg_reconstruction){.points = c->count, .samples = SAMPLES};
    summarise(c->to, c->count, &out->to_mean, &out->to_largest);
    summarise(c->from, SAMPLES, &out->from_mean, &out->from_largest);
    return STARG_OK;
}

starg_status starg_descriptor_reconstruct(starg_context *context,
                                          const starg_descriptor *descriptor,
                                          const starg_mesh *mesh, starg_reconstruction *out) {
    starg_status status = STARG_OK;
    comparison c = {.mesh = mesh,
                    .seed = context->seed,
                    .count = descriptor->guard_count * descriptor->direction_count};
    *out = (starg_reconstruction){0};
    STARG_TRY(sum_areas(context, &c));
    STARG_TRY(starg_descriptor_points(context, descriptor, &c.points));
    STARG_TRY(bvh_create(context, starg_mesh_vertices(mesh), starg_mesh_faces(mesh),
                         starg_mesh_face_count(mesh), &c.surface));
    STARG_TRY(kd_tree_create(context, c.points, c.count, 3, &c.tree));
    STARG_TRY(measure(context, &c, out));
done:
    starg_release(context, c.points);
    bvh_free(c.surface);
    kd_tree_free(&c.tree);
    RELEASE(c.sums, c.to, c.from);
    return status;
}
