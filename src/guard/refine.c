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
#include "guard/job.h"
#include "guard/pricing.h"

static const char STAGE[] = "refine";

enum { ROUNDS = 12, PATIENCE = 4 };

static int finest_level(const guard_job *job) {
    return job->records.count > 0 ? (int)job->records.count - 1 : 0;
}

/* Adds 1 for each column of a row. */
static void count_columns(const starg_bits *rows, size_t row, uint32_t *counts) {
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, row)[w]) {
            counts[64 * w + bit]++;
        }
}

/* Are the chosen still enough? Candidates that were added may see what none did before, or what
 * too few did for the redundancy. */
static starg_status check_chosen(const guard_job *job, bool *enough) {
    starg_status status = STARG_OK;
    const starg_bits *rows = job->pool.rows;
    uint32_t *supply = NULL, *held = NULL;
    STARG_NEW_ZERO(job->context, STAGE, supply, rows->columns);
    STARG_NEW_ZERO(job->context, STAGE, held, rows->columns);
    for (size_t i = 0; i < rows->rows; i++)
        count_columns(rows, i, supply);
    for (size_t i = 0; i < job->chosen.count; i++)
        count_columns(rows, job->chosen.data[i], held);
    *enough = true;
    for (size_t j = 0; j < rows->columns; j++)
        *enough = *enough && (held[j] >= job->options->redundancy || held[j] == supply[j]);
done:
    starg_release(job->context, supply);
    starg_release(job->context, held);
    return status;
}

/* Chooses among all candidates, and takes what is chosen if it is fewer than `most`. */
static starg_status choose_again(guard_job *job, const choice *how, size_t most,
                                 starg_cover **out) {
    starg_status status = STARG_OK;
    STARG_TRY(choose_candidates(&job->pool, &job->weights, how, out));
    if ((*out)->count < most)
        STARG_TRY(job_take_cover(job, *out, finest_level(job)));
    job->lower_bound = (*out)->lower_bound;
done:
    return status;
}

/* One round. *bound: the fewest candidates that the linear relaxation allows; *again: points were
 * found and added. */
static starg_status add_round(guard_job *job, pricing *prices, size_t *bound, bool *again) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    candidate_points found = {0};
    const choice how = {.method = STARG_COVER_LP, .prices = true};
    STARG_TRY(choose_again(job, &how, job->chosen.count, &cover));
    *bound = cover->lower_bound;
    prices->prices = cover->prices;
    STARG_TRY(price_candidates(prices, &found));
    *again = found.data.count > 0;
    if (*again)
        STARG_TRY(pool_add(&job->pool, &found));
done:
    candidates_free(job->context, &found);
    starg_cover_free(cover);
    return status;
}

static starg_status add_rounds(guard_job *job, pricing *prices) {
    starg_status status = STARG_OK;
    size_t best = SIZE_MAX;
    int idle = 0;
    bool again = true;
    while (again && idle < PATIENCE && prices->lines_left > 0 && !job->time_limited) {
        size_t bound;
        starg_progress_step(job->context, prices->round, ROUNDS);
        STARG_TRY(add_round(job, prices, &bound, &again));
        idle = bound < best ? 0 : idle + 1;
        best = bound < best ? bound : best;
        prices->round++;
        again = again && prices->round < ROUNDS;
        job->time_limited = starg_time_is_over(job->context);
    }
done:
    return status;
}

/* The medial axis, unless guards stand there already. None where the time does not last for it:
 * then no round follows. */
static starg_status find_places(guard_job *job, candidate_points *places) {
    if (job->options->candidates == STARG_CANDIDATES_MEDIAL)
        return STARG_OK;
    starg_status status = candidates_find(job->context, &job->shape, STARG_CANDIDATES_MEDIAL,
                                          job->options->candidate_count, places);
    if (status != STARG_ERROR_TIME)
        return status;
    job->time_limited = true;
    return STARG_OK;
}

starg_status refine_guards(guard_job *job) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    candidate_points places = {0};
    pricing prices = {
        .pool = &job->pool, .places = &places, .lines_left = job->options->refine_lines};
    const choice last = {.method = STARG_COVER_ILP, .max_nodes = job->options->max_nodes};
    bool enough = false;
    starg_progress_begin(job->context, STAGE);
    STARG_TRY(find_places(job, &places));
    STARG_TRY(add_rounds(job, &prices));
    job->lines_tested = job->options->refine_lines - prices.lines_left;
    STARG_TRY(check_chosen(job, &enough));
    STARG_TRY(choose_again(job, &last, enough ? job->chosen.count : SIZE_MAX, &cover));
done:
    starg_progress_end(job->context);
    candidates_free(job->context, &places);
    starg_cover_free(cover);
    return status;
}
