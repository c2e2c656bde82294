/* SPDX-License-Identifier: Apache-2.0 */
/* The fewest guards over every point of the free space, and a lower bound on their number.
 *
 * Problem. Guards may stand anywhere; find a lower bound that holds for all of them, and guards as
 * close to it as possible [after exact solvers for the art gallery problem in the plane: Tozoni, de
 * Rezende, de Souza 2016].
 *
 * Witnesses are a subset of the faces: guards that see everything see these, so a bound for them is
 * a bound for all. Cells (guard/cells.h) cover the whole space, and each stores the witnesses that
 * it may see. Points are candidates, moved points, and points of cells. The first phase only looks
 * for guards (guard/search_improve.c). The second, short unless a proof is asked for, improves both
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

#include "guard/prices.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum {
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

/* The share of the best effort that proofs get even if nothing is left of it: their cells also show
 * where else guards may stand. */
static const double LEAST_PROOF = 0.4;

typedef enum search_phase { PHASE_IMPROVE = 0, PHASE_PROVE = 1 } search_phase;

static bool is_met(const search *s) {
    return s->best.bound >= s->best.guards.count;
}

static bool goes_on(const search *s, uint64_t budget) {
    return !is_met(s) && s->effort.work < budget && !starg_time_is_over(s->problem->context);
}

/* Rounds of a phase, until a share of the work that was planned at `begun` is done. *ended: another
 * round would be in vain. */
static starg_status run_rounds(search *s, search_phase phase, uint64_t begun, uint64_t work,
                               double share, bool *ended) {
    starg_context *context = s->problem->context;
    s->effort.budget = begun + (uint64_t)(share * (double)work);
    *ended = false;
    while (!*ended && goes_on(s, s->effort.budget)) {
        SCOPED_BY(row_list_free) row_list list = {0};
        starg_progress_step(context, s->effort.work - begun, work);
        TRY(starg_check_cancel(context, STAGE));
        TRY(row_list_make(&s->duals, &list));
        TRY((phase == PHASE_IMPROVE ? search_improve : search_prove)(s, &list, ended));
    }
    return STARG_OK;
}

/* The share of the work after which integer programs close rounds for the k-th time. With many
 * guards they find in the points of a few rounds what local search would need many for, so it
 * begins anew from their guards. Proofs are closed after work that does not depend on how much
 * there is, so that more work begins alike and never proves less. */
static double next_closing(const search *s, search_phase phase, int k, uint64_t work) {
    const starg_guard_options *o = s->problem->options;
    uint64_t next = FIRST_CLOSING;
    int closings = !guard_is_brief(o)                ? CLOSINGS
                   : o->effort == STARG_EFFORT_QUICK ? QUICK_CLOSINGS
                                                     : SHORT_CLOSINGS;
    for (int i = 0; i < k; i++)
        next *= CLOSING_FACTOR;
    if (phase == PHASE_PROVE)
        return next < work ? (double)next / (double)work : 1;
    return k < closings && s->best.guards.count >= MANY_GUARDS ? (k + 1.0) / (closings + 1) : 1;
}

/* A phase closes several times, and proofs at their end. */
static starg_status run_phase(search *s, search_phase phase, uint64_t work) {
    const uint64_t begun = s->effort.work;
    const double extent = cell_length(&s->cells.data[0].box), guards = (double)s->best.guards.count;
    double share = 0;
    bool ended, better, more = phase == PHASE_IMPROVE || !is_met(s);
    if (phase == PHASE_PROVE)
        duals_set_finest(&s->duals, extent * FIRST_FINEST / guards);
    for (int k = 0; more; k++) {
        share = next_closing(s, phase, k, work);
        TRY(run_rounds(s, phase, begun, work, share, &ended));
        if (share >= 1 && phase == PHASE_IMPROVE)
            return STARG_OK;
        TRY(search_close(s, &better));
        more = share < 1 && (better || !ended) && goes_on(s, begun + work);
    }
    return STARG_OK;
}

/* Tests of boxes take longer in larger models, so that there are fewer; where guards are few, one
 * fewer is worth more. */
static double most_cell_work(const search *s) {
    double most = MOST_CELL_WORK * pow(fmin(1, EASY_COLUMNS / (double)s->pool->columns), 5);
    return most * fmax(1, MANY_GUARDS / (double)s->best.guards.count);
}

/* All phases. If the effort is to be the best, a proof begins with what is left of the budget, and
 * at least with LEAST_PROOF of it. *improving: the work for better guards. */
static starg_status run(search *s, bool improves, uint64_t *improving) {
    const starg_guard_options *o = s->problem->options;
    s->effort.nodes = FEW_NODES;
    if (improves) {
        const double most = most_cell_work(s);
        const uint64_t begun = s->effort.work, work = search_improve_work(s);
        bool better;
        TRY(run_phase(s, PHASE_IMPROVE, work));
        const double left = (double)work - (double)(s->effort.work - begun);
        if (o->prove || guard_is_brief(o) || is_met(s))
            TRY(search_close(s, &better));
        else
            TRY(run_phase(s, PHASE_PROVE,
                          (uint64_t)fmax(fmin(left, most), LEAST_PROOF * (double)work)));
    }
    *improving = s->effort.work;
    s->effort.nodes = MANY_NODES;
    if (o->prove) {
        double work = (double)o->prove_work / search_scene_unit(&s->witnesses.scene);
        TRY(run_phase(s, PHASE_PROVE, (uint64_t)work));
        TRY(search_prove_by_leaves(s));
    }
    return is_met(s) ? STARG_OK : search_prove_by_prices(s);
}

static starg_status begin(search *s, const guard_detail *detail, const guard_selection *selection) {
    const guard_problem *p = s->problem;
    const size_t count = selection->chosen.count;
    s->duals.witnesses = &s->witnesses;
    s->duals.points = &s->points;
    s->duals.cells = &s->cells;
    TRY(incumbent_take(p->context, selection->chosen.data, count, 0, &s->best));
    incumbent_raise(&s->best, count > 0);
    TRY(witness_set_begin(p, s->pool, selection, &s->witnesses));
    TRY(points_begin(p, detail, s->pool, &s->points));
    TRY(cells_begin(&s->witnesses.scene, &s->cells));
    return search_first_witnesses(s);
}

static void end(search *s) {
    prices_free(&s->duals.prices);
    RELEASE(s->cells.data, s->points.data, s->best.guards.data, s->best.steps.data);
    witness_set_end(&s->witnesses);
    starg_tell_best(s->problem->context, 0, "");
}

static uint64_t in_microseconds(const search *s, uint64_t work) {
    return (uint64_t)((double)work * search_scene_unit(&s->witnesses.scene));
}

/* What the search did, and its bound unless that is no improvement. */
static void report(search *s, uint64_t improving, search_record *out) {
    search_incumbent *best = &s->best;
    for (size_t i = 0; i < best->steps.count; i++)
        best->steps.data[i].work = in_microseconds(s, best->steps.data[i].work);
    RELEASE(out->steps);
    *out = (search_record){.bound = s->problem->options->prove || best->bound > 1 ? best->bound : 0,
                           .cells = s->cells.count,
                           .witnesses = s->witnesses.scene.witnesses.count,
                           .improve_work = in_microseconds(s, improving),
                           .prove_work = in_microseconds(s, s->effort.work - improving),
                           .step_count = best->steps.count,
                           .steps = best->steps.data};
    best->steps.data = NULL;
}

starg_status search_guards(const guard_problem *problem, const guard_detail *detail, bool improves,
                           guard_pool *pool, guard_selection *selection, search_record *out) {
    starg_context *context = problem->context;
    const starg_guard_options *o = problem->options;
    guard_certificate *why = problem->certificate;
    size_t first_count = pool_count(pool);
    uint64_t improving;
    if (!guard_searches(o))
        return STARG_OK;
    IN_STAGE(context, STAGE);
    SCOPED_BY(end)
    search s = {.problem = problem, .pool = pool, .best.bound = out->bound};
    if (out->bound == 0)
        out->bound = o->prove && selection->chosen.count > 0;
    if (starg_time_is_over(context))
        return STARG_OK;
    TRY(begin(&s, detail, selection));
    TRY(run(&s, improves, &improving));
    selection->time_limited = selection->time_limited || starg_time_is_over(context);
    if (why != NULL && why->proof.bound > 1)
        TRY(certificate_of_search(&s.witnesses.scene, &s.cells, o, why));
    if (o->candidates == STARG_CANDIDATES_GIVEN) {
        pool_truncate(pool, first_count);
        if (s.best.bound > selection->lower_bound)
            selection->lower_bound = s.best.bound;
    } else
        TRY(incumbent_choose(&s, first_count, selection));
    context->work += in_microseconds(&s, s.effort.work);
    report(&s, improving, out);
    return STARG_OK;
}
