/* SPDX-License-Identifier: Apache-2.0 */
/* The cost f(g, n): how many nodes depend on node n, directly or not [YL11, section 4].
 *
 * The paper accumulates it from the leaves to the guard, in linear time. A sum over all dependents
 * would count a node once for each way that leads to it, and grow beyond all bounds; so a node
 * hands on its count in equal shares to its predecessors. Then the costs of the nodes next to the
 * guard add up to the number of all that can be reached, and where each node has one predecessor f
 * is the number of its descendants (and itself).
 *
 * Stages: count the edges that leave each node; take nodes without any, hand on their counts, take
 * away the edges that enter them. Nodes on a cycle, which tetrahedra of general position can have
 * but seldom do, keep what has reached them. Cost: O(n). */
#include "star/paper/state.h"

/* The predecessors that a visible tetrahedron waits for; a repeated one counts as often. */
static int find_predecessors(const paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                             uint32_t out[4]) {
    int count = 0;
    for (int k = 0; k < 4; k++) {
        uint32_t p = dependency_predecessor(s, g, tetrahedron, k);
        if (p != PAPER_NONE)
            out[count++] = p;
    }
    return count;
}

static bool is_node(const paper_state *s, const paper_guard *g, uint32_t tetrahedron) {
    return dependency_seen(s, g, tetrahedron) == 4;
}

/* Counts edges: 1 is added for a node itself, so that 0 stands for what is no node. */
static void count_edges(const paper_state *s, paper_guard *g, const uint32_t *domain, size_t count,
                        uint32_t *waiting) {
    uint32_t before[4];
    for (size_t i = 0; i < count; i++) {
        g->cost[domain[i]] = 0;
        waiting[domain[i]] = is_node(s, g, domain[i]);
    }
    for (size_t i = 0; i < count; i++) {
        int n = waiting[domain[i]] > 0 ? find_predecessors(s, g, domain[i], before) : 0;
        for (int k = 0; k < n; k++)
            if (waiting[before[k]] > 0)
                waiting[before[k]]++;
    }
}

void cost_accumulate(const paper_state *s, paper_guard *g, const uint32_t *domain, size_t count,
                     uint32_t *waiting, uint32_t *stack) {
    size_t top = 0;
    uint32_t before[4];
    count_edges(s, g, domain, count, waiting);
    for (size_t i = 0; i < count; i++)
        if (waiting[domain[i]] == 1)
            stack[top++] = domain[i];
    while (top > 0) {
        uint32_t t = stack[--top];
        g->cost[t] += 1;
        int n = find_predecessors(s, g, t, before);
        for (int k = 0; k < n; k++) {
            if (waiting[before[k]] == 0)
                continue;
            g->cost[before[k]] += g->cost[t] / (float)n;
            if (--waiting[before[k]] == 1)
                stack[top++] = before[k];
        }
    }
    for (size_t i = 0; i < count; i++)
        waiting[domain[i]] = 0;
}
