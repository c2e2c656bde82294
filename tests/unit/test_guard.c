/* SPDX-License-Identifier: Apache-2.0 */
/* Guarding end to end on procedural solids: every result goes through the independent verifier. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "models.h"
#include "starguard/guard.h"
#include "starguard/sample.h"
#include "starguard/skeleton.h"
#include "starguard/verify.h"

static starg_guard_options small_options(void) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 150;
    options.method = STARG_GUARD_ILP;
    return options;
}

static void test_every_sample(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        starg_guard_options options = small_options();
        starg_solid *solid = test_sample(context, starg_sample_at(i)->name, 600);
        starg_guards *best = test_guard(context, solid, &options);
        options.method = STARG_GUARD_GREEDY;
        starg_guards *greedy = test_guard(context, solid, &options);
        /* samples are embedded and have no thin crevices: every face can be seen */
        assert_int_equal(best->uncovered_count, 0);
        assert_true(best->optimal);
        assert_true(best->count <= greedy->count);
        assert_true(greedy->lower_bound <= best->count);
        assert_int_equal(best->candidate_count, greedy->candidate_count);
        starg_guards_free(context, best);
        starg_guards_free(context, greedy);
        starg_solid_free(solid);
    }
    test_context_free(context);
}

static void test_sphere_takes_one(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "sphere", 500);
    starg_guard_options options = small_options();
    for (int source = 0; source < 2; source++) {
        options.candidates = (starg_candidates)source;
        starg_guards *guards = test_guard(context, solid, &options);
        assert_int_equal(guards->count, 1);
        starg_guards_free(context, guards);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_options(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "gallery", 900);
    double diagonal = starg_solid_check(solid)->diagonal;
    starg_guard_options options = small_options();
    starg_guards *all = test_guard(context, solid, &options);

    options.coverage = 0.9;
    starg_guards *most = test_guard(context, solid, &options);
    assert_true(most->count <= all->count);
    assert_true(most->coverage_area >= 0.9 * (1 - 1e-9));

    options = small_options();
    options.max_guards = 1;
    starg_guards *one = test_guard(context, solid, &options);
    assert_int_equal(one->count, 1);
    assert_true(one->coverage_area <= one->area_bound * (1 + 1e-9));
    assert_true(one->area_bound < 1);
    options.redundancy = 3; /* some faces may be seen by a single candidate, which then suffices */
    starg_guards *few = test_guard(context, solid, &options);
    assert_true(few->count <= 1 && few->area_bound == 1);
    starg_guards_free(context, few);

    options = small_options();
    options.redundancy = 2;
    starg_guards *twice = test_guard(context, solid, &options);
    assert_true(twice->count > all->count);

    options = small_options();
    options.visibility.range = 0.35 * diagonal;
    starg_guards *near = test_guard(context, solid, &options);
    assert_true(near->count >= all->count);

    options = small_options();
    options.clearance = 0.02 * diagonal;
    starg_guards *clear = test_guard(context, solid, &options);
    for (size_t i = 0; i < clear->count; i++)
        assert_true(starg_solid_distance(solid, clear->positions + 3 * i) >= options.clearance);

    options = small_options();
    options.visibility.target = STARG_TARGET_VERTICES;
    starg_guards *vertices = test_guard(context, solid, &options);
    assert_true(vertices->coverage_vertices == 1);
    assert_true(vertices->count <= all->count + 1);

    options = small_options();
    options.visibility.face_rule = STARG_FACES_WHOLE;
    starg_guards *whole = test_guard(context, solid, &options);
    assert_int_equal(whole->uncovered_count, 0);

    options = small_options();
    options.candidates = STARG_CANDIDATES_GIVEN;
    options.points = all->positions;
    options.point_count = all->count;
    starg_guards *given = test_guard(context, solid, &options);
    assert_int_equal(given->count, all->count);
    assert_int_equal(given->candidate_count, all->count);

    starg_guards *results[] = {all, most, one, twice, near, clear, vertices, whole, given};
    for (size_t i = 0; i < sizeof results / sizeof *results; i++)
        starg_guards_free(context, results[i]);
    starg_solid_free(solid);
    test_context_free(context);
}

static char *read_text(const char *path, long *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = ftell(file);
    rewind(file);
    char *text = malloc((size_t)*size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)*size, file), *size);
    text[*size] = '\0';
    fclose(file);
    return text;
}

/* Same bytes for any number of threads, and the file reads back what was written. */
static void test_file(void **state) {
    (void)state;
    char path[2][64], *text[2];
    long size[2];
    starg_guards *guards = NULL;
    for (int i = 0; i < 2; i++) {
        starg_context *context = test_context(i == 0 ? 1 : 5);
        starg_solid *solid = test_sample(context, "star", 700);
        starg_guard_options options = small_options();
        guards = test_guard(context, solid, &options);
        snprintf(path[i], sizeof path[i], "guards-%ld-%d.json", (long)getpid(), i);
        test_ok(context, starg_guards_write(context, guards, "a \"name\".off", path[i]));
        text[i] = read_text(path[i], &size[i]);

        starg_guards *again = NULL;
        test_ok(context, starg_guards_read(context, path[i], &again));
        assert_string_equal(again->file, "a \"name\".off");
        assert_int_equal(again->count, guards->count);
        assert_memory_equal(again->positions, guards->positions, 24 * guards->count);
        assert_memory_equal(again->seen_faces, guards->seen_faces,
                            guards->count * sizeof *guards->seen_faces);
        assert_true(again->coverage_area == guards->coverage_area);
        assert_int_equal(again->lower_bound, guards->lower_bound);
        assert_int_equal(again->optimal, guards->optimal);

        double *points = NULL;
        size_t count = 0;
        test_ok(context, starg_points_read(context, path[i], &points, &count));
        assert_int_equal(count, guards->count);
        starg_points_free(context, points);

        starg_guards_free(context, again);
        starg_guards_free(context, guards);
        starg_solid_free(solid);
        test_context_free(context);
        unlink(path[i]);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(text[0], text[1], (size_t)size[0]);
    free(text[0]);
    free(text[1]);
}

/* The nodes of a skeleton are used as points, whichever format it is written in. */
static void test_skeletons_are_points(void **state) {
    static const char *const extensions[] = {"obj", "cg", "vtk"};
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "star", 700);
    starg_skeleton *skeleton = NULL;
    test_ok(context, starg_skeleton_create(context, solid, NULL, &skeleton));
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
        char path[64];
        double *points = NULL;
        size_t count = 0;
        snprintf(path, sizeof path, "curve-%ld.%s", (long)getpid(), extensions[i]);
        test_ok(context, starg_skeleton_write(context, skeleton, path, STARG_SKELETON_AUTO));
        test_ok(context, starg_points_read(context, path, &points, &count));
        assert_int_equal(count, skeleton->node_count);
        assert_memory_equal(points, skeleton->positions, 24 * count);
        starg_points_free(context, points);
        unlink(path);
    }
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    test_context_free(context);
}

/* A line with too many numbers is reported by its number; six numbers are a position and a
 * direction, and all lines have equally many. */
static void test_lines_of_points(void **state) {
    static const struct {
        const char *text, *says;
    } cases[] = {{"1 2 3\n1 2 3 0 0 1\n", "6 numbers, and 3"},
                 {"1 2 3\nv 1 2 3 4\n", "not 4"},
                 {"1 2 3 1 0 0\n1 2 3\n", "3 numbers, and 6"},
                 {"1 2 3 1 0 0\n1 2 3 0 0 0\n", "none"},
                 {"1 2 3\n1 2\n3 4 5\n", "not 2"},
                 {"1 2 3\n1 2 3 4 5 6 7\n", "not 7"},
                 {"1 2 3\n1 2 hall\n", "hall"},
                 {"1 2 3\n1 2 3 # 4 5 6\nl 1 2\n", ""}};
    (void)state;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double *points = NULL;
        size_t count = 0, size = strlen(cases[i].text);
        starg_status status =
            starg_points_read_memory(context, cases[i].text, size, "p.txt", &points, &count);
        if (*cases[i].says == '\0') {
            test_ok(context, status);
            assert_int_equal(count, 2);
            starg_points_free(context, points);
            continue;
        }
        const starg_error *error = starg_context_error(context);
        assert_int_equal(status, STARG_ERROR_FORMAT);
        assert_null(points);
        assert_non_null(strstr(error->message, cases[i].says));
        assert_int_equal(error->element, STARG_ELEMENT_LINE);
        assert_int_equal(error->indices[0], 2);
    }
    test_context_free(context);
}

/* Every change that invalidates a good file is reported, and none crashes. */
static void test_bad_files(void **state) {
    static const char good[] =
        "{\"format\":\"starguard-guards\",\"version\":1,"
        "\"model\":{\"file\":\"m.off\",\"vertices\":4,\"faces\":4},"
        "\"options\":{\"method\":\"ilp\",\"candidates\":\"medial\",\"count\":10,"
        "\"target\":\"faces\",\"faces\":\"vertices\",\"coverage\":1.0,\"max_guards\":0,"
        "\"range\":null,\"redundancy\":1,\"clearance\":0.0},"
        "\"guards\":[{\"position\":[0.1,0.1,0.1],\"faces\":3,\"level\":0}],"
        "\"coverage\":{\"faces\":0.75,\"area\":0.7,\"coverable_faces\":3,"
        "\"uncovered_faces\":[2]},\"candidates\":5,\"lower_bound\":1,\"optimal\":true}";
    static const char *const changes[][2] = {{"starguard-guards", "starguard-gards"},
                                             {"\"version\":1", "\"version\":2"},
                                             {"\"vertices\":4", "\"vertices\":-4"},
                                             {"\"method\":\"ilp\"", "\"method\":\"best\""},
                                             {"[0.1,0.1,0.1]", "[0.1,0.1]"},
                                             {"[0.1,0.1,0.1]", "[0.1,\"x\",0.1]"},
                                             {"[2]", "[2,2]"},
                                             {"[2]", "[4]"},
                                             {"[2]", "{}"},
                                             {"\"optimal\":true", "\"optimal\":1"},
                                             {"\"lower_bound\":1", "\"lower\":1"},
                                             {"\"guards\":[", "\"guards\":7,\"g\":["},
                                             {"\"area\":0.7", "\"area\":\"0.7\""},
                                             {"}", ""},
                                             {"\"range\":null", "\"range\":-1"}};
    (void)state;
    char path[64], text[2048];
    snprintf(path, sizeof path, "bad-%ld.json", (long)getpid());
    starg_context *context = test_context(1);
    for (size_t i = 0; i <= sizeof changes / sizeof *changes; i++) {
        bool changed = i < sizeof changes / sizeof *changes;
        const char *at = changed ? strstr(good, changes[i][0]) : good;
        assert_non_null(at);
        if (changed)
            snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, changes[i][1],
                     at + strlen(changes[i][0]));
        else
            memcpy(text, good, sizeof good);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(text, file);
        fclose(file);
        starg_guards *guards = NULL;
        starg_status status = starg_guards_read(context, path, &guards);
        assert_int_equal(status, changed ? STARG_ERROR_FORMAT : STARG_OK);
        if (changed)
            assert_non_null(strstr(starg_context_error(context)->message, path));
        starg_guards_free(context, guards);
    }
    unlink(path);
    starg_guards *guards = NULL;
    assert_int_equal(starg_guards_read(context, path, &guards), STARG_ERROR_READ);
    test_context_free(context);
}

static void test_bad_options(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "torus", 500);
    starg_guards *guards = NULL;
    starg_guard_options bad[6];
    for (int i = 0; i < 6; i++)
        bad[i] = small_options();
    bad[0].coverage = 0;
    bad[1].coverage = NAN;
    bad[2].redundancy = 0;
    bad[3].clearance = -1;
    bad[4].candidate_count = 0;
    bad[5].visibility.range = NAN;
    for (int i = 0; i < 6; i++) {
        assert_int_equal(starg_guard(context, solid, &bad[i], &guards), STARG_ERROR_ARGUMENT);
        assert_null(guards);
    }
    starg_guard_options far = small_options();
    far.clearance = starg_solid_check(solid)->diagonal;
    assert_int_equal(starg_guard(context, solid, &far, &guards), STARG_ERROR_MESH);
    starg_context_cancel(context);
    assert_int_equal(starg_guard(context, solid, NULL, &guards), STARG_ERROR_CANCELLED);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Given guards, in any order and repeated: the result reports what they see, and verifies. A point
 * that is not inside is rejected. */
static void test_given_guards(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_guard_options options = small_options();
    starg_solid *solid = test_sample(context, "dog", 600);
    starg_guards *best = test_guard(context, solid, &options), *again;
    starg_verdict *verdict;
    size_t count = best->count + 1;
    double *points = malloc(3 * count * sizeof *points);
    assert_non_null(points);
    for (size_t i = 0; i < count; i++)
        memcpy(points + 3 * i, best->positions + 3 * ((count - 1 - i) % best->count),
               3 * sizeof *points);
    test_ok(context, starg_guards_given(context, solid, points, count, &again));
    assert_int_equal(again->count, count);
    assert_memory_equal(again->positions, points, 3 * count * sizeof *points);
    assert_int_equal(again->seen_faces[0], again->seen_faces[count - 1]);
    assert_int_equal(again->uncovered_count, best->uncovered_count);
    test_ok(context, starg_verify_guards(context, starg_solid_mesh(solid), again, &verdict));
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    starg_guards_free(context, again);
    assert_int_equal(starg_guards_given(context, solid, points, 0, &again), STARG_ERROR_ARGUMENT);
    points[1] = 1e6;
    assert_int_equal(starg_guards_given(context, solid, points, count, &again),
                     STARG_ERROR_ARGUMENT);
    assert_null(again);
    free(points);
    starg_guards_free(context, best);
    starg_solid_free(solid);
    test_context_free(context);
}

/* ---- parts, redundancy, nothing seen ---- */

/* Copies of a shape, apart. */
static shape apart(const shape *s, size_t count) {
    shape all = {0};
    for (size_t i = 0; i < count; i++)
        shape_append(&all, s, (const double[]){10 * (double)i, 0, 0}, 0);
    return all;
}

/* What parts of a solid need adds up: one guard for each, two for each without a kernel. */
static void test_parts(void **state) {
    (void)state;
    const struct {
        shape (*make)(void);
        size_t each;
    } kinds[] = {{shape_tetrahedron, 1}, {shape_room, 1}, {shape_cavity, 2}};
    starg_context *context = test_context(1);
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 100;
    options.refine_lines = 20000;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        for (size_t count = 1; count <= 5; count += 2) {
            shape one = kinds[i].make(), all = apart(&one, count);
            starg_solid *solid = test_solid_of(context, &all);
            starg_guards *guards = test_guard(context, solid, &options);
            assert_true(guards->lower_bound_everywhere >= kinds[i].each * count);
            assert_true(guards->lower_bound_everywhere <= guards->count);
            if (kinds[i].each == 1)
                assert_int_equal(guards->count, count);
            starg_guards_free(context, guards);
            starg_solid_free(solid);
            shape_free(&one);
            shape_free(&all);
        }
    test_context_free(context);
}

/* Each part needs as many guards as the redundancy, also where one candidate would do. */
static void test_redundancy(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(1), three = apart(&cube, 3);
    starg_solid *solid = test_solid_of(context, &three);
    for (uint32_t times = 2; times <= 3; times++)
        for (int method = 0; method < 3; method++) {
            starg_guard_options options = small_options();
            options.method = (starg_guard_method)method;
            options.redundancy = times;
            starg_guards *guards = test_guard(context, solid, &options);
            assert_int_equal(guards->count, 3 * times);
            assert_int_equal(guards->lower_bound_everywhere, 3 * times);
            assert_int_equal(guards->redundant_count, times);
            for (uint32_t k = 0; k < times; k++)
                assert_int_equal(guards->redundant_faces[k], guards->face_count);
            starg_guards_free(context, guards);
        }
    starg_solid_free(solid);
    shape_free(&cube);
    shape_free(&three);
    test_context_free(context);
}

/* Nothing seen is no result; a range in another unit is told so. */
static void test_nothing_seen(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "l-room", 500);
    double diagonal = starg_solid_check(solid)->diagonal;
    for (int unit = 0; unit < 2; unit++) {
        bool directed = !unit;
        starg_guard_options options = small_options();
        starg_guards *guards;
        options.visibility.range = unit ? diagonal / 1e4 : diagonal / 900;
        options.visibility.cone = directed ? 60 : 360;
        assert_int_equal(starg_guard(context, solid, &options, &guards), STARG_ERROR_MESH);
        assert_null(guards);
        const char *said = starg_context_error(context)->message;
        assert_int_equal(strstr(said, "another unit") != NULL, unit);
        assert_int_equal(strstr(said, "a wider view") != NULL, directed);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_parts),
                                       cmocka_unit_test(test_redundancy),
                                       cmocka_unit_test(test_nothing_seen),
                                       cmocka_unit_test(test_every_sample),
                                       cmocka_unit_test(test_sphere_takes_one),
                                       cmocka_unit_test(test_options),
                                       cmocka_unit_test(test_file),
                                       cmocka_unit_test(test_skeletons_are_points),
                                       cmocka_unit_test(test_lines_of_points),
                                       cmocka_unit_test(test_bad_files),
                                       cmocka_unit_test(test_bad_options),
                                       cmocka_unit_test(test_given_guards)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
