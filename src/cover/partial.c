/* SPDX-License-Identifier: Apache-2.0 */
/* A partial target, or a limit on the rows: bounds by weight_bound.c and the linear relaxation
 * (weight_relax.c), exact search by search.c. The fewest rows for a target are found by testing
 * each number of rows from the bound upwards, unless the matrix is so large that the search would
 * end in its first nodes. */
#include "cover/cover.h"

/* More bits are not searched. */
static const double MOST_SEARCHED = 0x1p28;

/* A good choice of few rows that reach the goal, by greedy, removal and swaps. */
static starg_status find_first_choice(cover_run *run, cover_state *choice, uint64_t goal) {
    TRY(cover_greedy(run, choice, goal, choice->instance->rows));
    cover_drop_needless(choice, goal);
    return cover_shrink(run, choice, goal);
}

/* Searches for `rows` rows that reach the goal; leaves `best` alone if there are none. */
static starg_status try_rows(cover_run *run, const cover_instance *instance, size_t rows,
                             cover_weight_bound *bound, cover_state *best, bool *decided) {
    SCOPED_BY(cover_state_free) cover_state found = {0};
    uint64_t goal = bound->goal;
    TRY(cover_state_create(instance, &found));
    cover_weight_bound_restart(instance, bound, rows);
    TRY(cover_weight_bound_relax(run, instance, false, goal - 1, bound));
    *decided = bound->most < goal;
    if (*decided || cover_time_is_over(run))
        return STARG_OK;
    TRY(cover_search(run, instance, bound, goal - 1, goal, &found, decided));
    if (found.weight >= goal) {
        cover_state_copy(best, &found);
        *decided = true;
    }
    return STARG_OK;
}

/* Closes the gap between the bound and the choice from below. */
static starg_status close_gap(cover_run *run, const cover_instance *instance,
                              cover_weight_bound *bound, cover_state *choice) {
    while (bound->least < choice->count && !cover_time_is_over(run)) {
        size_t rows = bound->least;
        bool decided;
        TRY(try_rows(run, instance, rows, bound, choice, &decided));
        if (!decided)
            break;
        if (choice->count > rows && bound->least <= rows)
            bound->least = rows + 1;
    }
    return STARG_OK;
}

starg_status cover_solve_partial(cover_run *run, const cover_instance *instance, uint64_t goal,
                                 bool exact, cover_answer *answer) {
    SCOPED_BY(cover_state_free) cover_state choice = {0};
    SCOPED_BY(cover_weight_bound_free) cover_weight_bound bound = {0};
    TRY(cover_state_create(instance, &choice));
    TRY(find_first_choice(run, &choice, goal));
    TRY(cover_weight_bound_create(instance, choice.count - 1, goal, &bound));
    TRY(cover_weight_bound_relax(run, instance, true, choice.count, &bound));
    if (exact && (double)instance->rows * (double)instance->columns <= MOST_SEARCHED)
        TRY(close_gap(run, instance, &bound, &choice));
    answer->lower_bound = bound.least;
    return cover_state_names(&choice, &answer->rows);
}

/* Raises the weight of the choice or lowers its upper bound until they meet. */
static starg_status close_weight_gap(cover_run *run, const cover_instance *instance, uint64_t goal,
                                     cover_weight_bound *bound, cover_state *choice) {
    bool exhausted;
    if (bound->most <= choice->weight || cover_time_is_over(run))
        return STARG_OK;
    TRY(cover_search(run, instance, bound, 0, goal, choice, &exhausted));
    if (exhausted && choice->weight < goal)
        bound->most = choice->weight;
    return STARG_OK;
}

/* Lower bound on the rows for the weight reached, at most the goal: by the multipliers of `limited`
 * or, if the choice should be the best there is, by a relaxation of its own. */
static starg_status bound_rows(cover_run *run, const cover_instance *instance,
                               const cover_state *choice, uint64_t goal, bool exact,
                               const cover_weight_bound *limited, size_t *least) {
    SCOPED_BY(cover_weight_bound_free) cover_weight_bound bound = {0};
    *least = 0;
    if (choice->count == 0)
        return STARG_OK;
    uint64_t reached = choice->weight < goal ? choice->weight : goal;
    TRY(cover_weight_bound_create(instance, choice->count - 1, reached, &bound));
    memcpy(bound.trial, limited->multipliers, instance->columns * sizeof *bound.trial);
    cover_weight_bound_take(instance, &bound);
    if (exact)
        TRY(cover_weight_bound_relax(run, instance, true, choice->count, &bound));
    *least = bound.least;
    return STARG_OK;
}

starg_status cover_solve_limited(cover_run *run, const cover_instance *instance, size_t limit,
                                 uint64_t goal, bool exact, cover_answer *answer, uint64_t *most) {
    SCOPED_BY(cover_state_free) cover_state choice = {0};
    SCOPED_BY(cover_weight_bound_free) cover_weight_bound bound = {0};
    TRY(cover_state_create(instance, &choice));
    TRY(cover_greedy(run, &choice, instance->total, limit));
    TRY(cover_swap(run, &choice, goal));
    TRY(cover_weight_bound_create(instance, limit, goal, &bound));
    if (choice.weight < goal)
        TRY(cover_weight_bound_relax(run, instance, false, choice.weight, &bound));
    if (exact && choice.weight < goal)
        TRY(close_weight_gap(run, instance, goal, &bound, &choice));
    cover_drop_needless(&choice, choice.weight < goal ? choice.weight : goal);
    TRY(bound_rows(run, instance, &choice, goal, exact, &bound, &answer->lower_bound));
    TRY(cover_state_names(&choice, &answer->rows));
    answer->weight = choice.weight;
    *most = bound.most;
    return STARG_OK;
}
