/* SPDX-License-Identifier: Apache-2.0 */
/* Both ends of a morph cut into the same pieces: checks the guarantees on the results alone. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "decomposition_oracle.h"
#include "models.h"
#include "tetrahedra.h"

enum { VERTICES = 500 };

static bool has_tetgen(void) {
    bool found = system("command -v tetgen >/dev/null 2>&1") == 0;
    if (!found)
        printf("skipped: the program tetgen is not installed\n");
    return found;
}

static void free_both(starg_context *context, starg_decomposition *out[2]) {
    starg_decomposition_free(context, out[0]);
    starg_decomposition_free(context, out[1]);
}

/* The boundary of the tetrahedra is the surface, which cuts may subdivide. */
static void check_boundary(starg_context *context, const starg_decomposition *d,
                           const starg_mesh *a, const double *positions) {
    starg_mesh *surface;
    test_ok(context, starg_tetmesh_surface(context, d->mesh, &surface, NULL));
    assert_subdivides(surface, a, positions);
    double volume = starg_mesh_volume(surface);
    assert_true(fabs(starg_tetmesh_volume(d->mesh) - volume) < 1e-9 * volume);
    starg_mesh_free(surface);
}

static void check(starg_context *context, starg_decomposition *const out[2], const starg_mesh *a,
                  const double *images) {
    size_t count = starg_tetmesh_count(out[0]->mesh);
    assert_int_equal(starg_tetmesh_count(out[1]->mesh), count);
    assert_memory_equal(starg_tetmesh_tetrahedra(out[0]->mesh),
                        starg_tetmesh_tetrahedra(out[1]->mesh), 4 * count * sizeof(uint32_t));
    assert_memory_equal(out[0]->labels, out[1]->labels, count * sizeof *out[0]->labels);
    for (int end = 0; end < 2; end++) {
        decomposition_oracle_check(out[end]);
        assert_int_equal(out[end]->strictly_star, out[end]->piece_count);
        assert_int_equal(starg_tetmesh_turned(out[end]->mesh), 0);
        assert_int_equal(out[end]->model_faces, starg_mesh_face_count(a));
        check_boundary(context, out[end], a, end == 0 ? starg_mesh_vertices(a) : images);
    }
}

/* ---- tests ---- */

static void test_poses(void **state) {
    (void)state;
    static const char *const names[] = {"cat", "dog"};
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1), *many = test_context(3);
    for (size_t i = 0; i < test_rounds(1, sizeof names / sizeof *names); i++) {
        starg_mesh *a = test_pose(context, names[i], 0, VERTICES),
                   *b = test_pose(context, names[i], 1, VERTICES);
        starg_morph *one = test_morph(context, a, starg_mesh_vertices(b), STARG_MORPH_STAR);
        starg_morph *three = test_morph(many, a, starg_mesh_vertices(b), STARG_MORPH_STAR);
        starg_decomposition *pieces[2], *same[2];
        test_ok(context, starg_morph_solids(one, pieces));
        test_ok(many, starg_morph_solids(three, same));
        check(context, pieces, a, starg_mesh_vertices(b));
        assert_int_equal(pieces[0]->piece_count, same[0]->piece_count);
        assert_memory_equal(pieces[1]->pieces, same[1]->pieces,
                            same[1]->piece_count * sizeof *same[1]->pieces);
        free_both(context, pieces);
        free_both(many, same);
        starg_morph_free(one);
        starg_morph_free(three);
        starg_mesh_free(a);
        starg_mesh_free(b);
    }
    test_context_free(context);
    test_context_free(many);
}

/* A shape that is convex at both ends is one piece. */
static void test_convex(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "sphere", VERTICES);
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *images = malloc(size * sizeof *images);
    assert_non_null(images);
    for (size_t i = 0; i < size; i++)
        images[i] = starg_mesh_vertices(a)[i] * (i % 3 == 0 ? 3 : 1);
    starg_morph *morph = test_morph(context, a, images, STARG_MORPH_LINEAR);
    starg_decomposition *out[2];
    test_ok(context, starg_morph_solids(morph, out));
    check(context, out, a, images);
    assert_int_equal(out[0]->piece_count, 1);
    free_both(context, out);
    starg_morph_free(morph);
    starg_mesh_free(a);
    free(images);
    test_context_free(context);
}

static void expect(starg_context *context, const starg_mesh *a, const double *images,
                   const char *says) {
    starg_morph *morph = test_morph(context, a, images, STARG_MORPH_LINEAR);
    starg_decomposition *out[2];
    assert_int_equal(starg_morph_solids(morph, out), STARG_ERROR_MESH);
    assert_null(out[0]);
    assert_null(out[1]);
    if (strstr(starg_context_error(context)->message, says) == NULL)
        fail_msg("'%s' is not in '%s'", says, starg_context_error(context)->message);
    starg_morph_free(morph);
}

/* A beam bent by 172 degrees and by 206; the straight path to the latter self-intersects. */
static void test_bent(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    char cells[2 * 2 * 16];
    memset(cells, '#', sizeof cells);
    shape s = shape_cells(cells, 2, 2, 16);
    starg_mesh *a = test_mesh_of(context, &s);
    double *images = malloc(3 * starg_mesh_vertex_count(a) * sizeof *images);
    assert_non_null(images);
    for (int i = 0; i < 2; i++) {
        double angle = 3 + 0.6 * i;
        for (size_t v = 0; v < starg_mesh_vertex_count(a); v++) {
            const double *p = starg_mesh_vertices(a) + 3 * v;
            double radius = 16 / angle - p[0] + 1, turn = angle * p[2] / 16;
            images[3 * v] = -radius * cos(turn);
            images[3 * v + 1] = p[1];
            images[3 * v + 2] = radius * sin(turn);
        }
        starg_morph *morph = test_morph(context, a, images, STARG_MORPH_STAR);
        starg_decomposition *out[2];
        test_ok(context, starg_morph_solids(morph, out));
        check(context, out, a, images);
        free_both(context, out);
        starg_morph_free(morph);
    }
    expect(context, a, images, "turn over");
    starg_mesh_free(a);
    shape_free(&s);
    free(images);
    test_context_free(context);
}

/* A self-intersecting end; a mirror image, whose tetrahedra would have to invert. */
static void test_refused(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    shape s = shape_cube(3);
    starg_mesh *a = test_mesh_of(context, &s);
    const double *v = starg_mesh_vertices(a);
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *images = malloc(size * sizeof *images);
    assert_non_null(images);
    for (size_t i = 0; i < size; i++)
        images[i] = i % 3 == 0 ? -v[i] : v[i];
    expect(context, a, images, "turn over");
    memcpy(images, v, size * sizeof *images);
    for (size_t k = 0; k < 3; k++) /* one vertex through the other side */
        images[k] = 4 + 0.3 * (double)k;
    expect(context, a, images, "B in A's connectivity meets itself");
    starg_mesh *crossed;
    test_ok(context, starg_mesh_create(context, images, size / 3, starg_mesh_faces(a),
                                       starg_mesh_face_count(a), &crossed));
    expect(context, crossed, v, "A meets itself");
    starg_mesh_free(crossed);
    starg_mesh_free(a);
    shape_free(&s);
    free(images);
    test_context_free(context);
}

static void test_time(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "cat", 0, VERTICES),
               *b = test_pose(context, "cat", 1, VERTICES);
    starg_morph *morph = test_morph(context, a, starg_mesh_vertices(b), STARG_MORPH_LINEAR);
    starg_decomposition *out[2];
    starg_context_set_time_limit(context, 1e-6);
    assert_int_equal(starg_morph_solids(morph, out), STARG_ERROR_TIME);
    assert_null(out[0]);
    assert_null(out[1]);
    starg_context_set_time_limit(context, 0);
    starg_morph_free(morph);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

static void test_memory(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    size_t left = SIZE_MAX, ration = 0;
    if (!has_tetgen())
        skip();
    starg_context *context = test_scarce_context(1, &left);
    shape s = shape_room();
    starg_mesh *a = test_mesh_of(context, &s);
    starg_morph *morph = test_morph(context, a, starg_mesh_vertices(a), STARG_MORPH_LINEAR);
    size_t before = starg_context_live_blocks(context);
    for (; status != STARG_OK && ration < 100000; ration += 1 + ration / 8) {
        starg_decomposition *out[2];
        left = ration;
        status = starg_morph_solids(morph, out);
        left = SIZE_MAX;
        if (status != STARG_OK) {
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_int_equal(starg_context_live_blocks(context), before);
        }
        free_both(context, out);
    }
    assert_int_equal(status, STARG_OK);
    assert_true(ration > 10);
    starg_morph_free(morph);
    starg_mesh_free(a);
    shape_free(&s);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_poses), cmocka_unit_test(test_convex),
                                       cmocka_unit_test(test_bent),  cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_time),  cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
