/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility_oracle.h"

#include <math.h>
#include <stdlib.h>

#include "exact_oracle.h"

/* ---- signs in doubles, where they are certain ---- */

/* Sign of det(a, b, c) for vectors that are rounded differences of doubles below 1e100; 0 if
 * rounding could have changed it. The error is below 16 units of 2^-53 of the sum of the absolute
 * products; underflow of a product of two loses less than 1e-220 in total. */
static int certain_sign(const double a[3], const double b[3], const double c[3]) {
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double plus = a[k] * (b[u] * c[v]), minus = a[k] * (b[v] * c[u]);
        sum += plus - minus;
        size += fabs(plus) + fabs(minus);
    }
    double bound = 1e-14 * size + 1e-200;
    return (sum > bound) - (sum < -bound);
}

static void minus(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static int certain_side(const double *const t[3], const double p[3]) {
    double a[3], b[3], c[3];
    minus(t[0], p, a);
    minus(t[1], p, b);
    minus(t[2], p, c);
    return certain_sign(a, b, c);
}

/* Are all points of the segment on one side of the triangle's box? */
static bool boxes_apart(const double p[3], const double q[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        double low = fmin(p[k], q[k]), high = fmax(p[k], q[k]);
        if ((t[0][k] < low && t[1][k] < low && t[2][k] < low) ||
            (t[0][k] > high && t[1][k] > high && t[2][k] > high))
            return true;
    }
    return false;
}

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool blocks(const double p[3], const double q[3], const double *const t[3]) {
    if (boxes_apart(p, q, t))
        return false;
    int side_p = certain_side(t, p);
    if (side_p != 0 && (same(q, t[0]) || same(q, t[1]) || same(q, t[2])))
        return false; /* the segment leaves the plane at q */
    int side_q = certain_side(t, q);
    if (side_p != 0 && side_p == side_q)
        return false;
    double d[3], corner[3][3];
    minus(q, p, d);
    int plus = 0, less = 0;
    for (int i = 0; i < 3; i++)
        minus(t[i], p, corner[i]);
    for (int i = 0; i < 3; i++) {
        int sign = certain_sign(d, corner[i], corner[(i + 1) % 3]);
        plus += sign > 0;
        less += sign < 0;
    }
    if (plus != 0 && less != 0)
        return false; /* the line misses the triangle */
    if ((plus == 3 || less == 3) && side_p != 0 && side_p == -side_q)
        return true;
    return oracle_segment_meets_triangle(p, q, t[0], t[1], t[2]);
}

/* ---- meshes ---- */

typedef struct scene {
    const double *vertices;
    const uint32_t *faces;
    size_t face_count;
} scene;

static void corners(const scene *s, size_t f, const double *t[3]) {
    for (int i = 0; i < 3; i++)
        t[i] = s->vertices + 3 * (size_t)s->faces[3 * f + (size_t)i];
}

static bool is_inside(const scene *s, const double p[3]) {
    bool on_surface;
    int winding = oracle_winding(s->vertices, s->faces, s->face_count, p, &on_surface);
    return !on_surface && winding >= 1;
}

static bool sees_point(const scene *s, const double p[3], const double q[3]) {
    for (size_t f = 0; f < s->face_count; f++) {
        const double *t[3];
        corners(s, f, t);
        if (blocks(p, q, t))
            return false;
    }
    return true;
}

/* May t have a point in the tetrahedron (p, face)? False only if certain. */
static bool may_enter(const double p[3], const double *const face[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        double low = fmin(fmin(p[k], face[0][k]), fmin(face[1][k], face[2][k]));
        double high = fmax(fmax(p[k], face[0][k]), fmax(face[1][k], face[2][k]));
        if ((t[0][k] < low && t[1][k] < low && t[2][k] < low) ||
            (t[0][k] > high && t[1][k] > high && t[2][k] > high))
            return false;
    }
    for (int i = 0; i < 3; i++) { /* outside one of the three planes through p */
        const double *plane[3] = {p, face[(i + 1) % 3], face[i]};
        if (certain_side(plane, t[0]) < 0 && certain_side(plane, t[1]) < 0 &&
            certain_side(plane, t[2]) < 0)
            return false;
    }
    return certain_side(face, t[0]) >= 0 || certain_side(face, t[1]) >= 0 ||
           certain_side(face, t[2]) >= 0;
}

static bool sees_whole(const scene *s, const double p[3], size_t face) {
    const double *f[3];
    corners(s, face, f);
    for (size_t g = 0; g < s->face_count; g++) {
        const double *t[3];
        corners(s, g, t);
        if (g != face && may_enter(p, f, t) && oracle_tetrahedron_meets_triangle(p, f, t))
            return false;
    }
    return true;
}

void visibility_oracle_vertices(const double *vertices, size_t vertex_count, const uint32_t *faces,
                                size_t face_count, const double p[3], bool *visible) {
    scene s = {vertices, faces, face_count};
    bool inside = is_inside(&s, p);
    for (size_t v = 0; v < vertex_count; v++)
        visible[v] = inside && sees_point(&s, p, vertices + 3 * v);
}

void visibility_oracle_faces_from(const double *vertices, const uint32_t *faces, size_t face_count,
                                  const double p[3], bool whole, const bool *vertex,
                                  bool *visible) {
    scene s = {vertices, faces, face_count};
    for (size_t f = 0; f < face_count; f++) {
        const uint32_t *v = faces + 3 * f;
        const double *t[3];
        corners(&s, f, t);
        visible[f] = vertex[v[0]] && vertex[v[1]] && vertex[v[2]] &&
                     oracle_orient3d(t[0], t[1], t[2], p) > 0 && (!whole || sees_whole(&s, p, f));
    }
}

void visibility_oracle_faces(const double *vertices, size_t vertex_count, const uint32_t *faces,
                             size_t face_count, const double p[3], bool whole, bool *visible) {
    bool *vertex = malloc(vertex_count + 1);
    if (vertex == NULL)
        abort();
    visibility_oracle_vertices(vertices, vertex_count, faces, face_count, p, vertex);
    visibility_oracle_faces_from(vertices, faces, face_count, p, whole, vertex, visible);
    free(vertex);
}
