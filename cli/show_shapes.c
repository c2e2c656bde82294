/* SPDX-License-Identifier: Apache-2.0 */
/* Distance tables, from a database or written by 'starguard db matrix -o', with small pictures of
 * the models that can be found. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "show.h"
#include "starguard/picture.h"

enum { PICTURE_WIDTH = 108, PICTURE_HEIGHT = 80, MOST_SHAPES = 2000 };

static starg_status make_room(cli_session *session, size_t count, cli_show *show) {
    show->shapes = calloc(count + 1, sizeof *show->shapes);
    show->pictures = calloc(count + 1, sizeof *show->pictures);
    show->shape_count = count;
    return show->shapes != NULL && show->pictures != NULL ? STARG_OK : cli_fail_memory(session);
}

/* ---- pictures ---- */

/* If a model cannot be read, its picture is missing; this is not an error. */
static starg_status draw_shape(cli_session *session, const char *file, size_t index,
                               cli_show *show) {
    starg_status status = STARG_OK;
    starg_mesh *mesh = NULL;
    starg_picture_options options;
    starg_page_shape *shape = &show->shapes[index];
    struct stat info;
    if (stat(file, &info) != 0 || !S_ISREG(info.st_mode))
        return STARG_OK;
    if ((status = cli_name_input(session, file)) != STARG_OK)
        return status;
    starg_picture_options_default(&options);
    options.width = PICTURE_WIDTH;
    options.height = PICTURE_HEIGHT;
    options.opacity = 1;
    status = starg_mesh_read(session->context, file, &mesh);
    if (status == STARG_OK)
        status = starg_picture_encode(session->context, mesh, &options, &show->pictures[index],
                                      &shape->png_size);
    shape->png = show->pictures[index];
    starg_mesh_free(mesh);
    return status == STARG_ERROR_MEMORY || status == STARG_ERROR_CANCELLED ? status : STARG_OK;
}

static void tell_missing(cli_session *session, const cli_show *show) {
    size_t missing = 0;
    for (size_t i = 0; i < show->shape_count; i++)
        missing += show->shapes[i].png == NULL;
    if (missing > 0)
        cli_log(session, STARG_LOG_NOTICE,
                "%zu of %zu models not found at their stored paths: shown without picture", missing,
                show->shape_count);
}

/* ---- databases ---- */

starg_status cli_show_database(cli_session *session, const char *file, int distance,
                               cli_show *show) {
    TRY(cli_table_make(session, file, distance, &show->table));
    const starg_database_models *models = show->table.models;
    if (models->count > MOST_SHAPES)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "'%.200s' has %zu models; a page shows at most %d", file, models->count,
                        MOST_SHAPES);
    TRY(make_room(session, models->count, show));
    for (size_t i = 0; i < models->count; i++) {
        show->shapes[i].name = models->items[i].name;
        TRY(draw_shape(session, models->items[i].path, i, show));
    }
    tell_missing(session, show);
    return cli_matrix_command(session, file, distance, "distances.csv", &show->table_command);
}

/* ---- tables of text ---- */

/* A table while it is read: its first line names the models, each other line has a model and its
 * distances. */
typedef struct reading {
    cli_session *session;
    const char *file;
    cli_show *show;
    size_t line;
} reading;

static starg_status reject(const reading *r, const char *what) {
    return cli_fail(r->session, STARG_ERROR_FORMAT, "'%.200s', line %zu: %s", r->file, r->line,
                    what);
}

static starg_status append_name(reading *r, const char *name) {
    cli_show *show = r->show;
    if (show->shape_count == MOST_SHAPES)
        return reject(r, "too many models for a page");
    char **names = realloc(show->names, (show->shape_count + 1) * sizeof *names);
    if (names == NULL)
        return cli_fail_memory(r->session);
    show->names = names;
    names[show->shape_count] = strdup(name);
    if (names[show->shape_count] == NULL)
        return cli_fail_memory(r->session);
    show->shape_count++;
    return STARG_OK;
}

static starg_status read_names(reading *r, char *line) {
    starg_status status = STARG_OK;
    char *at = line, *field = cli_csv_field(&at);
    if (field == NULL || strcmp(field, "model") != 0)
        return reject(r, "a distance table must begin with 'model' and the models' names, as "
                         "'starguard db matrix -o' writes it");
    while ((field = cli_csv_field(&at)) != NULL && status == STARG_OK)
        status = append_name(r, field);
    if (status == STARG_OK && r->show->shape_count == 0)
        return reject(r, "the table has no models");
    return status;
}

static starg_status read_row(reading *r, char *line, size_t row) {
    const cli_show *show = r->show;
    size_t count = show->shape_count;
    char *at = line, *field = cli_csv_field(&at);
    if (row >= count || field == NULL || strcmp(field, show->names[row]) != 0)
        return reject(r, "row names differ from the names in the first line");
    for (size_t k = 0; k < count; k++) {
        field = cli_csv_field(&at);
        double *distance = &show->distances[row * count + k];
        if (field == NULL || !cli_number_real(field, distance) || *distance < 0)
            return reject(r, "each row needs one distance (0 or more) per model");
    }
    return cli_csv_field(&at) == NULL ? STARG_OK : reject(r, "more numbers than models");
}

static starg_status read_lines(reading *r, FILE *stream) {
    starg_status status = STARG_OK;
    char *line = NULL;
    size_t capacity = 0, rows = 0;
    while (status == STARG_OK && getline(&line, &capacity, stream) >= 0) {
        r->line++;
        line[strcspn(line, "\r\n")] = '\0';
        if (r->line > 1) {
            status = read_row(r, line, rows++);
            continue;
        }
        status = read_names(r, line);
        size_t count = r->show->shape_count;
        if (status == STARG_OK)
            r->show->distances = malloc(count * count * sizeof *r->show->distances);
        if (status == STARG_OK && r->show->distances == NULL)
            status = cli_fail_memory(r->session);
    }
    free(line);
    if (status == STARG_OK && (rows == 0 || rows != r->show->shape_count))
        status = reject(r, "one row per model must follow");
    return status;
}

/* Searches for models beside the table. */
static starg_status draw_shapes(cli_session *session, const char *file, cli_show *show) {
    starg_status status = STARG_OK;
    const char *slash = strrchr(file, '/');
    size_t folder = slash != NULL ? (size_t)(slash - file) + 1 : 0;
    for (size_t i = 0; i < show->shape_count && status == STARG_OK; i++) {
        size_t size = folder + strlen(show->names[i]) + 1;
        char *path = malloc(size);
        if (path == NULL)
            return cli_fail_memory(session);
        snprintf(path, size, "%.*s%s", (int)folder, file, show->names[i]);
        show->shapes[i].name = show->names[i];
        status = draw_shape(session, path, i, show);
        free(path);
    }
    return status;
}

starg_status cli_show_table(cli_session *session, const char *file, cli_show *show) {
    starg_status status = STARG_OK;
    reading r = {.session = session, .file = file, .show = show};
    FILE *stream = fopen(file, "rb");
    if (stream == NULL)
        return cli_fail(session, STARG_ERROR_READ, "cannot open '%.300s'", file);
    CLI_TRY(read_lines(&r, stream));
    CLI_TRY(make_room(session, show->shape_count, show));
    CLI_TRY(draw_shapes(session, file, show));
    tell_missing(session, show);
done:
    fclose(stream);
    return status;
}

void cli_show_free_shapes(cli_session *session, cli_show *show) {
    for (size_t i = 0; i < show->shape_count; i++) {
        if (show->names != NULL)
            free(show->names[i]);
        if (show->pictures != NULL)
            starg_picture_bytes_free(session->context, show->pictures[i]);
    }
    free(show->names);
    free(show->shapes);
    free(show->pictures);
    free(show->distances);
    cli_table_free(&show->table);
}
