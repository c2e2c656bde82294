/* SPDX-License-Identifier: Apache-2.0 */
/* Subgradient method for the Lagrangian dual, with covers built from its reduced costs, after
 * [CFT99] with Held and Karp's step length control. Floating point only steers: the multipliers of
 * every step are rounded to integers and evaluated exactly. Cost of a step: the ones of the matrix,
 * twice. */
#include <stdlib.h>

#include "cover/cover.h"

enum {
    MOST_STEPS = 400,
    STEPS_PER_REVIEW = 20, /* steps between adjustments of the step factor */
    STEPS_PER_COVER = 10   /* steps between covers from the reduced costs */
};

typedef struct priced_row {
    int64_t price;
    uint32_t row;
} priced_row;

typedef struct lagrange {
    const cover_instance *instance;
    cover_dual *dual;
    cover_state *best, *trial;
    double *point;              /* multipliers, in rows */
    double *slope;              /* subgradient per column */
    int64_t *rounded, *reduced; /* multipliers of this step, and their reduced costs */
    priced_row *order;
    int64_t value;    /* exact value of this step */
    int64_t reached;  /* best value of the steps so far */
    int64_t reviewed; /* `reached` at the last review */
    double factor;
} lagrange;

static int compare_priced(const void *a, const void *b) {
    const priced_row *x = a, *y = b;
    if (x->price != y->price)
        return x->price < y->price ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

static bool is_closed(const lagrange *search) {
    return cover_dual_rows(search->dual->value) >= search->best->count;
}

static void evaluate(lagrange *search) {
    const cover_instance *instance = search->instance;
    for (size_t j = 0; j < instance->columns; j++)
        search->rounded[j] = (int64_t)(search->point[j] * (double)COVER_ONE);
    search->value = cover_dual_value(instance, search->rounded, search->reduced);
    cover_dual_offer(instance, search->dual, search->rounded, search->reduced, search->value);
    if (search->value > search->reached)
        search->reached = search->value;
}

/* The subgradient: what each column lacks if the rows of negative cost are chosen. Returns its
 * squared length; ignores components that would make a zero multiplier negative. */
static double find_slope(lagrange *search) {
    const cover_instance *instance = search->instance;
    double square = 0;
    for (size_t j = 0; j < instance->columns; j++)
        search->slope[j] = instance->demands[j];
    for (size_t i = 0; i < instance->rows; i++) {
        if (search->reduced[i] >= 0)
            continue;
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, cover_row(instance, i)[w])
                search->slope[64 * w + bit] -= 1;
        }
    }
    for (size_t j = 0; j < instance->columns; j++) {
        if (search->slope[j] < 0 && search->point[j] <= 0)
            search->slope[j] = 0;
        square += search->slope[j] * search->slope[j];
    }
    return square;
}

static void take_step(lagrange *search, double square) {
    double most = (double)COVER_MOST / (double)COVER_ONE;
    double gap = (double)search->best->count - (double)search->value / (double)COVER_ONE;
    double length = search->factor * gap / square;
    for (size_t j = 0; j < search->instance->columns; j++) {
        double next = search->point[j] + length * search->slope[j];
        search->point[j] = next < 0 ? 0 : next > most ? most : next;
    }
}

/* Shortens steps if the last ones did not improve the value. */
static void review(lagrange *search) {
    if (search->reached <= search->reviewed)
        search->factor *= 0.5;
    search->reviewed = search->reached;
}

/* Builds a cover from the cheapest rows and drops redundant ones. */
static void build_cover(lagrange *search) {
    const cover_instance *instance = search->instance;
    cover_state *trial = search->trial;
    for (size_t i = 0; i < instance->rows; i++)
        search->order[i] = (priced_row){search->reduced[i], (uint32_t)i};
    qsort(search->order, instance->rows, sizeof *search->order, compare_priced);
    cover_state_clear(trial);
    for (size_t k = 0; k < instance->rows && trial->weight < instance->total; k++) {
        if (cover_state_need(trial, search->order[k].row) != 0)
            cover_state_add(trial, search->order[k].row);
    }
    cover_drop_needless(trial, instance->total);
    if (trial->count < search->best->count)
        cover_state_copy(search->best, trial);
}

static starg_status iterate(cover_run *run, lagrange *search) {
    for (size_t step = 1; step <= MOST_STEPS && !is_closed(search); step++) {
        starg_status status = starg_check_cancel(run->context, "bound");
        if (status != STARG_OK || cover_time_is_over(run))
            return status;
        starg_progress_step(run->context, step, MOST_STEPS);
        evaluate(search);
        double square = find_slope(search);
        if (step % STEPS_PER_COVER == 0 || square == 0)
            build_cover(search);
        if (square == 0)
            break; /* a maximum */
        if (step % STEPS_PER_REVIEW == 0)
            review(search);
        take_step(search, square);
    }
    return STARG_OK;
}

/* Each column pays 1 / n for its largest row, of n columns: dual feasible and spread out, which
 * suits the method better than the vertex where dual ascent ends. */
static void set_start(lagrange *search) {
    const cover_instance *instance = search->instance;
    for (size_t j = 0; j < instance->columns; j++)
        search->point[j] = 1;
    for (size_t i = 0; i < instance->rows; i++) {
        const uint64_t *row = cover_row(instance, i);
        double share = 1 / (double)starg_bit_count(row, instance->row_words);
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, row[w]) {
                if (share < search->point[64 * w + bit])
                    search->point[64 * w + bit] = share;
            }
        }
    }
}

starg_status cover_lagrange(cover_run *run, const cover_instance *instance, cover_dual *dual,
                            cover_state *best) {
    starg_status status = STARG_OK;
    starg_context *context = run->context;
    cover_state trial = {0};
    lagrange search = {.instance = instance,
                       .dual = dual,
                       .best = best,
                       .trial = &trial,
                       .reached = INT64_MIN,
                       .reviewed = INT64_MIN,
                       .factor = 1};
    STARG_TRY(cover_state_create(instance, &trial));
    STARG_NEW(context, "bound", search.point, instance->columns);
    STARG_NEW(context, "bound", search.slope, instance->columns);
    STARG_NEW(context, "bound", search.rounded, instance->columns);
    STARG_NEW(context, "bound", search.reduced, instance->rows);
    STARG_NEW(context, "bound", search.order, instance->rows);
    set_start(&search);
    STARG_TRY(iterate(run, &search));
done:
    cover_state_free(&trial);
    RELEASE(search.point, search.slope, search.rounded, search.reduced, search.order);
    return status;
}
