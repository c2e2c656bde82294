/* SPDX-License-Identifier: Apache-2.0 */
/* The overlay of a map is a common refinement of both triangulations.
 *
 * Weights of corners are homogeneous coordinates of points in a face: three points turn to the left
 * exactly if the determinant of their weights is positive, whatever the face's shape. Let all
 * triangles be positive in a face of the surface, and each edge have two of them that run along it
 * in opposite directions. Within a face the number of triangles that cover a point changes nowhere,
 * and if it is one somewhere, they fill the face once. So triangles correspond one to one with
 * parts of A, and with parts of B: a bijection that is linear on each.
 *
 * All exact in the weights. Cost: O(n log n). */
#include <math.h>
#include <stdlib.h>

#include "verify/map.h"

static const char STAGE[] = "verify";
static const double ORIGIN[3], SUM_ERROR = 1e-12;
enum { CANCEL_STEP = 1024, NOWHERE = -1 };

bool verify_weights_in(const starg_mesh *mesh, const verify_places *places, size_t i,
                       const uint32_t corner[3], double w[3]) {
    const uint32_t *own = starg_mesh_faces(mesh) + 3 * (size_t)places->faces[i];
    size_t held = 0, placed = 0;
    w[0] = w[1] = w[2] = 0;
    for (size_t k = 0; k < 3; k++) {
        double weight = places->weights[3 * i + k];
        held += weight != 0;
        for (size_t j = 0; j < 3 && weight != 0; j++)
            if (corner[j] == own[k]) {
                w[j] = weight;
                placed++;
            }
    }
    return held > 0 && held == placed;
}

/* ---- edges ---- */

static int compare_edges(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static uint64_t edge_of(const uint32_t *triangles, size_t e) {
    return (uint64_t)triangles[e] << 32 | triangles[e % 3 == 2 ? e - 2 : e + 1];
}

/* Does each directed edge stand once, and its opposite as well? */
static starg_status find_closed(const verify_map *own, bool *closed) {
    size_t count = 3 * own->file->overlay_faces;
    SCOPED uint64_t *edges = NULL;
    NEW(own->context, STAGE, edges, count);
    for (size_t e = 0; e < count; e++)
        edges[e] = edge_of(own->file->triangles, e);
    qsort(edges, count, sizeof *edges, compare_edges);
    *closed = true;
    for (size_t e = 0; e < count && *closed; e++) {
        uint64_t back = edges[e] << 32 | edges[e] >> 32;
        *closed = (e == 0 || edges[e] != edges[e - 1]) &&
                  bsearch(&back, edges, count, sizeof *edges, compare_edges) != NULL;
    }
    return STARG_OK;
}

/* ---- triangles in faces ---- */

/* The overlay's triangles by the face of one surface that they are in. */
typedef struct sorted {
    int32_t *face;   /* of each triangle, or NOWHERE */
    size_t *start;   /* by face */
    uint32_t *order; /* triangles by face */
} sorted;

static void sorted_free(sorted *own) {
    RELEASE(own->face, own->start, own->order);
}

/* Triangles are oriented as A is in its file, surfaces outward. */
static size_t turned_corner(const verify_map *own, size_t k) {
    bool turned = own->surface[0]->faces[1] != starg_mesh_faces(own->mesh[0])[1];
    return turned && k > 0 ? 3 - k : k;
}

/* The weights of a triangle's corners in a face; false if it is not in it. */
static bool triangle_in(const verify_map *own, int s, size_t t, size_t face, double w[3][3]) {
    const starg_map_file *file = own->file;
    for (size_t k = 0; k < 3; k++)
        if (!verify_weights_in(own->mesh[s], &file->overlay[s], file->triangles[3 * t + k],
                               own->surface[s]->faces + 3 * face, w[turned_corner(own, k)]))
            return false;
    return true;
}

/* The face that holds a triangle and in which it is positive: one at a corner of it, or a
 * neighbour of that. `at` lists the faces at each vertex. */
typedef struct fans {
    size_t *start; /* by vertex */
    uint32_t *faces;
} fans;

static starg_status make_fans(const verify_map *own, int s, fans *out) {
    const verify_surface *surface = own->surface[s];
    NEW_ZERO(own->context, STAGE, out->start, surface->vertex_count + 2);
    NEW(own->context, STAGE, out->faces, 3 * surface->face_count);
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        out->start[surface->faces[e] + 2]++;
    for (size_t v = 2; v < surface->vertex_count + 2; v++)
        out->start[v] += out->start[v - 1];
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        out->faces[out->start[surface->faces[e] + 1]++] = (uint32_t)(e / 3);
    return STARG_OK;
}

/* A vertex with a weight at the place of a triangle's first corner: all faces of the triangle are
 * around it. */
static uint32_t vertex_near(const verify_map *own, int s, size_t t) {
    const verify_places *places = &own->file->overlay[s];
    size_t i = own->file->triangles[3 * t];
    const uint32_t *corner = starg_mesh_faces(own->mesh[s]) + 3 * (size_t)places->faces[i];
    for (size_t k = 0; k < 3; k++)
        if (places->weights[3 * i + k] != 0)
            return corner[k];
    return corner[0];
}

static int32_t face_of(const verify_map *own, int s, const fans *at, size_t t) {
    uint32_t v = vertex_near(own, s, t);
    double w[3][3];
    for (size_t i = at->start[v]; i < at->start[v + 1]; i++)
        if (triangle_in(own, s, t, at->faces[i], w))
            return verify_side(w[0], w[1], w[2], ORIGIN) > 0 ? (int32_t)at->faces[i] : NOWHERE;
    return NOWHERE;
}

static starg_status sort_triangles(const verify_map *own, int s, sorted *out, size_t *bad,
                                   size_t *first) {
    starg_status status = STARG_OK;
    size_t count = own->file->overlay_faces, faces = own->surface[s]->face_count;
    fans at = {0};
    *bad = 0;
    STARG_TRY(make_fans(own, s, &at));
    STARG_NEW(own->context, STAGE, out->face, count);
    STARG_NEW_ZERO(own->context, STAGE, out->start, faces + 2);
    STARG_NEW(own->context, STAGE, out->order, count);
    for (size_t t = count; t-- > 0;) {
        if (t % CANCEL_STEP == 0)
            STARG_TRY(starg_check_cancel(own->context, STAGE));
        out->face[t] = face_of(own, s, &at, t);
        if (out->face[t] != NOWHERE) {
            out->start[out->face[t] + 2]++;
            continue;
        }
        ++*bad;
        *first = t;
    }
    for (size_t f = 2; f < faces + 2; f++)
        out->start[f] += out->start[f - 1];
    for (size_t t = 0; t < count; t++)
        if (out->face[t] != NOWHERE)
            out->order[out->start[out->face[t] + 1]++] = (uint32_t)t;
done:
    RELEASE(at.start, at.faces);
    return status;
}

/* How many of a face's triangles cover a point? -1: it is on the boundary of one. */
static int count_cover(const verify_map *own, int s, const sorted *by, size_t face,
                       const double x[3]) {
    int count = 0;
    for (size_t i = by->start[face]; i < by->start[face + 1]; i++) {
        double w[3][3];
        int least = 1;
        triangle_in(own, s, by->order[i], face, w);
        for (int k = 0; k < 3; k++) {
            int sign = verify_side(w[k], w[(k + 1) % 3], x, ORIGIN);
            least = sign < least ? sign : least;
        }
        if (least == 0)
            return -1;
        count += least > 0;
    }
    return count;
}

static size_t count_uneven(const verify_map *own, int s, const sorted *by, size_t *first) {
    size_t uneven = 0;
    for (size_t f = own->surface[s]->face_count; f-- > 0;) {
        int count = -1;
        for (int i = 0; i < 100 && count < 0; i++) {
            const double x[3] = {1, 1 + 0.1234567 * i, 1 + 0.7654321 * i};
            count = count_cover(own, s, by, f, x);
        }
        if (count == 1)
            continue;
        uneven++;
        *first = f;
    }
    return uneven;
}

static starg_status claim_fills(const verify_map *own, int s) {
    SCOPED_BY(sorted_free) sorted by = {0};
    size_t bad, first = 0, uneven, first_uneven = 0;
    TRY(sort_triangles(own, s, &by, &bad, &first));
    uneven = count_uneven(own, s, &by, &first_uneven);
    verify_claim_all(own->verdict, bad, first,
                     "each triangle of the overlay is in a face of %c, and positive there",
                     'A' + s);
    verify_claim_all(own->verdict, uneven, first_uneven, "they cover each face of %c once",
                     'A' + s);
    return STARG_OK;
}

/* ---- vertices ---- */

/* Is each vertex of a surface one of the overlay? `at` receives the last one there. */
static starg_status claim_vertices(const verify_map *own, int s, uint32_t *at) {
    const verify_places *places = &own->file->overlay[s];
    size_t count = starg_mesh_vertex_count(own->mesh[s]), missing = 0, first = 0;
    for (size_t v = 0; v < count; v++)
        at[v] = UINT32_MAX;
    for (size_t i = 0; i < own->file->overlay_points; i++)
        for (size_t k = 0; k < 3; k++)
            if (places->weights[3 * i + k] != 0 && places->weights[3 * i + (k + 1) % 3] == 0 &&
                places->weights[3 * i + (k + 2) % 3] == 0)
                at[starg_mesh_faces(own->mesh[s])[3 * (size_t)places->faces[i] + k]] = (uint32_t)i;
    for (size_t v = count; v-- > 0;)
        if (at[v] == UINT32_MAX) {
            missing++;
            first = v;
        }
    verify_claim_all(own->verdict, missing, first, "all vertices of %c are among the overlay's",
                     'A' + s);
    return STARG_OK;
}

static void claim_images(const verify_map *own, const uint32_t *at) {
    const starg_map_file *file = own->file;
    size_t different = 0, first = 0;
    for (size_t v = file->point_count; v-- > 0;) {
        const uint32_t *corner = starg_mesh_faces(own->mesh[1]) + 3 * (size_t)file->points.faces[v];
        double w[3];
        bool same = at[v] != UINT32_MAX &&
                    verify_weights_in(own->mesh[1], &file->overlay[1], at[v], corner, w);
        for (size_t k = 0; k < 3 && same; k++)
            same = w[k] == file->points.weights[3 * v + k];
        if (!same) {
            different++;
            first = v;
        }
    }
    verify_claim_all(own->verdict, different, first, "vertices go to where the overlay has them");
}

/* ---- all of it ---- */

static bool is_in_range(const verify_map *own) {
    const starg_map_file *file = own->file;
    for (size_t i = 0; i < 3 * file->overlay_faces; i++)
        if (file->triangles[i] >= file->overlay_points)
            return false;
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < file->overlay_points; i++) {
            const double *w = file->overlay[s].weights + 3 * i;
            if (file->overlay[s].faces[i] >= own->surface[s]->face_count ||
                !(w[0] >= 0 && w[1] >= 0 && w[2] >= 0 && fabs(w[0] + w[1] + w[2] - 1) <= SUM_ERROR))
                return false;
        }
    return true;
}

starg_status verify_claim_overlay(const verify_map *own) {
    SCOPED uint32_t *at = NULL;
    bool closed;
    size_t most = starg_mesh_vertex_count(own->mesh[1]);
    if (!is_in_range(own)) {
        verify_claim(own->verdict, false,
                     "the overlay's points and triangles are of these models: an index is out of "
                     "range, or weights are negative or do not sum to 1");
        return STARG_OK;
    }
    most = most > own->file->point_count ? most : own->file->point_count;
    NEW(own->context, STAGE, at, most);
    TRY(find_closed(own, &closed));
    verify_claim(own->verdict, closed, "the overlay is closed: each edge has two triangles");
    for (int s = 0; s < 2; s++)
        TRY(claim_fills(own, s));
    TRY(claim_vertices(own, 1, at));
    TRY(claim_vertices(own, 0, at));
    claim_images(own, at);
    return STARG_OK;
}
