/* SPDX-License-Identifier: Apache-2.0 */
/* Making the pieces of a partition fewer.
 *
 * Problem: a partition into star-shaped pieces with as few pieces as can be found.
 *
 * Method: large neighbourhood search. First every two neighbours whose union is star-shaped are
 * joined, small pieces first. Then trials: some neighbouring pieces at random, their union to be
 * cut into one piece less by planes (repartition.c) or between guards that see all of it
 * (guard_split.c), or shared out among the pieces around (reassign.c). Others are moves: as many
 * pieces as before, which are kept when large pieces get larger and small ones smaller, so that the
 * small ones vanish in the end.
 *
 * There are several sorts of trials, which differ in cost by a factor of a hundred, and none is the
 * best everywhere. So some get fixed shares of the work, and the others share the rest by what each
 * has lately saved for its work (adaptive operator selection [Ropke and Pisinger 2006]).
 *
 * Invariants: trials come in batches that look at the same partition, each with random numbers of
 * its own, and are carried out in their order unless an earlier one of the batch has changed a
 * piece of theirs or a neighbour that takes part: the result does not depend on the number of
 * threads. Cost: a trial looks at the facets of its union some hundred times. */
#include "star/certified/search.h"

#include "core/parallel.h"
#include "core/streams.h"

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
static const double MARGIN = 4e-6, REPARTITION_MARGIN = 1e-5, REASSIGN_MARGIN = 5e-6;

typedef struct improver improver;
typedef struct trial trial;

/* What a trial looks for, and what becomes of it. */
typedef struct kind {
    starg_status (*find)(const improver *m, starg_rng *rng, region_scratch *scratch, trial *t);
    starg_status (*apply)(improver *m, const trial *t, apply_effect *effect);
    /* NULL: nothing. Further pieces that take part; what there is to do when others have changed
     * the partition, and at the end. */
    size_t (*concerns)(trial *t, uint32_t **out);
    starg_status (*follow)(improver *m, trial *t);
    void (*drop)(trial *t);
} kind;

typedef struct sort {
    const kind *is;
    size_t count, parts; /* pieces before and after: as many in a move */
    double share;        /* of the work, or 0: by what it saves */
    /* Void once another trial of the batch is carried out: one for each batch is enough. Carrying
     * out five times as many left as many pieces as before. */
    bool alone;
} sort;

/* Some neighbouring pieces, and what was found for them. */
struct trial {
    const sort *sort;
    uint32_t pieces[UNION_MOST];
    size_t count;
    bool found;
    uint64_t work;
    union {
        fan_plan fan;
        cut_plan cuts;
    } plan; /* by the sort */
};

static bool saves(const trial *t) {
    return t->sort->parts < t->sort->count;
}

struct improver {
    partition *p;
    const improve_options *options;
    improve_report *report;
    uint64_t stalled;  /* trials since the last success */
    size_t merge_from; /* facets from which on it is time to merge */
    trial trials[BATCH];
    size_t order[BATCH];    /* of the trials, those first that may take longest */
    region_scratch scratch; /* of the calling thread */
    /* neighbours of piece i: neighbours[first[i]] to neighbours[first[i + 1] - 1] */
    partition_numbers neighbours;
    partition_numbers first;
    partition_numbers met;   /* by piece: 1 + the last piece that met it */
    partition_numbers seeds; /* pieces that unions grow from */
};

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

/* ---- unions ---- */

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
        if (!partition_lists(t->pieces, t->count, next))
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
    const partition_plane *plane = &t->plan.cuts.planes[0];
    SCOPED_BY(region_free) region above = {.vertices = {0}};
    double a = m->p->pieces.data[t->pieces[0]].volume, b = m->p->pieces.data[t->pieces[1]].volume;
    TRY(region_clip(m->p->context, r, plane->normal, plane->offset, &above));
    double high = region_volume_above(&above, plane->normal, plane->offset), low = a + b - high;
    *better = square(high) + square(low) > square(a) + square(b);
    return STARG_OK;
}

/* ---- sorts of trials: planes ---- */

static starg_status find_planes(const improver *m, starg_rng *rng, region_scratch *scratch,
                                trial *t) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    const repartition_options options = {
        .margin = REPARTITION_MARGIN, .directions = 24, .steps = 16, .anywhere = !saves(t)};
    t->plan.cuts.count = 0;
    TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    TRY(repartition_find(&r, (int)t->sort->parts, &options, rng, scratch, &t->plan.cuts,
                         &t->found));
    if (!saves(t) && t->found)
        TRY(is_uneven(m, &r, t, &t->found));
    return STARG_OK;
}

/* ---- sorts of trials: borders between guards ---- */

static starg_status find_borders(const improver *m, starg_rng *rng, region_scratch *scratch,
                                 trial *t) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    double starts[UNION_MOST][3];
    for (size_t i = 0; i < t->count; i++)
        partition_to_unit(m->p, m->p->pieces.data[t->pieces[i]].guard, starts[i]);
    const guard_split_options options = {.margin = REPARTITION_MARGIN,
                                         .starts = (const double(*)[3])starts,
                                         .start_count = t->count};
    TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    return guard_split_find(&r, t->sort->parts, &options, rng, scratch, &t->plan.cuts, &t->found);
}

static starg_status apply_planes(improver *m, const trial *t, apply_effect *effect) {
    return apply_cuts(m->p, t->pieces, t->count, &t->plan.cuts, MARGIN,
                      saves(t) ? NULL : unevenness, &m->scratch, effect);
}

/* ---- sorts of trials: fans ---- */

/* What touches the pieces of a trial. */
static starg_status gather_around(const improver *m, const trial *t, partition_numbers *out) {
    for (size_t i = 0; i < t->count; i++)
        for (uint32_t k = m->first.data[t->pieces[i]]; k < m->first.data[t->pieces[i] + 1]; k++) {
            uint32_t next = m->neighbours.data[k];
            if (!partition_lists(t->pieces, t->count, next) &&
                !partition_lists(out->data, out->count, next))
                PUSH(m->p->context, PARTITION_STAGE, out, next);
        }
    return STARG_OK;
}

static starg_status find_fan(const improver *m, starg_rng *rng, region_scratch *scratch, trial *t) {
    SCOPED partition_numbers around = {0};
    TRY(gather_around(m, t, &around));
    const reassign_task task = {.pieces = t->pieces,
                                .piece_count = t->count,
                                .kept = t->sort->parts,
                                .neighbours = around.data,
                                .neighbour_count = around.count,
                                .margin = REASSIGN_MARGIN};
    TRY(reassign_find(m->p, &task, rng, scratch, &t->plan.fan, &t->found));
    return t->found ? fan_plan_mark(m->p, &t->plan.fan) : STARG_OK;
}

static starg_status apply_one_fan(improver *m, const trial *t, apply_effect *effect) {
    return apply_fan(m->p, &t->plan.fan, MARGIN, &m->scratch, effect);
}

static size_t list_takers(trial *t, uint32_t **out) {
    *out = t->plan.fan.takers;
    return t->plan.fan.taker_count;
}

/* The facets have other numbers. */
static starg_status follow_fan(improver *m, trial *t) {
    memcpy(t->plan.fan.pieces, t->pieces, t->count * sizeof *t->pieces);
    return fan_plan_find(m->p, &t->plan.fan, &t->found);
}

static void drop_fan(trial *t) {
    fan_plan_free(&t->plan.fan);
}

/* ---- the table of sorts ---- */

static const kind PLANES = {.find = find_planes, .apply = apply_planes};
static const kind BORDERS = {.find = find_borders, .apply = apply_planes};
static const kind FANS = {.find = find_fan,
                          .apply = apply_one_fan,
                          .concerns = list_takers,
                          .follow = follow_fan,
                          .drop = drop_fan};

static const sort SORTS[IMPROVE_SORTS] = {
    {&PLANES, 2, 2, 0.12, false}, {&FANS, 1, 1, 0.1, true},   {&PLANES, 3, 2, 0, false},
    {&PLANES, 4, 3, 0, false},    {&FANS, 1, 0, 0, false},    {&FANS, 2, 1, 0, false},
    {&BORDERS, 3, 2, 0.4, false}, {&BORDERS, 4, 3, 0, false},
};

/* ---- trials ---- */

static starg_status run_trial(starg_context *context, void *shared, void *scratch, size_t item) {
    improver *m = shared;
    const size_t number = m->order[item];
    trial *t = &m->trials[number];
    starg_rng rng = starg_rng_make(context->seed, STREAM_IMPROVE,
                                   m->options->first + m->report->trials + number);
    region_scratch *own = scratch;
    uint64_t before = own->work;
    choose_union(m, &rng, t->sort->count, t, &t->found);
    t->work = TRIAL_WORK;
    if (!t->found)
        return STARG_OK;
    starg_status status = t->sort->is->find(m, &rng, own, t);
    t->work = own->work - before;
    return status;
}

static improve_tally *tally_of(const improver *m, const trial *t) {
    return &m->options->tallies->of[t->sort - SORTS];
}

static starg_status carry_out(improver *m, const trial *t, apply_effect *effect) {
    TRY(t->sort->is->apply(m, t, effect));
    if (!effect->done)
        return STARG_OK;
    m->report->moves += !saves(t);
    m->report->saved += t->count - t->sort->parts;
    tally_of(m, t)->saved += (double)(t->count - t->sort->parts);
    if (saves(t))
        m->stalled = 0;
    return STARG_OK;
}

/* The pieces that take part beside those that were chosen. */
static size_t others_of(trial *t, uint32_t **out) {
    *out = NULL;
    return t->sort->is->concerns == NULL ? 0 : t->sort->is->concerns(t, out);
}

static bool meet(trial *a, trial *b) {
    uint32_t *more[2];
    const size_t count[2] = {others_of(a, &more[0]), others_of(b, &more[1])};
    for (size_t i = 0; i < a->count + count[0]; i++) {
        uint32_t number = i < a->count ? a->pieces[i] : more[0][i - a->count];
        if (partition_lists(b->pieces, b->count, number) ||
            partition_lists(more[1], count[1], number))
            return true;
    }
    return false;
}

static void renumber(uint32_t *pieces, size_t count, const apply_effect *effect) {
    for (size_t k = 0; k < effect->move_count; k++)
        for (size_t n = 0; n < count; n++)
            if (pieces[n] == effect->moves[k].from)
                pieces[n] = effect->moves[k].to;
}

/* Trials of the batch that concern a piece of a trial that was carried out are void; the others may
 * find pieces and facets under other numbers. */
static starg_status follow(improver *m, trial *done, const apply_effect *effect) {
    for (size_t i = 0; i < BATCH; i++) {
        trial *t = &m->trials[i];
        uint32_t *others;
        t->found = t->found && !meet(t, done) && !t->sort->alone;
        if (!t->found)
            continue;
        size_t count = others_of(t, &others);
        renumber(t->pieces, t->count, effect);
        renumber(others, count, effect);
        if (t->sort->is->follow != NULL)
            TRY(t->sort->is->follow(m, t));
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
static starg_status carry_out_batch(improver *m) {
    bool any = false;
    for (int fewer = 1; fewer >= 0; fewer--)
        for (size_t i = 0; i < BATCH; i++) {
            trial *t = &m->trials[i];
            apply_effect effect;
            if (!t->found || saves(t) != (fewer == 1))
                continue;
            TRY(carry_out(m, t, &effect));
            t->found = false;
            if (effect.done)
                TRY(follow(m, t, &effect));
            any = any || effect.done;
        }
    if (any) {
        TRY(merge_if_crowded(m));
        TRY(find_contacts(m));
    }
    return STARG_OK;
}

/* ---- batches ---- */

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

/* What its trials have cost lately. */
static double cost_of(const improve_tally *tally) {
    return (tally->work + USUAL_WORK) / (tally->trials + 1);
}

/* Each trial is of the sort that is due first; the next one of that is due after as much work as
 * trials of it cost, over its share. */
static void choose_sorts(improver *m) {
    improve_tallies *tallies = m->options->tallies;
    double delay[IMPROVE_SORTS];
    for (size_t i = 0; i < IMPROVE_SORTS; i++)
        delay[i] = cost_of(&tallies->of[i]) / share_of(m, i);
    for (size_t n = 0; n < BATCH; n++) {
        size_t next = 0;
        for (size_t i = 1; i < IMPROVE_SORTS; i++)
            if (tallies->of[i].due < tallies->of[next].due)
                next = i;
        tallies->of[next].due += delay[next];
        m->trials[n] = (trial){.sort = &SORTS[next]};
    }
}

static void order_trials(improver *m) {
    for (size_t n = 0; n < BATCH; n++) {
        size_t at = n;
        const double cost = cost_of(tally_of(m, &m->trials[n]));
        for (; at > 0 && cost_of(tally_of(m, &m->trials[m->order[at - 1]])) < cost; at--)
            m->order[at] = m->order[at - 1];
        m->order[at] = n;
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
        improve_tally *of = tally_of(m, &m->trials[n]);
        of->work += (double)m->trials[n].work;
        of->trials++;
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
    order_trials(m);
    STARG_TRY(starg_parallel_for(m->p->context, &loop));
    count_batch(m);
    STARG_TRY(carry_out_batch(m));
done:
    for (int i = 0; i < BATCH; i++)
        if (m->trials[i].sort->is->drop != NULL)
            m->trials[i].sort->is->drop(&m->trials[i]);
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
