/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a surface where more than two faces share an edge, or several fans a vertex.
 *
 * Around every edge of more than two faces, the faces are sorted by angle and matched like
 * brackets: a face in one direction with the next one in the other direction, with solid between
 * them. Two cubes that touch along an edge become two shells. Corners at a vertex that are linked
 * across matched edges form a fan; each fan but the first gets a copy of the vertex. This separates
 * vertices of several fans and usually the sheets at an edge too, unless they are connected at both
 * ends of it.
 *
 * The order by angle is exact. Cost: O(n log n), and the square of the faces at an edge. */
#include "mesh/topology.h"

#include "geometry/predicates.h"

static const char STAGE[] = "topology";

typedef struct pairing {
    const starg_mesh *mesh;
    mesh_topology *topology;
} pairing;

static const double *position(const pairing *s, uint32_t vertex) {
    return s->mesh->vertices + 3 * (size_t)vertex;
}

/* A face at an edge, viewed along the edge from its lower to its upper vertex. */
typedef struct wing {
    uint32_t halfedge;
    const double *tip; /* the corner opposite the edge */
    bool forward;      /* directed from the lower to the upper vertex */
    int sector;        /* relative to the first wing: 0 same, 1 left, 2 opposite, 3 right */
} wing;

typedef STARG_ARRAY(wing) wing_list;

/* Sector of `tip` around line a b, where `first` points up. */
static int sector_of(const double a[3], const double b[3], const double first[3],
                     const double tip[3]) {
    int side = orient3d(a, b, first, tip);
    if (side != 0)
        return side > 0 ? 1 : 3;
    for (int u = 0; u < 3; u++) {
        int turn = orient2d(a, b, first, u, (u + 1) % 3);
        if (turn != 0)
            return orient2d(a, b, tip, u, (u + 1) % 3) * turn < 0 ? 2 : 0;
    }
    return 0;
}

static bool comes_before(const double a[3], const double b[3], const wing *x, const wing *y) {
    if (x->sector != y->sector)
        return x->sector < y->sector;
    int side = x->sector % 2 == 1 ? orient3d(a, b, x->tip, y->tip) : 0;
    return side != 0 ? side > 0 : x->halfedge < y->halfedge;
}

/* Lists the wings of an edge by angle. */
static starg_status sort_wings(const pairing *s, uint32_t halfedge, wing_list *wings) {
    const uint32_t *faces = s->mesh->faces;
    uint32_t low = faces[halfedge], high = faces[corner_next(halfedge)], h = halfedge;
    if (low > high) {
        uint32_t swap = low;
        low = high;
        high = swap;
    }
    const double *a = position(s, low), *b = position(s, high);
    wings->count = 0;
    do {
        wing own = {.halfedge = h,
                    .tip = position(s, faces[corner_previous(h)]),
                    .forward = faces[h] == low};
        PUSH(s->topology->context, STAGE, wings, own);
        h = s->topology->ring[h];
    } while (h != halfedge);
    const double *first = wings->data[0].tip;
    for (size_t i = 0; i < wings->count && collinear(a, b, first); i++)
        first = wings->data[i].tip;
    for (size_t i = 0; i < wings->count; i++) {
        wing own = wings->data[i];
        size_t k = i;
        own.sector = sector_of(a, b, first, own.tip);
        for (; k > 0 && comes_before(a, b, &own, &wings->data[k - 1]); k--)
            wings->data[k] = wings->data[k - 1];
        wings->data[k] = own;
    }
    return STARG_OK;
}

/* Matches wings like brackets on a circle: the second pass closes those left open. */
static starg_status pair_wings(const pairing *s, const wing_list *wings) {
    SCOPED uint32_t *open = NULL;
    size_t depth = 0;
    NEW(s->topology->context, STAGE, open, 2 * wings->count);
    for (size_t i = 0; i < 2 * wings->count; i++) {
        const wing *own = &wings->data[i % wings->count];
        if (s->topology->twin[own->halfedge] != TOPOLOGY_NONE)
            continue;
        if (own->forward && i < wings->count) {
            open[depth++] = own->halfedge;
        } else if (!own->forward && depth > 0) {
            uint32_t partner = open[--depth];
            s->topology->twin[partner] = own->halfedge;
            s->topology->twin[own->halfedge] = partner;
        }
    }
    return STARG_OK;
}

static bool is_lowest(const mesh_topology *topology, uint32_t h) {
    for (uint32_t o = topology->ring[h]; o != h; o = topology->ring[o])
        if (o < h)
            return false;
    return true;
}

starg_status wings_create(starg_context *context, const starg_mesh *mesh, mesh_topology **out) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED wing_list wings = {0};
    *out = NULL;
    TRY(topology_create(context, mesh, &topology));
    pairing s = {.mesh = mesh, .topology = topology};
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        if (topology->twin[h] != TOPOLOGY_NONE || topology->ring[h] == h || !is_lowest(topology, h))
            continue;
        TRY(sort_wings(&s, h, &wings));
        TRY(pair_wings(&s, &wings));
    }
    *out = topology;
    topology = NULL;
    return STARG_OK;
}

/* ---- fans ---- */

void wings_find_fans(const mesh_topology *topology, const starg_mesh *mesh, uint32_t *fan) {
    const uint32_t *faces = mesh->faces;
    sets_make(fan, 3 * mesh->face_count);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        uint32_t twin = topology->twin[h];
        if (twin == TOPOLOGY_NONE || twin < h)
            continue;
        uint32_t other_end = corner_next(twin);
        bool opposite = faces[twin] != faces[h];
        sets_join(fan, h, opposite ? other_end : twin);
        sets_join(fan, corner_next(h), opposite ? twin : other_end);
    }
}

/* The vertex of each corner, and by vertex behind the given ones, of which it is a copy. */
static starg_status part_fans(starg_context *context, const starg_mesh *mesh, uint32_t *fan,
                              uint32_t *faces, uint32_t *copied, size_t *copies) {
    SCOPED uint8_t *used = NULL;
    NEW_ZERO(context, STAGE, used, mesh->vertex_count);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        uint32_t root = sets_find(fan, h), vertex = mesh->faces[h];
        if (root != h) {
            faces[h] = faces[root];
        } else if (used[vertex]) {
            faces[h] = (uint32_t)(mesh->vertex_count + *copies);
            copied[(*copies)++] = vertex;
        } else {
            used[vertex] = 1;
            faces[h] = vertex;
        }
    }
    return STARG_OK;
}

starg_status wings_part(starg_context *context, const starg_mesh *mesh, starg_mesh **out) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    size_t corners = 3 * mesh->face_count, copies = 0, count = mesh->vertex_count;
    SCOPED uint32_t *fan = NULL, *faces = NULL, *copied = NULL;
    SCOPED double *vertices = NULL;
    *out = NULL;
    TRY(wings_create(context, mesh, &topology));
    NEW(context, STAGE, fan, corners);
    NEW(context, STAGE, faces, corners);
    NEW(context, STAGE, copied, corners);
    wings_find_fans(topology, mesh, fan);
    TRY(part_fans(context, mesh, fan, faces, copied, &copies));
    if (copies == 0)
        return STARG_OK;
    NEW(context, STAGE, vertices, 3 * (count + copies));
    memcpy(vertices, mesh->vertices, 3 * count * sizeof *vertices);
    for (size_t i = 0; i < copies; i++)
        memcpy(vertices + 3 * (count + i), mesh->vertices + 3 * (size_t)copied[i],
               3 * sizeof *vertices);
    return starg_mesh_create(context, vertices, count + copies, faces, mesh->face_count, out);
}
