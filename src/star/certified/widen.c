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

#include <stdlib.h>

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
    STEPS = 24
};

/* The margin required at first, and the growth of a ball that is required then; of what is required
 * in a search, the share that remains in rounded coordinates. */
static const double GOAL = 4e-3, GROWTH = 1.25, ROUNDED = 0.9;

typedef STARG_ARRAY(uint32_t) numbers;

typedef struct widener {
    partition *p;
    region_scratch scratch;
    uint64_t work, tries; /* the work allowed; searches so far */
    numbers around;       /* of a piece: its neighbours */
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

/* Two pieces, and the margin that both are to have. */
typedef struct pair {
    uint32_t pieces[2];
    const region *r; /* their union */
    double margin;   /* of guards, in unit coordinates */
} pair;

/* By a plane, or else from two guards that see all of the union. */
static starg_status cut(widener *w, const pair *of, bool plane, bool *done) {
    double starts[2][3];
    const repartition_options planes = {
        .margin = of->margin, .directions = DIRECTIONS, .steps = STEPS};
    const guard_split_options guards = {
        .margin = of->margin, .starts = (const double(*)[3])starts, .start_count = 2};
    starg_rng rng = starg_rng_make(w->p->context->seed, STREAM_WIDEN, w->tries++);
    cut_plan plan = {.count = 0};
    apply_effect effect = {.done = false};
    bool found = false;
    for (int i = 0; i < 2; i++)
        partition_to_unit(w->p, w->p->pieces.data[of->pieces[i]].guard, starts[i]);
    TRY(plane ? repartition_find(of->r, 2, &planes, &rng, &w->scratch, &plan, &found)
              : guard_split_find(of->r, 2, &guards, &rng, &w->scratch, &plan, &found));
    if (found)
        TRY(apply_cuts(w->p, of->pieces, 2, &plan, ROUNDED * of->margin, fitness, &w->scratch,
                       &effect));
    *done = effect.done;
    return STARG_OK;
}

/* With the margin that is aimed at, or else with more than the smaller one is now. */
static starg_status try_pair(widener *w, uint32_t a, uint32_t b, bool *done) {
    const partition *p = w->p;
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    pair of = {.pieces = {a, b}, .r = &r};
    const double margins[2] = {GOAL * fmax(flatness_diagonal(p, a), flatness_diagonal(p, b)),
                               GROWTH * fmin(p->pieces.data[a].radius, p->pieces.data[b].radius)};
    TRY(starg_check_cancel(p->context, PARTITION_STAGE));
    TRY(region_gather(p, of.pieces, 2, &w->scratch, &r));
    for (int i = 0; i < 2 && !*done && margins[i] <= margins[0]; i++) {
        of.margin = margins[i];
        TRY(cut(w, &of, true, done));
        if (!*done)
            TRY(cut(w, &of, false, done));
    }
    return STARG_OK;
}

static bool is_over(const widener *w) {
    return w->scratch.work >= w->work || starg_time_is_over(w->p->context);
}

static starg_status widen_piece(widener *w, uint32_t number, bool *done) {
    *done = false;
    TRY(find_around(w, number));
    for (size_t i = 0; i < w->around.count && !*done && !is_over(w); i++)
        TRY(try_pair(w, number, w->around.data[i], done));
    return STARG_OK;
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

static starg_status run_round(widener *w, flatness_rank *list, bool *any) {
    size_t count;
    *any = false;
    rank(w, list, &count);
    for (size_t i = 0; i < count && !is_over(w); i++) {
        bool done;
        TRY(widen_piece(w, list[i].number, &done));
        *any = *any || done;
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
    RELEASE(list, w.around.data);
    region_scratch_free(&w.scratch);
    return status;
}
