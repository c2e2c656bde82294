/* SPDX-License-Identifier: Apache-2.0 */
/* Animations as binary glTF 2.0.
 *
 * Numbers, all four bytes wide, in this order: vertex indices of the faces; positions of the first
 * frame; for each other frame the displacements from the first; the times of the frames; the
 * weights of the targets at each time, one of them 1 and the others 0; the colours of the vertices
 * where they have some, linear as the format wants them. Each is a view and an accessor of its
 * own. Little endian, as the format requires, on any machine. */
#include "starguard/animation.h"

#include <math.h>

#include "export/glb.h"
#include "export/little.h"
#include "mesh/single.h"

static const char STAGE[] = "animation";

typedef struct animation {
    const starg_mesh *mesh;
    const double *const *frames;
    size_t count, vertices, indices;
    double seconds, center[3];
    float lower[3], upper[3]; /* of the first frame, as written */
} animation;

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
        for (size_t i = 0; i < 3 * a->vertices; i++)
            if (!(fabs(a->frames[f][i] - a->center[i % 3]) < GLB_LIMIT))
                return starg_fail(context, STARG_ERROR_RANGE, STAGE,
                                  "a coordinate of frame %zu exceeds single precision", f);
    return STARG_OK;
}

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
    SCOPED_BY(starg_mesh_drop) starg_mesh *surface = NULL;
    char name[32];
    const single_place place = {.stage = STAGE, .what = name, .remedy = "frames as OFF keep it"};
    snprintf(name, sizeof name, "frame %zu", frame);
    NEW(context, STAGE, drawn, 3 * a->vertices);
    TRY(starg_mesh_create(context, a->frames[frame], a->vertices, starg_mesh_faces(a->mesh),
                          frame == 0 ? a->indices / 3 : 0, &surface));
    for (size_t i = 0; i < 3 * a->vertices; i++) {
        surface->vertices[i] -= a->center[i % 3];
        drawn[i] = (double)first_position(a, i) + (double)displacement(a, frame, i);
    }
    return single_compare(context, surface, drawn, &place);
}

static void find_box(animation *a) {
    for (size_t i = 0; i < 3 * a->vertices; i++) {
        float x = first_position(a, i);
        if (i < 3 || x < a->lower[i % 3])
            a->lower[i % 3] = x;
        if (i < 3 || x > a->upper[i % 3])
            a->upper[i % 3] = x;
    }
}

/* ---- description ---- */

/* Accessors: indices, positions, targets, times, weights, colours. */
static size_t accessors_of(const animation *a) {
    return a->count + (starg_mesh_colors(a->mesh) != NULL ? 4 : 3);
}

static bool has_vectors(const animation *a, size_t index) {
    return (index >= 1 && index <= a->count) || index == a->count + 3;
}

/* Number of values in accessor `index`. */
static size_t accessor_count(const animation *a, size_t index) {
    if (index == 0)
        return a->indices;
    if (has_vectors(a, index))
        return a->vertices;
    return index == a->count + 1 ? a->count : a->count * (a->count - 1);
}

static size_t accessor_bytes(const animation *a, size_t index) {
    return accessor_count(a, index) * (has_vectors(a, index) ? 12 : 4);
}

static size_t binary_bytes(const animation *a) {
    size_t sum = 0;
    for (size_t i = 0; i < accessors_of(a); i++)
        sum += accessor_bytes(a, i);
    return sum;
}

static json_t *accessor_json(const animation *a, size_t index) {
    json_t *json = json_pack(
        "{s:I, s:I, s:I, s:s}", "bufferView", (json_int_t)index, "componentType",
        (json_int_t)(index == 0 ? GLB_UNSIGNED_INT : GLB_FLOAT), "count",
        (json_int_t)accessor_count(a, index), "type", has_vectors(a, index) ? "VEC3" : "SCALAR");
    int failed = 0;
    if (index == 1)
        failed = json_object_set_new(json, "min",
                                     json_pack("[f, f, f]", (double)a->lower[0],
                                               (double)a->lower[1], (double)a->lower[2])) |
                 json_object_set_new(json, "max",
                                     json_pack("[f, f, f]", (double)a->upper[0],
                                               (double)a->upper[1], (double)a->upper[2]));
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
    if (!describe_numbers(a, accessors, views, targets) ||
        (starg_mesh_colors(a->mesh) != NULL &&
         json_object_set_new(attributes, "COLOR_0", json_integer((json_int_t)a->count + 3)) != 0)) {
        json_decref(attributes);
        json_decref(accessors);
        json_decref(views);
        json_decref(targets);
        return NULL;
    }
    size_t times = a->count + 1; /* accessor */
    return json_pack("{s:{s:s}, s:i, s:[{s:[i]}], s:[{s:i, s:[f, f, f]}],"
                     " s:[{s:[{s:o, s:i, s:o}]}], s:[{s:[{s:i, s:{s:i, s:s}}],"
                     " s:[{s:I, s:I, s:s}]}], s:o, s:o, s:[{s:I}]}",
                     "asset", "version", "2.0", "scene", 0, "scenes", "nodes", 0, "nodes", "mesh",
                     0, "translation", a->center[0], a->center[1], a->center[2], "meshes",
                     "primitives", "attributes", attributes, "indices", 0, "targets", targets,
                     "animations", "channels", "sampler", 0, "target", "node", 0, "path", "weights",
                     "samplers", "input", (json_int_t)times, "output", (json_int_t)times + 1,
                     "interpolation", "LINEAR", "accessors", accessors, "bufferViews", views,
                     "buffers", "byteLength", (json_int_t)binary_bytes(a));
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
        little_put_word(stream, starg_mesh_faces(a->mesh)[i]);
    for (size_t i = 0; i < 3 * a->vertices; i++)
        little_put_float(stream, first_position(a, i));
    for (size_t f = 1; f < a->count; f++)
        for (size_t i = 0; i < 3 * a->vertices; i++)
            little_put_float(stream, displacement(a, f, i));
    for (size_t f = 0; f < a->count; f++)
        little_put_float(stream, (float)(a->seconds * (double)f / (double)(a->count - 1)));
    for (size_t f = 0; f < a->count; f++)
        for (size_t target = 1; target < a->count; target++)
            little_put_float(stream, target == f ? 1 : 0);
    const uint8_t *colors = starg_mesh_colors(a->mesh);
    for (size_t i = 0; colors != NULL && i < 3 * a->vertices; i++)
        little_put_float(stream, light_of(colors[i]));
}

starg_status starg_animation_write(starg_context *context, const starg_mesh *mesh,
                                   const double *const *frames, size_t frame_count, double seconds,
                                   const char *path) {
    starg_status status = STARG_OK;
    json_t *json = NULL;
    animation a = {.mesh = mesh,
                   .frames = frames,
                   .count = frame_count,
                   .vertices = starg_mesh_vertex_count(mesh),
                   .indices = 3 * starg_mesh_face_count(mesh),
                   .seconds = seconds};
    STARG_TRY(check(context, &a));
    for (size_t f = 0; f < a.count; f++)
        STARG_TRY(check_frame(context, &a, f));
    find_box(&a);
    json = describe(&a);
    STARG_TRY(glb_write(context, STAGE, path, json, binary_bytes(&a), put_numbers, &a));
done:
    json_decref(json);
    return status;
}
