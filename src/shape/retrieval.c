/* SPDX-License-Identifier: Apache-2.0 */
/* Measures how well distances retrieve models of the query's class: Shilane, Min, Kazhdan and
 * Funkhouser, The Princeton shape benchmark, SMI 2004 [SMKF04].
 *
 * Stages: for each query (in parallel) rank the other models that have a class; walk down the
 * ranking and count; then average in the order of the queries.
 *
 * Equal distances rank by index. A class of one model has no query, because there is nothing to
 * find. The largest possible gain has all relevant models first, so a perfect ranking scores 1 in
 * every measure except the second tier and the E-measure of classes of other sizes.
 *
 * Cost: O(n^2 log n). */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "starguard/shape.h"

static const char STAGE[] = "evaluate";

enum { E_MEASURE_SHOWN = 32 };

typedef struct ranked {
    double distance;
    size_t model;
} ranked;

typedef struct evaluation {
    const double *distances;
    const uint32_t *class_of;
    size_t count;
    size_t *sizes;            /* of classes */
    starg_retrieval *queries; /* one per model */
} evaluation;

static int by_distance(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    if (x->distance != y->distance)
        return x->distance < y->distance ? -1 : 1;
    return (x->model > y->model) - (x->model < y->model);
}

/* ---- one query ---- */

/* A ranking: number of relevant models up to each place, from 1 on. */
typedef struct ranking {
    ranked *list;
    size_t *found;
    size_t shown, relevant;
} ranking;

/* Number found within the first places. */
static double found_within(const ranking *r, size_t places) {
    return (double)r->found[places < r->shown ? places : r->shown];
}

static double e_measure(const ranking *r) {
    double found = found_within(r, E_MEASURE_SHOWN);
    double shown = E_MEASURE_SHOWN < r->shown ? E_MEASURE_SHOWN : (double)r->shown;
    double precision = found / shown, recall = found / (double)r->relevant;
    return found > 0 ? 2 / (1 / precision + 1 / recall) : 0;
}

/* The gain of a relevant model at a place. */
static double gain_at(size_t place) {
    return place == 1 ? 1 : 1 / log2((double)place);
}

static double discounted_gain(const ranking *r) {
    double gain = 0, best = 0;
    for (size_t place = 1; place <= r->shown; place++)
        if (r->found[place] > r->found[place - 1])
            gain += gain_at(place);
    for (size_t place = 1; place <= r->relevant; place++)
        best += gain_at(place);
    return gain / best;
}

/* Precision where each level of recall is reached, or the largest one beyond. */
static void measure_precision(const ranking *r, double precision[STARG_RECALL_LEVELS]) {
    size_t level = 0;
    for (size_t place = 1; place <= r->shown; place++)
        for (; level < STARG_RECALL_LEVELS &&
               (level + 1) * r->relevant <= r->found[place] * STARG_RECALL_LEVELS;
             level++)
            precision[level] = (double)r->found[place] / (double)place;
    for (size_t i = STARG_RECALL_LEVELS - 1; i-- > 0;)
        precision[i] = fmax(precision[i], precision[i + 1]);
}

static void measure(const ranking *r, starg_retrieval *out) {
    double relevant = (double)r->relevant;
    out->queries = 1;
    out->nearest_neighbour = found_within(r, 1);
    out->first_tier = found_within(r, r->relevant) / relevant;
    out->second_tier = found_within(r, 2 * r->relevant) / relevant;
    out->e_measure = e_measure(r);
    out->dcg = discounted_gain(r);
    measure_precision(r, out->precision);
}

static void free_ranking(starg_context *context, void *scratch) {
    (void)context;
    ranking *r = scratch;
    if (r == NULL)
        return;
    RELEASE(r->list, r->found, r);
}

static starg_status make_ranking(starg_context *context, void *shared, void **scratch) {
    const evaluation *e = shared;
    ranking *r = starg_allocate_zero(context, 1, sizeof *r);
    if (r == NULL)
        return STARG_ERROR_MEMORY;
    r->list = starg_allocate(context, e->count, sizeof *r->list);
    r->found = starg_allocate(context, e->count + 1, sizeof *r->found);
    if (r->list == NULL || r->found == NULL) {
        free_ranking(context, r);
        return STARG_ERROR_MEMORY;
    }
    *scratch = r;
    return STARG_OK;
}

static void rank(const evaluation *e, size_t query, ranking *r) {
    r->shown = 0;
    for (size_t i = 0; i < e->count; i++)
        if (i != query && e->class_of[i] != STARG_NO_CLASS)
            r->list[r->shown++] = (ranked){e->distances[query * e->count + i], i};
    qsort(r->list, r->shown, sizeof *r->list, by_distance);
    r->found[0] = 0;
    for (size_t place = 1; place <= r->shown; place++)
        r->found[place] =
            r->found[place - 1] + (e->class_of[r->list[place - 1].model] == e->class_of[query]);
    r->relevant = r->found[r->shown];
}

static starg_status run_query(starg_context *context, void *shared, void *scratch, size_t query) {
    const evaluation *e = shared;
    ranking *r = scratch;
    (void)context;
    if (e->class_of[query] == STARG_NO_CLASS || e->sizes[e->class_of[query]] < 2)
        return STARG_OK;
    rank(e, query, r);
    measure(r, &e->queries[query]);
    return STARG_OK;
}

/* ---- means ---- */

static void add(starg_retrieval *sum, const starg_retrieval *query) {
    sum->queries += query->queries;
    sum->nearest_neighbour += query->nearest_neighbour;
    sum->first_tier += query->first_tier;
    sum->second_tier += query->second_tier;
    sum->e_measure += query->e_measure;
    sum->dcg += query->dcg;
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        sum->precision[i] += query->precision[i];
}

static void divide(starg_retrieval *sum) {
    double count = sum->queries > 0 ? (double)sum->queries : 1;
    sum->nearest_neighbour /= count;
    sum->first_tier /= count;
    sum->second_tier /= count;
    sum->e_measure /= count;
    sum->dcg /= count;
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        sum->precision[i] /= count;
}

static void take_means(const evaluation *e, size_t class_count, starg_retrieval *classes,
                       starg_retrieval *overall) {
    *overall = (starg_retrieval){0};
    for (size_t c = 0; c < class_count; c++) {
        classes[c] = (starg_retrieval){.models = e->sizes[c]};
        overall->models += e->sizes[c];
    }
    for (size_t i = 0; i < e->count; i++) {
        if (e->class_of[i] == STARG_NO_CLASS)
            continue;
        add(&classes[e->class_of[i]], &e->queries[i]);
        add(overall, &e->queries[i]);
    }
    for (size_t c = 0; c < class_count; c++)
        divide(&classes[c]);
    divide(overall);
}

static starg_status check_arguments(starg_context *context, const evaluation *e,
                                    size_t class_count) {
    for (size_t i = 0; i < e->count; i++)
        if (e->class_of[i] != STARG_NO_CLASS && e->class_of[i] >= class_count)
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "model %zu has class %lu, but there are %zu classes", i,
                              (unsigned long)e->class_of[i], class_count);
    for (size_t i = 0; i < e->count * e->count; i++)
        if (!(e->distances[i] >= 0))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "the distance of model %zu to model %zu is negative or no number",
                              i / e->count, i % e->count);
    return STARG_OK;
}

starg_status starg_retrieval_measure(starg_context *context, const double *distances,
                                     const uint32_t *class_of, size_t count, size_t class_count,
                                     starg_retrieval *classes, starg_retrieval *overall) {
    starg_status status = STARG_OK;
    evaluation e = {.distances = distances, .class_of = class_of, .count = count};
    STARG_TRY(check_arguments(context, &e, class_count));
    STARG_NEW_ZERO(context, STAGE, e.sizes, class_count);
    STARG_NEW_ZERO(context, STAGE, e.queries, count);
    for (size_t i = 0; i < count; i++)
        if (class_of[i] != STARG_NO_CLASS)
            e.sizes[class_of[i]]++;
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = count,
                                      .shared = &e,
                                      .item = run_query,
                                      .make_scratch = make_ranking,
                                      .free_scratch = free_ranking};
    STARG_TRY(starg_parallel_for(context, &loop));
    take_means(&e, class_count, classes, overall);
done:
    RELEASE(e.sizes, e.queries);
    return status;
}
