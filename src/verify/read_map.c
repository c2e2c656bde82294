/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.json, read for the verifier (docs/formats.md). Checks types and shapes here; verification
 * checks the numbers. Skips unknown keys. Shares only the JSON parser with starg_map_read. */
#include <math.h>
#include <stdio.h>

#include "core/json.h"
#include "verify/map.h"

STARG_DROP(starg_map_file, starg_map_file)

static const char STAGE[] = "map file";

typedef struct reader {
    starg_context *context;
    const char *name;
    starg_status status; /* the first error ends it */
} reader;

static void reject(reader *r, const char *key, const char *expected) {
    if (r->status == STARG_OK)
        r->status = starg_fail(r->context, STARG_ERROR_FORMAT, STAGE,
                               "'%.200s' is not a valid map file: \"%s\" must be %s", r->name, key,
                               expected);
}

/* A number, or not a number if there is none. */
static double read_number(reader *r, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (value == NULL)
        return NAN;
    if (!json_is_number(value))
        reject(r, key, "a number");
    return json_number_value(value);
}

static bool read_index(const json_t *value, uint32_t *out) {
    json_int_t number = json_integer_value(value);
    *out = (uint32_t)number;
    return json_is_integer(value) && number >= 0 && number <= INT32_MAX;
}

static bool read_real(const json_t *value, double *out) {
    *out = json_number_value(value);
    return json_is_number(value) && fabs(*out) < 1e100;
}

/* A column block of a table. */
typedef struct column {
    size_t width;
    uint32_t **indices; /* either */
    double **reals;     /* or */
} column;

static bool read_row(const json_t *row, const column *columns, size_t count, size_t i) {
    size_t next = 0;
    for (size_t c = 0; c < count; c++)
        for (size_t k = 0; k < columns[c].width; k++, next++) {
            const json_t *value = json_array_get(row, next);
            size_t at = i * columns[c].width + k;
            if (columns[c].indices != NULL ? !read_index(value, *columns[c].indices + at)
                                           : !read_real(value, *columns[c].reals + at))
                return false;
        }
    return json_array_size(row) == next;
}

/* An array of rows; without the key nothing. */
static void read_table(reader *r, const json_t *root, const char *key, const column *columns,
                       size_t count, size_t *rows) {
    starg_status status = STARG_OK;
    const json_t *list = json_object_get(root, key);
    *rows = 0;
    if (list == NULL || r->status != STARG_OK)
        return;
    if (!json_is_array(list)) {
        reject(r, key, "an array");
        return;
    }
    size_t found = json_array_size(list);
    for (size_t c = 0; c < count; c++)
        if (columns[c].indices != NULL)
            STARG_NEW(r->context, STAGE, *columns[c].indices, found * columns[c].width);
        else
            STARG_NEW(r->context, STAGE, *columns[c].reals, found * columns[c].width);
    for (size_t i = 0; i < found; i++)
        if (!read_row(json_array_get(list, i), columns, count, i)) {
            char expected[96];
            snprintf(expected, sizeof expected,
                     "rows of indices and numbers as the format says; entry %zu is not", i);
            reject(r, key, expected);
            return;
        }
    *rows = found;
done:
    if (status != STARG_OK)
        r->status = status;
}

static void read_points(reader *r, const json_t *root, starg_map_file *file) {
    const column points[] = {{1, &file->points.faces, NULL}, {3, NULL, &file->points.weights}};
    const column pairs[] = {{2, &file->pairs, NULL}};
    const column own[] = {{3, NULL, &file->directions[0]}};
    const column target[] = {{3, NULL, &file->directions[1]}};
    if (json_object_get(root, "points") == NULL)
        reject(r, "points", "an array");
    read_table(r, root, "points", points, 2, &file->point_count);
    read_table(r, root, "landmark_pairs", pairs, 1, &file->pair_count);
    read_table(r, root, "directions", own, 1, &file->direction_count[0]);
    read_table(r, root, "target_directions", target, 1, &file->direction_count[1]);
}

static void read_overlay(reader *r, const json_t *root, starg_map_file *file) {
    const column points[] = {{1, &file->overlay[0].faces, NULL},
                             {3, NULL, &file->overlay[0].weights},
                             {1, &file->overlay[1].faces, NULL},
                             {3, NULL, &file->overlay[1].weights}};
    const column triangles[] = {{3, &file->triangles, NULL}};
    read_table(r, root, "overlay_points", points, 4, &file->overlay_points);
    read_table(r, root, "overlay_faces", triangles, 1, &file->overlay_faces);
}

static void read_document(reader *r, const json_t *root, starg_map_file *file) {
    const json_t *map = json_object_get(root, "map"), *version = json_object_get(root, "version");
    const char *kind = json_string_value(json_object_get(map, "kind"));
    if (!json_is_integer(version) || json_integer_value(version) != 1)
        reject(r, "version", "1, the only supported one");
    file->same = kind != NULL && strcmp(kind, "same") == 0;
    file->vertices = read_number(r, map, "vertices");
    file->target_vertices = read_number(r, map, "target_vertices");
    file->target_faces = read_number(r, map, "target_faces");
    file->landmarks = read_number(r, map, "landmarks");
    file->angles = read_number(r, map, "mean_angle_distortion");
    file->areas = read_number(r, map, "mean_area_distortion");
    read_points(r, root, file);
    read_overlay(r, root, file);
}

starg_status starg_map_file_read_memory(starg_context *context, const void *bytes, size_t size,
                                        const char *name, starg_map_file **out) {
    reader r = {context, name, STARG_OK};
    SCOPED_BY(starg_map_file_drop) starg_map_file *file = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    *out = NULL;
    TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    NEW_ZERO(context, STAGE, file, 1);
    file->context = context;
    read_document(&r, root, file);
    TRY(r.status);
    *out = file;
    file = NULL;
    return STARG_OK;
}

void starg_map_file_free(starg_map_file *file) {
    if (file == NULL)
        return;
    RELEASE(file->points.faces, file->points.weights, file->pairs);
    for (int s = 0; s < 2; s++) {
        RELEASE(file->directions[s], file->overlay[s].faces, file->overlay[s].weights);
    }
    RELEASE(file->triangles, file);
}
