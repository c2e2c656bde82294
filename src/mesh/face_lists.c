/* SPDX-License-Identifier: Apache-2.0 */
/* Faces and weights of faces from text files, and by names in the file of the model. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
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
    starg_status status = starg_word_integer(&r->scan, word, "a face number", &face);
    if (status != STARG_OK)
        return status;
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
    starg_status status = starg_word_real(&r->scan, word, "a weight", &weight);
    if (status != STARG_OK)
        return status;
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
    starg_release(context, bytes);
    starg_release(context, r.values);
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

/* Does the text fit a pattern, in which * stands for any characters, and ? for any one? */
static bool fits(const char *pattern, size_t pattern_length, const char *text, size_t length) {
    size_t p = 0, t = 0, star = SIZE_MAX, resume = 0;
    while (t < length) {
        if (p < pattern_length && pattern[p] == '*') {
            star = p++;
            resume = t;
        } else if (p < pattern_length && (pattern[p] == '?' || pattern[p] == text[t])) {
            p++;
            t++;
        } else if (star != SIZE_MAX) {
            p = star + 1;
            t = ++resume;
        } else {
            return false;
        }
    }
    while (p < pattern_length && pattern[p] == '*')
        p++;
    return p == pattern_length;
}

bool starg_values_know(starg_face_values *values, const char *name, size_t length) {
    size_t used = strlen(values->others);
    if (values->pattern ? fits(values->name, values->length, name, length)
                        : length == values->length && memcmp(name, values->name, length) == 0)
        return values->found = true;
    if (used + length + 3 < sizeof values->others) {
        char quoted[sizeof values->others];
        snprintf(quoted, sizeof quoted, "%s%.*s", used > 0 ? ", " : "", (int)length, name);
        const char *at = strstr(values->others, quoted + (used > 0 ? 2 : 0));
        if (at == NULL)
            strcat(values->others, quoted);
    }
    return false;
}

static starg_status fail_unknown(starg_context *context, const starg_face_values *values,
                                 const char *path) {
    bool any = values->others[0] != '\0';
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "no file, and no group, material or property of faces in '%.200s', is called "
                      "'%.*s'%s%s",
                      path, (int)(values->length < 100 ? values->length : 100), values->name,
                      any ? "; there are " : "; it names no faces: give a file of face numbers",
                      values->others);
}

/* 1 where the value is the one wanted. */
static starg_status compare(starg_context *context, starg_face_values *values) {
    starg_status status = STARG_OK;
    starg_c_locale locale = {0};
    double wanted;
    if (values->equals == NULL)
        return STARG_OK;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    if (!starg_parse_real(values->equals, values->equals_length, &wanted))
        status = starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE, "'%.*s' is not a number that a property can have",
            (int)(values->equals_length < 100 ? values->equals_length : 100), values->equals);
    for (size_t i = 0; status == STARG_OK && i < values->data.count; i++)
        values->data.data[i] = values->data.data[i] == wanted;
done:
    starg_c_locale_leave(&locale);
    return status;
}

/* A model's file, read once. */
typedef struct named_file {
    starg_context *context;
    const char *path;
    char *bytes;
    size_t size, faces;
} named_file;

/* Raises the values of faces to those by a name; `found` is false if the file does not have it. */
static starg_status raise_values(const named_file *file, starg_face_values *values, double *out) {
    starg_status status = STARG_OK;
    starg_mesh *mesh = NULL;
    STARG_TRY(
        starg_mesh_read_with(file->context, file->bytes, file->size, file->path, values, &mesh));
    if (values->found && values->data.count != file->faces)
        status = starg_fail(file->context, STARG_ERROR_ARGUMENT, STAGE,
                            "'%.200s' has %zu faces, and the model %zu", file->path,
                            values->data.count, file->faces);
    STARG_TRY(status);
    if (values->found)
        STARG_TRY(compare(file->context, values));
    for (size_t f = 0; f < file->faces && values->found; f++)
        if (out[f] == 0 || values->data.data[f] > out[f])
            out[f] = values->data.data[f];
done:
    STARG_ARRAY_FREE(file->context, &values->data);
    starg_mesh_free(mesh);
    return status;
}

/* A name with a list's other names left out: NAME or NAME=VALUE, either a pattern. */
static starg_face_values part_of(const char *text, size_t length) {
    const char *equals = memchr(text, '=', length);
    starg_face_values part = {.name = text, .length = length, .pattern = true};
    if (equals == NULL)
        return part;
    part.length = (size_t)(equals - text);
    part.equals = equals + 1;
    part.equals_length = length - part.length - 1;
    return part;
}

/* The name as it stands first, as names may hold any characters; else it is a list. */
starg_status starg_faces_named(starg_context *context, const char *model_file, const char *name,
                               size_t face_count, double **weights) {
    starg_status status = STARG_OK;
    named_file file = {.context = context, .path = model_file, .faces = face_count};
    starg_face_values values = {.name = name, .length = strlen(name)};
    double *out = NULL;
    *weights = NULL;
    STARG_TRY(starg_file_read(context, STAGE, model_file, &file.bytes, &file.size));
    STARG_NEW_ZERO(context, STAGE, out, face_count);
    STARG_TRY(raise_values(&file, &values, out));
    for (const char *at = name; !values.found && at != NULL;) {
        const char *comma = strchr(at, ',');
        starg_face_values part = part_of(at, comma != NULL ? (size_t)(comma - at) : strlen(at));
        STARG_TRY(raise_values(&file, &part, out));
        if (!part.found) {
            status = fail_unknown(context, &part, model_file);
            goto done;
        }
        at = comma != NULL ? comma + 1 : NULL;
    }
    *weights = out;
    out = NULL;
done:
    starg_release(context, out);
    starg_release(context, file.bytes);
    return status;
}

void starg_weights_free(starg_context *context, double *weights) {
    starg_release(context, weights);
}
