/* SPDX-License-Identifier: Apache-2.0 */
/* Straight lines on surfaces: unfolded, they are straight. */
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "morph/surface_map.h"

/* The point of the cube's side that points along an axis, by face and coordinates. */
static surface_point point_at(const starg_mesh *mesh, const double p[3]) {
    surface_point best = {0};
    double least = INFINITY;
    for (uint32_t f = 0; f < starg_mesh_face_count(mesh); f++)
        for (int i = 1; i < 20; i++)
            for (int j = 1; i + j < 20; j++) {
                surface_point own = {f, {i / 20.0, j / 20.0, (20 - i - j) / 20.0}};
                double at[3];
                surface_place(mesh, &own, at);
                double d = hypot(hypot(p[0] - at[0], p[1] - at[1]), p[2] - at[2]);
                if (d < least) {
                    least = d;
                    best = own;
                }
            }
    return best;
}

static double part(const double a[3], const double b[3]) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Four sides of a cube around an axis are one strip: a full turn returns to the start, and any part
 * of it stays at the same height. */
static void test_round_a_cube(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(3);
    starg_mesh *mesh = test_mesh_of(context, &cube);
    mesh_topology *topology;
    double lower[3], upper[3], start[3], end[3];
    test_ok(context, topology_create(context, mesh, &topology));
    starg_mesh_bounds(mesh, lower, upper);
    double side = upper[0] - lower[0];
    const double aim[3] = {lower[0] + 0.37 * side, lower[1], lower[2] + 0.41 * side};
    const surface_point first = point_at(mesh, aim);
    surface_place(mesh, &first, start);
    assert_true(fabs(start[1] - lower[1]) < 1e-12 * side);
    for (int quarters = -8; quarters <= 8; quarters++) {
        surface_point point = first;
        const double step[3] = {quarters * side, 0, 0};
        surface_walk(mesh, topology, step, &point);
        surface_place(mesh, &point, end);
        assert_true(fabs(end[2] - start[2]) < 1e-9 * side);
        if (quarters % 4 == 0)
            assert_true(part(start, end) < 1e-9 * side);
        else
            assert_true(part(start, end) > 0.1 * side);
    }
    topology_free(topology);
    starg_mesh_free(mesh);
    shape_free(&cube);
    test_context_free(context);
}

/* Coordinates stay valid whatever the step; no walk is longer in space than its step. */
static void test_any_step(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "cat", 600);
    mesh_topology *topology;
    starg_rng rng = starg_rng_make(11, 0, 0);
    test_ok(context, topology_create(context, mesh, &topology));
    for (int round = 0; round < 2000; round++) {
        uint32_t face = (uint32_t)starg_rng_below(&rng, starg_mesh_face_count(mesh));
        surface_point point = {face, {0.2, 0.3, 0.5}};
        double before[3], after[3], step[3], slopes[3];
        for (int k = 0; k < 3; k++)
            slopes[k] = starg_rng_unit(&rng) - 0.5;
        surface_place(mesh, &point, before);
        if (round % 100 == 0)
            memset(slopes, 0, sizeof slopes);
        assert_true(surface_gradient(mesh, &point, slopes, step));
        double length = sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
        surface_walk(mesh, topology, step, &point);
        surface_place(mesh, &point, after);
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            assert_true(point.coordinates[k] >= 0);
            sum += point.coordinates[k];
        }
        assert_true(fabs(sum - 1) < 1e-12);
        assert_true(point.face < starg_mesh_face_count(mesh));
        assert_true(part(before, after) <= length * (1 + 1e-9) + 1e-12);
    }
    topology_free(topology);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_round_a_cube),
                                       cmocka_unit_test(test_any_step)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
