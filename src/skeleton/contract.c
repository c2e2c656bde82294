/* SPDX-License-Identifier: Apache-2.0 */
/* Contraction of the medial complex where centres coincide.
 *
 * Problem: the vertices of drawn solids are cospherical, ring by ring and cube by cube. Delaunay's
 * cell of such points is one polytope, its Voronoi vertex one point, but cut into tetrahedra it is
 * many nodes at one place, with links of no length between them; along them every measure of
 * lengths, ends and joints fails. Symbolic perturbation leaves it so: it settles the topology of
 * the cuts and not their geometry. Shaken a little, the nodes lie close together instead.
 *
 * Stages: nodes joined by links are gathered about the largest ball whose centre is within a small
 * share of its radius; not farther, so that a finely sampled axis stays an axis. A cluster, with
 * the links and sheets within, is then contracted to a point if it is contractible, hence the
 * homotopy type stays, whatever the coordinates are. It is if it collapses to a tree: again and
 * again a sheet and a link that bounds no other. In which order does not matter. A cluster that
 * does not (it holds a loop or a void) is given up.
 *
 * Every sheet and link that remains is as before, but that its ends may be clusters: a sheet with a
 * free link still collapses. Between two clusters there may be several links.
 *
 * Cost: linear, and sorting. */
#include "skeleton/skeleton.h"

#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "medial complex";

/* Of the radius: nearer centres are one. */
static const double SHARE = 0.01;

typedef struct seed {
    double radius;
    uint32_t node;
} seed;

typedef struct contractor {
    starg_context *context;
    medial_complex *complex;
    uint32_t *leader; /* per node: that of its cluster */
    bool *given_up;   /* per leader */
    uint8_t *pending; /* per link: sheets within its cluster that are not collapsed */
    bool *within;     /* per edge: are all links of its sheet in one cluster, and is it a sheet? */
    bool *collapsed;  /* per edge */
    STARG_ARRAY(uint32_t) queue;
} contractor;

static bool is_near(const medial_complex *c, uint32_t centre, uint32_t other) {
    double least = SHARE * c->radii[centre];
    return vec3_distance_squared(c->centres[centre], c->centres[other]) <= least * least;
}

static int compare_seeds(const void *left, const void *right) {
    const seed *a = left, *b = right;
    if (a->radius != b->radius)
        return a->radius > b->radius ? -1 : 1;
    return (a->node > b->node) - (a->node < b->node);
}

/* Nodes that are near to a neighbour, by falling radius. */
static starg_status find_seeds(const contractor *k, seed **seeds, size_t *count) {
    const medial_complex *c = k->complex;
    SCOPED bool *close = NULL;
    NEW_ZERO(k->context, STAGE, close, c->node_count);
    NEW(k->context, STAGE, *seeds, c->node_count);
    for (size_t l = 0; l < c->link_count; l++) {
        uint32_t a = c->links[l][0], b = c->links[l][1];
        if (is_near(c, a, b) || is_near(c, b, a))
            close[a] = close[b] = true;
    }
    for (uint32_t v = 0; v < c->node_count; v++)
        if (close[v])
            (*seeds)[(*count)++] = (seed){c->radii[v], v};
    qsort(*seeds, *count, sizeof **seeds, compare_seeds);
    return STARG_OK;
}

/* Gathers the nodes that links join to `first` within its reach. */
static starg_status grow(contractor *k, const curve_graph *graph, uint32_t first) {
    k->queue.count = 0;
    k->leader[first] = first;
    PUSH(k->context, STAGE, &k->queue, first);
    for (size_t i = 0; i < k->queue.count; i++) {
        uint32_t v = k->queue.data[i];
        for (uint32_t j = graph->first[v]; j < graph->first[v + 1]; j++) {
            uint32_t w = graph->next[j];
            if (k->leader[w] != EDGE_NONE || !is_near(k->complex, first, w))
                continue;
            k->leader[w] = first;
            PUSH(k->context, STAGE, &k->queue, w);
        }
    }
    return STARG_OK;
}

static starg_status find_clusters(contractor *k) {
    const medial_complex *c = k->complex;
    SCOPED_BY(graph_free) curve_graph graph = {0};
    SCOPED seed *seeds = NULL;
    size_t count = 0;
    NEW(k->context, STAGE, k->leader, c->node_count);
    memset(k->leader, 0xff, c->node_count * sizeof *k->leader);
    TRY(find_seeds(k, &seeds, &count));
    TRY(graph_create(k->context, c->node_count, c->links, NULL, c->link_count, &graph));
    for (size_t i = 0; i < count; i++)
        if (k->leader[seeds[i].node] == EDGE_NONE)
            TRY(grow(k, &graph, seeds[i].node));
    for (uint32_t v = 0; v < c->node_count; v++)
        if (k->leader[v] == EDGE_NONE)
            k->leader[v] = v;
    return STARG_OK;
}

static bool is_within(const contractor *k, size_t link) {
    const uint32_t *ends = k->complex->links[link];
    return k->leader[ends[0]] == k->leader[ends[1]];
}

static void find_sheets(contractor *k) {
    const medial_complex *c = k->complex;
    memcpy(k->within, c->sheet, c->edge_count * sizeof *k->within);
    for (size_t l = 0; l < c->link_count; l++)
        for (int j = 0; j < 3 && !is_within(k, l); j++)
            k->within[c->link_edges[l][j]] = false;
}

/* Collapses the sheets of all clusters. */
static starg_status collapse(contractor *k) {
    const medial_complex *c = k->complex;
    k->queue.count = 0;
    for (uint32_t l = 0; l < c->link_count; l++) {
        for (int j = 0; j < 3; j++)
            k->pending[l] += k->within[c->link_edges[l][j]];
        if (k->pending[l] == 1)
            PUSH(k->context, STAGE, &k->queue, l);
    }
    for (size_t i = 0; i < k->queue.count; i++) {
        uint32_t link = k->queue.data[i];
        for (int j = 0; j < 3 && k->pending[link] == 1; j++) {
            uint32_t edge = c->link_edges[link][j];
            if (!k->within[edge] || k->collapsed[edge])
                continue;
            k->collapsed[edge] = true;
            for (uint32_t n = c->first_link[edge]; n < c->first_link[edge + 1]; n++)
                if (--k->pending[c->edge_links[n]] == 1)
                    PUSH(k->context, STAGE, &k->queue, c->edge_links[n]);
        }
    }
    return STARG_OK;
}

/* Clusters that have not collapsed to a tree: to a graph with one more node than links, since they
 * are connected. */
static starg_status give_up(contractor *k) {
    const medial_complex *c = k->complex;
    SCOPED uint32_t *links = NULL; /* of a cluster, less its nodes and sheets, modulo 2^32 */
    NEW_ZERO(k->context, STAGE, links, c->node_count);
    for (size_t v = 0; v < c->node_count; v++)
        links[k->leader[v]]--;
    for (size_t l = 0; l < c->link_count; l++)
        links[k->leader[c->links[l][0]]] += is_within(k, l);
    for (uint32_t edge = 0; edge < c->edge_count; edge++)
        if (k->within[edge]) {
            uint32_t leader = k->leader[c->links[c->edge_links[c->first_link[edge]]][0]];
            links[leader]--;
            k->given_up[leader] = k->given_up[leader] || !k->collapsed[edge];
        }
    for (size_t v = 0; v < c->node_count; v++)
        k->given_up[v] = k->given_up[v] || links[v] + 1 != 0;
    return STARG_OK;
}

/* Numbers clusters by their first nodes. */
static starg_status take_nodes(contractor *k) {
    medial_complex *c = k->complex;
    SCOPED uint32_t *numbers = NULL; /* of leaders */
    SCOPED double(*centres)[3] = NULL, *radii = NULL;
    size_t count = 0;
    NEW(k->context, STAGE, numbers, c->node_count);
    NEW(k->context, STAGE, centres, c->node_count);
    NEW(k->context, STAGE, radii, c->node_count);
    memset(numbers, 0xff, c->node_count * sizeof *numbers);
    for (uint32_t v = 0; v < c->node_count; v++) {
        uint32_t leader = k->given_up[k->leader[v]] ? v : k->leader[v];
        if (numbers[leader] == EDGE_NONE) {
            vec3_copy(c->centres[leader], centres[count]);
            radii[count] = c->radii[leader];
            numbers[leader] = (uint32_t)count++;
        }
        c->node_of[v] = numbers[leader];
    }
    memcpy(c->centres, centres, count * sizeof *centres);
    memcpy(c->radii, radii, count * sizeof *radii);
    c->node_count = count;
    return STARG_OK;
}

/* Keeps the links between different nodes and all but the contracted sheets. */
static void take_links(contractor *k) {
    medial_complex *c = k->complex;
    size_t count = 0;
    for (size_t l = 0; l < c->link_count; l++) {
        uint32_t a = c->links[l][0], b = c->links[l][1];
        bool kept = !is_within(k, l) || k->given_up[k->leader[a]];
        for (int j = 0; !kept && j < 3; j++)
            if (k->within[c->link_edges[l][j]])
                c->sheet[c->link_edges[l][j]] = false;
        if (!kept)
            continue;
        c->links[count][0] = c->node_of[a];
        c->links[count][1] = c->node_of[b];
        memmove(c->link_edges[count++], c->link_edges[l], sizeof *c->link_edges);
    }
    c->link_count = count;
}

starg_status contract_complex(starg_context *context, medial_complex *complex) {
    starg_status status = STARG_OK;
    contractor k = {.context = context, .complex = complex};
    STARG_TRY(find_clusters(&k));
    STARG_NEW_ZERO(context, STAGE, k.given_up, complex->node_count);
    STARG_NEW_ZERO(context, STAGE, k.pending, complex->link_count);
    STARG_NEW(context, STAGE, k.within, complex->edge_count);
    STARG_NEW_ZERO(context, STAGE, k.collapsed, complex->edge_count);
    find_sheets(&k);
    STARG_TRY(collapse(&k));
    STARG_TRY(give_up(&k));
    STARG_TRY(take_nodes(&k));
    take_links(&k);
    complex_invert(complex);
done:
    RELEASE(k.leader, k.given_up, k.pending, k.within, k.collapsed, k.queue.data);
    return status;
}
