/* SPDX-License-Identifier: Apache-2.0 */
/* Erosion leaves a graph with a twig to nearly every tetrahedron. Trees are peeled from their
 * leaves down to the loops, or to the largest ball of a component without loops; each node then
 * knows the one below it. Of the branches that meet in a node the one with the longest path up
 * continues, the others end there, which decomposes the trees into paths from a joint to a tip.
 *
 * A path is kept if it leaves its joint as a limb. Sampling noise and ridges give paths as long as
 * short limbs, so length alone does not decide; the medial geodesic function does: it is half the
 * girth on a limb, twice the height on a ridge, and less than the ball's diameter where a ball
 * touches nearly one place. All measures are ratios, independent of the model's size; except that
 * anything below some sample spacings counts as noise.
 *
 * The joint is the nearest kept node below, so that limbs that meet in a large ball count. A ball
 * keeps only a point. Kept paths end at the first ball that reaches nearly as far as any on them.
 *
 * Cost: linear. */
#include "skeleton/prune.h"

#include "core/memory.h"
#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "pruning";

static const double WIDTH_SHARE = 0.3;
static const double SLENDER = 0.9;
static const double SEPARATION = 2.5; /* in radii; pi on a tube */
enum { SPACINGS = 3 };                /* lengths within the unevenness of the samples */

typedef struct pruner {
    starg_context *context;
    const medial_complex *complex;
    const curve_graph *graph;
    const bool *node_left;
    double reach, spacing;
    double *girths; /* half the girth: the largest medial geodesic function at a node */
    double *widths; /* of the solid at nodes: see measure_widths */
    double *radii;  /* of balls about the centres, inside of the node's own ball or a neighbour's */
    bool *root;     /* not peeled */
    uint32_t *degree; /* in the remaining graph */
    uint32_t *below;  /* of peeled nodes; otherwise EDGE_NONE */
    uint32_t *order;  /* peeled nodes, leaves first */
    uint32_t *up;     /* next node of the longest path up, or EDGE_NONE at a tip */
    double *height;   /* length of that path, plus the radius at its tip */
    size_t peeled;
    pruned_graph *pruned;
} pruner;

static double distance(const pruner *p, uint32_t a, uint32_t b) {
    return vec3_distance(p->complex->centres[a], p->complex->centres[b]);
}

/* Makes values fall no faster than the distance to a neighbour with a larger one: a node near a
 * large ball's centre has a large ball too, even if its own centre is poor. */
static void level(const pruner *p, double *values) {
    enum { PASSES = 32 };
    bool changed = true;
    for (int pass = 0; pass < PASSES && changed; pass++) {
        changed = false;
        for (uint32_t v = 0; v < p->graph->node_count; v++)
            for (uint32_t j = p->graph->first[v]; j < p->graph->first[v + 1]; j++) {
                uint32_t w = p->graph->next[j];
                if (!(values[w] > values[v])) /* the common case, which needs no distance */
                    continue;
                double value = values[w] - distance(p, v, w);
                if (value > values[v]) {
                    values[v] = value;
                    changed = true;
                }
            }
    }
}

/* On a tube the medial geodesic function is half the girth, on a plate the width: a fraction of it
 * serves as the radius where the ball only measures the thickness. */
static void measure_widths(pruner *p, const double *values) {
    const medial_complex *c = p->complex;
    memcpy(p->radii, c->radii, p->graph->node_count * sizeof *p->radii);
    memset(p->girths, 0, p->graph->node_count * sizeof *p->girths);
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 6; k++) {
            double *girth = &p->girths[c->links[l][k / 3]];
            *girth = fmax(*girth, values[c->link_edges[l][k % 3]]);
        }
    for (size_t v = 0; v < p->graph->node_count; v++)
        p->widths[v] = fmax(c->radii[v], WIDTH_SHARE * p->girths[v]);
    level(p, p->radii);
    level(p, p->widths);
}

/* Visits the component of `start`; returns its largest ball if it is a tree, else EDGE_NONE.
 * `order` serves as the queue. */
static uint32_t root_of_part(pruner *p, uint32_t start, bool *seen) {
    size_t count = 0, ends = 0;
    uint32_t largest = start;
    seen[start] = true;
    p->order[count++] = start;
    for (size_t i = 0; i < count; i++) {
        uint32_t v = p->order[i];
        ends += graph_degree(p->graph, v);
        if (p->complex->radii[v] > p->complex->radii[largest])
            largest = v;
        for (uint32_t j = p->graph->first[v]; j < p->graph->first[v + 1]; j++) {
            uint32_t w = p->graph->next[j];
            if (!seen[w]) {
                seen[w] = true;
                p->order[count++] = w;
            }
        }
    }
    return ends / 2 + 1 == count ? largest : EDGE_NONE;
}

static starg_status find_roots(pruner *p) {
    starg_status status = STARG_OK;
    bool *seen = NULL;
    STARG_NEW_ZERO(p->context, STAGE, seen, p->graph->node_count);
    for (uint32_t v = 0; v < p->graph->node_count; v++) {
        uint32_t root = seen[v] ? EDGE_NONE : root_of_part(p, v, seen);
        if (root != EDGE_NONE)
            p->root[root] = true;
    }
done:
    starg_release(p->context, seen);
    return status;
}

static void peel(pruner *p) {
    size_t count = 0;
    for (uint32_t v = 0; v < p->graph->node_count; v++) {
        p->degree[v] = graph_degree(p->graph, v);
        p->below[v] = p->up[v] = EDGE_NONE;
        p->height[v] = p->radii[v];
        if (p->degree[v] == 1 && !p->root[v])
            p->order[count++] = v;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t v = p->order[i];
        p->degree[v] = 0;
        for (uint32_t j = p->graph->first[v]; j < p->graph->first[v + 1]; j++) {
            uint32_t w = p->graph->next[j];
            if (p->degree[w] == 0)
                continue;
            p->below[v] = w;
            if (--p->degree[w] == 1 && !p->root[w])
                p->order[count++] = w;
        }
    }
    p->peeled = count;
}

/* In peeling order, so that what is above a node is known first. */
static void find_ways_up(pruner *p) {
    for (size_t i = 0; i < p->peeled; i++) {
        uint32_t v = p->order[i], w = p->below[v];
        double height = p->height[v] + distance(p, v, w);
        if (p->up[w] == EDGE_NONE || height > p->height[w]) {
            p->up[w] = v;
            p->height[w] = height;
        }
    }
}

/* Largest straight-line distance from a joint that the balls of the path starting with `first`
 * reach. */
static double reach_of(const pruner *p, uint32_t joint, uint32_t first) {
    double farthest = 0;
    for (uint32_t v = first; v != EDGE_NONE; v = p->up[v])
        farthest = fmax(farthest, distance(p, joint, v) + p->radii[v]);
    return farthest;
}

/* Does the path starting with `first` leave the ball of its joint as a limb? From some node beyond
 * that ball it continues far enough compared with the solid's width at the joint and its own girth
 * (the height of a ridge is half its girth, however high), and that node's ball touches two
 * separate sides, where balls of noise touch nearly one place. */
static bool is_feature(const pruner *p, uint32_t joint, uint32_t first) {
    double least = fmax((p->reach - 1) * p->widths[joint], SPACINGS * p->spacing);
    double farthest = reach_of(p, joint, first);
    for (uint32_t v = first; v != EDGE_NONE; v = p->up[v]) {
        double away = distance(p, joint, v);
        if (away >= p->radii[joint] && fmin(farthest - away, p->height[v]) > least &&
            p->height[v] > SLENDER * p->girths[v] && p->girths[v] > SEPARATION * p->radii[v])
            return true;
    }
    return false;
}

/* Keeps a path up to the first ball that reaches as far as any, up to a tenth of its radius. */
static void keep_path(pruner *p, uint32_t joint, uint32_t first) {
    double farthest = 0, way = 0;
    uint32_t last = joint;
    for (uint32_t v = first; v != EDGE_NONE; last = v, v = p->up[v]) {
        way += distance(p, last, v);
        farthest = fmax(farthest, way + p->radii[v]);
    }
    way = 0;
    last = joint;
    for (uint32_t v = first; v != EDGE_NONE; last = v, v = p->up[v]) {
        way += distance(p, last, v);
        p->pruned->kept[v] = true;
        if (way + 1.1 * p->radii[v] >= farthest)
            break;
    }
}

/* Keeps the path from v down to the kept nodes. */
static void keep_way_down(pruner *p, uint32_t v) {
    for (; !p->pruned->kept[v]; v = p->below[v])
        p->pruned->kept[v] = true;
}

/* From the roots up. A node starts a path unless the node below continues with it. Paths may branch
 * off one that is not kept (as where many limbs meet); the joint is then the kept node below. */
static void choose_paths(pruner *p) {
    uint32_t *owner = p->pruned->owner;
    for (uint32_t v = 0; v < p->graph->node_count; v++) {
        p->pruned->kept[v] = p->below[v] == EDGE_NONE && p->node_left[v];
        owner[v] = v;
    }
    for (size_t i = p->peeled; i-- > 0;) {
        uint32_t v = p->order[i], w = p->below[v];
        bool starts = p->below[w] == EDGE_NONE || p->up[w] != v;
        if (starts && p->pruned->kept[owner[w]] && is_feature(p, owner[w], v)) {
            keep_way_down(p, w);
            keep_path(p, owner[w], v);
        }
        owner[v] = p->pruned->kept[v] ? v : owner[w];
    }
}

/* Runs again because paths down are kept later than what stands on them. */
static void find_owners(pruner *p) {
    for (size_t i = p->peeled; i-- > 0;) {
        uint32_t v = p->order[i];
        p->pruned->owner[v] = p->pruned->kept[v] ? v : p->pruned->owner[p->below[v]];
    }
}

starg_status prune_graph(starg_context *context, const medial_complex *complex,
                         const curve_graph *graph, const bool *node_left, const double *values,
                         double reach, double spacing, pruned_graph *pruned) {
    starg_status status = STARG_OK;
    size_t count = graph->node_count;
    pruner p = {.context = context,
                .complex = complex,
                .graph = graph,
                .node_left = node_left,
                .reach = reach,
                .spacing = spacing,
                .pruned = pruned};
    *pruned = (pruned_graph){0};
    STARG_NEW(context, STAGE, pruned->kept, count);
    STARG_NEW(context, STAGE, pruned->owner, count);
    STARG_NEW(context, STAGE, p.radii, count);
    STARG_NEW(context, STAGE, p.girths, count);
    STARG_NEW(context, STAGE, p.widths, count);
    STARG_NEW_ZERO(context, STAGE, p.root, count);
    STARG_NEW(context, STAGE, p.degree, count);
    STARG_NEW(context, STAGE, p.below, count);
    STARG_NEW(context, STAGE, p.order, count);
    STARG_NEW(context, STAGE, p.up, count);
    STARG_NEW(context, STAGE, p.height, count);
    measure_widths(&p, values);
    STARG_TRY(find_roots(&p));
    peel(&p);
    find_ways_up(&p);
    choose_paths(&p);
    find_owners(&p);
done:
    starg_release(context, p.radii);
    starg_release(context, p.girths);
    starg_release(context, p.widths);
    starg_release(context, p.root);
    starg_release(context, p.degree);
    starg_release(context, p.below);
    starg_release(context, p.order);
    starg_release(context, p.up);
    starg_release(context, p.height);
    if (status != STARG_OK)
        prune_free(context, pruned);
    return status;
}

void prune_free(starg_context *context, pruned_graph *pruned) {
    starg_release(context, pruned->kept);
    starg_release(context, pruned->owner);
    *pruned = (pruned_graph){0};
}
