/* SPDX-License-Identifier: Apache-2.0 */
/* Faces cut into patches.
 *
 * Problem: parts of a triangle whose edges are at most so long, as few as possible, and such that
 * others can find the same ones.
 *
 * Method: the longest edge of a triangle is halved until it is short enough [Rivara 1984]. Angles
 * stay bounded, and long thin faces are cut across. Halves of an edge that two faces share are the
 * same points, found again by a table, so that a row of visibility looks at them once. Weights are
 * whole numbers; lengths are those of the doubles that follow from them, by one formula
 * (patch_longest_edge), so that the parts are the same everywhere.
 *
 * Cost: O(patches). */
#include "mesh/solid.h"

#include <stdlib.h>

#include "core/rng.h"
#include "geometry/vec3.h"

static const char STAGE[] = "patches";

enum { FIRST_SLOTS = 64 };

/* ---- one triangle ---- */

int patch_longest_edge(const patch_triangle *t, const double *const corner[3], unsigned among,
                       double *square) {
    double ab[3], ac[3];
    int longest = 0;
    *square = -1;
    vec3_subtract(corner[1], corner[0], ab);
    vec3_subtract(corner[2], corner[0], ac);
    for (int k = 0; k < 3; k++) {
        const uint32_t *from = t->corner[k].weight, *to = t->corner[(k + 1) % 3].weight;
        if ((among >> k & 1) == 0)
            continue;
        double e1 = ldexp((double)to[1] - (double)from[1], -PATCH_DEPTH);
        double e2 = ldexp((double)to[2] - (double)from[2], -PATCH_DEPTH);
        double x = e1 * ab[0] + e2 * ac[0], y = e1 * ab[1] + e2 * ac[1];
        double z = e1 * ab[2] + e2 * ac[2], length = x * x + y * y + z * z;
        if (length > *square) {
            *square = length;
            longest = k;
        }
    }
    return longest;
}

bool patch_halve(const patch_triangle *t, int k, patch_triangle child[2]) {
    const uint32_t *from = t->corner[k].weight, *to = t->corner[(k + 1) % 3].weight;
    patch_corner middle;
    for (int i = 0; i < 3; i++) {
        if ((from[i] + to[i]) % 2 != 0)
            return false;
        middle.weight[i] = (from[i] + to[i]) / 2;
    }
    child[0] = child[1] = *t;
    child[0].corner[(k + 1) % 3] = child[1].corner[k] = middle;
    return true;
}

/* The share of the face's area. */
static double patch_share(const patch_triangle *t) {
    double m[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = ldexp(t->corner[i].weight[k], -PATCH_DEPTH);
    return fabs((m[1][1] - m[0][1]) * (m[2][2] - m[0][2]) -
                (m[1][2] - m[0][2]) * (m[2][1] - m[0][1]));
}

/* ---- points ---- */

static void exchange(patch_point *p, int i, int j) {
    uint32_t vertex = p->vertex[i], weight = p->weight[i];
    p->vertex[i] = p->vertex[j];
    p->weight[i] = p->weight[j];
    p->vertex[j] = vertex;
    p->weight[j] = weight;
}

bool patch_point_of(const uint32_t face[3], const patch_corner *corner, patch_point *point,
                    uint32_t *vertex) {
    int count = 0;
    *point = (patch_point){{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0}, PATCH_DEPTH};
    for (int k = 0; k < 3; k++)
        if (corner->weight[k] > 0) {
            point->vertex[count] = face[k];
            point->weight[count++] = corner->weight[k];
        }
    *vertex = point->vertex[0];
    if (count == 1)
        return false;
    while (((point->weight[0] | point->weight[1] | point->weight[2]) & 1) == 0) {
        for (int k = 0; k < 3; k++)
            point->weight[k] /= 2;
        point->depth--;
    }
    if (point->vertex[1] > point->vertex[2])
        exchange(point, 1, 2);
    if (point->vertex[0] > point->vertex[1])
        exchange(point, 0, 1);
    if (point->vertex[1] > point->vertex[2])
        exchange(point, 1, 2);
    return true;
}

dyadic_point patch_point_dyadic(const patch_point *point, const double *vertices) {
    dyadic_point out = {.depth = point->depth};
    for (int k = 0; k < 3; k++) {
        out.weight[k] = point->weight[k];
        out.corner[k] = point->weight[k] > 0 ? vertices + 3 * (size_t)point->vertex[k] : NULL;
    }
    dyadic_round(&out);
    return out;
}

static bool same_point(const patch_point *a, const patch_point *b) {
    for (int k = 0; k < 3; k++)
        if (a->vertex[k] != b->vertex[k] || a->weight[k] != b->weight[k])
            return false;
    return true;
}

static uint32_t *find_slot(const mesh_patches *set, const patch_point *point) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++)
        hash = starg_hash64(hash + ((uint64_t)point->vertex[k] << 32 | point->weight[k]));
    size_t i = hash & (set->slot_count - 1);
    while (set->slots[i] != 0 && !same_point(&set->points.data[set->slots[i] - 1], point))
        i = (i + 1) & (set->slot_count - 1);
    return &set->slots[i];
}

static starg_status grow_slots(mesh_patches *set) {
    if (2 * (set->points.count + 1) <= set->slot_count)
        return STARG_OK;
    size_t count = set->slot_count > 0 ? 2 * set->slot_count : FIRST_SLOTS;
    starg_release(set->context, set->slots);
    NEW_ZERO(set->context, STAGE, set->slots, count);
    set->slot_count = count;
    for (size_t i = 0; i < set->points.count; i++)
        *find_slot(set, &set->points.data[i]) = (uint32_t)i + 1;
    return STARG_OK;
}

static starg_status push_point(mesh_patches *set, const double *vertices,
                               const patch_point *point) {
    const dyadic_point at = patch_point_dyadic(point, vertices);
    PUSH(set->context, STAGE, &set->points, *point);
    for (int k = 0; k < 3; k++)
        PUSH(set->context, STAGE, &set->places, at.at[k]);
    return STARG_OK;
}

static starg_status push_corner(mesh_patches *set, const starg_mesh *mesh, size_t face,
                                const patch_corner *corner) {
    patch_point point;
    uint32_t number;
    if (patch_point_of(mesh->faces + 3 * face, corner, &point, &number)) {
        TRY(grow_slots(set));
        uint32_t *slot = find_slot(set, &point);
        if (*slot == 0) {
            TRY(push_point(set, mesh->vertices, &point));
            *slot = (uint32_t)set->points.count;
        }
        number = (uint32_t)set->vertex_count + *slot - 1;
    }
    PUSH(set->context, STAGE, &set->corner, number);
    return STARG_OK;
}

/* ---- all faces ---- */

static starg_status make_set(starg_context *context, const starg_mesh *mesh, size_t corners,
                             mesh_patches **out) {
    mesh_patches *set = NULL;
    NEW_ZERO(context, STAGE, set, 1);
    set->context = context;
    set->corners = corners;
    set->vertex_count = mesh->vertex_count;
    *out = set;
    NEW(context, STAGE, set->first, mesh->face_count + 1);
    return STARG_OK;
}

/* Triangles of one face that wait to be cut: one for each halving at most. */
typedef struct waiting {
    patch_triangle stack[2 * PATCH_DEPTH + 4];
    size_t depth;
} waiting;

/* Cuts triangles from the stack until one is small enough. */
static patch_triangle next_small(waiting *w, const double *const corner[3], double square) {
    for (;;) {
        patch_triangle t = w->stack[--w->depth], child[2];
        double length;
        int k = patch_longest_edge(&t, corner, ALL_EDGES, &length);
        if (!(length > square) || w->depth + 2 > sizeof w->stack / sizeof *w->stack ||
            !patch_halve(&t, k, child))
            return t;
        w->stack[w->depth++] = child[1];
        w->stack[w->depth++] = child[0];
    }
}

static void corners_of(const starg_mesh *mesh, size_t face, const double *corner[3]) {
    for (size_t k = 0; k < 3; k++)
        corner[k] = mesh->vertices + 3 * (size_t)mesh->faces[3 * face + k];
}

size_t patches_count(const starg_mesh *mesh, size_t faces, double longest, size_t most) {
    size_t count = mesh->face_count - faces;
    for (size_t f = 0; f < faces && count <= most; f++) {
        const double *corner[3];
        waiting w = {{patch_whole()}, 1};
        corners_of(mesh, f, corner);
        for (; w.depth > 0 && count <= most; count++)
            next_small(&w, corner, longest * longest);
    }
    return count;
}

static starg_status push_patch(mesh_patches *set, const starg_mesh *mesh, uint32_t face,
                               const patch_triangle *t) {
    for (size_t k = 0; k < 3; k++)
        TRY(push_corner(set, mesh, face, &t->corner[k]));
    PUSH(set->context, STAGE, &set->face, face);
    PUSH(set->context, STAGE, &set->share, patch_share(t));
    return STARG_OK;
}

static starg_status push_face(mesh_patches *set, const starg_mesh *mesh, uint32_t face,
                              double square) {
    const double *corner[3];
    waiting w = {{patch_whole()}, 1};
    corners_of(mesh, face, corner);
    while (w.depth > 0) {
        const patch_triangle t = next_small(&w, corner, square);
        TRY(push_patch(set, mesh, face, &t));
    }
    return STARG_OK;
}

/* The patches of an earlier face, from the other side. */
static starg_status push_turned(mesh_patches *set, uint32_t face, uint32_t front) {
    for (size_t i = set->first[front]; i < set->first[front + 1]; i++) {
        for (size_t k = set->corners; k-- > 0;) {
            uint32_t corner = set->corner.data[set->corners * i + k];
            PUSH(set->context, STAGE, &set->corner, corner);
        }
        double share = set->share.data[i];
        PUSH(set->context, STAGE, &set->face, face);
        PUSH(set->context, STAGE, &set->share, share);
    }
    return STARG_OK;
}

starg_status patches_divide(starg_context *context, const starg_mesh *mesh, size_t faces,
                            double longest, const uint32_t *other_side, mesh_patches **out) {
    SCOPED_BY(patches_drop) mesh_patches *set = NULL;
    *out = NULL;
    size_t count = patches_count(mesh, faces, longest, MOST_PATCHES);
    if (count > MOST_PATCHES)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "patches of at most %g are more than %d; ask for larger ones", longest,
                          MOST_PATCHES);
    if (count == mesh->face_count)
        return STARG_OK;
    TRY(make_set(context, mesh, 3, &set));
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        bool turned = other_side != NULL && other_side[f] < f;
        set->first[f] = set->face.count;
        if (turned)
            TRY(push_turned(set, f, other_side[f]));
        else
            TRY(push_face(set, mesh, f, f < faces ? longest * longest : INFINITY));
    }
    set->first[mesh->face_count] = set->face.count;
    *out = set;
    set = NULL;
    return STARG_OK;
}

int face_points_compare(const void *a, const void *b) {
    const face_point *x = a, *y = b;
    if (x->face != y->face)
        return x->face < y->face ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->at.weight[k] != y->at.weight[k])
            return x->at.weight[k] > y->at.weight[k] ? -1 : 1;
    return 0;
}

/* Weights by the vertices of the face, in its order. */
static patch_corner corner_in(const mesh_patches *set, const uint32_t face[3], uint32_t corner) {
    patch_corner at = {{0}};
    const patch_point *point =
        corner < set->vertex_count ? NULL : &set->points.data[corner - set->vertex_count];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (point == NULL ? face[k] == corner : face[k] == point->vertex[i])
                at.weight[k] =
                    point == NULL ? PATCH_UNIT : point->weight[i] << (PATCH_DEPTH - point->depth);
    return at;
}

starg_status patches_list_corners(const mesh_patches *set, const starg_mesh *mesh, uint32_t face,
                                  face_points *out) {
    for (size_t i = set->corners * set->first[face]; i < set->corners * set->first[face + 1]; i++) {
        const face_point point = {
            face, corner_in(set, mesh->faces + 3 * (size_t)face, set->corner.data[i])};
        PUSH(set->context, STAGE, out, point);
    }
    return STARG_OK;
}

static void sort_points(face_points *points) {
    size_t kept = 0;
    if (points->count > 0)
        qsort(points->data, points->count, sizeof *points->data, face_points_compare);
    for (size_t i = 0; i < points->count; i++)
        if (kept == 0 || face_points_compare(&points->data[kept - 1], &points->data[i]) != 0)
            points->data[kept++] = points->data[i];
    points->count = kept;
}

starg_status patches_of_points(starg_context *context, const starg_mesh *mesh, face_points *points,
                               const uint32_t *other_side, mesh_patches **out) {
    SCOPED_BY(patches_drop) mesh_patches *set = NULL;
    size_t next = 0;
    *out = NULL;
    sort_points(points);
    TRY(make_set(context, mesh, 1, &set));
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        set->first[f] = set->face.count;
        if (other_side != NULL && other_side[f] < f)
            TRY(push_turned(set, f, other_side[f]));
        for (; next < points->count && points->data[next].face == f; next++) {
            const double none = 0;
            TRY(push_corner(set, mesh, f, &points->data[next].at));
            PUSH(context, STAGE, &set->face, f);
            PUSH(context, STAGE, &set->share, none);
        }
    }
    set->first[mesh->face_count] = set->face.count;
    *out = set;
    set = NULL;
    return STARG_OK;
}

void patches_free(mesh_patches *set) {
    if (set == NULL)
        return;
    RELEASE(set->first, set->slots, set->face.data, set->corner.data, set->share.data,
            set->points.data, set->places.data, set);
}
