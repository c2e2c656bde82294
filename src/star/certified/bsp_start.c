/* SPDX-License-Identifier: Apache-2.0 */
/* BSP start: cuts by planes until every piece is star-shaped.
 *
 * Problem: a partition of a solid into few star-shaped pieces with flat borders, found fast.
 *
 * Method: as a decision tree is grown. A piece with a kernel is done; any other is cut by the plane
 * after which two guards miss the least of it (split_plane.c), into connected parts, and each of
 * these goes on. All open pieces are looked at at once, then cut one after the other.
 *
 * A piece that resists (no plane gains, or the cut fails, or leaves a small component that nothing
 * sees) is tried again with more effort and with less room for its guard, and is then halved: a
 * plane that is right where the trouble is may cost more elsewhere in a large piece. What resists
 * that too is cut by planes of its reflex edges: an edge is reflex if one of its triangles rises
 * above the plane of the other. Of some planes between those of both, the one whose triangles on
 * the larger side are the fewest; one that fails, by rounding, is not found again soon, for all is
 * random.
 *
 * Why it ends: a plane through a reflex edge that lies between the planes of its two faces leaves
 * no reflex edge there, and makes none anywhere else, for a plane adds no angle above pi to either
 * side. So the reflex edges of each part are fewer than those of the whole, counted as the lines
 * that they are on, and a part without any is convex, which is star-shaped [Chazelle 1984].
 * Rounding is what this leaves out: new vertices are off their edges by some 1e-16 of the model's
 * size, so that faces bend by as much. It does no harm where the pieces are thicker than that by
 * far, and where they are not it shows in the exact certificate, or in a section whose edges cross:
 * the piece is opened again, or cut elsewhere, and so many times at most. After that the start has
 * failed; nothing that is not certified leaves it.
 *
 * Invariants: what a cut does to other pieces is nothing but split facets; every guard is certified
 * on the finished partition, and where that fails the piece is opened again. The result does not
 * depend on the number of threads. Cost: each round that of split_plane.c for all open pieces;
 * about as many rounds as twice the depth of the tree. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "core/streams.h"
#include "geometry/vec3.h"

enum { FAIR_FROM = 1, HALVE_FROM = 4, REFLEX_FROM = 8, ATTEMPTS_MOST = 60, EFFORT_MOST = 3 };
enum { PROOFS_MOST = 40 }; /* rounds of them */
enum { MANY_LEAST = 16 };
enum { SAMPLE = 12000 }; /* facets of a piece that are looked at first, or twice as many */

/* Numbers of stages are below. */
static const uint64_t STREAMS = 1000;

/* Where a start takes longer than this, it is taken to fail: in units of work, for each facet that
 * there is at first, and in any case. Those that end take a fifth. */
static const uint64_t WORK_EACH = 100000, WORK_LEAST = UINT64_C(2500000000);

static const double MARGIN = 2e-5, MARGIN_LEAST = 2e-9,
                    SMALL_COMPONENT = 1e-7; /* unit coordinates */
static const double THIN_SHARE = 0.125;
static const double TURN = 1e-5, TURN_MOST = 0.1; /* radians, about */

/* A piece that is not known to be star-shaped. */
typedef struct job {
    uint32_t number;
    int attempts;
    double above;    /* so large the ball must be: a smaller one has failed */
    double radius;   /* of the ball in its kernel, in unit coordinates */
    double most;     /* no such ball is larger, however the piece is cut */
    double guard[3]; /* the middle of it, in those of the solid */
    partition_plane plane;
    bool found;
    uint64_t work;
} job;

typedef struct bsp_builder {
    partition *p;
    const bsp_options *options;
    STARG_ARRAY(double) hints; /* guards to choose from, in unit coordinates */
    region_scratch scratch;    /* of the calling thread */
    STARG_ARRAY(job) jobs;
    STARG_ARRAY(job) next;
    bool hurry;
    size_t done;       /* jobs so far */
    size_t merge_from; /* facets from which on it is time to merge */
    double volume;     /* of the solid, in unit coordinates */
    double finished;   /* of it, in pieces that have a guard */
    uint64_t began;    /* with this stamp */
    uint64_t work, most_work;
    bool stale;  /* the index of the partition is */
    size_t many; /* more pieces than that: only planes of reflex edges are taken, which end */
    bool hopeless;
} bsp_builder;

/* Each attempt asks for less. */
static double ease_of(const job *j) {
    return pow(0.25, j->attempts);
}

/* More than a share of what there can be is not asked for: cutting a thin piece leaves thin ones.
 */
static double margin_of(const job *j) {
    return fmin(fmax(MARGIN * ease_of(j), MARGIN_LEAST), THIN_SHARE * j->most);
}

/* In pieces that resist, what exact proof there is will do. */
static bool is_star(const job *j) {
    return j->radius >= (j->attempts < HALVE_FROM ? margin_of(j) : 0) && j->radius > j->above;
}

/* ---- planes of reflex edges ---- */

enum { TRIES = 12 };

static const double FLAT = 1e-12; /* no more than this above a plane is not above it */

typedef struct ridges {
    const region *r;
    partition_edge *all; /* by edge */
    size_t count;
    STARG_ARRAY(uint32_t) reflex; /* the first of each reflex edge */
} ridges;

static starg_status list_edges(ridges *e, starg_context *context) {
    e->count = 3 * e->r->triangles.count;
    NEW(context, PARTITION_STAGE, e->all, e->count);
    for (uint32_t i = 0; i < e->count; i++) {
        const uint32_t *c = e->r->triangles.data[i / 3].corners;
        e->all[i] = (partition_edge){c[i % 3], c[(i + 1) % 3], i / 3};
    }
    return partition_sort_edges(context, e->all, e->count, e->r->vertices.count / 3);
}

static const double *row_of(const ridges *e, const partition_edge *at) {
    return e->r->rows.data + 4 * (size_t)e->r->triangles.data[at->facet].row;
}

/* How far a triangle rises above the plane of another one. */
static double rise(const ridges *e, const partition_edge *above, const partition_edge *of) {
    const double *row = row_of(e, of);
    double most = -INFINITY;
    for (int k = 0; k < 3; k++) {
        uint32_t corner = e->r->triangles.data[above->facet].corners[k];
        most = fmax(most, vec3_dot(row, e->r->vertices.data + 3 * (size_t)corner) - row[3]);
    }
    return most;
}

static starg_status list_reflex(ridges *e, starg_context *context) {
    for (size_t i = 0; i < e->count;) {
        const partition_edge *first = &e->all[i];
        size_t count = 1;
        while (i + count < e->count && partition_same_edge(first, &e->all[i + count]))
            count++;
        if (count > 2 ||
            (count == 2 && fmax(rise(e, first, first + 1), rise(e, first + 1, first)) > FLAT))
            PUSH(context, PARTITION_STAGE, &e->reflex, (uint32_t)i);
        i += count;
    }
    return STARG_OK;
}

/* Between the planes of the first two triangles; either of them, the middle, or any. */
static bool plane_through(const ridges *e, const partition_edge *first, starg_rng *rng,
                          partition_plane *plane) {
    const double *a = row_of(e, first), *b = row_of(e, first + 1);
    uint64_t sort = starg_rng_below(rng, 4);
    double share = sort == 3 ? starg_rng_unit(rng) : 0.5 * (double)sort;
    for (int k = 0; k < 3; k++)
        plane->normal[k] = (1 - share) * a[k] - share * b[k];
    if (vec3_normalize(plane->normal) < 1e-6)
        return false;
    plane->offset = vec3_dot(plane->normal, e->r->vertices.data + 3 * (size_t)first->a);
    return true;
}

/* Triangles on the larger side, or all of them if one side has none. */
static size_t weigh(const ridges *e, const partition_plane *plane) {
    size_t above = 0, below = 0, all = e->r->triangles.count;
    for (size_t i = 0; i < all; i++) {
        bool high = false, low = false;
        for (int k = 0; k < 3; k++) {
            const double *v = e->r->vertices.data + 3 * (size_t)e->r->triangles.data[i].corners[k];
            double height = vec3_dot(plane->normal, v) - plane->offset;
            high = high || height > FLAT;
            low = low || height < -FLAT;
        }
        above += high;
        below += low;
    }
    return above == 0 || below == 0 ? SIZE_MAX : above > below ? above : below;
}

/* A plane through a reflex edge of a region, such that no side has a reflex edge there; or through
 * an edge in which the region's surface touches itself. *found is false when there is no such edge:
 * the region is convex up to rounding, or in parts that are. */
static starg_status reflex_plane_find(const region *r, starg_rng *rng, region_scratch *scratch,
                                      partition_plane *plane, bool *found) {
    starg_status status = STARG_OK;
    starg_context *context = scratch->context;
    ridges e = {.r = r};
    size_t best = SIZE_MAX;
    *found = false;
    STARG_TRY(list_edges(&e, context));
    STARG_TRY(list_reflex(&e, context));
    for (int i = 0; i < TRIES && e.reflex.count > 0; i++) {
        partition_plane fresh;
        const partition_edge *first = &e.all[e.reflex.data[starg_rng_below(rng, e.reflex.count)]];
        if (!plane_through(&e, first, rng, &fresh))
            continue;
        size_t weight = weigh(&e, &fresh);
        if (weight < best) {
            best = weight;
            *plane = fresh;
            *found = true;
        }
    }
done:
    RELEASE(e.all, e.reflex.data);
    return status;
}

/* ---- looking at open pieces ---- */

static starg_status find_plane(const bsp_builder *b, job *j, const region *r, starg_rng *rng,
                               region_scratch *scratch) {
    int effort = j->attempts < EFFORT_MOST ? j->attempts + 1 : EFFORT_MOST;
    const split_plane_options options = {.margin = margin_of(j),
                                         .effort = b->hurry ? 0 : effort,
                                         .demand = j->attempts < FAIR_FROM    ? SPLIT_PLANE_GAIN
                                                   : j->attempts < HALVE_FROM ? SPLIT_PLANE_FAIR
                                                                              : SPLIT_PLANE_HALVE,
                                         .places = b->hints.data,
                                         .place_count = b->hints.count / 3};
    if (j->attempts >= REFLEX_FROM)
        return reflex_plane_find(r, rng, scratch, &j->plane, &j->found);
    return split_plane_find(r, &options, rng, scratch, &j->plane, &j->found);
}

/* A guard for a piece too thin for rounded programs, by exact proof. */
static starg_status find_kernel(const partition *p, job *j) {
    SCOPED partition_triangles triangles = {0};
    kernel_faces surface = {.vertices = p->points.data};
    starg_kernel_result result;
    TRY(partition_gather(p, j->number, &triangles));
    surface.faces = triangles.data;
    surface.count = triangles.count / 3;
    TRY(kernel_find(p->context, &surface, &result));
    if (result.verdict == STARG_KERNEL_INTERIOR) {
        vec3_copy(result.guard, j->guard);
        j->radius = ldexp(fabs(result.radius), -partition_exponent(p));
    }
    return STARG_OK;
}

/* The heights of a guard's planes above it, times the areas of the facets on them, sum to three
 * times the volume: so no ball about it is larger than three times the volume by the area. */
static double largest_radius(const region *r) {
    double area = 0, volume = 0;
    for (size_t i = 0; i < r->triangles.count; i++) {
        const double *c[3];
        double normal[3];
        for (int k = 0; k < 3; k++)
            c[k] = r->vertices.data + 3 * (size_t)r->triangles.data[i].corners[k];
        vec3_triangle_normal(c[0], c[1], c[2], normal);
        area += vec3_length(normal) / 2;
        volume += vec3_dot(normal, c[0]) / 6;
    }
    return 3 * fabs(volume) / area;
}

static starg_status find_guard(const partition *p, const region *r, job *j,
                               region_scratch *scratch) {
    double center[3];
    TRY(region_find_center(r, NULL, 0, scratch, center, &j->radius));
    if (j->radius > 0)
        partition_from_unit(p, center, j->guard);
    bool thin = j->most < MARGIN;
    if ((j->attempts >= HALVE_FROM || thin) && j->radius < margin_of(j)) {
        j->radius = -1;
        TRY(find_kernel(p, j));
    }
    return STARG_OK;
}

/* Where a sample of the facets leaves no room for a guard, the sample serves for the plane, too. */
static starg_status look_at(starg_context *context, void *shared, void *scratch, size_t item) {
    bsp_builder *b = shared;
    job *j = &b->jobs.data[item];
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    starg_rng rng =
        starg_rng_make(context->seed, STREAM_START + STREAMS * b->options->stream, b->done + item);
    uint32_t facets = b->p->start.data[j->number + 1] - b->p->start.data[j->number];
    region_scratch *own = scratch;
    uint64_t before = own->work;
    j->found = false;
    for (int all = facets < 2 * SAMPLE || j->attempts >= HALVE_FROM; all < 2; all++) {
        TRY(region_gather_some(b->p, &j->number, 1, all ? UINT32_MAX : SAMPLE, scratch, &r));
        j->most = all ? largest_radius(&r) : INFINITY;
        TRY(find_guard(b->p, &r, j, scratch));
        if (!is_star(j))
            break;
    }
    if (!is_star(j))
        TRY(find_plane(b, j, &r, &rng, scratch));
    j->work = own->work - before;
    return STARG_OK;
}

/* ---- cutting ---- */

/* A part so small that no later cut will make anything of it. */
static starg_status is_small_component(bsp_builder *b, partition *p, uint32_t number, const job *j,
                                       bool *small) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    double center[3], radius;
    *small = false;
    if (j->attempts >= REFLEX_FROM || p->pieces.data[number].volume >= SMALL_COMPONENT * ease_of(j))
        return STARG_OK;
    TRY(region_gather(p, &number, 1, &b->scratch, &r));
    TRY(region_find_center(&r, NULL, 0, &b->scratch, center, &radius));
    *small = radius < margin_of(j);
    return STARG_OK;
}

/* Facets that a cut has made keep the plane of what they were part of; where rounding has turned
 * one out of it, it may be that no guard will be certified. */
static bool is_flat(const partition *p, size_t old_points, double most) {
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        const uint32_t *c = f->corners;
        double normal[3], across[3];
        if (c[0] < old_points && c[1] < old_points && c[2] < old_points)
            continue;
        vec3_triangle_normal(partition_unit(p, c[0]), partition_unit(p, c[1]),
                             partition_unit(p, c[2]), normal);
        const double *expected = p->planes.data[f->plane].normal;
        vec3_cross(normal, expected, across);
        double along = vec3_dot(normal, expected);
        if (!(along > 0 && vec3_length(across) <= most * along))
            return false;
    }
    return true;
}

static starg_status renew_index(bsp_builder *b) {
    starg_status status = b->stale ? partition_build_index(b->p) : STARG_OK;
    b->stale = b->stale && status != STARG_OK;
    return status;
}

/* In the extract: the piece cut, and both sides parted into what is connected. */
static starg_status cut(bsp_builder *b, const job *j, partition_extract *e, bool *done) {
    const piece fresh = {.stamp = ++b->p->stamps};
    partition *part = &e->part;
    TRY(renew_index(b));
    TRY(extract_make(b->p, &j->number, 1, &b->scratch, e));
    uint32_t first = (uint32_t)part->pieces.count;
    PUSH(part->context, PARTITION_STAGE, &part->pieces, fresh);
    TRY(partition_slice(part, 0, first, &j->plane, done));
    *done = *done && is_flat(part, e->points.count, fmin(TURN / ease_of(j), TURN_MOST));
    if (!*done)
        return STARG_OK;
    TRY(partition_build_index(part));
    TRY(partition_separate(part, 0));
    TRY(partition_separate(part, first));
    for (uint32_t i = 0; i < part->pieces.count && *done; i = i < first ? first : i + 1) {
        bool small;
        TRY(is_small_component(b, part, i, j, &small));
        *done = !small;
    }
    return STARG_OK;
}

static starg_status open_piece(bsp_builder *b, uint32_t number, int attempts) {
    if (b->p->pieces.count > b->many && attempts < REFLEX_FROM)
        attempts = REFLEX_FROM;
    const job fresh = {.number = number, .attempts = attempts};
    PUSH(b->p->context, PARTITION_STAGE, &b->next, fresh);
    return STARG_OK;
}

static starg_status try_again(bsp_builder *b, const job *j) {
    b->hopeless = j->attempts >= ATTEMPTS_MOST;
    return b->hopeless ? STARG_OK : open_piece(b, j->number, j->attempts + 1);
}

static starg_status carry_out(bsp_builder *b, const job *j) {
    SCOPED_BY(extract_free) partition_extract e = {.part = {.context = b->p->context}};
    bool done = false;
    if (j->found)
        TRY(cut(b, j, &e, &done));
    if (!done) {
        return try_again(b, j);
    }
    uint32_t first = (uint32_t)b->p->pieces.count;
    TRY(extract_return(&e, b->p));
    b->stale = true;
    TRY(open_piece(b, j->number, j->attempts / 2));
    for (uint32_t i = first; i < b->p->pieces.count; i++)
        TRY(open_piece(b, i, j->attempts / 2));
    return STARG_OK;
}

static void settle(bsp_builder *b, const job *j) {
    piece *it = &b->p->pieces.data[j->number];
    vec3_copy(j->guard, it->guard);
    it->radius = j->radius;
    it->stamp = ++b->p->stamps;
    b->finished += it->volume;
    starg_progress_step(b->p->context, (size_t)(1e6 * fmin(1, b->finished / b->volume)), 1000000);
}

/* ---- rounds ---- */

/* Facets of a piece are split again and again, also by cuts of its neighbours. */
static starg_status merge_if_crowded(bsp_builder *b) {
    if (b->p->facets.count <= b->merge_from)
        return STARG_OK;
    starg_status status = merge_coplanar_unproven(b->p);
    b->merge_from = b->p->facets.count + b->p->facets.count / 8;
    return status;
}

static starg_status run_round(bsp_builder *b) {
    const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                      .count = b->jobs.count,
                                      .shared = b,
                                      .item = look_at,
                                      .make_scratch = region_make_scratch,
                                      .free_scratch = region_free_scratch,
                                      .silent = true};
    b->hurry = starg_time_is_over(b->p->context);
    TRY(starg_parallel_for(b->p->context, &loop));
    b->done += b->jobs.count;
    b->next.count = 0;
    for (size_t i = 0; i < b->jobs.count; i++) {
        const job *j = &b->jobs.data[i];
        b->work += j->work;
        TRY(starg_check_cancel(b->p->context, PARTITION_STAGE));
        if (b->options->to_the_end && starg_time_is_long_over(b->p->context))
            return starg_fail_time(b->p->context, PARTITION_STAGE);
        b->hopeless = b->hopeless || b->work > b->most_work;
        if (b->hopeless)
            continue;
        if (is_star(j))
            settle(b, j);
        else
            TRY(carry_out(b, j));
    }
    TRY(renew_index(b));
    return merge_if_crowded(b);
}

static void swap_lists(bsp_builder *b) {
    bsp_builder before = *b;
    b->jobs.data = before.next.data;
    b->jobs.count = before.next.count;
    b->jobs.capacity = before.next.capacity;
    b->next.data = before.jobs.data;
    b->next.count = 0;
    b->next.capacity = before.jobs.capacity;
}

static bool may_go_on(const bsp_builder *b) {
    return b->jobs.count > 0 && !b->hopeless &&
           (b->options->to_the_end ||
            (b->done < b->options->budget && !starg_time_is_over(b->p->context)));
}

/* ---- proofs ---- */

/* Once more, but from where it has been the ball must have grown to be tried again. */
static starg_status reopen(bsp_builder *b, uint32_t number, int round) {
    starg_status status = open_piece(b, number, round);
    if (status == STARG_OK)
        b->next.data[b->next.count - 1].above = 2 * b->p->pieces.data[number].radius;
    return status;
}

/* Pieces whose guard does not see them: neighbours' cuts have split their facets since. */
static starg_status certify(bsp_builder *b, int round) {
    SCOPED partition_triangles triangles = {0};
    partition *p = b->p;
    b->next.count = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        triangles.count = 0;
        TRY(partition_gather(p, i, &triangles));
        size_t count = triangles.count / 3;
        if (p->pieces.data[i].stamp > b->began)
            p->pieces.data[i].volume = partition_volume(p, triangles.data, count);
        if (!partition_certify(p, triangles.data, count, p->pieces.data[i].guard))
            TRY(reopen(b, i, round));
    }
    b->hopeless = round == PROOFS_MOST && b->next.count > 0;
    return STARG_OK;
}

static starg_status open_all(bsp_builder *b) {
    size_t given = b->p->pieces.count, chosen = b->options->piece_count;
    size_t count = b->options->pieces != NULL ? chosen : given;
    b->many = given + MANY_LEAST + b->p->facets.count / 2;
    for (size_t i = 0; i < count; i++) {
        uint32_t number = b->options->pieces != NULL ? b->options->pieces[i] : (uint32_t)i;
        TRY(partition_separate(b->p, number));
        TRY(open_piece(b, number, 0));
    }
    for (size_t i = given; i < b->p->pieces.count; i++)
        TRY(open_piece(b, (uint32_t)i, 0));
    for (size_t i = 0; i < b->next.count; i++)
        b->volume += b->p->pieces.data[b->next.data[i].number].volume;
    return STARG_OK;
}

static starg_status take_hints(bsp_builder *b) {
    for (size_t i = 0; i < b->options->guard_count; i++) {
        double unit[3];
        partition_to_unit(b->p, b->options->guards + 3 * i, unit);
        for (int k = 0; k < 3; k++)
            PUSH(b->p->context, PARTITION_STAGE, &b->hints, unit[k]);
    }
    return STARG_OK;
}

starg_status bsp_start(partition *p, const bsp_options *options, bsp_report *report) {
    starg_status status = STARG_OK;
    bsp_builder b = {
        .p = p, .options = options, .scratch = {.context = p->context}, .began = p->stamps};
    *report = (bsp_report){.done = false};
    STARG_TRY(take_hints(&b));
    STARG_TRY(open_all(&b));
    b.merge_from = p->facets.count + p->facets.count / 8;
    b.most_work = WORK_LEAST + WORK_EACH * p->facets.count;
    for (int round = 1; b.next.count > 0 && !b.hopeless; round++) {
        swap_lists(&b);
        while (may_go_on(&b)) {
            STARG_TRY(run_round(&b));
            swap_lists(&b);
        }
        report->work = b.work;
        if (b.jobs.count > 0)
            goto done;
        STARG_TRY(certify(&b, round));
    }
    report->done = !b.hopeless;
done:
    p->context->work += b.work / PARTITION_WORK;
    region_scratch_free(&b.scratch);
    RELEASE(b.hints.data, b.jobs.data, b.next.data);
    return status;
}
