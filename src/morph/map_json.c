/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.json: the place on B of each vertex of A, as text (docs/formats.md). Its table
 * (starguard/fields.h) defines names, ranges and meaning of its keys. */
#include <float.h>
#include <math.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/record.h"
#include "mesh/mesh.h"
#include "morph/map.h"

static const char STAGE[] = "map file";
enum { MARGIN = 2 };
#define SUM_ERROR 1e-6 /* tolerance for three coordinates that should sum to 1 */

/* ---- the table ---- */

#define RESULT(NAME) FIELD_MEMBER(starg_map, NAME)
/* One of the coordinates of a point. */
#define COORDINATE(K)                                                                              \
    .kind = STARG_FIELD_REAL, .offset = offsetof(starg_map, coordinates),                          \
    .stride = 3 * sizeof(double), .within = (K) * sizeof(double), .size = sizeof(double),          \
    .high = 1 + SUM_ERROR

static const char *const KINDS[] = {"same", "sphere", "given", NULL};

/* Others may write maps: whatever follows from the points is optional. */
static const starg_field MAP[] = {
    {.key = "kind",
     .kind = STARG_FIELD_CHOICE,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(kind),
     .words = KINDS,
     .initial = STARG_MAP_GIVEN,
     .help = "same: vertex i maps to vertex i; sphere: via the sphere; given: read from a file."},
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(vertex_count),
     .most = STARG_MESH_LIMIT,
     .help = "Of A."},
    {.key = "target_vertices",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(target_vertices),
     .most = STARG_MESH_LIMIT,
     .help = "Of B."},
    {.key = "target_faces",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(target_faces),
     .most = STARG_MESH_LIMIT,
     .help = "Of B."},
    {.key = "mean_angle_distortion",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(mean_angle_distortion),
     .high = DBL_MAX,
     .help = "1 is best."},
    {.key = "mean_area_distortion",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(mean_area_distortion),
     .high = DBL_MAX,
     .help = "1 is best."},
    {.key = "landmarks",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(landmark_count),
     .most = STARG_MESH_LIMIT,
     .help = "Number of satisfied landmarks."},
};
static const starg_fields MAP_TABLE = {.name = "map", FIELD_ROWS(MAP)};

static const starg_field POINTS[] = {
    {.key = "face",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_map, faces),
     .size = sizeof(uint32_t),
     .most = STARG_MESH_LIMIT,
     .help = "Of B."},
    {.key = "u", COORDINATE(0), .help = "Barycentric coordinate about the face's first corner."},
    {.key = "v", COORDINATE(1), .help = "About its second corner."},
    {.key = "w", COORDINATE(2), .help = "About its third corner."},
};
static const starg_fields POINTS_TABLE = {
    .columns = true, .name = "points", .form = STARG_FORM_TUPLE, FIELD_ROWS(POINTS)};

static const starg_field FILE_ROWS[] = {
    {.key = "format", .kind = STARG_FIELD_CONSTANT, .value = "starguard-map"},
    {.key = "version", .kind = STARG_FIELD_CONSTANT, .initial = 1},
    {.key = "map", .kind = STARG_FIELD_RECORD, .flags = STARG_FIELD_OPTIONAL, .of = &MAP_TABLE},
    {.key = "points",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     .of = &POINTS_TABLE,
     .length = offsetof(starg_map, vertex_count),
     .help = "Of each vertex of A."},
};
const starg_fields map_file_fields = {
    .name = "map file", .size = sizeof(starg_map), FIELD_ROWS(FILE_ROWS)};

/* ---- write ---- */

static bool put(FILE *stream, const void *result, const char *unused) {
    (void)unused;
    return record_put(stream, &map_file_fields, result, MARGIN);
}

starg_status starg_map_write(starg_context *context, const starg_map *map, const char *path) {
    return starg_json_write(context, STAGE, path, put, map, NULL);
}

starg_status starg_map_write_memory(starg_context *context, const starg_map *map, char **text,
                                    size_t *size) {
    return starg_json_write_memory(context, STAGE, put, map, NULL, text, size);
}

/* ---- read ---- */

static starg_status check_point(starg_context *context, const starg_map *map, size_t vertex) {
    const double *w = map->coordinates + 3 * vertex;
    uint64_t index = vertex;
    bool known = map->faces[vertex] < map->target_faces;
    if (known && fabs(w[0] + w[1] + w[2] - 1) <= SUM_ERROR)
        return STARG_OK;
    return starg_fail_at(context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_VERTEX, &index, 1,
                         "the entry of vertex %zu in \"points\" %s; it must be [face of B, u, v, "
                         "w], with coordinates of 0 or more that sum to 1",
                         vertex,
                         known ? "has coordinates that do not sum to 1"
                               : "names a face that B does not have");
}

/* Checks that it is a map between these meshes, and takes over their counts. */
static starg_status check_map(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              starg_map *map) {
    starg_status status = STARG_OK;
    if (map->vertex_count != a->vertex_count)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the map has %zu entries in \"points\", but A has %zu vertices; it "
                          "belongs to another pair of models",
                          map->vertex_count, a->vertex_count);
    map->kind = STARG_MAP_GIVEN;
    map->target_vertices = b->vertex_count;
    map->target_faces = b->face_count;
    for (size_t v = 0; v < map->vertex_count; v++)
        STARG_TRY(check_point(context, map, v));
done:
    return status;
}

starg_status starg_map_read(starg_context *context, const char *path, const starg_mesh *a,
                            const starg_mesh *b, starg_map **out) {
    starg_status status = STARG_OK;
    starg_map *map = NULL;
    json_t *root = NULL;
    char *bytes = NULL;
    size_t size;
    *out = NULL;
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_json_parse(context, STAGE, path, bytes, size, &root));
    STARG_NEW_ZERO(context, STAGE, map, 1);
    STARG_TRY(record_read(context, path, root, &map_file_fields, map));
    STARG_TRY(check_map(context, a, b, map));
    STARG_TRY(map_measure(context, a, b, map));
    *out = map;
    map = NULL;
done:
    json_decref(root);
    starg_release(context, bytes);
    starg_map_free(context, map);
    return status;
}
