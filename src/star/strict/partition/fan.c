/* SPDX-License-Identifier: Apache-2.0 */
/* Distributes pieces by a fan of triangles.
 *
 * Stages: remove facets between the pieces; assign each facet of their union to its taker; along
 * every edge whose two facets go to different takers, add a triangle from the edge to the apex
 * between these; remove facets between a piece and its own taker.
 *
 * Invariants: no facet and no edge is split, so that no other piece is affected; every surface
 * stays closed. Cost: linear in the facets of the partition. */
#include "star/strict/partition/partition.h"

#include <stdlib.h>

#include "geometry/vec3.h"

/* An edge of the union, from a to b in the facet that `taker` receives. */
typedef struct fan_edge {
    uint32_t a, b;
    uint8_t taker;
} fan_edge;

typedef STARG_ARRAY(fan_edge) fan_edges;

void fan_plan_free(fan_plan *plan) {
    RELEASE(plan->entries.data, plan->takes.data, plan->corners.data);
    *plan = (fan_plan){.piece_count = 0};
}

/* ---- finding facets again ---- */

typedef struct known_facet {
    uint32_t corners[3], entry;
} known_facet;

static int compare_facets(const void *left, const void *right) {
    const known_facet *x = left, *y = right;
    for (int k = 0; k < 3; k++)
        if (x->corners[k] != y->corners[k])
            return x->corners[k] < y->corners[k] ? -1 : 1;
    return 0;
}

starg_status fan_plan_mark(const partition *p, fan_plan *plan) {
    plan->corners.count = 0;
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        for (int k = 0; k < 3; k++)
            PUSH(p->context, PARTITION_STAGE, &plan->corners, c[k]);
    }
    return STARG_OK;
}

starg_status fan_plan_find(const partition *p, fan_plan *plan, bool *found) {
    SCOPED STARG_ARRAY(known_facet) facets = {0};
    *found = false;
    for (size_t i = 0; i < plan->piece_count; i++)
        for (uint32_t k = p->start.data[plan->pieces[i]]; k < p->start.data[plan->pieces[i] + 1];
             k++) {
            known_facet fresh = {.entry = p->index.data[k]};
            facet_outward(&p->facets.data[fresh.entry / 2], (int)(fresh.entry % 2), fresh.corners);
            PUSH(p->context, PARTITION_STAGE, &facets, fresh);
        }
    if (facets.count == 0)
        return STARG_OK;
    qsort(facets.data, facets.count, sizeof *facets.data, compare_facets);
    *found = true;
    for (size_t i = 0; i < plan->entries.count && *found; i++) {
        known_facet wanted;
        memcpy(wanted.corners, plan->corners.data + 3 * i, sizeof wanted.corners);
        const known_facet *at =
            bsearch(&wanted, facets.data, facets.count, sizeof wanted, compare_facets);
        *found = at != NULL;
        if (*found)
            plan->entries.data[i] = at->entry;
    }
    return STARG_OK;
}

/* ---- the fan ---- */

static starg_status gather_edges(const partition *p, const fan_plan *plan, fan_edges *edges) {
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        for (int k = 0; k < 3; k++) {
            const fan_edge fresh = {c[k], c[(k + 1) % 3], plan->takes.data[i]};
            PUSH(p->context, PARTITION_STAGE, edges, fresh);
        }
    }
    return STARG_OK;
}

/* Sorts both directions of an edge next to each other. */
static int compare_edges(const void *left, const void *right) {
    const fan_edge *x = left, *y = right;
    int order = partition_compare_edges(x->a, x->b, y->a, y->b);
    return order != 0 ? order : (x->a > y->a) - (x->a < y->a);
}

static bool is_piece(const fan_plan *plan, uint32_t number) {
    for (size_t i = 0; i < plan->piece_count; i++)
        if (plan->pieces[i] == number)
            return true;
    return false;
}

/* Facets between two of the pieces get the same number on both sides. */
static void hand_over(partition *p, const fan_plan *plan) {
    for (size_t i = 0; i < p->facets.count; i++) {
        facet *f = &p->facets.data[i];
        if (is_piece(plan, f->side[0]) && is_piece(plan, f->side[1]))
            f->side[1] = f->side[0];
    }
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i];
        p->facets.data[entry / 2].side[entry % 2] = plan->takers[plan->takes.data[i]];
    }
}

static void drop_inner(partition *p) {
    size_t kept = 0;
    for (size_t i = 0; i < p->facets.count; i++)
        if (p->facets.data[i].side[0] != p->facets.data[i].side[1])
            p->facets.data[kept++] = p->facets.data[i];
    p->facets.count = kept;
}

static starg_status add_triangles(partition *p, const fan_plan *plan, const fan_edges *edges,
                                  uint32_t apex) {
    for (size_t i = 0; i + 1 < edges->count; i += 2) {
        const fan_edge *e = &edges->data[i];
        if (e[0].taker == e[1].taker)
            continue;
        facet f = {.corners = {e[0].b, e[0].a, apex},
                   .side = {plan->takers[e[0].taker], plan->takers[e[1].taker]},
                   .plane = (uint32_t)p->planes.count};
        partition_plane plane;
        partition_plane_of(p, f.corners, &plane);
        PUSH(p->context, PARTITION_STAGE, &p->planes, plane);
        PUSH(p->context, PARTITION_STAGE, &p->facets, f);
    }
    return STARG_OK;
}

starg_status partition_fan(partition *p, const fan_plan *plan) {
    SCOPED fan_edges edges = {0};
    double at[3];
    uint32_t apex;
    partition_from_unit(p, plan->apex, at);
    TRY(partition_add_point(p, at, &apex));
    TRY(gather_edges(p, plan, &edges));
    if (edges.count > 0)
        qsort(edges.data, edges.count, sizeof *edges.data, compare_edges);
    hand_over(p, plan);
    drop_inner(p);
    return add_triangles(p, plan, &edges, apex);
}
