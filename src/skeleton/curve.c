/* SPDX-License-Identifier: Apache-2.0 */
/* Resampling. The kept nodes form branches between joints and ends (a loop without either is one
 * branch from a node to itself). Each branch is smoothed and sampled at equal steps of arc length
 * over radius, so that thin parts have as many nodes for their width as thick ones. Joints stay,
 * ends move on to their last balls (ends.c), and branches get extra nodes where two edges would
 * otherwise join the same pair.
 *
 * Every position is tested exactly: one outside the solid is replaced by the nearest unsmoothed
 * one, which is known to be inside.
 *
 * Cost: linear, and some inside tests per node. */
#include "skeleton/skeleton.h"

#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "curve skeleton";

enum { TRAIL_PASSES = 10, NODE_PASSES = 3 };

/* A branch: a range of the trails, both special nodes included. */
typedef struct branch {
    size_t first, count;
    double length; /* in radii */
} branch;

typedef struct curve {
    starg_context *context;
    const starg_solid *solid;
    const medial_complex *complex;
    const curve_graph *graph;
    const pruned_graph *pruned;
    starg_skeleton *skeleton;
    double (*places)[3]; /* of kept nodes: strictly inside */
    bool *special;       /* joints, ends, isolated nodes, one node of each simple loop */
    bool *walked;        /* is it on a branch? */
    uint32_t *node_of;   /* skeleton node of each kept node */
    STARG_ARRAY(uint32_t) trails;
    STARG_ARRAY(branch) branches;
    double (*smooth)[3]; /* per entry of the trails */
    double *arcs;        /* arc length in radii from the start of its branch */
    double radius_floor;
    STARG_ARRAY(double) positions;
    STARG_ARRAY(uint32_t) edges;
} curve;

static uint32_t kept_degree(const curve *c, uint32_t v) {
    uint32_t degree = 0;
    for (uint32_t i = c->graph->first[v]; i < c->graph->first[v + 1]; i++)
        degree += c->pruned->kept[c->graph->next[i]];
    return degree;
}

/* Two links to one kept neighbour. */
static bool is_doubly_linked(const curve *c, uint32_t v) {
    for (uint32_t i = c->graph->first[v]; i < c->graph->first[v + 1]; i++)
        for (uint32_t j = c->graph->first[v]; j < i; j++)
            if (c->graph->next[i] == c->graph->next[j] && c->pruned->kept[c->graph->next[i]])
                return true;
    return false;
}

/* Copies a place from a neighbour that has one inside. Otherwise the neighbours are searched next;
 * returns true then too. */
static bool borrow_place(curve *c, bool *placed, bool *tried, uint32_t v) {
    bool spread = false;
    for (uint32_t i = c->graph->first[v]; i < c->graph->first[v + 1]; i++) {
        uint32_t w = c->graph->next[i];
        if (!placed[w])
            placed[w] = !tried[w] && starg_solid_contains(c->solid, c->places[w]);
        spread = spread || !tried[w];
        tried[w] = true;
        if (placed[w]) {
            vec3_copy(c->places[w], c->places[v]);
            return placed[v] = true;
        }
    }
    return spread;
}

/* Branches entirely outside, as on self-intersecting surfaces, collapse to a place inside. */
static starg_status place_rest(curve *c, const bool *placed) {
    size_t count = c->graph->node_count, some = 0;
    while (some < count && !placed[some])
        some++;
    if (some == count)
        return starg_fail(c->context, STARG_ERROR_MESH, STAGE,
                          "the solid is too thin to hold a point in double precision");
    for (size_t v = 0; v < count; v++)
        if (c->pruned->kept[v] && !placed[v])
            vec3_copy(c->places[some], c->places[v]);
    return STARG_OK;
}

/* Replaces centres that rounding put outside (of extremely flat tetrahedra) by those of
 * neighbours. */
static starg_status place_kept(curve *c) {
    SCOPED bool *placed = NULL, *tried = NULL;
    bool changed = true;
    size_t count = c->graph->node_count, missing = 0;
    NEW(c->context, STAGE, c->places, count);
    NEW_ZERO(c->context, STAGE, placed, count);
    NEW_ZERO(c->context, STAGE, tried, count);
    for (size_t v = 0; v < count; v++) {
        vec3_copy(c->complex->centres[v], c->places[v]);
        tried[v] = c->pruned->kept[v];
        placed[v] = tried[v] && starg_solid_contains(c->solid, c->places[v]);
        missing += c->pruned->kept[v] && !placed[v];
    }
    while (missing > 0 && changed) {
        changed = false;
        for (uint32_t v = 0; v < count; v++)
            if (tried[v] && !placed[v] && borrow_place(c, placed, tried, v)) {
                missing -= placed[v] && c->pruned->kept[v];
                changed = true;
            }
    }
    if (missing > 0)
        TRY(place_rest(c, placed));
    return STARG_OK;
}

/* The kept neighbour of v other than `from`. */
static uint32_t step_on(const curve *c, uint32_t v, uint32_t from) {
    for (uint32_t i = c->graph->first[v]; i < c->graph->first[v + 1]; i++)
        if (c->graph->next[i] != from && c->pruned->kept[c->graph->next[i]])
            return c->graph->next[i];
    return EDGE_NONE;
}

/* Follows a branch from the special node v by its neighbour w. Each branch is met from both ends
 * and kept once. */
static starg_status walk(curve *c, uint32_t v, uint32_t w) {
    branch found = {.first = c->trails.count};
    uint32_t from = v, at = w;
    PUSH(c->context, STAGE, &c->trails, v);
    while (!c->special[at]) {
        PUSH(c->context, STAGE, &c->trails, at);
        c->walked[at] = true;
        uint32_t next = step_on(c, at, from);
        from = at;
        at = next;
    }
    PUSH(c->context, STAGE, &c->trails, at);
    found.count = c->trails.count - found.first;
    if (v < at || (v == at && w < from))
        PUSH(c->context, STAGE, &c->branches, found);
    else
        c->trails.count = found.first;
    return STARG_OK;
}

static starg_status walk_from(curve *c, uint32_t v) {
    c->walked[v] = true;
    for (uint32_t i = c->graph->first[v]; i < c->graph->first[v + 1]; i++)
        if (c->pruned->kept[c->graph->next[i]])
            TRY(walk(c, v, c->graph->next[i]));
    return STARG_OK;
}

static starg_status find_branches(curve *c) {
    size_t count = c->graph->node_count;
    NEW_ZERO(c->context, STAGE, c->special, count);
    NEW_ZERO(c->context, STAGE, c->walked, count);
    for (uint32_t v = 0; v < count; v++)
        c->special[v] = c->pruned->kept[v] && (kept_degree(c, v) != 2 || is_doubly_linked(c, v));
    for (uint32_t v = 0; v < count; v++)
        if (c->special[v])
            TRY(walk_from(c, v));
    for (uint32_t v = 0; v < count; v++)
        if (c->pruned->kept[v] && !c->walked[v]) {
            c->special[v] = true;
            TRY(walk_from(c, v));
        }
    return STARG_OK;
}

/* Repeatedly moves the inner points of a trail halfway to the midpoint of their neighbours. On a
 * loop without joints all are inner points. */
static void smooth_trail(curve *c, const branch *b) {
    double(*p)[3] = c->smooth + b->first;
    size_t end = b->count - 1;
    uint32_t v = c->trails.data[b->first];
    bool loop = v == c->trails.data[b->first + end] && kept_degree(c, v) == 2;
    for (size_t i = 0; i < b->count; i++)
        vec3_copy(c->places[c->trails.data[b->first + i]], p[i]);
    for (int pass = 0; pass < TRAIL_PASSES; pass++) {
        double last[3], start[3];
        vec3_copy(p[loop ? end - 1 : 0], last);
        vec3_copy(p[!loop], start);
        for (size_t i = !loop; i < end; i++) {
            const double *next = loop && i + 1 == end ? start : p[i + 1];
            for (int k = 0; k < 3; k++) {
                double here = p[i][k];
                p[i][k] = 0.5 * here + 0.25 * last[k] + 0.25 * next[k];
                last[k] = here;
            }
        }
        if (loop)
            vec3_copy(p[0], p[end]);
    }
    if (loop && starg_solid_contains(c->solid, p[0]))
        vec3_copy(p[0], c->places[v]);
}

/* The ends of a smooth trail move on to their last balls. */
static void advance_ends(curve *c, const branch *b) {
    for (int side = 0; side < 2; side++) {
        size_t last = b->first + (side == 0 ? 0 : b->count - 1);
        uint32_t v = c->trails.data[last];
        if (kept_degree(c, v) == 1) {
            ends_advance(c->solid, c->smooth, last, side == 0 ? 1 : -1, b->count);
            vec3_copy(c->smooth[last], c->places[v]);
        }
    }
}

static void measure_trail(curve *c, branch *b) {
    c->arcs[b->first] = 0;
    for (size_t i = b->first + 1; i < b->first + b->count; i++) {
        double radius = 0.5 * c->complex->radii[c->trails.data[i]] +
                        0.5 * c->complex->radii[c->trails.data[i - 1]];
        double step = vec3_distance(c->smooth[i], c->smooth[i - 1]) / fmax(radius, c->radius_floor);
        c->arcs[i] = c->arcs[i - 1] + (isfinite(step) ? step : 0);
    }
    b->length = c->arcs[b->first + b->count - 1];
}

/* Balls at tips may be arbitrarily small; steps shrink down to a twentieth of the mean. */
static double mean_radius(const curve *c) {
    double sum = 0;
    size_t count = 0;
    for (size_t v = 0; v < c->graph->node_count; v++)
        if (c->pruned->kept[v]) {
            count++;
            sum += c->complex->radii[v];
        }
    return sum / (double)count;
}

static starg_status prepare_trails(curve *c) {
    NEW(c->context, STAGE, c->smooth, c->trails.count);
    NEW(c->context, STAGE, c->arcs, c->trails.count);
    c->radius_floor = 0.05 * mean_radius(c);
    for (size_t i = 0; i < c->branches.count; i++) {
        smooth_trail(c, &c->branches.data[i]);
        advance_ends(c, &c->branches.data[i]);
        measure_trail(c, &c->branches.data[i]);
    }
    return STARG_OK;
}

static starg_status push_node(curve *c, const double p[3], uint32_t *node) {
    *node = (uint32_t)(c->positions.count / 3);
    for (int k = 0; k < 3; k++)
        PUSH(c->context, STAGE, &c->positions, p[k]);
    return STARG_OK;
}

static starg_status push_edge(curve *c, uint32_t a, uint32_t b) {
    PUSH(c->context, STAGE, &c->edges, a);
    PUSH(c->context, STAGE, &c->edges, b);
    return STARG_OK;
}

static starg_status take_special(curve *c) {
    NEW(c->context, STAGE, c->node_of, c->graph->node_count);
    for (size_t v = 0; v < c->graph->node_count; v++)
        if (c->special[v])
            TRY(push_node(c, c->places[v], &c->node_of[v]));
    return STARG_OK;
}

/* Number of nodes between the special ones of a branch. */
static size_t inner_count(const curve *c, const branch *b, double step) {
    uint32_t v = c->trails.data[b->first], w = c->trails.data[b->first + b->count - 1];
    size_t least = v == w ? 2 : kept_degree(c, v) > 1 && kept_degree(c, w) > 1;
    double steps = step > 0 ? b->length / step : 0;
    size_t count = steps > 1.5 ? (size_t)(steps + 0.5) - 1 : 0;
    return count > least ? count : least;
}

/* The point at `arc` after entry i of the trails, or the entry's own place if that is outside. */
static void point_at(const curve *c, size_t i, double arc, double p[3]) {
    double gap = c->arcs[i + 1] - c->arcs[i];
    double t = gap > 0 ? (arc - c->arcs[i]) / gap : 0.5;
    for (int k = 0; k < 3; k++)
        p[k] = (1 - t) * c->smooth[i][k] + t * c->smooth[i + 1][k];
    if (!starg_solid_contains(c->solid, p))
        vec3_copy(c->places[c->trails.data[t < 0.5 ? i : i + 1]], p);
}

/* Places the nodes of a branch and assigns each of its kept nodes to the nearest one. */
static starg_status place_branch(curve *c, const branch *b, double step) {
    size_t inner = inner_count(c, b, step), at = b->first, last = b->first + b->count - 1;
    uint32_t base = (uint32_t)(c->positions.count / 3), node = 0;
    uint32_t first_node = c->node_of[c->trails.data[b->first]];
    uint32_t last_node = c->node_of[c->trails.data[last]], previous = first_node;
    for (size_t k = 1; k <= inner; k++) {
        double p[3], arc = b->length * (double)k / (double)(inner + 1);
        while (at + 1 < last && c->arcs[at + 1] <= arc)
            at++;
        point_at(c, at, arc, p);
        TRY(push_node(c, p, &node));
        TRY(push_edge(c, previous, node));
        previous = node;
    }
    TRY(push_edge(c, previous, last_node));
    for (size_t i = b->first + 1; i < last; i++) {
        double share = b->length > 0 ? c->arcs[i] / b->length : 0;
        size_t k = (size_t)(share * (double)(inner + 1) + 0.5);
        c->node_of[c->trails.data[i]] = k == 0      ? first_node
                                        : k > inner ? last_node
                                                    : base + (uint32_t)k - 1;
    }
    return STARG_OK;
}

static starg_status place_branches(curve *c, size_t wanted) {
    double total = 0;
    for (size_t i = 0; i < c->branches.count; i++)
        total += c->branches.data[i].length;
    for (size_t i = 0; i < c->branches.count; i++) {
        TRY(starg_check_cancel(c->context, STAGE));
        TRY(place_branch(c, &c->branches.data[i], total / (double)wanted));
    }
    return STARG_OK;
}

/* Moves nodes of degree two towards the midpoint of their neighbours if that is inside. */
static starg_status smooth_nodes(curve *c) {
    size_t count = c->positions.count / 3;
    SCOPED uint32_t(*neighbours)[2] = NULL, *degrees = NULL;
    double *p = c->positions.data, moved[3];
    NEW(c->context, STAGE, neighbours, count);
    NEW_ZERO(c->context, STAGE, degrees, count);
    for (size_t e = 0; e < c->edges.count; e++) {
        uint32_t v = c->edges.data[e];
        if (degrees[v] < 2)
            neighbours[v][degrees[v]] = c->edges.data[e ^ 1];
        degrees[v]++;
    }
    for (int pass = 0; pass < NODE_PASSES; pass++)
        for (size_t v = 0; v < count; v++) {
            if (degrees[v] != 2)
                continue;
            const double *a = p + 3 * (size_t)neighbours[v][0],
                         *b = p + 3 * (size_t)neighbours[v][1];
            for (size_t k = 0; k < 3; k++)
                moved[k] = 0.5 * p[3 * v + k] + 0.25 * a[k] + 0.25 * b[k];
            if (starg_solid_contains(c->solid, moved))
                vec3_copy(moved, p + 3 * v);
        }
    return STARG_OK;
}

static uint32_t nearest_node(const curve *c, const double p[3]) {
    size_t best = 0;
    for (size_t v = 1; v < c->positions.count / 3; v++)
        if (vec3_distance_squared(p, c->positions.data + 3 * v) <
            vec3_distance_squared(p, c->positions.data + 3 * best))
            best = v;
    return (uint32_t)best;
}

/* A vertex belongs to the largest ball through it (its inner pole [Amenta, Choi, Kolluri 2001]),
 * the ball to the kept node it was pruned to, and that one to the nearest node on its branch.
 * Vertices without a ball use the nearest node. */
static starg_status assign_vertices(curve *c) {
    const medial_complex *complex = c->complex;
    const starg_mesh *mesh = c->solid->mesh;
    SCOPED uint32_t *pole = NULL;
    NEW(c->context, STAGE, pole, mesh->vertex_count);
    NEW(c->context, STAGE, c->skeleton->vertex_nodes, mesh->vertex_count);
    memset(pole, 0xff, mesh->vertex_count * sizeof *pole);
    for (size_t t = 0; t < complex->tetrahedron_count; t++) {
        uint32_t n = complex->node_of[t];
        for (int k = 0; c->pruned->kept[c->pruned->owner[n]] && k < 4; k++) {
            uint32_t v = complex->corners[t][k];
            if (v < mesh->vertex_count &&
                (pole[v] == EDGE_NONE || complex->radii[n] > complex->radii[pole[v]]))
                pole[v] = n;
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        c->skeleton->vertex_nodes[v] = pole[v] == EDGE_NONE
                                           ? nearest_node(c, mesh->vertices + 3 * v)
                                           : c->node_of[c->pruned->owner[pole[v]]];
    c->skeleton->vertex_count = mesh->vertex_count;
    return STARG_OK;
}

static starg_status finish(curve *c) {
    starg_skeleton *skeleton = c->skeleton;
    skeleton->node_count = c->positions.count / 3;
    skeleton->edge_count = c->edges.count / 2;
    NEW(c->context, STAGE, skeleton->radii, skeleton->node_count);
    for (size_t v = 0; v < skeleton->node_count; v++)
        skeleton->radii[v] = starg_solid_distance(c->solid, c->positions.data + 3 * v);
    skeleton->positions = c->positions.data;
    skeleton->edges = c->edges.data;
    c->positions.data = NULL;
    c->edges.data = NULL;
    return STARG_OK;
}

starg_status curve_create(starg_context *context, const starg_solid *solid,
                          const medial_complex *complex, const curve_graph *graph,
                          const pruned_graph *pruned, size_t wanted, starg_skeleton *skeleton) {
    starg_status status = STARG_OK;
    curve c = {.context = context,
               .solid = solid,
               .complex = complex,
               .graph = graph,
               .pruned = pruned,
               .skeleton = skeleton};
    STARG_TRY(place_kept(&c));
    STARG_TRY(find_branches(&c));
    STARG_TRY(prepare_trails(&c));
    STARG_TRY(take_special(&c));
    STARG_TRY(place_branches(&c, wanted));
    STARG_TRY(smooth_nodes(&c));
    STARG_TRY(assign_vertices(&c));
    STARG_TRY(finish(&c));
done:
    RELEASE(c.places, c.special, c.walked, c.node_of, c.smooth, c.arcs, c.trails.data,
            c.branches.data, c.positions.data, c.edges.data);
    return status;
}
