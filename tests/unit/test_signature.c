/* SPDX-License-Identifier: Apache-2.0 */
/* Signatures against closed forms, and under motions that must not change them. */
#include "starguard/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversarial.h"
#include "core/rng.h"
#include "models.h"
#include "shape/signature_kinds.h"
#include "shape/spectrum.h"

enum { BINS = 64 };
static const double PI = 3.14159265358979323846;

static starg_signature *describe(starg_context *context, const starg_mesh *mesh,
                                 starg_signature_kind kind) {
    starg_signature *signature = NULL;
    test_ok(context, starg_signature_create(context, mesh, kind, &signature));
    assert_int_equal(signature->kind, kind);
    assert_int_equal(signature->version, starg_signature_version(kind));
    return signature;
}

static double distance(starg_context *context, const starg_signature *a, const starg_signature *b) {
    double forth, back;
    test_ok(context, starg_signature_distance(context, a, b, &forth));
    test_ok(context, starg_signature_distance(context, b, a, &back));
    assert_true(forth == back);
    return forth;
}

/* ---- D2 ---- */

static double sum_of(const double *numbers, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += numbers[i];
    return sum;
}

/* Two points of the unit sphere are closer than d with probability d^2 / 4; on average 4 / 3
 * apart. */
static void d2_of_a_sphere(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 8000);
    starg_signature *s = describe(context, mesh, STARG_SIGNATURE_D2);
    assert_int_equal(s->count, BINS);
    assert_true(fabs(sum_of(s->numbers, s->count) - 1) < 1e-9);
    /* opposite points are at the limit of two bins, and the mesh is not exactly a sphere */
    assert_true(s->numbers[32] < 0.002);
    s->numbers[31] += s->numbers[32];
    s->numbers[32] = 0;
    for (size_t i = 0; i < BINS; i++) {
        double low = fmin(2, 4.0 / 3 * 3 * (double)i / BINS);
        double high = fmin(2, 4.0 / 3 * 3 * (double)(i + 1) / BINS);
        double expected = (high * high - low * low) / 4;
        assert_true(fabs(s->numbers[i] - expected) < 5 * sqrt(expected / (1 << 20)) + 5e-4);
    }
    starg_signature_free(context, s);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Points of the surface of a unit cube: their mean squared distance is 5 / 6; their mean distance
 * is 0.5214054331 on the same face, 0.9263900552 on different ones. */
static void d2_of_a_cube(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(1);
    starg_mesh *mesh = test_mesh_of(context, &cube);
    starg_signature *s = describe(context, mesh, STARG_SIGNATURE_D2);
    const double average = 0.5214054331 / 6 + 0.9263900552 * 5 / 6;
    double width = 3.0 / BINS, mean = 0, square = 0;
    for (size_t i = 0; i < BINS; i++) {
        double middle = ((double)i + 0.5) * width;
        mean += s->numbers[i] * middle;
        square += s->numbers[i] * (middle * middle + width * width / 12);
    }
    assert_true(fabs(mean - 1) < 2e-3);
    assert_true(fabs(square - 5.0 / 6 / (average * average)) < 2e-3);
    /* the farthest points are sqrt(3) apart */
    for (size_t i = 0; i < BINS; i++)
        if ((double)i * width > sqrt(3) / average + 0.01)
            assert_true(s->numbers[i] == 0);
    starg_signature_free(context, s);
    starg_mesh_free(mesh);
    shape_free(&cube);
    test_context_free(context);
}

/* ---- Laplacian ---- */

/* A sheet of width x height squares of side 1, two triangles each. */
static starg_mesh *sheet(starg_context *context, uint32_t width, uint32_t height) {
    shape s = {.vertex_count = (size_t)(width + 1) * (height + 1),
               .face_count = 2 * (size_t)width * height};
    s.vertices = calloc(3 * s.vertex_count, sizeof *s.vertices);
    s.faces = calloc(3 * s.face_count, sizeof *s.faces);
    assert_true(s.vertices != NULL && s.faces != NULL);
    for (uint32_t y = 0; y <= height; y++)
        for (uint32_t x = 0; x <= width; x++) {
            s.vertices[3 * (y * (width + 1) + x)] = x;
            s.vertices[3 * (y * (width + 1) + x) + 1] = y;
        }
    uint32_t *f = s.faces;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++, f += 6) {
            uint32_t a = y * (width + 1) + x, c = a + width + 1;
            const uint32_t two[6] = {a, a + 1, c + 1, a, c + 1, c};
            memcpy(f, two, sizeof two);
        }
    starg_mesh *mesh = test_mesh_of(context, &s);
    shape_free(&s);
    return mesh;
}

static double entry(const laplacian *l, int64_t row, int64_t column) {
    for (int64_t i = l->starts[column]; i < l->starts[column + 1]; i++)
        if (l->rows[i] == row)
            return l->values[i];
    return 0;
}

/* x' L x for a coordinate of the vertices is the integral of its squared gradient, which on a
 * triangle is 1 minus that coordinate of the normal, squared. */
static void laplacian_energy(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "horse", 3000);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    laplacian l;
    test_ok(context, laplacian_create(context, mesh, &l));
    assert_int_equal(l.count, starg_mesh_vertex_count(mesh));
    assert_true(fabs(sum_of(l.masses, l.count) - 1) < 1e-12);
    for (size_t axis = 0; axis < 3; axis++) {
        double energy = 0, expected = 0;
        for (size_t c = 0; c < l.count; c++)
            for (int64_t i = l.starts[c]; i < l.starts[c + 1]; i++)
                energy += l.values[i] * v[3 * (size_t)l.rows[i] + axis] * v[3 * c + axis];
        for (size_t i = 0; i < starg_mesh_face_count(mesh); i++) {
            double e[2][3], n[3], square = 0;
            for (size_t k = 0; k < 3; k++) {
                e[0][k] = v[3 * f[3 * i + 1] + k] - v[3 * f[3 * i] + k];
                e[1][k] = v[3 * f[3 * i + 2] + k] - v[3 * f[3 * i] + k];
            }
            for (size_t k = 0; k < 3; k++) {
                n[k] =
                    e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
                square += n[k] * n[k];
            }
            expected += 0.5 * sqrt(square) * (1 - n[axis] * n[axis] / square);
        }
        assert_true(fabs(energy - expected) < 1e-9 * expected);
    }
    for (size_t c = 0; c < l.count; c++) {
        double sum = 0, size = 0;
        for (int64_t i = l.starts[c]; i < l.starts[c + 1]; i++) {
            sum += l.values[i];
            size += fabs(l.values[i]);
            assert_true(l.values[i] == entry(&l, (int64_t)c, l.rows[i]));
        }
        assert_true(fabs(sum) <= 1e-12 * size);
    }
    laplacian_free(&l);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* ---- spectrum ---- */

/* All eigenvalues of a dense symmetric matrix by Jacobi's rotations, ascending. */
static void jacobi(double *a, size_t n, double *out) {
    for (int sweep = 0; sweep < 30; sweep++) {
        for (size_t p = 0; p < n; p++) {
            for (size_t q = p + 1; q < n; q++) {
                if (a[p * n + q] == 0)
                    continue;
                double theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                double c = 1 / sqrt(t * t + 1), s = t * c;
                for (size_t k = 0; k < n; k++) {
                    double x = a[k * n + p], y = a[k * n + q];
                    a[k * n + p] = c * x - s * y;
                    a[k * n + q] = s * x + c * y;
                }
                for (size_t k = 0; k < n; k++) {
                    double x = a[p * n + k], y = a[q * n + k];
                    a[p * n + k] = c * x - s * y;
                    a[q * n + k] = s * x + c * y;
                }
            }
        }
    }
    for (size_t i = 0; i < n; i++) {
        double value = a[i * n + i];
        size_t place = i;
        for (; place > 0 && out[place - 1] > value; place--)
            out[place] = out[place - 1];
        out[place] = value;
    }
}

/* Are the columns solutions of A x = lambda M x, and orthonormal with respect to the masses? */
static void check_functions(const double *full, const double *masses, size_t n,
                            const double *eigenvalues, const double *functions, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const double *x = functions + i * n;
        for (size_t k = 0; k < i + 1; k++) {
            double product = 0;
            for (size_t r = 0; r < n; r++)
                product += masses[r] * x[r] * functions[k * n + r];
            assert_true(fabs(product - (i == k ? 1 : 0)) < 1e-7);
        }
        for (size_t r = 0; r < n; r++) {
            double left = 0, right = eigenvalues[i] * masses[r] * x[r];
            for (size_t c = 0; c < n; c++)
                left += full[r * n + c] * x[c];
            assert_true(fabs(left - right) < 1e-5 * (1 + eigenvalues[i]) * sqrt(masses[r]));
        }
    }
}

/* Random weighted graphs, of one or several components, against a dense solver. */
static void spectrum_of_graphs(void **state) {
    (void)state;
    enum { N = 70, WANTED = 20 };
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < 6; round++) {
        starg_rng rng = starg_rng_make(7, round, 0);
        double *full = calloc(N * N, sizeof *full), masses[N], exact[N], found[WANTED], sum = 0;
        int64_t starts[N + 1] = {0}, rows[N * N];
        double *values = calloc(N * N, sizeof *values);
        assert_true(full != NULL && values != NULL);
        size_t parts = 1 + round % 3;
        for (size_t i = 0; i < N; i++)
            sum += masses[i] = 0.1 + starg_rng_unit(&rng);
        for (size_t i = 0; i < N; i++)
            masses[i] /= sum;
        for (size_t i = 0; i < N; i++)
            for (size_t k = 0; k < i; k++) {
                bool joined = i % parts == k % parts && (i - k == parts || i % 7 == k % 7);
                double weight = joined ? starg_rng_unit(&rng) : 0;
                full[i * N + k] = full[k * N + i] = -weight;
                full[i * N + i] += weight;
                full[k * N + k] += weight;
            }
        int64_t next = 0;
        for (size_t c = 0; c < N; c++) {
            rows[next] = (int64_t)c;
            values[next++] = full[c * N + c];
            for (size_t r = 0; r < N; r++) {
                if (r == c || full[c * N + r] == 0)
                    continue;
                rows[next] = (int64_t)r;
                values[next++] = full[c * N + r];
            }
            starts[c + 1] = next;
        }
        const laplacian l = {
            .count = N, .starts = starts, .rows = rows, .values = values, .masses = masses};
        double *functions = malloc(WANTED * N * sizeof *functions), again[WANTED];
        assert_non_null(functions);
        test_ok(context, spectrum_smallest(context, &l, WANTED, again, NULL));
        test_ok(context, spectrum_smallest(context, &l, WANTED, found, functions));
        for (size_t i = 0; i < WANTED; i++)
            assert_true(fabs(again[i] - found[i]) < 1e-9 * (1 + found[i]));
        check_functions(full, masses, N, found, functions, WANTED);
        free(functions);
        for (size_t i = 0; i < N * N; i++)
            full[i] /= sqrt(masses[i / N] * masses[i % N]);
        jacobi(full, N, exact);
        for (size_t i = 0; i < WANTED; i++)
            assert_true(fabs(found[i] - exact[i]) < 1e-7 * (1 + exact[i]));
        assert_true(fabs(found[parts - 1]) < 1e-7 && found[parts] > 1e-4);
        free(values);
        free(full);
    }
    test_context_free(context);
}

/* A sphere of area A: l (l + 1) 4 pi / A, each 2 l + 1 times. */
static void spectrum_of_a_sphere(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 6000);
    starg_signature *s = describe(context, mesh, STARG_SIGNATURE_SHAPE_DNA);
    size_t i = 0;
    for (int l = 1; l <= 6; l++)
        for (int k = 0; k < 2 * l + 1; k++, i++) {
            double expected = 4 * PI * l * (l + 1);
            assert_true(fabs(s->numbers[i] - expected) < 0.01 * expected);
        }
    starg_signature_free(context, s);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A sheet with sides a and b and free borders: pi^2 (m^2 / a^2 + n^2 / b^2). */
static void spectrum_of_a_sheet(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = sheet(context, 80, 40);
    starg_signature *s = describe(context, mesh, STARG_SIGNATURE_SHAPE_DNA);
    double expected[400];
    for (int m = 0; m < 20; m++)
        for (int n = 0; n < 20; n++)
            expected[20 * m + n] = PI * PI * (m * m / 4.0 + n * n) * 2;
    qsort(expected, 400, sizeof *expected, by_size);
    for (size_t i = 0; i < 30; i++)
        assert_true(fabs(s->numbers[i] - expected[i + 1]) < 0.015 * expected[i + 1]);
    starg_signature_free(context, s);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* ---- invariance ---- */

/* The same surface translated, rotated, scaled, and with vertices and faces reordered. */
static starg_mesh *disguise(starg_context *context, const starg_mesh *mesh, double scale) {
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    shape s = {.vertex_count = n, .face_count = m};
    s.vertices = malloc(3 * n * sizeof *s.vertices);
    s.faces = malloc(3 * m * sizeof *s.faces);
    uint32_t *places = malloc(n * sizeof *places);
    assert_true(s.vertices != NULL && s.faces != NULL && places != NULL);
    starg_rng rng = starg_rng_make(5, 0, 0);
    for (size_t i = 0; i < n; i++) {
        size_t other = starg_rng_below(&rng, i + 1);
        places[i] = places[other];
        places[other] = (uint32_t)i;
    }
    for (size_t i = 0; i < n; i++) {
        const double *p = starg_mesh_vertices(mesh) + 3 * i;
        double *q = s.vertices + 3 * (size_t)places[i];
        double x = 0.6 * p[0] - 0.8 * p[1], y = 0.8 * p[0] + 0.6 * p[1];
        q[0] = scale * (x + 0.1);
        q[1] = scale * (0.28 * y - 0.96 * p[2] - 0.2);
        q[2] = scale * (0.96 * y + 0.28 * p[2] + 0.3);
    }
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < 3; k++)
            s.faces[3 * (m - 1 - i) + k] = places[starg_mesh_faces(mesh)[3 * i + (k + i) % 3]];
    starg_mesh *out = test_mesh_of(context, &s);
    free(places);
    shape_free(&s);
    return out;
}

static void nothing_but_the_shape_counts(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = test_sample_mesh(context, "octopus", test_size(2010, 3000));
    starg_mesh *other = test_sample_mesh(context, "torus", test_size(2010, 3000));
    const double noise[STARG_SIGNATURE_KINDS] = {[STARG_SIGNATURE_D2] = 0.02,
                                                 [STARG_SIGNATURE_SHAPE_DNA] = 1e-5,
                                                 [STARG_SIGNATURE_STAR] = 0.2};
    for (int k = 0; k < STARG_SIGNATURE_KINDS; k++) {
        starg_signature_kind kind = (starg_signature_kind)k;
        if (kind == STARG_SIGNATURE_PAPER)
            continue; /* depends on the positions of guards; test_match transforms its graphs */
        starg_signature *first = describe(context, mesh, kind);
        starg_signature *unlike = describe(context, other, kind);
        assert_true(distance(context, first, first) == 0);
        assert_true(distance(context, first, unlike) > 5 * noise[k]);
        const double scales[] = {1e-40, 1e60};
        for (size_t i = 0; i < 2; i++) {
            if (starg_signature_needs_descriptor(kind) && i != 0)
                continue; /* one decomposition is enough */
            starg_mesh *hidden = disguise(context, mesh, scales[i]);
            starg_signature *second = describe(context, hidden, kind);
            assert_true(distance(context, first, second) < noise[k]);
            starg_signature_free(context, second);
            starg_mesh_free(hidden);
        }
        starg_signature_free(context, first);
        starg_signature_free(context, unlike);
    }
    starg_mesh_free(mesh);
    starg_mesh_free(other);
    test_context_free(context);
}

/* The resolution of a flat surface hardly matters: coarse meshes are subdivided. */
static void resolution_hardly_counts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape coarse = shape_cube(1), fine = shape_cube(9);
    starg_mesh *meshes[2] = {test_mesh_of(context, &coarse), test_mesh_of(context, &fine)};
    starg_signature *s[2];
    for (size_t i = 0; i < 2; i++)
        s[i] = describe(context, meshes[i], STARG_SIGNATURE_SHAPE_DNA);
    for (size_t i = 0; i < 10; i++)
        assert_true(fabs(s[0]->numbers[i] / s[1]->numbers[i] - 1) < 0.02);
    for (size_t i = 0; i < 2; i++) {
        starg_signature_free(context, s[i]);
        starg_mesh_free(meshes[i]);
    }
    shape_free(&coarse);
    shape_free(&fine);
    test_context_free(context);
}

static void same_bytes_on_any_threads(void **state) {
    (void)state;
    starg_context *one = test_context(1), *four = test_context(4);
    starg_mesh *mesh = test_sample_mesh(one, "dog", 2010);
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        starg_signature *a = describe(one, mesh, (starg_signature_kind)kind);
        starg_signature *b = describe(four, mesh, (starg_signature_kind)kind);
        assert_int_equal(a->count, b->count);
        assert_memory_equal(a->numbers, b->numbers, a->count * sizeof *a->numbers);
        starg_signature_free(one, a);
        starg_signature_free(four, b);
    }
    starg_mesh_free(mesh);
    test_context_free(one);
    test_context_free(four);
}

/* ---- rejections ---- */

static void poor_meshes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double points[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 1e-200, 3, 4, 5};
    const uint32_t line[] = {0, 1, 2}, needle[] = {0, 1, 3}, point[] = {4, 4, 4},
                   lone[] = {0, 1, 4};
    const struct {
        const uint32_t *faces;
        bool d2, dna;
    } cases[] = {
        {line, false, true}, {needle, false, true}, {point, false, false}, {lone, true, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_mesh *mesh = NULL;
        starg_signature *s = NULL;
        test_ok(context, starg_mesh_create(context, points, 5, cases[i].faces, 1, &mesh));
        starg_status d2 = starg_signature_create(context, mesh, STARG_SIGNATURE_D2, &s);
        assert_int_equal(d2, cases[i].d2 ? STARG_OK : STARG_ERROR_MESH);
        starg_signature_free(context, s);
        starg_status dna = starg_signature_create(context, mesh, STARG_SIGNATURE_SHAPE_DNA, &s);
        assert_true(cases[i].dna ? dna == STARG_OK || dna == STARG_ERROR_SOLVER
                                 : dna == STARG_ERROR_MESH);
        assert_int_equal(dna == STARG_OK, s != NULL);
        starg_signature_free(context, s);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* Random faces over the nastiest points: a signature that passes its own check, or a clear
 * rejection. Without those based on guards: a fine enough lattice for such shapes takes minutes. */
static void adversarial_meshes(void **state) {
    (void)state;
    enum { POINTS = 9, FACES = 14 };
    starg_context *context = test_context(1);
    size_t described = 0, refused = 0, tried = 0;
    for (int family = 0; family < POINT_FAMILIES; family++) {
        starg_rng rng = starg_rng_make(21, (uint64_t)family, 0);
        double points[POINTS][3];
        uint32_t faces[3 * FACES];
        starg_mesh *mesh = NULL;
        adversarial_points(&rng, (point_family)family, points, POINTS);
        for (size_t i = 0; i < 3 * FACES; i++)
            faces[i] = (uint32_t)starg_rng_below(&rng, POINTS);
        test_ok(context, starg_mesh_create(context, points[0], POINTS, faces, FACES, &mesh));
        for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
            starg_signature *s = NULL, *again = NULL;
            if (starg_signature_needs_descriptor((starg_signature_kind)kind))
                continue;
            tried++;
            starg_status status =
                starg_signature_create(context, mesh, (starg_signature_kind)kind, &s);
            described += status == STARG_OK;
            refused += status == STARG_ERROR_MESH || status == STARG_ERROR_SOLVER;
            if (status == STARG_OK)
                test_ok(context, starg_signature_restore(context, s->kind, s->version, s->numbers,
                                                         s->count, &again));
            starg_signature_free(context, s);
            starg_signature_free(context, again);
        }
        starg_mesh_free(mesh);
    }
    assert_int_equal(described + refused, tried);
    assert_true(described > POINT_FAMILIES);
    test_context_free(context);
}

static void kinds_and_versions(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double d2[BINS] = {1}, dna[50], far;
    const int d2_version = starg_signature_version(STARG_SIGNATURE_D2),
              dna_version = starg_signature_version(STARG_SIGNATURE_SHAPE_DNA);
    starg_signature *a = NULL, *b = NULL, *none = NULL;
    for (size_t i = 0; i < 50; i++)
        dna[i] = (double)i;
    test_ok(context,
            starg_signature_restore(context, STARG_SIGNATURE_D2, d2_version, d2, BINS, &a));
    test_ok(context,
            starg_signature_restore(context, STARG_SIGNATURE_SHAPE_DNA, dna_version, dna, 50, &b));
    assert_int_equal(starg_signature_distance(context, a, b, &far), STARG_ERROR_ARGUMENT);
    starg_signature *const both[] = {a, b};
    double table[4];
    assert_int_equal(starg_signature_distances(context, both, 2, table), STARG_ERROR_ARGUMENT);
    assert_int_equal(
        starg_signature_restore(context, STARG_SIGNATURE_D2, d2_version - 1, d2, BINS, &none),
        STARG_ERROR_FORMAT);
    assert_int_equal(starg_signature_restore(context, STARG_SIGNATURE_D2, d2_version, d2, 3, &none),
                     STARG_ERROR_FORMAT);
    d2[5] = NAN;
    assert_int_equal(
        starg_signature_restore(context, STARG_SIGNATURE_D2, d2_version, d2, BINS, &none),
        STARG_ERROR_FORMAT);
    dna[7] = 1;
    assert_int_equal(
        starg_signature_restore(context, STARG_SIGNATURE_SHAPE_DNA, dna_version, dna, 50, &none),
        STARG_ERROR_FORMAT);
    assert_null(none);
    assert_null(starg_signature_name((starg_signature_kind)99));
    assert_string_equal(starg_signature_name(STARG_SIGNATURE_D2), "d2");
    starg_signature_free(context, a);
    starg_signature_free(context, b);
    test_context_free(context);
}

static void memory_may_give_out(void **state) {
    (void)state;
    shape s = shape_cube(1);
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    starg_mesh *mesh = test_mesh_of(context, &s);
    for (int kind = 0; kind <= STARG_SIGNATURE_STAR; kind++) {
        size_t before = starg_context_live_blocks(context), failures = 0;
        starg_signature *signature = NULL;
        for (;; failures += 1 + failures / 16) {
            left = failures;
            starg_status status =
                starg_signature_create(context, mesh, (starg_signature_kind)kind, &signature);
            left = SIZE_MAX;
            if (status == STARG_OK)
                break;
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_null(signature);
            assert_int_equal(starg_context_live_blocks(context), before);
        }
        assert_true(failures > 3);
        starg_signature_free(context, signature);
    }
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

static void cancelled(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "dog", 1000);
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        starg_signature *s = NULL;
        starg_context_cancel(context);
        assert_int_equal(starg_signature_create(context, mesh, (starg_signature_kind)kind, &s),
                         STARG_ERROR_CANCELLED);
        assert_null(s);
        starg_context_reset(context);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Random numbers of any size, and others near them, in steps of 8: what a signature's neighbours
 * do. */
static void random_pair(starg_rng *rng, size_t count, double *a, double *b) {
    double size = exp(150 * (starg_rng_unit(rng) - 0.5)), near = exp(-30 * starg_rng_unit(rng));
    double shift = 0;
    for (size_t i = 0; i < count; i++) {
        shift = i % 8 == 0 ? starg_rng_unit(rng) - 0.5 : shift;
        a[i] = size * (starg_rng_unit(rng) - 0.3);
        b[i] = a[i] + size * near * (shift + 0.3 * starg_rng_unit(rng));
    }
}

/* The weight of number i, by the definition of the kind's distance. */
static double weight_of(starg_signature_kind kind, size_t i) {
    enum {
        SPECTRUM = STARG_DESCRIPTOR_EIGENVALUES,
        SEEN = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
        WAVES = STARG_DESCRIPTOR_ENERGIES * STARG_DESCRIPTOR_SPREAD
    };
    if (kind == STARG_SIGNATURE_D2)
        return 1;
    if (kind == STARG_SIGNATURE_SHAPE_DNA)
        return 1 / (double)(i + 1);
    if (i < SPECTRUM)
        return 1 / (3 * 0.078 * SPECTRUM * (double)(i + 1));
    return i < SPECTRUM + SEEN ? 1 / (3 * 0.041 * SEEN) : 1 / (3 * 0.18 * WAVES);
}

static double distance_by_definition(starg_signature_kind kind, size_t count, const double *a,
                                     const double *b) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double difference = fabs(a[i] - b[i]) * weight_of(kind, i);
        sum += kind == STARG_SIGNATURE_SHAPE_DNA ? difference * difference : difference;
    }
    return kind == STARG_SIGNATURE_SHAPE_DNA ? sqrt(sum) : sum;
}

/* Distances of valid numbers, ascending and between 0 and 1, are as defined. */
static void distances_are_as_defined(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int k = 0; k < STARG_SIGNATURE_PAPER; k++) {
        starg_signature_kind kind = (starg_signature_kind)k;
        size_t count = signature_method_of(kind)->count;
        starg_rng rng = starg_rng_make(4, (uint64_t)k, 0);
        starg_signature *pair[2];
        double a[2][512] = {{0}}, found;
        for (size_t j = 0; j < 2; j++) {
            for (size_t i = 0; i < count; i++)
                a[j][i] = (i > 0 ? a[j][i - 1] : 0) + starg_rng_unit(&rng) / 512;
            test_ok(context, starg_signature_restore(context, kind, starg_signature_version(kind),
                                                     a[j], count, &pair[j]));
        }
        test_ok(context, starg_signature_distance(context, pair[0], pair[1], &found));
        double wanted = distance_by_definition(kind, count, a[0], a[1]);
        assert_true(wanted > 0 && fabs(found - wanted) <= 1e-12 * wanted);
        starg_signature_free(context, pair[0]);
        starg_signature_free(context, pair[1]);
    }
    test_context_free(context);
}

/* A sketch's bound is at most the distance, of numbers of any size; and mostly not much less. */
static void sketches_bound_distances(void **state) {
    (void)state;
    double a[512], b[512], tightness = 0;
    size_t trials = 0;
    for (int k = 0; k < STARG_SIGNATURE_KINDS; k++) {
        starg_signature_kind kind = (starg_signature_kind)k;
        const signature_method *method = signature_method_of(kind);
        assert_int_equal(sketch_count(kind) > 0, kind != STARG_SIGNATURE_PAPER);
        for (uint64_t i = 0; i < 3000 && sketch_count(kind) > 0; i++) {
            starg_rng rng = starg_rng_make(3, (uint64_t)k, i);
            uint8_t bytes[SKETCH_MOST_BYTES];
            sketch x, y, stored;
            random_pair(&rng, method->count, a, b);
            sketch_make(kind, a, method->count, &x);
            sketch_make(kind, b, method->count, &stored);
            sketch_store(&stored, bytes);
            sketch_load(bytes, stored.count, &y);
            double between = distance_by_definition(kind, method->count, a, b);
            double bound = sketch_bound(kind, &x, &y);
            assert_true(bound >= 0 && bound <= between);
            assert_true(sketch_bound(kind, &y, &x) == bound);
            assert_true(sketch_bound(kind, &x, &x) == 0);
            tightness += between > 0 ? bound / between : 1;
            trials++;
        }
    }
    assert_true(tightness > 0.2 * (double)trials);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(d2_of_a_sphere),
        cmocka_unit_test(d2_of_a_cube),
        cmocka_unit_test(laplacian_energy),
        cmocka_unit_test(spectrum_of_graphs),
        cmocka_unit_test(spectrum_of_a_sphere),
        cmocka_unit_test(spectrum_of_a_sheet),
        cmocka_unit_test(nothing_but_the_shape_counts),
        cmocka_unit_test(resolution_hardly_counts),
        cmocka_unit_test(same_bytes_on_any_threads),
        cmocka_unit_test(poor_meshes),
        cmocka_unit_test(adversarial_meshes),
        cmocka_unit_test(kinds_and_versions),
        cmocka_unit_test(distances_are_as_defined),
        cmocka_unit_test(sketches_bound_distances),
        cmocka_unit_test(memory_may_give_out),
        cmocka_unit_test(cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
