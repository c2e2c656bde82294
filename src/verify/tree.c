/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy. Faces are split recursively at the median of their centres along the
 * longest side of the centres' box, down to leaves of a few; node i has the children 2 i and 2 i +
 * 1, and its faces are a range of the order, so only boxes are stored.
 *
 * Boxes are exact. Only the segment test against a box is rounded: it returns "apart" only if
 * certain. Cost: O(n log n) to build, typically O(log n) per query near a point. */
#include "verify/surface.h"

#include "core/rng.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";

enum { LEAF = 4 };

typedef struct box {
    double lower[3], upper[3];
} box;

struct verify_tree {
    const verify_surface *surface;
    uint32_t *order; /* faces */
    box *boxes;      /* of the nodes, from 1 */
    double *centers; /* of the faces' boxes; only while building */
};

/* A node and its range of the order. */
typedef struct node {
    size_t index, begin, end;
} node;

static bool is_leaf(node own) {
    return own.end - own.begin <= LEAF;
}

static node child_of(node own, int side) {
    size_t middle = own.begin + (own.end - own.begin) / 2;
    return side == 0 ? (node){2 * own.index, own.begin, middle}
                     : (node){2 * own.index + 1, middle, own.end};
}

static node root_of(const verify_tree *tree) {
    return (node){1, 0, tree->surface->face_count};
}

/* ---- building ---- */

static const box NOTHING = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void widen(box *own, const double lower[3], const double upper[3]) {
    for (int k = 0; k < 3; k++) {
        own->lower[k] = lower[k] < own->lower[k] ? lower[k] : own->lower[k];
        own->upper[k] = upper[k] > own->upper[k] ? upper[k] : own->upper[k];
    }
}

static box box_of(const verify_surface *surface, uint32_t face) {
    box own = NOTHING;
    const double *t[3];
    verify_corners(surface, face, t);
    for (int i = 0; i < 3; i++)
        widen(&own, t[i], t[i]);
    return own;
}

static double center_of(const verify_tree *tree, size_t place, int axis) {
    return tree->centers[3 * (size_t)tree->order[place] + (size_t)axis];
}

static int longest_axis(const verify_tree *tree, node own) {
    box centers = NOTHING;
    for (size_t i = own.begin; i < own.end; i++) {
        const double *center = tree->centers + 3 * (size_t)tree->order[i];
        widen(&centers, center, center);
    }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (centers.upper[k] - centers.lower[k] > centers.upper[axis] - centers.lower[axis])
            axis = k;
    return axis;
}

static void exchange(uint32_t *a, uint32_t *b) {
    uint32_t c = *a;
    *a = *b;
    *b = c;
}

/* Partitions a range at its middle (Hoare's selection). */
static void partition_at_median(verify_tree *tree, node own, int axis) {
    uint32_t *order = tree->order;
    size_t middle = own.begin + (own.end - own.begin) / 2, begin = own.begin, last = own.end - 1;
    while (begin < last) {
        size_t pick = begin + (size_t)(starg_hash64(begin ^ last << 20) % (last - begin + 1));
        double pivot = center_of(tree, pick, axis);
        size_t i = begin, j = last;
        exchange(&order[begin], &order[pick]); /* so that j ends below `last` */
        for (;; i++, j--) {
            while (center_of(tree, i, axis) < pivot)
                i++;
            while (center_of(tree, j, axis) > pivot)
                j--;
            if (i >= j)
                break;
            exchange(&order[i], &order[j]);
        }
        if (middle <= j)
            last = j;
        else
            begin = j + 1;
    }
}

static box build(verify_tree *tree, node own) {
    box all = NOTHING;
    if (is_leaf(own)) {
        for (size_t i = own.begin; i < own.end; i++) {
            box one = box_of(tree->surface, tree->order[i]);
            widen(&all, one.lower, one.upper);
        }
    } else {
        partition_at_median(tree, own, longest_axis(tree, own));
        for (int side = 0; side < 2; side++) {
            box half = build(tree, child_of(own, side));
            widen(&all, half.lower, half.upper);
        }
    }
    tree->boxes[own.index] = all;
    return all;
}

static void find_centers(verify_tree *tree) {
    for (uint32_t f = 0; f < tree->surface->face_count; f++) {
        box own = box_of(tree->surface, f);
        tree->order[f] = f;
        for (size_t k = 0; k < 3; k++)
            tree->centers[3 * (size_t)f + k] = own.lower[k] / 2 + own.upper[k] / 2;
    }
}

starg_status verify_tree_create(const verify_surface *surface, verify_tree **out) {
    starg_context *context = surface->context;
    SCOPED_BY(verify_tree_drop) verify_tree *tree = NULL;
    size_t node_count = 2;
    *out = NULL;
    for (size_t most = surface->face_count; most > LEAF; most = most / 2 + most % 2)
        node_count *= 2;
    NEW_ZERO(context, STAGE, tree, 1);
    tree->surface = surface;
    NEW(context, STAGE, tree->order, surface->face_count);
    NEW(context, STAGE, tree->boxes, node_count);
    NEW(context, STAGE, tree->centers, 3 * surface->face_count);
    find_centers(tree);
    build(tree, root_of(tree));
    starg_release(context, tree->centers);
    tree->centers = NULL;
    *out = tree;
    tree = NULL;
    return STARG_OK;
}

void verify_tree_free(verify_tree *tree) {
    if (tree == NULL)
        return;
    RELEASE(tree->order, tree->boxes, tree->centers, tree);
}

const verify_surface *verify_tree_surface(const verify_tree *tree) {
    return tree->surface;
}

/* ---- boxes ---- */

static bool meet(const box *a, const box *b) {
    for (int k = 0; k < 3; k++)
        if (!(a->lower[k] <= b->upper[k] && b->lower[k] <= a->upper[k]))
            return false;
    return true;
}

typedef struct visitor {
    const verify_tree *tree;
    box within;
    verify_visit *visit;
    void *data;
} visitor;

static bool visit_node(const visitor *own, node at) {
    const verify_tree *tree = own->tree;
    if (!meet(&own->within, &tree->boxes[at.index]))
        return true;
    if (!is_leaf(at))
        return visit_node(own, child_of(at, 0)) && visit_node(own, child_of(at, 1));
    for (size_t i = at.begin; i < at.end; i++) {
        box face = box_of(tree->surface, tree->order[i]);
        if (meet(&own->within, &face) && !own->visit(own->data, tree->order[i]))
            return false;
    }
    return true;
}

bool verify_tree_visit(const verify_tree *tree, const double lower[3], const double upper[3],
                       verify_visit *visit, void *data) {
    visitor own = {.tree = tree, .within = NOTHING, .visit = visit, .data = data};
    widen(&own.within, lower, upper);
    return visit_node(&own, root_of(tree));
}

/* ---- distance ---- */

typedef struct nearest {
    const verify_tree *tree;
    const double *p;
    int scale;
    double least; /* squared, in scaled units */
} nearest;

/* Lower bound of the squared distance from p to a box, barely below it. */
static double squared_to_box(const nearest *own, const box *b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double beyond = fmax(fmax(b->lower[k] - own->p[k], own->p[k] - b->upper[k]), 0);
        double scaled = ldexp(beyond, own->scale);
        sum += scaled * scaled;
    }
    return sum * (1 - 1e-12);
}

static void approach(nearest *own, node at) {
    const verify_tree *tree = own->tree;
    if (is_leaf(at)) {
        for (size_t i = at.begin; i < at.end; i++)
            own->least = fmin(own->least, verify_squared_distance(tree->surface, tree->order[i],
                                                                  own->p, own->scale));
        return;
    }
    node child[2] = {child_of(at, 0), child_of(at, 1)};
    double far[2];
    for (int i = 0; i < 2; i++)
        far[i] = squared_to_box(own, &tree->boxes[child[i].index]);
    int first = far[1] < far[0];
    if (far[first] <= own->least)
        approach(own, child[first]);
    if (far[!first] <= own->least)
        approach(own, child[!first]);
}

double verify_tree_distance(const verify_tree *tree, const double p[3], int scale) {
    nearest own = {.tree = tree, .p = p, .scale = scale, .least = INFINITY};
    approach(&own, root_of(tree));
    return ldexp(sqrt(own.least), -scale);
}

/* ---- segments ---- */

typedef struct segment {
    double middle[3], half[3]; /* half = (q - p) / 2, rounded */
    double size;               /* bound on the magnitude of its coordinates */
} segment;

static segment segment_of(const double p[3], const double q[3]) {
    segment own = {.size = 0};
    for (int k = 0; k < 3; k++) {
        own.middle[k] = p[k] / 2 + q[k] / 2;
        own.half[k] = q[k] / 2 - p[k] / 2;
        own.size = fmax(own.size, fmax(fabs(p[k]), fabs(q[k])));
    }
    return own;
}

/* Are segment and box certainly apart? Separating axes: those of the box, and their cross products
 * with the segment. The margins cover the rounding of centres and of products several times over;
 * underflow gives 0 > 0, which is not apart. */
static bool apart(const segment *own, const box *b) {
    double away[3], reach[3];
    for (int k = 0; k < 3; k++) {
        double size = fmax(own->size, fmax(fabs(b->lower[k]), fabs(b->upper[k])));
        away[k] = own->middle[k] - (b->lower[k] / 2 + b->upper[k] / 2);
        reach[k] = (b->upper[k] / 2 - b->lower[k] / 2) + 0x1p-48 * size;
        if (fabs(away[k]) > reach[k] + fabs(own->half[k]) * (1 + 0x1p-48))
            return true;
    }
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double first = away[u] * own->half[v], second = away[v] * own->half[u];
        double limit = reach[u] * fabs(own->half[v]) + reach[v] * fabs(own->half[u]);
        double margin = 0x1p-48 * (fabs(first) + fabs(second)) + 1e-290;
        if (fabs(first - second) > limit + margin)
            return true;
    }
    return false;
}

typedef struct follower {
    const verify_tree *tree;
    segment way;
    verify_visit *visit;
    void *data;
} follower;

static bool follow(const follower *own, node at) {
    const verify_tree *tree = own->tree;
    if (apart(&own->way, &tree->boxes[at.index]))
        return true;
    if (!is_leaf(at))
        return follow(own, child_of(at, 0)) && follow(own, child_of(at, 1));
    for (size_t i = at.begin; i < at.end; i++)
        if (!own->visit(own->data, tree->order[i]))
            return false;
    return true;
}

bool verify_tree_follow(const verify_tree *tree, const double p[3], const double q[3],
                        verify_visit *visit, void *data) {
    const follower own = {.tree = tree, .way = segment_of(p, q), .visit = visit, .data = data};
    return follow(&own, root_of(tree));
}

typedef struct sight_line {
    const verify_surface *surface;
    const double *p, *q;
} sight_line;

static bool leaves_free(void *data, uint32_t face) {
    const sight_line *own = data;
    const double *t[3];
    verify_corners(own->surface, face, t);
    return !verify_blocks(own->p, own->q, t);
}

bool verify_tree_blocks(const verify_tree *tree, const double p[3], const double q[3]) {
    sight_line own = {tree->surface, p, q};
    return !verify_tree_follow(tree, p, q, leaves_free, &own);
}
