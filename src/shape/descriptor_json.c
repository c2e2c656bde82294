/* DESCRIPTOR.json: a descriptor as text (docs/formats.md). One line a key, one line a guard; reals
 * with 17 significant digits, so that reading gives back the same doubles. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "mesh/mesh.h"
#include "starguard/descriptor.h"

static const char STAGE[] = "descriptor file";
static const char FORMAT[] = "starguard-descriptor";
enum {
    VERSION = 4,
    OLDEST = 3, /* with a spectrum more, which nothing uses */
    VIEWS = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
    WAVES = STARG_DESCRIPTOR_ENERGIES * STARG_DESCRIPTOR_SPREAD,
    EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES
};

/* ---- writing ---- */

static json_t *numbers_json(const double *numbers, size_t count) {
    json_t *array = json_array();
    int failed = array == NULL;
    for (size_t i = 0; i < count && !failed; i++)
        failed = json_array_append_new(array, json_real(numbers[i]));
    if (failed) {
        json_decref(array);
        return NULL;
    }
    return array;
}

static bool put_numbers(FILE *stream, const char *key, const double *numbers, size_t count) {
    return fprintf(stream, "\"%s\": ", key) > 0 &&
           starg_json_put(stream, "", numbers_json(numbers, count), ",\n");
}

static json_t *guard_json(const starg_descriptor *d, size_t i) {
    const starg_descriptor_guard *g = &d->guards[i];
    json_t *distances = numbers_json(d->distances + i * d->direction_count, d->direction_count);
    if (distances == NULL)
        return NULL;
    return json_pack("{s:[f, f, f], s:f, s:o}", "position", g->position[0], g->position[1],
                     g->position[2], "volume", g->volume, "distances", distances);
}

static json_t *edge_json(const starg_descriptor_edge *e) {
    return json_pack("{s:[I, I], s:f, s:[f, f, f]}", "guards", (json_int_t)e->first,
                     (json_int_t)e->second, "area", e->area, "gate", e->gate[0], e->gate[1],
                     e->gate[2]);
}

static bool put_head(FILE *stream, const starg_descriptor *d, const char *file) {
    json_t *model =
        json_pack("{s:s?, s:I, s:I, s:f}", "file", file, "vertices", (json_int_t)d->model_vertices,
                  "faces", (json_int_t)d->model_faces, "diagonal", d->diagonal);
    return starg_json_put(stream, "{\n\"format\": ", json_string(FORMAT), ",\n") &&
           starg_json_put(stream, "\"version\": ", json_integer(VERSION), ",\n") &&
           starg_json_put(stream, "\"model\": ", model, ",\n") &&
           starg_json_put(stream, "\"detail\": ", json_integer((json_int_t)d->detail), ",\n") &&
           starg_json_put(stream, "\"effort\": ", json_integer((json_int_t)d->effort), ",\n") &&
           starg_json_put(stream, "\"time_limited\": ", json_boolean(d->time_limited), ",\n") &&
           starg_json_put(stream, "\"directions\": ", json_integer((json_int_t)d->direction_count),
                          ",\n") &&
           put_numbers(stream, "views", &d->views[0][0], VIEWS) &&
           put_numbers(stream, "surface_spectrum", d->surface_spectrum, EIGENVALUES) &&
           put_numbers(stream, "waves", &d->waves[0][0], WAVES);
}

static bool put_all(FILE *stream, const void *result, const char *file) {
    const starg_descriptor *d = result;
    bool done = put_head(stream, d, file);
    fputs("\"guards\": [\n", stream);
    for (size_t i = 0; i < d->guard_count && done; i++)
        done = starg_json_put(stream, "", guard_json(d, i), i + 1 < d->guard_count ? ",\n" : "\n");
    fputs("],\n\"edges\": [\n", stream);
    for (size_t i = 0; i < d->edge_count && done; i++)
        done = starg_json_put(stream, "", edge_json(&d->edges[i]),
                              i + 1 < d->edge_count ? ",\n" : "\n");
    fputs("]\n}\n", stream);
    return done;
}

starg_status starg_descriptor_write(starg_context *context, const starg_descriptor *descriptor,
                                    const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put_all, descriptor, model_file);
}

/* ---- reading ---- */

bool starg_descriptor_recognized(const void *bytes, size_t size) {
    const char *text = bytes;
    size_t i = 0;
    while (i < size && strchr(" \t\r\n", text[i]) != NULL && text[i] != '\0')
        i++;
    return i < size && text[i] == '{';
}

/* A reader in the middle of a file: the first thing that does not fit ends it. */
typedef struct json_reader {
    starg_context *context;
    const char *path;
    starg_descriptor *result;
} json_reader;

static starg_status reject(const json_reader *r, const char *key, const char *expected) {
    return starg_fail(r->context, STARG_ERROR_FORMAT, STAGE,
                      "'%s' is no valid descriptor: \"%s\" must be %s", r->path, key, expected);
}

static starg_status read_count(const json_reader *r, json_t *object, const char *key, size_t most,
                               size_t *out) {
    json_t *value = json_object_get(object, key);
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || (uint64_t)number > most)
        return reject(r, key, "a whole number, zero or more");
    *out = (size_t)number;
    return STARG_OK;
}

/* A length, area or volume: finite and not negative. */
static starg_status read_size(const json_reader *r, json_t *object, const char *key, double *out) {
    json_t *value = json_object_get(object, key);
    *out = json_is_number(value) ? json_number_value(value) : -1;
    return *out >= 0 && isfinite(*out) ? STARG_OK : reject(r, key, "a finite number, zero or more");
}

static starg_status read_point(const json_reader *r, json_t *object, const char *key,
                               double out[3]) {
    json_t *array = json_object_get(object, key);
    bool good = json_array_size(array) == 3;
    for (size_t k = 0; k < 3 && good; k++) {
        json_t *x = json_array_get(array, k);
        good = json_is_number(x) && fabs(json_number_value(x)) < STARG_COORDINATE_LIMIT;
        out[k] = json_number_value(x);
    }
    return good ? STARG_OK : reject(r, key, "an array of three numbers below 1e100");
}

static starg_status read_numbers(const json_reader *r, json_t *object, const char *key,
                                 size_t count, double *out) {
    json_t *array = json_object_get(object, key);
    bool good = json_array_size(array) == count;
    for (size_t k = 0; k < count && good; k++) {
        json_t *x = json_array_get(array, k);
        out[k] = json_is_number(x) ? json_number_value(x) : -1;
        good = out[k] >= 0 && isfinite(out[k]);
    }
    return good ? STARG_OK
                : reject(r, key,
                         "an array of finite numbers, zero or more, as many as the format "
                         "says");
}

static starg_status read_guard(const json_reader *r, json_t *object, size_t i) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    json_t *distances = json_object_get(object, "distances");
    STARG_TRY(read_point(r, object, "position", d->guards[i].position));
    STARG_TRY(read_size(r, object, "volume", &d->guards[i].volume));
    if (json_array_size(distances) != d->direction_count)
        return reject(r, "distances", "an array of a number for each direction");
    for (size_t k = 0; k < d->direction_count; k++) {
        json_t *x = json_array_get(distances, k);
        double *distance = &d->distances[i * d->direction_count + k];
        *distance = json_is_number(x) ? json_number_value(x) : -1;
        if (!(*distance >= 0 && *distance < 4 * STARG_COORDINATE_LIMIT))
            return reject(r, "distances", "an array of finite numbers, zero or more");
    }
done:
    return status;
}

static starg_status read_guards(const json_reader *r, json_t *root) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    json_t *list = json_object_get(root, "guards");
    size_t count = json_array_size(list);
    if (count == 0)
        return reject(r, "guards", "an array of at least one guard");
    if (json_array_size(json_object_get(json_array_get(list, 0), "distances")) !=
        d->direction_count)
        return reject(r, "distances", "an array of a number for each direction");
    STARG_NEW_ZERO(r->context, STAGE, d->guards, count);
    STARG_NEW_ZERO(r->context, STAGE, d->distances, count * d->direction_count);
    d->guard_count = count;
    for (size_t i = 0; i < count; i++)
        STARG_TRY(read_guard(r, json_array_get(list, i), i));
done:
    return status;
}

static starg_status read_edge(const json_reader *r, json_t *object, size_t i) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    starg_descriptor_edge *e = &d->edges[i];
    json_t *ends = json_object_get(object, "guards");
    json_t *first = json_array_get(ends, 0), *second = json_array_get(ends, 1);
    bool good = json_array_size(ends) == 2 && json_is_integer(first) && json_is_integer(second) &&
                json_integer_value(first) >= 0 &&
                json_integer_value(first) < json_integer_value(second) &&
                (uint64_t)json_integer_value(second) < d->guard_count;
    if (good) {
        e->first = (uint32_t)json_integer_value(first);
        e->second = (uint32_t)json_integer_value(second);
        good = i == 0 || e[-1].first < e->first ||
               (e[-1].first == e->first && e[-1].second < e->second);
    }
    if (!good)
        return reject(r, "guards", "two ascending guards in each edge, edges ascending");
    STARG_TRY(read_size(r, object, "area", &e->area));
    STARG_TRY(read_point(r, object, "gate", e->gate));
done:
    return status;
}

static starg_status read_edges(const json_reader *r, json_t *root) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    json_t *list = json_object_get(root, "edges");
    if (!json_is_array(list))
        return reject(r, "edges", "an array");
    STARG_NEW_ZERO(r->context, STAGE, d->edges, json_array_size(list));
    d->edge_count = json_array_size(list);
    for (size_t i = 0; i < d->edge_count; i++)
        STARG_TRY(read_edge(r, json_array_get(list, i), i));
done:
    return status;
}

static starg_status read_model(const json_reader *r, json_t *root) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    json_t *model = json_object_get(root, "model");
    const char *file = json_string_value(json_object_get(model, "file"));
    STARG_TRY(read_count(r, model, "vertices", STARG_MESH_LIMIT, &d->model_vertices));
    STARG_TRY(read_count(r, model, "faces", STARG_MESH_LIMIT, &d->model_faces));
    STARG_TRY(read_size(r, model, "diagonal", &d->diagonal));
    if (file == NULL)
        goto done;
    STARG_NEW(r->context, STAGE, d->file, strlen(file) + 1);
    memcpy(d->file, file, strlen(file) + 1);
done:
    return status;
}

static starg_status read_document(const json_reader *r, json_t *root) {
    starg_status status = STARG_OK;
    starg_descriptor *d = r->result;
    const char *format = json_string_value(json_object_get(root, "format"));
    size_t version = 0, effort = 0;
    if (format == NULL || strcmp(format, FORMAT) != 0)
        return reject(r, "format", "\"starguard-descriptor\"");
    STARG_TRY(read_count(r, root, "version", SIZE_MAX, &version));
    if (version < OLDEST || version > VERSION)
        return reject(r, "version",
                      "3 or 4, which are all that are known; describe the model anew with this "
                      "program");
    STARG_TRY(read_model(r, root));
    STARG_TRY(read_count(r, root, "detail", STARG_MESH_LIMIT, &d->detail));
    STARG_TRY(read_count(r, root, "effort", SIZE_MAX, &effort));
    d->effort = effort;
    d->time_limited = json_is_true(json_object_get(root, "time_limited"));
    STARG_TRY(read_count(r, root, "directions", UINT32_MAX, &d->direction_count));
    STARG_TRY(read_numbers(r, root, "views", VIEWS, &d->views[0][0]));
    STARG_TRY(read_numbers(r, root, "surface_spectrum", EIGENVALUES, d->surface_spectrum));
    STARG_TRY(read_numbers(r, root, "waves", WAVES, &d->waves[0][0]));
    STARG_TRY(read_guards(r, root));
    STARG_TRY(read_edges(r, root));
done:
    return status;
}

starg_status starg_descriptor_read_memory(starg_context *context, const void *bytes, size_t size,
                                          const char *name, starg_descriptor **out) {
    starg_status status = STARG_OK;
    json_reader reader = {.context = context, .path = name};
    json_t *root = NULL;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, reader.result, 1);
    STARG_TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    STARG_TRY(read_document(&reader, root));
    *out = reader.result;
done:
    json_decref(root);
    if (status != STARG_OK)
        starg_descriptor_free(context, reader.result);
    return status;
}

starg_status starg_descriptor_read(starg_context *context, const char *path,
                                   starg_descriptor **out) {
    starg_status status = STARG_OK;
    char *bytes = NULL;
    size_t size;
    *out = NULL;
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_descriptor_read_memory(context, bytes, size, path, out));
done:
    starg_release(context, bytes);
    return status;
}
