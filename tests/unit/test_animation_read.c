/* SPDX-License-Identifier: Apache-2.0 */
/* Reading animations: the written frames, and bytes that are not an animation. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/animation.h"

enum { FRAMES = 4 };

static char path[64];

static int choose_path(void **state) {
    (void)state;
    snprintf(path, sizeof path, "/tmp/test_animation_%ld.glb", (long)getpid());
    return 0;
}

static int remove_path(void **state) {
    (void)state;
    unlink(path);
    return 0;
}

/* Writes a few shapes of a mesh; `positions` receives them. */
static void write_frames(starg_context *context, const starg_mesh *mesh, double **positions) {
    size_t count = 3 * starg_mesh_vertex_count(mesh);
    const double *frames[FRAMES];
    *positions = malloc(FRAMES * count * sizeof **positions);
    assert_non_null(*positions);
    for (size_t f = 0; f < FRAMES; f++) {
        for (size_t i = 0; i < count; i++)
            (*positions)[f * count + i] =
                starg_mesh_vertices(mesh)[i] * (1 + (double)(f * (1 + i % 3)));
        frames[f] = *positions + f * count;
    }
    test_ok(context, starg_animation_write(context, mesh, frames, FRAMES, 2, path));
}

static uint8_t *read_bytes(size_t *size) {
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = malloc(1 << 20);
    assert_true(file != NULL && bytes != NULL);
    *size = fread(bytes, 1, 1 << 20, file);
    fclose(file);
    return bytes;
}

static void round_trip(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "bird", 500), **frames = NULL;
    double *positions;
    size_t count = 0, numbers = 3 * starg_mesh_vertex_count(mesh);
    write_frames(context, mesh, &positions);
    test_ok(context, starg_animation_read(context, path, &frames, &count));
    assert_int_equal(count, FRAMES);
    for (size_t f = 0; f < FRAMES; f++) {
        assert_int_equal(3 * starg_mesh_vertex_count(frames[f]), numbers);
        assert_int_equal(starg_mesh_face_count(frames[f]), starg_mesh_face_count(mesh));
        assert_memory_equal(starg_mesh_faces(frames[f]), starg_mesh_faces(mesh),
                            3 * starg_mesh_face_count(mesh) * sizeof(uint32_t));
        for (size_t i = 0; i < numbers; i++)
            assert_true(fabs(starg_mesh_vertices(frames[f])[i] - positions[f * numbers + i]) <
                        2e-6 * FRAMES);
    }
    starg_animation_free(context, frames, count);
    free(positions);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Truncated or changed files are read or rejected; whatever is read is a mesh. */
static void damaged_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_tetrahedron();
    starg_mesh *mesh = test_mesh_of(context, &s), **frames = NULL;
    double *positions;
    size_t size, count, good = 0;
    write_frames(context, mesh, &positions);
    uint8_t *bytes = read_bytes(&size), *changed = malloc(size);
    assert_non_null(changed);
    for (size_t i = 0; i < size + 3000; i++) {
        starg_rng rng = starg_rng_make(5, 1, i);
        memcpy(changed, bytes, size);
        if (i >= size)
            for (int k = 0; k < 2; k++)
                changed[starg_rng_below(&rng, size)] ^= (uint8_t)(1 + starg_rng_below(&rng, 255));
        starg_status status = starg_animation_read_memory(context, changed, i < size ? i : size,
                                                          "damaged", &frames, &count);
        assert_true(status == STARG_OK || status == STARG_ERROR_FORMAT ||
                    status == STARG_ERROR_ARGUMENT || status == STARG_ERROR_RANGE);
        assert_true(status == STARG_OK || frames == NULL);
        good += status == STARG_OK;
        if (status == STARG_OK)
            starg_animation_free(context, frames, count);
    }
    assert_true(good > 0 &&
                good < 3000); /* some changes break the file, some only change coordinates */
    free(changed);
    free(bytes);
    free(positions);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

static void scarce_memory(void **state) {
    (void)state;
    starg_context *maker = test_context(1);
    shape s = shape_tetrahedron();
    starg_mesh *mesh = test_mesh_of(maker, &s);
    double *positions;
    write_frames(maker, mesh, &positions);
    starg_status status = STARG_ERROR_MEMORY;
    for (size_t limit = 1; status != STARG_OK; limit++) {
        size_t left = limit, count = 0;
        starg_mesh **frames = NULL;
        starg_context *context = test_scarce_context(1, &left);
        status = starg_animation_read(context, path, &frames, &count);
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        if (status == STARG_OK)
            starg_animation_free(context, frames, count);
        test_context_free(context);
        assert_true(limit < 100);
    }
    free(positions);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(maker);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trip),
        cmocka_unit_test(damaged_files),
        cmocka_unit_test(scarce_memory),
    };
    return cmocka_run_group_tests(tests, choose_path, remove_path);
}
