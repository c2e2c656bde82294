/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra of solids: checks the guarantees of both generators on their results alone; programs
 * that fail in every way; the same bytes for any number of threads. */
#include "support.h"

#include <dirent.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/context.h"
#include "core/rng.h"
#include "models.h"
#include "starguard/tetra.h"
#include "tetra/generate.h"

static const double DEGREES = 57.29577951308232;

/* ---- checkers ---- */

static void normal_of(const double *a, const double *b, const double *c, double n[3]) {
    double u[3], v[3], length = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int y = (k + 1) % 3, z = (k + 2) % 3;
        n[k] = u[y] * v[z] - u[z] * v[y];
        length += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] /= sqrt(length);
}

static void angles_of(const starg_tetmesh *mesh, double *least, double *most) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const double *p = starg_tetmesh_vertices(mesh);
    *least = 180;
    *most = 0;
    for (size_t t = 0; t < starg_tetmesh_count(mesh); t++) {
        const uint32_t *v = starg_tetmesh_tetrahedra(mesh) + 4 * t;
        double n[4][3];
        for (int f = 0; f < 4; f++)
            normal_of(p + 3 * v[faces[f][0]], p + 3 * v[faces[f][1]], p + 3 * v[faces[f][2]], n[f]);
        for (int f = 0; f < 4; f++)
            for (int g = 0; g < f; g++) {
                double cosine = n[f][0] * n[g][0] + n[f][1] * n[g][1] + n[f][2] * n[g][2];
                double angle = 180 - DEGREES * acos(fmax(-1, fmin(1, cosine)));
                *least = fmin(*least, angle);
                *most = fmax(*most, angle);
            }
    }
}

/* Accepted again without trust: no fold, no overlap. */
static void check_mesh(starg_context *context, const starg_tetmesh *mesh) {
    starg_tetmesh *again = NULL;
    assert_int_equal(starg_tetmesh_turned(mesh), 0);
    assert_null(starg_tetmesh_regions(mesh));
    test_ok(context, starg_tetmesh_create(
                         context, starg_tetmesh_vertices(mesh), starg_tetmesh_vertex_count(mesh),
                         starg_tetmesh_tetrahedra(mesh), starg_tetmesh_count(mesh), NULL, &again));
    assert_int_equal(starg_tetmesh_turned(again), 0);
    starg_tetmesh_free(again);
}

/* Distance from p to a triangle by bisection of a convex problem. */
static double triangle_distance(const double *p, const double *a, const double *b,
                                const double *c) {
    double low[2] = {0, 0}, best = 1e300, size = 1;
    for (int round = 0; round < 14; round++, size *= 0.4) {
        double from[2] = {low[0], low[1]};
        for (int i = -2; i <= 4; i++)
            for (int j = -2; j <= 4; j++) {
                double u = fmin(1, fmax(0, from[0] + size * i / 4));
                double v = fmin(1 - u, fmax(0, from[1] + size * j / 4)), d = 0;
                for (int k = 0; k < 3; k++) {
                    double x = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) - p[k];
                    d += x * x;
                }
                if (d < best) {
                    best = d;
                    low[0] = u;
                    low[1] = v;
                }
            }
    }
    return sqrt(best);
}

/* No vertex or face centroid of one surface is farther from the other than reported. */
static void check_distance(const starg_mesh *from, const starg_mesh *to, double told) {
    const double *p = starg_mesh_vertices(from), *q = starg_mesh_vertices(to);
    for (size_t f = 0; f < starg_mesh_face_count(from); f += 1 + starg_mesh_face_count(from) / 12) {
        const uint32_t *v = starg_mesh_faces(from) + 3 * f;
        for (int sample = 0; sample < 2; sample++) {
            double x[3], nearest = 1e300;
            for (int k = 0; k < 3; k++)
                x[k] = sample ? (p[3 * v[0] + k] + p[3 * v[1] + k] + p[3 * v[2] + k]) / 3
                              : p[3 * v[0] + k];
            for (size_t g = 0; g < starg_mesh_face_count(to); g++) {
                const uint32_t *w = starg_mesh_faces(to) + 3 * g;
                nearest =
                    fmin(nearest, triangle_distance(x, q + 3 * w[0], q + 3 * w[1], q + 3 * w[2]));
            }
            assert_true(nearest <= told * 1.001); /* the search is inexact */
        }
    }
}

static void check_stuffing(starg_context *context, const shape *s, double density,
                           double volume_error) {
    starg_solid *solid = test_solid_of(context, s);
    starg_tetra_options options;
    starg_tetra_report report;
    starg_tetmesh *mesh = NULL;
    starg_mesh *surface = NULL;
    starg_tetra_options_default(&options);
    options.generator = STARG_TETRA_STUFFING;
    options.density = density;
    test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &report, &mesh));
    assert_int_equal(report.generator, STARG_TETRA_STUFFING);
    assert_false(report.surface_kept);
    assert_true(report.spacing > 0 && report.step > 0 && report.step <= report.spacing);
    check_mesh(context, mesh);
    double least, most, volume = starg_solid_check(solid)->volume;
    angles_of(mesh, &least, &most);
    assert_true(least > 10.5 && most < 165);
    assert_true(fabs(starg_tetmesh_volume(mesh) - volume) < volume_error * volume);
    test_ok(context, starg_tetmesh_surface(context, mesh, &surface, NULL));
    check_distance(surface, starg_solid_mesh(solid), report.to_surface + report.step);
    check_distance(starg_solid_mesh(solid), surface, report.from_surface + report.step);
    starg_mesh_free(surface);
    starg_tetmesh_free(mesh);
    starg_solid_free(solid);
}

/* ---- stuffing ---- */

static void test_stuffing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape shapes[] = {shape_cube(1),   shape_room(),     shape_cavity(),
                      shape_columns(), shape_blob(1, 3), shape_tetrahedron()};
    const double density[] = {100, 60, 60, 30, 80, 300};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        check_stuffing(context, &shapes[i], density[i], 0.2);
        shape_free(&shapes[i]);
    }
    test_context_free(context);
}

/* Spikes finer than the lattice: the angle bounds hold for any surface. */
static void test_stuffing_spikes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 8; seed++) {
        shape s = shape_blob(3, seed);
        check_stuffing(context, &s, 2.0 + (double)seed, 0.6);
        shape_free(&s);
    }
    test_context_free(context);
}

static void test_scales(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int i = 0; i < 3; i++) {
        shape s = shape_room();
        double scale = (const double[]){0x1p250, 0x1p-250, 1}[i];
        shape_place(&s, scale, i == 2 ? 1e6 : 0);
        starg_solid *solid = test_solid_of(context, &s);
        starg_tetra_options options;
        starg_tetra_options_default(&options);
        for (int generator = STARG_TETRA_AUTO; generator <= STARG_TETRA_STUFFING; generator += 2) {
            starg_tetmesh *mesh = NULL;
            options.generator = (starg_tetra_generator)generator;
            options.density = 100;
            test_ok(context, starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh));
            double ratio = starg_tetmesh_volume(mesh) / starg_solid_check(solid)->volume;
            assert_true(fabs(ratio - 1) < 0.2);
            starg_tetmesh_free(mesh);
        }
        starg_solid_free(solid);
        shape_free(&s);
    }
    test_context_free(context);
}

/* A plate missed by the first lattice. */
static void test_thin(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1);
    for (size_t i = 2; i < 3 * s.vertex_count; i += 3)
        s.vertices[i] *= 0.04;
    starg_solid *solid = test_solid_of(context, &s);
    starg_tetra_options options;
    starg_tetra_report report;
    starg_tetmesh *mesh = NULL;
    starg_tetra_options_default(&options);
    options.generator = STARG_TETRA_STUFFING;
    options.target = 1;
    test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &report, &mesh));
    assert_true(report.spacing < 0.1);
    check_mesh(context, mesh);
    starg_tetmesh_free(mesh);
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* Missing faces, with either orientation: the rest still winds around nearly the same points. */
static void test_open(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_tetra_options options;
    starg_tetra_options_default(&options);
    options.density = 30;
    for (int turned = 0; turned < 2; turned++) {
        shape s = {0}, ball = shape_blob(3, 1);
        const double here[3] = {0, 0, 0};
        for (size_t v = 0; v < ball.vertex_count; v++) { /* the unit ball */
            double *p = ball.vertices + 3 * v, length = 0;
            for (int k = 0; k < 3; k++)
                length += p[k] * p[k];
            for (int k = 0; k < 3; k++)
                p[k] /= sqrt(length);
        }
        shape_append(&s, &ball, here, turned);
        starg_mesh *mesh = NULL;
        starg_tetmesh *tetrahedra = NULL;
        starg_tetra_report report;
        test_ok(context, starg_mesh_create(context, s.vertices, s.vertex_count, s.faces,
                                           s.face_count - 6, &mesh));
        test_ok(context,
                starg_tetmesh_from_open_mesh(context, mesh, &options, &report, &tetrahedra));
        check_mesh(context, tetrahedra);
        assert_true(fabs(starg_tetmesh_volume(tetrahedra) - 4.1) < 0.15);
        assert_true(report.to_surface < 0.3);
        starg_tetmesh_free(tetrahedra);
        starg_mesh_free(mesh);
        shape_free(&ball);
        shape_free(&s);
    }
    test_context_free(context);
}

static void test_nothing_inside(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double points[] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
    const uint32_t face[] = {0, 1, 2};
    for (size_t faces = 0; faces < 2; faces++) {
        starg_mesh *mesh = NULL;
        starg_tetmesh *tetrahedra = NULL;
        test_ok(context, starg_mesh_create(context, points, 3, face, faces, &mesh));
        assert_int_equal(starg_tetmesh_from_open_mesh(context, mesh, NULL, NULL, &tetrahedra),
                         STARG_ERROR_MESH);
        assert_null(tetrahedra);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* Meshes that enclose nothing are reported at once: flat and tilted, doubled faces in any order,
 * and again with a face that invalidates this. */
static void test_hollow(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 50; seed++) {
        enum { FACES = 12, POINTS = 9 };
        starg_rng rng = starg_rng_make(seed, 5, 0);
        double points[3 * POINTS];
        uint32_t faces[3 * (2 * FACES + 1)];
        bool flat = seed % 2 == 0, hollow, spoilt;
        for (size_t i = 0; i < POINTS; i++) {
            for (size_t k = 0; k < 3; k++)
                points[3 * i + k] = (double)starg_rng_below(&rng, 64) / 8;
            if (flat) /* tilted, and exact */
                points[3 * i + 2] = points[3 * i] + 2 * points[3 * i + 1];
        }
        for (size_t f = 0; f < FACES; f++) {
            size_t turn = (size_t)starg_rng_below(&rng, 3);
            uint32_t a = (uint32_t)starg_rng_below(&rng, POINTS);
            const uint32_t face[3] = {a, (a + 1) % POINTS, (a + 4) % POINTS};
            for (size_t k = 0; k < 3; k++) {
                faces[3 * f + k] = face[k];
                faces[3 * (2 * FACES - f) + k] = face[(5 - k + turn) % 3];
            }
            faces[3 * FACES] = 0, faces[3 * FACES + 1] = 2, faces[3 * FACES + 2] = 5;
        }
        size_t half = 3 * (size_t)FACES;
        for (int single = 0; single < 2; single++) {
            starg_mesh *mesh = NULL;
            if (!single) { /* without the middle one */
                uint32_t all[6 * FACES];
                memcpy(all, faces, half * sizeof *all);
                memcpy(all + half, faces + half + 3, half * sizeof *all);
                test_ok(context, starg_mesh_create(context, points, POINTS, all, 2 * FACES, &mesh));
                test_ok(context, tetra_is_hollow(context, mesh, &hollow));
            } else {
                test_ok(context,
                        starg_mesh_create(context, points, POINTS, faces, 2 * FACES + 1, &mesh));
                test_ok(context, tetra_is_hollow(context, mesh, &spoilt));
            }
            starg_mesh_free(mesh);
        }
        assert_true(hollow);
        assert_int_equal(spoilt, flat);
    }
    test_context_free(context);
}

static void test_threads(void **state) {
    (void)state;
    starg_context *context[2] = {test_context(1), test_context(3)};
    shape s = shape_blob(2, 5);
    starg_tetmesh *mesh[2];
    starg_tetra_report report[2];
    starg_tetra_options options;
    starg_tetra_options_default(&options);
    options.generator = STARG_TETRA_STUFFING;
    for (int i = 0; i < 2; i++) {
        starg_solid *solid = test_solid_of(context[i], &s);
        test_ok(context[i],
                starg_tetmesh_from_solid(context[i], solid, &options, &report[i], &mesh[i]));
        starg_solid_free(solid);
    }
    assert_int_equal(starg_tetmesh_count(mesh[0]), starg_tetmesh_count(mesh[1]));
    assert_memory_equal(starg_tetmesh_vertices(mesh[0]), starg_tetmesh_vertices(mesh[1]),
                        24 * starg_tetmesh_vertex_count(mesh[0]));
    assert_memory_equal(starg_tetmesh_tetrahedra(mesh[0]), starg_tetmesh_tetrahedra(mesh[1]),
                        16 * starg_tetmesh_count(mesh[0]));
    assert_true(report[0].to_surface == report[1].to_surface);
    assert_true(report[0].from_surface == report[1].from_surface);
    for (int i = 0; i < 2; i++) {
        starg_tetmesh_free(mesh[i]);
        test_context_free(context[i]);
    }
    shape_free(&s);
}

/* ---- the program ---- */

static bool has_tetgen(void) {
    bool found = system("command -v tetgen >/dev/null 2>&1") == 0;
    if (!found)
        printf("skipped: the program tetgen is not installed\n");
    return found;
}

static void check_kept(starg_context *context, const starg_solid *solid,
                       const starg_tetmesh *mesh) {
    const starg_mesh *own = starg_solid_mesh(solid);
    starg_mesh *surface = NULL;
    uint32_t *map = NULL;
    check_mesh(context, mesh);
    test_ok(context, starg_tetmesh_surface(context, mesh, &surface, &map));
    size_t count = starg_mesh_face_count(own);
    assert_int_equal(starg_mesh_face_count(surface), count);
    assert_memory_equal(starg_tetmesh_vertices(mesh), starg_mesh_vertices(own),
                        24 * starg_mesh_vertex_count(own));
    for (size_t f = 0; f < count; f++) {
        const uint32_t *v = starg_mesh_faces(own) + 3 * f;
        bool found = false;
        for (size_t g = 0; g < count && !found; g++) {
            const uint32_t *w = starg_mesh_faces(surface) + 3 * g;
            for (int k = 0; k < 3; k++)
                found = found || (map[w[k]] == v[0] && map[w[(k + 1) % 3]] == v[1] &&
                                  map[w[(k + 2) % 3]] == v[2]);
        }
        assert_true(found);
    }
    starg_tetmesh_map_free(context, map);
    starg_mesh_free(surface);
}

static void test_tetgen(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    shape shapes[] = {shape_cube(2), shape_room(), shape_cavity(), shape_columns(),
                      shape_blob(2, 3)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        starg_solid *solid = test_solid_of(context, &shapes[i]);
        size_t counts[2];
        for (int dense = 0; dense < 2; dense++) {
            starg_tetra_options options;
            starg_tetra_report report;
            starg_tetmesh *mesh = NULL;
            starg_tetra_options_default(&options);
            options.generator = STARG_TETRA_TETGEN;
            options.density = dense ? 60 : 0;
            test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &report, &mesh));
            assert_int_equal(report.generator, STARG_TETRA_TETGEN);
            assert_true(report.surface_kept && report.to_surface == 0);
            check_kept(context, solid, mesh);
            double volume = starg_solid_check(solid)->volume;
            assert_true(fabs(starg_tetmesh_volume(mesh) - volume) < 1e-9 * volume);
            counts[dense] = starg_tetmesh_count(mesh);
            starg_tetmesh_free(mesh);
        }
        /* no point comes close to a large face that must stay whole: only fine surfaces get
         * dense */
        assert_true(i + 1 < sizeof shapes / sizeof *shapes ? counts[1] >= counts[0]
                                                           : counts[1] > 4 * counts[0]);
        starg_solid_free(solid);
        shape_free(&shapes[i]);
    }
    test_context_free(context);
}

/* Files in a folder, without "." and "..". */
static size_t count_files(const char *path) {
    size_t count = 0;
    DIR *folder = opendir(path);
    assert_non_null(folder);
    while (readdir(folder) != NULL)
        count++;
    closedir(folder);
    return count - 2;
}

/* Failing programs: what each does, and the resulting message. */
static const struct {
    const char *script, *says;
} BROKEN[] = {
    {NULL, "cannot be run"},
    {"exit 3", "status 3"},
    {"kill -SEGV $$", "signal"},
    {"while :; do :; done", "too long"},
    {"exit 0", "rejected"},
    {"echo rubbish > \"${2%.smesh}.1.node\"; echo rubbish > \"${2%.smesh}.1.ele\"", "rejected"},
    {"echo 4 3 0 0 > \"${2%.smesh}.1.node\"; echo 0 4 0 > \"${2%.smesh}.1.ele\"", "rejected"},
    {"n=\"${2%.smesh}.1\"; printf '8 3 0 0\\n0 0 0 0\\n1 0 0 1\\n2 0 1 0\\n3 0 1 1\\n4 1 0 0\\n"
     "5 1 0 1\\n6 1 1 0\\n7 1 1 1\\n' > $n.node; printf '1 4 1\\n0 0 4 2 1 1\\n' > $n.ele",
     "rejected"},
};

static void test_broken_programs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char folder[] = "/tmp/starguard-test-XXXXXX", program[64], scratch[64];
    assert_non_null(mkdtemp(folder));
    snprintf(program, sizeof program, "%s/tetgen", folder);
    snprintf(scratch, sizeof scratch, "%s/scratch", folder);
    assert_int_equal(mkdir(scratch, 0700), 0);
    assert_int_equal(setenv("TMPDIR", scratch, 1), 0);
    shape s = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &s);
    starg_tetra_options options;
    starg_tetra_options_default(&options);
    options.generator = STARG_TETRA_TETGEN;
    options.tetgen = program;
    options.tetgen_limit = 0.3;
    for (size_t i = 0; i < sizeof BROKEN / sizeof *BROKEN; i++) {
        starg_tetmesh *mesh = NULL;
        starg_tetra_report report;
        if (BROKEN[i].script != NULL) {
            FILE *file = fopen(program, "w");
            assert_non_null(file);
            fprintf(file, "#!/bin/sh\n%s\n", BROKEN[i].script);
            fclose(file);
            assert_int_equal(chmod(program, 0700), 0);
        }
        assert_int_equal(starg_tetmesh_from_solid(context, solid, &options, &report, &mesh),
                         STARG_ERROR_SOLVER);
        assert_null(mesh);
        if (strstr(starg_context_error(context)->message, BROKEN[i].says) == NULL)
            fail_msg("%s: %s", BROKEN[i].script, starg_context_error(context)->message);
        assert_int_equal(count_files(scratch), 0);
    }
    unlink(program);
    setenv("TMPDIR", "/nowhere", 1);
    starg_tetmesh *mesh = NULL;
    assert_int_equal(starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh),
                     STARG_ERROR_SOLVER);
    unsetenv("TMPDIR");
    rmdir(scratch);
    assert_int_equal(rmdir(folder), 0);
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* By default, no program runs, and it is told that the surface is approximated. */
static void tell_warnings(void *user, starg_log_level level, const char *message) {
    if (level == STARG_LOG_WARNING && strstr(message, "approximates") != NULL)
        ++*(int *)user;
}

static void test_default(void **state) {
    (void)state;
    starg_context *context;
    starg_context_options context_options;
    int warnings = 0;
    starg_context_options_default(&context_options);
    context_options.log = tell_warnings;
    context_options.log_user = &warnings;
    assert_int_equal(starg_context_create(&context_options, &context), STARG_OK);
    shape s = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &s);
    for (int said = 0; said < 2; said++) {
        starg_tetra_options options;
        starg_tetra_report report;
        starg_tetmesh *mesh;
        starg_tetra_options_default(&options);
        options.generator = said ? STARG_TETRA_STUFFING : STARG_TETRA_AUTO;
        test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &report, &mesh));
        assert_int_equal(report.generator, STARG_TETRA_STUFFING);
        assert_int_equal(warnings, 1);
        starg_tetmesh_free(mesh);
    }
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

static void test_self_intersecting(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1), other = shape_cube(1);
    const double offset[3] = {0.5, 0.5, 0.5};
    shape_append(&s, &other, offset, 0);
    starg_solid *solid = test_solid_of(context, &s);
    starg_tetra_options options;
    starg_tetra_report report;
    starg_tetmesh *mesh = NULL;
    starg_tetra_options_default(&options);
    options.target = 20000;
    test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &report, &mesh));
    assert_int_equal(report.generator, STARG_TETRA_STUFFING);
    check_mesh(context, mesh);
    assert_true(fabs(starg_tetmesh_volume(mesh) - 1.875) < 0.06); /* of the union */
    assert_true(report.to_surface < report.spacing);
    starg_tetmesh_free(mesh);
    options.generator = STARG_TETRA_TETGEN;
    assert_int_equal(starg_tetmesh_from_solid(context, solid, &options, &report, &mesh),
                     STARG_ERROR_SOLVER);
    starg_solid_free(solid);
    shape_free(&s);
    shape_free(&other);
    test_context_free(context);
}

static void test_arguments(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &s);
    starg_tetmesh *mesh = NULL;
    for (int i = 0; i < 4; i++) {
        starg_tetra_options options;
        starg_tetra_options_default(&options);
        if (i == 0)
            options.density = -1;
        else if (i == 1)
            options.density = NAN;
        else if (i == 2)
            options.target = SIZE_MAX;
        else
            options.tetgen_limit = 0;
        assert_int_equal(starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh),
                         STARG_ERROR_ARGUMENT);
        assert_null(mesh);
    }
    starg_context_cancel(context);
    for (int generator = 0; generator < 3; generator++) {
        starg_tetra_options options;
        starg_tetra_options_default(&options);
        options.generator = (starg_tetra_generator)generator;
        starg_status status = starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh);
        if (generator != STARG_TETRA_TETGEN || status != STARG_ERROR_SOLVER)
            assert_int_equal(status, STARG_ERROR_CANCELLED);
        assert_null(mesh);
    }
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* ---- memory ---- */

/* Every allocation fails once. */
static void test_memory(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    shape s = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &s);
    size_t before = starg_context_live_blocks(context);
    starg_tetra_options options;
    starg_tetra_options_default(&options);
    options.tetgen_limit = 20;
    options.density = 4;
    for (int generator = STARG_TETRA_AUTO; generator <= STARG_TETRA_STUFFING; generator += 2) {
        starg_tetmesh *mesh = NULL;
        size_t failures = 0;
        options.generator = (starg_tetra_generator)generator;
        for (;; failures++) {
            left = failures;
            starg_status status = starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh);
            left = SIZE_MAX;
            if (status == STARG_OK)
                break;
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_null(mesh);
            assert_int_equal(starg_context_live_blocks(context), before);
        }
        assert_true(failures >= 10);
        starg_tetmesh_free(mesh);
    }
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

static void test_shared(void **state) {
    (void)state;
    static const char *const files[] = {"nasty/two_spheres.obj", "nasty/self_intersectA.obj",
                                        "nasty/snake_loop.off", "solids/hand_1197.off"};
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(2);
    size_t made = 0;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[4300];
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        starg_tetmesh *tetrahedra = NULL;
        starg_tetra_report report;
        starg_tetra_options options;
        snprintf(path, sizeof path, "%s/%s", data, files[i]);
        starg_tetra_options_default(&options);
        options.density = 5;
        test_ok(context, starg_mesh_read(context, path, &mesh));
        if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
            test_ok(context,
                    starg_tetmesh_from_solid(context, solid, &options, &report, &tetrahedra));
            check_mesh(context, tetrahedra);
            if (starg_solid_check(solid)->findings[STARG_FINDING_SELF_INTERSECTION].count > 0)
                assert_int_equal(report.generator, STARG_TETRA_STUFFING);
            made++;
        }
        starg_tetmesh_free(tetrahedra);
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    assert_true(made >= 2);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stuffing),
                                       cmocka_unit_test(test_stuffing_spikes),
                                       cmocka_unit_test(test_scales),
                                       cmocka_unit_test(test_thin),
                                       cmocka_unit_test(test_open),
                                       cmocka_unit_test(test_nothing_inside),
                                       cmocka_unit_test(test_hollow),
                                       cmocka_unit_test(test_default),
                                       cmocka_unit_test(test_threads),
                                       cmocka_unit_test(test_tetgen),
                                       cmocka_unit_test(test_broken_programs),
                                       cmocka_unit_test(test_self_intersecting),
                                       cmocka_unit_test(test_arguments),
                                       cmocka_unit_test(test_memory),
                                       cmocka_unit_test(test_shared)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
