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
 * keeps only a point, unless two ways from it are together far longer than wide. Kept paths end at
 * the first ball beyond which none reaches farther in the direction of the path, so that no limb
 * hooks into the rim of a cap; and a root that is no part of a limb is dropped.
 *
 * Cost: linear in practice; the search for an end is quadratic in the nodes within a hook. */
#include "skeleton/skeleton.h"

#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "pruning";

static const double WIDTH_SHARE = 0.3;
/* Length over half the girth: of a limb (0.71 on a ridge of a right angle), and of a whole solid.
 */
static const double SLENDER = 0.75;
static const double OBLONG = 0.55;
static const double SEPARATION = 2.8; /* in radii; pi on a tube */
static const double HOOK = 2;         /* in radii: how far a hook reaches */
static const double SHORT = 0.16;     /* of a radius, by which a limb may end early */
static const double TINY = 0.3;       /* in sample spacings: no ball of a limb */
enum { SPACINGS = 3 };                /* lengths within the unevenness of the samples */

typedef struct pruner {
    starg_context *context;
    const starg_solid *solid;
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
    bool *limb;       /* is there a node of a limb at or above it? */
    double *height;   /* length of that path, plus the radius at its tip */
    uint32_t *path;   /* scratch: a limb from a joint to its tip */
    double *exact;    /* radii along it, or -1 */
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
    for (size_t l = 0; l < c->link_count; l++) {
        const uint32_t *edges = c->link_edges[l];
        double half = 0.5 * (values[edges[0]] + values[edges[1]] + values[edges[2]]);
        for (int k = 0; k < 2; k++) {
            double *girth = &p->girths[c->links[l][k]];
            *girth = fmax(*girth, half);
        }
    }
    for (size_t v = 0; v < p->graph->node_count; v++)
        p->widths[v] = fmax(c->radii[v], WIDTH_SHARE * p->girths[v]);
    level(p, p->radii);
    level(p, p->widths);
}

static uint32_t graph_degree(const curve_graph *graph, size_t v) {
    return graph->first[v + 1] - graph->first[v];
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
    SCOPED bool *seen = NULL;
    NEW_ZERO(p->context, STAGE, seen, p->graph->node_count);
    for (uint32_t v = 0; v < p->graph->node_count; v++) {
        uint32_t root = seen[v] ? EDGE_NONE : root_of_part(p, v, seen);
        if (root != EDGE_NONE)
            p->root[root] = true;
    }
    return STARG_OK;
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

/* Does the ball of v touch two separate sides, as on a limb? Noise touches nearly one place. */
static bool is_separated(const pruner *p, uint32_t v) {
    return p->girths[v] > SEPARATION * p->radii[v];
}

/* In peeling order, so that what is above a node is known first. Noise zigzags within a ball: of
 * what holds no separated node, or only balls smaller than the samples tell, only the first step
 * counts. */
static void find_ways_up(pruner *p) {
    for (size_t i = 0; i < p->peeled; i++) {
        uint32_t v = p->order[i], w = p->below[v];
        p->limb[v] = p->limb[v] || (is_separated(p, v) && p->radii[v] > TINY * p->spacing);
        double height = (p->limb[v] ? p->height[v] : p->radii[v]) + distance(p, v, w);
        if (p->up[w] == EDGE_NONE || height > p->height[w]) {
            p->up[w] = v;
            p->height[w] = height;
        }
        p->limb[w] = p->limb[w] || p->limb[v];
    }
}

/* Does the path leave the ball of the joint, its first entry, as a limb? From some node beyond that
 * ball it continues far enough compared with the solid's width at the joint and its own girth (the
 * height of a ridge is half its girth, however high), and that node's ball touches two separate
 * sides, where balls of noise touch nearly one place. */
static bool is_limb(const pruner *p, size_t count, double slender) {
    const uint32_t *path = p->path;
    double least = fmax((p->reach - 1) * p->widths[path[0]], SPACINGS * p->spacing);
    double farthest = 0, height = p->radii[path[count - 1]];
    for (size_t i = 1; i < count; i++)
        farthest = fmax(farthest, distance(p, path[0], path[i]) + p->radii[path[i]]);
    for (size_t i = count; i-- > 1;) {
        uint32_t v = path[i];
        double away = distance(p, path[0], v);
        if (i + 1 < count)
            height += distance(p, v, path[i + 1]);
        if (away >= p->radii[path[0]] && fmin(farthest - away, height) > least &&
            height > slender * p->girths[v] && is_separated(p, v))
            return true;
    }
    return false;
}

/* Appends the longest way up from a node to the path. */
static size_t append_way_up(const pruner *p, uint32_t first, size_t count) {
    for (uint32_t v = first; v != EDGE_NONE; v = p->up[v])
        p->path[count++] = v;
    return count;
}

/* The last entry of the path before entry i at some distance from it, or the first of all. */
static size_t entry_before(const pruner *p, size_t i, double away) {
    size_t from = i;
    while (from > 0 && distance(p, p->path[from], p->path[i]) < away)
        from--;
    return from;
}

/* The distance of an entry from the surface: near a rim, balls of the samples stick out. */
static double exact_radius(const pruner *p, size_t i) {
    if (p->exact[i] < 0)
        p->exact[i] = starg_solid_distance(p->solid, p->complex->centres[p->path[i]]);
    return p->exact[i];
}

/* Does the limb end at entry i of the path? Then no ball beyond reaches farther in the direction in
 * which the limb runs there: it only hooks from the axis to the rim of a cap. */
static bool is_end(const pruner *p, size_t i, size_t count) {
    const uint32_t *path = p->path;
    const double *at = p->complex->centres[path[i]];
    double radius = exact_radius(p, i), reach = (1 + SHORT) * radius;
    size_t back = entry_before(p, i, radius), before = entry_before(p, back, radius);
    double along[3], way[3];
    if (distance(p, path[0], path[before]) < HOOK * exact_radius(p, before))
        before = back; /* the other end may hook, too */
    ends_direction(p->complex->centres[path[before]], p->complex->centres[path[back]], at,
                   0.5 * radius, along);
    double length = vec3_length(along);
    for (size_t k = i + 1; k < count; k++) {
        vec3_subtract(p->complex->centres[path[k]], at, way);
        if (vec3_length(way) + exact_radius(p, k) > HOOK * radius ||
            vec3_dot(way, along) > length * (reach - exact_radius(p, k)))
            return false;
    }
    return true;
}

/* The entry of the path, from `first` on, at which the limb ends. */
static size_t find_end(pruner *p, size_t first, size_t count) {
    size_t end = count - 1;
    for (size_t i = 0; i < count; i++)
        p->exact[i] = -1;
    for (size_t i = count; i-- > first;) {
        uint32_t v = p->path[i];
        if (distance(p, v, p->path[count - 1]) <= HOOK * p->radii[v] && is_end(p, i, count))
            end = i;
    }
    return end;
}

/* Keeps the entries of the path from `first` to the end of the limb. */
static void keep_path(pruner *p, size_t first, size_t count) {
    size_t end = find_end(p, first, count);
    for (size_t i = first; i <= end; i++)
        p->pruned->kept[p->path[i]] = true;
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
        if (starts && p->pruned->kept[owner[w]]) {
            p->path[0] = owner[w];
            size_t count = append_way_up(p, v, 1);
            if (is_limb(p, count, SLENDER)) {
                keep_way_down(p, w);
                keep_path(p, 1, count);
            }
        }
        owner[v] = p->pruned->kept[v] ? v : owner[w];
    }
}

static double height_above(const pruner *p, uint32_t root, uint32_t v) {
    return p->height[v] + distance(p, v, root);
}

/* The neighbour of the root that is not kept with the longest way up, besides `other`; EDGE_NONE if
 * there is none. */
static uint32_t longest_way(const pruner *p, uint32_t root, uint32_t other) {
    uint32_t best = EDGE_NONE;
    for (uint32_t j = p->graph->first[root]; j < p->graph->first[root + 1]; j++) {
        uint32_t v = p->graph->next[j];
        if (!p->pruned->kept[v] && v != other &&
            (best == EDGE_NONE || height_above(p, root, v) > height_above(p, root, best)))
            best = v;
    }
    return best;
}

/* Number of kept neighbours; *next: the last of them but `from`. */
static size_t kept_neighbours(const pruner *p, uint32_t v, uint32_t from, uint32_t *next) {
    size_t count = 0;
    for (uint32_t j = p->graph->first[v]; j < p->graph->first[v + 1]; j++)
        if (p->pruned->kept[p->graph->next[j]]) {
            count++;
            if (p->graph->next[j] != from)
                *next = p->graph->next[j];
        }
    return count;
}

static void reverse_path(pruner *p, size_t count) {
    for (size_t i = 0; i < count / 2; i++) {
        uint32_t swap = p->path[i];
        p->path[i] = p->path[count - 1 - i];
        p->path[count - 1 - i] = swap;
    }
}

/* The root of a tree with one kept neighbour may lie near the end of a limb, which then continues
 * on its other side, or beside a joint, and then belongs to no limb. */
static void settle_root(pruner *p, uint32_t root) {
    uint32_t front = longest_way(p, root, EDGE_NONE), from = EDGE_NONE, at = root, next = root;
    size_t count = 0, degree;
    while ((degree = kept_neighbours(p, at, from, &next)) < 3) {
        p->path[count++] = at;
        if (at != root && degree == 1)
            break;
        from = at;
        at = next;
    }
    if (degree > 2)
        p->path[count++] = at;
    reverse_path(p, count);
    size_t before = count;
    count = front == EDGE_NONE ? count : append_way_up(p, front, count);
    if (degree < 3 || is_limb(p, count, SLENDER)) {
        keep_path(p, before - 1, count);
        return;
    }
    for (size_t i = 1; i < before; i++)
        p->pruned->kept[p->path[i]] = false;
    p->pruned->owner[root] = p->path[0];
}

/* No way from the root is a limb, but two of them may be together, as in an ellipsoid. */
static void widen_root(pruner *p, uint32_t root) {
    uint32_t back = longest_way(p, root, EDGE_NONE);
    uint32_t front = back == EDGE_NONE ? EDGE_NONE : longest_way(p, root, back);
    if (front == EDGE_NONE)
        return;
    for (int side = 0; side < 2; side++) {
        size_t before = append_way_up(p, side == 0 ? back : front, 0);
        reverse_path(p, before);
        p->path[before] = root;
        size_t count = append_way_up(p, side == 0 ? front : back, before + 1);
        if (side == 0 && !is_limb(p, count, OBLONG))
            return;
        keep_path(p, before, count);
    }
}

static void finish_roots(pruner *p) {
    for (uint32_t v = 0; v < p->graph->node_count; v++)
        if (p->root[v] && p->pruned->kept[v]) {
            uint32_t next;
            size_t degree = kept_neighbours(p, v, EDGE_NONE, &next);
            if (degree == 0)
                widen_root(p, v);
            else if (degree == 1)
                settle_root(p, v);
        }
}

/* Runs again because paths down are kept later than what stands on them. */
static void find_owners(pruner *p) {
    for (size_t i = p->peeled; i-- > 0;) {
        uint32_t v = p->order[i];
        p->pruned->owner[v] = p->pruned->kept[v] ? v : p->pruned->owner[p->below[v]];
    }
}

starg_status prune_graph(starg_context *context, const starg_solid *solid,
                         const medial_complex *complex, const curve_graph *graph,
                         const bool *node_left, const double *values, double reach, double spacing,
                         pruned_graph *pruned) {
    starg_status status = STARG_OK;
    size_t count = graph->node_count;
    pruner p = {.context = context,
                .solid = solid,
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
    STARG_NEW_ZERO(context, STAGE, p.limb, count);
    STARG_NEW(context, STAGE, p.path, count);
    STARG_NEW(context, STAGE, p.exact, count);
    measure_widths(&p, values);
    STARG_TRY(find_roots(&p));
    peel(&p);
    find_ways_up(&p);
    choose_paths(&p);
    finish_roots(&p);
    find_owners(&p);
done:
    RELEASE(p.radii, p.girths, p.widths, p.root, p.degree, p.below, p.order, p.up, p.height, p.limb,
            p.path, p.exact);
    if (status != STARG_OK)
        prune_free(pruned);
    return status;
}

void prune_free(pruned_graph *pruned) {
    RELEASE(pruned->kept, pruned->owner);
    *pruned = (pruned_graph){0};
}
