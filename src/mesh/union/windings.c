/* SPDX-License-Identifier: Apache-2.0 */
/* Winding numbers on both sides of a cut surface, exact.
 *
 * Triangles that are linked across edges of two form a patch; all of a patch has the same number in
 * front, and its layers more behind. One line for each patch finds it: from a rational point inside
 * of one of its triangles along the axis that is steepest there. The number is the sum over the
 * faces of the surface that the line leaves or enters. A point whose line meets an edge is replaced
 * by the next of a sequence: barycentric weights 1 : i : i^2, of which no three are on a line, so
 * that each edge spoils two of them at most.
 *
 * Cost: O(n log n), and a query of the tree for each patch. */
#include "mesh/union/arrangement.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

enum { LINES_PER_CHECK = 64, MOST_TRIALS = 10000 };

/* ---- a line ---- */

typedef struct line {
    const union_surface *surface;
    int scale;
    exact_point from;
    int u, v, axis; /* right-handed */
    int winding;    /* just above the point */
    bool spoiled;   /* it meets an edge */
} line;

/* What a face adds that the line leaves (1) or enters (-1). */
static bool count_face(void *user, uint32_t face) {
    line *l = user;
    const double *corner[3];
    exact_point place[3];
    int turn[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = union_corner(l->surface, face, k);
        exact_point_set(&place[k], corner[k], l->scale);
    }
    for (int k = 0; k < 3; k++)
        turn[k] = exact_turn(&place[k], &place[(k + 1) % 3], &l->from, l->u, l->v);
    bool left = turn[0] > 0 || turn[1] > 0 || turn[2] > 0;
    bool right = turn[0] < 0 || turn[1] < 0 || turn[2] < 0;
    if (left && right)
        return true;
    l->spoiled = turn[0] == 0 || turn[1] == 0 || turn[2] == 0;
    if (l->spoiled)
        return false;
    exact_plane plane;
    exact_plane_set(&plane, corner, l->scale);
    /* a face that looks up lies above the point behind it, one that looks down in front of it */
    if (exact_side(&plane, &l->from) == -turn[0])
        l->winding += turn[0];
    return true;
}

/* The points of the line from `from`, and its rounding errors on all sides. */
static bvh_box box_of_line(const line *l) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        box.lower[k] = nextafter(l->from.rounded[k], -INFINITY);
        box.upper[k] = k == l->axis ? INFINITY : nextafter(l->from.rounded[k], INFINITY);
    }
    return box;
}

/* Aims the line along an axis that the triangle is not parallel to, preferably far from it; returns
 * the way in which the triangle turns about that axis. */
static int choose_axis(line *l, const exact_point corner[3]) {
    double normal[3];
    vec3_triangle_normal(corner[0].rounded, corner[1].rounded, corner[2].rounded, normal);
    l->axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[l->axis]))
            l->axis = k;
    for (;; l->axis = (l->axis + 1) % 3) {
        l->u = (l->axis + 1) % 3;
        l->v = (l->axis + 2) % 3;
        int turn = exact_turn(&corner[0], &corner[1], &corner[2], l->u, l->v);
        if (turn != 0)
            return turn;
    }
}

/* The winding number in front of a triangle. */
static starg_status shoot(const union_complex *complex, const bvh *tree, uint32_t triangle,
                          int *front) {
    const union_triangle *own = &complex->triangles.data[triangle];
    line l = {.surface = complex->surface, .scale = complex->points.scale, .spoiled = true};
    exact_point corner[3];
    for (int k = 0; k < 3; k++)
        union_complex_place(complex, own->corner[k], &corner[k]);
    int turn = choose_axis(&l, corner);
    for (uint32_t i = 1; i < MOST_TRIALS && l.spoiled; i++) {
        const uint32_t weight[3] = {1, i, i * i};
        exact_point_between(&l.from,
                            (const exact_point *const[]){&corner[0], &corner[1], &corner[2]},
                            weight, l.scale);
        bvh_box box = box_of_line(&l);
        l.winding = 0;
        l.spoiled = false;
        bvh_query_box(tree, &box, count_face, &l);
    }
    if (l.spoiled)
        return starg_fail_at(complex->context, STARG_ERROR_SOLVER, UNION_STAGE, STARG_ELEMENT_FACE,
                             (const uint64_t[]){complex->surface->origin.data[own->face]}, 1,
                             "every line from face %u meets edges",
                             complex->surface->origin.data[own->face]);
    *front = turn > 0 ? l.winding : l.winding - own->layers;
    return STARG_OK;
}

/* ---- patches ---- */

static double area_of(const union_complex *complex, const union_triangle *triangle) {
    return vec3_triangle_area(union_complex_rounded(complex, triangle->corner[0]),
                              union_complex_rounded(complex, triangle->corner[1]),
                              union_complex_rounded(complex, triangle->corner[2]));
}

/* Joins triangles across edges of two. */
static starg_status find_patches(const union_complex *complex, uint32_t *patch) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED uint32_t *faces = NULL;
    size_t count = complex->triangles.count;
    NEW(complex->context, UNION_STAGE, faces, 3 * count);
    for (size_t i = 0; i < 3 * count; i++)
        faces[i] = complex->triangles.data[i / 3].corner[i % 3];
    const starg_mesh mesh = {.context = complex->context,
                             .vertex_count =
                                 complex->surface->vertices.count / 3 + complex->added.count,
                             .face_count = count,
                             .faces = faces};
    TRY(topology_create(complex->context, &mesh, &topology));
    sets_make(patch, count);
    for (uint32_t h = 0; h < 3 * count; h++)
        if (topology->twin[h] != TOPOLOGY_NONE)
            sets_join(patch, h / 3, topology->twin[h] / 3);
    return STARG_OK;
}

/* For the root of each patch its largest triangle; whole faces, whose corners are short, first. */
static starg_status find_largest(const union_complex *complex, uint32_t *patch, uint32_t *largest) {
    SCOPED double *size = NULL;
    NEW(complex->context, UNION_STAGE, size, complex->triangles.count);
    for (uint32_t t = 0; t < complex->triangles.count; t++) {
        const union_triangle *own = &complex->triangles.data[t];
        uint32_t root = sets_find(patch, t), best = largest[root];
        size[t] = area_of(complex, own);
        if (t == root || own->whole > complex->triangles.data[best].whole ||
            (own->whole == complex->triangles.data[best].whole && size[t] > size[best]))
            largest[root] = t;
    }
    return STARG_OK;
}

starg_status union_choose(const union_complex *complex, const bvh *tree, bool *keep) {
    SCOPED uint32_t *patch = NULL, *largest = NULL;
    size_t count = complex->triangles.count;
    NEW(complex->context, UNION_STAGE, patch, count);
    NEW(complex->context, UNION_STAGE, largest, count);
    TRY(find_patches(complex, patch));
    TRY(find_largest(complex, patch, largest));
    for (uint32_t t = 0; t < count; t++) { /* a root is the lowest of its patch */
        uint32_t root = sets_find(patch, t);
        int front;
        if (root != t) {
            keep[t] = keep[root];
            continue;
        }
        TRY(shoot(complex, tree, largest[root], &front));
        keep[t] = front < 1 && front + complex->triangles.data[t].layers >= 1;
        if (t % LINES_PER_CHECK == 0)
            TRY(starg_check_cancel(complex->context, UNION_STAGE));
    }
    return STARG_OK;
}
