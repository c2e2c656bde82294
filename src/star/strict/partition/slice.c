/* SPDX-License-Identifier: Apache-2.0 */
/* Cutting a piece of a partition by a plane.
 *
 * Stages: on which side of the plane each vertex of the piece lies, or whether it is on it, as
 * those of an edge that the plane was laid through; a new vertex on every edge of the piece that
 * the plane crosses; all facets at those edges are split, so that the partition stays conforming;
 * facets of the piece above the plane change hands; the segments in which the plane meets the
 * piece's facets, and edges on the plane between a facet below and one above, are joined to loops,
 * and the loops filled (star/strict/partition/cap.c).
 *
 * Invariants: a split edge is split in all its facets; every new vertex is where the two ends of
 * its edge say, whichever facet asks; every surface stays closed.
 *
 * Cost: linear in the facets of the partition, and that of the cap. */
#include "star/strict/partition/slice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/vec3.h"
#include "star/strict/partition/cap.h"

void partition_join(partition *p, const uint32_t *pieces, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < p->facets.count; i++) {
        facet f = p->facets.data[i];
        for (size_t k = 1; k < count; k++)
            for (int side = 0; side < 2; side++)
                if (f.side[side] == pieces[k])
                    f.side[side] = pieces[0];
        if (f.side[0] != f.side[1])
            p->facets.data[kept++] = f;
    }
    p->facets.count = kept;
}

/* An edge that the plane crosses, or a vertex that lies on it. */
typedef struct crossing {
    uint32_t ends[2]; /* ascending; of a vertex twice the same */
    uint32_t vertex;  /* on the plane */
    uint32_t facets;  /* of the piece that have the edge; of a vertex: segments that end there */
    uint32_t next;    /* the loop goes on at this crossing */
} crossing;

typedef struct slicer {
    partition *p;
    uint32_t low, high;
    partition_plane plane;
    double *height; /* per vertex: above the plane; 0: on it, or not a vertex of the piece */
    size_t old_vertices;
    STARG_ARRAY(crossing) crossings;
    STARG_ARRAY(uint64_t) on_plane_edges; /* edges on the plane of facets above it, ascending */
    bool broken;                          /* a loop goes on in two ways */
    uint32_t *table;                      /* 1 + crossing by edge; open addressing */
    size_t table_size;
    cap_indices corners, starts, triangles;
} slicer;

/* ---- heights ---- */

static int side_of_piece(const slicer *s, const facet *f) {
    for (int side = 0; side < 2; side++)
        if (f->side[side] == s->low)
            return side;
    return -1;
}

static double height_of(const slicer *s, uint32_t vertex) {
    return vec3_dot(s->plane.normal, partition_unit(s->p, vertex)) - s->plane.offset;
}

/* Returns false when it is neither on the plane nor well away from it. */
static bool find_height(slicer *s, uint32_t vertex) {
    double height = height_of(s, vertex);
    s->height[vertex] = fabs(height) < SLICE_ON ? 0 : height;
    return s->height[vertex] == 0 || fabs(height) >= SLICE_CLEARANCE;
}

static int corners_above(const slicer *s, const facet *f) {
    int above = 0;
    for (int k = 0; k < 3; k++)
        above += s->height[f->corners[k]] > 0;
    return above;
}

static int corners_below(const slicer *s, const facet *f) {
    int below = 0;
    for (int k = 0; k < 3; k++)
        below += s->height[f->corners[k]] < 0;
    return below;
}

/* False when a vertex is too near to the plane, a facet lies in it, or all are on one side. `nodes`
 * is at least as many as crossings will be. */
static bool find_heights(slicer *s, size_t *nodes) {
    bool above = false, below = false;
    *nodes = 0;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet *f = &s->p->facets.data[i];
        if (side_of_piece(s, f) < 0)
            continue;
        for (int k = 0; k < 3; k++)
            if (s->height[f->corners[k]] == 0 && !find_height(s, f->corners[k]))
                return false;
        int high = corners_above(s, f), low = corners_below(s, f);
        if (high + low == 0)
            return false;
        above = above || high > 0;
        below = below || low > 0;
        *nodes += (high > 0 && low > 0) || high + low < 3 ? 2 : 0;
    }
    return above && below;
}

/* ---- crossings ---- */

static size_t slot_of(const slicer *s, uint32_t a, uint32_t b) {
    uint64_t key = (uint64_t)a << 32 | b;
    size_t slot = starg_hash64(key) & (s->table_size - 1);
    while (s->table[slot] != 0) {
        const crossing *c = &s->crossings.data[s->table[slot] - 1];
        if (c->ends[0] == a && c->ends[1] == b)
            break;
        slot = (slot + 1) & (s->table_size - 1);
    }
    return slot;
}

static crossing *find_crossing(const slicer *s, uint32_t a, uint32_t b) {
    uint32_t found = s->table[a < b ? slot_of(s, a, b) : slot_of(s, b, a)];
    return found == 0 ? NULL : &s->crossings.data[found - 1];
}

static bool is_crossed(const slicer *s, uint32_t a, uint32_t b) {
    return a < s->old_vertices && b < s->old_vertices && s->height[a] * s->height[b] < 0;
}

static starg_status add_crossing(slicer *s, uint32_t a, uint32_t b, size_t slot) {
    starg_status status = STARG_OK;
    crossing fresh = {.ends = {a, b}, .next = UINT32_MAX};
    double t = s->height[a] / (s->height[a] - s->height[b]), point[3];
    const double *from = partition_point(s->p, a), *to = partition_point(s->p, b);
    for (int k = 0; k < 3; k++)
        point[k] = from[k] + t * (to[k] - from[k]);
    STARG_TRY(partition_add_point(s->p, point, &fresh.vertex));
    STARG_PUSH(s->p->context, PARTITION_STAGE, &s->crossings, fresh);
    s->table[slot] = (uint32_t)s->crossings.count;
done:
    return status;
}

/* A vertex on the plane. */
static starg_status add_touch(slicer *s, uint32_t vertex) {
    starg_status status = STARG_OK;
    const crossing fresh = {.ends = {vertex, vertex}, .vertex = vertex, .next = UINT32_MAX};
    size_t slot = slot_of(s, vertex, vertex);
    if (s->table[slot] != 0)
        goto done;
    STARG_PUSH(s->p->context, PARTITION_STAGE, &s->crossings, fresh);
    s->table[slot] = (uint32_t)s->crossings.count;
done:
    return status;
}

static starg_status find_crossings(slicer *s) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet f = s->p->facets.data[i];
        if (side_of_piece(s, &f) < 0)
            continue;
        for (int k = 0; k < 3; k++) {
            if (s->height[f.corners[k]] == 0)
                STARG_TRY(add_touch(s, f.corners[k]));
            uint32_t a = f.corners[k], b = f.corners[(k + 1) % 3];
            if (!is_crossed(s, a, b))
                continue;
            size_t slot = a < b ? slot_of(s, a, b) : slot_of(s, b, a);
            if (s->table[slot] == 0)
                STARG_TRY(add_crossing(s, a < b ? a : b, a < b ? b : a, slot));
            s->crossings.data[s->table[slot] - 1].facets++;
        }
    }
done:
    return status;
}

/* ---- splitting ---- */

static starg_status add_facet(slicer *s, const facet *parent, uint32_t a, uint32_t b, uint32_t c) {
    starg_status status = STARG_OK;
    facet child = *parent;
    child.corners[0] = a;
    child.corners[1] = b;
    child.corners[2] = c;
    STARG_PUSH(s->p->context, PARTITION_STAGE, &s->p->facets, child);
done:
    return status;
}

static double gap(const slicer *s, uint32_t a, uint32_t b) {
    return vec3_distance_squared(partition_unit(s->p, a), partition_unit(s->p, b));
}

/* Facet (a, b, c) with new vertices m on ab and n on ca: the corner at a goes, the quadrangle is
 * cut along its shorter diagonal. */
static starg_status split_in_three(slicer *s, const facet *f, int k, uint32_t m, uint32_t n) {
    starg_status status = STARG_OK;
    uint32_t a = f->corners[k], b = f->corners[(k + 1) % 3], c = f->corners[(k + 2) % 3];
    STARG_TRY(add_facet(s, f, a, m, n));
    if (gap(s, m, c) < gap(s, b, n)) {
        STARG_TRY(add_facet(s, f, m, b, c));
        STARG_TRY(add_facet(s, f, m, c, n));
    } else {
        STARG_TRY(add_facet(s, f, m, b, n));
        STARG_TRY(add_facet(s, f, b, c, n));
    }
done:
    return status;
}

/* A segment of the cap: the boundary of the part of a facet below the plane runs from one crossing
 * to the other, in the order of the facet's corners; the cap's runs against it. */
static void link_crossings(slicer *s, const facet *f, crossing *from, crossing *to) {
    bool outward = side_of_piece(s, f) == FACET_INNER;
    crossing *begin = outward ? to : from, *end = outward ? from : to;
    s->broken = s->broken || begin->next != UINT32_MAX;
    begin->next = (uint32_t)(end - s->crossings.data);
    begin->facets += begin->ends[0] == begin->ends[1];
    end->facets += end->ends[0] == end->ends[1];
}

/* The plane crosses edge k of the facet, and its opposite corner may lie on the plane. */
static void link_corner(slicer *s, const facet *f, int k, crossing *m) {
    uint32_t corner = f->corners[(k + 2) % 3];
    crossing *n = find_crossing(s, corner, corner);
    if (side_of_piece(s, f) < 0 || n == NULL)
        return;
    bool low = s->height[f->corners[k]] < 0;
    link_crossings(s, f, low ? m : n, low ? n : m);
}

static starg_status split_facet(slicer *s, size_t i, bool *split) {
    starg_status status = STARG_OK;
    const facet f = s->p->facets.data[i];
    crossing *on[3];
    int count = 0, apex = 0, edge = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t a = f.corners[k], b = f.corners[(k + 1) % 3];
        on[k] = is_crossed(s, a, b) ? find_crossing(s, a, b) : NULL;
        count += on[k] != NULL;
        if (on[k] != NULL)
            edge = k;
    }
    *split = count > 0;
    if (count == 1) {
        uint32_t m = on[edge]->vertex, c = f.corners[(edge + 2) % 3];
        link_corner(s, &f, edge, on[edge]);
        STARG_TRY(add_facet(s, &f, f.corners[edge], m, c));
        STARG_TRY(add_facet(s, &f, m, f.corners[(edge + 1) % 3], c));
    } else if (count == 2) {
        while (on[apex] == NULL || on[(apex + 2) % 3] == NULL)
            apex++;
        crossing *m = on[apex], *n = on[(apex + 2) % 3];
        bool low = s->height[f.corners[apex]] < 0;
        if (side_of_piece(s, &f) >= 0)
            link_crossings(s, &f, low ? m : n, low ? n : m);
        STARG_TRY(split_in_three(s, &f, apex, m->vertex, n->vertex));
    }
done:
    return status;
}

/* Children stand at the end; their parents are closed up afterwards. */
static starg_status split_facets(slicer *s) {
    starg_status status = STARG_OK;
    size_t count = s->p->facets.count, kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool split;
        STARG_TRY(split_facet(s, i, &split));
        if (!split)
            s->p->facets.data[kept++] = s->p->facets.data[i];
    }
    size_t children = s->p->facets.count - count;
    memmove(s->p->facets.data + kept, s->p->facets.data + count,
            children * sizeof *s->p->facets.data);
    s->p->facets.count = kept + children;
done:
    return status;
}

/* ---- edges on the plane ---- */

static int compare_edges(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The edge of a facet that lies on the plane, or -1. */
static int edge_on_plane(const slicer *s, const facet *f) {
    for (int k = 0; k < 3; k++)
        if (s->height[f->corners[k]] == 0 && s->height[f->corners[(k + 1) % 3]] == 0)
            return k;
    return -1;
}

static uint64_t edge_key(const facet *f, int k) {
    uint64_t a = f->corners[k], b = f->corners[(k + 1) % 3];
    return a < b ? a << 32 | b : b << 32 | a;
}

static starg_status find_on_plane_edges(slicer *s) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet *f = &s->p->facets.data[i];
        int k = side_of_piece(s, f) < 0 ? -1 : edge_on_plane(s, f);
        if (k >= 0 && corners_above(s, f) > 0)
            STARG_PUSH(s->p->context, PARTITION_STAGE, &s->on_plane_edges, edge_key(f, k));
    }
    if (s->on_plane_edges.count > 1)
        qsort(s->on_plane_edges.data, s->on_plane_edges.count, sizeof *s->on_plane_edges.data,
              compare_edges);
done:
    return status;
}

/* Edges where a facet below the plane meets one above are segments of the cap. Where both are on
 * one side the surface touches the plane: perhaps inside of the cap, which would pinch it. */
static starg_status link_on_plane_edges(slicer *s) {
    starg_status status = STARG_OK;
    size_t linked = 0;
    STARG_TRY(find_on_plane_edges(s));
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet *f = &s->p->facets.data[i];
        int k = side_of_piece(s, f) < 0 ? -1 : edge_on_plane(s, f);
        if (k < 0 || corners_below(s, f) == 0)
            continue;
        uint64_t key = edge_key(f, k);
        s->broken = s->broken || s->on_plane_edges.count == 0 ||
                    bsearch(&key, s->on_plane_edges.data, s->on_plane_edges.count, sizeof key,
                            compare_edges) == NULL;
        uint32_t a = f->corners[k], b = f->corners[(k + 1) % 3];
        link_crossings(s, f, find_crossing(s, a, a), find_crossing(s, b, b));
        linked++;
    }
    s->broken = s->broken || linked != s->on_plane_edges.count;
done:
    return status;
}

static void hand_over(slicer *s) {
    for (size_t i = 0; i < s->p->facets.count; i++) {
        facet *f = &s->p->facets.data[i];
        int side = side_of_piece(s, f);
        bool above = false;
        for (int k = 0; side >= 0 && k < 3; k++)
            above = above || (f->corners[k] < s->old_vertices && s->height[f->corners[k]] > 0);
        if (above)
            f->side[side] = s->high;
    }
}

/* ---- cap ---- */

/* False where the surface is no manifold: an edge has not two facets of the piece; or where it
 * touches the plane, or loops meet. */
static starg_status trace_loops(slicer *s, bool *done) {
    starg_status status = STARG_OK;
    *done = !s->broken;
    for (size_t i = 0; i < s->crossings.count && *done; i++)
        *done = s->crossings.data[i].facets == 2 && s->crossings.data[i].next != UINT32_MAX;
    STARG_PUSH(s->p->context, PARTITION_STAGE, &s->starts, 0);
    for (size_t i = 0; i < s->crossings.count && *done; i++) {
        if (s->crossings.data[i].facets == 0)
            continue;
        for (size_t at = i; s->crossings.data[at].facets != 0;) {
            s->crossings.data[at].facets = 0; /* visited */
            STARG_PUSH(s->p->context, PARTITION_STAGE, &s->corners, s->crossings.data[at].vertex);
            at = s->crossings.data[at].next;
        }
        STARG_PUSH(s->p->context, PARTITION_STAGE, &s->starts, (uint32_t)s->corners.count);
    }
done:
    return status;
}

static starg_status add_cap(slicer *s, bool *done) {
    starg_status status = STARG_OK;
    facet f = {.side = {s->low, s->high}, .plane = (uint32_t)s->p->planes.count};
    STARG_TRY(trace_loops(s, done));
    if (!*done)
        goto done;
    STARG_TRY(cap_fill(s->p->context, s->p->points.data, s->plane.normal, s->corners.data,
                       s->starts.data, s->starts.count - 1, &s->triangles, done));
    STARG_PUSH(s->p->context, PARTITION_STAGE, &s->p->planes, s->plane);
    for (size_t i = 0; i + 2 < s->triangles.count; i += 3)
        STARG_TRY(add_facet(s, &f, s->triangles.data[i], s->triangles.data[i + 1],
                            s->triangles.data[i + 2]));
done:
    return status;
}

starg_status partition_slice(partition *p, uint32_t low, uint32_t high,
                             const partition_plane *plane, bool *done) {
    starg_status status = STARG_OK;
    slicer s = {.p = p,
                .low = low,
                .high = high,
                .plane = *plane,
                .old_vertices = p->points.count / 3,
                .table_size = 64};
    size_t nodes;
    *done = false;
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.height, s.old_vertices);
    if (!find_heights(&s, &nodes))
        goto done;
    while (s.table_size < 3 * nodes)
        s.table_size *= 2;
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.table, s.table_size);
    STARG_TRY(find_crossings(&s));
    STARG_TRY(link_on_plane_edges(&s));
    STARG_TRY(split_facets(&s));
    hand_over(&s);
    STARG_TRY(add_cap(&s, done));
done:
    starg_release(p->context, s.height);
    starg_release(p->context, s.table);
    STARG_ARRAY_FREE(p->context, &s.crossings);
    STARG_ARRAY_FREE(p->context, &s.on_plane_edges);
    STARG_ARRAY_FREE(p->context, &s.corners);
    STARG_ARRAY_FREE(p->context, &s.starts);
    STARG_ARRAY_FREE(p->context, &s.triangles);
    return status;
}
