/* SPDX-License-Identifier: Apache-2.0 */
/* A partition as tetrahedra: every piece is the union of the tetrahedra that its facets span with
 * its guard. They do not overlap, because each ray from the guard leaves the piece once, and they
 * share faces, because all pieces share the same facets. Cost: linear. */
#include "star/strict/partition/partition.h"

#include "geometry/vec3.h"

typedef struct coner {
    const partition *p;
    double *vertices;
    uint32_t *tetrahedra;
    uint32_t *number; /* per point: its vertex, or NONE when no facet uses it */
    size_t vertex_count, used;
} coner;

static const uint32_t NONE = UINT32_MAX;

static void number_points(coner *c) {
    size_t points = c->p->points.count / 3;
    memset(c->number, 0xff, points * sizeof *c->number);
    for (size_t i = 0; i < 3 * c->p->facets.count; i++)
        c->number[c->p->facets.data[i / 3].corners[i % 3]] = 0;
    for (size_t v = 0; v < points; v++)
        if (c->number[v] != NONE) {
            vec3_copy(partition_point(c->p, (uint32_t)v), c->vertices + 3 * c->vertex_count);
            c->number[v] = (uint32_t)c->vertex_count++;
        }
    c->used = c->vertex_count;
    for (size_t i = 0; i < c->p->pieces.count; i++)
        vec3_copy(c->p->pieces.data[i].guard, c->vertices + 3 * c->vertex_count++);
}

/* The guard sees the facet clockwise: swaps two corners. */
static void put(const coner *c, size_t at, uint32_t entry, size_t owner) {
    uint32_t corners[3], *to = c->tetrahedra + 4 * at;
    facet_outward(&c->p->facets.data[entry / 2], (int)(entry % 2), corners);
    to[0] = c->number[corners[0]];
    to[1] = c->number[corners[2]];
    to[2] = c->number[corners[1]];
    to[3] = (uint32_t)(c->used + owner);
}

starg_status cone_all(const partition *p, starg_tetmesh **mesh, int32_t **labels) {
    starg_status status = STARG_OK;
    coner c = {.p = p};
    size_t count = p->index.count;
    *mesh = NULL;
    *labels = NULL;
    STARG_NEW(p->context, PARTITION_STAGE, c.vertices, p->points.count + 3 * p->pieces.count);
    STARG_NEW(p->context, PARTITION_STAGE, c.tetrahedra, 4 * count);
    STARG_NEW(p->context, PARTITION_STAGE, c.number, p->points.count / 3);
    STARG_NEW(p->context, PARTITION_STAGE, *labels, count);
    number_points(&c);
    for (size_t owner = 0, at = 0; owner < p->pieces.count; owner++)
        for (; at < p->start.data[owner + 1]; at++) {
            put(&c, at, p->index.data[at], owner);
            (*labels)[at] = (int32_t)owner;
        }
    STARG_TRY(tetmesh_adopt(p->context, c.vertices, c.vertex_count, c.tetrahedra, count, NULL, true,
                            mesh));
    c.vertices = NULL;
    c.tetrahedra = NULL;
done:
    RELEASE(c.vertices, c.tetrahedra, c.number);
    if (status != STARG_OK) {
        starg_release(p->context, *labels);
        *labels = NULL;
    }
    return status;
}
