/* SPDX-License-Identifier: Apache-2.0 */
/* Maps of star pieces to balls: by rationals, is every image positive, has each vertex one image on
 * the sphere, and are directions covered once? And where the rays do not fit into doubles. */
#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/singular_values.h"
#include "models.h"
#include "starguard/decompose.h"
#include "starguard/sample.h"
#include "starguard/verify.h"
#include "verify/pieces.h"

/* det(a, b, c) in rational numbers. */
static void slow_determinant(mpq_t out, const double *a, const double *b, const double *c) {
    mpq_t product, factor;
    mpq_inits(product, factor, NULL);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < 6; i++) {
        int x = i % 3, y = (x + 1 + i / 3) % 3, z = 3 - x - y;
        mpq_set_d(product, a[x]);
        mpq_set_d(factor, b[y]);
        mpq_mul(product, product, factor);
        mpq_set_d(factor, c[z]);
        mpq_mul(product, product, factor);
        if (i < 3)
            mpq_add(out, out, product);
        else
            mpq_sub(out, out, product);
    }
    mpq_clears(product, factor, NULL);
}

static int slow_sign(const double *a, const double *b, const double *c) {
    mpq_t sum;
    mpq_init(sum);
    slow_determinant(sum, a, b, c);
    int sign = mpq_sgn(sum);
    mpq_clear(sum);
    return sign;
}

/* The three images that are not the centre, in the order of a positive tetrahedron with it in
 * front: cyclic moves of three of four corners are even. */
static bool outer_images(const double *corners, const double *out[3]) {
    static const int order[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    int centre = 0;
    while (centre < 4 && (corners[3 * centre] != 0 || corners[3 * centre + 1] != 0 ||
                          corners[3 * centre + 2] != 0))
        centre++;
    for (int k = 0; k < 3 && centre < 4; k++)
        out[k] = corners + 3 * order[centre][k];
    return centre < 4;
}

static void check_one_image(const starg_decomposition *d) {
    const uint32_t *tetrahedra = starg_tetmesh_tetrahedra(d->mesh);
    size_t vertices = starg_tetmesh_vertex_count(d->mesh);
    const double **image = calloc(vertices, sizeof *image);
    assert_non_null(image);
    for (size_t p = 0; p < d->piece_count; p++) {
        memset(image, 0, vertices * sizeof *image);
        for (size_t i = 0; i < 4 * d->tetrahedra; i++) {
            if (d->labels[i / 4] != (int32_t)p)
                continue;
            const double *at = d->ball_corners + 3 * i, **before = &image[tetrahedra[i]];
            if (*before != NULL)
                assert_memory_equal(*before, at, 3 * sizeof *at);
            *before = at;
        }
    }
    free(image);
}

/* How many tetrahedra of a piece hold a direction. */
static size_t covering(const starg_decomposition *d, size_t piece, const double x[3]) {
    size_t count = 0;
    for (size_t t = 0; t < d->tetrahedra; t++) {
        const double *at[3];
        if (d->labels[t] != (int32_t)piece || !outer_images(d->ball_corners + 12 * t, at))
            continue;
        count += slow_sign(at[0], at[1], x) > 0 && slow_sign(at[1], at[2], x) > 0 &&
                 slow_sign(at[2], at[0], x) > 0;
    }
    return count;
}

static void check_balls(const starg_decomposition *d) {
    starg_rng rng = starg_rng_make(3, 3, 3);
    assert_non_null(d->ball_corners);
    for (size_t t = 0; t < d->tetrahedra; t++) {
        const double *at[3];
        assert_true(outer_images(d->ball_corners + 12 * t, at));
        for (int k = 0; k < 3; k++)
            assert_true(fabs(hypot(hypot(at[k][0], at[k][1]), at[k][2]) - 1) < 1e-14);
        assert_int_equal(slow_sign(at[0], at[1], at[2]), 1);
    }
    check_one_image(d);
    for (size_t p = 0; p < d->piece_count; p++) {
        const double x[3] = {starg_rng_unit(&rng) - 0.5, starg_rng_unit(&rng) - 0.5,
                             starg_rng_unit(&rng) - 0.5};
        assert_int_equal(covering(d, p, x), 1);
    }
    assert_true(d->ball_worst >= d->ball_mean && d->ball_mean >= 1);
    assert_true(d->ball_above_10 >= 0 && d->ball_above_10 <= 1);
}

static size_t count_spread(const starg_decomposition *d) {
    size_t count = 0;
    for (size_t p = 0; p < d->piece_count; p++)
        count += d->pieces[p].spread;
    return count;
}

static starg_decomposition *cut(starg_context *context, const starg_solid *solid,
                                starg_balls balls) {
    starg_decomposition *d = NULL;
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.effort = 20;
    options.balls = balls;
    test_ok(context, starg_decompose(context, solid, &options, &d));
    return d;
}

/* Even maps are more even; files hold what there is. */
static void check_solid(starg_context *context, const starg_solid *solid) {
    double mean = 0;
    for (int kind = STARG_BALLS_RAYS; kind <= STARG_BALLS_EVEN; kind++) {
        starg_decomposition *d = cut(context, solid, (starg_balls)kind);
        check_balls(d);
        if (kind == STARG_BALLS_EVEN) {
            assert_int_equal(count_spread(d), d->piece_count);
            assert_true(d->ball_mean < mean);
        }
        mean = d->ball_mean;
        starg_decomposition_free(context, d);
    }
}

static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"l-room", "gallery", "horse", "knot", "plate"};
    for (size_t i = 0; i < test_rounds(3, sizeof names / sizeof *names); i++) {
        starg_context *context = test_context(2);
        starg_solid *solid = test_sample(context, names[i], 500);
        check_solid(context, solid);
        starg_solid_free(solid);
        test_context_free(context);
    }
}

/* An octahedron, out of its middle, one of whose corners is cut off by a triangle of a size that no
 * direction from the guard can tell: rays coincide, and the piece is spread over the sphere. */
static starg_solid *blunt_octahedron(starg_context *context, double size) {
    const double vertices[8][3] = {{1, size, 0},   {1, -size, size}, {1, -size, -size},
                                   {-1, 0.3, 0.2}, {0, 1.3, 0.2},    {0, -0.7, 0.2},
                                   {0, 0.3, 1.2},  {0, 0.3, -0.8}};
    const uint32_t faces[12][3] = {{0, 1, 2}, {0, 4, 6}, {0, 6, 1}, {1, 6, 5},
                                   {1, 5, 2}, {2, 5, 7}, {2, 7, 0}, {0, 7, 4},
                                   {3, 6, 4}, {3, 5, 6}, {3, 7, 5}, {3, 4, 7}};
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    test_ok(context, starg_mesh_create(context, vertices[0], 8, faces[0], 12, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_mesh_free(mesh);
    return solid;
}

static void test_rays_that_coincide(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t spread = 0;
    for (int power = -2; power >= -40; power -= 2) {
        starg_solid *solid = blunt_octahedron(context, pow(10, power));
        starg_decomposition *d = cut(context, solid, STARG_BALLS_RAYS);
        check_balls(d);
        spread += count_spread(d);
        if (power == -2)
            assert_int_equal(spread, 0);
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
    }
    assert_true(spread > 0);
    test_context_free(context);
}

/* Maps that are known: a scaling along turned axes. */
static void test_singular_values(void **state) {
    (void)state;
    starg_rng rng = starg_rng_make(8, 8, 8);
    for (int round = 0; round < 1000; round++) {
        double from[3][3], to[3][3], found[3], turn = 6.283 * starg_rng_unit(&rng);
        double scales[3] = {exp(6 * starg_rng_unit(&rng)), 1, exp(-6 * starg_rng_unit(&rng))};
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                from[i][k] = starg_rng_unit(&rng) - 0.5 + (i == k);
        for (int i = 0; i < 3; i++) { /* a turn about x, the scales, a turn about z */
            double y = cos(turn) * from[i][1] - sin(turn) * from[i][2];
            double z = sin(turn) * from[i][1] + cos(turn) * from[i][2];
            double x = scales[0] * from[i][0];
            to[i][0] = cos(turn) * x - sin(turn) * scales[1] * y;
            to[i][1] = sin(turn) * x + cos(turn) * scales[1] * y;
            to[i][2] = scales[2] * z;
        }
        singular_values(from, to, found);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(found[k] / scales[k] - 1) < 1e-9);
    }
}

/* The ratio of singular values that `verify` finds in a map of tetrahedra. */
static verify_distortion verified_ratio(double from[3][3], double to[3][3]) {
    static const double origin[3] = {0, 0, 0};
    const double *const corners[2][4] = {{from[0], from[1], from[2], origin},
                                         {to[0], to[1], to[2], origin}};
    verify_distortion found = {0};
    verify_add_distortion(&found, corners[0], 0, corners[1], 0);
    return found;
}

static bool is_accepted(double from[3][3], double to[3][3], double ratio) {
    verify_distortion found = verified_ratio(from, to);
    return verify_near_distortion(ratio, found.worst, found.worst_room);
}

/* The matrix of the map that takes the rows of `from` to those of `to`, by rationals. */
static void slow_matrix(double from[3][3], double to[3][3], double out[3][3]) {
    mpq_t sum, cofactor, a, b;
    mpq_inits(sum, cofactor, a, b, NULL);
    for (int i = 0; i < 9; i++) {
        mpq_set_ui(sum, 0, 1);
        for (int j = 0; j < 3; j++) { /* Cramer: row j is replaced by an axis */
            double rows[3][3];
            memcpy(rows, from, sizeof rows);
            for (int k = 0; k < 3; k++)
                rows[j][k] = k == i / 3;
            slow_determinant(cofactor, rows[0], rows[1], rows[2]);
            mpq_set_d(a, to[j][i % 3]);
            mpq_mul(a, a, cofactor);
            mpq_add(sum, sum, a);
        }
        slow_determinant(b, from[0], from[1], from[2]);
        mpq_div(sum, sum, b);
        out[i / 3][i % 3] = mpq_get_d(sum);
    }
    mpq_clears(sum, cofactor, a, b, NULL);
}

/* The largest singular value, by iteration. */
static double slow_norm(double m[3][3]) {
    double most = 0;
    for (int start = 0; start < 3; start++) {
        double x[3] = {start == 0, start == 1, start == 2}, length = 0;
        for (int step = 0; step < 300; step++) {
            double y[3] = {0}, z[3] = {0};
            for (int i = 0; i < 9; i++)
                y[i % 3] += x[i / 3] * m[i / 3][i % 3];
            for (int i = 0; i < 9; i++)
                z[i / 3] += m[i / 3][i % 3] * y[i % 3];
            length = sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
            for (int k = 0; k < 3 && length > 0; k++)
                x[k] = z[k] / length;
        }
        most = fmax(most, sqrt(length));
    }
    return most;
}

/* Rays so near each other that the frames are flat, as in pieces that are seen at a small angle:
 * the smallest value is not lost, and `verify`, which finds the ratio in another way, agrees. */
static void test_flat_frames(void **state) {
    (void)state;
    starg_rng rng = starg_rng_make(9, 9, 9);
    for (int round = 0; round < 500; round++) {
        double from[3][3], to[3][3], found[3], map[3][3], inverse[3][3];
        double flat = pow(10, -4 - round % 7);
        for (int i = 0; i < 3; i++) {
            double length = 1 + starg_rng_unit(&rng), side = starg_rng_unit(&rng) - 0.5;
            const double ray[3] = {1, side, 0.3 * side + flat * starg_rng_unit(&rng)};
            for (int k = 0; k < 3; k++) {
                to[i][k] = ray[k];
                from[i][k] = length * ray[k];
            }
        }
        slow_matrix(from, to, map);
        slow_matrix(to, from, inverse);
        double ratio = slow_norm(map) * slow_norm(inverse);
        singular_values(from, to, found);
        assert_true(fabs(found[0] / found[2] / ratio - 1) < 1e-3);
        assert_true(is_accepted(from, to, found[0] / found[2]));
        assert_true(flat < 1e-4 || !is_accepted(from, to, 1.001 * ratio));
    }
}

static double rounded_determinant(double m[3][3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        sum += m[0][k] * (m[1][a] * m[2][b] - m[1][b] * m[2][a]);
    }
    return sum;
}

/* Frames so flat that rounding leaves little of their cofactors (even rounds), or nothing of their
 * determinants, which exactly are not 0 (odd rounds): `verify` finds the ratio all the same. */
static void test_lost_determinants(void **state) {
    (void)state;
    starg_rng rng = starg_rng_make(10, 10, 10);
    size_t lost = 0;
    for (int round = 0; round < 300; round++) {
        double from[3][3], to[3][3], map[3][3], inverse[3][3];
        double ray[3] = {starg_rng_unit(&rng), starg_rng_unit(&rng), starg_rng_unit(&rng)};
        mpq_t exact;
        for (int i = 0; i < 3; i++) {
            double length = 1 + starg_rng_unit(&rng);
            for (int k = 0; k < 3; k++) {
                from[i][k] = round % 2 == 0 ? length * ray[k] + 1e-13 * starg_rng_unit(&rng)
                                            : 1 + 0x1p-50 * (double)starg_rng_below(&rng, 16);
                to[i][k] = starg_rng_unit(&rng) - 0.5 + (i == k);
            }
        }
        mpq_init(exact);
        slow_determinant(exact, from[0], from[1], from[2]);
        bool flat = mpq_sgn(exact) == 0;
        mpq_clear(exact);
        if (flat)
            continue;
        lost += rounded_determinant(from) == 0;
        slow_matrix(from, to, map);
        slow_matrix(to, from, inverse);
        double ratio = slow_norm(map) * slow_norm(inverse);
        assert_true(fabs(verified_ratio(from, to).worst / ratio - 1) < 1e-9);
    }
    assert_true(lost > 0);
}

static void test_paper_mode(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "l-room", 500);
    starg_decomposition *d = NULL;
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.mode = STARG_DECOMPOSE_PAPER;
    options.balls = STARG_BALLS_RAYS;
    assert_int_equal(starg_decompose(context, solid, &options, &d), STARG_ERROR_ARGUMENT);
    assert_non_null(strstr(starg_context_error(context)->message, "--mode strict"));
    assert_null(d);
    starg_solid_free(solid);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples),           cmocka_unit_test(test_rays_that_coincide),
        cmocka_unit_test(test_singular_values),   cmocka_unit_test(test_flat_frames),
        cmocka_unit_test(test_lost_determinants), cmocka_unit_test(test_paper_mode)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
