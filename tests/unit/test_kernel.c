/* SPDX-License-Identifier: Apache-2.0 */
/* Kernels against rationals: all vertices of the arrangement of the face planes that are beyond no
 * plane. The kernel has an interior exactly if their mean is strictly on the inner side of every
 * face. */
#include "support.h"

#include <dirent.h>
#include <gmp.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "geometry/linear_program.h"
#include "models.h"
#include "starguard/kernel.h"

/* ---- the oracle ---- */

/* n . x <= d inside; 4 rationals a plane */
typedef mpq_t plane[4];

static void plane_set(plane out, const double *const p[3]) {
    mpq_t u[3], v[3], t;
    mpq_init(t);
    for (int k = 0; k < 3; k++) {
        mpq_inits(u[k], v[k], NULL);
        mpq_set_d(u[k], p[1][k]);
        mpq_set_d(t, p[0][k]);
        mpq_sub(u[k], u[k], t);
        mpq_set_d(v[k], p[2][k]);
        mpq_sub(v[k], v[k], t);
    }
    mpq_set_ui(out[3], 0, 1);
    for (int k = 0; k < 3; k++) {
        int y = (k + 1) % 3, z = (k + 2) % 3;
        mpq_mul(out[k], u[y], v[z]);
        mpq_mul(t, u[z], v[y]);
        mpq_sub(out[k], out[k], t);
        mpq_t a;
        mpq_init(a);
        mpq_set_d(a, p[0][k]);
        mpq_mul(t, a, out[k]);
        mpq_add(out[3], out[3], t);
        mpq_clear(a);
    }
    for (int k = 0; k < 3; k++)
        mpq_clears(u[k], v[k], NULL);
    mpq_clear(t);
}

static void determinant(mpq_t out, mpq_t *const c[3]) {
    mpq_t t;
    mpq_init(t);
    mpq_set_ui(out, 0, 1);
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int i = 0; i < 6; i++) {
        mpq_mul(t, c[0][order[i][0]], c[1][order[i][1]]);
        mpq_mul(t, t, c[2][order[i][2]]);
        if (i < 3)
            mpq_add(out, out, t);
        else
            mpq_sub(out, out, t);
    }
    mpq_clear(t);
}

/* Cramer's rule; false if the planes have no unique common point. */
static bool common_point(plane *planes[3], mpq_t x[3]) {
    mpq_t m[4][3], det;
    mpq_init(det);
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++) {
            mpq_init(m[c][r]);
            mpq_set(m[c][r], (*planes[r])[c]);
        }
    determinant(det, (mpq_t *const[]){m[0], m[1], m[2]});
    bool found = mpq_sgn(det) != 0;
    for (int k = 0; k < 3 && found; k++) {
        mpq_t *c[3] = {m[0], m[1], m[2]};
        c[k] = m[3];
        determinant(x[k], c);
        mpq_div(x[k], x[k], det);
    }
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            mpq_clear(m[c][r]);
    mpq_clear(det);
    return found;
}

/* Sign of d - n . x */
static int side(plane p, mpq_t x[3]) {
    mpq_t sum, t;
    mpq_inits(sum, t, NULL);
    mpq_set(sum, p[3]);
    for (int k = 0; k < 3; k++) {
        mpq_mul(t, p[k], x[k]);
        mpq_sub(sum, sum, t);
    }
    int sign = mpq_sgn(sum);
    mpq_clears(sum, t, NULL);
    return sign;
}

static bool all_sides(plane *planes, size_t count, mpq_t x[3], int least) {
    for (size_t i = 0; i < count; i++)
        if (side(planes[i], x) < least)
            return false;
    return true;
}

static bool oracle_kernel(const shape *s) {
    size_t count = s->face_count, found = 0;
    plane *planes = calloc(count, sizeof *planes);
    assert_non_null(planes);
    mpq_t x[3], sum[3], total;
    mpq_init(total);
    for (int k = 0; k < 3; k++)
        mpq_inits(x[k], sum[k], NULL);
    for (size_t i = 0; i < count; i++) {
        const double *p[3];
        for (int k = 0; k < 4; k++)
            mpq_init(planes[i][k]);
        for (size_t k = 0; k < 3; k++)
            p[k] = s->vertices + 3 * (size_t)s->faces[3 * i + k];
        plane_set(planes[i], p);
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++)
            for (size_t k = 0; k < j; k++) {
                plane *chosen[3] = {&planes[i], &planes[j], &planes[k]};
                if (!common_point(chosen, x) || !all_sides(planes, count, x, 0))
                    continue;
                found++;
                for (int axis = 0; axis < 3; axis++)
                    mpq_add(sum[axis], sum[axis], x[axis]);
            }
    mpq_set_ui(total, found, 1);
    bool inside = found > 0;
    for (int k = 0; k < 3 && found > 0; k++)
        mpq_div(sum[k], sum[k], total);
    inside = inside && all_sides(planes, count, sum, 1);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 4; k++)
            mpq_clear(planes[i][k]);
    for (int k = 0; k < 3; k++)
        mpq_clears(x[k], sum[k], NULL);
    mpq_clear(total);
    free(planes);
    return inside;
}

/* ---- one shape ---- */

static starg_kernel_result kernel_of(starg_context *context, const shape *s) {
    starg_kernel_result result;
    starg_mesh *mesh = test_mesh_of(context, s);
    test_ok(context, starg_kernel(context, mesh, NULL, &result));
    starg_mesh_free(mesh);
    return result;
}

static void check_guard(const shape *s, const starg_kernel_result *result) {
    bool on_surface;
    assert_true(result->radius > 0);
    for (size_t f = 0; f < s->face_count; f++)
        assert_int_equal(oracle_orient3d(s->vertices + 3 * (size_t)s->faces[3 * f],
                                         s->vertices + 3 * (size_t)s->faces[3 * f + 1],
                                         s->vertices + 3 * (size_t)s->faces[3 * f + 2],
                                         result->guard),
                         1);
    assert_int_equal(
        oracle_winding(s->vertices, s->faces, s->face_count, result->guard, &on_surface), 1);
    assert_false(on_surface);
}

/* The faces of the witness alone, and the box of the shape, leave no interior. */
static void check_witness(const shape *s, const starg_kernel_result *result) {
    shape few = shape_cube(1);
    double lower[3] = {1e99, 1e99, 1e99}, upper[3] = {-1e99, -1e99, -1e99};
    for (size_t i = 0; i < 3 * s->vertex_count; i++) {
        lower[i % 3] = fmin(lower[i % 3], s->vertices[i]);
        upper[i % 3] = fmax(upper[i % 3], s->vertices[i]);
    }
    for (size_t i = 0; i < 3 * few.vertex_count; i++) {
        few.vertices[i] = few.vertices[i] > 0 ? upper[i % 3] : lower[i % 3];
    }
    assert_in_range(result->witness_count, 1, STARG_KERNEL_WITNESS);
    shape all = {.vertex_count = few.vertex_count + 3 * result->witness_count,
                 .face_count = few.face_count + result->witness_count};
    all.vertices = calloc(3 * all.vertex_count, sizeof(double));
    all.faces = calloc(3 * all.face_count, sizeof(uint32_t));
    memcpy(all.vertices, few.vertices, 24 * few.vertex_count);
    memcpy(all.faces, few.faces, 12 * few.face_count);
    for (size_t i = 0; i < 3 * result->witness_count; i++) {
        uint32_t v = s->faces[3 * (size_t)result->witness[i / 3] + i % 3];
        memcpy(all.vertices + 3 * (few.vertex_count + i), s->vertices + 3 * (size_t)v, 24);
        all.faces[3 * few.face_count + i] = (uint32_t)(few.vertex_count + i);
    }
    assert_false(oracle_kernel(&all));
    shape_free(&few);
    shape_free(&all);
}

static starg_kernel_verdict check_shape(starg_context *context, const shape *s) {
    starg_kernel_result result = kernel_of(context, s);
    if (result.verdict == STARG_KERNEL_INTERIOR)
        check_guard(s, &result);
    else if (result.verdict == STARG_KERNEL_EMPTY)
        check_witness(s, &result);
    return result.verdict;
}

/* ---- tests ---- */

/* Random cells are lattice shapes with many coplanar and opposite faces. The surface of cells is
 * always closed. */
static void test_cells(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t stars = 0, empty = 0;
    for (uint64_t seed = 0; seed < 30; seed++) {
        starg_rng rng = starg_rng_make(seed, 1, 0);
        char cells[] = "########";
        for (size_t i = 1; i < 8; i++)
            cells[i] = starg_rng_below(&rng, 3) ? '#' : ' ';
        shape s = shape_cells(cells, 2, 2, 2);
        starg_kernel_verdict verdict = check_shape(context, &s);
        assert_int_equal(verdict, oracle_kernel(&s) ? STARG_KERNEL_INTERIOR : STARG_KERNEL_EMPTY);
        stars += verdict == STARG_KERNEL_INTERIOR;
        empty += verdict == STARG_KERNEL_EMPTY;
        shape_free(&s);
    }
    assert_true(stars >= 3 && empty >= 3);
    test_context_free(context);
}

/* Random octahedra subdivided once: star-shaped if the radii allow it. */
static void test_blobs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t stars = 0, empty = 0;
    for (uint64_t seed = 0; seed < 16; seed++) {
        shape s = shape_blob(1, seed);
        starg_rng rng = starg_rng_make(seed, 2, 0);
        if (seed % 2) /* vertices moved at random: mostly no longer star-shaped */
            for (size_t i = 0; i < 3 * s.vertex_count; i++)
                s.vertices[i] += 2 * starg_rng_unit(&rng) - 1;
        shape_place(&s, seed % 3 == 0 ? 1e-60 : 1, seed % 3 == 1 ? 1000 : 0);
        starg_kernel_verdict verdict = check_shape(context, &s);
        assert_int_equal(verdict, oracle_kernel(&s) ? STARG_KERNEL_INTERIOR : STARG_KERNEL_EMPTY);
        stars += verdict == STARG_KERNEL_INTERIOR;
        empty += verdict == STARG_KERNEL_EMPTY;
        shape_free(&s);
    }
    assert_true(stars >= 8 && empty >= 2);
    test_context_free(context);
}

/* Known kernels: checks centre and radius. */
static void test_known(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(3), room = shape_room();
    starg_kernel_result result = kernel_of(context, &cube);
    assert_int_equal(result.verdict, STARG_KERNEL_INTERIOR);
    assert_true(fabs(result.radius - 1.5) < 1e-12);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(result.guard[k] - 1.5) < 1e-12);
    shape_place(&cube, 0x1p200, 0);
    result = kernel_of(context, &cube);
    assert_true(fabs(result.radius * 0x1p-200 - 1.5) < 1e-12);
    shape_place(&cube, 0x1p-600, 0);
    result = kernel_of(context, &cube);
    assert_int_equal(result.verdict, STARG_KERNEL_INTERIOR);
    assert_int_equal(kernel_of(context, &room).verdict, STARG_KERNEL_INTERIOR);
    shape_free(&cube);
    shape_free(&room);
    test_context_free(context);
}

/* Steps of cells: planes of walls that meet other walls' edges, so that the kernel is flat, a line,
 * or empty. */
static void test_empty_interior(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cells("## " /* the strip above the middle cell's two inner corners */
                          " ##",
                          3, 2, 1);
    assert_int_equal(check_shape(context, &s),
                     oracle_kernel(&s) ? STARG_KERNEL_INTERIOR : STARG_KERNEL_EMPTY);
    shape_free(&s);
    s = shape_cells("##  "
                    " ## "
                    "  ##",
                    4, 3, 1);
    assert_false(oracle_kernel(&s));
    assert_int_equal(check_shape(context, &s), STARG_KERNEL_EMPTY);
    shape_free(&s);
    s = shape_cells("#  "
                    "## "
                    "   ",
                    3, 3, 1);
    assert_true(oracle_kernel(&s));
    assert_int_equal(check_shape(context, &s), STARG_KERNEL_INTERIOR);
    shape_free(&s);
    s = shape_cavity();
    assert_int_equal(check_shape(context, &s), STARG_KERNEL_EMPTY);
    shape_free(&s);
    test_context_free(context);
}

/* All planes are right, but the surface winds twice: two copies of one cube. */
static void test_winding(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1), copy = shape_cube(1);
    const double here[3] = {0, 0, 0};
    shape_append(&s, &copy, here, 0);
    starg_kernel_result result = kernel_of(context, &s);
    assert_int_equal(result.verdict, STARG_KERNEL_EMPTY);
    assert_int_equal(result.witness_count, 0);
    shape_free(&s);
    s = shape_cube(1);
    const double far[3] = {5, 0, 0};
    shape_append(&s, &copy, far, 0);
    assert_int_equal(check_shape(context, &s), STARG_KERNEL_EMPTY);
    shape_free(&s);
    shape_free(&copy);
    test_context_free(context);
}

/* A vertex on the edge of its neighbours makes a zero-area face. */
static void test_flat_face(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0};
    uint32_t faces[] = {0, 2, 1, 0, 4, 3, 4, 1, 3, 0, 3, 2, 1, 2, 3, 0, 1, 4};
    shape s = {.vertex_count = 5, .face_count = 6, .vertices = vertices, .faces = faces};
    starg_kernel_result result = kernel_of(context, &s);
    assert_int_equal(result.verdict, STARG_KERNEL_EMPTY);
    assert_int_equal(result.witness_count, 1);
    assert_int_equal(result.witness[0], 5);
    test_context_free(context);
}

static void test_errors(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1);
    starg_mesh *open = NULL, *none = NULL;
    starg_kernel_result result;
    starg_kernel_options options;
    starg_kernel_options_default(&options);
    test_ok(context, starg_mesh_create(context, s.vertices, s.vertex_count, s.faces,
                                       s.face_count - 1, &open));
    assert_int_equal(starg_kernel(context, open, NULL, &result), STARG_ERROR_MESH);
    assert_int_equal(starg_context_error(context)->element, STARG_ELEMENT_EDGE);
    assert_int_equal(starg_context_error(context)->index_count, 2);
    options.trust_closed = true;
    test_ok(context, starg_kernel(context, open, &options, &result));
    test_ok(context, starg_mesh_create(context, s.vertices, s.vertex_count, NULL, 0, &none));
    assert_int_equal(starg_kernel(context, none, NULL, &result), STARG_ERROR_MESH);
    starg_mesh_free(open);
    starg_mesh_free(none);
    s.faces[0] ^=
        s.faces[1]; /* one reversed face: every edge has two faces, three of them inconsistent */
    s.faces[1] ^= s.faces[0];
    s.faces[0] ^= s.faces[1];
    open = test_mesh_of(context, &s);
    assert_int_equal(starg_kernel(context, open, NULL, &result), STARG_ERROR_MESH);
    starg_mesh_free(open);
    starg_context_cancel(context);
    open = test_mesh_of(context, &s);
    assert_int_equal(starg_kernel(context, open, &options, &result), STARG_ERROR_CANCELLED);
    starg_mesh_free(open);
    shape_free(&s);
    test_context_free(context);
}

/* Proofs of emptiness for sets with and without a common point. */
static void test_half_spaces(void **state) {
    (void)state;
    const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    const double up[3][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    half_space above = {o, y, x}, below = {o, x, y}; /* z > 0, z < 0 */
    half_space below_up = {up[0], up[1], up[2]}, above_up = {up[0], up[2], up[1]};
    assert_true(half_spaces_apart((half_space[]){above, below}, 2)); /* touch in a plane */
    assert_true(half_spaces_apart((half_space[]){below, above_up}, 2));
    assert_false(half_spaces_apart((half_space[]){above, below_up}, 2));
    assert_false(half_spaces_apart((half_space[]){above, above}, 2));
    assert_false(half_spaces_apart((half_space[]){above}, 1));
    assert_true(half_spaces_apart((half_space[]){{o, x, x}}, 1));
    half_space corner[4] = {
        {o, x, y}, {o, y, z}, {o, z, x}, {x, z, y}}; /* tetrahedron, one orientation */
    int sides[2] = {0, 0};
    for (int turn = 0; turn < 2; turn++) {
        half_space all[4];
        for (int i = 0; i < 4; i++)
            all[i] = turn ? (half_space){corner[i].a, corner[i].c, corner[i].b} : corner[i];
        sides[turn] = half_spaces_apart(all, 4);
        for (int i = 0; i < 4; i++) {
            half_space three[3] = {all[(i + 1) % 4], all[(i + 2) % 4], all[(i + 3) % 4]};
            assert_false(half_spaces_apart(three, 3));
        }
    }
    assert_int_equal(sides[0] + sides[1],
                     1); /* one orientation is empty, the other is the inside */
    /* nearly parallel: they meet far away, not in the box */
    const double tilted[3] = {1, 0, 1 + 0x1p-20}, lower[3] = {-9, -9, -9}, upper[3] = {9, 9, 9};
    const double weights[2] = {1, 1}, wrong[2] = {1, 0}, negative[2] = {1, -1};
    half_space pair[2] = {below, {up[0], up[2], tilted}}; /* z < 0, about z > 1 */
    assert_false(half_spaces_apart(pair, 2));
    assert_true(half_spaces_apart_in_box(pair, weights, 2, lower, upper));
    assert_false(half_spaces_apart_in_box(pair, wrong, 2, lower, upper));
    assert_false(half_spaces_apart_in_box(pair, negative, 2, lower, upper));
    pair[1] = (half_space){up[0], tilted, up[2]};
    assert_false(half_spaces_apart_in_box(pair, weights, 2, lower, upper));
    const double huge[3] = {0x1p320, 0, 0}, tiny[3] = {0, 0x1p-1000, 0};
    assert_false(half_spaces_apart((half_space[]){{o, huge, tiny}, {o, tiny, huge}}, 2));
}

/* Every closed model of two folders is decided, one way or the other. */
static void check_folder(starg_context *context, const char *data, const char *folder,
                         size_t *stars, size_t *empty) {
    char path[4400];
    snprintf(path, sizeof path, "%s/%s", data, folder);
    DIR *files = opendir(path);
    assert_non_null(files);
    for (struct dirent *file = readdir(files); file != NULL; file = readdir(files)) {
        starg_mesh *mesh = NULL;
        starg_kernel_result result;
        if (strstr(file->d_name, ".off") == NULL)
            continue;
        snprintf(path, sizeof path, "%s/%s/%s", data, folder, file->d_name);
        test_ok(context, starg_mesh_read(context, path, &mesh));
        test_ok(context, starg_kernel(context, mesh, NULL, &result));
        assert_int_not_equal(result.verdict, STARG_KERNEL_UNDECIDED);
        ++*(result.verdict == STARG_KERNEL_INTERIOR ? stars : empty);
        starg_mesh_free(mesh);
    }
    closedir(files);
}

static void test_shared(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(1);
    size_t stars = 0, empty = 0;
    check_folder(context, data, "cad", &stars, &empty);
    check_folder(context, data, "solids", &stars, &empty);
    assert_true(stars >= 5 && empty >= 40);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells),   cmocka_unit_test(test_blobs),
        cmocka_unit_test(test_known),   cmocka_unit_test(test_empty_interior),
        cmocka_unit_test(test_winding), cmocka_unit_test(test_flat_face),
        cmocka_unit_test(test_errors),  cmocka_unit_test(test_half_spaces),
        cmocka_unit_test(test_shared)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
