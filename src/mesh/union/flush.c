/* SPDX-License-Identifier: Apache-2.0 */
/* Gives flat patches with one outline the same triangles.
 *
 * Problem: where solids stand upon one another, flush, both have a polygon there, with the same
 * corners up to rounding and other diagonals. Those of two fans cross n^2 times in nearly one
 * plane, and rounding makes slivers of what lies between. With the same triangles they cancel out.
 *
 * Stages:
 * 1. Vertices within the distance count as one (near_weld.c).
 * 2. From the largest faces on, patches grow across edges of two faces while corners lie within
 *    NEAR distances of the plane of the first one.
 * 3. Patches are sorted by their outlines. Of each that has the outline of an earlier one the faces
 *    are replaced by those, turned if the outline runs the other way, with corners of its own.
 *
 * Invariants: a patch keeps its border, so the surface bounds what it did; no point of it moves
 * farther than twice NEAR distances. Cost: O(n log n). */
#include <stdlib.h>

#include "core/rng.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "mesh/union/union.h"

enum { NEAR = 4 };

typedef struct patch {
    uint64_t hash;       /* of the outline */
    size_t begin, end;   /* of its faces, in `order` */
    size_t rim, rim_end; /* of its outline, in `rims` */
    double height;       /* how far a corner lies from its plane at most */
} patch;

/* A side of a patch; `from` and `to` count vertices within the distance as one. */
typedef struct rim_edge {
    uint32_t low, high; /* the same, sorted */
    bool turned;        /* from `high` to `low` */
    uint32_t own[2];    /* the vertices `low` and `high` of this patch */
} rim_edge;

typedef struct size_of_face {
    double size;
    uint32_t face;
} size_of_face;

typedef struct flush {
    starg_context *context;
    union_surface *surface;
    double distance, height; /* that of the patch that grows */
    int exponent;
    double *place;   /* vertices, in units that give them about unit size */
    uint32_t *at;    /* per vertex: the one that it counts as */
    uint32_t *faces; /* corners by `at`, of those that repeat none */
    uint32_t *named; /* their numbers in the surface */
    size_t count;
    uint32_t *patch_of;
    mesh_topology *topology;
    STARG_ARRAY(uint32_t) order;
    STARG_ARRAY(rim_edge) rims;
    STARG_ARRAY(patch) patches;
} flush;

static void flush_free(flush *u) {
    topology_free(u->topology);
    RELEASE(u->place, u->at, u->faces, u->named, u->patch_of, u->order.data, u->rims.data,
            u->patches.data);
}

static starg_status prepare(flush *u) {
    const union_surface *s = u->surface;
    const size_t vertices = s->vertices.count / 3, faces = union_face_count(s);
    NEW(u->context, UNION_STAGE, u->place, 3 * vertices);
    NEW(u->context, UNION_STAGE, u->at, vertices);
    NEW(u->context, UNION_STAGE, u->faces, 3 * faces);
    NEW(u->context, UNION_STAGE, u->named, faces);
    NEW(u->context, UNION_STAGE, u->patch_of, faces);
    for (size_t i = 0; i < 3 * vertices; i++)
        u->place[i] = ldexp(s->vertices.data[i], -u->exponent);
    TRY(near_weld(u->context, u->place, vertices, u->distance, u->at));
    for (size_t f = 0; f < faces; f++) {
        uint32_t *corner = u->faces + 3 * u->count;
        for (size_t k = 0; k < 3; k++)
            corner[k] = u->at[s->faces.data[3 * f + k]];
        if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
            u->named[u->count++] = (uint32_t)f;
    }
    const starg_mesh view = {.context = u->context,
                             .vertex_count = vertices,
                             .face_count = u->count,
                             .vertices = u->place,
                             .faces = u->faces};
    return topology_create(u->context, &view, &u->topology);
}

/* ---- patches ---- */

static int compare_sizes(const void *left, const void *right) {
    const size_of_face *a = left, *b = right;
    if (a->size != b->size)
        return a->size > b->size ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

static void normal_of(const flush *u, uint32_t face, double out[3]) {
    double a[3], b[3];
    const uint32_t *corner = u->faces + 3 * (size_t)face;
    vec3_subtract(u->place + 3 * (size_t)corner[1], u->place + 3 * (size_t)corner[0], a);
    vec3_subtract(u->place + 3 * (size_t)corner[2], u->place + 3 * (size_t)corner[0], b);
    vec3_cross(a, b, out);
}

static bool lies_in(flush *u, uint32_t face, const double origin[3], const double unit[3]) {
    double normal[3], d[3], most = 0;
    for (size_t k = 0; k < 3; k++) {
        vec3_subtract(u->place + 3 * (size_t)u->faces[3 * (size_t)face + k], origin, d);
        most = fmax(most, fabs(vec3_dot(d, unit)));
    }
    normal_of(u, face, normal);
    if (!(most <= NEAR * u->distance && vec3_dot(normal, unit) > 0))
        return false;
    u->height = fmax(u->height, most);
    return true;
}

static starg_status grow(flush *u, uint32_t first, uint32_t number) {
    double normal[3], length;
    const double *origin = u->place + 3 * (size_t)u->faces[3 * (size_t)first];
    normal_of(u, first, normal);
    length = vec3_length(normal);
    for (int k = 0; k < 3 && length > 0; k++)
        normal[k] /= length;
    size_t begin = u->order.count;
    u->height = 0;
    u->patch_of[first] = number;
    PUSH(u->context, UNION_STAGE, &u->order, first);
    for (size_t next = begin; length > 0 && next < u->order.count; next++)
        for (uint32_t h = 3 * u->order.data[next], end = h + 3; h < end; h++) {
            uint32_t twin = u->topology->twin[h];
            if (twin == TOPOLOGY_NONE || u->patch_of[twin / 3] != TOPOLOGY_NONE ||
                u->faces[twin] == u->faces[h] || !lies_in(u, twin / 3, origin, normal))
                continue;
            u->patch_of[twin / 3] = number;
            PUSH(u->context, UNION_STAGE, &u->order, twin / 3);
        }
    return STARG_OK;
}

static int compare_rims(const void *left, const void *right) {
    const rim_edge *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return a->turned - b->turned;
}

/* The outline: sides that have no other face of the patch. */
static starg_status add_patch(flush *u, size_t begin, uint32_t number) {
    patch own = {.begin = begin,
                 .end = u->order.count,
                 .rim = u->rims.count,

                 .height = u->height};
    const union_surface *s = u->surface;
    for (size_t i = begin; i < own.end; i++)
        for (uint32_t h = 3 * u->order.data[i], end = h + 3; h < end; h++) {
            const uint32_t twin = u->topology->twin[h], after = corner_next(h);
            if (twin != TOPOLOGY_NONE && u->patch_of[twin / 3] == number)
                continue;
            const uint32_t *corner = s->faces.data + 3 * (size_t)u->named[h / 3];
            rim_edge side = {
                u->faces[h], u->faces[after], false, {corner[h % 3], corner[after % 3]}};
            if (side.low > side.high)
                side = (rim_edge){side.high, side.low, true, {side.own[1], side.own[0]}};
            PUSH(u->context, UNION_STAGE, &u->rims, side);
            own.hash += starg_hash64((uint64_t)side.low << 32 | side.high);
        }
    own.rim_end = u->rims.count;
    if (own.rim_end > own.rim)
        qsort(u->rims.data + own.rim, own.rim_end - own.rim, sizeof(rim_edge), compare_rims);
    PUSH(u->context, UNION_STAGE, &u->patches, own);
    return STARG_OK;
}

static starg_status find_patches(flush *u) {
    SCOPED size_of_face *largest = NULL;
    NEW(u->context, UNION_STAGE, largest, u->count);
    for (uint32_t f = 0; f < u->count; f++) {
        double normal[3];
        normal_of(u, f, normal);
        largest[f] = (size_of_face){vec3_length(normal), f};
        u->patch_of[f] = TOPOLOGY_NONE;
    }
    qsort(largest, u->count, sizeof *largest, compare_sizes);
    for (size_t i = 0; i < u->count; i++) {
        const size_t begin = u->order.count;
        if (u->patch_of[largest[i].face] != TOPOLOGY_NONE)
            continue;
        TRY(grow(u, largest[i].face, (uint32_t)i));
        if (u->order.count - begin > 1)
            TRY(add_patch(u, begin, (uint32_t)i));
        else
            u->order.count = begin;
    }
    return STARG_OK;
}

/* ---- the same triangles ---- */

static int compare_patches(const void *left, const void *right) {
    const patch *a = left, *b = right;
    if (a->hash != b->hash)
        return a->hash < b->hash ? -1 : 1;
    return (a->begin > b->begin) - (a->begin < b->begin);
}

/* Is the outline of b that of a? *turned: it runs the other way. */
static bool fits(const flush *u, const patch *a, const patch *b, bool *turned) {
    const rim_edge *p = u->rims.data + a->rim, *q = u->rims.data + b->rim;
    const size_t count = a->rim_end - a->rim;
    if (a->hash != b->hash || b->rim_end - b->rim != count ||
        a->end - a->begin != b->end - b->begin)
        return false;
    *turned = count > 0 && p->turned != q->turned;
    for (size_t i = 0; i < count; i++)
        if (p[i].low != q[i].low || p[i].high != q[i].high ||
            (i > 0 && p[i].low == p[i - 1].low && p[i].high == p[i - 1].high) ||
            (p[i].turned != q[i].turned) != *turned)
            return false;
    return count > 0;
}

static int compare_number(const void *key, const void *element) {
    const uint32_t *a = key;
    const rim_edge *b = element;
    return (*a > b->low) - (*a < b->low);
}

/* The vertex of the patch at a corner; of one that is not on its outline the corner itself. Each
 * vertex of an outline is the lower one of a side, or only the higher one of two. */
static uint32_t own_vertex(const flush *u, const patch *b, uint32_t at, uint32_t corner) {
    const rim_edge *rim = u->rims.data + b->rim;
    const rim_edge *side = bsearch(&at, rim, b->rim_end - b->rim, sizeof *rim, compare_number);
    if (side != NULL)
        return side->own[0];
    for (size_t i = 0; i < b->rim_end - b->rim; i++)
        if (rim[i].high == at)
            return rim[i].own[1];
    return corner;
}

/* Patches of equal numbers of faces, so that each face has its place. */
static bool copy_faces(const flush *u, const patch *a, const patch *b, bool turned) {
    uint32_t *faces = u->surface->faces.data;
    bool changed = false;
    for (size_t i = 0; i < a->end - a->begin; i++) {
        const uint32_t from = u->order.data[a->begin + i],
                       to = u->named[u->order.data[b->begin + i]];
        for (size_t k = 0; k < 3; k++) {
            const size_t there = 3 * (size_t)from + (turned ? 2 - k : k);
            const uint32_t corner = faces[3 * (size_t)u->named[from] + there % 3];
            const uint32_t own = own_vertex(u, b, u->faces[there], corner);
            changed = changed || faces[3 * (size_t)to + k] != own;
            faces[3 * (size_t)to + k] = own;
        }
        u->surface->flags.data[to] = UNION_PART | UNION_FRESH;
    }
    return changed;
}

starg_status surface_match_flush(union_surface *surface, double distance, double *moved) {
    SCOPED_BY(flush_free) flush u = {.context = surface->context, .surface = surface};
    double largest = 0;
    double height = 0;
    bool turned;
    for (size_t i = 0; i < surface->vertices.count; i++)
        largest = fmax(largest, fabs(surface->vertices.data[i]));
    if (!(largest > 0))
        return STARG_OK;
    u.exponent = ilogb(largest) + 1;
    u.distance = ldexp(distance, -u.exponent);
    TRY(prepare(&u));
    TRY(find_patches(&u));
    if (u.patches.count > 0)
        qsort(u.patches.data, u.patches.count, sizeof(patch), compare_patches);
    for (size_t i = 1, first = 0; i < u.patches.count; i++) {
        const patch *a = &u.patches.data[first], *b = &u.patches.data[i];
        if (!fits(&u, a, b, &turned))
            first = i;
        else if (copy_faces(&u, a, b, turned))
            height = fmax(height, a->height + b->height);
    }
    *moved += ldexp(height, u.exponent);
    return STARG_OK;
}
