/* SPDX-License-Identifier: Apache-2.0 */
/* Real solids: no point of a box sees what is reported as hidden from all of it. Points of the
 * boxes, including adversarial ones, are tested by the point engines; on the smallest solids also
 * by the definition, in rationals where doubles are not certain. Prints how many of the pairs of a
 * box and a vertex or face seen by no point were found to be hidden. Up to ten million pairs with
 * STARGUARD_LONG. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "core/bits.h"
#include "models.h"
#include "starguard/visibility.h"
#include "visibility/box.h"
#include "visibility_oracle.h"

enum { POINTS = 40, EXACT_POINTS = 4, EXACT_VERTICES = 400 };

typedef struct tally {
    size_t pairs, hidden, unseen, exact;
} tally;

typedef struct subject {
    starg_context *context;
    const char *name;
    const starg_solid *solid;
    box_worker *worker;
} subject;

static void contradict(const subject *s, const bvh_box *box, const double p[3], size_t target) {
    fail_msg("%s, box (%a, %a, %a) to (%a, %a, %a): (%a, %a, %a) sees %zu, which is hidden",
             s->name, box->lower[0], box->lower[1], box->lower[2], box->upper[0], box->upper[1],
             box->upper[2], p[0], p[1], p[2], target);
}

/* By the definition, for a few points. */
static void check_exactly(const subject *s, const box_question *q, const uint64_t *open,
                          const double *points, size_t count, tally *sum) {
    const starg_mesh *mesh = starg_solid_mesh(s->solid);
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    bool *seen = calloc(n + m, sizeof *seen);
    assert_non_null(seen);
    for (size_t i = 0; i < count; i++) {
        const double *p = points + 3 * i;
        if (q->target == STARG_TARGET_FACES)
            visibility_oracle_faces(starg_mesh_vertices(mesh), n, starg_mesh_faces(mesh), m, p,
                                    false, seen);
        else
            visibility_oracle_vertices(starg_mesh_vertices(mesh), n, starg_mesh_faces(mesh), m, p,
                                       seen);
        for (size_t j = 0; j < q->count; j++)
            if (seen[j] && !starg_bit_test(open, j))
                contradict(s, &q->box, p, j);
        sum->exact += q->count;
    }
    free(seen);
}

static void check_box(const subject *s, starg_target target, const bvh_box *box,
                      const double *points, size_t count, tally *sum) {
    const starg_mesh *mesh = starg_solid_mesh(s->solid);
    starg_visibility_options options;
    starg_visibility_options_default(&options);
    options.target = target;
    box_question q = {.box = *box, .target = target, .range = INFINITY};
    q.count =
        target == STARG_TARGET_FACES ? starg_mesh_face_count(mesh) : starg_mesh_vertex_count(mesh);
    uint64_t *open = calloc(starg_bit_words(q.count), sizeof *open);
    starg_bits *seen = NULL;
    assert_non_null(open);
    box_look(s->worker, &q, open, NULL);
    test_ok(s->context, starg_visibility(s->context, s->solid, points, count, &options, &seen));
    for (size_t j = 0; j < q.count; j++) {
        bool once = false;
        for (size_t i = 0; i < count && !once; i++) {
            once = starg_bits_test(seen, i, j);
            if (once && !starg_bit_test(open, j))
                contradict(s, box, points + 3 * i, j);
        }
        sum->unseen += !once;
        sum->hidden += !starg_bit_test(open, j);
    }
    sum->pairs += q.count;
    if (starg_mesh_vertex_count(mesh) <= EXACT_VERTICES)
        check_exactly(s, &q, open, points, count < EXACT_POINTS ? count : EXACT_POINTS, sum);
    starg_bits_free(seen);
    free(open);
}

static void check_solid(starg_context *context, const char *name, const starg_solid *solid,
                        size_t pairs, tally *sum) {
    box_scene *scene = NULL;
    subject s = {.context = context, .name = name, .solid = solid};
    double points[3 * POINTS];
    test_ok(context, box_scene_create(context, solid, &scene));
    test_ok(context, box_worker_create(scene, &s.worker));
    size_t end = sum->pairs + pairs;
    for (size_t i = 0; sum->pairs < end; i++) {
        starg_rng rng = starg_rng_make(17, 6, i);
        bvh_box box = box_about(solid, &rng, i);
        size_t count = box_points(solid, &box, &rng, POINTS, points);
        check_box(&s, (starg_target)(i % 3 == 0), &box, points, count, sum);
    }
    box_worker_free(s.worker);
    box_scene_free(scene);
}

static void test_shared_solids(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    size_t most = test_rounds(800, 20000), pairs = test_rounds(4000, 100000), solids = 0;
    tally sum = {0};
    FILE *tables = test_tables(data);
    starg_context *context = test_context(2);
    for (test_row row = {0}; test_next_row(tables, data, &row);) {
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        if (starg_mesh_read(context, row.path, &mesh) == STARG_OK &&
            starg_mesh_vertex_count(mesh) <= most &&
            starg_solid_create(context, mesh, &solid) == STARG_OK) {
            check_solid(context, row.file, solid, pairs, &sum);
            solids++;
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    fclose(tables);
    printf("%zu solids, %zu pairs (%zu of them by definition); found hidden: %.1f %% of those that "
           "no point sees\n",
           solids, sum.pairs, sum.exact, 100 * (double)sum.hidden / (double)sum.unseen);
    assert_true(solids > 10 && 2 * sum.hidden > sum.unseen);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shared_solids)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
