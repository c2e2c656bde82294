/* SPDX-License-Identifier: Apache-2.0 */
/* Renderer: transparent triangles, lines and balls in exact depth order.
 *
 * The image is divided into bands of rows, each drawn by one thread: every sample keeps a short
 * list of fragments, sorted from near to far while it grows (an A-buffer; Carpenter, The A-buffer,
 * an antialiased hidden surface method, 1984, without its coverage masks: here every pixel has 3 x
 * 3 samples). Fragments behind an opaque one are dropped, as are those after the nearest
 * MAX_LAYERS. Then each list is blended from front to back over white.
 *
 * Of two triangles with a common edge, exactly one takes a sample on it: edge functions are
 * computed from the end points in a fixed order, and samples exactly on the edge go to the triangle
 * on one fixed side.
 *
 * A band depends only on the scene: the same bytes for any number of threads. */
#include "export/export.h"

#include "core/parallel.h"
#include "geometry/vec3.h"

static const char STAGE[] = "picture";

enum { SAMPLES = STARG_RASTER_SAMPLES, BAND_ROWS = 8, MAX_LAYERS = 14 };

typedef enum fragment_kind { SURFACE, LINE, BALL } fragment_kind;

typedef struct fragment {
    float z;
    uint8_t rgb[3], alpha;
    uint8_t kind;
} fragment;

/* One thread's fragments of one band. */
typedef struct band {
    size_t columns, rows; /* samples */
    double top;           /* sample row of the picture where the band starts */
    uint8_t *counts;      /* per sample */
    fragment *fragments;  /* MAX_LAYERS per sample */
} band;

typedef struct job {
    const starg_raster_scene *scene;
    uint8_t *rgb;
} job;

/* ---- fragments ---- */

/* Lines overlap where they meet: two on one sample at nearly the same depth count once. */
static bool line_is_there(const fragment *list, size_t count, const fragment *f, double radius) {
    for (size_t i = 0; i < count; i++)
        if (list[i].kind == LINE && fabs((double)list[i].z - (double)f->z) < 8 * radius)
            return true;
    return false;
}

static void insert(band *b, size_t column, size_t row, const fragment *f) {
    size_t sample = row * b->columns + column;
    fragment *list = b->fragments + sample * MAX_LAYERS;
    size_t count = b->counts[sample], place = count;
    while (place > 0 && list[place - 1].z < f->z)
        place--;
    if (place > 0 && list[place - 1].alpha == 255)
        return;
    if (place == MAX_LAYERS)
        return;
    if (f->alpha == 255) {
        count = place + 1; /* hides the rest */
    } else {
        count = count < MAX_LAYERS ? count + 1 : count;
        for (size_t i = count - 1; i > place; i--)
            list[i] = list[i - 1];
    }
    list[place] = *f;
    b->counts[sample] = (uint8_t)count;
}

/* ---- light ---- */

static const uint8_t NEUTRAL[3] = {174, 192, 212};
static const uint8_t INK[3] = {44, 54, 70};
static const double KEY_LIGHT[3] = {-0.45, 0.65, 0.61};
static const double FILL_LIGHT[3] = {0.80, 0.10, 0.59};

static uint8_t to_byte(double value) {
    return (uint8_t)(value <= 0 ? 0 : value >= 255 ? 255 : value + 0.5);
}

static double power4(double x) {
    return x * x * x * x;
}

/* Lighting of a matt surface with a soft gloss; `n` is a unit vector facing the viewer. */
static void shade(const uint8_t base[3], const double n[3], double gloss, uint8_t rgb[3]) {
    double key = 0.5 + 0.5 * vec3_dot(n, KEY_LIGHT);
    double fill = fmax(0, vec3_dot(n, FILL_LIGHT));
    double light = 0.38 + 0.66 * key * key + 0.10 * fill;
    /* mirrored view direction (0, 0, 1) against the key light */
    double mirror = 2 * n[2] * vec3_dot(n, KEY_LIGHT) - KEY_LIGHT[2];
    double highlight = mirror > 0 ? gloss * power4(power4(mirror)) : 0;
    double rim = 1 - 0.45 * power4(1 - n[2]);
    for (int k = 0; k < 3; k++)
        rgb[k] = to_byte(((double)base[k] * light) * rim + 255 * highlight);
}

/* ---- triangles ---- */

/* One edge of a triangle as a half-plane: value(x, y) > 0 inside, and on the edge if `closed`. */
typedef struct half_plane {
    double x, y, dx, dy, sign;
    bool closed;
} half_plane;

static half_plane make_half_plane(const double *a, const double *b, double orientation) {
    bool swapped = a[1] > b[1] || (a[1] == b[1] && a[0] > b[0]);
    const double *from = swapped ? b : a, *to = swapped ? a : b;
    double sign = swapped ? -orientation : orientation;
    return (half_plane){.x = from[0],
                        .y = from[1],
                        .dx = to[0] - from[0],
                        .dy = to[1] - from[1],
                        .sign = sign,
                        .closed = sign > 0};
}

static bool inside(const half_plane *edge, double x, double y) {
    double side = edge->sign * (edge->dx * (y - edge->y) - edge->dy * (x - edge->x));
    return side > 0 || (side == 0 && edge->closed);
}

typedef struct triangle {
    half_plane edges[3];
    const double *corners[3];
    const float *normals;
    const uint8_t *base;
    double area; /* twice, signed */
} triangle;

static bool make_triangle(const starg_raster_scene *scene, size_t face, triangle *t) {
    for (int k = 0; k < 3; k++)
        t->corners[k] = scene->positions + 3 * (size_t)scene->faces[3 * face + (size_t)k];
    const double *a = t->corners[0], *b = t->corners[1], *c = t->corners[2];
    t->area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (t->area == 0)
        return false;
    for (int k = 0; k < 3; k++)
        t->edges[k] =
            make_half_plane(t->corners[k], t->corners[(k + 1) % 3], t->area > 0 ? 1.0 : -1.0);
    t->normals = scene->normals + 9 * face;
    t->base = scene->face_colors ? scene->face_colors + 3 * face : NEUTRAL;
    return true;
}

/* Barycentric coordinates of a sample; the third is 1 minus the others. */
static void barycentric(const triangle *t, double x, double y, double w[3]) {
    const double *a = t->corners[0], *b = t->corners[1], *c = t->corners[2];
    w[1] = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / t->area;
    w[2] = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / t->area;
    w[0] = 1 - w[1] - w[2];
}

/* Unit normal at barycentric `w`, turned to the viewer. */
static void surface_normal(const triangle *t, const double w[3], double n[3]) {
    for (int k = 0; k < 3; k++)
        n[k] = w[0] * (double)t->normals[k] + w[1] * (double)t->normals[3 + k] +
               w[2] * (double)t->normals[6 + k];
    /* y points down in the picture, so a face with negative area faces the viewer */
    double length = vec3_length(n) * (t->area < 0 ? 1 : -1);
    for (int k = 0; k < 3; k++)
        n[k] = length == 0 ? k == 2 : n[k] / length;
    n[2] = fmax(n[2], 0); /* smooth normals may turn away a little at the silhouette */
}

/* Oblique parts are more opaque, like glass: the silhouette stays clear. */
static double surface_alpha(double opacity, double slant) {
    return opacity + (1 - opacity) * 0.62 * slant * slant * slant;
}

static fragment surface_fragment(const triangle *t, double opacity, double x, double y) {
    double w[3], n[3];
    barycentric(t, x, y, w);
    surface_normal(t, w, n);
    fragment f = {.kind = SURFACE};
    f.z = (float)(w[0] * t->corners[0][2] + w[1] * t->corners[1][2] + w[2] * t->corners[2][2]);
    f.alpha = to_byte(255 * surface_alpha(opacity, 1 - n[2]));
    shade(t->base, n, 0.22, f.rgb);
    return f;
}

/* The samples of a band that a box can touch: columns [x0, x1), rows [y0, y1) of the band. */
typedef struct window {
    size_t x0, x1, y0, y1;
} window;

static size_t clamp_index(double value, size_t limit) {
    return value <= 0 ? 0 : value >= (double)limit ? limit : (size_t)value;
}

static bool make_window(const band *b, const double lower[2], const double upper[2], window *w) {
    w->x0 = clamp_index(floor(lower[0]), b->columns);
    w->x1 = clamp_index(ceil(upper[0]), b->columns);
    w->y0 = clamp_index(floor(lower[1] - b->top), b->rows);
    w->y1 = clamp_index(ceil(upper[1] - b->top), b->rows);
    return w->x0 < w->x1 && w->y0 < w->y1;
}

static void box_of(const double *const *points, size_t count, double margin, double lower[2],
                   double upper[2]) {
    for (int k = 0; k < 2; k++) {
        lower[k] = upper[k] = points[0][k];
        for (size_t i = 1; i < count; i++) {
            lower[k] = fmin(lower[k], points[i][k]);
            upper[k] = fmax(upper[k], points[i][k]);
        }
        lower[k] -= margin;
        upper[k] += margin;
    }
}

static void draw_triangle(band *b, const starg_raster_scene *scene, size_t face) {
    const uint32_t *f = scene->faces + 3 * face;
    double bottom = b->top + (double)b->rows; /* rejects most triangles quickly */
    double y0 = scene->positions[3 * (size_t)f[0] + 1], y1 = scene->positions[3 * (size_t)f[1] + 1];
    double y2 = scene->positions[3 * (size_t)f[2] + 1];
    if ((y0 < b->top && y1 < b->top && y2 < b->top) || (y0 > bottom && y1 > bottom && y2 > bottom))
        return;
    triangle t;
    window w;
    double lower[2], upper[2];
    if (!make_triangle(scene, face, &t))
        return;
    box_of(t.corners, 3, 0, lower, upper);
    if (!make_window(b, lower, upper, &w))
        return;
    for (size_t row = w.y0; row < w.y1; row++)
        for (size_t column = w.x0; column < w.x1; column++) {
            double x = (double)column + 0.5, y = b->top + (double)row + 0.5;
            if (!inside(&t.edges[0], x, y) || !inside(&t.edges[1], x, y) ||
                !inside(&t.edges[2], x, y))
                continue;
            fragment found = surface_fragment(&t, scene->opacity, x, y);
            insert(b, column, row, &found);
        }
}

/* ---- lines and balls ---- */

static void draw_line(band *b, const starg_raster_scene *scene, const uint32_t *line) {
    const double *ends[2] = {scene->positions + 3 * (size_t)line[0],
                             scene->positions + 3 * (size_t)line[1]};
    double radius = scene->line_radius, lower[2], upper[2];
    window w;
    box_of(ends, 2, radius, lower, upper);
    if (!make_window(b, lower, upper, &w))
        return;
    double dx = ends[1][0] - ends[0][0], dy = ends[1][1] - ends[0][1];
    double square = dx * dx + dy * dy;
    for (size_t row = w.y0; row < w.y1; row++)
        for (size_t column = w.x0; column < w.x1; column++) {
            double x = (double)column + 0.5 - ends[0][0];
            double y = b->top + (double)row + 0.5 - ends[0][1];
            double t = square > 0 ? (x * dx + y * dy) / square : 0;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            if (hypot(x - t * dx, y - t * dy) > radius)
                continue;
            /* raised by its radius, otherwise the surface would hide half of it */
            double z = (1 - t) * ends[0][2] + t * ends[1][2] + radius;
            fragment f = {.z = (float)z, .alpha = 205, .kind = LINE};
            for (int k = 0; k < 3; k++)
                f.rgb[k] = INK[k];
            size_t sample = row * b->columns + column;
            if (!line_is_there(b->fragments + sample * MAX_LAYERS, b->counts[sample], &f, radius))
                insert(b, column, row, &f);
        }
}

static void draw_ball(band *b, const starg_raster_scene *scene, const starg_raster_ball *ball) {
    const double *center[1] = {ball->center};
    double radius = scene->ball_radius, lower[2], upper[2];
    window w;
    box_of(center, 1, radius, lower, upper);
    if (!make_window(b, lower, upper, &w))
        return;
    for (size_t row = w.y0; row < w.y1; row++)
        for (size_t column = w.x0; column < w.x1; column++) {
            double x = ((double)column + 0.5 - ball->center[0]) / radius;
            double y = (b->top + (double)row + 0.5 - ball->center[1]) / radius;
            double square = 1 - x * x - y * y;
            if (square < 0)
                continue;
            double n[3] = {x, -y, sqrt(square)};
            fragment f = {.alpha = 255, .kind = BALL};
            f.z = (float)(ball->center[2] + radius * n[2]);
            shade(ball->rgb, n, 0.45, f.rgb);
            insert(b, column, row, &f);
        }
}

/* ---- bands ---- */

/* Adds the colour of one sample, 0 to 255 per channel, over white. */
static void blend(const fragment *list, size_t count, double sum[3]) {
    double through = 1;
    for (size_t i = 0; i < count; i++) {
        double alpha = through * list[i].alpha / 255;
        for (int k = 0; k < 3; k++)
            sum[k] += alpha * list[i].rgb[k];
        through -= alpha;
    }
    for (int k = 0; k < 3; k++)
        sum[k] += 255 * through;
}

static void resolve_pixel(const band *b, size_t x, size_t y, uint8_t rgb[3]) {
    double sum[3] = {0, 0, 0};
    for (size_t i = 0; i < SAMPLES * SAMPLES; i++) {
        size_t row = y * SAMPLES + i / SAMPLES, column = x * SAMPLES + i % SAMPLES;
        size_t sample = row * b->columns + column;
        blend(b->fragments + sample * MAX_LAYERS, b->counts[sample], sum);
    }
    for (int k = 0; k < 3; k++)
        rgb[k] = to_byte(sum[k] / (SAMPLES * SAMPLES));
}

static starg_status draw_band(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)context;
    const job *work = shared;
    const starg_raster_scene *scene = work->scene;
    band *b = scratch;
    size_t first = item * BAND_ROWS, rows = scene->height - first;
    rows = rows < BAND_ROWS ? rows : BAND_ROWS;
    b->rows = rows * SAMPLES;
    b->top = (double)(first * SAMPLES);
    memset(b->counts, 0, b->rows * b->columns);

    for (size_t i = 0; i < scene->ball_count; i++) /* opaque first: they hide much */
        draw_ball(b, scene, &scene->balls[i]);
    for (size_t f = 0; f < scene->face_count; f++)
        draw_triangle(b, scene, f);
    for (size_t i = 0; i < scene->line_count; i++)
        draw_line(b, scene, scene->lines + 2 * i);
    for (size_t y = 0; y < rows; y++)
        for (size_t x = 0; x < scene->width; x++)
            resolve_pixel(b, x, y, work->rgb + 3 * ((first + y) * scene->width + x));
    return STARG_OK;
}

static void free_band(starg_context *context, void *scratch) {
    (void)context;
    band *b = scratch;
    if (b == NULL)
        return;
    RELEASE(b->counts, b->fragments, b);
}

static starg_status make_band(starg_context *context, void *shared, void **scratch) {
    const job *work = shared;
    band *b = starg_allocate_zero(context, 1, sizeof *b);
    if (b == NULL)
        return STARG_ERROR_MEMORY;
    b->columns = work->scene->width * SAMPLES;
    size_t samples = b->columns * BAND_ROWS * SAMPLES;
    b->counts = starg_allocate(context, samples, sizeof *b->counts);
    b->fragments = starg_allocate(context, samples, MAX_LAYERS * sizeof *b->fragments);
    if (b->counts == NULL || b->fragments == NULL) {
        free_band(context, b);
        return STARG_ERROR_MEMORY;
    }
    *scratch = b;
    return STARG_OK;
}

starg_status starg_raster_draw(starg_context *context, const starg_raster_scene *scene,
                               uint8_t *rgb) {
    job work = {.scene = scene, .rgb = rgb};
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = (scene->height + BAND_ROWS - 1) / BAND_ROWS,
                                .shared = &work,
                                .item = draw_band,
                                .make_scratch = make_band,
                                .free_scratch = free_band};
    return starg_parallel_for(context, &loop);
}
