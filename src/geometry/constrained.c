/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a planar straight-line graph, and the flips of any such mesh.
 *
 * Problem: triangulate given vertices such that given edges are edges of the triangulation.
 *
 * Flips: an edge that is missing is made by flipping the edges that cross it until none does [Sloan
 * 1993]; those whose quadrangle is not convex wait for others. This works on any points whose turns
 * are decided exactly: doubles here, rational points in mesh/union/triangulation.c.
 *
 * Stages, in doubles: insert the vertices in lexicographic order, each joined to the hull edges
 * that it sees; flip edges until all are locally Delaunay [Lawson 1977]; make the missing edges of
 * the graph; restore the Delaunay property, leaving the graph's edges alone.
 *
 * Invariants: every triangle is counter-clockwise, exactly, at all times: a flip requires that of
 * both its triangles; twins are mutual. The Delaunay test is rounded, since it affects only
 * quality; a bound on the flips ensures termination.
 *
 * Cost: O(n log n) for sorting, usually about n sqrt(n) flips; an edge costs the square of those
 * that cross it at worst. */
#include "geometry/constrained.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "geometry/predicates.h"

static const char STAGE[] = "triangulate";
static const uint32_t NONE = PLANAR_NONE;

enum { FLIPS_EACH = 400 /* upper bound per triangle */, CHECK_EACH = 1024 };

/* ---- a mesh of part of a plane ---- */

void planar_clear(planar *m) {
    m->corner.count = m->twin.count = m->mark.count = 0;
}

void planar_free(planar *m) {
    RELEASE(m->corner.data, m->twin.data, m->mark.data, m->at.data, m->crossed.data);
}

static int turn(const planar *m, uint32_t a, uint32_t b, uint32_t c) {
    return m->turn(m->points, a, b, c);
}

starg_status planar_add(planar *m, uint32_t *triangle) {
    *triangle = (uint32_t)(m->corner.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(m->context, m->stage, &m->corner, NONE);
        PUSH(m->context, m->stage, &m->twin, NONE);
        PUSH(m->context, m->stage, &m->mark, NONE);
    }
    return STARG_OK;
}

void planar_set(planar *m, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corner[3] = {a, b, c};
    for (uint32_t k = 0; k < 3; k++) {
        m->corner.data[3 * triangle + k] = corner[k];
        m->at.data[corner[k]] = 3 * triangle + k;
    }
    m->last = triangle;
}

void planar_link(planar *m, uint32_t h, uint32_t twin, uint32_t mark) {
    m->twin.data[h] = twin;
    m->mark.data[h] = mark;
    if (twin == NONE)
        return;
    m->twin.data[twin] = h;
    m->mark.data[twin] = mark;
}

bool planar_can_flip(const planar *m, uint32_t h) {
    uint32_t g = m->twin.data[h];
    if (g == NONE || m->mark.data[h] != NONE)
        return false;
    uint32_t a = planar_start(m, h), b = planar_end(m, h);
    uint32_t c = planar_tip(m, h), d = planar_tip(m, g);
    return turn(m, a, d, c) > 0 && turn(m, d, b, c) > 0;
}

void planar_flip(planar *m, uint32_t h) {
    uint32_t g = m->twin.data[h], one = h / 3, two = g / 3;
    uint32_t a = planar_start(m, h), b = planar_end(m, h);
    uint32_t c = planar_tip(m, h), d = planar_tip(m, g);
    const planar_rim bc = planar_rim_of(m, planar_next(h)),
                     ca = planar_rim_of(m, planar_previous(h));
    const planar_rim ad = planar_rim_of(m, planar_next(g)),
                     db = planar_rim_of(m, planar_previous(g));
    planar_set(m, one, a, d, c);
    planar_set(m, two, d, b, c);
    planar_link(m, 3 * one, ad.twin, ad.mark);
    planar_link(m, 3 * one + 2, ca.twin, ca.mark);
    planar_link(m, 3 * two, db.twin, db.mark);
    planar_link(m, 3 * two + 1, bc.twin, bc.mark);
    planar_link(m, 3 * one + 1, 3 * two + 2, NONE);
}

/* The first halfedge from a vertex, clockwise; any for one that is not on the border. */
static uint32_t planar_first(const planar *m, uint32_t vertex) {
    uint32_t start = m->at.data[vertex], h = start;
    while (m->twin.data[h] != NONE && planar_next(m->twin.data[h]) != start)
        h = planar_next(m->twin.data[h]);
    return h;
}

uint32_t planar_find(const planar *m, uint32_t a, uint32_t b) {
    const uint32_t first = planar_first(m, a);
    for (uint32_t h = first; h != NONE;) {
        if (planar_end(m, h) == b)
            return h;
        h = planar_around(m, h);
        if (h == first)
            break;
    }
    return NONE;
}

starg_status planar_march(planar *m, uint32_t h, uint32_t a, uint32_t b, uint32_t *target,
                          uint32_t *blocked) {
    m->crossed.count = 0;
    for (;;) {
        bool stop = m->mark.data[h] != NONE || m->twin.data[h] == NONE;
        *blocked = stop ? h : NONE;
        if (stop)
            return STARG_OK;
        uint64_t edge = (uint64_t)planar_start(m, h) << 32 | planar_end(m, h);
        PUSH(m->context, m->stage, &m->crossed, edge);
        h = m->twin.data[h];
        *target = planar_tip(m, h);
        int side = *target == b ? 0 : turn(m, a, b, *target);
        if (side == 0)
            return STARG_OK;
        /* through the edge whose ends lie on opposite sides of the way */
        h = side > 0 ? planar_next(h) : planar_previous(h);
    }
    return STARG_OK;
}

/* Does the way from a to b cross the edge c d? They have no vertex on each other. */
static bool crosses(const planar *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    bool apart = c != a && c != b && d != a && d != b;
    return apart && turn(m, a, b, c) * turn(m, a, b, d) < 0;
}

starg_status planar_flip_away(planar *m, uint32_t a, uint32_t b, bool dice, bool *done) {
    size_t waiting = 0;
    *done = true;
    for (size_t i = 0; i < m->crossed.count; i++) {
        uint64_t edge = m->crossed.data[i];
        uint32_t h = planar_find(m, (uint32_t)(edge >> 32), (uint32_t)edge);
        *done = h != NONE && (dice || waiting <= m->crossed.count - i);
        if (!*done)
            return STARG_OK;
        bool possible = planar_can_flip(m, h), again = false;
        if (possible) {
            uint32_t c = planar_tip(m, h), d = planar_tip(m, m->twin.data[h]);
            again = crosses(m, a, b, c, d);
            if (!again || !dice || starg_hash64(i) % 2 == 0) {
                planar_flip(m, h);
                edge = (uint64_t)c << 32 | d;
            }
        }
        waiting = possible ? 0 : waiting + 1;
        if (!possible || again)
            PUSH(m->context, m->stage, &m->crossed, edge);
        if (i % CHECK_EACH == CHECK_EACH - 1)
            TRY(starg_check_cancel(m->context, m->stage));
    }
    return STARG_OK;
}

/* ---- a graph in doubles ---- */

typedef struct site {
    double at[2];
    uint32_t vertex;
} site;

/* Vertices of the mesh are numbers of sites, marks those of edges of the graph. */
typedef struct triangulator {
    starg_context *context;
    const constrained_graph *graph;
    planar mesh;
    STARG_ARRAY(site) sites; /* in lexicographic order */
    uint32_t *by_vertex;     /* sites by vertex */
    uint32_t *next, *before; /* neighbours of a site on the hull, counter-clockwise */
    uint32_t *outer;         /* of such a site: the halfedge on the hull that starts there */
    STARG_ARRAY(uint32_t) stack;
    uint64_t flips_left;
} triangulator;

static int turn_of_sites(const void *points, uint32_t a, uint32_t b, uint32_t c) {
    const triangulator *t = points;
    const double *p[3];
    const uint32_t sites[3] = {a, b, c};
    for (int k = 0; k < 3; k++)
        p[k] = t->graph->points + 3 * (size_t)t->sites.data[sites[k]].vertex;
    return orient2d(p[0], p[1], p[2], t->graph->u, t->graph->v);
}

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
    const double *q = t->graph->points + 3 * (size_t)vertex;
    const site fresh = {{q[t->graph->u], q[t->graph->v]}, vertex};
    PUSH(t->context, STAGE, &t->sites, fresh);
    return STARG_OK;
}

/* Vertices with their site numbers, ascending. */
static int by_first(const void *x, const void *y) {
    const uint32_t *a = x, *b = y;
    return compare_numbers(a[0], b[0]);
}

static starg_status find_sites(triangulator *t, bool *done) {
    const constrained_graph *graph = t->graph;
    size_t kept = 0;
    for (size_t i = 0; i < graph->edge_count; i++) {
        TRY(add_site(t, graph->edges[i].from));
        TRY(add_site(t, graph->edges[i].to));
    }
    for (size_t i = 0; i < graph->loose_count; i++)
        TRY(add_site(t, graph->loose[i]));
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

/* ---- the hull ---- */

static starg_status add_triangle(triangulator *t, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t number;
    TRY(planar_add(&t->mesh, &number));
    planar_set(&t->mesh, number, a, b, c);
    return STARG_OK;
}

static void link_hull(triangulator *t, uint32_t a, uint32_t b, uint32_t h) {
    t->next[a] = b;
    t->before[b] = a;
    t->outer[a] = h;
}

/* The first sites are collinear: makes a fan around the first site off their line. */
static starg_status start_hull(triangulator *t, uint32_t apex) {
    bool left = turn(&t->mesh, 0, 1, apex) > 0;
    for (uint32_t i = 0; i + 1 < apex; i++) {
        TRY(add_triangle(t, left ? i : i + 1, left ? i + 1 : i, apex));
        /* edges: along the line, then to the apex and from it */
        if (i > 0)
            planar_link(&t->mesh, 3 * i + (left ? 2 : 1), 3 * (i - 1) + (left ? 1 : 2), NONE);
        if (left)
            link_hull(t, i, i + 1, 3 * i);
        else
            link_hull(t, i + 1, i, 3 * i);
    }
    uint32_t last = 3 * (apex - 2);
    link_hull(t, left ? apex - 1 : apex, left ? apex : apex - 1, last + (left ? 1 : 2));
    link_hull(t, left ? apex : 0, left ? 0 : apex, left ? 2 : 1);
    return STARG_OK;
}

/* Joins a new site to the hull edges that it sees; they are adjacent to the last site inserted. */
static starg_status extend_hull(triangulator *t, uint32_t fresh) {
    uint32_t from = fresh - 1, to = fresh - 1, first = (uint32_t)t->mesh.corner.count;
    while (turn(&t->mesh, t->before[from], from, fresh) < 0)
        from = t->before[from];
    while (turn(&t->mesh, to, t->next[to], fresh) < 0)
        to = t->next[to];
    for (uint32_t s = from; s != to; s = t->next[s]) {
        uint32_t h = (uint32_t)t->mesh.corner.count;
        TRY(add_triangle(t, t->next[s], s, fresh));
        planar_link(&t->mesh, h, t->outer[s], NONE);
        if (h > first)
            planar_link(&t->mesh, h + 1, h - 1, NONE);
    }
    link_hull(t, from, fresh, first + 1);
    link_hull(t, fresh, to, (uint32_t)t->mesh.corner.count - 1);
    return STARG_OK;
}

static starg_status triangulate_sites(triangulator *t) {
    uint32_t count = (uint32_t)t->sites.count, apex = 2;
    NEW(t->context, STAGE, t->next, count);
    NEW(t->context, STAGE, t->before, count);
    NEW(t->context, STAGE, t->outer, count);
    NEW(t->context, STAGE, t->mesh.at.data, count);
    while (apex < count && turn(&t->mesh, 0, 1, apex) == 0)
        apex++;
    if (apex >= count)
        return STARG_OK;
    TRY(start_hull(t, apex));
    for (uint32_t s = apex + 1; s < count; s++)
        TRY(extend_hull(t, s));
    t->flips_left = (uint64_t)FLIPS_EACH * (t->mesh.corner.count / 3);
    return STARG_OK;
}

/* ---- Delaunay ---- */

/* Is the sum of the angles at both tips above pi, so that the edge is not Delaunay? Rounded. */
static bool is_obtuse(const triangulator *t, uint32_t h, uint32_t g) {
    const double *p = t->sites.data[planar_start(&t->mesh, h)].at;
    const double *q = t->sites.data[planar_end(&t->mesh, h)].at;
    const double *r = t->sites.data[planar_tip(&t->mesh, h)].at;
    const double *s = t->sites.data[planar_tip(&t->mesh, g)].at;
    double ca[2] = {p[0] - r[0], p[1] - r[1]}, cb[2] = {q[0] - r[0], q[1] - r[1]};
    double da[2] = {p[0] - s[0], p[1] - s[1]}, db[2] = {q[0] - s[0], q[1] - s[1]};
    double sine_c = ca[0] * cb[1] - ca[1] * cb[0], cosine_c = ca[0] * cb[0] + ca[1] * cb[1];
    double sine_d = db[0] * da[1] - db[1] * da[0], cosine_d = da[0] * db[0] + da[1] * db[1];
    double sum = sine_c * cosine_d + cosine_c * sine_d;
    double most = fmax(fabs(sine_c), fabs(cosine_c)) * fmax(fabs(sine_d), fabs(cosine_d));
    return sum < -1e-10 * most;
}

static starg_status push_edges(triangulator *t, uint32_t triangle) {
    for (uint32_t k = 0; k < 3; k++)
        PUSH(t->context, STAGE, &t->stack, 3 * triangle + k);
    return STARG_OK;
}

static starg_status make_delaunay(triangulator *t) {
    planar *m = &t->mesh;
    t->stack.count = 0;
    for (uint32_t i = 0; i < m->corner.count / 3; i++)
        TRY(push_edges(t, i));
    while (t->stack.count > 0 && t->flips_left > 0) {
        uint32_t h = t->stack.data[--t->stack.count], g = m->twin.data[h];
        if (g == NONE || m->mark.data[h] != NONE || !is_obtuse(t, h, g) || !planar_can_flip(m, h))
            continue;
        planar_flip(m, h);
        t->flips_left--;
        TRY(push_edges(t, h / 3));
        TRY(push_edges(t, g / 3));
    }
    return STARG_OK;
}

/* ---- edges of the graph ---- */

/* The first edge that the way from a to b crosses, or NONE if a vertex lies on the way. */
static uint32_t find_way(const planar *m, uint32_t a, uint32_t b) {
    const uint32_t first = planar_first(m, a);
    for (uint32_t h = first; h != NONE;) {
        if (turn(m, a, planar_end(m, h), b) > 0 && turn(m, a, planar_tip(m, h), b) < 0)
            return planar_next(h);
        h = planar_around(m, h);
        if (h == first)
            break;
    }
    return NONE;
}

/* *done is false when another edge of the graph crosses, or a vertex lies on the edge. */
static starg_status clear_way(planar *m, uint32_t a, uint32_t b, bool *done) {
    uint32_t h = find_way(m, a, b), target, blocked;
    *done = h != NONE;
    if (!*done)
        return STARG_OK;
    TRY(planar_march(m, h, a, b, &target, &blocked));
    *done = blocked == NONE && target == b;
    return *done ? planar_flip_away(m, a, b, false, done) : STARG_OK;
}

static starg_status add_edge(triangulator *t, uint32_t number, bool *done) {
    const constrained_edge *edge = &t->graph->edges[number];
    planar *m = &t->mesh;
    uint32_t a = site_of(t, edge->from), b = site_of(t, edge->to);
    *done = a != b;
    if (*done && planar_find(m, a, b) == NONE && planar_find(m, b, a) == NONE)
        TRY(clear_way(m, a, b, done));
    if (!*done)
        return STARG_OK;
    uint32_t h = planar_find(m, a, b);
    if (h == NONE)
        h = planar_find(m, b, a);
    if (h != NONE)
        planar_link(m, h, m->twin.data[h], number);
    return STARG_OK;
}

/* All vertices are collinear: the graph may have edges, but no interior. */
static bool is_flat(const constrained_graph *graph) {
    for (size_t i = 0; i < graph->edge_count; i++)
        if (graph->edges[i].turns != 0)
            return false;
    return true;
}

static starg_status add_edges(triangulator *t, bool *done) {
    TRY(make_delaunay(t));
    for (uint32_t i = 0; *done && i < t->graph->edge_count; i++)
        TRY(add_edge(t, i, done));
    return *done ? make_delaunay(t) : STARG_OK;
}

static starg_status take_triangles(const triangulator *t, constrained_triangles *out) {
    const planar *m = &t->mesh;
    for (uint32_t i = 0; i < m->corner.count; i += 3) {
        constrained_triangle fresh = {.beyond = {NONE, NONE, NONE}};
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t twin = m->twin.data[i + k], mark = m->mark.data[i + k];
            fresh.corners[k] = t->sites.data[m->corner.data[i + k]].vertex;
            fresh.beyond[k] = twin == NONE ? NONE : twin / 3;
            fresh.fixed[k] = mark != NONE;
            if (mark == NONE)
                continue;
            const constrained_edge *edge = &t->graph->edges[mark];
            fresh.turns[k] = edge->from == fresh.corners[k] ? edge->turns : -edge->turns;
        }
        PUSH(t->context, STAGE, out, fresh);
    }
    return STARG_OK;
}

starg_status constrained_triangulate(starg_context *context, const constrained_graph *graph,
                                     constrained_triangles *out, bool *done) {
    starg_status status = STARG_OK;
    triangulator t = {.context = context,
                      .graph = graph,
                      .mesh = {.context = context, .stage = STAGE, .turn = turn_of_sites}};
    t.mesh.points = &t;
    out->count = 0;
    *done = true;
    STARG_TRY(find_sites(&t, done));
    if (!*done)
        goto done;
    STARG_TRY(triangulate_sites(&t));
    if (t.mesh.corner.count > 0)
        STARG_TRY(add_edges(&t, done));
    else
        *done = is_flat(graph);
    STARG_TRY(take_triangles(&t, out));
done:
    planar_free(&t.mesh);
    RELEASE(t.sites.data, t.stack.data, t.by_vertex, t.next, t.before, t.outer);
    return status;
}
