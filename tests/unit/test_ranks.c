/* SPDX-License-Identifier: Apache-2.0 */
/* Work shared by several processes: the same results as without sharing, and runs in which one
 * process fails. */
#include "starguard/ranks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "models.h"
#include "network.h"
#include "starguard/database.h"
#include "starguard/space.h"
#include "starguard/visibility.h"

enum { POINTS = 2500 }; /* times the faces below: enough for the rows to be shared */

static double points[3 * POINTS], directions[3 * POINTS];

static starg_solid *solid_with_points(starg_context *context) {
    starg_solid *solid = test_sample(context, "cat", 1000);
    const double *vertices = starg_mesh_vertices(starg_solid_mesh(solid));
    size_t count = starg_mesh_vertex_count(starg_solid_mesh(solid));
    starg_rng rng = starg_rng_make(7, 1, 0);
    for (size_t i = 0; i < POINTS; i++) {
        const double *a = vertices + 3 * starg_rng_below(&rng, count);
        const double *b = vertices + 3 * starg_rng_below(&rng, count);
        for (size_t k = 0; k < 3; k++) { /* some are inside */
            points[3 * i + k] = 0.5 * a[k] + 0.5 * b[k];
            directions[3 * i + k] = b[k] - a[k] + 1e-9;
        }
    }
    return solid;
}

static bool same_rows(const starg_bits *a, const starg_bits *b) {
    if (starg_bits_rows(a) != starg_bits_rows(b) || starg_bits_columns(a) != starg_bits_columns(b))
        return false;
    for (size_t i = 0; i < starg_bits_rows(a); i++)
        if (memcmp(starg_bits_row(a, i), starg_bits_row(b, i), 8 * starg_bits_words(a)) != 0)
            return false;
    return true;
}

/* Every option that affects a row is sent to the helpers. */
static void test_rows(void **state) {
    (void)state;
    starg_context *alone = test_context(1);
    starg_solid *solid = solid_with_points(alone);
    starg_visibility_options variants[6];
    for (size_t i = 0; i < 6; i++)
        starg_visibility_options_default(&variants[i]);
    variants[1].target = STARG_TARGET_VERTICES;
    variants[2].face_rule = STARG_FACES_WHOLE;
    variants[3].range = 0.4 * starg_solid_check(solid)->diagonal;
    variants[4].cone = 100;
    variants[4].directions = directions;
    variants[5].engine = STARG_VISIBILITY_GRID;
    for (size_t i = 0; i < 6; i++) {
        starg_bits *expected = NULL;
        test_ok(alone, starg_visibility(alone, solid, points, POINTS, &variants[i], &expected));
        for (int count = 2; count <= 4; count += 1 + (i > 0)) {
            network net;
            network_begin(&net, count, 1 + count % 2);
            starg_context *context = test_context(1);
            starg_context_set_ranks(context, network_ranks(&net));
            starg_bits *rows = NULL;
            test_ok(context, starg_visibility(context, solid, points, POINTS, &variants[i], &rows));
            assert_true(same_rows(rows, expected));
            assert_true(starg_context_helped_items(context) > 0);
            assert_true(starg_context_helped_items(context) <= POINTS);
            assert_true(starg_context_shared_seconds(context) > 0);
            starg_bits_free(rows);
            test_context_free(context);
            network_end_all(&net);
        }
        starg_bits_free(expected);
    }
    starg_solid_free(solid);
    test_context_free(alone);
}

/* Open surfaces: faces with two sides. */
static void test_rows_of_a_soup(void **state) {
    (void)state;
    starg_context *alone = test_context(1), *context = test_context(1);
    starg_solid *solid = solid_with_points(alone), *soup = NULL;
    const starg_mesh *closed = starg_solid_mesh(solid);
    starg_mesh *open = NULL;
    starg_bits *expected = NULL, *rows = NULL;
    starg_space_options options;
    network net;
    starg_space_options_default(&options);
    options.soup = options.two_sided = true;
    test_ok(alone, starg_mesh_create(alone, starg_mesh_vertices(closed),
                                     starg_mesh_vertex_count(closed), starg_mesh_faces(closed),
                                     starg_mesh_face_count(closed) * 3 / 4, &open));
    test_ok(alone, starg_space_create(alone, open, NULL, 0, &options, &soup));
    test_ok(alone, starg_visibility(alone, soup, points, POINTS, NULL, &expected));
    network_begin(&net, 3, 1);
    starg_context_set_ranks(context, network_ranks(&net));
    test_ok(context, starg_visibility(context, soup, points, POINTS, NULL, &rows));
    assert_true(starg_context_helped_items(context) > 0);
    assert_true(same_rows(rows, expected));
    starg_bits_free(rows);
    starg_bits_free(expected);
    network_end_all(&net);
    starg_solid_free(soup);
    starg_mesh_free(open);
    starg_solid_free(solid);
    test_context_free(context);
    test_context_free(alone);
}

static starg_guards *guards_of(starg_context *context, starg_guard_method method) {
    starg_guard_options options;
    starg_guards *guards = NULL;
    starg_guard_options_default(&options);
    options.method = method;
    options.candidate_count = 1500;
    options.coarsest = 800;
    options.step = 700;
    options.refine_lines = 200000;
    starg_solid *solid = test_sample(context, "dog", 1500);
    test_ok(context, starg_guard(context, solid, &options, &guards));
    starg_solid_free(solid);
    return guards;
}

/* All of guarding, including levels of detail. */
static void test_guards(void **state) {
    (void)state;
    static const starg_guard_method methods[] = {STARG_GUARD_GREEDY, STARG_GUARD_PILP};
    for (size_t i = 0; i < 2; i++) {
        network net;
        network_begin(&net, 3, 1);
        starg_context *alone = test_context(1), *context = test_context(1);
        starg_context_set_ranks(context, network_ranks(&net));
        starg_guards *expected = guards_of(alone, methods[i]);
        starg_guards *guards = guards_of(context, methods[i]);
        assert_true(starg_context_helped_items(context) > 0);
        assert_int_equal(guards->count, expected->count);
        assert_int_equal(guards->lower_bound, expected->lower_bound);
        assert_int_equal(guards->candidate_count, expected->candidate_count);
        assert_memory_equal(guards->positions, expected->positions,
                            3 * guards->count * sizeof *guards->positions);
        starg_guards_free(context, guards);
        starg_guards_free(alone, expected);
        test_context_free(context);
        test_context_free(alone);
        network_end_all(&net);
    }
}

/* The search for guards anywhere, with what each helper holds of the solid. */
static starg_status prove(starg_context *context, starg_target target, double clearance,
                          starg_guards **guards) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.prove = true;
    options.prove_work = test_size(60000, 120000);
    options.candidate_count = 200;
    options.refine = false;
    options.visibility.target = target;
    options.clearance = clearance;
    starg_solid *solid = test_sample(context, "cat", 600);
    starg_status status = starg_guard(context, solid, &options, guards);
    starg_solid_free(solid);
    return status;
}

static void assert_same_guards(const starg_guards *a, const starg_guards *b) {
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->lower_bound_everywhere, b->lower_bound_everywhere);
    assert_int_equal(a->cells, b->cells);
    assert_int_equal(a->witnesses, b->witnesses);
    assert_int_equal(a->prove_work, b->prove_work);
    assert_memory_equal(a->positions, b->positions, 3 * a->count * sizeof *a->positions);
}

static void test_cells(void **state) {
    (void)state;
    static const starg_target targets[] = {STARG_TARGET_FACES, STARG_TARGET_VERTICES};
    for (int i = 0; i < 2; i++) {
        int count = 2 + 2 * i;
        network net;
        starg_guards *expected = NULL, *guards = NULL;
        starg_context *alone = test_context(1), *context = test_context(1);
        network_begin(&net, count, 1 + i);
        starg_context_set_ranks(context, network_ranks(&net));
        test_ok(alone, prove(alone, targets[i], 0.001 * i, &expected));
        test_ok(context, prove(context, targets[i], 0.001 * i, &guards));
        assert_true(expected->cells > 300);
        assert_true(starg_context_helped_items(context) > 100);
        assert_same_guards(guards, expected);
        starg_guards_free(context, guards);
        /* a second search begins anew */
        test_ok(context, prove(context, targets[i], 0.001 * i, &guards));
        assert_same_guards(guards, expected);
        starg_guards_free(context, guards);
        starg_guards_free(alone, expected);
        test_context_free(context);
        test_context_free(alone);
        network_end_all(&net);
    }
}

/* The connection breaks after any number of messages, or a helper has too little memory. */
static void test_cells_without_helper(void **state) {
    (void)state;
    size_t failed = 0;
    for (size_t n = 1; n < 3000; n += 1 + 3 * n / 2) {
        network net;
        starg_guards *guards = NULL;
        size_t left = n + 1;
        starg_context *context = test_context(1);
        if (n % 2 == 0) {
            network_begin(&net, 3, 1);
            net.messages_left = (long)n / 8;
        } else {
            network_begin_failing(&net, 2, &left);
        }
        starg_context_set_ranks(context, network_ranks(&net));
        starg_status status = prove(context, STARG_TARGET_FACES, 0, &guards);
        assert_true(status == STARG_OK || status == STARG_ERROR_RANK ||
                    status == STARG_ERROR_MEMORY);
        failed += status != STARG_OK;
        starg_guards_free(context, guards);
        network_end_all(&net);
        test_context_free(context);
    }
    assert_true(failed > 6);
}

/* ---- a database ---- */

enum { MODELS = 4, FILES = 6 };

static char folder[64];

static const char *path_of(size_t i, char path[128]) {
    if (i < MODELS)
        snprintf(path, 128, "%s/model_%zu.off", folder, i);
    else
        snprintf(path, 128, "%s/%s", folder, i == MODELS ? "bad.off" : "models.db");
    return path;
}

static void write_models(starg_context *context) {
    char path[128];
    strcpy(folder, "/tmp/test_ranks_XXXXXX");
    assert_non_null(mkdtemp(folder));
    for (size_t i = 0; i < MODELS; i++) {
        shape s = shape_tetrahedron();
        s.vertices[0] -= 0.1 * (double)(i + 1);
        starg_mesh *mesh = test_mesh_of(context, &s);
        test_ok(context, starg_mesh_write(context, mesh, path_of(i, path), NULL));
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    FILE *file = fopen(path_of(MODELS, path), "w");
    assert_non_null(file);
    fputs("OFF\n3 1 0\n", file);
    fclose(file);
}

static void remove_models(void) {
    char path[128];
    for (size_t i = 0; i <= MODELS + 1; i++)
        unlink(path_of(i, path));
    assert_int_equal(rmdir(folder), 0);
}

/* A model that is stored already; a file that is not a model; the others, the first one again. */
static void fill(starg_context *context, starg_database_report **report,
                 starg_database_models **models) {
    static const size_t order[FILES] = {0, MODELS, 1, 2, 3, 0};
    static char paths[FILES][128];
    const char *files[FILES];
    char path[128];
    starg_database *database = NULL;
    starg_database_report *first = NULL;
    for (size_t i = 0; i < FILES; i++)
        files[i] = path_of(order[i], paths[i]);
    unlink(path_of(MODELS + 1, path));
    test_ok(context, starg_database_create(context, path));
    test_ok(context, starg_database_open(context, path, &database));
    test_ok(context, starg_database_add(database, files, 1, &first));
    starg_database_report_free(context, first);
    test_ok(context, starg_database_add(database, files, FILES, report));
    test_ok(context, starg_database_signatures(database, STARG_SIGNATURE_STAR, models));
    starg_database_close(database);
}

static void assert_same_models(const starg_database_models *a, const starg_database_models *b) {
    assert_int_equal(a->count, b->count);
    for (size_t i = 0; i < a->count; i++) {
        const starg_signature *x = a->items[i].signature, *y = b->items[i].signature;
        assert_int_equal(a->items[i].id, b->items[i].id);
        assert_string_equal(a->items[i].path, b->items[i].path);
        assert_string_equal(a->items[i].hash, b->items[i].hash);
        assert_int_equal(a->items[i].vertices, b->items[i].vertices);
        assert_int_equal(a->items[i].faces, b->items[i].faces);
        assert_int_equal(x->count, y->count);
        assert_memory_equal(x->numbers, y->numbers, x->count * sizeof *x->numbers);
    }
}

static void test_database(void **state) {
    (void)state;
    starg_context *alone = test_context(2);
    starg_database_report *expected = NULL, *report = NULL;
    starg_database_models *stored = NULL, *models = NULL;
    write_models(alone);
    fill(alone, &expected, &stored);
    assert_int_equal(expected->added, MODELS - 1);
    assert_int_equal(expected->known, 2);
    assert_int_equal(expected->refused, 1);
    network net;
    network_begin(&net, 3, 1);
    starg_context *context = test_context(1);
    starg_context_set_ranks(context, network_ranks(&net));
    fill(context, &report, &models);
    assert_true(starg_context_helped_items(context) > 0);
    for (size_t i = 0; i < FILES; i++) {
        assert_int_equal(report->results[i].outcome, expected->results[i].outcome);
        if (expected->results[i].text != NULL)
            assert_string_equal(report->results[i].text, expected->results[i].text);
    }
    assert_same_models(models, stored);
    starg_database_report_free(context, report);
    starg_database_models_free(context, models);
    test_context_free(context);
    network_end_all(&net);
    starg_database_report_free(alone, expected);
    starg_database_models_free(alone, stored);
    test_context_free(alone);
    remove_models();
}

/* ---- failures ---- */

static starg_status look(starg_context *context, const starg_solid *solid) {
    starg_bits *rows = NULL;
    starg_status status = starg_visibility(context, solid, points, POINTS, NULL, &rows);
    assert_int_equal(rows == NULL, status != STARG_OK);
    starg_bits_free(rows);
    return status;
}

/* The connection breaks after any number of messages. */
static void test_broken_way(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = solid_with_points(context);
    size_t failed = 0;
    for (long messages = 0; messages < 12; messages++) {
        network net;
        network_begin(&net, 3, 1);
        net.messages_left = messages;
        starg_context_set_ranks(context, network_ranks(&net));
        starg_status status = look(context, solid);
        failed += status == STARG_ERROR_RANK;
        assert_true(status == STARG_OK || status == STARG_ERROR_RANK);
        network_end_all(&net);
    }
    assert_true(failed > 6);
    starg_context_set_ranks(context, NULL);
    test_ok(context, look(context, solid));
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_garbled_replies(void **state) {
    (void)state;
    network net;
    starg_context *context = test_context(1);
    starg_solid *solid = solid_with_points(context);
    network_begin(&net, 2, 1);
    atomic_store(&net.garbles, true);
    starg_context_set_ranks(context, network_ranks(&net));
    assert_int_equal(look(context, solid), STARG_ERROR_RANK);
    network_end_all(&net);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Each of a helper's allocations fails once: the call fails with that or, if it was for a message,
 * with the loss of the helper; or the end of the run does, where that message came too late. */
static void test_memory_of_a_helper(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = solid_with_points(context);
    size_t failed = 0, lost = 0, left = 0;
    for (size_t n = 2; left == 0; n += 1 + n / 12) { /* 1: its context */
        network net;
        left = n;
        network_begin_failing(&net, 2, &left);
        starg_context_set_ranks(context, network_ranks(&net));
        starg_status status = look(context, solid);
        failed += status == STARG_ERROR_MEMORY;
        lost += status == STARG_ERROR_RANK;
        bool sound = network_end_all(&net);
        assert_true(status == STARG_OK
                        ? n < 4 || left > 0 || !sound
                        : status == STARG_ERROR_MEMORY || status == STARG_ERROR_RANK);
    }
    assert_true(failed > 10);
    assert_true(lost > 0);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Messages that rank 0 never sends. */
static void test_nonsense(void **state) {
    (void)state;
    starg_rng rng = starg_rng_make(3, 2, 1);
    for (int round = 0; round < 300; round++) {
        network net;
        unsigned char bytes[256];
        network_begin(&net, 2, 1);
        const starg_ranks *ranks = network_ranks(&net);
        for (int i = 0; i < 4; i++) {
            size_t size = (size_t)starg_rng_below(&rng, sizeof bytes);
            ranks_message head = {.kind = 1 + (uint32_t)starg_rng_below(&rng, 2),
                                  .work = (uint32_t)starg_rng_below(&rng, 4),
                                  .count = starg_rng_below(&rng, 3),
                                  .first = starg_rng_below(&rng, 3)};
            for (size_t k = 0; k < size; k++)
                bytes[k] =
                    (unsigned char)(starg_rng_below(&rng, 4) == 0 ? starg_rng_next(&rng) : 0);
            if (size >= sizeof head && round % 4 != 0)
                memcpy(bytes, &head, sizeof head);
            ranks->send(ranks->user, 1, bytes, size);
        }
        network_end_all(&net);
    }
}

static void test_time_limit(void **state) {
    (void)state;
    network net;
    starg_context *context = test_context(1);
    starg_solid *solid = solid_with_points(context);
    starg_guard_options options;
    starg_guards *guards = NULL;
    network_begin(&net, 2, 1);
    starg_context_set_ranks(context, network_ranks(&net));
    starg_context_set_time_limit(context, 1e-6);
    assert_int_equal(look(context, solid), STARG_ERROR_TIME);

    starg_guard_options_default(&options); /* stopped anywhere: a result that says so, or none */
    options.visibility.engine = STARG_VISIBILITY_SWEEP;
    options.candidate_count = 3000;
    starg_context_set_time_limit(context, 0.25);
    starg_status status = starg_guard(context, solid, &options, &guards);
    assert_true(status == STARG_OK ? guards->time_limited : status == STARG_ERROR_TIME);
    starg_context_set_time_limit(context, 0); /* the helpers continue as if nothing had happened */
    if (status == STARG_OK)
        test_verified(context, "cat", starg_solid_mesh(solid), guards);
    starg_guards_free(context, guards);
    test_ok(context, look(context, solid));
    network_end_all(&net);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Returns true until the first step of the rows. */
static bool refuse_late(void *user, const char *stage, double fraction) {
    (void)user;
    return strcmp(stage, "visibility") != 0 || fraction == 0;
}

static void test_cancel(void **state) {
    (void)state;
    network net;
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = 1;
    options.progress = refuse_late;
    starg_context *context = NULL;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    starg_solid *solid = solid_with_points(context);
    starg_visibility_options view;
    starg_bits *rows = NULL;
    network_begin(&net, 3, 1);
    starg_context_set_ranks(context, network_ranks(&net));
    starg_visibility_options_default(&view);
    view.engine = STARG_VISIBILITY_SWEEP;
    assert_int_equal(starg_visibility(context, solid, points, POINTS, &view, &rows),
                     STARG_ERROR_CANCELLED);
    assert_null(rows);
    network_end_all(&net);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Helpers have no ranks of their own; neither has a single process. */
static void test_no_helpers(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = solid_with_points(context);
    const starg_ranks alone = {.rank = 0, .count = 1}, helper = {.rank = 1, .count = 2};
    starg_context_set_ranks(context, &alone);
    test_ok(context, look(context, solid));
    starg_context_set_ranks(context, &helper);
    test_ok(context, look(context, solid));
    assert_int_equal(starg_context_helped_items(context), 0);
    assert_true(starg_context_shared_seconds(context) == 0);
    starg_solid_free(solid);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_rows_of_a_soup),
        cmocka_unit_test(test_guards),
        cmocka_unit_test(test_cells),
        cmocka_unit_test(test_cells_without_helper),
        cmocka_unit_test(test_database),
        cmocka_unit_test(test_broken_way),
        cmocka_unit_test(test_garbled_replies),
        cmocka_unit_test(test_memory_of_a_helper),
        cmocka_unit_test(test_nonsense),
        cmocka_unit_test(test_time_limit),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_no_helpers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
