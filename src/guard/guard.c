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
#include "core/parallel.h"
#include "guard/candidates.h"
#include "guard/corners.h"
#include "guard/prices.h"
#include "guard/stages.h"
#include "mesh/examine.h"
#include "starguard/kernel.h"

static const char STAGE[] = "guard";

enum { EVERYWHERE = 1000000 }; /* work for faces that no candidate sees: about a second */

/* Does the caller ask for the fewest of the given candidates and a bound for guards anywhere? Then
 * the choice is exact, whatever the method. */
static bool chooses_exactly(const starg_guard_options *o) {
    return o->prove && o->candidates == STARG_CANDIDATES_GIVEN;
}

/* Places: fewer where a search moves them, or where each looks in several directions. */
static size_t usual_count(const starg_guard_options *o) {
    if (guard_is_brief(o))
        return 200;
    if (guard_wants_part(o) && sensor_is_directed(&o->visibility))
        return o->effort == STARG_EFFORT_QUICK    ? 300
               : o->effort == STARG_EFFORT_NORMAL ? 600
                                                  : 1000;
    return 1000;
}

static void set_defaults(starg_guard_options *o, size_t vertices) {
    if (o->candidate_count == STARG_DEFAULT_COUNT)
        o->candidate_count = usual_count(o);
    if (o->max_nodes == STARG_DEFAULT_NODES)
        o->max_nodes = o->method == STARG_GUARD_PILP && !chooses_exactly(o) ? 30 : 100000;
    if (o->step == STARG_DEFAULT_STEP)
        o->step = starg_guard_default_step(vertices, o->coarsest);
}

static starg_status check_options(starg_context *context, const starg_guard_options *o) {
    TRY(fields_check(context, STAGE, starg_guard_options_fields(), o));
    if (o->candidates != STARG_CANDIDATES_GIVEN)
        TRY(candidates_check(context, o->candidates, o->candidate_count, o->clearance));
    if (o->visibility.tilt[0] != STARG_TILT_ANY && !sensor_is_directed(&o->visibility))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a tilt is of guards that look in one direction; give a field of view "
                          "(fov) or a cone");
    if (o->baseline > 0 && (o->redundancy < 2 || guard_wants_part(o)))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a baseline is one of two guards or more, and of all that can be seen; "
                          "ask for a redundancy of 2, and for no part");
    if (o->visibility.target == STARG_TARGET_POINTS && (o->redundancy > 1 || guard_wants_part(o)))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "points are seen once, and all of them: leave out the redundancy, the "
                          "coverage and the limit of guards, or ask for faces");
    if (o->baseline > 0 && o->visibility.target == STARG_TARGET_VERTICES)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a baseline is as seen from a face; the targets are vertices");
    return STARG_OK;
}

/* Leaves out given points where no guard may stand, with a notice. */
static starg_status take_given(const guard_problem *problem, candidate_points *points) {
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
        usable = usable && (d == NULL || starg_tilt_holds(&options->visibility, d));
        if (usable)
            TRY(candidates_push_pose(problem->context, points, p, d, up));
        dropped += !usable;
    }
    if (dropped > 0)
        starg_log(problem->context, STARG_LOG_WARNING,
                  "ignoring %zu of %zu given candidates: not inside%s%s%s", dropped,
                  options->point_count,
                  problem->solid->scene ? ", or not where guards may stand" : "",
                  options->visibility.tilt[0] != STARG_TILT_ANY ? ", or beyond the tilt" : "",
                  options->clearance > 0 ? ", or nearer to the boundary than the clearance" : "");
    return STARG_OK;
}

static bool needs_proxy(const guard_problem *problem) {
    return problem->options->candidates != STARG_CANDIDATES_GIVEN && proxy_wanted(problem->solid);
}

/* ---- what is found of the solid ---- */

static bool needs_levels(const guard_problem *problem) {
    const starg_solid *solid = problem->solid;
    /* obstacles and outsides have none, and patches are of this surface */
    return problem->options->method == STARG_GUARD_PILP && !solid->scene &&
           solid->patches == NULL && solid->need == NULL;
}

/* If time does not suffice for them, the model alone is used. */
static starg_status find_levels(const guard_problem *problem, guard_detail *out) {
    const starg_guard_options *options = problem->options;
    starg_progress_begin(problem->context, "levels");
    starg_levels_free(problem->context, out->levels);
    out->levels = NULL;
    starg_status status = starg_mesh_levels(problem->context, problem->solid->mesh,
                                            options->coarsest, options->step, NULL, &out->levels);
    starg_progress_end(problem->context);
    out->time_limited = status == STARG_ERROR_TIME;
    return out->time_limited ? STARG_OK : status;
}

static starg_status find_proxy(const guard_problem *problem, guard_detail *out) {
    TRY(find_levels(problem, out));
    if (out->levels != NULL)
        TRY(proxy_of_levels(problem->context, problem->solid, out->levels, &out->proxy));
    if (!needs_levels(problem)) {
        starg_levels_free(problem->context, out->levels);
        out->levels = NULL;
    }
    return STARG_OK;
}

static starg_status find_first(const guard_problem *problem, guard_detail *detail) {
    const starg_guard_options *options = problem->options;
    const candidate_shape shape = guard_shape(problem, detail);
    candidate_points *out = &detail->first;
    if (problem->carried != NULL)
        return candidates_append(problem->context, problem->carried, out);
    if (options->candidates == STARG_CANDIDATES_GIVEN)
        return take_given(problem, out);
    return candidates_find(problem->context, &shape, options->candidates, options->candidate_count,
                           out);
}

static starg_status find_centres(const guard_problem *problem, guard_detail *detail) {
    const starg_guard_options *options = problem->options;
    const candidate_shape shape = guard_shape(problem, detail);
    starg_status status = candidates_find(problem->context, &shape, STARG_CANDIDATES_MEDIAL,
                                          options->candidate_count, &detail->centres);
    return status == STARG_ERROR_TIME ? STARG_OK : status;
}

static bool needs_centres(const guard_problem *problem) {
    const starg_guard_options *options = problem->options;
    return guard_searches(options) && options->candidates != STARG_CANDIDATES_MEDIAL &&
           !sensor_is_directed(&options->visibility);
}

/* Those that do not need each other. */
typedef struct findings {
    const guard_problem *problem;
    guard_detail *detail;
    starg_status (*find[3])(const guard_problem *problem, guard_detail *detail);
} findings;

static starg_status find_one(starg_context *context, void *shared, size_t task) {
    findings *all = shared;
    (void)context;
    return all->find[task](all->problem, all->detail);
}

/* Levels are replaced when they are found again. */
static void forget_one(void *shared, size_t task) {
    findings *all = shared;
    if (all->find[task] == find_first)
        candidates_free(&all->detail->first);
    else if (all->find[task] == find_centres)
        candidates_free(&all->detail->centres);
}

static starg_status find_detail(const guard_problem *problem, guard_detail *out) {
    const bool proxy = !problem->solid->scene && needs_proxy(problem);
    findings all = {.problem = problem, .detail = out, .find = {find_first}};
    starg_tasks tasks = {
        .stage = STAGE, .count = 1, .shared = &all, .run = find_one, .undo = forget_one};
    if (proxy)
        TRY(find_proxy(problem, out));
    if (needs_centres(problem))
        all.find[tasks.count++] = find_centres;
    if (needs_levels(problem) && !proxy)
        all.find[tasks.count++] = find_levels;
    return starg_run_tasks(problem->context, &tasks);
}

static void detail_free(guard_detail *detail) {
    starg_solid_free(detail->proxy);
    starg_levels_free(NULL, detail->levels);
    candidates_free(&detail->first);
    candidates_free(&detail->centres);
}

/* The candidates before augmentation, and what they see. */
static starg_status find_candidates(const guard_problem *problem, guard_detail *detail,
                                    guard_pool *out) {
    TRY(pool_create(problem->context, problem->solid, problem->options, out));
    if (problem->carried == NULL && detail->proxy != NULL &&
        !sensor_is_directed(&problem->options->visibility))
        TRY(carry_candidates(problem, detail->proxy, &detail->first));
    return pool_add(out, &detail->first);
}

static bool is_limited(const starg_space_options *s) {
    return s->within[0] < s->within[3] || s->zone_count > 0 || s->standoff_most > 0 ||
           s->standoff_least > 0 || s->cell > 0 || s->over_count > 0 || s->mount_count > 0;
}

static bool is_in_another_unit(const guard_problem *problem) {
    return problem->options->visibility.range < problem->solid->check->diagonal / 1000;
}

static starg_status fail_unit(const guard_problem *problem, const char *what) {
    return starg_fail(
        problem->context, STARG_ERROR_MESH, STAGE,
        "%s: the range is %g, but the model measures %g across; is the range given in "
        "another unit than the model?",
        what, problem->options->visibility.range, problem->solid->check->diagonal);
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
         problem->solid->scene && !problem->solid->own_box && is_limited(&problem->solid->space)},
        {"other candidates", o->candidates == STARG_CANDIDATES_GIVEN},
    };
    char advice[256] = "";
    size_t used = 0;
    if (pool->time_limited)
        return starg_fail(problem->context, STARG_ERROR_TIME, STAGE,
                          "time limit reached before any candidate was evaluated; allow more time");
    if (is_in_another_unit(problem))
        return fail_unit(problem, "no candidate sees any target");
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        if (limits[i].set)
            used += (size_t)snprintf(advice + used, sizeof advice - used, "%s%s",
                                     used > 0 ? ", or " : "; try ", limits[i].text);
    return starg_fail(problem->context, STARG_ERROR_MESH, STAGE, "no candidate sees any target%s",
                      used > 0 ? advice : ": the solid is too thin for the candidates");
}

typedef STARG_ARRAY(uint32_t) patch_list;

static starg_status list_missing(const guard_problem *problem, const guard_pool *pool,
                                 patch_list *out) {
    const starg_solid *solid = problem->solid;
    out->count = 0;
    for (uint32_t j = 0; j < solid_first_patch(solid, starg_space_model_faces(solid)); j++)
        if (solid_wants(solid, false, solid_patch_face(solid, j), j) &&
            !starg_bit_test(pool->coverable, j))
            PUSH(problem->context, STAGE, out, j);
    return STARG_OK;
}

/* What remains is looked for in the whole free space: places nearest to the faces
 * that guards are bound to, then boxes. Faces that no place sees are told, and places that see
 * others become candidates. */
static starg_status look_everywhere(const guard_problem *problem, guard_pool *pool) {
    const starg_guard_options *options = problem->options;
    SCOPED patch_list missing = {0};
    SCOPED_BY(candidates_free) candidate_points places = {0};
    if (options->visibility.target != STARG_TARGET_FACES || pool->curtailed || pool->time_limited ||
        options->candidates == STARG_CANDIDATES_GIVEN || problem->hurried)
        return STARG_OK;
    TRY(list_missing(problem, pool, &missing));
    const candidate_shape shape = {problem->solid, problem->solid, options->clearance};
    TRY(near_candidates_before(problem->context, &shape, &options->visibility, missing.data,
                               missing.count, &places));
    if (candidates_count(&places) > 0) {
        TRY(pool_add(pool, &places));
        TRY(list_missing(problem, pool, &missing));
    }
    places.data.count = 0;
    if (missing.count == 0)
        return STARG_OK;
    TRY(unseen_prove(problem->context, problem->solid, options, missing.data, missing.count,
                     EVERYWHERE, &pool->unseen, &places));
    if (candidates_count(&places) > 0)
        TRY(pool_add(pool, &places));
    return STARG_OK;
}

static starg_status find_pool(const guard_problem *problem, guard_detail *detail, guard_pool *out) {
    TRY(find_candidates(problem, detail, out));
    TRY(pool_augment(out, &problem->weights));
    TRY(look_everywhere(problem, out));
    if (problem->options->candidates != STARG_CANDIDATES_GIVEN && pool_count(out) > 0)
        TRY(pool_add_companions(out));
    out->time_limited = out->time_limited || (detail->time_limited && pool_count(out) == 0);
    if (problem->kept == NULL &&
        starg_bit_count(out->coverable, starg_bit_words(out->columns)) == 0)
        return fail_unseen(problem, out);
    return STARG_OK;
}

static int level_of(const guard_selection *selection, uint32_t candidate, int otherwise) {
    for (size_t i = 0; i < selection->chosen.count; i++)
        if (selection->chosen.data[i] == candidate)
            return selection->levels.data[i];
    return otherwise;
}

starg_status selection_of_cover(starg_context *context, const starg_cover *cover,
                                const guard_selection *before, int level, guard_selection *out) {
    *out = (guard_selection){.level = level,
                             .lower_bound = cover->lower_bound,
                             .weight_bound = cover->weight_bound,
                             .time_limited = before->time_limited || cover->time_limited};
    for (size_t i = 0; i < cover->count; i++) {
        PUSH(context, STAGE, &out->chosen, cover->rows[i]);
        PUSH(context, STAGE, &out->levels, level_of(before, cover->rows[i], level));
    }
    return STARG_OK;
}

starg_status selection_copy(starg_context *context, const guard_selection *from,
                            guard_selection *out) {
    *out = (guard_selection){.level = from->level,
                             .lower_bound = from->lower_bound,
                             .weight_bound = from->weight_bound,
                             .time_limited = from->time_limited};
    for (size_t i = 0; i < from->chosen.count; i++) {
        PUSH(context, STAGE, &out->chosen, from->chosen.data[i]);
        PUSH(context, STAGE, &out->levels, from->levels.data[i]);
    }
    for (size_t i = 0; i < from->kept.count; i++)
        PUSH(context, STAGE, &out->kept, from->kept.data[i]);
    return STARG_OK;
}

void selection_free(guard_selection *selection) {
    RELEASE(selection->chosen.data);
    RELEASE(selection->levels.data);
    RELEASE(selection->kept.data);
}

/* One cover problem over the model as it is. */
static starg_status choose_at_once(const guard_problem *problem, const guard_pool *pool,
                                   bool time_limited, guard_selection *out) {
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    bool greedy =
        problem->options->method == STARG_GUARD_GREEDY && !chooses_exactly(problem->options);
    const guard_selection none = {.time_limited = time_limited};
    const choice how = {.method = greedy ? STARG_COVER_GREEDY : STARG_COVER_ILP,
                        .max_nodes = problem->options->max_nodes};
    TRY(choose_candidates(pool, &problem->weights, &how, &cover));
    return selection_of_cover(problem->context, cover, &none, 0, out);
}

/* Without levels, the first choice is that of the whole problem, with its bounds. */
static bool was_whole(const guard_detail *detail, const guard_selection *first) {
    return detail->levels == NULL && first->lower_bound > 0;
}

/* Solving the whole problem again, for the bounds, takes seconds: not after the time limit. */
static starg_status choose_by_levels(const guard_problem *problem, const guard_detail *detail,
                                     guard_outcome *out) {
    SCOPED_BY(selection_free) guard_selection first = {0};
    TRY(progressive_guards(problem, detail, &out->pool, &out->records, &first));
    bool late = first.lower_bound > 0 && starg_time_is_over(problem->context);
    if (late || was_whole(detail, &first) || guard_refines(problem->options)) {
        out->selection = first;
        out->selection.time_limited = first.time_limited || late;
        first = (guard_selection){0};
    } else
        TRY(bound_guards(problem, &out->pool, &first, &out->selection));
    return record_level(&out->pool, &out->selection, &out->records);
}

/* Could a single point suffice that is not a candidate? */
static bool may_be_star(const guard_problem *problem) {
    const starg_guard_options *o = problem->options;
    bool free = (o->prove && !chooses_exactly(o)) || guard_refines(o);
    return free && !problem->solid->scene && problem->kept == NULL && o->redundancy == 1 &&
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
    SCOPED_BY(candidates_free) candidate_points points = {0};
    starg_kernel_result kernel;
    guard_pool *pool = &out->pool;
    *found = false;
    TRY(starg_kernel(problem->context, problem->solid->mesh, NULL, &kernel));
    if (kernel.verdict != STARG_KERNEL_INTERIOR ||
        !candidates_allowed(problem->solid, kernel.guard, problem->options->clearance))
        return STARG_OK;
    TRY(pool_create(problem->context, problem->solid, problem->options, pool));
    TRY(candidates_push(problem->context, &points, kernel.guard, NULL));
    TRY(pool_add(pool, &points));
    *found = sees_everything(pool);
    if (*found) {
        PUSH(problem->context, STAGE, &out->selection.chosen, 0);
        PUSH(problem->context, STAGE, &out->selection.levels, 0);
        out->selection.lower_bound = out->search.bound = 1;
        out->selection.weight_bound = problem->weights.total;
        if (problem->options->max_guards > 0)
            out->search.weight_bound = problem->weights.total;
    } else
        pool_free(pool);
    return STARG_OK;
}

/* A certificate says why the bound of the search holds, so it has to come to that by itself. */
static starg_status begin_bound(const guard_problem *problem, guard_outcome *out) {
    size_t bound = 0;
    if (problem->certificate == NULL && out->selection.chosen.count > 0)
        TRY(bound_by_parts(problem, &out->pool, &bound));
    if (bound > 1 || bound == out->selection.chosen.count)
        out->search.bound = bound;
    if (bound > out->selection.lower_bound)
        out->selection.lower_bound = bound; /* it holds for candidates, too */
    return STARG_OK;
}

/* Guards that moved see parts that no candidate saw. Where several guards must see each part, they
 * get companions, and guards are chosen again. */
static starg_status see_again(const guard_problem *problem, guard_outcome *out) {
    SCOPED_BY(selection_free) guard_selection again = {0};
    const size_t before = pool_count(&out->pool);
    if (problem->options->redundancy == 1 || problem->options->candidates == STARG_CANDIDATES_GIVEN)
        return STARG_OK;
    TRY(pool_add_companions(&out->pool));
    if (pool_count(&out->pool) == before)
        return STARG_OK;
    TRY(choose_at_once(problem, &out->pool, out->selection.time_limited, &again));
    if (again.lower_bound < out->search.bound)
        again.lower_bound = out->search.bound; /* it holds for candidates, too */
    selection_free(&out->selection);
    out->selection = again;
    again = (guard_selection){0};
    return STARG_OK;
}

starg_status find_guards(const guard_problem *problem, guard_outcome *out) {
    SCOPED_BY(detail_free) guard_detail detail = {0};
    bool found = false;
    if (may_be_star(problem))
        TRY(find_star_guard(problem, out, &found));
    if (found)
        return STARG_OK;
    TRY(find_detail(problem, &detail));
    TRY(find_pool(problem, &detail, &out->pool));
    if (problem->kept != NULL &&
        starg_bit_count(out->pool.coverable, starg_bit_words(out->pool.columns)) == 0)
        return STARG_OK; /* what those that stay do not see, nobody sees */
    if (problem->options->method == STARG_GUARD_PILP && !chooses_exactly(problem->options))
        TRY(choose_by_levels(problem, &detail, out));
    else
        TRY(choose_at_once(problem, &out->pool, detail.time_limited || out->pool.time_limited,
                           &out->selection));
    if (!guard_wants_part(problem->options)) {
        TRY(begin_bound(problem, out));
        TRY(search_guards(problem, &detail, guard_refines(problem->options), &out->pool,
                          &out->selection, &out->search));
        TRY(see_again(problem, out));
    } else if (problem->options->prove)
        TRY(search_area(problem, &out->pool, &out->selection, &out->search));
    return STARG_OK;
}

static void records_free(guard_records *records) {
    for (size_t i = 0; i < records->count; i++)
        RELEASE(records->data[i].positions);
    RELEASE(records->data);
}

void outcome_free(guard_outcome *outcome) {
    records_free(&outcome->records);
    selection_free(&outcome->selection);
    RELEASE(outcome->worth.seen, outcome->worth.bound, outcome->tour.points, outcome->tour.stops,
            outcome->tour.blocked, outcome->search.steps);
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
    return certificate_of_one(problem->context, pool->solid, problem->options, witness,
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

/* Beside guards that stay: of a solid whose needs are what these leave. The pool outlives it, so
 * its solid becomes that of the problem, and what the guards that stay see is coverable. */
static starg_status find_others(guard_problem *problem, kept_guards *kept, guard_outcome *out) {
    starg_context *context = problem->context;
    starg_solid open = *problem->solid;
    starg_guard_options used = *problem->options;
    SCOPED_BY(problem_free) guard_problem rest = *problem;
    rest.weights = (column_weights){0};
    TRY(keep_find(problem, kept));
    TRY(keep_check(problem, kept));
    problem->kept = rest.kept = kept;
    open.need = kept->need;
    rest.solid = &open;
    rest.options = &used;
    used.redundancy = kept->times > 0 ? kept->times : 1;
    used.refine = used.refine && kept->even;
    TRY(column_weights_create(context, &open, used.visibility.target, &rest.weights));
    rest.weights.kept = kept->weight;
    if (kept->open > 0) {
        TRY(find_guards(&rest, out));
        TRY(curve_find(&rest, out));
    } else
        TRY(pool_create(context, &open, &used, &out->pool));
    out->pool.solid = problem->solid;
    out->pool.options = problem->options;
    for (size_t i = 0; kept->rows != NULL && i < kept->rows->rows; i++)
        for (size_t w = 0; w < starg_bit_words(out->pool.columns); w++)
            out->pool.coverable[w] |= starg_bits_row(kept->rows, i)[w];
    return STARG_OK;
}

static void free_rounds(point_round (*rounds)[2]) {
    point_round_free(*rounds);
    point_round_free(*rounds + 1);
}

static starg_status guard_solid(starg_context *context, const starg_solid *solid,
                                const starg_guard_options *options, guard_certificate *why,
                                starg_guards **out) {
    starg_guard_options defaults;
    starg_guard_options_default(&defaults);
    starg_guard_options used = options ? *options : defaults;
    SCOPED_BY(problem_free)
    guard_problem problem = {
        .context = context, .solid = solid, .options = &used, .certificate = why};
    SCOPED_BY(patched_solid_free) patched_solid patched = {0};
    SCOPED_BY(free_rounds) point_round rounds[2] = {0};
    SCOPED_BY(keep_free) kept_guards kept = {0};
    SCOPED_BY(outcome_free) guard_outcome of_faces = {0};
    guard_outcome *outcome = &of_faces;
    point_round *of_points = NULL;
    bool points = used.visibility.target == STARG_TARGET_POINTS;
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    TRY(check_options(context, &used));
    if (points) { /* as targets of the search they are the patches of a solid */
        used.visibility.target = STARG_TARGET_FACES;
        if (is_in_another_unit(&problem))
            return fail_unit(&problem, "nobody sees every point of a face");
    }
    TRY(patched_solid_make(context, solid, &used.visibility, &patched));
    if (points)
        used.visibility.patch = STARG_PATCH_OFF;
    else
        problem.solid = solid = &patched.solid;
    TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    if (points && (used.keep_count > 0 || solid->times != NULL))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "points are seen once, by guards that are all to be found; leave out "
                          "guards that stay (keep) and needs of faces (require), or ask for "
                          "faces, in fine patches");
    if (points && solid->clear != NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "every point is proven to be seen in front of what blocks; leave out "
                          "the clear faces, or ask for faces");
    if (keep_applies(&problem))
        TRY(find_others(&problem, &kept, &of_faces));
    else
        TRY(points ? find_guards_of_points(&problem, patched.patches, rounds, &of_points)
                   : find_guards(&problem, &of_faces));
    if (points) {
        outcome = &of_points->outcome;
        if (outcome->selection.chosen.count > 0 && !of_points->any)
            return fail_unseen(&problem, &outcome->pool); /* nothing but points on edges */
    }
    if (problem.kept == NULL && !points)
        TRY(curve_find(&problem, outcome));
    TRY(baseline_guards(&problem, &outcome->pool, &outcome->selection));
    TRY(certify_one(&problem, outcome));
    TRY(tour_find(&problem, outcome));
    if (points && used.order) { /* others are the first to see a part */
        point_coverage_free(&of_points->coverage);
        TRY(find_coverage(&problem, outcome, &of_points->coverage));
    }
    TRY(report_guards(&problem, outcome, points ? &of_points->coverage : NULL, out));
    if (points)
        (*out)->options.visibility.target = STARG_TARGET_POINTS;
    if (options != NULL) { /* as asked for: files name them only then */
        (*out)->options.max_nodes = options->max_nodes;
        (*out)->options.candidate_count = options->candidate_count;
        (*out)->options.refine = options->refine;
    }
    warn_of_shells(&problem, *out);
    return STARG_OK;
}

starg_status starg_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, starg_guards **out) {
    return guard_solid(context, solid, options, NULL, out);
}

starg_status starg_guard_certified(starg_context *context, const starg_solid *solid,
                                   const starg_guard_options *options, starg_guards **out,
                                   char **text, size_t *size) {
    guard_certificate why = {0};
    starg_guard_options used;
    *out = NULL;
    *text = NULL;
    *size = 0;
    if (options != NULL && options->visibility.patch > 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate is not written for faces in parts; leave the faces whole, "
                          "or ask for every point");
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
    used = *options;
    used.visibility.patch = STARG_PATCH_OFF;
    starg_status status = guard_solid(context, solid, &used, &why, out);
    if (status == STARG_OK) {
        *text = why.text;
        *size = why.size;
        why.text = NULL;
    }
    certificate_free(&why);
    return status;
}

/* ---- corners ---- */

static starg_status take_corner_guards(const guard_problem *problem, const guard_outcome *outcome,
                                       corner_guards *out) {
    const guard_selection *selection = &outcome->selection;
    NEW(problem->context, STAGE, out->positions, 3 * selection->chosen.count);
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
    return STARG_OK;
}

starg_status corner_guards_find(starg_context *context, const starg_solid *solid, uint64_t work,
                                bool certified, corner_guards *out) {
    starg_guard_options used;
    SCOPED_BY(certificate_free) guard_certificate why = {0};
    SCOPED_BY(outcome_free) guard_outcome outcome = {0};
    *out = (corner_guards){0};
    starg_guard_options_default(&used);
    used.visibility.target = STARG_TARGET_CORNERS;
    used.effort = STARG_EFFORT_BEST;
    used.prove = true;
    used.prove_work = work;
    set_defaults(&used, solid->mesh->vertex_count);
    SCOPED_BY(problem_free)
    guard_problem problem = {.context = context,
                             .solid = solid,
                             .options = &used,
                             .certificate = certified ? &why : NULL};
    TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    TRY(find_guards(&problem, &outcome));
    TRY(certify_one(&problem, &outcome));
    return take_corner_guards(&problem, &outcome, out);
}

void corner_guards_free(corner_guards *guards) {
    RELEASE(guards->positions);
    RELEASE(guards->certificate);
    *guards = (corner_guards){0};
}

static starg_status choose_all(const guard_problem *problem, const guard_pool *pool,
                               guard_selection *out) {
    size_t given = problem->options->point_count;
    for (uint32_t i = 0; i < pool_count(pool); i++) {
        PUSH(problem->context, STAGE, &out->chosen, i);
        PUSH(problem->context, STAGE, &out->levels, 0);
    }
    if (given == 0 || out->chosen.count != given)
        return starg_fail(problem->context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu of %zu given guards are strictly inside the solid; give at least "
                          "one guard, all of them inside",
                          out->chosen.count, given);
    return STARG_OK;
}

starg_status starg_guards_given(starg_context *context, const starg_solid *solid,
                                const double *points, size_t count, starg_guards **out) {
    starg_guard_options used;
    starg_guard_options_default(&used);
    used.method = STARG_GUARD_ILP;
    used.candidates = STARG_CANDIDATES_GIVEN;
    used.candidate_count = used.point_count = count;
    used.points = points;
    SCOPED_BY(problem_free)
    guard_problem problem = {.context = context, .solid = solid, .options = &used};
    SCOPED_BY(detail_free) guard_detail detail = {0};
    SCOPED_BY(outcome_free) guard_outcome outcome = {0};
    /* results so far are measured in full */
    TIME_RULE(context, STARG_TIME_IGNORED);
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    TRY(column_weights_create(context, solid, used.visibility.target, &problem.weights));
    TRY(find_first(&problem, &detail));
    TRY(find_candidates(&problem, &detail, &outcome.pool));
    TRY(choose_all(&problem, &outcome.pool, &outcome.selection));
    return report_guards(&problem, &outcome, NULL, out);
}

void starg_guards_free(starg_context *context, starg_guards *guards) {
    (void)context;
    if (guards == NULL)
        return;
    guard_records records = {.data = guards->level_list, .count = guards->level_count};
    records_free(&records);
    for (size_t i = 0; guards->obstacles != NULL && i < guards->obstacle_count; i++)
        RELEASE(guards->obstacles[i].file);
    for (size_t i = 0; guards->zones != NULL && i < guards->zone_count; i++)
        RELEASE(guards->zones[i].file);
    RELEASE(guards->obstacles, guards->zones, guards->needs, guards->space.over,
            guards->space.mount, guards->space.clear, guards->targets, guards->importance,
            guards->file, guards->positions, guards->directions, guards->ups, guards->seen_faces,
            guards->kept, guards->levels, guards->curve_faces, guards->curve_area,
            guards->worth_seen, guards->worth_bound);
    starg_bits_free(guards->rows);
    RELEASE(guards->uncovered, guards->partial, guards->partial_share, guards->uncovered_vertices,
            guards->redundant_faces, guards->tour.points, guards->tour.stops, guards->tour.blocked,
            guards->step_work, guards->step_guards, guards);
}
