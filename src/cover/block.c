/* SPDX-License-Identifier: Apache-2.0 */
/* Full covers: reductions, blocks, and for each block
 *   1. a greedy cover, improved by swaps;
 *   2. rounds of: Lagrangian bound (with covers from its reduced costs), local search down to that
 *      bound, the bound of the linear relaxation if that is not enough, reduced-cost fixing,
 *      reductions of the rest;
 *   3. branch and bound on the rest.
 * Each step ends as soon as the bound meets the cover. A relaxed run computes the bound of the
 * linear relaxation at once and stops there; a local one stops after a short local search.
 *
 * Invariant of a block: every cover with fewer rows than the best one consists of the forced rows
 * and a cover of the rest. */
#include "core/parallel.h"
#include "cover/cover.h"

/* Large programs are slow per node and even in their relaxation: runs with few nodes leave them to
 * the Lagrangian bound and the local search. */
enum { RELAXATION_ENTRIES = 2000000, NODE_ENTRIES = 3000 };

typedef struct block_solve {
    cover_run *run;
    cover_instance rest;
    cover_names forced; /* rows of every better cover */
    cover_names best;   /* best cover of the block */
    size_t lower_bound;
    bool priced; /* the run's prices include the block's */
} block_solve;

static bool is_closed(const block_solve *block) {
    return block->lower_bound >= block->best.count;
}

/* Does the run leave blocks as the first round found them? */
static bool is_brief(const block_solve *block) {
    return block->run->relaxed || block->run->local;
}

/* No cover has fewer than `rows` rows besides the forced ones, unless the best cover is optimal. */
static void raise_bound(block_solve *block, size_t rows) {
    size_t bound = block->forced.count + rows;
    if (bound > block->best.count)
        bound = block->best.count;
    if (bound > block->lower_bound)
        block->lower_bound = bound;
}

/* Makes the forced rows and a cover of the rest the best cover if that is smaller. */
static starg_status offer_cover(block_solve *block, const cover_state *cover) {
    if (block->forced.count + cover->count >= block->best.count)
        return STARG_OK;
    block->best.count = 0;
    for (size_t i = 0; i < block->forced.count; i++)
        PUSH(block->run->context, "cover", &block->best, block->forced.data[i]);
    for (size_t i = 0; i < cover->count; i++)
        PUSH(block->run->context, "cover", &block->best, block->rest.row_names[cover->rows[i]]);
    return STARG_OK;
}

static starg_status find_first_cover(cover_run *run, const cover_instance *instance,
                                     cover_state *cover) {
    TRY(cover_greedy(run, cover, instance->total, instance->rows));
    cover_drop_needless(cover, instance->total);
    return cover_shrink(run, cover, instance->total);
}

static bool is_too_large(const block_solve *block, size_t allowance) {
    const cover_instance *rest = &block->rest;
    size_t nodes = block->run->max_nodes;
    size_t entries = starg_bit_count(rest->row_bits, rest->rows * rest->row_words);
    return entries > allowance && (entries - allowance) / NODE_ENTRIES > nodes;
}

/* The linear relaxation. *found: it was solved. */
static starg_status relax(const block_solve *block, cover_relaxation *out, bool *found) {
    *found = false;
    cover_relaxation_free(out); /* of a try that found nothing */
    return is_too_large(block, RELAXATION_ENTRIES)
               ? STARG_OK
               : cover_relax(block->run, &block->rest, out, found);
}

/* Improves the multipliers by the linear relaxation where the subgradient method was not enough. */
static starg_status take_relaxation(block_solve *block, const cover_relaxation *relaxation,
                                    cover_dual *dual) {
    SCOPED int64_t *reduced = NULL;
    const int64_t *multipliers = relaxation->multipliers;
    NEW(block->run->context, "bound", reduced, block->rest.rows);
    int64_t value = cover_dual_value(&block->rest, multipliers, reduced);
    cover_dual_offer(&block->rest, dual, multipliers, reduced, value);
    raise_bound(block, cover_dual_rows(dual->value));
    return STARG_OK;
}

/* A smaller cover, and beside it, if there is a thread for that, the relaxation that may be needed
 * after it. */
typedef struct cover_and_bound {
    block_solve *block;
    size_t enough;
    cover_state *cover;
    cover_relaxation *relaxation;
    bool relaxed;
} cover_and_bound;

static starg_status find_either(starg_context *context, void *shared, void *scratch, size_t item) {
    cover_and_bound *both = shared;
    (void)context;
    (void)scratch;
    return item == 0 ? cover_local_search(both->block->run, both->enough, both->cover)
                     : relax(both->block, both->relaxation, &both->relaxed);
}

static starg_status bound_rest(block_solve *block, cover_dual *dual, cover_state *cover) {
    cover_run *run = block->run;
    SCOPED_BY(cover_relaxation_free) cover_relaxation relaxation = {0};
    cover_and_bound both = {.block = block, .cover = cover, .relaxation = &relaxation};
    if (run->relaxed) {
        TRY(relax(block, &relaxation, &both.relaxed));
        if (both.relaxed)
            return take_relaxation(block, &relaxation, dual);
    }
    if (run->local) {
        TRY(cover_local_search(run, 1, cover));
        return offer_cover(block, cover);
    }
    TRY(cover_lagrange(run, &block->rest, dual, cover));
    both.enough = cover_dual_rows(dual->value);
    const starg_parallel_loop loop = {.stage = "bound",
                                      .count = run->context->threads > 1 ? 2 : 1,
                                      .shared = &both,
                                      .item = find_either,
                                      .silent = true};
    TRY(starg_parallel_for(run->context, &loop));
    TRY(offer_cover(block, cover));
    raise_bound(block, both.enough);
    if (is_closed(block) || cover_time_is_over(run))
        return STARG_OK;
    if (loop.count == 1)
        TRY(relax(block, &relaxation, &both.relaxed));
    return both.relaxed ? take_relaxation(block, &relaxation, dual) : STARG_OK;
}

/* Fixes rows by reduced costs and reduces the rest; *again tells whether another round pays: at
 * least one row in twenty is gone. */
static starg_status fix_rest(block_solve *block, const cover_dual *dual, bool *again) {
    starg_context *context = block->run->context;
    SCOPED uint64_t *keep = NULL, *take = NULL;
    bool feasible;
    size_t before = block->rest.rows;
    NEW(context, "bound", keep, block->rest.column_words);
    NEW_ZERO(context, "bound", take, block->rest.column_words);
    cover_mask_fill(keep, block->rest.rows);
    size_t most = block->best.count - 1 - block->forced.count;
    if (!cover_dual_fix(&block->rest, dual, most, keep, take))
        return STARG_OK;
    TRY(cover_take_rows(&block->rest, take, keep, &block->forced));
    TRY(cover_reduce_full(block->run, &block->rest, &block->forced, NULL, &feasible));
    if (!feasible) /* no better cover exists */
        block->lower_bound = block->best.count;
    raise_bound(block, 0);
    *again = block->rest.columns == 0 || 20 * block->rest.rows <= 19 * before;
    return STARG_OK;
}

/* Multipliers from before any row was fixed are valid for the whole block. */
static void export_prices(block_solve *block, const cover_dual *dual) {
    double *prices = block->run->prices;
    if (prices == NULL || block->priced)
        return;
    for (size_t j = 0; j < block->rest.columns; j++)
        prices[block->rest.column_names[j]] = (double)dual->multipliers[j] / (double)COVER_ONE;
    block->priced = true;
}

static starg_status run_round(block_solve *block, bool *again) {
    SCOPED_BY(cover_dual_free) cover_dual dual = {0};
    SCOPED_BY(cover_state_free) cover_state cover = {0};
    *again = false;
    TRY(cover_state_create(&block->rest, &cover));
    TRY(find_first_cover(block->run, &block->rest, &cover));
    TRY(offer_cover(block, &cover));
    TRY(cover_dual_create(&block->rest, &dual));
    TRY(bound_rest(block, &dual, &cover));
    export_prices(block, &dual);
    if (is_closed(block) || is_brief(block) || cover_time_is_over(block->run))
        return STARG_OK;
    cover_state_free(&cover); /* the rest is about to change */
    return fix_rest(block, &dual, again);
}

/* A cover of the rest to start the search from, as small as the best one if such a cover is
 * found. */
static starg_status find_start(block_solve *block, cover_state *cover) {
    TRY(find_first_cover(block->run, &block->rest, cover));
    TRY(cover_local_search(block->run, block->best.count - block->forced.count, cover));
    return offer_cover(block, cover);
}

static starg_status branch_and_bound(block_solve *block) {
    SCOPED_BY(cover_state_free) cover_state cover = {0};
    size_t bound;
    TRY(cover_state_create(&block->rest, &cover));
    TRY(find_start(block, &cover));
    if (is_closed(block))
        return STARG_OK;
    TRY(cover_ilp_solve(block->run, &block->rest, &cover, &bound));
    TRY(offer_cover(block, &cover));
    raise_bound(block, bound);
    return STARG_OK;
}

static starg_status run_rounds(block_solve *block) {
    bool again = true;
    IN_STAGE(block->run->context, "bound");
    while (again) {
        TRY(run_round(block, &again));
        again = again && !is_closed(block) && !is_brief(block);
    }
    return STARG_OK;
}

/* Takes the block in `block->rest`; returns its cover in `block->best`. */
static starg_status solve_block(block_solve *block) {
    starg_context *context = block->run->context;
    for (size_t i = 0; i < block->rest.rows; i++)
        PUSH(context, "cover", &block->best, block->rest.row_names[i]);
    TRY(run_rounds(block));
    if (is_closed(block) || is_brief(block) || is_too_large(block, 0) ||
        cover_time_is_over(block->run))
        return STARG_OK;
    IN_STAGE(context, "ilp");
    return branch_and_bound(block);
}

static starg_status append(starg_context *context, const cover_names *from, cover_names *to) {
    for (size_t i = 0; i < from->count; i++)
        PUSH(context, "cover", to, from->data[i]);
    return STARG_OK;
}

/* Extracts one block from the instance. */
static starg_status cut_block(const cover_instance *instance, const uint32_t *block,
                              uint32_t number, cover_instance *out) {
    starg_context *context = instance->context;
    SCOPED uint64_t *rows = NULL, *columns = NULL;
    NEW_ZERO(context, "reduce", rows, instance->column_words);
    NEW_ZERO(context, "reduce", columns, instance->row_words);
    for (size_t i = 0; i < instance->rows; i++) {
        if (block[i] != number)
            continue;
        starg_bit_set(rows, i);
        for (size_t w = 0; w < instance->row_words; w++)
            columns[w] |= cover_row(instance, i)[w];
    }
    return cover_instance_select(instance, rows, columns, out);
}

static starg_status solve_number(cover_run *run, const cover_instance *instance,
                                 const uint32_t *blocks, uint32_t number, cover_answer *answer) {
    starg_status status = STARG_OK;
    block_solve block = {.run = run};
    STARG_TRY(cut_block(instance, blocks, number, &block.rest));
    STARG_TRY(solve_block(&block));
    STARG_TRY(append(run->context, &block.best, &answer->rows));
    answer->lower_bound += block.lower_bound;
done:
    cover_instance_free(&block.rest);
    RELEASE(block.forced.data, block.best.data);
    return status;
}

starg_status cover_solve_full(cover_run *run, cover_instance *instance, cover_answer *answer) {
    SCOPED uint32_t *blocks = NULL;
    size_t count;
    bool feasible; /* always true: the problem omits columns that cannot be covered */
    TRY(cover_reduce_full(run, instance, &answer->rows, run->prices, &feasible));
    answer->lower_bound = answer->rows.count;
    NEW(run->context, "reduce", blocks, instance->rows);
    TRY(cover_find_blocks(instance, blocks, &count));
    for (uint32_t number = 0; number < count; number++)
        TRY(solve_number(run, instance, blocks, number, answer));
    return STARG_OK;
}

starg_status cover_solve_greedy(cover_run *run, const cover_instance *instance,
                                cover_answer *answer) {
    SCOPED_BY(cover_state_free) cover_state cover = {0};
    SCOPED_BY(cover_instance_free) cover_instance rest = {.context = run->context};
    SCOPED cover_answer bounded = {0};
    TRY(cover_state_create(instance, &cover));
    TRY(cover_greedy(run, &cover, instance->total, instance->rows));
    TRY(cover_state_names(&cover, &answer->rows));
    TRY(cover_instance_select(instance, NULL, NULL, &rest));
    TRY(cover_solve_full(run, &rest, &bounded));
    answer->lower_bound = bounded.lower_bound;
    return STARG_OK;
}
