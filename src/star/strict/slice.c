/* Cutting a piece of a partition by a plane.
 *
 * Stages: on which side of the plane each vertex of the piece lies; a new vertex on every edge of
 * the piece that the plane crosses; all facets at those edges are split, so that the partition
 * stays conforming; facets of the piece above the plane change hands; the segments in which the
 * plane meets the piece's facets are joined to loops, and the loops filled (star/strict/cap.c).
 *
 * Invariants: a split edge is split in all its facets; every new vertex is where the two ends of
 * its edge say, whichever facet asks; every surface stays closed.
 *
 * Cost: linear in the facets of the partition, and that of the cap. */
#include "star/strict/slice.h"

#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/vec3.h"
#include "star/strict/cap.h"

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

/* An edge that the plane crosses. */
typedef struct crossing {
    uint32_t ends[2]; /* ascending */
    uint32_t vertex;  /* on the plane */
    uint32_t facets;  /* of the piece that have the edge */
    uint32_t next;    /* the loop goes on at this vertex's crossing */
} crossing;

typedef struct slicer {
    partition *p;
    uint32_t low, high;
    partition_plane plane;
    double *height; /* per vertex: above the plane; 0: not a vertex of the piece */
    size_t old_vertices;
    STARG_ARRAY(crossing) crossings;
    uint32_t *table; /* 1 + crossing by edge; open addressing */
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

/* False when a vertex is too near to the plane, or all are on one side. */
static bool find_heights(slicer *s, size_t *edges) {
    bool above = false, below = false;
    *edges = 0;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet *f = &s->p->facets.data[i];
        if (side_of_piece(s, f) < 0)
            continue;
        int high = 0;
        for (int k = 0; k < 3; k++) {
            double *height = &s->height[f->corners[k]];
            if (*height == 0)
                *height = height_of(s, f->corners[k]);
            if (fabs(*height) < SLICE_CLEARANCE)
                return false;
            high += *height > 0;
        }
        above = above || high > 0;
        below = below || high < 3;
        *edges += high == 1 || high == 2;
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

static starg_status find_crossings(slicer *s) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet f = s->p->facets.data[i];
        if (side_of_piece(s, &f) < 0)
            continue;
        for (int k = 0; k < 3; k++) {
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

/* The plane enters a facet of the piece over one edge and leaves it over another: a segment of the
 * cap, whose direction is against that of the part below the plane. */
static void link_crossings(slicer *s, const facet *f, int k, crossing *m, crossing *n) {
    bool apex_low = s->height[f->corners[k]] < 0;
    bool outward = side_of_piece(s, f) == FACET_INNER;
    /* below an apex that is low, the facet's own boundary runs from m to n */
    if (apex_low == outward)
        n->next = (uint32_t)(m - s->crossings.data);
    else
        m->next = (uint32_t)(n - s->crossings.data);
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
        STARG_TRY(add_facet(s, &f, f.corners[edge], m, c));
        STARG_TRY(add_facet(s, &f, m, f.corners[(edge + 1) % 3], c));
    } else if (count == 2) {
        while (on[apex] == NULL || on[(apex + 2) % 3] == NULL)
            apex++;
        crossing *m = on[apex], *n = on[(apex + 2) % 3];
        if (side_of_piece(s, &f) >= 0)
            link_crossings(s, &f, apex, m, n);
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

/* False where the surface is no manifold: an edge has not two facets of the piece. */
static starg_status trace_loops(slicer *s, bool *done) {
    starg_status status = STARG_OK;
    *done = true;
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
    size_t edges;
    *done = false;
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.height, s.old_vertices);
    if (!find_heights(&s, &edges))
        goto done;
    while (s.table_size < 3 * edges)
        s.table_size *= 2;
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.table, s.table_size);
    STARG_TRY(find_crossings(&s));
    STARG_TRY(split_facets(&s));
    hand_over(&s);
    STARG_TRY(add_cap(&s, done));
done:
    starg_release(p->context, s.height);
    starg_release(p->context, s.table);
    STARG_ARRAY_FREE(p->context, &s.crossings);
    STARG_ARRAY_FREE(p->context, &s.corners);
    STARG_ARRAY_FREE(p->context, &s.starts);
    STARG_ARRAY_FREE(p->context, &s.triangles);
    return status;
}
