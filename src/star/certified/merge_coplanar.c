/* SPDX-License-Identifier: Apache-2.0 */
/* Coplanar merge: undoes splits of facets that no cut needs any longer.
 *
 * Problem: a cut splits the facets that it meets, and the splits remain when later cuts replace it.
 * They cost time and cause slivers.
 *
 * Stages: group the coplanar facets with the same piece on either side; the border of a group
 * consists of its edges that occur in one direction only. A vertex made by cuts is needed unless
 * all borders through it run straight on between the same two neighbours (it was inserted on an
 * edge that is now a seam of planes), or no border passes. Each group's border, without the
 * vertices that are not needed, is triangulated again (cut.c), with the inner edges and vertices
 * that another group's border touches (seams): these are needed, and stay. A group whose border
 * touches itself, or whose triangulation fails, stays as it is and needs all of its vertices.
 * Finally, certify.
 *
 * Invariants: a vertex is removed from all facets or from none, so that every surface stays closed.
 *
 * Cost: n log n for sorting, plus the triangulations. */
#include "star/certified/partition.h"

#include <stdlib.h>

enum { ROUNDS = 4 };

/* An edge of a group's border, in the direction of its facet. */
typedef struct border {
    uint32_t from, to, group;
} border;

typedef struct group {
    uint32_t first, count; /* facets */
    uint32_t border_first, border_count;
    uint32_t seam_first, seam_count;
    bool kept; /* keeps its facets */
} group;

typedef struct tidier {
    partition *p; /* the copy: its facets are sorted by group */
    STARG_ARRAY(group) groups;
    STARG_ARRAY(border) borders; /* by group, then by where they start */
    STARG_ARRAY(border) seams;   /* by group */
    uint32_t (*around)[2];       /* per vertex: its neighbours along borders, or NONE */
    bool *needed;                /* per vertex */
    STARG_ARRAY(facet) facets;   /* the new facets */
    cap_edges edges;             /* of the current triangulation */
    cap_indices loose, triangles;
    bool *visited; /* per border edge */
} tidier;

static const uint32_t NONE = UINT32_MAX;

/* ---- groups ---- */

static int by_group(const void *x, const void *y) {
    const facet *a = x, *b = y;
    if (a->plane != b->plane)
        return a->plane < b->plane ? -1 : 1;
    if (a->side[0] != b->side[0])
        return a->side[0] < b->side[0] ? -1 : 1;
    if (a->side[1] != b->side[1])
        return a->side[1] < b->side[1] ? -1 : 1;
    /* the remaining keys make the order deterministic */
    return memcmp(a->corners, b->corners, sizeof a->corners);
}

static bool same_group(const facet *a, const facet *b) {
    return a->plane == b->plane && a->side[0] == b->side[0] && a->side[1] == b->side[1];
}

static starg_status find_groups(tidier *t) {
    const facet *facets = t->p->facets.data;
    size_t count = t->p->facets.count;
    if (count > 0)
        qsort(t->p->facets.data, count, sizeof *facets, by_group);
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && same_group(&facets[i - 1], &facets[i])) {
            t->groups.data[t->groups.count - 1].count++;
            continue;
        }
        const group fresh = {.first = (uint32_t)i, .count = 1};
        PUSH(t->p->context, PARTITION_STAGE, &t->groups, fresh);
    }
    return STARG_OK;
}

/* ---- borders ---- */

static int by_edge(const void *x, const void *y) {
    const border *a = x, *b = y;
    uint32_t a_low = a->from < a->to ? a->from : a->to, a_high = a->from + a->to - a_low;
    uint32_t b_low = b->from < b->to ? b->from : b->to, b_high = b->from + b->to - b_low;
    if (a_low != b_low)
        return a_low < b_low ? -1 : 1;
    return a_high < b_high ? -1 : a_high > b_high;
}

static int by_start(const void *x, const void *y) {
    const border *a = x, *b = y;
    if (a->from != b->from)
        return a->from < b->from ? -1 : 1;
    return a->to < b->to ? -1 : a->to > b->to;
}

/* Pairs of opposite edges cancel. */
static size_t cancel_pairs(border *edges, size_t count) {
    size_t kept = 0;
    qsort(edges, count, sizeof *edges, by_edge);
    for (size_t i = 0; i < count; i++)
        if (i + 1 < count && edges[i].from == edges[i + 1].to && edges[i].to == edges[i + 1].from)
            i++;
        else
            edges[kept++] = edges[i];
    qsort(edges, kept, sizeof *edges, by_start);
    return kept;
}

static starg_status find_border(tidier *t, uint32_t number) {
    group *g = &t->groups.data[number];
    g->border_first = (uint32_t)t->borders.count;
    for (uint32_t i = 0; i < g->count; i++) {
        const uint32_t *k = t->p->facets.data[g->first + i].corners;
        for (int e = 0; e < 3; e++) {
            const border edge = {k[e], k[(e + 1) % 3], number};
            PUSH(t->p->context, PARTITION_STAGE, &t->borders, edge);
        }
    }
    border *edges = t->borders.data + g->border_first;
    g->border_count = (uint32_t)cancel_pairs(edges, t->borders.count - g->border_first);
    t->borders.count = g->border_first + g->border_count;
    for (uint32_t i = 1; i < g->border_count; i++)
        g->kept = g->kept || edges[i].from == edges[i - 1].from;
    return STARG_OK;
}

/* ---- seams ---- */

/* An edge of a group of several facets. */
typedef struct inner_edge {
    border edge;
    bool own, other; /* on the group's own border, on another's */
} inner_edge;

static int by_inner_edge(const void *x, const void *y) {
    return by_edge(&((const inner_edge *)x)->edge, &((const inner_edge *)y)->edge);
}

static int by_edge_and_group(const void *x, const void *y) {
    const border *a = x, *b = y;
    return a->group != b->group ? (a->group < b->group ? -1 : 1) : by_edge(x, y);
}

/* Marks inner edges that lie on a border, of their own group or of another. */
static void meet_border(inner_edge *inner, size_t count, const border *edge) {
    const inner_edge key = {.edge = *edge};
    inner_edge *at = bsearch(&key, inner, count, sizeof *inner, by_inner_edge),
               *end = inner + count;
    while (at != NULL && at > inner && by_inner_edge(at - 1, &key) == 0)
        at--;
    for (; at != NULL && at < end && by_inner_edge(at, &key) == 0; at++)
        if (at->edge.group == edge->group)
            at->own = true;
        else
            at->other = true;
}

/* Edges inside one group that are on the border of another. */
static starg_status find_seams(tidier *t) {
    SCOPED STARG_ARRAY(inner_edge) inner = {0};
    for (uint32_t i = 0; i < t->groups.count; i++) {
        const group *g = &t->groups.data[i];
        for (uint32_t k = 0; g->count > 1 && k < 3 * g->count; k++) {
            const uint32_t *c = t->p->facets.data[g->first + k / 3].corners;
            const inner_edge fresh = {.edge = {c[k % 3], c[(k + 1) % 3], i}};
            if (fresh.edge.from < fresh.edge.to)
                PUSH(t->p->context, PARTITION_STAGE, &inner, fresh);
        }
    }
    if (inner.count > 1)
        qsort(inner.data, inner.count, sizeof *inner.data, by_inner_edge);
    for (size_t i = 0; inner.count > 0 && i < t->borders.count; i++)
        meet_border(inner.data, inner.count, &t->borders.data[i]);
    for (size_t i = 0; i < inner.count; i++)
        if (inner.data[i].other && !inner.data[i].own)
            PUSH(t->p->context, PARTITION_STAGE, &t->seams, inner.data[i].edge);
    if (t->seams.count > 1)
        qsort(t->seams.data, t->seams.count, sizeof *t->seams.data, by_edge_and_group);
    for (size_t i = 0; i < t->seams.count; i++) {
        group *g = &t->groups.data[t->seams.data[i].group];
        g->seam_first = g->seam_count == 0 ? (uint32_t)i : g->seam_first;
        g->seam_count++;
    }
    return STARG_OK;
}

/* ---- needed vertices ---- */

static void meet(tidier *t, uint32_t vertex, uint32_t neighbour) {
    uint32_t *around = t->around[vertex];
    if (around[0] == neighbour || around[1] == neighbour)
        return;
    if (around[0] == NONE)
        around[0] = neighbour;
    else if (around[1] == NONE)
        around[1] = neighbour;
    else
        t->needed[vertex] = true;
}

static void need_all(tidier *t, const group *g) {
    for (uint32_t i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            t->needed[t->p->facets.data[g->first + i].corners[k]] = true;
}

static void find_needed(tidier *t) {
    for (size_t v = 0; v < t->p->first_points; v++)
        t->needed[v] = true;
    for (size_t i = 0; i < t->borders.count; i++) {
        meet(t, t->borders.data[i].from, t->borders.data[i].to);
        meet(t, t->borders.data[i].to, t->borders.data[i].from);
    }
    for (size_t i = 0; i < t->seams.count; i++)
        t->needed[t->seams.data[i].from] = t->needed[t->seams.data[i].to] = true;
    for (size_t i = 0; i < t->groups.count; i++)
        if (t->groups.data[i].kept)
            need_all(t, &t->groups.data[i]);
}

/* ---- filling ---- */

/* The border edge of a group that starts at a vertex; each vertex has one. */
static uint32_t edge_from(const tidier *t, const group *g, uint32_t vertex) {
    uint32_t low = g->border_first, high = g->border_first + g->border_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (t->borders.data[middle].from <= vertex)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* One loop of a group's border, without the vertices that are not needed. */
static starg_status trace_loop(tidier *t, const group *g, uint32_t start) {
    uint32_t first = NONE, last = NONE;
    for (uint32_t at = start; !t->visited[at]; at = edge_from(t, g, t->borders.data[at].to)) {
        uint32_t vertex = t->borders.data[at].from;
        t->visited[at] = true;
        if (!t->needed[vertex])
            continue;
        const constrained_edge edge = {last, vertex, 1};
        if (last == NONE)
            first = vertex;
        else
            PUSH(t->p->context, PARTITION_STAGE, &t->edges, edge);
        last = vertex;
    }
    const constrained_edge closing = {last, first, 1};
    if (last != NONE)
        PUSH(t->p->context, PARTITION_STAGE, &t->edges, closing);
    return STARG_OK;
}

static starg_status trace(tidier *t, const group *g) {
    t->edges.count = t->loose.count = t->triangles.count = 0;
    for (uint32_t i = g->border_first; i < g->border_first + g->border_count; i++)
        if (!t->visited[i])
            TRY(trace_loop(t, g, i));
    for (uint32_t i = g->seam_first; i < g->seam_first + g->seam_count; i++) {
        const constrained_edge edge = {t->seams.data[i].from, t->seams.data[i].to, 0};
        PUSH(t->p->context, PARTITION_STAGE, &t->edges, edge);
    }
    for (uint32_t i = 0; i < 3 * g->count; i++) {
        uint32_t vertex = t->p->facets.data[g->first + i / 3].corners[i % 3];
        if (t->needed[vertex])
            PUSH(t->p->context, PARTITION_STAGE, &t->loose, vertex);
    }
    return STARG_OK;
}

static bool all_needed(const tidier *t, const group *g) {
    for (uint32_t i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            if (!t->needed[t->p->facets.data[g->first + i].corners[k]])
                return false;
    return true;
}

static starg_status copy_facets(tidier *t, const group *g) {
    for (uint32_t i = 0; i < g->count; i++)
        PUSH(t->p->context, PARTITION_STAGE, &t->facets, t->p->facets.data[g->first + i]);
    return STARG_OK;
}

static starg_status fill(tidier *t, group *g) {
    facet fresh = t->p->facets.data[g->first];
    bool done = false;
    if (g->kept || all_needed(t, g))
        return copy_facets(t, g);
    TRY(trace(t, g));
    TRY(cap_fill(t->p->context, t->p->points.data, t->p->planes.data[fresh.plane].normal, &t->edges,
                 &t->loose, &t->triangles, &done));
    g->kept = !done;
    for (size_t i = 0; done && i + 2 < t->triangles.count; i += 3) {
        memcpy(fresh.corners, t->triangles.data + i, sizeof fresh.corners);
        PUSH(t->p->context, PARTITION_STAGE, &t->facets, fresh);
    }
    return STARG_OK;
}

/* *again: some group turned out to need all of its vertices. */
static starg_status fill_all(tidier *t, bool *again) {
    *again = false;
    t->facets.count = 0;
    memset(t->visited, 0, t->borders.count * sizeof *t->visited);
    for (size_t i = 0; i < t->groups.count; i++) {
        bool kept = t->groups.data[i].kept;
        TRY(fill(t, &t->groups.data[i]));
        *again = *again || t->groups.data[i].kept != kept;
    }
    if (*again)
        find_needed(t);
    return STARG_OK;
}

/* ---- the result ---- */

static starg_status take_facets(tidier *t) {
    t->p->facets.count = 0;
    for (size_t i = 0; i < t->facets.count; i++)
        PUSH(t->p->context, PARTITION_STAGE, &t->p->facets, t->facets.data[i]);
    return STARG_OK;
}

/* Removes cut planes that contain no facet. */
static starg_status drop_planes(partition *p) {
    SCOPED uint32_t *number = NULL;
    size_t count = p->planes.count, kept = p->first_planes;
    NEW_ZERO(p->context, PARTITION_STAGE, number, count);
    for (size_t i = 0; i < p->facets.count; i++)
        number[p->facets.data[i].plane] = 1;
    for (size_t k = 0; k < count; k++) {
        bool used = number[k] != 0;
        number[k] = (uint32_t)(k < p->first_planes ? k : kept);
        if (k >= p->first_planes && used)
            p->planes.data[kept++] = p->planes.data[k];
    }
    p->planes.count = kept;
    for (size_t i = 0; i < p->facets.count; i++)
        p->facets.data[i].plane = number[p->facets.data[i].plane];
    return STARG_OK;
}

/* Removes points made by cuts that no facet uses. */
static starg_status drop_points(partition *p) {
    SCOPED uint32_t *number = NULL;
    size_t count = p->points.count / 3, kept = p->first_points;
    NEW_ZERO(p->context, PARTITION_STAGE, number, count);
    for (size_t i = 0; i < 3 * p->facets.count; i++)
        number[p->facets.data[i / 3].corners[i % 3]] = 1;
    for (size_t v = 0; v < count; v++) {
        if (v < p->first_points) {
            number[v] = (uint32_t)v;
            continue;
        }
        if (number[v] == 0)
            continue;
        memmove(p->points.data + 3 * kept, p->points.data + 3 * v, 3 * sizeof *p->points.data);
        memmove(p->unit.data + 3 * kept, p->unit.data + 3 * v, 3 * sizeof *p->unit.data);
        number[v] = (uint32_t)kept++;
    }
    p->points.count = p->unit.count = 3 * kept;
    for (size_t i = 0; i < 3 * p->facets.count; i++) {
        uint32_t *corner = &p->facets.data[i / 3].corners[i % 3];
        *corner = number[*corner];
    }
    return STARG_OK;
}

static starg_status make_anew(tidier *t, bool *done) {
    size_t vertices = t->p->points.count / 3;
    bool again = true;
    NEW(t->p->context, PARTITION_STAGE, t->around, vertices);
    NEW_ZERO(t->p->context, PARTITION_STAGE, t->needed, vertices);
    memset(t->around, 0xff, vertices * sizeof *t->around);
    TRY(find_groups(t));
    for (uint32_t i = 0; i < t->groups.count; i++)
        TRY(find_border(t, i));
    TRY(find_seams(t));
    find_needed(t);
    NEW(t->p->context, PARTITION_STAGE, t->visited, t->borders.count);
    for (int round = 0; round < ROUNDS && again; round++)
        TRY(fill_all(t, &again));
    *done = !again;
    if (*done)
        TRY(take_facets(t));
    return STARG_OK;
}

static void tidier_free(tidier *t) {
    RELEASE(t->groups.data, t->borders.data, t->facets.data, t->seams.data, t->edges.data,
            t->loose.data, t->triangles.data, t->around, t->needed, t->visited);
}

static starg_status merge_all(partition *p, bool proven) {
    SCOPED_BY(partition_free) partition copy = {.context = p->context};
    SCOPED_BY(tidier_free) tidier t = {.p = &copy};
    bool done = false;
    TRY(partition_copy(p, &copy));
    TRY(make_anew(&t, &done));
    if (!done)
        return STARG_OK;
    TRY(drop_points(&copy));
    TRY(drop_planes(&copy));
    TRY(partition_build_index(&copy));
    if (proven)
        TRY(partition_certify_all(&copy, &done));
    if (done)
        partition_swap(p, &copy);
    return STARG_OK;
}

starg_status merge_coplanar(partition *p) {
    return merge_all(p, true);
}

starg_status merge_coplanar_unproven(partition *p) {
    return merge_all(p, false);
}
