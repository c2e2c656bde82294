/* SPDX-License-Identifier: Apache-2.0 */
/* Repartition: the search for planes that cut a region into a given number of star-shaped parts.
 *
 * Problem: cut a union of m neighbouring pieces into fewer parts. A planar cut adds only one
 * half-space to each side, so that parts with planar borders have the largest kernels.
 *
 * Two parts: for a direction n let L be the highest plane with a star-shaped low side and H the
 * lowest with a star-shaped high side (region.c). A cut exists along n where L > H. The overlap L -
 * H is a function of n, piecewise smooth: random directions, the best few climb by random turns of
 * falling size.
 *
 * More parts: the direction and side whose star-shaped part takes most of the surface is cut off at
 * its highest plane, the rest is cut likewise; several such first cuts are tried in the order of
 * what they take.
 *
 * Invariants: planes keep away from all vertices of the region by PLANE_ROOM; both sides were
 * checked by the program at the very plane. Cost: two reaches for each direction. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { CLIMBERS = 2, PEELS = 3, PLACES = 4, PEEL_GAPS = 16 };

static const double PLANE_ROOM = 1e-7, FAIR = 0.2;

/* A search ends when the best overlap is still this bad, as a share of the region's size. Measured:
 * of 3,500 unions below the first after a third of the directions, 3 could be cut; of 2,500 below
 * the second after all of them, 1. */
static const double HOPELESS = -0.15, CLIMBABLE = -0.1;

typedef struct direction {
    double normal[3];
    double score;
    double low, high; /* two parts: a cut may be between */
} direction;

typedef struct searcher {
    const region *r;
    const repartition_options *options;
    starg_rng *rng;
    region_scratch *scratch;
} searcher;

/* ---- directions ---- */

static void turn_a_little(const double from[3], double angle, starg_rng *rng, double out[3]) {
    double random[3];
    starg_rng_direction(rng, random);
    vec3_along(from, angle, random, out);
    vec3_normalize(out);
}

/* Now and then the normal of a row: where pieces had a flat border before, a better one may be
 * near. */
static void propose(const searcher *s, double out[3]) {
    size_t rows = s->r->rows.count / 4;
    starg_rng_direction(s->rng, out);
    if (rows == 0 || starg_rng_below(s->rng, 4) != 0)
        return;
    const double *row = s->r->rows.data + 4 * starg_rng_below(s->rng, rows);
    if (vec3_dot(row, row) > 0.5)
        turn_a_little(row, 0.1, s->rng, out);
}

static void insert(direction *best, int most, int *count, const direction *fresh) {
    int i = *count;
    if (i < most)
        (*count)++;
    else if (best[--i].score >= fresh->score)
        return;
    for (; i > 0 && best[i - 1].score < fresh->score; i--)
        best[i] = best[i - 1];
    best[i] = *fresh;
}

static void negate(const double a[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = -a[k];
}

/* ---- places along a direction ---- */

typedef struct place {
    double height, room;
} place;

/* Are both sides (or the low one alone) star-shaped with the plane exactly there? */
static starg_status check_place(const searcher *s, const double normal[3], double height, bool both,
                                bool *fine) {
    double center[3], down[3], radius;
    negate(normal, down);
    *fine = false;
    TRY(region_find_center(s->r, normal, height, s->scratch, center, &radius));
    if (radius < s->options->margin)
        return STARG_OK;
    if (both)
        TRY(region_find_center(s->r, down, -height, s->scratch, center, &radius));
    *fine = radius >= s->options->margin;
    return STARG_OK;
}

static double widest_gap(const double *heights, size_t count) {
    double widest = 0;
    for (size_t i = 0; i + 1 < count; i++)
        widest = fmax(widest, heights[i + 1] - heights[i]);
    return widest;
}

/* The roomiest gaps between heights of vertices from low to high; or any ones of fair width: a
 * plane close to a vertex makes slivers. */
static int find_places(const searcher *s, const direction *d, place places[PLACES]) {
    double *heights = s->scratch->heights.data;
    size_t count = 0;
    int found = 0;
    for (size_t i = 0; i < s->scratch->heights.count; i++)
        if (heights[i] >= d->low && heights[i] <= d->high)
            heights[count++] = heights[i];
    qsort(heights, count, sizeof *heights, partition_ascending_real);
    double least = fmax(2 * PLANE_ROOM, FAIR * widest_gap(heights, count));
    for (size_t i = 0; i + 1 < count; i++) {
        place fresh = {0.5 * (heights[i] + heights[i + 1]), heights[i + 1] - heights[i]};
        if (fresh.room < least)
            continue;
        if (s->options->anywhere)
            fresh.room = starg_rng_unit(s->rng);
        int at = found;
        if (found < PLACES)
            found++;
        else if (places[--at].room >= fresh.room)
            continue;
        for (; at > 0 && places[at - 1].room < fresh.room; at--)
            places[at] = places[at - 1];
        places[at] = fresh;
    }
    return found;
}

static starg_status find_heights_of(const searcher *s, const double normal[3]) {
    s->scratch->heights.count = 0;
    for (size_t i = 0; i < s->r->vertices.count / 3; i++)
        PUSH(s->scratch->context, PARTITION_STAGE, &s->scratch->heights,
             vec3_dot(normal, s->r->vertices.data + 3 * i));
    return STARG_OK;
}

/* ---- two parts ---- */

static starg_status measure_overlap(const searcher *s, direction *d) {
    region_reach up, down;
    d->score = -INFINITY;
    d->low = d->high = 0;
    TRY(region_find_reach(s->r, d->normal, s->options->margin, s->scratch, &up, &down));
    if (up.height == -INFINITY)
        return STARG_OK;
    d->high = up.height;
    d->low = -down.height;
    d->score = d->high - d->low;
    return STARG_OK;
}

static void add_part(cut_plan *plan, const double normal[3], double offset) {
    partition_plane *plane = &plan->planes[plan->count];
    vec3_copy(normal, plane->normal);
    plane->offset = offset;
    plan->ends[plan->count++] = CUT_ENDS_PART;
}

static starg_status try_cut(const searcher *s, const direction *d, cut_plan *plan, bool *found) {
    place places[PLACES];
    TRY(find_heights_of(s, d->normal));
    int count = find_places(s, d, places);
    for (int i = 0; i < count && !*found; i++) {
        TRY(check_place(s, d->normal, places[i].height, true, found));
        if (*found) {
            add_part(plan, d->normal, places[i].height);
        }
    }
    return STARG_OK;
}

static starg_status climb(const searcher *s, direction *best, cut_plan *plan, bool *found) {
    double angle = 0.5;
    for (int step = 0; step < s->options->steps && !*found; step++) {
        direction next;
        turn_a_little(best->normal, angle, s->rng, next.normal);
        TRY(measure_overlap(s, &next));
        if (next.score > best->score)
            *best = next;
        else
            angle *= 0.8;
        if (next.score > 0)
            TRY(try_cut(s, &next, plan, found));
    }
    return STARG_OK;
}

static starg_status find_two(const searcher *s, cut_plan *plan, bool *found) {
    direction best[CLIMBERS];
    int count = 0;
    double size = region_diagonal(s->r);
    for (int i = 0; i < s->options->directions && !*found; i++) {
        direction fresh;
        propose(s, fresh.normal);
        TRY(measure_overlap(s, &fresh));
        if (fresh.score > 0)
            TRY(try_cut(s, &fresh, plan, found));
        if (fresh.score > -INFINITY)
            insert(best, CLIMBERS, &count, &fresh);
        if (3 * (i + 1) == s->options->directions &&
            (count == 0 || best[0].score < HOPELESS * size))
            return STARG_OK;
    }
    for (int i = 0; i < count && !*found && best[i].score > CLIMBABLE * size; i++)
        TRY(climb(s, &best[i], plan, found));
    return STARG_OK;
}

/* ---- more parts ---- */

static double area_below(const region *r, const double *heights, double height) {
    double sum = 0;
    for (size_t i = 0; i < r->triangles.count; i++) {
        const uint32_t *k = r->triangles.data[i].corners;
        if (heights[k[0]] > height || heights[k[1]] > height || heights[k[2]] > height)
            continue;
        sum += vec3_triangle_area(r->vertices.data + 3 * (size_t)k[0],
                                  r->vertices.data + 3 * (size_t)k[1],
                                  r->vertices.data + 3 * (size_t)k[2]);
    }
    return sum;
}

static starg_status measure_peel(const searcher *s, direction *d) {
    region_reach up;
    d->score = -INFINITY;
    TRY(region_find_reach(s->r, d->normal, s->options->margin, s->scratch, &up, NULL));
    if (up.height == -INFINITY)
        return STARG_OK;
    d->high = up.height;
    d->low = -INFINITY;
    d->score = area_below(s->r, s->scratch->heights.data, up.height);
    return STARG_OK;
}

/* The highest place below the reach with room for the plane. */
static starg_status place_peel(const searcher *s, const direction *d, double *height, bool *found) {
    TRY(find_heights_of(s, d->normal));
    double *heights = s->scratch->heights.data, top = -INFINITY;
    size_t count = 0;
    for (size_t i = 0; i < s->scratch->heights.count; i++)
        if (heights[i] <= d->high)
            heights[count++] = heights[i];
    qsort(heights, count, sizeof *heights, partition_ascending_real);
    /* among the highest gaps, not the widest of all */
    size_t first = count > PEEL_GAPS ? count - PEEL_GAPS : 0;
    double least = fmax(2 * PLANE_ROOM, FAIR * widest_gap(heights + first, count - first));
    for (size_t i = count; i-- > 1 && top == -INFINITY;)
        if (heights[i] - heights[i - 1] > least)
            top = 0.5 * (heights[i] + heights[i - 1]);
    *found = false;
    if (top == -INFINITY)
        return STARG_OK;
    *height = top;
    return check_place(s, d->normal, top, false, found);
}

static starg_status cut_off(const searcher *s, const direction *d, int parts, cut_plan *plan,
                            bool *found) {
    SCOPED_BY(region_free) region rest = {.vertices = {0}};
    double height = 0;
    bool placed;
    TRY(place_peel(s, d, &height, &placed));
    if (!placed)
        return STARG_OK;
    TRY(region_clip(s->scratch->context, s->r, d->normal, height, &rest));
    add_part(plan, d->normal, height);
    TRY(repartition_find(&rest, parts - 1, s->options, s->rng, s->scratch, plan, found));
    if (!*found)
        plan->count--;
    return STARG_OK;
}

static starg_status find_more(const searcher *s, int parts, cut_plan *plan, bool *found) {
    direction best[PEELS];
    int count = 0;
    for (int i = 0; i < s->options->directions; i++) {
        direction fresh;
        propose(s, fresh.normal);
        TRY(measure_peel(s, &fresh));
        if (fresh.score > -INFINITY)
            insert(best, PEELS, &count, &fresh);
    }
    for (int i = 0; i < count && !*found; i++)
        TRY(cut_off(s, &best[i], parts, plan, found));
    return STARG_OK;
}

static starg_status find_one(const searcher *s, bool *found) {
    double center[3], radius;
    starg_status status = region_find_center(s->r, NULL, 0, s->scratch, center, &radius);
    *found = status == STARG_OK && radius >= s->options->margin;
    return status;
}

starg_status repartition_find(const region *r, int parts, const repartition_options *options,
                              starg_rng *rng, region_scratch *scratch, cut_plan *plan,
                              bool *found) {
    const searcher s = {r, options, rng, scratch};
    *found = false;
    if (parts == 1)
        return find_one(&s, found);
    if (parts == 2)
        return find_two(&s, plan, found);
    return find_more(&s, parts, plan, found);
}
