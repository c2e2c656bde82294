/* SPDX-License-Identifier: Apache-2.0 */
/* A box is tested only for what is asked about, and not for what one of its points is known to see.
 * The random points of a box follow from its number: nothing depends on who tests it.
 *
 * A new box is trimmed first (visibility/box_trim.c).
 *
 * Invariant: no point of a box in the free space sees a witness that was asked about and is not
 * open.
 * Cost: a box test for each vertex that is asked about, about 10 sight lines for each vertex that
 * the box sees. */
#include "guard/cells.h"

#include "core/rng.h"
#include "core/streams.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"

static const char STAGE[] = "search";

starg_status cells_worker_make(starg_context *context, void *shared, void **scratch) {
    const search_scene *const *scene = shared;
    box_worker *worker = NULL;
    (void)context;
    starg_status status = box_worker_create((*scene)->boxes, &worker);
    *scratch = worker;
    return status;
}

void cells_worker_free(starg_context *context, void *scratch) {
    (void)context;
    box_worker_free(scratch);
}

/* If views are directed: aims at a random witness among those that the box may see. */
static void look_somewhere(const search_scene *scene, search_point *point, const witness_row *among,
                           starg_rng *rng) {
    size_t count = starg_bit_count(among->bits, WITNESS_WORDS), at = 0;
    if (!sensor_is_directed(scene->view) || count == 0)
        return;
    uint64_t chosen = starg_rng_below(rng, count);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, among->bits[w])
            at = chosen-- == 0 ? 64 * w + bit : at;
    double centre[3];
    search_scene_centre(scene, at, centre);
    vec3_subtract(centre, point->place, point->direction);
    double length = vec3_length(point->direction);
    for (int k = 0; k < 3 && length > 0; k++)
        point->direction[k] /= length;
}

/* Looks from a place of the box, if guards may stand there. */
static void try_place(const search_scene *scene, const double p[3], const witness_row *among,
                      starg_rng *rng, cell_answer *answer, search_point *points) {
    search_point *point = &points[answer->point_count];
    if (!candidates_allowed(scene->solid, p, scene->clearance))
        return;
    *point = (search_point){.candidate = UINT32_MAX};
    vec3_copy(p, point->place);
    look_somewhere(scene, point, among, rng);
    answer->work += search_scene_look(scene, point, among);
    answer->point_count++;
}

static void look_from_box(const search_scene *scene, box_worker *worker, const bvh_box *box,
                          const witness_row *among, const witness_row *known, cell_answer *answer) {
    uint64_t before = box_worker_tests(worker);
    const box_question question = {.box = *box,
                                   .target = scene->view->target,
                                   .targets = scene->witnesses.data,
                                   .count = scene->witnesses.count,
                                   .range = scene->view->range,
                                   .among = among->bits,
                                   .known = known->bits};
    if (!search_scene_bars(scene, box))
        box_look(worker, &question, answer->open.bits, NULL);
    answer->work += box_worker_tests(worker) - before;
}

static starg_status run_test(starg_context *context, void *shared, void *scratch, size_t item) {
    const cell_tests *all = shared;
    const cell_test *test = &all->tests[item];
    cell_answer *answer = &all->answers[item];
    search_point *points = cell_tests_points(all, item);
    starg_rng rng = starg_rng_make(context->seed, STREAM_CELLS, all->first + item);
    witness_row known = {{0}};
    double p[3];
    *answer = (cell_answer){0};
    bvh_box box = test->box;
    if (all->tries > 0)
        answer->cut_count = box_trim(scratch, &box, answer->cuts);
    for (int i = 0; i < all->tries; i++) {
        for (int k = 0; k < 3; k++)
            p[k] = i == 0 ? 0.5 * box.lower[k] + 0.5 * box.upper[k]
                          : box.lower[k] + starg_rng_unit(&rng) * (box.upper[k] - box.lower[k]);
        try_place(all->scene, p, &test->among, &rng, answer, points);
    }
    for (size_t i = 0; i < answer->point_count; i++)
        for (int w = 0; w < WITNESS_WORDS; w++)
            known.bits[w] |= points[i].seen.bits[w];
    look_from_box(all->scene, scratch, &box, &test->among, &known, answer);
    return STARG_OK;
}

starg_status cell_tests_run(starg_context *context, cell_tests *tests,
                            const starg_parallel_remote *remote) {
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = tests->count,
                                      .shared = tests,
                                      .item = run_test,
                                      .make_scratch = cells_worker_make,
                                      .free_scratch = cells_worker_free,
                                      .silent = true,
                                      .remote = remote};
    return starg_parallel_for(context, &loop);
}
