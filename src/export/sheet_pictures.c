/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of a sheet.
 *
 * Both are drawn by the renderer of pictures (export/raster.c), to which a scene is handed in
 * samples. Through a lens, a point goes to its place divided by its depth; depth itself becomes a
 * multiple of 1 / depth, which is linear over the picture of a plane, as the renderer takes it to
 * be. Triangles and lines are cut off just before the eye; those beside the view are left out.
 *
 * The plan looks down, without perspective, at what looks up: floors and tables. What lies wholly
 * above the highest guard, such as a roof, is left out.
 *
 * Cost: that of the faces, and of the samples that they cover. */
#include "export/export.h"

#include <math.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "guard/stages.h"
#include "starguard/picture.h"

static const char STAGE[] = "sheet";
static const double DEGREE = 3.14159265358979323846 / 180;
static const double EYE = 1e-4; /* where sight begins, as a part of the size of all */

enum { LENS_WIDTH = 480, LENS_TALLEST = 640, LENS_LOWEST = 120, PLAN_SIDE = 1400, MARGIN = 40 };

/* A scene in the making. */
typedef struct canvas {
    starg_context *context;
    size_t width, height; /* pixels */
    STARG_ARRAY(double) positions;
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(float) normals;
    STARG_ARRAY(uint8_t) colors;
    STARG_ARRAY(uint32_t) lines;
} canvas;

static void canvas_free(canvas *c) {
    RELEASE(c->positions.data, c->faces.data, c->normals.data, c->colors.data, c->lines.data);
}

static starg_status push_point(canvas *c, const double p[3], uint32_t *index) {
    *index = (uint32_t)(c->positions.count / 3);
    for (int k = 0; k < 3; k++)
        PUSH(c->context, STAGE, &c->positions, p[k]);
    return STARG_OK;
}

/* Corners as the renderer takes them; the normal of all of them, with y up. */
static starg_status push_triangle(canvas *c, const double *const corner[3], const double normal[3],
                                  const uint8_t rgb[3]) {
    for (int k = 0; k < 3; k++) {
        uint32_t index;
        TRY(push_point(c, corner[k], &index));
        PUSH(c->context, STAGE, &c->faces, index);
        for (int i = 0; i < 3; i++)
            PUSH(c->context, STAGE, &c->normals, (float)normal[i]);
        PUSH(c->context, STAGE, &c->colors, rgb[k]);
    }
    return STARG_OK;
}

static starg_status push_line(canvas *c, const double a[3], const double b[3]) {
    uint32_t ends[2];
    TRY(push_point(c, a, &ends[0]));
    TRY(push_point(c, b, &ends[1]));
    PUSH(c->context, STAGE, &c->lines, ends[0]);
    PUSH(c->context, STAGE, &c->lines, ends[1]);
    return STARG_OK;
}

static starg_status finish(const canvas *c, double line_radius, sheet_picture *out) {
    SCOPED uint8_t *rgb = NULL;
    const starg_raster_scene scene = {.width = c->width,
                                      .height = c->height,
                                      .positions = c->positions.data,
                                      .faces = c->faces.data,
                                      .face_count = c->faces.count / 3,
                                      .normals = c->normals.data,
                                      .face_colors = c->colors.data,
                                      .opacity = 1,
                                      .lines = c->lines.data,
                                      .line_count = c->lines.count / 2,
                                      .line_radius = line_radius * STARG_RASTER_SAMPLES};
    NEW(c->context, STAGE, rgb, 3 * c->width * c->height);
    TRY(starg_raster_draw(c->context, &scene, rgb));
    *out = (sheet_picture){.width = c->width, .height = c->height};
    return starg_png_encode(c->context, rgb, c->width, c->height, &out->png, &out->size);
}

/* ---- what is drawn ---- */

static const starg_solid *scene_of(const sheet_scene *s) {
    return &s->table->patched.solid;
}

static const double *corner_of(const starg_mesh *mesh, size_t face, size_t k) {
    return mesh->vertices + 3 * (size_t)mesh->faces[3 * face + k];
}

static bool is_clear(const sheet_scene *s, size_t face) {
    const uint64_t *clear = scene_of(s)->clear;
    return clear != NULL && starg_bit_test(clear, face);
}

/* The same edges for every picture: creases of the model as it was given. */
static starg_status find_edges(starg_context *context, const starg_mesh *mesh, size_t faces,
                               starg_features *out) {
    return starg_features_create(context, mesh->vertices, mesh->vertex_count, mesh->faces, faces,
                                 out);
}

/* ---- through a lens ---- */

typedef struct lens {
    double place[3], frame[3][3]; /* right, above, ahead */
    double size;                  /* of all that is drawn */
    double across, up;            /* tangents of half the angles */
    double half[2], depth;        /* of the picture in samples; that of depth 1 */
} lens;

static void see_point(const lens *l, const double p[3], double out[3]) {
    double line[3];
    vec3_subtract(p, l->place, line);
    for (int k = 0; k < 3; k++)
        out[k] = vec3_dot(line, l->frame[k]) / l->size;
}

static void to_samples(const lens *l, const double p[3], double out[3]) {
    out[0] = l->half[0] * (1 + p[0] / (p[2] * l->across));
    out[1] = l->half[1] * (1 - p[1] / (p[2] * l->up));
    out[2] = l->depth / p[2];
}

/* Are all of the points on the far side of one of the limits? */
static bool is_beside(const lens *l, const double (*p)[3], int count) {
    int out[5] = {0};
    for (int i = 0; i < count; i++) {
        out[0] += p[i][2] < EYE;
        out[1] += p[i][0] > p[i][2] * l->across;
        out[2] += -p[i][0] > p[i][2] * l->across;
        out[3] += p[i][1] > p[i][2] * l->up;
        out[4] += -p[i][1] > p[i][2] * l->up;
    }
    return out[0] == count || out[1] == count || out[2] == count || out[3] == count ||
           out[4] == count;
}

static void cut(const double a[3], const double b[3], double out[3]) {
    double t = (EYE - a[2]) / (b[2] - a[2]);
    for (int k = 0; k < 2; k++)
        out[k] = a[k] + t * (b[k] - a[k]);
    out[2] = EYE;
}

static starg_status see_triangle(canvas *c, const lens *l, const double *const corner[3],
                                 const uint8_t rgb[3]) {
    double p[3][3], kept[4][3], drawn[4][3], normal[3];
    int count = 0;
    for (int k = 0; k < 3; k++)
        see_point(l, corner[k], p[k]);
    if (is_beside(l, (const double(*)[3])p, 3))
        return STARG_OK;
    for (int k = 0; k < 3; k++) {
        const double *a = p[k], *b = p[(k + 1) % 3];
        if (a[2] >= EYE)
            vec3_copy(a, kept[count++]);
        if ((a[2] >= EYE) != (b[2] >= EYE))
            cut(a, b, kept[count++]);
    }
    /* with ahead as the third axis the frame is left-handed */
    vec3_triangle_normal(p[0], p[1], p[2], normal);
    double length = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        normal[k] = length > 0 ? (k == 2 ? normal[k] : -normal[k]) / length : k == 2;
    for (int k = 0; k < count; k++)
        to_samples(l, kept[k], drawn[k]);
    for (int k = 1; k + 1 < count; k++)
        TRY(push_triangle(c, (const double *[]){drawn[0], drawn[k], drawn[k + 1]}, normal, rgb));
    return STARG_OK;
}

static starg_status see_line(canvas *c, const lens *l, const double a[3], const double b[3]) {
    double p[2][3], ends[2][3];
    see_point(l, a, p[0]);
    see_point(l, b, p[1]);
    if (is_beside(l, (const double(*)[3])p, 2))
        return STARG_OK;
    for (int k = 0; k < 2; k++)
        if (p[k][2] < EYE)
            cut(p[k], p[1 - k], p[k]);
    to_samples(l, p[0], ends[0]);
    to_samples(l, p[1], ends[1]);
    return push_line(c, ends[0], ends[1]);
}

static double size_of(const sheet_scene *s) {
    double lower[3], upper[3];
    starg_mesh_bounds(s->shown, lower, upper);
    double size = hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
    return size > 0 ? size : 1;
}

static void aim(const sheet_scene *s, size_t guard, canvas *c, lens *l) {
    static const double none[3] = {0, 0, 0};
    const starg_guards *g = s->table->guards;
    const starg_visibility_options *o = &g->options.visibility;
    double wide = fmin(o->fov[0] > 0 ? o->fov[0] : o->cone, SHEET_WIDEST);
    double tall = fmin(o->fov[0] > 0 ? o->fov[1] : o->cone, SHEET_WIDEST);
    *l = (lens){
        .size = size_of(s), .across = tan(0.5 * wide * DEGREE), .up = tan(0.5 * tall * DEGREE)};
    vec3_copy(g->positions + 3 * guard, l->place);
    sensor_frame(g->directions + 3 * guard, g->ups != NULL ? g->ups + 3 * guard : none, l->frame);
    c->width = LENS_WIDTH;
    double height = LENS_WIDTH * l->up / l->across;
    if (height > LENS_TALLEST) {
        c->width = (size_t)fmax(LENS_LOWEST, LENS_WIDTH * LENS_TALLEST / height);
        height = LENS_TALLEST;
    }
    c->height = (size_t)fmax(LENS_LOWEST, height + 0.5);
    l->half[0] = 0.5 * (double)(c->width * STARG_RASTER_SAMPLES);
    l->half[1] = 0.5 * (double)(c->height * STARG_RASTER_SAMPLES);
    l->depth = 2 * l->half[0];
}

static starg_status see_model(const sheet_scene *s, size_t guard, const lens *l, canvas *c) {
    SCOPED_BY(starg_features_free) starg_features edges = {0};
    const starg_solid *solid = scene_of(s);
    const double *points = solid->mesh->vertices;
    uint8_t own[3], grey[3];
    scene_count_color(SCENE_NOT_WANTED, grey);
    starg_distinct_color(guard, own);
    for (int k = 0; k < 3; k++)
        own[k] = (uint8_t)(own[k] / 2 + 127);
    for (size_t j = 0; j < s->shown->face_count; j++) {
        const double *corner[3];
        size_t face = solid_patch_face(solid, j);
        bool counts =
            starg_bits_test(s->table->rows, guard, j) && solid_is_target(solid, false, face);
        for (size_t k = 0; k < 3; k++)
            corner[k] = corner_of(s->shown, j, k);
        if (!is_clear(s, face))
            TRY(see_triangle(c, l, corner, counts ? own : grey));
    }
    TRY(find_edges(c->context, solid->mesh, starg_space_model_faces(solid), &edges));
    for (size_t i = 0; i < edges.lines.count; i += 2)
        TRY(see_line(c, l, points + 3 * (size_t)edges.lines.data[i],
                     points + 3 * (size_t)edges.lines.data[i + 1]));
    return STARG_OK;
}

static starg_status see_obstacles(const sheet_scene *s, const lens *l, canvas *c) {
    SCOPED_BY(starg_features_free) starg_features edges = {0};
    const starg_mesh *mesh = s->obstacles;
    if (mesh == NULL)
        return STARG_OK;
    for (size_t f = 0; f < mesh->face_count; f++)
        TRY(see_triangle(
            c, l,
            (const double *[]){corner_of(mesh, f, 0), corner_of(mesh, f, 1), corner_of(mesh, f, 2)},
            SCENE_IN_THE_WAY));
    TRY(find_edges(c->context, mesh, mesh->face_count, &edges));
    for (size_t i = 0; i < edges.lines.count; i += 2)
        TRY(see_line(c, l, mesh->vertices + 3 * (size_t)edges.lines.data[i],
                     mesh->vertices + 3 * (size_t)edges.lines.data[i + 1]));
    return STARG_OK;
}

starg_status sheet_draw_lens(starg_context *context, const sheet_scene *scene, size_t guard,
                             sheet_picture *out) {
    SCOPED_BY(canvas_free) canvas c = {.context = context};
    lens l;
    *out = (sheet_picture){0};
    aim(scene, guard, &c, &l);
    TRY(see_model(scene, guard, &l, &c));
    TRY(see_obstacles(scene, &l, &c));
    return finish(&c, 0.6, out);
}

/* ---- from above ---- */

static double height_of(const sheet_scene *s, const double p[3]) {
    return vec3_dot(p, s->level[1]);
}

/* The highest guard; without guards, all is below. */
static double find_ceiling(const sheet_scene *s) {
    const starg_guards *g = s->table->guards;
    double highest = g->count > 0 ? -INFINITY : INFINITY;
    for (size_t i = 0; i < g->count; i++)
        highest = fmax(highest, height_of(s, g->positions + 3 * i));
    return highest;
}

static bool is_below(const sheet_scene *s, const starg_mesh *mesh, size_t face, double ceiling) {
    double lowest = INFINITY;
    for (size_t k = 0; k < 3; k++)
        lowest = fmin(lowest, height_of(s, corner_of(mesh, face, k)));
    return lowest < ceiling;
}

/* Faces of a scene look out of the free space: those that are seen from above look down. */
static bool is_floor(const sheet_scene *s, const starg_mesh *mesh, size_t face, double ceiling) {
    double normal[3];
    vec3_triangle_normal(corner_of(mesh, face, 0), corner_of(mesh, face, 1),
                         corner_of(mesh, face, 2), normal);
    return vec3_dot(normal, s->level[1]) < 0 && is_below(s, mesh, face, ceiling);
}

static void cover(const sheet_scene *s, const double *points, size_t count, double box[4]) {
    for (size_t i = 0; i < count; i++) {
        double x = vec3_dot(points + 3 * i, s->level[0]), y = vec3_dot(points + 3 * i, s->level[2]);
        box[0] = fmin(box[0], x);
        box[1] = fmin(box[1], y);
        box[2] = fmax(box[2], x);
        box[3] = fmax(box[3], y);
    }
}

/* The model and the guards, in a picture whose longer side is PLAN_SIDE. */
static void fit_plan(const sheet_scene *s, sheet_plan *plan) {
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    cover(s, s->shown->vertices, s->shown->vertex_count, box);
    cover(s, s->table->guards->positions, s->table->guards->count, box);
    double width = box[2] - box[0], height = box[3] - box[1], side = fmax(width, height);
    plan->scale = (PLAN_SIDE - 2 * MARGIN) / (side > 0 ? side : 1);
    plan->x = MARGIN - plan->scale * box[0];
    plan->y = MARGIN + plan->scale * box[3];
    plan->picture.width = (size_t)ceil(2 * MARGIN + plan->scale * width);
    plan->picture.height = (size_t)ceil(2 * MARGIN + plan->scale * height);
}

static void place(const sheet_scene *s, const sheet_plan *plan, const double p[3], double out[3]) {
    out[0] = STARG_RASTER_SAMPLES * (plan->x + plan->scale * vec3_dot(p, s->level[0]));
    out[1] = STARG_RASTER_SAMPLES * (plan->y - plan->scale * vec3_dot(p, s->level[2]));
    out[2] = STARG_RASTER_SAMPLES * plan->scale * height_of(s, p);
}

static starg_status lay_face(canvas *c, const sheet_scene *s, const sheet_plan *plan,
                             const starg_mesh *mesh, size_t face, const uint8_t rgb[3]) {
    double p[3][3];
    static const double up[3] = {0, 0, 1};
    for (size_t k = 0; k < 3; k++)
        place(s, plan, corner_of(mesh, face, k), p[k]);
    double area =
        (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    if (area < 0) /* facing the viewer */
        return push_triangle(c, (const double *[]){p[0], p[1], p[2]}, up, rgb);
    return push_triangle(c, (const double *[]){p[0], p[2], p[1]}, up, rgb);
}

static starg_status lay_model(canvas *c, const sheet_scene *s, const sheet_plan *plan,
                              double ceiling) {
    const starg_solid *solid = scene_of(s);
    for (size_t j = 0; j < s->shown->face_count; j++) {
        size_t face = solid_patch_face(solid, j), count = 0;
        uint8_t rgb[3];
        if (!is_floor(s, s->shown, j, ceiling) || is_clear(s, face))
            continue;
        for (size_t i = 0; i < s->table->rows->rows && count < SCENE_MOST_TIMES; i++)
            count += starg_bits_test(s->table->rows, i, j);
        scene_count_color(solid_is_target(solid, false, face) ? count : SCENE_NOT_WANTED, rgb);
        TRY(lay_face(c, s, plan, s->shown, j, rgb));
    }
    return STARG_OK;
}

/* Edges of what looks up, of the faces as they were given. */
static starg_status lay_edges(canvas *c, const sheet_scene *s, const sheet_plan *plan,
                              double ceiling) {
    SCOPED_BY(starg_features_free) starg_features edges = {0};
    SCOPED STARG_ARRAY(uint32_t) floors = {0};
    const starg_mesh *mesh = scene_of(s)->mesh;
    for (size_t f = 0; f < starg_space_model_faces(scene_of(s)); f++)
        if (is_floor(s, mesh, f, ceiling) && !is_clear(s, f))
            for (size_t k = 0; k < 3; k++)
                PUSH(c->context, STAGE, &floors, mesh->faces[3 * f + k]);
    TRY(starg_features_create(c->context, mesh->vertices, mesh->vertex_count, floors.data,
                              floors.count / 3, &edges));
    for (size_t i = 0; i < edges.lines.count; i += 2) {
        double ends[2][3];
        for (size_t k = 0; k < 2; k++)
            place(s, plan, mesh->vertices + 3 * (size_t)edges.lines.data[i + k], ends[k]);
        TRY(push_line(c, ends[0], ends[1]));
    }
    return STARG_OK;
}

starg_status sheet_draw_plan(starg_context *context, const sheet_scene *scene, sheet_plan *out) {
    SCOPED_BY(canvas_free) canvas c = {.context = context};
    double ceiling = find_ceiling(scene);
    *out = (sheet_plan){0};
    fit_plan(scene, out);
    c.width = out->picture.width;
    c.height = out->picture.height;
    TRY(lay_model(&c, scene, out, ceiling));
    for (size_t f = 0; scene->obstacles != NULL && f < scene->obstacles->face_count; f++)
        if (is_below(scene, scene->obstacles, f, ceiling))
            TRY(lay_face(&c, scene, out, scene->obstacles, f, SCENE_IN_THE_WAY));
    TRY(lay_edges(&c, scene, out, ceiling));
    return finish(&c, 0.8, &out->picture);
}
