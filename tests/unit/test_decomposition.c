/* SPDX-License-Identifier: Apache-2.0 */
/* Reports about pieces, for random labels and guards on random tetrahedra, against brute force in
 * rationals; files contain what was reported. */
#include "support.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/rng.h"
#include "decomposition_oracle.h"
#include "shapes.h"
#include "star/decomposition.h"
#include "starguard/check.h"
#include "starguard/decompose.h"
#include "tetra/tetmesh.h"
#include "tetrahedra.h"

/* ---- random input ---- */

/* A guard at the centre of a tetrahedron, of one of its faces or edges, at a vertex, or far
 * away. */
static void random_guard(starg_rng *rng, const starg_tetmesh *mesh, size_t tetrahedron,
                         double out[3]) {
    int corners = (int)starg_rng_below(rng, 6);
    corners = corners == 0 || corners == 5 ? 4 : corners;
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int c = 0; c < corners; c++)
            out[k] += tetmesh_corner(mesh, tetrahedron, c)[k] / corners;
    }
    if (starg_rng_below(rng, 16) == 0)
        out[0] += 2 * fabs(tetmesh_corner(mesh, tetrahedron, 0)[0]) + 1e-3;
}

/* Labels grown from random tetrahedra, or random ones; every label occurs. */
static int32_t *random_labels(starg_context *context, starg_rng *rng, const starg_tetmesh *mesh,
                              size_t pieces, double *guards) {
    int32_t *labels = starg_allocate(context, mesh->count, sizeof *labels);
    assert_non_null(labels);
    bool scattered = starg_rng_below(rng, 4) == 0;
    for (size_t t = 0; t < mesh->count; t++)
        labels[t] = scattered ? (int32_t)starg_rng_below(rng, pieces) : -1;
    for (size_t p = 0; p < pieces; p++) {
        size_t t = p * mesh->count / pieces;
        labels[t] = (int32_t)p;
        random_guard(rng, mesh, t, guards + 3 * p);
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t f = 0; f < 4 * mesh->count; f++) {
            uint32_t next = mesh->neighbours[f];
            if (labels[f / 4] >= 0 || next == STARG_TETMESH_NONE || labels[next] < 0)
                continue;
            labels[f / 4] = labels[next];
            changed = true;
        }
    }
    for (size_t t = 0; t < mesh->count; t++)
        if (labels[t] < 0)
            labels[t] = 0;
    return labels;
}

static starg_decomposition *random_result(starg_context *context, uint64_t seed, double scale) {
    starg_rng rng = starg_rng_make(seed, 12, 0);
    starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + seed % 24, seed % 3 == 1, scale);
    starg_decomposition *d = NULL;
    double guards[3 * 1000];
    assert_true(mesh->count <= 1000);
    /* many pieces, or few */
    size_t pieces = seed % 2 == 0 ? 1 + starg_rng_below(&rng, mesh->count)
                                  : 1 + starg_rng_below(&rng, 1 + mesh->count / 8);
    int32_t *labels = random_labels(context, &rng, mesh, pieces, guards);
    test_ok(context,
            decomposition_finish(context, STARG_DECOMPOSE_PAPER, mesh, labels, guards, pieces, &d));
    assert_int_equal(d->piece_count, pieces);
    for (size_t p = 0; p < pieces; p++)
        assert_memory_equal(d->pieces[p].guard, guards + 3 * p, 3 * sizeof *guards);
    return d;
}

static void test_random(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t stars = 0, others = 0;
    for (uint64_t seed = 0; seed < 48; seed++) {
        starg_decomposition *d = random_result(context, seed, 1);
        decomposition_oracle_check(d);
        decomposition_oracle_check_sight(d);
        stars += d->strictly_star;
        others += d->piece_count - d->strictly_star;
        starg_decomposition_free(context, d);
    }
    assert_true(stars > 150); /* both kinds occurred */
    assert_true(others > 150);
    starg_decomposition_free(context, NULL);
    test_context_free(context);
}

/* Lengths, areas and volumes that fit doubles are correct at any scale. */
static void test_scales(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const double scales[] = {0x1p-300, 0x1p-90, 0x1p90, 0x1p300};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            double s = scales[i];
            starg_decomposition *unit = random_result(context, seed, 1);
            starg_decomposition *d = random_result(context, seed, s);
            assert_int_equal(d->piece_count, unit->piece_count);
            assert_int_equal(d->contact_count, unit->contact_count);
            for (size_t p = 0; p < d->piece_count; p++) {
                /* guards displaced by a fixed length are excluded */
                if (fabs(d->pieces[p].guard[0] - s * unit->pieces[p].guard[0]) > 0)
                    continue;
                assert_int_equal(d->pieces[p].star, unit->pieces[p].star);
                assert_true(d->pieces[p].radius == s * unit->pieces[p].radius);
                assert_true(d->pieces[p].volume == s * s * s * unit->pieces[p].volume);
            }
            for (size_t c = 0; c < d->contact_count; c++)
                assert_true(d->contacts[c].area == s * s * unit->contacts[c].area);
            starg_decomposition_free(context, unit);
            starg_decomposition_free(context, d);
        }
    test_context_free(context);
}

/* ---- surfaces ---- */

static void check_surface(starg_context *context, const starg_decomposition *d,
                          const starg_mesh *all, const uint32_t *first, size_t piece,
                          uint32_t *next_vertex) {
    size_t count = first[piece + 1] - first[piece];
    const uint32_t *faces = starg_mesh_faces(all) + 3 * (size_t)first[piece];
    starg_mesh *own = NULL;
    uint32_t most = *next_vertex;
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(faces[i] >= *next_vertex); /* no vertex of an earlier piece */
        most = faces[i] > most ? faces[i] : most;
    }
    /* every edge equally often in both directions */
    for (size_t i = 0; i < 3 * count; i++) {
        uint32_t a = faces[i], b = faces[i % 3 == 2 ? i - 2 : i + 1];
        int balance = 0;
        for (size_t j = 0; j < 3 * count; j++) {
            uint32_t from = faces[j], to = faces[j % 3 == 2 ? j - 2 : j + 1];
            balance += (from == a && to == b) - (from == b && to == a);
        }
        assert_int_equal(balance, 0);
    }
    test_ok(context, starg_mesh_create(context, starg_mesh_vertices(all),
                                       starg_mesh_vertex_count(all), faces, count, &own));
    assert_true(fabs(starg_mesh_volume(own) - d->pieces[piece].volume) < 1e-12);
    starg_mesh_free(own);
    *next_vertex = most + 1;
}

static void test_surfaces(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 12; seed++) {
        starg_decomposition *d = random_result(context, seed, 1);
        starg_mesh *all = NULL;
        uint32_t *first = NULL, next_vertex = 0;
        test_ok(context, starg_decomposition_surfaces(context, d, &all, &first));
        assert_int_equal(first[0], 0);
        for (size_t p = 0; p < d->piece_count; p++)
            check_surface(context, d, all, first, p, &next_vertex);
        assert_int_equal(first[d->piece_count], starg_mesh_face_count(all));
        assert_int_equal(next_vertex, starg_mesh_vertex_count(all));
        starg_tetmesh_map_free(context, first);
        starg_mesh_free(all);
        starg_decomposition_free(context, d);
    }
    test_context_free(context);
}

/* ---- files ---- */

static double number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void check_report(const starg_decomposition *d, const char *path) {
    json_error_t error;
    json_t *report = json_load_file(path, 0, &error);
    assert_non_null(report);
    assert_string_equal(json_string_value(json_object_get(report, "format")), "starguard-pieces");
    assert_true(number(report, "version") == 1);
    assert_string_equal(json_string_value(json_object_get(report, "mode")), "paper");
    assert_true(number(report, "tetrahedra") == (double)starg_tetmesh_count(d->mesh));
    assert_true(number(report, "strictly_star") == (double)d->strictly_star);
    assert_true(number(report, "visible_vertices") == d->visible_vertices);
    const json_t *model = json_object_get(report, "model");
    assert_string_equal(json_string_value(json_object_get(model, "file")), "a \"model\"?");
    const json_t *pieces = json_object_get(report, "pieces");
    assert_int_equal(json_array_size(pieces), d->piece_count);
    for (size_t p = 0; p < d->piece_count; p++) {
        const json_t *piece = json_array_get(pieces, p), *guard = json_object_get(piece, "guard");
        for (size_t k = 0; k < 3; k++)
            assert_true(json_number_value(json_array_get(guard, k)) == d->pieces[p].guard[k]);
        assert_true(number(piece, "tetrahedra") == (double)d->pieces[p].tetrahedra);
        assert_true(number(piece, "volume") == d->pieces[p].volume);
        assert_true(number(piece, "radius") == d->pieces[p].radius);
        assert_int_equal(json_is_true(json_object_get(piece, "star")), d->pieces[p].star);
    }
    const json_t *contacts = json_object_get(report, "adjacency");
    assert_int_equal(json_array_size(contacts), d->contact_count);
    for (size_t i = 0; i < d->contact_count; i++) {
        const json_t *c = json_array_get(contacts, i);
        assert_true(json_number_value(json_array_get(c, 0)) == d->contacts[i].first);
        assert_true(json_number_value(json_array_get(c, 1)) == d->contacts[i].second);
        assert_true(json_number_value(json_array_get(c, 2)) == d->contacts[i].area);
    }
    json_decref(report);
}

static void check_grid(starg_context *context, const starg_decomposition *d, const char *path) {
    starg_tetmesh *read = NULL;
    test_ok(context, starg_tetmesh_read(context, path, &read));
    size_t count = starg_tetmesh_count(d->mesh);
    assert_int_equal(starg_tetmesh_count(read), count);
    assert_int_equal(starg_tetmesh_turned(read), 0);
    assert_memory_equal(starg_tetmesh_tetrahedra(read), starg_tetmesh_tetrahedra(d->mesh),
                        16 * count);
    assert_memory_equal(starg_tetmesh_vertices(read), starg_tetmesh_vertices(d->mesh),
                        24 * starg_tetmesh_vertex_count(d->mesh));
    if (d->piece_count > 1)
        assert_memory_equal(starg_tetmesh_regions(read), d->labels, 4 * count);
    starg_tetmesh_free(read);
}

static void test_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char grid[] = "/tmp/starguard-grid-XXXXXX", report[] = "/tmp/starguard-report-XXXXXX";
    int files[] = {mkstemp(grid), mkstemp(report)};
    for (uint64_t seed = 0; seed < 8; seed++) {
        starg_decomposition *d = random_result(context, seed, 1);
        test_ok(context, starg_decomposition_write(context, d, grid, seed % 2 == 0));
        test_ok(context, starg_decomposition_write_report(context, d, "a \"model\"\xff", report));
        check_grid(context, d, grid);
        check_report(d, report);
        starg_decomposition_free(context, d);
    }
    starg_decomposition *d = random_result(context, 0, 1);
    assert_int_equal(starg_decomposition_write_report(context, d, NULL, "/nowhere/at/all"),
                     STARG_ERROR_WRITE);
    assert_int_equal(starg_decomposition_write(context, d, "/nowhere/at/all", false),
                     STARG_ERROR_WRITE);
    starg_decomposition_free(context, d);
    for (int i = 0; i < 2; i++)
        close(files[i]);
    unlink(grid);
    unlink(report);
    test_context_free(context);
}

/* Reading both files and writing them again gives the same bytes. */
static void check_reread(starg_context *context, const char *grid, const char *report,
                         bool binary) {
    starg_decomposition *d = NULL;
    char *bytes[4], again[] = "/tmp/starguard-again-XXXXXX";
    size_t sizes[4];
    close(mkstemp(again));
    test_ok(context, starg_decomposition_read(context, grid, report, &d));
    test_ok(context, starg_file_read(context, "test", grid, &bytes[0], &sizes[0]));
    test_ok(context, starg_file_read(context, "test", report, &bytes[1], &sizes[1]));
    test_ok(context, starg_decomposition_write(context, d, again, binary));
    test_ok(context, starg_file_read(context, "test", again, &bytes[2], &sizes[2]));
    test_ok(context, starg_decomposition_write_report(context, d, d->file, again));
    test_ok(context, starg_file_read(context, "test", again, &bytes[3], &sizes[3]));
    unlink(again);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(sizes[i], sizes[i + 2]);
        assert_memory_equal(bytes[i], bytes[i + 2], sizes[i]);
    }
    for (int i = 0; i < 4; i++)
        starg_release(context, bytes[i]);
    starg_decomposition_free(context, d);
}

/* Any result at any scale, from tetrahedra or a surface, kept or approximated. */
static void test_read_back(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char grid[] = "/tmp/starguard-grid-XXXXXX", report[] = "/tmp/starguard-report-XXXXXX";
    close(mkstemp(grid));
    close(mkstemp(report));
    for (uint64_t seed = 0; seed < 24; seed++) {
        starg_decomposition *d = random_result(context, seed, seed % 4 == 0 ? 0x1p300 : 1);
        if (seed % 3 > 0) {
            d->model_faces = 10;
            d->model_tetrahedra = 0;
            d->tetra.surface_kept = seed % 3 == 1;
            d->tetra.distance = 0.1;
            d->tetra.distance_back = 0.25;
        }
        test_ok(context, starg_decomposition_write(context, d, grid, seed % 2 == 0));
        test_ok(context,
                starg_decomposition_write_report(context, d, seed % 5 ? "m.off" : NULL, report));
        check_reread(context, grid, report, seed % 2 == 0);
        starg_decomposition_free(context, d);
    }
    unlink(grid);
    unlink(report);
    test_context_free(context);
}

/* Pairs of files that are valid alone but do not match, and inconsistent reports. */
static void test_bad_pairs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char grid[] = "/tmp/starguard-grid-XXXXXX", report[] = "/tmp/starguard-report-XXXXXX";
    close(mkstemp(grid));
    close(mkstemp(report));
    for (int kind = 0; kind < 5; kind++) {
        starg_decomposition *d = random_result(context, 2, 1), *read = NULL;
        test_ok(context, starg_decomposition_write(context, d, grid, false));
        if (kind == 0)
            d->tetrahedra++;
        else if (kind == 1)
            d->pieces[0].tetrahedra++;
        else if (kind == 2)
            d->strictly_star++;
        else if (kind == 3)
            d->contacts[0].second = (uint32_t)d->piece_count;
        else
            d->labels[0]++;
        if (kind == 4)
            test_ok(context, starg_decomposition_write(context, d, grid, false));
        test_ok(context, starg_decomposition_write_report(context, d, NULL, report));
        starg_status status = starg_decomposition_read(context, grid, report, &read);
        assert_int_equal(status, STARG_ERROR_FORMAT);
        assert_null(read);
        starg_decomposition_free(context, d);
    }
    unlink(grid);
    unlink(report);
    test_context_free(context);
}

/* ---- from solids ---- */

static starg_solid *solid_of(starg_context *context, const shape *s) {
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    test_ok(context, starg_mesh_create(context, s->vertices, s->vertex_count, s->faces,
                                       s->face_count, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_mesh_free(mesh);
    return solid;
}

static void test_solids(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape shapes[] = {shape_tetrahedron(), shape_cube(2), shape_room(), shape_cavity(),
                      shape_blob(1, 5)};
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    assert_int_equal(options.mode, STARG_DECOMPOSE_STRICT);
    options.tetra.density = 4;
    options.effort = 200;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        starg_solid *solid = solid_of(context, &shapes[i]);
        for (int generator = 0; generator < 2; generator++) {
            starg_decomposition *d = NULL;
            options.tetra.generator = generator == 0 ? STARG_TETRA_AUTO : STARG_TETRA_STUFFING;
            test_ok(context, starg_decompose(context, solid, &options, &d));
            decomposition_oracle_check(d);
            assert_int_equal(d->strictly_star, d->piece_count);
            assert_true(d->visible_vertices == 1);
            assert_int_equal(d->model_vertices, shapes[i].vertex_count);
            assert_int_equal(d->model_faces, shapes[i].face_count);
            assert_int_equal(d->model_tetrahedra, 0);
            if (d->tetra.surface_kept)
                assert_true(fabs(starg_tetmesh_volume(d->mesh) - starg_solid_check(solid)->volume) <
                            1e-9);
            starg_decomposition_free(context, d);
        }
        starg_solid_free(solid);
        shape_free(&shapes[i]);
    }
    test_context_free(context);
}

static void test_arguments(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = random_tetmesh(context, 3, 10, false, 1);
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    starg_decomposition *d = NULL;
    options.effort = 50;
    test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
    assert_int_equal(d->model_tetrahedra, starg_tetmesh_count(mesh));
    assert_int_equal(d->model_vertices, 10);
    assert_true(d->tetra.surface_kept);
    starg_decomposition_free(context, d);
    const double odd[] = {0, 0, 0, 1, NAN, 0};
    options.guards = odd;
    options.guard_count = 2;
    assert_int_equal(starg_decompose_tetmesh(context, mesh, &options, &d), STARG_ERROR_ARGUMENT);
    assert_null(d);
    assert_int_equal(starg_context_error(context)->element, STARG_ELEMENT_GUARD);
    assert_int_equal(starg_context_error(context)->indices[0], 1);
    options.guards = NULL;
    options.mode = (starg_decompose_mode)7;
    assert_int_equal(starg_decompose_tetmesh(context, mesh, &options, &d), STARG_ERROR_ARGUMENT);
    assert_null(d);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* ---- memory ---- */

/* Everything in one go; true if the ration was enough. */
static bool run_rationed(size_t ration, const char *report) {
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    starg_decomposition *d = NULL;
    starg_mesh *all = NULL;
    uint32_t *first = NULL;
    double guards[3 * 4] = {0};
    starg_rng rng = starg_rng_make(1, 2, 3);
    starg_tetmesh *mesh = random_tetmesh(context, 5, 20, false, 1);
    int32_t *labels = random_labels(context, &rng, mesh, 4, guards);
    left = ration;
    starg_status status =
        decomposition_finish(context, STARG_DECOMPOSE_PAPER, mesh, labels, guards, 4, &d);
    if (status == STARG_OK)
        status = starg_decomposition_surfaces(context, d, &all, &first);
    if (status == STARG_OK)
        status = starg_decomposition_write_report(context, d, "m", report);
    if (status != STARG_OK)
        assert_int_equal(status, STARG_ERROR_MEMORY);
    starg_tetmesh_map_free(context, first);
    starg_mesh_free(all);
    starg_decomposition_free(context, d);
    test_context_free(context);
    return status == STARG_OK;
}

static void test_memory(void **state) {
    (void)state;
    size_t ration = 0;
    char report[] = "/tmp/starguard-report-XXXXXX";
    close(mkstemp(report));
    while (!run_rationed(ration, report))
        ration++;
    unlink(report);
    assert_in_range(ration, 20, 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),   cmocka_unit_test(test_scales),
        cmocka_unit_test(test_surfaces), cmocka_unit_test(test_files),
        cmocka_unit_test(test_solids),   cmocka_unit_test(test_arguments),
        cmocka_unit_test(test_memory),   cmocka_unit_test(test_read_back),
        cmocka_unit_test(test_bad_pairs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
