/* SPDX-License-Identifier: Apache-2.0 */
/* Guards that see every point of the targets: the art gallery problem itself.
 *
 * Problem. Faces by their corners are not all that the paper asks for (2.1): between seen corners
 * there may be shadows, and a face that two guards share counts as unseen.
 *
 * Method [in the plane: Tozoni, de Rezende, de Souza 2016]: some points of faces stand for all of
 * them, at first the corners of each, or of parts where views are limited. Guards are sought that
 * see these, by all the means that there are for faces (guard/guard.c); halving faces then decides
 * whether they see every point (guard/point_coverage.c). Where they do not, points that no guard
 * sees join the others, and the search goes on from the candidates of the round before.
 *
 * Where many guards share a wall, each a piece of it as far as their range or field of view goes,
 * every round would leave slits elsewhere. After EXACT_ROUNDS, guards are sought with limits that
 * are tighter by a hundredth a round: what lies between points seen so is seen with the limits as
 * they are. Bounds are of rounds with these alone.
 *
 * Invariant: a bound for some points holds for all. It ends when everything is seen, when nothing
 * unseen is found in what is left open, when no candidate sees what was added last, when the work
 * for proofs is done, or after MOST_ROUNDS; with the fewest guards that see everything, or else
 * those of the last round. */
#include <math.h>
#include <stdlib.h>

#include "guard/prices.h"
#include "guard/stages.h"
#include "visibility/sensor.h"

static const char STAGE[] = "points";

enum { MOST_ROUNDS = 40, EXACT_ROUNDS = 4 };

static const double TIGHTER = 0.01, MOST_TIGHTER = 0.1; /* of the limits */

typedef struct point_search {
    const guard_problem *problem; /* of the plain solid */
    face_points points;
    candidate_points carried;
    size_t bound;       /* of all rounds */
    uint64_t work_left; /* for proofs */
} point_search;

/* The corners of all target faces, or of parts of them. */
static starg_status begin_points(point_search *s, const mesh_patches *parts) {
    const starg_solid *solid = s->problem->solid;
    const patch_triangle whole = patch_whole();
    for (uint32_t f = 0; f < starg_space_model_faces(solid); f++) {
        if (!solid_is_target(solid, false, f))
            continue;
        if (parts != NULL)
            TRY(patches_list_corners(parts, solid->mesh, f, &s->points));
        for (size_t k = 0; k < 3 && parts == NULL; k++) {
            const face_point corner = {f, whole.corner[k]};
            PUSH(s->problem->context, STAGE, &s->points, corner);
        }
    }
    return STARG_OK;
}

/* Adds what no guard sees; *added: is any of it new? What is there already is sorted. */
static starg_status add_unseen(point_search *s, const point_coverage *coverage, bool *added) {
    size_t known = s->points.count;
    for (size_t i = 0; i < coverage->unseen.count; i++)
        if (bsearch(&coverage->unseen.data[i], s->points.data, known, sizeof *s->points.data,
                    face_points_compare) == NULL)
            PUSH(s->problem->context, STAGE, &s->points, coverage->unseen.data[i]);
    *added = s->points.count > known;
    return STARG_OK;
}

/* A bound for some points holds for all; where its reason is wanted, only one that has one counts.
 */
static void keep_bound(point_search *s, size_t bound, guard_certificate *why) {
    guard_certificate *kept = s->problem->certificate;
    if (bound <= s->bound || (kept != NULL && why->text == NULL))
        return;
    s->bound = bound;
    if (kept == NULL)
        return;
    certificate_free(kept);
    *kept = *why;
    *why = (guard_certificate){0};
}

/* Limits of a view, tightened by a share. */
static void tighten(starg_visibility_options *view, double share) {
    view->range *= 1 - share;
    view->near *= 1 + share;
    view->incidence *= 1 - share;
    view->cone *= view->cone < 360 ? 1 - share : 1;
    for (int k = 0; k < 2; k++)
        view->fov[k] *= 1 - share;
}

static bool is_limited(const starg_visibility_options *view) {
    return sensor_is_directed(view) || view->range < 1e100 || view->incidence > 0;
}

/* The first round and the last are searches as long as asked for; between them quick ones will do,
 * whose guards only show what else has to be seen. */
static uint64_t effort_of(const point_search *s, bool thorough) {
    const starg_guard_options *o = s->problem->options;
    bool words = o->refine_lines == STARG_DEFAULT_LINES && o->effort > INT64_MAX;
    return thorough || !words ? o->effort : STARG_EFFORT_QUICK;
}

/* Guards that see the points so far, with tighter limits by a share. */
static starg_status find_round(point_search *s, bool thorough, bool prove, double tighter,
                               point_round *out) {
    starg_context *context = s->problem->context;
    const starg_solid *solid = s->problem->solid;
    starg_guard_options options = *s->problem->options;
    SCOPED_BY(problem_free) guard_problem problem = *s->problem;
    SCOPED_BY(certificate_free) guard_certificate why = {0};
    problem.weights = (column_weights){0};
    problem.certificate = prove && problem.certificate != NULL ? &why : NULL;
    problem.hurried = !thorough;
    options.effort = effort_of(s, thorough);
    options.prove = prove;
    options.prove_work = s->work_left;
    tighten(&options.visibility, tighter);
    problem.options = &options;
    problem.carried = candidates_count(&s->carried) > 0 ? &s->carried : NULL;
    point_round_free(out);
    out->patched.solid = *solid;
    TRY(patches_of_points(context, solid->mesh, &s->points,
                          solid_is_two_sided(solid) ? solid->other_side : NULL,
                          &out->patched.patches));
    out->patched.solid.patches = out->patched.patches;
    problem.solid = &out->patched.solid;
    TRY(column_weights_create(context, problem.solid, STARG_TARGET_FACES, &problem.weights));
    TRY(find_guards(&problem, &out->outcome));
    uint64_t spent = out->outcome.search.prove_work;
    s->work_left -= spent < s->work_left ? spent : s->work_left;
    if (tighter > 0) /* bounds are of the tighter limits */
        out->outcome.selection.lower_bound = out->outcome.selection.chosen.count > 0;
    else
        keep_bound(s, out->outcome.search.bound, &why);
    candidates_free(&s->carried);
    TRY(candidates_append(context, &out->outcome.pool.points, &s->carried));
    out->outcome.pool.options = s->problem->options;
    return STARG_OK;
}

starg_status find_coverage(const guard_problem *problem, const guard_outcome *outcome,
                           point_coverage *out) {
    starg_visibility_options view = problem->options->visibility;
    SCOPED_BY(candidates_free) candidate_points guards = {0};
    for (size_t i = 0; i < outcome->selection.chosen.count; i++) {
        uint32_t g = outcome->selection.chosen.data[i];
        TRY(candidates_push_pose(problem->context, &guards, pool_point(&outcome->pool, g),
                                 pool_direction(&outcome->pool, g), pool_up(&outcome->pool, g)));
    }
    view.directions = guards.directions.data;
    view.ups = guards.ups.data;
    return point_coverage_find(problem->context, problem->solid, guards.data.data,
                               candidates_count(&guards), &view, out);
}

/* Do the chosen guards see the points, and all others? */
static starg_status check_round(const point_search *s, point_round *round) {
    const starg_solid *solid = s->problem->solid;
    TRY(find_coverage(s->problem, &round->outcome, &round->coverage));
    round->complete = true;
    for (size_t f = 0; f < starg_space_model_faces(solid); f++) {
        if (!solid_is_target(solid, false, f))
            continue;
        round->complete = round->complete && round->coverage.open[f] == 0;
        round->any = round->any || round->coverage.open[f] < 1;
    }
    return STARG_OK;
}

static size_t guards_of(const point_round *round) {
    return round->outcome.selection.chosen.count;
}

static size_t coverable_of(const point_round *round) {
    const guard_pool *pool = &round->outcome.pool;
    return starg_bit_count(pool->coverable, starg_bit_words(pool->columns));
}

void point_round_free(point_round *round) {
    outcome_free(&round->outcome);
    point_coverage_free(&round->coverage);
    patched_solid_free(&round->patched);
    *round = (point_round){0};
}

starg_status find_guards_of_points(const guard_problem *problem, const mesh_patches *parts,
                                   point_round rounds[2], point_round **out) {
    starg_status status = STARG_OK;
    starg_context *context = problem->context;
    const starg_visibility_options *view = &problem->options->visibility;
    point_search s = {.problem = problem, .work_left = problem->options->prove_work};
    bool thorough = true, prove = false, more = true, added = false;
    point_round *now = &rounds[0], *best = NULL;
    double tighter = 0;
    size_t before = 0;
    starg_progress_begin(context, "points");
    STARG_TRY(begin_points(&s, parts));
    for (int round = 0; round < MOST_ROUNDS && more; round++) {
        now = best == &rounds[0] ? &rounds[1] : &rounds[0];
        STARG_TRY(find_round(&s, thorough, prove, prove ? 0 : tighter, now));
        STARG_TRY(check_round(&s, now));
        bool in_vain = added && coverable_of(now) == before; /* nobody sees what was added */
        before = coverable_of(now);
        STARG_TRY(add_unseen(&s, &now->coverage, &added));
        if (now->complete && (best == NULL || guards_of(now) <= guards_of(best)))
            best = now;
        bool settled = best != NULL && guards_of(now) >= guards_of(best) &&
                       (!prove || s.bound >= guards_of(best));
        more = added && !in_vain && !(thorough && settled);
        if (more && !thorough && round + 1 >= EXACT_ROUNDS && is_limited(view))
            tighter = fmin(tighter + TIGHTER, MOST_TIGHTER);
        if (!more && !thorough)
            thorough = more = true;
        else if (!more && problem->options->prove && !prove)
            prove = more = true;
        else
            thorough = prove;
        more = more && !(prove && s.work_left == 0) && !starg_time_is_over(context);
    }
    *out = best != NULL ? best : now;
    (*out)->outcome.search.bound = s.bound > 0 || guards_of(*out) == 0 ? s.bound : 1;
    size_t *of_candidates = &(*out)->outcome.selection.lower_bound;
    if (*of_candidates < (*out)->outcome.search.bound)
        *of_candidates = (*out)->outcome.search.bound;
done:
    starg_progress_end(context);
    STARG_ARRAY_FREE(context, &s.points);
    candidates_free(&s.carried);
    return status;
}
