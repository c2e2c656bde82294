/* SPDX-License-Identifier: Apache-2.0 */
/* Linear relaxation min sum x, sum over R(j) of x >= demand(j), 0 <= x <= 1, by Clp's dual simplex
 * method. Most columns are never tight, so the model starts with an even selection and adds the
 * most violated columns round by round, warm-started from the last basis, until none is violated.
 *
 * Columns outside the model have multiplier 0, so the multipliers of any round are valid for all
 * columns; integer arithmetic determines what they prove (dual.c). */
#include "cover/cover.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "cover/exceptions.h"
#include "cover/solver.h"

enum {
    FIRST_COLUMNS = 200,
    MOST_ADDED = 200, /* per round */
    MOST_ENTRIES = INT_MAX / 2
};

static const double TOLERANCE = 1e-6; /* for violations */

typedef struct scored_column {
    double surplus;
    uint32_t column;
} scored_column;

typedef struct relaxing {
    const cover_instance *instance;
    cover_relaxation *out;
    Clp_Simplex *model;
    uint64_t *inside;      /* mask of the columns in the model */
    uint32_t *columns;     /* those, in model order */
    size_t count, entries; /* columns and ones in the model */
    scored_column *short_columns;
    int *index; /* one column at a time */
    double *ones, *zeros;
} relaxing;

static void relaxing_free(relaxing *relax) {
    if (relax->model != NULL)
        Clp_deleteModel(relax->model);
    RELEASE(relax->inside, relax->columns, relax->short_columns, relax->index, relax->ones,
            relax->zeros);
}

static starg_status relaxing_make(const cover_instance *instance, cover_relaxation *out,
                                  relaxing *relax) {
    starg_context *context = instance->context;
    *relax = (relaxing){.instance = instance, .out = out};
    NEW_ZERO(context, "bound", relax->inside, instance->row_words);
    NEW(context, "bound", relax->columns, instance->columns);
    NEW(context, "bound", relax->short_columns, instance->columns);
    NEW(context, "bound", relax->index, instance->rows);
    NEW(context, "bound", relax->ones, instance->rows);
    NEW_ZERO(context, "bound", relax->zeros, instance->rows);
    for (size_t i = 0; i < instance->rows; i++)
        relax->ones[i] = 1;
    return STARG_OK;
}

static void add_column(relaxing *relax, size_t column) {
    const cover_instance *instance = relax->instance;
    int count = 0;
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, cover_column(instance, column)[w])
            relax->index[count++] = (int)(64 * w + bit);
    }
    if (relax->entries + (size_t)count > MOST_ENTRIES)
        return;
    CoinBigIndex starts[2] = {0, count};
    double demand = instance->demands[column];
    Clp_addRows(relax->model, 1, &demand, NULL, starts, relax->index, relax->ones);
    starg_bit_set(relax->inside, column);
    relax->columns[relax->count++] = (uint32_t)column;
    relax->entries += (size_t)count;
}

/* The model with the first columns; false if it cannot be created. */
static bool start_model(relaxing *relax) {
    const cover_instance *instance = relax->instance;
    if (instance->rows >= MOST_ENTRIES || (relax->model = Clp_newModel()) == NULL)
        return false;
    Clp_setLogLevel(relax->model, 0);
    Clp_resize(relax->model, 0, (int)instance->rows);
    Clp_chgColumnLower(relax->model, relax->zeros);
    Clp_chgColumnUpper(relax->model, relax->ones);
    Clp_chgObjCoefficients(relax->model, relax->ones);
    size_t stride = (instance->columns + FIRST_COLUMNS - 1) / FIRST_COLUMNS;
    for (size_t j = 0; j < instance->columns; j += stride)
        add_column(relax, j);
    return true;
}

static int64_t round_multiplier(double value) {
    if (!(value > 0))
        return 0;
    if (value >= (double)COVER_MOST / (double)COVER_ONE)
        return COVER_MOST;
    return llround(value * (double)COVER_ONE);
}

static void read_solution(relaxing *relax) {
    const cover_instance *instance = relax->instance;
    cover_relaxation *out = relax->out;
    const double *solution = Clp_primalColumnSolution(relax->model);
    const double *duals = Clp_dualRowSolution(relax->model);
    for (size_t j = 0; j < instance->columns; j++) {
        out->surplus[j] = -(double)instance->demands[j];
        out->multipliers[j] = 0;
    }
    for (size_t c = 0; c < relax->count; c++)
        out->multipliers[relax->columns[c]] = round_multiplier(duals[c]);
    for (size_t i = 0; i < instance->rows; i++) {
        out->solution[i] = solution[i];
        if (!(solution[i] > 0))
            continue;
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, cover_row(instance, i)[w])
                out->surplus[64 * w + bit] += solution[i];
        }
    }
}

static int compare_scored(const void *a, const void *b) {
    const scored_column *x = a, *y = b;
    if (x->surplus != y->surplus)
        return x->surplus < y->surplus ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* Adds the most violated columns; false if there are none. */
static bool add_violated(relaxing *relax) {
    size_t count = 0, before = relax->count;
    for (size_t j = 0; j < relax->instance->columns; j++) {
        if (relax->out->surplus[j] < -TOLERANCE && !starg_bit_test(relax->inside, j))
            relax->short_columns[count++] = (scored_column){relax->out->surplus[j], (uint32_t)j};
    }
    qsort(relax->short_columns, count, sizeof *relax->short_columns, compare_scored);
    for (size_t c = 0; c < count && c < MOST_ADDED; c++)
        add_column(relax, relax->short_columns[c].column);
    return relax->count > before;
}

static starg_status run_rounds(cover_run *run, relaxing *relax, bool *found) {
    do {
        starg_status status = starg_check_cancel(run->context, "bound");
        if (status != STARG_OK || cover_time_is_over(run))
            return status;
        if (!cover_run_simplex(run, relax->model, !*found))
            return STARG_OK;
        read_solution(relax);
        *found = true;
    } while (add_violated(relax));
    return STARG_OK;
}

typedef struct clp_call {
    cover_run *run;
    relaxing *relax;
    bool *found;
    starg_status status;
} clp_call;

/* An exception may leave this at any call of Clp: results of earlier rounds remain valid. */
static void run_clp(void *argument) {
    clp_call *call = argument;
    if (start_model(call->relax))
        call->status = run_rounds(call->run, call->relax, call->found);
}

/* After an exception the model is not used again. */
static starg_status run_clp_safely(cover_run *run, relaxing *relax, bool *found) {
    clp_call call = {run, relax, found, STARG_OK};
    if (!cover_call_safely(run_clp, &call)) {
        relax->model = NULL;
        cover_solver_give_up();
    }
    return call.status;
}

starg_status cover_relax(cover_run *run, const cover_instance *instance, cover_relaxation *out,
                         bool *found) {
    starg_context *context = run->context;
    SCOPED_BY(cover_solver_unlock) bool held = false;
    SCOPED_BY(relaxing_free) relaxing relax = {0};
    *found = false;
    *out = (cover_relaxation){0};
    NEW_ZERO(context, "bound", out->solution, instance->rows);
    NEW_ZERO(context, "bound", out->surplus, instance->columns);
    NEW_ZERO(context, "bound", out->multipliers, instance->columns);
    TRY(relaxing_make(instance, out, &relax));
    TRY(cover_solver_lock(run, &held));
    return held && instance->columns != 0 ? run_clp_safely(run, &relax, found) : STARG_OK;
}

void cover_relaxation_free(cover_relaxation *relaxation) {
    RELEASE(relaxation->solution, relaxation->surplus, relaxation->multipliers);
    *relaxation = (cover_relaxation){0};
}
