/* SPDX-License-Identifier: Apache-2.0 */
/* Undirected graphs as adjacency lists. */
#pragma once

#include "core/context.h"

typedef struct curve_graph {
    size_t node_count;
    uint32_t *first; /* neighbours of v: next[first[v] .. first[v + 1]) */
    uint32_t *next;
} curve_graph;

/* The graph of the marked pairs, or of all if `marked` is NULL. Errors: MEMORY. */
starg_status graph_create(starg_context *context, size_t node_count, uint32_t (*links)[2],
                          const bool *marked, size_t link_count, curve_graph *graph);
void graph_free(curve_graph *graph);

static inline uint32_t graph_degree(const curve_graph *graph, size_t v) {
    return graph->first[v + 1] - graph->first[v];
}
