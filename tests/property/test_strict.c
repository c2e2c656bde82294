/* SPDX-License-Identifier: Apache-2.0 */
/* Strict star decompositions of whole solids: each is verified independently, by rationals, and the
 * options keep their guarantees. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "starguard/decompose.h"
#include "starguard/sample.h"
#include "starguard/verify.h"
#include "tetrahedra.h"

/* STARGUARD_LONG: larger tetrahedral meshes. */
static bool thorough(void) {
    return test_rounds(1, 2) > 1;
}

static starg_decompose_options small_effort(uint64_t effort) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.effort = effort;
    return options;
}

static starg_decomposition *decompose(starg_context *context, const starg_solid *solid,
                                      const starg_decompose_options *options) {
    starg_decomposition *d = NULL;
    test_ok(context, starg_decompose(context, solid, options, &d));
    return d;
}

/* ---- the verifier ---- */

static void copy_result(const starg_decomposition *d, starg_pieces_mesh *mesh,
                        starg_pieces_report *report) {
    size_t points = 3 * starg_tetmesh_vertex_count(d->mesh), count = starg_tetmesh_count(d->mesh);
    *mesh = (starg_pieces_mesh){.vertex_count = points / 3,
                                .count = count,
                                .vertices = malloc(points * sizeof(double)),
                                .tetrahedra = malloc(4 * count * sizeof(uint32_t)),
                                .labels = d->labels};
    assert_non_null(mesh->vertices);
    assert_non_null(mesh->tetrahedra);
    memcpy(mesh->vertices, starg_tetmesh_vertices(d->mesh), points * sizeof(double));
    memcpy(mesh->tetrahedra, starg_tetmesh_tetrahedra(d->mesh), 4 * count * sizeof(uint32_t));
    *report = (starg_pieces_report){.mode = d->mode,
                                    .tetrahedra = count,
                                    .piece_count = d->piece_count,
                                    .pieces = d->pieces,
                                    .contact_count = d->contact_count,
                                    .contacts = d->contacts,
                                    .strictly_star = d->strictly_star,
                                    .visible_vertices = d->visible_vertices,
                                    .approximated = !d->tetra.surface_kept,
                                    .distance = d->tetra.to_surface + d->tetra.step,
                                    .distance_back = d->tetra.from_surface + d->tetra.step,
                                    .flattest = d->flattest};
}

/* Against a surface, or a tetrahedral mesh; the other one is NULL. */
static void check_verified(starg_context *context, const char *name, const starg_mesh *surface,
                           const starg_tetmesh *tetmesh, const starg_decomposition *d) {
    starg_pieces_mesh mesh;
    starg_pieces_report report;
    starg_verdict *verdict = NULL;
    copy_result(d, &mesh, &report);
    test_ok(context,
            surface != NULL
                ? starg_verify_pieces(context, surface, &mesh, &report, &verdict)
                : starg_verify_pieces_of_tetmesh(context, tetmesh, &mesh, &report, &verdict));
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_error("%s: %s\n", name, verdict->claims[i].text);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    free(mesh.vertices);
    free(mesh.tetrahedra);
    assert_int_equal(d->mode, STARG_DECOMPOSE_STRICT);
    assert_int_equal(d->strictly_star, d->piece_count);
    assert_true(d->visible_vertices == 1);
    assert_false(d->time_limited);
    assert_int_equal(starg_tetmesh_turned(d->mesh), 0);
    for (size_t i = 0; i < d->piece_count; i++)
        assert_true(d->pieces[i].star && d->pieces[i].radius > 0);
}

static void assert_same(const starg_decomposition *a, const starg_decomposition *b) {
    size_t points = starg_tetmesh_vertex_count(a->mesh), count = starg_tetmesh_count(a->mesh);
    assert_int_equal(points, starg_tetmesh_vertex_count(b->mesh));
    assert_int_equal(count, starg_tetmesh_count(b->mesh));
    assert_int_equal(a->piece_count, b->piece_count);
    assert_int_equal(a->contact_count, b->contact_count);
    assert_memory_equal(starg_tetmesh_vertices(a->mesh), starg_tetmesh_vertices(b->mesh),
                        24 * points);
    assert_memory_equal(starg_tetmesh_tetrahedra(a->mesh), starg_tetmesh_tetrahedra(b->mesh),
                        16 * count);
    assert_memory_equal(a->labels, b->labels, 4 * count);
    for (size_t i = 0; i < a->piece_count; i++) {
        assert_memory_equal(a->pieces[i].guard, b->pieces[i].guard, sizeof a->pieces[i].guard);
        assert_true(a->pieces[i].volume == b->pieces[i].volume);
        assert_true(a->pieces[i].radius == b->pieces[i].radius);
    }
    for (size_t i = 0; i < a->contact_count; i++) {
        assert_int_equal(a->contacts[i].first, b->contacts[i].first);
        assert_int_equal(a->contacts[i].second, b->contacts[i].second);
        assert_true(a->contacts[i].area == b->contacts[i].area);
    }
}

/* ---- samples ---- */

/* Verified; and the same bytes again with five threads. */
static void test_samples(void **state) {
    (void)state;
    starg_context *one = test_context(1), *five = test_context(5);
    const starg_decompose_options options = small_effort(64);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        const char *name = starg_sample_at(i)->name;
        starg_solid *solid = test_sample(one, name, 500);
        starg_decomposition *d = decompose(one, solid, &options);
        check_verified(one, name, starg_solid_mesh(solid), NULL, d);
        assert_true(d->tetra.surface_kept);
        starg_decomposition *again = decompose(five, solid, &options);
        assert_same(d, again);
        starg_decomposition_free(five, again);
        starg_decomposition_free(one, d);
        starg_solid_free(solid);
    }
    test_context_free(one);
    test_context_free(five);
}

/* Twice on one context, which keeps no state. */
static void test_runs(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const starg_decompose_options options = small_effort(128);
    starg_solid *solid = test_sample(context, "labyrinth", 500);
    starg_decomposition *first = decompose(context, solid, &options);
    starg_decomposition *second = decompose(context, solid, &options);
    assert_same(first, second);
    starg_decomposition_free(context, first);
    starg_decomposition_free(context, second);
    starg_solid_free(solid);
    test_context_free(context);
}

/* ---- shapes ---- */

static shape two_blobs(void) {
    static const double offset[3] = {10, 0, 0};
    shape s = shape_blob(1, 3), other = shape_room();
    shape_append(&s, &other, offset, 0);
    shape_free(&other);
    return s;
}

/* Four cubes: the second touches the first along an edge, the third in a vertex, the last in only a
 * part of an edge, unless `apart` is 2. */
static shape touching_cubes(double apart) {
    const double offsets[3][3] = {{2, 2, 0}, {-2, -2, -2}, {2, -2, apart}};
    shape s = shape_cube(2);
    for (int i = 0; i < 3; i++) {
        shape other = shape_cube(2);
        shape_append(&s, &other, offsets[i], 0);
        shape_free(&other);
    }
    return s;
}

typedef struct shape_case {
    const char *name;
    shape s;
    size_t least, most; /* pieces */
} shape_case;

/* Star-shaped solids are one piece, and separate components at least one each; with a cavity or a
 * column, no point sees everything. */
static void test_shapes(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape_case cases[] = {
        {"tetrahedron", shape_tetrahedron(), 1, 1}, {"cube", shape_cube(3), 1, 1},
        {"blob", shape_blob(2, 7), 1, 1},           {"room", shape_room(), 1, 2},
        {"two parts", two_blobs(), 2, 3},           {"cavity", shape_cavity(), 2, 4},
        {"columns", shape_columns(), 2, 40},        {"touching", touching_cubes(0), 4, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_solid *solid = test_solid_of(context, &cases[i].s);
        const starg_decompose_options options = small_effort(300);
        starg_decomposition *d = decompose(context, solid, &options);
        check_verified(context, cases[i].name, starg_solid_mesh(solid), NULL, d);
        assert_true(d->tetra.surface_kept);
        assert_in_range(d->piece_count, cases[i].least, cases[i].most);
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
        shape_free(&cases[i].s);
    }
    test_context_free(context);
}

/* If they touch otherwise than in common edges and vertices, the surface is not kept yet. */
static void test_other_contacts(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape s = touching_cubes(0.5);
    starg_solid *solid = test_solid_of(context, &s);
    const starg_decompose_options options = small_effort(20);
    starg_decomposition *d = decompose(context, solid, &options);
    assert_false(d->tetra.surface_kept);
    check_verified(context, "contacts", starg_solid_mesh(solid), NULL, d);
    starg_decomposition_free(context, d);
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* Any scale and any place: the room lies on a lattice, so scaling by powers of two gives the same
 * problem. */
static void test_scales(void **state) {
    (void)state;
    static const double scales[] = {1e-30, 1e30, 0x1p-100, 0x1p100, 1, 1e-3};
    static const double offsets[] = {0, 0, 0, 0, 1e6, 1e6};
    starg_context *context = test_context(1);
    const starg_decompose_options options = small_effort(100);
    size_t plain = 0;
    for (size_t i = 0; i <= sizeof scales / sizeof *scales; i++) {
        shape s = shape_room();
        if (i > 0)
            shape_place(&s, scales[i - 1], offsets[i - 1]);
        starg_solid *solid = test_solid_of(context, &s);
        starg_decomposition *d = decompose(context, solid, &options);
        check_verified(context, "scaled", starg_solid_mesh(solid), NULL, d);
        plain = i == 0 ? d->piece_count : plain;
        assert_true(d->piece_count <= plain + 2);
        if (i == 3 || i == 4)
            assert_int_equal(d->piece_count, plain);
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
        shape_free(&s);
    }
    test_context_free(context);
}

/* Star-shaped is star-shaped in whatever way a solid is pressed: as few pieces however thin it is,
 * but for what the search finds by chance. */
static void test_pressed(void **state) {
    (void)state;
    static const double factors[] = {1, 0x1p-35, 0x1p-60};
    starg_context *context = test_context(1);
    const starg_decompose_options options = small_effort(100);
    size_t counts[3];
    for (size_t i = 0; i < 3; i++) {
        shape s = shape_columns();
        for (size_t v = 0; v < s.vertex_count; v++)
            s.vertices[3 * v + 1] *= factors[i];
        starg_solid *solid = test_solid_of(context, &s);
        starg_decomposition *d = decompose(context, solid, &options);
        check_verified(context, "pressed", starg_solid_mesh(solid), NULL, d);
        assert_true(d->tetra.surface_kept);
        counts[i] = d->piece_count;
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
        shape_free(&s);
    }
    print_message("pieces: %zu, pressed %zu, %zu\n", counts[0], counts[1], counts[2]);
    for (size_t i = 1; i < 3; i++)
        assert_true(counts[i] <= counts[0] + 1);
    test_context_free(context);
}

/* ---- options ---- */

/* More effort never gives more pieces, because the search continues the same path; max_pieces ends
 * it as soon as the number is reached, and hints do not affect correctness. */
static void test_options(void **state) {
    (void)state;
    static const uint64_t efforts[] = {1, 64, 256, 1024};
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "labyrinth", 500);
    size_t most = SIZE_MAX, first = 0, last = 0;
    for (size_t i = 0; i < sizeof efforts / sizeof *efforts; i++) {
        const starg_decompose_options options = small_effort(efforts[i]);
        starg_decomposition *d = decompose(context, solid, &options);
        assert_true(d->piece_count <= most);
        most = last = d->piece_count;
        first = i == 0 ? last : first;
        starg_decomposition_free(context, d);
    }
    assert_true(last < first);
    starg_decompose_options options = small_effort(1024);
    options.max_pieces = first;
    starg_decomposition *d = decompose(context, solid, &options);
    check_verified(context, "max_pieces", starg_solid_mesh(solid), NULL, d);
    assert_int_equal(d->piece_count, first); /* no more is done than needed */
    starg_decomposition_free(context, d);
    options.max_pieces = last;
    d = decompose(context, solid, &options);
    assert_int_equal(d->piece_count, last);
    double hints[3 * 64];
    size_t count = 0;
    for (; count < d->piece_count && count < 64; count++)
        memcpy(hints + 3 * count, d->pieces[count].guard, 3 * sizeof *hints);
    starg_decomposition_free(context, d);
    options = small_effort(64);
    options.guards = hints;
    options.guard_count = count;
    d = decompose(context, solid, &options);
    check_verified(context, "hints", starg_solid_mesh(solid), NULL, d);
    starg_decomposition_free(context, d);
    starg_solid_free(solid);
    test_context_free(context);
}

/* With no time at all the first start is the result, which reports this, even if it has no more
 * pieces than wanted: possible joins are not made. If tetrahedra must be made first, there is no
 * result. */
static void test_time(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "labyrinth", 500);
    starg_decomposition *d = NULL;
    starg_decompose_options options = small_effort(64);
    for (size_t most = 0; most <= 1000; most += 1000) {
        options.max_pieces = most;
        starg_context_set_time_limit(context, 1e-9);
        d = decompose(context, solid, &options);
        assert_true(d->time_limited && d->tetra.surface_kept);
        assert_int_equal(d->strictly_star, d->piece_count);
        starg_decomposition_free(context, d);
    }
    options.mode = STARG_DECOMPOSE_PAPER;
    starg_context_set_time_limit(context, 1e-9);
    assert_int_equal(starg_decompose(context, solid, &options, &d), STARG_ERROR_TIME);
    assert_null(d);
    starg_solid_free(solid);
    test_context_free(context);
}

/* ---- tetrahedral meshes ---- */

static void check_tetmesh(starg_context *context, const char *name, const starg_tetmesh *mesh,
                          uint64_t effort) {
    starg_decompose_options options = small_effort(effort);
    starg_decomposition *d = NULL;
    test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
    check_verified(context, name, NULL, mesh, d);
    assert_true(d->tetra.surface_kept);
    assert_int_equal(d->model_tetrahedra, starg_tetmesh_count(mesh));
    starg_decomposition_free(context, d);
}

/* Delaunay tetrahedra with holes: edges and vertices where parts of the solid only touch. */
static void test_random_tetrahedra(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (uint64_t seed = 0; seed < (thorough() ? 24 : 15); seed++) {
        starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + 2 * seed, seed % 3 == 1, 1);
        check_tetmesh(context, "random", mesh, thorough() ? 100 : 20);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

static void test_shared_tetrahedra(void **state) {
    (void)state;
    static const char *const names[] = {"av_bird.mesh",
                                        "av_bone.mesh",
                                        "av_duck.mesh",
                                        "av_kitten.mesh",
                                        "bunny.mesh",
                                        "hand.mesh",
                                        "sdb_object.vtk",
                                        "decimated-knight.mesh",
                                        "galaxy_rockerarm291.vtk",
                                        "octopus-low.mesh",
                                        "sdm_open.vtk",
                                        "sdm_thumb.vtk"};
    const char *data = test_shared_data();
    char path[4300];
    starg_tetmesh *mesh = NULL;
    if (data == NULL)
        skip();
    starg_context *context = test_context(2);
    for (size_t i = 0; i < sizeof names / sizeof *names; i += test_size(2, 1)) {
        snprintf(path, sizeof path, "%s/tet/%s", data, names[i]);
        test_ok(context, starg_tetmesh_read(context, path, &mesh));
        check_tetmesh(context, names[i], mesh, 1);
        starg_tetmesh_free(mesh);
    }
    snprintf(path, sizeof path, "%s/tet/av_dog_folded.mesh", data);
    assert_int_equal(starg_tetmesh_read(context, path, &mesh), STARG_ERROR_MESH);
    test_context_free(context);
}

/* ---- failures ---- */

static void test_cancelled(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = random_tetmesh(context, 3, 50, false, 1);
    const starg_decompose_options options = small_effort(100);
    starg_decomposition *d = NULL;
    starg_context_cancel(context);
    assert_int_equal(starg_decompose_tetmesh(context, mesh, &options, &d), STARG_ERROR_CANCELLED);
    assert_null(d);
    starg_context_reset(context);
    test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
    starg_decomposition_free(context, d);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* Memory runs out at later and later places. */
static void test_memory(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    size_t failures = 0;
    for (size_t ration = 0; status != STARG_OK; ration += 1 + ration / 10, failures++) {
        size_t left = SIZE_MAX;
        starg_context *context = test_scarce_context(1, &left);
        starg_tetmesh *mesh = random_tetmesh(context, 6, 24, false, 1);
        starg_decompose_options options = small_effort(32);
        starg_decomposition *d = NULL;
        left = ration;
        status = starg_decompose_tetmesh(context, mesh, &options, &d);
        if (status != STARG_OK) {
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_null(d);
        }
        starg_decomposition_free(context, d);
        starg_tetmesh_free(mesh);
        test_context_free(context);
    }
    assert_true(failures > 25);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_other_contacts),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_pressed),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_time),
        cmocka_unit_test(test_random_tetrahedra),
        cmocka_unit_test(test_shared_tetrahedra),
        cmocka_unit_test(test_cancelled),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
