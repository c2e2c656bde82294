/* Candidate points from a file: text of three numbers a line, with an optional leading "v" as in
 * OBJ and comments by #, or the positions in a GUARDS.json. */
#include <math.h>

#include "core/file.h"
#include "guard/candidates.h"
#include "mesh/scan.h"

static const char STAGE[] = "points file";

static starg_status take_positions(const starg_source *source, candidate_points *points) {
    starg_guards *guards = NULL;
    starg_status status = starg_guards_read_memory(source->context, source->bytes, source->size,
                                                   source->name, &guards);
    for (size_t i = 0; status == STARG_OK && i < guards->count; i++)
        status = candidates_push(source->context, points, guards->positions + 3 * i, NULL);
    starg_guards_free(source->context, guards);
    return status;
}

/* One line: nothing, a keyword of OBJ that stands for no vertex, or a point. */
static starg_status scan_line(starg_scan *scan, candidate_points *points) {
    starg_status status = STARG_OK;
    starg_word word;
    double p[3];
    if (!starg_scan_word_here(scan, &word))
        return STARG_OK;
    if (starg_word_is(word, "v")) {
        STARG_TRY(starg_scan_expect(scan, "a coordinate", &word));
    } else if (starg_word_is(word, "l") || starg_word_is(word, "p") || starg_word_is(word, "o") ||
               starg_word_is(word, "g")) {
        return STARG_OK;
    }
    STARG_TRY(starg_word_real(scan, word, "a coordinate", &p[0]));
    STARG_TRY(starg_scan_real(scan, "a coordinate", &p[1]));
    STARG_TRY(starg_scan_real(scan, "a coordinate", &p[2]));
    for (int k = 0; k < 3; k++)
        if (!(fabs(p[k]) < 1e100)) {
            status = starg_source_fail(scan->source, starg_at_line(word.line),
                                       "coordinate %c is %g; it must be finite and below 1e100",
                                       "xyz"[k], p[k]);
            goto done;
        }
    STARG_TRY(candidates_push(scan->source->context, points, p, NULL));
done:
    return status;
}

static starg_status scan_text(const starg_source *source, candidate_points *points) {
    starg_status status = STARG_OK;
    starg_c_locale locale = {0};
    starg_scan scan = starg_scan_make(source);
    scan.comments = true;
    STARG_TRY(starg_c_locale_enter(source->context, &locale));
    do
        STARG_TRY(scan_line(&scan, points));
    while (starg_scan_next_line(&scan));
done:
    starg_c_locale_leave(&locale);
    return status;
}

/* A JSON text begins with a brace; a list of points never does. */
static bool is_json(const starg_source *source) {
    size_t i = 0;
    while (i < source->size && (source->bytes[i] == ' ' || source->bytes[i] == '\n' ||
                                source->bytes[i] == '\r' || source->bytes[i] == '\t'))
        i++;
    return i < source->size && source->bytes[i] == '{';
}

starg_status starg_points_read_memory(starg_context *context, const void *bytes, size_t size,
                                      const char *name, double **points, size_t *count) {
    starg_status status = STARG_OK;
    starg_source source = {context, name, bytes, size};
    candidate_points found = {0};
    *points = NULL;
    *count = 0;
    if (is_json(&source))
        STARG_TRY(take_positions(&source, &found));
    else
        STARG_TRY(scan_text(&source, &found));
    if (found.data.count == 0) {
        status = starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                            "'%s' holds no points; write three numbers a line", name);
        goto done;
    }
    *points = found.data.data;
    *count = found.data.count / 3;
    found.data.data = NULL;
done:
    candidates_free(context, &found);
    return status;
}

starg_status starg_points_read(starg_context *context, const char *path, double **points,
                               size_t *count) {
    char *bytes = NULL;
    size_t size;
    *points = NULL;
    *count = 0;
    starg_status status = starg_file_read(context, STAGE, path, &bytes, &size);
    if (status == STARG_OK)
        status = starg_points_read_memory(context, bytes, size, path, points, count);
    starg_release(context, bytes);
    return status;
}
