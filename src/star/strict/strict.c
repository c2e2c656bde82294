/* SPDX-License-Identifier: Apache-2.0 */
/* Strict star decomposition: few pieces, each proven to be star-shaped.
 *
 * Stages: two starts, each with its neighbours joined where that can be done, and the better one is
 * taken: regions of tetrahedra grown about guards, one after another (region_growing.c), which
 * always succeeds, and only the surfaces of the regions go on (partition.c); and the whole surface
 * cut by planes until every part is star-shaped (bsp_start.c), as a rule with fewer pieces by far.
 * Then unions of neighbours are cut again into fewer pieces, every step with an exact certificate
 * (improve.c), until nothing is found any more; then the same from the other start and from more
 * BSP starts, and the best result is kept. At the end each piece is made of tetrahedra about its
 * guard (cone.c).
 *
 * Starts are compared in docs/decomposition.md. */
#include "star/strict/strict.h"

#include "star/decomposition.h"
#include "star/strict/partition/cone.h"
#include "star/strict/search/improve.h"
#include "star/strict/start/bsp_start.h"
#include "star/strict/start/region_growing.h"

enum {
    SEARCHES = 6,
    IDLE_MOST = 2, /* searches in a row that bring nothing: then no more */
    EVALUATIONS_LEAST = 100,
    EVALUATIONS_EACH = 20, /* for each grown region; BSP starts that are done take 1 to 17 */
    EVALUATIONS_MOST = 1500
};

/* Of all searches, unless trials or time are limited: vertices, facets and rows looked at, which
 * are counted the same at any number of threads. About 4e8 take a second. */
static const uint64_t WORK_MOST = 6000000000;

static starg_status collect_guards(const partition *p, double **guards) {
    starg_status status = STARG_OK;
    STARG_NEW(p->context, PARTITION_STAGE, *guards, 3 * p->pieces.count);
    for (size_t i = 0; i < p->pieces.count; i++)
        for (int k = 0; k < 3; k++)
            (*guards)[3 * i + (size_t)k] = p->pieces.data[i].guard[k];
done:
    return status;
}

static starg_status finish(const partition *p, starg_decomposition **out) {
    starg_status status = STARG_OK;
    starg_tetmesh *mesh = NULL;
    int32_t *labels = NULL;
    double *guards = NULL;
    STARG_TRY(cone_all(p, &mesh, &labels));
    STARG_TRY(collect_guards(p, &guards));
    status = decomposition_finish(p->context, STARG_DECOMPOSE_STRICT, mesh, labels, guards,
                                  p->pieces.count, out);
    mesh = NULL;
    labels = NULL;
done:
    starg_tetmesh_free(mesh);
    starg_release(p->context, labels);
    starg_release(p->context, guards);
    return status;
}

/* ---- starts ---- */

static starg_status start_by_region_growing(const starg_tetmesh *mesh,
                                            const starg_decompose_options *options, partition *p) {
    starg_status status = STARG_OK;
    starg_context *context = p->context;
    grown_regions start = {.count = 0};
    STARG_TRY(grow_regions(context, mesh, options->guards, options->guard_count, &start));
    STARG_TRY(partition_create(context, mesh, start.labels, start.guards.data, start.count, p));
    STARG_TRY(improve_join(p));
done:
    grown_regions_free(context, &start);
    return status;
}

/* How many evaluations a BSP start is worth, where region growing has made so many pieces. */
static size_t evaluation_budget(size_t pieces) {
    size_t budget = EVALUATIONS_LEAST + EVALUATIONS_EACH * pieces;
    return budget < EVALUATIONS_MOST ? budget : EVALUATIONS_MOST;
}

/* All in one piece, then cut. */
static starg_status start_by_bsp(const starg_tetmesh *mesh, uint64_t stream, size_t budget,
                                 partition *p, bool *done) {
    starg_status status = STARG_OK;
    static const double nowhere[3] = {0, 0, 0};
    uint32_t *labels = NULL;
    *done = false;
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, labels, starg_tetmesh_count(mesh));
    STARG_TRY(partition_create(p->context, mesh, labels, nowhere, 1, p));
    STARG_TRY(bsp_start(p, stream, budget, done));
    if (*done)
        STARG_TRY(improve_join(p));
done:
    starg_release(p->context, labels);
    return status;
}

static void keep_better(partition *p, partition *other) {
    if (other->pieces.count >= p->pieces.count)
        return;
    partition before = *p;
    *p = *other;
    *other = before;
}

/* Both starts, the better one first; `other` is without pieces where one will do. Guards that were
 * given are what region growing begins with. */
static starg_status begin(const starg_tetmesh *mesh, const starg_decompose_options *options,
                          partition *p, partition *other, size_t *budget) {
    starg_status status = STARG_OK;
    bool done;
    STARG_TRY(start_by_region_growing(mesh, options, p));
    *budget = evaluation_budget(p->pieces.count);
    if (options->guard_count > 0 || p->pieces.count < 2 || starg_time_is_over(p->context))
        goto done;
    STARG_TRY(start_by_bsp(mesh, 0, *budget, other, &done));
    if (done)
        keep_better(p, other);
    else
        partition_free(other);
done:
    return status;
}

/* ---- searches ---- */

typedef struct searches {
    const starg_tetmesh *mesh;
    uint64_t trials_left, work_left;
    size_t enough;
    size_t budget;  /* of a BSP start */
    uint64_t count; /* searches so far */
    int idle;       /* of them, since the last that was better */
    bool time_limited;
} searches;

static starg_status run_search(searches *s, partition *p) {
    improve_report report;
    const improve_options wanted = {.trials = s->trials_left,
                                    .work = s->work_left,
                                    .enough = s->enough,
                                    .first = s->count << 40};
    starg_status status = improve(p, &wanted, &report);
    s->trials_left -= report.trials < s->trials_left ? report.trials : s->trials_left;
    s->work_left -= report.work < s->work_left ? report.work : s->work_left;
    s->time_limited = report.time_limited;
    s->count++;
    return status;
}

/* Two pieces are as few as can be when one was not enough. */
static bool may_search_again(const searches *s, const partition *p) {
    return s->count < SEARCHES && s->idle < IDLE_MOST && s->trials_left > 0 && s->work_left > 0 &&
           !s->time_limited && p->pieces.count > (s->enough > 2 ? s->enough : 2);
}

/* From the other start, or one more BSP start; the better result stays. */
static starg_status search_again(searches *s, partition *p, partition *other) {
    starg_status status = STARG_OK;
    bool done = other->pieces.count > 0;
    if (!done)
        STARG_TRY(start_by_bsp(s->mesh, s->count, s->budget, other, &done));
    if (done) {
        STARG_TRY(run_search(s, other));
        s->idle = other->pieces.count < p->pieces.count ? 0 : s->idle + 1;
        keep_better(p, other);
    } else {
        s->count = SEARCHES;
        s->time_limited = starg_time_is_over(p->context);
    }
done:
    partition_free(other);
    return status;
}

starg_status strict_decompose(starg_context *context, const starg_tetmesh *mesh,
                              const starg_decompose_options *options, starg_decomposition **out) {
    starg_status status = STARG_OK;
    partition p = {.context = context}, other = {.context = context};
    searches s = {.mesh = mesh,
                  .trials_left = options->effort > 0 ? options->effort : UINT64_MAX,
                  .work_left =
                      options->effort > 0 || context->deadline.at > 0 ? UINT64_MAX : WORK_MOST,
                  .enough = options->max_pieces > 0 ? options->max_pieces : 1};
    *out = NULL;
    STARG_TRY(begin(mesh, options, &p, &other, &s.budget));
    STARG_TRY(run_search(&s, &p));
    while (options->guard_count == 0 && may_search_again(&s, &p))
        STARG_TRY(search_again(&s, &p, &other));
    STARG_TRY(finish(&p, out));
    (*out)->time_limited = s.time_limited;
done:
    partition_free(&p);
    partition_free(&other);
    return status;
}
