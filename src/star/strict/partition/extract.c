/* SPDX-License-Identifier: Apache-2.0 */
/* Extracts some pieces as a partition of their own, on which a change can be tried.
 *
 * Problem: most changes of a few pieces fail, in the cut or in the proof; trying one should neither
 * copy nor visit the rest of the partition.
 *
 * Stages: collect the facets of the pieces; the facets of other pieces at two of their vertices,
 * because a cut that splits an edge splits these too; then renumber points, planes and pieces. On
 * return, facets replace those that were extracted.
 *
 * Invariants: facets, and what they refer to, keep their order. Cost: the extract is linear in its
 * facets and those at its vertices, except for sorting; the return is a pass over the facets of the
 * partition. */
#include "star/strict/partition/partition.h"

#include <stdlib.h>

#include "geometry/vec3.h"

void extract_free(partition_extract *e) {
    RELEASE(e->facets.data, e->points.data, e->planes.data, e->pieces.data);
    partition_free(&e->part);
}

typedef struct extractor {
    const partition *p;
    region_scratch *scratch; /* its tables: 1 + number in the part, 0: absent */
    partition_extract *e;
} extractor;

/* ---- facets ---- */

static bool is_named(const extractor *x, uint32_t owner) {
    return owner != PARTITION_OUTSIDE && x->scratch->piece_of.data[owner] != 0;
}

static starg_status name_pieces(const extractor *x, const uint32_t *pieces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        PUSH(x->p->context, PARTITION_STAGE, &x->e->pieces, pieces[i]);
        x->scratch->piece_of.data[pieces[i]] = (uint32_t)x->e->pieces.count;
    }
    return STARG_OK;
}

/* A facet between two of the pieces is listed for its inner side. */
static starg_status list_own_facets(const extractor *x) {
    const partition *p = x->p;
    for (size_t i = 0; i < x->e->pieces.count; i++) {
        uint32_t number = x->e->pieces.data[i];
        for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
            uint32_t entry = p->index.data[k];
            const facet *f = &p->facets.data[entry / 2];
            if (entry % 2 == FACET_OUTER && is_named(x, f->side[FACET_INNER]))
                continue;
            PUSH(p->context, PARTITION_STAGE, &x->e->facets, entry / 2);
        }
    }
    return STARG_OK;
}

static starg_status number_point(const extractor *x, uint32_t point) {
    if (x->scratch->vertex_of.data[point] != 0)
        return STARG_OK;
    PUSH(x->p->context, PARTITION_STAGE, &x->e->points, point);
    x->scratch->vertex_of.data[point] = (uint32_t)x->e->points.count;
    return STARG_OK;
}

static starg_status number_points(const extractor *x) {
    for (size_t i = 0; i < 3 * x->e->facets.count; i++)
        TRY(number_point(x, x->p->facets.data[x->e->facets.data[i / 3]].corners[i % 3]));
    return STARG_OK;
}

/* Does a facet belong to none of the pieces but have two of their vertices, `corner` being the
 * first? */
static bool is_beside(const extractor *x, const facet *f, uint32_t corner) {
    int shared = 0;
    if (is_named(x, f->side[0]) || is_named(x, f->side[1]))
        return false;
    for (uint32_t k = 0; k < 3; k++) {
        bool known = x->scratch->vertex_of.data[f->corners[k]] != 0;
        if (known && shared == 0 && k != corner)
            return false;
        shared += known;
    }
    return shared > 1;
}

/* `points` are those of the pieces themselves. */
static starg_status list_facets_beside(const extractor *x) {
    const partition *p = x->p;
    for (size_t i = 0; i < x->e->points.count; i++)
        for (uint32_t c = p->first_at.data[x->e->points.data[i]]; c != PARTITION_NO_CORNER;
             c = p->next_at.data[c])
            if (is_beside(x, &p->facets.data[c / 3], c % 3))
                PUSH(p->context, PARTITION_STAGE, &x->e->facets, c / 3);
    return STARG_OK;
}

static int ascending(const void *x, const void *y) {
    uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
    return (a > b) - (a < b);
}

/* ---- the part ---- */

static starg_status number_piece(const extractor *x, uint32_t *side) {
    if (*side == PARTITION_OUTSIDE)
        return STARG_OK;
    if (!is_named(x, *side))
        TRY(name_pieces(x, side, 1));
    *side = x->scratch->piece_of.data[*side] - 1;
    return STARG_OK;
}

static starg_status number_plane(const extractor *x, uint32_t *plane) {
    uint32_t *slot = &x->scratch->row_of.data[2 * (size_t)*plane];
    if (*slot == 0) {
        PUSH(x->p->context, PARTITION_STAGE, &x->e->planes, *plane);
        *slot = (uint32_t)x->e->planes.count;
    }
    *plane = *slot - 1;
    return STARG_OK;
}

static starg_status add_facets(const extractor *x) {
    for (size_t i = 0; i < x->e->facets.count; i++) {
        facet f = x->p->facets.data[x->e->facets.data[i]];
        for (int k = 0; k < 3; k++) {
            TRY(number_point(x, f.corners[k]));
            f.corners[k] = x->scratch->vertex_of.data[f.corners[k]] - 1;
        }
        for (int side = 0; side < 2; side++)
            TRY(number_piece(x, &f.side[side]));
        TRY(number_plane(x, &f.plane));
        PUSH(x->p->context, PARTITION_STAGE, &x->e->part.facets, f);
    }
    return STARG_OK;
}

static starg_status add_what_is_listed(const extractor *x) {
    const partition *p = x->p;
    partition *part = &x->e->part;
    for (size_t i = 0; i < 3 * x->e->points.count; i++) {
        size_t from = 3 * (size_t)x->e->points.data[i / 3] + i % 3;
        PUSH(p->context, PARTITION_STAGE, &part->points, p->points.data[from]);
        PUSH(p->context, PARTITION_STAGE, &part->unit, p->unit.data[from]);
    }
    for (size_t i = 0; i < x->e->planes.count; i++)
        PUSH(p->context, PARTITION_STAGE, &part->planes, p->planes.data[x->e->planes.data[i]]);
    for (size_t i = 0; i < x->e->pieces.count; i++)
        PUSH(p->context, PARTITION_STAGE, &part->pieces, p->pieces.data[x->e->pieces.data[i]]);
    return STARG_OK;
}

/* The tables are all zero between calls. */
static void forget(const extractor *x) {
    for (size_t i = 0; i < x->e->points.count; i++)
        x->scratch->vertex_of.data[x->e->points.data[i]] = 0;
    for (size_t i = 0; i < x->e->planes.count; i++)
        x->scratch->row_of.data[2 * (size_t)x->e->planes.data[i]] = 0;
    for (size_t i = 0; i < x->e->pieces.count; i++)
        x->scratch->piece_of.data[x->e->pieces.data[i]] = 0;
}

starg_status extract_make(const partition *p, const uint32_t *pieces, size_t count,
                          region_scratch *scratch, partition_extract *out) {
    const extractor x = {p, scratch, out};
    *out = (partition_extract){.part = {.context = p->context, .stamps = p->stamps}};
    vec3_copy(p->origin, out->part.origin);
    memcpy(out->part.exponents, p->exponents, sizeof p->exponents);
    TRY(region_scratch_fit(scratch, p));
    TRY(name_pieces(&x, pieces, count));
    TRY(list_own_facets(&x));
    TRY(number_points(&x));
    TRY(list_facets_beside(&x));
    if (out->facets.count > 1)
        qsort(out->facets.data, out->facets.count, sizeof *out->facets.data, ascending);
    TRY(add_facets(&x));
    TRY(add_what_is_listed(&x));
    forget(&x);
    return STARG_OK;
}

/* ---- return ---- */

static starg_status number_new(partition_extract *e, partition *p) {
    const partition *part = &e->part;
    for (uint32_t i = (uint32_t)e->points.count; i < part->points.count / 3; i++) {
        uint32_t number;
        TRY(partition_add_point(p, partition_point(part, i), &number));
        PUSH(p->context, PARTITION_STAGE, &e->points, number);
    }
    for (size_t i = e->planes.count; i < part->planes.count; i++) {
        PUSH(p->context, PARTITION_STAGE, &e->planes, (uint32_t)p->planes.count);
        PUSH(p->context, PARTITION_STAGE, &p->planes, part->planes.data[i]);
    }
    for (size_t i = 0; i < e->pieces.count; i++)
        p->pieces.data[e->pieces.data[i]] = part->pieces.data[i];
    for (size_t i = e->pieces.count; i < part->pieces.count; i++) {
        PUSH(p->context, PARTITION_STAGE, &e->pieces, (uint32_t)p->pieces.count);
        PUSH(p->context, PARTITION_STAGE, &p->pieces, part->pieces.data[i]);
    }
    p->stamps = part->stamps;
    return STARG_OK;
}

static facet in_the_whole(const partition_extract *e, size_t number) {
    facet f = e->part.facets.data[number];
    for (int k = 0; k < 3; k++)
        f.corners[k] = e->points.data[f.corners[k]];
    for (int side = 0; side < 2; side++)
        if (f.side[side] != PARTITION_OUTSIDE)
            f.side[side] = e->pieces.data[f.side[side]];
    f.plane = e->planes.data[f.plane];
    return f;
}

/* Removes the facets whose numbers are listed from `first` on, and compacts the rest. */
static void drop_facets(const partition_extract *e, size_t first, partition *p) {
    size_t kept = first < e->facets.count ? e->facets.data[first] : p->facets.count;
    for (size_t i = kept; i < p->facets.count; i++)
        if (first < e->facets.count && e->facets.data[first] == i)
            first++;
        else
            p->facets.data[kept++] = p->facets.data[i];
    p->facets.count = kept;
}

starg_status extract_return(partition_extract *e, partition *p) {
    size_t count = e->part.facets.count, places = e->facets.count;
    TRY(number_new(e, p));
    for (size_t i = 0; i < count; i++)
        if (i < places)
            p->facets.data[e->facets.data[i]] = in_the_whole(e, i);
        else
            PUSH(p->context, PARTITION_STAGE, &p->facets, in_the_whole(e, i));
    if (count < places)
        drop_facets(e, count, p);
    return STARG_OK;
}
