/* How many segment queries a second and core, engine by engine, beside Embree in the same run.
 *
 * A query is one segment from an inside point to one vertex. Embree (single precision, and so not
 * exact) answers the same queries by rtcOccluded1 with the segment's end drawn back a little; how
 * many of its answers differ is printed.
 *
 * Usage: bench_visibility MODEL [POINTS [REPEATS]] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "starguard/starguard.h"

#ifdef HAVE_EMBREE
#include <embree3/rtcore.h>
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

/* Inside points, uniform in the box, by a small generator of their own. */
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

static void print_rate(const setting *s, const char *name, size_t points, double seconds,
                       size_t different) {
    double queries = (double)points * (double)s->vertex_count;
    printf("%-16s %6zu points %8.3f s %8.2f million queries/s   %zu different answers\n", name,
           points, seconds, 1e-6 * queries / seconds, different);
}

/* Best of the repeats: what the machine can do when nobody else uses it. */
static void run_engine(setting *s, starg_visibility_engine engine, const char *name, size_t points,
                       int repeats) {
    starg_visibility_options options;
    double best = INFINITY;
    size_t different = 0;
    starg_visibility_options_default(&options);
    options.engine = engine;
    options.target = STARG_TARGET_VERTICES;
    for (int i = 0; i < repeats; i++) {
        starg_bits *bits = NULL;
        double start = now();
        stop_unless(s->context,
                    starg_visibility(s->context, s->solid, s->points, points, &options, &bits));
        best = fmin(best, now() - start);
        different = 0;
        for (size_t p = 0; s->reference != NULL && p < points; p++)
            for (size_t v = 0; v < s->vertex_count; v++)
                different += starg_bits_test(bits, p, v) != starg_bits_test(s->reference, p, v);
        if (s->reference == NULL)
            s->reference = bits;
        else
            starg_bits_free(bits);
    }
    print_rate(s, name, points, best, different);
}

#ifdef HAVE_EMBREE
static RTCScene make_scene(RTCDevice device, const setting *s) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof(float), s->vertex_count);
    uint32_t *f = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(uint32_t), s->face_count);
    for (size_t i = 0; i < 3 * s->vertex_count; i++)
        v[i] = (float)s->vertices[i];
    memcpy(f, s->faces, 3 * s->face_count * sizeof *f);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

static void run_embree(const setting *s, size_t points, int repeats) {
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = make_scene(device, s);
    double best = INFINITY;
    size_t different = 0;
    for (int i = 0; i < repeats; i++) {
        double start = now();
        different = 0;
        for (size_t p = 0; p < points; p++)
            for (size_t v = 0; v < s->vertex_count; v++) {
                struct RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
                struct RTCRay ray = {0};
                ray.org_x = (float)s->points[3 * p];
                ray.org_y = (float)s->points[3 * p + 1];
                ray.org_z = (float)s->points[3 * p + 2];
                ray.dir_x = (float)s->vertices[3 * v] - ray.org_x;
                ray.dir_y = (float)s->vertices[3 * v + 1] - ray.org_y;
                ray.dir_z = (float)s->vertices[3 * v + 2] - ray.org_z;
                ray.tfar = 0.9999f;
                ray.mask = UINT32_MAX;
                rtcOccluded1(scene, &context, &ray);
                different += (ray.tfar > 0) != starg_bits_test(s->reference, p, v);
            }
        best = fmin(best, now() - start);
    }
    print_rate(s, "embree (float)", points, best, different);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
#endif

int main(int count, char **arguments) {
    setting s = {0};
    starg_context_options options;
    starg_mesh *mesh = NULL;
    if (count < 2) {
        fprintf(stderr, "usage: bench_visibility MODEL [POINTS [REPEATS]]\n");
        return 1;
    }
    s.point_count = count > 2 ? strtoul(arguments[2], NULL, 10) : 1000;
    int repeats = count > 3 ? (int)strtol(arguments[3], NULL, 10) : 3;
    starg_context_options_default(&options);
    options.threads = 1;
    stop_unless(NULL, starg_context_create(&options, &s.context));
    stop_unless(s.context, starg_mesh_read(s.context, arguments[1], &mesh));
    stop_unless(s.context, starg_solid_create(s.context, mesh, &s.solid));
    s.vertices = starg_mesh_vertices(starg_solid_mesh(s.solid));
    s.faces = starg_mesh_faces(starg_solid_mesh(s.solid));
    s.vertex_count = starg_mesh_vertex_count(mesh);
    s.face_count = starg_mesh_face_count(mesh);
    make_points(&s);
    size_t few = s.point_count / 10 + 1;
    printf("%s: %zu vertices, one thread, best of %d\n", arguments[1], s.vertex_count, repeats);
    run_engine(&s, STARG_VISIBILITY_GRID, "grid", s.point_count, repeats);
    run_engine(&s, STARG_VISIBILITY_BVH, "bvh", few, 1);
    run_engine(&s, STARG_VISIBILITY_SWEEP, "sweep", few, 1);
#ifdef HAVE_EMBREE
    run_embree(&s, few, repeats);
#endif
    starg_bits_free(s.reference);
    starg_solid_free(s.solid);
    starg_mesh_free(mesh);
    starg_context_free(s.context);
    free(s.points);
    return 0;
}
