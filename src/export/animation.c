/* SPDX-License-Identifier: Apache-2.0 */
/* Animations as binary glTF 2.0.
 *
 * Numbers, all four bytes wide, in this order: vertex indices of the faces; positions of the first
 * frame; for each other frame the displacements from the first; the times of the frames; the
 * weights of the targets at each time, one of them 1 and the others 0; the colours of the vertices
 * where they have some, linear as the format wants them; their texture coordinates where they have
 * some, v downward. Each is a view and an accessor of its own. Little endian, as the format
 * requires, on any machine. A vertex whose corners have several texture coordinates is written once
 * for each. */
#include "starguard/animation.h"

#include <math.h>
#include <stdlib.h>

#include "export/export.h"
#include "mesh/mesh.h"

static const char STAGE[] = "animation";

typedef struct animation {
    const starg_mesh *mesh;
    const double *const *frames;
    size_t count, indices;
    size_t vertices;       /* as written */
    size_t *vertex;        /* of the mesh, by vertex as written */
    size_t *corner;        /* a corner there, or NULL: no texture coordinates */
    uint32_t *faces;       /* indices, by corner */
    const uint8_t *colors; /* of the mesh, or NULL */
    double seconds, center[3];
} animation;

/* ---- vertices ---- */

typedef struct corner {
    const float *uv;
    size_t vertex, index;
} corner;

static int compare_places(const corner *a, const corner *b) {
    if (a->vertex != b->vertex)
        return a->vertex < b->vertex ? -1 : 1;
    for (int k = 0; k < 2; k++)
        if (a->uv[k] != b->uv[k])
            return a->uv[k] < b->uv[k] ? -1 : 1;
    return 0;
}

static int compare_corners(const void *left, const void *right) {
    const corner *a = left, *b = right;
    int order = compare_places(a, b);
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

static starg_status keep_vertices(starg_context *context, animation *a) {
    a->vertices = starg_mesh_vertex_count(a->mesh);
    NEW(context, STAGE, a->vertex, a->vertices);
    NEW(context, STAGE, a->faces, a->indices);
    for (size_t i = 0; i < a->vertices; i++)
        a->vertex[i] = i;
    memcpy(a->faces, starg_mesh_faces(a->mesh), a->indices * sizeof *a->faces);
    return STARG_OK;
}

/* One vertex for each place in the texture. */
static starg_status split_vertices(starg_context *context, animation *a) {
    const float *texture = starg_mesh_texture(a->mesh);
    SCOPED corner *corners = NULL;
    if (texture == NULL)
        return keep_vertices(context, a);
    NEW(context, STAGE, corners, a->indices);
    NEW(context, STAGE, a->vertex, a->indices);
    NEW(context, STAGE, a->corner, a->indices);
    NEW(context, STAGE, a->faces, a->indices);
    for (size_t i = 0; i < a->indices; i++)
        corners[i] = (corner){texture + 2 * i, starg_mesh_faces(a->mesh)[i], i};
    qsort(corners, a->indices, sizeof *corners, compare_corners);
    for (size_t i = 0; i < a->indices; i++) {
        if (i == 0 || compare_places(&corners[i - 1], &corners[i]) != 0) {
            a->vertex[a->vertices] = corners[i].vertex;
            a->corner[a->vertices++] = corners[i].index;
        }
        a->faces[corners[i].index] = (uint32_t)a->vertices - 1;
    }
    return STARG_OK;
}

/* ---- checks ---- */

static starg_status check(starg_context *context, animation *a) {
    double lower[3], upper[3];
    if (a->count < 2 || a->count > STARG_ANIMATION_FRAMES || !(a->seconds > 0 && a->seconds < 1e6))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu frames in %g seconds; there must be 2 to %d frames, and the time "
                          "must be positive and below 1e6",
                          a->count, a->seconds, STARG_ANIMATION_FRAMES);
    if (a->indices == 0 || a->count * a->vertices * 12 + a->indices * 4 > UINT32_MAX / 2)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "%zu frames of %zu vertices: empty, or too many for the format", a->count,
                          a->vertices);
    starg_mesh_bounds(a->mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        a->center[k] = 0.5 * lower[k] + 0.5 * upper[k];
    for (size_t f = 0; f < a->count; f++)
        for (size_t i = 0; i < 3 * starg_mesh_vertex_count(a->mesh); i++)
            if (!(fabs(a->frames[f][i] - a->center[i % 3]) < GLB_LIMIT))
                return starg_fail(context, STARG_ERROR_RANGE, STAGE,
                                  "a coordinate of frame %zu exceeds single precision", f);
    return STARG_OK;
}

/* Of coordinate i of the mesh's vertices, as the next one. */
static float first_position(const animation *a, size_t i) {
    return (float)(a->frames[0][i] - a->center[i % 3]);
}

static float displacement(const animation *a, size_t frame, size_t i) {
    return (float)(a->frames[frame][i] - a->frames[0][i]);
}

/* Frames are drawn as the first one and a displacement, both rounded. Their faces may have no area
 * between the ends, so that only the first one is compared as a surface. */
static starg_status check_frame(starg_context *context, const animation *a, size_t frame) {
    SCOPED double *drawn = NULL;
    const size_t vertices = starg_mesh_vertex_count(a->mesh);
    SCOPED_BY(starg_mesh_drop) starg_mesh *surface = NULL;
    char name[32];
    const single_place place = {.stage = STAGE, .what = name, .remedy = "frames as OFF keep it"};
    snprintf(name, sizeof name, "frame %zu", frame);
    NEW(context, STAGE, drawn, 3 * vertices);
    TRY(starg_mesh_create(context, a->frames[frame], vertices, starg_mesh_faces(a->mesh),
                          frame == 0 ? a->indices / 3 : 0, &surface));
    for (size_t i = 0; i < 3 * vertices; i++) {
        surface->vertices[i] -= a->center[i % 3];
        drawn[i] = (double)first_position(a, i) + (double)displacement(a, frame, i);
    }
    return single_compare(context, surface, drawn, &place);
}

/* The coordinate of the mesh's vertices that is number i of the vertices as written. */
static size_t coordinate(const animation *a, size_t i) {
    return 3 * a->vertex[i / 3] + i % 3;
}

/* Number i of the first frame's positions, or of another frame's displacements, as written. */
static float number_of(const animation *a, size_t frame, size_t i) {
    return frame == 0 ? first_position(a, coordinate(a, i))
                      : displacement(a, frame, coordinate(a, i));
}

/* ---- description ---- */

/* Accessors: indices, positions, targets, times, weights, colours, texture coordinates. */
static size_t accessors_of(const animation *a) {
    return a->count + 3 + (a->colors != NULL) + (a->corner != NULL);
}

/* Numbers of a value in accessor `index`. */
static size_t parts_of(const animation *a, size_t index) {
    if ((index >= 1 && index <= a->count) || (index == a->count + 3 && a->colors != NULL))
        return 3;
    return index >= a->count + 3 ? 2 : 1;
}

/* Number of values in accessor `index`. */
static size_t accessor_count(const animation *a, size_t index) {
    if (index == 0)
        return a->indices;
    if (parts_of(a, index) > 1)
        return a->vertices;
    return index == a->count + 1 ? a->count : a->count * (a->count - 1);
}

static size_t accessor_bytes(const animation *a, size_t index) {
    return accessor_count(a, index) * parts_of(a, index) * 4;
}

static size_t binary_bytes(const animation *a) {
    size_t sum = 0;
    for (size_t i = 0; i < accessors_of(a); i++)
        sum += accessor_bytes(a, i);
    return sum;
}

static int set_box(const animation *a, size_t frame, json_t *json) {
    double lower[3] = {0}, upper[3] = {0};
    for (size_t i = 0; i < 3 * a->vertices; i++) {
        double x = (double)number_of(a, frame, i);
        lower[i % 3] = i < 3 ? x : fmin(lower[i % 3], x);
        upper[i % 3] = i < 3 ? x : fmax(upper[i % 3], x);
    }
    return json_object_set_new(json, "min", json_pack("[f, f, f]", lower[0], lower[1], lower[2])) |
           json_object_set_new(json, "max", json_pack("[f, f, f]", upper[0], upper[1], upper[2]));
}

static json_t *accessor_json(const animation *a, size_t index) {
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3"};
    json_t *json =
        json_pack("{s:I, s:I, s:I, s:s}", "bufferView", (json_int_t)index, "componentType",
                  (json_int_t)(index == 0 ? GLB_UNSIGNED_INT : GLB_FLOAT), "count",
                  (json_int_t)accessor_count(a, index), "type", types[parts_of(a, index) - 1]);
    int failed = 0;
    if (index >= 1 && index <= a->count)
        failed = set_box(a, index - 1, json);
    if (index == a->count + 1)
        failed = json_object_set_new(json, "min", json_pack("[f]", 0.0)) |
                 json_object_set_new(json, "max", json_pack("[f]", (double)(float)a->seconds));
    if (failed == 0)
        return json;
    json_decref(json);
    return NULL;
}

/* Appends to each list; false when out of memory. */
static bool describe_numbers(const animation *a, json_t *accessors, json_t *views,
                             json_t *targets) {
    size_t offset = 0;
    int failed = 0;
    for (size_t i = 0; i < accessors_of(a); i++) {
        failed |= json_array_append_new(accessors, accessor_json(a, i));
        failed |= json_array_append_new(
            views, json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset", (json_int_t)offset,
                             "byteLength", (json_int_t)accessor_bytes(a, i)));
        if (i >= 2 && i <= a->count)
            failed |= json_array_append_new(targets, json_pack("{s:I}", "POSITION", (json_int_t)i));
        offset += accessor_bytes(a, i);
    }
    return failed == 0;
}

static json_t *describe(const animation *a) {
    json_t *accessors = json_array(), *views = json_array(), *targets = json_array();
    json_t *attributes = json_pack("{s:i}", "POSITION", 1);
    const json_int_t next = (json_int_t)a->count + 3; /* accessor */
    int failed = 0;
    if (a->colors != NULL)
        failed |= json_object_set_new(attributes, "COLOR_0", json_integer(next));
    if (a->corner != NULL)
        failed |=
            json_object_set_new(attributes, "TEXCOORD_0", json_integer(next + (a->colors != NULL)));
    if (!describe_numbers(a, accessors, views, targets) || failed != 0) {
        json_decref(attributes);
        json_decref(accessors);
        json_decref(views);
        json_decref(targets);
        return NULL;
    }
    size_t times = a->count + 1; /* accessor */
    return json_pack(
        "{s:{s:s}, s:i, s:[{s:[i]}], s:[{s:i, s:[f, f, f]}],"
        " s:[{s:[{s:o, s:i, s:i, s:o}]}], s:[{s:s, s:{s:i, s:i}}], s:[{s:[{s:i, s:{s:i, s:s}}],"
        " s:[{s:I, s:I, s:s}]}], s:o, s:o, s:[{s:I}]}",
        "asset", "version", "2.0", "scene", 0, "scenes", "nodes", 0, "nodes", "mesh", 0,
        "translation", a->center[0], a->center[1], a->center[2], "meshes", "primitives",
        "attributes", attributes, "indices", 0, "material", 0, "targets", targets, "materials",
        "name", "surface", "pbrMetallicRoughness", "metallicFactor", 0, "roughnessFactor", 1,
        "animations", "channels", "sampler", 0, "target", "node", 0, "path", "weights", "samplers",
        "input", (json_int_t)times, "output", (json_int_t)times + 1, "interpolation", "LINEAR",
        "accessors", accessors, "bufferViews", views, "buffers", "byteLength",
        (json_int_t)binary_bytes(a));
}

/* ---- bytes ---- */

/* The light of a part of an sRGB colour. */
static float light_of(uint8_t part) {
    double x = part / 255.0;
    return (float)(x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4));
}

static void put_numbers(FILE *stream, const void *user) {
    const animation *a = user;
    for (size_t i = 0; i < a->indices; i++)
        little_put_word(stream, a->faces[i]);
    for (size_t f = 0; f < a->count; f++)
        for (size_t i = 0; i < 3 * a->vertices; i++)
            little_put_float(stream, number_of(a, f, i));
    for (size_t f = 0; f < a->count; f++)
        little_put_float(stream, (float)(a->seconds * (double)f / (double)(a->count - 1)));
    for (size_t f = 0; f < a->count; f++)
        for (size_t target = 1; target < a->count; target++)
            little_put_float(stream, target == f ? 1 : 0);
    for (size_t i = 0; a->colors != NULL && i < 3 * a->vertices; i++)
        little_put_float(stream, light_of(a->colors[coordinate(a, i)]));
    for (size_t i = 0; a->corner != NULL && i < a->vertices; i++) {
        const float *uv = starg_mesh_texture(a->mesh) + 2 * a->corner[i];
        little_put_float(stream, uv[0]);
        little_put_float(stream, 1 - uv[1]);
    }
}

starg_status starg_animation_write(starg_context *context, const starg_mesh *mesh,
                                   const double *const *frames, size_t frame_count, double seconds,
                                   const char *path) {
    starg_status status = STARG_OK;
    json_t *json = NULL;
    animation a = {.mesh = mesh,
                   .frames = frames,
                   .count = frame_count,
                   .colors = starg_mesh_colors(mesh),
                   .indices = 3 * starg_mesh_face_count(mesh),
                   .seconds = seconds};
    STARG_TRY(split_vertices(context, &a));
    STARG_TRY(check(context, &a));
    for (size_t f = 0; f < a.count; f++)
        STARG_TRY(check_frame(context, &a, f));
    json = describe(&a);
    STARG_TRY(glb_write(context, STAGE, path, json, binary_bytes(&a), put_numbers, &a));
done:
    json_decref(json);
    RELEASE(a.vertex, a.corner, a.faces);
    return status;
}
