/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra of a solid, divided so that their surface is an overlay.
 *
 * Problem: tetrahedra fill A and keep its faces; an overlay divides these, with points in faces and
 * on edges. Divide the tetrahedra likewise, so that they stay conforming.
 *
 * Stages: triangles inside whose three edges are on the surface get a vertex in the middle; so a
 * tetrahedron has a face, an edge or less on the surface. One with an edge becomes a fan along the
 * points of that edge, one with a face a cone over the triangles in that face. Inner corners stay
 * as far from the surface as they were, however flat the triangles are; a generator that is given
 * the divided surface fills it with as flat tetrahedra, more than three times as many.
 *
 * Invariant: all are positive in A, by exact signs, and their surface is the overlay. In the other
 * place they are as positive as they were, up to rounding. Cost: O(n log n). */
#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"
#include "morph/solid_map.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "overlay";

#define NONE UINT32_MAX

/* A triangle by its ascending corners; the number of A's face, or of the vertex in its middle. */
typedef struct face_key {
    uint32_t corners[3], number;
} face_key;

/* A vertex of the overlay on an edge of A. */
typedef struct edge_point {
    deform_edge edge;
    double along; /* weight of the upper vertex */
    uint32_t vertex;
} edge_point;

typedef struct subdivision {
    starg_context *context;
    deform_mesh *c;
    const starg_mesh *a;
    const starg_overlay *overlay;
    uint32_t *own;                  /* A's vertices: their numbers in c */
    uint32_t *renumbered;           /* vertices of c: their numbers afterwards */
    face_key *faces;                /* of A, ascending */
    size_t *first;                  /* per face of A, and one more: its triangles in `triangles` */
    uint32_t *triangles;            /* of the overlay */
    STARG_ARRAY(edge_point) points; /* ascending */
    STARG_ARRAY(uint32_t) tetrahedra;
} subdivision;

static void subdivision_free(subdivision *s) {
    void *const blocks[] = {s->own, s->renumbered, s->faces, s->first, s->triangles};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(s->context, blocks[i]);
    RELEASE(s->points.data, s->tetrahedra.data);
}

/* ---- faces ---- */

static int by_corners(const void *left, const void *right) {
    return memcmp(left, right, 3 * sizeof(uint32_t));
}

static void sort_corners(uint32_t v[3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j + 1 < 3; j++)
            if (v[j] > v[j + 1]) {
                uint32_t former = v[j];
                v[j] = v[j + 1];
                v[j + 1] = former;
            }
}

static face_key key_of(uint32_t a, uint32_t b, uint32_t c, size_t number) {
    face_key key = {{a, b, c}, (uint32_t)number};
    sort_corners(key.corners);
    return key;
}

static uint32_t find(const face_key *list, size_t count, const face_key *key) {
    const face_key *found = count > 0 ? bsearch(key, list, count, sizeof *key, by_corners) : NULL;
    return found != NULL ? found->number : NONE;
}

/* The face of A with the given corners, or NONE. */
static uint32_t find_face(const subdivision *s, uint32_t a, uint32_t b, uint32_t c) {
    const face_key key = key_of(a, b, c, 0);
    return find(s->faces, s->a->face_count, &key);
}

static starg_status list_faces(subdivision *s) {
    NEW(s->context, STAGE, s->faces, s->a->face_count);
    for (size_t f = 0; f < s->a->face_count; f++) {
        const uint32_t *corner = s->a->faces + 3 * f;
        s->faces[f] = key_of(s->own[corner[0]], s->own[corner[1]], s->own[corner[2]], f);
    }
    qsort(s->faces, s->a->face_count, sizeof *s->faces, by_corners);
    return STARG_OK;
}

/* Adds the corners of the simplex of A that a vertex of the overlay is inside of, if they are new.
 */
static size_t add_support(const subdivision *s, uint32_t vertex, uint32_t *corners, size_t count) {
    const uint32_t *face = s->a->faces + 3 * (size_t)s->overlay->own_faces[vertex];
    for (size_t k = 0; k < 3; k++) {
        uint32_t v = s->own[face[k]];
        bool known = s->overlay->own_coordinates[3 * (size_t)vertex + k] == 0;
        for (size_t i = 0; i < count && !known; i++)
            known = corners[i] == v;
        if (!known && count < 3)
            corners[count++] = v;
    }
    return count;
}

/* The face of A that a triangle lies in, or NONE. */
static uint32_t face_of(const subdivision *s, size_t triangle) {
    uint32_t corners[3];
    size_t count = 0;
    for (size_t k = 0; k < 3; k++)
        count = add_support(s, s->overlay->faces[3 * triangle + k], corners, count);
    return count == 3 ? find_face(s, corners[0], corners[1], corners[2]) : NONE;
}

static starg_status file_triangles(subdivision *s) {
    const starg_overlay *overlay = s->overlay;
    size_t faces = s->a->face_count;
    SCOPED uint32_t *where = NULL;
    NEW(s->context, STAGE, where, overlay->face_count);
    NEW_ZERO(s->context, STAGE, s->first, faces + 2);
    NEW(s->context, STAGE, s->triangles, overlay->face_count);
    for (size_t t = 0; t < overlay->face_count; t++) {
        where[t] = face_of(s, t);
        if (where[t] == NONE)
            return starg_fail(s->context, STARG_ERROR_MESH, STAGE,
                              "triangle %zu of the overlay is in no face of A", t);
        s->first[where[t] + 2]++;
    }
    for (size_t f = 0; f < faces; f++)
        s->first[f + 2] += s->first[f + 1];
    for (size_t t = 0; t < overlay->face_count; t++)
        s->triangles[s->first[where[t] + 1]++] = (uint32_t)t;
    return STARG_OK;
}

/* ---- vertices ---- */

static int by_place(const void *left, const void *right) {
    const edge_point *a = left, *b = right;
    if (a->edge != b->edge)
        return a->edge < b->edge ? -1 : 1;
    return (a->along > b->along) - (a->along < b->along);
}

static starg_status list_vertices(subdivision *s) {
    NEW(s->context, STAGE, s->own, s->a->vertex_count);
    memset(s->own, 0xff, s->a->vertex_count * sizeof *s->own);
    for (uint32_t v = 0; v < s->c->fixed; v++)
        s->own[s->c->surface[v]] = v;
    return STARG_OK;
}

/* New numbers of vertices, and the points on edges. */
static starg_status place_vertices(subdivision *s) {
    const starg_overlay *overlay = s->overlay;
    const deform_mesh *c = s->c;
    NEW(s->context, STAGE, s->renumbered, c->rest.count / 3);
    for (size_t v = c->fixed; v < c->rest.count / 3; v++)
        s->renumbered[v] = (uint32_t)(overlay->vertex_count + v - c->fixed);
    for (uint32_t i = 0; i < overlay->vertex_count; i++) {
        const uint32_t *face = s->a->faces + 3 * (size_t)overlay->own_faces[i];
        uint32_t corners[3];
        size_t count = add_support(s, i, corners, 0);
        if (count == 1)
            s->renumbered[corners[0]] = i;
        if (count != 2)
            continue;
        uint32_t upper = corners[0] > corners[1] ? corners[0] : corners[1];
        edge_point point = {.edge = deform_edge_of(corners[0], corners[1]), .vertex = i};
        for (size_t k = 0; k < 3; k++)
            if (s->own[face[k]] == upper)
                point.along = overlay->own_coordinates[3 * (size_t)i + k];
        PUSH(s->context, STAGE, &s->points, point);
    }
    if (s->points.count > 0)
        qsort(s->points.data, s->points.count, sizeof *s->points.data, by_place);
    return STARG_OK;
}

/* ---- triangles inside, between edges of the surface ---- */

typedef STARG_ARRAY(face_key) key_list;

/* Which corner is opposite such a triangle? -1: there is none. */
static int opposite_inner(const subdivision *s, size_t t, face_key *key) {
    const uint32_t *v = s->c->tetrahedra.data + 4 * t;
    for (int own = 0; own < 4; own++) {
        const int *k = TETMESH_FACE[own];
        if (v[k[0]] >= s->c->fixed || v[k[1]] >= s->c->fixed || v[k[2]] >= s->c->fixed)
            continue;
        *key = key_of(v[k[0]], v[k[1]], v[k[2]], 0);
        if (find(s->faces, s->a->face_count, key) == NONE)
            return own;
    }
    return -1;
}

static starg_status find_inner(const subdivision *s, key_list *out) {
    size_t kept = 0;
    face_key key;
    for (size_t t = 0; t < s->c->tetrahedra.count / 4; t++)
        if (opposite_inner(s, t, &key) >= 0)
            PUSH(s->context, STAGE, out, key);
    if (out->count == 0)
        return STARG_OK;
    qsort(out->data, out->count, sizeof *out->data, by_corners);
    for (size_t i = 0; i < out->count; i++)
        if (kept == 0 || by_corners(&out->data[i], &out->data[kept - 1]) != 0)
            out->data[kept++] = out->data[i];
    out->count = kept;
    return STARG_OK;
}

/* A vertex in the middle of a triangle, in both places. */
static starg_status add_middle(subdivision *s, face_key *key) {
    deform_mesh *c = s->c;
    key->number = (uint32_t)(c->rest.count / 3);
    for (size_t k = 0; k < 3; k++) {
        double sums[2] = {0, 0};
        for (int i = 0; i < 3; i++) {
            sums[0] += c->rest.data[3 * (size_t)key->corners[i] + k];
            sums[1] += c->now.data[3 * (size_t)key->corners[i] + k];
        }
        PUSH(s->context, STAGE, &c->rest, sums[0] / 3);
        PUSH(s->context, STAGE, &c->now, sums[1] / 3);
    }
    return STARG_OK;
}

/* Each becomes three, with its two tetrahedra. */
static starg_status split_inner(subdivision *s) {
    deform_mesh *c = s->c;
    SCOPED key_list inner = {0};
    TRY(find_inner(s, &inner));
    for (size_t i = 0; i < inner.count; i++)
        TRY(add_middle(s, &inner.data[i]));
    for (size_t t = 0, count = c->tetrahedra.count / 4; t < count; t++) {
        face_key key;
        uint32_t corners[4];
        int own = opposite_inner(s, t, &key);
        if (own < 0)
            continue;
        uint32_t middle = find(inner.data, inner.count, &key);
        memcpy(corners, c->tetrahedra.data + 4 * t, sizeof corners);
        for (int i = 0; i < 3; i++) {
            int turned = TETMESH_FACE[own][i];
            for (int k = 0; k < 4; k++) {
                uint32_t v = k == turned ? middle : corners[k];
                if (i == 0)
                    c->tetrahedra.data[4 * t + (size_t)k] = v;
                else
                    PUSH(s->context, STAGE, &c->tetrahedra, v);
            }
        }
    }
    return STARG_OK;
}

/* ---- tetrahedra ---- */

static starg_status add(subdivision *s, const uint32_t corners[4]) {
    for (int k = 0; k < 4; k++)
        PUSH(s->context, STAGE, &s->tetrahedra, corners[k]);
    return STARG_OK;
}

static size_t first_point(const subdivision *s, deform_edge edge) {
    size_t low = 0, high = s->points.count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (s->points.data[middle].edge < edge)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* A fan along the edge between corners a and b. */
static starg_status fan_edge(subdivision *s, const uint32_t corners[4], int a, int b) {
    deform_edge edge = deform_edge_of(corners[a], corners[b]);
    int low = corners[a] < corners[b] ? a : b, high = low == a ? b : a;
    uint32_t fresh[4];
    for (int k = 0; k < 4; k++)
        fresh[k] = s->renumbered[corners[k]];
    uint32_t last = fresh[high];
    for (size_t i = first_point(s, edge); i < s->points.count && s->points.data[i].edge == edge;
         i++) {
        fresh[high] = s->points.data[i].vertex;
        TRY(add(s, fresh));
        fresh[low] = fresh[high];
    }
    fresh[high] = last;
    return add(s, fresh);
}

/* Are two orders of the same corners equal up to rotation? */
static bool is_even(const uint32_t a[3], const uint32_t b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[0] == b[k])
            return a[1] == b[(k + 1) % 3];
    return true;
}

/* A cone over the triangles of the face opposite the apex. */
static starg_status cone(subdivision *s, const uint32_t corners[4], int apex, uint32_t face) {
    uint32_t outward[3], given[3], fresh[4];
    for (int k = 0; k < 3; k++) {
        outward[k] = corners[TETMESH_FACE[apex][k]];
        given[k] = s->own[s->a->faces[3 * (size_t)face + (size_t)k]];
    }
    bool even = is_even(outward, given);
    fresh[apex] = s->renumbered[corners[apex]];
    for (size_t i = s->first[face]; i < s->first[face + 1]; i++) {
        const uint32_t *triangle = s->overlay->faces + 3 * (size_t)s->triangles[i];
        for (int k = 0; k < 3; k++)
            fresh[TETMESH_FACE[apex][k]] = triangle[even ? k : 2 - k];
        TRY(add(s, fresh));
    }
    return STARG_OK;
}

static starg_status divide(subdivision *s, size_t t) {
    const uint32_t *corners = s->c->tetrahedra.data + 4 * t;
    uint32_t face = NONE, fresh[4];
    int on[4], off = 0, count = 0;
    for (int k = 0; k < 4; k++)
        if (corners[k] < s->c->fixed)
            on[count++] = k;
        else
            off = k;
    if (count == 2)
        return fan_edge(s, corners, on[0], on[1]);
    if (count == 3)
        face = find_face(s, corners[on[0]], corners[on[1]], corners[on[2]]);
    if (face != NONE)
        return cone(s, corners, off, face);
    if (count > 2)
        return starg_fail(s->context, STARG_ERROR_MESH, STAGE,
                          "tetrahedron %zu of A has all corners on the surface and is too thin for "
                          "a vertex inside; a finer A (--density) may help",
                          t);
    for (int k = 0; k < 4; k++)
        fresh[k] = s->renumbered[corners[k]];
    return add(s, fresh);
}

/* ---- the result ---- */

/* Where a vertex of the overlay is, by places of A's vertices. */
static void place_in(const subdivision *s, size_t vertex, const double *from, double out[3]) {
    const uint32_t *face = s->a->faces + 3 * (size_t)s->overlay->own_faces[vertex];
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < 3; k++)
        vec3_along(out, s->overlay->own_coordinates[3 * vertex + k],
                   from + 3 * (size_t)s->own[face[k]], out);
}

static starg_status finish(subdivision *s) {
    deform_mesh *c = s->c;
    SCOPED_BY(deform_free)
    deform_mesh next = {.context = c->context, .fixed = s->overlay->vertex_count};
    for (size_t i = 0; i < next.fixed; i++) {
        double rest[3], now[3];
        place_in(s, i, c->rest.data, rest);
        place_in(s, i, c->now.data, now);
        for (int k = 0; k < 3; k++) {
            PUSH(s->context, STAGE, &next.rest, rest[k]);
            PUSH(s->context, STAGE, &next.now, now[k]);
        }
    }
    for (size_t i = 3 * c->fixed; i < c->rest.count; i++) {
        PUSH(s->context, STAGE, &next.rest, c->rest.data[i]);
        PUSH(s->context, STAGE, &next.now, c->now.data[i]);
    }
    for (size_t i = 0; i < s->tetrahedra.count; i++)
        PUSH(s->context, STAGE, &next.tetrahedra, s->tetrahedra.data[i]);
    deform_free(c);
    *c = next;
    next = (deform_mesh){.context = c->context};
    return STARG_OK;
}

static starg_status check_positive(const deform_mesh *c) {
    size_t flat = 0, count = c->tetrahedra.count / 4;
    for (size_t t = 0; t < count; t++) {
        const double *p[4];
        for (size_t k = 0; k < 4; k++)
            p[k] = c->rest.data + 3 * (size_t)c->tetrahedra.data[4 * t + k];
        flat += orient3d(p[0], p[1], p[2], p[3]) >= 0;
    }
    if (flat == 0)
        return STARG_OK;
    return starg_fail(c->context, STARG_ERROR_MESH, STAGE,
                      "%zu of %zu tetrahedra of A are too thin for doubles when they are divided "
                      "along the overlay; a map with less distortion (landmarks) may do",
                      flat, count);
}

starg_status solids_divide(deform_mesh *c, const starg_mesh *a, const starg_overlay *overlay) {
    SCOPED_BY(subdivision_free)
    subdivision s = {.context = c->context, .c = c, .a = a, .overlay = overlay};
    TRY(list_vertices(&s));
    TRY(list_faces(&s));
    TRY(split_inner(&s));
    TRY(file_triangles(&s));
    TRY(place_vertices(&s));
    for (size_t t = 0; t < c->tetrahedra.count / 4; t++)
        TRY(divide(&s, t));
    TRY(finish(&s));
    return check_positive(c);
}
