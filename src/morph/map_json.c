/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.json: the place on B of each vertex of A, as text (docs/formats.md). Its table
 * (starguard/fields.h) defines names, ranges and meaning of its keys. */
#include <float.h>
#include <math.h>

#include "core/file.h"
#include "core/json.h"
#include "mesh/mesh.h"
#include "morph/surface_map.h"

static const char STAGE[] = "map file";
enum { MARGIN = 2 };
#define DIRECTION_MOST 1e3  /* of a coordinate */
#define SUM_ERROR      1e-6 /* tolerance for three coordinates that should sum to 1 */

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

#define DIRECTION(MEMBER, K)                                                                       \
    .kind = STARG_FIELD_REAL, .offset = offsetof(starg_map, MEMBER), .stride = 3 * sizeof(double), \
    .within = (K) * sizeof(double), .size = sizeof(double), .low = -DIRECTION_MOST,                \
    .high = DIRECTION_MOST

static const starg_field DIRECTIONS[] = {
    {.key = "x", DIRECTION(directions, 0), .help = "Of a direction of length about 1."},
    {.key = "y", DIRECTION(directions, 1), .help = "Of the same."},
    {.key = "z", DIRECTION(directions, 2), .help = "Of the same."},
};
static const starg_fields DIRECTIONS_TABLE = {
    .columns = true, .name = "directions", .form = STARG_FORM_TUPLE, FIELD_ROWS(DIRECTIONS)};

static const starg_field TARGET_DIRECTIONS[] = {
    {.key = "x", DIRECTION(target_directions, 0), .help = "Of a direction of length about 1."},
    {.key = "y", DIRECTION(target_directions, 1), .help = "Of the same."},
    {.key = "z", DIRECTION(target_directions, 2), .help = "Of the same."},
};
static const starg_fields TARGET_DIRECTIONS_TABLE = {
    .columns = true, .name = "directions", .form = STARG_FORM_TUPLE, FIELD_ROWS(TARGET_DIRECTIONS)};

/* Item K of N indices in a row. */
#define INDEX(MEMBER, K, N)                                                                        \
    .kind = STARG_FIELD_COUNT, .offset = offsetof(starg_map, MEMBER),                              \
    .stride = (N) * sizeof(uint32_t), .within = (K) * sizeof(uint32_t), .size = sizeof(uint32_t),  \
    .most = STARG_MESH_LIMIT

static const starg_field PAIRS[] = {
    {.key = "from", INDEX(pairs, 0, 2), .help = "A vertex of A."},
    {.key = "to", INDEX(pairs, 1, 2), .help = "The vertex of B that it goes to."},
};
static const starg_fields PAIRS_TABLE = {
    .columns = true, .name = "landmark_pairs", .form = STARG_FORM_TUPLE, FIELD_ROWS(PAIRS)};

#define OVERLAY_COORDINATE(MEMBER, K)                                                              \
    .kind = STARG_FIELD_REAL, .offset = offsetof(starg_map, overlay.MEMBER),                       \
    .stride = 3 * sizeof(double), .within = (K) * sizeof(double), .size = sizeof(double),          \
    .high = 1 + SUM_ERROR

static const starg_field OVERLAY_POINTS[] = {
    {.key = "face", INDEX(overlay.own_faces, 0, 1), .help = "Of A."},
    {.key = "u", OVERLAY_COORDINATE(own_coordinates, 0), .help = "Barycentric coordinates there."},
    {.key = "v", OVERLAY_COORDINATE(own_coordinates, 1), .help = "Likewise."},
    {.key = "w", OVERLAY_COORDINATE(own_coordinates, 2), .help = "Likewise."},
    {.key = "target_face", INDEX(overlay.target_faces, 0, 1), .help = "Of B."},
    {.key = "target_u",
     OVERLAY_COORDINATE(target_coordinates, 0),
     .help = "Barycentric coordinates there."},
    {.key = "target_v", OVERLAY_COORDINATE(target_coordinates, 1), .help = "Likewise."},
    {.key = "target_w", OVERLAY_COORDINATE(target_coordinates, 2), .help = "Likewise."},
};
static const starg_fields OVERLAY_POINTS_TABLE = {.columns = true,
                                                  .name = "overlay_points",
                                                  .form = STARG_FORM_TUPLE,
                                                  FIELD_ROWS(OVERLAY_POINTS)};

static const starg_field OVERLAY_FACES[] = {
    {.key = "a", INDEX(overlay.faces, 0, 3), .help = "A point of the overlay."},
    {.key = "b", INDEX(overlay.faces, 1, 3), .help = "Likewise."},
    {.key = "c", INDEX(overlay.faces, 2, 3), .help = "Likewise."},
};
static const starg_fields OVERLAY_FACES_TABLE = {
    .columns = true, .name = "overlay_faces", .form = STARG_FORM_TUPLE, FIELD_ROWS(OVERLAY_FACES)};

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
    {.key = "landmark_pairs",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_LINES,
     .of = &PAIRS_TABLE,
     .length = offsetof(starg_map, pair_count),
     .help = "Satisfied landmarks."},
    {.key = "directions",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_LINES,
     .of = &DIRECTIONS_TABLE,
     .length = offsetof(starg_map, direction_count),
     .help = "Of each vertex of A on the sphere over which both surfaces are mapped."},
    {.key = "target_directions",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_LINES,
     .of = &TARGET_DIRECTIONS_TABLE,
     .length = offsetof(starg_map, target_direction_count),
     .help = "Of each vertex of B on the same sphere."},
    {.key = "overlay_points",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_LINES,
     .of = &OVERLAY_POINTS_TABLE,
     .length = offsetof(starg_map, overlay.vertex_count),
     .help = "Vertices of the overlay: places on A and on B."},
    {.key = "overlay_faces",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_LINES,
     .of = &OVERLAY_FACES_TABLE,
     .length = offsetof(starg_map, overlay.face_count),
     .help = "Triangles of the overlay, each in one face of A and in one of B."},
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
/* The directions are of both surfaces, and landmarks of their vertices. */
static starg_status check_target(starg_context *context, const starg_mesh *b,
                                 const starg_map *map) {
    if ((map->direction_count > 0 || map->target_direction_count > 0) &&
        (map->direction_count != map->vertex_count ||
         map->target_direction_count != b->vertex_count))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the map has %zu entries in \"directions\" and %zu in "
                          "\"target_directions\", but A has %zu vertices and B %zu; it belongs to "
                          "another pair of models",
                          map->direction_count, map->target_direction_count, map->vertex_count,
                          b->vertex_count);
    for (size_t i = 0; i < map->pair_count; i++)
        if (map->pairs[2 * i] >= map->vertex_count || map->pairs[2 * i + 1] >= b->vertex_count)
            return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                              "entry %zu of \"landmark_pairs\" names vertices that the models do "
                              "not have; it belongs to another pair of models",
                              i);
    return STARG_OK;
}

static bool are_below(const uint32_t *indices, size_t count, size_t limit) {
    bool below = true;
    for (size_t i = 0; i < count; i++)
        below = below && indices[i] < limit;
    return below;
}

static starg_status check_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                  const starg_overlay *overlay) {
    if ((overlay->vertex_count > 0) != (overlay->face_count > 0))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the map needs both \"overlay_points\" and \"overlay_faces\", or none");
    if (!are_below(overlay->own_faces, overlay->vertex_count, a->face_count) ||
        !are_below(overlay->target_faces, overlay->vertex_count, b->face_count))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "\"overlay_points\" name faces that the models do not have; it belongs "
                          "to another pair of models");
    if (!are_below(overlay->faces, 3 * overlay->face_count, overlay->vertex_count))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "\"overlay_faces\" name more than the %zu points of the overlay",
                          overlay->vertex_count);
    return STARG_OK;
}

static starg_status check_map(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              starg_map *map) {
    if (map->vertex_count != a->vertex_count)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the map has %zu entries in \"points\", but A has %zu vertices; it "
                          "belongs to another pair of models",
                          map->vertex_count, a->vertex_count);
    TRY(check_target(context, b, map));
    TRY(check_overlay(context, a, b, &map->overlay));
    map->kind = STARG_MAP_GIVEN;
    map->target_vertices = b->vertex_count;
    map->target_faces = b->face_count;
    for (size_t v = 0; v < map->vertex_count; v++)
        TRY(check_point(context, map, v));
    return STARG_OK;
}

starg_status starg_map_read(starg_context *context, const char *path, const starg_mesh *a,
                            const starg_mesh *b, starg_map **out) {
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    SCOPED char *bytes = NULL;
    size_t size;
    *out = NULL;
    TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    TRY(starg_json_parse(context, STAGE, path, bytes, size, &root));
    NEW_ZERO(context, STAGE, map, 1);
    TRY(record_read(context, path, root, &map_file_fields, map));
    TRY(check_map(context, a, b, map));
    TRY(map_measure(context, a, b, map));
    *out = map;
    map = NULL;
    return STARG_OK;
}
