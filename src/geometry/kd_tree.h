/* SPDX-License-Identifier: Apache-2.0 */
/* k-d tree for nearest neighbours, up to four coordinates. */
#pragma once

#include "core/context.h"

enum { KD_TREE_MOST_DIMENSIONS = 4 };

typedef struct kd_tree {
    const double *points; /* count x dimension, borrowed; finite */
    size_t count;
    int dimension;
    uint32_t *order; /* the middle of each range splits it, along the axis of its depth */
} kd_tree;

/* Errors: MEMORY. */
starg_status kd_tree_create(starg_context *context, const double *points, size_t count,
                            int dimension, kd_tree *out) STARG_PRIVATE(kd_tree_create);
void kd_tree_free(kd_tree *tree) STARG_PRIVATE(kd_tree_free);

/* The point nearest to p, on ties that of the lowest index; `squared` receives the rounded squared
 * distance. The tree must not be empty. */
size_t kd_tree_nearest(const kd_tree *tree, const double *p, double *squared)
    STARG_PRIVATE(kd_tree_nearest);
