/* SPDX-License-Identifier: Apache-2.0 */
/* Pruning: decides which branches of an eroded medial axis are features. */
#pragma once

#include "skeleton/complex.h"
#include "skeleton/graph.h"

typedef struct pruned_graph {
    bool *kept;
    uint32_t *owner; /* the kept node that represents each node; itself if kept */
} pruned_graph;

/* `values`: the medial geodesic function of the complex's edges. Keeps all loops, and branches that
 * leave their joint's ball as limbs do, by at least `reach` - 1 half widths of the solid at the
 * joint and some `spacing`s of the samples. Every component keeps a node, except components of
 * nodes that are not left, which are dropped. Errors: MEMORY. */
starg_status prune_graph(starg_context *context, const starg_solid *solid,
                         const medial_complex *complex, const curve_graph *graph,
                         const bool *node_left, const double *values, double reach, double spacing,
                         pruned_graph *pruned);
void prune_free(pruned_graph *pruned);
