/* SPDX-License-Identifier: Apache-2.0 */
/* Memory failures at every place in calls that compare and morph shapes: signatures, descriptors,
 * the database, maps, morphs. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/database.h"
#include "starguard/shape.h"
#include "starguard/solidmap.h"

static failing_inputs in;
static input_bytes descriptor_text, database_file, map_text, report_text, solid_text;
static starg_map_file *map_file;
static starg_morph_report *morph_report;
static starg_mesh *simplex; /* whose only map is the identity */

/* ---- signatures ---- */

#define SIGNATURE(NAME, VARIANT, ...)                                                              \
    FAILING_MAKES(NAME, VARIANT, starg_signature, starg_signature_free(context, out), __VA_ARGS__)

static starg_status signature_create_all(starg_context *context) {
    starg_signature *all[STARG_SIGNATURE_KINDS] = {NULL};
    starg_status status = starg_signature_create_all(context, in.cube, all);
    for (size_t i = 0; i < STARG_SIGNATURE_KINDS; i++) {
        failing_result(status, all[i]);
        starg_signature_free(context, all[i]);
    }
    return status;
}

static starg_status signatures(starg_context *context) {
    static const double table[] = {0, 1, 2, 1, 0, 3, 2, 3, 0};
    static const uint32_t class_of[] = {0, 0, 1};
    const starg_signature *from = in.papers[0];
    starg_retrieval classes[2], overall;
    starg_alignment alignment;
    double d[4];
    SIGNATURE(starg_signature_create, "d2", in.cube, STARG_SIGNATURE_D2);
    SIGNATURE(starg_signature_create, "shape-dna", in.cube, STARG_SIGNATURE_SHAPE_DNA);
    SIGNATURE(starg_signature_create, "star", in.cube, STARG_SIGNATURE_STAR);
    FAILING_BY(starg_signature_create_all, "", signature_create_all(context));
    SIGNATURE(starg_signature_restore, "", from->kind, from->version, from->numbers, from->count);
    FAILING(starg_signature_distance, "star", in.stars[0], in.stars[1], d);
    FAILING(starg_signature_distance, "paper", in.papers[0], in.papers[1], d);
    FAILING(starg_signature_distances, "paper", in.papers, 2, d);
    FAILING(starg_alignment_measure, "", in.cube, in.cube, &alignment);
    FAILING(starg_retrieval_measure, "", table, class_of, 3, 2, classes, &overall);
    return STARG_OK;
}

/* ---- descriptors ---- */

#define DESCRIPTOR(NAME, VARIANT, ...)                                                             \
    FAILING_MAKES(NAME, VARIANT, starg_descriptor, starg_descriptor_free(context, out), __VA_ARGS__)

static starg_status descriptors(starg_context *context) {
    starg_descriptor_options as_it_is, brought_down;
    starg_reconstruction result;
    starg_descriptor_options_default(&as_it_is);
    as_it_is.direction_count = 12;
    as_it_is.detail = 0;
    as_it_is.effort = 3;
    brought_down = as_it_is;
    brought_down.detail = 100;
    DESCRIPTOR(starg_descriptor_create, "as it is", in.cube, &as_it_is);
    DESCRIPTOR(starg_descriptor_create, "brought down", in.fine_blob, &brought_down);
    FAILING(starg_descriptor_write, "", in.descriptor, "r.off", failing_output("d.json"));
    FAILING_TEXT(starg_descriptor_write_memory, "", in.descriptor, "r.off");
    DESCRIPTOR(starg_descriptor_read, "", failing_input("descriptor.json"));
    DESCRIPTOR(starg_descriptor_read_memory, "", descriptor_text.data, descriptor_text.size, "d");
    FAILING_MAKES(starg_descriptor_points, "", double, starg_descriptor_points_free(context, out),
                  in.descriptor);
    FAILING(starg_descriptor_reconstruct, "", in.descriptor, in.room, &result);
    SIGNATURE(starg_signature_of_descriptor, "star", in.descriptor, STARG_SIGNATURE_STAR);
    SIGNATURE(starg_signature_of_descriptor, "paper", in.descriptor, STARG_SIGNATURE_PAPER);
    return STARG_OK;
}

/* ---- the database ---- */

/* Opens a database with working memory; memory fails in the call that follows. */
static starg_database *opened(starg_context *context, const char *path) {
    starg_database *database = NULL;
    failing_pause();
    test_ok(context, starg_database_open(context, path, &database));
    failing_resume();
    return database;
}

/* A copy of the database in memory, for changes. */
static const char *scratch_database(void) {
    const char *path = failing_input("scratch.db");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(database_file.data, 1, database_file.size, file), database_file.size);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* Number of models; the database stays consistent whatever fails. */
static size_t models_in(starg_context *context, starg_database *database) {
    starg_database_models *models = NULL;
    failing_pause();
    test_ok(context, starg_database_list(database, &models));
    size_t count = models->count;
    starg_database_models_free(context, models);
    failing_resume();
    return count;
}

/* The report tells the outcome for each file; existing models stay, and new ones may have been
 * added before memory failed. */
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

static starg_database_models *two_models(void) {
    static char room[] = "room.off", cube[] = "cube.off";
    static starg_database_model items[] = {{.path = room, .name = room},
                                           {.path = cube, .name = cube}};
    static starg_database_models models = {2, items};
    return &models;
}

/* NAME(database, ..., &out), with an existing database. */
#define MODELS(NAME, VARIANT, ...)                                                                 \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT)) {                                                        \
            starg_database *database = opened(context, failing_input("shapes.db"));                \
            starg_database_models *out = NULL;                                                     \
            starg_status status = NAME(__VA_ARGS__);                                               \
            failing_result(status, out);                                                           \
            starg_database_models_free(context, out);                                              \
            starg_database_close(database);                                                        \
            return status;                                                                         \
        }                                                                                          \
    while (0)
#define CLASSES(NAME, VARIANT, ...)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_classes, starg_classes_free(context, out), __VA_ARGS__)

static starg_status databases(starg_context *context) {
    FAILING(starg_database_create, "", failing_output("new.db"));
    FAILING_MAKES(starg_database_open, "", starg_database, starg_database_close(out),
                  failing_input("shapes.db"));
    FAILING_BY(starg_database_add, "new, known, missing", database_add(context));
    FAILING_BY(starg_database_remove, "", database_remove(context));
    MODELS(starg_database_list, "", database, &out);
    MODELS(starg_database_signatures, "", database, STARG_SIGNATURE_PAPER, &out);
    MODELS(starg_database_query, "", database, in.stars[0], 1, &out);
    CLASSES(starg_classes_by_prefix, "", two_models());
    CLASSES(starg_classes_read, "", failing_input("classes.txt"), two_models());
    return STARG_OK;
}

/* ---- maps ---- */

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

#define MAP(NAME, VARIANT, ...)                                                                    \
    FAILING_MAKES(NAME, VARIANT, starg_map, starg_map_free(context, out), __VA_ARGS__)

/* A map with working memory; memory fails when its overlay is made. */
static starg_status map_overlay(starg_context *context) {
    starg_map *map = NULL;
    failing_pause();
    test_ok(context, starg_map_create(context, in.blob, in.other_blob, NULL, &map));
    failing_resume();
    starg_status status = starg_map_overlay(context, in.blob, in.other_blob, map);
    assert_true((status == STARG_OK) == (map->overlay.face_count > 0));
    starg_map_free(context, map);
    return status;
}

/* A mesh with the overlay's faces gets colours and texture coordinates; memory fails then. */
static starg_status overlay_look(starg_context *context) {
    starg_map *map = NULL;
    starg_mesh *a = NULL, *refined = NULL;
    failing_pause();
    test_ok(context, starg_map_create(context, in.blob, in.other_blob, NULL, &map));
    test_ok(context, starg_map_overlay(context, in.blob, in.other_blob, map));
    const starg_overlay *overlay = &map->overlay;
    const size_t vertices = starg_mesh_vertex_count(in.blob);
    const size_t faces = starg_mesh_face_count(in.blob);
    double *places = malloc(3 * overlay->vertex_count * sizeof *places);
    uint8_t *colors = calloc(3 * vertices, 1);
    float *texture = calloc(6 * faces, sizeof *texture);
    starg_overlay_positions(overlay, in.blob, 0, places);
    test_ok(context, starg_mesh_create(context, places, overlay->vertex_count, overlay->faces,
                                       overlay->face_count, &refined));
    test_ok(context, starg_mesh_create(context, starg_mesh_vertices(in.blob), vertices,
                                       starg_mesh_faces(in.blob), faces, &a));
    test_ok(context, starg_mesh_set_colors(a, colors));
    test_ok(context, starg_mesh_set_texture(a, texture));
    failing_resume();
    starg_status status = starg_overlay_look(context, overlay, a, refined);
    free(places);
    free(colors);
    free(texture);
    starg_mesh_free(a);
    starg_mesh_free(refined);
    starg_map_free(context, map);
    return status;
}

#define VERDICT(NAME, VARIANT, ...)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_verdict, starg_verdict_free(context, out), __VA_ARGS__)

static starg_status maps(starg_context *context) {
    double apart;
    static const uint32_t pairs[] = {0, 0, 2, 2, 4, 4};
    const starg_map_options landmarks = {.landmarks = pairs, .landmark_count = 3};
    const starg_map_options solid = {.solid = true};
    MAP(starg_map_create, "same faces", in.cube, in.box, NULL);
    MAP(starg_map_create, "sphere", in.blob, in.other_blob, NULL);
    MAP(starg_map_create, "sphere, landmarks", in.blob, in.other_blob, &landmarks);
    MAP(starg_map_create, "stars", in.blob, in.other_blob, &solid);
    FAILING_BY(starg_map_overlay, "", map_overlay(context));
    FAILING_BY(starg_overlay_look, "", overlay_look(context));
    FAILING(starg_map_write, "", in.map, failing_output("m.json"));
    FAILING_TEXT(starg_map_write_memory, "", in.map);
    MAP(starg_map_read, "", failing_input("map.json"), in.blob, in.other_blob);
    FAILING_MAKES(starg_map_file_read_memory, "", starg_map_file, starg_map_file_free(out),
                  map_text.data, map_text.size, "m");
    VERDICT(starg_verify_map, "", in.blob, in.other_blob, map_file);
    FAILING_BY(starg_landmarks_read, "", landmarks_read(context));
    FAILING(starg_mesh_apart, "", in.blob, in.cube, &apart);
    return STARG_OK;
}

/* ---- morphs ---- */

static const starg_morph_options *by(starg_morph_method method) {
    static starg_morph_options options;
    starg_morph_options_default(&options);
    options.method = method;
    options.candidates = 8;
    return &options;
}

/* Makes a morph with working memory; memory fails in later calls on it. */
static starg_morph *ready(starg_context *context) {
    starg_morph *morph = NULL;
    failing_pause();
    test_ok(context, starg_morph_create(context, in.cube, starg_mesh_vertices(in.box),
                                        by(STARG_MORPH_STAR), &morph));
    failing_resume();
    return morph;
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

#define MORPH(NAME, VARIANT, METHOD)                                                               \
    FAILING_MAKES(NAME, VARIANT, starg_morph, starg_morph_free(out), in.cube,                      \
                  starg_mesh_vertices(in.box), by(STARG_MORPH_##METHOD))
/* NAME(morph, ...), which may make guards. */
#define OF_MORPH(NAME, VARIANT, ...)                                                               \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT)) {                                                        \
            starg_morph *morph = ready(context);                                                   \
            starg_status status = NAME(morph, __VA_ARGS__);                                        \
            assert_true(status == STARG_OK || guards == NULL);                                     \
            starg_guards_free(context, guards);                                                    \
            starg_morph_free(morph);                                                               \
            return status;                                                                         \
        }                                                                                          \
    while (0)

static starg_status verified_morphs(starg_context *context) {
    const starg_mesh *const frames[] = {in.cube, in.box}, *const refined[] = {in.blob, in.blob};
    FAILING_MAKES(starg_morph_report_read_memory, "", starg_morph_report,
                  starg_morph_report_free(out), report_text.data, report_text.size, "m");
    VERDICT(starg_verify_morph, "", in.cube, in.blob, frames, 2, morph_report);
    VERDICT(starg_verify_morph, "refined", in.other_blob, in.other_blob, refined, 2, NULL);
    return STARG_OK;
}

static starg_status morphs(starg_context *context) {
    double positions[24];
    starg_frame_measures measures;
    starg_guards *guards = NULL;
    MORPH(starg_morph_create, "star", STAR);
    MORPH(starg_morph_create, "arap", ARAP);
    MORPH(starg_morph_create, "linear", LINEAR);
    MORPH(starg_morph_create, "spherical", SPHERICAL);
    OF_MORPH(starg_morph_frame, "star", 0.5, positions);
    OF_MORPH(starg_morph_measure, "", 0, starg_mesh_vertices(in.cube), &measures);
    OF_MORPH(starg_morph_guards_result, "", 0, &guards);
    OF_MORPH(starg_morph_guards_separate, "", 1, &guards);
    return STARG_OK;
}

/* ---- maps between solids ---- */

#define SOLID_MAP(NAME, VARIANT, ...)                                                              \
    FAILING_MAKES(NAME, VARIANT, starg_solid_map, starg_solid_map_free(context, out), __VA_ARGS__)
#define SAMPLES(NAME, VARIANT, ...)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_samples, starg_samples_free(context, out), __VA_ARGS__)

/* The identity of a tetrahedron, a piece of its own. */
static double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, inside[] = {0.25, 0.25, 0.25};
static double time_of_key[] = {0.5};
static uint32_t one_tetrahedron[] = {0, 1, 2, 3};
static int32_t one_label[] = {0};
static const starg_solid_map identity = {.vertex_count = 4,
                                         .count = 1,
                                         .vertices = corners,
                                         .images = corners,
                                         .tetrahedra = one_tetrahedron,
                                         .labels = one_label,
                                         .piece_count = 1,
                                         .guards = inside,
                                         .guard_images = inside,
                                         .worst = 1,
                                         .mean = 1,
                                         .key_count = 1,
                                         .times = time_of_key,
                                         .keys = corners};

static starg_status solid_map_by_overlay(starg_context *context, const starg_mesh *a,
                                         const starg_mesh *b) {
    starg_map *surfaces = NULL;
    starg_solid_map *map = NULL;
    failing_pause();
    test_ok(context, starg_map_create(context, a, b, NULL, &surfaces));
    test_ok(context, starg_map_overlay(context, a, b, surfaces));
    failing_resume();
    starg_status status = starg_solid_map_overlay(context, a, b, surfaces, NULL, &map);
    failing_result(status, map);
    starg_solid_map_free(context, map);
    starg_map_free(context, surfaces);
    return status;
}

static starg_status solid_maps(starg_context *context) {
    static double values[] = {1, 2, 3};
    const starg_samples samples = {.count = 1, .width = 3, .points = inside, .values = values};
    SOLID_MAP(starg_solid_map_read_memory, "", solid_text.data, solid_text.size, "map.vtu");
    FAILING(starg_solid_map_write, "", &identity, failing_output("other.vtu"));
    FAILING_BY(starg_solid_map_overlay, "cones",
               solid_map_by_overlay(context, in.blob, in.other_blob));
    starg_solid_map compared = identity;
    FAILING(starg_solid_map_compare, "", in.cube, &compared);
    FAILING_MAKES(starg_verify_solid_map, "", starg_verdict, starg_verdict_free(context, out),
                  simplex, simplex, &identity);
    SAMPLES(starg_solid_map_carry, "", &identity, &samples, true);
    SAMPLES(starg_samples_read, "", failing_input("samples.txt"));
    FAILING(starg_samples_write, "", &samples, failing_output("samples.txt"));
    return STARG_OK;
}

static starg_status solid_map_of_morph(starg_context *context) {
    starg_morph *morph = NULL;
    starg_solid_map *map = NULL;
    failing_pause();
    test_ok(context, starg_morph_create(context, in.cube, starg_mesh_vertices(in.box),
                                        by(STARG_MORPH_SOLID), &morph));
    failing_resume();
    starg_status status = starg_morph_solid_map(morph, &map);
    failing_result(status, map);
    starg_solid_map_free(context, map);
    starg_morph_free(morph);
    return status;
}

static starg_status by_tetgen(starg_context *context) {
    FAILING_BY(starg_morph_solids, "", morph_solids(context));
    MORPH(starg_morph_create, "solid", SOLID);
    SOLID_MAP(starg_solid_map_create, "", in.cube, starg_mesh_vertices(in.box), NULL);
    FAILING_BY(starg_solid_map_overlay, "", solid_map_by_overlay(context, in.cube, in.box));
    SOLID_MAP(starg_solid_map_to, "ball", in.cube, STARG_SOLID_BALL, NULL);
    FAILING_BY(starg_morph_solid_map, "", solid_map_of_morph(context));
    return STARG_OK;
}

FAILING_TEST(signatures)
FAILING_TEST(descriptors)
FAILING_TEST(databases)
FAILING_TEST(maps)
FAILING_TEST(morphs)
FAILING_TEST(verified_morphs)
FAILING_TEST(solid_maps)

static void test_tetgen(void **state) {
    (void)state;
    failing_run_with_tetgen(by_tetgen);
}

/* What tests with failing memory verify. */
static void read_claims(void) {
    static const char text[] =
        "{\"format\": \"starguard-morph\", \"version\": 1, \"frames\": ["
        "{\"t\": 0, \"intersections\": 0, \"volume\": 1, \"area\": 6, \"volume_drift\": 0, "
        "\"area_drift\": 0}, {\"t\": 1, \"intersections\": 0, \"volume\": 1, \"area\": 6, "
        "\"volume_drift\": 0, \"area_drift\": 0}]}";
    report_text = (input_bytes){malloc(sizeof text), sizeof text - 1};
    assert_non_null(report_text.data);
    memcpy(report_text.data, text, sizeof text);
    map_text = failing_input_bytes("map.json");
    test_ok(in.context,
            starg_map_file_read_memory(in.context, map_text.data, map_text.size, "map", &map_file));
    test_ok(in.context, starg_morph_report_read_memory(in.context, report_text.data,
                                                       report_text.size, "report", &morph_report));
}

static int set_up(void **state) {
    (void)state;
    static const uint32_t faces[] = {1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1};
    failing_inputs_make(&in);
    read_claims();
    test_ok(in.context, starg_mesh_create(in.context, corners, 4, faces, 4, &simplex));
    test_ok(in.context, starg_solid_map_write(in.context, &identity, failing_input("map.vtu")));
    solid_text = failing_input_bytes("map.vtu");
    descriptor_text = failing_input_bytes("descriptor.json");
    database_file = failing_input_bytes("shapes.db");
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(descriptor_text.data);
    free(database_file.data);
    free(map_text.data);
    free(report_text.data);
    starg_map_file_free(map_file);
    starg_morph_report_free(morph_report);
    free(solid_text.data);
    starg_mesh_free(simplex);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_signatures), cmocka_unit_test(test_descriptors),
        cmocka_unit_test(test_databases),  cmocka_unit_test(test_maps),
        cmocka_unit_test(test_morphs),     cmocka_unit_test(test_verified_morphs),
        cmocka_unit_test(test_tetgen),     cmocka_unit_test(test_solid_maps),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
