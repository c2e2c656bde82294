/* SPDX-License-Identifier: Apache-2.0 */
/* Tests of boxes by other processes.
 *
 * A search has hundreds of short loops over the same solid. So the first job of a search contains
 * the solid; helpers keep it for the following ones, which contain the witnesses and the boxes
 * only. A scene has a number, by which rank 0 knows which one the helpers hold, and a helper
 * notices a job that does not follow on its own.
 *
 * Limits: scenes (guards outside, obstacles, ...) are not shared: where guards may stand there is
 * in no job.
 * Cost: 200 bytes a box and way, and per helper what visibility/rows_remote.c says of the solid. */
#include "core/context.h"
#include "guard/cells.h"
#include "visibility/scene.h"

static const char STAGE[] = "search";

/* Fewer boxes, each about a millisecond, are not worth the messages. */
enum { LEAST_SHARED = 16 };

typedef struct job_head {
    uint64_t scene;  /* its number */
    uint64_t begins; /* 1: the solid follows */
    uint64_t witnesses, count, first;
    int64_t tries;
    double clearance;
} job_head;

typedef struct remote_tests {
    uint64_t number;
    starg_solid *solid;
    starg_visibility_options view;
    search_scene scene;
    cell_test *tests;
    size_t count, first;
    int tries;
} remote_tests;

/* ---- rank 0 ---- */

static starg_status pack(starg_context *context, const cell_tests *all, starg_bytes *out) {
    const search_scene *scene = all->scene;
    const job_head head = {.scene = scene->number,
                           .begins = context->shared_scene != scene->number,
                           .witnesses = scene->witnesses.count,
                           .count = all->count,
                           .first = all->first,
                           .tries = all->tries,
                           .clearance = scene->clearance};
    TRY(starg_bytes_put(context, out, &head, 1, sizeof head));
    if (head.begins)
        TRY(visibility_pack_scene(context, scene->solid, scene->view, 0, out));
    TRY(starg_bytes_put(context, out, scene->witnesses.data, scene->witnesses.count,
                        sizeof *scene->witnesses.data));
    return starg_bytes_put(context, out, all->tests, all->count, sizeof *all->tests);
}

static bool is_sound_answer(const cell_tests *all, const cell_answer *answer) {
    if (answer->point_count > (uint64_t)all->tries || answer->cut_count < 0 ||
        answer->cut_count > BOX_CUTS)
        return false;
    for (int64_t i = 0; i < answer->cut_count; i++) {
        const box_cut *cut = &answer->cuts[i];
        if (cut->axis < 0 || cut->axis > 2 || cut->above < 0 || cut->above > 1)
            return false;
    }
    return true;
}

/* A reply holds for each box its answer, and the points that it counts. */
static starg_status take(starg_context *context, void *shared, size_t first, size_t count,
                         starg_bytes_reader *reply) {
    cell_tests *all = shared;
    (void)context;
    for (size_t i = first; i < first + count; i++) {
        cell_answer *answer = &all->answers[i];
        if (!starg_bytes_take(reply, answer, 1, sizeof *answer) || !is_sound_answer(all, answer) ||
            !starg_bytes_take(reply, cell_tests_points(all, i), answer->point_count,
                              sizeof *all->points))
            return STARG_ERROR_RANK;
    }
    return reply->left == 0 ? STARG_OK : STARG_ERROR_RANK;
}

starg_status cell_tests_share(starg_context *context, cell_tests *tests) {
    SCOPED starg_bytes packed = {0};
    const starg_parallel_remote remote = {.work = RANKS_CELLS, .job = &packed, .take = take};
    if (context->ranks == NULL || tests->count < LEAST_SHARED || tests->scene->solid->scene)
        return cell_tests_run(context, tests, NULL);
    TRY(pack(context, tests, &packed));
    context->shared_scene = tests->scene->number;
    return cell_tests_run(context, tests, &remote);
}

/* ---- helpers ---- */

static void end(starg_context *context, void *state) {
    (void)context;
    remote_tests *job = state;
    if (job == NULL)
        return;
    search_scene_close(&job->scene);
    starg_solid_free(job->solid);
    RELEASE(job->tests, job);
}

static starg_status begin_scene(starg_context *context, const job_head *head,
                                starg_bytes_reader *bytes, void **state) {
    remote_tests *job = NULL;
    end(context, *state);
    *state = NULL;
    NEW_ZERO(context, STAGE, job, 1);
    *state = job;
    TRY(visibility_unpack_scene(context, bytes, &job->solid, &job->view));
    TRY(search_scene_open(context, job->solid, &job->view, head->clearance, &job->scene));
    job->number = head->scene;
    return STARG_OK;
}

static starg_status take_witnesses(starg_context *context, remote_tests *job, size_t count,
                                   starg_bytes_reader *bytes) {
    size_t columns = target_columns(job->solid, job->view.target);
    job->scene.witnesses.count = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t column;
        if (!starg_bytes_take(bytes, &column, 1, sizeof column) || column >= columns)
            return STARG_ERROR_RANK;
        PUSH(context, STAGE, &job->scene.witnesses, column);
    }
    return STARG_OK;
}

static bool is_sound(const job_head *head, size_t left) {
    return head->witnesses <= MOST_WITNESSES && head->count <= left / sizeof(cell_test) &&
           head->tries >= 0 && head->tries <= MOST_TRIES && head->clearance >= 0;
}

static starg_status begin(starg_context *context, starg_bytes_reader *bytes, void **state) {
    job_head head;
    void *tests;
    if (!starg_bytes_take(bytes, &head, 1, sizeof head) || !is_sound(&head, bytes->left))
        return STARG_ERROR_RANK;
    if (head.begins)
        TRY(begin_scene(context, &head, bytes, state));
    remote_tests *job = *state;
    if (job == NULL || job->number != head.scene)
        return STARG_ERROR_RANK;
    TRY(take_witnesses(context, job, head.witnesses, bytes));
    starg_release(context, job->tests);
    job->tests = NULL;
    job->count = 0;
    TRY(starg_bytes_take_block(context, bytes, head.count, sizeof *job->tests, &tests));
    job->tests = tests;
    job->count = head.count;
    job->first = head.first;
    job->tries = (int)head.tries;
    return STARG_OK;
}

static starg_status reply_with(starg_context *context, const cell_tests *all, starg_bytes *reply) {
    for (size_t i = 0; i < all->count; i++) {
        const cell_answer *answer = &all->answers[i];
        TRY(starg_bytes_put(context, reply, answer, 1, sizeof *answer));
        TRY(starg_bytes_put(context, reply, cell_tests_points(all, i), answer->point_count,
                            sizeof *all->points));
    }
    return STARG_OK;
}

static starg_status run(starg_context *context, void *state, size_t first, size_t count,
                        starg_bytes *reply) {
    starg_status status = STARG_OK;
    const remote_tests *job = state;
    if (count > job->count || first > job->count - count)
        return STARG_ERROR_RANK;
    cell_tests all = {.scene = &job->scene,
                      .tests = job->tests + first,
                      .count = count,
                      .first = job->first + first,
                      .tries = job->tries};
    STARG_NEW(context, STAGE, all.answers, count);
    STARG_NEW(context, STAGE, all.points, count * (size_t)job->tries);
    STARG_TRY(cell_tests_run(context, &all, NULL));
    STARG_TRY(reply_with(context, &all, reply));
done:
    RELEASE(all.answers, all.points);
    return status;
}

const ranks_work cells_ranks_work = {begin, run, end};

starg_status starg_ranks_serve(starg_context *context, const starg_ranks *ranks) {
    const ranks_work *const works[RANKS_WORKS] = {
        [RANKS_VISIBILITY] = &visibility_ranks_work, [RANKS_CELLS] = &cells_ranks_work};
    return ranks_serve(context, ranks, works);
}
