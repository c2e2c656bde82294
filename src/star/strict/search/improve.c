/* SPDX-License-Identifier: Apache-2.0 */
/* Making the pieces of a partition fewer.
 *
 * Problem: a partition into star-shaped pieces with as few pieces as can be found.
 *
 * Method: large neighbourhood search. First every two neighbours whose union is star-shaped are
 * joined, small pieces first. Then trials: some neighbouring pieces at random, their union to be
 * cut flat into one piece less (star/strict/search/repartition.c), or shared out among the pieces
 * around (star/strict/search/eliminate.c). Now and then a trial is a move instead: as many pieces
 * as before, which are kept when large pieces get larger and small ones smaller, so that the small
 * ones vanish in the end.
 *
 * Invariants: trials come in batches that look at the same partition, each with random numbers of
 * its own, and are carried out in their order unless an earlier one of the batch has changed a
 * piece of theirs: the result does not depend on the number of threads. Cost: a trial looks at the
 * facets of its union some hundred times. */
#include "star/strict/search/improve.h"

#include <math.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "star/strict/partition/apply.h"
#include "star/strict/partition/merge_coplanar.h"
#include "star/strict/search/eliminate.h"

enum {
    BATCH = 16,
    UNION_MOST = APPLY_MOST,
    PATIENCE = 150, /* trials for each piece without a piece less, after which the search ends */
    PATIENCE_LEAST = 2000
};

/* Of guards to planes, in unit coordinates; the diagonal is at least 1/2. Searches ask for more
 * than proofs do, for they are rounded. */
static const double MARGIN = 4e-6, REPARTITION_MARGIN = 1e-5, ELIMINATE_MARGIN = 5e-6;

typedef struct trial {
    uint32_t pieces[UNION_MOST];
    size_t count, parts; /* pieces before and after */
    bool eliminates;
    repartition_plan plan; /* if it does not */
    fan_plan fan;          /* if it does     */
    bool found;
    uint64_t work;
} trial;

typedef STARG_ARRAY(uint32_t) numbers;

typedef struct improver {
    partition *p;
    improve_report *report;
    double began;      /* clock */
    uint64_t offset;   /* number of the first trial */
    uint64_t stalled;  /* trials since the last success */
    size_t merge_from; /* facets from which on it is time to merge */
    trial trials[BATCH];
    region_scratch scratch; /* of the calling thread */
    /* neighbours of piece i: neighbours[first[i]] to neighbours[first[i + 1] - 1] */
    numbers neighbours;
    numbers first;
    numbers met; /* by piece: 1 + the last piece that met it */
} improver;

/* ---- neighbours ---- */

static starg_status find_contacts(improver *m) {
    starg_status status = STARG_OK;
    const partition *p = m->p;
    m->neighbours.count = m->first.count = m->met.count = 0;
    for (size_t i = 0; i < p->pieces.count; i++)
        STARG_PUSH(p->context, PARTITION_STAGE, &m->met, 0);
    for (uint32_t a = 0; a < p->pieces.count; a++) {
        STARG_PUSH(p->context, PARTITION_STAGE, &m->first, (uint32_t)m->neighbours.count);
        for (uint32_t k = p->start.data[a]; k < p->start.data[a + 1]; k++) {
            uint32_t entry = p->index.data[k], b = p->facets.data[entry / 2].side[1 - entry % 2];
            if (b == PARTITION_OUTSIDE || m->met.data[b] == a + 1)
                continue;
            m->met.data[b] = a + 1;
            STARG_PUSH(p->context, PARTITION_STAGE, &m->neighbours, b);
        }
    }
    STARG_PUSH(p->context, PARTITION_STAGE, &m->first, (uint32_t)m->neighbours.count);
done:
    return status;
}

/* ---- joins ---- */

/* Joins one piece with a neighbour if it can be done. */
static starg_status join_one(improver *m, uint32_t a, bool *done) {
    starg_status status = STARG_OK;
    piece *pieces = m->p->pieces.data;
    *done = false;
    for (uint32_t i = m->first.data[a]; i < m->first.data[a + 1] && !*done; i++) {
        uint32_t b = m->neighbours.data[i];
        bool known = pieces[a].stamp <= pieces[a].checked && pieces[b].stamp <= pieces[a].checked;
        if (!known)
            STARG_TRY(apply_join(m->p, a, b, MARGIN, &m->scratch, done));
    }
    if (*done) {
        m->report->joins++;
        STARG_TRY(find_contacts(m));
    } else {
        m->p->pieces.data[a].checked = m->p->stamps;
    }
done:
    return status;
}

/* Until no two neighbours can be joined. */
static starg_status join_all(improver *m) {
    starg_status status = STARG_OK;
    bool any = true;
    starg_progress_begin(m->p->context, "join");
    while (any && !starg_time_is_over(m->p->context)) {
        any = false;
        for (uint32_t a = 0; a < m->p->pieces.count; a++) {
            bool done = true;
            STARG_TRY(starg_check_cancel(m->p->context, PARTITION_STAGE));
            starg_progress_step(m->p->context, a, m->p->pieces.count);
            while (done && a < m->p->pieces.count && !starg_time_is_over(m->p->context)) {
                STARG_TRY(join_one(m, a, &done));
                any = any || done;
            }
        }
    }
done:
    starg_progress_end(m->p->context);
    return status;
}

/* ---- trials ---- */

static bool is_in(const trial *t, uint32_t number) {
    for (size_t i = 0; i < t->count; i++)
        if (t->pieces[i] == number)
            return true;
    return false;
}

/* A random piece and random neighbours of what is chosen. */
static void choose_union(const improver *m, starg_rng *rng, size_t wanted, trial *t) {
    t->count = 0;
    uint32_t seed = (uint32_t)starg_rng_below(rng, m->p->pieces.count);
    uint32_t other = (uint32_t)starg_rng_below(rng, m->p->pieces.count);
    if (m->p->pieces.data[other].volume < m->p->pieces.data[seed].volume)
        seed = other;
    t->pieces[t->count++] = seed;
    for (int attempt = 0; attempt < 20 && t->count < wanted; attempt++) {
        uint32_t from = t->pieces[starg_rng_below(rng, t->count)];
        uint32_t degree = m->first.data[from + 1] - m->first.data[from];
        if (degree == 0)
            continue;
        uint32_t next = m->neighbours.data[m->first.data[from] + starg_rng_below(rng, degree)];
        if (!is_in(t, next))
            t->pieces[t->count++] = next;
    }
}

/* Would a move make the pieces more uneven? */
static starg_status is_uneven(const improver *m, const region *r, const trial *t, bool *better) {
    starg_status status = STARG_OK;
    const partition_plane *plane = &t->plan.planes[0];
    region above = {.vertices = {0}};
    double whole = m->p->pieces.data[t->pieces[0]].volume + m->p->pieces.data[t->pieces[1]].volume;
    STARG_TRY(region_clip(m->p->context, r, plane->normal, plane->offset, &above));
    double high = region_volume_above(&above, plane->normal, plane->offset), low = whole - high;
    *better = high * high + low * low > sum_of_squares(m->p, t->pieces, t->count);
done:
    region_free(m->p->context, &above);
    return status;
}

static starg_status try_repartition(const improver *m, starg_rng *rng, region_scratch *scratch,
                                    trial *t) {
    starg_status status = STARG_OK;
    static const size_t sizes[8] = {2, 2, 3, 3, 3, 4, 4, 5};
    region r = {.vertices = {0}};
    choose_union(m, rng, sizes[starg_rng_below(rng, 8)], t);
    if (t->count < 2)
        goto done;
    bool move = t->count == 2 || starg_rng_below(rng, 4) == 0;
    t->parts = move ? 2 : t->count - 1;
    if (move)
        t->count = 2;
    const repartition_options options = {
        .margin = REPARTITION_MARGIN, .directions = 24, .steps = 16, .anywhere = move};
    STARG_TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    STARG_TRY(repartition_find(&r, (int)t->parts, &options, rng, scratch, &t->plan, &t->found));
    if (move && t->found)
        STARG_TRY(is_uneven(m, &r, t, &t->found));
done:
    region_free(m->p->context, &r);
    return status;
}

/* What touches the pieces of a trial. */
static starg_status gather_around(const improver *m, const trial *t, numbers *out) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < t->count; i++)
        for (uint32_t k = m->first.data[t->pieces[i]]; k < m->first.data[t->pieces[i] + 1]; k++) {
            uint32_t next = m->neighbours.data[k];
            bool known = is_in(t, next);
            for (size_t n = 0; n < out->count && !known; n++)
                known = out->data[n] == next;
            if (!known)
                STARG_PUSH(m->p->context, PARTITION_STAGE, out, next);
        }
done:
    return status;
}

static starg_status try_eliminate(const improver *m, starg_rng *rng, region_scratch *scratch,
                                  trial *t) {
    starg_status status = STARG_OK;
    numbers around = {0};
    choose_union(m, rng, starg_rng_below(rng, 4) == 0 ? 2 : 1, t);
    t->eliminates = true;
    t->parts = t->count == 1 ? starg_rng_below(rng, 2) : 1;
    STARG_TRY(gather_around(m, t, &around));
    const eliminate_task task = {.pieces = t->pieces,
                                 .piece_count = t->count,
                                 .kept = t->parts,
                                 .neighbours = around.data,
                                 .neighbour_count = around.count,
                                 .margin = ELIMINATE_MARGIN};
    STARG_TRY(eliminate_find(m->p, &task, rng, scratch, &t->fan, &t->found));
done:
    STARG_ARRAY_FREE(m->p->context, &around);
    return status;
}

static starg_status run_trial(starg_context *context, void *shared, void *scratch, size_t item) {
    improver *m = shared;
    trial *t = &m->trials[item];
    starg_rng rng = starg_rng_make(context->seed, 77, m->offset + m->report->trials + item);
    region_scratch *own = scratch;
    uint64_t before = own->work;
    *t = (trial){.found = false};
    starg_status status = starg_rng_below(&rng, 2) == 0 ? try_repartition(m, &rng, own, t)
                                                        : try_eliminate(m, &rng, own, t);
    t->work = own->work - before;
    return status;
}

static bool saves(const trial *t) {
    return t->parts < t->count;
}

static starg_status carry_out(improver *m, const trial *t, apply_effect *effect) {
    starg_status status = STARG_OK;
    double least = saves(t) ? -1 : sum_of_squares(m->p, t->pieces, t->count);
    if (t->eliminates)
        STARG_TRY(apply_fan(m->p, &t->fan, MARGIN, &m->scratch, effect));
    else
        STARG_TRY(
            apply_plan(m->p, t->pieces, t->count, &t->plan, MARGIN, least, &m->scratch, effect));
    if (!effect->done)
        m->report->refused++;
    else if (!saves(t))
        m->report->moves++;
    else if (t->eliminates)
        m->report->eliminated += t->count - t->parts, m->stalled = 0;
    else
        m->report->repartitions++, m->stalled = 0;
done:
    return status;
}

static bool have_common(const trial *t, const uint32_t *pieces, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (is_in(t, pieces[i]))
            return true;
    return false;
}

/* Trials of the batch that have a piece of a trial that was carried out are void, and so are those
 * that know facets by their numbers; the others may find pieces under other numbers. */
static void follow(improver *m, size_t count, const trial *done, const apply_effect *effect) {
    for (size_t i = 0; i < count; i++) {
        trial *t = &m->trials[i];
        if (t->eliminates || have_common(t, done->pieces, done->count) ||
            have_common(t, done->fan.takers, done->fan.taker_count))
            t->found = false;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < effect->move_count; k++)
            for (size_t n = 0; n < m->trials[i].count; n++)
                if (m->trials[i].pieces[n] == effect->moves[k].from)
                    m->trials[i].pieces[n] = effect->moves[k].to;
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
    starg_status status = STARG_OK;
    bool any = false;
    for (int fewer = 1; fewer >= 0; fewer--)
        for (size_t i = 0; i < count; i++) {
            trial *t = &m->trials[i];
            apply_effect effect;
            if (!t->found || saves(t) != (fewer == 1))
                continue;
            STARG_TRY(carry_out(m, t, &effect));
            t->found = false;
            if (effect.done)
                follow(m, count, t, &effect);
            any = any || effect.done;
        }
    if (any) {
        STARG_TRY(merge_if_crowded(m));
        STARG_TRY(find_contacts(m));
    }
done:
    return status;
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
    STARG_TRY(starg_parallel_for(m->p->context, &loop));
    m->stalled += BATCH;
    STARG_TRY(carry_out_batch(m, BATCH));
    for (int i = 0; i < BATCH; i++)
        m->report->work += m->trials[i].work;
    m->report->trials += BATCH;
done:
    for (int i = 0; i < BATCH; i++)
        fan_plan_free(m->p->context, &m->trials[i].fan);
    return status;
}

/* How far the search is, by whatever will end it. */
static void tell_progress(const improver *m, const improve_options *options, uint64_t patience) {
    double part = (double)m->stalled / (double)patience, passed = starg_clock() - m->began;
    if (options->trials != UINT64_MAX)
        part = fmax(part, (double)m->report->trials / (double)options->trials);
    if (options->work != UINT64_MAX)
        part = fmax(part, (double)m->report->work / (double)options->work);
    part = fmax(part, passed / (passed + fmax(0, starg_seconds_left(m->p->context))));
    starg_progress_step(m->p->context, (size_t)(1e6 * fmin(1, part)), 1000000);
}

/* Until there are few enough, or trials, work, time or patience are at an end. */
static starg_status search(improver *m, const improve_options *options) {
    starg_status status = STARG_OK;
    improve_report *report = m->report;
    report->time_limited = m->p->pieces.count > 1 && starg_time_is_over(m->p->context);
    while (!report->time_limited && m->p->pieces.count > options->enough &&
           report->trials < options->trials && report->work < options->work) {
        uint64_t patience = PATIENCE * m->p->pieces.count + PATIENCE_LEAST;
        if (m->stalled >= patience)
            break;
        STARG_TRY(starg_check_cancel(m->p->context, PARTITION_STAGE));
        STARG_TRY(run_batch(m));
        tell_progress(m, options, patience);
        report->time_limited = starg_time_is_over(m->p->context);
    }
done:
    return status;
}

static void improver_free(improver *m) {
    region_scratch_free(&m->scratch);
    STARG_ARRAY_FREE(m->p->context, &m->neighbours);
    STARG_ARRAY_FREE(m->p->context, &m->met);
    STARG_ARRAY_FREE(m->p->context, &m->first);
}

starg_status improve_join(partition *p) {
    starg_status status = STARG_OK;
    improve_report report = {.trials = 0};
    improver m = {.p = p, .report = &report, .scratch = {.context = p->context}};
    STARG_TRY(find_contacts(&m));
    STARG_TRY(join_all(&m));
done:
    improver_free(&m);
    return status;
}

starg_status improve(partition *p, const improve_options *options, improve_report *report) {
    starg_status status = STARG_OK;
    improver m = {.p = p,
                  .report = report,
                  .scratch = {.context = p->context},
                  .began = starg_clock(),
                  .offset = options->first};
    *report = (improve_report){.trials = 0};
    starg_progress_begin(p->context, PARTITION_STAGE);
    STARG_TRY(find_contacts(&m));
    STARG_TRY(join_all(&m));
    if (!starg_time_is_over(p->context))
        STARG_TRY(merge_coplanar(p));
    STARG_TRY(find_contacts(&m));
    m.merge_from = p->facets.count + p->facets.count / 8;
    STARG_TRY(search(&m, options));
    STARG_TRY(merge_coplanar(p));
    STARG_TRY(apply_centers(p, &m.scratch));
done:
    starg_progress_end(p->context);
    improver_free(&m);
    return status;
}
