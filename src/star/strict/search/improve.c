/* SPDX-License-Identifier: Apache-2.0 */
/* Making the pieces of a partition fewer.
 *
 * Problem: a partition into star-shaped pieces with as few pieces as can be found.
 *
 * Method: large neighbourhood search. First every two neighbours whose union is star-shaped are
 * joined, small pieces first. Then trials: some neighbouring pieces at random, their union to be
 * cut into one piece less by planes (star/strict/search/repartition.c) or between guards that see
 * all of it (star/strict/search/covering.c), or shared out among the pieces around
 * (star/strict/search/eliminate.c). Others are moves: as many pieces as before, which are kept when
 * large pieces get larger and small ones smaller, so that the small ones vanish in the end.
 *
 * There are several sorts of trials, which differ in cost by a factor of a hundred, and none is the
 * best everywhere. So moves, and what helps where nothing else does any more, get fixed shares of
 * the work, and the others share the rest by what each has lately saved for its work (adaptive
 * operator selection [Ropke and Pisinger 2006]).
 *
 * Invariants: trials come in batches that look at the same partition, each with random numbers of
 * its own, and are carried out in their order unless an earlier one of the batch has changed a
 * piece of theirs or a neighbour that takes part: the result does not depend on the number of
 * threads. Cost: a trial looks at the facets of its union some hundred times. */
#include "star/strict/search/improve.h"

#include "core/parallel.h"
#include "star/strict/partition/apply.h"
#include "star/strict/search/search.h"

enum { BATCH = 16, UNION_MOST = APPLY_MOST };

/* Of all work, that goes to each sort of trials whatever it saves. */
static const double FLOOR = 0.03;

/* Each batch, tallies of the former ones count so much less. */
static const double FADING = 0.998;

/* Of a trial that finds no pieces to look at: every trial counts something, or a search without any
 * possible move would not end. */
static const uint64_t TRIAL_WORK = 1000;

/* What no tally says yet. */
static const double USUAL_WORK = 1e5, USUAL_SAVED = 1, USUAL_SPENT = 3e7;

/* Of guards to planes, in unit coordinates; the diagonal is at least 1/2. Searches ask for more
 * than proofs do, for they are rounded. */
static const double MARGIN = 4e-6, REPARTITION_MARGIN = 1e-5, ELIMINATE_MARGIN = 5e-6;

typedef struct trial {
    size_t sort;
    uint32_t pieces[UNION_MOST];
    size_t count, parts; /* pieces before and after */
    cut_plan cuts;
    fan_plan fan; /* instead of cuts */
    bool found;
    uint64_t work;
} trial;

typedef struct improver {
    partition *p;
    const improve_options *options;
    improve_report *report;
    uint64_t stalled;  /* trials since the last success */
    size_t merge_from; /* facets from which on it is time to merge */
    trial trials[BATCH];
    region_scratch scratch; /* of the calling thread */
    /* neighbours of piece i: neighbours[first[i]] to neighbours[first[i + 1] - 1] */
    partition_numbers neighbours;
    partition_numbers first;
    partition_numbers met;   /* by piece: 1 + the last piece that met it */
    partition_numbers seeds; /* pieces that unions grow from */
} improver;

/* ---- neighbours ---- */

static starg_status find_contacts(improver *m) {
    const partition *p = m->p;
    size_t open = 0;
    m->neighbours.count = m->first.count = m->met.count = m->seeds.count = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        PUSH(p->context, PARTITION_STAGE, &m->met, 0);
    TRY(partition_find_open(p, &m->seeds));
    for (size_t i = 0; i < m->seeds.count; i++)
        if (p->pieces.data[m->seeds.data[i]].stamp > m->options->since)
            m->seeds.data[open++] = m->seeds.data[i];
    m->seeds.count = open;
    for (uint32_t a = 0; a < p->pieces.count; a++) {
        PUSH(p->context, PARTITION_STAGE, &m->first, (uint32_t)m->neighbours.count);
        for (uint32_t k = p->start.data[a]; k < p->start.data[a + 1]; k++) {
            uint32_t entry = p->index.data[k], b = p->facets.data[entry / 2].side[1 - entry % 2];
            if (b == PARTITION_OUTSIDE || m->met.data[b] == a + 1)
                continue;
            m->met.data[b] = a + 1;
            PUSH(p->context, PARTITION_STAGE, &m->neighbours, b);
        }
    }
    PUSH(p->context, PARTITION_STAGE, &m->first, (uint32_t)m->neighbours.count);
    return STARG_OK;
}

/* ---- joins ---- */

/* Joins one piece with a neighbour if it can be done. */
static starg_status join_one(improver *m, uint32_t a, bool *done) {
    piece *pieces = m->p->pieces.data;
    *done = false;
    for (uint32_t i = m->first.data[a]; i < m->first.data[a + 1] && !*done; i++) {
        uint32_t b = m->neighbours.data[i];
        bool known = pieces[a].stamp <= pieces[a].checked && pieces[b].stamp <= pieces[a].checked;
        if (!known)
            TRY(apply_join(m->p, a, b, MARGIN, &m->scratch, done));
    }
    if (*done) {
        m->report->joins++;
        TRY(find_contacts(m));
    } else {
        m->p->pieces.data[a].checked = m->p->stamps;
    }
    return STARG_OK;
}

/* Until no two neighbours can be joined. */
static starg_status join_all(improver *m) {
    bool any = true;
    while (any && !starg_time_is_over(m->p->context)) {
        any = false;
        for (uint32_t a = 0; a < m->p->pieces.count; a++) {
            bool done = true;
            TRY(starg_check_cancel(m->p->context, PARTITION_STAGE));
            starg_progress_step(m->p->context, a, m->p->pieces.count);
            while (done && a < m->p->pieces.count && !starg_time_is_over(m->p->context)) {
                TRY(join_one(m, a, &done));
                any = any || done;
            }
        }
    }
    return STARG_OK;
}

/* ---- trials ---- */

static bool is_in(const trial *t, uint32_t number) {
    for (size_t i = 0; i < t->count; i++)
        if (t->pieces[i] == number)
            return true;
    return false;
}

static uint32_t random_seed(const improver *m, starg_rng *rng) {
    return m->seeds.data[starg_rng_below(rng, m->seeds.count)];
}

/* The smaller one of two random pieces and random neighbours of what is chosen; *found is false if
 * that has not so many. */
static void choose_union(const improver *m, starg_rng *rng, size_t wanted, trial *t, bool *found) {
    uint32_t seed = random_seed(m, rng), other = random_seed(m, rng);
    if (m->p->pieces.data[other].volume < m->p->pieces.data[seed].volume)
        seed = other;
    t->pieces[0] = seed;
    t->count = 1;
    for (int attempt = 0; attempt < 20 && t->count < wanted; attempt++) {
        uint32_t from = t->pieces[starg_rng_below(rng, t->count)];
        uint32_t degree = m->first.data[from + 1] - m->first.data[from];
        if (degree == 0)
            continue;
        uint32_t next = m->neighbours.data[m->first.data[from] + starg_rng_below(rng, degree)];
        if (!is_in(t, next))
            t->pieces[t->count++] = next;
    }
    *found = t->count == wanted;
}

static double square(double x) {
    return x * x;
}

/* The sum of the squared volumes: larger if they are more uneven. */
static double unevenness(const partition *part, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += square(part->pieces.data[i].volume);
    return sum;
}

/* Would a move make the pieces more uneven? */
static starg_status is_uneven(const improver *m, const region *r, const trial *t, bool *better) {
    const partition_plane *plane = &t->cuts.planes[0];
    SCOPED_BY(region_free) region above = {.vertices = {0}};
    double a = m->p->pieces.data[t->pieces[0]].volume, b = m->p->pieces.data[t->pieces[1]].volume;
    TRY(region_clip(m->p->context, r, plane->normal, plane->offset, &above));
    double high = region_volume_above(&above, plane->normal, plane->offset), low = a + b - high;
    *better = square(high) + square(low) > square(a) + square(b);
    return STARG_OK;
}

static bool saves(const trial *t) {
    return t->parts < t->count;
}

static starg_status find_planes(const improver *m, starg_rng *rng, region_scratch *scratch,
                                trial *t) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    const repartition_options options = {
        .margin = REPARTITION_MARGIN, .directions = 24, .steps = 16, .anywhere = !saves(t)};
    TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    TRY(repartition_find(&r, (int)t->parts, &options, rng, scratch, &t->cuts, &t->found));
    if (!saves(t) && t->found)
        TRY(is_uneven(m, &r, t, &t->found));
    return STARG_OK;
}

static starg_status find_borders(const improver *m, starg_rng *rng, region_scratch *scratch,
                                 trial *t) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    double starts[UNION_MOST][3];
    for (size_t i = 0; i < t->count; i++)
        partition_to_unit(m->p, m->p->pieces.data[t->pieces[i]].guard, starts[i]);
    const covering_options options = {.margin = REPARTITION_MARGIN,
                                      .starts = (const double(*)[3])starts,
                                      .start_count = t->count};
    TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    return covering_find(&r, t->parts, &options, rng, scratch, &t->cuts, &t->found);
}

/* What touches the pieces of a trial. */
static starg_status gather_around(const improver *m, const trial *t, partition_numbers *out) {
    for (size_t i = 0; i < t->count; i++)
        for (uint32_t k = m->first.data[t->pieces[i]]; k < m->first.data[t->pieces[i] + 1]; k++) {
            uint32_t next = m->neighbours.data[k];
            bool known = is_in(t, next);
            for (size_t n = 0; n < out->count && !known; n++)
                known = out->data[n] == next;
            if (!known)
                PUSH(m->p->context, PARTITION_STAGE, out, next);
        }
    return STARG_OK;
}

static starg_status find_fan(const improver *m, starg_rng *rng, region_scratch *scratch, trial *t) {
    SCOPED partition_numbers around = {0};
    TRY(gather_around(m, t, &around));
    const eliminate_task task = {.pieces = t->pieces,
                                 .piece_count = t->count,
                                 .kept = t->parts,
                                 .neighbours = around.data,
                                 .neighbour_count = around.count,
                                 .margin = ELIMINATE_MARGIN};
    return eliminate_find(m->p, &task, rng, scratch, &t->fan, &t->found);
}

/* What a trial looks for. */
static const struct sort {
    size_t count, parts; /* pieces before and after */
    starg_status (*find)(const improver *m, starg_rng *rng, region_scratch *scratch, trial *t);
    double share; /* of the work, or 0: by what it saves */
} SORTS[IMPROVE_SORTS] = {
    {2, 2, find_planes, 0.12}, {1, 1, find_fan, 0.1},   {3, 2, find_planes, 0},
    {4, 3, find_planes, 0},    {1, 0, find_fan, 0},     {2, 1, find_fan, 0},
    {3, 2, find_borders, 0.4}, {4, 3, find_borders, 0},
};

static starg_status run_trial(starg_context *context, void *shared, void *scratch, size_t item) {
    improver *m = shared;
    trial *t = &m->trials[item];
    starg_rng rng = starg_rng_make(context->seed, 77, m->options->first + m->report->trials + item);
    region_scratch *own = scratch;
    uint64_t before = own->work;
    choose_union(m, &rng, SORTS[t->sort].count, t, &t->found);
    t->parts = SORTS[t->sort].parts;
    t->work = TRIAL_WORK;
    if (!t->found)
        return STARG_OK;
    starg_status status = SORTS[t->sort].find(m, &rng, own, t);
    t->work = own->work - before;
    return status;
}

static bool is_fan(const trial *t) {
    return SORTS[t->sort].find == find_fan;
}

static starg_status carry_out(improver *m, const trial *t, apply_effect *effect) {
    if (is_fan(t))
        TRY(apply_fan(m->p, &t->fan, MARGIN, &m->scratch, effect));
    else
        TRY(apply_cuts(m->p, t->pieces, t->count, &t->cuts, MARGIN, saves(t) ? NULL : unevenness,
                       &m->scratch, effect));
    if (!effect->done) {
        m->report->refused++;
        return STARG_OK;
    }
    m->report->moves += !saves(t);
    *(is_fan(t) ? &m->report->eliminated : &m->report->repartitions) += t->count - t->parts;
    m->options->tallies->of[t->sort].saved += (double)(t->count - t->parts);
    if (saves(t))
        m->stalled = 0;
    return STARG_OK;
}

static bool concerns(const trial *t, uint32_t number) {
    for (size_t i = 0; i < t->fan.taker_count; i++)
        if (t->fan.takers[i] == number)
            return true;
    return is_in(t, number);
}

static bool meet(const trial *a, const trial *b) {
    for (size_t i = 0; i < a->count; i++)
        if (concerns(b, a->pieces[i]))
            return true;
    for (size_t i = 0; i < a->fan.taker_count; i++)
        if (concerns(b, a->fan.takers[i]))
            return true;
    return false;
}

static void renumber(uint32_t *pieces, size_t count, const apply_effect *effect) {
    for (size_t k = 0; k < effect->move_count; k++)
        for (size_t n = 0; n < count; n++)
            if (pieces[n] == effect->moves[k].from)
                pieces[n] = effect->moves[k].to;
}

/* Trials of the batch that concern a piece of a trial that was carried out are void; the others may
 * find pieces and facets under other numbers. Of moves by fans, one for each batch is enough:
 * carrying out five times as many left as many pieces as before. */
static starg_status follow(improver *m, size_t count, const trial *done,
                           const apply_effect *effect) {
    for (size_t i = 0; i < count; i++) {
        trial *t = &m->trials[i];
        t->found = t->found && !meet(t, done) && (saves(t) || !is_fan(t));
        if (!t->found)
            continue;
        renumber(t->pieces, t->count, effect);
        renumber(t->fan.pieces, t->fan.piece_count, effect);
        renumber(t->fan.takers, t->fan.taker_count, effect);
        if (is_fan(t))
            TRY(fan_plan_find(m->p, &t->fan, &t->found));
    }
    return STARG_OK;
}

static starg_status merge_if_crowded(improver *m) {
    if (m->p->facets.count <= m->merge_from)
        return STARG_OK;
    starg_status status = merge_coplanar(m->p);
    m->merge_from = m->p->facets.count + m->p->facets.count / 8;
    return status;
}

/* Those that save a piece first. */
static starg_status carry_out_batch(improver *m, size_t count) {
    bool any = false;
    for (size_t i = 0; i < count; i++)
        if (m->trials[i].found && is_fan(&m->trials[i]))
            TRY(fan_plan_mark(m->p, &m->trials[i].fan));
    for (int fewer = 1; fewer >= 0; fewer--)
        for (size_t i = 0; i < count; i++) {
            trial *t = &m->trials[i];
            apply_effect effect;
            if (!t->found || saves(t) != (fewer == 1))
                continue;
            TRY(carry_out(m, t, &effect));
            t->found = false;
            if (effect.done)
                TRY(follow(m, count, t, &effect));
            any = any || effect.done;
        }
    if (any) {
        TRY(merge_if_crowded(m));
        TRY(find_contacts(m));
    }
    return STARG_OK;
}

/* ---- sorts ---- */

/* Pieces saved for the work, lately. */
static double gain_of(const improver *m, size_t number) {
    const improve_tallies *tallies = m->options->tallies;
    return (tallies->of[number].saved + USUAL_SAVED) / (tallies->of[number].work + USUAL_SPENT);
}

/* Of the work. */
static double share_of(const improver *m, size_t number) {
    double gain = 0, left = 1;
    if (SORTS[number].share > 0)
        return SORTS[number].share;
    for (size_t i = 0; i < IMPROVE_SORTS; i++) {
        bool is_fixed = SORTS[i].share > 0;
        left -= is_fixed ? SORTS[i].share : FLOOR;
        gain += is_fixed ? 0 : gain_of(m, i);
    }
    return FLOOR + left * gain_of(m, number) / gain;
}

/* Each trial is of the sort that is due first; the next one of that is due after as much work as
 * trials of it cost, over its share. */
static void choose_sorts(improver *m) {
    improve_tallies *tallies = m->options->tallies;
    double delay[IMPROVE_SORTS];
    for (size_t i = 0; i < IMPROVE_SORTS; i++)
        delay[i] =
            (tallies->of[i].work + USUAL_WORK) / (tallies->of[i].trials + 1) / share_of(m, i);
    for (size_t n = 0; n < BATCH; n++) {
        size_t next = 0;
        for (size_t i = 1; i < IMPROVE_SORTS; i++)
            if (tallies->of[i].due < tallies->of[next].due)
                next = i;
        tallies->of[next].due += delay[next];
        m->trials[n] = (trial){.sort = next};
    }
}

static void count_batch(improver *m) {
    improve_tallies *tallies = m->options->tallies;
    for (size_t i = 0; i < IMPROVE_SORTS; i++) {
        tallies->of[i].work *= FADING;
        tallies->of[i].trials *= FADING;
        tallies->of[i].saved *= FADING;
    }
    for (size_t n = 0; n < BATCH; n++) {
        tallies->of[m->trials[n].sort].work += (double)m->trials[n].work;
        tallies->of[m->trials[n].sort].trials++;
        m->report->work += m->trials[n].work;
    }
    m->report->trials += BATCH;
    m->stalled += BATCH;
}

static starg_status run_batch(improver *m) {
    starg_status status = STARG_OK;
    const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                      .count = BATCH,
                                      .shared = m,
                                      .item = run_trial,
                                      .make_scratch = region_make_scratch,
                                      .free_scratch = region_free_scratch,
                                      .silent = true};
    choose_sorts(m);
    STARG_TRY(starg_parallel_for(m->p->context, &loop));
    count_batch(m);
    STARG_TRY(carry_out_batch(m, BATCH));
done:
    for (int i = 0; i < BATCH; i++)
        fan_plan_free(&m->trials[i].fan);
    return status;
}

/* Until there are few enough, or trials, work, time or patience are at an end. */
static starg_status search(improver *m) {
    const improve_options *options = m->options;
    improve_report *report = m->report;
    report->time_limited = m->p->pieces.count > 1 && starg_time_is_over(m->p->context);
    while (!report->time_limited && m->p->pieces.count > options->enough && m->seeds.count > 0 &&
           report->trials < options->trials && report->work < options->work &&
           m->stalled < options->patience) {
        TRY(starg_check_cancel(m->p->context, PARTITION_STAGE));
        TRY(run_batch(m));
        report->time_limited = starg_time_is_over(m->p->context);
    }
    return STARG_OK;
}

static void improver_free(improver *m) {
    region_scratch_free(&m->scratch);
    RELEASE(m->neighbours.data, m->met.data, m->first.data, m->seeds.data);
}

starg_status improve_join(partition *p) {
    const improve_options options = {.since = 0};
    improve_report report = {.trials = 0};
    SCOPED_BY(improver_free)
    improver m = {
        .p = p, .options = &options, .report = &report, .scratch = {.context = p->context}};
    IN_STAGE(p->context, "join");
    TRY(find_contacts(&m));
    return join_all(&m);
}

starg_status improve(partition *p, const improve_options *options, improve_report *report) {
    starg_status status = STARG_OK;
    improver m = {.p = p,
                  .options = options,
                  .report = report,
                  .scratch = {.context = p->context},
                  .merge_from = p->facets.count + p->facets.count / 8};
    *report = (improve_report){.trials = 0};
    starg_progress_begin(p->context, PARTITION_STAGE);
    STARG_TRY(find_contacts(&m));
    STARG_TRY(join_all(&m));
    STARG_TRY(search(&m));
done:
    p->context->work += report->work / PARTITION_WORK;
    starg_progress_end(p->context);
    improver_free(&m);
    return status;
}
