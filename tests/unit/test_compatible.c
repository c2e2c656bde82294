/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces that are star-shaped in two embeddings at once, against their definition in rationals. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "decomposition_oracle.h"
#include "exact_oracle.h"
#include "geometry/vec3.h"
#include "star/certified/region_growing.h"
#include "star/certified/search.h"
#include "star/compatible/compatible.h"
#include "star/compatible/twin_pieces.h"
#include "tetra/tetmesh.h"
#include "tetrahedra.h"

/* ---- images ---- */

static double *copy_places(const starg_tetmesh *mesh) {
    double *places = malloc(3 * mesh->vertex_count * sizeof *places);
    assert_non_null(places);
    memcpy(places, mesh->vertices, 3 * mesh->vertex_count * sizeof *places);
    return places;
}

static starg_tetmesh *image_of(starg_context *context, const starg_tetmesh *mesh, double *places) {
    starg_tetmesh *image;
    test_ok(context, starg_tetmesh_create(context, places, mesh->vertex_count, mesh->tetrahedra,
                                          mesh->count, NULL, &image));
    assert_int_equal(starg_tetmesh_turned(image), 0);
    free(places);
    return image;
}

/* Sheared and stretched by powers of two: preserves star-shapedness. */
static starg_tetmesh *shear(starg_context *context, const starg_tetmesh *mesh) {
    double *places = copy_places(mesh);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        places[3 * v] += 2 * places[3 * v + 1];
        places[3 * v + 2] = 4 * places[3 * v + 2] - places[3 * v];
    }
    return image_of(context, mesh, places);
}

/* Those around a vertex, or all: STARG_TETMESH_NONE. */
static bool are_positive(const starg_tetmesh *mesh, const double *places, uint32_t vertex) {
    for (size_t t = 0; t < mesh->count; t++) {
        const uint32_t *c = mesh->tetrahedra + 4 * t;
        const double *p[4];
        if (vertex != STARG_TETMESH_NONE && c[0] != vertex && c[1] != vertex && c[2] != vertex &&
            c[3] != vertex)
            continue;
        for (size_t k = 0; k < 4; k++)
            p[k] = places + 3 * (size_t)c[k];
        if (oracle_orient3d(p[0], p[1], p[2], p[3]) >= 0)
            return false;
    }
    return true;
}

/* Bent by the square of x. */
static starg_tetmesh *bend(starg_context *context, const starg_tetmesh *mesh) {
    double *places = copy_places(mesh);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        places[3 * v + 1] += 0.35 * places[3 * v] * places[3 * v];
    return image_of(context, mesh, places);
}

/* Vertices moved one by one wherever all tetrahedra stay positive. The random meshes have holes,
 * which tetrahedra may enter: then the moves are smaller. */
static starg_tetmesh *shake(starg_context *context, const starg_tetmesh *mesh, uint64_t seed) {
    starg_tetmesh *image = NULL;
    for (double reach = 0.3; image == NULL; reach /= 2) {
        double *places = copy_places(mesh);
        starg_rng rng = starg_rng_make(seed, 0, 0);
        for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
            double before = places[i];
            places[i] += reach * (starg_rng_unit(&rng) - 0.5);
            if (!are_positive(mesh, places, (uint32_t)(i / 3)))
                places[i] = before;
        }
        starg_status status = starg_tetmesh_create(context, places, mesh->vertex_count,
                                                   mesh->tetrahedra, mesh->count, NULL, &image);
        if (status != STARG_OK)
            assert_int_equal(status, STARG_ERROR_MESH);
        free(places);
    }
    return image;
}

/* ---- checks ---- */

static void check(const starg_tetmesh *mesh, const starg_tetmesh *image,
                  starg_decomposition *const out[2]) {
    const starg_tetmesh *const meshes[2] = {mesh, image};
    assert_int_equal(out[0]->piece_count, out[1]->piece_count);
    assert_memory_equal(out[0]->labels, out[1]->labels, mesh->count * sizeof *out[0]->labels);
    for (int i = 0; i < 2; i++) {
        decomposition_oracle_check(out[i]);
        decomposition_oracle_check_connected(out[i]);
        assert_int_equal(out[i]->strictly_star, out[i]->piece_count);
        assert_memory_equal(out[i]->mesh->tetrahedra, mesh->tetrahedra,
                            4 * mesh->count * sizeof *mesh->tetrahedra);
        assert_memory_equal(out[i]->mesh->vertices, meshes[i]->vertices,
                            3 * mesh->vertex_count * sizeof(double));
    }
}

static void free_both(starg_context *context, starg_decomposition *out[2]) {
    starg_decomposition_free(context, out[0]);
    starg_decomposition_free(context, out[1]);
}

/* ---- tests ---- */

static void test_random(void **state) {
    (void)state;
    starg_context *context = test_context(1), *many = test_context(3);
    size_t pieces = 0, tetrahedra = 0;
    for (uint64_t seed = 0; seed < test_size(9, 12); seed++) {
        starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + 3 * seed, false, 1);
        starg_tetmesh *image = seed % 4 == 0 ? shear(context, mesh) : shake(context, mesh, seed);
        starg_decomposition *one[2], *three[2];
        test_ok(context, compatible_decompose(context, mesh, image, false, one));
        test_ok(many, compatible_decompose(many, mesh, image, false, three));
        check(mesh, image, one);
        assert_int_equal(one[0]->piece_count, three[0]->piece_count);
        for (int i = 0; i < 2; i++) {
            assert_memory_equal(one[i]->labels, three[i]->labels,
                                mesh->count * sizeof *one[i]->labels);
            assert_memory_equal(one[i]->pieces, three[i]->pieces,
                                one[i]->piece_count * sizeof *one[i]->pieces);
        }
        pieces += one[0]->piece_count;
        tetrahedra += mesh->count;
        free_both(context, one);
        free_both(many, three);
        starg_tetmesh_free(mesh);
        starg_tetmesh_free(image);
    }
    assert_true(2 * pieces < tetrahedra);
    test_context_free(context);
    test_context_free(many);
}

/* A solid whose image is an affine copy needs no more pieces than alone; a convex one needs one. */
static void test_affine(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = sample_tetmesh(context, "sphere", 1500), *image = shear(context, mesh);
    starg_decomposition *out[2];
    test_ok(context, compatible_decompose(context, mesh, image, false, out));
    check(mesh, image, out);
    assert_int_equal(out[0]->piece_count, 1);
    free_both(context, out);
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(image);
    test_context_free(context);
}

/* Growing groups anew saves pieces: without it there are as many as regions grown and joined once.
 */
static void test_saves(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_tetmesh *mesh = sample_tetmesh(context, "octopus", 800), *image = shear(context, mesh);
    starg_decomposition *out[2];
    grown_regions grown;
    test_ok(context, grow_compatible_regions(context, mesh, image, &grown));
    test_ok(context, compatible_decompose(context, mesh, image, false, out));
    check(mesh, image, out);
    print_message("%zu regions, %zu pieces\n", grown.count, out[0]->piece_count);
    assert_true(3 * out[0]->piece_count < 2 * grown.count);
    grown_regions_free(&grown);
    free_both(context, out);
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(image);
    test_context_free(context);
}

/* ---- cuts ---- */

static double volume_of(const starg_tetmesh *mesh) {
    int exponent = tetmesh_exponent(mesh);
    double sum = 0;
    for (size_t t = 0; t < mesh->count; t++)
        sum += tetmesh_scaled_volume(mesh, t, exponent);
    return ldexp(sum, 3 * exponent);
}

/* Tetrahedra that the cut leaves are positive, conforming, without overlap, and fill the same
 * volume; the given vertices come first. */
static void check_divided(starg_context *context, const starg_tetmesh *mesh,
                          const starg_tetmesh *made) {
    starg_tetmesh *again;
    assert_true(made->vertex_count > mesh->vertex_count && made->count > mesh->count);
    assert_memory_equal(made->vertices, mesh->vertices, 3 * mesh->vertex_count * sizeof(double));
    assert_true(are_positive(made, made->vertices, STARG_TETMESH_NONE));
    test_ok(context, starg_tetmesh_create(context, made->vertices, made->vertex_count,
                                          made->tetrahedra, made->count, NULL, &again));
    assert_int_equal(starg_tetmesh_turned(again), 0);
    assert_true(fabs(volume_of(made) - volume_of(mesh)) < 1e-9 * volume_of(mesh));
    starg_tetmesh_free(again);
}

/* Are all faces around a part seen from the guard's inner side? In rationals. */
static void check_part(const starg_tetmesh *made, const uint32_t *labels, uint32_t part,
                       const double *guard) {
    size_t count = 0;
    for (size_t face = 0; face < 4 * made->count; face++) {
        uint32_t u = made->neighbours[face];
        const double *p[3];
        if (labels[face / 4] != part || (u != STARG_TETMESH_NONE && labels[u] == labels[face / 4]))
            continue;
        for (int k = 0; k < 3; k++)
            p[k] = tetmesh_corner(made, face / 4, TETMESH_FACE[face % 4][k]);
        assert_int_equal(oracle_orient3d(p[0], p[1], p[2], guard), 1);
        count++;
    }
    assert_true(count > 0);
}

/* Points on edges are at the same ratio in both places: the map stays as it was. */
static void check_ratios(const through_cut *cut, starg_tetmesh *const made[2]) {
    size_t first = cut->meshes[0]->vertex_count;
    for (size_t e = 0; e < cut->edges.count; e++) {
        size_t ends[2] = {(size_t)(cut->edges.data[e] >> 32), (uint32_t)cut->edges.data[e]};
        double ratio[2];
        for (int i = 0; i < 2; i++) {
            const double *p = made[i]->vertices;
            double whole = vec3_distance(p + 3 * ends[0], p + 3 * ends[1]);
            ratio[i] = vec3_distance(p + 3 * ends[0], p + 3 * (first + e)) / whole;
        }
        assert_true(fabs(ratio[0] - ratio[1]) < 1e-9);
    }
}

/* A random plane through a ball or, with `half`, through the tetrahedra on one side of it. Returns
 * whether there are guards. */
static bool check_plane(starg_context *context, const starg_tetmesh *mesh,
                        const starg_tetmesh *image, bool half, uint64_t seed) {
    through_cut cut = {.context = context, .meshes = {mesh, image}};
    uint8_t *inside = calloc(mesh->count, 1);
    uint32_t *labels = calloc(mesh->count, sizeof *labels), *made_labels;
    starg_tetmesh *made[2];
    double normal[3], offset, guards[2][2][3];
    bool found, good;
    starg_rng rng = starg_rng_make(seed, 2, 0);
    cut.levels = calloc(mesh->vertex_count, sizeof *cut.levels);
    assert_true(inside != NULL && labels != NULL && cut.levels != NULL);
    for (int k = 0; k < 3; k++)
        normal[k] = starg_rng_unit(&rng) - 0.5;
    offset = 0.1 * (starg_rng_unit(&rng) - 0.5);
    for (size_t t = 0; t < mesh->count; t++) {
        inside[t] = !half || tetmesh_corner(mesh, t, 0)[0] < 0;
        for (int k = 0; k < 4 && inside[t]; k++) {
            const double *p = tetmesh_corner(mesh, t, k);
            cut.levels[mesh->tetrahedra[4 * t + (size_t)k]] =
                p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2] - offset;
        }
    }
    cut.inside = inside;
    test_ok(context, through_find(&cut, guards, &found));
    test_ok(context, through_divide(&cut, labels, made, &made_labels, &good));
    assert_true(good);
    check_ratios(&cut, made);
    for (int i = 0; i < 2; i++) {
        check_divided(context, cut.meshes[i], made[i]);
        for (int part = 0; part < 2 && found; part++)
            check_part(made[i], made_labels, THROUGH_PART + (uint32_t)part, guards[part][i]);
        starg_tetmesh_free(made[i]);
    }
    starg_release(context, made_labels);
    through_free(&cut);
    free(cut.levels);
    free(inside);
    free(labels);
    return found;
}

/* Convex, or nearly: both halves have guards in both places. */
static void test_cuts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = sample_tetmesh(context, "sphere", 1500), *image = bend(context, mesh);
    for (uint64_t seed = 0; seed < 6; seed++) {
        assert_true(check_plane(context, mesh, image, false, seed));
        check_plane(context, mesh, image, true, seed);
    }
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(image);
    test_context_free(context);
}

/* ---- planes ---- */

/* Parts between planes: in both places the tetrahedra are divided and filled as before, and each
 * part is star-shaped about its guard. Returns their number. */
static size_t check_planes(starg_context *context, const starg_tetmesh *mesh,
                           const starg_tetmesh *image) {
    const starg_tetmesh *const meshes[2] = {mesh, image};
    starg_tetmesh *own[2];
    grown_regions parts;
    test_ok(context, compatible_planes(context, meshes, 0, own, &parts));
    for (int i = 0; i < 2; i++) {
        const double *guards = i == 0 ? parts.guards.data : parts.counterparts.data;
        const starg_tetmesh *made = own[i] != NULL ? own[i] : meshes[i];
        if (own[i] != NULL)
            check_divided(context, meshes[i], own[i]);
        for (uint32_t part = 0; part < parts.count; part++)
            check_part(made, parts.labels, part, guards + 3 * (size_t)part);
    }
    if (own[0] != NULL)
        assert_memory_equal(own[0]->tetrahedra, own[1]->tetrahedra,
                            4 * own[0]->count * sizeof *own[0]->tetrahedra);
    size_t count = parts.count;
    grown_regions_free(&parts);
    starg_tetmesh_free(own[0]);
    starg_tetmesh_free(own[1]);
    return count;
}

static void test_planes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < test_size(9, 12); seed++) {
        starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + 3 * seed, false, 1);
        starg_tetmesh *image = seed % 4 == 0 ? shear(context, mesh) : shake(context, mesh, seed);
        check_planes(context, mesh, image);
        starg_tetmesh_free(mesh);
        starg_tetmesh_free(image);
    }
    test_context_free(context);
}

/* Few parts between planes where many regions grow; no more pieces than either way alone. */
static void test_planes_save(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_tetmesh *mesh = sample_tetmesh(context, "gallery", test_size(1000, 1500)),
                  *image = bend(context, mesh);
    starg_decomposition *whole[2], *cut[2];
    grown_regions grown;
    size_t parts = check_planes(context, mesh, image);
    test_ok(context, compatible_decompose(context, mesh, image, false, whole));
    test_ok(context, compatible_decompose(context, mesh, image, true, cut));
    test_ok(context, grow_compatible_regions(context, mesh, image, &grown));
    print_message("%zu regions, %zu parts, %zu pieces, %zu without cuts\n", grown.count, parts,
                  cut[0]->piece_count, whole[0]->piece_count);
    assert_true(2 * parts < grown.count);
    assert_true(cut[0]->piece_count <= parts && cut[0]->piece_count <= whole[0]->piece_count);
    for (int i = 0; i < 2; i++) {
        decomposition_oracle_check(cut[i]);
        decomposition_oracle_check_connected(cut[i]);
        assert_int_equal(cut[i]->strictly_star, cut[i]->piece_count);
        if (cut[i]->mesh->count > mesh->count)
            check_divided(context, i == 0 ? mesh : image, cut[i]->mesh);
    }
    grown_regions_free(&grown);
    free_both(context, whole);
    free_both(context, cut);
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(image);
    test_context_free(context);
}

static void test_memory(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    size_t ration = 0;
    starg_context *plenty = test_context(1);
    starg_tetmesh *mesh = random_tetmesh(plenty, 5, 30, false, 1);
    starg_tetmesh *image = shake(plenty, mesh, 5);
    for (; status != STARG_OK && ration < 200000; ration += 1 + ration / test_size(2, 8)) {
        size_t left = SIZE_MAX;
        starg_context *context = test_scarce_context(1, &left);
        starg_decomposition *out[2];
        left = ration;
        status = compatible_decompose(context, mesh, image, true, out);
        left = SIZE_MAX;
        if (status != STARG_OK) {
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_null(out[0]);
            assert_null(out[1]);
        }
        free_both(context, out);
        test_context_free(context);
    }
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(image);
    test_context_free(plenty);
    assert_int_equal(status, STARG_OK);
    assert_true(ration > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random), cmocka_unit_test(test_affine),
        cmocka_unit_test(test_saves),  cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_planes), cmocka_unit_test(test_planes_save),
        cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
