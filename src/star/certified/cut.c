/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a piece of a partition by a plane, fills the section, and parts what is not connected.
 *
 * Slice: classify each vertex of the piece as above, below or on the plane; put a new vertex on
 * every edge of the piece that the plane crosses; split all facets at those edges, so that the
 * partition stays conforming; reassign facets of the piece above the plane, and those in the plane
 * according to what they bound. The edges and vertices in the plane of all other facets of the
 * piece form a planar straight-line graph; the edges of the lower part that occur in one direction
 * only bound its cap. So there are no special cases: the plane may pass through vertices, along
 * edges and through facets, loops may meet, and the surface may touch itself or the plane in edges
 * and vertices.
 *
 * Cap: project along the axis closest to the normal, where signs are exact, and triangulate the
 * graph (geometry/constrained.c). The winding number, 0 outside, changes between triangles only
 * across edges of the graph, by an amount that the surface gives; the triangles of winding number 1
 * are the cap. The boundary of the triangles is always the chain of the edges.
 *
 * Parts: facets that share an edge are in one part; parts are numbered in the order of the facets.
 * A negative volume is the surface of a cavity. Parts that only touch at a vertex are separate: no
 * point inside either sees all around the vertex, and no plane with the vertex on one side
 * separates them.
 *
 * Invariants: a split edge is split in all its facets; the position of a new vertex depends only on
 * the ends of its edge; every surface stays closed. New vertices are rounded, so they lie off their
 * edges and off the plane by the rounding error. This may make edges of the graph cross; then there
 * is no cut.
 *
 * Cost: linear in the facets of the partition, plus the triangulation. */
#include "star/certified/partition.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

/* ---- caps ---- */

static const int32_t UNKNOWN = INT32_MIN;

/* Projection axes: points near a plane with this normal appear counter-clockwise when viewed
 * against the normal. */
static void choose_view(const double normal[3], int *u, int *v) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    *u = (axis + (normal[axis] < 0 ? 2 : 1)) % 3;
    *v = (axis + (normal[axis] < 0 ? 1 : 2)) % 3;
}

typedef struct winder {
    starg_context *context;
    const constrained_triangle *triangles;
    size_t count;
    int32_t *winding; /* per triangle */
    cap_indices stack;
} winder;

/* Sets the winding number of a triangle, as seen across one of its edges; it must be consistent. */
static starg_status give(winder *w, uint32_t number, int32_t winding, bool *done) {
    if (w->winding[number] != UNKNOWN) {
        *done = *done && w->winding[number] == winding;
        return STARG_OK;
    }
    w->winding[number] = winding;
    *done = *done && (winding == 0 || winding == 1);
    PUSH(w->context, "decompose", &w->stack, number);
    return STARG_OK;
}

static starg_status wind(winder *w, bool *done) {
    for (uint32_t i = 0; i < w->count; i++)
        w->winding[i] = UNKNOWN;
    for (uint32_t i = 0; i < w->count; i++)
        for (int k = 0; k < 3; k++)
            if (w->triangles[i].beyond[k] == CONSTRAINED_NONE)
                TRY(give(w, i, w->triangles[i].turns[k], done));
    while (w->stack.count > 0) {
        uint32_t number = w->stack.data[--w->stack.count];
        const constrained_triangle *t = &w->triangles[number];
        for (int k = 0; k < 3; k++)
            if (t->beyond[k] != CONSTRAINED_NONE)
                TRY(give(w, t->beyond[k], w->winding[number] - t->turns[k], done));
    }
    return STARG_OK;
}

static starg_status take(const winder *w, cap_indices *triangles) {
    for (size_t i = 0; i < w->count; i++)
        for (int k = 0; k < 3 && w->winding[i] == 1; k++)
            PUSH(w->context, "decompose", triangles, w->triangles[i].corners[k]);
    return STARG_OK;
}

starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const cap_edges *edges, const cap_indices *loose, cap_indices *triangles,
                      bool *done) {
    starg_status status = STARG_OK;
    constrained_triangles all = {0};
    winder w = {.context = context};
    constrained_graph graph = {.points = points,
                               .edges = edges->data,
                               .edge_count = edges->count,
                               .loose = loose->data,
                               .loose_count = loose->count};
    choose_view(normal, &graph.u, &graph.v);
    STARG_TRY(constrained_triangulate(context, &graph, &all, done));
    if (!*done || all.count == 0)
        goto done;
    w.triangles = all.data;
    w.count = all.count;
    STARG_NEW(context, "decompose", w.winding, w.count);
    STARG_TRY(wind(&w, done));
    if (*done)
        STARG_TRY(take(&w, triangles));
done:
    RELEASE(all.data, w.stack.data, w.winding);
    return status;
}

/* ---- slices ---- */

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
} crossing;

/* An edge in the plane, of a facet of the piece. */
typedef struct seam {
    uint32_t low, high; /* ends, ascending */
    int32_t turns;      /* of the cap, from low to high */
    bool needed;        /* the facet is not in the plane itself */
} seam;

typedef struct slicer {
    partition *p;
    uint32_t low, high;
    partition_plane plane;
    double on;      /* vertices closer to the plane count as on it */
    double *height; /* per vertex: above the plane; 0: on it, or not a vertex of the piece */
    size_t old_vertices;
    STARG_ARRAY(crossing) crossings;
    uint32_t *table; /* 1 + crossing by edge; open addressing */
    size_t table_size;
    STARG_ARRAY(seam) seams;
    cap_edges edges;
    cap_indices loose, triangles;
} slicer;

/* ---- slices: heights ---- */

static int side_of_piece(const slicer *s, const facet *f) {
    for (int side = 0; side < 2; side++)
        if (f->side[side] == s->low)
            return side;
    return -1;
}

/* New vertices deviate from their planes by the rounding of coordinates. */
static double find_tolerance(const partition *p) {
    double largest = 0;
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, ldexp(fabs(p->origin[k]), -p->exponents[k]));
    return fmax(SLICE_ON, 32 * DBL_EPSILON * (largest + 0.5));
}

/* Above the plane; 0 on it. */
static double find_height(const partition *p, const partition_plane *plane, double on,
                          uint32_t vertex) {
    double height = vec3_dot(plane->normal, partition_unit(p, vertex)) - plane->offset;
    return fabs(height) < on ? 0 : height;
}

static double height_of(const slicer *s, uint32_t vertex) {
    return vertex < s->old_vertices ? s->height[vertex] : 0;
}

/* 1 if a facet that the plane does not cross is above it, -1 below, 0 in it. */
static int side_of_plane(const slicer *s, const facet *f) {
    for (int k = 0; k < 3; k++) {
        double height = height_of(s, f->corners[k]);
        if (height != 0)
            return height > 0 ? 1 : -1;
    }
    return 0;
}

/* False if all of the piece is on one side. `nodes` bounds the number of crossings. */
static bool find_heights(slicer *s, size_t *nodes) {
    bool above = false, below = false;
    *nodes = 0;
    for (size_t i = 0; i < s->p->facets.count; i++) {
        const facet *f = &s->p->facets.data[i];
        if (side_of_piece(s, f) < 0)
            continue;
        bool high = false, low = false;
        for (int k = 0; k < 3; k++) {
            double height = find_height(s->p, &s->plane, s->on, f->corners[k]);
            s->height[f->corners[k]] = height;
            high = high || height > 0;
            low = low || height < 0;
        }
        above = above || high;
        below = below || low;
        *nodes += high && low ? 2 : 0;
    }
    return above && below;
}

/* ---- slices: crossings ---- */

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
    crossing fresh = {.ends = {a, b}};
    double t = s->height[a] / (s->height[a] - s->height[b]), point[3];
    const double *from = partition_point(s->p, a), *to = partition_point(s->p, b);
    for (int k = 0; k < 3; k++)
        point[k] = from[k] + t * (to[k] - from[k]);
    TRY(partition_add_point(s->p, point, &fresh.vertex));
    PUSH(s->p->context, PARTITION_STAGE, &s->crossings, fresh);
    s->table[slot] = (uint32_t)s->crossings.count;
    return STARG_OK;
}

static starg_status find_crossings(slicer *s) {
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
                TRY(add_crossing(s, a < b ? a : b, a < b ? b : a, slot));
        }
    }
    return STARG_OK;
}

/* ---- slices: splitting ---- */

static starg_status add_facet(slicer *s, const facet *parent, uint32_t a, uint32_t b, uint32_t c) {
    facet child = *parent;
    child.corners[0] = a;
    child.corners[1] = b;
    child.corners[2] = c;
    PUSH(s->p->context, PARTITION_STAGE, &s->p->facets, child);
    return STARG_OK;
}

static double gap(const slicer *s, uint32_t a, uint32_t b) {
    return vec3_distance_squared(partition_unit(s->p, a), partition_unit(s->p, b));
}

/* Facet (a, b, c) with new vertices m on ab and n on ca: separates the corner at a, and splits the
 * quadrangle along its shorter diagonal. */
static starg_status split_in_three(slicer *s, const facet *f, int k, uint32_t m, uint32_t n) {
    uint32_t a = f->corners[k], b = f->corners[(k + 1) % 3], c = f->corners[(k + 2) % 3];
    TRY(add_facet(s, f, a, m, n));
    if (gap(s, m, c) < gap(s, b, n)) {
        TRY(add_facet(s, f, m, b, c));
        TRY(add_facet(s, f, m, c, n));
    } else {
        TRY(add_facet(s, f, m, b, n));
        TRY(add_facet(s, f, b, c, n));
    }
    return STARG_OK;
}

static starg_status split_facet(slicer *s, size_t i, bool *split) {
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
        TRY(add_facet(s, &f, f.corners[edge], m, c));
        TRY(add_facet(s, &f, m, f.corners[(edge + 1) % 3], c));
    } else if (count == 2) {
        while (on[apex] == NULL || on[(apex + 2) % 3] == NULL)
            apex++;
        TRY(split_in_three(s, &f, apex, on[apex]->vertex, on[(apex + 2) % 3]->vertex));
    }
    return STARG_OK;
}

/* Appends the children, then removes their parents. */
static starg_status split_facets(slicer *s) {
    size_t count = s->p->facets.count, kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool split;
        TRY(split_facet(s, i, &split));
        if (!split)
            s->p->facets.data[kept++] = s->p->facets.data[i];
    }
    size_t children = s->p->facets.count - count;
    memmove(s->p->facets.data + kept, s->p->facets.data + count,
            children * sizeof *s->p->facets.data);
    s->p->facets.count = kept + children;
    return STARG_OK;
}

/* ---- slices: the graph in the plane ---- */

/* Is the piece below a facet in the plane, seen along the axis of the cap? */
static bool is_lid(const slicer *s, const facet *f, int side) {
    int u, v;
    uint32_t c[3];
    choose_view(s->plane.normal, &u, &v);
    facet_outward(f, side, c);
    return orient2d(partition_point(s->p, c[0]), partition_point(s->p, c[1]),
                    partition_point(s->p, c[2]), u, v) >= 0;
}

/* Adds the edges of a facet of the piece that lie in the plane. */
static starg_status add_seams(slicer *s, const facet *f, int side, bool is_low, bool is_flat) {
    uint32_t c[3];
    facet_outward(f, side, c);
    for (int k = 0; k < 3; k++) {
        uint32_t a = c[k], b = c[(k + 1) % 3];
        if (height_of(s, a) != 0)
            continue;
        if (!is_flat && a < s->old_vertices)
            PUSH(s->p->context, PARTITION_STAGE, &s->loose, a);
        if (height_of(s, b) != 0)
            continue;
        /* opposite to the facets of the lower part */
        const seam fresh = {.low = a < b ? a : b,
                            .high = a < b ? b : a,
                            .turns = is_low ? (a < b ? -1 : 1) : 0,
                            .needed = !is_flat};
        PUSH(s->p->context, PARTITION_STAGE, &s->seams, fresh);
    }
    return STARG_OK;
}

/* Reassigns the facets above the plane. */
static starg_status hand_over(slicer *s) {
    for (size_t i = 0; i < s->p->facets.count; i++) {
        facet *f = &s->p->facets.data[i];
        int side = side_of_piece(s, f);
        if (side < 0)
            continue;
        int above = side_of_plane(s, f);
        bool is_low = above < 0 || (above == 0 && is_lid(s, f, side));
        TRY(add_seams(s, f, side, is_low, above == 0));
        if (!is_low)
            f->side[side] = s->high;
    }
    return STARG_OK;
}

static int compare_seams(const void *x, const void *y) {
    const seam *a = x, *b = y;
    return partition_compare_edges(a->low, a->high, b->low, b->high);
}

/* Combines all seams of an edge. Inside facets in the plane there is nothing to fill. */
static starg_status join_seams(slicer *s) {
    size_t count = s->seams.count;
    if (count > 1)
        qsort(s->seams.data, count, sizeof *s->seams.data, compare_seams);
    for (size_t i = 0; i < count;) {
        seam all = s->seams.data[i];
        for (i++; i < count && compare_seams(&all, &s->seams.data[i]) == 0; i++) {
            all.turns += s->seams.data[i].turns;
            all.needed = all.needed || s->seams.data[i].needed;
        }
        const constrained_edge edge = {all.low, all.high, all.turns};
        if (all.turns != 0 || all.needed)
            PUSH(s->p->context, PARTITION_STAGE, &s->edges, edge);
    }
    return STARG_OK;
}

static starg_status add_cap(slicer *s, bool *done) {
    facet f = {.side = {s->low, s->high}, .plane = (uint32_t)s->p->planes.count};
    TRY(join_seams(s));
    TRY(cap_fill(s->p->context, s->p->points.data, s->plane.normal, &s->edges, &s->loose,
                 &s->triangles, done));
    PUSH(s->p->context, PARTITION_STAGE, &s->p->planes, s->plane);
    for (size_t i = 0; i + 2 < s->triangles.count; i += 3)
        TRY(add_facet(s, &f, s->triangles.data[i], s->triangles.data[i + 1],
                      s->triangles.data[i + 2]));
    return STARG_OK;
}

int partition_sides(const partition *p, uint32_t number, const partition_plane *plane) {
    double on = find_tolerance(p);
    int sides = 0;
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        for (int k = 0; k < 3 && (f->side[0] == number || f->side[1] == number); k++) {
            double height = find_height(p, plane, on, f->corners[k]);
            sides |= height > 0 ? PARTITION_ABOVE : height < 0 ? PARTITION_BELOW : 0;
        }
    }
    return sides;
}

starg_status partition_slice(partition *p, uint32_t low, uint32_t high,
                             const partition_plane *plane, bool *done) {
    starg_status status = STARG_OK;
    slicer s = {.p = p,
                .low = low,
                .high = high,
                .plane = *plane,
                .on = find_tolerance(p),
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
    STARG_TRY(split_facets(&s));
    STARG_TRY(hand_over(&s));
    STARG_TRY(add_cap(&s, done));
done:
    RELEASE(s.height, s.table, s.crossings.data, s.seams.data, s.edges.data, s.loose.data,
            s.triangles.data);
    return status;
}

/* ---- parts ---- */

typedef struct separator {
    partition *p;
    uint32_t number;
    size_t count;     /* facets */
    uint32_t *leader; /* by facet, in the order of the index */
    uint32_t *part;   /* by leading facet: 1 + part, 0: none yet */
    STARG_ARRAY(double) volumes;
} separator;

/* Facets with a common edge are linked. */
static starg_status link_neighbours(separator *s) {
    const partition *p = s->p;
    const size_t count = 3 * s->count;
    SCOPED partition_edge *edges = NULL;
    NEW(p->context, PARTITION_STAGE, edges, count);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *c =
            p->facets.data[p->index.data[p->start.data[s->number] + i / 3] / 2].corners;
        edges[i] = (partition_edge){c[i % 3], c[(i + 1) % 3], i / 3};
    }
    TRY(partition_sort_edges(p->context, edges, count, p->points.count / 3));
    sets_make(s->leader, s->count);
    for (size_t i = 1; i < count; i++)
        if (partition_same_edge(&edges[i - 1], &edges[i]))
            sets_join(s->leader, edges[i].facet, edges[i - 1].facet);
    return STARG_OK;
}

static starg_status number_parts(separator *s) {
    partition *p = s->p;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        uint32_t *part = &s->part[sets_find(s->leader, i)];
        if (*part == 0) {
            PUSH(p->context, PARTITION_STAGE, &s->volumes, 0);
            *part = (uint32_t)s->volumes.count;
        }
        s->volumes.data[*part - 1] +=
            vec3_triple(partition_unit(p, c[0]), partition_unit(p, c[1]), partition_unit(p, c[2])) /
            6;
    }
    return STARG_OK;
}

static bool has_cavity(const separator *s) {
    for (size_t i = 0; i < s->volumes.count; i++)
        if (s->volumes.data[i] <= 0)
            return true;
    return false;
}

static starg_status hand_out(separator *s) {
    partition *p = s->p;
    uint32_t first = (uint32_t)p->pieces.count - 1; /* the second part's number is one more */
    for (size_t i = 1; i < s->volumes.count; i++) {
        const piece fresh = {.volume = s->volumes.data[i], .stamp = ++p->stamps};
        PUSH(p->context, PARTITION_STAGE, &p->pieces, fresh);
    }
    p->pieces.data[s->number].volume = s->volumes.data[0];
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i];
        uint32_t part = s->part[sets_find(s->leader, i)] - 1;
        if (part > 0)
            p->facets.data[entry / 2].side[entry % 2] = first + part;
    }
    return partition_build_index(p);
}

starg_status partition_separate(partition *p, uint32_t number) {
    starg_status status = STARG_OK;
    separator s = {
        .p = p, .number = number, .count = p->start.data[number + 1] - p->start.data[number]};
    STARG_NEW(p->context, PARTITION_STAGE, s.leader, s.count);
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.part, s.count);
    STARG_TRY(link_neighbours(&s));
    STARG_TRY(number_parts(&s));
    if (s.volumes.count == 1)
        p->pieces.data[number].volume = s.volumes.data[0];
    else if (!has_cavity(&s))
        STARG_TRY(hand_out(&s));
done:
    RELEASE(s.leader, s.part, s.volumes.data);
    return status;
}
