/* SPDX-License-Identifier: Apache-2.0 */
/* Segment queries per second and core for each engine, with Embree in the same run: a table line
 * per model.
 *
 * A query is one segment from an inside point to one vertex. Embree (single precision, hence not
 * exact) answers the same queries with the segment's end drawn back a little, in four modes: one
 * call per segment or one for all segments of a point (rtcOccluded1, rtcOccluded1M), in the order
 * of the mesh or of cells of their directions; sorting is not timed. "times" is the first engine
 * over Embree's best mode; "differ" counts answers that differ from those of the exact engines,
 * which must agree with one another.
 *
 * Usage: bench_visibility POINTS REPEATS MODEL... */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "starguard/starguard.h"

#ifdef HAVE_EMBREE
#include "embree.h"
#endif

typedef struct setting {
    starg_context *context;
    starg_solid *solid;
    const double *vertices;
    const uint32_t *faces;
    size_t vertex_count, face_count, point_count;
    double *points;
    starg_bits *reference;
} setting;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stop_unless(starg_context *context, starg_status status) {
    if (status == STARG_OK)
        return;
    fprintf(stderr, "%s\n", context ? starg_context_error(context)->message : "no context");
    exit(1);
}

/* Inside points, uniform in the box, by a small separate generator. */
static void make_points(setting *s) {
    double lower[3], upper[3];
    uint64_t state = 1;
    size_t count = 0;
    starg_mesh_bounds(starg_solid_mesh(s->solid), lower, upper);
    s->points = malloc(3 * s->point_count * sizeof *s->points);
    while (s->points != NULL && count < s->point_count) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            p[k] = lower[k] + (upper[k] - lower[k]) * (double)(state >> 11) * 0x1p-53;
        }
        if (starg_solid_contains(s->solid, p))
            memcpy(s->points + 3 * count++, p, sizeof p);
    }
}

static double rate(const setting *s, size_t points, double seconds) {
    return 1e-6 * (double)points * (double)s->vertex_count / seconds;
}

/* In millions of queries a second. */
static double run_engine(setting *s, starg_visibility_engine engine, size_t points) {
    starg_visibility_options options;
    starg_bits *bits = NULL;
    starg_visibility_options_default(&options);
    options.engine = engine;
    options.target = STARG_TARGET_VERTICES;
    double start = now();
    stop_unless(s->context,
                starg_visibility(s->context, s->solid, s->points, points, &options, &bits));
    double seconds = now() - start;
    if (s->reference == NULL) {
        s->reference = bits;
        return rate(s, points, seconds);
    }
    for (size_t p = 0; p < points; p++)
        for (size_t v = 0; v < s->vertex_count; v++)
            if (starg_bits_test(bits, p, v) != starg_bits_test(s->reference, p, v)) {
                fprintf(stderr, "engine %d differs at point %zu, vertex %zu\n", (int)engine, p, v);
                exit(1);
            }
    starg_bits_free(bits);
    return rate(s, points, seconds);
}

#ifdef HAVE_EMBREE
/* A ray and the cell of its direction. */
typedef struct order {
    uint32_t cell, vertex;
} order;

static int compare_orders(const void *left, const void *right) {
    const order *a = left, *b = right;
    return a->cell != b->cell ? (a->cell > b->cell) - (a->cell < b->cell)
                              : (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

/* Cells of 64 x 64 on each face of a cube around the point, along a Morton curve. */
static uint32_t cell_of(const double d[3]) {
    int k = fabs(d[0]) >= fabs(d[1]) && fabs(d[0]) >= fabs(d[2]) ? 0
            : fabs(d[1]) >= fabs(d[2])                           ? 1
                                                                 : 2;
    uint32_t cell = 0;
    for (int j = 1; j < 3; j++) {
        double t = 32 * (d[(k + j) % 3] / fabs(d[k]) + 1);
        uint32_t at = t < 63 ? (uint32_t)t : 63;
        for (uint32_t bit = 0; bit < 6; bit++)
            cell |= (at >> bit & 1) << (2 * bit + (uint32_t)j - 1);
    }
    return cell + 4096 * (uint32_t)(2 * k + (d[k] < 0));
}

static void make_rays(const setting *s, const double p[3], bool by_cells, order *orders,
                      struct RTCRay *rays) {
    for (size_t v = 0; v < s->vertex_count; v++) {
        double d[3];
        for (int k = 0; k < 3; k++)
            d[k] = s->vertices[3 * v + (size_t)k] - p[k];
        orders[v] = (order){by_cells ? cell_of(d) : 0, (uint32_t)v};
    }
    if (by_cells)
        qsort(orders, s->vertex_count, sizeof *orders, compare_orders);
    for (size_t i = 0; i < s->vertex_count; i++) {
        const double *q = s->vertices + 3 * (size_t)orders[i].vertex;
        rays[i] = (struct RTCRay){.org_x = (float)p[0],
                                  .org_y = (float)p[1],
                                  .org_z = (float)p[2],
                                  .tfar = 0.9999f,
                                  .mask = UINT32_MAX};
        rays[i].dir_x = (float)q[0] - rays[i].org_x;
        rays[i].dir_y = (float)q[1] - rays[i].org_y;
        rays[i].dir_z = (float)q[2] - rays[i].org_z;
    }
}

static void trace(RTCScene scene, const setting *s, bool together, struct RTCRay *rays) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (together) {
        rtcOccluded1M(scene, &context, rays, (unsigned)s->vertex_count, sizeof *rays);
        return;
    }
    for (size_t i = 0; i < s->vertex_count; i++)
        rtcOccluded1(scene, &context, &rays[i]);
}

typedef struct embree {
    RTCDevice device;
    RTCScene scene;
    struct RTCRay *rays;
    order *orders;
    double best;
    int best_mode;
    size_t different, points;
} embree;

static void start_embree(const setting *s, embree *e) {
    *e = (embree){.points = s->point_count / 4 + 1};
    e->device = rtcNewDevice("threads=1");
    e->scene = embree_scene(e->device, s->vertices, s->vertex_count, s->faces, s->face_count);
    e->rays = aligned_alloc(64, (s->vertex_count * sizeof *e->rays + 63) / 64 * 64);
    e->orders = malloc(s->vertex_count * sizeof *e->orders);
    if (e->rays == NULL || e->orders == NULL)
        exit(1);
}

static void run_embree(const setting *s, embree *e) {
    for (int mode = 0; mode < 4; mode++) {
        double seconds = 0;
        e->different = 0;
        for (size_t p = 0; p < e->points; p++) {
            make_rays(s, s->points + 3 * p, mode / 2, e->orders, e->rays);
            double start = now();
            trace(e->scene, s, mode % 2, e->rays);
            seconds += now() - start;
            for (size_t k = 0; k < s->vertex_count; k++)
                e->different +=
                    (e->rays[k].tfar > 0) != starg_bits_test(s->reference, p, e->orders[k].vertex);
        }
        if (rate(s, e->points, seconds) > e->best) {
            e->best = rate(s, e->points, seconds);
            e->best_mode = mode;
        }
    }
}

static void print_embree(const setting *s, embree *e, double fastest) {
    static const char *const modes[] = {"1, mesh", "1M, mesh", "1, cells", "1M, cells"};
    printf(" %.1f (%s) | %.1f | %zu in %.1f million |", e->best, modes[e->best_mode],
           fastest / e->best, e->different, 1e-6 * (double)e->points * (double)s->vertex_count);
    free(e->rays);
    free(e->orders);
    rtcReleaseScene(e->scene);
    rtcReleaseDevice(e->device);
}
#endif

/* Large meshes and slow engines get fewer points. Reports the best of the repeats, which alternate:
 * this approximates an idle machine. */
static void run_model(starg_context *context, const char *path, size_t points, int repeats) {
    setting s = {.context = context};
    starg_mesh *mesh = NULL;
    stop_unless(context, starg_mesh_read(context, path, &mesh));
    stop_unless(context, starg_solid_create(context, mesh, &s.solid));
    s.vertices = starg_mesh_vertices(starg_solid_mesh(s.solid));
    s.faces = starg_mesh_faces(starg_solid_mesh(s.solid));
    s.vertex_count = starg_mesh_vertex_count(mesh);
    s.face_count = starg_mesh_face_count(mesh);
    s.point_count = points * 20000 / (s.vertex_count + 10000);
    if (s.point_count < 50)
        s.point_count = 50;
    make_points(&s);
    size_t few = s.point_count / 20 + 1;
    double fastest = 0, contours = 0, grid = 0;
#ifdef HAVE_EMBREE
    embree e;
    start_embree(&s, &e);
#endif
    for (int i = 0; i < repeats; i++) {
        fastest = fmax(fastest, run_engine(&s, STARG_VISIBILITY_FASTEST, s.point_count));
        contours = fmax(contours, run_engine(&s, STARG_VISIBILITY_CONTOURS, s.point_count));
        grid = fmax(grid, run_engine(&s, STARG_VISIBILITY_GRID, s.point_count));
#ifdef HAVE_EMBREE
        run_embree(&s, &e);
#endif
    }
    double tree = run_engine(&s, STARG_VISIBILITY_BVH, few);
    double sweep = run_engine(&s, STARG_VISIBILITY_SWEEP, few);
    const char *name = strrchr(path, '/');
    printf("| %s | %zu | %.1f | %.1f | %.1f | %.1f | %.1f |", name ? name + 1 : path,
           s.vertex_count, fastest, contours, grid, tree, sweep);
#ifdef HAVE_EMBREE
    print_embree(&s, &e, fastest);
#endif
    printf("\n");
    fflush(stdout);
    starg_bits_free(s.reference);
    starg_solid_free(s.solid);
    starg_mesh_free(mesh);
    free(s.points);
}

int main(int count, char **arguments) {
    starg_context_options options;
    starg_context *context = NULL;
    if (count < 4) {
        fprintf(stderr, "usage: bench_visibility POINTS REPEATS MODEL...\n");
        return 1;
    }
    starg_context_options_default(&options);
    options.threads = 1;
    stop_unless(NULL, starg_context_create(&options, &context));
    printf(
        "| model | vertices | fastest | contours | grid | tree | sweep | Embree (mode) | times | "
        "differ |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 3; i < count; i++)
        run_model(context, arguments[i], strtoul(arguments[1], NULL, 10),
                  (int)strtol(arguments[2], NULL, 10));
    starg_context_free(context);
    return 0;
}
