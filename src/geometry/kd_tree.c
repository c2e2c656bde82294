/* SPDX-License-Identifier: Apache-2.0 */
/* Implicit k-d tree [Bentley 1975]: the middle of a range of `order` is its median along the axis
 * of its depth (axes alternate); entries before it are not above it, entries behind it not below.
 *
 * Invariant: a range is skipped only if its rounded distance along one axis exceeds the best one;
 * rounding is monotone, so no nearer point is lost.
 *
 * Cost: O(n log n) on average to build, O(log n) per query for well distributed points. */
#include "geometry/kd_tree.h"

#include <math.h>

#include "core/memory.h"

static double coordinate(const kd_tree *tree, uint32_t point, int axis) {
    return tree->points[(size_t)point * (size_t)tree->dimension + (size_t)axis];
}

static bool before(const kd_tree *tree, int axis, uint32_t a, uint32_t b) {
    double x = coordinate(tree, a, axis), y = coordinate(tree, b, axis);
    return x < y || (x == y && a < b);
}

/* Quickselect: order[middle] becomes what sorting would put there. */
static void select_median(const kd_tree *tree, int axis, size_t low, size_t high, size_t middle) {
    uint32_t *order = tree->order;
    while (high - low > 1) {
        uint32_t pivot = order[low + (high - low) / 2];
        size_t i = low, j = high - 1;
        while (i <= j) {
            while (before(tree, axis, order[i], pivot))
                i++;
            while (before(tree, axis, pivot, order[j]))
                j--;
            if (i > j)
                break;
            uint32_t swap = order[i];
            order[i++] = order[j];
            order[j] = swap;
            if (j-- == 0)
                break;
        }
        if (j != SIZE_MAX && middle <= j)
            high = j + 1;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

static void build(const kd_tree *tree, size_t low, size_t high, int axis) {
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        select_median(tree, axis, low, high, middle);
        axis = (axis + 1) % tree->dimension;
        build(tree, low, middle, axis);
        low = middle + 1;
    }
}

starg_status kd_tree_create(starg_context *context, const double *points, size_t count,
                            int dimension, kd_tree *out) {
    *out = (kd_tree){.points = points, .count = count, .dimension = dimension};
    NEW(context, "k-d tree", out->order, count);
    for (size_t i = 0; i < count; i++)
        out->order[i] = (uint32_t)i;
    build(out, 0, count, 0);
    return STARG_OK;
}

void kd_tree_free(kd_tree *tree) {
    RELEASE(tree->order);
    *tree = (kd_tree){0};
}

typedef struct search {
    const kd_tree *tree;
    const double *p;
    double best;
    uint32_t point;
} search;

static void look_at(search *s, uint32_t point) {
    double squared = 0;
    for (int k = 0; k < s->tree->dimension; k++) {
        double d = coordinate(s->tree, point, k) - s->p[k];
        squared += d * d;
    }
    if (squared < s->best || (squared == s->best && point < s->point)) {
        s->best = squared;
        s->point = point;
    }
}

/* Searches the side of p first, then the other if it may hold a point at least as near. */
static void look_in(search *s, size_t low, size_t high, int axis) {
    if (low >= high)
        return;
    size_t middle = low + (high - low) / 2;
    uint32_t point = s->tree->order[middle];
    double d = s->p[axis] - coordinate(s->tree, point, axis);
    int next = (axis + 1) % s->tree->dimension;
    look_at(s, point);
    if (d < 0)
        look_in(s, low, middle, next);
    else
        look_in(s, middle + 1, high, next);
    if (d * d > s->best)
        return;
    if (d < 0)
        look_in(s, middle + 1, high, next);
    else
        look_in(s, low, middle, next);
}

size_t kd_tree_nearest(const kd_tree *tree, const double *p, double *squared) {
    search s = {.tree = tree, .p = p, .best = INFINITY, .point = 0};
    look_in(&s, 0, tree->count, 0);
    *squared = s.best;
    return s.point;
}
