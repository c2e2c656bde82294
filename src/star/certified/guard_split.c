/* SPDX-License-Identifier: Apache-2.0 */
/* A few guards that see all of a region, and the borders between their parts.
 *
 * Problem: cut a union of neighbouring pieces into fewer star-shaped parts, with borders of any
 * form, where flat ones (repartition.c) do not do.
 *
 * The corners of the surface's triangles, each seen by a guard strictly inside the triangle along a
 * free segment, are what any such parts need (docs/decomposition.md, "How few pieces"). So guards
 * come first: places that see all corners. Then they move until no segment from a guard to what it
 * alone is inside of meets one of another guard likewise (separator.c); where there is none,
 * borders are found as a rule. One part after the other is cut from the rest.
 *
 * Method: the starts, and places at random, each moved to where it is inside all that is near; for
 * some of them, a place inside all rows that they are not inside of; of all these the few that see
 * most together climb by random steps.
 *
 * Measured in femur_g2 and shell_309: of 42 unions where the best places missed ten corners or
 * fewer, 11 were cut in the end, of 178 where they missed more, one.
 *
 * Cost: where there is no hope, twenty small linear programs, and looks along a tree of the
 * triangles that end early; else up to a hundred looks at all vertices, and crossings as long as
 * MOVES_WORK. */
#include "star/certified/search.h"

#include <stdatomic.h>

#include "core/parallel.h"
#include "geometry/vec3.h"

enum {
    PLACES = 12,
    MATES = 8,
    POOL = PLACES + MATES,
    SPARE = POOL, /* a step that is tried */
    OTHERS,       /* what the others see  */
    VIEWS,
    LOOK_WORK = 250,  /* for a vertex, in what a row costs */
    LOOKS = 64,       /* at vertices, by an item of a loop */
    MISSED_MOST = 10, /* corners, of the best places; else there is no hope */
    CLIMBS = 100,
    CLIMBS_IDLE = 40,      /* then no more */
    MOVES_WORK = 40000000, /* about a sixth of a second */
    MOVES_IDLE = 250,
    TANGLED = 100000,     /* crossings, where guards do not even see all */
    PAIRS_MOST = 16000000 /* of triangles, to be looked at for crossings: most of a second */
};

/* Lengths of random steps, by the region's diagonal: ten to a power between. */
static const double LONGEST = -0.5, SHORTEST = -3.5;

/* What may be seen from a place: a bit for each corner. */
typedef struct view {
    double place[3];
    uint64_t *seen;
    bool looked; /* or only: whose triangles the place is inside of */
} view;

typedef struct searcher {
    const region *r;
    size_t guards;
    const guard_split_options *options;
    starg_rng *rng;
    region_scratch *scratch;
    bvh *tree;
    uint32_t *faces; /* of the tree, x 3 */
    size_t corners;  /* of all triangles */
    size_t stride;   /* from corner to corner, which leads to all */
    uint8_t *sight;  /* by vertex */
    view views[VIEWS];
    uint64_t *bits;                     /* of all views */
    size_t words;                       /* of each */
    double size;                        /* diagonal */
    double places[GUARD_SPLIT_MOST][3]; /* the result */
    separator_task task;
} searcher;

/* About the golden section, and no divisor in common. */
static size_t find_stride(size_t count) {
    for (size_t stride = (size_t)(0.618 * (double)count) | 1;; stride++) {
        size_t a = stride, b = count;
        while (b > 0) {
            size_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return stride;
    }
}

static starg_status begin(searcher *s) {
    starg_context *context = s->scratch->context;
    const region *r = s->r;
    s->corners = 3 * r->triangles.count;
    s->words = (s->corners + 63) / 64;
    s->stride = find_stride(s->corners);
    NEW(context, PARTITION_STAGE, s->faces, s->corners);
    NEW(context, PARTITION_STAGE, s->sight, r->vertices.count / 3);
    NEW(context, PARTITION_STAGE, s->bits, VIEWS * s->words);
    for (size_t i = 0; i < VIEWS; i++)
        s->views[i].seen = s->bits + i * s->words;
    for (size_t i = 0; i < s->corners; i++)
        s->faces[i] = r->triangles.data[i / 3].corners[i % 3];
    s->size = region_diagonal(r);
    return bvh_create(context, r->vertices.data, s->faces, r->triangles.count, &s->tree);
}

static void end(searcher *s) {
    bvh_free(s->tree);
    RELEASE(s->faces, s->sight, s->bits, s->task.own.data, s->task.others.data);
}

static const double *vertex(const searcher *s, uint32_t number) {
    return s->r->vertices.data + 3 * (size_t)number;
}

/* ---- sight ---- */

typedef struct segment {
    const searcher *s;
    const double *from;
    double along[3];
    uint32_t to; /* vertex */
    uint64_t work;
} segment;

/* Does the segment meet a triangle? Rounded. */
static bool meets(const segment *s, const uint32_t *corners) {
    const double *a = vertex(s->s, corners[0]);
    double ab[3], ac[3], ap[3], p[3], q[3];
    vec3_subtract(vertex(s->s, corners[1]), a, ab);
    vec3_subtract(vertex(s->s, corners[2]), a, ac);
    vec3_subtract(s->from, a, ap);
    vec3_cross(s->along, ac, p);
    vec3_cross(ap, ab, q);
    double scale = vec3_dot(ab, p);
    if (scale == 0)
        return false;
    double u = vec3_dot(ap, p) / scale, v = vec3_dot(s->along, q) / scale;
    double t = vec3_dot(ac, q) / scale;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1;
}

static bool passes(void *user, size_t rank) {
    segment *s = user;
    const uint32_t *c = s->s->faces + 3 * (size_t)s->s->tree->order[rank];
    s->work += 3;
    return c[0] == s->to || c[1] == s->to || c[2] == s->to || !meets(s, c);
}

static bool is_inside(const searcher *s, size_t triangle, const double place[3]) {
    const double *row = s->r->rows.data + 4 * (size_t)s->r->triangles.data[triangle].row;
    return row[3] - vec3_dot(row, place) >= s->options->margin;
}

/* All corners whose triangles a place is inside of. */
static void suppose(const searcher *s, view *out) {
    s->scratch->work += s->corners / 3;
    memset(out->seen, 0, s->words * sizeof *out->seen);
    out->looked = false;
    for (size_t i = 0; i < s->corners; i++)
        out->seen[i / 64] |= (uint64_t)is_inside(s, i / 3, out->place) << i % 64;
}

enum { UNKNOWN, FREE, MET }; /* the segment to a vertex */

/* Returns the work. */
static uint64_t look_at(const searcher *s, const double place[3], uint32_t at) {
    segment to = {.s = s, .from = place, .to = at, .work = LOOK_WORK};
    vec3_subtract(vertex(s, at), place, to.along);
    s->sight[at] = bvh_query_segment(s->tree, place, vertex(s, at), passes, &to) ? FREE : MET;
    return to.work;
}

/* Vertices to look at from a place, side by side. */
typedef struct looks {
    const searcher *s;
    const double *place;
    const uint32_t *vertices;
    size_t count;
    atomic_uint_fast64_t work;
} looks;

static starg_status look_at_some(starg_context *context, void *shared, void *scratch, size_t item) {
    looks *all = shared;
    uint64_t work = 0;
    (void)context;
    (void)scratch;
    for (size_t i = item * LOOKS; i < (item + 1) * LOOKS && i < all->count; i++)
        work += look_at(all->s, all->place, all->vertices[i]);
    atomic_fetch_add(&all->work, work);
    return STARG_OK;
}

static starg_status look_at_all(const searcher *s, const view *from) {
    starg_context *context = s->scratch->context;
    SCOPED uint32_t *list = NULL;
    NEW(context, PARTITION_STAGE, list, s->r->vertices.count / 3);
    looks all = {.s = s, .place = from->place, .vertices = list};
    for (size_t i = 0; i < s->corners; i++) {
        uint8_t *sight = &s->sight[s->faces[i]];
        if ((from->seen[i / 64] >> i % 64 & 1) == 0 || *sight != UNKNOWN)
            continue;
        *sight = MET;
        list[all.count++] = s->faces[i];
    }
    const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                      .count = (all.count + LOOKS - 1) / LOOKS,
                                      .shared = &all,
                                      .item = look_at_some,
                                      .silent = true};
    TRY(starg_parallel_for(context, &loop));
    s->scratch->work += atomic_load(&all.work);
    return STARG_OK;
}

/* Of these, only the ones that are seen, all of them or, unless it is NULL, those not in `others`.
 * Ends when more than `most` are not seen. Their order is mixed, for what is hidden lies together.
 */
static starg_status look(const searcher *s, view *out, const uint64_t *others, size_t most) {
    size_t lost = 0, i = 0;
    memset(s->sight, UNKNOWN, s->r->vertices.count / 3);
    if (others == NULL)
        TRY(look_at_all(s, out));
    for (size_t n = 0; n < s->corners && lost <= most; n++, i = (i + s->stride) % s->corners) {
        uint64_t word = out->seen[i / 64] & ~(others == NULL ? 0 : others[i / 64]);
        uint32_t at = s->faces[i];
        if (!(word >> i % 64 & 1))
            continue;
        if (s->sight[at] == UNKNOWN)
            s->scratch->work += look_at(s, out->place, at);
        if (s->sight[at] == FREE)
            continue;
        out->seen[i / 64] &= ~((uint64_t)1 << i % 64);
        lost++;
    }
    out->looked = others == NULL && lost <= most;
    return STARG_OK;
}

/* Corners that some of the views see. */
static size_t count_all(const searcher *s, view *const *views, size_t count) {
    size_t sum = 0;
    for (size_t w = 0; w < s->words; w++) {
        uint64_t seen = 0;
        for (size_t i = 0; i < count; i++)
            seen |= views[i]->seen[w];
        sum += starg_bits_in(seen);
    }
    return sum;
}

/* ---- places ---- */

static void take_place(const searcher *s, const double place[3], view *out) {
    vec3_copy(place, out->place);
    suppose(s, out);
}

/* Somewhere between a start and a vertex, then inside all rows that are near. */
static starg_status find_place(searcher *s, view *out) {
    const guard_split_options *o = s->options;
    const double *start = o->starts[starg_rng_below(s->rng, o->start_count)];
    double to[3], place[3];
    region_reach reach;
    vec3_subtract(vertex(s, (uint32_t)starg_rng_below(s->rng, s->r->vertices.count / 3)), start,
                  to);
    vec3_along(start, 0.95 * starg_rng_unit(s->rng), to, place);
    TRY(region_find_reach_about(s->r, place, o->margin, s->scratch, &reach));
    take_place(s, reach.height > -INFINITY ? reach.guard : place, out);
    return STARG_OK;
}

/* A place inside what another is not inside of, near a corner that it does not see. */
static starg_status find_mate(searcher *s, const view *of, view *out, bool *found) {
    region_reach reach;
    size_t at = starg_rng_below(s->rng, s->corners);
    for (size_t i = 0; i < s->corners && (of->seen[at / 64] >> at % 64 & 1); i++)
        at = at + 1 < s->corners ? at + 1 : 0;
    TRY(region_find_reach_for(s->r, vertex(s, s->faces[at]), of->place, s->options->margin,
                              s->scratch, &reach));
    *found = reach.height > -INFINITY;
    if (*found)
        take_place(s, reach.guard, out);
    return STARG_OK;
}

static starg_status fill_pool(searcher *s, size_t *count) {
    const guard_split_options *o = s->options;
    for (*count = 0; *count < PLACES; ++*count)
        if (*count < o->start_count)
            take_place(s, o->starts[*count], &s->views[*count]);
        else
            TRY(find_place(s, &s->views[*count]));
    for (size_t i = 0; i < MATES; i++) {
        bool found;
        TRY(find_mate(s, &s->views[i], &s->views[*count], &found));
        *count += found;
    }
    return STARG_OK;
}

static bool is_among(view *const *chosen, size_t count, const view *v) {
    for (size_t i = 0; i < count; i++)
        if (chosen[i] == v)
            return true;
    return false;
}

/* Another one of the pool, which sees most of what the first `count` of the chosen do not. */
static size_t complete(searcher *s, size_t pool, view **chosen, size_t count) {
    size_t most = 0;
    view *best = NULL;
    for (size_t i = 0; i < pool; i++) {
        if (is_among(chosen, count, &s->views[i]))
            continue;
        chosen[count] = &s->views[i];
        size_t seen = count_all(s, chosen, count + 1);
        if (best == NULL || seen > most) {
            most = seen;
            best = &s->views[i];
        }
    }
    chosen[count] = best;
    return most;
}

/* For each place, greedily adds the best partners. */
static size_t choose_supposed(searcher *s, size_t pool, view **chosen) {
    size_t most = 0;
    for (size_t first = 0; first < pool; first++) {
        view *own[GUARD_SPLIT_MOST] = {&s->views[first]};
        size_t seen = 0;
        for (size_t i = 1; i < s->guards; i++)
            seen = complete(s, pool, own, i);
        if (first > 0 && seen <= most)
            continue;
        most = seen;
        memcpy(chosen, own, sizeof own);
    }
    return most;
}

/* Corners that the chosen ones but one see. */
static const uint64_t *others_of(const searcher *s, view *const *chosen, size_t but) {
    uint64_t *others = s->views[OTHERS].seen;
    for (size_t w = 0; w < s->words; w++) {
        others[w] = 0;
        for (size_t i = 0; i < s->guards; i++)
            others[w] |= i == but ? 0 : chosen[i]->seen[w];
    }
    return others;
}

/* Looks from the best places only, as long as they may see `least`, until these are still the best.
 */
static starg_status choose(searcher *s, size_t pool, view **chosen, size_t least, size_t *out) {
    for (;;) {
        size_t most = choose_supposed(s, pool, chosen);
        *out = most;
        view *next = NULL;
        size_t which = 0;
        for (size_t i = 0; i < s->guards && next == NULL; i++)
            if (!chosen[i]->looked) {
                next = chosen[i];
                which = i;
            }
        if (next == NULL || most < least)
            return STARG_OK;
        TRY(look(s, next, others_of(s, chosen, which), most - least));
        if (count_all(s, chosen, s->guards) >= least)
            TRY(look(s, next, NULL, SIZE_MAX));
    }
}

static void random_step(const searcher *s, const double from[3], double out[3]) {
    double direction[3], power = SHORTEST + (LONGEST - SHORTEST) * starg_rng_unit(s->rng);
    starg_rng_direction(s->rng, direction);
    vec3_along(from, s->size * pow(10, power), direction, out);
}

/* A random step of one of the chosen: do all of them see at least as much as before? */
static starg_status try_step(searcher *s, view **chosen, size_t which, view *spare, size_t *most,
                             bool *kept) {
    view *former = chosen[which];
    const uint64_t *others = others_of(s, chosen, which);
    random_step(s, former->place, spare->place);
    suppose(s, spare);
    chosen[which] = spare;
    size_t seen = count_all(s, chosen, s->guards);
    if (seen >= *most) {
        TRY(look(s, spare, others, seen - *most));
        seen = count_all(s, chosen, s->guards);
    }
    *kept = seen >= *most;
    if (*kept) {
        *most = seen;
        return look(s, spare, NULL, SIZE_MAX);
    }
    chosen[which] = former;
    return STARG_OK;
}

/* Random steps that lose nothing. */
static starg_status climb(searcher *s, view **chosen, size_t *most) {
    view *spare = &s->views[SPARE];
    int idle = 0;
    for (int i = 0; i < CLIMBS && *most < s->corners && idle < CLIMBS_IDLE; i++, idle++) {
        size_t which = starg_rng_below(s->rng, s->guards), before = *most;
        view *former = chosen[which];
        bool kept;
        TRY(try_step(s, chosen, which, spare, most, &kept));
        if (kept)
            spare = former;
        if (*most > before)
            idle = 0;
    }
    return STARG_OK;
}

static starg_status find_places(searcher *s, bool *found) {
    view *chosen[GUARD_SPLIT_MOST];
    size_t pool, most;
    *found = false;
    TRY(fill_pool(s, &pool));
    size_t least = s->corners > MISSED_MOST ? s->corners - MISSED_MOST : 0;
    TRY(choose(s, pool, chosen, least, &most));
    if (most < least)
        return STARG_OK;
    TRY(climb(s, chosen, &most));
    *found = most == s->corners;
    for (size_t i = 0; i < s->guards; i++)
        vec3_copy(chosen[i]->place, s->places[i]);
    return STARG_OK;
}

/* ---- parts ---- */

/* The task for the part of guard `first`, cut from what former ones leave: triangles that none of
 * the later guards is inside of, and those that it is not, but a later one is. Those in `plan` are
 * left out. *all is false if there are triangles that no guard is inside of. */
static starg_status share_out(searcher *s, size_t first, const cut_plan *plan, bool *all) {
    separator_task *task = &s->task;
    task->r = s->r;
    task->guards = (const double(*)[3])(s->places + first);
    task->guard_count = s->guards - first;
    task->gap = s->options->margin;
    task->own.count = task->others.count = 0;
    *all = true;
    s->scratch->work += s->guards * s->corners / 3;
    for (uint32_t t = 0; t < s->corners / 3; t++) {
        bool former = false, own = is_inside(s, t, s->places[first]), later = false;
        for (size_t i = 0; i < first && !own; i++)
            former = former || is_inside(s, t, s->places[i]);
        for (size_t i = first + 1; i < s->guards && !later; i++)
            later = is_inside(s, t, s->places[i]);
        *all = *all && (former || own || later);
        if (own == later || (plan != NULL && separator_holds(s->r, plan, t)))
            continue;
        PUSH(s->scratch->context, PARTITION_STAGE, own ? &task->own : &task->others, t);
    }
    return STARG_OK;
}

/* Of all parts, up to `most`; as many where there are too many pairs to look at. */
static starg_status count_crossings(searcher *s, size_t most, size_t *count) {
    *count = 0;
    for (size_t i = 0; i + 1 < s->guards && *count < most; i++) {
        size_t more = 0;
        bool all;
        TRY(share_out(s, i, NULL, &all));
        all = all && (uint64_t)s->task.own.count * s->task.others.count <= PAIRS_MOST;
        if (all)
            TRY(crossings_count(&s->task, most - *count, s->scratch, &more));
        *count += all ? more : most;
    }
    return STARG_OK;
}

/* Moves the guards until no cones cross, or so long. */
static starg_status disentangle(searcher *s, bool *done) {
    size_t crossings;
    int idle = 0;
    const uint64_t limit = s->scratch->work + MOVES_WORK;
    TRY(count_crossings(s, TANGLED, &crossings));
    while (crossings > 0 && idle < MOVES_IDLE && s->scratch->work < limit) {
        double *place = s->places[starg_rng_below(s->rng, s->guards)], former[3];
        size_t now;
        vec3_copy(place, former);
        random_step(s, former, place);
        TRY(count_crossings(s, crossings + 1, &now));
        idle = now < crossings ? 0 : idle + 1;
        if (now > crossings)
            vec3_copy(former, place);
        else
            crossings = now;
    }
    *done = crossings == 0;
    return STARG_OK;
}

static starg_status find_borders(searcher *s, cut_plan *plan, bool *found) {
    plan->count = 0;
    for (size_t i = 0; i + 1 < s->guards && *found; i++) {
        TRY(share_out(s, i, plan, found));
        if (*found)
            TRY(separator_find(&s->task, s->rng, s->scratch, plan, found));
    }
    return STARG_OK;
}

starg_status guard_split_find(const region *r, size_t guards, const guard_split_options *options,
                              starg_rng *rng, region_scratch *scratch, cut_plan *plan,
                              bool *found) {
    SCOPED_BY(end)
    searcher s = {.r = r, .guards = guards, .options = options, .rng = rng, .scratch = scratch};
    *found = false;
    TRY(begin(&s));
    TRY(find_places(&s, found));
    if (*found)
        TRY(disentangle(&s, found));
    if (*found)
        TRY(find_borders(&s, plan, found));
    return STARG_OK;
}
