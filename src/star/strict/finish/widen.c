/* SPDX-License-Identifier: Apache-2.0 */
/* Room for the guards of a partition whose number of pieces is final.
 *
 * Problem: a search for few pieces accepts any kernel, however small, but a guard close to the
 * plane of a face makes flat tetrahedra. The margin of a piece is the radius of the largest ball in
 * its kernel divided by the diagonal of its bounding box. Increase the small margins without adding
 * a piece.
 *
 * Method: local search, the smallest margin first. The union of the piece with one or two
 * neighbours is cut by other planes into as many parts (star/strict/search/repartition.c). That
 * search requires the margin from the start: the goal, or else a multiple of the smallest ball so
 * far. A piece without a solution is skipped until a neighbour changes.
 *
 * Invariants: those of the partition; a change enlarges the smallest ball of the pieces that it
 * affects. Cost: a trial of the search for each union; `work` in total. */
#include "star/strict/finish/widen.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "geometry/vec3.h"
#include "star/strict/partition/apply.h"
#include "star/strict/partition/merge_coplanar.h"

enum {
    IDLE_MOST = 12, /* consecutive rounds without a change before it stops */
    RNG_STREAM = 78,
    UNION_MOST = 4,
    TRIPLES = 12,
    DIRECTIONS = 32,
    STEPS = 24
};

/* The sufficient margin, the margin required at first, and the least growth of a ball. */
static const double ENOUGH = 2e-3, GOAL = 4e-3, GROWTH = 1.25;

typedef STARG_ARRAY(uint32_t) numbers;

typedef struct widener {
    partition *p;
    region_scratch scratch;
    uint64_t work, unions; /* work so far; unions tried */
    numbers around;        /* of a piece: its neighbours */
} widener;

typedef struct ranked_piece {
    double margin;
    uint32_t number;
} ranked_piece;

static int by_margin(const void *x, const void *y) {
    const ranked_piece *a = x, *b = y;
    if (a->margin != b->margin)
        return a->margin < b->margin ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

static double diagonal_of(const partition *p, uint32_t number) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++)
        for (int c = 0; c < 3; c++) {
            const double *at = partition_unit(p, p->facets.data[p->index.data[k] / 2].corners[c]);
            for (int i = 0; i < 3; i++) {
                lower[i] = fmin(lower[i], at[i]);
                upper[i] = fmax(upper[i], at[i]);
            }
        }
    return vec3_distance(lower, upper);
}

static double margin_of(const partition *p, uint32_t number) {
    return p->pieces.data[number].radius / diagonal_of(p, number);
}

/* ---- unions ---- */

static bool holds(const uint32_t *list, size_t count, uint32_t number) {
    for (size_t i = 0; i < count; i++)
        if (list[i] == number)
            return true;
    return false;
}

/* Appends the neighbours of a piece that are not yet in the list. */
static starg_status find_around(widener *w, uint32_t number) {
    starg_status status = STARG_OK;
    const partition *p = w->p;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t entry = p->index.data[k], next = p->facets.data[entry / 2].side[1 - entry % 2];
        if (next != PARTITION_OUTSIDE && !holds(w->around.data, w->around.count, next))
            STARG_PUSH(p->context, PARTITION_STAGE, &w->around, next);
    }
done:
    return status;
}

/* Repartitions the union with this margin. */
static starg_status cut_again(widener *w, const region *r, const uint32_t *pieces, size_t count,
                              double margin, bool *done) {
    starg_status status = STARG_OK;
    const repartition_options options = {
        .margin = margin, .directions = DIRECTIONS, .steps = STEPS};
    starg_rng rng = starg_rng_make(w->p->context->seed, RNG_STREAM, w->unions++);
    repartition_plan plan = {.cuts = 0};
    apply_effect effect = {.done = false};
    bool found = false;
    STARG_TRY(repartition_find(r, (int)count, &options, &rng, &w->scratch, &plan, &found));
    if (found)
        STARG_TRY(apply_plan(w->p, pieces, count, &plan, 0.9 * margin, -1, &w->scratch, &effect));
    *done = effect.done;
done:
    return status;
}

static starg_status try_union(widener *w, const uint32_t *pieces, size_t count, bool *done) {
    starg_status status = STARG_OK;
    const partition *p = w->p;
    region r = {.vertices = {0}};
    double smallest = INFINITY, largest = 0;
    for (size_t i = 0; i < count; i++) {
        smallest = fmin(smallest, p->pieces.data[pieces[i]].radius);
        largest = fmax(largest, diagonal_of(p, pieces[i]));
    }
    *done = false;
    STARG_TRY(starg_check_cancel(p->context, PARTITION_STAGE));
    STARG_TRY(region_gather(p, pieces, count, &w->scratch, &r));
    double goal = GOAL * largest, more = GROWTH * smallest;
    if (goal > more)
        STARG_TRY(cut_again(w, &r, pieces, count, goal, done));
    if (!*done)
        STARG_TRY(cut_again(w, &r, pieces, count, more, done));
done:
    region_free(p->context, &r);
    return status;
}

static bool is_over(const widener *w) {
    return w->scratch.work >= w->work || starg_time_is_over(w->p->context);
}

/* Tries each neighbour, then two pieces around. */
static starg_status widen_piece(widener *w, uint32_t number, bool *done) {
    starg_status status = STARG_OK;
    uint32_t set[UNION_MOST] = {number};
    size_t wanted;
    w->around.count = 0;
    *done = false;
    STARG_PUSH(w->p->context, PARTITION_STAGE, &w->around, number);
    STARG_TRY(find_around(w, number));
    size_t near = w->around.count;
    for (size_t i = 1; i < near && !*done && !is_over(w); i++) {
        set[1] = w->around.data[i];
        STARG_TRY(try_union(w, set, 2, done));
    }
    if (*done)
        goto done;
    for (size_t i = 1; i < near; i++)
        STARG_TRY(find_around(w, w->around.data[i]));
    for (uint64_t k = 0; k < TRIPLES && near > 1 && w->around.count > 2 && !*done && !is_over(w);
         k++) {
        size_t count = 2;
        starg_rng rng = starg_rng_make(w->p->context->seed, RNG_STREAM + 1, w->unions);
        set[1] = w->around.data[1 + starg_rng_below(&rng, near - 1)];
        wanted = 3 + starg_rng_below(&rng, 2);
        for (int attempt = 0; attempt < 8 && count < wanted; attempt++) {
            uint32_t next = w->around.data[1 + starg_rng_below(&rng, w->around.count - 1)];
            if (!holds(set, count, next))
                set[count++] = next;
        }
        STARG_TRY(try_union(w, set, count, done));
    }
done:
    return status;
}

/* ---- rounds ---- */

/* The pieces with insufficient margins, the smallest first. */
static starg_status rank(const widener *w, ranked_piece *list, size_t *count) {
    *count = 0;
    for (uint32_t i = 0; i < w->p->pieces.count; i++) {
        const ranked_piece one = {margin_of(w->p, i), i};
        if (one.margin < ENOUGH)
            list[(*count)++] = one;
    }
    if (*count > 1)
        qsort(list, *count, sizeof *list, by_margin);
    return STARG_OK;
}

static starg_status run_round(widener *w, ranked_piece *list, bool *any) {
    starg_status status = STARG_OK;
    size_t count;
    *any = false;
    STARG_TRY(rank(w, list, &count));
    for (size_t i = 0; i < count && !is_over(w); i++) {
        bool done;
        if (margin_of(w->p, list[i].number) >= ENOUGH)
            continue;
        STARG_TRY(widen_piece(w, list[i].number, &done));
        *any = *any || done;
    }
done:
    return status;
}

starg_status widen(partition *p, uint64_t work) {
    starg_status status = STARG_OK;
    widener w = {.p = p, .scratch = {.context = p->context}, .work = work};
    ranked_piece *list = NULL;
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
    starg_release(p->context, list);
    STARG_ARRAY_FREE(p->context, &w.around);
    region_scratch_free(&w.scratch);
    return status;
}
