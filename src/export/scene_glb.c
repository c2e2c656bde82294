/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as binary glTF 2.0. The model is coloured by how many guards see its faces, as far as
 * that is known. Below the root, which is moved to the middle of all, stand the nodes "model" with
 * its groups, "obstacles", "guards" with "guard_0000" and so on, each with its "camera_0000" if it
 * looks one way, "pieces" with "piece_0000" and so on, "skeleton". What results say about a guard
 * or a piece is in the extras of its node.
 *
 * Numbers stand in one view for each kind, of which accessors take ranges: all pieces share their
 * vertices, and all guards one ball. There are no normals, so that programs shade each face flat,
 * as the format demands. Stages: the views are listed; the JSON is built, views first; the numbers
 * are put. Cost: that of the output. */
#include <math.h>

#include "export/export.h"
#include "mesh/mesh.h"
#include "starguard/picture.h"

static const char STAGE[] = "scene";

enum { MODE_POINTS = 0, MODE_LINES = 1, MODE_TRIANGLES = 4 };

/* ---- views ---- */

typedef enum view_kind {
    VIEW_MODEL_POINTS,
    VIEW_MODEL_FACES,
    VIEW_OBSTACLE_POINTS,
    VIEW_OBSTACLE_FACES,
    VIEW_PIECE_POINTS,
    VIEW_PIECE_FACES,
    VIEW_BALL_POINTS,
    VIEW_BALL_FACES,
    VIEW_NODE_POINTS,
    VIEW_NODE_RADII,
    VIEW_NODE_EDGES,
    VIEW_KINDS,
    VIEW_NONE = VIEW_KINDS /* empty */
} view_kind;

/* Where the numbers of a view are; `reals` or `words`. */
typedef struct view {
    const double *reals;
    const uint32_t *words, *through; /* reals are those of these vertices, or NULL: of all */
    size_t count;                    /* vertices, radii, or indices                        */
    bool centered;                   /* positions, from the middle of all                  */
    json_int_t index;                /* in the file; -1: empty and left out                */
} view;

typedef struct glb_scene {
    const scene_job *job;
    scene_ball ball;
    view views[VIEW_KINDS + 1];
    uint32_t *sorted;     /* faces of the model: by group, those of none first, then by times */
    size_t *start;        /* of each part in it, in corners, and the end */
    size_t groups, times; /* how many of both, at least 1 */
    json_int_t looks[SCENE_TIMES]; /* materials of the parts, or -1 */
    size_t bytes;
    bool failed; /* memory was out while JSON was made */
    json_t *root, *nodes, *meshes, *materials, *accessors, *buffer_views, *cameras;
} glb_scene;

/* The part of the model that a face belongs to. */
static size_t part_of(const glb_scene *s, size_t face) {
    const scene_job *job = s->job;
    const starg_face_groups *groups = job->scene->groups;
    bool grouped = groups != NULL && groups->of[face] != UINT32_MAX;
    return (grouped ? groups->of[face] + (size_t)1 : 0) * s->times +
           (job->times != NULL ? job->times[face] : 0);
}

/* Sorts the faces of the model by groups and by how many guards see them. */
static starg_status sort_faces(starg_context *context, glb_scene *s) {
    const scene_job *job = s->job;
    if (job->model_faces == 0)
        return STARG_OK;
    const uint32_t *faces = starg_mesh_faces(job->scene->model);
    s->groups = 1 + (job->scene->groups != NULL ? job->scene->groups->count : 0);
    s->times = job->times != NULL ? SCENE_TIMES : 1;
    NEW(context, STAGE, s->sorted, 3 * job->model_faces);
    NEW_ZERO(context, STAGE, s->start, s->groups * s->times + 1);
    for (size_t f = 0; f < job->model_faces; f++)
        s->start[part_of(s, f) + 1] += 3;
    for (size_t p = 0; p < s->groups * s->times; p++)
        s->start[p + 1] += s->start[p];
    SCOPED size_t *at = NULL;
    NEW(context, STAGE, at, s->groups * s->times);
    memcpy(at, s->start, s->groups * s->times * sizeof *at);
    for (size_t f = 0; f < job->model_faces; f++)
        for (size_t c = 0, *place = &at[part_of(s, f)]; c < 3; c++)
            s->sorted[(*place)++] = faces[3 * f + c];
    return STARG_OK;
}

static bool is_points(view_kind kind) {
    return kind == VIEW_MODEL_POINTS || kind == VIEW_OBSTACLE_POINTS || kind == VIEW_PIECE_POINTS ||
           kind == VIEW_BALL_POINTS || kind == VIEW_NODE_POINTS;
}

static void list_views(glb_scene *s) {
    const scene_job *job = s->job;
    const starg_scene *scene = job->scene;
    const starg_piece_surfaces *pieces = &job->surfaces;
    view *v = s->views;
    if (job->model_faces > 0) {
        v[VIEW_MODEL_POINTS] = (view){.reals = starg_mesh_vertices(scene->model),
                                      .count = job->model_vertices,
                                      .centered = true};
        v[VIEW_MODEL_FACES] = (view){.words = s->sorted, .count = 3 * job->model_faces};
    }
    if (job->obstacle_faces > 0) {
        v[VIEW_OBSTACLE_POINTS] = (view){.reals = starg_mesh_vertices(scene->obstacles),
                                         .count = job->obstacle_vertices,
                                         .centered = true};
        v[VIEW_OBSTACLE_FACES] =
            (view){.words = starg_mesh_faces(scene->obstacles), .count = 3 * job->obstacle_faces};
    }
    if (pieces->piece_count > 0) {
        v[VIEW_PIECE_POINTS] = (view){.reals = scene->pieces->vertices,
                                      .through = pieces->vertices,
                                      .count = pieces->vertex_count,
                                      .centered = true};
        v[VIEW_PIECE_FACES] =
            (view){.words = pieces->faces, .count = 3 * pieces->first_face[pieces->piece_count]};
    }
    if (job->guards > 0) {
        v[VIEW_BALL_POINTS] = (view){.reals = s->ball.vertices, .count = BALL_VERTICES};
        v[VIEW_BALL_FACES] = (view){.words = s->ball.faces, .count = 3 * BALL_FACES};
    }
    if (job->nodes > 0) {
        v[VIEW_NODE_POINTS] =
            (view){.reals = scene->skeleton->positions, .count = job->nodes, .centered = true};
        if (scene->skeleton->radii != NULL)
            v[VIEW_NODE_RADII] = (view){.reals = scene->skeleton->radii, .count = job->nodes};
        v[VIEW_NODE_EDGES] = (view){.words = scene->skeleton->edges, .count = 2 * job->edges};
    }
}

/* A coordinate of a vertex, or a radius, as the file holds it. */
static float real_of(const glb_scene *s, view_kind kind, size_t i, size_t k) {
    const view *v = &s->views[kind];
    if (!is_points(kind))
        return (float)v->reals[i];
    size_t vertex = v->through != NULL ? v->through[i] : i;
    double scale = kind == VIEW_BALL_POINTS ? scene_ball_radius(s->job) : 1;
    return (float)(scale * (v->reals[3 * vertex + k] - (v->centered ? s->job->center[k] : 0)));
}

static size_t view_bytes(const glb_scene *s, view_kind kind) {
    return s->views[kind].count * (is_points(kind) ? 12 : 4);
}

static starg_status check_range(starg_context *context, const glb_scene *s) {
    if (s->job->size < GLB_LIMIT)
        return STARG_OK;
    return starg_fail(
        context, STARG_ERROR_RANGE, STAGE,
        "an extent of %g exceeds the single precision of this format; write .vtu, .ply or .obj",
        s->job->size);
}

/* Does single precision keep a part? `faces` may be of no view: points alone. */
static starg_status check_part(starg_context *context, const glb_scene *s, view_kind points,
                               view_kind faces, const char *name) {
    const view *v = &s->views[points], *f = &s->views[faces];
    const single_place place = {.stage = STAGE, .what = name, .remedy = "write .vtu, .ply or .obj"};
    SCOPED double *all = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *part = NULL;
    NEW(context, STAGE, all, 3 * v->count);
    for (size_t i = 0; i < v->count; i++)
        memcpy(all + 3 * i, v->reals + 3 * (v->through != NULL ? v->through[i] : i),
               3 * sizeof *all);
    TRY(starg_mesh_create(context, all, v->count, f->words, f->count / 3, &part));
    return single_check(context, part, s->job->center, &place);
}

static starg_status check_parts(starg_context *context, const glb_scene *s) {
    TRY(check_part(context, s, VIEW_MODEL_POINTS, VIEW_MODEL_FACES, "the model"));
    TRY(check_part(context, s, VIEW_OBSTACLE_POINTS, VIEW_OBSTACLE_FACES, "obstacles"));
    TRY(check_part(context, s, VIEW_PIECE_POINTS, VIEW_PIECE_FACES, "pieces"));
    return check_part(context, s, VIEW_NODE_POINTS, VIEW_NONE, "the skeleton");
}

/* ---- JSON ---- */

/* Appends a value, which is consumed; its index. */
static json_int_t append(glb_scene *s, json_t *list, json_t *value) {
    json_int_t index = (json_int_t)json_array_size(list);
    if (json_array_append_new(list, value) != 0)
        s->failed = true;
    return index;
}

static void put(glb_scene *s, json_t *object, const char *key, json_t *value) {
    if (json_object_set_new(object, key, value) != 0)
        s->failed = true;
}

static void describe_views(glb_scene *s) {
    for (view_kind kind = 0; kind < VIEW_KINDS; kind++) {
        view *v = &s->views[kind];
        v->index = -1;
        if (v->count == 0)
            continue;
        bool corners = v->words != NULL;
        v->index =
            append(s, s->buffer_views,
                   json_pack("{s:i, s:I, s:I, s:i}", "buffer", 0, "byteOffset",
                             (json_int_t)s->bytes, "byteLength", (json_int_t)view_bytes(s, kind),
                             "target", corners ? GLB_ELEMENT_ARRAY_BUFFER : GLB_ARRAY_BUFFER));
        s->bytes += view_bytes(s, kind);
    }
}

/* An accessor of `count` indices from `first` on. */
static json_int_t add_indices(glb_scene *s, view_kind kind, size_t first, size_t count) {
    return append(s, s->accessors,
                  json_pack("{s:I, s:I, s:i, s:I, s:s}", "bufferView", s->views[kind].index,
                            "byteOffset", 4 * (json_int_t)first, "componentType", GLB_UNSIGNED_INT,
                            "count", (json_int_t)count, "type", "SCALAR"));
}

static json_t *triple(const double x[3]) {
    return json_pack("[f, f, f]", x[0], x[1], x[2]);
}

/* An accessor of all of a view of reals; positions have their box, as the file holds it. With fmin
 * and fmax, gcc 12 for aarch64 breaks off at -O3. */
static json_int_t add_reals(glb_scene *s, view_kind kind) {
    const view *v = &s->views[kind];
    json_t *accessor =
        json_pack("{s:I, s:i, s:I, s:s}", "bufferView", v->index, "componentType", GLB_FLOAT,
                  "count", (json_int_t)v->count, "type", is_points(kind) ? "VEC3" : "SCALAR");
    if (is_points(kind)) {
        double lower[3], upper[3];
        for (size_t k = 0; k < 3; k++) {
            lower[k] = upper[k] = (double)real_of(s, kind, 0, k);
            for (size_t i = 1; i < v->count; i++) {
                double x = (double)real_of(s, kind, i, k);
                lower[k] = x < lower[k] ? x : lower[k];
                upper[k] = x > upper[k] ? x : upper[k];
            }
        }
        put(s, accessor, "min", triple(lower));
        put(s, accessor, "max", triple(upper));
    }
    return append(s, s->accessors, accessor);
}

/* glTF takes linear colours. */
static double linear(uint8_t value) {
    double x = value / 255.0;
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

static json_int_t add_material(glb_scene *s, const uint8_t rgb[3], double opacity) {
    json_t *material =
        json_pack("{s:{s:[f, f, f, f], s:f, s:f}, s:b}", "pbrMetallicRoughness", "baseColorFactor",
                  linear(rgb[0]), linear(rgb[1]), linear(rgb[2]), opacity, "metallicFactor", 0.0,
                  "roughnessFactor", 0.8, "doubleSided", 1);
    if (opacity < 1)
        put(s, material, "alphaMode", json_string("BLEND"));
    return append(s, s->materials, material);
}

/* `indices` below 0: the points themselves. */
static json_t *primitive(glb_scene *s, json_int_t positions, json_int_t indices, int mode,
                         json_int_t material) {
    json_t *own = json_pack("{s:{s:I}, s:i, s:I}", "attributes", "POSITION", positions, "mode",
                            mode, "material", material);
    if (indices >= 0)
        put(s, own, "indices", json_integer(indices));
    return own;
}

/* A mesh of one primitive. */
static json_int_t add_mesh(glb_scene *s, json_int_t positions, json_int_t indices, int mode,
                           json_int_t material) {
    return append(
        s, s->meshes,
        json_pack("{s:[o]}", "primitives", primitive(s, positions, indices, mode, material)));
}

/* The material of faces that so many guards see, or of the model where that is not known. */
static json_int_t look_of(glb_scene *s, size_t times, bool alone) {
    static const char *const names[SCENE_TIMES] = {"seen by none", "seen by 1", "seen by 2",
                                                   "seen by 3 or more", "need not be seen"};
    uint8_t rgb[3];
    if (s->looks[times] >= 0)
        return s->looks[times];
    if (s->times == 1)
        return s->looks[times] = add_material(s, SCENE_NEUTRAL, alone ? 1 : 0.3);
    scene_count_color(times, rgb);
    s->looks[times] = add_material(s, rgb, 0.45);
    put(s, json_array_get(s->materials, (size_t)s->looks[times]), "name",
        json_string(names[times]));
    return s->looks[times];
}

/* The mesh of a group, a primitive for each number of guards; -1: it has no faces. */
static json_int_t add_group(glb_scene *s, json_int_t positions, size_t group, bool alone) {
    json_t *list = json_array();
    for (size_t k = 0; k < s->times; k++) {
        const size_t *start = s->start + group * s->times + k;
        if (start[1] > start[0])
            append(s, list,
                   primitive(s, positions,
                             add_indices(s, VIEW_MODEL_FACES, start[0], start[1] - start[0]),
                             MODE_TRIANGLES, look_of(s, k, alone)));
    }
    if (json_array_size(list) > 0)
        return append(s, s->meshes, json_pack("{s:o}", "primitives", list));
    json_decref(list);
    return -1;
}

/* A node below another. */
static json_t *add_node(glb_scene *s, json_t *parent, const char *name, size_t number,
                        json_int_t mesh) {
    char text[64];
    json_t *children = json_object_get(parent, "children");
    if (number == SIZE_MAX)
        snprintf(text, sizeof text, "%s", name);
    else
        snprintf(text, sizeof text, "%s_%04zu", name, number);
    json_t *node = json_pack("{s:s}", "name", text);
    if (mesh >= 0)
        put(s, node, "mesh", json_integer(mesh));
    if (children == NULL) {
        put(s, parent, "children", json_array());
        children = json_object_get(parent, "children");
    }
    append(s, children, json_integer(append(s, s->nodes, node)));
    return node;
}

/* ---- parts ---- */

static void add_model(glb_scene *s) {
    const scene_job *job = s->job;
    if (job->model_faces == 0)
        return;
    bool alone = job->guards + job->surfaces.piece_count + job->nodes == 0;
    for (size_t k = 0; k < SCENE_TIMES; k++)
        s->looks[k] = -1;
    json_int_t points = add_reals(s, VIEW_MODEL_POINTS);
    json_t *parent = NULL;
    for (size_t g = 0; g < s->groups; g++) {
        json_int_t mesh = add_group(s, points, g, alone);
        if (g == 0)
            parent = add_node(s, s->root, "model", SIZE_MAX, mesh);
        if (g == 0 || mesh < 0)
            continue;
        json_t *node = add_node(s, parent, "group", g - 1, mesh);
        json_t *name = json_string(job->scene->groups->names[g - 1]); /* NULL: no UTF-8 */
        if (name != NULL)
            put(s, node, "name", name);
    }
}

/* A node of its own, which programs hide and show. */
static void add_obstacles(glb_scene *s) {
    if (s->job->obstacle_faces == 0)
        return;
    json_int_t points = add_reals(s, VIEW_OBSTACLE_POINTS);
    json_int_t faces = add_indices(s, VIEW_OBSTACLE_FACES, 0, 3 * s->job->obstacle_faces);
    json_int_t material = add_material(s, SCENE_IN_THE_WAY, 0.6);
    add_node(s, s->root, "obstacles", SIZE_MAX,
             add_mesh(s, points, faces, MODE_TRIANGLES, material));
}

static void describe_guard(glb_scene *s, json_t *node, size_t index) {
    const starg_guards *g = s->job->scene->guards;
    double place[3];
    for (size_t k = 0; k < 3; k++)
        place[k] = g->positions[3 * index + k] - s->job->center[k];
    json_t *extras =
        json_pack("{s:I, s:i, s:o}", "faces", (json_int_t)g->seen_faces[index], "level",
                  g->levels[index], "position", triple(g->positions + 3 * index));
    if (g->directions != NULL)
        put(s, extras, "direction", triple(g->directions + 3 * index));
    put(s, node, "translation", triple(place));
    put(s, node, "extras", extras);
}

/* A camera at the guard, which looks the same way: with its field of view, or with one that holds
 * its cone. Wider than WIDEST degrees none can be. */
static void add_camera(glb_scene *s, json_t *node, size_t index) {
    const double WIDEST = 170, DEGREE = 3.14159265358979323846 / 180;
    const starg_guards *g = s->job->scene->guards;
    const starg_visibility_options *o = &g->options.visibility;
    double q[4], size = s->job->size, yfov = fmin(o->cone, WIDEST), aspect = 1;
    if (!starg_guards_rotation(g, index, q))
        return;
    if (o->fov[0] > 0) {
        yfov = o->fov[1];
        aspect = tan(0.5 * o->fov[0] * DEGREE) / tan(0.5 * o->fov[1] * DEGREE);
    }
    json_t *lens = json_pack("{s:f, s:f, s:f, s:f}", "yfov", yfov * DEGREE, "aspectRatio", aspect,
                             "znear", fmax(o->near, 1e-3 * size), "zfar",
                             o->range < 1e100 ? fmax(o->range, 2e-3 * size) : 4 * size);
    char name[32];
    snprintf(name, sizeof name, "camera_%04zu", index);
    json_int_t camera = append(
        s, s->cameras,
        json_pack("{s:s, s:s, s:o}", "name", name, "type", "perspective", "perspective", lens));
    json_t *eye = add_node(s, node, "camera", index, -1);
    put(s, eye, "camera", json_integer(camera));
    put(s, eye, "rotation", json_pack("[f, f, f, f]", q[0], q[1], q[2], q[3]));
}

static void add_guards(glb_scene *s) {
    if (s->job->guards == 0)
        return;
    json_int_t points = add_reals(s, VIEW_BALL_POINTS);
    json_int_t faces = add_indices(s, VIEW_BALL_FACES, 0, 3 * BALL_FACES);
    json_t *parent = add_node(s, s->root, "guards", SIZE_MAX, -1);
    for (size_t g = 0; g < s->job->guards; g++) {
        uint8_t rgb[3];
        starg_distinct_color(g, rgb);
        json_int_t mesh = add_mesh(s, points, faces, MODE_TRIANGLES, add_material(s, rgb, 1));
        json_t *node = add_node(s, parent, "guard", g, mesh);
        describe_guard(s, node, g);
        add_camera(s, node, g);
    }
}

static void add_piece(glb_scene *s, json_t *parent, json_int_t points, size_t index) {
    const size_t *first = s->job->surfaces.first_face + index;
    const starg_pieces_report *report = s->job->scene->report;
    uint8_t rgb[3];
    if (first[0] == first[1])
        return; /* a label that no tetrahedron has */
    starg_distinct_color(index, rgb);
    json_int_t faces = add_indices(s, VIEW_PIECE_FACES, 3 * first[0], 3 * (first[1] - first[0]));
    json_int_t mesh = add_mesh(s, points, faces, MODE_TRIANGLES, add_material(s, rgb, 1));
    json_t *node = add_node(s, parent, "piece", index, mesh);
    if (report != NULL)
        put(s, node, "extras",
            json_pack("{s:o, s:f, s:b}", "guard", triple(report->pieces[index].guard), "volume",
                      report->pieces[index].volume, "star", (int)report->pieces[index].star));
}

static void add_pieces(glb_scene *s) {
    if (s->job->surfaces.piece_count == 0)
        return;
    json_int_t points = add_reals(s, VIEW_PIECE_POINTS);
    json_t *parent = add_node(s, s->root, "pieces", SIZE_MAX, -1);
    for (size_t p = 0; p < s->job->surfaces.piece_count; p++)
        add_piece(s, parent, points, p);
}

static void add_skeleton(glb_scene *s) {
    const scene_job *job = s->job;
    if (job->nodes == 0)
        return;
    bool lines = job->edges > 0;
    json_int_t points = add_reals(s, VIEW_NODE_POINTS);
    json_int_t edges = lines ? add_indices(s, VIEW_NODE_EDGES, 0, 2 * job->edges) : -1;
    json_int_t mesh = add_mesh(s, points, edges, lines ? MODE_LINES : MODE_POINTS,
                               add_material(s, SCENE_CURVE, 1));
    if (s->views[VIEW_NODE_RADII].count > 0) {
        json_t *primitives = json_object_get(json_array_get(s->meshes, (size_t)mesh), "primitives");
        put(s, json_object_get(json_array_get(primitives, 0), "attributes"), "_RADIUS",
            json_integer(add_reals(s, VIEW_NODE_RADII)));
    }
    add_node(s, s->root, "skeleton", SIZE_MAX, mesh);
}

/* All of it; NULL when memory is out. */
static json_t *describe(glb_scene *s) {
    s->nodes = json_array();
    s->meshes = json_array();
    s->materials = json_array();
    s->accessors = json_array();
    s->buffer_views = json_array();
    s->cameras = json_array();
    s->root = json_pack("{s:s, s:o}", "name", "starguard", "translation", triple(s->job->center));
    append(s, s->nodes, s->root);
    describe_views(s);
    add_model(s);
    add_obstacles(s);
    add_guards(s);
    add_pieces(s);
    add_skeleton(s);
    json_t *json = json_pack("{s:{s:s, s:s}, s:i, s:[{s:[i]}], s:o, s:o, s:o, s:o, s:o, s:[{s:I}]}",
                             "asset", "version", "2.0", "generator", "starguard", "scene", 0,
                             "scenes", "nodes", 0, "nodes", s->nodes, "meshes", s->meshes,
                             "materials", s->materials, "accessors", s->accessors, "bufferViews",
                             s->buffer_views, "buffers", "byteLength", (json_int_t)s->bytes);
    if (json_array_size(s->cameras) > 0)
        put(s, json, "cameras", json_incref(s->cameras));
    json_decref(s->cameras);
    if (!s->failed)
        return json;
    json_decref(json);
    return NULL;
}

/* ---- numbers ---- */

static void put_numbers(FILE *stream, const void *user) {
    const glb_scene *s = user;
    for (view_kind kind = 0; kind < VIEW_KINDS; kind++)
        for (size_t i = 0; i < s->views[kind].count; i++) {
            if (s->views[kind].words != NULL)
                little_put_word(stream, s->views[kind].words[i]);
            else
                for (size_t k = 0; k < (is_points(kind) ? 3 : 1); k++)
                    little_put_float(stream, real_of(s, kind, i, k));
        }
}

starg_status scene_write_glb(starg_context *context, const scene_job *job, const char *path) {
    starg_status status = STARG_OK;
    json_t *json = NULL;
    glb_scene s = {.job = job};
    scene_ball_make(&s.ball);
    STARG_TRY(sort_faces(context, &s));
    list_views(&s);
    STARG_TRY(check_range(context, &s));
    STARG_TRY(check_parts(context, &s));
    json = describe(&s);
    STARG_TRY(glb_write(context, STAGE, path, json, s.bytes, put_numbers, &s));
done:
    json_decref(json);
    RELEASE(s.sorted, s.start);
    return status;
}
