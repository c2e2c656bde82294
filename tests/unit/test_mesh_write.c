/* SPDX-License-Identifier: Apache-2.0 */
/* Writers: files read back bit for bit, and appear completely or not at all. */
#include <dirent.h>
#include <fcntl.h>
#include <locale.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/rng.h"
#include "support.h"

static char folder[64];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/test_mesh_write_XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder); /* fails if a test has left anything */
}

static const char *path_of(const char *name) {
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static size_t files_in_folder(void) {
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    size_t count = 0;
    while (readdir(listing) != NULL)
        count++;
    closedir(listing);
    return count - 2; /* . and .. */
}

/* Any finite double below 1e100, including subnormals and -0. */
static double random_coordinate(starg_rng *rng) {
    for (;;) {
        uint64_t bits = starg_rng_next(rng);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (bits % 16 == 0)
            return bits % 32 == 0 ? -0.0 : 0x1p-1074 * (double)(bits % 1000);
        if (value > -1e100 && value < 1e100)
            return value;
    }
}

static starg_mesh *random_mesh(starg_context *context, starg_rng *rng, bool single) {
    enum { MOST = 300 };
    static double vertices[3 * MOST];
    static uint32_t faces[3 * MOST];
    size_t vertex_count = 1 + (size_t)starg_rng_below(rng, MOST);
    size_t face_count = 1 + (size_t)starg_rng_below(rng, MOST);
    for (size_t i = 0; i < 3 * vertex_count; i++)
        vertices[i] = single ? (double)(float)starg_rng_unit(rng) : random_coordinate(rng);
    for (size_t i = 0; i < 3 * face_count; i++)
        faces[i] = (uint32_t)starg_rng_below(rng, vertex_count);
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, vertices, vertex_count, faces, face_count, &mesh));
    return mesh;
}

static starg_mesh *write_and_read(starg_context *context, const starg_mesh *mesh, const char *name,
                                  const starg_mesh_write_options *options) {
    starg_mesh *back = NULL;
    test_ok(context, starg_mesh_write(context, mesh, path_of(name), options));
    test_ok(context, starg_mesh_read(context, path_of(name), &back));
    assert_int_equal(files_in_folder(), 1);
    assert_int_equal(unlink(path_of(name)), 0);
    return back;
}

static void expect_same(const starg_mesh *a, const starg_mesh *b) {
    assert_int_equal(starg_mesh_vertex_count(a), starg_mesh_vertex_count(b));
    assert_int_equal(starg_mesh_face_count(a), starg_mesh_face_count(b));
    assert_memory_equal(starg_mesh_vertices(a), starg_mesh_vertices(b),
                        3 * starg_mesh_vertex_count(a) * sizeof(double));
    assert_memory_equal(starg_mesh_faces(a), starg_mesh_faces(b),
                        3 * starg_mesh_face_count(a) * sizeof(uint32_t));
}

static void indexed_formats_keep_every_bit(void **state) {
    (void)state;
    static const struct {
        const char *name;
        starg_mesh_format format;
    } cases[] = {{"a.off", STARG_MESH_AUTO},   {"a.OBJ", STARG_MESH_AUTO},
                 {"a.ply", STARG_MESH_AUTO},   {"a.ply", STARG_MESH_PLY_ASCII},
                 {"a", STARG_MESH_PLY_BINARY}, {"a.stl", STARG_MESH_OFF}};
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(1, 0, 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int round = 0; round < 40; round++) {
            starg_mesh *mesh = random_mesh(context, &rng, false);
            uint8_t colors[900];
            for (size_t k = 0; k < sizeof colors; k++)
                colors[k] = (uint8_t)starg_rng_next(&rng);
            starg_mesh_write_options options;
            starg_mesh_write_options_default(&options);
            options.format = cases[i].format;
            options.face_colors = round % 2 ? colors : NULL;
            starg_mesh *back = write_and_read(context, mesh, cases[i].name, &options);
            expect_same(mesh, back);
            starg_mesh_free(mesh);
            starg_mesh_free(back);
        }
    }
    test_context_free(context);
}

/* STL has no indices: positions are equal corner by corner, with -0 equal to 0. */
static void stl_keeps_every_corner(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(2, 0, 0);
    for (int round = 0; round < 80; round++) {
        bool binary = round % 2;
        starg_mesh *mesh = random_mesh(context, &rng, binary);
        const starg_mesh_write_options options = {.format = binary ? STARG_MESH_AUTO
                                                                   : STARG_MESH_STL_ASCII};
        starg_mesh *back = write_and_read(context, mesh, "a.stl", &options);
        assert_int_equal(starg_mesh_face_count(back), starg_mesh_face_count(mesh));
        for (size_t i = 0; i < 3 * starg_mesh_face_count(mesh); i++) {
            const double *p = starg_mesh_vertices(mesh) + 3 * (size_t)starg_mesh_faces(mesh)[i];
            const double *q = starg_mesh_vertices(back) + 3 * (size_t)starg_mesh_faces(back)[i];
            assert_true(p[0] == q[0] && p[1] == q[1] && p[2] == q[2]);
        }
        starg_mesh_free(mesh);
        starg_mesh_free(back);
    }
    test_context_free(context);
}

static starg_mesh *triangle(starg_context *context, double scale) {
    const double vertices[] = {0, 0, 0, scale, 0, 0, 0, scale / 4, 0};
    const uint32_t faces[] = {0, 1, 2};
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, vertices, 3, faces, 1, &mesh));
    return mesh;
}

static void expect_file(const char *name, const char *text, size_t size) {
    char bytes[1024];
    FILE *file = fopen(path_of(name), "rb");
    assert_non_null(file);
    assert_int_equal(fread(bytes, 1, sizeof bytes, file), size);
    fclose(file);
    assert_memory_equal(bytes, text, size);
}

static void expect_text(const starg_mesh *mesh, const starg_mesh_write_options *options,
                        const char *text) {
    starg_context *context = test_context(1);
    test_ok(context, starg_mesh_write(context, mesh, path_of("a"), options));
    expect_file("a", text, strlen(text));
    assert_int_equal(unlink(path_of("a")), 0);
    test_context_free(context);
}

/* The exact bytes, under a locale with a decimal comma if there is one. */
static void the_text_is_as_documented(void **state) {
    (void)state;
    if (setlocale(LC_ALL, "de_DE.UTF-8") == NULL)
        print_message("there is no locale with a decimal comma here\n");
    starg_context *context = test_context(1);
    starg_mesh *mesh = triangle(context, 1);
    static const uint8_t red[] = {255, 0, 7};
    expect_text(mesh, &(starg_mesh_write_options){.format = STARG_MESH_OFF, .face_colors = NULL},
                "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.25 0\n3 0 1 2\n");
    expect_text(mesh, &(starg_mesh_write_options){.format = STARG_MESH_OFF, .face_colors = red},
                "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.25 0\n3 0 1 2 255 0 7\n");
    expect_text(mesh, &(starg_mesh_write_options){.format = STARG_MESH_OBJ, .face_colors = red},
                "v 0 0 0\nv 1 0 0\nv 0 0.25 0\nf 1 2 3\n");
    expect_text(mesh,
                &(starg_mesh_write_options){.format = STARG_MESH_STL_ASCII, .face_colors = NULL},
                "solid starguard\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                "vertex 0 0.25 0\nendloop\nendfacet\nendsolid starguard\n");
    expect_text(mesh,
                &(starg_mesh_write_options){.format = STARG_MESH_PLY_ASCII, .face_colors = red},
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
                "property double z\nelement face 1\nproperty list uchar int vertex_indices\n"
                "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                "0 0 0\n1 0 0\n0 0.25 0\n3 0 1 2 255 0 7\n");
    starg_mesh *back = write_and_read(context, mesh, "a.off", NULL); /* also reads points */
    expect_same(mesh, back);
    starg_mesh_free(back);
    starg_mesh_free(mesh);
    test_context_free(context);
    setlocale(LC_ALL, "C");
}

static void expect_failure(const char *path, starg_mesh_format format, double scale,
                           starg_status expected, const char *says) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = triangle(context, scale);
    const starg_mesh_write_options options = {.format = format};
    assert_int_equal(starg_mesh_write(context, mesh, path, &options), expected);
    assert_non_null(strstr(starg_context_error(context)->message, says));
    assert_non_null(strstr(starg_context_error(context)->message, path));
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void failures(void **state) {
    (void)state;
    expect_failure(path_of("a.xyz"), STARG_MESH_AUTO, 1, STARG_ERROR_ARGUMENT, ".off");
    expect_failure("-", STARG_MESH_AUTO, 1, STARG_ERROR_ARGUMENT, "format");
    expect_failure(path_of("a.off"), (starg_mesh_format)8, 1, STARG_ERROR_ARGUMENT, "format");
    expect_failure(path_of("a.stl"), STARG_MESH_AUTO, 1e39, STARG_ERROR_RANGE, "vertex 1");
    expect_failure(path_of("missing/a.off"), STARG_MESH_AUTO, 1, STARG_ERROR_WRITE, "No such file");
    expect_failure("/proc/a.off", STARG_MESH_AUTO, 1, STARG_ERROR_WRITE, "cannot write");
    expect_failure("/dev/full", STARG_MESH_OFF, 1, STARG_ERROR_WRITE, "not a regular file");
    expect_failure(folder, STARG_MESH_OFF, 1, STARG_ERROR_WRITE, "not a regular file");
    assert_int_equal(files_in_folder(), 0);
}

/* An old file is replaced completely, or stays unchanged. */
static void old_files_are_replaced_at_once(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *small = triangle(context, 1), *large = triangle(context, 1e50);
    test_ok(context, starg_mesh_write(context, large, path_of("a.off"), NULL));
    test_ok(context, starg_mesh_write(context, small, path_of("a.off"), NULL));
    static const char text[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.25 0\n3 0 1 2\n";
    expect_file("a.off", text, sizeof text - 1);
    starg_context_cancel(context);
    assert_int_equal(starg_mesh_write(context, large, path_of("a.off"), NULL),
                     STARG_ERROR_CANCELLED);
    expect_file("a.off", text, sizeof text - 1);
    assert_int_equal(files_in_folder(), 1);
    assert_int_equal(unlink(path_of("a.off")), 0);
    starg_mesh_free(small);
    starg_mesh_free(large);
    test_context_free(context);
}

/* Runs `step` in a child with `path` as standard stream `which`; returns its exit status. */
static int with_stream(int which, const char *path, int flags, int (*step)(void)) {
    fflush(stdout);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int file = open(path, flags, 0666);
        _exit(file < 0 || dup2(file, which) < 0 ? 99 : step());
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int write_to_output(void) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = triangle(context, 1);
    const starg_mesh_write_options options = {.format = STARG_MESH_OFF};
    int status = (int)starg_mesh_write(context, mesh, "-", &options);
    starg_mesh_free(mesh);
    starg_context_free(context);
    return status;
}

static int read_from_input(void) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL;
    int status = (int)starg_mesh_read(context, "-", &mesh);
    bool good = status == STARG_OK && starg_mesh_face_count(mesh) == 1;
    starg_mesh_free(mesh);
    starg_context_free(context);
    return good ? 0 : 1;
}

static void standard_streams(void **state) {
    (void)state;
    int create = O_WRONLY | O_CREAT | O_TRUNC;
    assert_int_equal(with_stream(STDOUT_FILENO, path_of("out"), create, write_to_output), 0);
    assert_int_equal(with_stream(STDIN_FILENO, path_of("out"), O_RDONLY, read_from_input), 0);
    assert_int_equal(unlink(path_of("out")), 0);
    assert_int_equal(with_stream(STDOUT_FILENO, "/dev/full", O_WRONLY, write_to_output),
                     STARG_ERROR_WRITE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(indexed_formats_keep_every_bit), cmocka_unit_test(stl_keeps_every_corner),
        cmocka_unit_test(the_text_is_as_documented),      cmocka_unit_test(failures),
        cmocka_unit_test(old_files_are_replaced_at_once), cmocka_unit_test(standard_streams),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
