/* SPDX-License-Identifier: Apache-2.0 */
/* The fewest guards over every point of the free space, and a lower bound on their number.
 *
 * Problem. Guards may stand anywhere; find a lower bound that holds for all of them, and guards as
 * close to it as possible [after exact solvers for the art gallery problem in the plane: Tozoni, de
 * Rezende, de Souza 2016].
 *
 * Witnesses are a subset of the faces: guards that see everything see these, so a bound for them is
 * a bound for all. Cells (guard/cells.h) cover the whole space, and each stores the witnesses that
 * it may see. Points are candidates, moved points, and points of cells. A first loop only looks for
 * guards (guard/search_improve.c). A second one, short unless a proof is asked for, improves both
 * ends (guard/search_proof.c). Both are closed by integer programs over all faces. In the end all
 * cells count as points, which gives the best bound of these cells.
 *
 * If several guards must see each face, the witnesses are faces that enough guards see, and k
 * guards cover at most k times what one of them covers. If views are directed, points have a
 * direction and cells look in all directions: the bound holds for both.
 *
 * Invariant: the bound holds for guards anywhere in the free space; the guards see everything
 * required. All budgets count operations, so nothing depends on threads. */
#include <math.h>
#include <stdlib.h>

#include "geometry/vec3.h"
#include "guard/certificate.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum {
    VALUES = 5,     /* values of rows that take as long as a test */
    COMPARED = 300, /* comparisons of points that take as long as a test */
    LEAST_BATCH = 32,
    MOST_BATCH = 2048,
    FEW_NODES = 10,
    MANY_NODES = 300,
    CLOSINGS = 4, /* before the last, after equal parts of the budget */
    SHORT_CLOSINGS = 8,
    QUICK_CLOSINGS = 2,
    FIRST_CLOSING = 5000000,
    CLOSING_FACTOR = 3,
    MANY_GUARDS = 20
};

/* The more guards, the smaller are the parts of the space that tell them apart: leaves of a
 * sixteenth of the extent, shared among the guards, are small at first. */
static const double FIRST_FINEST = 1.0 / 16;

/* Most work of cells for better guards, and the number of columns above which it is less. */
static const double MOST_CELL_WORK = 5e6, EASY_COLUMNS = 1e4;

starg_status search_note_guards(search *s) {
    PUSH(context_of(s), STAGE, &s->steps, ((search_step){s->scene.work, s->count}));
    starg_tell_best(context_of(s), s->count, "guards");
    return STARG_OK;
}

/* ---- points ---- */

/* Points of the pool stay: other witnesses may raise their value. */
void search_prune_points(search *s, size_t first) {
    search_point *points = s->points.data;
    size_t kept = first;
    for (size_t i = first; i < s->points.count; i++) {
        bool needless = false;
        for (size_t j = 0; j < s->points.count && !needless; j++)
            needless = (j < kept || j > i) && row_is_within(&points[i].seen, &points[j].seen) &&
                       (j < kept || !row_is_within(&points[j].seen, &points[i].seen));
        if (!needless || points[i].candidate != UINT32_MAX)
            points[kept++] = points[i];
    }
    s->scene.work += (s->points.count - first) * s->points.count / COMPARED;
    s->points.count = kept;
}

static starg_status begin_points(search *s) {
    for (size_t i = 0; i < pool_count(s->pool); i++) {
        search_point point = {.candidate = (uint32_t)i};
        vec3_copy(pool_point(s->pool, i), point.place);
        if (sensor_is_directed(s->scene.view)) {
            vec3_copy(pool_direction(s->pool, i), point.direction);
            vec3_copy(pool_up(s->pool, i), point.up);
        }
        PUSH(context_of(s), STAGE, &s->points, point);
    }
    return STARG_OK;
}

/* Adds the medial axis as places, unless guards stand there already. Adds none if time does not
 * suffice or views are cones. */
static starg_status begin_places(search *s, const guard_detail *detail) {
    starg_status status = STARG_OK;
    const guard_problem *p = s->problem;
    const candidate_shape shape = guard_shape(p, detail);
    candidate_points places = {0};
    if (p->options->candidates == STARG_CANDIDATES_MEDIAL || sensor_is_directed(s->scene.view))
        return STARG_OK;
    status = candidates_find(p->context, &shape, STARG_CANDIDATES_MEDIAL,
                             p->options->candidate_count, &places);
    if (status == STARG_ERROR_TIME)
        status = STARG_OK;
    for (size_t i = 0; status == STARG_OK && i < candidates_count(&places); i++) {
        search_point point = {.candidate = UINT32_MAX};
        vec3_copy(places.data.data + 3 * i, point.place);
        STARG_PUSH(context_of(s), STAGE, &s->points, point);
    }
done:
    candidates_free(&places);
    return status;
}

/* ---- cells ---- */

int search_by_score(const void *a, const void *b) {
    const scored_leaf *x = a, *y = b;
    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

starg_status search_list_leaves(search *s, double most, size_t first, leaf_list *list) {
    for (size_t i = first; i < s->cells.count; i++) {
        const search_cell *cell = &s->cells.data[i];
        if (cell->children != 0 || search_is_fine(s, cell))
            continue;
        double value = search_worth(s, &cell->open);
        if (value <= most)
            continue;
        double size = vec3_distance(cell->box.lower, cell->box.upper);
        scored_leaf leaf = {(value - most) * sqrt(size), (uint32_t)i};
        PUSH(context_of(s), STAGE, list, leaf);
    }
    s->scene.work += (s->cells.count - first) / VALUES;
    return STARG_OK;
}

starg_status search_split(search *s, scored_leaf *list, size_t count, int tries) {
    starg_status status = STARG_OK;
    uint32_t *leaves = NULL;
    size_t first = s->points.count, chosen = 0, batch = count / 4;
    batch = batch < LEAST_BATCH ? LEAST_BATCH : batch > MOST_BATCH ? MOST_BATCH : batch;
    STARG_NEW(context_of(s), STAGE, leaves, batch);
    qsort(list, count, sizeof *list, search_by_score);
    for (size_t i = 0; i < count && chosen < batch; i++)
        if (cell_splits(&s->cells.data[list[i].cell].box))
            leaves[chosen++] = list[i].cell;
    s->ended = chosen == 0;
    STARG_TRY(cells_split(&s->scene, &s->cells, leaves, chosen, tries, &s->points));
    search_prune_points(s, first);
done:
    starg_release(context_of(s), leaves);
    return status;
}

starg_status search_bound_points(search *s) {
    starg_status status = STARG_OK;
    const witness_row **rows = NULL;
    whole_prices whole;
    STARG_NEW(context_of(s), STAGE, rows, s->points.count);
    for (size_t i = 0; i < s->points.count; i++)
        rows[i] = &s->points.data[i].seen;
    bound_round(&s->prices, &s->odd, &whole);
    s->known = bound_of_prices(rows, s->points.count, &whole, s->redundancy);
done:
    starg_release(context_of(s), rows);
    return status;
}

/* ---- the loop ---- */

typedef starg_status round_run(search *s, row_list *list);

static bool goes_on(const search *s) {
    return s->bound < s->count && !s->ended && s->scene.work < s->budget &&
           !starg_time_is_over(context_of(s));
}

/* Until a share of the work that was planned at `begun` is done. */
static starg_status run_rounds(search *s, round_run *round, uint64_t begun, uint64_t work,
                               double share) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    s->budget = begun + (uint64_t)(share * (double)work);
    s->ended = false;
    while (goes_on(s)) {
        row_list list = {0};
        starg_progress_step(context, s->scene.work - begun, work);
        STARG_TRY(starg_check_cancel(context, STAGE));
        status = row_list_make(context, 2 * s->points.count + s->cells.count, &list);
        if (status == STARG_OK)
            status = round(s, &list);
        row_list_free(context, &list);
        STARG_TRY(status);
    }
done:
    return status;
}

/* Integer programs over the points look for fewer guards. If there are none, what is known of the
 * points is renewed all the same. */
static starg_status close_and_resume(search *s) {
    size_t before = s->count;
    if (s->bound < before)
        TRY(search_close(s));
    else
        TRY(search_bound_points(s));
    if (s->count < before) {
        s->idle = 0;
        s->ended = false;
    }
    return STARG_OK;
}

static int count_closings(const search *s) {
    const starg_guard_options *o = s->problem->options;
    return !guard_is_brief(o)                ? CLOSINGS
           : o->effort == STARG_EFFORT_QUICK ? QUICK_CLOSINGS
                                             : SHORT_CLOSINGS;
}

/* Rounds of local search. With many guards, cover problems find in the points of a few rounds what
 * local search would need many for, so it begins anew from their guards. */
static starg_status run_improvement(search *s, uint64_t work) {
    uint64_t begun = s->scene.work;
    bool more = true;
    int closings = count_closings(s);
    for (int k = 0; k < closings && s->count >= MANY_GUARDS && more; k++) {
        TRY(run_rounds(s, search_improve, begun, work, (k + 1.0) / (closings + 1)));
        TRY(close_and_resume(s));
        s->budget = begun + work;
        more = goes_on(s);
    }
    if (more)
        TRY(run_rounds(s, search_improve, begun, work, 1));
    return STARG_OK;
}

/* Rounds of a proof, closed several times too: after work that does not depend on how much there
 * is, so that more work begins alike and never proves less. */
static starg_status run_proof(search *s, uint64_t work) {
    uint64_t begun = s->scene.work, next = FIRST_CLOSING;
    bool more = s->bound < s->count;
    s->finest = cell_length(&s->cells.data[0].box) * FIRST_FINEST / (double)s->count;
    s->ended = false;
    for (; more; next *= CLOSING_FACTOR) {
        double share = next < work ? (double)next / (double)work : 1;
        TRY(run_rounds(s, search_prove_round, begun, work, share));
        TRY(close_and_resume(s));
        s->budget = begun + work;
        more = share < 1 && goes_on(s);
    }
    return STARG_OK;
}

/* Looks for better guards. Where local search gives up early and the effort is to be the best,
 * cells show where else guards may stand: a proof begins, with what is left of the budget. Tests of
 * boxes take longer in larger models, so that there are fewer; where guards are few, one fewer is
 * worth more. */
static starg_status improve(search *s) {
    uint64_t begun = s->scene.work, work = search_improve_work(s);
    double most = MOST_CELL_WORK * pow(fmin(1, EASY_COLUMNS / (double)s->pool->columns), 5);
    most *= fmax(1, MANY_GUARDS / (double)s->count);
    TRY(run_improvement(s, work));
    double left = (double)work - (double)(s->scene.work - begun);
    const starg_guard_options *o = s->problem->options;
    if (o->prove || guard_is_brief(o) || s->bound == s->count || !(left > 0))
        TRY(close_and_resume(s));
    else
        TRY(run_proof(s, (uint64_t)fmin(left, most)));
    return STARG_OK;
}

static starg_status run(search *s, bool improves) {
    const starg_guard_options *o = s->problem->options;
    s->nodes = FEW_NODES;
    if (improves)
        TRY(improve(s));
    s->improve_work = s->scene.work;
    s->nodes = MANY_NODES;
    if (o->prove) {
        TRY(run_proof(s, (uint64_t)((double)o->prove_work / search_scene_unit(&s->scene))));
        TRY(search_prove_by_leaves(s));
    }
    if (s->bound < s->count)
        TRY(search_prove(s));
    return STARG_OK;
}

/* How often each column must be seen: as often as the guards see it, but at most as often as
 * required. */
static starg_status find_need(search *s, const guard_selection *selection) {
    const starg_bits *rows = s->pool->rows;
    NEW_ZERO(context_of(s), STAGE, s->need, 64 * rows->words);
    for (size_t i = 0; i < selection->chosen.count; i++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, selection->chosen.data[i])[w])
                s->need[64 * w + bit] += s->need[64 * w + bit] < s->redundancy;
    return STARG_OK;
}

static starg_status begin(search *s, const guard_detail *detail, const guard_selection *selection) {
    const guard_problem *p = s->problem;
    for (size_t i = 0; i < selection->chosen.count; i++)
        PUSH(p->context, STAGE, &s->guards, selection->chosen.data[i]);
    s->count = s->guards.count;
    TRY(search_note_guards(s));
    s->bound = s->bound > 0 ? s->bound : s->count > 0;
    s->redundancy = p->options->redundancy;
    s->first_count = pool_count(s->pool);
    TRY(search_scene_open(p->context, p->solid, &p->options->visibility, p->options->clearance,
                          &s->scene));
    TRY(find_need(s, selection));
    TRY(search_count_views(s));
    TRY(begin_points(s));
    TRY(begin_places(s, detail));
    TRY(cells_begin(&s->scene, &s->cells));
    return search_first_witnesses(s);
}

static void end(search *s) {
    prices_free(&s->prices);
    RELEASE(s->cells.data, s->points.data, s->guards.data, s->need, s->views, s->viewers,
            s->steps.data);
    starg_tell_best(context_of(s), 0, "");
    search_scene_close(&s->scene);
}

/* Adds 1 for each column of a row. */
static void count_columns(const starg_bits *rows, size_t row, uint32_t *counts) {
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, row)[w])
            counts[64 * w + bit]++;
}

/* The guards found, ordered by what each adds, descending. */
static starg_status order_guards(const search *s, starg_cover **out) {
    starg_cover_problem problem;
    starg_cover_options options;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    const starg_bits *all = s->pool->rows;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    TRY(starg_bits_create(context_of(s), s->count, all->columns, &rows));
    for (size_t i = 0; i < s->count; i++)
        memcpy(starg_bits_row_mutable(rows, i), starg_bits_row(all, s->guards.data[i]),
               all->words * sizeof *all->data);
    problem.rows = rows;
    problem.redundancy = (uint32_t)s->redundancy;
    options.method = STARG_COVER_GREEDY;
    TRY(starg_cover_solve(context_of(s), &problem, &options, out));
    for (size_t i = 0; i < (*out)->count; i++)
        (*out)->rows[i] = s->guards.data[(*out)->rows[i]];
    return STARG_OK;
}

/* Do the rows still suffice? Added candidates may see faces that none saw before, or that too few
 * saw for the redundancy. */
static starg_status check_enough(const search *s, const uint32_t *chosen, size_t count,
                                 bool *enough) {
    starg_context *context = context_of(s);
    const starg_bits *rows = s->pool->rows;
    SCOPED uint32_t *supply = NULL, *held = NULL;
    NEW_ZERO(context, STAGE, supply, 64 * rows->words);
    NEW_ZERO(context, STAGE, held, 64 * rows->words);
    for (size_t i = 0; i < rows->rows; i++)
        count_columns(rows, i, supply);
    for (size_t i = 0; i < count; i++)
        count_columns(rows, chosen[i], held);
    *enough = true;
    for (size_t j = 0; j < rows->columns; j++)
        *enough = *enough && (held[j] >= s->redundancy || held[j] == supply[j]);
    return STARG_OK;
}

/* Replaces the choice and its bound by the result. If added candidates see faces that none saw
 * before, the choice is made again over all candidates. */
static starg_status choose_again(search *s, guard_selection *selection) {
    starg_context *context = context_of(s);
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    SCOPED_BY(selection_free) guard_selection next = {0};
    bool enough = false;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = s->problem->options->max_nodes};
    TRY(check_enough(s, s->guards.data, s->count, &enough));
    if (!enough)
        TRY(choose_candidates(s->pool, &s->problem->weights, &how, &cover));
    else if (s->better)
        TRY(order_guards(s, &cover));
    size_t cover_bound = cover != NULL ? cover->lower_bound : 0;
    if (cover != NULL) {
        TRY(selection_of_cover(context, cover, selection, selection->level, &next));
        selection_free(selection);
        *selection = next;
        next = (guard_selection){0};
    }
    if (!enough || pool_count(s->pool) > s->first_count)
        selection->lower_bound = 0; /* it was a bound for fewer candidates */
    size_t bound = enough ? s->known : cover_bound;
    bound = bound > s->bound ? bound : s->bound;
    if (bound > selection->lower_bound)
        selection->lower_bound = bound;
    return STARG_OK;
}

static uint64_t in_microseconds(const search *s, uint64_t work) {
    return (uint64_t)((double)work * search_scene_unit(&s->scene));
}

starg_status search_guards(const guard_problem *problem, const guard_detail *detail, bool improves,
                           guard_pool *pool, guard_selection *selection, search_record *out) {
    starg_status status = STARG_OK;
    search s = {.problem = problem, .pool = pool, .bound = out->bound};
    bool keeps = problem->options->candidates == STARG_CANDIDATES_GIVEN;
    if (!improves && !problem->options->prove)
        return STARG_OK;
    starg_progress_begin(problem->context, STAGE);
    if (out->bound == 0)
        out->bound = problem->options->prove && selection->chosen.count > 0;
    if (starg_time_is_over(problem->context))
        goto done;
    STARG_TRY(begin(&s, detail, selection));
    STARG_TRY(run(&s, improves));
    selection->time_limited = selection->time_limited || starg_time_is_over(problem->context);
    if (problem->certificate != NULL && problem->certificate->proof.bound > 1)
        STARG_TRY(
            certificate_of_search(&s.scene, &s.cells, problem->options, problem->certificate));
    if (keeps) {
        pool_truncate(pool, s.first_count);
        selection->lower_bound =
            s.bound > selection->lower_bound ? s.bound : selection->lower_bound;
    } else
        STARG_TRY(choose_again(&s, selection));
    if (!problem->options->prove && s.bound < 2)
        s.bound = 0; /* no improvement */
    problem->context->work += in_microseconds(&s, s.scene.work);
    for (size_t i = 0; i < s.steps.count; i++)
        s.steps.data[i].work = in_microseconds(&s, s.steps.data[i].work);
    RELEASE(out->steps);
    *out = (search_record){s.bound,
                           s.cells.count,
                           s.scene.witnesses.count,
                           in_microseconds(&s, s.improve_work),
                           in_microseconds(&s, s.scene.work - s.improve_work),
                           0,
                           s.steps.count,
                           s.steps.data};
    s.steps.data = NULL;
done:
    end(&s);
    starg_progress_end(problem->context);
    return status;
}
