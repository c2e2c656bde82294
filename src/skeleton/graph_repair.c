/* SPDX-License-Identifier: Apache-2.0 */
/* With coarse samples, a lost face may leave a hole in the interior region, which makes a loop of a
 * few tetrahedra. The number of real loops is known from the surface (its genus), so the shortest
 * loops in excess of it are taken for such holes and cut.
 *
 * The shortest loop of a graph leaves any spanning forest, so it is the shortest path between the
 * ends of some link outside one; breadth-first searches bounded by the best length so far find it.
 *
 * A cut leaves the forest unchanged and shortens no path, so earlier search results remain lower
 * bounds; most links need no new search.
 *
 * Cost: linear, plus the searches, which end early, and for each loop cut the number of loops. */
#include "skeleton/skeleton.h"

#include "mesh/topology.h"

static const char STAGE[] = "skeleton loops";

/* A link outside the forest. */
typedef struct closing_link {
    uint32_t link;
    uint32_t least; /* lower bound on the links of the path around it */
} closing_link;

typedef struct searcher {
    curve_graph graph;
    STARG_ARRAY(closing_link) closing; /* in the order of links */
    uint32_t *queue, *depth, *stamp;
    uint32_t stamps;
} searcher;

/* Number of links on the shortest path from a to b besides the link between them; `limit` if not
 * shorter. */
static uint32_t way_around(searcher *s, uint32_t a, uint32_t b, uint32_t limit) {
    size_t count = 0;
    s->stamp[a] = ++s->stamps;
    s->depth[a] = 0;
    s->queue[count++] = a;
    for (size_t i = 0; i < count; i++) {
        uint32_t v = s->queue[i];
        if (s->depth[v] + 1 >= limit)
            break;
        for (uint32_t j = s->graph.first[v]; j < s->graph.first[v + 1]; j++) {
            uint32_t w = s->graph.next[j];
            if (s->stamp[w] == s->stamps || (v == a && w == b))
                continue;
            if (w == b)
                return s->depth[v] + 1;
            s->stamp[w] = s->stamps;
            s->depth[w] = s->depth[v] + 1;
            s->queue[count++] = w;
        }
    }
    return limit;
}

static starg_status find_closing(starg_context *context, const medial_complex *complex,
                                 const bool *link_left, searcher *s) {
    SCOPED uint32_t *sets = NULL;
    NEW(context, STAGE, sets, complex->node_count);
    sets_make(sets, complex->node_count);
    for (uint32_t l = 0; l < complex->link_count; l++) {
        uint32_t a = complex->links[l][0], b = complex->links[l][1];
        if (!link_left[l])
            continue;
        if (sets_find(sets, a) != sets_find(sets, b))
            sets_join(sets, a, b);
        else
            PUSH(context, STAGE, &s->closing, ((closing_link){.link = l}));
    }
    return STARG_OK;
}

/* The first closing link of a shortest loop, or their number. */
static size_t find_shortest(searcher *s, const medial_complex *complex) {
    size_t best = s->closing.count;
    uint32_t shortest = UINT32_MAX;
    for (size_t i = 0; i < s->closing.count; i++) {
        closing_link *c = &s->closing.data[i];
        if (c->least >= shortest)
            continue;
        c->least = way_around(s, complex->links[c->link][0], complex->links[c->link][1], shortest);
        if (c->least < shortest) {
            shortest = c->least;
            best = i;
        }
    }
    return best;
}

/* A node listed as its own neighbour is ignored: it was visited already. */
static void part_from(curve_graph *graph, uint32_t v, uint32_t w) {
    uint32_t j = graph->first[v];
    while (graph->next[j] != w)
        j++;
    graph->next[j] = v;
}

starg_status graph_repair_parts(starg_context *context, const medial_complex *complex,
                                bool *link_left, bool *node_left, size_t wanted) {
    SCOPED uint32_t *sets = NULL;
    SCOPED size_t *sizes = NULL;
    SCOPED bool *chosen = NULL;
    size_t count = complex->node_count;
    NEW(context, STAGE, sets, count);
    NEW_ZERO(context, STAGE, sizes, count);
    NEW_ZERO(context, STAGE, chosen, count);
    sets_make(sets, count);
    for (size_t l = 0; l < complex->link_count; l++)
        if (link_left[l])
            sets_join(sets, complex->links[l][0], complex->links[l][1]);
    for (uint32_t v = 0; v < count; v++)
        sizes[sets_find(sets, v)]++;
    for (size_t i = 0; i < wanted; i++) {
        size_t best = count;
        for (size_t v = 0; v < count; v++)
            if (sets[v] == v && !chosen[v] && (best == count || sizes[v] > sizes[best]))
                best = v;
        if (best < count)
            chosen[best] = true;
    }
    for (uint32_t v = 0; v < count; v++)
        node_left[v] = chosen[sets_find(sets, v)];
    for (size_t l = 0; l < complex->link_count; l++)
        link_left[l] = link_left[l] && node_left[complex->links[l][0]];
    return STARG_OK;
}

starg_status graph_repair_loops(starg_context *context, const medial_complex *complex,
                                bool *link_left, size_t excess) {
    starg_status status = STARG_OK;
    searcher s = {0};
    STARG_NEW(context, STAGE, s.queue, complex->node_count);
    STARG_NEW(context, STAGE, s.depth, complex->node_count);
    STARG_NEW_ZERO(context, STAGE, s.stamp, complex->node_count);
    STARG_TRY(graph_create(context, complex->node_count, complex->links, link_left,
                           complex->link_count, &s.graph));
    STARG_TRY(find_closing(context, complex, link_left, &s));
    for (size_t i = 0; i < excess; i++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        size_t best = find_shortest(&s, complex);
        if (best == s.closing.count)
            break;
        uint32_t link = s.closing.data[best].link;
        link_left[link] = false;
        part_from(&s.graph, complex->links[link][0], complex->links[link][1]);
        part_from(&s.graph, complex->links[link][1], complex->links[link][0]);
        s.closing.count--;
        for (size_t j = best; j < s.closing.count; j++)
            s.closing.data[j] = s.closing.data[j + 1];
    }
done:
    graph_free(&s.graph);
    RELEASE(s.closing.data, s.queue, s.depth, s.stamp);
    return status;
}
