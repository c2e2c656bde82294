/* Memory that fails at every place of the calls that compare shapes and turn one into another:
 * signatures, descriptors, the database, maps, morphs. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/database.h"
#include "starguard/shape.h"

static failing_inputs in;
static input_bytes descriptor_text, database_file;

/* ---- signatures ---- */

static starg_status signature_result(starg_context *context, starg_status status,
                                     starg_signature *signature) {
    failing_result(status, signature);
    starg_signature_free(context, signature);
    return status;
}

static starg_status signature_of(starg_context *context, starg_signature_kind kind) {
    starg_signature *s = NULL;
    starg_status status = starg_signature_create(context, in.cube, kind, &s);
    return signature_result(context, status, s);
}

static starg_status signature_d2(starg_context *context) {
    return signature_of(context, STARG_SIGNATURE_D2);
}

static starg_status signature_dna(starg_context *context) {
    return signature_of(context, STARG_SIGNATURE_SHAPE_DNA);
}

static starg_status signature_star(starg_context *context) {
    return signature_of(context, STARG_SIGNATURE_STAR);
}

static starg_status signature_create_all(starg_context *context) {
    starg_signature *all[STARG_SIGNATURE_KINDS] = {NULL};
    starg_status status = starg_signature_create_all(context, in.cube, all);
    for (size_t i = 0; i < STARG_SIGNATURE_KINDS; i++) {
        failing_result(status, all[i]);
        starg_signature_free(context, all[i]);
    }
    return status;
}

static starg_status signature_restore(starg_context *context) {
    const starg_signature *from = in.papers[0];
    starg_signature *s = NULL;
    starg_status status =
        starg_signature_restore(context, from->kind, from->version, from->numbers, from->count, &s);
    return signature_result(context, status, s);
}

static starg_status distance_star(starg_context *context) {
    double d;
    return starg_signature_distance(context, in.stars[0], in.stars[1], &d);
}

static starg_status distance_paper(starg_context *context) {
    double d;
    return starg_signature_distance(context, in.papers[0], in.papers[1], &d);
}

static starg_status distances(starg_context *context) {
    double d[4];
    return starg_signature_distances(context, in.papers, 2, d);
}

static starg_status retrieval_measure(starg_context *context) {
    static const double table[] = {0, 1, 2, 1, 0, 3, 2, 3, 0};
    static const uint32_t class_of[] = {0, 0, 1};
    starg_retrieval classes[2], overall;
    return starg_retrieval_measure(context, table, class_of, 3, 2, classes, &overall);
}

/* ---- descriptors ---- */

static starg_status descriptor_result(starg_context *context, starg_status status,
                                      starg_descriptor *descriptor) {
    failing_result(status, descriptor);
    starg_descriptor_free(context, descriptor);
    return status;
}

static starg_status describe(starg_context *context, const starg_mesh *mesh, size_t detail) {
    starg_descriptor_options options;
    starg_descriptor *d = NULL;
    starg_descriptor_options_default(&options);
    options.direction_count = 12;
    options.detail = detail;
    options.effort = 3;
    starg_status status = starg_descriptor_create(context, mesh, &options, &d);
    return descriptor_result(context, status, d);
}

static starg_status descriptor_create(starg_context *context) {
    return describe(context, in.cube, 0);
}

static starg_status descriptor_simplified(starg_context *context) {
    return describe(context, in.fine_blob, 100);
}

static starg_status descriptor_write(starg_context *context) {
    return starg_descriptor_write(context, in.descriptor, "r.off", failing_output("d.json"));
}

static starg_status descriptor_write_memory(starg_context *context) {
    char *text;
    size_t size;
    starg_status status =
        starg_descriptor_write_memory(context, in.descriptor, "r.off", &text, &size);
    failing_result(status, text);
    starg_text_free(context, text);
    return status;
}

static starg_status descriptor_read(starg_context *context) {
    starg_descriptor *d = NULL;
    starg_status status = starg_descriptor_read(context, failing_input("descriptor.json"), &d);
    return descriptor_result(context, status, d);
}

static starg_status descriptor_read_memory(starg_context *context) {
    starg_descriptor *d = NULL;
    starg_status status =
        starg_descriptor_read_memory(context, descriptor_text.data, descriptor_text.size, "d", &d);
    return descriptor_result(context, status, d);
}

static starg_status descriptor_points(starg_context *context) {
    double *points = NULL;
    starg_status status = starg_descriptor_points(context, in.descriptor, &points);
    failing_result(status, points);
    starg_descriptor_points_free(context, points);
    return status;
}

static starg_status descriptor_reconstruct(starg_context *context) {
    starg_reconstruction result;
    return starg_descriptor_reconstruct(context, in.descriptor, in.room, &result);
}

static starg_status signature_of_star(starg_context *context) {
    starg_signature *s = NULL;
    starg_status status =
        starg_signature_of_descriptor(context, in.descriptor, STARG_SIGNATURE_STAR, &s);
    return signature_result(context, status, s);
}

static starg_status signature_of_paper(starg_context *context) {
    starg_signature *s = NULL;
    starg_status status =
        starg_signature_of_descriptor(context, in.descriptor, STARG_SIGNATURE_PAPER, &s);
    return signature_result(context, status, s);
}

/* ---- the database ---- */

static starg_status database_create(starg_context *context) {
    return starg_database_create(context, failing_output("new.db"));
}

static starg_status database_open(starg_context *context) {
    starg_database *database = NULL;
    starg_status status = starg_database_open(context, failing_input("shapes.db"), &database);
    failing_result(status, database);
    starg_database_close(database);
    return status;
}

/* Opens a database with memory that holds; the call that follows has memory that fails. */
static starg_database *opened(starg_context *context, const char *path) {
    starg_database *database = NULL;
    failing_pause();
    test_ok(context, starg_database_open(context, path, &database));
    failing_resume();
    return database;
}

/* A copy of the database in memory, to be changed. */
static const char *scratch_database(void) {
    const char *path = failing_input("scratch.db");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(database_file.data, 1, database_file.size, file), database_file.size);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* How many models it has; whatever fails, it stays in order. */
static size_t models_in(starg_context *context, starg_database *database) {
    starg_database_models *models = NULL;
    failing_pause();
    test_ok(context, starg_database_list(database, &models));
    size_t count = models->count;
    starg_database_models_free(context, models);
    failing_resume();
    return count;
}

/* The report tells what became of each file; models that stand in the database already stay there,
 * and new ones may have got there before memory failed. */
static starg_status database_add(starg_context *context) {
    starg_database *database = opened(context, scratch_database());
    starg_database_report *report = NULL;
    const char *const files[] = {failing_input("room.off"), failing_input("room.stl"),
                                 "/nowhere/missing.off"};
    starg_status status = starg_database_add(database, files, 3, &report);
    failing_result(status, report);
    size_t models = models_in(context, database);
    if (status == STARG_OK)
        assert_true(report->known == 1 && report->added == 1 && report->refused == 1 &&
                    models == 3);
    assert_true(models == 2 || models == 3);
    starg_database_report_free(context, report);
    starg_database_close(database);
    return status;
}

static starg_status database_remove(starg_context *context) {
    starg_database *database = opened(context, scratch_database());
    static const char *const words[] = {"cube.off", "id:1"};
    starg_status status = starg_database_remove(database, words, 2);
    assert_int_equal(models_in(context, database), status == STARG_OK ? 0 : 2);
    starg_database_close(database);
    return status;
}

static starg_status models_result(starg_context *context, starg_database *database,
                                  starg_status status, starg_database_models *models) {
    failing_result(status, models);
    starg_database_models_free(context, models);
    starg_database_close(database);
    return status;
}

static starg_status database_list(starg_context *context) {
    starg_database *database = opened(context, failing_input("shapes.db"));
    starg_database_models *models = NULL;
    starg_status status = starg_database_list(database, &models);
    return models_result(context, database, status, models);
}

static starg_status database_signatures(starg_context *context) {
    starg_database *database = opened(context, failing_input("shapes.db"));
    starg_database_models *models = NULL;
    starg_status status = starg_database_signatures(database, STARG_SIGNATURE_PAPER, &models);
    return models_result(context, database, status, models);
}

static starg_status database_query(starg_context *context) {
    starg_database *database = opened(context, failing_input("shapes.db"));
    starg_database_models *models = NULL;
    starg_status status = starg_database_query(database, in.stars[0], 1, &models);
    return models_result(context, database, status, models);
}

/* ---- classes ---- */

static starg_database_models *two_models(void) {
    static char room[] = "room.off", cube[] = "cube.off";
    static starg_database_model items[] = {{.path = room, .name = room},
                                           {.path = cube, .name = cube}};
    static starg_database_models models = {2, items};
    return &models;
}

static starg_status classes_by_prefix(starg_context *context) {
    starg_classes *classes = NULL;
    starg_status status = starg_classes_by_prefix(context, two_models(), &classes);
    failing_result(status, classes);
    starg_classes_free(context, classes);
    return status;
}

static starg_status classes_read(starg_context *context) {
    starg_classes *classes = NULL;
    starg_status status =
        starg_classes_read(context, failing_input("classes.txt"), two_models(), &classes);
    failing_result(status, classes);
    starg_classes_free(context, classes);
    return status;
}

/* ---- maps ---- */

static starg_status map_result(starg_context *context, starg_status status, starg_map *map) {
    failing_result(status, map);
    starg_map_free(context, map);
    return status;
}

static starg_status map_same(starg_context *context) {
    starg_map *map = NULL;
    starg_status status = starg_map_create(context, in.cube, in.box, NULL, &map);
    return map_result(context, status, map);
}

static starg_status map_sphere(starg_context *context) {
    starg_map *map = NULL;
    starg_status status = starg_map_create(context, in.blob, in.other_blob, NULL, &map);
    return map_result(context, status, map);
}

static starg_status map_landmarks(starg_context *context) {
    static const uint32_t pairs[] = {0, 0, 2, 2, 4, 4};
    const starg_map_options options = {pairs, 3};
    starg_map *map = NULL;
    starg_status status = starg_map_create(context, in.blob, in.other_blob, &options, &map);
    return map_result(context, status, map);
}

static starg_status map_write(starg_context *context) {
    return starg_map_write(context, in.map, failing_output("m.json"));
}

static starg_status map_write_memory(starg_context *context) {
    char *text;
    size_t size;
    starg_status status = starg_map_write_memory(context, in.map, &text, &size);
    failing_result(status, text);
    starg_text_free(context, text);
    return status;
}

static starg_status map_read(starg_context *context) {
    starg_map *map = NULL;
    starg_status status =
        starg_map_read(context, failing_input("map.json"), in.blob, in.other_blob, &map);
    return map_result(context, status, map);
}

static starg_status landmarks_read(starg_context *context) {
    uint32_t *pairs = NULL;
    size_t count = 0;
    starg_status status = starg_landmarks_read(context, failing_input("landmarks.txt"), in.cube,
                                               in.cube, &pairs, &count);
    assert_int_equal(count, status == STARG_OK ? 3 : 0);
    failing_result(status, pairs);
    starg_landmarks_free(context, pairs);
    return status;
}

/* ---- morphs ---- */

static starg_status morph_of(starg_context *context, starg_morph_method method,
                             starg_morph **morph) {
    starg_morph_options options;
    starg_morph_options_default(&options);
    options.method = method;
    options.candidates = 8;
    return starg_morph_create(context, in.cube, starg_mesh_vertices(in.box), &options, morph);
}

static starg_status morph_result(starg_status status, starg_morph *morph) {
    failing_result(status, morph);
    starg_morph_free(morph);
    return status;
}

static starg_status morph_star(starg_context *context) {
    starg_morph *morph = NULL;
    starg_status status = morph_of(context, STARG_MORPH_STAR, &morph);
    return morph_result(status, morph);
}

static starg_status morph_arap(starg_context *context) {
    starg_morph *morph = NULL;
    starg_status status = morph_of(context, STARG_MORPH_ARAP, &morph);
    return morph_result(status, morph);
}

static starg_status morph_linear(starg_context *context) {
    starg_morph *morph = NULL;
    starg_status status = morph_of(context, STARG_MORPH_LINEAR, &morph);
    return morph_result(status, morph);
}

static starg_status morph_spherical(starg_context *context) {
    starg_morph *morph = NULL;
    starg_status status = morph_of(context, STARG_MORPH_SPHERICAL, &morph);
    return morph_result(status, morph);
}

/* A morph with memory that holds; what is asked of it has memory that fails. */
static starg_morph *ready(starg_context *context) {
    starg_morph *morph = NULL;
    failing_pause();
    test_ok(context, morph_of(context, STARG_MORPH_STAR, &morph));
    failing_resume();
    return morph;
}

static starg_status morph_frame(starg_context *context) {
    starg_morph *morph = ready(context);
    double positions[24];
    starg_status status = starg_morph_frame(morph, 0.5, positions);
    starg_morph_free(morph);
    return status;
}

static starg_status morph_measure(starg_context *context) {
    starg_morph *morph = ready(context);
    starg_frame_measures measures;
    starg_status status = starg_morph_measure(morph, 0, starg_mesh_vertices(in.cube), &measures);
    starg_morph_free(morph);
    return status;
}

static starg_status morph_guards_result(starg_context *context) {
    starg_morph *morph = ready(context);
    starg_guards *guards = NULL;
    starg_status status = starg_morph_guards_result(morph, 0, &guards);
    failing_result(status, guards);
    starg_guards_free(context, guards);
    starg_morph_free(morph);
    return status;
}

static starg_status morph_guards_separate(starg_context *context) {
    starg_morph *morph = ready(context);
    starg_guards *guards = NULL;
    starg_status status = starg_morph_guards_separate(morph, 1, &guards);
    failing_result(status, guards);
    starg_guards_free(context, guards);
    starg_morph_free(morph);
    return status;
}

static starg_status morph_solids(starg_context *context) {
    starg_morph *morph = ready(context);
    starg_decomposition *solids[2] = {NULL, NULL};
    starg_status status = starg_morph_solids(morph, solids);
    for (int end = 0; end < 2; end++) {
        failing_result(status, solids[end]);
        starg_decomposition_free(context, solids[end]);
    }
    starg_morph_free(morph);
    return status;
}

/* ---- the tables ---- */

static const failing_call signatures[] = {
    {"starg_signature_create", "d2", signature_d2, NULL},
    {"starg_signature_create", "shape-dna", signature_dna, NULL},
    {"starg_signature_create", "star", signature_star, NULL},
    {"starg_signature_create_all", "", signature_create_all, NULL},
    {"starg_signature_restore", "", signature_restore, NULL},
    {"starg_signature_distance", "star", distance_star, NULL},
    {"starg_signature_distance", "paper", distance_paper, NULL},
    {"starg_signature_distances", "paper", distances, NULL},
    {"starg_retrieval_measure", "", retrieval_measure, NULL},
};

static const failing_call descriptors[] = {
    {"starg_descriptor_create", "as it is", descriptor_create, NULL},
    {"starg_descriptor_create", "brought down", descriptor_simplified, NULL},
    {"starg_descriptor_write", "", descriptor_write, NULL},
    {"starg_descriptor_write_memory", "", descriptor_write_memory, NULL},
    {"starg_descriptor_read", "", descriptor_read, NULL},
    {"starg_descriptor_read_memory", "", descriptor_read_memory, NULL},
    {"starg_descriptor_points", "", descriptor_points, NULL},
    {"starg_descriptor_reconstruct", "", descriptor_reconstruct, NULL},
    {"starg_signature_of_descriptor", "star", signature_of_star, NULL},
    {"starg_signature_of_descriptor", "paper", signature_of_paper, NULL},
};

static const failing_call databases[] = {
    {"starg_database_create", "", database_create, NULL},
    {"starg_database_open", "", database_open, NULL},
    {"starg_database_add", "new, known, missing", database_add, NULL},
    {"starg_database_remove", "", database_remove, NULL},
    {"starg_database_list", "", database_list, NULL},
    {"starg_database_signatures", "", database_signatures, NULL},
    {"starg_database_query", "", database_query, NULL},
    {"starg_classes_by_prefix", "", classes_by_prefix, NULL},
    {"starg_classes_read", "", classes_read, NULL},
};

static const failing_call maps[] = {
    {"starg_map_create", "same faces", map_same, NULL},
    {"starg_map_create", "sphere", map_sphere, NULL},
    {"starg_map_create", "sphere, landmarks", map_landmarks, NULL},
    {"starg_map_write", "", map_write, NULL},
    {"starg_map_write_memory", "", map_write_memory, NULL},
    {"starg_map_read", "", map_read, NULL},
    {"starg_landmarks_read", "", landmarks_read, NULL},
};

static const failing_call morphs[] = {
    {"starg_morph_create", "star", morph_star, NULL},
    {"starg_morph_create", "arap", morph_arap, NULL},
    {"starg_morph_create", "linear", morph_linear, NULL},
    {"starg_morph_create", "spherical", morph_spherical, NULL},
    {"starg_morph_frame", "star", morph_frame, NULL},
    {"starg_morph_measure", "", morph_measure, NULL},
    {"starg_morph_guards_result", "", morph_guards_result, NULL},
    {"starg_morph_guards_separate", "", morph_guards_separate, NULL},
};

static const failing_call by_tetgen[] = {
    {"starg_morph_solids", "", morph_solids, NULL},
};

static void test_signatures(void **state) {
    (void)state;
    FAILING_RUN(signatures);
}

static void test_descriptors(void **state) {
    (void)state;
    FAILING_RUN(descriptors);
}

static void test_databases(void **state) {
    (void)state;
    FAILING_RUN(databases);
}

static void test_maps(void **state) {
    (void)state;
    FAILING_RUN(maps);
}

static void test_morphs(void **state) {
    (void)state;
    FAILING_RUN(morphs);
}

static void test_tetgen(void **state) {
    (void)state;
    starg_status status = morph_solids(in.context);
    if (status == STARG_ERROR_SOLVER) {
        printf("skipped: %s\n", starg_context_error(in.context)->message);
        skip();
    }
    test_ok(in.context, status);
    FAILING_RUN(by_tetgen);
}

static int set_up(void **state) {
    (void)state;
    failing_inputs_make(&in);
    descriptor_text = failing_input_bytes("descriptor.json");
    database_file = failing_input_bytes("shapes.db");
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(descriptor_text.data);
    free(database_file.data);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_signatures), cmocka_unit_test(test_descriptors),
        cmocka_unit_test(test_databases),  cmocka_unit_test(test_maps),
        cmocka_unit_test(test_morphs),     cmocka_unit_test(test_tetgen),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
