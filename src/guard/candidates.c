/* SPDX-License-Identifier: Apache-2.0 */
#include "guard/candidates.h"

#include <math.h>

#include "mesh/solid.h"
#include "skeleton/skeleton.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "candidates";

starg_status candidates_push_pose(starg_context *context, candidate_points *points,
                                  const double p[3], const double direction[3],
                                  const double up[3]) {
    for (int k = 0; k < 3; k++)
        PUSH(context, STAGE, &points->data, p[k]);
    for (int k = 0; k < 3 && direction != NULL; k++) {
        PUSH(context, STAGE, &points->directions, direction[k]);
        PUSH(context, STAGE, &points->ups, up != NULL ? up[k] : 0);
    }
    return STARG_OK;
}

starg_status candidates_push(starg_context *context, candidate_points *points, const double p[3],
                             const double direction[3]) {
    return candidates_push_pose(context, points, p, direction, NULL);
}

starg_status candidates_append(starg_context *context, const candidate_points *from,
                               candidate_points *out) {
    bool directed = from->directions.count > 0;
    for (size_t i = 0; i < candidates_count(from); i++)
        TRY(candidates_push_pose(context, out, from->data.data + 3 * i,
                                 directed ? from->directions.data + 3 * i : NULL,
                                 directed ? from->ups.data + 3 * i : NULL));
    return STARG_OK;
}

void candidates_free(candidate_points *points) {
    RELEASE(points->data.data);
    RELEASE(points->directions.data);
    RELEASE(points->ups.data);
    *points = (candidate_points){0};
}

bool candidates_allowed(const starg_solid *solid, const double p[3], double clearance) {
    return starg_space_admits(solid, p) &&
           (clearance <= 0 || starg_solid_distance(solid, p) >= clearance);
}

static starg_status medial_candidates(starg_context *context, const candidate_shape *shape,
                                      size_t wanted, candidate_points *points) {
    SCOPED medial_ball *balls = NULL;
    SCOPED double *scratch = NULL;
    size_t count = 0, chosen = 0;
    TRY(medial_balls(context, shape->proxy, shape->clearance, &balls, &count));
    NEW(context, STAGE, scratch, count);
    TRY(medial_thin(context, balls, count, wanted, scratch, &chosen));
    for (size_t i = 0; i < chosen; i++)
        if (candidates_allowed(shape->solid, balls[i].centre, shape->clearance))
            TRY(candidates_push(context, points, balls[i].centre, NULL));
    return STARG_OK;
}

static starg_status skeletal_candidates(starg_context *context, const candidate_shape *shape,
                                        size_t wanted, candidate_points *points) {
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *skeleton = NULL;
    starg_skeleton_options options;
    starg_skeleton_options_default(&options);
    options.node_count = wanted;
    options.prune = 1; /* short branches are places too */
    starg_status status = starg_skeleton_create(context, shape->proxy, &options, &skeleton);
    if (status == STARG_ERROR_MESH) {
        starg_log(context, STARG_LOG_NOTICE,
                  "no curve skeleton (%s): using candidates on the medial axis",
                  starg_context_error(context)->message);
        return medial_candidates(context, shape, wanted, points);
    }
    TRY(status);
    for (size_t i = 0; i < skeleton->node_count; i++)
        if (candidates_allowed(shape->solid, skeleton->positions + 3 * i, shape->clearance))
            TRY(candidates_push(context, points, skeleton->positions + 3 * i, NULL));
    return STARG_OK;
}

/* The approximate number of lattice points in the box. */
static double lattice_size(const double extent[3], double step) {
    double size = 2;
    for (int k = 0; k < 3; k++)
        size *= floor(extent[k] / step) + 1;
    return size;
}

/* Doubles the step until the lattice has at most `most` points: a solid may be so thin in its box
 * that very few of them are inside. */
static double coarse_enough(const starg_solid *solid, double step, double most) {
    double extent[3];
    bvh_box all;
    solid_reach(solid, &all);
    for (int k = 0; k < 3; k++)
        extent[k] = all.upper[k] - all.lower[k];
    step = fmax(step, 5e-324); /* where the volume underflows */
    while (!(lattice_size(extent, step) <= most))
        step *= 2;
    return step;
}

/* Points of a body-centred cubic lattice, which covers space most evenly. The half-step offset from
 * the box keeps points off axis-aligned walls. */
static starg_status lattice_points(starg_context *context, const starg_solid *solid, double step,
                                   double clearance, candidate_points *points) {
    bvh_box all;
    solid_reach(solid, &all);
    const double *lower = all.lower;
    size_t cells[3];
    for (int k = 0; k < 3; k++)
        cells[k] = (size_t)((all.upper[k] - lower[k]) / step) + 1;
    points->data.count = 0;
    for (size_t i = 0; i < 2 * cells[0]; i++) {
        TRY(starg_check_cancel(context, STAGE));
        for (size_t j = i % 2; j < 2 * cells[1]; j += 2)
            for (size_t k = i % 2; k < 2 * cells[2]; k += 2) {
                const double p[3] = {lower[0] + step * (0.5 * (double)i + 0.3),
                                     lower[1] + step * (0.5 * (double)j + 0.3),
                                     lower[2] + step * (0.5 * (double)k + 0.3)};
                if (candidates_allowed(solid, p, clearance))
                    TRY(candidates_push(context, points, p, NULL));
            }
    }
    return STARG_OK;
}

/* For a scene, the volume of the box in which guards may stand. */
static double free_volume(const starg_solid *solid) {
    bvh_box reach;
    if (!solid->scene)
        return solid->check->volume;
    if (solid->reached != NULL)
        return flood_volume(solid->reached);
    solid_reach(solid, &reach);
    double volume = 1;
    for (int k = 0; k < 3; k++)
        volume *= reach.upper[k] - reach.lower[k];
    return volume;
}

/* The step follows from the volume, two points per cubic cell; if clearance or thin walls leave too
 * few points, the step is reduced, a few times. */
static starg_status interior_candidates(starg_context *context, const candidate_shape *shape,
                                        size_t wanted, candidate_points *points) {
    enum { ROUNDS = 6 };
    const double most = 10000 * (double)wanted + 1000;
    double step = cbrt(2 * free_volume(shape->solid) / (double)wanted);
    for (int round = 0; round < ROUNDS; round++) {
        double used = coarse_enough(shape->solid, step, most);
        TRY(lattice_points(context, shape->solid, used, shape->clearance, points));
        size_t found = points->data.count / 3;
        if (10 * found >= 9 * wanted || used > step)
            break;
        double ratio = (double)(found > wanted / 8 ? found : wanted / 8 + 1) / (double)wanted;
        step *= cbrt(ratio) * 0.99;
    }
    return STARG_OK;
}

starg_status candidates_check(starg_context *context, starg_candidates source, size_t wanted,
                              double clearance) {
    if (source > STARG_CANDIDATES_SKELETON || source == STARG_CANDIDATES_GIVEN)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "given candidates are not made: pass them in the options");
    if (wanted == 0 || wanted > 10000000 || !(clearance >= 0))
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "candidates must be 1 to 10000000 and clearance zero or more, not %zu and %g", wanted,
            clearance);
    return STARG_OK;
}

/* Curve skeletons need a solid, the medial axis needs an inside. */
static starg_candidates source_in(const starg_solid *solid, starg_candidates wanted) {
    if (solid->ambient > 0)
        return STARG_CANDIDATES_INTERIOR;
    return solid->scene && wanted == STARG_CANDIDATES_SKELETON ? STARG_CANDIDATES_MEDIAL : wanted;
}

/* In a small part of the free space there may be no centres and nodes. */
static starg_status add_within(starg_context *context, const candidate_shape *shape, size_t wanted,
                               candidate_points *points) {
    const starg_solid *solid = shape->solid;
    SCOPED_BY(candidates_free) candidate_points more = {0};
    bool limited =
        solid->scene && (solid->zones.count > 0 || solid->space.within[0] < solid->space.within[3]);
    if (!limited || 4 * candidates_count(points) >= wanted)
        return STARG_OK;
    TRY(interior_candidates(context, shape, wanted, &more));
    return candidates_append(context, &more, points);
}

static starg_status find(starg_context *context, const candidate_shape *shape,
                         starg_candidates source, size_t wanted, candidate_points *points) {
    if (shape->solid->over.count > 0 || shape->solid->mount.count > 0)
        return near_candidates(context, shape, wanted, points);
    source = source_in(shape->solid, source);
    if (source != STARG_CANDIDATES_INTERIOR) {
        starg_status status = source == STARG_CANDIDATES_SKELETON
                                  ? skeletal_candidates(context, shape, wanted, points)
                                  : medial_candidates(context, shape, wanted, points);
        return status == STARG_OK ? add_within(context, shape, wanted, points) : status;
    }
    return interior_candidates(context, shape, wanted, points);
}

starg_status candidates_find(starg_context *context, const candidate_shape *shape,
                             starg_candidates source, size_t wanted, candidate_points *points) {
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    starg_status status = find(context, shape, source, wanted, points);
    starg_time_end(context, former);
    return status;
}

starg_status starg_candidate_points(starg_context *context, const starg_solid *solid,
                                    starg_candidates source, size_t wanted, double clearance,
                                    double **points, size_t *count) {
    SCOPED_BY(candidates_free) candidate_points found = {0};
    SCOPED_BY(starg_solid_drop) starg_solid *proxy = NULL;
    *points = NULL;
    *count = 0;
    TRY(candidates_check(context, source, wanted, clearance));
    if (proxy_wanted(solid))
        TRY(proxy_make(context, solid, &proxy));
    const candidate_shape shape = {solid, proxy ? proxy : solid, clearance};
    TRY(candidates_find(context, &shape, source, wanted, &found));
    *points = found.data.data;
    *count = found.data.count / 3;
    found.data.data = NULL;
    return STARG_OK;
}

void starg_points_free(starg_context *context, double *points) {
    starg_release(context, points);
}
