/* SPDX-License-Identifier: Apache-2.0 */
/* D2 shape distribution [OFCD02]: distances between random points of the surface.
 *
 * Stages: running sums of the face areas, with a guide table [CA74]; points, uniform in area; the
 * distances of each to the next 16, relative to the mean distance; a histogram of equal bins,
 * normalized to sum 1. Pairs that share a point are not independent, but nearly: the histogram
 * varies as if there were four fifths as many pairs of points of their own.
 *
 * Point i depends only on the seed and i, so the numbers are the same for any thread count;
 * distances are summed in order. Distances beyond the last bin count in it (between points of a
 * segment none exceeds three times the mean; only surfaces concentrated mostly in one place have
 * some).
 *
 * Histograms are compared by the L1 norm of their difference, from 0 to 2.
 *
 * Cost: 2^16 points, each with a search, short unless areas differ a lot, and 2^20 distances.
 *
 * [CA74] Chen, Asau: On generating random variates from an empirical distribution, AIIE
 * Transactions 6, 1974. */

#include "core/parallel.h"
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/vec3.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "d2";

enum {
    BINS = 64,
    POINTS = 1 << 16,
    PARTNERS = 16, /* of a point */
    PAIRS = POINTS * PARTNERS,
    CHUNK = 256, /* points */
    GUIDES = 1 << 15
};
static const double LAST = 3; /* upper end of the histogram, in mean distances */

typedef struct sampler {
    const starg_mesh *mesh;
    uint64_t seed;
    double extent;   /* unit of length, to avoid underflow of squares */
    double *sums;    /* cumulative face areas */
    uint32_t *guide; /* first face beyond i of GUIDES equal parts of the last */
    double *points;
    double *distances; /* of the pairs */
} sampler;

static const double *corner(const sampler *s, size_t face, size_t k) {
    return starg_mesh_vertices(s->mesh) + 3 * (size_t)starg_mesh_faces(s->mesh)[3 * face + k];
}

/* From p to q, relative to the extent. */
static void way(const sampler *s, const double p[3], const double q[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (q[k] - p[k]) / s->extent;
}

static double area(const sampler *s, size_t face) {
    double u[3], v[3], normal[3];
    way(s, corner(s, face, 0), corner(s, face, 1), u);
    way(s, corner(s, face, 0), corner(s, face, 2), v);
    vec3_cross(u, v, normal);
    return 0.5 * sqrt(vec3_dot(normal, normal));
}

static starg_status sum_areas(starg_context *context, sampler *s) {
    size_t count = starg_mesh_face_count(s->mesh);
    double lower[3], upper[3], sum = 0;
    starg_mesh_bounds(s->mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        s->extent = fmax(s->extent, upper[k] - lower[k]);
    NEW(context, STAGE, s->sums, count);
    for (size_t i = 0; s->extent > 0 && i < count; i++)
        s->sums[i] = sum += area(s, i);
    if (!(sum > 0))
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the mesh has no area");
    return STARG_OK;
}

static starg_status make_guide(starg_context *context, sampler *s) {
    size_t last = starg_mesh_face_count(s->mesh) - 1;
    NEW(context, STAGE, s->guide, GUIDES + 1);
    for (size_t i = 0, face = 0; i <= GUIDES; i++) {
        while (face < last && s->sums[face] <= s->sums[last] * ((double)i / GUIDES))
            face++;
        s->guide[i] = (uint32_t)face;
    }
    return STARG_OK;
}

/* The first face whose sum exceeds a part, below 1, of the last sum; so the face has an area. */
static size_t find_face(const sampler *s, double part) {
    size_t guide = (size_t)(part * GUIDES), low = s->guide[guide], high = s->guide[guide + 1];
    double goal = part * s->sums[starg_mesh_face_count(s->mesh) - 1];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (s->sums[middle] > goal)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* The square root makes the points uniform. */
static void random_point(const sampler *s, starg_rng *rng, double out[3]) {
    size_t face = find_face(s, starg_rng_unit(rng));
    double far = sqrt(starg_rng_unit(rng)), along = starg_rng_unit(rng);
    const double *a = corner(s, face, 0), *b = corner(s, face, 1), *c = corner(s, face, 2);
    for (int k = 0; k < 3; k++)
        out[k] = (1 - far) * a[k] + far * ((1 - along) * b[k] + along * c[k]);
}

static starg_status choose_points(starg_context *context, void *shared, void *scratch,
                                  size_t chunk) {
    const sampler *s = shared;
    (void)context, (void)scratch;
    for (size_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK; i++) {
        starg_rng rng = starg_rng_make(s->seed, STREAM_D2, i);
        random_point(s, &rng, s->points + 3 * i);
    }
    return STARG_OK;
}

static starg_status measure_pairs(starg_context *context, void *shared, void *scratch,
                                  size_t chunk) {
    const sampler *s = shared;
    (void)context, (void)scratch;
    for (size_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK; i++)
        for (size_t k = 0; k < PARTNERS; k++) {
            double d[3];
            way(s, s->points + 3 * i, s->points + 3 * ((i + k + 1) % POINTS), d);
            s->distances[i * PARTNERS + k] = sqrt(vec3_dot(d, d));
        }
    return STARG_OK;
}

static void count_bins(const sampler *s, double *bins) {
    double mean = 0;
    for (size_t i = 0; i < PAIRS; i++)
        mean += s->distances[i] / PAIRS;
    memset(bins, 0, BINS * sizeof *bins);
    for (size_t i = 0; i < PAIRS; i++) {
        double place = s->distances[i] / mean * (BINS / LAST);
        bins[place < BINS - 1 ? (size_t)place : BINS - 1] += 1.0 / PAIRS;
    }
}

static starg_status compute(starg_context *context, const starg_mesh *mesh, double **numbers,
                            size_t *count) {
    starg_status status = STARG_OK;
    double *bins = NULL;
    sampler s = {.mesh = mesh, .seed = context->seed};
    STARG_TRY(sum_areas(context, &s));
    STARG_TRY(make_guide(context, &s));
    STARG_NEW(context, STAGE, s.points, 3 * POINTS);
    STARG_NEW(context, STAGE, s.distances, PAIRS);
    STARG_NEW(context, STAGE, bins, BINS);
    starg_parallel_loop loop = {
        .stage = STAGE, .count = POINTS / CHUNK, .shared = &s, .item = choose_points};
    STARG_TRY(starg_parallel_for(context, &loop));
    loop.item = measure_pairs;
    STARG_TRY(starg_parallel_for(context, &loop));
    count_bins(&s, bins);
    *numbers = bins;
    *count = BINS;
done:
    RELEASE(s.sums, s.guide, s.points, s.distances);
    if (status != STARG_OK)
        starg_release(context, bins);
    return status;
}

static bool check(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(numbers[i] >= 0 && numbers[i] <= 1))
            return false;
    return count == BINS;
}

static void weigh(const double *numbers, double *out) {
    memcpy(out, numbers, BINS * sizeof *out);
}

const signature_method signature_d2 = {.name = "d2",
                                       .version = 2,
                                       .compute = compute,
                                       .check = check,
                                       .weigh = weigh,
                                       .count = BINS,
                                       .run = 2};
