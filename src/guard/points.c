/* SPDX-License-Identifier: Apache-2.0 */
/* Reads candidate points from a file: text with three numbers per line, six with the direction of a
 * camera there, or nine with its up vector, with an optional leading "v", lines of edges as in OBJ,
 * and comments after #; the nodes of a skeleton (CG, VTK); or the poses in a GUARDS.json. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "mesh/formats/scan.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "points file";

static starg_status take_positions(const starg_source *source, candidate_points *points) {
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    TRY(starg_json_parse(source->context, STAGE, source->name, source->bytes, source->size, &root));
    if (poses_are_json(root))
        return poses_read_json(source, root, points);
    TRY(starg_guards_read_memory(source->context, source->bytes, source->size, source->name,
                                 &guards));
    for (size_t i = 0; i < guards->count; i++)
        TRY(candidates_push_pose(source->context, points, guards->positions + 3 * i,
                                 guards->directions != NULL ? guards->directions + 3 * i : NULL,
                                 guards->ups != NULL ? guards->ups + 3 * i : NULL));
    return STARG_OK;
}

static starg_status take_nodes(const starg_source *source, candidate_points *points) {
    starg_skeleton *skeleton = NULL;
    starg_status status = starg_skeleton_read_memory(source->context, source->bytes, source->size,
                                                     source->name, &skeleton);
    for (size_t i = 0; status == STARG_OK && i < skeleton->node_count; i++)
        status = candidates_push(source->context, points, skeleton->positions + 3 * i, NULL);
    starg_skeleton_free(source->context, skeleton);
    return status;
}

/* The count of numbers per line: 3, 6 or 9. */
typedef struct pose_scan {
    candidate_points *points;
    size_t width; /* of the lines before; 0: none yet */
} pose_scan;

static starg_status check_count(const starg_scan *scan, size_t line, size_t count,
                                const pose_scan *poses) {
    if (count != 3 && count != 6 && count != 9)
        return starg_source_fail(scan->source, starg_at_line(line),
                                 "a point has three coordinates, six numbers with a direction, or "
                                 "nine with what is up, not %zu; write as many on each line",
                                 count);
    if (poses->width > 0 && count != poses->width)
        return starg_source_fail(scan->source, starg_at_line(line),
                                 "%zu numbers, and %zu on the lines before; give all points a "
                                 "direction, or none",
                                 count, poses->width);
    return STARG_OK;
}

/* Checks that direction and up are nonzero and not parallel. */
static starg_status check_direction(const starg_scan *scan, size_t line, size_t count,
                                    const double *d) {
    double across[3];
    if (count < 6)
        return STARG_OK;
    if (d[0] == 0 && d[1] == 0 && d[2] == 0)
        return starg_source_fail(scan->source, starg_at_line(line),
                                 "the direction is (0, 0, 0), which is none");
    if (count < 9)
        return STARG_OK;
    vec3_cross(d, d + 3, across);
    if (across[0] == 0 && across[1] == 0 && across[2] == 0)
        return starg_source_fail(scan->source, starg_at_line(line),
                                 "what is up, (%g, %g, %g), lies along the direction", d[3], d[4],
                                 d[5]);
    return STARG_OK;
}

static bool is_passed_over(starg_word word) {
    return starg_word_is(word, "l") || starg_word_is(word, "p") || starg_word_is(word, "o") ||
           starg_word_is(word, "g");
}

/* One line: empty, an OBJ keyword other than a vertex, or a point. */
static starg_status scan_line(starg_scan *scan, pose_scan *poses) {
    starg_word word;
    double p[9], x;
    size_t count = 0, line = scan->line;
    bool more = starg_scan_word_here(scan, &word);
    if (!more || is_passed_over(word))
        return STARG_OK;
    if (starg_word_is(word, "v"))
        more = starg_scan_word_here(scan, &word);
    for (; more; more = starg_scan_word_here(scan, &word)) {
        TRY(starg_word_real(scan, word, "a coordinate", &x));
        if (!(fabs(x) < 1e100))
            return starg_source_fail(scan->source, starg_at_line(line),
                                     "coordinate %c is %g; it must be finite and below 1e100",
                                     "xyz"[count % 3], x);
        if (count < 9)
            p[count] = x;
        count++;
    }
    TRY(check_count(scan, line, count, poses));
    TRY(check_direction(scan, line, count, p + 3));
    TRY(candidates_push_pose(scan->source->context, poses->points, p, count > 3 ? p + 3 : NULL,
                             count > 6 ? p + 6 : NULL));
    poses->width = count;
    return STARG_OK;
}

static starg_status scan_text(const starg_source *source, candidate_points *points) {
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    starg_scan scan = starg_scan_make(source);
    pose_scan poses = {.points = points};
    scan.comments = true;
    TRY(starg_c_locale_enter(source->context, &locale));
    do
        TRY(scan_line(&scan, &poses));
    while (starg_scan_next_line(&scan));
    return STARG_OK;
}

/* A JSON text begins with a brace; a list of points never does. */
static bool is_json(const starg_source *source) {
    size_t i = 0;
    while (i < source->size && (source->bytes[i] == ' ' || source->bytes[i] == '\n' ||
                                source->bytes[i] == '\r' || source->bytes[i] == '\t'))
        i++;
    return i < source->size && source->bytes[i] == '{';
}

/* OBJ reads like a list of points. */
static bool is_skeleton(const starg_source *source) {
    static const char *const heads[] = {"# vtk", "# D:3 NV:"};
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        size_t size = strlen(heads[i]);
        if (source->size >= size && memcmp(source->bytes, heads[i], size) == 0)
            return true;
    }
    return false;
}

void starg_poses_free(starg_context *context, starg_poses *poses) {
    (void)context;
    RELEASE(poses->points, poses->directions, poses->ups);
    *poses = (starg_poses){0};
}

starg_status starg_poses_read_memory(starg_context *context, const void *bytes, size_t size,
                                     const char *name, starg_poses *out) {
    starg_source source = {context, name, bytes, size};
    SCOPED_BY(candidates_free) candidate_points found = {0};
    *out = (starg_poses){0};
    if (poses_are_glb(&source))
        TRY(poses_read_glb(&source, &found));
    else if (poses_are_table(&source))
        TRY(poses_read_table(&source, &found));
    else if (is_json(&source))
        TRY(take_positions(&source, &found));
    else if (is_skeleton(&source))
        TRY(take_nodes(&source, &found));
    else
        TRY(scan_text(&source, &found));
    if (found.data.count == 0)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "'%s' has no points; write three numbers per line", name);
    if (found.directions.count > 0 && found.directions.count != found.data.count)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "'%s' has %zu poses, of which %zu have a direction; give one to all, or "
                          "to none",
                          name, found.data.count / 3, found.directions.count / 3);
    *out = (starg_poses){.points = found.data.data,
                         .directions = found.directions.data,
                         .ups = found.ups.data,
                         .count = found.data.count / 3};
    found = (candidate_points){0};
    return STARG_OK;
}

starg_status starg_poses_read(starg_context *context, const char *path, starg_poses *out) {
    char *bytes = NULL;
    size_t size;
    *out = (starg_poses){0};
    starg_status status = starg_file_read(context, STAGE, path, &bytes, &size);
    if (status == STARG_OK)
        status = starg_poses_read_memory(context, bytes, size, path, out);
    starg_release(context, bytes);
    return status;
}

static void keep_points(starg_context *context, starg_poses *poses, double **points,
                        size_t *count) {
    *points = poses->points;
    *count = poses->count;
    poses->points = NULL;
    starg_poses_free(context, poses);
}

starg_status starg_points_read_memory(starg_context *context, const void *bytes, size_t size,
                                      const char *name, double **points, size_t *count) {
    starg_poses poses;
    starg_status status = starg_poses_read_memory(context, bytes, size, name, &poses);
    keep_points(context, &poses, points, count);
    return status;
}

starg_status starg_points_read(starg_context *context, const char *path, double **points,
                               size_t *count) {
    starg_poses poses;
    starg_status status = starg_poses_read(context, path, &poses);
    keep_points(context, &poses, points, count);
    return status;
}
