/* SPDX-License-Identifier: Apache-2.0 */
/* Guarding by levels: every level's guards see their level, refinement only helps, and the result
 * is the same for any number of threads. */
#include "support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "starguard/guard.h"
#include "starguard/sample.h"
#include "starguard/simplify.h"
#include "starguard/verify.h"

static starg_guard_options level_options(void) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 150;
    options.coarsest = 300;
    options.step = 400;
    options.refine = false;
    return options;
}

/* The faces of a level that the points see; by the tree, which guarding does not use here. */
static uint64_t *seen_by(starg_context *context, const starg_solid *solid, const double *points,
                         size_t count) {
    size_t faces = starg_mesh_face_count(starg_solid_mesh(solid));
    uint64_t *seen = calloc(faces / 64 + 1, sizeof *seen);
    starg_visibility_options options;
    starg_bits *rows = NULL;
    assert_non_null(seen);
    starg_visibility_options_default(&options);
    options.engine = STARG_VISIBILITY_BVH;
    test_ok(context, starg_visibility(context, solid, points, count, &options, &rows));
    for (size_t i = 0; i < count; i++)
        for (size_t f = 0; f < faces; f++)
            if (starg_bits_test(rows, i, f))
                seen[f / 64] |= (uint64_t)1 << (f % 64);
    starg_bits_free(rows);
    return seen;
}

/* Guards of a level see everything that the candidates see; the job's candidates are unknown here,
 * except the initial ones. */
static void check_level(starg_context *context, const char *name, const starg_mesh *mesh,
                        const starg_guard_level *level, const double *candidates, size_t count) {
    starg_solid *solid = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    size_t faces = starg_mesh_face_count(mesh);
    assert_int_equal(level->vertex_count, starg_mesh_vertex_count(mesh));
    assert_int_equal(level->face_count, faces);
    uint64_t *wanted = seen_by(context, solid, candidates, count);
    uint64_t *found = seen_by(context, solid, level->positions, level->count);
    for (size_t w = 0; w <= faces / 64; w++)
        if (wanted[w] & ~found[w])
            fail_msg("%s: a level of %zu faces is not covered", name, faces);
    free(wanted);
    free(found);
    starg_solid_free(solid);
}

static void check_model(starg_context *context, const char *name, const starg_mesh *mesh,
                        size_t step) {
    starg_solid *solid = NULL;
    starg_guards *guards = NULL, *refined = NULL, *best = NULL;
    starg_levels *levels = NULL;
    starg_guard_options options = level_options();
    double *candidates = NULL;
    size_t count = 0;
    options.step = step;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_guard(context, solid, &options, &guards));
    test_verified(context, name, mesh, guards);
    test_ok(context, starg_candidate_points(context, solid, options.candidates,
                                            options.candidate_count, 0, &candidates, &count));
    test_ok(context, starg_mesh_levels(context, starg_solid_mesh(solid), options.coarsest,
                                       options.step, NULL, &levels));
    assert_int_equal(guards->level_count, levels->count);
    for (size_t i = 0; i < levels->count; i++)
        check_level(context, name, levels->levels[i].mesh, &guards->level_list[i], candidates,
                    count);
    assert_int_equal(guards->level_list[levels->count - 1].count, guards->count);

    /* more candidates: never more guards, with their own bound */
    options.refine = true;
    options.refine_lines = test_size(100000, 300000);
    test_ok(context, starg_guard(context, solid, &options, &refined));
    test_verified(context, name, mesh, refined);
    assert_true(refined->count <= guards->count);
    assert_true(refined->candidate_count >= guards->candidate_count);

    /* the best of the first candidates cannot be fewer than their bound */
    options.method = STARG_GUARD_ILP;
    test_ok(context, starg_guard(context, solid, &options, &best));
    assert_true(guards->lower_bound <= best->count && best->count <= guards->count);
    assert_int_equal(best->candidate_count, guards->candidate_count);
    starg_guards_free(context, guards);
    starg_guards_free(context, refined);
    starg_guards_free(context, best);
    starg_points_free(context, candidates);
    starg_levels_free(context, levels);
    starg_solid_free(solid);
}

static void test_samples(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const char *const names[] = {"gallery", "human", "plate"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_mesh *mesh = test_sample_mesh(context, names[i], test_size(1100, 1500));
        check_model(context, names[i], mesh, i == 1 ? STARG_QUARTERS : 400);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

static void test_shared(void **state) {
    (void)state;
    const char *const names[] = {"table2/bunny_998.off", "solids/bumpy.off",
                                 "solids/elephant_g3.off", "table2/bimba_752.off"};
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(2);
    for (size_t i = 0; i < test_rounds(3, sizeof names / sizeof *names); i++) {
        char path[4400];
        starg_mesh *mesh = NULL;
        snprintf(path, sizeof path, "%s/%s", data, names[i]);
        test_ok(context, starg_mesh_read(context, path, &mesh));
        check_model(context, names[i], mesh, 400);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

static void sample_solid(starg_context *context, const char *name, size_t vertices,
                         starg_mesh **mesh, starg_solid **solid) {
    *mesh = test_sample_mesh(context, name, vertices);
    test_ok(context, starg_solid_create(context, *mesh, solid));
}

/* With a partial goal, crevices get no candidates of their own; the goal is still relative to the
 * whole area. */
static void test_part(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const char *const names[] = {"gallery", "horse", "human"};
    const double parts[] = {0.5, 0.7, 0.9};
    bool fewer = false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        size_t all = 0;
        sample_solid(context, names[i], 1500, &mesh, &solid);
        for (size_t k = 0; k < 4; k++) {
            starg_guards *guards = NULL;
            starg_guard_options options = level_options();
            options.candidate_count = 10; /* these alone see little */
            options.coverage = k == 0 ? 1 : parts[k - 1];
            test_ok(context, starg_guard(context, solid, &options, &guards));
            test_verified(context, names[i], mesh, guards);
            if (guards->coverage_area < options.coverage)
                fail_msg("%s: %g of the area for %g", names[i], guards->coverage_area,
                         options.coverage);
            all = k == 0 ? guards->candidate_count : all;
            fewer = fewer || guards->candidate_count < all;
            starg_guards_free(context, guards);
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    assert_true(fewer);
    test_context_free(context);
}

/* The fraction of the area that all candidates of a curve skeleton see. */
static double seen_from_skeleton(starg_context *context, size_t vertices) {
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_guards *guards = NULL;
    double *points = NULL;
    size_t count = 0;
    sample_solid(context, "human", vertices, &mesh, &solid);
    test_ok(context, starg_candidate_points(context, solid, STARG_CANDIDATES_SKELETON, 100, 0,
                                            &points, &count));
    assert_true(count >= 50);
    for (size_t i = 0; i < count; i++)
        assert_true(starg_solid_contains(solid, points + 3 * i));
    test_ok(context, starg_guards_given(context, solid, points, count, &guards));
    double seen = guards->coverage_area;
    starg_guards_free(context, guards);
    starg_points_free(context, points);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    return seen;
}

/* Above 100,000 vertices the skeleton is that of a simplified version, and as good. */
static void test_large(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    double small = seen_from_skeleton(context, test_size(10000, 20000)),
           large = seen_from_skeleton(context, test_size(102000, 110000));
    if (large < small - 0.01)
        fail_msg("%g of the area seen, %g with fewer vertices", large, small);
    test_context_free(context);
}

static void test_threads(void **state) {
    (void)state;
    starg_guards *first = NULL;
    starg_context *contexts[3];
    for (int t = 0; t < 3; t++) {
        starg_context *context = contexts[t] = test_context(t == 2 ? 7 : t + 1);
        starg_sample_options sample;
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        starg_guards *guards = NULL;
        starg_guard_options options = level_options();
        options.refine = true;
        options.refine_lines = 200000;
        starg_sample_options_default(&sample);
        sample.vertex_count = 1000;
        test_ok(context, starg_sample_create(context, "gallery", &sample, &mesh));
        test_ok(context, starg_solid_create(context, mesh, &solid));
        test_ok(context, starg_guard(context, solid, &options, &guards));
        if (first == NULL) {
            first = guards;
        } else {
            assert_int_equal(guards->count, first->count);
            assert_int_equal(guards->lines_tested, first->lines_tested);
            assert_memory_equal(guards->positions, first->positions,
                                3 * guards->count * sizeof *guards->positions);
            starg_guards_free(context, guards);
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    starg_guards_free(contexts[0], first);
    for (int t = 0; t < 3; t++)
        test_context_free(contexts[t]);
}

static void expect_refuted(starg_context *context, const starg_mesh *mesh,
                           const starg_guards *guards, const char *claim) {
    starg_verdict *verdict = NULL;
    bool found = false;
    test_ok(context, starg_verify_guards(context, mesh, guards, &verdict));
    for (size_t i = 0; i < verdict->count; i++)
        found = found || (!verdict->claims[i].holds && strstr(verdict->claims[i].text, claim));
    if (!found)
        fail_msg("no claim about \"%s\" fails", claim);
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
}

/* The verifier detects a wrong curve, a wrong direction and impossible levels. */
static void refute_falsifications(starg_context *context, const starg_mesh *mesh,
                                  starg_guards *guards) {
    size_t last = guards->level_count - 1;
    guards->curve_area[0] *= 1 - 1e-6;
    expect_refuted(context, mesh, guards, "the curve");
    guards->curve_area[0] /= 1 - 1e-6;
    guards->curve_faces[0] += 1e-6;
    expect_refuted(context, mesh, guards, "the curve");
    guards->curve_faces[0] -= 1e-6;
    size_t kept = guards->level_list[last].kept;
    guards->level_list[last].kept = guards->level_list[last].count + 1;
    expect_refuted(context, mesh, guards, "levels grow");
    guards->level_list[last].kept = kept;
    int level = guards->levels[0];
    guards->levels[0] = (int)guards->level_count;
    expect_refuted(context, mesh, guards, "levels grow");
    guards->levels[0] = level;
    for (size_t k = 0; k < 3; k++)
        guards->directions[k] = -guards->directions[k];
    expect_refuted(context, mesh, guards, "each guard sees");
    for (size_t k = 0; k < 3; k++)
        guards->directions[k] = -guards->directions[k];
}

/* The step in the file. */
static void expect_step(starg_context *context, const starg_guards *guards, const char *wanted) {
    char text[2000] = "", found[16] = "";
    test_ok(context, starg_guards_write(context, guards, "human.off", "test_progressive.json"));
    FILE *file = fopen("test_progressive.json", "r");
    assert_non_null(file);
    assert_true(fread(text, 1, sizeof text - 1, file) > 0);
    fclose(file);
    const char *step = strstr(text, "\"step\":");
    assert_non_null(step);
    assert_int_equal(sscanf(step + 7, "%15[0-9a-z]", found), 1);
    assert_string_equal(found, wanted);
}

/* Writing and reading loses nothing. */
static void test_round_trip(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_sample_options sample;
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_guards *guards = NULL, *back = NULL;
    starg_guard_options options = level_options();
    starg_sample_options_default(&sample);
    sample.vertex_count = 1000;
    options.visibility.cone = 170;
    options.candidate_count = 30;
    test_ok(context, starg_sample_create(context, "human", &sample, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_guard(context, solid, &options, &guards));
    test_ok(context, starg_guards_write(context, guards, "human.off", "test_progressive.json"));
    test_ok(context, starg_guards_read(context, "test_progressive.json", &back));
    assert_int_equal(back->count, guards->count);
    assert_memory_equal(back->directions, guards->directions, 24 * guards->count);
    assert_memory_equal(back->curve_faces, guards->curve_faces, 8 * guards->count);
    assert_memory_equal(back->curve_area, guards->curve_area, 8 * guards->count);
    assert_int_equal(back->level_count, guards->level_count);
    for (size_t i = 0; i < guards->level_count; i++) {
        assert_int_equal(back->level_list[i].kept, guards->level_list[i].kept);
        assert_int_equal(back->level_list[i].count, guards->level_list[i].count);
        assert_memory_equal(back->level_list[i].positions, guards->level_list[i].positions,
                            24 * guards->level_list[i].count);
    }
    assert_true(back->options.visibility.cone == 170);
    test_verified(context, "human", mesh, back);
    refute_falsifications(context, mesh, back);
    test_verified(context, "human", mesh, back);
    expect_step(context, guards, "400");
    guards->options.step = STARG_QUARTERS;
    expect_step(context, guards, "null");
    remove("test_progressive.json");
    starg_guards_free(context, guards);
    starg_guards_free(context, back);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples), cmocka_unit_test(test_shared),
        cmocka_unit_test(test_part),    cmocka_unit_test(test_large),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_round_trip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
