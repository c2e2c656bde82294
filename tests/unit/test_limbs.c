/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids cut alike at their limbs: pairs of limbs fit together, pieces fill the solids, and
 * tetrahedra are positive in both, in rationals. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "morph/limbs.h"
#include "starguard/sample.h"

enum { VERTICES = 60 };

/* A solid of cubes, a tree of corridors or a slab with teeth. */
typedef struct model {
    starg_mesh *mesh;
    starg_solid *solid;
} model;

static model make_model(starg_context *context, const char *name, uint64_t seed) {
    starg_sample_options options;
    model out;
    starg_sample_options_default(&options);
    const bool cubes = strstr("maze comb polycube", name) != NULL;
    options.vertex_count = cubes ? VERTICES : 500;
    context->seed = seed;
    test_ok(context, starg_sample_create(context, name, &options, &out.mesh));
    test_ok(context, starg_solid_create(context, out.mesh, &out.solid));
    return out;
}

static void free_model(model *m) {
    starg_solid_free(m->solid);
    starg_mesh_free(m->mesh);
}

/* ---- pairs ---- */

/* Limbs that meet in one tree meet in the other: joints and ends correspond one to one. */
static void check_pairs(const limb_tree trees[2], const limb_pairs *pairs) {
    size_t counts[2] = {trees[0].nodes.count, trees[1].nodes.count};
    uint32_t *partners[2];
    uint8_t *used[2];
    for (int end = 0; end < 2; end++) {
        partners[end] = malloc(counts[end] * sizeof *partners[end]);
        used[end] = calloc(trees[end].limbs.count + 1, 1);
        assert_non_null(partners[end]);
        assert_non_null(used[end]);
        memset(partners[end], 0xff, counts[end] * sizeof *partners[end]);
    }
    for (size_t i = 0; i < pairs->count; i++)
        for (int k = 0; k < 2; k++) {
            uint32_t nodes[2];
            for (int end = 0; end < 2; end++) {
                const limb_way way = pairs->data[i].ways[end];
                if (k == 0)
                    assert_int_equal(used[end][way.limb]++, 0);
                nodes[end] = trees[end].limbs.data[way.limb].nodes[k == 0 ? way.back : !way.back];
            }
            for (int end = 0; end < 2; end++) {
                if (partners[end][nodes[end]] == NOWHERE)
                    partners[end][nodes[end]] = nodes[1 - end];
                assert_int_equal(partners[end][nodes[end]], nodes[1 - end]);
            }
        }
    for (int end = 0; end < 2; end++) {
        free(partners[end]);
        free(used[end]);
    }
}

static void find_trees(starg_context *context, const model models[2], limb_tree trees[2]) {
    for (int end = 0; end < 2; end++) {
        bool found;
        test_ok(context, limbs_find_tree(context, models[end].solid, &trees[end], &found));
        assert_true(found);
    }
}

static void test_pairs(void **state) {
    starg_context *context = test_context(1);
    const char *names[5] = {"maze", "comb", "polycube", "octopus", "human"};
    (void)state;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        model models[2] = {make_model(context, names[seed % 5], seed),
                           make_model(context, names[(seed + 1 + seed / 5) % 5], seed + 9)};
        limb_tree trees[2];
        limb_pairs pairs = {0};
        find_trees(context, models, trees);
        test_ok(context, limbs_pair(trees, &pairs));
        assert_true(pairs.count > 0);
        check_pairs(trees, &pairs);
        RELEASE(pairs.data);
        for (int end = 0; end < 2; end++) {
            limbs_free_tree(&trees[end]);
            free_model(&models[end]);
        }
    }
    test_context_free(context);
}

/* With itself, every limb is its own partner, and no cap is added. */
static void test_itself(void **state) {
    starg_context *context = test_context(1);
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        const model m = make_model(context, "maze", seed);
        model models[2] = {m, m};
        limb_tree trees[2];
        limb_pairs pairs = {0};
        find_trees(context, models, trees);
        size_t limbs = trees[0].limbs.count;
        test_ok(context, limbs_pair(trees, &pairs));
        assert_int_equal(pairs.count, limbs);
        assert_int_equal(trees[1].limbs.count, limbs);
        for (size_t i = 0; i < pairs.count; i++) {
            assert_int_equal(pairs.data[i].ways[0].limb, pairs.data[i].ways[1].limb);
            assert_int_equal(pairs.data[i].ways[0].back, pairs.data[i].ways[1].back);
        }
        RELEASE(pairs.data);
        limbs_free_tree(&trees[0]);
        limbs_free_tree(&trees[1]);
        free_model(&models[0]);
    }
    test_context_free(context);
}

/* ---- cuts ---- */

static double triangle_volume(const double *a, const double *b, const double *c) {
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0])) /
           6;
}

/* What a piece encloses: its part of the surface, and walls. */
static double piece_volume(const limb_cuts *cuts, int end, uint32_t which) {
    const cone_builder *b = &cuts->sides[end];
    const double *at = b->places[0].data;
    double sum = 0;
    for (size_t t = 0; t < b->corners.count / 3; t++) {
        const uint32_t *corner = b->corners.data + 3 * t;
        if (b->sides.data[2 * t] == which)
            sum += triangle_volume(at + 3 * (size_t)corner[0], at + 3 * (size_t)corner[1],
                                   at + 3 * (size_t)corner[2]);
    }
    for (size_t i = 0; i < cuts->walls.count; i++) {
        const limb_wall *wall = &cuts->walls.data[i];
        const number_list *loop = &wall->loops[end];
        double own = 0;
        for (size_t j = 0; j < loop->count; j++)
            own +=
                triangle_volume(at + 3 * (size_t)loop->data[(j + 1) % loop->count],
                                at + 3 * (size_t)loop->data[j], at + 3 * (size_t)wall->hubs[end]);
        sum += wall->pieces[0] == which ? own : wall->pieces[1] == which ? -own : 0;
    }
    return sum;
}

/* Does a point see all of a piece? */
static bool has_kernel(starg_context *context, const limb_cuts *cuts, int end, uint32_t which) {
    const cone_builder *b = &cuts->sides[end];
    size_t most = b->corners.count, count = 0;
    starg_kernel_result kernel;
    for (size_t i = 0; i < cuts->walls.count; i++)
        most += 3 * cuts->walls.data[i].loops[end].count;
    uint32_t *faces = calloc(most, sizeof *faces);
    assert_non_null(faces);
    for (size_t t = 0; t < b->corners.count / 3; t++)
        for (size_t k = 0; k < 3 && b->sides.data[2 * t] == which; k++)
            faces[count++] = b->corners.data[3 * t + k];
    for (size_t i = 0; i < cuts->walls.count; i++) {
        const limb_wall *wall = &cuts->walls.data[i];
        const number_list *loop = &wall->loops[end];
        const bool left = wall->pieces[0] == which;
        for (size_t j = 0; j < loop->count && (left || wall->pieces[1] == which); j++) {
            faces[count++] = loop->data[left ? (j + 1) % loop->count : j];
            faces[count++] = loop->data[left ? j : (j + 1) % loop->count];
            faces[count++] = wall->hubs[end];
        }
    }
    const kernel_faces surface = {b->places[0].data, faces, count / 3};
    test_ok(context, kernel_find(context, &surface, &kernel));
    free(faces);
    return kernel.verdict == STARG_KERNEL_INTERIOR;
}

/* Solids of cubes, and a spanner, of which a piece that one point sees has to follow what a horse's
 * hips need. */
static void test_cuts(void **state) {
    static const char *const names[][2] = {{"maze", "comb"}, {"comb", "maze"}, {"tool", "horse"}};
    starg_context *context = test_context(1);
    (void)state;
    for (uint64_t seed = 0; seed < 3; seed++) {
        const char *const *name = names[seed];
        model models[2] = {make_model(context, name[0], seed), make_model(context, name[1], seed)};
        limb_tree trees[2];
        limb_pairs pairs = {0};
        limb_cuts cuts = {.context = context};
        find_trees(context, models, trees);
        test_ok(context, limbs_pair(trees, &pairs));
        test_ok(context, limbs_cut(context, trees, &pairs, &cuts));
        assert_true(cuts.walls.count > 0);
        assert_int_equal(cuts.piece_count, cuts.walls.count + 1);
        size_t blind = 0;
        for (int end = 0; end < 2; end++) {
            double sum = 0;
            for (uint32_t p = 0; p < cuts.piece_count; p++) {
                double volume = piece_volume(&cuts, end, p);
                assert_true(volume > 0);
                sum += volume;
            }
            assert_true(fabs(sum / starg_mesh_volume(starg_solid_mesh(models[end].solid)) - 1) <
                        1e-12);
        }
        for (uint32_t p = 0; p < cuts.piece_count; p++)
            blind += !has_kernel(context, &cuts, 0, p) || !has_kernel(context, &cuts, 1, p);
        assert_int_equal(blind, cuts.resisting);
        assert_int_equal(blind, 0);
        for (size_t i = 0; i < cuts.walls.count; i++) {
            const limb_wall *wall = &cuts.walls.data[i];
            assert_int_equal(wall->loops[0].count, wall->loops[1].count);
            for (size_t j = 0; j < wall->loops[0].count; j++)
                assert_int_equal(cuts.mates.data[wall->loops[0].data[j]], wall->loops[1].data[j]);
        }
        limbs_free_cuts(&cuts);
        RELEASE(pairs.data);
        for (int end = 0; end < 2; end++) {
            limbs_free_tree(&trees[end]);
            free_model(&models[end]);
        }
    }
    test_context_free(context);
}

/* ---- tetrahedra ---- */

/* All are positive in both places, and have the volumes of the solids. */
static void check_filled(const compatible_cones *cones, const model models[2]) {
    for (int end = 0; end < 2; end++) {
        const double *places = cones->places[end];
        double sum = 0, whole = starg_mesh_volume(starg_solid_mesh(models[end].solid));
        for (size_t t = 0; t < cones->count; t++) {
            const double *c[4];
            double moved[3][3];
            for (size_t k = 0; k < 4; k++)
                c[k] = places + 3 * (size_t)cones->tetrahedra[4 * t + k];
            assert_int_equal(oracle_orient3d(c[0], c[1], c[2], c[3]), -1);
            for (int k = 0; k < 3; k++)
                for (int i = 0; i < 3; i++)
                    moved[k][i] = c[k + 1][i] - c[0][i];
            sum += triangle_volume(moved[0], moved[1], moved[2]);
        }
        assert_true(fabs(sum / whole - 1) < 1e-9);
    }
}

static void test_fill(void **state) {
    starg_context *contexts[2] = {test_context(1), test_context(3)};
    (void)state;
    for (uint64_t seed = 1; seed <= test_size(1, 6); seed++) {
        model models[2] = {make_model(contexts[0], "maze", seed),
                           make_model(contexts[0], "comb", seed)};
        const starg_mesh *const meshes[2] = {models[0].mesh, models[1].mesh};
        compatible_cones cones[2];
        for (int i = 0; i < 2; i++) {
            bool found;
            contexts[i]->seed = 1;
            test_ok(contexts[i], limbs_fill(contexts[i], meshes, &cones[i], &found));
            assert_true(found);
        }
        check_filled(&cones[0], models);
        assert_int_equal(cones[0].count, cones[1].count);
        assert_int_equal(cones[0].vertex_count, cones[1].vertex_count);
        for (int end = 0; end < 2; end++)
            assert_memory_equal(cones[0].places[end], cones[1].places[end],
                                3 * cones[0].vertex_count * sizeof *cones[0].places[end]);
        assert_memory_equal(cones[0].tetrahedra, cones[1].tetrahedra,
                            4 * cones[0].count * sizeof *cones[0].tetrahedra);
        for (int i = 0; i < 2; i++)
            compatible_cones_free(contexts[i], &cones[i]);
        for (int end = 0; end < 2; end++)
            free_model(&models[end]);
    }
    for (int i = 0; i < 2; i++)
        test_context_free(contexts[i]);
}

/* ---- failing memory ---- */

/* The allocation that fails, counted from when it is set; blocks in use. */
static size_t failing, asked, blocks;

static void *allocate(void *user, size_t size) {
    (void)user;
    void *block = ++asked == failing ? NULL : malloc(size);
    blocks += block != NULL;
    return block;
}

static void release(void *user, void *block) {
    (void)user;
    blocks--;
    free(block);
}

/* Allocations at even distances fail, one at a time: that is the status, and nothing is left. */
static void test_memory(void **state) {
    size_t all = 0, times = test_size(3, 100);
    (void)state;
    for (size_t i = 0; i <= times; i++) { /* the first time none fails */
        starg_context_options options;
        starg_context *context;
        compatible_cones cones;
        bool found = false;
        starg_context_options_default(&options);
        options.threads = 1;
        options.allocator = (starg_allocator){allocate, release, NULL};
        failing = 0;
        assert_int_equal(starg_context_create(&options, &context), STARG_OK);
        model models[2] = {make_model(context, "maze", 1), make_model(context, "comb", 1)};
        const starg_mesh *const meshes[2] = {models[0].mesh, models[1].mesh};
        size_t before = blocks;
        context->seed = 1;
        asked = 0;
        failing = i * all / (times + 1);
        starg_status status = limbs_fill(context, meshes, &cones, &found);
        bool failed = failing > 0 && asked >= failing;
        failing = 0;
        if (i == 0)
            all = asked;
        assert_int_equal(status, failed ? STARG_ERROR_MEMORY : STARG_OK);
        assert_int_equal(found, !failed);
        if (found)
            compatible_cones_free(context, &cones);
        assert_int_equal(blocks, before);
        for (int end = 0; end < 2; end++)
            free_model(&models[end]);
        starg_context_free(context);
        assert_int_equal(blocks, 0);
    }
    print_message("%zu of %zu allocations failed\n", times, all);
}

/* A solid with a handle has no tree. */
static void test_handle(void **state) {
    starg_context *context = test_context(1);
    starg_mesh *torus, *maze;
    starg_sample_options options;
    compatible_cones cones;
    bool found = true;
    (void)state;
    starg_sample_options_default(&options);
    options.vertex_count = 500;
    test_ok(context, starg_sample_create(context, "torus", &options, &torus));
    test_ok(context, starg_sample_create(context, "maze", &options, &maze));
    const starg_mesh *const meshes[2] = {maze, torus};
    test_ok(context, limbs_fill(context, meshes, &cones, &found));
    assert_false(found);
    starg_mesh_free(torus);
    starg_mesh_free(maze);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs), cmocka_unit_test(test_itself), cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_fill),  cmocka_unit_test(test_memory), cmocka_unit_test(test_handle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
