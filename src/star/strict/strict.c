/* SPDX-License-Identifier: Apache-2.0 */
/* Strict star decomposition: few pieces, each proven to be star-shaped.
 *
 * Stages: the surface is one piece (partition.c), which is cut by planes until every part is
 * star-shaped (bsp_start.c); neighbours are joined where that can be done; then unions of
 * neighbours are cut again into fewer pieces, every step with an exact certificate (improve.c),
 * until nothing is found any more; then the same from more starts, with other random numbers, and
 * the best result is kept. At the end guards get room (widen.c), and each piece is made of
 * tetrahedra about its guard (cone.c).
 *
 * The first start runs to its end whatever the time limit says, in a hurry once that has passed:
 * so there is a result. Where it fails, which takes roundings that spoil every cut of some piece,
 * others are tried. Given tetrahedra are grown into regions first (region_growing.c), which always
 * succeeds, and the better one of both starts is searched. */
#include "star/strict/strict.h"

#include "star/decomposition.h"
#include "star/strict/finish/widen.h"
#include "star/strict/partition/cone.h"
#include "star/strict/search/improve.h"
#include "star/strict/start/bsp_start.h"
#include "star/strict/start/region_growing.h"

enum {
    SEARCHES = 6,
    IDLE_MOST = 2,         /* searches in a row that bring nothing: then no more */
    EVALUATIONS_TIMES = 4, /* of the first start, that another one may take      */
    EVALUATIONS_LEAST = 50,
    EVALUATIONS_EACH = 3 /* for each grown region */
};

/* Of all searches, unless trials or time are limited: vertices, facets and rows looked at, which
 * are counted the same at any number of threads. About 4e8 take a second. */
static const uint64_t WORK_MOST = 6000000000;

/* The same for the room of guards at the end: so much and what the searches have taken, up to the
 * second; the third if more is asked for. */
static const uint64_t ROOM_LEAST = 50000000, ROOM_USUAL = 600000000, ROOM_MOST = 6000000000;

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

/* One of the two is NULL. */
typedef struct model {
    const kernel_faces *surface;
    const starg_tetmesh *mesh;
} model;

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

static starg_status make_one_piece(const model *m, partition *p) {
    starg_status status = STARG_OK;
    static const double nowhere[3] = {0, 0, 0};
    uint32_t *labels = NULL;
    if (m->surface != NULL)
        return partition_create_from_surface(p->context, m->surface, p);
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, labels, starg_tetmesh_count(m->mesh));
    STARG_TRY(partition_create(p->context, m->mesh, labels, nowhere, 1, p));
done:
    starg_release(p->context, labels);
    return status;
}

/* All in one piece, then cut. */
static starg_status start_by_bsp(const model *m, const bsp_options *options, partition *p,
                                 bsp_report *report) {
    starg_status status = STARG_OK;
    STARG_TRY(make_one_piece(m, p));
    STARG_TRY(bsp_start(p, options, report));
    if (report->done)
        STARG_TRY(improve_join(p));
    else
        partition_free(p);
done:
    return status;
}

static void keep_better(partition *p, partition *other) {
    if (other->pieces.count >= p->pieces.count)
        return;
    partition before = *p;
    *p = *other;
    *other = before;
}

/* ---- searches ---- */

typedef struct searches {
    model of;
    const starg_decompose_options *options;
    uint64_t trials_left, work_left, work_done;
    size_t enough;
    size_t budget;  /* of another start */
    uint64_t count; /* searches so far */
    int idle;       /* of them, since the last that was better */
    bool time_limited;
} searches;

static bsp_options start_options(const searches *s) {
    return (bsp_options){.stream = s->count,
                         .budget = s->budget,
                         .guards = s->options->guards,
                         .guard_count = s->options->guard_count};
}

/* Where there are tetrahedra, regions of them are a start at once, and in a solid full of holes the
 * better one; planes are worth no more than a few evaluations for each. */
static starg_status begin_with_tetrahedra(searches *s, partition *p) {
    starg_status status = STARG_OK;
    partition other = {.context = p->context};
    bsp_report report;
    STARG_TRY(start_by_region_growing(s->of.mesh, s->options, p));
    s->budget = EVALUATIONS_LEAST + EVALUATIONS_EACH * p->pieces.count;
    if (p->pieces.count < 2 || starg_time_is_over(p->context))
        goto done;
    const bsp_options options = start_options(s);
    STARG_TRY(start_by_bsp(&s->of, &options, &other, &report));
    if (report.done)
        keep_better(p, &other);
    else
        s->count = SEARCHES;
done:
    partition_free(&other);
    return status;
}

/* The first start; the partition has no pieces when there is none. */
static starg_status begin(searches *s, partition *p) {
    starg_status status = STARG_OK;
    bsp_report report = {.done = false};
    bsp_options options = start_options(s);
    if (s->of.mesh != NULL)
        return begin_with_tetrahedra(s, p);
    options.to_the_end = true;
    for (; !report.done && options.stream < SEARCHES; options.stream++)
        STARG_TRY(start_by_bsp(&s->of, &options, p, &report));
    s->budget = EVALUATIONS_TIMES * report.evaluations;
done:
    return status;
}

static starg_status run_search(searches *s, partition *p) {
    improve_report report;
    const improve_options wanted = {.trials = s->trials_left,
                                    .work = s->work_left,
                                    .enough = s->enough,
                                    .first = s->count << 40};
    starg_status status = improve(p, &wanted, &report);
    s->trials_left -= report.trials < s->trials_left ? report.trials : s->trials_left;
    s->work_left -= report.work < s->work_left ? report.work : s->work_left;
    s->work_done += report.work;
    s->time_limited = report.time_limited;
    s->count++;
    return status;
}

static uint64_t room_for(const searches *s) {
    uint64_t work = ROOM_LEAST + s->work_done;
    return s->options->quality ? ROOM_MOST : work < ROOM_USUAL ? work : ROOM_USUAL;
}

/* Two pieces are as few as can be when one was not enough. */
static bool may_search_again(const searches *s, const partition *p) {
    return s->count < SEARCHES && s->idle < IDLE_MOST && s->trials_left > 0 && s->work_left > 0 &&
           !s->time_limited && p->pieces.count > (s->enough > 2 ? s->enough : 2);
}

/* From another start; the better result stays. */
static starg_status search_again(searches *s, partition *p) {
    starg_status status = STARG_OK;
    partition other = {.context = p->context};
    bsp_report report;
    const bsp_options options = start_options(s);
    STARG_TRY(start_by_bsp(&s->of, &options, &other, &report));
    if (report.done) {
        STARG_TRY(run_search(s, &other));
        s->idle = other.pieces.count < p->pieces.count ? 0 : s->idle + 1;
        keep_better(p, &other);
    } else {
        s->count = SEARCHES;
        s->time_limited = starg_time_is_over(p->context);
    }
done:
    partition_free(&other);
    return status;
}

static starg_status decompose(starg_context *context, model of,
                              const starg_decompose_options *options, starg_decomposition **out) {
    starg_status status = STARG_OK;
    partition p = {.context = context};
    searches s = {.of = of,
                  .options = options,
                  .trials_left = options->effort > 0 ? options->effort : UINT64_MAX,
                  .work_left =
                      options->effort > 0 || context->deadline.at > 0 ? UINT64_MAX : WORK_MOST,
                  .enough = options->max_pieces > 0 ? options->max_pieces : 1};
    *out = NULL;
    STARG_TRY(begin(&s, &p));
    if (p.pieces.count == 0)
        goto done;
    STARG_TRY(run_search(&s, &p));
    while (may_search_again(&s, &p))
        STARG_TRY(search_again(&s, &p));
    STARG_TRY(widen(&p, room_for(&s)));
    STARG_TRY(finish(&p, out));
    (*out)->time_limited = s.time_limited;
done:
    partition_free(&p);
    return status;
}

starg_status strict_decompose_surface(starg_context *context, const kernel_faces *surface,
                                      const starg_decompose_options *options,
                                      starg_decomposition **out) {
    return decompose(context, (model){.surface = surface}, options, out);
}

starg_status strict_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                      const starg_decompose_options *options,
                                      starg_decomposition **out) {
    return decompose(context, (model){.mesh = mesh}, options, out);
}
