/* SPDX-License-Identifier: Apache-2.0 */
/* Grown regions against their definition in rationals: every set is star-shaped about its guard,
 * and they cover everything; the effect of hints and threads. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "star/certified/region_growing.h"
#include "tetrahedra.h"

/* Outward faces of a tetrahedron with det(b - a, c - a, d - a) > 0. */
static const uint8_t SIDES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* Side of a face on which a point lies: 1 for inside. */
static int side_of(const starg_tetmesh *mesh, size_t t, size_t face, const double g[3]) {
    const uint8_t *k = SIDES[face];
    return oracle_orient3d(tetmesh_corner(mesh, t, k[0]), tetmesh_corner(mesh, t, k[1]),
                           tetmesh_corner(mesh, t, k[2]), g);
}

/* One set: each face of its boundary has the guard strictly on its inner side, and one of its
 * tetrahedra contains the guard (possibly on its border). So the set is star-shaped and
 * connected. */
static void check_set(const starg_tetmesh *mesh, const grown_regions *c, uint32_t number) {
    const double *guard = c->guards.data + 3 * (size_t)number;
    size_t holders = 0, inner = 0;
    for (size_t t = 0; t < mesh->count; t++) {
        int least = 1;
        if (c->labels[t] != number)
            continue;
        for (size_t face = 0; face < 4; face++) {
            uint32_t beyond = mesh->neighbours[4 * t + face];
            int side = side_of(mesh, t, face, guard);
            least = side < least ? side : least;
            if (beyond == STARG_TETMESH_NONE || c->labels[beyond] != number)
                assert_int_equal(side, 1);
        }
        holders += least >= 0;
        inner += least > 0;
    }
    assert_true(holders > 0);
    assert_true(inner <= 1);
    assert_true(inner == 0 || holders == 1); /* winding number one */
}

static void check_connected(const starg_tetmesh *mesh, const grown_regions *c, uint32_t number) {
    size_t size = 0, top = 0, reached = 0;
    uint32_t *stack = malloc(mesh->count * sizeof *stack);
    bool *seen = calloc(mesh->count, sizeof *seen);
    assert_non_null(stack);
    assert_non_null(seen);
    for (uint32_t t = 0; t < mesh->count; t++)
        if (c->labels[t] == number && size++ == 0) {
            stack[top++] = t;
            seen[t] = true;
        }
    while (top > 0) {
        uint32_t t = stack[--top];
        reached++;
        for (size_t face = 0; face < 4; face++) {
            uint32_t u = mesh->neighbours[4 * (size_t)t + face];
            if (u == STARG_TETMESH_NONE || seen[u] || c->labels[u] != number)
                continue;
            seen[u] = true;
            stack[top++] = u;
        }
    }
    free(stack);
    free(seen);
    assert_true(size > 0);
    assert_int_equal(reached, size);
}

static void check_regions(const starg_tetmesh *mesh, const grown_regions *c) {
    assert_int_equal(c->guards.count, 3 * c->count);
    for (size_t t = 0; t < mesh->count; t++)
        assert_true(c->labels[t] < c->count);
    for (uint32_t i = 0; i < c->count; i++) {
        check_set(mesh, c, i);
        check_connected(mesh, c, i);
    }
}

static grown_regions grow(starg_context *context, const starg_tetmesh *mesh, const double *hints,
                          size_t count) {
    grown_regions c;
    test_ok(context, grow_regions(context, mesh, hints, count, &c));
    check_regions(mesh, &c);
    return c;
}

static void assert_same(const starg_tetmesh *mesh, const grown_regions *a, const grown_regions *b) {
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->labels, b->labels, mesh->count * sizeof *a->labels);
    assert_memory_equal(a->guards.data, b->guards.data, 3 * a->count * sizeof(double));
}

/* ---- tests ---- */

static void test_random(void **state) {
    (void)state;
    static const double scales[] = {1, 0x1p-300, 0x1p300, 1};
    starg_context *context = test_context(1), *many = test_context(3);
    size_t sets = 0, tetrahedra = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        starg_tetmesh *mesh =
            random_tetmesh(context, seed, 8 + 3 * seed, seed % 3 == 1, scales[seed % 4]);
        grown_regions one = grow(context, mesh, NULL, 0), three = grow(many, mesh, NULL, 0);
        assert_same(mesh, &one, &three);
        sets += one.count;
        tetrahedra += mesh->count;
        grown_regions_free(&one);
        grown_regions_free(&three);
        starg_tetmesh_free(mesh);
    }
    assert_true(sets > 40);
    assert_true(4 * sets < tetrahedra); /* regions contain more than the guard's tetrahedron */
    test_context_free(context);
    test_context_free(many);
}

static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"horse",   "octopus", "human", "labyrinth",
                                        "gallery", "plate",   "knot",  "shell"};
    starg_context *context = test_context(2);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_tetmesh *mesh = sample_tetmesh(context, names[i], 1500);
        grown_regions c = grow(context, mesh, NULL, 0);
        assert_true(c.count > 1);
        grown_regions_free(&c);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

/* A star-shaped whole is one set, and so is every separate component. */
static void test_whole(void **state) {
    (void)state;
    static const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1,
                                      1, 5, 0, 0, 6, 0, 0, 5, 1, 0, 5, 0, 1};
    static const uint32_t tetrahedra[] = {0, 1, 2, 3, 1, 4, 2, 3, 5, 6, 7, 8};
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = sample_tetmesh(context, "sphere", 1000);
    grown_regions c = grow(context, mesh, NULL, 0);
    assert_int_equal(c.count, 1);
    grown_regions_free(&c);
    starg_tetmesh_free(mesh);
    test_ok(context, starg_tetmesh_create(context, vertices, 9, tetrahedra, 3, NULL, &mesh));
    c = grow(context, mesh, NULL, 0);
    assert_int_equal(c.count, 2);
    assert_int_equal(c.labels[0], c.labels[1]);
    grown_regions_free(&c);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* Any points are allowed: far away, at vertices, on faces, repeated. */
static void test_hints(void **state) {
    (void)state;
    starg_context *context = test_context(1), *many = test_context(3);
    size_t other = 0;
    for (uint64_t seed = 0; seed < 12; seed++) {
        starg_rng rng = starg_rng_make(seed, 91, 0);
        starg_tetmesh *mesh = random_tetmesh(context, seed, 30 + 2 * seed, seed % 3 == 1, 1);
        size_t count = (size_t)starg_rng_below(&rng, 60);
        double hints[3 * 60];
        for (size_t i = 0; i < count; i++) {
            size_t kind = (size_t)starg_rng_below(&rng, 4), corners = kind == 0 ? 4 : kind;
            size_t t = (size_t)starg_rng_below(&rng, mesh->count);
            for (int k = 0; k < 3; k++) {
                double *at = &hints[3 * i + (size_t)k];
                *at = starg_rng_below(&rng, 40) == 0 ? 9e99 : 0;
                for (size_t v = 0; v < corners; v++)
                    *at += tetmesh_corner(mesh, t, (int)v)[k] / (double)corners;
            }
        }
        grown_regions plain = grow(context, mesh, NULL, 0), one = grow(context, mesh, hints, count);
        grown_regions three = grow(many, mesh, hints, count);
        assert_same(mesh, &one, &three);
        other += one.count != plain.count ||
                 memcmp(one.guards.data, plain.guards.data, 24 * one.count) != 0;
        grown_regions_free(&plain);
        grown_regions_free(&one);
        grown_regions_free(&three);
        starg_tetmesh_free(mesh);
    }
    assert_true(other > 6); /* the hints are used */
    test_context_free(context);
    test_context_free(many);
}

/* Regions that are kept stay as they are; the rest is divided, in another way each time. */
static void test_again(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_tetmesh *mesh = sample_tetmesh(context, "octopus", 1500);
    grown_regions first, former;
    uint8_t dropped[1000];
    size_t different = 0;
    test_ok(context, grow_compatible_regions(context, mesh, mesh, &first));
    former = first;
    for (uint64_t round = 1; round <= 12; round++) {
        starg_rng rng = starg_rng_make(round, 5, 0);
        grown_regions c;
        size_t kept = 0;
        assert_in_range(former.count, 2, sizeof dropped);
        for (size_t p = 0; p < former.count; p++)
            dropped[p] = starg_rng_below(&rng, 3) == 0;
        test_ok(context, grow_compatible_again(context, mesh, mesh, &former, dropped, round, &c));
        check_regions(mesh, &c);
        for (uint32_t p = 0; p < former.count; p++) {
            if (dropped[p])
                continue;
            assert_memory_equal(c.guards.data + 3 * kept, former.guards.data + 3 * (size_t)p, 24);
            for (size_t t = 0; t < mesh->count; t++)
                assert_int_equal(former.labels[t] == p, c.labels[t] == kept);
            kept++;
        }
        different += memcmp(first.labels, c.labels, mesh->count * sizeof *c.labels) != 0;
        if (round > 1)
            grown_regions_free(&former);
        former = c;
    }
    assert_true(different > 6); /* of 12 */
    grown_regions_free(&first);
    grown_regions_free(&former);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* ---- failures ---- */

/* No double lies between one coordinate and the next: a tetrahedron without room for a guard. */
static void test_too_thin(void **state) {
    (void)state;
    static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t tetrahedron[] = {0, 1, 2, 3};
    static const double steps[] = {5e-324, 0x1p-52}, origins[] = {0, 1};
    starg_context *context = test_context(1);
    for (int i = 0; i < 2; i++) {
        double vertices[12];
        starg_tetmesh *mesh = NULL;
        grown_regions c;
        for (int k = 0; k < 12; k++)
            vertices[k] = origins[i] + steps[i] * corners[k];
        test_ok(context, starg_tetmesh_create(context, vertices, 4, tetrahedron, 1, NULL, &mesh));
        assert_int_equal(grow_regions(context, mesh, NULL, 0, &c), STARG_ERROR_MESH);
        assert_null(c.labels);
        const starg_error *error = starg_context_error(context);
        assert_int_equal(error->element, STARG_ELEMENT_TETRAHEDRON);
        assert_int_equal(error->index_count, 1);
        assert_int_equal(error->indices[0], 0);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

static void test_cancelled(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = random_tetmesh(context, 3, 60, false, 1);
    grown_regions c;
    starg_context_cancel(context);
    assert_int_equal(grow_regions(context, mesh, NULL, 0, &c), STARG_ERROR_CANCELLED);
    assert_null(c.labels);
    starg_context_reset(context);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

static void test_memory(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    size_t ration = 0;
    for (; status != STARG_OK && ration < 5000; ration += 1 + ration / 20) {
        size_t left = SIZE_MAX;
        starg_context *context = test_scarce_context(1, &left);
        starg_tetmesh *mesh = random_tetmesh(context, 5, 30, false, 1);
        grown_regions c;
        left = ration;
        status = grow_regions(context, mesh, NULL, 0, &c);
        if (status != STARG_OK)
            assert_int_equal(status, STARG_ERROR_MEMORY);
        grown_regions_free(&c);
        starg_tetmesh_free(mesh);
        test_context_free(context);
    }
    assert_int_equal(status, STARG_OK);
    assert_true(ration > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),   cmocka_unit_test(test_samples),
        cmocka_unit_test(test_whole),    cmocka_unit_test(test_hints),
        cmocka_unit_test(test_too_thin), cmocka_unit_test(test_cancelled),
        cmocka_unit_test(test_memory),   cmocka_unit_test(test_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
