/* SPDX-License-Identifier: Apache-2.0 */
/* All engines, and all ISA variants of the grid, against visibility by definition (the oracle). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/bits.h"
#include "core/rng.h"
#include "geometry/predicates.h"
#include "models.h"
#include "starguard/sample.h"
#include "starguard/visibility.h"
#include "visibility/contours.h"
#include "visibility/grid.h"
#include "visibility_oracle.h"

/* Points inside: random ones, and means of a few vertices, which lie in many face planes. */
static const scene_view around = {0};

static size_t pick_points(const starg_solid *solid, size_t wanted, uint64_t seed, double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    double lower[3], upper[3];
    size_t count = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (uint64_t attempt = 0; attempt < 400 * wanted && count < wanted; attempt++) {
        starg_rng rng = starg_rng_make(seed, 11, attempt);
        double p[3];
        size_t a = starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        size_t b = starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        for (size_t k = 0; k < 3; k++) {
            if (attempt % 2)
                p[k] = 0.5 * (v[3 * a + k] + v[3 * b + k]);
            else
                p[k] = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(&rng);
        }
        if (starg_solid_contains(solid, p))
            memcpy(points + 3 * count++, p, sizeof p);
    }
    return count;
}

static void compare_row(const char *name, const char *what, const starg_bits *bits, size_t row,
                        const bool *expected) {
    for (size_t j = 0; j < starg_bits_columns(bits); j++)
        if (starg_bits_test(bits, row, j) != expected[j]) {
            print_error("%s, %s, point %zu: column %zu is %d, by definition %d\n", name, what, row,
                        j, !expected[j], expected[j]);
            fail();
        }
}

static void check_engines(starg_context *context, const char *name, const starg_solid *solid,
                          const double *points, size_t count) {
    static const char *const engines[] = {"grid", "bvh", "sweep", "contours", "fastest"};
    const starg_mesh *mesh = starg_solid_mesh(solid);
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    bool *expected = malloc(3 * count * (n + m) * sizeof *expected);
    bool *vertices = expected, *faces = vertices + count * n, *whole = faces + count * m;
    assert_non_null(expected);
    size_t whole_count = m > 300 && count > 1 ? 1 : count; /* the oracle is slow */
    for (size_t i = 0; i < count; i++) {
        visibility_oracle_vertices(starg_mesh_vertices(mesh), n, starg_mesh_faces(mesh), m,
                                   points + 3 * i, vertices + i * n);
        visibility_oracle_faces(starg_mesh_vertices(mesh), n, starg_mesh_faces(mesh), m,
                                points + 3 * i, false, faces + i * m);
        if (i < whole_count)
            visibility_oracle_faces(starg_mesh_vertices(mesh), n, starg_mesh_faces(mesh), m,
                                    points + 3 * i, true, whole + i * m);
    }
    for (int engine = 0; engine < 5; engine++)
        for (int what = 0; what < 3; what++) {
            starg_visibility_options options;
            starg_bits *bits = NULL;
            starg_visibility_options_default(&options);
            options.engine = (starg_visibility_engine)engine;
            options.target = what == 0 ? STARG_TARGET_VERTICES : STARG_TARGET_FACES;
            options.face_rule = what == 2 ? STARG_FACES_WHOLE : STARG_FACES_VERTICES;
            size_t rows = what == 2 ? whole_count : count;
            test_ok(context, starg_visibility(context, solid, points, rows, &options, &bits));
            for (size_t i = 0; i < rows; i++)
                compare_row(name, engines[engine], bits, i,
                            what == 0   ? vertices + i * n
                            : what == 1 ? faces + i * m
                                        : whole + i * m);
            starg_bits_free(bits);
        }
    free(expected);
}

static void check_mesh(starg_context *context, const char *name, const starg_mesh *mesh,
                       size_t points) {
    starg_solid *solid = NULL;
    double *p = malloc(3 * points * sizeof *p);
    assert_non_null(p);
    if (starg_solid_create(context, mesh, &solid) == STARG_OK)
        check_engines(context, name, solid, p, pick_points(solid, points, 5, p));
    starg_solid_free(solid);
    free(p);
}

static void test_samples(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        const char *name = starg_sample_at(i)->name;
        starg_mesh *mesh = test_sample_mesh(context, name, 500);
        check_mesh(context, name, mesh, 2);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* Flat, self-intersecting, touching, with cavities: many signs are zero. */
static void test_shared(void **state) {
    static const char *const files[] = {"cad/cross.off",
                                        "cad/crown.off",
                                        "cad/letter_p.off",
                                        "cad/three_torus.off",
                                        "cad/rooms_bldg010.off",
                                        "cad/u.off",
                                        "cad/star.off",
                                        "cad/wall_window.off",
                                        "cad/cube_notch.off",
                                        "cad/anchor.off",
                                        "cad/part.off",
                                        "nasty/two_cubes_1.obj",
                                        "nasty/rot_seven_cubes.obj",
                                        "nasty/two_spheres.obj",
                                        "nasty/comments.off",
                                        "solids/eight.off",
                                        "table2/kitten_400.off"};
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(2);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[4200];
        starg_mesh *mesh = NULL;
        snprintf(path, sizeof path, "%s/%s", data, files[i]);
        test_ok(context, starg_mesh_read(context, path, &mesh));
        check_mesh(context, files[i], mesh, 4);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* A box with every side divided into squares on a lattice: most segments to its vertices lie in
 * planes. */
static starg_mesh *make_lattice_box(starg_context *context, uint32_t steps, double scale,
                                    double shift) {
    uint32_t side = steps + 1, count = side * side * side, *index = calloc(count, sizeof *index);
    double *vertices = malloc(3 * count * sizeof *vertices);
    uint32_t *faces = malloc(36 * (size_t)steps * steps * sizeof *faces), used = 0, n = 0;
    assert_true(index && vertices && faces);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t c[3] = {i % side, i / side % side, i / side / side};
        bool border = false;
        for (int k = 0; k < 3; k++)
            border = border || c[k] == 0 || c[k] == steps;
        if (!border)
            continue;
        index[i] = used;
        for (uint32_t k = 0; k < 3; k++)
            vertices[3 * used + k] = scale * c[k] + shift;
        used++;
    }
    for (uint32_t axis = 0; axis < 3; axis++)
        for (uint32_t end = 0; end < 2; end++)
            for (uint32_t i = 0; i < steps * steps; i++) {
                uint32_t stride[3] = {1, side, side * side};
                uint32_t u = stride[(axis + 1) % 3], v = stride[(axis + 2) % 3];
                uint32_t at = end * steps * stride[axis] + i % steps * u + i / steps * v;
                uint32_t quad[4] = {at, at + u, at + u + v, at + v};
                static const int out[2][6] = {{0, 2, 1, 0, 3, 2}, {0, 1, 2, 0, 2, 3}};
                for (int k = 0; k < 6; k++)
                    faces[n++] = index[quad[out[end][k]]];
            }
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, vertices, used, faces, n / 3, &mesh));
    free(index);
    free(vertices);
    free(faces);
    return mesh;
}

static void test_lattice_boxes(void **state) {
    static const double scales[] = {1, 1e-90, 1e90, 0x1p-298};
    (void)state;
    starg_context *context = test_context(2);
    for (size_t i = 0; i < 4; i++) {
        starg_mesh *mesh = make_lattice_box(context, 5, scales[i], i == 0 ? 1e8 : 0);
        check_mesh(context, "lattice box", mesh, i < 3 ? 4 : 2);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* A sample, its scene, and data for querying single points. */
typedef struct isa_case {
    starg_context *context;
    starg_mesh *mesh;
    starg_solid *solid;
    visibility_scene *scene;
    double points[3 * 20];
    size_t count;
    int8_t *side;
    uint8_t *plain, *wide;
} isa_case;

/* The sample scaled by axis and moved. */
static void make_scaled_case(const char *name, const double scale[4], isa_case *c) {
    *c = (isa_case){.context = test_context(1)};
    c->mesh = test_sample_mesh(c->context, name, 3000);
    for (size_t i = 0; i < 3 * c->mesh->vertex_count; i++)
        c->mesh->vertices[i] = c->mesh->vertices[i] * scale[i % 3] + scale[3];
    test_ok(c->context, starg_solid_create(c->context, c->mesh, &c->solid));
    test_ok(c->context, scene_create(c->context, c->solid, &c->scene));
    test_ok(c->context, scene_add_adjacency(c->scene));
    assert_non_null(c->scene->adjacency);
    c->count = pick_points(c->solid, 20, 9, c->points);
    assert_true(c->count > 0);
    c->side = malloc(c->scene->face_count);
    c->plain = malloc(c->scene->vertex_count);
    c->wide = malloc(c->scene->vertex_count);
    assert_true(c->side && c->plain && c->wide);
}

static void make_isa_case(const char *name, isa_case *c) {
    make_scaled_case(name, (const double[4]){1, 1, 1, 0}, c);
}

static void free_isa_case(isa_case *c) {
    free(c->side);
    free(c->plain);
    free(c->wide);
    scene_free(c->scene);
    starg_solid_free(c->solid);
    starg_mesh_free(c->mesh);
    test_context_free(c->context);
}

/* Single sight lines, down a tree in single precision and past planes, against the engine that asks
 * every face that a segment may meet; also of a model that is flat, tiny and far from the origin.
 */
static void test_single_sights(void **state) {
    static const double SCALES[][4] = {{1, 1, 1, 0}, {1, 1e-5, 1, 0}, {1e-6, 1e-6, 1e-6, 1e-3}};
    (void)state;
    for (size_t k = 0; k < sizeof SCALES / sizeof *SCALES; k++) {
        isa_case c;
        size_t seen = 0, hidden = 0;
        starg_visibility_options all;
        starg_visibility_options_default(&all);
        all.target = STARG_TARGET_VERTICES;
        make_scaled_case("octopus", SCALES[k], &c);
        test_ok(c.context, scene_add_sights(c.scene));
        for (size_t i = 0; i < c.count; i++) {
            const double *p = c.points + 3 * i;
            scene_sides(c.scene, p, NULL, c.side);
            visibility_tree.find(c.scene, NULL, p, c.side, &around, c.plain);
            for (uint32_t slot = 0; slot < c.scene->vertex_count; slot++) {
                bool sees = scene_sees_vertex(c.scene, p, slot, &all);
                assert_int_equal(sees, c.plain[slot]);
                seen += sees;
                hidden += !sees;
            }
        }
        assert_true(seen > 1000 && hidden > 1000);
        free_isa_case(&c);
    }
}

/* Sides of places far from the solid, nearly in planes of its faces. */
static void test_sides_far_away(void **state) {
    (void)state;
    isa_case c;
    size_t inner = 0, outer = 0;
    make_isa_case("octopus", &c);
    for (size_t i = 0; i < 40; i++) {
        const double *a = scene_corner(c.scene, 7 * i, 0), *b = scene_corner(c.scene, 7 * i, 1);
        double p[3], times = pow(10, 1 + (double)(i % 8));
        for (int k = 0; k < 3; k++)
            p[k] = a[k] + times * (b[k] - a[k]);
        scene_sides(c.scene, p, NULL, c.side);
        for (size_t rank = 0; rank < c.scene->face_count; rank++) {
            assert_int_equal(c.side[rank], orient3d(scene_corner(c.scene, rank, 0),
                                                    scene_corner(c.scene, rank, 1),
                                                    scene_corner(c.scene, rank, 2), p));
            inner += c.side[rank] > 0;
            outer += c.side[rank] < 0;
        }
    }
    assert_true(inner > 1000 && outer > 1000);
    free_isa_case(&c);
}

/* The stages for each instruction set of the processor: the same bits. */
static void test_grid_isa(void **state) {
    (void)state;
    isa_case c;
    void *scratch = NULL;
    make_isa_case(starg_sample_at(0)->name, &c);
    assert_int_equal(visibility_grid.make_scratch(c.scene, &scratch), STARG_OK);
    grid_scratch *grid = scratch;
    for (size_t i = 0; i < c.count; i++) {
        scene_sides(c.scene, c.points + 3 * i, NULL, c.side);
        for (int isa = ISA_PLAIN; isa <= ISA_WIDEST; isa++) {
            grid->run = grid_choose_variant((visibility_isa)isa);
            if (grid->run == NULL)
                continue;
            uint8_t *out = isa == ISA_PLAIN ? c.plain : c.wide;
            visibility_grid.find(c.scene, scratch, c.points + 3 * i, c.side, &around, out);
            if (isa != ISA_PLAIN)
                assert_memory_equal(c.plain, c.wide, c.scene->vertex_count);
        }
    }
    visibility_grid.free_scratch(c.scene, scratch);
    free_isa_case(&c);
}

/* Likewise; and contours decide by themselves, without the grid, except at special points. */
static void test_contours_isa(void **state) {
    (void)state;
    isa_case c;
    void *scratch = NULL;
    size_t decided = 0;
    make_isa_case(starg_sample_at(0)->name, &c);
    assert_int_equal(visibility_contours.make_scratch(c.scene, &scratch), STARG_OK);
    contours_scratch *s = scratch;
    for (size_t i = 0; i < c.count; i++) {
        const double *p = c.points + 3 * i;
        scene_sides(c.scene, p, NULL, c.side);
        visibility_grid.find(c.scene, s->grid, p, c.side, &around, c.plain);
        bool answers = contours_plain.run(c.scene, s, p, c.side, c.wide);
        decided += answers;
        if (answers)
            assert_memory_equal(c.plain, c.wide, c.scene->vertex_count);
        for (int isa = ISA_PLAIN + 1; isa <= ISA_WIDEST; isa++) {
            const contours_variant *chosen = contours_choose_variant((visibility_isa)isa);
            if (chosen == NULL)
                continue;
            assert_int_equal(chosen->run(c.scene, s, p, c.side, c.wide), answers);
            if (answers)
                assert_memory_equal(c.plain, c.wide, c.scene->vertex_count);
        }
    }
    assert_true(2 * decided >= c.count);
    visibility_contours.free_scratch(c.scene, scratch);
    free_isa_case(&c);
}

/* Both engines are chosen for some points of the samples, and give the same bits. */
static void test_fastest(void **state) {
    (void)state;
    size_t by_contours = 0, count = 0;
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        isa_case c;
        void *scratch = NULL;
        make_isa_case(starg_sample_at(i)->name, &c);
        assert_int_equal(visibility_fastest.make_scratch(c.scene, &scratch), STARG_OK);
        contours_scratch *s = scratch;
        for (size_t k = 0; k < c.count; k++) {
            const double *p = c.points + 3 * k;
            scene_sides(c.scene, p, NULL, c.side);
            visibility_grid.find(c.scene, s->grid, p, c.side, &around, c.plain);
            s->decided = false;
            visibility_fastest.find(c.scene, scratch, p, c.side, &around, c.wide);
            assert_memory_equal(c.plain, c.wide, c.scene->vertex_count);
            by_contours += s->decided;
        }
        count += c.count;
        visibility_fastest.free_scratch(c.scene, scratch);
        free_isa_case(&c);
    }
    assert_in_range(by_contours, 1, count - 1);
}

static void test_arguments(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = make_lattice_box(context, 2, 1, 0);
    starg_solid *solid = NULL;
    starg_bits *bits = NULL;
    starg_visibility_options options;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    const double outside[] = {5, 5, 5, 0, 1, 1, 1, 1, 1};
    test_ok(context, starg_visibility(context, solid, outside, 3, NULL, &bits));
    assert_int_equal(starg_bits_count(bits, 0), 0);
    assert_int_equal(starg_bits_count(bits, 1), 0); /* on the surface */
    assert_int_equal(starg_bits_count(bits, 2), starg_mesh_face_count(mesh));
    starg_bits_free(bits);

    starg_visibility_options_default(&options);
    options.range = 1; /* reaches the centres of the six sides, but no whole face */
    options.target = STARG_TARGET_VERTICES;
    test_ok(context, starg_visibility(context, solid, outside + 6, 1, &options, &bits));
    assert_int_equal(starg_bits_count(bits, 0), 6);
    starg_bits_free(bits);
    options.range = -1;
    assert_int_equal(starg_visibility(context, solid, outside, 1, &options, &bits),
                     STARG_ERROR_ARGUMENT);
    assert_null(bits);
    const double bad[] = {1, NAN, 1};
    assert_int_equal(starg_visibility(context, solid, bad, 1, NULL, &bits), STARG_ERROR_ARGUMENT);
    assert_int_equal(starg_context_error(context)->element, STARG_ELEMENT_CANDIDATE);
    starg_context_cancel(context);
    assert_int_equal(starg_visibility(context, solid, outside, 3, NULL, &bits),
                     STARG_ERROR_CANCELLED);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples),       cmocka_unit_test(test_shared),
        cmocka_unit_test(test_single_sights), cmocka_unit_test(test_lattice_boxes),
        cmocka_unit_test(test_grid_isa),      cmocka_unit_test(test_contours_isa),
        cmocka_unit_test(test_fastest),       cmocka_unit_test(test_sides_far_away),
        cmocka_unit_test(test_arguments)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
