/* SPDX-License-Identifier: Apache-2.0 */
/* Faces and weights of faces from text files. */
#include <math.h>

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

void starg_weights_free(starg_context *context, double *weights) {
    starg_release(context, weights);
}
