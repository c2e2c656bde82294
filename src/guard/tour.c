/* SPDX-License-Identifier: Apache-2.0 */
/* Guards in the order of a short tour: a way through all of them, one after the other, that passes
 * through no face.
 *
 * Stages:
 *   1. a graph of ways: its nodes are the guards and other candidates, where ways may bend. Nodes
 *      are joined along segments that meet no face: guards with all others that they see, each node
 *      with those among the nearest that it sees, and then, pair by pair in the order of their
 *      distance, nodes between which there is no way yet, with a new node between if need be;
 *   2. shortest ways in it between all guards, each by a run of Dijkstra's algorithm. Where there
 * is none, the straight segment counts as longer than any tour, so that few such legs are used;
 *   3. a short path through all guards: nearest neighbours from several starts, each improved by
 *      turning stretches round (2-opt) and by moving up to three guards elsewhere (Or-opt) until
 *      neither shortens it; the shortest one is taken;
 *   4. the way of each leg is pulled tight: bends that can be left out are, others move towards the
 *      straight line as far as nothing comes between.
 *
 * Invariant: each segment of a leg that is not listed as blocked meets no face; exact.
 * Cost: with G guards and N nodes O(N^2 log N + G (N + E) log N + G^2 for each improving round),
 * and about a microsecond for each segment tested, of which there are some 24 N + G^2 / 2. */
#include <math.h>
#include <stdlib.h>

#include "geometry/intersect.h"
#include "geometry/vec3.h"
#include "guard/stages.h"
#include "mesh/levels/heap.h"

static const char STAGE[] = "tour";

enum {
    MOST_BENDS = 2000, /* candidates among the nodes */
    NEAREST = 24,      /* nodes to which each is joined, if it sees them */
    DETOURS = 32,      /* places tried as a bend between two nodes */
    MOST_DETOURS = 16, /* for each node, pairs for which they are */
    ROUNDS = 3,        /* of new nodes */
    START_WORK = 4096, /* starts times guards */
    SWEEPS = 8,        /* of pulling a way tight */
    HALVINGS = 6,      /* of a move that something blocks */
    MOST_MOVED = 3     /* guards that move together */
};

typedef struct edge {
    uint32_t from, to;
    double length;
} edge;

typedef STARG_ARRAY(edge) edge_list;
typedef STARG_ARRAY(double) way_points; /* three each */

typedef struct ways {
    starg_context *context;
    const bvh *tree;
    size_t guards, count; /* nodes; guards come first */
    way_points places;    /* count of them */
    edge_list edges;      /* both directions, by their first node */
    size_t *first;        /* by node: its first edge; count + 1 */
    mesh_heap *heap;
    double *distance; /* of the last run, by node; INFINITY: no way */
    uint32_t *before; /* on the way there: the node before */
} ways;

static void ways_free(ways *w) {
    RELEASE(w->places.data, w->edges.data, w->first, w->distance, w->before);
    heap_free(w->heap);
}

static const double *place(const ways *w, size_t node) {
    return w->places.data + 3 * node;
}

/* ---- segments ---- */

typedef struct segment {
    const bvh *tree;
    const double *p, *q;
} segment;

static bool passes(void *user, size_t rank) {
    const segment *s = user;
    const uint32_t *corner = s->tree->faces + 3 * (size_t)s->tree->order[rank];
    return !segment_meets_triangle(s->p, s->q, s->tree->vertices + 3 * (size_t)corner[0],
                                   s->tree->vertices + 3 * (size_t)corner[1],
                                   s->tree->vertices + 3 * (size_t)corner[2]);
}

/* Does the segment meet no face? q itself is known to be on none. */
static bool is_free(const ways *w, const double p[3], const double q[3]) {
    segment s = {w->tree, p, q};
    return bvh_query_segment(w->tree, p, q, passes, &s);
}

/* ---- 1. the graph ---- */

static starg_status add_node(ways *w, const double p[3]) {
    for (int x = 0; x < 3; x++)
        PUSH(w->context, STAGE, &w->places, p[x]);
    w->count++;
    return STARG_OK;
}

static starg_status take_nodes(const guard_problem *problem, const guard_outcome *outcome,
                               ways *w) {
    const guard_pool *pool = &outcome->pool;
    size_t bends = pool_count(pool) < MOST_BENDS ? pool_count(pool) : MOST_BENDS;
    w->context = problem->context;
    w->tree = problem->solid->tree;
    w->guards = outcome->selection.chosen.count;
    for (size_t i = 0; i < w->guards; i++)
        TRY(add_node(w, pool_point(pool, outcome->selection.chosen.data[i])));
    for (size_t i = 0; i < bends; i++) /* evenly from all of them */
        TRY(add_node(w, pool_point(pool, i * pool_count(pool) / bends)));
    return STARG_OK;
}

static starg_status join(ways *w, uint32_t a, uint32_t b) {
    double length = vec3_distance(place(w, a), place(w, b));
    PUSH(w->context, STAGE, &w->edges, ((edge){a, b, length}));
    PUSH(w->context, STAGE, &w->edges, ((edge){b, a, length}));
    return STARG_OK;
}

static int by_length(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->length != y->length)
        return x->length < y->length ? -1 : 1;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return (x->to > y->to) - (x->to < y->to);
}

static int by_node(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return by_length(a, b);
}

static starg_status join_guards(ways *w) {
    for (uint32_t a = 0; a < w->guards; a++)
        for (uint32_t b = a + 1; b < w->guards; b++)
            if (is_free(w, place(w, a), place(w, b)))
                TRY(join(w, a, b));
    return STARG_OK;
}

static starg_status join_near(ways *w) {
    SCOPED edge *others = NULL;
    NEW(w->context, STAGE, others, w->count);
    for (uint32_t a = 0; a < w->count; a++) {
        size_t count = 0;
        for (uint32_t b = 0; b < w->count; b++)
            if (b != a)
                others[count++] = (edge){a, b, vec3_distance(place(w, a), place(w, b))};
        qsort(others, count, sizeof *others, by_length);
        for (size_t k = 0; k < count && k < NEAREST; k++)
            if (is_free(w, place(w, a), place(w, others[k].to)))
                TRY(join(w, a, others[k].to));
        TRY(starg_check_cancel(w->context, STAGE));
    }
    return STARG_OK;
}

static uint32_t root_of(uint32_t *parent, uint32_t node) {
    while (parent[node] != node)
        node = parent[node] = parent[parent[node]];
    return node;
}

/* Digits of the number behind the point, in reverse order. */
static double radical_inverse(unsigned number, unsigned base) {
    double value = 0, digit = 1;
    for (; number > 0; number /= base)
        value += (digit /= base) * (number % base);
    return value;
}

/* A place near both nodes from which both can be reached on straight ways becomes a node. */
static starg_status find_detour(ways *w, uint32_t a, uint32_t b, bool *found) {
    const double *p = place(w, a), *q = place(w, b);
    double reach = vec3_distance(p, q), bend[3];
    *found = false;
    for (unsigned k = 1; k <= DETOURS && !*found; k++) {
        for (int x = 0; x < 3; x++)
            bend[x] = (p[x] + q[x]) / 2 + reach * (2 * radical_inverse(k, x + 2 + x / 2) - 1);
        *found = is_free(w, bend, p) && is_free(w, bend, q);
    }
    if (!*found)
        return STARG_OK;
    TRY(add_node(w, bend));
    TRY(join(w, a, (uint32_t)w->count - 1));
    return join(w, b, (uint32_t)w->count - 1);
}

/* Parts of the graph grow together wherever two of their nodes see each other; failing that, where
 * there is a place that both see. */
static starg_status join_parts(ways *w, bool *grown) {
    SCOPED uint32_t *parent = NULL;
    SCOPED edge_list pairs = {0};
    size_t left = MOST_DETOURS * w->count, before = w->count;
    NEW(w->context, STAGE, parent, w->count);
    for (uint32_t i = 0; i < w->count; i++)
        parent[i] = i;
    for (size_t i = 0; i < w->edges.count; i++)
        parent[root_of(parent, w->edges.data[i].from)] = root_of(parent, w->edges.data[i].to);
    for (uint32_t a = 0; a < w->count; a++)
        for (uint32_t b = a + 1; b < w->count; b++)
            if (root_of(parent, a) != root_of(parent, b))
                PUSH(w->context, STAGE, &pairs,
                     ((edge){a, b, vec3_distance(place(w, a), place(w, b))}));
    qsort(pairs.data, pairs.count, sizeof *pairs.data, by_length);
    for (size_t i = 0; i < 2 * pairs.count && left > 0; i++) {
        const edge *pair = &pairs.data[i % pairs.count];
        uint32_t a = root_of(parent, pair->from), b = root_of(parent, pair->to);
        bool joined = false;
        if (i % 1024 == 0)
            TRY(starg_check_cancel(w->context, STAGE));
        if (a == b)
            continue;
        if (i >= pairs.count) {
            TRY(find_detour(w, pair->from, pair->to, &joined));
            left--;
        } else if (is_free(w, place(w, pair->from), place(w, pair->to))) {
            TRY(join(w, pair->from, pair->to));
            joined = true;
        }
        if (joined)
            parent[a] = b;
    }
    *grown = w->count > before;
    return STARG_OK;
}

static starg_status make_graph(ways *w) {
    bool grown = true;
    TRY(join_guards(w));
    TRY(join_near(w));
    for (int round = 0; round < ROUNDS && grown; round++)
        TRY(join_parts(w, &grown));
    qsort(w->edges.data, w->edges.count, sizeof *w->edges.data, by_node);
    NEW(w->context, STAGE, w->distance, w->count);
    NEW(w->context, STAGE, w->before, w->count);
    TRY(heap_create(w->context, w->count, &w->heap));
    NEW_ZERO(w->context, STAGE, w->first, w->count + 1);
    for (size_t i = 0; i < w->edges.count; i++)
        w->first[w->edges.data[i].from + 1]++;
    for (size_t i = 0; i < w->count; i++)
        w->first[i + 1] += w->first[i];
    return STARG_OK;
}

/* ---- 2. shortest ways ---- */

static void find_ways(ways *w, uint32_t from) {
    uint32_t node = 0;
    for (size_t i = 0; i < w->count; i++)
        w->distance[i] = INFINITY;
    w->distance[from] = 0;
    heap_set(w->heap, from, 0);
    while (heap_pop(w->heap, &node))
        for (size_t i = w->first[node]; i < w->first[node + 1]; i++) {
            const edge *e = &w->edges.data[i];
            double length = w->distance[node] + e->length;
            if (length >= w->distance[e->to])
                continue;
            w->distance[e->to] = length;
            w->before[e->to] = node;
            heap_set(w->heap, e->to, length);
        }
}

/* Between guards, `far` more where there is no way. */
static starg_status find_lengths(ways *w, double **out) {
    double far = 0;
    NEW(w->context, STAGE, *out, w->guards * w->guards);
    for (size_t a = 0; a < w->guards; a++)
        for (size_t b = 0; b < a; b++)
            far += vec3_distance(place(w, a), place(w, b));
    for (uint32_t a = 0; a < w->guards; a++) {
        TRY(starg_check_cancel(w->context, STAGE));
        find_ways(w, a);
        for (size_t b = 0; b < w->guards; b++)
            (*out)[a * w->guards + b] = isfinite(w->distance[b])
                                            ? w->distance[b]
                                            : far + vec3_distance(place(w, a), place(w, b));
    }
    for (size_t a = 0; a < w->guards; a++) /* sums of both directions may differ by rounding */
        for (size_t b = 0; b < a; b++)
            (*out)[b * w->guards + a] = (*out)[a * w->guards + b];
    return STARG_OK;
}

/* ---- 3. a short path ---- */

typedef struct path {
    size_t count;
    const double *lengths; /* count x count */
    uint32_t *order;
    uint32_t *room; /* count */
} path;

/* Between positions of the path; beyond its ends all is near. */
static double gap(const path *p, size_t i, size_t j) {
    if (i >= p->count || j >= p->count)
        return 0;
    return p->lengths[p->order[i] * p->count + p->order[j]];
}

static double length_of(const path *p) {
    double length = 0;
    for (size_t i = 0; i + 1 < p->count; i++)
        length += gap(p, i, i + 1);
    return length;
}

static void turn_round(path *p, size_t i, size_t j) {
    for (; i < j; i++, j--) {
        uint32_t other = p->order[i];
        p->order[i] = p->order[j];
        p->order[j] = other;
    }
}

static void follow_nearest(path *p, uint32_t start) {
    for (uint32_t i = 0; i < p->count; i++)
        p->order[i] = i;
    turn_round(p, 0, start);
    for (size_t i = 0; i + 1 < p->count; i++) {
        size_t best = i + 1;
        for (size_t j = i + 2; j < p->count; j++)
            if (gap(p, i, j) < gap(p, i, best))
                best = j;
        uint32_t other = p->order[i + 1];
        p->order[i + 1] = p->order[best];
        p->order[best] = other;
    }
}

/* Turns stretches from i to j round. Position 0 - 1 wraps to one beyond the end. */
static bool turn_stretches(path *p, double least) {
    bool any = false;
    for (size_t i = 0; i + 1 < p->count; i++)
        for (size_t j = i + 1; j < p->count; j++)
            if (gap(p, i - 1, i) + gap(p, j, j + 1) - gap(p, i - 1, j) - gap(p, i, j + 1) > least) {
                turn_round(p, i, j);
                any = true;
            }
    return any;
}

static void put_elsewhere(path *p, size_t i, size_t count, size_t right, bool turned) {
    size_t end = i + count, to = right > i ? right - count : right;
    memcpy(p->room, p->order + i, count * sizeof *p->room);
    memmove(p->order + i, p->order + end, (p->count - end) * sizeof *p->order);
    memmove(p->order + to + count, p->order + to, (p->count - count - to) * sizeof *p->order);
    for (size_t m = 0; m < count; m++)
        p->order[to + m] = p->room[turned ? count - 1 - m : m];
}

/* Moves a few neighbours, either way round, to between positions `right` - 1 and `right`. */
static bool move_few(path *p, double least) {
    for (size_t count = 1; count <= MOST_MOVED && count < p->count; count++)
        for (size_t i = 0, last = count - 1; last < p->count; i++, last++) {
            double gain = gap(p, i - 1, i) + gap(p, last, last + 1) - gap(p, i - 1, last + 1);
            for (size_t right = 0; right <= p->count; right++) {
                if (right >= i && right <= last + 1)
                    continue;
                for (int turned = 0; turned < 2; turned++) {
                    double cost = gap(p, right - 1, turned ? last : i) +
                                  gap(p, turned ? i : last, right) - gap(p, right - 1, right);
                    if (gain - cost > least) {
                        put_elsewhere(p, i, count, right, turned);
                        return true;
                    }
                }
            }
        }
    return false;
}

static starg_status find_path(starg_context *context, const double *lengths, size_t count,
                              uint32_t *order) {
    SCOPED uint32_t *tried = NULL, *room = NULL;
    NEW(context, STAGE, tried, count);
    NEW(context, STAGE, room, count);
    path p = {count, lengths, tried, room};
    size_t starts = START_WORK / count < 1 ? 1 : START_WORK / count;
    double best = INFINITY;
    starts = starts < count ? starts : count;
    for (size_t s = 0; s < starts; s++) {
        follow_nearest(&p, (uint32_t)(s * count / starts));
        double least = 1e-12 * length_of(&p);
        while (turn_stretches(&p, least) || move_few(&p, least))
            TRY(starg_check_cancel(context, STAGE));
        if (length_of(&p) < best) {
            best = length_of(&p);
            memcpy(order, tried, count * sizeof *order);
        }
    }
    return STARG_OK;
}

/* ---- 4. legs ---- */

/* Leaves out bends: each point is followed by the last one that it sees. */
static void shorten(const ways *w, double *p, size_t *count) {
    size_t kept = 1;
    for (size_t i = 0; i + 1 < *count; kept++) {
        size_t next = *count - 1;
        while (next > i + 1 && !is_free(w, p + 3 * (kept - 1), p + 3 * next))
            next--;
        memmove(p + 3 * kept, p + 3 * next, 3 * sizeof *p);
        i = next;
    }
    *count = kept;
}

/* Moves a bend towards the point of the segment a c that is nearest to it. */
static void straighten(const ways *w, const double a[3], double b[3], const double c[3]) {
    double along[3], from[3], share, moved[3];
    vec3_subtract(c, a, along);
    vec3_subtract(b, a, from);
    share = vec3_dot(from, along) / vec3_dot(along, along);
    share = share > 0 ? fmin(share, 1) : 0;
    for (double step = 1, k = 0; k < HALVINGS; k++, step /= 2) {
        for (int x = 0; x < 3; x++)
            moved[x] = b[x] + step * (a[x] + share * along[x] - b[x]);
        if (is_free(w, moved, a) && is_free(w, moved, c)) {
            vec3_copy(moved, b);
            return;
        }
    }
}

static void pull_tight(const ways *w, double *p, size_t *count) {
    shorten(w, p, count);
    for (int sweep = 0; sweep<SWEEPS && * count> 2; sweep++) {
        for (size_t i = 1; i + 1 < *count; i++)
            straighten(w, p + 3 * (i - 1), p + 3 * i, p + 3 * (i + 1));
        shorten(w, p, count);
    }
}

/* The way from guard a to b, without a itself. */
static starg_status find_leg(ways *w, uint32_t a, uint32_t b, way_points *out, bool *blocked) {
    SCOPED way_points leg = {0};
    find_ways(w, b);
    *blocked = !isfinite(w->distance[a]);
    for (uint32_t node = a;; node = *blocked ? b : w->before[node]) {
        for (int x = 0; x < 3; x++)
            PUSH(w->context, STAGE, &leg, place(w, node)[x]);
        if (node == b)
            break;
    }
    size_t count = leg.count / 3;
    if (!*blocked)
        pull_tight(w, leg.data, &count);
    for (size_t i = 3; i < 3 * count; i++)
        PUSH(w->context, STAGE, out, leg.data[i]);
    return STARG_OK;
}

static starg_status find_legs(ways *w, const uint32_t *order, starg_tour *tour) {
    SCOPED way_points points = {0};
    NEW(w->context, STAGE, tour->stops, w->guards);
    NEW(w->context, STAGE, tour->blocked, w->guards);
    for (int x = 0; x < 3; x++)
        PUSH(w->context, STAGE, &points, place(w, order[0])[x]);
    tour->stops[0] = 0;
    for (size_t i = 1; i < w->guards; i++) {
        bool blocked = false;
        TRY(starg_check_cancel(w->context, STAGE));
        TRY(find_leg(w, order[i - 1], order[i], &points, &blocked));
        tour->stops[i] = (uint32_t)(points.count / 3 - 1);
        if (blocked)
            tour->blocked[tour->blocked_count++] = (uint32_t)(i - 1);
    }
    for (size_t i = 3; i < points.count; i += 3)
        tour->length += vec3_distance(points.data + i - 3, points.data + i);
    tour->stop_count = w->guards;
    tour->point_count = points.count / 3;
    tour->points = points.data;
    points.data = NULL;
    return STARG_OK;
}

static starg_status put_in_order(starg_context *context, const uint32_t *order,
                                 guard_selection *selection) {
    SCOPED_BY(selection_free) guard_selection former = {0};
    TRY(selection_copy(context, selection, &former));
    for (size_t i = 0; i < selection->chosen.count; i++) {
        selection->chosen.data[i] = former.chosen.data[order[i]];
        selection->levels.data[i] = former.levels.data[order[i]];
    }
    return STARG_OK;
}

starg_status tour_find(const guard_problem *problem, guard_outcome *outcome) {
    SCOPED_BY(ways_free) ways w = {0};
    SCOPED double *lengths = NULL;
    SCOPED uint32_t *order = NULL;
    if (!problem->options->order || outcome->selection.chosen.count == 0)
        return STARG_OK;
    IN_STAGE(problem->context, STAGE);
    TIME_RULE(problem->context, STARG_TIME_IGNORED);
    TRY(take_nodes(problem, outcome, &w));
    TRY(make_graph(&w));
    TRY(find_lengths(&w, &lengths));
    NEW(w.context, STAGE, order, w.guards);
    TRY(find_path(w.context, lengths, w.guards, order));
    TRY(find_legs(&w, order, &outcome->tour));
    return put_in_order(w.context, order, &outcome->selection);
}
