/* SPDX-License-Identifier: Apache-2.0 */
/* Inside tests: winding numbers of the engines and of the verifier, containment, and front-facing
 * sides, against rationals; from points on vertices, edges and faces, in planes of faces, an ulp
 * off, and anywhere. */
#include "support.h"

#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "models.h"
#include "verify/surface.h"
#include "visibility/kernel.h"

enum { MODELS = 9 };

static shape two_cubes(double at) {
    const double offset[3] = {at, at, at / 2};
    shape s = shape_cube(2), other = shape_cube(1);
    shape_append(&s, &other, offset, 0);
    shape_free(&other);
    return s;
}

static shape placed(shape s, double scale, double offset) {
    shape_place(&s, scale, offset);
    return s;
}

static shape make_model(int which) {
    switch (which) {
    case 0:
        return shape_tetrahedron();
    case 1:
        return shape_room();
    case 2:
        return shape_cavity();
    case 3:
        return two_cubes(1.5); /* winding number two, in part */
    case 4:
        return placed(shape_cube(2), 0x1p-290, 0);
    case 5:
        return placed(shape_room(), 1e90, 0);
    case 6:
        return placed(shape_cube(2), 0.1, 1e6);
    case 7:
        return shape_blob(0, 7);
    default:
        return shape_blob(1, 8);
    }
}

static void pick_point(starg_rng *rng, const shape *s, double p[3]) {
    const uint32_t *f = s->faces + 3 * starg_rng_below(rng, s->face_count);
    const double *a = s->vertices + 3 * (size_t)f[0], *b = s->vertices + 3 * (size_t)f[1];
    const double *c = s->vertices + 3 * (size_t)f[2];
    const double *d = s->vertices + 3 * starg_rng_below(rng, s->vertex_count);
    uint64_t kind = starg_rng_below(rng, 6);
    double u = 2 * starg_rng_unit(rng) - 0.5, v = starg_rng_unit(rng);
    for (size_t k = 0; k < 3; k++) {
        const double kinds[6] = {a[k],
                                 0.5 * a[k] + 0.5 * b[k],
                                 0.5 * a[k] + 0.25 * b[k] + 0.25 * c[k],
                                 a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]),
                                 0.25 * a[k] + 0.25 * b[k] + 0.5 * d[k],
                                 a[k] + u * (d[k] - a[k])};
        p[k] = kinds[kind];
        if (starg_rng_below(rng, 6) == 0)
            p[k] = nextafter(p[k], starg_rng_below(rng, 2) ? INFINITY : -INFINITY);
    }
}

static bool sees_all(const shape *s, const double p[3]) {
    for (size_t f = 0; f < s->face_count; f++)
        if (oracle_orient3d(s->vertices + 3 * (size_t)s->faces[3 * f],
                            s->vertices + 3 * (size_t)s->faces[3 * f + 1],
                            s->vertices + 3 * (size_t)s->faces[3 * f + 2], p) <= 0)
            return false;
    return true;
}

static void check_point(const char *what, int model, const double p[3], int expected, int found) {
    if (expected != found)
        fail_msg("%s, model %d at (%a, %a, %a): expected %d, found %d", what, model, p[0], p[1],
                 p[2], expected, found);
}

static void check_model(starg_context *context, int which, size_t rounds, size_t *inside) {
    shape s = make_model(which);
    const kernel_faces faces = {s.vertices, s.faces, s.face_count};
    starg_mesh *mesh = test_mesh_of(context, &s);
    starg_solid *solid = NULL;
    verify_surface *surface = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, verify_surface_create(context, mesh, &surface));
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(29, (uint64_t)which, round);
        double p[3];
        bool on, found_on;
        pick_point(&rng, &s, p);
        int winding = oracle_winding(s.vertices, s.faces, s.face_count, p, &on);
        int found = verify_winding(surface, NULL, surface->face_count, p, &found_on);
        check_point("on_surface", which, p, on, found_on);
        check_point("starg_solid_contains", which, p, !on && winding > 0,
                    starg_solid_contains(solid, p));
        check_point("kernel_sees_all", which, p, sees_all(&s, p), kernel_sees_all(&faces, p));
        if (on)
            continue;
        check_point("verify_winding", which, p, winding, found);
        check_point("kernel_winding", which, p, winding, kernel_winding(&faces, p));
        *inside += winding > 0;
    }
    verify_surface_free(surface);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    shape_free(&s);
}

static void test_inside(void **state) {
    (void)state;
    size_t rounds = test_rounds(250, 12000), inside = 0;
    starg_context *context = test_context(1);
    for (int which = 0; which < MODELS; which++)
        check_model(context, which, rounds, &inside);
    assert_true(inside > rounds && inside < (MODELS - 1) * rounds);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_inside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
