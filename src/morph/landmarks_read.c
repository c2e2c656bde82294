/* SPDX-License-Identifier: Apache-2.0 */
/* Landmark files: a pair per line, by vertex numbers or by points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "geometry/vec3.h"
#include "mesh/formats/io.h"
#include "mesh/mesh.h"
#include "morph/parse_numbers.h"
#include "starguard/morph.h"

static const char STAGE[] = "landmarks";
enum { VALUES_MOST = 6 };

static starg_status fail_line(starg_context *context, const char *path, size_t line,
                              const char *what) {
    uint64_t index = line;
    return starg_fail_at(context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &index, 1,
                         "'%.200s' line %zu %s; a landmark is a vertex of A and one of B (numbered "
                         "from 0), or a point near A and one near B (six coordinates)",
                         path, line, what);
}

static bool to_vertex(double value, size_t count, uint32_t *vertex) {
    if (!(value >= 0 && value < (double)count && floor(value) == value))
        return false;
    *vertex = (uint32_t)value;
    return true;
}

static uint32_t nearest_vertex(const starg_mesh *mesh, const double p[3]) {
    uint32_t best = 0;
    double least = INFINITY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double *q = mesh->vertices + 3 * (size_t)v;
        double d = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        if (d < least) {
            least = d;
            best = v;
        }
    }
    return best;
}

/* From two numbers or six coordinates. */
static bool find_pair(const starg_mesh *a, const starg_mesh *b, const double *values, size_t count,
                      uint32_t pair[2]) {
    if (count == 2)
        return to_vertex(values[0], a->vertex_count, &pair[0]) &&
               to_vertex(values[1], b->vertex_count, &pair[1]);
    pair[0] = nearest_vertex(a, values);
    pair[1] = nearest_vertex(b, values + 3);
    return a->vertex_count > 0 && b->vertex_count > 0;
}

starg_status starg_landmarks_read(starg_context *context, const char *path, const starg_mesh *a,
                                  const starg_mesh *b, uint32_t **pairs, size_t *count) {
    starg_status status = STARG_OK;
    STARG_ARRAY(uint32_t) list = {0};
    char *bytes = NULL;
    size_t size, number = 0;
    starg_c_locale locale = {0};
    *pairs = NULL;
    *count = 0;
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_c_locale_enter(context, &locale));
    if (memchr(bytes, '\0', size) != NULL)
        STARG_TRY(fail_line(context, path, 1, "is not text"));
    for (char *line = bytes, *next; line != NULL; line = next) {
        double values[VALUES_MOST] = {0};
        uint32_t pair[2] = {0, 0};
        next = strchr(line, '\n');
        if (next != NULL)
            *next++ = '\0';
        number++;
        size_t found = parse_numbers(line, values, VALUES_MOST);
        if (found == 0)
            continue;
        if (list.count == 2 * (size_t)STARG_LANDMARKS_MOST)
            STARG_TRY(fail_line(context, path, number, "is one landmark too many"));
        if (found != 2 && found != VALUES_MOST)
            STARG_TRY(fail_line(context, path, number, "is not a pair"));
        if (!find_pair(a, b, values, found, pair))
            STARG_TRY(fail_line(context, path, number, "refers to a missing vertex"));
        STARG_PUSH(context, STAGE, &list, pair[0]);
        STARG_PUSH(context, STAGE, &list, pair[1]);
    }
    *pairs = list.data;
    *count = list.count / 2;
    list.data = NULL;
done:
    starg_c_locale_leave(&locale);
    starg_release(context, bytes);
    STARG_ARRAY_FREE(context, &list);
    return status;
}

void starg_landmarks_free(starg_context *context, uint32_t *pairs) {
    starg_release(context, pairs);
}
