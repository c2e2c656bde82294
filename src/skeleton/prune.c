/* SPDX-License-Identifier: Apache-2.0 */
/* Erosion leaves a graph with a twig to nearly every tetrahedron. Trees are peeled from their
 * leaves down to the loops, or to the largest ball of a part without loops; thus each node knows
 * the one below it. Among the branches that meet in a node the one with the longest way up goes on,
 * the others end there, so that the trees fall into paths from a joint to a tip.
 *
 * A path is kept when it leaves its joint as a limb. Noise of the samples and ridges give paths as
 * long as short limbs are, so that length alone does not tell; the medial geodesic function does,
 * which is half the girth on a limb, twice the height on a ridge, and less than the ball is wide
 * where a ball touches nearly one place. All measures are ratios, and do not depend on the size of
 * the model; only what is no longer than some steps of the samples is their noise in any case.
 *
 * The joint is the nearest kept node below, so that limbs count that meet in a large ball. A ball
 * keeps a point only. Kept paths end at the first ball that reaches nearly as far as any on them.
 *
 * Cost: linear. */
#include "skeleton/prune.h"

#include "core/memory.h"
#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "pruning";

static const double WIDTH_SHARE = 0.3;
static const double SLENDER = 0.9;
static const double SEPARATION = 2.5; /* in radii; it is pi on a tube */
enum { SPACINGS = 3 };                /* what samples cannot tell from their own unevenness */

typedef struct pruner {
    starg_context *context;
    const medial_complex *complex;
    const curve_graph *graph;
    const bool *node_left;
    double reach, spacing;
    double *girths;   /* half the girth: the largest medial geodesic function at a node */
    double *widths;   /* of the solid at nodes: see measure_widths */
    double *radii;    /* of balls about the centres that lie in those of neighbours, or their own */
    bool *root;       /* not to be peeled */
    uint32_t *degree; /* in what is left */
    uint32_t *below;  /* of peeled nodes; EDGE_NONE for others */
    uint32_t *order;  /* peeled nodes, leaves first */
    uint32_t *up;     /* the node that goes on the longest way, or EDGE_NONE at a tip */
    double *height;   /* of that way, with the radius at its tip */
    size_t peeled;
    pruned_graph *pruned;
} pruner;

static double distance(const pruner *p, uint32_t a, uint32_t b) {
    return vec3_distance(p->complex->centres[a], p->complex->centres[b]);
}

/* A value at v that falls no faster than the way to a neighbour with a larger one: a node near a
 * large ball's centre has a large ball too, even where its own centre is a poor one. */
static void level(const pruner *p, double *values) {
    enum { PASSES = 32 };
    bool changed = true;
    for (int pass = 0; pass < PASSES && changed; pass++) {
        changed = false;
        for (uint32_t v = 0; v < p->graph->node_count; v++)
            for (uint32_t j = p->graph->first[v]; j < p->graph->first[v + 1]; j++) {
                uint32_t w = p->graph->next[j];
                if (!(values[w] > values[v])) /* most, and no way need be measured */
                    continue;
                double value = values[w] - distance(p, v, w);
                if (value > values[v]) {
                    values[v] = value;
                    changed = true;
                }
            }
    }
}

/* On a tube the medial geodesic function is half the girth, on a plate the width: a share of it
 * stands for the radius where the ball only knows the thickness. */
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

/* Visits the part of `start` and returns its largest ball if the part is a tree, else EDGE_NONE.
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

/* In the order of peeling, so that what is above a node is known first. */
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

/* How far from a joint the balls of the path that starts with `first` reach, as the crow flies. */
static double reach_of(const pruner *p, uint32_t joint, uint32_t first) {
    double farthest = 0;
    for (uint32_t v = first; v != EDGE_NONE; v = p->up[v])
        farthest = fmax(farthest, distance(p, joint, v) + p->radii[v]);
    return farthest;
}

/* Does the path that starts with `first` leave the ball of its joint as a limb? From some node
 * beyond that ball it goes on far enough for the solid's width at the joint and for its own girth
 * (a ridge is half as high as it is round, however high), and that node's ball touches two sides
 * that lie apart, where those of noise touch nearly one place. */
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

/* Keeps a path up to the first ball that reaches as far as any but for a tenth of its radius. */
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

/* Keeps the way from v down to what is kept. */
static void keep_way_down(pruner *p, uint32_t v) {
    for (; !p->pruned->kept[v]; v = p->below[v])
        p->pruned->kept[v] = true;
}

/* From the roots up. A node starts a path unless the node below goes on with it. Paths may part on
 * one that is none itself (as where many limbs meet); the kept node below is the joint then. */
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

/* Again, as ways down have been kept later than what stands on them. */
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
