/* Where samples are coarse, a hole in the region inside may remain at a lost face; it gives a loop
 * of a few tetrahedra. How many loops are real is known from the surface (its genus), so that the
 * shortest ones above that number are taken for such holes and cut.
 *
 * The shortest loop of a graph leaves any spanning forest, so it is the shortest way between the
 * ends of some link outside one; breadth-first searches no longer than the best so far find it.
 *
 * Cost: linear for each loop cut, plus the searches, which end early. */
#include "skeleton/mend.h"

#include "core/memory.h"
#include "mesh/topology.h"
#include "skeleton/graph.h"

static const char STAGE[] = "skeleton loops";

typedef struct searcher {
    const curve_graph *graph;
    uint32_t *queue, *depth, *stamp;
    uint32_t stamps;
} searcher;

/* Links on the shortest way from a to b besides the link between them; `limit` if not fewer. */
static uint32_t way_around(searcher *s, uint32_t a, uint32_t b, uint32_t limit) {
    size_t count = 0;
    s->stamp[a] = ++s->stamps;
    s->depth[a] = 0;
    s->queue[count++] = a;
    for (size_t i = 0; i < count; i++) {
        uint32_t v = s->queue[i];
        if (s->depth[v] + 1 >= limit)
            break;
        for (uint32_t j = s->graph->first[v]; j < s->graph->first[v + 1]; j++) {
            uint32_t w = s->graph->next[j];
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

/* A link of the shortest loop, or link_count. `sets` is scratch. */
static size_t find_shortest(searcher *s, const medial_complex *complex, const bool *link_left,
                            uint32_t *sets) {
    size_t best = complex->link_count;
    uint32_t shortest = UINT32_MAX;
    sets_make(sets, complex->node_count);
    for (size_t l = 0; l < complex->link_count; l++) {
        uint32_t a = complex->links[l][0], b = complex->links[l][1];
        if (!link_left[l])
            continue;
        if (sets_find(sets, a) != sets_find(sets, b)) {
            sets_join(sets, a, b);
            continue;
        }
        uint32_t way = way_around(s, a, b, shortest);
        if (way < shortest) {
            shortest = way;
            best = l;
        }
    }
    return best;
}

starg_status mend_parts(starg_context *context, const medial_complex *complex, bool *link_left,
                        bool *node_left, size_t wanted) {
    starg_status status = STARG_OK;
    uint32_t *sets = NULL;
    size_t *sizes = NULL;
    bool *chosen = NULL;
    size_t count = complex->node_count;
    STARG_NEW(context, STAGE, sets, count);
    STARG_NEW_ZERO(context, STAGE, sizes, count);
    STARG_NEW_ZERO(context, STAGE, chosen, count);
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
done:
    starg_release(context, sets);
    starg_release(context, sizes);
    starg_release(context, chosen);
    return status;
}

starg_status mend_loops(starg_context *context, const medial_complex *complex, bool *link_left,
                        size_t excess) {
    starg_status status = STARG_OK;
    curve_graph graph = {0};
    searcher s = {.graph = &graph};
    uint32_t *sets = NULL;
    STARG_NEW(context, STAGE, sets, complex->node_count);
    STARG_NEW(context, STAGE, s.queue, complex->node_count);
    STARG_NEW(context, STAGE, s.depth, complex->node_count);
    STARG_NEW_ZERO(context, STAGE, s.stamp, complex->node_count);
    for (size_t i = 0; i < excess; i++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        graph_free(context, &graph);
        STARG_TRY(graph_create(context, complex->node_count, complex->links, link_left,
                               complex->link_count, &graph));
        size_t link = find_shortest(&s, complex, link_left, sets);
        if (link == complex->link_count)
            break;
        link_left[link] = false;
    }
done:
    graph_free(context, &graph);
    starg_release(context, sets);
    starg_release(context, s.queue);
    starg_release(context, s.depth);
    starg_release(context, s.stamp);
    return status;
}
