/* SPDX-License-Identifier: Apache-2.0 */
/* What is left to be seen beside guards that stay.
 *
 * Each column, a patch of a face or a vertex, must be seen so many times: as the redundancy says,
 * or more or less often on faces of which that was said (starg_space_require). Guards that stay see
 * some of it in advance. What a column still needs is the rest; a column that needs nothing more is
 * no target, as if it were no face to be seen: its bits are cleared in all rows, and its weight is
 * 0. So candidates, reductions, programs, prices, cells and proofs know of it without knowing of
 * these guards, and all bounds are bounds for the others.
 *
 * Where all columns that are left need the same number, that is their redundancy. Else covers take
 * the needs one by one, and there is neither refinement nor a proof, which count alike for all.
 *
 * Cost: the rows of the guards that stay. */
#include "guard/stages.h"

#include <math.h>

#include "visibility/scene.h"

static const char STAGE[] = "guard";

bool keep_applies(const guard_problem *problem) {
    return problem->options->keep_count > 0 || problem->solid->times != NULL;
}

static bool sees_vertices(const guard_problem *problem) {
    return problem->options->visibility.target == STARG_TARGET_VERTICES;
}

/* How many guards must see a column, those that stay among them. */
static uint32_t keep_times(const guard_problem *problem, size_t column) {
    const starg_solid *solid = problem->solid;
    if (solid->times == NULL || sees_vertices(problem))
        return problem->options->redundancy;
    uint32_t own = solid->times[solid_patch_face(solid, column)];
    return own > 0 ? own : problem->options->redundancy;
}

static starg_status check(const guard_problem *problem) {
    const starg_guard_options *o = problem->options;
    const char *what = o->keep_count > 0 ? "guards that stay (keep)" : "needs of faces (require)";
    const char *why = o->visibility.target == STARG_TARGET_POINTS ? "every point (target points)"
                      : o->baseline > 0                           ? "a baseline"
                      : problem->certificate != NULL              ? "a certificate"
                                                                  : NULL;
    if (why == NULL && problem->solid->times != NULL && sees_vertices(problem))
        why = "vertices (target vertices)";
    if (why != NULL)
        return starg_fail(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                          "%s cannot be combined with %s; leave out one of them", what, why);
    if (o->keep_count > 0 && sensor_is_directed(&o->visibility) && o->keep_directions == NULL)
        return starg_fail(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                          "guards have a cone or a field of view, and those that stay have no "
                          "directions; give six numbers each");
    return STARG_OK;
}

/* A guard in a wall, or outside, would be one that sees nothing: more likely it is a mistake. */
static starg_status take_poses(const guard_problem *problem, kept_guards *out) {
    const starg_guard_options *o = problem->options;
    bool looks = sensor_is_directed(&o->visibility);
    for (size_t i = 0; i < o->keep_count; i++) {
        const double *p = o->keep + 3 * i;
        uint64_t index = i;
        bool finite = fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100;
        if (!finite || !starg_solid_contains(problem->solid, p))
            return starg_fail_at(problem->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_CANDIDATE,
                                 &index, 1,
                                 "guard %zu that is to stay, at (%g, %g, %g), is not strictly "
                                 "inside the free space; move it off the wall, or leave it out; "
                                 "has it the units and the origin of the model?",
                                 i, p[0], p[1], p[2]);
        TRY(candidates_push_pose(problem->context, &out->poses, p,
                                 looks ? o->keep_directions + 3 * i : NULL,
                                 looks && o->keep_ups != NULL ? o->keep_ups + 3 * i : NULL));
    }
    return STARG_OK;
}

static starg_status find_rows(const guard_problem *problem, kept_guards *out) {
    starg_visibility_options view = problem->options->visibility;
    view.engine = STARG_VISIBILITY_FASTEST;
    view.directions = out->poses.directions.data;
    view.ups = out->poses.ups.data;
    starg_time_rule former = starg_time_begin(problem->context, STARG_TIME_IGNORED);
    starg_status status = visibility_rows(problem->context, problem->solid, out->poses.data.data,
                                          candidates_count(&out->poses), &view, NULL, &out->rows);
    starg_time_end(problem->context, former);
    return status;
}

static starg_status find_need(const guard_problem *problem, kept_guards *out) {
    const starg_solid *solid = problem->solid;
    bool vertices = sees_vertices(problem);
    size_t columns = target_columns(solid, problem->options->visibility.target);
    NEW_ZERO(problem->context, STAGE, out->need, columns);
    out->even = true;
    for (size_t j = 0; j < columns; j++) {
        uint32_t wanted = keep_times(problem, j);
        if (!solid_is_target(solid, vertices, vertices ? j : solid_patch_face(solid, j)))
            continue;
        for (size_t i = 0; out->rows != NULL && i < out->rows->rows && wanted > 0; i++)
            wanted -= starg_bits_test(out->rows, i, j);
        out->need[j] = wanted;
        out->open += wanted > 0;
        out->weight += wanted == 0 ? problem->weights.weights[j] : 0;
        out->even = out->even && (wanted == 0 || out->times == 0 || wanted == out->times);
        out->times = wanted > out->times ? wanted : out->times;
    }
    return STARG_OK;
}

starg_status keep_find(const guard_problem *problem, kept_guards *out) {
    *out = (kept_guards){0};
    TRY(check(problem));
    TRY(take_poses(problem, out));
    if (candidates_count(&out->poses) > 0)
        TRY(find_rows(problem, out));
    return find_need(problem, out);
}

starg_status keep_check(const guard_problem *problem, const kept_guards *kept) {
    if (!kept->even && problem->options->prove)
        return starg_fail(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                          "a bound for guards anywhere is proven where all that is left to be seen "
                          "is to be seen equally often, which it is not here: leave out the proof "
                          "(prove), or ask for the same number everywhere");
    return STARG_OK;
}

void keep_free(kept_guards *kept) {
    candidates_free(&kept->poses);
    starg_bits_free(kept->rows);
    RELEASE(kept->need);
    *kept = (kept_guards){0};
}
