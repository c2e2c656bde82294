/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility from boxes: (box, vertex) tests per second and core, and the fraction of hidden
 * targets found, by box size: a table line for each model and number of halvings of the bounding
 * box.
 *
 * Boxes are cells around random inside points. "vertices" tests all vertices, "faces" all faces (up
 * to three vertices each, every vertex once). "found" is the number of faces (vertices) reported as
 * hidden over the number that none of SAMPLES inside points of the box sees: a lower bound of the
 * fraction, since more samples would see more.
 *
 * Usage: bench_region BOXES SAMPLES MODEL... */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/bits.h"
#include "core/rng.h"
#include "starguard/starguard.h"
#include "visibility/box.h"

typedef struct setting {
    starg_context *context;
    const starg_solid *solid;
    const starg_mesh *mesh;
    box_worker *worker;
    size_t boxes, samples;
} setting;

typedef struct tally {
    double seconds;
    uint64_t tests;
    size_t hidden, unseen, pairs;
} tally;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stop_unless(starg_context *context, starg_status status) {
    if (status == STARG_OK)
        return;
    fprintf(stderr, "%s\n", context ? starg_context_error(context)->message : "no context");
    exit(1);
}

static void random_point(const bvh_box *box, starg_rng *rng, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = box->lower[k] + (box->upper[k] - box->lower[k]) * starg_rng_unit(rng);
}

static bvh_box make_box(const setting *s, starg_rng *rng, int halvings) {
    bvh_box box;
    double p[3];
    starg_mesh_bounds(s->mesh, box.lower, box.upper);
    do
        random_point(&box, rng, p);
    while (!starg_solid_contains(s->solid, p));
    for (int i = 0; i < halvings; i++) {
        int k = 0;
        for (int j = 1; j < 3; j++)
            if (box.upper[j] - box.lower[j] > box.upper[k] - box.lower[k])
                k = j;
        double middle = 0.5 * box.lower[k] + 0.5 * box.upper[k];
        *(p[k] < middle ? &box.upper[k] : &box.lower[k]) = middle;
    }
    return box;
}

static size_t count_unseen(const setting *s, const box_question *q, starg_rng *rng) {
    double *points = malloc(3 * s->samples * sizeof *points);
    starg_visibility_options options;
    starg_bits *seen = NULL;
    size_t count = 0, unseen = 0;
    if (points == NULL)
        exit(1);
    for (size_t attempt = 0; attempt < 10 * s->samples && count < s->samples; attempt++) {
        random_point(&q->box, rng, points + 3 * count);
        count += starg_solid_contains(s->solid, points + 3 * count);
    }
    starg_visibility_options_default(&options);
    options.target = q->target;
    stop_unless(s->context, starg_visibility(s->context, s->solid, points, count, &options, &seen));
    for (size_t j = 0; j < q->count; j++) {
        bool once = false;
        for (size_t i = 0; i < count && !once; i++)
            once = starg_bits_test(seen, i, j);
        unseen += !once;
    }
    starg_bits_free(seen);
    free(points);
    return unseen;
}

static tally run(const setting *s, starg_target target, int halvings) {
    tally sum = {0};
    box_question q = {.target = target, .range = INFINITY};
    q.count = target == STARG_TARGET_FACES ? starg_mesh_face_count(s->mesh)
                                           : starg_mesh_vertex_count(s->mesh);
    uint64_t *open = malloc(starg_bit_words(q.count) * sizeof *open);
    if (open == NULL)
        exit(1);
    for (size_t i = 0; i < s->boxes; i++) {
        starg_rng rng = starg_rng_make(1, (uint64_t)halvings, i);
        q.box = make_box(s, &rng, halvings);
        uint64_t before = box_worker_tests(s->worker);
        double start = now();
        box_look(s->worker, &q, open, NULL);
        sum.seconds += now() - start;
        sum.tests += box_worker_tests(s->worker) - before;
        sum.pairs += q.count;
        sum.hidden += q.count - starg_bit_count(open, starg_bit_words(q.count));
        sum.unseen += count_unseen(s, &q, &rng);
    }
    free(open);
    return sum;
}

static void run_model(starg_context *context, const char *path, size_t boxes, size_t samples) {
    setting s = {.context = context, .boxes = boxes, .samples = samples};
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    box_scene *scene = NULL;
    const char *name = strrchr(path, '/');
    stop_unless(context, starg_mesh_read(context, path, &mesh));
    stop_unless(context, starg_solid_create(context, mesh, &solid));
    stop_unless(context, box_scene_create(context, solid, &scene));
    stop_unless(context, box_worker_create(scene, &s.worker));
    s.solid = solid;
    s.mesh = starg_solid_mesh(solid);
    for (int halvings = 6; halvings <= 15; halvings += 3) {
        tally v = run(&s, STARG_TARGET_VERTICES, halvings),
              f = run(&s, STARG_TARGET_FACES, halvings);
        printf("| %s | %zu | %d | %.2f | %.0f %% | %.2f | %.0f %% | %.0f %% |\n",
               name ? name + 1 : path, starg_mesh_vertex_count(mesh), halvings,
               1e-6 * (double)v.tests / v.seconds, 100 * (double)v.hidden / (double)v.unseen,
               1e-6 * (double)f.pairs / f.seconds, 100 * (double)f.hidden / (double)f.unseen,
               100 * (double)f.unseen / (double)f.pairs);
        fflush(stdout);
    }
    box_worker_free(s.worker);
    box_scene_free(scene);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
}

int main(int count, char **arguments) {
    starg_context *context = NULL;
    if (count < 4) {
        fprintf(stderr, "usage: bench_region BOXES SAMPLES MODEL...\n");
        return 1;
    }
    stop_unless(NULL, starg_context_create(NULL, &context));
    printf("| model | vertices | halvings | million vertices/s | found | million faces/s | found | "
           "hidden faces |\n|---|---|---|---|---|---|---|---|\n");
    for (int i = 3; i < count; i++)
        run_model(context, arguments[i], strtoul(arguments[1], NULL, 10),
                  strtoul(arguments[2], NULL, 10));
    starg_context_free(context);
    return 0;
}
