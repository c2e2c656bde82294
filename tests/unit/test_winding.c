/* SPDX-License-Identifier: Apache-2.0 */
/* The generalized winding number against the sum of all solid angles. */
#include "support.h"

#include <math.h>

#include "core/rng.h"
#include "geometry/bvh.h"
#include "shapes.h"

/* Solid angle by its definition on the sphere: the sum of the angles minus pi. */
static double solid_angle(const double *const corner[3], const double *p) {
    double u[3][3], sum = 0, side = 0;
    for (int k = 0; k < 3; k++) {
        double length = 0;
        for (int i = 0; i < 3; i++) {
            u[k][i] = corner[k][i] - p[i];
            length += u[k][i] * u[k][i];
        }
        for (int i = 0; i < 3; i++)
            u[k][i] /= sqrt(length);
    }
    for (int k = 0; k < 3; k++) {
        const double *a = u[k], *b = u[(k + 1) % 3], *c = u[(k + 2) % 3];
        double n[2][3], square[2] = {0, 0}, cosine = 0;
        for (int i = 0; i < 3; i++) {
            int y = (i + 1) % 3, z = (i + 2) % 3;
            n[0][i] = a[y] * b[z] - a[z] * b[y];
            n[1][i] = a[y] * c[z] - a[z] * c[y];
            square[0] += n[0][i] * n[0][i];
            square[1] += n[1][i] * n[1][i];
            cosine += n[0][i] * n[1][i];
        }
        sum += acos(fmax(-1, fmin(1, cosine / sqrt(square[0] * square[1]))));
        for (int i = 0; i < 3; i++)
            side += k == 0 ? n[0][i] * c[i] : 0;
    }
    return copysign(sum - 3.14159265358979323846, side);
}

static double brute_number(const shape *s, size_t faces, const double *p) {
    double sum = 0;
    for (size_t f = 0; f < faces; f++) {
        const double *corner[3];
        for (size_t k = 0; k < 3; k++)
            corner[k] = s->vertices + 3 * (size_t)s->faces[3 * f + k];
        sum += solid_angle(corner, p);
    }
    return sum / (4 * 3.14159265358979323846);
}

static void check_shape(starg_context *context, const shape *s, size_t faces, double scale) {
    bvh *tree = NULL;
    winding_field field;
    test_ok(context, bvh_create(context, s->vertices, s->faces, faces, &tree));
    test_ok(context, winding_create(context, tree, &field));
    starg_rng rng = starg_rng_make(faces, 5, 0);
    for (int sample = 0; sample < 200; sample++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = scale * (8 * starg_rng_unit(&rng) - 4);
        assert_true(fabs(winding_number(&field, p) - brute_number(s, faces, p)) < 0.03);
    }
    winding_free(&field);
    bvh_free(tree);
}

static void test_numbers(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int i = 0; i < 3; i++) {
        double scale = (const double[]){1, 0x1p200, 0x1p-200}[i];
        shape shapes[] = {shape_cube(1), shape_room(), shape_blob(3, 2)};
        for (size_t j = 0; j < sizeof shapes / sizeof *shapes; j++) {
            shape_place(&shapes[j], scale, 0);
            check_shape(context, &shapes[j], shapes[j].face_count, scale);
            check_shape(context, &shapes[j], 3 * shapes[j].face_count / 4, scale);
            check_shape(context, &shapes[j], 2, scale);
            shape_free(&shapes[j]);
        }
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_numbers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
