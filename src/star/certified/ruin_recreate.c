/* SPDX-License-Identifier: Apache-2.0 */
/* Cutting some neighbouring pieces anew.
 *
 * Problem: a search by small changes ends where none of them helps.
 *
 * Method: ruin and recreate [Schrimpf et al. 2000]. Some neighbouring pieces of a copy become one,
 * which is cut by planes as the whole was at the start (bsp_start.c), and searched alone with what
 * touches it (improve.c). The copy replaces the partition unless it has more pieces. If the pieces
 * are all there are, that is another search from another start.
 *
 * Cost: that of a start and of a search for the pieces, and some passes over the partition. */
#include "core/streams.h"
#include "star/certified/search.h"

enum {
    PIECES_LEAST = 3,
    PIECES_MOST = 14,
    EVALUATIONS_EACH = 12, /* of the start, for each piece */
    PATIENCE = 40,         /* trials for each piece        */
    PATIENCE_LEAST = 160
};

typedef struct group {
    uint32_t pieces[PIECES_MOST];
    size_t count;
} group;

/* What is beyond a random facet of a random piece of the group, until there are enough. The first
 * is one of which there may be fewer. */
static starg_status choose_group(const partition *p, starg_rng *rng, group *g) {
    SCOPED partition_numbers open = {0};
    size_t wanted = PIECES_LEAST + starg_rng_below(rng, PIECES_MOST - PIECES_LEAST + 1);
    g->count = 0;
    TRY(partition_find_open(p, &open));
    if (open.count > 0)
        g->pieces[g->count++] = open.data[starg_rng_below(rng, open.count)];
    for (size_t attempt = 0; attempt < 40 * wanted && g->count > 0 && g->count < wanted;
         attempt++) {
        uint32_t from = g->pieces[starg_rng_below(rng, g->count)], first = p->start.data[from];
        uint32_t facets = p->start.data[from + 1] - first;
        uint32_t entry = p->index.data[first + starg_rng_below(rng, facets)];
        uint32_t next = p->facets.data[entry / 2].side[1 - entry % 2];
        if (next != PARTITION_OUTSIDE && !partition_lists(g->pieces, g->count, next))
            g->pieces[g->count++] = next;
    }
    return STARG_OK;
}

/* The number of the piece that all have become; the last numbers take the place of the others. */
static starg_status join(partition *p, const group *g, uint32_t *whole) {
    group left = *g;
    partition_join(p, g->pieces, g->count);
    *whole = g->pieces[0];
    while (left.count > 1) {
        size_t highest = 1;
        for (size_t i = 1; i < left.count; i++)
            if (left.pieces[i] > left.pieces[highest])
                highest = i;
        uint32_t last = (uint32_t)p->pieces.count - 1, hole = left.pieces[highest];
        left.pieces[highest] = left.pieces[--left.count];
        partition_renumber(p, last, hole);
        if (*whole == last)
            *whole = hole;
    }
    return partition_build_index(p);
}

static starg_status cut_anew(partition *copy, const group *g, const ruin_recreate_options *options,
                             ruin_recreate_report *report, bool *done) {
    bsp_report cut;
    uint32_t whole;
    TRY(join(copy, g, &whole));
    const bsp_options start = {.stream = options->round,
                               .budget = EVALUATIONS_EACH * g->count,
                               .pieces = &whole,
                               .piece_count = 1};
    TRY(bsp_start(copy, &start, &cut));
    report->work += cut.work;
    *done = cut.done;
    return STARG_OK;
}

static starg_status search(partition *copy, const group *g, uint64_t since,
                           const ruin_recreate_options *options, ruin_recreate_report *report) {
    improve_report found;
    const improve_options wanted = {.trials = options->trials,
                                    .work = options->work,
                                    .patience = PATIENCE * g->count + PATIENCE_LEAST,
                                    .enough = 1,
                                    .first = options->round << 40,
                                    .since = since,
                                    .tallies = options->tallies};
    starg_status status = improve(copy, &wanted, &found);
    report->trials = found.trials;
    report->work += found.work;
    report->time_limited = found.time_limited;
    return status;
}

starg_status ruin_recreate(partition *p, const ruin_recreate_options *options,
                           ruin_recreate_report *report) {
    starg_status status = STARG_OK;
    partition copy = {.context = p->context};
    starg_rng rng = starg_rng_make(p->context->seed, STREAM_RUIN, options->round);
    group g;
    bool done;
    *report = (ruin_recreate_report){.trials = 0};
    starg_progress_begin(p->context, PARTITION_STAGE);
    STARG_TRY(choose_group(p, &rng, &g));
    if (g.count == 0)
        goto done;
    STARG_TRY(partition_copy(p, &copy));
    STARG_TRY(cut_anew(&copy, &g, options, report, &done));
    if (!done)
        goto done;
    STARG_TRY(search(&copy, &g, p->stamps, options, report));
    if (copy.pieces.count > p->pieces.count)
        goto done;
    report->better = copy.pieces.count < p->pieces.count;
    partition_swap(p, &copy);
done:
    report->time_limited = report->time_limited || starg_time_is_over(p->context);
    starg_progress_end(p->context);
    partition_free(&copy);
    return status;
}
