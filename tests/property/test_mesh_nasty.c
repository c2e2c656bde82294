/* SPDX-License-Identifier: Apache-2.0 */
/* Every surface file of the shared data: those with counts in the tables of its README are read
 * with these counts, and those that must be rejected are, with a message that names them. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"

/* One row of a table: the file and its counts, or -1 if missing. */
typedef struct table_row {
    const char *file;
    long vertices, faces;
    bool rejected;
} table_row;

static long count_in(const char *cell) {
    return cell[0] == '-' ? -1 : strtol(cell, NULL, 10);
}

static table_row parse_row(const test_row *from) {
    const char *file = from->file;
    return (table_row){.file = file,
                       .vertices = count_in(from->cells[0]),
                       .faces = count_in(from->cells[1]),
                       .rejected = strncmp(file, "corrupted_", 10) == 0 ||
                                   strncmp(file, "truncated", 9) == 0 ||
                                   strncmp(file, "empty", 5) == 0};
}

/* The program that made the table could not read these; they are valid. */
static void amend(table_row *row) {
    if (strcmp(row->file, "whitespace.off") == 0) { /* a cube after "OFF8 6 12" */
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
    FILE *readme = test_tables(data);
    starg_context *context = test_context(1);
    test_row from = {0};
    size_t read = 0, rejected = 0;
    while (test_next_row(readme, data, &from)) {
        table_row row = parse_row(&from);
        amend(&row);
        if (row.rejected) {
            expect_rejection(context, from.path, &row);
            rejected++;
        } else {
            expect_counts(context, from.path, &row);
            read++;
        }
    }
    fclose(readme);
    test_context_free(context);
    assert_true(read >= 200); /* otherwise the tables are not what this test expects */
    assert_true(rejected >= 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_surface_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
