/* SPDX-License-Identifier: Apache-2.0 */
#include "decomposition_oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "support.h"

/* Outward faces of a positive tetrahedron, derived independently: face k omits vertex k and has it
 * on its inner side. */
static void face_of(const starg_tetmesh *mesh, size_t t, size_t k, uint32_t out[3]) {
    const uint32_t *v = starg_tetmesh_tetrahedra(mesh) + 4 * t;
    const double *p = starg_tetmesh_vertices(mesh);
    size_t n = 0;
    for (size_t i = 0; i < 4; i++)
        if (i != k)
            out[n++] = v[i];
    if (oracle_orient3d(p + 3 * out[0], p + 3 * out[1], p + 3 * out[2], p + 3 * v[k]) < 0) {
        uint32_t swap = out[1];
        out[1] = out[2];
        out[2] = swap;
    }
}

static bool is_outer(const starg_decomposition *d, size_t face) {
    uint32_t next = starg_tetmesh_neighbours(d->mesh)[face];
    return next == STARG_TETMESH_NONE || d->labels[next] != d->labels[face / 4];
}

static bool close_to(double a, double b, double scale) {
    return fabs(a - b) <= 1e-9 * scale;
}

/* ---- star-shaped pieces ---- */

/* Are the tetrahedra of a piece connected by faces? */
static bool is_connected(const starg_decomposition *d, int32_t piece) {
    size_t n = starg_tetmesh_count(d->mesh), reached = 0, top = 0, size = 0;
    const uint32_t *next = starg_tetmesh_neighbours(d->mesh);
    size_t *stack = malloc((n + 1) * sizeof *stack);
    bool *seen = calloc(n + 1, sizeof *seen);
    assert_non_null(stack);
    assert_non_null(seen);
    for (size_t t = 0; t < n; t++) {
        size += d->labels[t] == piece;
        if (d->labels[t] == piece && top == 0) {
            stack[top++] = t;
            seen[t] = true;
        }
    }
    while (top > 0) {
        size_t t = stack[--top];
        reached++;
        for (size_t k = 0; k < 4; k++) {
            uint32_t u = next[4 * t + k];
            if (u == STARG_TETMESH_NONE || seen[u] || d->labels[u] != piece)
                continue;
            seen[u] = true;
            stack[top++] = u;
        }
    }
    free(stack);
    free(seen);
    return reached == size;
}

/* Is the guard in a tetrahedron of its piece, strictly inside the piece's outer faces? */
static bool is_star(const starg_decomposition *d, int32_t piece) {
    const double *p = starg_tetmesh_vertices(d->mesh), *g = d->pieces[piece].guard;
    bool held = false;
    for (size_t t = 0; t < starg_tetmesh_count(d->mesh); t++) {
        if (d->labels[t] != piece)
            continue;
        int inner = 0;
        for (size_t k = 0; k < 4; k++) {
            uint32_t f[3];
            face_of(d->mesh, t, k, f);
            int side = oracle_orient3d(p + 3 * f[0], p + 3 * f[1], p + 3 * f[2], g);
            inner += side >= 0;
            if (side <= 0 && is_outer(d, 4 * t + k))
                return false;
        }
        held = held || inner == 4;
    }
    return held && is_connected(d, piece);
}

/* ---- measures ---- */

static void difference(const double *a, const double *b, long double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (long double)a[k] - (long double)b[k];
}

static void cross(const long double u[3], const long double v[3], long double out[3]) {
    for (int k = 0; k < 3; k++) {
        int y = (k + 1) % 3, z = (k + 2) % 3;
        out[k] = u[y] * v[z] - u[z] * v[y];
    }
}

static long double dot(const long double u[3], const long double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static double volume_of(const starg_tetmesh *mesh, size_t t) {
    const uint32_t *v = starg_tetmesh_tetrahedra(mesh) + 4 * t;
    const double *p = starg_tetmesh_vertices(mesh);
    long double e[3][3], n[3];
    for (int k = 0; k < 3; k++)
        difference(p + 3 * v[k + 1], p + 3 * v[0], e[k]);
    cross(e[0], e[1], n);
    return (double)(dot(n, e[2]) / 6);
}

static long double extent_of(const starg_tetmesh *mesh) {
    const double *p = starg_tetmesh_vertices(mesh);
    long double extent = 0;
    for (size_t i = 0; i < 3 * starg_tetmesh_vertex_count(mesh); i++)
        extent = fmaxl(extent, fabsl((long double)p[i] - (long double)p[i % 3]));
    return extent;
}

static double radius_of(const starg_decomposition *d, int32_t piece) {
    const double *p = starg_tetmesh_vertices(d->mesh);
    long double least = INFINITY;
    for (size_t f = 0; f < 4 * starg_tetmesh_count(d->mesh); f++) {
        if (d->labels[f / 4] != piece || !is_outer(d, f))
            continue;
        uint32_t c[3];
        long double u[3], v[3], n[3], to_face[3];
        face_of(d->mesh, f / 4, f % 4, c);
        difference(p + 3 * c[1], p + 3 * c[0], u);
        difference(p + 3 * c[2], p + 3 * c[0], v);
        cross(u, v, n);
        difference(p + 3 * c[0], d->pieces[piece].guard, to_face);
        least = fminl(least, dot(n, to_face) / sqrtl(dot(n, n)));
    }
    return (double)least;
}

static double area_of(const starg_tetmesh *mesh, size_t face) {
    uint32_t c[3];
    long double u[3], v[3], n[3];
    const double *p = starg_tetmesh_vertices(mesh);
    face_of(mesh, face / 4, face % 4, c);
    difference(p + 3 * c[1], p + 3 * c[0], u);
    difference(p + 3 * c[2], p + 3 * c[0], v);
    cross(u, v, n);
    return (double)(sqrtl(dot(n, n)) / 2);
}

/* Of the bounding box of a piece. */
static double diagonal_of(const starg_decomposition *d, int32_t piece) {
    long double squared = 0;
    for (int k = 0; k < 3; k++) {
        double lower = INFINITY, upper = -INFINITY;
        for (size_t i = 0; i < 4 * starg_tetmesh_count(d->mesh); i++) {
            uint32_t v = starg_tetmesh_tetrahedra(d->mesh)[i];
            double x = starg_tetmesh_vertices(d->mesh)[3 * (size_t)v + (size_t)k];
            lower = d->labels[i / 4] == piece ? fmin(lower, x) : lower;
            upper = d->labels[i / 4] == piece ? fmax(upper, x) : upper;
        }
        squared += ((long double)upper - lower) * ((long double)upper - lower);
    }
    return (double)sqrtl(squared);
}

/* The smallest dihedral angle of a tetrahedron in degrees: heights by distances of a corner from
 * edges. */
static double dihedral_of(const starg_tetmesh *mesh, size_t t) {
    const uint32_t *v = starg_tetmesh_tetrahedra(mesh) + 4 * t;
    const double *p = starg_tetmesh_vertices(mesh);
    long double least = 180;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            long double e[3], u[3], w[3], n[3], m[3];
            int c = 0;
            if (i == j)
                continue;
            while (c == i || c == j)
                c++;
            difference(p + 3 * v[j], p + 3 * v[i], e);
            difference(p + 3 * v[c], p + 3 * v[i], u);
            difference(p + 3 * v[6 - i - j - c], p + 3 * v[i], w);
            cross(e, u, n);
            cross(e, w, m);
            long double sine = fabsl(dot(n, w)) * sqrtl(dot(e, e));
            least = fminl(least, atan2l(sine, dot(n, m)) * 180 / acosl(-1));
        }
    return (double)least;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check_angles(const starg_decomposition *d) {
    size_t n = starg_tetmesh_count(d->mesh);
    double *angles = malloc(n * sizeof *angles);
    assert_non_null(angles);
    for (size_t t = 0; t < n; t++)
        angles[t] = dihedral_of(d->mesh, t);
    qsort(angles, n, sizeof *angles, ascending);
    assert_true(fabs(d->smallest_angle - angles[0]) <= 1e-6 * angles[0] + 1e-9);
    assert_true(fabs(d->median_angle - angles[n / 2]) <= 1e-6 * angles[n / 2] + 1e-9);
    assert_true(d->smallest_angle_made < 0 || d->smallest_angle_made >= d->smallest_angle);
    free(angles);
}

static void check_pieces(const starg_decomposition *d) {
    size_t stars = 0, n = starg_tetmesh_count(d->mesh);
    double extent = (double)extent_of(d->mesh), all = 0;
    for (size_t i = 0; i < d->piece_count; i++) {
        const starg_piece *piece = &d->pieces[i];
        size_t count = 0;
        double volume = 0;
        for (size_t t = 0; t < n; t++)
            if (d->labels[t] == (int32_t)i) {
                count++;
                volume += volume_of(d->mesh, t);
            }
        all += piece->volume;
        assert_int_equal(piece->tetrahedra, count);
        assert_true(count > 0);
        assert_true(close_to(piece->volume, volume, extent * extent * extent));
        assert_true(close_to(piece->radius, radius_of(d, (int32_t)i), extent));
        assert_true(fabs(piece->margin * diagonal_of(d, (int32_t)i) - piece->radius) <=
                    1e-12 * extent);
        assert_int_equal(piece->star, is_star(d, (int32_t)i));
        stars += piece->star;
    }
    assert_int_equal(d->strictly_star, stars);
    assert_true(close_to(all, starg_tetmesh_volume(d->mesh), extent * extent * extent));
}

static void check_contacts(const starg_decomposition *d) {
    double *areas = calloc(d->piece_count * d->piece_count + 1, sizeof *areas);
    const uint32_t *next = starg_tetmesh_neighbours(d->mesh);
    double extent = (double)extent_of(d->mesh);
    size_t pairs = 0;
    assert_non_null(areas);
    for (size_t f = 0; f < 4 * starg_tetmesh_count(d->mesh); f++)
        if (next[f] != STARG_TETMESH_NONE && d->labels[f / 4] < d->labels[next[f]])
            areas[(size_t)d->labels[f / 4] * d->piece_count + (size_t)d->labels[next[f]]] +=
                area_of(d->mesh, f);
    for (size_t i = 0; i < d->piece_count * d->piece_count; i++)
        pairs += areas[i] > 0;
    assert_int_equal(d->contact_count, pairs);
    for (size_t i = 0; i < d->contact_count; i++) {
        const starg_piece_contact *c = &d->contacts[i];
        assert_true(c->first < c->second && c->second < d->piece_count);
        assert_true(i == 0 || c[-1].first < c->first ||
                    (c[-1].first == c->first && c[-1].second < c->second));
        assert_true(
            close_to(c->area, areas[c->first * d->piece_count + c->second], extent * extent));
        assert_true(c->area > 0);
    }
    free(areas);
}

void decomposition_oracle_check(const starg_decomposition *d) {
    assert_true(d->piece_count > 0);
    for (size_t t = 0; t < starg_tetmesh_count(d->mesh); t++)
        assert_true(d->labels[t] >= 0 && (size_t)d->labels[t] < d->piece_count);
    check_pieces(d);
    check_angles(d);
    check_contacts(d);
}

void decomposition_oracle_check_connected(const starg_decomposition *d) {
    for (size_t i = 0; i < d->piece_count; i++)
        assert_true(is_connected(d, (int32_t)i));
}

/* ---- sight ---- */

static size_t collect_outer(const starg_tetmesh *mesh, uint32_t *faces) {
    size_t count = 0;
    for (size_t f = 0; f < 4 * starg_tetmesh_count(mesh); f++)
        if (starg_tetmesh_neighbours(mesh)[f] == STARG_TETMESH_NONE)
            face_of(mesh, f / 4, f % 4, faces + 3 * count++);
    return count;
}

static bool sees(const double *p, const uint32_t *faces, size_t count, const double *g,
                 uint32_t vertex) {
    for (size_t f = 0; f < count; f++)
        if (oracle_segment_meets_triangle(g, p + 3 * vertex, p + 3 * faces[3 * f],
                                          p + 3 * faces[3 * f + 1], p + 3 * faces[3 * f + 2]))
            return false;
    return true;
}

static bool has_vertex(const starg_decomposition *d, int32_t piece, uint32_t vertex) {
    for (size_t i = 0; i < 4 * starg_tetmesh_count(d->mesh); i++)
        if (d->labels[i / 4] == piece && starg_tetmesh_tetrahedra(d->mesh)[i] == vertex)
            return true;
    return false;
}

void decomposition_oracle_check_sight(const starg_decomposition *d) {
    const double *p = starg_tetmesh_vertices(d->mesh);
    uint32_t *faces = malloc(12 * starg_tetmesh_count(d->mesh) * sizeof *faces + 1);
    assert_non_null(faces);
    size_t count = collect_outer(d->mesh, faces), total = 0, seen = 0;
    for (int32_t i = 0; i < (int32_t)d->piece_count; i++) {
        const double *g = d->pieces[i].guard;
        bool on_surface, inside = oracle_winding(p, faces, count, g, &on_surface) > 0;
        for (uint32_t v = 0; v < starg_tetmesh_vertex_count(d->mesh); v++) {
            if (!has_vertex(d, i, v))
                continue;
            total++;
            seen += inside && !on_surface && sees(p, faces, count, g, v);
        }
    }
    assert_true(d->visible_vertices == (double)seen / (double)total);
    free(faces);
}
