/* SPDX-License-Identifier: Apache-2.0 */
/* Set cover on bit rows: the working form, what shrinks it, covers, and bounds (cover.c is the
 * flow). Calls of the solver library: solver.h. What a function makes in a struct of the caller
 * is the caller's to free, on failure, too. */
#pragma once

#include "core/bits.h"
#include "starguard/cover.h"

/* ---- working form: relevant columns, identical ones merged, bits both ways (instance.c) ---- */

/* Sums of products of weights and counts. */
__extension__ typedef __int128 cover_wide;

typedef struct cover_instance {
    starg_context *context;
    size_t rows, columns;
    size_t row_words;    /* words per row: one bit per column */
    size_t column_words; /* words per column: one bit per row */
    size_t used_words;   /* words per row of row_used: one bit per word of the row */
    uint64_t *row_bits, *column_bits;
    uint64_t *row_used;     /* the words of a row that may hold bits: of large scenes, few */
    uint64_t *weights;      /* per column, positive; their sum is below 2^62 */
    uint32_t *demands;      /* per column, 1 to the number of its rows (before rows are dropped) */
    uint32_t *row_names;    /* per row: its index in the caller's matrix */
    uint32_t *column_names; /* per column: the first column it represents */
    uint64_t total;         /* sum of the weights */
} cover_instance;

/* Shared by the stages of one call. */
typedef struct cover_run {
    starg_context *context;
    size_t max_nodes;
    size_t nodes;      /* branch-and-bound nodes used so far */
    bool time_limited; /* the time limit cut some stage short */
    bool relaxed;      /* nothing beyond the linear relaxation */
    bool local;        /* full covers: nothing but a short local search */
    double *prices;    /* per column of the caller's matrix, or NULL */
} cover_run;

/* A list of row names. */
typedef STARG_ARRAY(uint32_t) cover_names;

static inline const uint64_t *cover_row(const cover_instance *instance, size_t row) {
    return instance->row_bits + row * instance->row_words;
}

/* Runs the body with W = index of each word of a row that may hold bits. */
#define COVER_FOR_WORDS(W, INSTANCE, ROW)                                                          \
    for (size_t used_ = 0; used_ < (INSTANCE)->used_words; used_++)                                \
        for (uint64_t words_ = (INSTANCE)->row_used[(ROW) * (INSTANCE)->used_words + used_],       \
                      W = 0;                                                                       \
             words_ != 0 && (W = 64 * used_ + (uint64_t)starg_bit_lowest(words_), 1);              \
             words_ &= words_ - 1)

static inline const uint64_t *cover_column(const cover_instance *instance, size_t column) {
    return instance->column_bits + column * instance->column_words;
}

/* True after the time limit; records that it cut something short. */
static inline bool cover_time_is_over(cover_run *run) {
    if (starg_time_is_over(run->context))
        run->time_limited = true;
    return run->time_limited;
}

/* Builds the working form of a checked problem; *given receives the weight covered by the given
 * rows, which is not part of the instance. Errors: MEMORY. */
starg_status cover_instance_build(starg_context *context, const starg_cover_problem *problem,
                                  cover_instance *out, uint64_t *given);

/* Extracts the rows and columns set in the masks (NULL: all). Weights, demands and names stay the
 * same. Errors: MEMORY. */
starg_status cover_instance_select(const cover_instance *from, const uint64_t *rows,
                                   const uint64_t *columns, cover_instance *out);

/* Leaves the rows set in the mask, in place. Errors: MEMORY, which leaves all. */
starg_status cover_instance_keep_rows(cover_instance *instance, const uint64_t *rows);

/* Frees the arrays and empties the instance; a zeroed one is allowed. */
void cover_instance_free(cover_instance *instance);

/* Sets the first `count` bits of a mask and clears the rest of its last word. */
void cover_mask_fill(uint64_t *mask, size_t count);

/* ---- the solvers behind the public function (cover.c, block.c, partial.c) ---- */

typedef struct cover_answer {
    cover_names rows;   /* first, so that SCOPED releases it */
    size_t lower_bound; /* no fewer rows reach the same */
    uint64_t weight;    /* covered by the rows; set by cover_solve_limited */
} cover_answer;

/* Full cover, with a bound. Reduces the instance in place. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_full(cover_run *run, cover_instance *instance, cover_answer *answer);

/* Covers the weight `goal`, more than 0 and less than the total; greedily unless `exact`. Errors:
 * MEMORY, CANCELLED. */
starg_status cover_solve_partial(cover_run *run, const cover_instance *instance, uint64_t goal,
                                 bool exact, cover_answer *answer);

/* Covers as much as `limit` rows (at least 1) can, up to `goal`; the answer's lower_bound is for
 * the weight it covers. *most: upper bound on the weight of `limit` rows. Searches for the optimum
 * if `exact`, otherwise greedy. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_limited(cover_run *run, const cover_instance *instance, size_t limit,
                                 uint64_t goal, bool exact, cover_answer *answer, uint64_t *most);

/* Greedy full cover, with the bound of a relaxed run. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_greedy(cover_run *run, const cover_instance *instance,
                                cover_answer *answer);

/* ---- the paper's four reductions [YL11, 3.3], generalized to demands (reduce.c) ---- */

/* (1) Sets the bits of the essential rows in a zeroed mask; returns their number. */
size_t cover_mark_essential(const cover_instance *instance, uint64_t *rows);

/* (2), (3) Clears the bits of redundant rows or columns in a full mask; returns how many it
 * cleared. At the time limit they stop early, which is harmless. Errors: MEMORY (columns only),
 * CANCELLED. */
starg_status cover_drop_dominated_rows(cover_run *run, const cover_instance *instance,
                                       uint64_t *rows, size_t *dropped);
starg_status cover_drop_dominated_columns(cover_run *run, const cover_instance *instance,
                                          uint64_t *columns, size_t *dropped);

/* Replaces the instance by the rest after choosing the rows of `taken` (their names go to
 * `forced`), keeping only the rows of `keep` (NULL: all). Errors: MEMORY. */
starg_status cover_take_rows(cover_instance *instance, const uint64_t *taken, const uint64_t *keep,
                             cover_names *forced);

/* Rules (1) to (3) to a fixpoint, for full covers. Appends the names of essential rows to `forced`;
 * the columns that force them get price 1 in `prices` (by name), if not NULL. *feasible is false if
 * some column has fewer rows than it demands (possible only if rows were dropped for other
 * reasons). Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_full(cover_run *run, cover_instance *instance, cover_names *forced,
                               double *prices, bool *feasible);

/* Rule (2), for a partial target or a limit on the rows. Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_partial(cover_run *run, cover_instance *instance);

/* (4) Numbers the blocks from 0 by their first rows: block[i] for each row. Every row must have a
 * column. Errors: MEMORY. */
starg_status cover_find_blocks(const cover_instance *instance, uint32_t *block, size_t *count);

/* ---- a changing choice of rows, and what each row would add or remove (state.c) ---- */

typedef struct cover_state {
    const cover_instance *instance;
    uint32_t *held;
    uint64_t *open, *last, *exact; /* masks of columns */
    uint64_t *taken;               /* mask of rows */
    uint32_t *rows;                /* the chosen rows, unordered */
    size_t count;
    uint64_t weight; /* of the covered columns */
} cover_state;

/* Creates a state without rows. Errors: MEMORY. */
starg_status cover_state_create(const cover_instance *instance, cover_state *out);
void cover_state_free(cover_state *state);

void cover_state_clear(cover_state *state);
void cover_state_copy(cover_state *to, const cover_state *from); /* of the same instance */
void cover_state_add(cover_state *state, size_t row);
void cover_state_remove(cover_state *state,
                        size_t position); /* index into `rows`; the last one moves there */

/* Sum of the weights of the columns of a row that are in the mask. */
uint64_t cover_weight_of(const cover_instance *instance, size_t row, const uint64_t *mask);

/* Weight of the columns of a row that still lack rows: never grows while rows are added. */
static inline uint64_t cover_state_need(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->open);
}

/* Weight that adding a row would cover at once. */
static inline uint64_t cover_state_gain(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->last);
}

/* Weight that removing a chosen row would uncover. */
static inline uint64_t cover_state_loss(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->exact);
}

/* Replaces `names` by the names of the chosen rows. Errors: MEMORY. */
starg_status cover_state_names(const cover_state *state, cover_names *names);

/* ---- heuristics: greedy, removal of redundant rows, swaps (greedy.c, improve.c) ---- */
/* All maximize the weight of covered columns; a full cover has the total weight as goal. */

/* Adds the row with the largest need (weight of its columns that still lack rows; ties: lowest
 * index) until the covered weight reaches `goal` or `limit` rows are chosen. Errors: MEMORY,
 * CANCELLED. */
starg_status cover_greedy(cover_run *run, cover_state *state, uint64_t goal, size_t limit);

/* Drops chosen rows, least loss first, while the covered weight stays at least `goal`. */
void cover_drop_needless(cover_state *state, uint64_t goal);

/* Swaps a chosen row for another while that covers more, until `goal` is reached or no swap helps.
 * Errors: CANCELLED. */
starg_status cover_swap(cover_run *run, cover_state *state, uint64_t goal);

/* Repeatedly tries to reach `goal` with one row less: drops the row of least loss, then swaps.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_shrink(cover_run *run, cover_state *state, uint64_t goal);

/* ---- local search for smaller full covers (local.c) ---- */

/* Improves `best`, a full cover, until it has at most `enough` rows or the search finds nothing for
 * long. Errors: MEMORY, CANCELLED. */
starg_status cover_local_search(cover_run *run, size_t enough, cover_state *best);

/* ---- lower bound on full covers: the Lagrangian dual, in integers (dual.c, lagrange.c) ---- */

/* 1 and the largest multiplier. With 2^32 columns, demands to 1,000 and multipliers of 16 rows the
 * terms stay below 2^32 x 2^10 x 2^24; instances that fit into memory (below 2^28 columns) stay
 * below 2^62. */
#define COVER_ONE  ((int64_t)1 << 20)
#define COVER_MOST (16 * COVER_ONE)

/* L(u) in units of COVER_ONE; `reduced` receives 1 - sum of u for each row, in the same units. */
int64_t cover_dual_value(const cover_instance *instance, const int64_t *multipliers,
                         int64_t *reduced);

/* The fewest rows that a dual value allows. */
static inline size_t cover_dual_rows(int64_t value) {
    return value <= 0 ? 0 : (size_t)((value + COVER_ONE - 1) / COVER_ONE);
}

/* The best known bound and its proof. */
typedef struct cover_dual {
    int64_t *multipliers;
    int64_t *reduced; /* of `multipliers` */
    int64_t value;    /* of `multipliers` */
} cover_dual;

/* Starts from the multipliers of dual ascent. Errors: MEMORY. */
starg_status cover_dual_create(const cover_instance *instance, cover_dual *out);
void cover_dual_free(cover_dual *dual);

/* Replaces the multipliers by others, with their reduced costs and value as from cover_dual_value,
 * if the value is larger. */
void cover_dual_offer(const cover_instance *instance, cover_dual *dual, const int64_t *multipliers,
                      const int64_t *reduced, int64_t value);

/* Improves the dual by the subgradient method, and `best`, a full cover, on the way; stops when
 * they meet. Errors: MEMORY, CANCELLED. */
starg_status cover_lagrange(cover_run *run, const cover_instance *instance, cover_dual *dual,
                            cover_state *best);

/* Reduced-cost fixing for covers of at most `most` rows: clears in `keep` the rows that no such
 * cover holds, sets in `take` the rows that all of them hold; true if there are any. */
bool cover_dual_fix(const cover_instance *instance, const cover_dual *dual, size_t most,
                    uint64_t *keep, uint64_t *take);

/* ---- linear relaxation of full covers (relax.c) ---- */

typedef struct cover_relaxation {
    double *solution;     /* per row: fraction chosen, 0 to 1 */
    double *surplus;      /* per column: coverage beyond its demand */
    int64_t *multipliers; /* per column: nearly optimal dual multipliers, integers >= 0, to be
                             proven by cover_dual_offer */
} cover_relaxation;

/* Solves the relaxation. *found is false if Clp failed. If it was cut short, the solution may
 * violate columns, but the multipliers still give a bound. Errors: MEMORY, CANCELLED. */
starg_status cover_relax(cover_run *run, const cover_instance *instance, cover_relaxation *out,
                         bool *found);
void cover_relaxation_free(cover_relaxation *relaxation);

/* ---- branch and bound by the solver library (ilp.c) ---- */

/* Improves `best`, a full cover, by branch and bound; new covers are checked on the bits. *bound:
 * no cover has fewer rows; 0 if nothing was proven. Errors: MEMORY, CANCELLED. */
starg_status cover_ilp_solve(cover_run *run, const cover_instance *instance, cover_state *best,
                             size_t *bound);

/* ---- upper bound on the weight that K rows cover (weight_bound.c, weight_relax.c) ---- */

/* A row with the sum of its multipliers. */
typedef struct cover_score {
    uint64_t score;
    uint32_t row;
} cover_score;

/* Sorts by score, largest first, ties by index. */
void cover_sort_scores(cover_score *scores, size_t count);

typedef struct cover_weight_bound {
    unsigned shift;
    uint64_t *multipliers; /* of the lowest bound found for `rows` rows */
    size_t rows;           /* K */
    uint64_t most;         /* no K rows cover more */
    uint64_t goal;         /* T */
    size_t least;          /* no fewer rows cover T */
    uint64_t *trial;       /* scratch: multipliers, their sums by 64, scores */
    uint64_t *word_sums;
    cover_score *scores;
} cover_weight_bound;

/* The largest useful multiplier: a covered column keeps nothing. */
static inline uint64_t cover_largest_multiplier(const cover_instance *instance,
                                                const cover_weight_bound *bound, size_t column) {
    return (instance->weights[column] << bound->shift) / instance->demands[column];
}

/* Bounds for `rows` rows and for the weight `goal`, from u(j) = w(j) / demand(j): the sum of the
 * heaviest rows. Errors: MEMORY. */
starg_status cover_weight_bound_create(const cover_instance *instance, size_t rows, uint64_t goal,
                                       cover_weight_bound *out);
void cover_weight_bound_free(cover_weight_bound *bound);

/* Changes the number of rows; bounds for the goal stay. */
void cover_weight_bound_restart(const cover_instance *instance, cover_weight_bound *bound,
                                size_t rows);

/* Applies the trial multipliers' bounds, and sorts the rows' scores by them. */
void cover_weight_bound_take(const cover_instance *instance, cover_weight_bound *bound);

/* Improves both by the linear relaxation: of the fewest rows for the goal, until `least` is at
 * least `enough`, or of the most weight for `rows` rows, until `most` is at most `enough`. A
 * failing solver or the time limit never worsens them. Errors: MEMORY, CANCELLED. */
starg_status cover_weight_bound_relax(cover_run *run, const cover_instance *instance, bool by_goal,
                                      uint64_t enough, cover_weight_bound *bound);

/* ---- branch and bound: the most weight that K rows can cover (search.c) ---- */
/* For partial targets and limited rows. Exact in integers. */

/* Finds at most `bound->rows` rows that cover more than `best` does and more than `floor`, and
 * stores the heaviest in `best`; stops once one covers `goal`. *exhausted tells that the search
 * finished: if it stored nothing there is no such choice, and if it did not reach the goal nothing
 * is heavier. Limits: max_nodes of the run, and 4,096 steps on matrix words per node. Errors:
 * MEMORY, CANCELLED. */
starg_status cover_search(cover_run *run, const cover_instance *instance,
                          const cover_weight_bound *bound, uint64_t floor, uint64_t goal,
                          cover_state *best, bool *exhausted);
