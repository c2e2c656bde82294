/* SPDX-License-Identifier: Apache-2.0 */
/* `guard` by default beside the pipeline that people build for themselves: random points inside as
 * candidates, rays by Embree from each to every vertex, and a greedy cover of the faces whose three
 * corners are free; one thread.
 *
 *     bench_pipeline [POINTS [VERTICES]]
 *
 * Eleven samples of the program's own. Prints a table: guards and processor seconds of both, and
 * how many faces no candidate of the pipeline sees. Of greedy, the next guard is found from bounds
 * of earlier rounds (lazily), which changes nothing but the time. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/rng.h"
#include "embree.h"
#include "starguard/guard.h"
#include "starguard/sample.h"

static const char *const MODELS[] = {"horse", "dog",  "cat",     "giraffe", "dinosaur", "bird",
                                     "human", "bust", "octopus", "gallery", "plate"};

typedef struct answer {
    size_t guards, unseen;
    double seconds;
} answer;

static double processor_seconds(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

static void *need(void *block) {
    if (block != NULL)
        return block;
    fputs("bench_pipeline: out of memory\n", stderr);
    exit(EXIT_FAILURE);
}

static void stop_unless(starg_context *context, starg_status status) {
    if (status == STARG_OK)
        return;
    fprintf(stderr, "bench_pipeline: %s\n", starg_context_error(context)->message);
    exit(EXIT_FAILURE);
}

static void draw_point(const starg_solid *solid, starg_rng *rng, double p[3]) {
    double lower[3], upper[3];
    starg_mesh_bounds(starg_solid_mesh(solid), lower, upper);
    do
        for (int k = 0; k < 3; k++)
            p[k] = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(rng);
    while (!starg_solid_contains(solid, p));
}

/* Is p on the inner side of a face of a solid? */
static bool is_inner(const double *v, const uint32_t f[3], const double p[3]) {
    double a[3], b[3], c[3];
    for (int k = 0; k < 3; k++) {
        a[k] = v[3 * (size_t)f[1] + (size_t)k] - v[3 * (size_t)f[0] + (size_t)k];
        b[k] = v[3 * (size_t)f[2] + (size_t)k] - v[3 * (size_t)f[0] + (size_t)k];
        c[k] = p[k] - v[3 * (size_t)f[0] + (size_t)k];
    }
    return (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
               (a[0] * b[1] - a[1] * b[0]) * c[2] <
           0;
}

static void find_row(RTCScene scene, const starg_mesh *mesh, const double p[3], uint8_t *open,
                     uint64_t *row) {
    size_t vertices = starg_mesh_vertex_count(mesh), faces = starg_mesh_face_count(mesh);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    for (size_t i = 0; i < vertices; i++)
        open[i] = embree_is_free(scene, p, v + 3 * i);
    for (size_t j = 0; j < faces; j++, f += 3)
        if (open[f[0]] && open[f[1]] && open[f[2]] && is_inner(v, f, p))
            row[j / 64] |= UINT64_C(1) << (j % 64);
}

static size_t gain_of(const uint64_t *row, const uint64_t *covered, size_t words) {
    size_t gain = 0;
    for (size_t w = 0; w < words; w++)
        gain += (size_t)__builtin_popcountll(row[w] & ~covered[w]);
    return gain;
}

/* Greedy cover; returns the number of rows, and the columns that none has. */
static size_t cover(const uint64_t *rows, size_t count, size_t words, size_t columns,
                    size_t *unseen) {
    uint64_t *covered = need(calloc(words, sizeof *covered));
    size_t *bound = need(malloc(count * sizeof *bound)), chosen = 0, seen = 0;
    for (size_t i = 0; i < count; i++)
        bound[i] = SIZE_MAX;
    for (;;) {
        size_t best = 0, most = 0;
        for (size_t i = 0; i < count; i++) {
            if (bound[i] <= most)
                continue;
            bound[i] = gain_of(rows + i * words, covered, words);
            if (bound[i] > most) {
                most = bound[i];
                best = i;
            }
        }
        if (most == 0)
            break;
        for (size_t w = 0; w < words; w++)
            covered[w] |= rows[best * words + w];
        chosen++;
        seen += most;
    }
    *unseen = columns - seen;
    free(covered);
    free(bound);
    return chosen;
}

static answer run_pipeline(const starg_solid *solid, size_t count) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    size_t words = (starg_mesh_face_count(mesh) + 63) / 64;
    uint64_t *rows = need(calloc(count * words, sizeof *rows));
    uint8_t *open = need(malloc(starg_mesh_vertex_count(mesh)));
    starg_rng rng = starg_rng_make(1, 1, 1);
    answer found = {0};
    double start = processor_seconds();
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = embree_scene(device, starg_mesh_vertices(mesh), starg_mesh_vertex_count(mesh),
                                  starg_mesh_faces(mesh), starg_mesh_face_count(mesh));
    for (size_t i = 0; i < count; i++) {
        double p[3];
        draw_point(solid, &rng, p);
        find_row(scene, mesh, p, open, rows + i * words);
    }
    found.guards = cover(rows, count, words, starg_mesh_face_count(mesh), &found.unseen);
    found.seconds = processor_seconds() - start;
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    free(open);
    free(rows);
    return found;
}

static answer run_guard(starg_context *context, const starg_solid *solid) {
    starg_guards *guards;
    double start = processor_seconds();
    stop_unless(context, starg_guard(context, solid, NULL, &guards));
    answer found = {guards->count, guards->uncovered_count, processor_seconds() - start};
    starg_guards_free(context, guards);
    return found;
}

static void compare(starg_context *context, const char *name, size_t points, size_t vertices) {
    starg_mesh *mesh;
    starg_solid *solid;
    starg_sample_options options;
    starg_sample_options_default(&options);
    options.vertex_count = vertices;
    stop_unless(context, starg_sample_create(context, name, &options, &mesh));
    stop_unless(context, starg_solid_create(context, mesh, &solid));
    answer ours = run_guard(context, solid), theirs = run_pipeline(solid, points);
    printf("| %s | %zu | %zu | %.1f | %zu | %zu | %.1f |\n", name, starg_mesh_face_count(mesh),
           ours.guards, ours.seconds, theirs.guards, theirs.unseen, theirs.seconds);
    fflush(stdout);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
}

int main(int count, char **words) {
    size_t points = count > 1 ? strtoul(words[1], NULL, 10) : 5000;
    size_t vertices = count > 2 ? strtoul(words[2], NULL, 10) : 5000;
    starg_context *context;
    starg_context_options used;
    starg_context_options_default(&used);
    used.threads = 1;
    if (starg_context_create(&used, &context) != STARG_OK)
        return EXIT_FAILURE;
    puts("| sample | faces | guards | s | guards of the pipeline | faces it leaves | s |\n"
         "|---|--:|--:|--:|--:|--:|--:|");
    for (size_t i = 0; i < sizeof MODELS / sizeof *MODELS; i++)
        compare(context, MODELS[i], points, vertices);
    starg_context_free(context);
    return EXIT_SUCCESS;
}
