/* SPDX-License-Identifier: Apache-2.0 */
/* Maps and morphs of small shapes: ends, rigid motions, bad input, failing memory. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "models.h"

static const starg_morph_method METHODS[] = {STARG_MORPH_STAR, STARG_MORPH_ARAP, STARG_MORPH_LINEAR,
                                             STARG_MORPH_SPHERICAL};

static double diagonal_of(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static double *room_for(const starg_mesh *mesh) {
    double *positions = malloc(3 * starg_mesh_vertex_count(mesh) * sizeof *positions);
    assert_non_null(positions);
    return positions;
}

static double farthest(const double *a, const double *b, size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

/* The ends are exact, and the motion is continuous there. */
static void test_ends(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "horse", 0, 800), *b = test_pose(context, "horse", 1, 800);
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *frame = room_for(a);
    for (size_t i = 0; i < sizeof METHODS / sizeof *METHODS; i++) {
        starg_morph *morph = test_morph(context, a, starg_mesh_vertices(b), METHODS[i]);
        test_ok(context, starg_morph_frame(morph, 0, frame));
        assert_memory_equal(frame, starg_mesh_vertices(a), size * sizeof *frame);
        test_ok(context, starg_morph_frame(morph, 1, frame));
        assert_memory_equal(frame, starg_mesh_vertices(b), size * sizeof *frame);
        test_ok(context, starg_morph_frame(morph, 1e-12, frame));
        assert_true(farthest(frame, starg_mesh_vertices(a), size) < 1e-9 * diagonal_of(a));
        test_ok(context, starg_morph_frame(morph, 1 - 1e-12, frame));
        assert_true(farthest(frame, starg_mesh_vertices(b), size) < 1e-9 * diagonal_of(a));
        starg_morph_free(morph);
    }
    free(frame);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* Rotates about a skew axis, then translates. */
static void turn_and_move(const starg_mesh *mesh, double angle, double *out) {
    const double axis[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3};
    for (size_t v = 0; v < starg_mesh_vertex_count(mesh); v++) {
        const double *p = starg_mesh_vertices(mesh) + 3 * v;
        double along = axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
        for (size_t k = 0; k < 3; k++) {
            size_t i = (k + 1) % 3, j = (k + 2) % 3;
            double side = axis[i] * p[j] - axis[j] * p[i];
            out[3 * v + k] = along * axis[k] * (1 - cos(angle)) + p[k] * cos(angle) +
                             side * sin(angle) + (double)k - 0.7;
        }
    }
}

static double longest_change(const starg_mesh *mesh, const double *frame) {
    const double *rest = starg_mesh_vertices(mesh);
    double most = 0;
    for (size_t i = 0; i < 3 * starg_mesh_face_count(mesh); i++) {
        const uint32_t *f = starg_mesh_faces(mesh) + i / 3 * 3;
        size_t a = 3 * (size_t)f[i % 3], b = 3 * (size_t)f[(i + 1) % 3];
        double before =
            hypot(hypot(rest[a] - rest[b], rest[a + 1] - rest[b + 1]), rest[a + 2] - rest[b + 2]);
        double now = hypot(hypot(frame[a] - frame[b], frame[a + 1] - frame[b + 1]),
                           frame[a + 2] - frame[b + 2]);
        most = fmax(most, fabs(now - before));
    }
    return most;
}

/* A rigidly moved copy is interpolated rigidly: no edge changes its length. */
static void test_rigid(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "dog", 0, 800);
    double *images = room_for(a), *frame = room_for(a);
    for (double angle = 0.2; angle < 3.1; angle += 0.7) {
        turn_and_move(a, angle, images);
        for (int i = 0; i < 2; i++) {
            starg_morph *morph = test_morph(context, a, images, METHODS[i]);
            for (double t = 0.1; t < 1; t += 0.2) {
                test_ok(context, starg_morph_frame(morph, t, frame));
                assert_true(longest_change(a, frame) < 1e-8 * diagonal_of(a));
            }
            starg_morph_free(morph);
        }
    }
    free(images);
    free(frame);
    starg_mesh_free(a);
    test_context_free(context);
}

/* A prism whose upper end is rotated by more than half a turn against the lower one: adjacent faces
 * must rotate the same way, so that no edge gets much shorter than at both ends. */
static void test_twist(void **state) {
    (void)state;
    enum { RINGS = 41, SIDES = 12, VERTICES = RINGS * SIDES, FACES = 2 * (RINGS - 1) * SIDES };
    static double rest[3 * VERTICES], images[3 * VERTICES], frame[3 * VERTICES];
    static uint32_t faces[3 * FACES];
    const double pi = acos(-1), turn = 1.7 * pi;
    size_t next = 0;
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t j = 0; j < SIDES; j++) {
            double angle = 2 * pi * j / SIDES, more = turn * i / (RINGS - 1);
            uint32_t v = i * SIDES + j;
            memcpy(rest + 3 * v, (double[3]){cos(angle), sin(angle), 0.5 * i}, 3 * sizeof *rest);
            memcpy(images + 3 * v, (double[3]){cos(angle + more), sin(angle + more), 0.5 * i},
                   3 * sizeof *images);
            if (i + 1 == RINGS)
                continue;
            uint32_t w = i * SIDES + (j + 1) % SIDES;
            const uint32_t two[6] = {v, w, w + SIDES, v, w + SIDES, v + SIDES};
            memcpy(faces + next, two, sizeof two);
            next += 6;
        }
    starg_context *context = test_context(1);
    starg_mesh *a;
    test_ok(context, starg_mesh_create(context, rest, VERTICES, faces, FACES, &a));
    starg_morph *morph = test_morph(context, a, images, STARG_MORPH_ARAP);
    test_ok(context, starg_morph_frame(morph, 0.5, frame));
    for (size_t v = 0; v < VERTICES; v++) /* a tube of constant width */
        assert_true(fabs(hypot(frame[3 * v], frame[3 * v + 1]) - 1) < 0.1);
    starg_morph_free(morph);
    starg_mesh_free(a);
    test_context_free(context);
}

/* Swaps some vertices with a neighbour, which folds the surface. */
static void fold(const starg_mesh *mesh, double *images) {
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f += 150)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t *corner = starg_mesh_faces(mesh) + 3 * f;
            double *p = images + 3 * (size_t)corner[0] + k, *q = images + 3 * (size_t)corner[1] + k;
            double swap = *p;
            *p = *q;
            *q = swap;
        }
}

/* The folded end is exact, but nothing intersects on the way, whereas with the rigid method each
 * face moves on its own. */
static void test_folds(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "dog", 0, 800), *b = test_pose(context, "dog", 1, 800);
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *images = room_for(a), *frame = room_for(a);
    size_t pairs[2] = {0, 0};
    memcpy(images, starg_mesh_vertices(b), size * sizeof *images);
    fold(a, images);
    for (int i = 0; i < 2; i++) {
        starg_morph *morph = test_morph(context, a, images, METHODS[i]);
        starg_frame_measures measures;
        for (double t = 0.25; t < 1; t += 0.25) {
            test_ok(context, starg_morph_frame(morph, t, frame));
            test_ok(context, starg_morph_measure(morph, t, frame, &measures));
            pairs[i] += measures.intersections;
        }
        test_ok(context, starg_morph_frame(morph, 1 - 1e-12, frame));
        assert_true(farthest(frame, images, size) < 1e-9 * diagonal_of(a));
        test_ok(context, starg_morph_frame(morph, 1, frame));
        assert_memory_equal(frame, images, size * sizeof *frame);
        test_ok(context, starg_morph_measure(morph, 1, frame, &measures));
        assert_true(measures.intersections > 10);
        starg_morph_free(morph);
    }
    assert_int_equal(pairs[0], 0);
    assert_true(pairs[1] > 10);
    free(images);
    free(frame);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

static void expect(starg_context *context, starg_status status, starg_status wanted,
                   const char *part) {
    assert_int_equal(status, wanted);
    if (strstr(starg_context_error(context)->message, part) == NULL)
        fail_msg("'%s' is not in '%s'", part, starg_context_error(context)->message);
}

static void test_bad_maps(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *ball = test_sample_mesh(context, "sphere", 600);
    starg_mesh *ring = test_sample_mesh(context, "torus", 600);
    starg_mesh *cat = test_sample_mesh(context, "cat", 600);
    starg_map *map;
    expect(context, starg_map_create(context, ball, ring, NULL, &map), STARG_ERROR_MESH, "genus 1");
    assert_null(map);
    const uint32_t far[] = {0, 1u << 30};
    starg_map_options options = {.landmarks = far, .landmark_count = 1};
    expect(context, starg_map_create(context, ball, cat, &options, &map), STARG_ERROR_MESH,
           "landmark 0");
    const uint32_t twice[] = {0, 1, 5, 9, 0, 2};
    options = (starg_map_options){.landmarks = twice, .landmark_count = 3};
    expect(context, starg_map_create(context, ball, cat, &options, &map), STARG_ERROR_MESH,
           "landmarks 0 and 2");
    const uint32_t other[] = {0, 1};
    options = (starg_map_options){.landmarks = other, .landmark_count = 1};
    expect(context, starg_map_create(context, cat, cat, &options, &map), STARG_ERROR_MESH,
           "the same faces");
    starg_mesh_free(ball);
    starg_mesh_free(ring);
    starg_mesh_free(cat);
    test_context_free(context);
}

static void test_parts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape two = shape_cube(1), cube = shape_cube(1);
    shape_append(&two, &cube, (const double[3]){5, 0, 0}, 0);
    starg_mesh *pair = test_mesh_of(context, &two),
               *ball = test_sample_mesh(context, "sphere", 600);
    starg_map *map;
    expect(context, starg_map_create(context, pair, ball, NULL, &map), STARG_ERROR_MESH,
           "2 components");
    starg_mesh_free(pair);
    starg_mesh_free(ball);
    shape_free(&two);
    shape_free(&cube);
    test_context_free(context);
}

/* Writes text to a temporary file; the caller removes it. */
static void write_text(char name[64], const char *text) {
    snprintf(name, 64, "/tmp/starguard-morph-XXXXXX");
    int file = mkstemp(name);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
}

static void test_map_files(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } bad[] = {
        {"{", "line"},
        {"{\"format\":\"starguard-guards\",\"version\":1,\"points\":[]}", "format"},
        {"{\"format\":\"starguard-map\",\"version\":2,\"points\":[]}", "version"},
        {"{\"format\":\"starguard-map\",\"version\":1,\"points\":[]}", "another pair"},
        {"{\"format\":\"starguard-map\",\"version\":1,\"points\":[[0,1,0],0,0,0]}",
         "entry 0 of \"points\" must be an array of 4"},
        {"{\"format\":\"starguard-map\",\"version\":1,\"points\":[[0,1,0,0],[9,1,0,0],[0,1,0,0],"
         "[0,1,0,0]]}",
         "vertex 1 in \"points\" names a face"},
        {"{\"format\":\"starguard-map\",\"version\":1,\"points\":[[0,1,0,0],[0,2,-1,0],0,0]}",
         "\"u\" in entry 1 of \"points\" must be 0 to 1"},
        {"{\"format\":\"starguard-map\",\"version\":1,\"points\":[[0,0.5,0,0],[0,1,0,0],[0,1,0,0],"
         "[0,1,0,0]]}",
         "sum"}};
    starg_context *context = test_context(1);
    shape corner = shape_tetrahedron();
    starg_mesh *mesh = test_mesh_of(context, &corner);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char name[64];
        starg_map *map;
        write_text(name, bad[i].text);
        starg_status status = starg_map_read(context, name, mesh, mesh, &map);
        unlink(name);
        expect(context, status, STARG_ERROR_FORMAT, bad[i].part);
        assert_null(map);
    }
    starg_mesh_free(mesh);
    shape_free(&corner);
    test_context_free(context);
}

static void test_landmark_files(void **state) {
    (void)state;
    static const char *const bad[] = {"1",    "1 2 3", "1 x",           "1 4",
                                      "-1 2", "1.5 2", "1 2 3 4 5 6 7", "nan 1"};
    starg_context *context = test_context(1);
    shape corner = shape_tetrahedron();
    starg_mesh *mesh = test_mesh_of(context, &corner);
    char name[64];
    uint32_t *pairs;
    size_t count;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_text(name, bad[i]);
        starg_status status = starg_landmarks_read(context, name, mesh, mesh, &pairs, &count);
        unlink(name);
        expect(context, status, STARG_ERROR_FORMAT, "line 1");
        assert_null(pairs);
    }
    write_text(name, "# a comment\n1 2\n\n 0, 3 # more\r\n");
    test_ok(context, starg_landmarks_read(context, name, mesh, mesh, &pairs, &count));
    unlink(name);
    assert_int_equal(count, 2);
    assert_memory_equal(pairs, ((const uint32_t[]){1, 2, 0, 3}), 4 * sizeof *pairs);
    starg_landmarks_free(context, pairs);
    starg_mesh_free(mesh);
    shape_free(&corner);
    test_context_free(context);
}

/* Files read back bit for bit. */
static void test_map_round(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "cat", 600),
               *b = test_sample_mesh(context, "bird", 700);
    starg_map *map, *again;
    char name[64];
    test_ok(context, starg_map_create(context, a, b, NULL, &map));
    write_text(name, "");
    test_ok(context, starg_map_write(context, map, name));
    test_ok(context, starg_map_read(context, name, a, b, &again));
    unlink(name);
    assert_memory_equal(map->faces, again->faces, map->vertex_count * sizeof *map->faces);
    assert_memory_equal(map->coordinates, again->coordinates,
                        3 * map->vertex_count * sizeof *map->coordinates);
    starg_map_free(context, map);
    starg_map_free(context, again);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* Every allocation fails once, in steps: an error, and no leaks. */
static void test_memory(void **state) {
    (void)state;
    starg_context *plenty = test_context(1);
    starg_mesh *a = test_pose(plenty, "cat", 0, 800), *b = test_pose(plenty, "cat", 1, 800);
    double *images = room_for(a);
    memcpy(images, starg_mesh_vertices(b), 3 * starg_mesh_vertex_count(b) * sizeof *images);
    fold(a, images);
    starg_mesh *other = test_sample_mesh(plenty, "sphere", 500);
    bool done = false;
    for (size_t blocks = 0; !done; blocks += 1 + blocks / 6) {
        size_t left = blocks + 2;
        starg_context *context = test_scarce_context(1, &left);
        starg_map *map = NULL;
        starg_morph *morph = NULL;
        starg_status status = starg_map_create(context, a, other, NULL, &map);
        if (status == STARG_OK)
            status = starg_morph_create(context, a, images, NULL, &morph);
        if (status != STARG_OK)
            assert_int_equal(status, STARG_ERROR_MEMORY);
        done = status == STARG_OK;
        starg_map_free(context, map);
        starg_morph_free(morph);
        left = SIZE_MAX;
        test_context_free(context);
    }
    starg_mesh_free(a);
    starg_mesh_free(b);
    starg_mesh_free(other);
    free(images);
    test_context_free(plenty);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ends),      cmocka_unit_test(test_rigid),
        cmocka_unit_test(test_twist),     cmocka_unit_test(test_folds),
        cmocka_unit_test(test_bad_maps),  cmocka_unit_test(test_parts),
        cmocka_unit_test(test_map_files), cmocka_unit_test(test_landmark_files),
        cmocka_unit_test(test_map_round), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
