/* SPDX-License-Identifier: Apache-2.0 */
/* Room for the guards of a partition whose number of pieces is final.
 *
 * Problem: a search for few pieces accepts any kernel, however small, but a guard close to the
 * plane of a face makes flat tetrahedra, and so do borders that cross near their corners. Reduce
 * what margins and angles lack in all without adding a piece.
 *
 * A tetrahedron lacks what its smallest angle is short of FLATNESS_ANGLE, as a share of that and
 * squared: max(0, 1 - angle / FLATNESS_ANGLE)^2. A piece lacks max(0, 1 - margin / FLATNESS_MARGIN)
 * of its margin, which weighs as much as a hundred angles, for a piece with a thin kernel has many
 * that are small, and other cuts of its neighbours cannot mend these. Rounded: it says which cut is
 * better, never whether one is valid.
 *
 * Method: local search, the piece that lacks most first. Its union with a neighbour is cut anew
 * into two parts: by another plane (repartition.c), or else from two guards that see all of it
 * (guard_split.c). These searches require a margin from the start: the goal, or else a multiple of
 * the smaller ball so far. Rounds go on until some have changed nothing. Unions of more than two
 * pieces are hardly ever better off (docs/decomposition.md, "Angles and margins").
 *
 * Invariants: those of the partition; a change lowers the sum. Cost: up to four searches for each
 * union; `work` in total. */
#include "star/certified/search.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/streams.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/piece_faces.h"

/* ---- what is lacking ---- */

/* Of a margin, in angles. */
static const double WEIGHT = 100;

typedef struct box {
    double lower[3], upper[3];
} box;

static const box EMPTY = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void add_facet(const partition *p, const facet *f, box *to) {
    for (int c = 0; c < 3; c++) {
        const double *at = partition_unit(p, f->corners[c]);
        for (int i = 0; i < 3; i++) {
            to->lower[i] = fmin(to->lower[i], at[i]);
            to->upper[i] = fmax(to->upper[i], at[i]);
        }
    }
}

static double lack_of_margin(const partition *p, uint32_t number, double diagonal) {
    double margin = p->pieces.data[number].radius / diagonal;
    return WEIGHT * fmax(0, 1 - margin / FLATNESS_MARGIN);
}

/* The smallest dihedral angle of the tetrahedron on a triangle of a piece, whose corners are
 * counter-clockwise from outside; negative if its guard is not strictly inside. Degrees. */
static double angle_over(const partition *p, uint32_t number, const uint32_t corners[3]) {
    const double *guard = p->pieces.data[number].guard, *origin = partition_point(p, corners[0]);
    double place[4][3] = {{0}};
    const int exponent = partition_exponent(p);
    if (orient3d(origin, partition_point(p, corners[1]), partition_point(p, corners[2]), guard) <=
        0)
        return -1;
    for (int i = 1; i < 4; i++) {
        vec3_subtract(i == 3 ? guard : partition_point(p, corners[i]), origin, place[i]);
        for (int k = 0; k < 3; k++)
            place[i][k] = ldexp(place[i][k], -exponent);
    }
    return angles_smallest((const double(*)[3])place);
}

double flatness_of_side(const partition *p, const facet *f, int side) {
    uint32_t corners[3];
    facet_outward(f, side, corners);
    const double angle = angle_over(p, f->side[side], corners);
    const double lack = fmax(0, 1 - angle / FLATNESS_ANGLE);
    return angle < 0 ? INFINITY : lack * lack;
}

double flatness_of_facet(const partition *p, const facet *f) {
    double sum = 0;
    for (int side = 0; side < 2; side++)
        if (f->side[side] != PARTITION_OUTSIDE)
            sum += flatness_of_side(p, f, side);
    return sum;
}

int flatness_compare(const void *x, const void *y) {
    const flatness_rank *a = x, *b = y;
    if (a->lack != b->lack)
        return a->lack > b->lack ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

double flatness_diagonal(const partition *p, uint32_t number) {
    box all = EMPTY;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++)
        add_facet(p, &p->facets.data[p->index.data[k] / 2], &all);
    return vec3_distance(all.lower, all.upper);
}

double flatness_room(const partition *p, uint32_t number) {
    double guard[3], least = INFINITY;
    partition_to_unit(p, p->pieces.data[number].guard, guard);
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t corners[3], entry = p->index.data[k];
        partition_plane plane;
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), corners);
        partition_plane_of(p, corners, &plane);
        least = fmin(least, plane.offset - vec3_dot(plane.normal, guard));
    }
    return least;
}

double flatness_of_piece(const partition *p, uint32_t number) {
    double sum = lack_of_margin(p, number, flatness_diagonal(p, number));
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t entry = p->index.data[k];
        sum += flatness_of_side(p, &p->facets.data[entry / 2], (int)(entry % 2));
    }
    return sum;
}

double flatness_of_first(const partition *p, size_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        box all = EMPTY;
        for (size_t f = 0; f < p->facets.count; f++)
            if (p->facets.data[f].side[0] == i || p->facets.data[f].side[1] == i)
                add_facet(p, &p->facets.data[f], &all);
        sum += lack_of_margin(p, i, vec3_distance(all.lower, all.upper));
    }
    for (size_t f = 0; f < p->facets.count; f++)
        sum += flatness_of_facet(p, &p->facets.data[f]);
    return sum;
}

/* ---- the search ---- */

enum {
    IDLE_MOST = 12, /* consecutive rounds without a change before it stops */
    DIRECTIONS = 32,
    STEPS = 24,
    AT_ONCE = 32 /* searches */
};

/* The margin required at first, and the growth of a ball that is required then; of what is required
 * in a search, the share that remains in rounded coordinates. */
static const double GOAL = 4e-3, GROWTH = 1.25, ROUNDED = 0.9;

typedef STARG_ARRAY(uint32_t) numbers;

/* A search in a round, for cuts of the union of a piece, by its rank, and one of its neighbours. */
typedef struct place {
    size_t rank, neighbour;
    int number; /* of those of the union */
} place;

typedef struct union_search {
    place at;
    uint32_t pieces[2];
    double margin; /* of guards, in unit coordinates */
    bool left;     /* not begun, as one before it has found a plan */
    bool found;
    cut_plan plan;
    uint64_t work;
} union_search;

typedef struct widener {
    partition *p;
    region_scratch scratch;
    uint64_t work, tries;      /* the work allowed; searches so far */
    numbers around;            /* of a piece: its neighbours */
    union_search *searches;    /* AT_ONCE */
    size_t count;              /* of these */
    atomic_size_t first_found; /* the first so far that has found a plan */
} widener;

/* ---- unions ---- */

/* The neighbours of a piece, each once. */
static starg_status find_around(widener *w, uint32_t number) {
    const partition *p = w->p;
    w->around.count = 0;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t entry = p->index.data[k], next = p->facets.data[entry / 2].side[1 - entry % 2];
        bool known = next == PARTITION_OUTSIDE;
        for (size_t i = 0; i < w->around.count && !known; i++)
            known = w->around.data[i] == next;
        if (!known)
            PUSH(p->context, PARTITION_STAGE, &w->around, next);
    }
    return STARG_OK;
}

static double fitness(const partition *part, size_t count) {
    return -flatness_of_first(part, count);
}

/* Up to four searches: with the margin that is aimed at, or else with more than the smaller one is
 * now, by a plane, or else from two guards that see all. Returns how many there are. */
static int margins_of(const partition *p, const uint32_t pieces[2], double margins[2]) {
    const piece *a = &p->pieces.data[pieces[0]], *b = &p->pieces.data[pieces[1]];
    margins[0] = GOAL * fmax(flatness_diagonal(p, pieces[0]), flatness_diagonal(p, pieces[1]));
    margins[1] = GROWTH * fmin(a->radius, b->radius);
    return margins[1] <= margins[0] ? 4 : 2;
}

static starg_status find_plan(const widener *w, size_t number, region_scratch *scratch,
                              union_search *s) {
    const partition *p = w->p;
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    double starts[2][3];
    const repartition_options planes = {
        .margin = s->margin, .directions = DIRECTIONS, .steps = STEPS};
    const guard_split_options guards = {
        .margin = s->margin, .starts = (const double(*)[3])starts, .start_count = 2};
    starg_rng rng = starg_rng_make(p->context->seed, STREAM_WIDEN, w->tries + number);
    for (int i = 0; i < 2; i++)
        partition_to_unit(p, p->pieces.data[s->pieces[i]].guard, starts[i]);
    TRY(region_gather(p, s->pieces, 2, scratch, &r));
    return s->at.number % 2 == 0
               ? repartition_find(&r, 2, &planes, &rng, scratch, &s->plan, &s->found)
               : guard_split_find(&r, 2, &guards, &rng, scratch, &s->plan, &s->found);
}

/* Those behind one with a plan are left: if that can be carried out, they are void. */
static starg_status run_search(starg_context *context, void *shared, void *scratch, size_t item) {
    widener *w = shared;
    region_scratch *own = scratch;
    union_search *s = &w->searches[item];
    uint64_t before = own->work;
    size_t first = atomic_load(&w->first_found);
    (void)context;
    s->left = item > first;
    if (s->left)
        return STARG_OK;
    TRY(find_plan(w, item, own, s));
    s->work = own->work - before;
    while (s->found && item < first &&
           !atomic_compare_exchange_weak(&w->first_found, &first, item)) {
    }
    return STARG_OK;
}

static bool is_over(const widener *w) {
    return w->scratch.work >= w->work || starg_time_is_over(w->p->context);
}

/* ---- rounds ---- */

/* The pieces that lack something, the worst first. */
static void rank(const widener *w, flatness_rank *list, size_t *count) {
    *count = 0;
    for (uint32_t i = 0; i < w->p->pieces.count; i++) {
        const flatness_rank one = {flatness_of_piece(w->p, i), i};
        if (one.lack > 0)
            list[(*count)++] = one;
    }
    if (*count > 1)
        qsort(list, *count, sizeof *list, flatness_compare);
}

/* Those of a union from a place on, as far as there is room. */
static void list_of_union(widener *w, const uint32_t pieces[2], place *next) {
    double margins[2];
    const int searches = margins_of(w->p, pieces, margins);
    for (; next->number < searches && w->count < AT_ONCE; next->number++)
        w->searches[w->count++] = (union_search){
            .at = *next, .pieces = {pieces[0], pieces[1]}, .margin = margins[next->number / 2]};
    if (next->number == searches)
        *next = (place){.rank = next->rank, .neighbour = next->neighbour + 1};
}

/* Those from a place on, as long as nothing changes; *next is the place behind them. */
static starg_status list_searches(widener *w, const flatness_rank *list, size_t count,
                                  place *next) {
    for (w->count = 0; next->rank < count && w->count < AT_ONCE;) {
        const uint32_t number = list[next->rank].number;
        TRY(find_around(w, number));
        while (next->neighbour < w->around.count && w->count < AT_ONCE) {
            const uint32_t pieces[2] = {number, w->around.data[next->neighbour]};
            list_of_union(w, pieces, next);
        }
        if (next->neighbour == w->around.count)
            *next = (place){.rank = next->rank + 1};
    }
    return STARG_OK;
}

/* Runs searches side by side, and carries out in their order what they find. *next: where to go
 * on. */
static starg_status run_searches(widener *w, place *next, bool *any) {
    const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                      .count = w->count,
                                      .shared = w,
                                      .item = run_search,
                                      .make_scratch = region_make_scratch,
                                      .free_scratch = region_free_scratch,
                                      .silent = true};
    apply_effect effect = {.done = false};
    atomic_store(&w->first_found, SIZE_MAX);
    TRY(starg_parallel_for(w->p->context, &loop));
    for (size_t k = 0; k < w->count && !is_over(w); k++) {
        union_search *s = &w->searches[k];
        *next = s->left ? s->at : *next;
        if (s->left)
            return STARG_OK;
        w->tries++;
        w->scratch.work += s->work;
        if (s->found)
            TRY(apply_cuts(w->p, s->pieces, 2, &s->plan, ROUNDED * s->margin, fitness, &w->scratch,
                           &effect));
        if (effect.done) {
            *any = true;
            *next = (place){.rank = s->at.rank + 1};
            return STARG_OK;
        }
    }
    return STARG_OK;
}

static starg_status run_round(widener *w, flatness_rank *list, bool *any) {
    size_t count;
    place next = {.rank = 0};
    *any = false;
    rank(w, list, &count);
    while (next.rank < count && !is_over(w)) {
        TRY(list_searches(w, list, count, &next));
        TRY(run_searches(w, &next, any));
    }
    return STARG_OK;
}

starg_status widen(partition *p, uint64_t work) {
    starg_status status = STARG_OK;
    widener w = {.p = p, .scratch = {.context = p->context}, .work = work};
    flatness_rank *list = NULL;
    bool any, changed = false;
    int idle = p->pieces.count > 1 ? 0 : IDLE_MOST;
    STARG_NEW(p->context, PARTITION_STAGE, list, p->pieces.count);
    STARG_NEW(p->context, PARTITION_STAGE, w.searches, AT_ONCE);
    while (idle < IDLE_MOST && !is_over(&w)) {
        STARG_TRY(run_round(&w, list, &any));
        changed = changed || any;
        idle = any ? 0 : idle + 1;
    }
    if (changed) {
        STARG_TRY(merge_coplanar(p));
        STARG_TRY(apply_centers(p, &w.scratch));
    }
done:
    p->context->work += w.scratch.work / PARTITION_WORK;
    RELEASE(list, w.searches, w.around.data);
    region_scratch_free(&w.scratch);
    return status;
}
