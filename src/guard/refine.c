/* SPDX-License-Identifier: Apache-2.0 */
/* Refinement: better places than the candidates that there were, the paper's future work.
 *
 * Rounds of column generation: the linear relaxation of the cover problem gives a bound and prices;
 * points where a candidate pays by these prices
 * are looked for (guard/pricing.c) and added. It ends when none is found, when the sight lines are
 * spent, after ROUNDS, or when the bound, a whole number of guards, has not fallen PATIENCE times;
 * then the problem over all candidates, old and new, is solved by branch and bound. What was chosen
 * before stays where it is as good.
 *
 * Guards that stay keep their level; new ones get that of the model. The bound is that of the last
 * problem, over everything that was added. Cost: the sight
 * lines, and a linear program a round. */
#include "core/bits.h"
#include "core/memory.h"
#include "guard/pricing.h"
#include "guard/stages.h"

static const char STAGE[] = "refine";

enum { ROUNDS = 12, PATIENCE = 4 };

typedef struct refinement {
    const guard_problem *problem;
    guard_pool *pool;      /* grows round by round           */
    guard_selection *best; /* of what has been in it so far  */
    pricing prices;
} refinement;

/* Adds 1 for each column of a row. */
static void count_columns(const starg_bits *rows, size_t row, uint32_t *counts) {
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, row)[w]) {
            counts[64 * w + bit]++;
        }
}

/* Are the chosen still enough? Candidates that were added may see what none did before, or what
 * too few did for the redundancy. */
static starg_status check_chosen(const refinement *r, bool *enough) {
    starg_status status = STARG_OK;
    starg_context *context = r->problem->context;
    const starg_bits *rows = r->pool->rows;
    uint32_t *supply = NULL, *held = NULL;
    STARG_NEW_ZERO(context, STAGE, supply, rows->columns);
    STARG_NEW_ZERO(context, STAGE, held, rows->columns);
    for (size_t i = 0; i < rows->rows; i++)
        count_columns(rows, i, supply);
    for (size_t i = 0; i < r->best->chosen.count; i++)
        count_columns(rows, r->best->chosen.data[i], held);
    *enough = true;
    for (size_t j = 0; j < rows->columns; j++)
        *enough = *enough && (held[j] >= r->problem->options->redundancy || held[j] == supply[j]);
done:
    starg_release(context, supply);
    starg_release(context, held);
    return status;
}

/* Chooses among all candidates, and takes what is chosen if it is fewer than `most`. */
static starg_status choose_again(refinement *r, const choice *how, size_t most, starg_cover **out) {
    starg_status status = STARG_OK;
    starg_context *context = r->problem->context;
    guard_selection next = {0};
    STARG_TRY(choose_candidates(r->pool, &r->problem->weights, how, out));
    if ((*out)->count < most) {
        STARG_TRY(selection_of_cover(context, *out, r->best, r->best->level, &next));
        selection_free(context, r->best);
        *r->best = next;
        next = (guard_selection){0};
    }
    r->best->lower_bound = (*out)->lower_bound;
done:
    selection_free(context, &next);
    return status;
}

/* One round. *bound: the fewest candidates that the linear relaxation allows; *again: points were
 * found and added. */
static starg_status add_round(refinement *r, size_t *bound, bool *again) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    candidate_points found = {0};
    const choice how = {.method = STARG_COVER_LP, .prices = true};
    STARG_TRY(choose_again(r, &how, r->best->chosen.count, &cover));
    *bound = cover->lower_bound;
    r->prices.prices = cover->prices;
    STARG_TRY(price_candidates(&r->prices, &found));
    *again = found.data.count > 0;
    if (*again)
        STARG_TRY(pool_add(r->pool, &found));
done:
    candidates_free(r->problem->context, &found);
    starg_cover_free(cover);
    return status;
}

static starg_status add_rounds(refinement *r) {
    starg_status status = STARG_OK;
    size_t best = SIZE_MAX;
    int idle = 0;
    bool again = true;
    while (again && idle < PATIENCE && r->prices.lines_left > 0 && !r->best->time_limited) {
        size_t bound;
        starg_progress_step(r->problem->context, r->prices.round, ROUNDS);
        STARG_TRY(add_round(r, &bound, &again));
        idle = bound < best ? 0 : idle + 1;
        best = bound < best ? bound : best;
        r->prices.round++;
        again = again && r->prices.round < ROUNDS;
        r->best->time_limited = starg_time_is_over(r->problem->context);
    }
done:
    return status;
}

/* The medial axis, unless guards stand there already. None where the time does not last for it. */
static starg_status find_places(const guard_problem *problem, const guard_detail *detail,
                                candidate_points *places, bool *time_limited) {
    const candidate_shape shape = guard_shape(problem, detail);
    *time_limited = false;
    if (problem->options->candidates == STARG_CANDIDATES_MEDIAL)
        return STARG_OK;
    starg_status status = candidates_find(problem->context, &shape, STARG_CANDIDATES_MEDIAL,
                                          problem->options->candidate_count, places);
    *time_limited = status == STARG_ERROR_TIME;
    return *time_limited ? STARG_OK : status;
}

starg_status refine_guards(const guard_problem *problem, const guard_detail *detail,
                           const guard_selection *first, guard_pool *pool, guard_selection *out,
                           uint64_t *lines_tested) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    candidate_points places = {0};
    uint64_t lines = problem->options->refine_lines;
    refinement r = {.problem = problem,
                    .pool = pool,
                    .best = out,
                    .prices = {.pool = pool, .places = &places, .lines_left = lines}};
    const choice last = {.method = STARG_COVER_ILP, .max_nodes = problem->options->max_nodes};
    bool enough = false, time_limited;
    starg_progress_begin(problem->context, STAGE);
    STARG_TRY(selection_copy(problem->context, first, out));
    STARG_TRY(find_places(problem, detail, &places, &time_limited));
    out->time_limited = first->time_limited || time_limited;
    STARG_TRY(add_rounds(&r));
    *lines_tested = lines - r.prices.lines_left;
    STARG_TRY(check_chosen(&r, &enough));
    STARG_TRY(choose_again(&r, &last, enough ? out->chosen.count : SIZE_MAX, &cover));
done:
    starg_progress_end(problem->context);
    candidates_free(problem->context, &places);
    starg_cover_free(cover);
    return status;
}
