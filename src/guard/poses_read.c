/* SPDX-License-Identifier: Apache-2.0 */
/* Poses in the files of other programs: the tables and the JSON that starg_guards_write_poses
 * writes, or any CSV with columns of these names, and the cameras of a binary glTF.
 *
 * A rotation turns a camera that looks along -z with y up. A camera of a scene stands where the
 * transforms of its node and of all nodes above it put it; its axes are unit vectors again whatever
 * their scales. Cost: linear in the file, and in the depth of each camera's node. */
#include "guard/candidates.h"

#include <math.h>
#include <string.h>

#include "core/json.h"
#include "geometry/vec3.h"
#include "mesh/formats/scan.h"

static const char STAGE[] = "points file";

/* The columns that are read; others are passed over. */
enum { X, Y, Z, QX, QY, QZ, QW, LOOK_X, LOOK_Y, LOOK_Z, NAMES };
static const char *const NAME[NAMES] = {"x",  "y",  "z",      "qx",     "qy",
                                        "qz", "qw", "look_x", "look_y", "look_z"};

/* v turned by the quaternion (x, y, z, w), of any length. */
static void turn(const double q[4], const double v[3], double out[3]) {
    double across[3], twice[3], square = vec3_dot(q, q);
    vec3_cross(q, v, across);
    double along = vec3_dot(q, v);
    for (int k = 0; k < 3; k++)
        twice[k] = (q[3] * q[3] - square) * v[k] + 2 * along * q[k] + 2 * q[3] * across[k];
    double length = vec3_length(twice);
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? twice[k] / length : 0;
}

static bool is_good(const double *values, size_t count) {
    bool good = true;
    for (size_t i = 0; i < count; i++)
        good = good && fabs(values[i]) < 1e100;
    return good;
}

/* A pose by its position and rotation; the latter may be NULL. */
static starg_status push_turned(starg_context *context, candidate_points *points, const double p[3],
                                const double *q) {
    const double ahead[3] = {0, 0, -1}, above[3] = {0, 1, 0};
    double direction[3], up[3];
    if (q == NULL)
        return candidates_push(context, points, p, NULL);
    turn(q, ahead, direction);
    turn(q, above, up);
    return candidates_push_pose(context, points, p, direction, up);
}

static bool is_turning(const double q[4]) {
    return is_good(q, 4) && (q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0);
}

/* ---- CSV ---- */

typedef struct table {
    const starg_source *source;
    candidate_points *points;
    int column[NAMES]; /* where it stands; -1: nowhere */
    size_t line;
} table;

/* The next field of a line that ends at `end`; false: there is none. */
static bool next_field(const char **at, const char *end, starg_word *field) {
    if (*at == NULL)
        return false;
    const char *begin = *at, *stop = memchr(begin, ',', (size_t)(end - begin));
    *at = stop != NULL ? stop + 1 : NULL;
    stop = stop != NULL ? stop : end;
    while (begin < stop && (*begin == ' ' || *begin == '\t' || *begin == '"'))
        begin++;
    while (stop > begin && strchr(" \t\r\"", stop[-1]) != NULL)
        stop--;
    *field = (starg_word){.text = begin, .length = (size_t)(stop - begin)};
    return true;
}

static void read_head(table *t, const char *at, const char *end) {
    starg_word field;
    for (int i = 0; i < NAMES; i++)
        t->column[i] = -1;
    for (int c = 0; next_field(&at, end, &field); c++)
        for (int i = 0; i < NAMES; i++)
            if (t->column[i] < 0 && starg_word_is(field, NAME[i]))
                t->column[i] = c;
}

static bool has_columns(const table *t, int first, int last) {
    bool all = true;
    for (int i = first; i <= last; i++)
        all = all && t->column[i] >= 0;
    return all;
}

static starg_status read_row(table *t, const char *at, const char *end) {
    starg_context *context = t->source->context;
    double value[NAMES] = {0}, direction[3];
    starg_word field;
    bool turned = has_columns(t, QX, QW), aimed = !turned && has_columns(t, LOOK_X, LOOK_Z);
    int fields = 0;
    for (; next_field(&at, end, &field); fields++)
        for (int i = 0; i < NAMES; i++)
            if (t->column[i] == fields && (i < QX || (turned && i <= QW) || (aimed && i > QW)) &&
                !starg_parse_real(field.text, field.length, &value[i]))
                return starg_source_fail(
                    t->source, starg_at_line(t->line), "'%.*s' in the column %s is not a number",
                    (int)(field.length < 40 ? field.length : 40), field.text, NAME[i]);
    for (int i = 0; i < NAMES; i++)
        if (t->column[i] >= fields)
            return starg_source_fail(t->source, starg_at_line(t->line),
                                     "%d fields, and the column %s is beyond them", fields,
                                     NAME[i]);
    if (!is_good(value, NAMES))
        return starg_source_fail(t->source, starg_at_line(t->line),
                                 "numbers must be finite and below 1e100");
    if (turned && !is_turning(value + QX))
        return starg_source_fail(t->source, starg_at_line(t->line), "the rotation is 0, 0, 0, 0");
    if (!aimed)
        return push_turned(context, t->points, value, turned ? value + QX : NULL);
    vec3_subtract(value + LOOK_X, value, direction);
    if (!(vec3_length(direction) > 0))
        return starg_source_fail(t->source, starg_at_line(t->line),
                                 "it looks at the place where it stands");
    return candidates_push(context, t->points, value, direction);
}

static const char *end_of_line(const char *at, const char *stop) {
    const char *end = memchr(at, '\n', (size_t)(stop - at));
    return end != NULL ? end : stop;
}

/* The first line is one of names, with commas between them. */
bool poses_are_table(const starg_source *source) {
    table t = {.source = source};
    if (source->size == 0)
        return false;
    read_head(&t, source->bytes, end_of_line(source->bytes, source->bytes + source->size));
    return has_columns(&t, X, Z);
}

starg_status poses_read_table(const starg_source *source, candidate_points *points) {
    table t = {.source = source, .points = points, .line = 1};
    const char *stop = source->bytes + source->size;
    const char *end = end_of_line(source->bytes, stop);
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_c_locale_enter(source->context, &locale));
    read_head(&t, source->bytes, end);
    while (end < stop) {
        const char *at = end + 1;
        end = end_of_line(at, stop);
        t.line++;
        bool empty = true;
        for (const char *c = at; c < end && empty; c++)
            empty = strchr(" \t\r", *c) != NULL;
        if (!empty && *at != '#')
            TRY(read_row(&t, at, end));
    }
    return STARG_OK;
}

/* ---- JSON ---- */

static bool take_numbers(const json_t *list, double *out, size_t count) {
    if (!json_is_array(list) || json_array_size(list) != count)
        return false;
    for (size_t i = 0; i < count; i++) {
        if (!json_is_number(json_array_get(list, i)))
            return false;
        out[i] = json_number_value(json_array_get(list, i));
    }
    return is_good(out, count);
}

static starg_status read_pose(const starg_source *source, const json_t *pose, size_t index,
                              candidate_points *points) {
    double p[3], q[4];
    const json_t *rotation = json_object_get(pose, "rotation");
    if (!take_numbers(json_object_get(pose, "position"), p, 3))
        return starg_source_fail(source, starg_at_file(),
                                 "pose %zu has no position of three numbers", index);
    if (rotation != NULL && (!take_numbers(rotation, q, 4) || !is_turning(q)))
        return starg_source_fail(source, starg_at_file(),
                                 "the rotation of pose %zu is no quaternion of four numbers",
                                 index);
    return push_turned(source->context, points, p, rotation != NULL ? q : NULL);
}

/* A JSON of poses names them; the results of guards name guards. */
bool poses_are_json(const json_t *root) {
    return json_is_array(json_object_get(root, "poses"));
}

starg_status poses_read_json(const starg_source *source, const json_t *root,
                             candidate_points *points) {
    const json_t *poses = json_object_get(root, "poses");
    for (size_t i = 0; i < json_array_size(poses); i++)
        TRY(read_pose(source, json_array_get(poses, i), i, points));
    return STARG_OK;
}

/* ---- binary glTF ---- */

enum { GLB_HEAD = 20, MOST_DEPTH = 1000 };

static size_t word_at(const starg_source *source, size_t at) {
    const unsigned char *b = (const unsigned char *)source->bytes + at;
    return (size_t)b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
}

bool poses_are_glb(const starg_source *source) {
    return source->size >= GLB_HEAD && memcmp(source->bytes, "glTF", 4) == 0;
}

/* The images of the axes, and of the origin. */
typedef struct placement {
    double axis[3][3], origin[3];
} placement;

static void apply(const placement *m, const double v[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = v[0] * m->axis[0][k] + v[1] * m->axis[1][k] + v[2] * m->axis[2][k];
}

/* The transform of a node; false: it is none. */
static bool place_node(const json_t *node, placement *out) {
    double all[16], q[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    const json_t *matrix = json_object_get(node, "matrix");
    const json_t *rotation = json_object_get(node, "rotation");
    const json_t *shift = json_object_get(node, "translation"),
                 *size = json_object_get(node, "scale");
    *out = (placement){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
    if (matrix != NULL) {
        if (!take_numbers(matrix, all, 16))
            return false;
        for (int c = 0; c < 3; c++)
            vec3_copy(all + 4 * c, out->axis[c]);
        vec3_copy(all + 12, out->origin);
        return true;
    }
    if ((rotation != NULL && (!take_numbers(rotation, q, 4) || !is_turning(q))) ||
        (shift != NULL && !take_numbers(shift, out->origin, 3)) ||
        (size != NULL && !take_numbers(size, scale, 3)))
        return false;
    for (int c = 0; c < 3; c++) {
        const double unit[3] = {c == 0, c == 1, c == 2};
        turn(q, unit, out->axis[c]);
        for (int k = 0; k < 3; k++)
            out->axis[c][k] *= scale[c];
    }
    return true;
}

/* inner, then outer. */
static void compose(const placement *outer, placement *inner) {
    placement all;
    for (int c = 0; c < 3; c++)
        apply(outer, inner->axis[c], all.axis[c]);
    apply(outer, inner->origin, all.origin);
    for (int k = 0; k < 3; k++)
        all.origin[k] += outer->origin[k];
    *inner = all;
}

static starg_status push_camera(const starg_source *source, const placement *m, size_t node,
                                candidate_points *points) {
    double ahead[3], above[3], across[3];
    for (int k = 0; k < 3; k++)
        ahead[k] = -m->axis[2][k];
    vec3_copy(m->axis[1], above);
    double lengths[2] = {vec3_length(ahead), vec3_length(above)};
    for (int k = 0; k < 3; k++) {
        ahead[k] /= lengths[0];
        above[k] /= lengths[1];
    }
    vec3_cross(ahead, above, across);
    if (!is_good(ahead, 3) || !is_good(above, 3) || !is_good(m->origin, 3) ||
        !(vec3_length(across) > 0))
        return starg_source_fail(source, starg_at_file(),
                                 "the camera of node %zu has no orientation", node);
    return candidates_push_pose(source->context, points, m->origin, ahead, above);
}

static starg_status list_parents(const starg_source *source, const json_t *nodes, size_t *parent) {
    size_t count = json_array_size(nodes);
    for (size_t i = 0; i < count; i++)
        parent[i] = SIZE_MAX;
    for (size_t i = 0; i < count; i++) {
        const json_t *children = json_object_get(json_array_get(nodes, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            json_int_t child = json_integer_value(json_array_get(children, k));
            if (child < 0 || (size_t)child >= count)
                return starg_source_fail(source, starg_at_file(), "node %zu has no child %lld", i,
                                         (long long)child);
            parent[child] = i;
        }
    }
    return STARG_OK;
}

static starg_status read_cameras(const starg_source *source, const json_t *nodes,
                                 candidate_points *points) {
    SCOPED size_t *parent = NULL;
    NEW(source->context, STAGE, parent, json_array_size(nodes) + 1);
    TRY(list_parents(source, nodes, parent));
    for (size_t i = 0; i < json_array_size(nodes); i++) {
        placement all, outer;
        if (json_object_get(json_array_get(nodes, i), "camera") == NULL)
            continue;
        bool good = place_node(json_array_get(nodes, i), &all);
        size_t depth = 0;
        for (size_t n = parent[i]; n != SIZE_MAX && good; n = parent[n]) {
            good = ++depth < MOST_DEPTH && place_node(json_array_get(nodes, n), &outer);
            if (good)
                compose(&outer, &all);
        }
        if (!good)
            return starg_source_fail(source, starg_at_file(),
                                     "the transform of camera node %zu, or of one above it, is "
                                     "not usable",
                                     i);
        TRY(push_camera(source, &all, i, points));
    }
    if (candidates_count(points) == 0)
        return starg_source_fail(source, starg_at_file(), "there are no cameras in this scene");
    return STARG_OK;
}

starg_status poses_read_glb(const starg_source *source, candidate_points *points) {
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    size_t size = word_at(source, 12);
    if (word_at(source, 4) != 2 || memcmp(source->bytes + 16, "JSON", 4) != 0 ||
        size > source->size - GLB_HEAD)
        return starg_source_fail(source, starg_at_file(), "this is no binary glTF 2.0");
    TRY(starg_json_parse(source->context, STAGE, source->name, source->bytes + GLB_HEAD, size,
                         &root));
    return read_cameras(source, json_object_get(root, "nodes"), points);
}
