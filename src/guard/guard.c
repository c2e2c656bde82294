/* SPDX-License-Identifier: Apache-2.0 */
/* Guarding a solid [YL11, section 3]: candidates, what they see, the fewest that see everything.
 *
 * Stages: a star-shaped solid needs one guard (starguard/kernel.h); levels of detail; candidate
 * points, for a large model from one of the levels (guard/proxy.c); their visibility rows; more
 * candidates until one sees every face that can be seen (guard/augment.c); the choice, by one cover
 * problem or from coarse to fine (guard/progressive.c); refinement and, on request, the search over
 * every point of the solid (both guard/search.c); what the chosen guards see (guard/measure.c).
 *
 * The lower bound is that of the cover problem: it holds for guards from the final candidate set.
 * That of the search holds for guards anywhere. */
#include "starguard/guard.h"

#include <math.h>
#include <stdio.h>

#include "core/fields.h"
#include "guard/baseline.h"
#include "guard/carry.h"
#include "guard/certificate.h"
#include "guard/corners.h"
#include "guard/proxy.h"
#include "guard/stages.h"
#include "guard/unseen.h"
#include "mesh/examine.h"
#include "starguard/kernel.h"

static const char STAGE[] = "guard";

enum { EVERYWHERE = 1000000 }; /* work for faces that no candidate sees: about a second */

/* Does the caller ask for the fewest of the given candidates and a bound for guards anywhere? Then
 * the choice is exact, whatever the method. */
static bool chooses_exactly(const starg_guard_options *o) {
    return o->prove && o->candidates == STARG_CANDIDATES_GIVEN;
}

static void set_defaults(starg_guard_options *o, size_t vertices) {
    if (o->candidate_count == STARG_DEFAULT_COUNT)
        o->candidate_count = guard_is_brief(o) ? 200 : 1000;
    if (o->max_nodes == STARG_DEFAULT_NODES)
        o->max_nodes = o->method == STARG_GUARD_PILP && !chooses_exactly(o) ? 30 : 100000;
    if (o->step == STARG_DEFAULT_STEP)
        o->step = starg_guard_default_step(vertices, o->coarsest);
}

static starg_status check_options(starg_context *context, const starg_guard_options *o) {
    starg_status status = STARG_OK;
    STARG_TRY(fields_check(context, STAGE, starg_guard_options_fields(), o));
    if (o->candidates != STARG_CANDIDATES_GIVEN)
        STARG_TRY(candidates_check(context, o->candidates, o->candidate_count, o->clearance));
    if (o->baseline > 0 && (o->redundancy < 2 || guard_wants_part(o)))
        status = starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                            "a baseline is one of two guards or more, and of all that can be seen; "
                            "ask for a redundancy of 2, and for no part");
    else if (o->baseline > 0 && o->visibility.target == STARG_TARGET_VERTICES)
        status = starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                            "a baseline is as seen from a face; the targets are vertices");
done:
    return status;
}

/* Leaves out given points where no guard may stand, with a notice. */
static starg_status take_given(const guard_problem *problem, candidate_points *points) {
    starg_status status = STARG_OK;
    const starg_guard_options *options = problem->options;
    bool looks = sensor_is_directed(&options->visibility) && options->directions != NULL;
    size_t dropped = 0;
    for (size_t i = 0; i < options->point_count; i++) {
        const double *p = options->points + 3 * i;
        uint64_t index = i;
        if (!(fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100))
            return starg_fail_at(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                                 STARG_ELEMENT_CANDIDATE, &index, 1,
                                 "candidate %zu has a coordinate that is not finite", i);
        bool usable = candidates_allowed(problem->solid, p, options->clearance);
        const double *d = looks ? options->directions + 3 * i : NULL;
        const double *up = looks && options->ups != NULL ? options->ups + 3 * i : NULL;
        if (usable)
            STARG_TRY(candidates_push_pose(problem->context, points, p, d, up));
        dropped += !usable;
    }
    if (dropped > 0)
        starg_log(problem->context, STARG_LOG_WARNING,
                  "ignoring %zu of %zu given candidates: not inside%s%s", dropped,
                  options->point_count,
                  problem->solid->scene ? ", or not where guards may stand" : "",
                  options->clearance > 0 ? ", or nearer to the boundary than the clearance" : "");
done:
    return status;
}

static bool needs_proxy(const guard_problem *problem) {
    return problem->options->candidates != STARG_CANDIDATES_GIVEN && proxy_wanted(problem->solid);
}

/* Levels of detail, for the method or as proxy. If time does not suffice for them, the model alone
 * is used. */
static starg_status make_levels(const guard_problem *problem, guard_detail *out) {
    const starg_guard_options *options = problem->options;
    starg_progress_begin(problem->context, "levels");
    starg_status status = starg_mesh_levels(problem->context, problem->solid->mesh,
                                            options->coarsest, options->step, NULL, &out->levels);
    starg_progress_end(problem->context);
    out->time_limited = status == STARG_ERROR_TIME;
    return out->time_limited ? STARG_OK : status;
}

static starg_status find_detail(const guard_problem *problem, guard_detail *out) {
    starg_status status = STARG_OK;
    bool proxy = needs_proxy(problem);
    if (problem->solid->scene)
        return STARG_OK; /* obstacles and outsides have no levels of detail */
    if (problem->options->method == STARG_GUARD_PILP || proxy)
        STARG_TRY(make_levels(problem, out));
    if (proxy && out->levels != NULL)
        STARG_TRY(proxy_of_levels(problem->context, problem->solid, out->levels, &out->proxy));
done:
    return status;
}

static starg_status find_first(const guard_problem *problem, const guard_detail *detail,
                               candidate_points *out) {
    const starg_guard_options *options = problem->options;
    const candidate_shape shape = guard_shape(problem, detail);
    if (options->candidates == STARG_CANDIDATES_GIVEN)
        return take_given(problem, out);
    return candidates_find(problem->context, &shape, options->candidates, options->candidate_count,
                           out);
}

/* The candidates before augmentation, and what they see. */
static starg_status find_candidates(const guard_problem *problem, const guard_detail *detail,
                                    guard_pool *out) {
    starg_status status = STARG_OK;
    candidate_points points = {0};
    STARG_TRY(pool_create(problem->context, problem->solid, problem->options, out));
    STARG_TRY(find_first(problem, detail, &points));
    if (detail->proxy != NULL && !sensor_is_directed(&problem->options->visibility))
        STARG_TRY(carry_candidates(problem, detail->proxy, &points));
    STARG_TRY(pool_add(out, &points));
done:
    candidates_free(problem->context, &points);
    return status;
}

static bool is_limited(const starg_space_options *s) {
    return s->within[0] < s->within[3] || s->standoff_most > 0 || s->standoff_least > 0 ||
           s->cell > 0 || s->over_count > 0 || s->mount_count > 0;
}

/* Candidates that see nothing prove nothing. Says which limits may be the reason. */
static starg_status fail_unseen(const guard_problem *problem, const guard_pool *pool) {
    const starg_guard_options *o = problem->options;
    double diagonal = problem->solid->check->diagonal, range = o->visibility.range;
    const struct {
        const char *text;
        bool set;
    } limits[] = {
        {"a smaller clearance", o->clearance > 0},
        {"a larger range", range < diagonal},
        {"a wider view", sensor_is_directed(&o->visibility)},
        {"a larger incidence", o->visibility.incidence > 0 && o->visibility.incidence < 90},
        {"faces that are seen from either side (two-sided)",
         problem->solid->other_side != NULL && !solid_is_two_sided(problem->solid)},
        {"other faces to see", problem->weights.faces < starg_space_model_faces(problem->solid)},
        {"wider limits of where guards may stand (box, distances, faces)",
         problem->solid->scene && is_limited(&problem->solid->space)},
        {"other candidates", o->candidates == STARG_CANDIDATES_GIVEN},
    };
    char advice[256] = "";
    size_t used = 0;
    if (pool->time_limited)
        return starg_fail(problem->context, STARG_ERROR_TIME, STAGE,
                          "time limit reached before any candidate was evaluated; allow more time");
    if (range < diagonal / 1000)
        return starg_fail(problem->context, STARG_ERROR_MESH, STAGE,
                          "no candidate sees any target: the range is %g, but the model measures "
                          "%g across; is the range given in another unit than the model?",
                          range, diagonal);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        if (limits[i].set)
            used += (size_t)snprintf(advice + used, sizeof advice - used, "%s%s",
                                     used > 0 ? ", or " : "; try ", limits[i].text);
    return starg_fail(problem->context, STARG_ERROR_MESH, STAGE, "no candidate sees any target%s",
                      used > 0 ? advice : ": the solid is too thin for the candidates");
}

typedef STARG_ARRAY(uint32_t) face_list;

static starg_status list_missing(const guard_problem *problem, const guard_pool *pool,
                                 face_list *out) {
    starg_status status = STARG_OK;
    out->count = 0;
    for (uint32_t f = 0; f < starg_space_model_faces(problem->solid); f++)
        if (solid_is_target(problem->solid, false, f) && !starg_bit_test(pool->coverable, f))
            STARG_PUSH(problem->context, STAGE, out, f);
done:
    return status;
}

/* What remains is looked for in the whole free space: places nearest to the faces
 * that guards are bound to, then boxes. Faces that no place sees are told, and places that see
 * others become candidates. */
static starg_status look_everywhere(const guard_problem *problem, guard_pool *pool) {
    starg_status status = STARG_OK;
    const starg_guard_options *options = problem->options;
    face_list missing = {0};
    candidate_points places = {0};
    if (options->visibility.target != STARG_TARGET_FACES || pool->curtailed || pool->time_limited ||
        options->candidates == STARG_CANDIDATES_GIVEN)
        return STARG_OK;
    STARG_TRY(list_missing(problem, pool, &missing));
    const candidate_shape shape = {problem->solid, problem->solid, options->clearance};
    STARG_TRY(
        near_candidates_before(problem->context, &shape, missing.data, missing.count, &places));
    if (candidates_count(&places) > 0) {
        STARG_TRY(pool_add(pool, &places));
        STARG_TRY(list_missing(problem, pool, &missing));
    }
    places.data.count = 0;
    if (missing.count == 0)
        goto done;
    STARG_TRY(unseen_prove(problem->context, problem->solid, options, missing.data, missing.count,
                           EVERYWHERE, &pool->unseen, &places));
    if (candidates_count(&places) > 0)
        STARG_TRY(pool_add(pool, &places));
done:
    STARG_ARRAY_FREE(problem->context, &missing);
    candidates_free(problem->context, &places);
    return status;
}

static starg_status find_pool(const guard_problem *problem, const guard_detail *detail,
                              guard_pool *out) {
    starg_status status = STARG_OK;
    STARG_TRY(find_candidates(problem, detail, out));
    STARG_TRY(pool_augment(out, &problem->weights));
    STARG_TRY(look_everywhere(problem, out));
    out->time_limited = out->time_limited || (detail->time_limited && pool_count(out) == 0);
    if (starg_bit_count(out->coverable, starg_bit_words(out->columns)) == 0)
        status = fail_unseen(problem, out);
done:
    return status;
}

static int level_of(const guard_selection *selection, uint32_t candidate, int otherwise) {
    for (size_t i = 0; i < selection->chosen.count; i++)
        if (selection->chosen.data[i] == candidate)
            return selection->levels.data[i];
    return otherwise;
}

starg_status selection_of_cover(starg_context *context, const starg_cover *cover,
                                const guard_selection *before, int level, guard_selection *out) {
    starg_status status = STARG_OK;
    *out = (guard_selection){.level = level,
                             .lower_bound = cover->lower_bound,
                             .weight_bound = cover->weight_bound,
                             .time_limited = before->time_limited || cover->time_limited};
    for (size_t i = 0; i < cover->count; i++) {
        STARG_PUSH(context, STAGE, &out->chosen, cover->rows[i]);
        STARG_PUSH(context, STAGE, &out->levels, level_of(before, cover->rows[i], level));
    }
done:
    return status;
}

starg_status selection_copy(starg_context *context, const guard_selection *from,
                            guard_selection *out) {
    starg_status status = STARG_OK;
    *out = (guard_selection){.level = from->level,
                             .lower_bound = from->lower_bound,
                             .weight_bound = from->weight_bound,
                             .time_limited = from->time_limited};
    for (size_t i = 0; i < from->chosen.count; i++) {
        STARG_PUSH(context, STAGE, &out->chosen, from->chosen.data[i]);
        STARG_PUSH(context, STAGE, &out->levels, from->levels.data[i]);
    }
    for (size_t i = 0; i < from->kept.count; i++)
        STARG_PUSH(context, STAGE, &out->kept, from->kept.data[i]);
done:
    return status;
}

void selection_free(starg_context *context, guard_selection *selection) {
    STARG_ARRAY_FREE(context, &selection->chosen);
    STARG_ARRAY_FREE(context, &selection->levels);
    STARG_ARRAY_FREE(context, &selection->kept);
}

/* One cover problem over the model as it is. */
static starg_status choose_at_once(const guard_problem *problem, const guard_pool *pool,
                                   bool time_limited, guard_selection *out) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    bool greedy =
        problem->options->method == STARG_GUARD_GREEDY && !chooses_exactly(problem->options);
    const guard_selection none = {.time_limited = time_limited};
    const choice how = {.method = greedy ? STARG_COVER_GREEDY : STARG_COVER_ILP,
                        .max_nodes = problem->options->max_nodes};
    STARG_TRY(choose_candidates(pool, &problem->weights, &how, &cover));
    STARG_TRY(selection_of_cover(problem->context, cover, &none, 0, out));
done:
    starg_cover_free(cover);
    return status;
}

/* Without levels, the first choice is that of the whole problem, with its bounds. */
static bool was_whole(const guard_detail *detail, const guard_selection *first) {
    return detail->levels == NULL && first->lower_bound > 0;
}

/* Solving the whole problem again, for the bounds, takes seconds: not after the time limit. */
static starg_status choose_by_levels(const guard_problem *problem, const guard_detail *detail,
                                     guard_outcome *out) {
    starg_status status = STARG_OK;
    guard_selection first = {0};
    STARG_TRY(progressive_guards(problem, detail, &out->pool, &out->records, &first));
    bool late = first.lower_bound > 0 && starg_time_is_over(problem->context);
    if (late || was_whole(detail, &first) || guard_refines(problem->options)) {
        out->selection = first;
        out->selection.time_limited = first.time_limited || late;
        first = (guard_selection){0};
    } else
        STARG_TRY(bound_guards(problem, &out->pool, &first, &out->selection));
    STARG_TRY(record_level(&out->pool, &out->selection, &out->records));
done:
    selection_free(problem->context, &first);
    return status;
}

/* Could a single point suffice that is not a candidate? */
static bool may_be_star(const guard_problem *problem) {
    const starg_guard_options *o = problem->options;
    bool free = (o->prove && !chooses_exactly(o)) || guard_refines(o);
    return free && !problem->solid->scene && o->redundancy == 1 &&
           !sensor_is_directed(&o->visibility);
}

/* Does the only candidate see everything that any point could see? */
static bool sees_everything(const guard_pool *pool) {
    const starg_mesh *mesh = pool->solid->mesh;
    if (pool_count(pool) != 1)
        return false;
    if (pool->options->visibility.target != STARG_TARGET_VERTICES)
        return starg_bits_count(pool->rows, 0) == pool->columns;
    for (size_t k = 0; k < 3 * mesh->face_count; k++)
        if (!starg_bits_test(pool->rows, 0, mesh->faces[k]))
            return false;
    return true;
}

/* A star-shaped solid: a point of its kernel sees everything, so one guard is optimal. */
static starg_status find_star_guard(const guard_problem *problem, guard_outcome *out, bool *found) {
    starg_status status = STARG_OK;
    candidate_points points = {0};
    starg_kernel_result kernel;
    guard_pool *pool = &out->pool;
    *found = false;
    STARG_TRY(starg_kernel(problem->context, problem->solid->mesh, NULL, &kernel));
    if (kernel.verdict != STARG_KERNEL_INTERIOR ||
        !candidates_allowed(problem->solid, kernel.guard, problem->options->clearance))
        return STARG_OK;
    STARG_TRY(pool_create(problem->context, problem->solid, problem->options, pool));
    STARG_TRY(candidates_push(problem->context, &points, kernel.guard, NULL));
    STARG_TRY(pool_add(pool, &points));
    *found = sees_everything(pool);
    if (*found) {
        STARG_PUSH(problem->context, STAGE, &out->selection.chosen, 0);
        STARG_PUSH(problem->context, STAGE, &out->selection.levels, 0);
        out->selection.lower_bound = out->search.bound = 1;
        out->selection.weight_bound = problem->weights.total;
        if (problem->options->max_guards > 0)
            out->search.weight_bound = problem->weights.total;
    } else
        pool_free(pool);
done:
    candidates_free(problem->context, &points);
    return status;
}

/* A certificate says why the bound of the search holds, so it has to come to that by itself. */
static starg_status begin_bound(const guard_problem *problem, guard_outcome *out) {
    starg_status status = STARG_OK;
    size_t bound = 0;
    if (problem->certificate == NULL && out->selection.chosen.count > 0)
        STARG_TRY(bound_by_parts(problem, &out->pool, &bound));
    if (bound > 1 || bound == out->selection.chosen.count)
        out->search.bound = bound;
done:
    return status;
}

/* Everything from the solid to the choice. */
static starg_status find_guards(const guard_problem *problem, guard_outcome *out) {
    starg_status status = STARG_OK;
    guard_detail detail = {0};
    bool found = false;
    if (may_be_star(problem))
        STARG_TRY(find_star_guard(problem, out, &found));
    if (found)
        return STARG_OK;
    STARG_TRY(find_detail(problem, &detail));
    STARG_TRY(find_pool(problem, &detail, &out->pool));
    if (problem->options->method == STARG_GUARD_PILP && !chooses_exactly(problem->options))
        STARG_TRY(choose_by_levels(problem, &detail, out));
    else
        STARG_TRY(choose_at_once(problem, &out->pool, detail.time_limited || out->pool.time_limited,
                                 &out->selection));
    if (!guard_wants_part(problem->options)) {
        STARG_TRY(begin_bound(problem, out));
        STARG_TRY(search_guards(problem, &detail, guard_refines(problem->options), &out->pool,
                                &out->selection, &out->search));
    } else if (problem->options->prove)
        STARG_TRY(search_area(problem, &out->pool, &out->selection, &out->search));
done:
    starg_solid_free(detail.proxy);
    starg_levels_free(problem->context, detail.levels);
    return status;
}

static void outcome_free(starg_context *context, guard_outcome *outcome) {
    records_free(context, &outcome->records);
    selection_free(context, &outcome->selection);
    pool_free(&outcome->pool);
}

/* If the search had nothing to prove: one guard is needed if anything must be seen. */
static starg_status certify_one(const guard_problem *problem, const guard_outcome *outcome) {
    const guard_pool *pool = &outcome->pool;
    uint32_t witness = UINT32_MAX;
    if (problem->certificate == NULL || problem->certificate->text != NULL)
        return STARG_OK;
    for (uint32_t j = 0; j < pool->columns && outcome->search.bound > 0 && witness == UINT32_MAX;
         j++)
        if (starg_bits_test(pool->rows, outcome->selection.chosen.data[0], j))
            witness = j;
    return certificate_of_one(problem->context, problem->solid, problem->options, witness,
                              problem->certificate);
}

/* Under the union rule a crate inside a room is part of the room; the user may have meant an
 * obstacle. */
static void warn_of_shells(const guard_problem *problem, const starg_guards *guards) {
    bool on_surface;
    size_t count = 0, first = 0;
    if (problem->solid->check->components < 2 || problem->solid->scene ||
        mesh_is_rounded(problem->solid->check))
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (bvh_winding(problem->solid->tree, guards->positions + 3 * g, &on_surface) > 1) {
            count++;
            first = g;
        }
    if (count > 0)
        starg_log(problem->context, STARG_LOG_WARNING,
                  "%zu %s within more than one shell of the model (first: guard %zu); if one of "
                  "them is an obstacle, give it as one, or keep the orientation of the faces",
                  count, count == 1 ? "guard stands" : "guards stand", first);
}

static starg_status guard_solid(starg_context *context, const starg_solid *solid,
                                const starg_guard_options *options, guard_certificate *why,
                                starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guard_options defaults;
    starg_guard_options_default(&defaults);
    starg_guard_options used = options ? *options : defaults;
    guard_problem problem = {
        .context = context, .solid = solid, .options = &used, .certificate = why};
    guard_outcome outcome = {0};
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    STARG_TRY(check_options(context, &used));
    STARG_TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    STARG_TRY(find_guards(&problem, &outcome));
    STARG_TRY(baseline_guards(&problem, &outcome.pool, &outcome.selection));
    STARG_TRY(certify_one(&problem, &outcome));
    STARG_TRY(report_guards(&problem, &outcome, out));
    if (options != NULL) { /* as asked for: files name them only then */
        (*out)->options.max_nodes = options->max_nodes;
        (*out)->options.candidate_count = options->candidate_count;
    }
    warn_of_shells(&problem, *out);
done:
    outcome_free(context, &outcome);
    column_weights_free(context, &problem.weights);
    return status;
}

starg_status starg_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, starg_guards **out) {
    return guard_solid(context, solid, options, NULL, out);
}

starg_status starg_guard_certified(starg_context *context, const starg_solid *solid,
                                   const starg_guard_options *options, starg_guards **out,
                                   char **text, size_t *size) {
    guard_certificate why = {0};
    *out = NULL;
    *text = NULL;
    *size = 0;
    if (options != NULL && guard_wants_part(options))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate is only written where everything is to be seen; ask for a "
                          "coverage of 1 without a limit of guards");
    if (solid->scene)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate is only written for a plain solid: without obstacles, "
                          "outsides, weights and bounds for where guards stand");
    if (options == NULL || !options->prove)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate says why a bound for guards anywhere holds, which is not "
                          "asked for; ask for a proof (prove)");
    starg_status status = guard_solid(context, solid, options, &why, out);
    if (status == STARG_OK) {
        *text = why.text;
        *size = why.size;
        why.text = NULL;
    }
    certificate_free(context, &why);
    return status;
}

/* ---- corners ---- */

static starg_status take_corner_guards(const guard_problem *problem, const guard_outcome *outcome,
                                       corner_guards *out) {
    starg_status status = STARG_OK;
    const guard_selection *selection = &outcome->selection;
    STARG_NEW(problem->context, STAGE, out->positions, 3 * selection->chosen.count);
    out->count = selection->chosen.count;
    out->bound = outcome->search.bound;
    for (size_t i = 0; i < out->count; i++)
        memcpy(out->positions + 3 * i, pool_point(&outcome->pool, selection->chosen.data[i]),
               3 * sizeof *out->positions);
    if (problem->certificate != NULL) {
        out->certificate = problem->certificate->text;
        out->size = problem->certificate->size;
        problem->certificate->text = NULL;
    }
done:
    return status;
}

starg_status corner_guards_find(starg_context *context, const starg_solid *solid, uint64_t work,
                                bool certified, corner_guards *out) {
    starg_status status = STARG_OK;
    starg_guard_options used;
    guard_certificate why = {0};
    guard_outcome outcome = {0};
    *out = (corner_guards){0};
    starg_guard_options_default(&used);
    used.visibility.target = STARG_TARGET_CORNERS;
    used.effort = STARG_EFFORT_BEST;
    used.prove = true;
    used.prove_work = work;
    set_defaults(&used, solid->mesh->vertex_count);
    guard_problem problem = {.context = context,
                             .solid = solid,
                             .options = &used,
                             .certificate = certified ? &why : NULL};
    STARG_TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    STARG_TRY(find_guards(&problem, &outcome));
    STARG_TRY(certify_one(&problem, &outcome));
    STARG_TRY(take_corner_guards(&problem, &outcome, out));
done:
    outcome_free(context, &outcome);
    column_weights_free(context, &problem.weights);
    certificate_free(context, &why);
    if (status != STARG_OK)
        corner_guards_free(context, out);
    return status;
}

void corner_guards_free(starg_context *context, corner_guards *guards) {
    starg_release(context, guards->positions);
    starg_release(context, guards->certificate);
    *guards = (corner_guards){0};
}

static starg_status choose_all(const guard_problem *problem, const guard_pool *pool,
                               guard_selection *out) {
    starg_status status = STARG_OK;
    size_t given = problem->options->point_count;
    for (uint32_t i = 0; i < pool_count(pool); i++) {
        STARG_PUSH(problem->context, STAGE, &out->chosen, i);
        STARG_PUSH(problem->context, STAGE, &out->levels, 0);
    }
    if (given == 0 || out->chosen.count != given)
        status = starg_fail(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                            "%zu of %zu given guards are strictly inside the solid; give at least "
                            "one guard, all of them inside",
                            out->chosen.count, given);
done:
    return status;
}

starg_status starg_guards_given(starg_context *context, const starg_solid *solid,
                                const double *points, size_t count, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guard_options used;
    starg_guard_options_default(&used);
    used.method = STARG_GUARD_ILP;
    used.candidates = STARG_CANDIDATES_GIVEN;
    used.candidate_count = used.point_count = count;
    used.points = points;
    guard_problem problem = {.context = context, .solid = solid, .options = &used};
    guard_outcome outcome = {0};
    /* results so far are measured in full */
    starg_time_rule former = starg_time_begin(context, STARG_TIME_IGNORED);
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    STARG_TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    STARG_TRY(find_candidates(&problem, &(guard_detail){0}, &outcome.pool));
    STARG_TRY(choose_all(&problem, &outcome.pool, &outcome.selection));
    STARG_TRY(report_guards(&problem, &outcome, out));
done:
    starg_time_end(context, former);
    outcome_free(context, &outcome);
    column_weights_free(context, &problem.weights);
    return status;
}

void records_free(starg_context *context, guard_records *records) {
    for (size_t i = 0; i < records->count; i++)
        starg_release(context, records->data[i].positions);
    STARG_ARRAY_FREE(context, records);
}

void starg_guards_free(starg_context *context, starg_guards *guards) {
    if (guards == NULL)
        return;
    guard_records records = {.data = guards->level_list, .count = guards->level_count};
    records_free(context, &records);
    for (size_t i = 0; guards->obstacles != NULL && i < guards->obstacle_count; i++)
        starg_release(context, guards->obstacles[i].file);
    starg_release(context, guards->obstacles);
    starg_release(context, guards->space.over);
    starg_release(context, guards->space.mount);
    starg_release(context, guards->targets);
    starg_release(context, guards->importance);
    starg_release(context, guards->file);
    starg_release(context, guards->positions);
    starg_release(context, guards->directions);
    starg_release(context, guards->ups);
    starg_release(context, guards->seen_faces);
    starg_release(context, guards->levels);
    starg_release(context, guards->curve_faces);
    starg_release(context, guards->curve_area);
    starg_release(context, guards->uncovered);
    starg_release(context, guards->uncovered_vertices);
    starg_release(context, guards->redundant_faces);
    starg_release(context, guards);
}
