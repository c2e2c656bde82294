/* SPDX-License-Identifier: Apache-2.0 */
/* How much can guards anywhere see, and how few can see a part of everything?
 *
 * If the goal is a part of the area, every face counts, so each cell has a row over all faces:
 * those it may see. k guards stand in at most k cells, and see no more than the union of these
 * cells' rows. So a bound for choosing rows of cells is a bound for guards anywhere: on the weight
 * that max_guards rows cover, or on the number of rows that cover the required weight; both come
 * from the integer bounds of the cover (starguard/cover.h). If several guards must see each face,
 * what is seen often enough is also seen once, so the bound holds as well.
 *
 * Cells are split in the middle of their longest sides: first those of the best choice, then those
 * that may see most. The cover is solved again whenever the number of cells has grown by half.
 *
 * Invariant: the cells of the rows cover all of the free space. Cost: a box test for each face that
 * the parent cell may see; stops when the budget is used up. Independent of the number of
 * threads. */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "guard/candidates.h"
#include "guard/cells.h"
#include "guard/stages.h"

static const char STAGE[] = "search";

enum { LEAST_BATCH = 8 };

typedef struct area_cell {
    bvh_box box;
    uint64_t *open; /* superset of the columns that points of the box see */
    uint64_t weight, work;
    bool chosen; /* in the best choice of cells */
} area_cell;

typedef struct area_search {
    const search_scene *scene; /* first member, as cells_worker_make requires */
    const guard_problem *problem;
    const guard_pool *pool;
    STARG_ARRAY(area_cell) cells; /* leaves only */
    size_t asked_at;              /* number of cells when the cover was last solved */
    size_t bound;                 /* lower bound on the guards for the required weight */
    uint64_t weight_bound;        /* upper bound on the weight that max_guards see */
    uint64_t seen;                /* weight that the guards see */
    uint64_t work;
    scored_leaf *list; /* cells being split, each followed by its other half */
    area_cell *parts;
    size_t part_count;
} area_search;

static uint64_t weight_of(const area_search *a, const uint64_t *row) {
    return column_weights_of(&a->problem->weights, row, starg_bit_words(a->pool->columns));
}

static void look(const area_search *a, box_worker *worker, const uint64_t *among, area_cell *cell) {
    const box_question question = {.box = cell->box,
                                   .target = a->scene->view->target,
                                   .count = a->pool->columns,
                                   .range = a->scene->view->range,
                                   .among = among};
    if (!search_scene_bars(a->scene, &cell->box))
        box_look(worker, &question, cell->open, NULL);
    cell->weight = weight_of(a, cell->open);
    cell->work = box_worker_take_work(worker) + a->pool->columns / 100 + 1;
}

static starg_status look_from_part(starg_context *context, void *shared, void *scratch,
                                   size_t item) {
    const area_search *a = shared;
    (void)context;
    look(a, scratch, a->cells.data[a->list[item / 2].cell].open, &a->parts[item]);
    return STARG_OK;
}

static void free_parts(area_search *a) {
    for (size_t i = 0; a->parts != NULL && i < a->part_count; i++)
        starg_release(a->scene->context, a->parts[i].open);
    RELEASE(a->parts, a->list);
    a->parts = NULL;
    a->list = NULL;
}

/* One half replaces the cell, the other is appended. */
static starg_status take_parts(area_search *a, size_t count) {
    for (size_t i = 0; i < 2 * count; i++) {
        area_cell part = a->parts[i];
        a->work += part.work;
        if (i % 2 == 0) {
            a->parts[i].open = a->cells.data[a->list[i / 2].cell].open;
            a->cells.data[a->list[i / 2].cell] = part;
            continue;
        }
        PUSH(a->scene->context, STAGE, &a->cells, part);
        a->parts[i].open = NULL;
    }
    return STARG_OK;
}

/* Splits the cells at the front of the list. */
static starg_status split(area_search *a, size_t count) {
    starg_context *context = a->scene->context;
    NEW_ZERO(context, STAGE, a->parts, 2 * count);
    a->part_count = 2 * count;
    for (size_t i = 0; i < 2 * count; i++) {
        a->parts[i].box = cell_half(&a->cells.data[a->list[i / 2].cell].box, i % 2 != 0);
        NEW_ZERO(context, STAGE, a->parts[i].open, starg_bit_words(a->pool->columns));
    }
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = 2 * count,
                                      .shared = a,
                                      .item = look_from_part,
                                      .make_scratch = cells_worker_make,
                                      .free_scratch = cells_worker_free,
                                      .silent = true};
    TRY(starg_parallel_for(context, &loop));
    TRY(take_parts(a, count));
    free_parts(a);
    return STARG_OK;
}

/* A cell for each part. */
static starg_status begin(area_search *a) {
    SCOPED search_cells first = {0};
    TRY(cells_begin(a->scene, &first));
    for (size_t i = 0; i < first.count; i++) {
        const search_cell *leaf = &first.data[i];
        if (leaf->children != 0)
            continue;
        area_cell cell = {.box = leaf->box};
        PUSH(a->scene->context, STAGE, &a->cells, cell);
        area_cell *last = &a->cells.data[a->cells.count - 1];
        NEW_ZERO(a->scene->context, STAGE, last->open, starg_bit_words(a->pool->columns));
        for (size_t j = 0; j < a->pool->columns; j++)
            if (search_scene_part(a->scene, (uint32_t)j) == leaf->first_part)
                starg_bit_set(last->open, j);
        last->weight = weight_of(a, last->open);
    }
    return STARG_OK;
}

/* The bound from the cover of the cells' rows: on their number, or on the weight they cover. */
static starg_status ask_cover(area_search *a) {
    starg_context *context = a->scene->context;
    const starg_guard_options *o = a->problem->options;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    TRY(starg_bits_create(context, a->cells.count, a->pool->columns, &rows));
    for (size_t i = 0; i < a->cells.count; i++) {
        memcpy(starg_bits_row_mutable(rows, i), a->cells.data[i].open,
               rows->words * sizeof *rows->data);
        a->cells.data[i].chosen = false;
    }
    problem.rows = rows;
    problem.weights = a->problem->weights.weights;
    problem.max_rows = o->max_guards;
    problem.target = choose_target(a->pool, &a->problem->weights);
    options.max_nodes = 0;
    TRY(starg_cover_solve(context, &problem, &options, &cover));
    for (size_t i = 0; i < cover->count; i++)
        a->cells.data[cover->rows[i]].chosen = true;
    if (o->max_guards > 0 && cover->weight_bound < a->weight_bound)
        a->weight_bound = cover->weight_bound;
    if (o->max_guards == 0 && cover->lower_bound > a->bound)
        a->bound = cover->lower_bound;
    a->work += a->cells.count * a->pool->columns / 16;
    a->asked_at = a->cells.count;
    return STARG_OK;
}

static starg_status split_best(area_search *a, bool *any) {
    size_t count = 0, batch = a->cells.count / 4;
    batch = batch < LEAST_BATCH ? LEAST_BATCH : batch;
    NEW(a->scene->context, STAGE, a->list, a->cells.count);
    for (size_t i = 0; i < a->cells.count; i++) {
        const area_cell *cell = &a->cells.data[i];
        if (cell->weight > 0 && cell_splits(&cell->box))
            a->list[count++] =
                (scored_leaf){cell->chosen ? INFINITY : (double)cell->weight, (uint32_t)i};
    }
    qsort(a->list, count, sizeof *a->list, cells_by_score);
    *any = count > 0;
    return split(a, count < batch ? count : batch);
}

/* Is there nothing left to prove? */
static bool is_proven(const area_search *a, const guard_selection *selection) {
    if (a->problem->options->max_guards > 0)
        return a->weight_bound <= a->seen;
    return a->bound >= selection->chosen.count;
}

static starg_status run(area_search *a, const guard_selection *selection) {
    starg_context *context = a->scene->context;
    uint64_t most = a->problem->options->prove_work;
    bool any = true;
    while (any && a->work < most && !is_proven(a, selection) && !starg_time_is_over(context)) {
        starg_progress_step(context, a->work, most);
        TRY(starg_check_cancel(context, STAGE));
        TRY(split_best(a, &any));
        if (2 * a->cells.count > 3 * a->asked_at)
            TRY(ask_cover(a));
    }
    if (!is_proven(a, selection) && a->cells.count > a->asked_at)
        TRY(ask_cover(a));
    return STARG_OK;
}

static void end(area_search *a) {
    free_parts(a);
    for (size_t i = 0; i < a->cells.count; i++)
        starg_release(a->problem->context, a->cells.data[i].open);
    RELEASE(a->cells.data);
}

starg_status search_area(const guard_problem *problem, const guard_pool *pool,
                         guard_selection *selection, search_record *out) {
    starg_context *context = problem->context;
    const starg_guard_options *o = problem->options;
    IN_STAGE(context, STAGE);
    SCOPED_BY(search_scene_close) search_scene scene = {0};
    SCOPED_BY(starg_bits_drop) starg_bits *chosen = NULL;
    SCOPED uint64_t *joined = NULL;
    SCOPED_BY(end)
    area_search a = {.scene = &scene,
                     .problem = problem,
                     .pool = pool,
                     .bound = selection->chosen.count > 0,
                     .weight_bound = problem->weights.total};
    TRY(search_scene_open(context, problem->solid, &o->visibility, o->clearance, &scene));
    TRY(pool_copy_rows(pool, selection->chosen.data, selection->chosen.count, &chosen));
    TRY(pool_join_rows(context, chosen, &joined));
    a.seen = weight_of(&a, joined);
    TRY(begin(&a));
    TRY(run(&a, selection));
    selection->time_limited = selection->time_limited || starg_time_is_over(context);
    context->work += a.work;
    *out = (search_record){.cells = a.cells.count, .prove_work = a.work};
    if (o->max_guards > 0)
        out->weight_bound = a.weight_bound;
    else
        out->bound = a.bound;
    if (out->bound > selection->lower_bound)
        selection->lower_bound = out->bound;
    return STARG_OK;
}
