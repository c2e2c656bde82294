/* SPDX-License-Identifier: Apache-2.0 */
/* Straight lines on a triangulated surface, from face to face by unfolding.
 *
 * In each face the step is expressed in barycentric coordinates; the first of them to become
 * negative determines the edge where it leaves. The rest of the step keeps its component along that
 * edge, and its component across continues in the neighbour's plane.
 *
 * Invariant: coordinates are at least 0 and sum to 1, so rounding cannot leave the surface. Cost:
 * O(faces crossed). */
#include "morph/surface_map.h"

#include "geometry/vec3.h"

enum { CROSSINGS = 200 };

static const double *corner_at(const starg_mesh *mesh, uint32_t halfedge) {
    return mesh->vertices + 3 * (size_t)mesh->faces[halfedge];
}

void surface_place(const starg_mesh *mesh, const surface_point *point, double out[3]) {
    double sum[3] = {0};
    for (uint32_t k = 0; k < 3; k++)
        vec3_along(sum, point->coordinates[k], corner_at(mesh, 3 * point->face + k), sum);
    vec3_copy(sum, out);
}

/* The unit normal; false for a zero-area face. */
static bool unit_normal(const starg_mesh *mesh, uint32_t face, double out[3]) {
    vec3_triangle_normal(corner_at(mesh, 3 * face), corner_at(mesh, 3 * face + 1),
                         corner_at(mesh, 3 * face + 2), out);
    double length = vec3_length(out);
    for (int k = 0; k < 3; k++)
        out[k] /= length;
    return length > 0 && isfinite(1 / length);
}

/* The gradients of a face's three coordinates. */
static void coordinate_gradients(const starg_mesh *mesh, uint32_t face, const double normal[3],
                                 double out[3][3]) {
    double edges[3][3], cross[3];
    for (uint32_t k = 0; k < 3; k++) /* the edge opposite to corner k */
        vec3_subtract(corner_at(mesh, 3 * face + (k + 2) % 3),
                      corner_at(mesh, 3 * face + (k + 1) % 3), edges[k]);
    vec3_cross(edges[0], edges[1], cross);
    double twice_area = vec3_dot(cross, normal);
    for (int k = 0; k < 3; k++) {
        vec3_cross(normal, edges[k], out[k]);
        for (int j = 0; j < 3; j++)
            out[k][j] /= twice_area;
    }
}

bool surface_gradient(const starg_mesh *mesh, const surface_point *point, const double slopes[3],
                      double out[3]) {
    double normal[3], gradients[3][3];
    out[0] = out[1] = out[2] = 0;
    if (!unit_normal(mesh, point->face, normal))
        return false;
    coordinate_gradients(mesh, point->face, normal, gradients);
    for (int k = 0; k < 3; k++)
        vec3_along(out, slopes[k], gradients[k], out);
    return true;
}

/* Moves within the face; returns the completed share of the step, and the corner opposite to the
 * edge that stops it (3: none does, or the face is too thin and nothing is done). */
static double advance(surface_point *point, const double change[3], uint32_t *opposite) {
    double share = 1, sum = 0, moved[3];
    *opposite = 3;
    for (uint32_t k = 0; k < 3; k++)
        if (point->coordinates[k] + share * change[k] < 0) {
            share = fmax(0, -point->coordinates[k] / change[k]);
            *opposite = k;
        }
    for (uint32_t k = 0; k < 3; k++) {
        double x = point->coordinates[k] + share * change[k];
        moved[k] = k == *opposite || x < 0 ? 0 : x;
        sum += moved[k];
    }
    if (!(sum > 0 && sum < INFINITY)) {
        *opposite = 3;
        return 1;
    }
    for (int k = 0; k < 3; k++)
        point->coordinates[k] = moved[k] / sum;
    return share;
}

/* Moves a point on the edge of a halfedge to the neighbour, and rotates the vector along. */
static bool cross_edge(const starg_mesh *mesh, uint32_t halfedge, uint32_t twin,
                       surface_point *point, double normal[3], double v[3]) {
    double edge[3], outward[3], next[3];
    vec3_subtract(corner_at(mesh, corner_next(halfedge)), corner_at(mesh, halfedge), edge);
    double length = vec3_length(edge);
    if (!(length > 0) || !unit_normal(mesh, twin / 3, next))
        return false;
    for (int k = 0; k < 3; k++)
        edge[k] /= length;
    vec3_cross(edge, normal, outward);
    double along = vec3_dot(v, edge), across = vec3_dot(v, outward);
    vec3_cross(edge, next, outward);
    for (int k = 0; k < 3; k++)
        v[k] = along * edge[k] + across * outward[k];
    vec3_copy(next, normal);
    surface_point moved = {.face = twin / 3};
    moved.coordinates[twin % 3] = point->coordinates[corner_next(halfedge) % 3];
    moved.coordinates[corner_next(twin) % 3] = point->coordinates[halfedge % 3];
    *point = moved;
    return true;
}

void surface_walk(const starg_mesh *mesh, const mesh_topology *topology, const double step[3],
                  surface_point *point) {
    double v[3], normal[3], change[3], gradients[3][3];
    vec3_copy(step, v);
    if (!unit_normal(mesh, point->face, normal))
        return;
    for (int i = 0; i < CROSSINGS; i++) {
        uint32_t opposite;
        coordinate_gradients(mesh, point->face, normal, gradients);
        for (int k = 0; k < 3; k++)
            change[k] = vec3_dot(gradients[k], v);
        double share = advance(point, change, &opposite);
        if (opposite == 3)
            return;
        for (int k = 0; k < 3; k++)
            v[k] *= 1 - share;
        uint32_t halfedge = 3 * point->face + (opposite + 1) % 3, twin = topology->twin[halfedge];
        if (twin == TOPOLOGY_NONE || !cross_edge(mesh, halfedge, twin, point, normal, v))
            return;
    }
}
