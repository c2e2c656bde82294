/* SPDX-License-Identifier: Apache-2.0 */
/* Landmark files: a pair per line, by vertex numbers or by points. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "geometry/bvh.h"
#include "mesh/formats/io.h"
#include "morph/surface_map.h"
#include "starguard/morph.h"

static const char STAGE[] = "landmarks";
enum { VALUES_MOST = 6 };
static const double TOLD = 0.01, REFUSED = 0.1; /* distances from the surface, in diagonals */

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

/* A point is meant to be on the surface: told where it is off by a little, refused where by a lot.
 */
static starg_status check_distance(starg_context *context, const char *path, size_t line,
                                   const starg_mesh *mesh, const bvh *tree, const double p[3],
                                   const char *name) {
    double distance = bvh_distance(tree, p), diagonal = mesh_diagonal(mesh);
    char text[160];
    if (distance <= TOLD * diagonal)
        return STARG_OK;
    snprintf(text, sizeof text, "has a point %.3g from %s, %.3g %% of its diagonal", distance, name,
             100 * distance / diagonal);
    if (!(distance <= REFUSED * diagonal))
        return fail_line(context, path, line, text);
    starg_log(context, STARG_LOG_WARNING, "'%.200s' line %zu %s", path, line, text);
    return STARG_OK;
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
    bvh *trees[2] = {NULL, NULL};
    size_t size, number = 0;
    starg_c_locale locale = {0};
    *pairs = NULL;
    *count = 0;
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(bvh_create(context, a->vertices, a->faces, a->face_count, &trees[0]));
    STARG_TRY(bvh_create(context, b->vertices, b->faces, b->face_count, &trees[1]));
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
        if (found == VALUES_MOST) {
            STARG_TRY(check_distance(context, path, number, a, trees[0], values, "A"));
            STARG_TRY(check_distance(context, path, number, b, trees[1], values + 3, "B"));
        }
        STARG_PUSH(context, STAGE, &list, pair[0]);
        STARG_PUSH(context, STAGE, &list, pair[1]);
    }
    if (list.count == 0)
        STARG_TRY(fail_line(context, path, number, "is the last one, and there is no landmark"));
    *pairs = list.data;
    *count = list.count / 2;
    list.data = NULL;
done:
    starg_c_locale_leave(&locale);
    bvh_free(trees[0]);
    bvh_free(trees[1]);
    RELEASE(bytes, list.data);
    return status;
}

void starg_landmarks_free(starg_context *context, uint32_t *pairs) {
    (void)context;
    RELEASE(pairs);
}
