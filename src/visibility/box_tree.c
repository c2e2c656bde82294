/* SPDX-License-Identifier: Apache-2.0 */
/* A hierarchy with four children a node, whose boxes are floats: a segment is tested against the
 * four at once. A node takes the place of a node of the binary tree and its children; below it a
 * leaf's triangles are the children, with their own boxes.
 *
 * Nothing is lost to rounding: coordinates are relative to the centre of the whole and in units of
 * its extent, so at most a half but for rounding; boxes are larger by MARGIN on every side. The
 * segment of floats is off the exact one by less than 2^-22; the parameters where it enters and
 * leaves a slab carry three roundings, which shift its points by less than 2^-21 for parameters up
 * to 2; larger and negative ones are not compared with each other but through 0 and 1. A segment
 * that runs along a slab gets a tiny inverse slope, which moves it by less than all this.
 *
 * Cost: O(log n) where little is met; about 10 ns a node. */
#include "visibility/box_parts.h"

#include <math.h>

#include "core/memory.h"

static const char STAGE[] = "visibility";
static const float MARGIN = 0x1p-20F;
static const float STEEPEST = 1e30F;

static const uint32_t TRIANGLE = UINT32_C(1) << 31;

enum { STACK_SIZE = 256 };

/* Of GCC and Clang; what the processor does not have is made of what it has. */
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_bits __attribute__((vector_size(16)));

typedef struct tree_node {
    float lower[3][4], upper[3][4];
    uint32_t child[4]; /* a node, or a rank with the bit TRIANGLE */
} tree_node;

struct box_tree {
    starg_context *context;
    double centre[3], scale;
    size_t count;
    tree_node *nodes; /* root at 0 */
};

static float place(const box_tree *tree, double x, int k) {
    return (float)((x - tree->centre[k]) * tree->scale);
}

/* Sets child i of the node; without a box it is never met. */
static void set_child(const box_tree *tree, tree_node *node, int i, uint32_t child,
                      const bvh_box *box) {
    node->child[i] = child;
    for (int k = 0; k < 3; k++) {
        node->lower[k][i] = box == NULL ? 8 : place(tree, box->lower[k], k) - MARGIN;
        node->upper[k][i] = box == NULL ? 8 : place(tree, box->upper[k], k) + MARGIN;
    }
}

static bvh_box box_of_triangle(const bvh *from, uint32_t rank) {
    const uint32_t *corner = from->faces + 3 * (size_t)from->order[rank];
    bvh_box box;
    for (size_t k = 0; k < 3; k++) {
        const double a = from->vertices[3 * (size_t)corner[0] + k];
        const double b = from->vertices[3 * (size_t)corner[1] + k];
        const double c = from->vertices[3 * (size_t)corner[2] + k];
        box.lower[k] = fmin(a, fmin(b, c));
        box.upper[k] = fmax(a, fmax(b, c));
    }
    return box;
}

static bool is_leaf(const bvh *from, uint32_t index) {
    return from->nodes[index].count > 0;
}

/* Makes the node for a node of the binary tree, and those below it; returns its index. */
static uint32_t fold(box_tree *tree, const bvh *from, uint32_t index) {
    uint32_t own = (uint32_t)tree->count++, below[4];
    int count = 0;
    const bvh_node *node = &from->nodes[index];
    for (int i = 0; i < 4; i++)
        set_child(tree, &tree->nodes[own], i, 0, NULL);
    if (is_leaf(from, index)) {
        for (uint32_t i = 0; i < node->count; i++) {
            bvh_box box = box_of_triangle(from, node->first + i);
            set_child(tree, &tree->nodes[own], (int)i, TRIANGLE | (node->first + i), &box);
        }
        return own;
    }
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t child = node->first + side;
        if (is_leaf(from, child)) {
            below[count++] = child;
            continue;
        }
        below[count++] = from->nodes[child].first;
        below[count++] = from->nodes[child].first + 1;
    }
    for (int i = 0; i < count; i++) {
        uint32_t child = fold(tree, from, below[i]);
        set_child(tree, &tree->nodes[own], i, child, &from->nodes[below[i]].box);
    }
    return own;
}

starg_status box_tree_create(starg_context *context, const bvh *from, const double centre[3],
                             double extent, box_tree **out) {
    SCOPED_BY(box_tree_drop) box_tree *tree = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, tree, 1);
    tree->context = context;
    tree->scale = 1 / extent;
    for (int k = 0; k < 3; k++)
        tree->centre[k] = centre[k];
    NEW(context, STAGE, tree->nodes, from->node_count);
    fold(tree, from, 0);
    *out = tree;
    tree = NULL;
    return STARG_OK;
}

void box_tree_free(box_tree *tree) {
    if (tree == NULL)
        return;
    RELEASE(tree->nodes, tree);
}

typedef struct ray {
    float origin[3], inverse[3];
} ray;

static inline four load(const float *p) {
    four x;
    memcpy(&x, p, sizeof x);
    return x;
}

static inline four choose(four_bits when, four a, four b) {
    return (four)(((four_bits)a & when) | ((four_bits)b & ~when));
}

/* Bits of the children that the segment may meet. Which side of a slab comes first is the same for
 * all four. */
static unsigned met(const tree_node *node, const ray *r) {
    four enter = {0, 0, 0, 0}, leave = {1, 1, 1, 1};
    for (int k = 0; k < 3; k++) {
        four low = (load(node->lower[k]) - r->origin[k]) * r->inverse[k];
        four high = (load(node->upper[k]) - r->origin[k]) * r->inverse[k];
        four near = r->inverse[k] < 0 ? high : low, far = r->inverse[k] < 0 ? low : high;
        enter = choose(near > enter, near, enter);
        leave = choose(far < leave, far, leave);
    }
    four_bits hit = enter <= leave;
    return (unsigned)((hit[0] & 1) | (hit[1] & 2) | (hit[2] & 4) | (hit[3] & 8));
}

bool box_tree_query(const box_tree *tree, const double p[3], const double q[3],
                    bvh_visit_rank *visit, void *user) {
    uint32_t stack[STACK_SIZE];
    int depth = 0;
    ray r;
    for (int k = 0; k < 3; k++) {
        r.origin[k] = place(tree, p[k], k);
        float slope = place(tree, q[k], k) - r.origin[k];
        r.inverse[k] = fabsf(slope) > 1 / STEEPEST ? 1 / slope : STEEPEST;
    }
    stack[depth++] = 0;
    while (depth > 0) {
        const tree_node *node = &tree->nodes[stack[--depth]];
        for (unsigned bits = met(node, &r); bits != 0; bits &= bits - 1) {
            uint32_t child = node->child[__builtin_ctz(bits)];
            if ((child & TRIANGLE) == 0)
                stack[depth++] = child;
            else if (!visit(user, child & ~TRIANGLE))
                return false;
        }
    }
    return true;
}
