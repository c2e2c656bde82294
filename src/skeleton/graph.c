/* SPDX-License-Identifier: Apache-2.0 */
/* Adjacency lists by counting sort; each list in the order of the links. Linear. */
#include "skeleton/skeleton.h"

#include "core/memory.h"

static const char STAGE[] = "curve graph";

starg_status graph_create(starg_context *context, size_t node_count, uint32_t (*links)[2],
                          const bool *marked, size_t link_count, curve_graph *graph) {
    *graph = (curve_graph){.node_count = node_count};
    NEW_ZERO(context, STAGE, graph->first, node_count + 2);
    NEW(context, STAGE, graph->next, 2 * link_count);
    uint32_t *end = graph->first + 1; /* of each list as it fills */
    for (size_t l = 0; l < link_count; l++)
        for (int k = 0; (marked == NULL || marked[l]) && k < 2; k++)
            end[links[l][k] + 1]++;
    for (size_t v = 0; v < node_count; v++)
        end[v + 1] += end[v];
    for (size_t l = 0; l < link_count; l++)
        for (int k = 0; (marked == NULL || marked[l]) && k < 2; k++)
            graph->next[end[links[l][k]]++] = links[l][1 - k];
    return STARG_OK;
}

void graph_free(curve_graph *graph) {
    RELEASE(graph->first, graph->next);
    *graph = (curve_graph){0};
}
