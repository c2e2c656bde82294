/* SPDX-License-Identifier: Apache-2.0 */
/* Connected parts of a piece made pieces of their own.
 *
 * Stages: facets with an edge in common are in one part (edges sorted, union-find); parts numbered
 * in the order of the facets; their volumes: a negative one is the surface of a cavity; facets
 * change hands. Parts that only touch, at a vertex, are two: nothing inside of both sees all around
 * it, and no plane that leaves the vertex on one side would part them.
 *
 * Cost: that of sorting the piece's edges. */
#include "star/strict/partition/separate.h"

#include <stdlib.h>

#include "geometry/vec3.h"

/* Of a facet of the piece, which are numbered from 0 in the order of the index. */
typedef struct facet_edge {
    uint64_t ends;
    uint32_t facet;
} facet_edge;

typedef STARG_ARRAY(facet_edge) facet_edges;

typedef struct separator {
    partition *p;
    uint32_t number;
    size_t count; /* facets */
    facet_edges edges;
    uint32_t *leader; /* by facet */
    uint32_t *part;   /* by leading facet: 1 + part, 0: none yet */
    STARG_ARRAY(double) volumes;
} separator;

static int compare_edges(const void *a, const void *b) {
    const facet_edge *x = a, *y = b;
    if (x->ends != y->ends)
        return x->ends < y->ends ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

/* Sorted, so that those of neighbours come together. */
static starg_status list_edges(const partition *p, uint32_t number, facet_edges *edges) {
    starg_status status = STARG_OK;
    uint32_t first = p->start.data[number];
    for (uint32_t k = first; k < p->start.data[number + 1]; k++) {
        const uint32_t *c = p->facets.data[p->index.data[k] / 2].corners;
        for (int i = 0; i < 3; i++) {
            uint64_t a = c[i], b = c[(i + 1) % 3];
            const facet_edge edge = {.ends = a < b ? a << 32 | b : b << 32 | a, .facet = k - first};
            STARG_PUSH(p->context, PARTITION_STAGE, edges, edge);
        }
    }
    if (edges->count > 0)
        qsort(edges->data, edges->count, sizeof *edges->data, compare_edges);
done:
    return status;
}

static uint32_t find_leader(uint32_t *leader, uint32_t i) {
    while (leader[i] != i)
        i = leader[i] = leader[leader[i]];
    return i;
}

static void link_neighbours(separator *s) {
    const facet_edge *edges = s->edges.data;
    for (size_t i = 0; i < s->count; i++)
        s->leader[i] = (uint32_t)i;
    for (size_t i = 1; i < s->edges.count; i++)
        if (edges[i].ends == edges[i - 1].ends)
            s->leader[find_leader(s->leader, edges[i].facet)] =
                find_leader(s->leader, edges[i - 1].facet);
}

static starg_status number_parts(separator *s) {
    starg_status status = STARG_OK;
    partition *p = s->p;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        uint32_t *part = &s->part[find_leader(s->leader, i)];
        if (*part == 0) {
            STARG_PUSH(p->context, PARTITION_STAGE, &s->volumes, 0);
            *part = (uint32_t)s->volumes.count;
        }
        s->volumes.data[*part - 1] +=
            vec3_triple(partition_unit(p, c[0]), partition_unit(p, c[1]), partition_unit(p, c[2])) /
            6;
    }
done:
    return status;
}

static bool has_cavity(const separator *s) {
    for (size_t i = 0; i < s->volumes.count; i++)
        if (s->volumes.data[i] <= 0)
            return true;
    return false;
}

static starg_status hand_out(separator *s) {
    starg_status status = STARG_OK;
    partition *p = s->p;
    uint32_t first = (uint32_t)p->pieces.count - 1; /* the second part's number is one more */
    for (size_t i = 1; i < s->volumes.count; i++) {
        const piece fresh = {.volume = s->volumes.data[i], .stamp = ++p->stamps};
        STARG_PUSH(p->context, PARTITION_STAGE, &p->pieces, fresh);
    }
    p->pieces.data[s->number].volume = s->volumes.data[0];
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i];
        uint32_t part = s->part[find_leader(s->leader, i)] - 1;
        if (part > 0)
            p->facets.data[entry / 2].side[entry % 2] = first + part;
    }
    STARG_TRY(partition_build_index(p));
done:
    return status;
}

starg_status partition_separate(partition *p, uint32_t number) {
    starg_status status = STARG_OK;
    separator s = {
        .p = p, .number = number, .count = p->start.data[number + 1] - p->start.data[number]};
    STARG_TRY(list_edges(p, number, &s.edges));
    STARG_NEW(p->context, PARTITION_STAGE, s.leader, s.count);
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.part, s.count);
    link_neighbours(&s);
    STARG_TRY(number_parts(&s));
    if (s.volumes.count == 1)
        p->pieces.data[number].volume = s.volumes.data[0];
    else if (!has_cavity(&s))
        STARG_TRY(hand_out(&s));
done:
    STARG_ARRAY_FREE(p->context, &s.edges);
    starg_release(p->context, s.leader);
    starg_release(p->context, s.part);
    STARG_ARRAY_FREE(p->context, &s.volumes);
    return status;
}
