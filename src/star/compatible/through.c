/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts through compatible tetrahedra.
 *
 * Problem: pieces that consist of given tetrahedra have ragged sides, whose faces look in many
 * directions: few points see all of them. A plane in one place, cut through the tetrahedra, is
 * smooth there, and nearly so in the other place if the map is.
 *
 * A level at each vertex, linear in between, stands for the plane. Where edges come too near a
 * vertex the cut is moved onto it. Each edge that crosses is halved where the level is 0, by the
 * same ratio in both places, in the order of its vertices. As this order is the same in all
 * tetrahedra, they stay conforming; and no edge crosses any more, so that each is on one side.
 *
 * Stages: the edges; the faces around both parts, and their kernels; the divided mesh. The kernels
 * are found before anything is divided, and proven by the caller afterwards. Cost: O(n log n). */
#include "star/compatible/twin_pieces.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "join";

static const double NEAR = 0.05; /* of an edge: a cut so near its end goes through the end */

enum { PARTS_MOST = 32 }; /* of a tetrahedron */

static const int EDGE[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

void through_free(through_cut *cut) {
    STARG_ARRAY_FREE(cut->context, &cut->edges);
    for (int i = 0; i < 2; i++) {
        RELEASE(cut->places[i].data, cut->faces[i].data);
    }
}

/* ---- edges ---- */

static uint64_t key_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static bool crosses(const through_cut *cut, uint32_t a, uint32_t b) {
    return (cut->levels[a] < 0 && cut->levels[b] > 0) || (cut->levels[a] > 0 && cut->levels[b] < 0);
}

/* All at once, so that the order of edges does not matter. */
static starg_status move_onto_vertices(through_cut *cut) {
    const starg_tetmesh *mesh = cut->meshes[0];
    SCOPED uint8_t *near = NULL;
    NEW_ZERO(cut->context, STAGE, near, mesh->vertex_count);
    for (size_t t = 0; t < mesh->count; t++)
        for (int e = 0; cut->inside[t] && e < 6; e++) {
            uint32_t a = mesh->tetrahedra[4 * t + (size_t)EDGE[e][0]];
            uint32_t b = mesh->tetrahedra[4 * t + (size_t)EDGE[e][1]];
            if (!crosses(cut, a, b))
                continue;
            double at = cut->levels[a] / (cut->levels[a] - cut->levels[b]);
            if (at < NEAR)
                near[a] = 1;
            else if (at > 1 - NEAR)
                near[b] = 1;
        }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (near[v])
            cut->levels[v] = 0;
    return STARG_OK;
}

static int compare_keys(const void *left, const void *right) {
    uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

static starg_status list_edges(through_cut *cut) {
    const starg_tetmesh *mesh = cut->meshes[0];
    size_t kept = 0;
    cut->edges.count = 0;
    for (size_t t = 0; t < mesh->count; t++)
        for (int e = 0; cut->inside[t] && e < 6; e++) {
            uint32_t a = mesh->tetrahedra[4 * t + (size_t)EDGE[e][0]];
            uint32_t b = mesh->tetrahedra[4 * t + (size_t)EDGE[e][1]];
            if (crosses(cut, a, b))
                PUSH(cut->context, STAGE, &cut->edges, key_of(a, b));
        }
    if (cut->edges.count > 0)
        qsort(cut->edges.data, cut->edges.count, sizeof *cut->edges.data, compare_keys);
    for (size_t i = 0; i < cut->edges.count; i++)
        if (kept == 0 || cut->edges.data[kept - 1] != cut->edges.data[i])
            cut->edges.data[kept++] = cut->edges.data[i];
    cut->edges.count = kept;
    return STARG_OK;
}

/* The number of the point on an edge; UINT32_MAX: it does not cross. */
static uint32_t point_on(const through_cut *cut, uint32_t a, uint32_t b) {
    if (cut->edges.count == 0 || !crosses(cut, a, b))
        return UINT32_MAX;
    uint64_t key = key_of(a, b);
    const uint64_t *at = bsearch(&key, cut->edges.data, cut->edges.count, sizeof key, compare_keys);
    return at == NULL ? UINT32_MAX
                      : (uint32_t)(cut->meshes[0]->vertex_count + (size_t)(at - cut->edges.data));
}

static starg_status place_points(through_cut *cut) {
    for (int i = 0; i < 2; i++) {
        const starg_tetmesh *mesh = cut->meshes[i];
        cut->places[i].count = 0;
        for (size_t k = 0; k < 3 * mesh->vertex_count; k++)
            PUSH(cut->context, STAGE, &cut->places[i], mesh->vertices[k]);
        for (size_t e = 0; e < cut->edges.count; e++) {
            uint32_t a = (uint32_t)(cut->edges.data[e] >> 32), b = (uint32_t)cut->edges.data[e];
            double at = cut->levels[a] / (cut->levels[a] - cut->levels[b]);
            for (size_t k = 0; k < 3; k++) {
                double from = mesh->vertices[3 * (size_t)a + k];
                double to = mesh->vertices[3 * (size_t)b + k];
                PUSH(cut->context, STAGE, &cut->places[i], from + at * (to - from));
            }
        }
    }
    return STARG_OK;
}

/* ---- faces around the parts ---- */

static starg_status add_polygon(through_cut *cut, int part, const uint32_t *corners, size_t count) {
    for (size_t i = 1; i + 1 < count; i++) {
        PUSH(cut->context, STAGE, &cut->faces[part], corners[0]);
        PUSH(cut->context, STAGE, &cut->faces[part], corners[i]);
        PUSH(cut->context, STAGE, &cut->faces[part], corners[i + 1]);
    }
    return STARG_OK;
}

/* What of a face is on either side. */
static starg_status add_outer_face(through_cut *cut, const uint32_t corners[3]) {
    for (int part = 0; part < 2; part++) {
        uint32_t polygon[4];
        size_t count = 0;
        for (int k = 0; k < 3; k++) {
            uint32_t a = corners[k], b = corners[(k + 1) % 3];
            if (part == 0 ? cut->levels[a] <= 0 : cut->levels[a] >= 0)
                polygon[count++] = a;
            if (crosses(cut, a, b))
                polygon[count++] = point_on(cut, a, b);
        }
        TRY(add_polygon(cut, part, polygon, count));
    }
    return STARG_OK;
}

/* 0, 1, or -1 for a tetrahedron that is on both sides. */
static int side_of(const through_cut *cut, const uint32_t corners[4]) {
    bool below = false, above = false;
    for (int k = 0; k < 4; k++) {
        below = below || cut->levels[corners[k]] < 0;
        above = above || cut->levels[corners[k]] > 0;
    }
    return below && above ? -1 : above;
}

/* The polygon between both parts, for the lower one, and reversed for the upper one. */
static starg_status add_inner_polygon(through_cut *cut, uint32_t *polygon, size_t count,
                                      uint32_t below) {
    const double *places = cut->places[0].data;
    double normal[3], down[3];
    uint32_t turned[4];
    vec3_triangle_normal(places + 3 * (size_t)polygon[0], places + 3 * (size_t)polygon[1],
                         places + 3 * (size_t)polygon[2], normal);
    vec3_subtract(places + 3 * (size_t)below, places + 3 * (size_t)polygon[0], down);
    for (size_t i = 0; i < count; i++)
        turned[i] = polygon[(count - i) % count];
    bool outward = vec3_dot(normal, down) < 0;
    TRY(add_polygon(cut, 0, outward ? polygon : turned, count));
    return add_polygon(cut, 1, outward ? turned : polygon, count);
}

static starg_status add_cut_of(through_cut *cut, const uint32_t corners[4]) {
    uint32_t below[4], above[4], polygon[4], turned[4];
    size_t low = 0, high = 0, count = 0, first = 0;
    for (int k = 0; k < 4; k++)
        if (cut->levels[corners[k]] < 0)
            below[low++] = corners[k];
        else if (cut->levels[corners[k]] > 0)
            above[high++] = corners[k];
        else
            polygon[count++] = corners[k];
    for (size_t i = 0; i < low; i++)
        for (size_t j = 0; j < high; j++) /* for two and two: around */
            polygon[count++] = point_on(cut, below[i], above[i % 2 == 0 ? j : high - 1 - j]);
    if (count < 4)
        return add_inner_polygon(cut, polygon, count, below[0]);
    for (size_t i = 0; i < 4; i++) /* the edge that is halved first has the diagonal */
        if (polygon[i] < polygon[first])
            first = i;
    for (size_t i = 0; i < 4; i++)
        turned[i] = polygon[(first + i) % 4];
    return add_inner_polygon(cut, turned, 4, below[0]);
}

/* A face on the cut between tetrahedra of both sides. */
static bool is_on_cut(const through_cut *cut, const uint32_t corners[3]) {
    return cut->levels[corners[0]] == 0 && cut->levels[corners[1]] == 0 &&
           cut->levels[corners[2]] == 0;
}

static starg_status add_faces_of(through_cut *cut, size_t t) {
    const starg_tetmesh *mesh = cut->meshes[0];
    int side = side_of(cut, mesh->tetrahedra + 4 * t);
    if (side < 0)
        TRY(add_cut_of(cut, mesh->tetrahedra + 4 * t));
    for (size_t face = 4 * t; face < 4 * t + 4; face++) {
        uint32_t corners[3], u = mesh->neighbours[face];
        piece_face_corners(mesh, face, corners);
        bool outer = u == STARG_TETMESH_NONE || !cut->inside[u], on = is_on_cut(cut, corners);
        if (outer && !on)
            TRY(add_outer_face(cut, corners));
        else if (on && (outer || side_of(cut, mesh->tetrahedra + 4 * (size_t)u) != side))
            TRY(add_polygon(cut, side, corners, 3));
    }
    return STARG_OK;
}

static starg_status list_faces(through_cut *cut) {
    cut->faces[0].count = cut->faces[1].count = 0;
    for (size_t t = 0; t < cut->meshes[0]->count; t++)
        if (cut->inside[t])
            TRY(add_faces_of(cut, t));
    return STARG_OK;
}

starg_status through_place(through_cut *cut, bool *found) {
    starg_status status = STARG_OK;
    bool below = false, above = false;
    STARG_TRY(move_onto_vertices(cut));
    STARG_TRY(list_edges(cut));
    STARG_TRY(place_points(cut));
    for (size_t v = 0; v < cut->meshes[0]->vertex_count; v++) {
        below = below || cut->levels[v] < 0;
        above = above || cut->levels[v] > 0;
    }
done:
    *found = below && above;
    return status;
}

starg_status through_find(through_cut *cut, double guards[2][2][3], bool *found) {
    TRY(through_place(cut, found));
    if (!*found)
        return STARG_OK;
    *found = false;
    TRY(list_faces(cut));
    for (int i = 0; i < 4; i++) {
        int part = i / 2, place = i % 2;
        const kernel_faces surface = {cut->places[place].data, cut->faces[part].data,
                                      cut->faces[part].count / 3};
        starg_kernel_result kernel;
        TRY(kernel_find(cut->context, &surface, &kernel));
        if (kernel.verdict != STARG_KERNEL_INTERIOR)
            return STARG_OK;
        vec3_copy(kernel.guard, guards[part][place]);
    }
    *found = true;
    return STARG_OK;
}

/* ---- dividing ---- */

/* The parts of a tetrahedron: edges that cross are halved in their order. */
static size_t divide(const through_cut *cut, const uint32_t corners[4],
                     uint32_t parts[PARTS_MOST][4]) {
    uint32_t point[6];
    size_t count = 1;
    memcpy(parts[0], corners, 4 * sizeof *corners);
    for (int e = 0; e < 6; e++)
        point[e] = point_on(cut, corners[EDGE[e][0]], corners[EDGE[e][1]]);
    for (;;) {
        int next = -1;
        for (int e = 0; e < 6; e++)
            if (point[e] != UINT32_MAX && (next < 0 || point[e] < point[next]))
                next = e;
        if (next < 0)
            return count;
        uint32_t a = corners[EDGE[next][0]], b = corners[EDGE[next][1]];
        for (size_t i = 0, before = count; i < before; i++) {
            int at_a = -1, at_b = -1;
            for (int k = 0; k < 4; k++) {
                at_a = parts[i][k] == a ? k : at_a;
                at_b = parts[i][k] == b ? k : at_b;
            }
            if (at_a < 0 || at_b < 0 || count == PARTS_MOST)
                continue;
            memcpy(parts[count], parts[i], 4 * sizeof *corners);
            parts[i][at_a] = point[next];
            parts[count++][at_b] = point[next];
        }
        point[next] = UINT32_MAX;
    }
}

/* In both places. */
static bool is_positive(const through_cut *cut, const uint32_t corners[4]) {
    for (int i = 0; i < 2; i++) {
        const double *p = cut->places[i].data;
        if (orient3d(p + 3 * (size_t)corners[0], p + 3 * (size_t)corners[1],
                     p + 3 * (size_t)corners[2], p + 3 * (size_t)corners[3]) >= 0)
            return false;
    }
    return true;
}

/* By the vertices that are not new. */
static uint32_t label_of(const through_cut *cut, const uint32_t corners[4]) {
    for (int k = 0; k < 4; k++)
        if (corners[k] < cut->meshes[0]->vertex_count && cut->levels[corners[k]] != 0)
            return THROUGH_PART + (cut->levels[corners[k]] > 0);
    return THROUGH_PART;
}

typedef struct divided {
    STARG_ARRAY(uint32_t) tetrahedra;
    STARG_ARRAY(uint32_t) labels;
} divided;

static starg_status divide_all(const through_cut *cut, const uint32_t *labels, divided *out,
                               bool *good) {
    const starg_tetmesh *mesh = cut->meshes[0];
    *good = true;
    for (size_t t = 0; t < mesh->count && *good; t++) {
        uint32_t parts[PARTS_MOST][4];
        size_t count = divide(cut, mesh->tetrahedra + 4 * t, parts);
        for (size_t i = 0; i < count && *good; i++) {
            *good = count == 1 || is_positive(cut, parts[i]);
            for (int k = 0; k < 4; k++)
                PUSH(cut->context, STAGE, &out->tetrahedra, parts[i][k]);
            PUSH(cut->context, STAGE, &out->labels,
                 cut->inside[t] ? label_of(cut, parts[i]) : labels[t]);
        }
    }
    return STARG_OK;
}

static starg_status adopt(const through_cut *cut, const divided *parts, int place,
                          starg_tetmesh **out) {
    SCOPED double *vertices = NULL;
    SCOPED uint32_t *tetrahedra = NULL;
    size_t size = cut->places[place].count;
    NEW(cut->context, STAGE, vertices, size);
    NEW(cut->context, STAGE, tetrahedra, parts->tetrahedra.count);
    memcpy(vertices, cut->places[place].data, size * sizeof *vertices);
    memcpy(tetrahedra, parts->tetrahedra.data, parts->tetrahedra.count * sizeof *tetrahedra);
    TRY(tetmesh_adopt(cut->context, vertices, size / 3, tetrahedra, parts->tetrahedra.count / 4,
                      NULL, true, out));
    vertices = NULL;
    tetrahedra = NULL;
    return STARG_OK;
}

starg_status through_divide(const through_cut *cut, const uint32_t *labels, starg_tetmesh *out[2],
                            uint32_t **out_labels, bool *good) {
    starg_status status = STARG_OK;
    divided parts = {0};
    out[0] = out[1] = NULL;
    *out_labels = NULL;
    STARG_TRY(divide_all(cut, labels, &parts, good));
    if (!*good)
        goto done;
    for (int i = 0; i < 2; i++)
        STARG_TRY(adopt(cut, &parts, i, &out[i]));
    *out_labels = parts.labels.data;
    parts.labels.data = NULL;
done:
    RELEASE(parts.tetrahedra.data, parts.labels.data);
    if (status != STARG_OK) {
        starg_tetmesh_free(out[0]);
        out[0] = NULL;
    }
    return status;
}
