/* SPDX-License-Identifier: Apache-2.0 */
/* Limbs of solids: the branches of their skeletons, and which ones correspond.
 *
 * Problem: two trees of limbs, with lengths and places. Pair limbs of one with limbs of the other,
 * each at most once, so that pairs which share a joint in one tree share it in the other.
 *
 * Method: a pair of joints or ends is chosen as roots, and limbs are paired outward from there. At
 * a pair of joints the limbs that lead on are assigned to each other, each with all that follows
 * it, by dynamic programming over sets of the second tree's limbs. What has no partner costs its
 * length; what has one costs the difference of lengths, and the distance of their ends, as places
 * in the two boxes. Lengths are shares of all limbs of a tree.
 *
 * Cost: O(n m d 2^d) for trees of n and m limbs with at most d <= BRANCHES at a joint. */
#include <stdlib.h>

#include "core/context.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/limbs.h"

static const char STAGE[] = "limbs";
enum { BRANCHES = 12 };              /* at a joint; further ones stay without partners */
static const double OFF_PLACE = 0.5; /* of a limb's length, for an end a box away */
static const double ROOT_OFF = 0.05; /* the same for roots, of the whole length */
static const double CAP = 0.25;      /* depth of all caps at a node, over its radius */
static const double NEAR = 1.5;      /* vertices of caps are that near to the node, in radii */
static const double ASIDE = 0.6;     /* cosine of their directions and those of other limbs */
static const double BENT = 1e-2;     /* sine by which neighbours of such a vertex are below it */

void limbs_free_tree(limb_tree *tree) {
    RELEASE(tree->nodes.data, tree->points.data, tree->limbs.data);
}

starg_status limbs_copy_tree(starg_context *context, const limb_tree *tree, limb_tree *out) {
    *out = *tree;
    out->context = context;
    memset(&out->nodes, 0, sizeof out->nodes);
    memset(&out->points, 0, sizeof out->points);
    memset(&out->limbs, 0, sizeof out->limbs);
    for (size_t i = 0; i < tree->nodes.count; i++)
        PUSH(context, STAGE, &out->nodes, tree->nodes.data[i]);
    for (size_t i = 0; i < tree->points.count; i++)
        PUSH(context, STAGE, &out->points, tree->points.data[i]);
    for (size_t i = 0; i < tree->limbs.count; i++)
        PUSH(context, STAGE, &out->limbs, tree->limbs.data[i]);
    return STARG_OK;
}

/* ---- the tree ---- */

/* What is left of a skeleton once it is a tree. */
typedef struct skeleton_walk {
    limb_tree *tree;
    starg_skeleton *skeleton;
    uint32_t *starts, *items; /* neighbours of node v: from starts[v] to starts[v + 1] */
    uint32_t *sets;           /* joints in one another's balls */
} skeleton_walk;

static void free_walk(skeleton_walk *w) {
    starg_skeleton_free(w->tree->context, w->skeleton);
    RELEASE(w->starts, w->items, w->sets);
}

static starg_status list_neighbours(skeleton_walk *w) {
    const starg_skeleton *s = w->skeleton;
    NEW_ZERO(w->tree->context, STAGE, w->starts, s->node_count + 2);
    NEW(w->tree->context, STAGE, w->items, 2 * s->edge_count);
    for (size_t i = 0; i < 2 * s->edge_count; i++)
        w->starts[s->edges[i] + 2]++;
    for (size_t v = 0; v < s->node_count; v++)
        w->starts[v + 2] += w->starts[v + 1];
    for (size_t i = 0; i < 2 * s->edge_count; i++)
        w->items[w->starts[s->edges[i] + 1]++] = s->edges[i ^ 1];
    return STARG_OK;
}

static size_t degree_of(const skeleton_walk *w, uint32_t v) {
    return w->starts[v + 1] - w->starts[v];
}

static starg_status add_point(limb_tree *tree, const double point[3]) {
    for (int k = 0; k < 3; k++)
        PUSH(tree->context, STAGE, &tree->points, point[k]);
    return STARG_OK;
}

static const double *point_at(const limb_tree *tree, size_t i) {
    return tree->points.data + 3 * i;
}

/* Follows the skeleton from a joint or end to the next one. Its nodes are those of the skeleton. */
static starg_status follow(skeleton_walk *w, uint32_t from, uint32_t next) {
    limb_tree *tree = w->tree;
    limb own = {.nodes = {from, next}, .first = tree->points.count / 3};
    uint32_t before = from;
    TRY(add_point(tree, w->skeleton->positions + 3 * (size_t)from));
    for (;;) {
        TRY(add_point(tree, w->skeleton->positions + 3 * (size_t)next));
        size_t last = tree->points.count / 3 - 1;
        own.length += vec3_distance(point_at(tree, last - 1), point_at(tree, last));
        if (degree_of(w, next) != 2)
            break;
        uint32_t first = w->items[w->starts[next]];
        uint32_t after = first != before ? first : w->items[w->starts[next] + 1];
        before = next;
        next = after;
    }
    own.nodes[1] = next;
    own.count = tree->points.count / 3 - own.first;
    if (from < next)
        PUSH(tree->context, STAGE, &tree->limbs, own);
    else
        tree->points.count = 3 * own.first;
    return STARG_OK;
}

/* Joints in one another's balls become one. */
static starg_status join_joints(skeleton_walk *w) {
    limb_tree *tree = w->tree;
    const double *radii = w->skeleton->radii;
    size_t kept = 0;
    NEW(tree->context, STAGE, w->sets, w->skeleton->node_count);
    sets_make(w->sets, w->skeleton->node_count);
    for (size_t i = 0; i < tree->limbs.count; i++) {
        const limb *own = &tree->limbs.data[i];
        bool joints = degree_of(w, own->nodes[0]) > 2 && degree_of(w, own->nodes[1]) > 2;
        if (joints && own->length < fmax(radii[own->nodes[0]], radii[own->nodes[1]]))
            sets_join(w->sets, own->nodes[0], own->nodes[1]);
        else
            tree->limbs.data[kept++] = *own;
    }
    tree->limbs.count = kept;
    return STARG_OK;
}

static uint32_t nearest_vertex(const starg_mesh *mesh, const double point[3]) {
    double least = INFINITY;
    uint32_t nearest = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double far = vec3_distance_squared(mesh->vertices + 3 * (size_t)v, point);
        if (far < least) {
            least = far;
            nearest = v;
        }
    }
    return nearest;
}

/* The largest radius of the skeleton that is about that far from an end. */
static double radius_near(const skeleton_walk *w, uint32_t end) {
    const starg_skeleton *s = w->skeleton;
    double radius = s->radii[end], length = 0;
    for (uint32_t before = end, v = w->items[w->starts[end]]; degree_of(w, v) == 2;) {
        length += vec3_distance(s->positions + 3 * (size_t)before, s->positions + 3 * (size_t)v);
        if (length > 2 * s->radii[v] && length > 2 * radius)
            break;
        radius = fmax(radius, s->radii[v]);
        uint32_t first = w->items[w->starts[v]];
        uint32_t after = first != before ? first : w->items[w->starts[v] + 1];
        before = v;
        v = after;
    }
    return radius;
}

static starg_status number_nodes(skeleton_walk *w) {
    limb_tree *tree = w->tree;
    const starg_skeleton *s = w->skeleton;
    SCOPED uint32_t *numbers = NULL;
    NEW(tree->context, STAGE, numbers, s->node_count);
    for (uint32_t v = 0; v < s->node_count; v++) {
        uint32_t root = sets_find(w->sets, v); /* the lowest */
        bool joint = degree_of(w, v) > 2;
        if (degree_of(w, v) == 2)
            continue;
        if (root == v) {
            limb_node node = {.radius = joint ? s->radii[v] : radius_near(w, v), .vertex = NOWHERE};
            vec3_copy(s->positions + 3 * (size_t)v, node.place);
            if (!joint)
                node.vertex = nearest_vertex(tree->mesh, node.place);
            PUSH(tree->context, STAGE, &tree->nodes, node);
            numbers[v] = (uint32_t)tree->nodes.count - 1;
        }
        numbers[v] = numbers[root];
        limb_node *node = &tree->nodes.data[numbers[v]];
        node->radius = fmax(node->radius, joint ? s->radii[v] : 0);
    }
    for (size_t i = 0; i < tree->limbs.count; i++)
        for (int k = 0; k < 2; k++) {
            limb *own = &tree->limbs.data[i];
            own->nodes[k] = numbers[own->nodes[k]];
            const limb_node *node = &tree->nodes.data[own->nodes[k]];
            own->radii[k] = node->vertex == NOWHERE ? node->radius : 0;
        }
    return STARG_OK;
}

starg_status limbs_find_tree(starg_context *context, const starg_solid *solid, limb_tree *out,
                             bool *found) {
    SCOPED_BY(free_walk) skeleton_walk w = {.tree = out};
    double upper[3];
    *out = (limb_tree){.context = context, .mesh = starg_solid_mesh(solid)};
    *found = false;
    TRY(starg_skeleton_create(context, solid, NULL, &w.skeleton));
    const starg_skeleton *s = w.skeleton;
    if (s->components != 1 || s->loops > 0 || s->edge_count == 0)
        return STARG_OK;
    TRY(list_neighbours(&w));
    for (uint32_t v = 0; v < s->node_count; v++)
        for (uint32_t i = w.starts[v]; i < w.starts[v + 1] && degree_of(&w, v) != 2; i++)
            TRY(follow(&w, v, w.items[i]));
    TRY(join_joints(&w));
    TRY(number_nodes(&w));
    for (size_t i = 0; i < out->limbs.count; i++)
        out->length += out->limbs.data[i].length;
    starg_mesh_bounds(out->mesh, out->lower, upper);
    vec3_subtract(upper, out->lower, out->extent);
    *found = out->limbs.count > 0 && out->length > 0;
    return STARG_OK;
}

/* ---- points of limbs ---- */

static void go_along(const limb_tree *tree, limb_way way, double distance, double out[3]) {
    const limb *own = &tree->limbs.data[way.limb];
    for (size_t i = 0; i + 1 < own->count; i++) {
        const double *p = point_at(tree, own->first + (way.back ? own->count - 1 - i : i));
        const double *q = point_at(tree, own->first + (way.back ? own->count - 2 - i : i + 1));
        double length = vec3_distance(p, q);
        if (distance < length || i + 2 == own->count) {
            double share = length > 0 ? fmin(fmax(distance / length, 0), 1) : 0;
            for (int k = 0; k < 3; k++)
                out[k] = (1 - share) * p[k] + share * q[k];
            return;
        }
        distance -= length;
    }
}

void limbs_point_at(const limb_tree *tree, limb_way way, double share, double point[3],
                    double direction[3]) {
    const double length = tree->limbs.data[way.limb].length, reach = 0.05 * length;
    double ends[2][3];
    go_along(tree, way, share * length, point);
    go_along(tree, way, share * length - reach, ends[0]);
    go_along(tree, way, share * length + reach, ends[1]);
    vec3_subtract(ends[1], ends[0], direction);
}

void limbs_mark_beyond(const limb_tree *tree, limb_way way, uint8_t *marks) {
    const limb *own = &tree->limbs.data[way.limb];
    uint32_t node = own->nodes[!way.back];
    marks[node] = 1;
    for (uint32_t i = 0; i < tree->limbs.count; i++)
        for (int back = 0; back < 2 && i != way.limb; back++)
            if (tree->limbs.data[i].nodes[back] == node && !marks[tree->limbs.data[i].nodes[!back]])
                limbs_mark_beyond(tree, (limb_way){i, back}, marks);
}

/* ---- pairs ---- */

/* A limb that has no partner at a pair of nodes. */
typedef struct lone_limb {
    int end;
    uint32_t way, node; /* of the other tree */
} lone_limb;

typedef struct pairing {
    starg_context *context;
    const limb_tree *trees;
    STARG_ARRAY(lone_limb) lone;
    number_list around[2]; /* ways that lead away from each node: 2 limb + back */
    number_list starts[2];
    double *costs; /* of pairs of ways, with all that follows; negative: not known yet */
} pairing;

static uint32_t node_before(const limb_tree *tree, uint32_t way) {
    return tree->limbs.data[way / 2].nodes[way & 1];
}

static uint32_t node_after(const limb_tree *tree, uint32_t way) {
    return tree->limbs.data[way / 2].nodes[1 - (way & 1)];
}

static double length_of(const pairing *p, int end, uint32_t way) {
    return p->trees[end].limbs.data[way / 2].length / p->trees[end].length;
}

/* Ways that lead on from a node, but not back over `from`. */
static size_t list_ways(const pairing *p, int end, uint32_t node, uint32_t from, uint32_t *out) {
    size_t count = 0;
    for (uint32_t i = p->starts[end].data[node]; i < p->starts[end].data[node + 1]; i++)
        if (p->around[end].data[i] / 2 != from && count < BRANCHES)
            out[count++] = p->around[end].data[i];
    return count;
}

/* The length of a limb and all that follows it. */
static double length_beyond(const pairing *p, int end, uint32_t way) {
    uint32_t ways[BRANCHES];
    double length = length_of(p, end, way);
    size_t count = list_ways(p, end, node_after(&p->trees[end], way), way / 2, ways);
    for (size_t i = 0; i < count; i++)
        length += length_beyond(p, end, ways[i]);
    return length;
}

/* How far apart two nodes are, each as a place in its box. */
static double place_off(const pairing *p, const uint32_t nodes[2]) {
    double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        double at[2];
        for (int end = 0; end < 2; end++) {
            const limb_tree *tree = &p->trees[end];
            double extent = tree->extent[k] > 0 ? tree->extent[k] : 1;
            at[end] = (tree->nodes.data[nodes[end]].place[k] - tree->lower[k]) / extent;
        }
        sum += (at[0] - at[1]) * (at[0] - at[1]);
    }
    return sqrt(sum);
}

static starg_status cost_of(pairing *p, const uint32_t ways[2], double *out);

/* Assigns the ways from two nodes to each other. partners[i]: an index into the second ones. */
static starg_status assign(pairing *p, const uint32_t nodes[2], const uint32_t from[2],
                           uint32_t ways[2][BRANCHES], size_t counts[2],
                           uint32_t partners[BRANCHES], double *cost) {
    SCOPED double *least = NULL;
    SCOPED uint8_t *chosen = NULL;
    double alone[2][BRANCHES], pairs[BRANCHES][BRANCHES];
    for (int end = 0; end < 2; end++) {
        counts[end] = list_ways(p, end, nodes[end], from[end], ways[end]);
        for (size_t i = 0; i < counts[end]; i++)
            alone[end][i] = length_beyond(p, end, ways[end][i]);
    }
    for (size_t i = 0; i < counts[0]; i++)
        for (size_t j = 0; j < counts[1]; j++) {
            const uint32_t both[2] = {ways[0][i], ways[1][j]};
            TRY(cost_of(p, both, &pairs[i][j]));
        }
    size_t sets = (size_t)1 << counts[1];
    NEW(p->context, STAGE, least, (counts[0] + 1) * sets);
    NEW_ZERO(p->context, STAGE, chosen, (counts[0] + 1) * sets);
    /* least[i, set]: for ways from the i-th on, with those of the set still free */
    for (size_t set = 0; set < sets; set++) {
        double *last = &least[counts[0] * sets + set];
        *last = 0;
        for (size_t j = 0; j < counts[1]; j++)
            *last += set >> j & 1 ? alone[1][j] : 0;
    }
    for (size_t i = counts[0]; i-- > 0;)
        for (size_t set = 0; set < sets; set++) {
            const double *next = least + (i + 1) * sets;
            double *own = &least[i * sets + set];
            *own = next[set] + alone[0][i];
            for (size_t j = 0; j < counts[1]; j++)
                if (set >> j & 1 && next[set ^ (size_t)1 << j] + pairs[i][j] < *own) {
                    *own = next[set ^ (size_t)1 << j] + pairs[i][j];
                    chosen[i * sets + set] = (uint8_t)(j + 1);
                }
        }
    *cost = least[sets - 1];
    for (size_t i = 0, set = sets - 1; i < counts[0]; i++) {
        uint8_t j = chosen[i * sets + set];
        partners[i] = j > 0 ? (uint32_t)j - 1 : NOWHERE;
        set ^= j > 0 ? (size_t)1 << (j - 1) : 0;
    }
    return STARG_OK;
}

static starg_status cost_of(pairing *p, const uint32_t ways[2], double *out) {
    uint32_t next[2][BRANCHES], partners[BRANCHES];
    size_t counts[2];
    double *known = &p->costs[ways[0] * 2 * p->trees[1].limbs.count + ways[1]], beyond;
    if (*known < 0) {
        const uint32_t nodes[2] = {node_after(&p->trees[0], ways[0]),
                                   node_after(&p->trees[1], ways[1])};
        const uint32_t from[2] = {ways[0] / 2, ways[1] / 2};
        double lengths[2] = {length_of(p, 0, ways[0]), length_of(p, 1, ways[1])};
        TRY(assign(p, nodes, from, next, counts, partners, &beyond));
        *known = fabs(lengths[0] - lengths[1]) +
                 OFF_PLACE * fmin(lengths[0], lengths[1]) * place_off(p, nodes) + beyond;
    }
    *out = *known;
    return STARG_OK;
}

/* Pairs of all limbs beyond two nodes, outward. */
static starg_status walk(pairing *p, const uint32_t nodes[2], const uint32_t from[2],
                         limb_pairs *out) {
    uint32_t ways[2][BRANCHES], partners[BRANCHES];
    size_t counts[2];
    double cost;
    TRY(assign(p, nodes, from, ways, counts, partners, &cost));
    for (size_t j = 0; j < counts[1]; j++) {
        bool taken = false;
        for (size_t i = 0; i < counts[0]; i++)
            taken = taken || partners[i] == j;
        if (!taken)
            PUSH(p->context, STAGE, &p->lone, ((lone_limb){1, ways[1][j], nodes[0]}));
    }
    for (size_t i = 0; i < counts[0]; i++) {
        if (partners[i] == NOWHERE) {
            PUSH(p->context, STAGE, &p->lone, ((lone_limb){0, ways[0][i], nodes[1]}));
            continue;
        }
        const uint32_t both[2] = {ways[0][i], ways[1][partners[i]]};
        const uint32_t next[2] = {node_after(&p->trees[0], both[0]),
                                  node_after(&p->trees[1], both[1])};
        const uint32_t over[2] = {both[0] / 2, both[1] / 2};
        PUSH(p->context, STAGE, out,
             ((limb_pair){{{over[0], both[0] & 1}, {over[1], both[1] & 1}}}));
        TRY(walk(p, next, over, out));
    }
    return STARG_OK;
}

static starg_status list_around(pairing *p, int end) {
    const limb_tree *tree = &p->trees[end];
    for (uint32_t node = 0; node <= tree->nodes.count; node++) {
        PUSH(p->context, STAGE, &p->starts[end], (uint32_t)p->around[end].count);
        for (uint32_t way = 0; way < 2 * tree->limbs.count; way++)
            if (node_before(tree, way) == node)
                PUSH(p->context, STAGE, &p->around[end], way);
    }
    return STARG_OK;
}

static void free_pairing(pairing *p) {
    for (int end = 0; end < 2; end++)
        RELEASE(p->around[end].data, p->starts[end].data);
    RELEASE(p->costs, p->lone.data);
}

/* ---- caps ---- */

/* Per vertex: its normal, of length 1 where all its neighbours are below it, else 0. */
static starg_status find_convex(const limb_tree *tree, double **out) {
    const starg_mesh *mesh = tree->mesh;
    SCOPED uint8_t *convex = NULL;
    NEW_ZERO(tree->context, STAGE, *out, 3 * mesh->vertex_count);
    NEW(tree->context, STAGE, convex, mesh->vertex_count);
    memset(convex, 1, mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->face_count; i++) {
        const uint32_t *face = mesh->faces + i / 3 * 3;
        double normal[3];
        vec3_triangle_normal(mesh->vertices + 3 * (size_t)face[0],
                             mesh->vertices + 3 * (size_t)face[1],
                             mesh->vertices + 3 * (size_t)face[2], normal);
        double *sum = *out + 3 * (size_t)mesh->faces[i];
        vec3_along(sum, 1, normal, sum);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        vec3_normalize(*out + 3 * v);
    for (size_t i = 0; i < 3 * mesh->face_count; i++) {
        uint32_t u = mesh->faces[i], v = mesh->faces[i % 3 == 2 ? i - 2 : i + 1];
        double way[3];
        vec3_subtract(mesh->vertices + 3 * (size_t)v, mesh->vertices + 3 * (size_t)u, way);
        if (!(vec3_dot(way, *out + 3 * (size_t)u) < -BENT * vec3_length(way)))
            convex[u] = 0;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        for (size_t k = 0; k < 3 && !convex[v]; k++)
            (*out)[3 * v + k] = 0;
    return STARG_OK;
}

/* Where a limb leads, from the node that it begins with: a unit vector. */
static void direction_of(const limb_tree *tree, uint32_t way, double out[3]) {
    double place[3];
    const limb *own = &tree->limbs.data[way / 2];
    const limb_node *node = &tree->nodes.data[own->nodes[way & 1]];
    go_along(tree, (limb_way){way / 2, way & 1}, fmin(2 * node->radius, own->length), place);
    vec3_subtract(place, node->place, out);
    vec3_normalize(out);
}

/* Adds a limb to a tree from below a convex vertex near a node, as far as possible in a direction,
 * but away from other limbs there. *found: there is such a vertex. */
static starg_status add_cap(limb_tree *tree, const double *normals, uint32_t at, double depth,
                            const double direction[3], bool *found) {
    const limb_node from = tree->nodes.data[at];
    const starg_mesh *mesh = tree->mesh;
    const double width = 2 * sqrt(2 * from.radius * depth); /* of a cap on a ball */
    double most = -INFINITY, foot[3];
    limb_node tip = {.radius = depth, .vertex = NOWHERE};
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->vertices + 3 * (size_t)v, *normal = normals + 3 * (size_t)v;
        double way[3], far = vec3_distance(p, from.place);
        bool free = vec3_dot(normal, normal) > 0 && far < NEAR * from.radius;
        if (!free)
            continue;
        vec3_subtract(p, from.place, way);
        vec3_normalize(way);
        for (uint32_t i = 0; i < 2 * tree->limbs.count && free; i++) {
            double other[3];
            if (node_before(tree, i) != at)
                continue;
            const limb_node *end = &tree->nodes.data[node_after(tree, i)];
            direction_of(tree, i, other);
            free = tree->limbs.data[i / 2].radii[i & 1] < 0
                       ? vec3_distance(p, end->place) > width
                       : from.vertex != NOWHERE || vec3_dot(way, other) < ASIDE;
        }
        double score = vec3_dot(way, direction) + vec3_dot(normal, direction);
        if (free && score > most) {
            most = score;
            tip.vertex = v;
        }
    }
    *found = tip.vertex != NOWHERE;
    if (!*found)
        return STARG_OK;
    vec3_copy(mesh->vertices + 3 * (size_t)tip.vertex, tip.place);
    vec3_along(tip.place, -depth, normals + 3 * (size_t)tip.vertex, foot);
    PUSH(tree->context, STAGE, &tree->nodes, tip);
    PUSH(tree->context, STAGE, &tree->limbs,
         ((limb){.nodes = {at, (uint32_t)tree->nodes.count - 1},
                 .first = tree->points.count / 3,
                 .count = 2,
                 .length = depth,
                 .radii = {-1, 0}}));
    TRY(add_point(tree, foot));
    return add_point(tree, tip.place);
}

static starg_status add_caps(pairing *p, limb_tree trees[2], limb_pairs *out) {
    SCOPED double *first = NULL, *second = NULL;
    TRY(find_convex(&trees[0], &first));
    TRY(find_convex(&trees[1], &second));
    for (size_t i = 0; i < p->lone.count; i++) {
        const lone_limb *own = &p->lone.data[i];
        int other = 1 - own->end;
        size_t beside = 0;
        for (size_t j = 0; j < p->lone.count; j++)
            beside += p->lone.data[j].end == own->end && p->lone.data[j].node == own->node;
        double direction[3];
        double depth = CAP * trees[other].nodes.data[own->node].radius / (double)beside;
        bool found;
        direction_of(&trees[own->end], own->way, direction);
        TRY(add_cap(&trees[other], other == 0 ? first : second, own->node, depth, direction,
                    &found));
        if (!found)
            continue;
        limb_pair pair = {.ways = {{0, false}, {0, false}}};
        pair.ways[own->end] = (limb_way){own->way / 2, own->way & 1};
        pair.ways[other] = (limb_way){(uint32_t)trees[other].limbs.count - 1, false};
        PUSH(p->context, STAGE, out, pair);
    }
    return STARG_OK;
}

starg_status limbs_pair(limb_tree trees[2], limb_pairs *out) {
    SCOPED_BY(free_pairing) pairing p = {.context = trees[0].context, .trees = trees};
    const uint32_t nowhere[2] = {NOWHERE, NOWHERE};
    size_t size = 4 * trees[0].limbs.count * trees[1].limbs.count;
    uint32_t roots[2] = {0, 0};
    double least = INFINITY;
    for (int end = 0; end < 2; end++)
        TRY(list_around(&p, end));
    NEW(p.context, STAGE, p.costs, size);
    for (size_t i = 0; i < size; i++)
        p.costs[i] = -1;
    for (uint32_t i = 0; i < trees[0].nodes.count; i++)
        for (uint32_t j = 0; j < trees[1].nodes.count; j++) {
            uint32_t ways[2][BRANCHES], partners[BRANCHES];
            const uint32_t nodes[2] = {i, j};
            size_t counts[2];
            double cost;
            TRY(assign(&p, nodes, nowhere, ways, counts, partners, &cost));
            cost += ROOT_OFF * place_off(&p, nodes);
            if (cost < least) {
                least = cost;
                roots[0] = i;
                roots[1] = j;
            }
        }
    TRY(walk(&p, roots, nowhere, out));
    return add_caps(&p, trees, out);
}
