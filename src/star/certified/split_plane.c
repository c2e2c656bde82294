/* SPDX-License-Identifier: Apache-2.0 */
/* Split-plane search: a plane that makes a region easier to see.
 *
 * Problem: cut a region that no single point sees in two, recursively, until every part is
 * star-shaped. As in a decision tree, each cut should reduce the cost as much as possible. The cost
 * of a guard is the area of the triangles that it is not strictly behind. The cost of a plane is
 * the sum of the least costs of a guard below, for the triangles that reach below, and of a guard
 * above. A plane is used if it costs less than the best guard of the whole region.
 *
 * Stages: guards to choose from, each as far inside of as many triangles around a place as can be
 * (region.c): along random directions, about random places, about triangles that the best one
 * misses; for random directions the cost of all heights at once, by histograms; the best plane
 * turned a little; planes through edges of missed triangles, which leave no sliver of either side
 * at a sharp reflex edge.
 *
 * Large regions are searched by a sample of their triangles.
 *
 * Invariants: rounded throughout; a plane through no edge keeps to the widest gap between heights
 * of vertices near the best place. Cost: guards x triangles missed x directions, a few million. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum {
    BINS = 48,
    GUARDS = 48, /* of each effort: those about places and directions */
    NEEDED = 24, /* those about what is missed                         */
    DIRECTIONS = 32,
    TURNS = 16,
    EDGES = 32,
    EDGE_TURNS = 8,
    HURRY = 8,
    SAMPLE = 12000, /* triangles */
    ABREAST = 16    /* summed up before it is asked whether that is too much */
};

static const double FAIR_LEAST = 0.3, FAIR_MOST = 0.7, EDGE_GAIN = 0.97, EDGE_HOPE = 1.2,
                    EDGE_ROOM = 1e-5;

enum { BELOW = 1, ABOVE = 2 };

/* A place for a guard, and the triangles that it misses. */
typedef struct place {
    double at[3];
    double missed; /* area */
    size_t first, count;
} place;

typedef struct cut {
    double normal[3], height;
    double cost;
    bool through_edge;
} cut;

typedef struct plane_search {
    starg_context *context;
    const region *r;
    const split_plane_options *options;
    starg_rng *rng;
    region_scratch *scratch;
    double size;            /* diagonal of the box */
    region_values areas;    /* of triangles */
    region_values reach[2]; /* scratch: of those that reach below a plane, or above, else 0 */
    STARG_ARRAY(unsigned char) row_is_missed;
    STARG_ARRAY(unsigned char) sides; /* scratch: of vertices */
    STARG_ARRAY(unsigned char) bins;  /* scratch: of triangles, lowest and highest */
    STARG_ARRAY(uint32_t) missed;     /* triangles, place after place */
    STARG_ARRAY(place) places;
    size_t best_place;
    cut best, fair; /* of all, and of those into fair shares */
} plane_search;

static void plane_search_free(plane_search *d) {
    RELEASE(d->areas.data, d->reach[0].data, d->reach[1].data, d->row_is_missed.data, d->sides.data,
            d->bins.data, d->missed.data, d->places.data);
}

static const double *corner(const plane_search *d, const region_triangle *t, int k) {
    return d->r->vertices.data + 3 * (size_t)t->corners[k];
}

/* So many tries, by the effort. */
static int tries(const plane_search *d, int usual) {
    return d->options->effort > 0 ? usual * d->options->effort : usual / HURRY;
}

/* ---- preparation ---- */

static starg_status measure(plane_search *d) {
    d->size = region_diagonal(d->r);
    for (size_t i = 0; i < d->r->triangles.count; i++) {
        const region_triangle *t = &d->r->triangles.data[i];
        PUSH(d->context, PARTITION_STAGE, &d->areas,
             vec3_triangle_area(corner(d, t, 0), corner(d, t, 1), corner(d, t, 2)));
        for (int k = 0; k < 2; k++) {
            PUSH(d->context, PARTITION_STAGE, &d->reach[k], 0);
            PUSH(d->context, PARTITION_STAGE, &d->bins, 0);
        }
    }
    for (size_t i = 0; i < d->r->vertices.count / 3; i++)
        PUSH(d->context, PARTITION_STAGE, &d->sides, 0);
    for (size_t i = 0; i < d->r->rows.count / 4; i++)
        PUSH(d->context, PARTITION_STAGE, &d->row_is_missed, 0);
    return STARG_OK;
}

/* ---- places ---- */

static starg_status add_place(plane_search *d, const double at[3]) {
    place fresh = {.first = d->missed.count};
    vec3_copy(at, fresh.at);
    d->scratch->work += d->row_is_missed.count + d->r->triangles.count;
    for (size_t i = 0; i < d->row_is_missed.count; i++) {
        const double *row = d->r->rows.data + 4 * i;
        d->row_is_missed.data[i] = vec3_dot(row, at) - row[3] > -2 * d->options->margin;
    }
    for (size_t i = 0; i < d->r->triangles.count; i++) {
        if (!d->row_is_missed.data[d->r->triangles.data[i].row])
            continue;
        PUSH(d->context, PARTITION_STAGE, &d->missed, (uint32_t)i);
        fresh.missed += d->areas.data[i];
    }
    fresh.count = d->missed.count - fresh.first;
    PUSH(d->context, PARTITION_STAGE, &d->places, fresh);
    if (fresh.missed < d->places.data[d->best_place].missed)
        d->best_place = d->places.count - 1;
    return STARG_OK;
}

static starg_status add_reach_along(plane_search *d) {
    region_reach reach;
    double direction[3];
    starg_rng_direction(d->rng, direction);
    TRY(region_find_reach(d->r, direction, d->options->margin, d->scratch, &reach, NULL));
    if (reach.height > -INFINITY)
        TRY(add_place(d, reach.guard));
    return STARG_OK;
}

/* About the middle of a triangle, moved by `offset`. */
static starg_status add_reach_about(plane_search *d, size_t triangle, const double offset[3]) {
    const region_triangle *t = &d->r->triangles.data[triangle];
    region_reach reach;
    double center[3];
    for (int k = 0; k < 3; k++)
        center[k] = (corner(d, t, 0)[k] + corner(d, t, 1)[k] + corner(d, t, 2)[k]) / 3 + offset[k];
    TRY(region_find_reach_about(d->r, center, d->options->margin, d->scratch, &reach));
    if (reach.height > -INFINITY)
        TRY(add_place(d, reach.guard));
    return STARG_OK;
}

/* About a place on the surface, or some way below it. */
static starg_status add_reach_below(plane_search *d, bool on_surface) {
    size_t triangle = starg_rng_below(d->rng, d->r->triangles.count);
    const double *row = d->r->rows.data + 4 * (size_t)d->r->triangles.data[triangle].row;
    double depth = on_surface ? 0 : 0.5 * d->size * pow(10, -2 * starg_rng_unit(d->rng));
    const double offset[3] = {-depth * row[0], -depth * row[1], -depth * row[2]};
    return add_reach_about(d, triangle, offset);
}

static const place *random_place(const plane_search *d) {
    return &d->places.data[starg_rng_below(d->rng, d->places.count)];
}

/* About something that the best place misses, or now and then another one. */
static starg_status add_reach_needed(plane_search *d, bool nearby) {
    const place *from = &d->places.data[d->best_place];
    double offset[3], far = nearby ? 0.2 * d->size * pow(10, -3 * starg_rng_unit(d->rng)) : 0;
    if (starg_rng_below(d->rng, 4) == 0)
        from = random_place(d);
    if (from->count == 0)
        return STARG_OK;
    starg_rng_direction(d->rng, offset);
    for (int k = 0; k < 3; k++)
        offset[k] *= far;
    return add_reach_about(d, d->missed.data[from->first + starg_rng_below(d->rng, from->count)],
                           offset);
}

static starg_status add_places(plane_search *d) {
    int count = tries(d, GUARDS), needed = tries(d, NEEDED);
    for (size_t i = 0; i < d->options->place_count; i++)
        TRY(add_place(d, d->options->places + 3 * i));
    for (int i = 0; i < count; i++) {
        if (i % 4 == 0)
            TRY(add_reach_along(d));
        else
            TRY(add_reach_below(d, i % 4 == 1));
    }
    for (int i = 0; i < needed && d->places.count > 0; i++)
        TRY(add_reach_needed(d, i % 2 == 1));
    return STARG_OK;
}

/* ---- all heights along a direction ---- */

typedef struct histogram {
    double low, scale;               /* bin of height h: (h - low) * scale */
    double area_to[BINS];            /* of triangles that begin before the bin */
    double below[BINS], above[BINS]; /* cost of what is below and above the bin's lower limit */
} histogram;

static int bin_of(const histogram *h, double height) {
    double at = (height - h->low) * h->scale;
    return at < 0 ? 0 : at >= BINS ? BINS - 1 : (int)at;
}

static void find_bins(plane_search *d, const double normal[3], histogram *h) {
    double *height = d->scratch->heights.data, high = -INFINITY;
    h->low = INFINITY;
    for (size_t i = 0; i < d->r->vertices.count / 3; i++) {
        height[i] = vec3_dot(normal, d->r->vertices.data + 3 * i);
        h->low = height[i] < h->low ? height[i] : h->low;
        high = height[i] > high ? height[i] : high;
    }
    h->scale = BINS / (high - h->low);
    for (int i = 0; i < BINS; i++) {
        h->area_to[i] = 0;
        h->below[i] = h->above[i] = INFINITY;
    }
    for (size_t i = 0; i < d->r->triangles.count; i++) {
        const uint32_t *k = d->r->triangles.data[i].corners;
        double a = height[k[0]], b = height[k[1]], c = height[k[2]];
        double low = a < b ? a : b, top = a < b ? b : a;
        int first = bin_of(h, low < c ? low : c), last = bin_of(h, top < c ? c : top);
        d->bins.data[2 * i] = (unsigned char)first;
        d->bins.data[2 * i + 1] = (unsigned char)last;
        if (first + 1 < BINS)
            h->area_to[first + 1] += d->areas.data[i];
    }
    for (int i = 1; i < BINS; i++)
        h->area_to[i] += h->area_to[i - 1];
}

static void count_place(const plane_search *d, const double normal[3], const place *p,
                        histogram *h) {
    double begins[BINS] = {0}, ends[BINS] = {0}, sum = 0;
    for (size_t i = p->first; i < p->first + p->count; i++) {
        uint32_t triangle = d->missed.data[i];
        begins[d->bins.data[2 * triangle]] += d->areas.data[triangle];
        ends[d->bins.data[2 * triangle + 1]] += d->areas.data[triangle];
    }
    int own = bin_of(h, vec3_dot(normal, p->at));
    for (int i = 1; i < BINS; i++) {
        sum += begins[i - 1];
        if (own < i)
            h->below[i] = sum < h->below[i] ? sum : h->below[i];
    }
    sum = 0;
    for (int i = BINS - 1; i > 0; i--) {
        sum += ends[i];
        if (own >= i)
            h->above[i] = sum < h->above[i] ? sum : h->above[i];
    }
}

static void offer(cut *best, const double normal[3], double height, double cost, bool edge) {
    if (!(cost < best->cost))
        return;
    *best = (cut){.height = height, .cost = cost, .through_edge = edge};
    vec3_copy(normal, best->normal);
}

static void try_direction(plane_search *d, const double normal[3]) {
    histogram h;
    d->scratch->work += d->sides.count + 2 * d->r->triangles.count + 2 * d->missed.count;
    find_bins(d, normal, &h);
    for (size_t i = 0; i < d->places.count; i++)
        count_place(d, normal, &d->places.data[i], &h);
    double all = h.area_to[BINS - 1];
    for (int i = 1; i < BINS; i++) {
        double cost = h.below[i] + h.above[i], height = h.low + i / h.scale;
        offer(&d->best, normal, height, cost, false);
        if (d->options->demand == SPLIT_PLANE_HALVE)
            cost = starg_rng_unit(d->rng);
        if (h.area_to[i] > FAIR_LEAST * all && h.area_to[i] < FAIR_MOST * all)
            offer(&d->fair, normal, height, cost, false);
    }
}

/* From the normal of a row, from one place to another, or any. */
static void propose(const plane_search *d, int sort, double out[3]) {
    starg_rng_direction(d->rng, out);
    if (sort == 0) {
        const double *row = d->r->rows.data + 4 * starg_rng_below(d->rng, d->r->rows.count / 4);
        vec3_along(row, starg_rng_below(d->rng, 2) == 0 ? 0.05 : 0.3, out, out);
        vec3_normalize(out);
    } else if (sort == 1) {
        double between[3];
        /* one after the other: compilers evaluate arguments in orders of their own */
        const double *from = random_place(d)->at, *to = random_place(d)->at;
        vec3_subtract(to, from, between);
        if (vec3_length(between) > 1e-9) {
            vec3_copy(between, out);
            vec3_normalize(out);
        }
    }
}

static void try_directions(plane_search *d) {
    for (int i = 0; i < tries(d, DIRECTIONS); i++) {
        double normal[3];
        propose(d, i % 3, normal);
        try_direction(d, normal);
    }
}

static void turn_best(plane_search *d) {
    double angle = 0.3;
    for (int i = 0; i < TURNS && d->best.cost < INFINITY; i++) {
        double random[3], normal[3], before = d->best.cost;
        starg_rng_direction(d->rng, random);
        vec3_along(d->best.normal, angle, random, normal);
        vec3_normalize(normal);
        try_direction(d, normal);
        if (d->best.cost == before)
            angle *= 0.85;
    }
}

/* ---- planes through edges ---- */

/* The areas of the triangles that reach below a plane, and above. */
static void find_reach(plane_search *d, const double normal[3], double height) {
    for (size_t i = 0; i < d->sides.count; i++) {
        double above = vec3_dot(normal, d->r->vertices.data + 3 * i) - height;
        d->sides.data[i] = above < -1e-12 ? BELOW : above > 1e-12 ? ABOVE : 0;
    }
    for (size_t i = 0; i < d->areas.count; i++) {
        const uint32_t *c = d->r->triangles.data[i].corners;
        const int on = d->sides.data[c[0]] | d->sides.data[c[1]] | d->sides.data[c[2]];
        d->reach[0].data[i] = on & BELOW ? d->areas.data[i] : 0;
        d->reach[1].data[i] = on & ABOVE ? d->areas.data[i] : 0;
    }
}

/* What is cheapest of the places on each side of a plane. */
static double cost_of_plane(plane_search *d, const double normal[3], double height) {
    double cost[2] = {INFINITY, INFINITY};
    find_reach(d, normal, height);
    d->scratch->work += d->sides.count + d->missed.count / 2;
    for (size_t i = 0; i < d->places.count; i++) {
        const place *p = &d->places.data[i];
        const uint32_t *missed = d->missed.data + p->first;
        double above = vec3_dot(normal, p->at) - height, sum = 0;
        const int side = above >= 0;
        if (fabs(above) < d->options->margin)
            continue;
        for (size_t k = 0; k < p->count && sum < cost[side];)
            for (const size_t end = k + ABREAST; k < end && k < p->count; k++)
                sum += d->reach[side].data[missed[k]];
        cost[side] = fmin(cost[side], sum);
    }
    return cost[0] + cost[1];
}

/* Turned about its edge by a random angle. */
static void turn_about(const double edge[3], const double normal[3], double angle, double out[3]) {
    double across[3];
    vec3_cross(edge, normal, across);
    vec3_normalize(across);
    for (int k = 0; k < 3; k++)
        out[k] = cos(angle) * normal[k] + sin(angle) * across[k];
}

/* From all vertices but those that it goes through: what comes too near makes slivers. */
static bool keeps_away(const plane_search *d, const double normal[3], double height) {
    for (size_t i = 0; i < d->sides.count; i++) {
        double above = fabs(vec3_dot(normal, d->r->vertices.data + 3 * i) - height);
        if (above > 1e-12 && above < EDGE_ROOM * d->size)
            return false;
    }
    return true;
}

static void try_edge(plane_search *d, const double a[3], const double b[3]) {
    double edge[3], normal[3], reach = 0.3, range = d->best.cost * EDGE_HOPE;
    vec3_subtract(b, a, edge);
    double squared = vec3_dot(edge, edge);
    if (squared < 1e-18)
        return;
    starg_rng_direction(d->rng, normal);
    vec3_along(normal, -vec3_dot(normal, edge) / squared, edge, normal);
    if (vec3_length(normal) < 0.05)
        return;
    vec3_normalize(normal);
    double cost = cost_of_plane(d, normal, vec3_dot(normal, a));
    for (int i = 0; i < EDGE_TURNS && cost < range; i++) {
        double turned[3];
        turn_about(edge, normal, (2 * starg_rng_unit(d->rng) - 1) * reach, turned);
        double fresh = cost_of_plane(d, turned, vec3_dot(turned, a));
        if (fresh < cost) {
            cost = fresh;
            vec3_copy(turned, normal);
        } else {
            reach *= 0.7;
        }
    }
    if (cost < EDGE_GAIN * d->best.cost && keeps_away(d, normal, vec3_dot(normal, a)))
        offer(&d->best, normal, vec3_dot(normal, a), cost, true);
}

static void try_edges(plane_search *d) {
    for (int i = 0; i < tries(d, EDGES); i++) {
        const place *p = i % 2 == 0 ? random_place(d) : &d->places.data[d->best_place];
        if (p->count == 0)
            continue;
        const region_triangle *t =
            &d->r->triangles.data[d->missed.data[p->first + starg_rng_below(d->rng, p->count)]];
        int k = (int)starg_rng_below(d->rng, 3);
        try_edge(d, corner(d, t, k), corner(d, t, (k + 1) % 3));
    }
}

/* ---- the place of the plane ---- */

/* The middle of the widest gap between vertices' heights within the bin: a plane close to a vertex
 * makes slivers. */
static double widest_gap_near(const plane_search *d, const cut *c) {
    double *heights = d->scratch->heights.data, widest = -1, best = c->height;
    size_t count = 0;
    for (size_t i = 0; i < d->r->vertices.count / 3; i++) {
        double height = vec3_dot(c->normal, d->r->vertices.data + 3 * i);
        if (fabs(height - c->height) < 0.5 * d->size / BINS)
            heights[count++] = height;
    }
    qsort(heights, count, sizeof *heights, partition_ascending_real);
    for (size_t i = 0; i + 1 < count; i++)
        if (heights[i + 1] - heights[i] > widest) {
            widest = heights[i + 1] - heights[i];
            best = 0.5 * (heights[i] + heights[i + 1]);
        }
    return best;
}

static void choose(const plane_search *d, partition_plane *plane, bool *found) {
    const cut *c = &d->best;
    *found =
        d->options->demand != SPLIT_PLANE_HALVE && c->cost < d->places.data[d->best_place].missed;
    if (!*found && d->options->demand != SPLIT_PLANE_GAIN) {
        c = &d->fair;
        *found = c->cost < INFINITY;
    }
    if (!*found)
        return;
    vec3_copy(c->normal, plane->normal);
    plane->offset = c->through_edge ? c->height : widest_gap_near(d, c);
}

/* ---- samples ---- */

/* Every n-th triangle, with all vertices and rows. */
static starg_status take_sample(starg_context *context, const region *from, region *out) {
    size_t step = (from->triangles.count + SAMPLE - 1) / SAMPLE;
    for (size_t i = 0; i < from->vertices.count; i++)
        PUSH(context, PARTITION_STAGE, &out->vertices, from->vertices.data[i]);
    for (size_t i = 0; i < from->triangles.count; i += step)
        PUSH(context, PARTITION_STAGE, &out->triangles, from->triangles.data[i]);
    for (size_t i = 0; i < from->rows.count; i++)
        PUSH(context, PARTITION_STAGE, &out->rows, from->rows.data[i]);
    for (size_t i = 0; i < from->blocks.count; i++)
        PUSH(context, PARTITION_STAGE, &out->blocks, from->blocks.data[i]);
    return STARG_OK;
}

starg_status split_plane_find(const region *r, const split_plane_options *options, starg_rng *rng,
                              region_scratch *scratch, partition_plane *plane, bool *found) {
    SCOPED_BY(region_free) region sample = {.vertices = {0}};
    SCOPED_BY(plane_search_free)
    plane_search d = {.context = scratch->context,
                      .r = r,
                      .options = options,
                      .rng = rng,
                      .scratch = scratch,
                      .best = {.cost = INFINITY},
                      .fair = {.cost = INFINITY}};
    *found = false;
    if (r->triangles.count == 0)
        return STARG_OK;
    if (r->triangles.count > SAMPLE) {
        TRY(take_sample(scratch->context, r, &sample));
        d.r = &sample;
    }
    TRY(measure(&d));
    TRY(add_places(&d));
    if (d.places.count == 0)
        return STARG_OK;
    try_directions(&d);
    if (options->demand != SPLIT_PLANE_HALVE) {
        turn_best(&d);
        try_edges(&d);
    }
    choose(&d, plane, found);
    return STARG_OK;
}
