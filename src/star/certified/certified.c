/* SPDX-License-Identifier: Apache-2.0 */
/* Certified star decomposition: few pieces, each proven to be star-shaped.
 *
 * Stages: the surface is one piece (partition.c), which is cut by planes until every part is
 * star-shaped (bsp_start.c); neighbours are joined where that can be done; then, in turns, small
 * changes save pieces (improve.c) and some neighbouring pieces are cut anew (ruin_recreate.c),
 * every step with an exact certificate, until nothing is found any more. At the end guards get room
 * (widen.c), borders between pieces better triangles (refine_caps.c), vertices of cuts and guards
 * better places (reshape.c), and each piece is made of tetrahedra about its guard.
 *
 * A start that the time limit overtakes goes on for a while, in a hurry, since without it there is
 * no result (starg_time_is_long_over). Where it fails, which takes roundings that spoil every cut
 * of some piece, others are tried. Given tetrahedra are grown into regions first
 * (region_growing.c), which always succeeds, and the better one of both starts is searched. */
#include "star/decomposition.h"

#include "star/certified/region_growing.h"
#include "star/certified/search.h"

enum {
    STARTS = 6, /* until one succeeds */
    IDLE = 1,   /* rounds for each piece that save nothing: then no more */
    IDLE_LEAST = 25,
    IDLE_FEW = 5, /* the same for the smallest models */
    EVALUATIONS_LEAST = 50,
    EVALUATIONS_EACH = 3 /* for each grown region */
};

/* Work of the search, by effort, unless trials or time are limited: vertices, facets and rows
 * visited, which are counted the same at any number of threads. About 2.5e8 take a second. The
 * first fifth of the best effort saves all but the last piece or two (docs/decomposition.md). */
static const uint64_t WORK_QUICK = 300000000, WORK_NORMAL = 1000000000, WORK_BEST = 4700000000;

/* Work of widen() and of reshape(): ROOM_LEAST and the search's work, at most ROOM_USUAL; with
 * `quality` ROOM_MOST. */
static const uint64_t ROOM_LEAST = 50000000, ROOM_USUAL = 600000000, ROOM_MOST = 6000000000;

/* Work of small changes in a round; about as much as ruin_recreate() takes. Where pieces and facets
 * are so few that their product is below USUAL_SIZE, there is less to try: the square of its share.
 */
static const uint64_t WORK_EACH = 100000000;
static const double USUAL_SIZE = 4000;

/* Each round, what there was before counts so much less: a search that has saved forty pieces and
 * now saves none need not wait for seventy rounds. */
static const double FADING = 0.7;

static starg_status collect_guards(const partition *p, double **guards) {
    NEW(p->context, PARTITION_STAGE, *guards, 3 * p->pieces.count);
    for (size_t i = 0; i < p->pieces.count; i++)
        for (int k = 0; k < 3; k++)
            (*guards)[3 * i + (size_t)k] = p->pieces.data[i].guard[k];
    return STARG_OK;
}

static starg_status finish(const partition *p, starg_decomposition **out) {
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *mesh = NULL;
    SCOPED int32_t *labels = NULL;
    SCOPED double *guards = NULL;
    TRY(cone_all(p, &mesh, &labels));
    TRY(collect_guards(p, &guards));
    starg_status status = decomposition_finish(p->context, STARG_DECOMPOSE_STRICT, mesh, labels,
                                               guards, p->pieces.count, out);
    mesh = NULL;
    labels = NULL;
    return status;
}

/* ---- starts ---- */

/* A surface, or tetrahedra. */
typedef struct model {
    const kernel_faces *surface;
    const solid_parts *parts; /* of the surface */
    const starg_tetmesh *mesh;
} model;

static starg_status start_by_region_growing(const starg_tetmesh *mesh,
                                            const starg_decompose_options *options, partition *p) {
    starg_context *context = p->context;
    SCOPED_BY(grown_regions_free) grown_regions start = {.count = 0};
    TRY(grow_regions(context, mesh, options->guards, options->guard_count, &start));
    TRY(partition_create(context, mesh, start.labels, start.guards.data, start.count, p));
    return improve_join(p);
}

static starg_status make_one_piece(const model *m, partition *p) {
    static const double nowhere[3] = {0, 0, 0};
    SCOPED uint32_t *labels = NULL;
    if (m->surface != NULL)
        return partition_create_from_surface(p->context, m->surface, m->parts, p);
    NEW_ZERO(p->context, PARTITION_STAGE, labels, starg_tetmesh_count(m->mesh));
    return partition_create(p->context, m->mesh, labels, nowhere, 1, p);
}

/* All in one piece, then cut. */
static starg_status start_by_bsp(const model *m, const bsp_options *options, partition *p,
                                 bsp_report *report) {
    IN_STAGE(p->context, "planes");
    TRY(make_one_piece(m, p));
    TRY(bsp_start(p, options, report));
    if (report->done)
        TRY(improve_join(p));
    else
        partition_free(p);
    return STARG_OK;
}

/* Where there are tetrahedra, regions of them are a start at once, and in a solid full of holes the
 * better one; planes are worth no more than a few evaluations for each. */
static starg_status begin_with_tetrahedra(const model *of, const starg_decompose_options *options,
                                          partition *p) {
    SCOPED_BY(partition_free) partition other = {.context = p->context};
    bsp_report report;
    TRY(start_by_region_growing(of->mesh, options, p));
    if (p->pieces.count < 2 || starg_time_is_over(p->context))
        return STARG_OK;
    const bsp_options wanted = {.budget = EVALUATIONS_LEAST + EVALUATIONS_EACH * p->pieces.count,
                                .guards = options->guards,
                                .guard_count = options->guard_count};
    TRY(start_by_bsp(of, &wanted, &other, &report));
    if (report.done && other.pieces.count < p->pieces.count)
        partition_swap(p, &other);
    return STARG_OK;
}

/* The partition has no pieces when there is no start. */
static starg_status begin(const model *of, const starg_decompose_options *options, partition *p) {
    bsp_report report = {.done = false};
    bsp_options wanted = {
        .guards = options->guards, .guard_count = options->guard_count, .to_the_end = true};
    if (of->mesh != NULL)
        return begin_with_tetrahedra(of, options, p);
    for (; !report.done && wanted.stream < STARTS; wanted.stream++)
        TRY(start_by_bsp(of, &wanted, p, &report));
    return STARG_OK;
}

/* ---- searches ---- */

/* What one way to save pieces has cost and brought lately. */
typedef struct record {
    double work, saved;
} record;

typedef struct searches {
    uint64_t trials, trials_left, work, work_left;
    size_t enough;
    double share;       /* of the usual size */
    uint64_t work_each; /* of small changes in a round */
    uint64_t rounds;    /* so far */
    size_t idle;        /* of them, since the last that saved a piece */
    record changes, recreations;
    bool time_limited;
    double began;                                /* clock */
    improve_tallies tallies, recreation_tallies; /* what helps differs */
} searches;

static uint64_t least(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static void spend(searches *s, record *on, uint64_t trials, uint64_t work, size_t saved) {
    s->trials += trials;
    s->work += work;
    s->trials_left -= least(trials, s->trials_left);
    s->work_left -= least(work, s->work_left);
    s->idle = saved > 0 ? 0 : s->idle + 1;
    on->work += (double)work;
    on->saved += (double)saved;
}

/* Small changes, for a while. */
static starg_status change_some(searches *s, partition *p) {
    improve_report report;
    const improve_options wanted = {.trials = s->trials_left,
                                    .work = least(s->work_left, s->work_each),
                                    .patience = UINT64_MAX,
                                    .enough = s->enough,
                                    .first = s->trials,
                                    .tallies = &s->tallies};
    size_t before = p->pieces.count;
    TRY(improve(p, &wanted, &report));
    spend(s, &s->changes, report.trials, report.work, before - p->pieces.count);
    s->time_limited = report.time_limited;
    return STARG_OK;
}

/* Some pieces anew. */
static starg_status recreate_some(searches *s, partition *p) {
    ruin_recreate_report report;
    const ruin_recreate_options wanted = {.trials = s->trials_left,
                                          .work = s->work_left,
                                          .round = s->rounds,
                                          .tallies = &s->recreation_tallies};
    size_t before = p->pieces.count;
    TRY(ruin_recreate(p, &wanted, &report));
    spend(s, &s->recreations, report.trials, report.work, before - p->pieces.count);
    s->time_limited = report.time_limited;
    return STARG_OK;
}

static double gain_of(const record *of, uint64_t each) {
    return (of->saved + 1) / (of->work + (double)each);
}

static void fade(record *of) {
    of->work *= FADING;
    of->saved *= FADING;
}

static size_t idle_most(const searches *s, const partition *p) {
    return IDLE * p->pieces.count + IDLE_FEW + (size_t)(s->share * (IDLE_LEAST - IDLE_FEW));
}

static uint64_t room_for(const searches *s, const starg_decompose_options *options) {
    uint64_t work = ROOM_LEAST + s->work;
    return options->quality ? ROOM_MOST : least(work, ROOM_USUAL);
}

/* Only while some component may have fewer pieces (partition_find_open). */
static starg_status may_go_on(const searches *s, const partition *p, bool *on) {
    SCOPED partition_numbers open = {0};
    *on = s->idle < idle_most(s, p) && s->trials_left > 0 && s->work_left > 0 && !s->time_limited &&
          p->pieces.count > s->enough;
    if (!*on)
        return STARG_OK;
    TRY(partition_find_open(p, &open));
    *on = open.count > 0;
    return STARG_OK;
}

/* Does the effort count trials? */
static bool counts_trials(const starg_decompose_options *options) {
    return options->effort > 0 && options->effort <= INT64_MAX;
}

static uint64_t work_of(const starg_decompose_options *options) {
    return options->effort == STARG_EFFORT_BEST    ? WORK_BEST
           : options->effort == STARG_EFFORT_QUICK ? WORK_QUICK
                                                   : WORK_NORMAL;
}

/* The effort that gives the same result without a clock. */
static uint64_t effort_of(const searches *s, const starg_decompose_options *options) {
    bool more = !counts_trials(options) && s->work > work_of(options);
    return more ? INT64_MAX : options->effort;
}

/* How far the search is, by whatever will end it. */
static void tell_progress(const searches *s, const partition *p) {
    double part = (double)s->idle / (double)idle_most(s, p), passed = starg_clock() - s->began;
    if (s->trials_left != UINT64_MAX)
        part = fmax(part, (double)s->trials / (double)(s->trials + s->trials_left));
    if (s->work_left <= WORK_BEST)
        part = fmax(part, (double)s->work / (double)(s->work + s->work_left));
    part = fmax(part, passed / (passed + fmax(0, starg_seconds_left(p->context))));
    starg_tell_best(p->context, p->pieces.count, "pieces");
    starg_progress_step(p->context, (size_t)(1e6 * fmin(1, part)), 1000000);
}

/* Continues with whichever search has lately saved more pieces for its work. */
static starg_status search(searches *s, partition *p) {
    starg_status status = STARG_OK;
    s->began = starg_clock();
    s->share = fmin(1, (double)p->pieces.count * (double)p->facets.count / USUAL_SIZE);
    s->work_each = (uint64_t)(s->share * s->share * (double)WORK_EACH);
    starg_progress_begin(p->context, PARTITION_STAGE);
    STARG_TRY(change_some(s, p));
    for (bool on; (status = may_go_on(s, p, &on)) == STARG_OK && on;) {
        STARG_TRY(starg_check_cancel(p->context, PARTITION_STAGE));
        s->rounds++;
        if (gain_of(&s->changes, s->work_each) >= gain_of(&s->recreations, s->work_each))
            STARG_TRY(change_some(s, p));
        else
            STARG_TRY(recreate_some(s, p));
        fade(&s->changes);
        fade(&s->recreations);
        tell_progress(s, p);
    }
done:
    starg_tell_best(p->context, 0, "");
    starg_progress_end(p->context);
    return status;
}

static starg_status decompose(starg_context *context, model of,
                              const starg_decompose_options *options, starg_decomposition **out) {
    SCOPED_BY(partition_free) partition p = {.context = context};
    SCOPED_BY(region_scratch_free) region_scratch scratch = {.context = context};
    bool trials = counts_trials(options), clocked = context->deadline.at > 0;
    searches s = {.trials_left = trials ? options->effort : UINT64_MAX,
                  .work_left = trials || clocked ? UINT64_MAX : work_of(options),
                  .enough = options->max_pieces > 0 ? options->max_pieces : 1};
    *out = NULL;
    TRY(begin(&of, options, &p));
    if (p.pieces.count == 0)
        return STARG_OK;
    if (!starg_time_is_over(context))
        TRY(merge_coplanar(&p));
    TRY(search(&s, &p));
    TRY(merge_coplanar(&p));
    TRY(apply_centers(&p, &scratch));
    TRY(widen(&p, room_for(&s, options)));
    TRY(refine_caps(&p));
    TRY(reshape(&p, room_for(&s, options)));
    TRY(finish(&p, out));
    (*out)->time_limited = s.time_limited;
    (*out)->options.effort = effort_of(&s, options);
    return STARG_OK;
}

starg_status certified_decompose_surface(starg_context *context, const kernel_faces *surface,
                                         const solid_parts *parts,
                                         const starg_decompose_options *options,
                                         starg_decomposition **out) {
    return decompose(context, (model){.surface = surface, .parts = parts}, options, out);
}

starg_status certified_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                         const starg_decompose_options *options,
                                         starg_decomposition **out) {
    return decompose(context, (model){.mesh = mesh}, options, out);
}
