/* SPDX-License-Identifier: Apache-2.0 */
/* Limbs of solids: the branches of their skeletons, and which ones correspond.
 *
 * Problem: two trees of limbs, with lengths and places. Pair limbs of one with limbs of the other,
 * each at most once, so that pairs which share a joint in one tree share it in the other.
 *
 * Method: a pair of joints or ends is chosen as roots, and limbs are paired outward from there. At
 * a pair of joints the limbs that lead on are assigned to each other, each with all that follows
 * it, by dynamic programming over sets of the second tree's limbs. What has no partner costs its
 * length; what has one costs the difference of lengths, and the distance of their ends, as places in
 * the two boxes. Lengths are shares of all limbs of a tree.
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

void limbs_free_tree(limb_tree *tree) {
    starg_skeleton_free(tree->context, tree->skeleton);
    RELEASE(tree->node_of, tree->places, tree->radii, tree->steps.data, tree->limbs.data);
}

/* ---- the tree ---- */

typedef struct neighbours {
    uint32_t *starts, *items; /* of node v: from starts[v] to starts[v + 1] */
} neighbours;

static starg_status list_neighbours(const limb_tree *tree, neighbours *out) {
    const starg_skeleton *s = tree->skeleton;
    NEW_ZERO(tree->context, STAGE, out->starts, s->node_count + 2);
    NEW(tree->context, STAGE, out->items, 2 * s->edge_count);
    for (size_t i = 0; i < 2 * s->edge_count; i++)
        out->starts[s->edges[i] + 2]++;
    for (size_t v = 0; v < s->node_count; v++)
        out->starts[v + 2] += out->starts[v + 1];
    for (size_t i = 0; i < 2 * s->edge_count; i++)
        out->items[out->starts[s->edges[i] + 1]++] = s->edges[i ^ 1];
    return STARG_OK;
}

static void free_neighbours(neighbours *n) {
    RELEASE(n->starts, n->items);
}

static size_t degree_of(const neighbours *n, uint32_t v) {
    return n->starts[v + 1] - n->starts[v];
}

static const double *node_at(const limb_tree *tree, uint32_t v) {
    return tree->skeleton->positions + 3 * (size_t)v;
}

/* Follows the skeleton from a joint or end to the next one. */
static starg_status follow(limb_tree *tree, const neighbours *n, uint32_t from, uint32_t next) {
    limb own = {.nodes = {from, next}, .first = tree->steps.count};
    uint32_t before = from;
    PUSH(tree->context, STAGE, &tree->steps, from);
    for (;;) {
        PUSH(tree->context, STAGE, &tree->steps, next);
        own.length += vec3_distance(node_at(tree, before), node_at(tree, next));
        if (degree_of(n, next) != 2)
            break;
        uint32_t first = n->items[n->starts[next]];
        uint32_t after = first != before ? first : n->items[n->starts[next] + 1];
        before = next;
        next = after;
    }
    own.nodes[1] = next;
    own.count = tree->steps.count - own.first;
    if (from < next)
        PUSH(tree->context, STAGE, &tree->limbs, own);
    else
        tree->steps.count = own.first;
    return STARG_OK;
}

/* Joints in one another's balls become one; numbers what is left. */
static starg_status number_nodes(limb_tree *tree, const neighbours *n) {
    const starg_skeleton *s = tree->skeleton;
    SCOPED uint32_t *sets = NULL;
    size_t kept = 0;
    NEW(tree->context, STAGE, sets, s->node_count);
    sets_make(sets, s->node_count);
    for (size_t i = 0; i < tree->limbs.count; i++) {
        const limb *own = &tree->limbs.data[i];
        double radius = fmax(s->radii[own->nodes[0]], s->radii[own->nodes[1]]);
        bool joints = degree_of(n, own->nodes[0]) > 2 && degree_of(n, own->nodes[1]) > 2;
        if (joints && own->length < radius)
            sets_join(sets, own->nodes[0], own->nodes[1]);
        else
            tree->limbs.data[kept++] = *own;
    }
    tree->limbs.count = kept;
    NEW(tree->context, STAGE, tree->node_of, s->node_count);
    NEW_ZERO(tree->context, STAGE, tree->places, 3 * s->node_count);
    NEW_ZERO(tree->context, STAGE, tree->radii, s->node_count);
    memset(tree->node_of, 0xff, s->node_count * sizeof *tree->node_of);
    for (uint32_t v = 0; v < s->node_count; v++)
        if (degree_of(n, v) != 2 && sets_find(sets, v) == v) {
            vec3_copy(node_at(tree, v), tree->places + 3 * tree->node_count);
            tree->node_of[v] = (uint32_t)tree->node_count++;
        }
    for (uint32_t v = 0; v < s->node_count; v++)
        if (degree_of(n, v) != 2) {
            tree->node_of[v] = tree->node_of[sets_find(sets, v)];
            double *radius = &tree->radii[tree->node_of[v]];
            *radius = degree_of(n, v) > 2 ? fmax(*radius, s->radii[v]) : 0;
        }
    for (size_t i = 0; i < tree->limbs.count; i++)
        for (int k = 0; k < 2; k++)
            tree->limbs.data[i].nodes[k] = tree->node_of[tree->limbs.data[i].nodes[k]];
    return STARG_OK;
}

starg_status limbs_find_tree(starg_context *context, const starg_solid *solid, limb_tree *out,
                             bool *found) {
    SCOPED_BY(free_neighbours) neighbours n = {0};
    double upper[3];
    *out = (limb_tree){.context = context};
    *found = false;
    TRY(starg_skeleton_create(context, solid, NULL, &out->skeleton));
    const starg_skeleton *s = out->skeleton;
    if (s->components != 1 || s->loops > 0 || s->edge_count == 0)
        return STARG_OK;
    TRY(list_neighbours(out, &n));
    for (uint32_t v = 0; v < s->node_count; v++)
        for (uint32_t i = n.starts[v]; i < n.starts[v + 1] && degree_of(&n, v) != 2; i++)
            TRY(follow(out, &n, v, n.items[i]));
    TRY(number_nodes(out, &n));
    for (size_t i = 0; i < out->limbs.count; i++)
        out->length += out->limbs.data[i].length;
    starg_mesh_bounds(starg_solid_mesh(solid), out->lower, upper);
    vec3_subtract(upper, out->lower, out->extent);
    *found = out->limbs.count > 0 && out->length > 0;
    return STARG_OK;
}

/* ---- points of limbs ---- */

static const double *step_at(const limb_tree *tree, limb_way way, size_t i) {
    const limb *own = &tree->limbs.data[way.limb];
    return node_at(tree, tree->steps.data[own->first + (way.back ? own->count - 1 - i : i)]);
}

static void go_along(const limb_tree *tree, limb_way way, double distance, double out[3]) {
    const limb *own = &tree->limbs.data[way.limb];
    for (size_t i = 0; i + 1 < own->count; i++) {
        const double *p = step_at(tree, way, i), *q = step_at(tree, way, i + 1);
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

typedef struct pairing {
    starg_context *context;
    const limb_tree *trees;
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
            at[end] = (tree->places[3 * (size_t)nodes[end] + k] - tree->lower[k]) / extent;
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
    for (size_t i = 0; i < counts[0]; i++) {
        if (partners[i] == NOWHERE)
            continue;
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
    for (uint32_t node = 0; node <= tree->node_count; node++) {
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
    RELEASE(p->costs);
}

starg_status limbs_pair(const limb_tree trees[2], limb_pairs *out) {
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
    for (uint32_t i = 0; i < trees[0].node_count; i++)
        for (uint32_t j = 0; j < trees[1].node_count; j++) {
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
    return walk(&p, roots, nowhere, out);
}
