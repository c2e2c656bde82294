/* SPDX-License-Identifier: Apache-2.0 */
/* The incumbent of a search: its best guards, the bound for guards anywhere, and the choice that
 * becomes of them.
 *
 * Candidates added by a search may see faces that none saw before, or that too few saw for the
 * redundancy; then the choice is made again over all candidates.
 *
 * Invariant: the bound never falls, and the number of guards never rises. */
#include "guard/search_parts.h"
#include "starguard/cover.h"

static const char STAGE[] = "search";

starg_status incumbent_take(starg_context *context, const uint32_t *guards, size_t count,
                            uint64_t work, search_incumbent *best) {
    best->guards.count = 0;
    for (size_t i = 0; i < count; i++)
        PUSH(context, STAGE, &best->guards, guards[i]);
    PUSH(context, STAGE, &best->steps, ((search_step){work, count}));
    starg_tell_best(context, count, "guards");
    return STARG_OK;
}

bool incumbent_raise(search_incumbent *best, size_t bound) {
    bool higher = bound > best->bound;
    best->bound = higher ? bound : best->bound;
    return higher;
}

/* The guards found, ordered by what each adds, descending. */
static starg_status order_guards(const search *s, starg_cover **out) {
    const uint32_t *guards = s->best.guards.data;
    starg_cover_problem problem;
    starg_cover_options options;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    TRY(pool_copy_rows(s->pool, guards, s->best.guards.count, &rows));
    problem.rows = rows;
    problem.redundancy = s->problem->options->redundancy;
    options.method = STARG_COVER_GREEDY;
    TRY(starg_cover_solve(s->problem->context, &problem, &options, out));
    for (size_t i = 0; i < (*out)->count; i++)
        (*out)->rows[i] = guards[(*out)->rows[i]];
    return STARG_OK;
}

/* Do the guards still suffice? */
static starg_status check_enough(const search *s, bool *enough) {
    const search_incumbent *best = &s->best;
    SCOPED uint32_t *supply = NULL;
    TRY(pool_supply(s->pool, &supply));
    *enough = true;
    for (size_t j = 0; j < s->pool->columns && *enough; j++) {
        uint32_t held = 0;
        for (size_t i = 0; i < best->guards.count; i++)
            held += starg_bits_test(s->pool->rows, best->guards.data[i], j);
        *enough = held >= s->problem->options->redundancy || held == supply[j];
    }
    return STARG_OK;
}

starg_status incumbent_choose(const search *s, size_t first_count, guard_selection *selection) {
    starg_context *context = s->problem->context;
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    SCOPED_BY(selection_free) guard_selection next = {0};
    bool enough = false;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = s->problem->options->max_nodes};
    TRY(check_enough(s, &enough));
    if (!enough)
        TRY(choose_candidates(s->pool, &s->problem->weights, &how, &cover));
    else if (s->best.steps.count > 1)
        TRY(order_guards(s, &cover));
    size_t cover_bound = cover != NULL ? cover->lower_bound : 0;
    if (cover != NULL) {
        TRY(selection_of_cover(context, cover, selection, selection->level, &next));
        selection_free(selection);
        *selection = next;
        next = (guard_selection){0};
    }
    if (!enough || pool_count(s->pool) > first_count)
        selection->lower_bound = 0; /* it was a bound for fewer candidates */
    size_t bound = enough ? s->points.bound : cover_bound;
    bound = bound > s->best.bound ? bound : s->best.bound;
    if (bound > selection->lower_bound)
        selection->lower_bound = bound;
    return STARG_OK;
}
