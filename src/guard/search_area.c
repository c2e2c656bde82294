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
#include "guard/cell_tests.h"
#include "guard/search_parts.h"

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
} area_search;

static void look(const area_search *a, box_worker *worker, const uint64_t *among, area_cell *cell) {
    const box_question question = {.box = cell->box,
                                   .target = a->scene->view->target,
                                   .count = a->pool->columns,
                                   .range = a->scene->view->range,
                                   .among = among};
    if (!search_scene_bars(a->scene, &cell->box))
        box_look(worker, &question, cell->open, NULL);
    cell->weight = 0;
    for (size_t w = 0; w < starg_bit_words(a->pool->columns); w++)
        STARG_FOR_BITS (bit, cell->open[w])
            cell->weight += a->problem->weights.weights[64 * w + bit];
    cell->work = box_worker_take_work(worker) + a->pool->columns / 100 + 1;
}

static starg_status look_from_part(starg_context *context, void *shared, void *scratch,
                                   size_t item) {
    const area_search *a = shared;
    (void)context;
    look(a, scratch, a->cells.data[a->list[item / 2].cell].open, &a->parts[item]);
    return STARG_OK;
}

static void free_parts(area_search *a, size_t count) {
    for (size_t i = 0; a->parts != NULL && i < count; i++)
        starg_release(a->scene->context, a->parts[i].open);
    starg_release(a->scene->context, a->parts);
    a->parts = NULL;
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
    starg_status status = STARG_OK;
    starg_context *context = a->scene->context;
    STARG_NEW_ZERO(context, STAGE, a->parts, 2 * count);
    for (size_t i = 0; i < 2 * count; i++) {
        a->parts[i].box = cell_half(&a->cells.data[a->list[i / 2].cell].box, i % 2 != 0);
        STARG_NEW_ZERO(context, STAGE, a->parts[i].open, starg_bit_words(a->pool->columns));
    }
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = 2 * count,
                                      .shared = a,
                                      .item = look_from_part,
                                      .make_scratch = cells_worker_make,
                                      .free_scratch = cells_worker_free,
                                      .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    STARG_TRY(take_parts(a, count));
done:
    free_parts(a, 2 * count);
    return status;
}

/* A cell for each part. */
static starg_status begin(area_search *a) {
    starg_status status = STARG_OK;
    search_cells first = {0};
    area_cell cell = {0};
    STARG_TRY(cells_begin(a->scene, &first));
    for (size_t i = 0; i < first.count; i++) {
        const search_cell *leaf = &first.data[i];
        if (leaf->children != 0)
            continue;
        cell = (area_cell){.box = leaf->box};
        STARG_NEW_ZERO(a->scene->context, STAGE, cell.open, starg_bit_words(a->pool->columns));
        for (size_t j = 0; j < a->pool->columns; j++)
            if (search_scene_part(a->scene, (uint32_t)j) == leaf->first_part) {
                starg_bit_set(cell.open, j);
                cell.weight += a->problem->weights.weights[j];
            }
        STARG_PUSH(a->scene->context, STAGE, &a->cells, cell);
        cell.open = NULL;
    }
done:
    RELEASE(first.data, cell.open);
    return status;
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
    starg_status status = STARG_OK;
    size_t count = 0, batch = a->cells.count / 4;
    batch = batch < LEAST_BATCH ? LEAST_BATCH : batch;
    STARG_NEW(a->scene->context, STAGE, a->list, a->cells.count);
    for (size_t i = 0; i < a->cells.count; i++) {
        const area_cell *cell = &a->cells.data[i];
        if (cell->weight > 0 && cell_splits(&cell->box))
            a->list[count++] =
                (scored_leaf){cell->chosen ? INFINITY : (double)cell->weight, (uint32_t)i};
    }
    qsort(a->list, count, sizeof *a->list, search_by_score);
    *any = count > 0;
    STARG_TRY(split(a, count < batch ? count : batch));
done:
    starg_release(a->scene->context, a->list);
    a->list = NULL;
    return status;
}

/* The weight that the chosen candidates see. */
static uint64_t seen_weight(const area_search *a, const guard_selection *selection) {
    uint64_t seen = 0;
    for (size_t w = 0; w < a->pool->rows->words; w++) {
        uint64_t joined = 0;
        for (size_t i = 0; i < selection->chosen.count; i++)
            joined |= starg_bits_row(a->pool->rows, selection->chosen.data[i])[w];
        STARG_FOR_BITS (bit, joined)
            seen += a->problem->weights.weights[64 * w + bit];
    }
    return seen;
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

starg_status search_area(const guard_problem *problem, const guard_pool *pool,
                         guard_selection *selection, search_record *out) {
    starg_status status = STARG_OK;
    search_scene scene = {0};
    area_search a = {.scene = &scene,
                     .problem = problem,
                     .pool = pool,
                     .bound = selection->chosen.count > 0,
                     .weight_bound = problem->weights.total};
    starg_progress_begin(problem->context, STAGE);
    STARG_TRY(search_scene_open(problem->context, problem->solid, &problem->options->visibility,
                                problem->options->clearance, &scene));
    a.seen = seen_weight(&a, selection);
    STARG_TRY(begin(&a));
    STARG_TRY(run(&a, selection));
    selection->time_limited = selection->time_limited || starg_time_is_over(problem->context);
    problem->context->work += a.work;
    *out = (search_record){.cells = a.cells.count, .prove_work = a.work};
    if (problem->options->max_guards > 0)
        out->weight_bound = a.weight_bound;
    else
        out->bound = a.bound;
    selection->lower_bound =
        out->bound > selection->lower_bound ? out->bound : selection->lower_bound;
done:
    for (size_t i = 0; i < a.cells.count; i++)
        starg_release(problem->context, a.cells.data[i].open);
    STARG_ARRAY_FREE(problem->context, &a.cells);
    search_scene_close(&scene);
    starg_progress_end(problem->context);
    return status;
}
