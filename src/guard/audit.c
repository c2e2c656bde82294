/* SPDX-License-Identifier: Apache-2.0 */
/* An audit: what given guards see, without a search. They are the candidates, and all of them are
 * chosen. Cost: that of their rows of visibility. */
#include "guard/stages.h"
#include "visibility/sensor.h"

static const char STAGE[] = "audit";

/* All poses become candidates, also where they see nothing. */
static starg_status take_poses(const guard_problem *problem, const starg_poses *poses,
                               guard_outcome *out) {
    SCOPED_BY(candidates_free) candidate_points points = {0};
    bool looks = sensor_is_directed(&problem->options->visibility);
    TRY(pool_create(problem->context, problem->solid, problem->options, &out->pool));
    for (size_t i = 0; i < poses->count; i++)
        TRY(candidates_push_pose(problem->context, &points, poses->points + 3 * i,
                                 looks ? poses->directions + 3 * i : NULL,
                                 looks && poses->ups != NULL ? poses->ups + 3 * i : NULL));
    TRY(pool_add(&out->pool, &points));
    for (uint32_t i = 0; i < pool_count(&out->pool); i++) {
        PUSH(problem->context, STAGE, &out->selection.chosen, i);
        PUSH(problem->context, STAGE, &out->selection.levels, 0);
    }
    return STARG_OK;
}

static starg_status check_poses(starg_context *context, const starg_poses *poses,
                                const starg_visibility_options *view) {
    if (poses->count == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "there are no poses");
    if (sensor_is_directed(view) && poses->directions == NULL)
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "a cone or a field of view needs to know where guards look, and the poses "
            "have no directions; give six numbers each");
    return STARG_OK;
}

starg_status starg_guards_audit(starg_context *context, const starg_solid *scene,
                                const starg_poses *poses, const starg_visibility_options *view,
                                starg_guards **out) {
    starg_guard_options used;
    SCOPED_BY(patched_solid_free) patched_solid patched = {0};
    SCOPED_BY(outcome_free) guard_outcome outcome = {0};
    SCOPED_BY(point_coverage_free) point_coverage coverage = {0};
    bool points = view->target == STARG_TARGET_POINTS;
    TIME_RULE(context, STARG_TIME_FAILS);
    *out = NULL;
    starg_guard_options_default(&used);
    used.method = STARG_GUARD_ILP;
    used.candidates = STARG_CANDIDATES_GIVEN;
    used.candidate_count = poses->count;
    used.visibility = *view;
    if (points) {
        used.visibility.target = STARG_TARGET_FACES;
        used.visibility.patch = STARG_PATCH_OFF;
    }
    SCOPED_BY(problem_free)
    guard_problem problem = {.context = context,
                             .solid = scene,
                             .options = &used,
                             .audited = used.visibility.target == STARG_TARGET_FACES};
    TRY(check_poses(context, poses, view));
    TRY(patched_solid_make(context, scene, &used.visibility, &patched));
    problem.solid = &patched.solid;
    TRY(column_weights_create(context, &patched.solid, used.visibility.target, &problem.weights));
    TRY(take_poses(&problem, poses, &outcome));
    if (points)
        TRY(find_coverage(&problem, &outcome, &coverage));
    TRY(report_guards(&problem, &outcome, points ? &coverage : NULL, out));
    (*out)->optimal = false; /* nothing was chosen */
    (*out)->options.visibility.target = view->target;
    return STARG_OK;
}
