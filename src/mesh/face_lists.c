/* SPDX-License-Identifier: Apache-2.0 */
/* Faces and weights of faces from text files, and by names in the file of the model. */
#include <math.h>
#include <stdio.h>

#include "mesh/formats/scan.h"
#include "starguard/space.h"

static const char STAGE[] = "face list";

typedef struct face_reader {
    starg_scan scan;
    size_t count; /* numbers so far */
    size_t face_count;
    double *values; /* by face */
} face_reader;

typedef starg_status take_word(face_reader *r, starg_word word);

/* A face of which the value is to be 1. */
static starg_status take_face(face_reader *r, starg_word word) {
    int64_t face;
    TRY(starg_word_integer(&r->scan, word, "a face number", &face));
    if (face < 0 || (uint64_t)face >= r->face_count)
        return starg_source_fail(r->scan.source, starg_at_line(word.line),
                                 "there is no face %lld; the model has the faces 0 to %zu",
                                 (long long)face, r->face_count - 1);
    r->values[face] = 1;
    r->count++;
    return STARG_OK;
}

/* The value of the next face. */
static starg_status take_weight(face_reader *r, starg_word word) {
    double weight;
    TRY(starg_word_real(&r->scan, word, "a weight", &weight));
    if (!(weight >= 0 && weight < 1e100))
        return starg_source_fail(r->scan.source, starg_at_line(word.line),
                                 "a weight is %g; it must be zero or more, and finite", weight);
    if (r->count == r->face_count)
        return starg_source_fail(r->scan.source, starg_at_line(word.line),
                                 "more than one weight for each of the %zu faces of the model",
                                 r->face_count);
    r->values[r->count++] = weight;
    return STARG_OK;
}

static starg_status read_words(starg_context *context, const char *path, take_word *take,
                               size_t face_count, double **out, size_t *count) {
    starg_status status = STARG_OK;
    char *bytes = NULL;
    starg_c_locale locale = {0};
    face_reader r = {.face_count = face_count};
    starg_word word;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, r.values, face_count);
    starg_source source = {.context = context, .name = path};
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &source.size));
    source.bytes = bytes;
    r.scan = starg_scan_make(&source);
    r.scan.comments = true;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    while (status == STARG_OK && starg_scan_word(&r.scan, &word))
        status = take(&r, word);
    *count = r.count;
    if (status == STARG_OK) {
        *out = r.values;
        r.values = NULL;
    }
done:
    starg_c_locale_leave(&locale);
    RELEASE(bytes, r.values);
    return status;
}

starg_status starg_faces_read(starg_context *context, const char *path, size_t face_count,
                              double **weights) {
    size_t count = 0;
    starg_status status = read_words(context, path, take_face, face_count, weights, &count);
    if (status != STARG_OK || count > 0)
        return status;
    starg_release(context, *weights);
    *weights = NULL;
    return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                      "'%.200s' names no face; write numbers of faces, from 0 on", path);
}

starg_status starg_weights_read(starg_context *context, const char *path, size_t face_count,
                                double **weights) {
    size_t count = 0;
    starg_status status = read_words(context, path, take_weight, face_count, weights, &count);
    if (status != STARG_OK || count == face_count)
        return status;
    starg_release(context, *weights);
    *weights = NULL;
    return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                      "'%.200s' has %zu weights, and the model %zu faces; write one for each", path,
                      count, face_count);
}

/* ---- names in the model ---- */

/* Is the name what the pattern, up to its end, describes? The last * takes one character more
 * whenever what follows it does not fit. Cost: the product of the lengths. */
static bool fits(const char *pattern, const char *end, const char *name, size_t length) {
    const char *stop = name + length, *star = NULL, *from = NULL;
    while (name < stop) {
        if (pattern < end && *pattern == '*') {
            star = pattern++;
            from = name;
        } else if (pattern < end && (*pattern == '?' || *pattern == *name)) {
            pattern++;
            name++;
        } else if (star != NULL) {
            pattern = star + 1;
            name = ++from;
        } else {
            return false;
        }
    }
    while (pattern < end && *pattern == '*')
        pattern++;
    return pattern == end;
}

bool starg_values_want(starg_face_values *values, const char *name, size_t length) {
    bool wanted = fits(values->pattern, values->pattern + strlen(values->pattern), name, length);
    values->found = values->found || wanted;
    return wanted;
}

bool starg_values_want_property(starg_face_values *values, const char *name, size_t length) {
    if (values->equals == NULL)
        return starg_values_want(values, name, length);
    bool wanted = fits(values->pattern, values->equals, name, length);
    values->found = values->compared = values->found || wanted;
    return wanted;
}

void starg_values_note(starg_face_values *values, const char *name, size_t length) {
    size_t used = strlen(values->others);
    char quoted[sizeof values->others];
    if (used + length + 3 >= sizeof values->others)
        return;
    snprintf(quoted, sizeof quoted, "%s%.*s", used > 0 ? ", " : "", (int)length, name);
    if (strstr(values->others, quoted + (used > 0 ? 2 : 0)) == NULL)
        strcat(values->others, quoted);
}

void starg_values_take(starg_face_values *values, double value) {
    if (values->equals != NULL)
        values->current = values->current != 0 || value == values->wanted;
    else if (value != 0)
        values->current = value;
}

static starg_status fail_unknown(starg_context *context, const starg_face_values *values,
                                 const char *path) {
    bool any = values->others[0] != '\0';
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "no file, and no group, object, material or property of faces in '%.200s', "
                      "is called '%.100s'%s%s",
                      path, values->pattern,
                      any ? "; there are " : "; the model names no faces: give a file",
                      values->others);
}

static starg_status take_pattern(starg_context *context, const char *name,
                                 starg_face_values *values) {
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    values->pattern = name;
    values->equals = strchr(name, '=');
    if (values->equals == NULL)
        return STARG_OK;
    TRY(starg_c_locale_enter(context, &locale));
    if (!starg_parse_real(values->equals + 1, strlen(values->equals + 1), &values->wanted))
        values->wanted = NAN;
    return STARG_OK;
}

static void values_free(starg_face_values *values) {
    RELEASE(values->data.data, values->names.data);
}

starg_status starg_faces_named(starg_context *context, const char *model_file, const char *name,
                               size_t face_count, double **weights) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED char *bytes = NULL;
    const char *up;
    size_t size = 0;
    SCOPED_BY(values_free) starg_face_values values = {0};
    *weights = NULL;
    TRY(take_pattern(context, name, &values));
    TRY(starg_mesh_bytes(context, model_file, &bytes, &size, &up));
    TRY(starg_mesh_read_with(context, bytes, size, model_file, &values, &mesh));
    if (!values.found)
        return fail_unknown(context, &values, model_file);
    if (values.data.count != face_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "'%.200s' has %zu faces, and the model %zu", model_file,
                          values.data.count, face_count);
    if (values.compared && isnan(values.wanted))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "'%.100s' is not a number that a property can have", values.equals + 1);
    *weights = values.data.data;
    values.data.data = NULL;
    return STARG_OK;
}

/* ---- groups ---- */

starg_status starg_values_collect(starg_context *context, starg_face_values *values,
                                  const char *name, size_t length, double *number) {
    size_t at = 0;
    for (size_t i = 0; i < values->group_count; i++) {
        const char *known = values->names.data + at;
        size_t size = strlen(known);
        *number = (double)i + 1;
        if (size == length && memcmp(known, name, length) == 0)
            return STARG_OK;
        at += size + 1;
    }
    for (size_t i = 0; i < length; i++)
        PUSH(context, STAGE, &values->names, name[i]);
    PUSH(context, STAGE, &values->names, '\0');
    *number = (double)++values->group_count;
    return STARG_OK;
}

/* Takes the names over. */
static starg_status take_groups(starg_context *context, starg_face_values *values,
                                starg_face_groups *out) {
    size_t at = 0;
    NEW(context, STAGE, out->names, values->group_count);
    NEW(context, STAGE, out->of, values->data.count);
    out->face_count = values->data.count;
    for (size_t f = 0; f < out->face_count; f++)
        out->of[f] = values->data.data[f] > 0 ? (uint32_t)values->data.data[f] - 1 : UINT32_MAX;
    out->text = values->names.data;
    values->names.data = NULL;
    for (; out->count < values->group_count; out->count++) {
        out->names[out->count] = out->text + at;
        at += strlen(out->text + at) + 1;
    }
    return STARG_OK;
}

starg_status starg_face_groups_read(starg_context *context, const char *model_file,
                                    starg_face_groups *out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED char *bytes = NULL;
    const char *up;
    size_t size = 0;
    SCOPED_BY(values_free) starg_face_values values = {.collects = true, .pattern = ""};
    *out = (starg_face_groups){0};
    TRY(starg_mesh_bytes(context, model_file, &bytes, &size, &up));
    TRY(starg_mesh_read_with(context, bytes, size, model_file, &values, &mesh));
    starg_status status = take_groups(context, &values, out);
    if (status != STARG_OK)
        starg_face_groups_free(context, out);
    return status;
}

void starg_face_groups_free(starg_context *context, starg_face_groups *groups) {
    (void)context;
    RELEASE(groups->names, groups->text, groups->of);
    *groups = (starg_face_groups){0};
}

void starg_weights_free(starg_context *context, double *weights) {
    starg_release(context, weights);
}
