/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the frames of a morph from binary glTF 2.0 in the form written by animation.c: the first
 * primitive of the first mesh, whose positions are the first frame and whose morph targets are the
 * displacements of the others, relative to the first node's translation.
 *
 * Everything is checked against the available bytes; glTF files of another form (positions in
 * packed floats, triangles with indices) are rejected. Cost: linear. */
#include <math.h>

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "starguard/animation.h"

static const char STAGE[] = "animation file";

enum { GL_UNSIGNED_BYTE = 5121, GL_UNSIGNED_SHORT = 5123, GL_UNSIGNED_INT = 5125, GL_FLOAT = 5126 };
enum { HEADER = 12, CHUNK_HEADER = 8, GL_TRIANGLES = 4 };
#define JSON_CHUNK   0x4E4F534Au
#define BINARY_CHUNK 0x004E4942u

typedef struct reader {
    starg_context *context;
    const char *name;
    const uint8_t *binary;
    size_t binary_size;
    json_t *root, *primitive;
    double translation[3];
} reader;

/* Numbers of an accessor, within the binary chunk. */
typedef struct span {
    const uint8_t *at;
    size_t count; /* of its elements */
    json_int_t type;
} span;

static starg_status reject(const reader *r, const char *what) {
    return starg_fail(r->context, STARG_ERROR_FORMAT, STAGE, "'%s' is not a morph: %s", r->name,
                      what);
}

static uint32_t load_word(const uint8_t *at) {
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* ---- chunks ---- */

/* Returns a chunk of that type at `*at`, which advances behind it. */
static bool take_chunk(const uint8_t *bytes, size_t size, size_t *at, uint32_t type,
                       const uint8_t **chunk, size_t *length) {
    if (size - *at < CHUNK_HEADER || load_word(bytes + *at + 4) != type)
        return false;
    *length = load_word(bytes + *at);
    *at += CHUNK_HEADER;
    if (*length > size - *at)
        return false;
    *chunk = bytes + *at;
    *at += *length;
    return true;
}

static starg_status open_chunks(reader *r, const uint8_t *bytes, size_t size) {
    const uint8_t *text;
    size_t length, at = HEADER;
    if (size < HEADER || memcmp(bytes, "glTF", 4) != 0 || load_word(bytes + 4) != 2)
        return reject(r, "it is not binary glTF 2.0");
    if (!take_chunk(bytes, size, &at, JSON_CHUNK, &text, &length) ||
        !take_chunk(bytes, size, &at, BINARY_CHUNK, &r->binary, &r->binary_size))
        return reject(r, "it ends too early, or lacks a chunk");
    return starg_json_parse(r->context, STAGE, r->name, text, length, &r->root);
}

/* The integer under a key, `missing` if there is none, -1 if it is anything else. */

/* A whole number under a key, `missing` where there is none, -1 where it is something else. */
static json_int_t number(const json_t *object, const char *key, json_int_t missing) {
    const json_t *value = json_object_get(object, key);
    if (value == NULL)
        return missing;
    return json_is_integer(value) && json_integer_value(value) >= 0 ? json_integer_value(value)
                                                                    : -1;
}

static size_t bytes_of(json_int_t type) {
    return type == GL_UNSIGNED_BYTE ? 1 : type == GL_UNSIGNED_SHORT ? 2 : 4;
}

/* `parts` is the number of values per element. */
static starg_status open_accessor(const reader *r, json_int_t index, size_t parts, span *out) {
    const json_t *accessor =
        json_array_get(json_object_get(r->root, "accessors"), (size_t)(index < 0 ? -1 : index));
    json_int_t view_index = number(accessor, "bufferView", -1);
    const json_t *view = json_array_get(json_object_get(r->root, "bufferViews"),
                                        (size_t)(view_index < 0 ? -1 : view_index));
    json_int_t view_at = number(view, "byteOffset", 0), inner = number(accessor, "byteOffset", 0);
    json_int_t length = number(view, "byteLength", -1), count = number(accessor, "count", -1);
    out->type = number(accessor, "componentType", -1);
    size_t unit = parts * bytes_of(out->type), limit = r->binary_size;
    if (view_at < 0 || inner < 0 || length < 0 || count < 0 || (size_t)view_at > limit ||
        (size_t)length > limit - (size_t)view_at || inner > length ||
        (size_t)count > (size_t)(length - inner) / unit)
        return reject(r, "numbers are missing");
    if (json_object_get(accessor, "sparse") != NULL ||
        (number(view, "byteStride", (json_int_t)unit) != (json_int_t)unit))
        return reject(r, "its numbers are sparse or not packed");
    out->at = r->binary + view_at + inner;
    out->count = (size_t)count;
    return STARG_OK;
}

static double load_float(const uint8_t *at) {
    uint32_t word = load_word(at);
    float value;
    memcpy(&value, &word, sizeof value);
    return (double)value;
}

static uint32_t load_index(const span *s, size_t i) {
    const uint8_t *at = s->at + i * bytes_of(s->type);
    if (s->type == GL_UNSIGNED_BYTE)
        return at[0];
    return s->type == GL_UNSIGNED_SHORT ? (uint32_t)at[0] | (uint32_t)at[1] << 8 : load_word(at);
}

/* ---- frames ---- */

static starg_status find_primitive(reader *r) {
    json_t *mesh = json_array_get(json_object_get(r->root, "meshes"), 0);
    const json_t *node = json_array_get(json_object_get(r->root, "nodes"), 0);
    const json_t *translation = json_object_get(node, "translation");
    r->primitive = json_array_get(json_object_get(mesh, "primitives"), 0);
    if (r->primitive == NULL || number(r->primitive, "mode", GL_TRIANGLES) != GL_TRIANGLES)
        return reject(r, "it has no mesh of triangles");
    for (size_t k = 0; k < 3; k++)
        r->translation[k] = json_number_value(json_array_get(translation, k));
    return STARG_OK;
}

static starg_status read_faces(const reader *r, uint32_t **faces, size_t *count) {
    span indices = {0};
    TRY(open_accessor(r, number(r->primitive, "indices", -1), 1, &indices));
    if (indices.type == GL_FLOAT || indices.count == 0 || indices.count % 3 != 0)
        return reject(r, "its indices are not those of triangles");
    NEW(r->context, STAGE, *faces, indices.count);
    for (size_t i = 0; i < indices.count; i++)
        (*faces)[i] = load_index(&indices, i);
    *count = indices.count / 3;
    return STARG_OK;
}

static starg_status open_positions(const reader *r, const json_t *attributes, span *out) {
    starg_status status = open_accessor(r, number(attributes, "POSITION", -1), 3, out);
    if (status == STARG_OK && out->type != GL_FLOAT)
        return reject(r, "its positions are not floats");
    return status;
}

/* Writes frame `index` to `points`; `first` are the positions of frame 0. */
static starg_status read_points(const reader *r, const span *first, size_t index, double *points) {
    span target = {0};
    const json_t *targets = json_object_get(r->primitive, "targets");
    if (index > 0)
        TRY(open_positions(r, json_array_get(targets, index - 1), &target));
    if (index > 0 && target.count != first->count)
        return reject(r, "a target has another number of vertices");
    for (size_t i = 0; i < 3 * first->count; i++) {
        points[i] = load_float(first->at + 4 * i) + r->translation[i % 3];
        if (index > 0)
            points[i] += load_float(target.at + 4 * i);
    }
    return STARG_OK;
}

static starg_status read_frames(reader *r, starg_mesh ***out, size_t *frame_count) {
    starg_status status = STARG_OK;
    starg_mesh **frames = NULL;
    uint32_t *faces = NULL;
    double *points = NULL;
    span first = {0};
    size_t face_count = 0, count = 0;
    STARG_TRY(find_primitive(r));
    STARG_TRY(open_positions(r, json_object_get(r->primitive, "attributes"), &first));
    STARG_TRY(read_faces(r, &faces, &face_count));
    count = 1 + json_array_size(json_object_get(r->primitive, "targets"));
    if (count < 2 || count > STARG_ANIMATION_FRAMES) {
        status = reject(r, "it has no morph targets, or too many");
        goto done;
    }
    frames = starg_allocate_zero(r->context, count, sizeof(starg_mesh *));
    if (frames == NULL) {
        status = starg_fail_memory(r->context, STAGE);
        goto done;
    }
    STARG_NEW(r->context, STAGE, points, 3 * first.count);
    for (size_t i = 0; i < count; i++) {
        STARG_TRY(starg_check_cancel(r->context, STAGE));
        STARG_TRY(read_points(r, &first, i, points));
        STARG_TRY(
            starg_mesh_create(r->context, points, first.count, faces, face_count, &frames[i]));
    }
    *out = frames;
    *frame_count = count;
done:
    RELEASE(faces, points);
    if (status != STARG_OK && frames != NULL)
        starg_animation_free(r->context, frames, count);
    return status;
}

starg_status starg_animation_read_memory(starg_context *context, const void *bytes, size_t size,
                                         const char *name, starg_mesh ***frames, size_t *count) {
    starg_status status = STARG_OK;
    reader r = {.context = context, .name = name};
    *frames = NULL;
    *count = 0;
    STARG_TRY(open_chunks(&r, bytes, size));
    STARG_TRY(read_frames(&r, frames, count));
done:
    json_decref(r.root);
    return status;
}

starg_status starg_animation_read(starg_context *context, const char *path, starg_mesh ***frames,
                                  size_t *count) {
    SCOPED char *bytes = NULL;
    size_t size;
    *frames = NULL;
    *count = 0;
    TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    return starg_animation_read_memory(context, bytes, size, path, frames, count);
}

void starg_animation_free(starg_context *context, starg_mesh **frames, size_t count) {
    for (size_t i = 0; i < count; i++)
        starg_mesh_free(frames[i]);
    starg_release(context, frames);
}
