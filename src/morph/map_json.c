/* MAP.json: where each vertex of A lies on B, as text (docs/formats.md); and files of landmarks. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "mesh/mesh.h"
#include "morph/map.h"

static const char STAGE[] = "map file";
static const char FORMAT[] = "starguard-map";
static const char *const KINDS[] = {"same", "sphere", "given"};
enum { VERSION = 1 };
static const double SUM_ERROR = 1e-6; /* of three coordinates that should sum to 1 */

/* ---- write ---- */

static json_t *head_json(const starg_map *map) {
    return json_pack("{s:s, s:I, s:I, s:I, s:f, s:f, s:I}", "kind", KINDS[map->kind], "vertices",
                     (json_int_t)map->vertex_count, "target_vertices",
                     (json_int_t)map->target_vertices, "target_faces",
                     (json_int_t)map->target_faces, "mean_angle_distortion",
                     map->mean_angle_distortion, "mean_area_distortion", map->mean_area_distortion,
                     "landmarks", (json_int_t)map->landmark_count);
}

static bool put_points(FILE *stream, const starg_map *map) {
    bool made = true;
    for (size_t v = 0; v < map->vertex_count && made; v++) {
        const double *w = map->coordinates + 3 * v;
        made = starg_json_put(
            stream, "    ", json_pack("[I, f, f, f]", (json_int_t)map->faces[v], w[0], w[1], w[2]),
            v + 1 < map->vertex_count ? ",\n" : "\n");
    }
    return made;
}

starg_status starg_map_write(starg_context *context, const starg_map *map, const char *path) {
    starg_status status = STARG_OK;
    starg_output output;
    STARG_TRY(starg_output_open(context, STAGE, path, &output));
    fprintf(output.stream, "{\n  \"format\": \"%s\",\n  \"version\": %d,\n", FORMAT, VERSION);
    bool made = starg_json_put(output.stream, "  \"map\": ", head_json(map), ",\n");
    fputs("  \"points\": [\n", output.stream);
    made = made && put_points(output.stream, map);
    fputs("  ]\n}\n", output.stream);
    if (!made) {
        starg_output_discard(&output);
        return starg_fail_memory(context, STAGE);
    }
    STARG_TRY(starg_output_commit(&output));
done:
    return status;
}

/* ---- read ---- */

static starg_status fail_point(starg_context *context, size_t vertex, const char *what) {
    uint64_t index = vertex;
    return starg_fail_at(context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_VERTEX, &index, 1,
                         "the entry of vertex %zu in \"points\" %s; it must be [face of B, u, v, "
                         "w], with coordinates of 0 or more that sum to 1",
                         vertex, what);
}

static starg_status read_point(starg_context *context, const json_t *item, size_t v,
                               starg_map *map) {
    double *w = map->coordinates + 3 * v, sum = 0;
    if (!json_is_array(item) || json_array_size(item) != 4 ||
        !json_is_integer(json_array_get(item, 0)))
        return fail_point(context, v, "is not a face and three numbers");
    json_int_t face = json_integer_value(json_array_get(item, 0));
    if (face < 0 || (size_t)face >= map->target_faces)
        return fail_point(context, v, "names a face that B does not have");
    map->faces[v] = (uint32_t)face;
    for (size_t k = 0; k < 3; k++) {
        const json_t *value = json_array_get(item, k + 1);
        if (!json_is_number(value))
            return fail_point(context, v, "is not a face and three numbers");
        w[k] = json_number_value(value);
        if (!(w[k] >= 0 && w[k] <= 1 + SUM_ERROR))
            return fail_point(context, v, "has a coordinate outside of 0 to 1");
        sum += w[k];
    }
    if (!(fabs(sum - 1) <= SUM_ERROR))
        return fail_point(context, v, "has coordinates that do not sum to 1");
    return STARG_OK;
}

static starg_status read_points(starg_context *context, const json_t *root, starg_map *map) {
    starg_status status = STARG_OK;
    const json_t *points = json_object_get(root, "points"),
                 *format = json_object_get(root, "format"),
                 *version = json_object_get(root, "version");
    if (!json_is_string(format) || strcmp(json_string_value(format), FORMAT) != 0)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the file does not say that it is a map: \"format\" must be \"%s\"",
                          FORMAT);
    if (!json_is_integer(version) || json_integer_value(version) != VERSION)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE, "\"version\" must be %d", VERSION);
    if (!json_is_array(points) || json_array_size(points) != map->vertex_count)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "the map has %zu entries in \"points\", but A has %zu vertices; it is of "
                          "another pair of models",
                          json_array_size(points), map->vertex_count);
    for (size_t v = 0; v < map->vertex_count; v++)
        STARG_TRY(read_point(context, json_array_get(points, v), v, map));
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
    STARG_TRY(map_make(context, a, b, STARG_MAP_GIVEN, &map));
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_json_parse(context, STAGE, path, bytes, size, &root));
    STARG_TRY(read_points(context, root, map));
    STARG_TRY(map_measure(context, a, b, map));
    *out = map;
    map = NULL;
done:
    json_decref(root);
    starg_release(context, bytes);
    starg_map_free(context, map);
    return status;
}
