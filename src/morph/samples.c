/* SPDX-License-Identifier: Apache-2.0 */
/* Points, and values of a field there, as text: a point per line, x y z, and behind it nothing, a
 * number or a vector. '#' begins a comment. */
#include <math.h>
#include <stdlib.h>

#include "mesh/formats/io.h"
#include "morph/surface_map.h"
#include "starguard/solidmap.h"

static const char STAGE[] = "points file";
enum { VALUES_MOST = 6, POINT = 3 };

typedef struct reader {
    starg_context *context;
    const char *path;
    size_t line;
    size_t columns; /* of the first point; 0: there is none yet */
    STARG_ARRAY(double) points;
    STARG_ARRAY(double) values;
} reader;

static starg_status fail_line(const reader *r, const char *what) {
    uint64_t index = r->line;
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &index, 1,
                         "'%.200s' line %zu %s; a line is x y z, x y z value or x y z u v w, the "
                         "same for all",
                         r->path, r->line, what);
}

static starg_status take_line(reader *r, char *line) {
    double values[VALUES_MOST] = {0};
    size_t found = parse_numbers(line, values, VALUES_MOST);
    r->line++;
    if (found == 0)
        return STARG_OK;
    if (found != POINT && found != POINT + 1 && found != VALUES_MOST)
        return fail_line(r, "is not a point with a number or a vector");
    if (r->columns != 0 && found != r->columns)
        return fail_line(r, "has another number of values than those before");
    r->columns = found;
    for (size_t k = 0; k < POINT; k++) {
        if (!(fabs(values[k]) < STARG_COORDINATE_LIMIT))
            return fail_line(r, "has a coordinate that is not below 1e100 in magnitude");
        PUSH(r->context, STAGE, &r->points, values[k]);
    }
    for (size_t k = POINT; k < found; k++)
        PUSH(r->context, STAGE, &r->values, values[k]);
    return STARG_OK;
}

static starg_status take_lines(reader *r, char *bytes, size_t size) {
    if (memchr(bytes, '\0', size) != NULL)
        return fail_line(r, "is not text");
    for (char *line = bytes, *next; line != NULL; line = next) {
        next = strchr(line, '\n');
        if (next != NULL)
            *next++ = '\0';
        TRY(take_line(r, line));
    }
    if (r->columns == 0)
        return starg_fail(r->context, STARG_ERROR_FORMAT, STAGE, "'%.200s' has no points", r->path);
    return STARG_OK;
}

starg_status starg_samples_read(starg_context *context, const char *path, starg_samples **out) {
    starg_status status = STARG_OK;
    reader r = {.context = context, .path = path};
    starg_samples *samples = NULL;
    char *bytes = NULL;
    size_t size;
    starg_c_locale locale = {0};
    *out = NULL;
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(take_lines(&r, bytes, size));
    STARG_NEW_ZERO(context, STAGE, samples, 1);
    samples->count = r.points.count / POINT;
    samples->width = r.columns - POINT;
    samples->points = r.points.data;
    samples->values = r.values.data;
    r.points.data = r.values.data = NULL;
    *out = samples;
done:
    starg_c_locale_leave(&locale);
    RELEASE(bytes, r.points.data, r.values.data);
    return status;
}

void starg_samples_free(starg_context *context, starg_samples *samples) {
    (void)context;
    if (samples == NULL)
        return;
    RELEASE(samples->points, samples->values, samples);
}

starg_status starg_samples_write(starg_context *context, const starg_samples *samples,
                                 const char *path) {
    starg_output output;
    TRY(starg_output_open(context, STAGE, path, &output));
    for (size_t i = 0; i < samples->count; i++) {
        const double *p = samples->points + POINT * i;
        fprintf(output.stream, "%.17g %.17g %.17g", p[0], p[1], p[2]);
        for (size_t k = 0; k < samples->width; k++)
            fprintf(output.stream, " %.17g", samples->values[samples->width * i + k]);
        fputc('\n', output.stream);
    }
    return starg_output_commit(&output);
}
