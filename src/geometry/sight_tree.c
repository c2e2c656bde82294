/* SPDX-License-Identifier: Apache-2.0 */
/* Eight boxes a node, tested together.
 *
 * Problem: a search asks millions of times whether a segment meets any triangle. In a binary tree
 * most of the time goes into waiting for one box to decide about the next.
 *
 * Method [after Wald, Benthin, Boulos 2008]: three levels of the binary tree become one node, whose
 * boxes are rows of floats that compilers make vector code of. Coordinates are relative to the
 * bounding box, from -1 to 1.
 *
 * Invariant: no triangle that the segment meets is lost. Rounding moves a relative coordinate by
 * less than 2^-22, and so each point of the segment; boxes are larger by SLACK, which is more than
 * both, and the interval of parameters by as much. Which boxes are visited needlessly changes
 * nothing: predicates decide about triangles.
 *
 * Cost: O(n) to build, O(log n) for a segment that few boxes hold. */
#include "geometry/bvh.h"

#include <math.h>

#include "core/compiler.h"

enum { WIDTH = 8, LEAF = 4, MOST_STACK = 8 * 64 };

static const float SLACK = 0x1p-19f, STEEPEST = 0x1p60f;

typedef struct wide_node {
    /* lower x, y, z, then upper; of an empty box they are the wrong way round */
    float bound[6][WIDTH];
    uint32_t first[WIDTH]; /* of triangles, or the node */
    uint32_t count[WIDTH]; /* 0: a node */
} wide_node;

struct sight_tree {
    starg_context *context;
    const bvh *tree;
    wide_node *nodes;
    size_t node_count;
    double centre[3], scale;
};

static bool is_inner(const bvh *tree, const bvh_node *node) {
    return node->count == 0 && tree->triangle_count > LEAF;
}

static double size_of(const bvh_box *box) {
    double x = box->upper[0] - box->lower[0], y = box->upper[1] - box->lower[1];
    double z = box->upper[2] - box->lower[2];
    return x * y + y * z + z * x;
}

/* Replaces the largest inner node by its children until there are eight. */
static size_t gather(const bvh *tree, const bvh_node *root, const bvh_node *list[WIDTH]) {
    size_t count = 1;
    list[0] = root;
    while (count < WIDTH) {
        size_t best = WIDTH;
        for (size_t i = 0; i < count; i++)
            if (is_inner(tree, list[i]) &&
                (best == WIDTH || size_of(&list[i]->box) > size_of(&list[best]->box)))
                best = i;
        if (best == WIDTH)
            break;
        const bvh_node *children = &tree->nodes[list[best]->first];
        list[best] = children;
        list[count++] = children + 1;
    }
    return count;
}

static void build(sight_tree *out, size_t at, const bvh_node *root) {
    const bvh_node *list[WIDTH];
    wide_node *node = &out->nodes[at];
    size_t count = gather(out->tree, root, list);
    for (size_t i = 0; i < WIDTH; i++)
        for (int k = 0; k < 3; k++) {
            double c = out->centre[k], s = out->scale;
            node->bound[k][i] = i < count ? (float)((list[i]->box.lower[k] - c) * s) - SLACK : 4;
            node->bound[3 + k][i] =
                i < count ? (float)((list[i]->box.upper[k] - c) * s) + SLACK : -4;
        }
    for (size_t i = 0; i < count; i++) {
        bool inner = is_inner(out->tree, list[i]);
        node->count[i] = inner ? 0 : list[i]->count;
        node->first[i] = inner ? (uint32_t)out->node_count++ : list[i]->first;
    }
    for (size_t i = 0; i < count; i++)
        if (node->count[i] == 0)
            build(out, node->first[i], list[i]);
}

starg_status sight_tree_create(starg_context *context, const bvh *tree, const bvh_box *all,
                               sight_tree **out) {
    SCOPED_BY(sight_tree_drop) sight_tree *made = NULL;
    double extent = 0;
    *out = NULL;
    NEW_ZERO(context, "bvh", made, 1);
    made->context = context;
    made->tree = tree;
    for (int k = 0; k < 3; k++) {
        made->centre[k] = 0.5 * all->lower[k] + 0.5 * all->upper[k];
        extent = fmax(extent, 0.5 * all->upper[k] - 0.5 * all->lower[k]);
    }
    made->scale = 1 / extent;
    /* each node but the root replaces at least one inner node of the binary tree */
    NEW(context, "bvh", made->nodes, tree->node_count / 2 + 1);
    made->node_count = 1;
    build(made, 0, &tree->nodes[0]);
    *out = made;
    made = NULL;
    return STARG_OK;
}

void sight_tree_free(sight_tree *tree) {
    if (tree == NULL)
        return;
    RELEASE(tree->nodes, tree);
}

typedef struct ray {
    float origin[3], inverse[3];
    int near[3], far[3]; /* which bounds it meets first and last */
} ray;

static ray ray_make(const sight_tree *tree, const double p[3], const double q[3]) {
    ray r;
    for (int k = 0; k < 3; k++) {
        float from = (float)((p[k] - tree->centre[k]) * tree->scale);
        float to = (float)((q[k] - tree->centre[k]) * tree->scale), along = to - from;
        bool down = along < 0;
        r.origin[k] = from;
        r.inverse[k] = fabsf(along) * STEEPEST > 1 ? 1 / along : down ? -STEEPEST : STEEPEST;
        r.near[k] = down ? 3 + k : k;
        r.far[k] = down ? k : 3 + k;
    }
    return r;
}

/* Where the ray enters each of the boxes; 2: it misses. */
static inline __attribute__((always_inline)) void enter_boxes(const wide_node *node, const ray *r,
                                                              float at[WIDTH]) {
    const float *nx = node->bound[r->near[0]], *ny = node->bound[r->near[1]];
    const float *nz = node->bound[r->near[2]], *fx = node->bound[r->far[0]];
    const float *fy = node->bound[r->far[1]], *fz = node->bound[r->far[2]];
    for (int i = 0; i < WIDTH; i++) {
        float x = (nx[i] - r->origin[0]) * r->inverse[0];
        float y = (ny[i] - r->origin[1]) * r->inverse[1];
        float z = (nz[i] - r->origin[2]) * r->inverse[2];
        float enter = x > y ? x : y;
        enter = enter > z ? enter : z;
        enter = enter > 0 ? enter : 0;
        x = (fx[i] - r->origin[0]) * r->inverse[0];
        y = (fy[i] - r->origin[1]) * r->inverse[1];
        z = (fz[i] - r->origin[2]) * r->inverse[2];
        float leave = x < y ? x : y;
        leave = leave < z ? leave : z;
        leave = leave < 1 ? leave : 1;
        at[i] = enter <= leave * (1 + SLACK) ? enter : 2;
    }
}

typedef struct entry {
    uint32_t first, count;
} entry;

STARG_SEVERAL_VERSIONS
static bool query(const sight_tree *tree, const ray *r, bvh_visit_rank *visit, void *user) {
    entry stack[MOST_STACK];
    size_t depth = 0;
    stack[depth++] = (entry){0, 0};
    while (depth > 0) {
        entry top = stack[--depth];
        for (uint32_t i = top.first; i < top.first + top.count; i++)
            if (!visit(user, i))
                return false;
        if (top.count > 0)
            continue;
        const wide_node *node = &tree->nodes[top.first];
        float at[WIDTH], entered[WIDTH];
        size_t bottom = depth;
        enter_boxes(node, r, at);
        for (size_t i = 0; i < WIDTH; i++) {
            if (at[i] > 1)
                continue;
            size_t k = depth++; /* the nearest on top */
            for (; k > bottom && entered[k - 1 - bottom] < at[i]; k--) {
                entered[k - bottom] = entered[k - 1 - bottom];
                stack[k] = stack[k - 1];
            }
            entered[k - bottom] = at[i];
            stack[k] = (entry){node->first[i], node->count[i]};
        }
    }
    return true;
}

bool sight_tree_query(const sight_tree *tree, const double p[3], const double q[3],
                      bvh_visit_rank *visit, void *user) {
    const ray r = ray_make(tree, p, q);
    return query(tree, &r, visit, user);
}
