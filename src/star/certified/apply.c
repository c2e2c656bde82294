/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of a partition, with proof: plans of cuts, fans, joins, and centred guards.
 *
 * Stages: extract the pieces (partition.c); in the extract, join them and slice the union (cut.c),
 * or distribute them by a fan of triangles; find a guard for each new piece and certify it exactly;
 * check that facets of other pieces split on the way still have their guard strictly inside; return
 * the extract and close gaps in the numbering.
 *
 * Fan: remove facets between the pieces; assign each facet of their union to its taker; along every
 * edge whose two facets go to different takers, add a triangle from the edge to the apex between
 * these; remove facets between a piece and its own taker. No facet and no edge is split, so that no
 * other piece is affected; every surface stays closed.
 *
 * Invariants: the partition is either untouched or satisfies its invariants again. Cost: of a plan
 * that fails, linear in the facets of its pieces; of one that succeeds, a pass over all facets. */
#include "star/certified/partition.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"

enum { PARTS_MOST = FAN_TAKERS_MOST }; /* more than a cut makes */

/* Pieces have the extract's numbers. */
typedef struct change {
    partition_extract extract;
    uint32_t parts[PARTS_MOST]; /* new pieces */
    size_t part_count;
    double margin;
    region_scratch *scratch;
} change;

/* ---- numbers ---- */

/* Removes pieces of the partition without facets: the last pieces take their numbers, the highest
 * first, so that a removed piece is never moved. Rebuilds the index. */
static starg_status drop_pieces(partition *p, const uint32_t *unused, size_t count,
                                apply_effect *effect) {
    bool gone[APPLY_MOST] = {false};
    for (size_t left = count; left > 0; left--) {
        uint32_t last = (uint32_t)p->pieces.count - 1;
        size_t hole = count;
        for (size_t i = 0; i < count; i++)
            if (!gone[i] && (hole == count || unused[i] > unused[hole]))
                hole = i;
        gone[hole] = true;
        partition_renumber(p, last, unused[hole]);
        effect->moves[effect->move_count++] = (apply_move){last, unused[hole]};
    }
    return partition_build_index(p);
}

/* ---- cuts ---- */

/* Cuts off what is above a plane, if anything is, and adds it to piece `away`. */
static starg_status cut_away(partition *p, uint32_t from, uint32_t empty, uint32_t away,
                             const partition_plane *plane, bool *done) {
    const uint32_t all[2] = {away, from}, part[2] = {away, empty};
    int sides = partition_sides(p, from, plane);
    if (sides == PARTITION_ABOVE)
        partition_join(p, all, 2);
    if (sides == (PARTITION_ABOVE | PARTITION_BELOW)) {
        TRY(partition_slice(p, from, empty, plane, done));
        partition_join(p, part, 2);
    }
    return STARG_OK;
}

/* Cuts the union of the first pieces of the extract into the parts of the plan, in their order. */
static starg_status cut(change *c, size_t count, const cut_plan *plan, bool *done) {
    static const uint32_t numbers[APPLY_MOST] = {0, 1, 2, 3, 4};
    partition *p = &c->extract.part;
    const size_t pieces = p->pieces.count;
    /* what is below the planes of a term so far, above some of them, and a place for a slice */
    const uint32_t below = (uint32_t)pieces, away = below + 1, empty = below + 2;
    uint32_t part = 0;
    for (int i = 0; i < 3; i++)
        PUSH(p->context, PARTITION_STAGE, &p->pieces, (piece){.radius = 0});
    partition_join(p, numbers, count);
    partition_join(p, (const uint32_t[2]){below, 0}, 2);
    *done = true;
    for (int i = 0; i < plan->count && *done; i++) {
        TRY(cut_away(p, below, empty, away, &plan->planes[i], done));
        if (plan->ends[i] == CUT_GOES_ON)
            continue;
        partition_join(p, (const uint32_t[2]){part, below}, 2);
        partition_join(p, (const uint32_t[2]){below, away}, 2);
        part += plan->ends[i] == CUT_ENDS_PART;
    }
    partition_join(p, (const uint32_t[2]){part, below}, 2);
    p->pieces.count = pieces;
    c->part_count = (size_t)part + 1;
    for (size_t i = 0; i < c->part_count; i++)
        c->parts[i] = numbers[i];
    return STARG_OK;
}

/* ---- proofs ---- */

static starg_status settle_piece(change *c, uint32_t number, bool *done) {
    partition *p = &c->extract.part;
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    SCOPED partition_triangles triangles = {0};
    piece fresh = {.stamp = ++p->stamps};
    double center[3];
    *done = false;
    TRY(region_gather(p, &number, 1, c->scratch, &r));
    TRY(region_find_center(&r, NULL, 0, c->scratch, center, &fresh.radius));
    if (fresh.radius < c->margin)
        return STARG_OK;
    partition_from_unit(p, center, fresh.guard);
    TRY(partition_gather(p, number, &triangles));
    *done = partition_certify(p, triangles.data, triangles.count / 3, fresh.guard);
    fresh.volume = partition_volume(p, triangles.data, triangles.count / 3);
    p->pieces.data[number] = fresh;
    return STARG_OK;
}

/* Do the guards of pieces outside the plan still see those of their facets that were split? */
static bool check_others(const change *c) {
    const partition *p = &c->extract.part;
    size_t old_points = c->extract.points.count;
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        if (f->corners[0] < old_points && f->corners[1] < old_points && f->corners[2] < old_points)
            continue;
        for (int side = 0; side < 2; side++) {
            uint32_t k[3];
            if (f->side[side] == PARTITION_OUTSIDE ||
                partition_lists(c->parts, c->part_count, f->side[side]))
                continue;
            facet_outward(f, side, k);
            if (orient3d(partition_point(p, k[0]), partition_point(p, k[1]),
                         partition_point(p, k[2]), p->pieces.data[f->side[side]].guard) <= 0)
                return false;
        }
    }
    return true;
}

/* Certified guards for all parts. */
static starg_status settle_parts(change *c, bool *done) {
    TRY(partition_build_index(&c->extract.part));
    *done = true;
    for (size_t i = 0; i < c->part_count && *done; i++)
        TRY(settle_piece(c, c->parts[i], done));
    return STARG_OK;
}

starg_status apply_cuts(partition *p, const uint32_t *pieces, size_t count, const cut_plan *plan,
                        double margin, apply_worth worth, region_scratch *scratch,
                        apply_effect *effect) {
    starg_status status = STARG_OK;
    change c = {.margin = margin, .scratch = scratch};
    bool done = false;
    *effect = (apply_effect){.done = false};
    STARG_TRY(extract_make(p, pieces, count, scratch, &c.extract));
    const double before = worth == NULL ? 0 : worth(&c.extract.part, count);
    STARG_TRY(cut(&c, count, plan, &done));
    if (done)
        STARG_TRY(settle_parts(&c, &done));
    effect->done =
        done && check_others(&c) && (worth == NULL || worth(&c.extract.part, count) > before);
    if (!effect->done)
        goto done;
    STARG_TRY(extract_return(&c.extract, p));
    STARG_TRY(drop_pieces(p, pieces + c.part_count, count - c.part_count, effect));
done:
    extract_free(&c.extract);
    return status;
}

/* ---- fans: finding facets again ---- */

void fan_plan_free(fan_plan *plan) {
    RELEASE(plan->entries.data, plan->takes.data, plan->corners.data);
    *plan = (fan_plan){.piece_count = 0};
}

typedef struct known_facet {
    uint32_t corners[3], entry;
} known_facet;

static int compare_facets(const void *left, const void *right) {
    const known_facet *x = left, *y = right;
    for (int k = 0; k < 3; k++)
        if (x->corners[k] != y->corners[k])
            return x->corners[k] < y->corners[k] ? -1 : 1;
    return 0;
}

starg_status fan_plan_mark(const partition *p, fan_plan *plan) {
    plan->corners.count = 0;
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        for (int k = 0; k < 3; k++)
            PUSH(p->context, PARTITION_STAGE, &plan->corners, c[k]);
    }
    return STARG_OK;
}

starg_status fan_plan_find(const partition *p, fan_plan *plan, bool *found) {
    SCOPED STARG_ARRAY(known_facet) facets = {0};
    *found = false;
    for (size_t i = 0; i < plan->piece_count; i++)
        for (uint32_t k = p->start.data[plan->pieces[i]]; k < p->start.data[plan->pieces[i] + 1];
             k++) {
            known_facet fresh = {.entry = p->index.data[k]};
            facet_outward(&p->facets.data[fresh.entry / 2], (int)(fresh.entry % 2), fresh.corners);
            PUSH(p->context, PARTITION_STAGE, &facets, fresh);
        }
    if (facets.count == 0)
        return STARG_OK;
    qsort(facets.data, facets.count, sizeof *facets.data, compare_facets);
    *found = true;
    for (size_t i = 0; i < plan->entries.count && *found; i++) {
        known_facet wanted;
        memcpy(wanted.corners, plan->corners.data + 3 * i, sizeof wanted.corners);
        const known_facet *at =
            bsearch(&wanted, facets.data, facets.count, sizeof wanted, compare_facets);
        *found = at != NULL;
        if (*found)
            plan->entries.data[i] = at->entry;
    }
    return STARG_OK;
}

/* ---- fans: made ---- */

/* Facets between two of the pieces get the same number on both sides. */
static void hand_over(partition *p, const fan_plan *plan) {
    for (size_t i = 0; i < p->facets.count; i++) {
        facet *f = &p->facets.data[i];
        if (partition_lists(plan->pieces, plan->piece_count, f->side[0]) &&
            partition_lists(plan->pieces, plan->piece_count, f->side[1]))
            f->side[1] = f->side[0];
    }
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i];
        p->facets.data[entry / 2].side[entry % 2] = plan->takers[plan->takes.data[i]];
    }
}

static void drop_inner(partition *p) {
    size_t kept = 0;
    for (size_t i = 0; i < p->facets.count; i++)
        if (p->facets.data[i].side[0] != p->facets.data[i].side[1])
            p->facets.data[kept++] = p->facets.data[i];
    p->facets.count = kept;
}

/* Between the facets of the plan's entries at an edge, if they go to different takers. */
static starg_status add_triangle(partition *p, const fan_plan *plan, const partition_edge *edge,
                                 uint32_t apex) {
    const partition_edge *one = edge->a < edge->b ? edge : edge + 1;
    const partition_edge *two = one == edge ? edge + 1 : edge;
    const uint8_t *takes = plan->takes.data;
    if (takes[one->facet] == takes[two->facet])
        return STARG_OK;
    const uint32_t corners[3] = {one->b, one->a, apex};
    return partition_add_facet(p, corners, plan->takers[takes[one->facet]],
                               plan->takers[takes[two->facet]]);
}

starg_status partition_fan(partition *p, const fan_plan *plan) {
    SCOPED partition_edge *edges = NULL;
    const size_t count = 3 * plan->entries.count;
    double at[3];
    uint32_t apex;
    partition_from_unit(p, plan->apex, at);
    TRY(partition_add_point(p, at, &apex));
    NEW(p->context, PARTITION_STAGE, edges, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t entry = plan->entries.data[i / 3], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        edges[i] = (partition_edge){c[i % 3], c[(i + 1) % 3], i / 3};
    }
    TRY(partition_sort_edges(p->context, edges, count, p->points.count / 3));
    hand_over(p, plan);
    drop_inner(p);
    for (size_t i = 0; i + 1 < count; i += 2)
        TRY(add_triangle(p, plan, &edges[i], apex));
    return STARG_OK;
}

/* ---- fans: carried out ---- */

static uint32_t place_of(const uint32_t *numbers, size_t count, uint32_t number) {
    uint32_t place = 0;
    while (place < count && numbers[place] != number)
        place++;
    return place;
}

/* The plan in the numbers of the extract. */
static starg_status translate(const change *c, const fan_plan *plan, fan_plan *out) {
    const partition_extract *e = &c->extract;
    *out = *plan;
    out->entries.data = NULL;
    out->entries.count = out->entries.capacity = 0;
    for (size_t i = 0; i < plan->piece_count; i++)
        out->pieces[i] = place_of(e->pieces.data, e->pieces.count, plan->pieces[i]);
    for (size_t i = 0; i < plan->taker_count; i++)
        out->takers[i] = place_of(e->pieces.data, e->pieces.count, plan->takers[i]);
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], number = entry / 2;
        const uint32_t *found =
            bsearch(&number, e->facets.data, e->facets.count, sizeof number, partition_ascending);
        PUSH(e->part.context, PARTITION_STAGE, &out->entries,
             2 * (uint32_t)(found - e->facets.data) + entry % 2);
    }
    return STARG_OK;
}

/* The pieces of a plan, and the takers. */
static size_t list_concerned(const fan_plan *plan, uint32_t *out) {
    size_t count = 0;
    for (size_t i = 0; i < plan->piece_count; i++)
        out[count++] = plan->pieces[i];
    for (size_t i = 0; i < plan->taker_count; i++)
        if (!partition_lists(out, count, plan->takers[i]))
            out[count++] = plan->takers[i];
    return count;
}

starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect) {
    starg_status status = STARG_OK;
    change c = {.margin = margin, .scratch = scratch};
    fan_plan own = {.piece_count = 0};
    uint32_t concerned[FAN_PIECES_MOST + FAN_TAKERS_MOST];
    *effect = (apply_effect){.done = false};
    STARG_TRY(extract_make(p, concerned, list_concerned(plan, concerned), scratch, &c.extract));
    STARG_TRY(translate(&c, plan, &own));
    STARG_TRY(partition_fan(&c.extract.part, &own));
    for (size_t i = 0; i < own.taker_count; i++)
        c.parts[c.part_count++] = own.takers[i];
    STARG_TRY(settle_parts(&c, &effect->done));
    if (!effect->done)
        goto done;
    STARG_TRY(extract_return(&c.extract, p));
    STARG_TRY(drop_pieces(p, plan->pieces + plan->kept, plan->piece_count - plan->kept, effect));
done:
    STARG_ARRAY_FREE(p->context, &own.entries);
    extract_free(&c.extract);
    return status;
}

/* ---- joining ---- */

/* The facets of two pieces except those between them. */
static starg_status gather_union(const partition *p, uint32_t a, uint32_t b,
                                 partition_triangles *out) {
    const uint32_t pair[2] = {a, b};
    for (int i = 0; i < 2; i++)
        for (uint32_t k = p->start.data[pair[i]]; k < p->start.data[pair[i] + 1]; k++) {
            uint32_t entry = p->index.data[k], corners[3];
            const facet *f = &p->facets.data[entry / 2];
            if (f->side[1 - entry % 2] == pair[1 - i])
                continue;
            facet_outward(f, (int)(entry % 2), corners);
            for (int c = 0; c < 3; c++)
                PUSH(p->context, PARTITION_STAGE, out, corners[c]);
        }
    return STARG_OK;
}

/* The largest ball in the common kernel of two pieces. Most pairs have none, and usually a sample
 * of their facets already shows this. */
static starg_status find_common_ball(const partition *p, const uint32_t pair[2], double margin,
                                     region_scratch *scratch, double center[3], double *radius) {
    static const uint32_t most[] = {256, 8192, UINT32_MAX};
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    *radius = INFINITY;
    for (size_t i = 0; i < sizeof most / sizeof *most && *radius >= margin; i++) {
        TRY(region_gather_some(p, pair, 2, most[i], scratch, &r));
        TRY(region_find_center(&r, NULL, 0, scratch, center, radius));
    }
    return STARG_OK;
}

starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done) {
    const uint32_t pair[2] = {a, b};
    SCOPED partition_triangles triangles = {0};
    piece fresh = {.stamp = p->stamps + 1};
    double center[3];
    *done = false;
    TRY(find_common_ball(p, pair, margin, scratch, center, &fresh.radius));
    if (fresh.radius < margin)
        return STARG_OK;
    partition_from_unit(p, center, fresh.guard);
    TRY(gather_union(p, a, b, &triangles));
    *done = partition_certify(p, triangles.data, triangles.count / 3, fresh.guard);
    if (!*done)
        return STARG_OK;
    fresh.volume = p->pieces.data[a].volume + p->pieces.data[b].volume;
    p->stamps++;
    partition_join(p, pair, 2);
    p->pieces.data[a] = fresh;
    partition_renumber(p, (uint32_t)p->pieces.count - 1, b);
    return partition_build_index(p);
}

/* ---- guards ---- */

static starg_status center_guard(partition *p, uint32_t number, region *r,
                                 partition_triangles *triangles, region_scratch *scratch) {
    piece *it = &p->pieces.data[number];
    double center[3], guard[3], radius;
    triangles->count = 0;
    TRY(region_gather(p, &number, 1, scratch, r));
    TRY(region_find_center(r, NULL, 0, scratch, center, &radius));
    partition_from_unit(p, center, guard);
    if (radius <= it->radius)
        return STARG_OK;
    TRY(partition_gather(p, number, triangles));
    if (!partition_certify(p, triangles->data, triangles->count / 3, guard))
        return STARG_OK;
    vec3_copy(guard, it->guard);
    it->radius = radius;
    return STARG_OK;
}

starg_status apply_centers(partition *p, region_scratch *scratch) {
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    SCOPED partition_triangles triangles = {0};
    for (uint32_t i = 0; i < p->pieces.count; i++)
        TRY(center_guard(p, i, &r, &triangles, scratch));
    return STARG_OK;
}
