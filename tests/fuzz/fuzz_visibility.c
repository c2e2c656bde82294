/* SPDX-License-Identifier: Apache-2.0 */
/* What points see of a small solid: every engine and the verifier against the definition, every
 * segment against every triangle in rationals. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "starguard/visibility.h"
#include "support.h"
#include "verify/sight.h"
#include "visibility_oracle.h"

enum { ENGINES = 5 };

/* A point anywhere, in the middle of two or three vertices, or on the line of an edge. */
static void choose_point(fuzz_input *in, const starg_mesh *mesh, double p[3]) {
    const double *v = starg_mesh_vertices(mesh), *corner[3];
    uint32_t kind = fuzz_below(in, 4), count = (uint32_t)starg_mesh_vertex_count(mesh);
    double along = 0.5 * fuzz_below(in, 8) - 1;
    for (int i = 0; i < 3; i++)
        corner[i] = v + 3 * (size_t)fuzz_below(in, count);
    for (int k = 0; k < 3; k++) {
        double a = corner[0][k], b = corner[1][k], c = corner[2][k];
        const double kinds[3] = {0.5 * a + 0.5 * b, 0.5 * a + 0.25 * b + 0.25 * c,
                                 a + along * (b - a)};
        p[k] = kind < 3 ? kinds[kind] : fuzz_coordinate(in);
        p[k] = fabs(p[k]) < 1e100 ? p[k] : 0;
    }
}

static void compare_engines(starg_context *context, const starg_solid *solid, const double p[3],
                            bool faces, starg_face_rule rule, const bool *expected) {
    static const char *const names[ENGINES] = {"grid", "bvh", "sweep", "contours", "fastest"};
    for (int engine = 0; engine < ENGINES; engine++) {
        starg_visibility_options options;
        starg_bits *bits = NULL;
        starg_visibility_options_default(&options);
        options.engine = (starg_visibility_engine)engine;
        options.target = faces ? STARG_TARGET_FACES : STARG_TARGET_VERTICES;
        options.face_rule = rule;
        fuzz_require_ok(context, starg_visibility(context, solid, p, 1, &options, &bits),
                        "visibility can be computed");
        for (size_t i = 0; i < starg_bits_columns(bits); i++)
            fuzz_require(starg_bits_test(bits, 0, i) == expected[i], names[engine]);
        starg_bits_free(bits);
    }
}

/* The verifier is for points inside, and knows no vertices that no face names. */
static void compare_verifier(starg_context *context, const starg_mesh *mesh, const double p[3],
                             starg_face_rule rule, const bool *vertices, const bool *faces) {
    verify_surface *surface = NULL;
    verify_sight *sight = NULL;
    const uint8_t *found_vertices, *found_faces;
    const verify_view view = {.range = INFINITY, .rule = rule};
    const uint32_t *f = starg_mesh_faces(mesh);
    fuzz_require_ok(context, verify_surface_create(context, mesh, &surface),
                    "the verifier takes every solid");
    fuzz_require_ok(context, verify_sight_create(surface, &sight), "and looks around in it");
    fuzz_require_ok(context, verify_look(sight, p, &view, &found_vertices, &found_faces),
                    "from any point inside");
    for (size_t i = 0; i < 3 * starg_mesh_face_count(mesh); i++)
        fuzz_require(found_vertices[f[i]] == vertices[f[i]], "verifier, vertices");
    for (size_t i = 0; i < starg_mesh_face_count(mesh); i++)
        fuzz_require(found_faces[i] == faces[i], "verifier, faces");
    verify_sight_free(sight);
    verify_surface_free(surface);
}

static void look(starg_context *context, const starg_solid *solid, const double p[3]) {
    bool vertices[FUZZ_VERTICES], seen[FUZZ_FACES];
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    bool on_surface, inside = oracle_winding(v, f, m, p, &on_surface) >= 1 && !on_surface;
    fuzz_require(starg_solid_contains(solid, p) == inside, "starg_solid_contains");
    visibility_oracle_vertices(v, n, f, m, p, vertices);
    compare_engines(context, solid, p, false, STARG_FACES_VERTICES, vertices);
    for (int rule = 0; rule < 2; rule++) {
        visibility_oracle_faces(v, n, f, m, p, rule == STARG_FACES_WHOLE, seen);
        compare_engines(context, solid, p, true, (starg_face_rule)rule, seen);
        if (inside)
            compare_verifier(context, mesh, p, (starg_face_rule)rule, vertices, seen);
    }
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    shape s = fuzz_shape(&in);
    starg_mesh *mesh = fuzz_mesh(context, &s);
    starg_solid *solid = NULL;
    double p[3];
    if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
        choose_point(&in, mesh, p);
        look(context, solid, p);
    }
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    shape_free(&s);
    fuzz_context_end(context);
    return 0;
}
