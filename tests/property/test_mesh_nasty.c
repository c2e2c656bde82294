/* Every surface file of the shared data: those that the tables of its README give counts for are
 * read with these counts, and those that must be rejected are, with a message that names them. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

/* One row of a table: the file and its counts, or -1 where the table has none. */
typedef struct table_row {
    char folder[64], file[128];
    long vertices, faces;
    bool rejected;
} table_row;

static bool has_ending(const char *name, const char *ending) {
    size_t length = strlen(name), tail = strlen(ending);
    return length >= tail && strcmp(name + length - tail, ending) == 0;
}

static bool is_surface(const char *name) {
    static const char *const endings[] = {".off", ".obj", ".ply", ".stl", ".STL"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (has_ending(name, endings[i]))
            return true;
    return false;
}

/* Parses a line of the README; headings set the folder. True for a row about a surface file. */
static bool parse_line(const char *line, table_row *row) {
    char vertices[32], faces[32];
    if (sscanf(line, "## %63s", row->folder) == 1)
        return false;
    if (sscanf(line, "| %127s | %31s | %31s |", row->file, vertices, faces) != 3 ||
        !is_surface(row->file))
        return false;
    row->vertices = vertices[0] == '-' ? -1 : strtol(vertices, NULL, 10);
    row->faces = faces[0] == '-' ? -1 : strtol(faces, NULL, 10);
    row->rejected = strncmp(row->file, "corrupted_", 10) == 0 ||
                    strncmp(row->file, "truncated", 9) == 0 || strncmp(row->file, "empty", 5) == 0;
    return true;
}

/* The table's maker could not read these; they are fine. */
static void amend(table_row *row) {
    if (strcmp(row->file, "whitespace.off") == 0) { /* a cube behind "OFF8 6 12" */
        row->vertices = 8;
        row->faces = 12;
    }
}

static void expect_counts(starg_context *context, const char *path, const table_row *row) {
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_read(context, path, &mesh));
    if ((long)starg_mesh_vertex_count(mesh) != row->vertices ||
        (long)starg_mesh_face_count(mesh) != row->faces)
        fail_msg("%s: %zu vertices and %zu faces, %ld and %ld expected", path,
                 starg_mesh_vertex_count(mesh), starg_mesh_face_count(mesh), row->vertices,
                 row->faces);
    starg_mesh_free(mesh);
}

static void expect_rejection(starg_context *context, const char *path, const table_row *row) {
    starg_mesh *mesh = NULL;
    starg_status status = starg_mesh_read(context, path, &mesh);
    const starg_error *error = starg_context_error(context);
    if (status != STARG_ERROR_FORMAT)
        fail_msg("%s: status %d instead of a FORMAT error", path, (int)status);
    assert_null(mesh);
    assert_int_equal(error->status, status);
    assert_non_null(strstr(error->message, row->file));
}

static void every_surface_file(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    char path[4400], line[8192];
    snprintf(path, sizeof path, "%s/README.md", data);
    FILE *readme = fopen(path, "r");
    assert_non_null(readme);
    starg_context *context = test_context(1);
    table_row row = {0};
    size_t read = 0, rejected = 0;
    while (fgets(line, sizeof line, readme) != NULL) {
        if (!parse_line(line, &row))
            continue;
        amend(&row);
        snprintf(path, sizeof path, "%s/%s/%s", data, row.folder, row.file);
        if (row.rejected) {
            expect_rejection(context, path, &row);
            rejected++;
        } else {
            expect_counts(context, path, &row);
            read++;
        }
    }
    fclose(readme);
    test_context_free(context);
    assert_true(read >= 200); /* otherwise the tables are not what this test thinks they are */
    assert_true(rejected >= 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_surface_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
