/* Making the pieces of a partition fewer.
 *
 * Problem: a partition into star-shaped pieces with as few pieces as can be found.
 *
 * Method: large neighbourhood search. First every two neighbours whose union is star-shaped are
 * joined, small pieces first. Then trials: some neighbouring pieces at random, their union to be
 * cut flat into one piece less (star/strict/recut.c), or, now and then, into as many pieces at
 * another place, which is kept when it makes large pieces larger and small ones smaller, so that
 * the small ones vanish in the end.
 *
 * Invariants: trials come in batches that look at the same partition, each with random numbers of
 * its own, and are carried out in their order unless an earlier one of the batch has changed a
 * piece of theirs: the result does not depend on the number of threads. Cost: a trial looks at the
 * facets of its union some hundred times. */
#include "star/strict/improve.h"

#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "star/strict/apply.h"
#include "star/strict/tidy.h"

enum { BATCH = 16, UNION_MOST = 5 };

static const double MARGIN = 4e-6; /* of guards to planes; the diagonal is at least 1/2 */

typedef struct trial {
    uint32_t pieces[UNION_MOST];
    size_t count;
    int parts;
    recut_plan plan;
    bool found;
} trial;

typedef struct contact {
    uint32_t a, b;
} contact;

typedef struct improver {
    partition *p;
    improve_report *report;
    uint64_t stalled; /* trials since the last success */
    size_t crowded;   /* facets from which on it is time to tidy up */
    trial trials[BATCH];
    region_scratch scratch;        /* of the calling thread */
    STARG_ARRAY(contact) contacts; /* both ways, ascending: neighbours of a piece in a row */
    STARG_ARRAY(uint32_t) first;   /* by piece: its first contact */
} improver;

/* ---- neighbours ---- */

static int by_pieces(const void *x, const void *y) {
    const contact *c = x, *d = y;
    if (c->a != d->a)
        return c->a < d->a ? -1 : 1;
    return c->b < d->b ? -1 : c->b > d->b;
}

static starg_status find_contacts(improver *m) {
    starg_status status = STARG_OK;
    const partition *p = m->p;
    size_t kept = 0;
    m->contacts.count = m->first.count = 0;
    for (size_t i = 0; i < p->facets.count; i++) {
        const uint32_t *side = p->facets.data[i].side;
        if (side[1] == PARTITION_OUTSIDE)
            continue;
        contact one = {side[0], side[1]}, other = {side[1], side[0]};
        STARG_PUSH(p->context, PARTITION_STAGE, &m->contacts, one);
        STARG_PUSH(p->context, PARTITION_STAGE, &m->contacts, other);
    }
    if (m->contacts.count > 0)
        qsort(m->contacts.data, m->contacts.count, sizeof *m->contacts.data, by_pieces);
    for (size_t i = 0; i < m->contacts.count; i++)
        if (i == 0 || by_pieces(&m->contacts.data[i], &m->contacts.data[kept - 1]) != 0)
            m->contacts.data[kept++] = m->contacts.data[i];
    m->contacts.count = kept;
    for (size_t i = 0, at = 0; i <= p->pieces.count; i++) {
        while (at < kept && m->contacts.data[at].a < i)
            at++;
        STARG_PUSH(p->context, PARTITION_STAGE, &m->first, (uint32_t)at);
    }
done:
    return status;
}

/* ---- joins ---- */

static starg_status try_join(improver *m, uint32_t a, uint32_t b, bool *done) {
    starg_status status = STARG_OK;
    const uint32_t pair[2] = {a, b};
    const recut_options options = {.margin = MARGIN};
    const recut_plan plan = {.cuts = 0};
    region r = {.vertices = {0}};
    starg_rng rng = {0};
    STARG_TRY(region_gather(m->p, pair, 2, &m->scratch, &r));
    STARG_TRY(recut_find(&r, 1, &options, &rng, &m->scratch, NULL, done));
    if (*done)
        STARG_TRY(apply_plan(m->p, pair, 2, &plan, MARGIN, -1, &m->scratch, done));
done:
    region_free(m->p->context, &r);
    return status;
}

/* Joins one piece with a neighbour if it can be done. */
static starg_status join_one(improver *m, uint32_t a, bool *done) {
    starg_status status = STARG_OK;
    *done = false;
    for (uint32_t i = m->first.data[a]; i < m->first.data[a + 1] && !*done; i++)
        STARG_TRY(try_join(m, a, m->contacts.data[i].b, done));
    if (*done) {
        m->report->joins++;
        STARG_TRY(find_contacts(m));
    }
done:
    return status;
}

static starg_status join_all(improver *m) {
    starg_status status = STARG_OK;
    STARG_TRY(find_contacts(m));
    for (uint32_t a = 0; a < m->p->pieces.count;) {
        bool done;
        STARG_TRY(starg_check_cancel(m->p->context, PARTITION_STAGE));
        STARG_TRY(join_one(m, a, &done));
        if (!done)
            a++;
        else
            a = 0;
        if (starg_time_is_over(m->p->context))
            goto done;
    }
done:
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
        uint32_t next = m->contacts.data[m->first.data[from] + starg_rng_below(rng, degree)].b;
        if (!is_in(t, next))
            t->pieces[t->count++] = next;
    }
}

static starg_status run_trial(starg_context *context, void *shared, void *scratch, size_t item) {
    starg_status status = STARG_OK;
    improver *m = shared;
    trial *t = &m->trials[item];
    region r = {.vertices = {0}};
    starg_rng rng = starg_rng_make(context->seed, 77, m->report->trials + item);
    static const size_t sizes[8] = {2, 2, 3, 3, 3, 4, 4, 5};
    *t = (trial){.found = false};
    choose_union(m, &rng, sizes[starg_rng_below(&rng, 8)], t);
    if (t->count < 2)
        goto done;
    bool move = t->count == 2 || starg_rng_below(&rng, 4) == 0;
    t->parts = move ? 2 : (int)t->count - 1;
    if (move)
        t->count = 2;
    const recut_options options = {.margin = 1e-5, .directions = 24, .steps = 16, .anywhere = move};
    STARG_TRY(region_gather(m->p, t->pieces, t->count, scratch, &r));
    STARG_TRY(recut_find(&r, t->parts, &options, &rng, scratch, &t->plan, &t->found));
done:
    region_free(context, &r);
    return status;
}

static starg_status make_scratch(starg_context *context, void *shared, void **out) {
    starg_status status = STARG_OK;
    region_scratch *scratch = NULL;
    (void)shared;
    STARG_NEW_ZERO(context, PARTITION_STAGE, scratch, 1);
    scratch->context = context;
done:
    *out = scratch;
    return status;
}

static void free_scratch(starg_context *context, void *scratch) {
    if (scratch != NULL)
        region_scratch_free(scratch);
    starg_release(context, scratch);
}

static starg_status carry_out(improver *m, const trial *t, bool *done) {
    starg_status status = STARG_OK;
    bool fewer = (size_t)t->parts < t->count;
    double least = fewer ? -1 : sum_of_squares(m->p, t->pieces, t->count);
    if (!fewer) {
        static double f = -2;
        if (f == -2)
            f = getenv("F") ? atof(getenv("F")) : 1;
        least *= f;
    }
    STARG_TRY(apply_plan(m->p, t->pieces, t->count, &t->plan, MARGIN, least, &m->scratch, done));
    if (!*done)
        m->report->refused++;
    else if (fewer)
        m->report->recuts++, m->stalled = 0;
    else
        m->report->moves++;
done:
    return status;
}

/* One success of a batch changes piece numbers: the others wait for another batch. */
static starg_status carry_out_batch(improver *m, size_t count) {
    starg_status status = STARG_OK;
    bool done = false;
    for (int fewer = 1; fewer >= 0; fewer--)
        for (size_t i = 0; i < count && !done; i++) {
            const trial *t = &m->trials[i];
            if (t->found && ((size_t)t->parts < t->count) == fewer)
                STARG_TRY(carry_out(m, t, &done));
        }
    if (done && m->p->facets.count > m->crowded) {
        STARG_TRY(tidy(m->p));
        m->crowded = m->p->facets.count + m->p->facets.count / 8;
    }
    if (done)
        STARG_TRY(find_contacts(m));
done:
    return status;
}

static starg_status run_batch(improver *m) {
    starg_status status = STARG_OK;
    const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                      .count = BATCH,
                                      .shared = m,
                                      .item = run_trial,
                                      .make_scratch = make_scratch,
                                      .free_scratch = free_scratch};
    STARG_TRY(starg_parallel_for(m->p->context, &loop));
    m->stalled += BATCH;
    STARG_TRY(carry_out_batch(m, BATCH));
    m->report->trials += BATCH;
done:
    return status;
}

starg_status improve(partition *p, const improve_options *options, improve_report *report) {
    starg_status status = STARG_OK;
    improver m = {.p = p, .report = report, .scratch = {.context = p->context}};
    *report = (improve_report){.trials = 0};
    STARG_TRY(join_all(&m));
    m.crowded = p->facets.count + p->facets.count / 8;
    while (p->pieces.count > 1 && p->pieces.count > options->enough &&
           report->trials < options->trials && m.stalled < 100 * p->pieces.count + 1000) {
        STARG_TRY(run_batch(&m));
        report->time_limited = starg_time_is_over(p->context);
        if (report->time_limited)
            break;
    }
done:
    region_scratch_free(&m.scratch);
    STARG_ARRAY_FREE(p->context, &m.contacts);
    STARG_ARRAY_FREE(p->context, &m.first);
    return status;
}
