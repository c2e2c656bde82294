/* SPDX-License-Identifier: Apache-2.0 */
/* Pruning: which branches of an eroded medial axis are features of the shape. */
#ifndef STARG_SKELETON_PRUNE_H
#define STARG_SKELETON_PRUNE_H

#include "skeleton/complex.h"
#include "skeleton/graph.h"

typedef struct pruned_graph {
    bool *kept;
    uint32_t *owner; /* the kept node that each node stands behind; itself when kept */
} pruned_graph;

/* `values`: the medial geodesic function of the complex's edges. Keeps all loops, and branches that
 * go beyond their joint's ball as limbs do, at least `reach` - 1 half widths of the solid at the
 * joint and some `spacing`s of the samples. Every connected part keeps a node, unless it is one of
 * nodes that are not left, which all are dropped. Errors: MEMORY. */
starg_status prune_graph(starg_context *context, const medial_complex *complex,
                         const curve_graph *graph, const bool *node_left, const double *values,
                         double reach, double spacing, pruned_graph *pruned);
void prune_free(starg_context *context, pruned_graph *pruned);

#endif
