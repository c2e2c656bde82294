/* GUARDS.json: the result of guarding as text (docs/formats.md). One line a key, one line a guard;
 * reals with 17 significant digits, so that reading gives back the same doubles. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "starguard/guard.h"

static const char STAGE[] = "guards file";
static const char FORMAT[] = "starguard-guards";
enum { VERSION = 1 };

static const char *const METHODS[] = {"ilp", "greedy", "pilp"};
static const char *const CANDIDATES[] = {"medial", "interior", "given", "skeleton"};
static const char *const TARGETS[] = {"faces", "vertices"};
static const char *const FACE_RULES[] = {"vertices", "whole"};

static json_t *real_or_null(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *step_or_null(size_t step) {
    return step == STARG_QUARTERS ? json_null() : json_integer((json_int_t)step);
}

static int set(json_t *object, const char *key, json_t *value) {
    return json_object_set_new(object, key, value);
}

static json_t *options_json(const starg_guard_options *o) {
    json_t *json =
        json_pack("{s:s, s:s, s:I, s:s, s:s, s:f, s:I, s:o, s:o, s:I, s:f}", "method",
                  METHODS[o->method], "candidates", CANDIDATES[o->candidates], "count",
                  (json_int_t)o->candidate_count, "target", TARGETS[o->visibility.target], "faces",
                  FACE_RULES[o->visibility.face_rule], "coverage", o->coverage, "max_guards",
                  (json_int_t)o->max_guards, "range", real_or_null(o->visibility.range), "cone",
                  o->visibility.cone < 360 ? json_real(o->visibility.cone) : json_null(),
                  "redundancy", (json_int_t)o->redundancy, "clearance", o->clearance);
    if (json == NULL || o->method != STARG_GUARD_PILP)
        return json;
    int failed = set(json, "coarsest", json_integer((json_int_t)o->coarsest)) |
                 set(json, "step", step_or_null(o->step)) |
                 set(json, "significance", json_real(o->significance)) |
                 set(json, "refine", json_boolean(o->refine));
    if (failed == 0)
        return json;
    json_decref(json);
    return NULL;
}

static json_t *index_list(const uint32_t *items, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count && list != NULL; i++)
        if (json_array_append_new(list, json_integer(items[i])) != 0) {
            json_decref(list);
            list = NULL;
        }
    return list;
}

/* Adds a value that is consumed to a list; the list is freed and NULL when that fails. */
static json_t *append(json_t *list, json_t *value) {
    if (json_array_append_new(list, value) == 0)
        return list;
    json_decref(list);
    return NULL;
}

/* What the first guards see, for each number of them: pairs of fractions, of faces and of area. */
static json_t *curve_json(const starg_guards *g) {
    json_t *list = json_array();
    for (size_t i = 0; i < g->count && list != NULL; i++)
        list = append(list, json_pack("[f, f]", g->curve_faces[i], g->curve_area[i]));
    return list;
}

static json_t *level_json(const starg_guard_level *level) {
    json_t *list = json_array();
    for (size_t i = 0; i < level->count && list != NULL; i++) {
        const double *p = level->positions + 3 * i;
        list = append(list, json_pack("[f, f, f]", p[0], p[1], p[2]));
    }
    return json_pack("{s:I, s:I, s:I, s:o}", "vertices", (json_int_t)level->vertex_count, "faces",
                     (json_int_t)level->face_count, "kept", (json_int_t)level->kept, "guards",
                     list);
}

static json_t *levels_json(const starg_guards *g) {
    json_t *list = json_array();
    for (size_t i = 0; i < g->level_count && list != NULL; i++)
        list = append(list, level_json(&g->level_list[i]));
    return list;
}

static json_t *coverage_json(const starg_guards *g) {
    json_t *coverage =
        json_pack("{s:f, s:f, s:I, s:o}", "faces", g->coverage_faces, "area", g->coverage_area,
                  "coverable_faces", (json_int_t)g->coverable_faces, "uncovered_faces",
                  index_list(g->uncovered, g->uncovered_count));
    if (coverage == NULL)
        return NULL;
    int failed = set(coverage, "curve", curve_json(g));
    if (g->options.visibility.target == STARG_TARGET_VERTICES) {
        failed |= set(coverage, "vertices", json_real(g->coverage_vertices));
        failed |=
            set(coverage, "coverable_vertices", json_integer((json_int_t)g->coverable_vertices));
        failed |= set(coverage, "uncovered_vertices",
                      index_list(g->uncovered_vertices, g->uncovered_vertex_count));
    }
    if (g->options.max_guards > 0)
        failed |= set(coverage, "area_bound", json_real(g->area_bound));
    if (failed == 0)
        return coverage;
    json_decref(coverage);
    return NULL;
}

static json_t *guard_json(const starg_guards *g, size_t i) {
    const double *p = g->positions + 3 * i;
    json_t *guard = json_pack("{s:[f, f, f], s:I, s:i}", "position", p[0], p[1], p[2], "faces",
                              (json_int_t)g->seen_faces[i], "level", g->levels[i]);
    if (g->directions == NULL || guard == NULL)
        return guard;
    const double *d = g->directions + 3 * i;
    if (set(guard, "direction", json_pack("[f, f, f]", d[0], d[1], d[2])) == 0)
        return guard;
    json_decref(guard);
    return NULL;
}

static bool put_all(FILE *stream, const void *result, const char *model_file) {
    const starg_guards *g = result;
    json_t *model = json_pack("{s:s?, s:I, s:I}", "file", model_file, "vertices",
                              (json_int_t)g->vertex_count, "faces", (json_int_t)g->face_count);
    bool done =
        starg_json_put(stream, "{\n\"format\": ", json_string(FORMAT), ",\n") &&
        starg_json_put(stream, "\"version\": ", json_integer(VERSION), ",\n") &&
        starg_json_put(stream, "\"model\": ", model, ",\n") &&
        starg_json_put(stream, "\"options\": ", options_json(&g->options), ",\n\"guards\": [\n");
    for (size_t i = 0; i < g->count && done; i++)
        done = starg_json_put(stream, "", guard_json(g, i), i + 1 < g->count ? ",\n" : "\n");
    fputs("],\n", stream);
    if (g->level_count > 0)
        done = done && starg_json_put(stream, "\"levels\": ", levels_json(g), ",\n");
    return done && starg_json_put(stream, "\"coverage\": ", coverage_json(g), ",\n") &&
           starg_json_put(stream, "\"candidates\": ", json_integer((json_int_t)g->candidate_count),
                          ",\n") &&
           starg_json_put(stream, "\"lower_bound\": ", json_integer((json_int_t)g->lower_bound),
                          ",\n") &&
           starg_json_put(stream, "\"optimal\": ", json_boolean(g->optimal), ",\n") &&
           starg_json_put(stream, "\"time_limited\": ", json_boolean(g->time_limited), "\n}\n");
}

starg_status starg_guards_write(starg_context *context, const starg_guards *guards,
                                const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put_all, guards, model_file);
}

/* A reader in the middle of a file: the first thing that does not fit ends it. */
typedef struct json_reader {
    starg_context *context;
    const char *path;
    starg_status status;
} json_reader;

static void reject(json_reader *r, const char *what) {
    if (r->status == STARG_OK)
        r->status = starg_fail(r->context, STARG_ERROR_FORMAT, STAGE,
                               "'%s' is no valid guards file: %s", r->path, what);
}

static json_t *member(json_reader *r, json_t *object, const char *key) {
    json_t *value = json_object_get(object, key);
    char text[128];
    if (value != NULL)
        return value;
    snprintf(text, sizeof text, "key \"%s\" is missing", key);
    reject(r, text);
    return NULL;
}

static void reject_key(json_reader *r, const char *key, const char *expected) {
    char text[128];
    snprintf(text, sizeof text, "\"%s\" must be %s", key, expected);
    reject(r, text);
}

static size_t read_count(json_reader *r, json_t *object, const char *key) {
    json_t *value = member(r, object, key);
    if (value == NULL)
        return 0;
    if (!json_is_integer(value) || json_integer_value(value) < 0) {
        reject_key(r, key, "a whole number, zero or more");
        return 0;
    }
    return (size_t)json_integer_value(value);
}

static double read_real(json_reader *r, json_t *object, const char *key) {
    json_t *value = member(r, object, key);
    if (value == NULL)
        return 0;
    if (!json_is_number(value)) {
        reject_key(r, key, "a number");
        return 0;
    }
    return json_number_value(value);
}

static bool read_bool(json_reader *r, json_t *object, const char *key) {
    json_t *value = member(r, object, key);
    if (value != NULL && !json_is_boolean(value))
        reject_key(r, key, "true or false");
    return json_is_true(value);
}

static int read_name(json_reader *r, json_t *object, const char *key, const char *const *names,
                     int count) {
    json_t *value = member(r, object, key);
    for (int i = 0; i < count && value != NULL; i++)
        if (json_is_string(value) && strcmp(json_string_value(value), names[i]) == 0)
            return i;
    if (value != NULL)
        reject_key(r, key, "one of the names that docs/formats.md lists");
    return 0;
}

static void read_options(json_reader *r, json_t *object, starg_guard_options *o) {
    starg_guard_options_default(o);
    if (!json_is_object(object)) {
        reject(r, "\"options\" must be an object");
        return;
    }
    o->method = (starg_guard_method)read_name(r, object, "method", METHODS, 3);
    o->candidates = (starg_candidates)read_name(r, object, "candidates", CANDIDATES, 4);
    o->candidate_count = read_count(r, object, "count");
    o->visibility.target = (starg_target)read_name(r, object, "target", TARGETS, 2);
    o->visibility.face_rule = (starg_face_rule)read_name(r, object, "faces", FACE_RULES, 2);
    o->coverage = read_real(r, object, "coverage");
    o->max_guards = read_count(r, object, "max_guards");
    o->redundancy = (uint32_t)read_count(r, object, "redundancy");
    o->clearance = read_real(r, object, "clearance");
    if (!json_is_null(json_object_get(object, "range")))
        o->visibility.range = read_real(r, object, "range");
    if (json_is_number(json_object_get(object, "cone")))
        o->visibility.cone = read_real(r, object, "cone");
    if (!(o->visibility.cone > 0 && o->visibility.cone <= 360))
        reject(r, "\"cone\" must be above 0 and at most 360, or null");
    if (!(o->visibility.range >= 0) || !(o->clearance >= 0))
        reject(r, "\"range\" and \"clearance\" must not be negative");
}

/* An array of three numbers below 1e100. */
static void read_triple(json_reader *r, json_t *array, const char *key, double out[3]) {
    bool good = json_is_array(array) && json_array_size(array) == 3;
    for (size_t k = 0; k < 3 && good; k++) {
        json_t *x = json_array_get(array, k);
        good = json_is_number(x) && fabs(json_number_value(x)) < 1e100;
        if (good)
            out[k] = json_number_value(x);
    }
    if (!good)
        reject_key(r, key, "an array of three numbers below 1e100");
}

static void read_guard(json_reader *r, json_t *object, starg_guards *g, size_t i) {
    read_triple(r, json_object_get(object, "position"), "position", g->positions + 3 * i);
    if (g->directions != NULL)
        read_triple(r, json_object_get(object, "direction"), "direction", g->directions + 3 * i);
    g->seen_faces[i] = read_count(r, object, "faces");
    g->levels[i] = (int)read_count(r, object, "level");
}

static void read_guards(json_reader *r, json_t *list, starg_guards *g) {
    starg_status status = STARG_OK;
    if (!json_is_array(list)) {
        reject(r, "\"guards\" must be an array");
        return;
    }
    g->count = json_array_size(list);
    STARG_NEW(r->context, STAGE, g->positions, 3 * g->count);
    if (g->options.visibility.cone < 360)
        STARG_NEW_ZERO(r->context, STAGE, g->directions, 3 * g->count);
    STARG_NEW(r->context, STAGE, g->seen_faces, g->count);
    STARG_NEW(r->context, STAGE, g->levels, g->count);
    for (size_t i = 0; i < g->count; i++)
        read_guard(r, json_array_get(list, i), g, i);
done:
    if (status != STARG_OK)
        r->status = status;
}

/* A list of ascending indices below `limit`. */
static void read_list(json_reader *r, json_t *object, const char *key, size_t limit,
                      uint32_t **items, size_t *count) {
    starg_status status = STARG_OK;
    json_t *list = member(r, object, key);
    if (!json_is_array(list)) {
        reject_key(r, key, "an array of indices");
        return;
    }
    *count = json_array_size(list);
    STARG_NEW(r->context, STAGE, *items, *count);
    for (size_t i = 0; i < *count; i++) {
        json_t *item = json_array_get(list, i);
        json_int_t value = json_is_integer(item) ? json_integer_value(item) : -1;
        if (value < 0 || (size_t)value >= limit || (i > 0 && value <= (*items)[i - 1])) {
            reject_key(r, key, "an array of ascending indices of the model");
            break;
        }
        (*items)[i] = (uint32_t)value;
    }
done:
    if (status != STARG_OK)
        r->status = status;
}

/* The curve, which files of earlier versions of this program lack: it stays NULL then. */
static void read_curve(json_reader *r, json_t *list, starg_guards *g) {
    starg_status status = STARG_OK;
    if (list == NULL)
        return;
    if (!json_is_array(list) || json_array_size(list) != g->count) {
        reject_key(r, "curve", "an array of a pair for each guard");
        return;
    }
    STARG_NEW_ZERO(r->context, STAGE, g->curve_faces, g->count);
    STARG_NEW_ZERO(r->context, STAGE, g->curve_area, g->count);
    for (size_t i = 0; i < g->count; i++) {
        json_t *pair = json_array_get(list, i);
        json_t *faces = json_array_get(pair, 0), *area = json_array_get(pair, 1);
        if (!json_is_number(faces) || !json_is_number(area))
            reject_key(r, "curve", "an array of pairs of fractions");
        g->curve_faces[i] = json_number_value(faces);
        g->curve_area[i] = json_number_value(area);
    }
done:
    if (status != STARG_OK)
        r->status = status;
}

static void read_level(json_reader *r, json_t *object, starg_guard_level *level) {
    starg_status status = STARG_OK;
    json_t *list = json_object_get(object, "guards");
    level->vertex_count = read_count(r, object, "vertices");
    level->face_count = read_count(r, object, "faces");
    level->kept = read_count(r, object, "kept");
    STARG_NEW_ZERO(r->context, STAGE, level->positions, 3 * json_array_size(list));
    level->count = json_array_size(list);
    for (size_t i = 0; i < level->count; i++)
        read_triple(r, json_array_get(list, i), "guards", level->positions + 3 * i);
    if (level->kept > level->count)
        reject_key(r, "kept", "at most the number of guards of its level");
done:
    if (status != STARG_OK)
        r->status = status;
}

static void read_levels(json_reader *r, json_t *list, starg_guards *g) {
    starg_status status = STARG_OK;
    if (list == NULL)
        return;
    if (!json_is_array(list)) {
        reject(r, "\"levels\" must be an array");
        return;
    }
    STARG_NEW_ZERO(r->context, STAGE, g->level_list, json_array_size(list));
    g->level_count = json_array_size(list);
    for (size_t i = 0; i < g->level_count; i++)
        read_level(r, json_array_get(list, i), &g->level_list[i]);
done:
    if (status != STARG_OK)
        r->status = status;
}

static void read_coverage(json_reader *r, json_t *object, starg_guards *g) {
    if (!json_is_object(object)) {
        reject(r, "\"coverage\" must be an object");
        return;
    }
    g->coverage_faces = read_real(r, object, "faces");
    g->coverage_area = read_real(r, object, "area");
    g->coverable_faces = read_count(r, object, "coverable_faces");
    read_list(r, object, "uncovered_faces", g->face_count, &g->uncovered, &g->uncovered_count);
    read_curve(r, json_object_get(object, "curve"), g);
    g->area_bound = 1;
    if (g->options.max_guards > 0)
        g->area_bound = read_real(r, object, "area_bound");
    if (g->options.visibility.target == STARG_TARGET_VERTICES) {
        g->coverage_vertices = read_real(r, object, "vertices");
        g->coverable_vertices = read_count(r, object, "coverable_vertices");
        read_list(r, object, "uncovered_vertices", g->vertex_count, &g->uncovered_vertices,
                  &g->uncovered_vertex_count);
    }
}

static void read_model(json_reader *r, json_t *object, starg_guards *g) {
    json_t *file = json_object_get(object, "file");
    if (!json_is_object(object)) {
        reject(r, "\"model\" must be an object");
        return;
    }
    g->vertex_count = read_count(r, object, "vertices");
    g->face_count = read_count(r, object, "faces");
    if (!json_is_string(file))
        return;
    size_t length = strlen(json_string_value(file));
    g->file = starg_allocate(r->context, length + 1, 1);
    if (g->file == NULL)
        r->status = starg_fail_memory(r->context, STAGE);
    else
        memcpy(g->file, json_string_value(file), length + 1);
}

static void read_document(json_reader *r, json_t *root, starg_guards *g) {
    json_t *format = json_object_get(root, "format");
    if (!json_is_string(format) || strcmp(json_string_value(format), FORMAT) != 0) {
        reject(r, "its \"format\" is not \"starguard-guards\"");
        return;
    }
    if (read_count(r, root, "version") != VERSION) {
        reject(r, "its \"version\" is not 1, the only one that is known");
        return;
    }
    read_model(r, json_object_get(root, "model"), g);
    read_options(r, json_object_get(root, "options"), &g->options);
    read_guards(r, json_object_get(root, "guards"), g);
    read_levels(r, json_object_get(root, "levels"), g);
    read_coverage(r, json_object_get(root, "coverage"), g);
    g->candidate_count = read_count(r, root, "candidates");
    g->lower_bound = read_count(r, root, "lower_bound");
    g->optimal = read_bool(r, root, "optimal");
    g->time_limited = json_is_true(json_object_get(root, "time_limited"));
}

starg_status starg_guards_read_memory(starg_context *context, const void *bytes, size_t size,
                                      const char *name, starg_guards **out) {
    starg_status status = STARG_OK;
    json_reader reader = {context, name, STARG_OK};
    starg_guards *guards = NULL;
    json_t *root = NULL;
    *out = NULL;
    STARG_TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    STARG_NEW_ZERO(context, STAGE, guards, 1);
    read_document(&reader, root, guards);
    STARG_TRY(reader.status);
    *out = guards;
done:
    json_decref(root);
    if (status != STARG_OK)
        starg_guards_free(context, guards);
    return status;
}

starg_status starg_guards_read(starg_context *context, const char *path, starg_guards **out) {
    char *bytes = NULL;
    size_t size;
    *out = NULL;
    starg_status status = starg_file_read(context, STAGE, path, &bytes, &size);
    if (status == STARG_OK)
        status = starg_guards_read_memory(context, bytes, size, path, out);
    starg_release(context, bytes);
    return status;
}
