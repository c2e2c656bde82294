/* SPDX-License-Identifier: Apache-2.0 */
/* Public function: checks the problem, builds its working form, solves it for its target and, if
 * max_rows rows cannot reach that, for the most weight. */

#include "cover/cover.h"

STARG_DROP(starg_cover, starg_cover)

static const uint64_t WEIGHT_LIMIT = (uint64_t)1 << 62;

enum { MOST_REDUNDANCY = 1000 };

/* The result and the context that owns its memory. */
typedef struct owned_cover {
    starg_cover cover; /* first, so that pointers to it can be cast back */
    starg_context *context;
} owned_cover;

void starg_cover_problem_default(starg_cover_problem *problem) {
    *problem = (starg_cover_problem){.target = UINT64_MAX, .redundancy = 1};
}

void starg_cover_options_default(starg_cover_options *options) {
    *options = (starg_cover_options){.method = STARG_COVER_ILP, .max_nodes = 100000};
}

static starg_status check_weights(starg_context *context, const starg_cover_problem *problem) {
    uint64_t left = WEIGHT_LIMIT - 1;
    for (size_t j = 0; problem->weights != NULL && j < problem->rows->columns; j++) {
        if (problem->weights[j] > left)
            return starg_fail(context, STARG_ERROR_ARGUMENT, "cover",
                              "the weights up to column %zu sum to 2^62 or more; scale them down",
                              j);
        left -= problem->weights[j];
    }
    return STARG_OK;
}

static starg_status check(starg_context *context, const starg_cover_problem *problem,
                          const starg_cover_options *options) {
    if (problem->rows == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "cover", "the problem has no rows");
    if (problem->rows->rows >= UINT32_MAX || problem->rows->columns >= UINT32_MAX)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "cover",
                          "%zu rows and %zu columns are too many; the limit is 4294967294 each",
                          problem->rows->rows, problem->rows->columns);
    if (problem->redundancy < 1 || problem->redundancy > MOST_REDUNDANCY)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "cover",
                          "redundancy is %u; it must be between 1 and %d", problem->redundancy,
                          MOST_REDUNDANCY);
    for (size_t k = 0; k < problem->given_count; k++)
        if (problem->given[k] >= problem->rows->rows)
            return starg_fail(context, STARG_ERROR_ARGUMENT, "cover",
                              "given row %zu has the index %u; there are %zu rows", k,
                              problem->given[k], problem->rows->rows);
    if (options->method > STARG_COVER_LOCAL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "cover", "unknown method %d",
                          (int)options->method);
    return check_weights(context, problem);
}

static starg_status solve_all(cover_run *run, const cover_instance *instance, bool exact,
                              cover_answer *answer) {
    SCOPED_BY(cover_instance_free) cover_instance rest = {.context = run->context};
    if (!exact)
        return cover_solve_greedy(run, instance, answer);
    TRY(cover_instance_select(instance, NULL, NULL, &rest));
    return cover_solve_full(run, &rest, answer);
}

/* For a partial target or a limit, the instance loses its dominated rows. */
static starg_status solve_part(cover_run *run, cover_instance *instance, uint64_t goal, bool exact,
                               cover_answer *answer) {
    TRY(cover_reduce_partial(run, instance));
    return cover_solve_partial(run, instance, goal, exact, answer);
}

/* The fewest rows for the goal, ignoring max_rows. */
static starg_status solve_goal(cover_run *run, cover_instance *instance, uint64_t goal, bool exact,
                               cover_answer *answer) {
    if (goal == 0)
        return STARG_OK;
    if (goal == instance->total)
        return solve_all(run, instance, exact, answer);
    return solve_part(run, instance, goal, exact, answer);
}

/* The most weight with `limit` rows, and the fewest rows for the goal unless it takes more. */
static starg_status solve_limit(cover_run *run, cover_instance *instance, size_t limit,
                                uint64_t goal, bool exact, cover_answer *answer, uint64_t *most) {
    SCOPED cover_answer limited = {0};
    TRY(cover_reduce_partial(run, instance));
    TRY(cover_solve_limited(run, instance, limit, goal, exact, &limited, most));
    if (*most >= goal) {
        TRY(solve_goal(run, instance, goal, exact, answer));
        if (answer->rows.count <= limit) {
            *most = instance->total;
            return STARG_OK;
        }
        if (answer->lower_bound > limit)
            *most = goal - 1;
        if (limited.weight >= goal && limited.lower_bound < answer->lower_bound)
            limited.lower_bound = answer->lower_bound;
    }
    RELEASE(answer->rows.data, run->prices); /* prices are of full covers */
    run->prices = NULL;
    *answer = limited;
    limited = (cover_answer){0};
    return STARG_OK;
}

/* Sorts the chosen rows by what each adds; drops rows that add nothing. */
static starg_status order_rows(cover_run *run, const cover_instance *instance,
                               const cover_names *names, starg_cover *cover) {
    starg_context *context = run->context;
    SCOPED uint64_t *mask = NULL;
    SCOPED_BY(cover_instance_free) cover_instance chosen = {.context = context};
    SCOPED_BY(cover_state_free) cover_state state = {0};
    NEW_ZERO(context, "cover", mask, instance->column_words);
    for (size_t row = 0; row < instance->rows; row++)
        for (size_t i = 0; i < names->count; i++)
            if (instance->row_names[row] == names->data[i])
                starg_bit_set(mask, row);
    TRY(cover_instance_select(instance, mask, NULL, &chosen));
    TRY(cover_state_create(&chosen, &state));
    TRY(cover_greedy(run, &state, UINT64_MAX, chosen.rows));
    NEW(context, "cover", cover->rows, state.count);
    for (size_t i = 0; i < state.count; i++)
        cover->rows[i] = chosen.row_names[state.rows[i]];
    cover->count = state.count;
    cover->weight = state.weight;
    return STARG_OK;
}

static starg_status finish(cover_run *run, const cover_instance *instance,
                           const cover_answer *answer, uint64_t goal, uint64_t most, uint64_t given,
                           starg_cover **out) {
    owned_cover *owned;
    NEW_ZERO(run->context, "cover", owned, 1);
    owned->context = run->context;
    SCOPED_BY(starg_cover_drop) starg_cover *cover = &owned->cover;
    TRY(order_rows(run, instance, &answer->rows, cover));
    cover->target_reached = cover->weight >= goal;
    cover->weight += given;
    cover->weight_bound = most + given;
    cover->lower_bound = answer->lower_bound;
    cover->optimal = cover->count == cover->lower_bound;
    cover->time_limited = run->time_limited;
    cover->nodes = run->nodes;
    cover->prices = run->prices;
    run->prices = NULL;
    *out = cover;
    cover = NULL;
    return STARG_OK;
}

starg_status starg_cover_solve(starg_context *context, const starg_cover_problem *problem,
                               const starg_cover_options *options, starg_cover **out) {
    starg_status status = STARG_OK;
    starg_cover_options defaults;
    cover_instance instance = {.context = context};
    cover_answer answer = {0};
    cover_run run = {.context = context};
    uint64_t given;
    *out = NULL;
    starg_cover_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    STARG_TRY(check(context, problem, options));
    STARG_TRY(starg_check_cancel(context, "cover"));
    run.max_nodes = options->max_nodes;
    bool exact = options->method != STARG_COVER_GREEDY;
    run.relaxed = !exact || options->method == STARG_COVER_LP;
    run.local = options->method == STARG_COVER_LOCAL;
    STARG_TRY(cover_instance_build(context, problem, &instance, &given));
    uint64_t goal = problem->target > given ? problem->target - given : 0;
    if (goal > instance.total)
        goal = instance.total;
    uint64_t most = instance.total;
    if (options->prices && exact && goal == instance.total)
        STARG_NEW_ZERO(context, "cover", run.prices, problem->rows->columns);
    if (problem->max_rows == 0)
        STARG_TRY(solve_goal(&run, &instance, goal, exact, &answer));
    else
        STARG_TRY(solve_limit(&run, &instance, problem->max_rows, goal, exact, &answer, &most));
    STARG_TRY(finish(&run, &instance, &answer, goal, most, given, out));
done:
    RELEASE(run.prices, answer.rows.data);
    cover_instance_free(&instance);
    return status;
}

void starg_cover_free(starg_cover *cover) {
    if (cover == NULL)
        return;
    owned_cover *owned = (owned_cover *)cover;
    RELEASE(cover->rows, cover->prices, owned);
}
