/* How well distances retrieve models of the query's class: the measures of Shilane, Min, Kazhdan
 * and Funkhouser, The Princeton shape benchmark, SMI 2004 [SMKF04].
 *
 * Stages: for each query (in parallel) rank the other models that have a class; go down the ranking
 * and count; then the means, in the order of the queries.
 *
 * Equal distances rank by index. A class of one model has no query, because there is nothing to
 * find. The largest possible gain has all relevant models in front, so that a perfect ranking has
 * the value 1 in every measure but the second tier and the E-measure of classes of other sizes.
 *
 * Cost: O(n^2 log n). */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
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
    size_t *sizes;            /* of classes  */
    starg_retrieval *queries; /* one a model */
} evaluation;

static int by_distance(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    if (x->distance != y->distance)
        return x->distance < y->distance ? -1 : 1;
    return (x->model > y->model) - (x->model < y->model);
}

static size_t rank(const evaluation *e, size_t query, ranked *list) {
    size_t shown = 0;
    for (size_t i = 0; i < e->count; i++)
        if (i != query && e->class_of[i] != STARG_NO_CLASS)
            list[shown++] = (ranked){e->distances[query * e->count + i], i};
    qsort(list, shown, sizeof *list, by_distance);
    return shown;
}

/* ---- one query ---- */

static double e_measure(size_t found, size_t shown, size_t relevant) {
    double precision = (double)found / (double)shown, recall = (double)found / (double)relevant;
    return found > 0 ? 2 / (1 / precision + 1 / recall) : 0;
}

/* The gain of a relevant model at a place, from 1 on. */
static double gain_at(size_t place) {
    return place == 1 ? 1 : 1 / log2((double)place);
}

/* `precision` has what holds where each level of recall is first reached; later places may have
 * more. */
static void interpolate(double precision[STARG_RECALL_LEVELS]) {
    for (size_t i = STARG_RECALL_LEVELS - 1; i-- > 0;)
        precision[i] = fmax(precision[i], precision[i + 1]);
}

static void measure_query(const evaluation *e, const ranked *list, size_t shown, uint32_t class,
                          size_t relevant, starg_retrieval *out) {
    size_t found = 0, level = 0;
    double gain = 0, best = 0;
    for (size_t place = 1; place <= shown; place++) {
        bool hit = e->class_of[list[place - 1].model] == class;
        if (hit) {
            found++;
            gain += gain_at(place);
            best += gain_at(found);
            double precision = (double)found / (double)place;
            for (; level < STARG_RECALL_LEVELS &&
                   (level + 1) * relevant <= found * STARG_RECALL_LEVELS;
                 level++)
                out->precision[level] = precision;
        }
        if (place == 1)
            out->nearest_neighbour = hit;
        if (place == relevant)
            out->first_tier = (double)found / (double)relevant;
        if (place == (2 * relevant < shown ? 2 * relevant : shown))
            out->second_tier = (double)found / (double)relevant;
        if (place == (E_MEASURE_SHOWN < shown ? E_MEASURE_SHOWN : shown))
            out->e_measure = e_measure(found, place, relevant);
    }
    out->dcg = gain / best;
    out->queries = 1;
    interpolate(out->precision);
}

static starg_status make_list(starg_context *context, void *shared, void **scratch) {
    const evaluation *e = shared;
    *scratch = starg_allocate(context, e->count, sizeof(ranked));
    return *scratch != NULL ? STARG_OK : STARG_ERROR_MEMORY;
}

static starg_status run_query(starg_context *context, void *shared, void *scratch, size_t query) {
    const evaluation *e = shared;
    uint32_t class = e->class_of[query];
    (void)context;
    if (class == STARG_NO_CLASS || e->sizes[class] < 2)
        return STARG_OK;
    size_t shown = rank(e, query, scratch);
    measure_query(e, scratch, shown, class, e->sizes[class] - 1, &e->queries[query]);
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
                                      .make_scratch = make_list,
                                      .free_scratch = starg_release};
    STARG_TRY(starg_parallel_for(context, &loop));
    take_means(&e, class_count, classes, overall);
done:
    starg_release(context, e.sizes);
    starg_release(context, e.queries);
    return status;
}
