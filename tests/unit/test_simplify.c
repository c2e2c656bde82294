/* SPDX-License-Identifier: Apache-2.0 */
/* Simplified meshes: the topology, the embedding and nearly the shape of the input, the same bytes
 * every time, and errors on other input. Results are judged by starg_mesh_check and by distances,
 * which are independent of the simplification. */
#include "support.h"

#include <dirent.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "mesh/levels/heap.h"
#include "mesh/levels/levels.h"
#include "mesh/solid.h"
#include "models.h"
#include "starguard/check.h"
#include "starguard/sample.h"
#include "starguard/simplify.h"

static starg_check *check_of(starg_context *context, const starg_mesh *mesh) {
    starg_check *check;
    test_ok(context, starg_mesh_check(context, mesh, &check));
    return check;
}

static void assert_same_mesh(const starg_mesh *a, const starg_mesh *b) {
    size_t n = starg_mesh_vertex_count(a), faces = starg_mesh_face_count(a);
    assert_int_equal(starg_mesh_vertex_count(b), n);
    assert_int_equal(starg_mesh_face_count(b), faces);
    assert_memory_equal(starg_mesh_vertices(a), starg_mesh_vertices(b), 3 * n * sizeof(double));
    assert_memory_equal(starg_mesh_faces(a), starg_mesh_faces(b), 3 * faces * sizeof(uint32_t));
}

/* Closed, manifold, and as many components, cavities and handles as before. */
static void assert_same_topology(starg_context *context, const starg_mesh *fine,
                                 const starg_mesh *coarse, bool embedded) {
    starg_check *before = check_of(context, fine), *after = check_of(context, coarse);
    assert_true(before->usable);
    assert_true(after->closed && after->manifold && after->oriented);
    assert_int_equal(after->genus, before->genus);
    assert_int_equal(after->components, before->components);
    assert_int_equal(after->findings[STARG_FINDING_ISOLATED_VERTEX].count, 0);
    if (embedded) {
        assert_true(before->embedded);
        assert_true(after->embedded);
        assert_true(after->usable);
        assert_int_equal(after->cavities, before->cavities);
        assert_int_equal(after->findings[STARG_FINDING_INWARD_COMPONENT].count,
                         before->findings[STARG_FINDING_INWARD_COMPONENT].count);
    }
    starg_check_free(context, before);
    starg_check_free(context, after);
}

/* Onto all vertices of the coarse mesh; vertices that are the only preimage did not move. */
static void assert_map(const starg_mesh *fine, const starg_mesh *coarse, const uint32_t *map) {
    size_t n = starg_mesh_vertex_count(fine), count = starg_mesh_vertex_count(coarse);
    uint32_t *merged = calloc(count, sizeof *merged);
    for (size_t v = 0; v < n; v++) {
        assert_true(map[v] < count);
        merged[map[v]]++;
    }
    for (size_t c = 0; c < count; c++)
        assert_true(merged[c] > 0);
    for (size_t v = 0; v < n; v++)
        if (merged[map[v]] == 1)
            assert_memory_equal(starg_mesh_vertices(fine) + 3 * v,
                                starg_mesh_vertices(coarse) + 3 * (size_t)map[v],
                                3 * sizeof(double));
    free(merged);
}

static starg_mesh *simplify(starg_context *context, const starg_mesh *mesh, size_t target) {
    uint32_t *map = malloc((starg_mesh_vertex_count(mesh) + 1) * sizeof *map);
    starg_mesh *coarse;
    test_ok(context, starg_mesh_simplify(context, mesh, target, NULL, map, &coarse));
    assert_map(mesh, coarse, map);
    free(map);
    return coarse;
}

/* ---- topology and embedding ---- */

/* To a reachable target, and as far as possible. */
static void check_mesh(starg_context *context, const starg_mesh *mesh, size_t target,
                       double volume_change) {
    starg_mesh *coarse = simplify(context, mesh, target);
    size_t count = starg_mesh_vertex_count(mesh);
    assert_int_equal(starg_mesh_vertex_count(coarse), target < count ? target : count);
    assert_same_topology(context, mesh, coarse, true);
    double volume = starg_mesh_volume(mesh);
    assert_true(fabs(starg_mesh_volume(coarse) - volume) <= volume_change * fabs(volume));
    starg_mesh *least = simplify(context, coarse, 0);
    assert_same_topology(context, mesh, least, true);
    assert_true(starg_mesh_vertex_count(least) >= 4);
    assert_true(starg_mesh_vertex_count(least) <= 60); /* the samples have at most 8 handles */
    starg_mesh_free(least);
    starg_mesh_free(coarse);
}

static void test_samples_stay_solids(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        starg_mesh *mesh = test_sample_mesh(context, starg_sample_at(i)->name, 2000);
        check_mesh(context, mesh, 400, starg_sample_at(i)->poses > 100 ? 0.5 : 0.06); /* cubes */
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

static void test_lattices_stay_solids(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape shapes[] = {shape_tetrahedron(), shape_cube(1),  shape_cube(6),
                      shape_room(),        shape_cavity(), shape_columns()};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        starg_mesh *mesh = test_mesh_of(context, &shapes[i]);
        size_t count = starg_mesh_vertex_count(mesh);
        check_mesh(context, mesh, count > 5 ? count - count / 4 : 4, 0.5);
        starg_mesh_free(mesh);
        shape_free(&shapes[i]);
    }
    test_context_free(context);
}

static void test_flat_walls_cost_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(6);
    starg_mesh *mesh = test_mesh_of(context, &cube), *coarse = simplify(context, mesh, 30);
    assert_int_equal(starg_mesh_vertex_count(coarse), 30);
    assert_true(fabs(starg_mesh_volume(coarse) - 216) < 0.1);
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
    shape_free(&cube);
    test_context_free(context);
}

static void test_everything_shrinks_to_a_tetrahedron(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape blob = shape_blob(3, 7), cube = shape_cube(4);
    shape_append(&blob, &cube, (const double[3]){9, 0, 0}, 0);
    starg_mesh *mesh = test_mesh_of(context, &blob), *coarse = simplify(context, mesh, 0);
    assert_int_equal(starg_mesh_vertex_count(coarse), 8); /* two components */
    assert_int_equal(starg_mesh_face_count(coarse), 8);
    assert_same_topology(context, mesh, coarse, true);
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
    shape_free(&blob);
    shape_free(&cube);
    test_context_free(context);
}

/* Small shells close to a moving surface: none may change sides. */
static void test_shells_do_not_change_sides(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 8; seed++) {
        starg_rng rng = starg_rng_make(seed, 1, 0);
        shape all = shape_blob(2, seed);
        shape_place(&all, 100, 0);
        size_t corners = all.vertex_count;
        for (size_t v = 0; v < corners; v += 7) {
            shape grain = shape_tetrahedron();
            shape_place(&grain, 0.01 + 0.1 * starg_rng_unit(&rng), 0);
            const double *p = all.vertices + 3 * v;
            int inside = (int)starg_rng_below(&rng, 2);
            double at = inside ? 0.97 : 1.01;
            const double offset[3] = {at * p[0], at * p[1], at * p[2]};
            shape_append(&all, &grain, offset, inside);
            shape_free(&grain);
        }
        starg_mesh *mesh = test_mesh_of(context, &all), *coarse = simplify(context, mesh, 0);
        assert_same_topology(context, mesh, coarse, true);
        starg_mesh_free(coarse);
        starg_mesh_free(mesh);
        shape_free(&all);
    }
    test_context_free(context);
}

static void test_shared_solids(void **state) {
    (void)state;
    const char *shared = test_shared_data();
    if (shared == NULL)
        skip();
    char folder[4200], path[8600];
    snprintf(folder, sizeof folder, "%s/solids", shared);
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    starg_context *context = test_context(1);
    size_t done = 0;
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        starg_mesh *mesh = NULL;
        if (strstr(entry->d_name, ".off") == NULL)
            continue;
        test_ok(context, starg_mesh_read(context, path, &mesh));
        if (starg_mesh_vertex_count(mesh) <
            test_size(3300, 4000)) { /* checking the larger ones takes long */
            check_mesh(context, mesh, 300 + starg_mesh_vertex_count(mesh) / 10, 0.05);
            done++;
        }
        starg_mesh_free(mesh);
    }
    closedir(directory);
    assert_true(done > test_size(8, 10));
    test_context_free(context);
}

/* ---- the rules of a collapse ---- */

/* A lens over a ring of six corners: one vertex below, two above, joined by an edge. */
static shape lens(void) {
    static const uint32_t above[8][3] = {{7, 5, 0}, {7, 0, 1}, {7, 1, 8}, {8, 1, 2},
                                         {8, 2, 3}, {8, 3, 4}, {8, 4, 7}, {7, 4, 5}};
    shape s = {.vertex_count = 9, .face_count = 14};
    s.vertices = calloc(3 * s.vertex_count, sizeof *s.vertices);
    s.faces = calloc(3 * s.face_count, sizeof *s.faces);
    for (uint32_t i = 0; i < 6; i++) {
        s.vertices[3 * i] = cos(i * 1.0471975511965976);
        s.vertices[3 * i + 1] = sin(i * 1.0471975511965976);
        memcpy(s.faces + 3 * i, (const uint32_t[3]){6, (i + 1) % 6, i}, 3 * sizeof *s.faces);
    }
    memcpy(s.faces + 18, above, sizeof above);
    s.vertices[20] = -0.1;
    s.vertices[21] = 0.3;
    s.vertices[24] = -0.3;
    s.vertices[23] = s.vertices[26] = 0.1;
    return s;
}

static uint32_t halfedge_between(const mesh_surface *surface, uint32_t a, uint32_t b) {
    for (uint32_t h = 0; h < 3 * surface->face_count; h++)
        if (halfedges_start(&surface->mesh, h) == a && halfedges_end(&surface->mesh, h) == b)
            return h;
    fail();
    return 0;
}

static void test_shape_is_kept(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = lens();
    starg_mesh *mesh = test_mesh_of(context, &s);
    mesh_surface *surface;
    dynamic_bvh *tree;
    collapse_star star;
    test_ok(context, surface_create(context, mesh, &surface));
    test_ok(context, dynamic_bvh_create(context, surface, &tree));
    assert_true(collapse_gather(surface, halfedge_between(surface, 7, 8), &star));
    assert_int_equal(star.count, 6);
    static const struct {
        double position[3];
        bool shape, embedding;
    } cases[] = {
        {{0, 0, 0.1}, true, true},    {{0.2, 0.1, 0.2}, true, true},
        {{0, 0, -0.3}, false, true},  /* inside out, though no normal rotates far */
        {{1.5, 0, 0.1}, false, true}, /* over the rim: two faces flip */
        {{0, 0, -0.1}, false, false}, /* onto the vertex below */
        {{1, 0, 0}, false, false},    /* onto the ring */
        {{0, 0, 1e9}, false, true},   /* needles */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(collapse_keeps_shape(surface, &star, cases[i].position), cases[i].shape);
        assert_int_equal(collapse_keeps_embedding(surface, tree, &star, cases[i].position),
                         cases[i].embedding);
    }
    dynamic_bvh_free(tree);
    surface_free(surface);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

/* The mesh resulting from a collapse, built directly. */
static starg_mesh *collapsed(starg_context *context, const mesh_surface *surface,
                             const collapse_star *star, const double position[3]) {
    shape s = {.vertex_count = surface->vertex_count};
    s.vertices = calloc(3 * surface->vertex_count, sizeof *s.vertices);
    s.faces = calloc(3 * surface->face_count, sizeof *s.faces);
    memcpy(s.vertices, surface->vertices, 3 * surface->vertex_count * sizeof *s.vertices);
    memcpy(s.vertices + 3 * (size_t)star->a, position, 3 * sizeof *position);
    for (size_t f = 0; f < surface->face_count; f++) {
        uint32_t *corner = s.faces + 3 * s.face_count;
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = surface_face(surface, f)[k];
            corner[k] = v == star->b ? star->a : v;
        }
        s.face_count += corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0];
    }
    starg_mesh *mesh = test_mesh_of(context, &s);
    shape_free(&s);
    return mesh;
}

/* Any edge of a shape, to any place: compares the rule with a check of the whole mesh. */
static void compare_embedding(starg_context *context, shape *s, uint64_t seed, size_t trials,
                              size_t *kept, size_t *broken) {
    starg_mesh *mesh = test_mesh_of(context, s);
    mesh_surface *surface;
    dynamic_bvh *tree;
    test_ok(context, surface_create(context, mesh, &surface));
    test_ok(context, dynamic_bvh_create(context, surface, &tree));
    for (size_t trial = 0; trial < trials; trial++) {
        starg_rng rng = starg_rng_make(seed, 4, trial);
        collapse_star star;
        double p[3];
        if (!collapse_gather(surface, (uint32_t)starg_rng_below(&rng, 3 * s->face_count), &star))
            continue;
        uint64_t step = starg_rng_below(&rng, 3); /* on a lattice, half a lattice, or free */
        double reach = starg_rng_unit(&rng) < 0.5 ? 1 : 3;
        for (int k = 0; k < 3; k++) {
            double middle = 0.5 * (surface_at(surface, star.a)[k] + surface_at(surface, star.b)[k]);
            p[k] = middle + reach * (starg_rng_unit(&rng) - 0.5);
            if (step > 0)
                p[k] = floor(p[k] * (double)step) / (double)step;
        }
        starg_mesh *result = collapsed(context, surface, &star, p);
        starg_check *check = check_of(context, result);
        assert_true(check->closed && check->manifold && check->oriented);
        assert_int_equal(collapse_keeps_embedding(surface, tree, &star, p), check->embedded);
        *(check->embedded ? kept : broken) += 1;
        starg_check_free(context, check);
        starg_mesh_free(result);
    }
    dynamic_bvh_free(tree);
    surface_free(surface);
    starg_mesh_free(mesh);
    shape_free(s);
}

static void test_embedding_against_the_check(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t kept = 0, broken = 0;
    for (uint64_t seed = 0; seed < 3; seed++) {
        shape shapes[] = {shape_blob(1, seed), shape_blob(2, seed), shape_cube(3),
                          shape_room(),        shape_columns(),     lens()};
        for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
            compare_embedding(context, &shapes[i], 10 * seed + i, 100, &kept, &broken);
    }
    assert_true(kept > 150);
    assert_true(broken > 150);
    test_context_free(context);
}

/* ---- shape ---- */

/* The largest distance of random points of a mesh from a solid. */
static double farthest(const starg_mesh *mesh, const starg_solid *solid, uint64_t seed) {
    double largest = 0;
    for (size_t i = 0; i < test_size(8000, 20000); i++) {
        starg_rng rng = starg_rng_make(seed, 2, i);
        const uint32_t *face =
            starg_mesh_faces(mesh) + 3 * starg_rng_below(&rng, starg_mesh_face_count(mesh));
        double u = starg_rng_unit(&rng), v = starg_rng_unit(&rng), p[3];
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        for (int k = 0; k < 3; k++) {
            const double *x = starg_mesh_vertices(mesh) + k;
            double a = x[3 * (size_t)face[0]], b = x[3 * (size_t)face[1]];
            p[k] = a + u * (b - a) + v * (x[3 * (size_t)face[2]] - a);
        }
        largest = fmax(largest, starg_solid_distance(solid, p));
    }
    return largest;
}

/* Both ways, within a part of the diagonal. */
static void expect_near(starg_context *context, const char *name, size_t vertices, size_t target,
                        double part) {
    starg_mesh *mesh = test_sample_mesh(context, name, vertices),
               *coarse = simplify(context, mesh, target);
    starg_solid *before, *after;
    test_ok(context, starg_solid_create(context, mesh, &before));
    test_ok(context, starg_solid_create(context, coarse, &after));
    assert_true(starg_solid_check(after)->embedded);
    double limit = part * starg_solid_check(before)->diagonal;
    double to = farthest(coarse, before, vertices), from = farthest(mesh, after, vertices);
    if (to > limit || from > limit)
        print_error("%s: %g and %g, at most %g\n", name, to, from, limit);
    assert_true(to <= limit && from <= limit);
    starg_solid_free(before);
    starg_solid_free(after);
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
}

static void test_the_surface_stays_near(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "torus", "gallery", "knot"};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        expect_near(context, names[i], 5000, 1000, 0.006);
    test_context_free(context);
}

/* Above 100,000 vertices errors are compared roughly. */
static void test_large_surfaces_stay_near(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    expect_near(context, "horse", test_size(108000, 130000), 101000, 4e-5);
    test_context_free(context);
}

static void test_large_targets_change_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "star", 500);
    size_t count = starg_mesh_vertex_count(mesh);
    for (int i = 0; i < 2; i++) {
        starg_mesh *same = simplify(context, mesh, i ? count : SIZE_MAX);
        assert_same_mesh(mesh, same);
        starg_mesh_free(same);
    }
    starg_mesh *less = simplify(context, mesh, count - 1);
    assert_int_equal(starg_mesh_vertex_count(less), count - 1);
    starg_mesh_free(less);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_same_bytes_for_any_thread_count(void **state) {
    (void)state;
    starg_context *one = test_context(1), *four = test_context(4);
    starg_mesh *a = test_sample_mesh(one, "horse", 3000),
               *b = test_sample_mesh(four, "horse", 3000);
    starg_mesh *x = simplify(one, a, 300), *y = simplify(four, b, 300), *z = simplify(one, b, 300);
    assert_same_mesh(x, y);
    assert_same_mesh(x, z);
    starg_mesh_free(x);
    starg_mesh_free(y);
    starg_mesh_free(z);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(one);
    test_context_free(four);
}

/* Powers of two change no digit: the same collapses at every size. */
static void test_size_does_not_matter(void **state) {
    (void)state;
    static const int exponents[] = {-900, -300, 300};
    starg_context *context = test_context(1);
    shape blob = shape_blob(3, 3);
    starg_mesh *mesh = test_mesh_of(context, &blob), *coarse = simplify(context, mesh, 60);
    size_t count = starg_mesh_vertex_count(coarse);
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        shape other = shape_blob(3, 3);
        shape_place(&other, ldexp(1, exponents[i]), 0);
        starg_mesh *scaled = test_mesh_of(context, &other), *result = simplify(context, scaled, 60);
        assert_int_equal(starg_mesh_vertex_count(result), count);
        assert_memory_equal(starg_mesh_faces(coarse), starg_mesh_faces(result),
                            3 * starg_mesh_face_count(coarse) * sizeof(uint32_t));
        for (size_t k = 0; k < 3 * count; k++)
            assert_true(starg_mesh_vertices(result)[k] ==
                        ldexp(starg_mesh_vertices(coarse)[k], exponents[i]));
        starg_mesh_free(result);
        starg_mesh_free(scaled);
        shape_free(&other);
    }
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
    shape_free(&blob);
    test_context_free(context);
}

/* At the ends of the range only the topology is checked. */
static void test_extreme_places(void **state) {
    (void)state;
    static const double places[][2] = {{1, 1e8}, {1e-3, 1e12}, {3e99, 0}, {1e-320, 0}, {0, 5}};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        shape blob = shape_blob(2, 5);
        shape_place(&blob, places[i][0], places[i][1]);
        starg_mesh *mesh = test_mesh_of(context, &blob), *coarse = simplify(context, mesh, 40);
        starg_check *check = check_of(context, coarse);
        assert_true(check->closed && check->manifold && check->oriented);
        assert_int_equal(check->genus, 0);
        starg_check_free(context, check);
        starg_mesh_free(coarse);
        starg_mesh_free(mesh);
        shape_free(&blob);
    }
    test_context_free(context);
}

static void test_crossing_input_keeps_its_topology(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape blob = shape_blob(3, 1), other = shape_blob(3, 2);
    shape_append(&blob, &other, (const double[3]){0.7, 0, 0}, 0);
    starg_mesh *mesh = test_mesh_of(context, &blob), *coarse = simplify(context, mesh, 0),
               *free_run;
    assert_same_topology(context, mesh, coarse, false);
    starg_simplify_options options = {.allow_intersections = true};
    test_ok(context, starg_mesh_simplify(context, mesh, 0, &options, NULL, &free_run));
    assert_same_topology(context, mesh, free_run, false);
    assert_int_equal(starg_mesh_vertex_count(free_run), 8);
    starg_mesh_free(free_run);
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
    shape_free(&blob);
    shape_free(&other);
    test_context_free(context);
}

/* ---- levels ---- */

static void test_levels(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "horse", 3600);
    static const size_t expected[] = {500, 1500, 2500};
    starg_levels *levels;
    test_ok(context, starg_mesh_levels(context, mesh, 500, 1000, NULL, &levels));
    assert_int_equal(levels->count, 4);
    assert_same_mesh(levels->levels[3].mesh, mesh);
    assert_null(levels->levels[3].vertex_map);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(starg_mesh_vertex_count(levels->levels[i].mesh), expected[i]);
        assert_same_topology(context, mesh, levels->levels[i].mesh, true);
        assert_map(levels->levels[i + 1].mesh, levels->levels[i].mesh,
                   levels->levels[i].vertex_map);
    }
    starg_mesh *direct = simplify(context, mesh, 500);
    assert_same_mesh(direct, levels->levels[0].mesh);
    starg_mesh_free(direct);
    starg_levels_free(context, levels);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* What is taken over from the finest level is what an examination of each finds. */
static void test_levels_are_solids(void **state) {
    static const char *const names[] = {"horse", "knot", "shell", "plate"};
    (void)state;
    starg_context *context = test_context(1);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        starg_solid *fine = test_sample(context, names[n], 3600), *known, *examined;
        starg_levels *levels;
        test_ok(context,
                starg_mesh_levels(context, starg_solid_mesh(fine), 500, 1000, NULL, &levels));
        assert_true(starg_solid_check(fine)->embedded);
        for (size_t i = 0; i < levels->count; i++) {
            test_ok(context, solid_of_level(context, fine, levels->levels[i].mesh, &known));
            test_ok(context, solid_make(context, levels->levels[i].mesh, &examined));
            starg_check a = *starg_solid_check(known), b = *starg_solid_check(examined);
            assert_same_mesh(starg_solid_mesh(known), starg_solid_mesh(examined));
            assert_true(fabs(a.area - b.area) <= 1e-12 * b.area);
            assert_true(fabs(a.volume - b.volume) <= 1e-12 * b.volume);
            a.area = b.area;
            a.volume = b.volume;
            assert_true(fabs(a.diagonal - b.diagonal) <= 1e-12 * b.diagonal);
            a.diagonal = b.diagonal;
            a.face_marks = b.face_marks = NULL;
            assert_memory_equal(&a, &b, offsetof(starg_check, findings));
            starg_solid_free(known);
            starg_solid_free(examined);
        }
        starg_levels_free(context, levels);
        starg_solid_free(fine);
    }
    test_context_free(context);
}

/* Each a quarter of the next finer one; the last clamped to the coarsest, if worthwhile. */
static void test_levels_by_quarters(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "horse", 3600);
    const size_t n = starg_mesh_vertex_count(mesh);
    const struct {
        size_t coarsest, count, vertices[4];
    } cases[] = {{100, 4, {100, n / 16, n / 4, n}},
                 {n / 16, 3, {n / 16, n / 4, n}},
                 {n / 16 + 1, 3, {n / 16 + 1, n / 4, n}},
                 {n / 4 - 10, 2, {n / 4, n}}, /* ten fewer do not make a level */
                 {n / 2, 2, {n / 2, n}},
                 {n - n / 8, 1, {n}},
                 {n, 1, {n}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_levels *levels;
        test_ok(context,
                starg_mesh_levels(context, mesh, cases[i].coarsest, STARG_QUARTERS, NULL, &levels));
        assert_int_equal(levels->count, cases[i].count);
        for (size_t k = 0; k < levels->count; k++)
            assert_int_equal(starg_mesh_vertex_count(levels->levels[k].mesh), cases[i].vertices[k]);
        for (size_t k = 0; k + 1 < levels->count; k++)
            assert_map(levels->levels[k + 1].mesh, levels->levels[k].mesh,
                       levels->levels[k].vertex_map);
        starg_levels_free(context, levels);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_levels_that_are_left_out(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "torus", 1000);
    size_t count = starg_mesh_vertex_count(mesh);
    const struct {
        size_t coarsest, step, levels;
    } cases[] = {{count, 10, 1},   {SIZE_MAX, 1, 1}, {count - 100, 404, 1}, {count - 100, 400, 2},
                 {0, SIZE_MAX, 1}, {0, count, 2},    {count - 10, 1, 11},   {500, SIZE_MAX, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_levels *levels;
        test_ok(context,
                starg_mesh_levels(context, mesh, cases[i].coarsest, cases[i].step, NULL, &levels));
        assert_int_equal(levels->count, cases[i].levels);
        assert_same_mesh(levels->levels[levels->count - 1].mesh, mesh);
        starg_levels_free(context, levels);
    }
    starg_levels *none = (starg_levels *)context;
    assert_int_equal(starg_mesh_levels(context, mesh, 10, 0, NULL, &none), STARG_ERROR_ARGUMENT);
    assert_null(none);
    starg_levels_free(context, NULL);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* ---- bad input ---- */

static void assert_refused(starg_context *context, const shape *s, const char *word) {
    starg_mesh *mesh = test_mesh_of(context, s), *coarse = mesh;
    starg_levels *levels = (starg_levels *)context;
    assert_int_equal(starg_mesh_simplify(context, mesh, 4, NULL, NULL, &coarse), STARG_ERROR_MESH);
    assert_null(coarse);
    assert_non_null(strstr(starg_context_error(context)->message, word));
    assert_int_equal(starg_mesh_levels(context, mesh, 4, 1, NULL, &levels), STARG_ERROR_MESH);
    assert_null(levels);
    starg_mesh_free(mesh);
}

static void test_other_meshes_are_refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(2), touching = shape_cells("#..#", 2, 2, 1);
    /* two cells that share one corner */
    shape corner = shape_cells("#......#", 2, 2, 2), empty = {0};
    assert_refused(context, &touching, "fan");
    assert_refused(context, &corner, "fan");
    assert_refused(context, &empty, "no faces");
    uint32_t *face = cube.faces + 3 * (cube.face_count - 1), first = face[0];
    face[0] = face[1];
    assert_refused(context, &cube, "");
    face[0] = first;
    cube.face_count--;
    assert_refused(context, &cube, "two faces");
    cube.face_count++;
    face[0] = face[1];
    face[1] = first;
    assert_refused(context, &cube, "same direction");
    shape_free(&cube);
    shape_free(&touching);
    shape_free(&corner);
    test_context_free(context);
}

static void test_vertices_of_no_face_go(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(1);
    uint32_t map[9];
    double vertices[27] = {5, 5, 5}; /* number 0 is isolated */
    memcpy(vertices + 3, cube.vertices, 24 * sizeof *vertices);
    for (size_t i = 0; i < 3 * cube.face_count; i++)
        cube.faces[i]++;
    starg_mesh *mesh, *coarse;
    starg_levels *levels;
    test_ok(context, starg_mesh_create(context, vertices, 9, cube.faces, cube.face_count, &mesh));
    test_ok(context, starg_mesh_simplify(context, mesh, 8, NULL, map, &coarse));
    assert_int_equal(starg_mesh_vertex_count(coarse), 8);
    assert_true(map[0] == STARG_NO_VERTEX);
    for (uint32_t v = 1; v < 9; v++)
        assert_int_equal(map[v], v - 1);
    test_ok(context, starg_mesh_levels(context, mesh, 5, 4, NULL, &levels));
    assert_int_equal(levels->count, 2);
    assert_true(levels->levels[0].vertex_map[0] == STARG_NO_VERTEX);
    starg_levels_free(context, levels);
    starg_mesh_free(coarse);
    starg_mesh_free(mesh);
    shape_free(&cube);
    test_context_free(context);
}

static void test_it_can_be_stopped(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "torus", 1000), *coarse = mesh;
    starg_levels *levels = (starg_levels *)context;
    starg_context_cancel(context);
    assert_int_equal(starg_mesh_simplify(context, mesh, 4, NULL, NULL, &coarse),
                     STARG_ERROR_CANCELLED);
    assert_null(coarse);
    assert_int_equal(starg_mesh_levels(context, mesh, 4, 100, NULL, &levels),
                     STARG_ERROR_CANCELLED);
    assert_null(levels);
    starg_context_reset(context);
    starg_context_set_time_limit(context, 1e-9);
    assert_int_equal(starg_mesh_simplify(context, mesh, 4, NULL, NULL, &coarse), STARG_ERROR_TIME);
    assert_null(coarse);
    starg_context_set_time_limit(context, 0);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* ---- memory that runs out ---- */

static void test_every_allocation_fails_once(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(0, &left);
    shape blob = shape_blob(2, 1);
    starg_mesh *mesh = test_mesh_of(context, &blob), *coarse;
    starg_levels *levels;
    size_t before = starg_context_live_blocks(context), failures = 0;
    for (;; failures++) {
        left = failures;
        starg_status status = starg_mesh_simplify(context, mesh, 0, NULL, NULL, &coarse);
        if (status == STARG_OK)
            break;
        assert_int_equal(status, STARG_ERROR_MEMORY);
        assert_null(coarse);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(failures > 30); /* including those of rebuilt trees */
    starg_mesh_free(coarse);
    for (failures = 0;; failures++) {
        left = failures;
        starg_status status = starg_mesh_levels(context, mesh, 10, 20, NULL, &levels);
        if (status == STARG_OK)
            break;
        assert_int_equal(status, STARG_ERROR_MEMORY);
        assert_null(levels);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(failures > 60);
    left = SIZE_MAX;
    starg_levels_free(context, levels);
    starg_mesh_free(mesh);
    shape_free(&blob);
    test_context_free(context);
}

/* ---- the queue ---- */

/* Against a table searched linearly. */
static void test_heap_against_a_table(void **state) {
    (void)state;
    enum { ITEMS = 50 };
    double key[ITEMS];
    bool in[ITEMS] = {false};
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(1, 3, 0);
    mesh_heap *heap;
    test_ok(context, heap_create(context, ITEMS, &heap));
    for (size_t step = 0; step < 20000; step++) {
        uint32_t item = (uint32_t)starg_rng_below(&rng, ITEMS), lowest = ITEMS, popped = ITEMS;
        switch (starg_rng_below(&rng, 4)) {
        case 0:
            for (uint32_t i = ITEMS; i-- > 0;)
                if (in[i] && (lowest == ITEMS || key[i] <= key[lowest]))
                    lowest = i;
            assert_int_equal(heap_pop(heap, &popped), lowest < ITEMS);
            assert_int_equal(popped, lowest);
            if (lowest < ITEMS)
                in[lowest] = false;
            break;
        case 1:
            heap_remove(heap, item);
            in[item] = false;
            break;
        default:
            key[item] = (double)starg_rng_below(&rng, 20); /* many ties */
            heap_set(heap, item, key[item]);
            in[item] = true;
        }
        for (uint32_t i = 0; i < ITEMS; i++)
            assert_int_equal(heap_contains(heap, i), in[i]);
    }
    heap_free(heap);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_stay_solids),
        cmocka_unit_test(test_lattices_stay_solids),
        cmocka_unit_test(test_flat_walls_cost_nothing),
        cmocka_unit_test(test_everything_shrinks_to_a_tetrahedron),
        cmocka_unit_test(test_shells_do_not_change_sides),
        cmocka_unit_test(test_shared_solids),
        cmocka_unit_test(test_shape_is_kept),
        cmocka_unit_test(test_embedding_against_the_check),
        cmocka_unit_test(test_the_surface_stays_near),
        cmocka_unit_test(test_large_surfaces_stay_near),
        cmocka_unit_test(test_large_targets_change_nothing),
        cmocka_unit_test(test_same_bytes_for_any_thread_count),
        cmocka_unit_test(test_size_does_not_matter),
        cmocka_unit_test(test_extreme_places),
        cmocka_unit_test(test_crossing_input_keeps_its_topology),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_levels_are_solids),
        cmocka_unit_test(test_levels_by_quarters),
        cmocka_unit_test(test_levels_that_are_left_out),
        cmocka_unit_test(test_other_meshes_are_refused),
        cmocka_unit_test(test_vertices_of_no_face_go),
        cmocka_unit_test(test_it_can_be_stopped),
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_heap_against_a_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
