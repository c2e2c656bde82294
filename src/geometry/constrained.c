/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a planar straight-line graph.
 *
 * Problem: triangulate given vertices such that given edges are edges of the triangulation.
 *
 * Stages: insert the vertices in lexicographic order, each joined to the hull edges that it sees;
 * flip edges until all are locally Delaunay [Lawson 1977]; for each missing edge of the graph, flip
 * the edges that cross it until none does [Sloan 1993]; restore the Delaunay property, leaving the
 * graph's edges alone.
 *
 * Invariants: every triangle is counter-clockwise, exactly, at all times: a flip requires that of
 * both its triangles. The Delaunay test is rounded, since it affects only quality; a bound on the
 * flips ensures termination.
 *
 * Cost: O(n log n) for sorting, usually about n sqrt(n) flips. */
#include "geometry/constrained.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/predicates.h"

static const char STAGE[] = "triangulate";
static const uint32_t NONE = CONSTRAINED_NONE;

enum { FLIPS_EACH = 400 }; /* upper bound per triangle */

typedef struct site {
    double at[2];
    uint32_t vertex;
} site;

/* Corners are site numbers until the end. */
typedef struct triangulator {
    starg_context *context;
    const double *points;
    int u, v;
    STARG_ARRAY(site) sites; /* in lexicographic order */
    uint32_t *by_vertex;     /* sites by vertex */
    uint32_t *next, *before; /* neighbours of a site on the hull, counter-clockwise */
    uint32_t *outer; /* of such a site: 4 * triangle + edge, for the hull edge that starts there */
    uint32_t *triangle_of; /* per site: one of its triangles */
    STARG_ARRAY(uint32_t) stack;
    STARG_ARRAY(uint32_t) crossed; /* pairs of endpoints */
    constrained_triangles *triangles;
    uint64_t flips_left;
} triangulator;

static const double *place(const triangulator *t, uint32_t s) {
    return t->points + 3 * (size_t)t->sites.data[s].vertex;
}

static int turn(const triangulator *t, uint32_t a, uint32_t b, uint32_t c) {
    return orient2d(place(t, a), place(t, b), place(t, c), t->u, t->v);
}

/* ---- sites ---- */

static int compare_numbers(uint32_t a, uint32_t b) {
    return (a > b) - (a < b);
}

static int by_place(const void *x, const void *y) {
    const site *a = x, *b = y;
    for (int k = 0; k < 2; k++)
        if (a->at[k] != b->at[k])
            return a->at[k] < b->at[k] ? -1 : 1;
    return compare_numbers(a->vertex, b->vertex);
}

static starg_status add_site(triangulator *t, uint32_t vertex) {
    const double *q = t->points + 3 * (size_t)vertex;
    const site fresh = {{q[t->u], q[t->v]}, vertex};
    PUSH(t->context, STAGE, &t->sites, fresh);
    return STARG_OK;
}

/* Vertices with their site numbers, ascending. */
static int by_first(const void *x, const void *y) {
    const uint32_t *a = x, *b = y;
    return compare_numbers(a[0], b[0]);
}

static starg_status find_sites(triangulator *t, const constrained_edge *edges, size_t edge_count,
                               const uint32_t *loose, size_t loose_count, bool *done) {
    size_t kept = 0;
    for (size_t i = 0; i < edge_count; i++) {
        TRY(add_site(t, edges[i].from));
        TRY(add_site(t, edges[i].to));
    }
    for (size_t i = 0; i < loose_count; i++)
        TRY(add_site(t, loose[i]));
    if (t->sites.count > 1)
        qsort(t->sites.data, t->sites.count, sizeof *t->sites.data, by_place);
    for (size_t i = 0; i < t->sites.count; i++) {
        const site *s = &t->sites.data[i], *last = kept > 0 ? &t->sites.data[kept - 1] : NULL;
        if (last != NULL && last->vertex == s->vertex)
            continue;
        if (last != NULL && last->at[0] == s->at[0] && last->at[1] == s->at[1])
            *done = false;
        t->sites.data[kept++] = *s;
    }
    t->sites.count = kept;
    NEW(t->context, STAGE, t->by_vertex, 2 * kept);
    for (size_t i = 0; i < kept; i++) {
        t->by_vertex[2 * i] = t->sites.data[i].vertex;
        t->by_vertex[2 * i + 1] = (uint32_t)i;
    }
    if (kept > 1)
        qsort(t->by_vertex, kept, 2 * sizeof *t->by_vertex, by_first);
    return STARG_OK;
}

static uint32_t site_of(const triangulator *t, uint32_t vertex) {
    const uint32_t key[2] = {vertex, 0};
    const uint32_t *found =
        bsearch(key, t->by_vertex, t->sites.count, 2 * sizeof *t->by_vertex, by_first);
    return found[1];
}

/* ---- triangles ---- */

static constrained_triangle *at(const triangulator *t, uint32_t number) {
    return &t->triangles->data[number];
}

/* The edge of a triangle that starts at a site. */
static int edge_from(const constrained_triangle *it, uint32_t s) {
    return it->corners[0] == s ? 0 : it->corners[1] == s ? 1 : 2;
}

/* Links two triangles across an edge; b may be NONE. */
static void join(const triangulator *t, uint32_t a, int edge, uint32_t b, int other) {
    at(t, a)->beyond[edge] = b;
    if (b != NONE)
        at(t, b)->beyond[other] = a;
}

static starg_status add_triangle(triangulator *t, uint32_t a, uint32_t b, uint32_t c) {
    const constrained_triangle fresh = {.corners = {a, b, c}, .beyond = {NONE, NONE, NONE}};
    uint32_t number = (uint32_t)t->triangles->count;
    PUSH(t->context, STAGE, t->triangles, fresh);
    for (int k = 0; k < 3; k++)
        t->triangle_of[fresh.corners[k]] = number;
    return STARG_OK;
}

/* ---- the hull ---- */

static void link_hull(triangulator *t, uint32_t a, uint32_t b, uint32_t triangle, int edge) {
    t->next[a] = b;
    t->before[b] = a;
    t->outer[a] = 4 * triangle + (uint32_t)edge;
}

/* The first sites are collinear: makes a fan around the first site off their line. */
static starg_status start_hull(triangulator *t, uint32_t apex) {
    bool left = turn(t, 0, 1, apex) > 0;
    for (uint32_t i = 0; i + 1 < apex; i++) {
        TRY(add_triangle(t, left ? i : i + 1, left ? i + 1 : i, apex));
        /* edges: along the line, then to the apex and from it */
        if (i > 0)
            join(t, i, left ? 2 : 1, i - 1, left ? 1 : 2);
        if (left)
            link_hull(t, i, i + 1, i, 0);
        else
            link_hull(t, i + 1, i, i, 0);
    }
    uint32_t last = apex - 2;
    link_hull(t, left ? apex - 1 : apex, left ? apex : apex - 1, last, left ? 1 : 2);
    link_hull(t, left ? apex : 0, left ? 0 : apex, 0, left ? 2 : 1);
    return STARG_OK;
}

/* Joins a new site to the hull edges that it sees; they are adjacent to the last site inserted. */
static starg_status extend_hull(triangulator *t, uint32_t fresh) {
    uint32_t from = fresh - 1, to = fresh - 1, first = (uint32_t)t->triangles->count;
    while (turn(t, t->before[from], from, fresh) < 0)
        from = t->before[from];
    while (turn(t, to, t->next[to], fresh) < 0)
        to = t->next[to];
    for (uint32_t s = from; s != to; s = t->next[s]) {
        uint32_t number = (uint32_t)t->triangles->count;
        TRY(add_triangle(t, t->next[s], s, fresh));
        join(t, number, 0, t->outer[s] / 4, (int)(t->outer[s] % 4));
        if (number > first)
            join(t, number, 1, number - 1, 2);
    }
    link_hull(t, from, fresh, first, 1);
    link_hull(t, fresh, to, (uint32_t)t->triangles->count - 1, 2);
    return STARG_OK;
}

static starg_status triangulate_sites(triangulator *t) {
    uint32_t count = (uint32_t)t->sites.count, apex = 2;
    NEW(t->context, STAGE, t->next, count);
    NEW(t->context, STAGE, t->before, count);
    NEW(t->context, STAGE, t->outer, count);
    NEW(t->context, STAGE, t->triangle_of, count);
    while (apex < count && turn(t, 0, 1, apex) == 0)
        apex++;
    if (apex >= count)
        return STARG_OK;
    TRY(start_hull(t, apex));
    for (uint32_t s = apex + 1; s < count; s++)
        TRY(extend_hull(t, s));
    t->flips_left = (uint64_t)FLIPS_EACH * t->triangles->count;
    return STARG_OK;
}

/* ---- flips ---- */

typedef struct side {
    uint32_t beyond;
    int32_t turns;
    bool fixed;
} side;

static side side_of(const constrained_triangle *it, int edge) {
    return (side){it->beyond[edge], it->turns[edge], it->fixed[edge]};
}

static void put_side(const triangulator *t, uint32_t number, int edge, side s) {
    constrained_triangle *it = at(t, number);
    it->beyond[edge] = s.beyond;
    it->turns[edge] = s.turns;
    it->fixed[edge] = s.fixed;
    if (s.beyond == NONE)
        return;
    constrained_triangle *other = at(t, s.beyond);
    other->beyond[edge_from(other, it->corners[(edge + 1) % 3])] = number;
}

/* The corner of the triangle across an edge that is not on the edge. */
static uint32_t opposite(const triangulator *t, const constrained_triangle *it, int edge) {
    const constrained_triangle *other = at(t, it->beyond[edge]);
    return other->corners[(edge_from(other, it->corners[(edge + 1) % 3]) + 2) % 3];
}

/* Flips edge ab between c and d to cd if both new triangles are counter-clockwise. */
static bool flip(triangulator *t, uint32_t number, int edge) {
    constrained_triangle *s = at(t, number);
    uint32_t other = s->beyond[edge];
    uint32_t a = s->corners[edge], b = s->corners[(edge + 1) % 3], c = s->corners[(edge + 2) % 3];
    uint32_t d = opposite(t, s, edge);
    if (turn(t, a, d, c) <= 0 || turn(t, d, b, c) <= 0)
        return false;
    constrained_triangle *o = at(t, other);
    int back = edge_from(o, b);
    side bc = side_of(s, (edge + 1) % 3), ca = side_of(s, (edge + 2) % 3);
    side ad = side_of(o, (back + 1) % 3), db = side_of(o, (back + 2) % 3);
    *s = (constrained_triangle){.corners = {a, d, c}, .beyond = {NONE, other, NONE}};
    *o = (constrained_triangle){.corners = {d, b, c}, .beyond = {NONE, NONE, number}};
    put_side(t, number, 0, ad);
    put_side(t, number, 2, ca);
    put_side(t, other, 0, db);
    put_side(t, other, 1, bc);
    t->triangle_of[a] = t->triangle_of[d] = t->triangle_of[c] = number;
    t->triangle_of[b] = other;
    return true;
}

/* Is the sum of the angles at c and d above pi, so that edge ab between them is not Delaunay?
 * Rounded. */
static bool is_obtuse(const triangulator *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const double *p = t->sites.data[a].at, *q = t->sites.data[b].at;
    const double *r = t->sites.data[c].at, *s = t->sites.data[d].at;
    double ca[2] = {p[0] - r[0], p[1] - r[1]}, cb[2] = {q[0] - r[0], q[1] - r[1]};
    double da[2] = {p[0] - s[0], p[1] - s[1]}, db[2] = {q[0] - s[0], q[1] - s[1]};
    double sine_c = ca[0] * cb[1] - ca[1] * cb[0], cosine_c = ca[0] * cb[0] + ca[1] * cb[1];
    double sine_d = db[0] * da[1] - db[1] * da[0], cosine_d = da[0] * db[0] + da[1] * db[1];
    double sum = sine_c * cosine_d + cosine_c * sine_d;
    double most = fmax(fabs(sine_c), fabs(cosine_c)) * fmax(fabs(sine_d), fabs(cosine_d));
    return sum < -1e-10 * most;
}

static starg_status push_edges(triangulator *t, uint32_t number) {
    for (uint32_t k = 0; k < 3; k++)
        PUSH(t->context, STAGE, &t->stack, 4 * number + k);
    return STARG_OK;
}

static starg_status make_delaunay(triangulator *t) {
    t->stack.count = 0;
    for (uint32_t i = 0; i < t->triangles->count; i++)
        TRY(push_edges(t, i));
    while (t->stack.count > 0 && t->flips_left > 0) {
        uint32_t entry = t->stack.data[--t->stack.count], number = entry / 4;
        int edge = (int)(entry % 4);
        const constrained_triangle *it = at(t, number);
        uint32_t other = it->beyond[edge];
        if (other == NONE || it->fixed[edge] ||
            !is_obtuse(t, it->corners[edge], it->corners[(edge + 1) % 3],
                       it->corners[(edge + 2) % 3], opposite(t, it, edge)) ||
            !flip(t, number, edge))
            continue;
        t->flips_left--;
        TRY(push_edges(t, number));
        TRY(push_edges(t, other));
    }
    return STARG_OK;
}

/* ---- edges of the graph ---- */

/* The next triangle counter-clockwise about a site, or NONE. */
static uint32_t next_about(const triangulator *t, uint32_t number, uint32_t s) {
    const constrained_triangle *it = at(t, number);
    return it->beyond[(edge_from(it, s) + 2) % 3];
}

/* The first triangle around a site, clockwise, or any for an interior site. */
static uint32_t first_about(const triangulator *t, uint32_t s) {
    uint32_t start = t->triangle_of[s], number = start;
    for (;;) {
        const constrained_triangle *it = at(t, number);
        uint32_t former = it->beyond[edge_from(it, s)];
        if (former == NONE || former == start)
            return number;
        number = former;
    }
}

/* The triangle with an edge from a to b, or NONE. */
static uint32_t find_edge(const triangulator *t, uint32_t a, uint32_t b) {
    uint32_t first = first_about(t, a);
    for (uint32_t number = first; number != NONE;) {
        const constrained_triangle *it = at(t, number);
        if (it->corners[(edge_from(it, a) + 1) % 3] == b)
            return number;
        number = next_about(t, number, a);
        if (number == first)
            break;
    }
    return NONE;
}

/* The triangle at a that the segment to b enters, or NONE if a vertex lies on the segment. */
static uint32_t find_way(const triangulator *t, uint32_t a, uint32_t b) {
    uint32_t first = first_about(t, a);
    for (uint32_t number = first; number != NONE;) {
        const constrained_triangle *it = at(t, number);
        int k = edge_from(it, a);
        if (turn(t, a, it->corners[(k + 1) % 3], b) > 0 &&
            turn(t, a, it->corners[(k + 2) % 3], b) < 0)
            return number;
        number = next_about(t, number, a);
        if (number == first)
            break;
    }
    return NONE;
}

/* Lists the edges that cross segment a b. *clear is false when one of them belongs to the graph, or
 * a vertex lies on the segment. */
static starg_status list_crossed(triangulator *t, uint32_t a, uint32_t b, bool *clear) {
    uint32_t number = find_way(t, a, b);
    t->crossed.count = 0;
    *clear = number != NONE;
    if (!*clear)
        return STARG_OK;
    int edge = (edge_from(at(t, number), a) + 1) % 3;
    for (;;) {
        const constrained_triangle *it = at(t, number);
        uint32_t right = it->corners[edge], left = it->corners[(edge + 1) % 3];
        *clear = !it->fixed[edge] && it->beyond[edge] != NONE;
        if (!*clear)
            break;
        PUSH(t->context, STAGE, &t->crossed, right);
        PUSH(t->context, STAGE, &t->crossed, left);
        uint32_t far = opposite(t, it, edge);
        number = it->beyond[edge];
        int sign = far == b ? 0 : turn(t, a, b, far);
        if (sign == 0) {
            *clear = far == b;
            break;
        }
        /* continue through the edge whose endpoints lie on opposite sides of the segment */
        edge = edge_from(at(t, number), sign > 0 ? right : far);
    }
    return STARG_OK;
}

static bool is_between(const triangulator *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    return c != a && c != b && d != a && d != b && turn(t, a, b, c) * turn(t, a, b, d) < 0;
}

/* Flips crossing edges until none is left. Some edge can always be flipped; the others wait. */
static starg_status clear_way(triangulator *t, uint32_t a, uint32_t b, bool *done) {
    TRY(list_crossed(t, a, b, done));
    size_t waiting = 0;
    for (size_t i = 0; *done && i < t->crossed.count; i += 2) {
        uint32_t c = t->crossed.data[i], d = t->crossed.data[i + 1];
        uint32_t number = find_edge(t, c, d);
        int edge = number == NONE ? 0 : edge_from(at(t, number), c);
        *done = number != NONE && waiting <= t->crossed.count - i;
        if (!*done)
            break;
        uint32_t apex = at(t, number)->corners[(edge + 2) % 3];
        uint32_t far = opposite(t, at(t, number), edge);
        if (flip(t, number, edge)) {
            waiting = 0;
            if (!is_between(t, a, b, apex, far))
                continue;
            c = apex;
            d = far;
        } else {
            waiting += 2;
        }
        PUSH(t->context, STAGE, &t->crossed, c);
        PUSH(t->context, STAGE, &t->crossed, d);
    }
    return STARG_OK;
}

static void fix(const triangulator *t, uint32_t a, uint32_t b, int32_t turns) {
    uint32_t number = find_edge(t, a, b);
    if (number == NONE)
        return;
    constrained_triangle *it = at(t, number);
    int edge = edge_from(it, a);
    it->fixed[edge] = true;
    it->turns[edge] = turns;
}

static starg_status add_edge(triangulator *t, const constrained_edge *edge, bool *done) {
    uint32_t a = site_of(t, edge->from), b = site_of(t, edge->to);
    *done = a != b;
    if (*done && find_edge(t, a, b) == NONE && find_edge(t, b, a) == NONE)
        TRY(clear_way(t, a, b, done));
    if (!*done)
        return STARG_OK;
    fix(t, a, b, edge->turns);
    fix(t, b, a, -edge->turns);
    return STARG_OK;
}

/* All vertices are collinear: the graph may have edges, but no interior. */
static bool is_flat_graph(const constrained_edge *edges, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (edges[i].turns != 0)
            return false;
    return true;
}

static starg_status add_edges(triangulator *t, const constrained_edge *edges, size_t count,
                              bool *done) {
    TRY(make_delaunay(t));
    for (size_t i = 0; *done && i < count; i++)
        TRY(add_edge(t, &edges[i], done));
    if (*done)
        TRY(make_delaunay(t));
    return STARG_OK;
}

starg_status constrained_triangulate(starg_context *context, const double *points, int u, int v,
                                     const constrained_edge *edges, size_t edge_count,
                                     const uint32_t *loose, size_t loose_count,
                                     constrained_triangles *out, bool *done) {
    starg_status status = STARG_OK;
    triangulator t = {.context = context, .points = points, .u = u, .v = v, .triangles = out};
    out->count = 0;
    *done = true;
    STARG_TRY(find_sites(&t, edges, edge_count, loose, loose_count, done));
    if (!*done)
        goto done;
    STARG_TRY(triangulate_sites(&t));
    if (out->count > 0)
        STARG_TRY(add_edges(&t, edges, edge_count, done));
    else
        *done = is_flat_graph(edges, edge_count);
    for (size_t i = 0; i < 3 * out->count; i++) {
        uint32_t *corner = &out->data[i / 3].corners[i % 3];
        *corner = t.sites.data[*corner].vertex;
    }
done:
    RELEASE(t.sites.data, t.stack.data, t.crossed.data, t.by_vertex, t.next, t.before, t.outer,
            t.triangle_of);
    return status;
}
