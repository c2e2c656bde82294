/* Carrying out a plan of cuts, with proof.
 *
 * Stages: a copy of the partition; the pieces joined, the union sliced; numbers without facets
 * closed up; a guard for each new piece and the exact certificate for it; facets of other pieces
 * that were split on the way must still have the guard of their piece strictly inside; then the
 * copy takes the partition's place.
 *
 * Invariants: the partition is either untouched or again as its invariants say. Cost: linear in the
 * facets of the partition. */
#include "star/strict/apply.h"

#include <math.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/strict/slice.h"

typedef struct change {
    partition *p; /* the copy */
    uint32_t parts[RECUT_PARTS_MOST];
    size_t part_count;
    size_t old_points;
    double margin;
    region_scratch *scratch;
} change;

/* ---- numbers ---- */

static void move_piece(partition *p, uint32_t from, uint32_t to) {
    for (size_t i = 0; i < p->facets.count; i++)
        for (int side = 0; side < 2; side++)
            if (p->facets.data[i].side[side] == from)
                p->facets.data[i].side[side] = to;
    p->pieces.data[to] = p->pieces.data[from];
}

/* The joined pieces but the first have no facets: the last numbers take the place of theirs. */
static void drop_pieces(change *c, const uint32_t *unused, size_t count) {
    bool gone[RECUT_PARTS_MOST] = {false};
    partition *p = c->p;
    for (size_t left = count; left > 0; left--) {
        uint32_t last = (uint32_t)p->pieces.count - 1;
        size_t hole = count;
        for (size_t i = 0; i < count; i++)
            if (!gone[i] && (hole == count || unused[i] > unused[hole]))
                hole = i;
        gone[hole] = true;
        if (unused[hole] != last) {
            move_piece(p, last, unused[hole]);
            for (size_t i = 0; i < c->part_count; i++)
                if (c->parts[i] == last)
                    c->parts[i] = unused[hole];
        }
        p->pieces.count--;
    }
}

/* ---- cuts ---- */

static starg_status cut(change *c, const uint32_t *pieces, size_t count, const recut_plan *plan,
                        bool *done) {
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

static double volume_of(const partition *p, const uint32_t *triangles, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += vec3_triple(partition_unit(p, triangles[3 * i]),
                           partition_unit(p, triangles[3 * i + 1]),
                           partition_unit(p, triangles[3 * i + 2]));
    return sum / 6;
}

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
    STARG_ARRAY(uint32_t) triangles = {0};
    piece fresh = {.stamp = ++p->stamps};
    double center[3];
    *done = false;
    STARG_TRY(region_gather(p, &number, 1, c->scratch, &r));
    STARG_TRY(region_find_center(&r, NULL, 0, c->scratch, center, &fresh.radius));
    if (fresh.radius < c->margin)
        goto done;
    partition_from_unit(p, center, fresh.guard);
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t corners[3];
        facet_outward(&p->facets.data[p->index.data[k] / 2], (int)(p->index.data[k] % 2), corners);
        for (int i = 0; i < 3; i++)
            STARG_PUSH(p->context, PARTITION_STAGE, &triangles, corners[i]);
    }
    *done = partition_certify(p, triangles.data, triangles.count / 3, fresh.guard);
    fresh.volume = volume_of(p, triangles.data, triangles.count / 3);
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

starg_status apply_plan(partition *p, const uint32_t *pieces, size_t count, const recut_plan *plan,
                        double margin, double least, region_scratch *scratch, bool *done) {
    starg_status status = STARG_OK;
    partition copy = {.context = p->context};
    change c = {
        .p = &copy, .old_points = p->points.count / 3, .margin = margin, .scratch = scratch};
    STARG_TRY(partition_copy(p, &copy));
    STARG_TRY(cut(&c, pieces, count, plan, done));
    if (!*done)
        goto done;
    STARG_TRY(partition_build_index(&copy));
    for (size_t i = 0; i < c.part_count && *done; i++)
        STARG_TRY(settle_piece(&c, c.parts[i], done));
    *done = *done && sum_of_squares(&copy, c.parts, c.part_count) > least && check_others(&c);
    if (!*done)
        goto done;
    partition before = *p;
    *p = copy;
    copy = before;
done:
    partition_free(&copy);
    return status;
}
