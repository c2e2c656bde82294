/* SPDX-License-Identifier: Apache-2.0 */
/* Carrying out a plan of cuts, with proof.
 *
 * Stages: a copy of the partition; the pieces joined, the union sliced; numbers without facets
 * closed up; a guard for each new piece and the exact certificate for it; facets of other pieces
 * that were split on the way must still have the guard of their piece strictly inside; then the
 * copy takes the partition's place.
 *
 * Invariants: the partition is either untouched or again as its invariants say. Cost: linear in the
 * facets of the partition. */
#include "star/strict/partition/apply.h"

#include <math.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/strict/partition/slice.h"

enum { PARTS_MOST = FAN_TAKERS_MOST }; /* more than a cut makes */

typedef struct change {
    partition *p; /* the copy */
    uint32_t parts[PARTS_MOST];
    size_t part_count;
    size_t old_points;
    double margin;
    region_scratch *scratch;
    apply_effect *effect;
} change;

/* ---- numbers ---- */

/* The joined pieces but the parts have no facets: the last numbers take the place of theirs, the
 * highest first, so that what moves is never one of them. */
static void drop_pieces(change *c, const uint32_t *unused, size_t count) {
    bool gone[APPLY_MOST] = {false};
    for (size_t left = count; left > 0; left--) {
        uint32_t last = (uint32_t)c->p->pieces.count - 1;
        size_t hole = count;
        for (size_t i = 0; i < count; i++)
            if (!gone[i] && (hole == count || unused[i] > unused[hole]))
                hole = i;
        gone[hole] = true;
        partition_renumber(c->p, last, unused[hole]);
        for (size_t i = 0; i < c->part_count; i++)
            if (c->parts[i] == last)
                c->parts[i] = unused[hole];
        c->effect->moves[c->effect->move_count++] = (apply_move){last, unused[hole]};
    }
}

/* ---- cuts ---- */

static starg_status cut(change *c, const uint32_t *pieces, size_t count,
                        const repartition_plan *plan, bool *done) {
    starg_status status = STARG_OK;
    *done = true;
    partition_join(c->p, pieces, count);
    c->parts[0] = pieces[0];
    c->part_count = 1;
    for (int i = 0; i < plan->cuts && *done; i++) {
        uint32_t fresh = pieces[c->part_count];
        STARG_TRY(
            partition_slice(c->p, c->parts[c->part_count - 1], fresh, &plan->planes[i], done));
        c->parts[c->part_count++] = fresh;
    }
    if (*done)
        drop_pieces(c, pieces + c->part_count, count - c->part_count);
done:
    return status;
}

/* ---- proofs ---- */

double sum_of_squares(const partition *p, const uint32_t *pieces, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += p->pieces.data[pieces[i]].volume * p->pieces.data[pieces[i]].volume;
    return sum;
}

static starg_status settle_piece(change *c, uint32_t number, bool *done) {
    starg_status status = STARG_OK;
    partition *p = c->p;
    region r = {.vertices = {0}};
    partition_triangles triangles = {0};
    piece fresh = {.stamp = ++p->stamps};
    double center[3];
    *done = false;
    STARG_TRY(region_gather(p, &number, 1, c->scratch, &r));
    STARG_TRY(region_find_center(&r, NULL, 0, c->scratch, center, &fresh.radius));
    if (fresh.radius < c->margin)
        goto done;
    partition_from_unit(p, center, fresh.guard);
    STARG_TRY(partition_gather(p, number, &triangles));
    *done = partition_certify(p, triangles.data, triangles.count / 3, fresh.guard);
    fresh.volume = partition_volume(p, triangles.data, triangles.count / 3);
    p->pieces.data[number] = fresh;
done:
    region_free(p->context, &r);
    STARG_ARRAY_FREE(p->context, &triangles);
    return status;
}

static bool is_new(const change *c, uint32_t number) {
    for (size_t i = 0; i < c->part_count; i++)
        if (c->parts[i] == number)
            return true;
    return false;
}

/* Split facets of pieces that the plan does not name: do their guards still see them? */
static bool check_others(const change *c) {
    const partition *p = c->p;
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        if (f->corners[0] < c->old_points && f->corners[1] < c->old_points &&
            f->corners[2] < c->old_points)
            continue;
        for (int side = 0; side < 2; side++) {
            uint32_t k[3];
            if (f->side[side] == PARTITION_OUTSIDE || is_new(c, f->side[side]))
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
    starg_status status = STARG_OK;
    STARG_TRY(partition_build_index(c->p));
    *done = true;
    for (size_t i = 0; i < c->part_count && *done; i++)
        STARG_TRY(settle_piece(c, c->parts[i], done));
done:
    return status;
}

static void swap(partition *p, partition *other) {
    partition before = *p;
    *p = *other;
    *other = before;
}

starg_status apply_plan(partition *p, const uint32_t *pieces, size_t count,
                        const repartition_plan *plan, double margin, double least,
                        region_scratch *scratch, apply_effect *effect) {
    starg_status status = STARG_OK;
    partition copy = {.context = p->context};
    change c = {.p = &copy,
                .old_points = p->points.count / 3,
                .margin = margin,
                .scratch = scratch,
                .effect = effect};
    bool done = false;
    *effect = (apply_effect){.done = false};
    STARG_TRY(partition_copy(p, &copy));
    STARG_TRY(cut(&c, pieces, count, plan, &done));
    if (!done)
        goto done;
    STARG_TRY(settle_parts(&c, &done));
    effect->done = done && sum_of_squares(&copy, c.parts, c.part_count) > least && check_others(&c);
    if (effect->done)
        swap(p, &copy);
done:
    partition_free(&copy);
    return status;
}

/* ---- sharing out ---- */

starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect) {
    starg_status status = STARG_OK;
    partition copy = {.context = p->context};
    change c = {.p = &copy, .margin = margin, .scratch = scratch, .effect = effect};
    *effect = (apply_effect){.done = false};
    STARG_TRY(partition_copy(p, &copy));
    STARG_TRY(partition_fan(&copy, plan));
    for (size_t i = 0; i < plan->taker_count; i++)
        c.parts[c.part_count++] = plan->takers[i];
    drop_pieces(&c, plan->pieces + plan->kept, plan->piece_count - plan->kept);
    STARG_TRY(settle_parts(&c, &effect->done));
    if (effect->done)
        swap(p, &copy);
done:
    partition_free(&copy);
    return status;
}

/* ---- joining ---- */

/* The facets of two pieces without those between them. */
static starg_status gather_union(const partition *p, uint32_t a, uint32_t b,
                                 partition_triangles *out) {
    starg_status status = STARG_OK;
    const uint32_t pair[2] = {a, b};
    for (int i = 0; i < 2; i++)
        for (uint32_t k = p->start.data[pair[i]]; k < p->start.data[pair[i] + 1]; k++) {
            uint32_t entry = p->index.data[k], corners[3];
            const facet *f = &p->facets.data[entry / 2];
            if (f->side[1 - entry % 2] == pair[1 - i])
                continue;
            facet_outward(f, (int)(entry % 2), corners);
            for (int c = 0; c < 3; c++)
                STARG_PUSH(p->context, PARTITION_STAGE, out, corners[c]);
        }
done:
    return status;
}

/* The largest ball from which all of two pieces is seen. Most pairs have none, and mostly some of
 * their facets tell. */
static starg_status find_common_ball(const partition *p, const uint32_t pair[2], double margin,
                                     region_scratch *scratch, double center[3], double *radius) {
    static const uint32_t most[] = {256, 8192, UINT32_MAX};
    starg_status status = STARG_OK;
    region r = {.vertices = {0}};
    *radius = INFINITY;
    for (size_t i = 0; i < sizeof most / sizeof *most && *radius >= margin; i++) {
        STARG_TRY(region_gather_some(p, pair, 2, most[i], scratch, &r));
        STARG_TRY(region_find_center(&r, NULL, 0, scratch, center, radius));
    }
done:
    region_free(p->context, &r);
    return status;
}

starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done) {
    starg_status status = STARG_OK;
    const uint32_t pair[2] = {a, b};
    partition_triangles triangles = {0};
    piece fresh = {.stamp = p->stamps + 1};
    double center[3];
    *done = false;
    STARG_TRY(find_common_ball(p, pair, margin, scratch, center, &fresh.radius));
    if (fresh.radius < margin)
        goto done;
    partition_from_unit(p, center, fresh.guard);
    STARG_TRY(gather_union(p, a, b, &triangles));
    *done = partition_certify(p, triangles.data, triangles.count / 3, fresh.guard);
    if (!*done)
        goto done;
    fresh.volume = p->pieces.data[a].volume + p->pieces.data[b].volume;
    p->stamps++;
    partition_join(p, pair, 2);
    p->pieces.data[a] = fresh;
    partition_renumber(p, (uint32_t)p->pieces.count - 1, b);
    STARG_TRY(partition_build_index(p));
done:
    STARG_ARRAY_FREE(p->context, &triangles);
    return status;
}

/* ---- guards ---- */

static starg_status center_guard(partition *p, uint32_t number, region *r,
                                 partition_triangles *triangles, region_scratch *scratch) {
    starg_status status = STARG_OK;
    piece *it = &p->pieces.data[number];
    double center[3], guard[3], radius;
    triangles->count = 0;
    STARG_TRY(region_gather(p, &number, 1, scratch, r));
    STARG_TRY(region_find_center(r, NULL, 0, scratch, center, &radius));
    partition_from_unit(p, center, guard);
    if (radius <= it->radius)
        goto done;
    STARG_TRY(partition_gather(p, number, triangles));
    if (!partition_certify(p, triangles->data, triangles->count / 3, guard))
        goto done;
    vec3_copy(guard, it->guard);
    it->radius = radius;
done:
    return status;
}

starg_status apply_centers(partition *p, region_scratch *scratch) {
    starg_status status = STARG_OK;
    region r = {.vertices = {0}};
    partition_triangles triangles = {0};
    for (uint32_t i = 0; i < p->pieces.count; i++)
        STARG_TRY(center_guard(p, i, &r, &triangles, scratch));
done:
    region_free(p->context, &r);
    STARG_ARRAY_FREE(p->context, &triangles);
    return status;
}
