/* SPDX-License-Identifier: Apache-2.0 */
/* Views from all over a solid: the histograms of [YL11, section 5.1], from very many points.
 *
 * Problem: positions and number of guards change with the pose and with tiny changes of the
 * surface. What is seen from points uniform in the volume of the pieces does not depend on the
 * cuts.
 *
 * Stages: points, equally many per share of the volume, in the order of the tetrahedra; from each,
 * the sorted distances to the boundary in a few directions, which rotations change little; for each
 * rank, its distribution over the points.
 *
 * Invariants: a point depends only on the seed and its number. Cost: POINTS x DIRECTIONS rays. */
#include "shape/measures.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/vec3.h"

static const char STAGE[] = "views";

enum {
    POINTS = 1024,
    DIRECTIONS = 24,
    VIEW = STARG_DESCRIPTOR_VIEW,
    SPREAD = STARG_DESCRIPTOR_SPREAD
};

typedef struct viewer {
    const starg_tetmesh *mesh;
    const ray_caster *caster;
    const double *volumes; /* cumulative volumes of the tetrahedra */
    uint64_t seed;
    double *ranks; /* VIEW x POINTS */
} viewer;

static int compare_reals(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static starg_status sum_volumes(starg_context *context, const starg_tetmesh *mesh, double scale,
                                double **out) {
    double sum = 0;
    NEW(context, STAGE, *out, mesh->count);
    for (size_t t = 0; t < mesh->count; t++) {
        const double *p[4];
        double e[3][3], normal[3];
        for (size_t c = 0; c < 4; c++)
            p[c] = mesh->vertices + 3 * (size_t)mesh->tetrahedra[4 * t + c];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                e[c][k] = (p[c + 1][k] - p[0][k]) * scale;
        vec3_cross(e[0], e[1], normal);
        sum += fmax(0, vec3_dot(normal, e[2]));
        (*out)[t] = sum;
    }
    return STARG_OK;
}

/* The first tetrahedron whose cumulative volume exceeds `volume`. */
static size_t find_tetrahedron(const viewer *v, double volume) {
    size_t low = 0, high = v->mesh->count - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (v->volumes[middle] > volume)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Uniform in its share of the volume: barycentric weights from exponential numbers. */
static void choose_point(const viewer *v, size_t item, double out[3]) {
    starg_rng rng = starg_rng_make(v->seed, STREAM_VIEWS, item);
    double all = v->volumes[v->mesh->count - 1], weights[4], sum = 0;
    size_t t = find_tetrahedron(v, ((double)item + starg_rng_unit(&rng)) / POINTS * all);
    for (int c = 0; c < 4; c++)
        sum += weights[c] = 0x1p-40 - log(1 - starg_rng_unit(&rng)); /* strictly inside */
    for (int k = 0; k < 3; k++)
        out[k] = 0;
    for (size_t c = 0; c < 4; c++)
        vec3_along(out, weights[c] / sum,
                   v->mesh->vertices + 3 * (size_t)v->mesh->tetrahedra[4 * t + c], out);
}

static starg_status look(starg_context *context, void *shared, void *scratch, size_t item) {
    const viewer *v = shared;
    double from[3], direction[3], distances[DIRECTIONS];
    (void)context, (void)scratch;
    choose_point(v, item, from);
    for (size_t i = 0; i < DIRECTIONS; i++) {
        starg_descriptor_direction(DIRECTIONS, i, direction);
        distances[i] = ray_length(v->caster, from, direction);
    }
    qsort(distances, DIRECTIONS, sizeof *distances, compare_reals);
    for (size_t k = 0; k < VIEW; k++)
        v->ranks[k * POINTS + item] = distances[(2 * k + 1) * DIRECTIONS / (2 * VIEW)];
    return STARG_OK;
}

starg_status views_measure(starg_context *context, const starg_tetmesh *mesh,
                           const ray_caster *caster, double *out) {
    starg_status status = STARG_OK;
    double *volumes = NULL;
    viewer v = {.mesh = mesh, .caster = caster, .seed = context->seed};
    STARG_TRY(sum_volumes(context, mesh, caster->scale, &volumes));
    v.volumes = volumes;
    STARG_NEW(context, STAGE, v.ranks, VIEW * POINTS);
    const starg_parallel_loop loop = {.stage = STAGE, .count = POINTS, .shared = &v, .item = look};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t k = 0; k < VIEW; k++) {
        double *row = v.ranks + k * POINTS;
        qsort(row, POINTS, sizeof *row, compare_reals);
        for (size_t i = 0; i < SPREAD; i++)
            out[k * SPREAD + i] = row[(2 * i + 1) * POINTS / (2 * SPREAD)];
    }
done:
    RELEASE(volumes, v.ranks);
    return status;
}
