/* SPDX-License-Identifier: Apache-2.0 */
/* Splits a piece into its connected parts.
 *
 * Stages: facets that share an edge are in one part (edges listed by their lower ends, union-find);
 * number the parts in the order of the facets; compute their volumes: a negative one is the surface
 * of a cavity; reassign the facets. Parts that only touch at a vertex are separate: no point inside
 * either sees all around the vertex, and no plane with the vertex on one side separates them.
 *
 * Cost: linear in the points of the partition and the facets of the piece. */
#include "star/strict/partition/partition.h"

#include <stdlib.h>

#include "geometry/vec3.h"

/* An edge of a facet of the piece; facets are numbered from 0 in the order of the index. */
typedef struct facet_edge {
    uint32_t high, facet; /* the higher of its ends */
} facet_edge;

typedef struct separator {
    partition *p;
    uint32_t number;
    size_t count;      /* facets */
    uint32_t *start;   /* by vertex: its first edge, as the lower end */
    facet_edge *edges; /* by lower end, then by higher end */
    uint32_t *leader;  /* by facet */
    uint32_t *part;    /* by leading facet: 1 + part, 0: none yet */
    STARG_ARRAY(double) volumes;
} separator;

static int compare_edges(const void *a, const void *b) {
    const facet_edge *x = a, *y = b;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

static const uint32_t *corners_of(const separator *s, size_t number) {
    const partition *p = s->p;
    return p->facets.data[p->index.data[p->start.data[s->number] + number] / 2].corners;
}

static uint32_t low_end(const uint32_t *c, int k) {
    return c[k] < c[(k + 1) % 3] ? c[k] : c[(k + 1) % 3];
}

/* Counting sort by the lower end, which usually has few edges; these are sorted directly. */
static starg_status list_edges(separator *s) {
    size_t vertices = s->p->points.count / 3;
    NEW_ZERO(s->p->context, PARTITION_STAGE, s->start, vertices + 2);
    NEW(s->p->context, PARTITION_STAGE, s->edges, 3 * s->count);
    for (size_t i = 0; i < 3 * s->count; i++)
        s->start[low_end(corners_of(s, i / 3), (int)(i % 3)) + 2]++;
    for (size_t v = 2; v < vertices + 2; v++)
        s->start[v] += s->start[v - 1];
    /* one place ahead, so that filling restores each start */
    for (size_t i = 0; i < 3 * s->count; i++) {
        const uint32_t *c = corners_of(s, i / 3);
        int k = (int)(i % 3);
        uint32_t low = low_end(c, k), high = c[k] == low ? c[(k + 1) % 3] : c[k];
        s->edges[s->start[low + 1]++] = (facet_edge){high, (uint32_t)(i / 3)};
    }
    for (size_t v = 0; v < vertices; v++)
        if (s->start[v + 1] - s->start[v] > 1)
            qsort(s->edges + s->start[v], s->start[v + 1] - s->start[v], sizeof *s->edges,
                  compare_edges);
    return STARG_OK;
}

static uint32_t find_leader(uint32_t *leader, uint32_t i) {
    while (leader[i] != i)
        i = leader[i] = leader[leader[i]];
    return i;
}

static void link_neighbours(separator *s) {
    for (size_t i = 0; i < s->count; i++)
        s->leader[i] = (uint32_t)i;
    for (size_t v = 0; v < s->p->points.count / 3; v++)
        for (uint32_t i = s->start[v] + 1; i < s->start[v + 1]; i++)
            if (s->edges[i].high == s->edges[i - 1].high)
                s->leader[find_leader(s->leader, s->edges[i].facet)] =
                    find_leader(s->leader, s->edges[i - 1].facet);
}

static starg_status number_parts(separator *s) {
    partition *p = s->p;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        uint32_t *part = &s->part[find_leader(s->leader, i)];
        if (*part == 0) {
            PUSH(p->context, PARTITION_STAGE, &s->volumes, 0);
            *part = (uint32_t)s->volumes.count;
        }
        s->volumes.data[*part - 1] +=
            vec3_triple(partition_unit(p, c[0]), partition_unit(p, c[1]), partition_unit(p, c[2])) /
            6;
    }
    return STARG_OK;
}

static bool has_cavity(const separator *s) {
    for (size_t i = 0; i < s->volumes.count; i++)
        if (s->volumes.data[i] <= 0)
            return true;
    return false;
}

static starg_status hand_out(separator *s) {
    partition *p = s->p;
    uint32_t first = (uint32_t)p->pieces.count - 1; /* the second part's number is one more */
    for (size_t i = 1; i < s->volumes.count; i++) {
        const piece fresh = {.volume = s->volumes.data[i], .stamp = ++p->stamps};
        PUSH(p->context, PARTITION_STAGE, &p->pieces, fresh);
    }
    p->pieces.data[s->number].volume = s->volumes.data[0];
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t entry = p->index.data[p->start.data[s->number] + i];
        uint32_t part = s->part[find_leader(s->leader, i)] - 1;
        if (part > 0)
            p->facets.data[entry / 2].side[entry % 2] = first + part;
    }
    return partition_build_index(p);
}

starg_status partition_separate(partition *p, uint32_t number) {
    starg_status status = STARG_OK;
    separator s = {
        .p = p, .number = number, .count = p->start.data[number + 1] - p->start.data[number]};
    STARG_TRY(list_edges(&s));
    STARG_NEW(p->context, PARTITION_STAGE, s.leader, s.count);
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.part, s.count);
    link_neighbours(&s);
    STARG_TRY(number_parts(&s));
    if (s.volumes.count == 1)
        p->pieces.data[number].volume = s.volumes.data[0];
    else if (!has_cavity(&s))
        STARG_TRY(hand_out(&s));
done:
    RELEASE(s.start, s.edges, s.leader, s.part, s.volumes.data);
    return status;
}
