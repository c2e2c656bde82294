/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier of star decompositions on real models. Every tetrahedron as a separate piece, with
 * guards proven by rationals, is a strict decomposition that must pass, for each generator of
 * tetrahedra; with an error anywhere it must fail. A whole solid as one piece is star-shaped
 * exactly if the library's own, independent proof says so for the same guard. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "starguard/kernel.h"
#include "starguard/verify.h"
#include "support.h"

static const uint8_t SIDES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* A decomposition of a tetrahedral mesh in separate arrays. */
typedef struct result {
    starg_pieces_mesh mesh;
    starg_pieces_report report;
} result;

static void *copy(const void *from, size_t size) {
    void *block = malloc(size);
    assert_non_null(block);
    memcpy(block, from, size);
    return block;
}

static const double *corner(const result *r, size_t tetrahedron, int i) {
    return r->mesh.vertices + 3 * (size_t)r->mesh.tetrahedra[4 * tetrahedron + (size_t)i];
}

static long double volume_of(const result *r, size_t t) {
    long double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (long double)corner(r, t, i + 1)[k] - corner(r, t, 0)[k];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
}

static double area_of(const result *r, size_t t, int side) {
    long double e[2][3], n[3];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] =
                (long double)corner(r, t, SIDES[side][i + 1])[k] - corner(r, t, SIDES[side][0])[k];
    for (int k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    return (double)(sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2);
}

/* Places the guard at the centroid; is it strictly inside after rounding? */
static void place_guard(const result *r, size_t t, starg_piece *piece) {
    piece->star = true;
    piece->radius = NAN;
    for (int k = 0; k < 3; k++)
        piece->guard[k] =
            (corner(r, t, 0)[k] + corner(r, t, 1)[k] + corner(r, t, 2)[k] + corner(r, t, 3)[k]) / 4;
    for (int i = 0; i < 4; i++)
        piece->star =
            piece->star &&
            oracle_orient3d(corner(r, t, SIDES[i][0]), corner(r, t, SIDES[i][1]),
                            corner(r, t, SIDES[i][2]), piece->guard) ==
                oracle_orient3d(corner(r, t, 0), corner(r, t, 2), corner(r, t, 1), corner(r, t, 3));
}

static result make_result(const starg_tetmesh *tetmesh) {
    size_t count = starg_tetmesh_count(tetmesh), vertices = starg_tetmesh_vertex_count(tetmesh);
    const uint32_t *neighbours = starg_tetmesh_neighbours(tetmesh);
    result r = {
        {.vertex_count = vertices,
         .count = count,
         .vertices = copy(starg_tetmesh_vertices(tetmesh), 3 * vertices * sizeof(double)),
         .tetrahedra = copy(starg_tetmesh_tetrahedra(tetmesh), 4 * count * sizeof(uint32_t)),
         .labels = calloc(count, sizeof(int32_t))},
        {.tetrahedra = count,
         .piece_count = count,
         .pieces = calloc(count, sizeof(starg_piece)),
         .contacts = calloc(4 * count, sizeof(starg_piece_contact)),
         .visible_vertices = 1}};
    for (size_t t = 0; t < count; t++) {
        starg_piece *piece = &r.report.pieces[t];
        r.mesh.labels[t] = (int32_t)t;
        piece->tetrahedra = 1;
        piece->volume = (double)volume_of(&r, t);
        place_guard(&r, t, piece);
        r.report.strictly_star += piece->star;
        for (int i = 0; i < 4; i++) {
            uint32_t other = neighbours[4 * t + (size_t)i];
            if (other != STARG_TETMESH_NONE && other > t)
                r.report.contacts[r.report.contact_count++] =
                    (starg_piece_contact){(uint32_t)t, other, area_of(&r, t, i)};
        }
    }
    return r;
}

static void free_result(result *r) {
    free(r->mesh.vertices);
    free(r->mesh.tetrahedra);
    free(r->mesh.labels);
    free(r->report.pieces);
    free(r->report.contacts);
}

/* ---- verdicts ---- */

static bool passes(starg_context *context, const starg_mesh *model, const result *r, bool tell) {
    starg_verdict *verdict = NULL;
    test_ok(context, starg_verify_pieces(context, model, &r->mesh, &r->report, &verdict));
    bool passed = verdict->passed;
    for (size_t i = 0; i < verdict->count && tell; i++)
        if (!verdict->claims[i].holds)
            print_error("%s\n", verdict->claims[i].text);
    starg_verdict_free(context, verdict);
    return passed;
}

enum { SPOILINGS = 7 };

/* Corrupts a copy at a random place. */
static result spoil(const result *truth, int kind, starg_rng *rng) {
    result r = *truth;
    size_t n = r.mesh.count, t = (size_t)starg_rng_below(rng, n), k = starg_rng_below(rng, 3);
    r.mesh.vertices = copy(r.mesh.vertices, 3 * r.mesh.vertex_count * sizeof(double));
    r.mesh.tetrahedra = copy(r.mesh.tetrahedra, 4 * n * sizeof(uint32_t));
    r.mesh.labels = copy(r.mesh.labels, n * sizeof(int32_t));
    r.report.pieces = copy(r.report.pieces, n * sizeof(starg_piece));
    r.report.contacts = copy(r.report.contacts, 4 * n * sizeof(starg_piece_contact));
    uint32_t *v = r.mesh.tetrahedra + 4 * t;
    const double *guard = r.report.pieces[(t + 1) % n].guard;
    switch (kind) {
    case 0: /* the guard of another piece */
        memcpy(r.report.pieces[t].guard, guard, 3 * sizeof *guard);
        break;
    case 1: /* two labels exchanged */
        r.mesh.labels[t] = (int32_t)((t + 1) % n);
        r.mesh.labels[(t + 1) % n] = (int32_t)t;
        break;
    case 2: /* a vertex moved by much less than a tetrahedron, or to another place */
        r.mesh.vertices[3 * (size_t)v[0] + k] = r.mesh.vertices[3 * (size_t)v[1] + k];
        break;
    case 3: /* inverted */
        v[3] ^= v[2];
        v[2] ^= v[3];
        v[3] ^= v[2];
        break;
    case 4: /* dropped, with its label */
        memmove(v, v + 4, 4 * (n - t - 1) * sizeof *v);
        r.mesh.count--;
        break;
    case 5: /* a volume */
        r.report.pieces[t].volume *= 1 + 1e-7;
        break;
    default: /* a contact */
        t = (size_t)starg_rng_below(rng, r.report.contact_count);
        r.report.contacts[t].second = (uint32_t)((r.report.contacts[t].second + 1) % n);
    }
    return r;
}

/* Moving a coordinate to its old value changes nothing. */
static bool same_vertices(const result *a, const result *b) {
    return memcmp(a->mesh.vertices, b->mesh.vertices, 3 * a->mesh.vertex_count * sizeof(double)) ==
           0;
}

static void check_model(starg_context *context, const char *name, const starg_mesh *model,
                        const starg_tetmesh *tetmesh, const starg_tetra_report *made,
                        uint64_t seed) {
    result r = make_result(tetmesh);
    r.report.mode =
        r.report.strictly_star == r.mesh.count ? STARG_DECOMPOSE_STRICT : STARG_DECOMPOSE_PAPER;
    r.report.approximated = !made->surface_kept;
    r.report.distance = made->to_surface + made->step;
    r.report.distance_back = made->from_surface + made->step;
    if (!passes(context, model, &r, true))
        fail_msg("%s: does not pass", name);
    for (int kind = 0; kind < SPOILINGS; kind++) {
        starg_rng rng = starg_rng_make(seed, 41, (uint64_t)kind);
        result bad = spoil(&r, kind, &rng);
        if ((kind != 2 || !same_vertices(&bad, &r)) && passes(context, model, &bad, false))
            fail_msg("%s: passes with spoiling %d", name, kind);
        free_result(&bad);
    }
    free_result(&r);
}

/* ---- one piece ---- */

static void check_whole(starg_context *context, const char *name, const starg_mesh *model,
                        const starg_tetmesh *tetmesh) {
    starg_kernel_result kernel;
    starg_verdict *verdict = NULL;
    starg_mesh *surface = NULL;
    test_ok(context, starg_tetmesh_surface(context, tetmesh, &surface, NULL));
    test_ok(context, starg_kernel(context, surface, NULL, &kernel));
    result r = make_result(tetmesh);
    memset(r.mesh.labels, 0, r.mesh.count * sizeof *r.mesh.labels);
    bool star = kernel.verdict == STARG_KERNEL_INTERIOR;
    starg_piece piece = {.tetrahedra = r.mesh.count,
                         .volume = starg_tetmesh_volume(tetmesh),
                         .star = star,
                         .radius = NAN};
    memcpy(piece.guard, kernel.guard, sizeof kernel.guard);
    r.report.pieces[0] = piece;
    r.report.piece_count = 1;
    r.report.contact_count = 0;
    r.report.strictly_star = star;
    r.report.mode = STARG_DECOMPOSE_PAPER;
    test_ok(context, starg_verify_pieces(context, model, &r.mesh, &r.report, &verdict));
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        if (!claim->holds && (star || strstr(claim->text, "vertices") == NULL))
            fail_msg("%s: %s", name, claim->text);
    }
    starg_verdict_free(context, verdict);
    starg_mesh_free(surface);
    free_result(&r);
}

/* ---- models ---- */

static void check_file(starg_context *context, const char *data, const char *file,
                       starg_tetra_generator generator, size_t target, uint64_t seed) {
    char path[4300];
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_tetmesh *tetmesh = NULL;
    starg_tetra_options options;
    starg_tetra_report made;
    starg_tetra_options_default(&options);
    options.generator = generator;
    options.density = 0;
    options.target = target;
    snprintf(path, sizeof path, "%s/%s", data, file);
    test_ok(context, starg_mesh_read(context, path, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_tetmesh_from_solid(context, solid, &options, &made, &tetmesh));
    check_model(context, file, mesh, tetmesh, &made, seed);
    if (made.surface_kept)
        check_whole(context, file, mesh, tetmesh);
    starg_tetmesh_free(tetmesh);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
}

static void test_models(void **state) {
    (void)state;
    static const char *const files[] = {"solids/hand_1197.off", "solids/shell_309.off",
                                        "solids/octopus_124.off", "solids/knight_502.off"};
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const bool both = test_rounds(0, 1) > 0; /* else one of the two for each */
        if (both || i % 2 == 0)
            check_file(context, data, files[i], STARG_TETRA_AUTO, 0, i);
        if (both || i % 2 == 1)
            check_file(context, data, files[i], STARG_TETRA_STUFFING, 1500, i);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
