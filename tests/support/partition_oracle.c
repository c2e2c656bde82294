/* SPDX-License-Identifier: Apache-2.0 */
#include "partition_oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "geometry/delaunay.h"
#include "star/certified/region_growing.h"
#include "star/certified/search.h"
#include "support.h"
#include "tetrahedra.h"

/* ---- facets ---- */

/* Corners of a facet as seen from outside the piece on a side. */
static void outward(const facet *f, int side, uint32_t out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = f->corners[side == FACET_INNER ? k : 2 - k];
}

static long double triple(const double *a, const double *b, const double *c) {
    return a[0] * ((long double)b[1] * c[2] - (long double)b[2] * c[1]) +
           a[1] * ((long double)b[2] * c[0] - (long double)b[0] * c[2]) +
           a[2] * ((long double)b[0] * c[1] - (long double)b[1] * c[0]);
}

double partition_oracle_volume(const partition *p, uint32_t number) {
    long double sum = 0;
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        const facet *f = &p->facets.data[i / 2];
        uint32_t k[3];
        if (f->side[i % 2] != number)
            continue;
        outward(f, (int)(i % 2), k);
        sum +=
            triple(partition_unit(p, k[0]), partition_unit(p, k[1]), partition_unit(p, k[2])) / 6;
    }
    return (double)sum;
}

/* Solid angle of a triangle, signed [Van Oosterom and Strackee 1983]. */
static double solid_angle(const double *a, const double *b, const double *c, const double o[3]) {
    double e[3][3], length[3], dot[3];
    const double *corner[3] = {a, b, c};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            e[i][k] = corner[i][k] - o[k];
        length[i] = sqrt(e[i][0] * e[i][0] + e[i][1] * e[i][1] + e[i][2] * e[i][2]);
    }
    for (int i = 0; i < 3; i++)
        dot[i] =
            e[i][0] * e[(i + 1) % 3][0] + e[i][1] * e[(i + 1) % 3][1] + e[i][2] * e[(i + 1) % 3][2];
    double below = length[0] * length[1] * length[2] + dot[0] * length[2] + dot[1] * length[0] +
                   dot[2] * length[1];
    return 2 * atan2((double)triple(e[0], e[1], e[2]), below);
}

static int winding(const partition *p, uint32_t number, const double point[3]) {
    double sum = 0;
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        const facet *f = &p->facets.data[i / 2];
        uint32_t k[3];
        if (f->side[i % 2] != number)
            continue;
        outward(f, (int)(i % 2), k);
        sum += solid_angle(partition_unit(p, k[0]), partition_unit(p, k[1]),
                           partition_unit(p, k[2]), point);
    }
    double turns = sum / (4 * acos(-1));
    assert_true(fabs(turns - round(turns)) < 1e-6);
    return (int)round(turns);
}

uint32_t partition_oracle_locate(const partition *p, const double point[3]) {
    uint32_t found = PARTITION_OUTSIDE;
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        int turns = winding(p, i, point);
        assert_in_range(turns, 0, 1);
        if (turns == 0)
            continue;
        assert_int_equal(found, PARTITION_OUTSIDE); /* pieces do not overlap */
        found = i;
    }
    return found;
}

/* ---- invariants ---- */

typedef struct directed {
    uint32_t owner, low, high;
    int sign;
} directed;

static int by_edge(const void *x, const void *y) {
    return memcmp(x, y, 3 * sizeof(uint32_t));
}

static void check_closed(const partition *p) {
    size_t count = 0;
    directed *edges = malloc((6 * p->facets.count + 1) * sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        const facet *f = &p->facets.data[i / 2];
        uint32_t k[3];
        outward(f, (int)(i % 2), k);
        for (int e = 0; f->side[i % 2] != PARTITION_OUTSIDE && e < 3; e++) {
            uint32_t a = k[e], b = k[(e + 1) % 3];
            edges[count++] =
                (directed){f->side[i % 2], a < b ? a : b, a < b ? b : a, a < b ? 1 : -1};
        }
    }
    qsort(edges, count, sizeof *edges, by_edge);
    int balance = 0;
    for (size_t i = 0; i < count; i++) {
        balance += edges[i].sign;
        if (i + 1 == count || by_edge(&edges[i], &edges[i + 1]) != 0) {
            assert_int_equal(balance, 0);
            balance = 0;
        }
    }
    free(edges);
}

static void check_index(const partition *p) {
    assert_int_equal(p->start.count, p->pieces.count + 1);
    size_t *next = calloc(p->pieces.count + 1, sizeof *next);
    assert_non_null(next);
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        uint32_t owner = p->facets.data[i / 2].side[i % 2];
        if (owner != PARTITION_OUTSIDE)
            assert_int_equal(p->index.data[p->start.data[owner] + next[owner]++], i);
    }
    for (size_t i = 0; i < p->pieces.count; i++) {
        assert_true(next[i] >= 4); /* every number is in use, by at least a tetrahedron's facets */
        assert_int_equal(p->start.data[i] + next[i], p->start.data[i + 1]);
    }
    assert_int_equal(p->start.data[0], 0);
    assert_int_equal(p->start.data[p->pieces.count], p->index.count);
    free(next);
}

void partition_oracle_check(const partition *p) {
    size_t points = p->points.count / 3;
    assert_int_equal(p->points.count, p->unit.count);
    for (size_t i = 0; i < p->points.count; i++)
        assert_true(p->unit.data[i] ==
                    (p->points.data[i] - p->origin[i % 3]) / ldexp(1, p->exponents[i % 3]));
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        for (int k = 0; k < 3; k++) {
            assert_true(f->corners[k] < points);
            assert_int_not_equal(f->corners[k], f->corners[(k + 1) % 3]);
        }
        assert_true(f->side[FACET_INNER] < p->pieces.count);
        assert_true(f->side[FACET_OUTER] < p->pieces.count ||
                    f->side[FACET_OUTER] == PARTITION_OUTSIDE);
        assert_int_not_equal(f->side[0], f->side[1]);
        assert_true(f->plane < p->planes.count);
        const partition_plane *plane = &p->planes.data[f->plane];
        for (int k = 0; k < 3; k++) {
            const double *q = partition_unit(p, f->corners[k]);
            double height = plane->normal[0] * q[0] + plane->normal[1] * q[1] +
                            plane->normal[2] * q[2] - plane->offset;
            assert_true(fabs(height) < 1e-12);
        }
    }
    check_closed(p);
    check_index(p);
}

static void check_guard(const partition *p, uint32_t number) {
    const piece *own = &p->pieces.data[number];
    double unit[3], room = INFINITY;
    for (int k = 0; k < 3; k++)
        unit[k] = (own->guard[k] - p->origin[k]) / ldexp(1, p->exponents[k]);
    for (uint32_t i = p->start.data[number]; i < p->start.data[number + 1]; i++) {
        const facet *f = &p->facets.data[p->index.data[i] / 2];
        int side = (int)(p->index.data[i] % 2);
        const partition_plane *plane = &p->planes.data[f->plane];
        uint32_t k[3];
        outward(f, side, k);
        assert_int_equal(oracle_orient3d(partition_point(p, k[0]), partition_point(p, k[1]),
                                         partition_point(p, k[2]), own->guard),
                         1);
        double height = plane->offset - plane->normal[0] * unit[0] - plane->normal[1] * unit[1] -
                        plane->normal[2] * unit[2];
        room = fmin(room, side == FACET_INNER ? height : -height);
    }
    assert_int_equal(winding(p, number, unit), 1);
    assert_true(own->radius <= room + 1e-9);
    assert_true(fabs(own->volume - partition_oracle_volume(p, number)) < 1e-12);
}

void partition_oracle_check_guards(const partition *p) {
    partition_oracle_check(p);
    for (uint32_t i = 0; i < p->pieces.count; i++)
        check_guard(p, i);
}

/* ---- the surface ---- */

static void area_vector(const partition *p, const facet *f, long double out[3]) {
    const double *a = partition_unit(p, f->corners[0]), *b = partition_unit(p, f->corners[1]),
                 *c = partition_unit(p, f->corners[2]);
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        out[k] = (((long double)b[u] - a[u]) * ((long double)c[v] - a[v]) -
                  ((long double)b[v] - a[v]) * ((long double)c[u] - a[u])) /
                 2;
    }
}

static long double area_of(const partition *p, const facet *f) {
    long double n[3];
    area_vector(p, f, n);
    return sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Is q in the triangle of a facet, by the areas of q with its edges? */
static bool is_on(const partition *p, const facet *f, const double q[3]) {
    long double sum = 0, whole = area_of(p, f);
    for (int k = 0; k < 3; k++) {
        const double *a = partition_unit(p, f->corners[k]);
        const double *b = partition_unit(p, f->corners[(k + 1) % 3]);
        long double n[3];
        for (int i = 0; i < 3; i++) {
            int u = (i + 1) % 3, v = (i + 2) % 3;
            n[i] = (((long double)b[u] - a[u]) * ((long double)q[v] - a[v]) -
                    ((long double)b[v] - a[v]) * ((long double)q[u] - a[u])) /
                   2;
        }
        sum += sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum <= whole + 1e-13L;
}

void partition_oracle_check_surface(const partition *first, const partition *p) {
    const facet **at = calloc(p->planes.count, sizeof *at);
    long double *area = calloc(p->planes.count, sizeof *area);
    assert_non_null(at);
    assert_non_null(area);
    for (size_t i = 0; i < first->facets.count; i++)
        if (first->facets.data[i].side[FACET_OUTER] == PARTITION_OUTSIDE) {
            assert_null(at[first->facets.data[i].plane]);
            at[first->facets.data[i].plane] = &first->facets.data[i];
        }
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        long double n[3], m[3];
        if (f->side[FACET_OUTER] != PARTITION_OUTSIDE)
            continue;
        assert_non_null(at[f->plane]);
        for (int k = 0; k < 3; k++)
            assert_true(is_on(first, at[f->plane], partition_unit(p, f->corners[k])));
        area_vector(p, f, n);
        area_vector(first, at[f->plane], m);
        long double same = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
        area[f->plane] += same > 0 ? area_of(p, f) : -area_of(p, f);
    }
    for (size_t i = 0; i < p->planes.count; i++)
        if (at[i] != NULL)
            assert_true(fabsl(area[i] - area_of(first, at[i])) < 1e-13L);
    free(at);
    free(area);
}

/* ---- copies ---- */

#define SAME(A, B)                                                                                 \
    ((A).count == (B).count && memcmp((A).data, (B).data, (A).count * sizeof *(A).data) == 0)

bool partition_oracle_same(const partition *a, const partition *b) {
    return SAME(a->points, b->points) && SAME(a->unit, b->unit) && SAME(a->planes, b->planes) &&
           SAME(a->facets, b->facets) && SAME(a->pieces, b->pieces) && SAME(a->start, b->start) &&
           SAME(a->index, b->index) && a->first_points == b->first_points &&
           a->stamps == b->stamps && memcmp(a->exponents, b->exponents, sizeof a->exponents) == 0 &&
           memcmp(a->origin, b->origin, sizeof a->origin) == 0;
}

partition partition_oracle_copy(const partition *from) {
    partition to;
    test_ok(from->context, partition_copy(from, &to));
    test_ok(from->context, partition_build_index(&to));
    return to;
}

/* ---- partitions ---- */

partition random_hull(starg_context *context, uint64_t seed, size_t points) {
    starg_rng rng = starg_rng_make(seed, 71, 0);
    double *coordinates = malloc(3 * points * sizeof *coordinates), guard[3] = {0};
    delaunay *d = NULL;
    starg_tetmesh *mesh = NULL;
    partition p;
    assert_non_null(coordinates);
    for (size_t i = 0; i < 3 * points; i++) {
        coordinates[i] = 3 * starg_rng_unit(&rng) - 1;
        guard[i % 3] += coordinates[i] / (double)points;
    }
    test_ok(context, delaunay_create(context, coordinates, points, &d));
    test_ok(context, starg_tetmesh_create(context, coordinates, points, d->tetrahedra[0], d->count,
                                          NULL, &mesh));
    uint32_t *labels = calloc(d->count, sizeof *labels);
    assert_non_null(labels);
    test_ok(context, partition_create(context, mesh, labels, guard, 1, &p));
    free(labels);
    free(coordinates);
    starg_tetmesh_free(mesh);
    delaunay_free(d);
    return p;
}

partition grown_sample(starg_context *context, const char *name, size_t target) {
    starg_tetmesh *mesh = sample_tetmesh(context, name, target);
    grown_regions grown;
    partition p;
    test_ok(context, grow_regions(context, mesh, NULL, 0, &grown));
    test_ok(context,
            partition_create(context, mesh, grown.labels, grown.guards.data, grown.count, &p));
    grown_regions_free(&grown);
    starg_tetmesh_free(mesh);
    return p;
}

partition random_cells(starg_context *context, uint64_t seed, size_t points) {
    starg_tetmesh *mesh = random_tetmesh(context, seed, points, false, 1);
    uint32_t *labels = calloc(mesh->count, sizeof *labels);
    double *guards = calloc(3 * mesh->count, sizeof *guards);
    partition p;
    assert_non_null(labels);
    assert_non_null(guards);
    for (size_t t = 0; t < mesh->count; t++) {
        labels[t] = (uint32_t)t;
        for (size_t i = 0; i < 12; i++)
            guards[3 * t + i % 3] += tetmesh_corner(mesh, t, (int)(i / 3))[i % 3] / 4;
    }
    test_ok(context, partition_create(context, mesh, labels, guards, mesh->count, &p));
    free(labels);
    free(guards);
    starg_tetmesh_free(mesh);
    return p;
}

static double height_along(const double normal[3], const double q[3]) {
    return normal[0] * q[0] + normal[1] * q[1] + normal[2] * q[2];
}

partition_plane random_plane_across(const partition *p, uint32_t number, starg_rng *rng) {
    partition_plane plane;
    double length = 0, low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 3; k++) {
        plane.normal[k] = 2 * starg_rng_unit(rng) - 1;
        length += plane.normal[k] * plane.normal[k];
    }
    for (int k = 0; k < 3; k++)
        plane.normal[k] /= sqrt(length);
    for (uint32_t i = p->start.data[number]; i < p->start.data[number + 1]; i++)
        for (int k = 0; k < 3; k++) {
            const facet *f = &p->facets.data[p->index.data[i] / 2];
            double height = height_along(plane.normal, partition_unit(p, f->corners[k]));
            low = fmin(low, height);
            high = fmax(high, height);
        }
    plane.offset = low + (0.05 + 0.9 * starg_rng_unit(rng)) * (high - low);
    return plane;
}
