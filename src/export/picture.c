/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: checks the options, projects the mesh to the camera, draws, writes.
 *
 * The camera's frame is x to the right, y up, z towards the viewer. The model is first moved and
 * scaled to unit size, so that models of any size (1e-300 or 1e+90) give the same picture. Cost:
 * O(faces x bands) for the cheap rejection of triangles, plus the samples covered. */
#include "starguard/picture.h"

#include <stdio.h>
#include <stdlib.h>

#include "export/export.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"

static const char STAGE[] = "picture";
static const double DEGREE = 0.01745329251994329577;

enum { MIN_SIZE = 16, MAX_SIZE = 8192, MAX_SIDE = 16384 };

void starg_picture_options_default(starg_picture_options *options) {
    *options = (starg_picture_options){.width = 1200,
                                       .height = 900,
                                       .azimuth = 35,
                                       .elevation = 20,
                                       .up = 1,
                                       .opacity = 0.35,
                                       .point_radius = 0.012};
}

static starg_status check_options(starg_context *context, const starg_picture_options *o) {
    if (o->width < MIN_SIZE || o->width > MAX_SIZE || o->height < MIN_SIZE || o->height > MAX_SIZE)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a picture of %zu x %zu pixels; each side must be 16 to 8192", o->width,
                          o->height);
    if (!isfinite(o->azimuth) || !isfinite(o->elevation))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the azimuth and the elevation must be finite angles in degrees");
    if (o->up < 0 || o->up > 2)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "up axis %d; it must be 0 (x), 1 (y) or 2 (z)", o->up);
    if (!(o->opacity >= 0 && o->opacity <= 1))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "opacity is %g; it must be in [0, 1]", o->opacity);
    if (!(o->point_radius > 0 && o->point_radius <= 1))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "point radius %g; it must be above 0 and at most 1, as a fraction of the "
                          "model's diagonal",
                          o->point_radius);
    for (size_t i = 0; i < 3 * o->point_count; i++)
        if (!(fabs(o->points[i]) < 1e100))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "point %zu has the coordinate %g; it must be finite and below 1e100",
                              i / 3, o->points[i]);
    return STARG_OK;
}

/* From model coordinates to the camera's frame: axes . ((p - center) / size). */
typedef struct camera {
    double axes[3][3]; /* right, up, towards the viewer */
    double center[3], size;
} camera;

static void grow_box(const double *points, size_t count, double lower[3], double upper[3]) {
    for (size_t i = 0; i < 3 * count; i++) {
        lower[i % 3] = fmin(lower[i % 3], points[i]);
        upper[i % 3] = fmax(upper[i % 3], points[i]);
    }
}

static void aim_camera(const starg_mesh *mesh, const starg_picture_options *o, camera *c) {
    double lower[3], upper[3], span[3];
    starg_mesh_bounds(mesh, lower, upper);
    if (mesh->vertex_count == 0 && o->point_count != 0) {
        vec3_copy(o->points, lower);
        vec3_copy(o->points, upper);
    }
    grow_box(o->points, o->point_count, lower, upper);
    vec3_subtract(upper, lower, span);
    /* hypot neither overflows nor underflows */
    c->size = hypot(hypot(span[0], span[1]), span[2]);
    if (c->size == 0)
        c->size = 1;
    for (int k = 0; k < 3; k++)
        c->center[k] = lower[k] + 0.5 * span[k];

    int first = (o->up + 1) % 3, second = (o->up + 2) % 3;
    double ca = cos(DEGREE * o->azimuth), sa = sin(DEGREE * o->azimuth);
    double ce = cos(DEGREE * o->elevation), se = sin(DEGREE * o->elevation);
    double *right = c->axes[0], *up = c->axes[1], *towards = c->axes[2];
    right[first] = -sa;
    right[second] = ca;
    right[o->up] = 0;
    towards[first] = ce * ca;
    towards[second] = ce * sa;
    towards[o->up] = se;
    vec3_cross(towards, right, up);
}

static void look(const camera *c, const double *points, size_t count, double *out) {
    for (size_t i = 0; i < count; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (points[3 * i + (size_t)k] - c->center[k]) / c->size;
        for (int k = 0; k < 3; k++)
            out[3 * i + (size_t)k] = vec3_dot(c->axes[k], p);
    }
}

/* Maps the camera's frame to samples: x = ox + scale x', y = oy - scale y'. */
typedef struct frame {
    double ox, oy, scale;
} frame;

static frame fit_frame(const starg_picture_options *o, const double *vertices, size_t vertex_count,
                       const double *points, double line_margin) {
    double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};
    const double *some = vertex_count ? vertices : points;
    if (vertex_count + o->point_count != 0) {
        vec3_copy(some, lower);
        vec3_copy(some, upper);
    }
    grow_box(vertices, vertex_count, lower, upper);
    grow_box(points, o->point_count, lower, upper);
    double margin = o->point_count ? o->point_radius : 0.001;
    double width = (double)(o->width * STARG_RASTER_SAMPLES);
    double height = (double)(o->height * STARG_RASTER_SAMPLES);
    double room = 0.94;
    double across = (room * width - line_margin) / (upper[0] - lower[0] + 2 * margin);
    double down = (room * height - line_margin) / (upper[1] - lower[1] + 2 * margin);
    double scale = fmin(across, down);
    return (frame){.ox = 0.5 * width - scale * 0.5 * (lower[0] + upper[0]),
                   .oy = 0.5 * height + scale * 0.5 * (lower[1] + upper[1]),
                   .scale = scale};
}

static void to_samples(const frame *f, double *positions, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double *p = positions + 3 * i;
        p[0] = f->ox + f->scale * p[0];
        p[1] = f->oy - f->scale * p[1];
        p[2] = f->scale * p[2];
    }
}

static void make_balls(const starg_picture_options *o, const double *centers,
                       starg_raster_ball *balls) {
    for (size_t i = 0; i < o->point_count; i++) {
        vec3_copy(centers + 3 * i, balls[i].center);
        if (o->point_colors == NULL)
            starg_distinct_color(i, balls[i].rgb);
        else
            memcpy(balls[i].rgb, o->point_colors + 3 * i, 3);
    }
}

/* ---- numbers ---- */

typedef struct number {
    double x, y, z; /* of the point; pixels */
    size_t index;
} number;

/* Near to far; at equal depth by index. */
static int by_depth(const void *a, const void *b) {
    const number *p = a, *q = b;
    if (p->z != q->z)
        return p->z < q->z ? 1 : -1;
    return (p->index > q->index) - (p->index < q->index);
}

static bool is_free(const number *taken, size_t count, const number *n, double across,
                    double down) {
    for (size_t i = 0; i < count; i++)
        if (fabs(taken[i].x - n->x) < across && fabs(taken[i].y - n->y) < down)
            return false;
    return true;
}

/* Draws the numbers of points to the upper right of their balls, nearer ones first; what would
 * cover another is left out. */
static starg_status draw_numbers(starg_context *context, const starg_picture_options *o,
                                 const starg_raster_scene *scene, uint8_t *rgb) {
    const starg_canvas canvas = {.rgb = rgb, .width = o->width, .height = o->height};
    const double height = fmax(7, 0.0135 * (double)o->height);
    const starg_lettering style = {.height = height, .ink = {28, 36, 48}, .halo = 0.28 * height};
    char widest[24];
    snprintf(widest, sizeof widest, "%zu", o->point_count);
    const double across = starg_lettering_length(&style, widest), down = 1.4 * height;
    const double beside = 0.8 * scene->ball_radius / STARG_RASTER_SAMPLES + 0.3 * height;
    SCOPED number *numbers = NULL;
    size_t taken = 0;
    NEW(context, STAGE, numbers, o->point_count);
    for (size_t i = 0; i < o->point_count; i++) {
        const double *p = scene->balls[i].center;
        numbers[i] =
            (number){p[0] / STARG_RASTER_SAMPLES, p[1] / STARG_RASTER_SAMPLES, p[2], .index = i};
    }
    qsort(numbers, o->point_count, sizeof *numbers, by_depth);
    for (size_t i = 0; i < o->point_count; i++) {
        char text[24];
        number n = numbers[i];
        if (!is_free(numbers, taken, &n, across, down))
            continue;
        numbers[taken++] = n;
        snprintf(text, sizeof text, "%zu", n.index);
        starg_lettering_draw(&canvas, &style, text, n.x + beside, n.y - beside);
    }
    return STARG_OK;
}

/* ---- views of cameras ---- */

/* A view's corners follow the vertices of the mesh: the camera, then the rim. */
static void place_views(const scene_job *job, size_t sides, double *points) {
    for (size_t i = 0; i < job->guards * (sides + 1); i++)
        scene_view_corner(job, i / (sides + 1), i % (sides + 1), points + 3 * i);
}

/* Four of the rays, and the rim. */
static starg_status join_views(starg_context *context, const scene_job *job, size_t sides,
                               size_t base, starg_features *features) {
    for (size_t i = 0; i < job->guards * sides; i++) {
        size_t side = i % sides, apex = base + i / sides * (sides + 1);
        const size_t ends[4] = {apex + 1 + side, apex + 1 + (side + 1) % sides, apex,
                                apex + 1 + side};
        for (size_t k = 0; k < (side % (sides / 4) == 0 ? 4 : 2); k++)
            PUSH(context, STAGE, &features->lines, (uint32_t)ends[k]);
    }
    return STARG_OK;
}

static scene_job job_of(const starg_mesh *mesh, const starg_guards *guards, starg_scene *scene) {
    double lower[3], upper[3];
    scene_job job = {.scene = scene, .guards = guards != NULL ? guards->count : 0};
    *scene = (starg_scene){.guards = guards};
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        job.size = fmax(job.size, upper[k] - lower[k]);
    return job;
}

/* Draws into height rows of width x 3 bytes. */
static starg_status draw(starg_context *context, const starg_mesh *mesh,
                         const starg_picture_options *o, uint8_t *rgb) {
    SCOPED_BY(starg_features_free) starg_features features = {0};
    SCOPED double *positions = NULL, *centers = NULL;
    SCOPED starg_raster_ball *balls = NULL;
    camera c;
    starg_scene scene_of_views;
    const scene_job job = job_of(mesh, o->views, &scene_of_views);
    size_t sides = scene_view_sides(&job), count = mesh->vertex_count;
    if (sides > 0)
        count += job.guards * (sides + 1);
    NEW(context, STAGE, positions, 3 * count);
    NEW(context, STAGE, centers, 3 * o->point_count);
    NEW(context, STAGE, balls, o->point_count);

    aim_camera(mesh, o, &c);
    memcpy(positions, mesh->vertices, 3 * mesh->vertex_count * sizeof *positions);
    if (sides > 0)
        place_views(&job, sides, positions + 3 * mesh->vertex_count);
    look(&c, positions, count, positions);
    look(&c, o->points, o->point_count, centers);
    TRY(starg_features_create(context, positions, mesh->vertex_count, mesh->faces, mesh->face_count,
                              &features));
    if (sides > 0)
        TRY(join_views(context, &job, sides, mesh->vertex_count, &features));
    double line_radius = fmax(1.0, 0.0008 * STARG_RASTER_SAMPLES * (double)o->height);
    frame f = fit_frame(o, positions, count, centers, 2 * line_radius);
    to_samples(&f, positions, count);
    to_samples(&f, centers, o->point_count);
    make_balls(o, centers, balls);

    starg_raster_scene scene = {.width = o->width,
                                .height = o->height,
                                .positions = positions,
                                .faces = mesh->faces,
                                .face_count = mesh->face_count,
                                .normals = features.normals,
                                .face_colors = o->face_colors,
                                .opacity = o->opacity,
                                .lines = features.lines.data,
                                .line_count = features.lines.count / 2,
                                .line_radius = line_radius,
                                .balls = balls,
                                .ball_count = o->point_count,
                                .ball_radius = o->point_radius * f.scale};
    TRY(starg_raster_draw(context, &scene, rgb));
    if (o->point_numbers)
        TRY(draw_numbers(context, o, &scene, rgb));
    return STARG_OK;
}

starg_status starg_picture_write(starg_context *context, const starg_mesh *mesh,
                                 const starg_picture_options *options, const char *path) {
    return starg_picture_sheet_write(context, &mesh, 1, 1, options, path);
}

starg_status starg_picture_encode(starg_context *context, const starg_mesh *mesh,
                                  const starg_picture_options *options, uint8_t **png,
                                  size_t *size) {
    starg_picture_options defaults;
    SCOPED uint8_t *rgb = NULL;
    *png = NULL;
    *size = 0;
    starg_picture_options_default(&defaults);
    const starg_picture_options *o = options ? options : &defaults;
    TRY(check_options(context, o));
    NEW(context, STAGE, rgb, 3 * o->width * o->height);
    TRY(draw(context, mesh, o, rgb));
    return starg_png_encode(context, rgb, o->width, o->height, png, size);
}

void starg_picture_bytes_free(starg_context *context, uint8_t *png) {
    starg_release(context, png);
}

static starg_status check_sheet(starg_context *context, size_t rows, size_t columns,
                                const starg_picture_options *o) {
    if (rows >= 1 && columns >= 1 && rows <= MAX_SIDE / o->height && columns <= MAX_SIDE / o->width)
        return STARG_OK;
    return starg_fail(
        context, STARG_ERROR_ARGUMENT, STAGE,
        "a sheet of %zu x %zu pictures; it needs at least one, and at most %d pixels per side",
        columns, rows, MAX_SIDE);
}

starg_status starg_picture_sheet_write(starg_context *context, const starg_mesh *const *meshes,
                                       size_t rows, size_t columns,
                                       const starg_picture_options *options, const char *path) {
    starg_picture_options defaults;
    SCOPED uint8_t *tile = NULL, *sheet = NULL;
    starg_picture_options_default(&defaults);
    const starg_picture_options *o = options ? options : &defaults;
    TRY(check_options(context, o));
    TRY(check_sheet(context, rows, columns, o));
    size_t line = 3 * o->width, stride = line * columns;
    NEW(context, STAGE, tile, line * o->height);
    NEW(context, STAGE, sheet, stride * o->height * rows);
    for (size_t i = 0; i < rows * columns; i++) {
        uint8_t *corner = sheet + i / columns * o->height * stride + i % columns * line;
        TRY(draw(context, meshes[i], o, tile));
        for (size_t y = 0; y < o->height; y++)
            memcpy(corner + y * stride, tile + y * line, line);
    }
    const starg_canvas canvas = {
        .rgb = sheet, .width = columns * o->width, .height = rows * o->height};
    const double height = fmax(7, 0.05 * (double)o->height);
    const starg_lettering style = {.height = height, .ink = {28, 36, 48}, .halo = 0.28 * height};
    for (size_t i = 0; o->row_names != NULL && i < rows; i++)
        starg_lettering_draw(&canvas, &style, o->row_names[i], height,
                             (double)(i * o->height) + 2 * height);
    return starg_png_write(context, path, sheet, columns * o->width, rows * o->height);
}
