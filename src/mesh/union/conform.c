/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a surface conform: rounds of joining and dividing until nothing is near anything that it
 * does not share.
 *
 * A round
 * 1. merges vertices within the distance (near_weld.c),
 * 2. finds what lies on what (near.c): an edge becomes the chain of the vertices on it, the same
 *    for all its faces. Edges that meet get a common vertex,
 * 3. divides each face that has vertices on its edges or in it, together with the faces that it
 *    overlaps in one plane: a constrained triangulation, in a projection, of the chains of all and
 *    of chains of other faces that lie in them. Each face takes the triangles within its border.
 *    Where the projection is no plane graph (rounding has bent a sliver), a face is divided by its
 *    border alone, in coordinates of its own in which chains are straight.
 *
 * A border that runs to and fro cancels out, so that slivers vanish. Invariants: every face is
 * replaced by triangles with its border as their border. So a surface that bounds something still
 * does, and one with T-junctions does now.
 *
 * Rounding alone needs two or three rounds; an end to them is counted, not proven, and so is one to
 * the number of faces. Cost of a round: that of near.c, and of the triangulations. */
#include "mesh/union/union.h"

#include <float.h>
#include <stdlib.h>

#include "geometry/constrained.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

enum { MOST_ROUNDS = 12, ULPS = 16, IN_FACE = 8, FLIPS_PER_TRIANGLE = 8, MOST_GROWTH = 4 };

typedef STARG_ARRAY(uint32_t) index_list;
typedef STARG_ARRAY(constrained_edge) edge_list;

typedef struct conformer {
    starg_context *context;
    union_surface *surface, *next; /* vertices stay in `surface` */
    double distance;               /* in units of `place` */
    int exponent;                  /* place = vertices times 2^-exponent */
    double *place;
    near_facts facts;
    size_t *on_start, *in_start; /* per edge, per face: where its facts begin */
    size_t *link_start;          /* per vertex with links: where they begin */
    uint32_t *links;             /* the other ends of segments of chains */
    /* the faces that are divided together */
    uint32_t *local; /* per vertex: its number among `points`, or NONE */
    uint8_t *side;   /* per vertex: bits of the sides of a face; or in it */
    index_list vertices, loose, queue, own;
    STARG_ARRAY(double) points;
    edge_list border, graph;
    constrained_triangles triangles;
    STARG_ARRAY(uint8_t) reached;
    double moved;
    bool changed;
} conformer;

/* ---- distance ---- */

static double shortest_edge(const union_surface *surface) {
    double least = INFINITY;
    for (uint32_t f = 0; f < union_face_count(surface); f++)
        for (int k = 0; k < 3; k++) {
            double length =
                vec3_distance(union_corner(surface, f, k), union_corner(surface, f, (k + 1) % 3));
            if (length > 0)
                least = fmin(least, length);
        }
    return least;
}

double conform_distance(const union_surface *surface, double merge) {
    double largest = 0, lower[3] = {0}, upper[3] = {0};
    bool single = true;
    for (size_t i = 0; i < surface->vertices.count; i++) {
        double x = surface->vertices.data[i];
        largest = fmax(largest, fabs(x));
        single = single && fabs(x) < FLT_MAX && (double)(float)x == x;
        lower[i % 3] = i < 3 ? x : fmin(lower[i % 3], x);
        upper[i % 3] = i < 3 ? x : fmax(upper[i % 3], x);
    }
    if (!(largest > 0))
        return 0;
    double least = ldexp(ULPS * DBL_EPSILON / 2, ilogb(largest) + 1);
    if (single)
        least = fmax(least, fmin(shortest_edge(surface) / 4,
                                 ldexp(ULPS * FLT_EPSILON / 2, ilogb(largest) + 1)));
    return fmax(least, merge * vec3_distance(lower, upper));
}

/* ---- vertices ---- */

static starg_status scale_vertices(conformer *c) {
    size_t count = c->surface->vertices.count;
    starg_release(c->context, c->place);
    NEW(c->context, UNION_STAGE, c->place, count);
    for (size_t i = 0; i < count; i++)
        c->place[i] = ldexp(c->surface->vertices.data[i], -c->exponent);
    return STARG_OK;
}

/* Moves corners to the vertices that theirs have joined; drops faces that repeat one then. */
static void move_corners(conformer *c, const uint32_t *place) {
    union_surface *s = c->surface;
    size_t kept = 0;
    for (size_t f = 0; f < union_face_count(s); f++) {
        uint32_t corner[3];
        bool moved = false;
        for (size_t k = 0; k < 3; k++) {
            corner[k] = place[s->faces.data[3 * f + k]];
            moved = moved || corner[k] != s->faces.data[3 * f + k];
        }
        c->changed = c->changed || moved;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            continue;
        memcpy(s->faces.data + 3 * kept, corner, sizeof corner);
        s->origin.data[kept] = s->origin.data[f];
        s->flags.data[kept++] = s->flags.data[f] | (moved ? UNION_FRESH : 0);
    }
    s->faces.count = 3 * kept;
    s->origin.count = s->flags.count = kept;
}

/* `given` counts the vertices that the surface began with. */
static starg_status merge_vertices(conformer *c, size_t given, conform_report *report) {
    SCOPED uint32_t *place = NULL;
    size_t count = c->surface->vertices.count / 3;
    NEW(c->context, UNION_STAGE, place, count);
    TRY(near_weld(c->context, c->place, count, c->distance, place));
    report->merged = 0;
    for (size_t v = 0; v < count; v++) {
        report->merged += v < given && place[v] != v;
        c->moved = fmax(c->moved, vec3_distance(c->place + 3 * v, c->place + 3 * (size_t)place[v]));
    }
    move_corners(c, place);
    return STARG_OK;
}

/* Edges that meet get a vertex there: one that is near, or a new one. */
static starg_status add_crossings(conformer *c, conform_report *report) {
    near_facts *facts = &c->facts;
    SCOPED uint32_t *place = NULL;
    size_t before = c->surface->vertices.count / 3, count = facts->crossing.count;
    if (count == 0)
        return STARG_OK;
    for (size_t i = 0; i < 3 * count; i++)
        PUSH(c->context, UNION_STAGE, &c->surface->vertices,
             ldexp(facts->crossing.data[i / 3].point[i % 3], c->exponent));
    TRY(scale_vertices(c));
    NEW(c->context, UNION_STAGE, place, before + count);
    TRY(near_weld(c->context, c->place, before + count, c->distance, place));
    for (size_t i = 0; i < count; i++) {
        const near_crossing *own = &facts->crossing.data[i];
        uint32_t vertex = place[before + i];
        report->added += vertex == before + i;
        for (int k = 0; k < 2; k++) {
            const near_on_edge fact = {own->edge[k], vertex, own->at[k]};
            const uint32_t *ends = facts->ends + 2 * (size_t)fact.edge;
            if (vertex != ends[0] && vertex != ends[1])
                PUSH(c->context, UNION_STAGE, &facts->on, fact);
        }
    }
    near_sort(facts);
    return STARG_OK;
}

/* ---- chains ---- */

static starg_status file_facts(conformer *c) {
    const near_facts *facts = &c->facts;
    NEW_ZERO(c->context, UNION_STAGE, c->on_start, facts->edge_count + 1);
    NEW_ZERO(c->context, UNION_STAGE, c->in_start, facts->face_count + 1);
    for (size_t i = 0; i < facts->on.count; i++)
        c->on_start[facts->on.data[i].edge + 1]++;
    for (size_t i = 0; i < facts->in.count; i++)
        c->in_start[facts->in.data[i].face + 1]++;
    for (size_t i = 0; i < facts->edge_count; i++)
        c->on_start[i + 1] += c->on_start[i];
    for (size_t i = 0; i < facts->face_count; i++)
        c->in_start[i + 1] += c->in_start[i];
    return STARG_OK;
}

/* The segments of the chain of an edge: calls for each pair of neighbours. */
static size_t chain_length(const conformer *c, uint32_t edge) {
    return c->on_start[edge + 1] - c->on_start[edge] + 2;
}

static uint32_t chain_vertex(const conformer *c, uint32_t edge, size_t i) {
    size_t length = chain_length(c, edge);
    if (i == 0 || i + 1 == length)
        return c->facts.ends[2 * (size_t)edge + (i > 0)];
    return c->facts.on.data[c->on_start[edge] + i - 1].vertex;
}

/* Lists at each vertex the segments of chains. */
static starg_status file_links(conformer *c) {
    size_t vertices = c->surface->vertices.count / 3;
    NEW_ZERO(c->context, UNION_STAGE, c->link_start, vertices + 1);
    for (uint32_t e = 0; e < c->facts.edge_count; e++)
        for (size_t i = 0; i < chain_length(c, e); i++)
            c->link_start[chain_vertex(c, e, i) + 1] +=
                i == 0 || i + 1 == chain_length(c, e) ? 1 : 2;
    for (size_t v = 0; v < vertices; v++)
        c->link_start[v + 1] += c->link_start[v];
    NEW(c->context, UNION_STAGE, c->links, c->link_start[vertices]);
    for (uint32_t e = (uint32_t)c->facts.edge_count; e-- > 0;)
        for (size_t i = 0; i + 1 < chain_length(c, e); i++) {
            uint32_t a = chain_vertex(c, e, i), b = chain_vertex(c, e, i + 1);
            c->links[--c->link_start[a + 1]] = b;
            c->links[--c->link_start[b + 1]] = a;
        }
    /* each end has gone down to its begin: link_start[v + 1] is where v begins */
    size_t all = c->link_start[vertices];
    for (size_t v = 0; v < vertices; v++)
        c->link_start[v] = c->link_start[v + 1];
    c->link_start[vertices] = all;
    return STARG_OK;
}

/* ---- the graph of some faces ---- */

static starg_status push_edge(conformer *c, edge_list *list, uint32_t from, uint32_t to) {
    const constrained_edge edge = {from, to, 0};
    PUSH(c->context, UNION_STAGE, list, edge);
    return STARG_OK;
}

static starg_status localize(conformer *c, uint32_t vertex) {
    if (c->local[vertex] != UINT32_MAX)
        return STARG_OK;
    c->local[vertex] = (uint32_t)c->vertices.count;
    PUSH(c->context, UNION_STAGE, &c->vertices, vertex);
    for (size_t k = 0; k < 3; k++)
        PUSH(c->context, UNION_STAGE, &c->points, c->place[3 * (size_t)vertex + k]);
    return STARG_OK;
}

static void forget_graph(conformer *c) {
    for (size_t i = 0; i < c->vertices.count; i++)
        c->local[c->vertices.data[i]] = UINT32_MAX;
    c->vertices.count = c->points.count = c->graph.count = c->loose.count = 0;
}

static int compare_edges(const void *left, const void *right) {
    const constrained_edge *a = left, *b = right;
    if (a->from != b->from)
        return a->from < b->from ? -1 : 1;
    return (a->to > b->to) - (a->to < b->to);
}

static const constrained_edge *find_edge(const edge_list *list, uint32_t from, uint32_t to) {
    const constrained_edge key = {from, to, 0};
    return list->count == 0 ? NULL
                            : bsearch(&key, list->data, list->count, sizeof key, compare_edges);
}

/* The border of a face as directed segments between local vertices, sorted, without those that run
 * to and fro. */
static starg_status collect_border(conformer *c, uint32_t face) {
    edge_list *border = &c->border;
    size_t kept = 0;
    border->count = 0;
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++) {
        uint32_t edge = c->facts.edge[h];
        size_t length = chain_length(c, edge);
        bool along = c->surface->faces.data[h] == c->facts.ends[2 * (size_t)edge];
        for (size_t i = 0; i < length; i++)
            TRY(localize(c, chain_vertex(c, edge, i)));
        for (size_t i = 0; i + 1 < length; i++) {
            uint32_t a = c->local[chain_vertex(c, edge, i)];
            uint32_t b = c->local[chain_vertex(c, edge, i + 1)];
            TRY(push_edge(c, border, along ? a : b, along ? b : a));
        }
    }
    qsort(border->data, border->count, sizeof *border->data, compare_edges);
    for (size_t i = 0; i < border->count; i++)
        border->data[i].turns = find_edge(border, border->data[i].to, border->data[i].from) != NULL;
    for (size_t i = 0; i < border->count; i++)
        if (border->data[i].turns == 0)
            border->data[kept++] = border->data[i];
    border->count = kept;
    return STARG_OK;
}

/* A vertex on sides of the current face (a bit each), or in it (another bit). */
static starg_status place_vertex(conformer *c, uint32_t vertex, uint8_t where) {
    if (c->side[vertex] == 0)
        PUSH(c->context, UNION_STAGE, &c->own, vertex);
    c->side[vertex] |= where;
    return STARG_OK;
}

/* Vertices in the face, and segments of chains that lie in it. */
static starg_status collect_inside(conformer *c, uint32_t face) {
    starg_status status = STARG_OK;
    c->own.count = 0;
    for (size_t i = c->in_start[face]; i < c->in_start[face + 1]; i++) {
        uint32_t vertex = c->facts.in.data[i].vertex;
        STARG_TRY(localize(c, vertex));
        STARG_PUSH(c->context, UNION_STAGE, &c->loose, c->local[vertex]);
        STARG_TRY(place_vertex(c, vertex, IN_FACE));
    }
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t edge = c->facts.edge[3 * face + k];
        for (size_t i = 0; i < chain_length(c, edge); i++)
            STARG_TRY(place_vertex(c, chain_vertex(c, edge, i), (uint8_t)(1 << k)));
    }
    for (size_t i = 0; i < c->own.count; i++) {
        uint32_t a = c->own.data[i];
        for (size_t l = c->link_start[a]; l < c->link_start[a + 1]; l++) {
            uint32_t b = c->links[l];
            if (a < b && c->side[b] != 0 && (c->side[a] & c->side[b] & (IN_FACE - 1)) == 0)
                STARG_TRY(push_edge(c, &c->graph, c->local[a], c->local[b]));
        }
    }
done:
    for (size_t i = 0; i < c->own.count; i++)
        c->side[c->own.data[i]] = 0;
    return status;
}

/* Sorts the edges of the graph and drops repetitions, whatever their direction. */
static void sort_graph(conformer *c) {
    size_t kept = 0;
    for (size_t i = 0; i < c->graph.count; i++) {
        constrained_edge *own = &c->graph.data[i];
        if (own->from > own->to)
            *own = (constrained_edge){own->to, own->from, 0};
    }
    if (c->graph.count > 0)
        qsort(c->graph.data, c->graph.count, sizeof *c->graph.data, compare_edges);
    for (size_t i = 0; i < c->graph.count; i++)
        if (i == 0 || compare_edges(&c->graph.data[i], &c->graph.data[i - 1]) != 0)
            c->graph.data[kept++] = c->graph.data[i];
    c->graph.count = kept;
}

/* The coordinates in which the largest of some faces is largest; it turns left in them. */
static void choose_projection(const conformer *c, const uint32_t *faces, size_t count, int *u,
                              int *v) {
    double largest = -1, normal[3] = {0, 0, 1};
    for (size_t i = 0; i < count; i++) {
        const uint32_t *corner = c->surface->faces.data + 3 * (size_t)faces[i];
        double own[3];
        vec3_triangle_normal(c->place + 3 * (size_t)corner[0], c->place + 3 * (size_t)corner[1],
                             c->place + 3 * (size_t)corner[2], own);
        if (!(vec3_dot(own, own) > largest))
            continue;
        largest = vec3_dot(own, own);
        vec3_copy(own, normal);
    }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    *u = (axis + (normal[axis] > 0 ? 1 : 2)) % 3;
    *v = (axis + (normal[axis] > 0 ? 2 : 1)) % 3;
}

/* ---- slivers ---- */

/* Least height of a triangle of local vertices, in space. */
static double least_height(const conformer *c, uint32_t i, uint32_t j, uint32_t k) {
    const uint32_t corner[3] = {i, j, k};
    const double *p[3];
    double longest = 0;
    for (int n = 0; n < 3; n++)
        p[n] = c->points.data + 3 * (size_t)corner[n];
    for (int n = 0; n < 3; n++)
        longest = fmax(longest, vec3_distance(p[n], p[(n + 1) % 3]));
    return 2 * vec3_triangle_area(p[0], p[1], p[2]) / longest;
}

static void relink(conformer *c, uint32_t triangle, int edge, const constrained_triangle *from,
                   int old_edge, uint32_t old) {
    constrained_triangle *own = &c->triangles.data[triangle];
    uint32_t beyond = from->beyond[old_edge];
    own->beyond[edge] = beyond;
    own->fixed[edge] = from->fixed[old_edge];
    if (beyond == CONSTRAINED_NONE)
        return;
    constrained_triangle *other = &c->triangles.data[beyond];
    for (int k = 0; k < 3; k++)
        if (other->beyond[k] == old && other->corners[k] == own->corners[(edge + 1) % 3])
            other->beyond[k] = triangle;
}

/* Flips edge k of a triangle if that is possible and leaves triangles twice as high. */
static bool flip_if_better(conformer *c, uint32_t triangle, int k, int u, int v) {
    constrained_triangle one = c->triangles.data[triangle];
    uint32_t beyond = one.beyond[k];
    if (one.fixed[k] || beyond == CONSTRAINED_NONE)
        return false;
    constrained_triangle two = c->triangles.data[beyond];
    uint32_t p = one.corners[k], q = one.corners[(k + 1) % 3], tip = one.corners[(k + 2) % 3];
    int j = two.corners[0] == q ? 0 : two.corners[1] == q ? 1 : 2;
    uint32_t x = two.corners[(j + 2) % 3];
    const double *at = c->points.data;
    if (orient2d(at + 3 * (size_t)p, at + 3 * (size_t)x, at + 3 * (size_t)tip, u, v) <= 0 ||
        orient2d(at + 3 * (size_t)x, at + 3 * (size_t)q, at + 3 * (size_t)tip, u, v) <= 0)
        return false;
    if (fmin(least_height(c, p, x, tip), least_height(c, x, q, tip)) <=
        2 * fmin(least_height(c, p, q, tip), least_height(c, q, p, x)))
        return false;
    c->triangles.data[triangle] = (constrained_triangle){.corners = {p, x, tip}};
    c->triangles.data[beyond] = (constrained_triangle){.corners = {x, q, tip}};
    relink(c, triangle, 0, &two, (j + 1) % 3, beyond);
    relink(c, triangle, 2, &one, (k + 2) % 3, triangle);
    relink(c, beyond, 0, &two, (j + 2) % 3, beyond);
    relink(c, beyond, 1, &one, (k + 1) % 3, triangle);
    c->triangles.data[triangle].beyond[1] = beyond;
    c->triangles.data[beyond].beyond[2] = triangle;
    return true;
}

/* Vertices that rounding has bent out of a line make triangles narrower than the distance, and the
 * next round would find them on an edge again: such edges are flipped. */
static void flip_slivers(conformer *c, int u, int v) {
    size_t flips = 0, most = FLIPS_PER_TRIANGLE * c->triangles.count;
    bool flipped = true;
    while (flipped && flips < most) {
        flipped = false;
        for (uint32_t t = 0; t < c->triangles.count; t++) {
            const uint32_t *corner = c->triangles.data[t].corners;
            if (least_height(c, corner[0], corner[1], corner[2]) > 2 * c->distance)
                continue;
            for (int k = 0; k < 3; k++) {
                bool better = flip_if_better(c, t, k, u, v);
                flipped = flipped || better;
                flips += better;
            }
        }
    }
}

/* ---- what a face takes ---- */

static starg_status emit(conformer *c, uint32_t face, const uint32_t corner[3]) {
    const union_surface *from = c->surface;
    const uint32_t *own = from->faces.data + 3 * (size_t)face;
    bool whole = false;
    for (int k = 0; k < 3; k++)
        whole = whole || (corner[k] == own[0] && corner[(k + 1) % 3] == own[1] &&
                          corner[(k + 2) % 3] == own[2]);
    for (int k = 0; k < 3; k++)
        PUSH(c->context, UNION_STAGE, &c->next->faces, whole ? own[k] : corner[k]);
    PUSH(c->context, UNION_STAGE, &c->next->origin, from->origin.data[face]);
    PUSH(c->context, UNION_STAGE, &c->next->flags,
         from->flags.data[face] | (whole ? 0 : UNION_PART | UNION_FRESH));
    c->changed = c->changed || !whole;
    return STARG_OK;
}

/* Marks the triangles within the border of a face by a flood from it. False unless the border of
 * what is marked is that border: then there is no such part of the triangulation. */
static starg_status flood(conformer *c, bool turned, bool *fits) {
    size_t count = c->triangles.count, met = 0;
    c->reached.count = c->queue.count = 0;
    *fits = false;
    for (uint32_t t = 0; t < count; t++) {
        const constrained_triangle *own = &c->triangles.data[t];
        PUSH(c->context, UNION_STAGE, &c->reached, 0);
        for (int k = 0; k < 3 && !c->reached.data[t]; k++) {
            uint32_t a = own->corners[k], b = own->corners[(k + 1) % 3];
            c->reached.data[t] =
                own->fixed[k] && find_edge(&c->border, turned ? b : a, turned ? a : b) != NULL;
        }
        if (c->reached.data[t])
            PUSH(c->context, UNION_STAGE, &c->queue, t);
    }
    for (size_t i = 0; i < c->queue.count; i++) {
        const constrained_triangle *own = &c->triangles.data[c->queue.data[i]];
        for (int k = 0; k < 3; k++) {
            uint32_t a = own->corners[k], b = own->corners[(k + 1) % 3], beyond = own->beyond[k];
            if (own->fixed[k] && find_edge(&c->border, turned ? b : a, turned ? a : b) != NULL) {
                met++;
                continue;
            }
            if (beyond == CONSTRAINED_NONE ||
                (own->fixed[k] && find_edge(&c->border, turned ? a : b, turned ? b : a) != NULL))
                return STARG_OK; /* it runs out, or comes from outside */
            if (c->reached.data[beyond])
                continue;
            c->reached.data[beyond] = 1;
            PUSH(c->context, UNION_STAGE, &c->queue, beyond);
        }
    }
    *fits = met == c->border.count;
    return STARG_OK;
}

static starg_status take_triangles(conformer *c, uint32_t face, bool turned) {
    for (uint32_t t = 0; t < c->triangles.count; t++) {
        const uint32_t *own = c->triangles.data[t].corners;
        if (!c->reached.data[t])
            continue;
        TRY(emit(c, face,
                 (const uint32_t[]){c->vertices.data[own[0]], c->vertices.data[own[turned ? 2 : 1]],
                                    c->vertices.data[own[turned ? 1 : 2]]}));
    }
    return STARG_OK;
}

/* Does a face turn right in the projection? */
static bool is_turned(const conformer *c, uint32_t face, int u, int v) {
    const uint32_t *corner = c->surface->faces.data + 3 * (size_t)face;
    const double *p = c->place + 3 * (size_t)corner[0], *q = c->place + 3 * (size_t)corner[1];
    const double *r = c->place + 3 * (size_t)corner[2];
    return (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]) < 0;
}

static starg_status triangulate(conformer *c, int u, int v, bool *done) {
    const constrained_graph graph = {.points = c->points.data,
                                     .u = u,
                                     .v = v,
                                     .edges = c->graph.data,
                                     .edge_count = c->graph.count,
                                     .loose = c->loose.data,
                                     .loose_count = c->loose.count};
    return constrained_triangulate(c->context, &graph, &c->triangles, done);
}

/* Divides faces together. *done is false, and nothing is emitted, if they cannot be. */
static starg_status divide_together(conformer *c, const uint32_t *faces, size_t count, bool *done) {
    starg_status status = STARG_OK;
    size_t before = c->next->origin.count;
    int u, v;
    bool changed = c->changed;
    choose_projection(c, faces, count, &u, &v);
    for (size_t i = 0; i < count; i++) {
        STARG_TRY(collect_border(c, faces[i]));
        for (size_t e = 0; e < c->border.count; e++)
            STARG_TRY(push_edge(c, &c->graph, c->border.data[e].from, c->border.data[e].to));
        STARG_TRY(collect_inside(c, faces[i]));
    }
    sort_graph(c);
    c->triangles.count = 0;
    STARG_TRY(triangulate(c, u, v, done));
    flip_slivers(c, u, v);
    for (size_t i = 0; i < count && *done; i++) {
        bool turned = is_turned(c, faces[i], u, v);
        STARG_TRY(collect_border(c, faces[i]));
        if (c->border.count > 0)
            STARG_TRY(flood(c, turned, done));
        if (c->border.count > 0 && *done)
            STARG_TRY(take_triangles(c, faces[i], turned));
        c->changed = c->changed || c->border.count == 0;
    }
    if (!*done) {
        c->next->origin.count = c->next->flags.count = before;
        c->next->faces.count = 3 * before;
        c->changed = changed;
    }
done:
    forget_graph(c);
    return status;
}

/* Divides a face by its border alone: corners at (0, 0), (1, 0) and (0, 1), and chains evenly
 * between them, on lattice points so that they are straight. */
static starg_status divide_alone(conformer *c, uint32_t face) {
    static const double CORNER[4][2] = {{0, 0}, {1, 0}, {0, 1}, {0, 0}};
    starg_status status = STARG_OK;
    size_t steps = 1;
    bool done;
    for (uint32_t k = 0; k < 3; k++)
        while (steps < chain_length(c, c->facts.edge[3 * face + k]))
            steps *= 2;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t edge = c->facts.edge[3 * face + k];
        size_t length = chain_length(c, edge);
        bool along = c->surface->faces.data[3 * face + k] == c->facts.ends[2 * (size_t)edge];
        for (size_t i = 0; i + 1 < length; i++) {
            double at = (double)i / (double)steps;
            STARG_PUSH(c->context, UNION_STAGE, &c->vertices,
                       chain_vertex(c, edge, along ? i : length - 1 - i));
            for (int axis = 0; axis < 3; axis++)
                STARG_PUSH(
                    c->context, UNION_STAGE, &c->points,
                    axis == 2 ? 0 : CORNER[k][axis] + at * (CORNER[k + 1][axis] - CORNER[k][axis]));
        }
    }
    for (uint32_t i = 0; i < c->vertices.count; i++)
        STARG_TRY(push_edge(c, &c->graph, i, (uint32_t)((i + 1) % c->vertices.count)));
    c->triangles.count = 0;
    STARG_TRY(triangulate(c, 0, 1, &done));
    for (size_t t = 0; t < c->triangles.count; t++) {
        uint32_t corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = c->vertices.data[c->triangles.data[t].corners[k]];
        if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
            STARG_TRY(emit(c, face, corner));
    }
    c->changed = true;
done:
    c->vertices.count = c->points.count = c->graph.count = 0;
    return status;
}

/* ---- rounds ---- */

static bool is_busy(const conformer *c, uint32_t face) {
    bool busy = c->in_start[face] != c->in_start[face + 1];
    for (uint32_t k = 0; k < 3; k++)
        busy = busy || chain_length(c, c->facts.edge[3 * face + k]) > 2;
    return busy;
}

static starg_status divide_sheet(conformer *c, const uint32_t *faces, size_t count) {
    bool done = false;
    if (count == 1 && !is_busy(c, faces[0]))
        return emit(c, faces[0], c->surface->faces.data + 3 * (size_t)faces[0]);
    TRY(divide_together(c, faces, count, &done));
    for (size_t i = 0; i < count && !done; i++) {
        bool alone = false;
        if (count > 1)
            TRY(divide_together(c, faces + i, 1, &alone));
        if (!alone)
            TRY(divide_alone(c, faces[i]));
    }
    return STARG_OK;
}

/* Sheet by sheet, in the order of their lowest faces. */
static starg_status divide_all(conformer *c) {
    size_t count = c->facts.face_count;
    SCOPED uint32_t *chain = NULL;
    SCOPED index_list members = {0};
    NEW(c->context, UNION_STAGE, chain, count);
    for (size_t f = 0; f < count; f++)
        chain[f] = UINT32_MAX;
    for (size_t f = count; f-- > 0;) {
        uint32_t root = sets_find(c->facts.sheet, (uint32_t)f);
        if (root == f)
            continue;
        chain[f] = chain[root];
        chain[root] = (uint32_t)f;
    }
    for (uint32_t f = 0; f < count; f++) {
        if (sets_find(c->facts.sheet, f) != f)
            continue;
        members.count = 0;
        for (uint32_t m = f; m != UINT32_MAX; m = chain[m])
            PUSH(c->context, UNION_STAGE, &members, m);
        TRY(divide_sheet(c, members.data, members.count));
        if (members.count > 1 || f % 1024 == 0)
            TRY(starg_check_cancel(c->context, UNION_STAGE));
    }
    return STARG_OK;
}

static starg_status divide(conformer *c) {
    SCOPED_BY(union_surface_free) union_surface next = {.context = c->context};
    size_t vertices = c->surface->vertices.count / 3;
    TRY(file_facts(c));
    TRY(file_links(c));
    NEW_ZERO(c->context, UNION_STAGE, c->side, vertices);
    NEW(c->context, UNION_STAGE, c->local, vertices);
    for (size_t v = 0; v < vertices; v++)
        c->local[v] = UINT32_MAX;
    c->next = &next;
    TRY(divide_all(c));
    union_surface former = *c->surface;
    next.vertices = former.vertices;
    *c->surface = next;
    next = former;
    next.vertices.data = NULL;
    return STARG_OK;
}

static void free_round(conformer *c) {
    RELEASE(c->place, c->on_start, c->in_start, c->link_start, c->links, c->local, c->side,
            c->own.data, c->vertices.data, c->loose.data, c->queue.data, c->points.data,
            c->border.data, c->graph.data, c->triangles.data, c->reached.data);
    near_free(&c->facts);
}

static starg_status run_round(union_surface *surface, double distance, int exponent, size_t given,
                              conform_report *report, bool *changed, bool *full) {
    SCOPED_BY(free_round)
    conformer c = {.context = surface->context,
                   .surface = surface,
                   .distance = ldexp(distance, -exponent),
                   .exponent = exponent,
                   .facts.context = surface->context};
    TRY(scale_vertices(&c));
    TRY(merge_vertices(&c, given, report));
    TRY(near_find(c.context, c.place, surface->faces.data, union_face_count(surface), c.distance,
                  &c.facts));
    *full = c.facts.full;
    if (*full)
        return STARG_OK;
    TRY(add_crossings(&c, report));
    if (c.facts.on.count > 0 || c.facts.in.count > 0 || c.facts.sheets)
        TRY(divide(&c));
    report->moved += ldexp(fmax(c.moved, c.facts.farthest), exponent);
    *changed = c.changed;
    return STARG_OK;
}

starg_status surface_conform(union_surface *surface, double distance, conform_report *report) {
    size_t given = surface->vertices.count / 3;
    double largest = 0;
    *report = (conform_report){0};
    for (size_t i = 0; i < surface->vertices.count; i++)
        largest = fmax(largest, fabs(surface->vertices.data[i]));
    int exponent = largest > 0 ? ilogb(largest) + 1 : 0;
    bool changed = true, full = false;
    size_t most = MOST_GROWTH * (union_face_count(surface) + 256);
    while (changed && !full && report->rounds < MOST_ROUNDS && union_face_count(surface) <= most) {
        TRY(run_round(surface, distance, exponent, given, report, &changed, &full));
        report->rounds += changed;
    }
    report->left = changed || full;
    return STARG_OK;
}

starg_status conform_closes(starg_context *context, const starg_mesh *mesh, double merge,
                            bool *closed) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED_BY(union_surface_free) union_surface surface = {.context = context};
    conform_report report;
    TRY(union_surface_make(context, mesh, &surface));
    TRY(surface_conform(&surface, conform_distance(&surface, merge), &report));
    const starg_mesh view = {.context = context,
                             .vertex_count = surface.vertices.count / 3,
                             .face_count = union_face_count(&surface),
                             .vertices = surface.vertices.data,
                             .faces = surface.faces.data};
    TRY(topology_create(context, &view, &topology));
    *closed = view.face_count > 0;
    for (uint32_t h = 0; h < 3 * view.face_count && *closed; h++)
        *closed = topology->ring[h] != h;
    return STARG_OK;
}
