/* SPDX-License-Identifier: Apache-2.0 */
/* Linear relaxation with a limit K on the rows, for its multipliers: with y(j) the fraction of
 * column j that counts and h(j) the sum of x over R(j),
 *
 *     max sum w y,  sum x <= K,  demand(j) y(j) <= h(j),  0 <= x <= 1,  0 <= y <= 1.
 *
 * Its value grows with K and is concave. In the relaxation, the fewest rows for a goal is the K
 * where it reaches the goal: K starts at the known bound and follows it, since the multipliers of
 * each K bound the weight of every other number of rows too (Newton's method from below).
 *
 * Most columns lie on one side of their bend w min(1, h / demand): clearly covered, with multiplier
 * 0 and all their weight kept, or short of it, with the full multiplier w / demand and a weight
 * that is linear in x. So the model starts with rows only: each column is replaced by one of its
 * sides, which can only raise the covered weight. The columns with the largest overestimates are
 * added round by round, as
 *
 *     h + demand s >= demand   (kept:   s >= 0 takes w s away)   or
 *     h - demand e <= demand   (linear: e >= 0 takes w e away).
 *
 * The last basis stays dual feasible, for Clp's dual simplex. When nothing is overestimated, the
 * relaxation of all columns is solved. The first sides come from an average of subgradient steps,
 * which tends to the relaxation's solution.
 *
 * Invariant: replacing a column fixes its multiplier, and any multipliers within their bounds prove
 * something (weight_bound.c). The multipliers of each round are rounded to integers and evaluated
 * there exactly; no claim of Clp is trusted.
 *
 * Cost: a subgradient step takes the ones of the matrix, a round the simplex method on the added
 * columns, some hundreds of steps. */
#include "cover/cover.h"

#include <float.h>
#include <limits.h>
#include <stdlib.h>

#include <Clp_C_Interface.h>

#include "cover/exceptions.h"
#include "cover/solver.h"

enum {
    STEPS = 100,      /* towards the first sides */
    MOST_ADDED = 300, /* columns per round */
    MOST_ROUNDS = 100,
    BATCH_ENTRIES = 1 << 20, /* at least one column's */
    MOST_ENTRIES = INT_MAX / 2
};

/* For overestimates, as a fraction of the total weight; the second for bounds that a relaxed run
 * gives of the weight of a number of rows, which is no worse by more. */
static const double TOLERANCE = 1e-7, ROUGH_TOLERANCE = 5e-3;

/* Half width of the bend h = demand while choosing sides, as a fraction of the demand. */
static const double BEND = 0.1;

typedef struct overstated {
    double excess;
    uint32_t column;
} overstated;

typedef struct relaxing {
    const cover_instance *instance;
    cover_weight_bound *bound;
    bool by_goal;    /* K follows the bound for the goal */
    uint64_t enough; /* rows for the goal or weight of the rows: stop at this bound */
    double tolerance;
    size_t limit; /* K */
    Clp_Simplex *model;
    double unit;             /* mean weight, 1 in the model */
    uint64_t *inside, *kept; /* masks: in the model; replaced by w */
    uint32_t *columns;       /* those inside, in model order */
    size_t count, entries;   /* columns and ones in the model */
    double *cost;            /* per row: minus the contribution of the linear columns */
    double *held;            /* per column: h */
    overstated *found;       /* columns outside */
    int *index;              /* a batch of columns */
    double *ones;
    CoinBigIndex starts[MOST_ADDED + 1];
    size_t room;
} relaxing;

static void relaxing_free(relaxing *relax) {
    if (relax->model != NULL)
        Clp_deleteModel(relax->model);
    RELEASE(relax->inside, relax->kept, relax->columns, relax->cost, relax->held, relax->found,
            relax->index, relax->ones);
}

/* A scaled number, clamped to between 0 and the largest multiplier; 0 for NaN. */
static uint64_t cover_near_multiplier(const cover_instance *instance,
                                      const cover_weight_bound *bound, size_t column,
                                      double value) {
    uint64_t largest = cover_largest_multiplier(instance, bound, column);
    return !(value > 0) ? 0 : value >= (double)largest ? largest : (uint64_t)value;
}

/* Multipliers that decrease from full to 0 while h crosses the bend. */
static void set_trial(const relaxing *relax) {
    const cover_instance *instance = relax->instance;
    for (size_t j = 0; j < instance->columns; j++) {
        double short_of = 0.5 + (1 - relax->held[j] / instance->demands[j]) / (2 * BEND);
        double full = (double)cover_largest_multiplier(instance, relax->bound, j);
        relax->bound->trial[j] = cover_near_multiplier(instance, relax->bound, j, short_of * full);
    }
}

/* Moves x a fraction of the way to the K rows with the largest sums of multipliers. */
static void step_towards_best(relaxing *relax, double part) {
    const cover_instance *instance = relax->instance;
    for (size_t j = 0; j < instance->columns; j++)
        relax->held[j] *= 1 - part;
    for (size_t k = 0; k < relax->limit && k < instance->rows; k++) {
        const uint64_t *row = cover_row(instance, relax->bound->scores[k].row);
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, row[w])
                relax->held[64 * w + bit] += part;
        }
    }
}

static bool is_enough(const relaxing *relax) {
    return relax->by_goal ? relax->bound->least >= relax->enough
                          : relax->bound->most <= relax->enough;
}

static starg_status find_sides(cover_run *run, relaxing *relax) {
    const cover_instance *instance = relax->instance;
    for (size_t step = 0; step < STEPS && !is_enough(relax); step++) {
        starg_status status = starg_check_cancel(run->context, "bound");
        if (status != STARG_OK || cover_time_is_over(run))
            return status;
        set_trial(relax);
        cover_weight_bound_take(instance, relax->bound);
        step_towards_best(relax, 2 / (double)(step + 2));
    }
    return STARG_OK;
}

/* Replaces each column by its side. */
static void choose_sides(relaxing *relax) {
    const cover_instance *instance = relax->instance;
    for (size_t j = 0; j < instance->columns; j++) {
        if (relax->held[j] >= instance->demands[j]) {
            starg_bit_set(relax->kept, j);
            continue;
        }
        double share = (double)instance->weights[j] / relax->unit / instance->demands[j];
        for (size_t w = 0; w < instance->column_words; w++) {
            STARG_FOR_BITS (bit, cover_column(instance, j)[w])
                relax->cost[64 * w + bit] -= share;
        }
    }
}

static starg_status relaxing_make(const cover_instance *instance, cover_weight_bound *bound,
                                  relaxing *relax) {
    starg_context *context = instance->context;
    *relax = (relaxing){.instance = instance, .bound = bound, .limit = bound->rows};
    relax->unit = (double)instance->total / (double)instance->columns;
    relax->room = instance->rows > BATCH_ENTRIES ? instance->rows : BATCH_ENTRIES;
    NEW_ZERO(context, "bound", relax->inside, instance->row_words);
    NEW_ZERO(context, "bound", relax->kept, instance->row_words);
    NEW(context, "bound", relax->columns, instance->columns);
    NEW_ZERO(context, "bound", relax->cost, instance->rows);
    NEW_ZERO(context, "bound", relax->held, instance->columns);
    NEW(context, "bound", relax->found, instance->columns);
    NEW(context, "bound", relax->index, relax->room);
    NEW(context, "bound", relax->ones, relax->room);
    for (size_t e = 0; e < relax->room; e++)
        relax->ones[e] = 1;
    return STARG_OK;
}

/* The model with all rows and the limit but no column; false if it cannot be created. */
static bool start_model(relaxing *relax) {
    size_t rows = relax->instance->rows;
    CoinBigIndex starts[2] = {0, (CoinBigIndex)rows};
    double limit = (double)relax->limit;
    if (rows >= MOST_ENTRIES || (relax->model = Clp_newModel()) == NULL)
        return false;
    choose_sides(relax);
    Clp_setLogLevel(relax->model, 0);
    Clp_resize(relax->model, 0, (int)rows);
    Clp_chgColumnUpper(relax->model, relax->ones); /* allocates room for all rows */
    Clp_chgObjCoefficients(relax->model, relax->cost);
    for (size_t i = 0; i < rows; i++)
        relax->index[i] = (int)i;
    Clp_addRows(relax->model, 1, NULL, &limit, starts, relax->index, relax->ones);
    relax->entries = rows;
    return true;
}

/* Appends a column's rows to the batch; false if there is no room. */
static bool list_rows(relaxing *relax, size_t column, size_t added) {
    const cover_instance *instance = relax->instance;
    const uint64_t *bits = cover_column(instance, column);
    size_t filled = (size_t)relax->starts[added];
    size_t count = starg_bit_count(bits, instance->column_words);
    if (filled + count > relax->room || relax->entries + count > MOST_ENTRIES)
        return false;
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, bits[w])
            relax->index[filled++] = (int)(64 * w + bit);
    }
    relax->starts[added + 1] = (CoinBigIndex)filled;
    relax->entries += count;
    return true;
}

/* Adds the variables s or e of the last `added` columns. */
static void add_slacks(relaxing *relax, size_t added) {
    double cost[MOST_ADDED], elements[MOST_ADDED];
    int rows[MOST_ADDED];
    size_t first = relax->count - added;
    for (size_t a = 0; a < added; a++) {
        size_t j = relax->columns[first + a];
        double demand = relax->instance->demands[j];
        relax->starts[a] = (CoinBigIndex)a;
        rows[a] = (int)(1 + first + a);
        elements[a] = starg_bit_test(relax->kept, j) ? demand : -demand;
        cost[a] = (double)relax->instance->weights[j] / relax->unit;
    }
    relax->starts[added] = (CoinBigIndex)added;
    Clp_addColumns(relax->model, (int)added, NULL, NULL, cost, relax->starts, rows, elements);
}

static int compare_overstated(const void *a, const void *b) {
    const overstated *x = a, *y = b;
    if (x->excess != y->excess)
        return x->excess > y->excess ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* Finds the overestimated columns; returns the sum in units. */
static double find_overstated(relaxing *relax, size_t *count) {
    const cover_instance *instance = relax->instance;
    double sum = 0;
    *count = 0;
    for (size_t j = 0; j < instance->columns; j++) {
        double beyond = relax->held[j] / instance->demands[j] - 1;
        double excess = starg_bit_test(relax->kept, j) ? -beyond : beyond;
        if (starg_bit_test(relax->inside, j) || excess <= TOLERANCE)
            continue;
        excess *= (double)instance->weights[j] / relax->unit;
        relax->found[(*count)++] = (overstated){excess, (uint32_t)j};
        sum += excess;
    }
    qsort(relax->found, *count, sizeof *relax->found, compare_overstated);
    return sum;
}

/* Adds the most overestimated columns; false if none matters. */
static bool add_overstated(relaxing *relax) {
    double lower[MOST_ADDED], upper[MOST_ADDED];
    size_t count, added = 0;
    if (find_overstated(relax, &count) <= relax->tolerance * (double)relax->instance->columns)
        return false;
    relax->starts[0] = 0;
    for (size_t c = 0; c < count && added < MOST_ADDED; c++) {
        uint32_t j = relax->found[c].column;
        double demand = relax->instance->demands[j];
        if (!list_rows(relax, j, added))
            break;
        lower[added] = starg_bit_test(relax->kept, j) ? demand : -DBL_MAX;
        upper[added++] = starg_bit_test(relax->kept, j) ? DBL_MAX : demand;
        starg_bit_set(relax->inside, j);
        relax->columns[relax->count++] = j;
    }
    Clp_addRows(relax->model, (int)added, lower, upper, relax->starts, relax->index, relax->ones);
    add_slacks(relax, added);
    return added > 0;
}

/* Reads h, and the multipliers as the bound's trial ones. */
static void read_solution(relaxing *relax) {
    const cover_instance *instance = relax->instance;
    cover_weight_bound *bound = relax->bound;
    const double *solution = Clp_primalColumnSolution(relax->model);
    const double *duals = Clp_dualRowSolution(relax->model);
    double scale = relax->unit * (double)((uint64_t)1 << bound->shift);
    for (size_t j = 0; j < instance->columns; j++) {
        bound->trial[j] =
            starg_bit_test(relax->kept, j) ? 0 : cover_largest_multiplier(instance, bound, j);
        relax->held[j] = 0;
    }
    for (size_t c = 0; c < relax->count; c++) {
        size_t j = relax->columns[c];
        double change = duals[1 + c] * scale;
        bound->trial[j] =
            cover_near_multiplier(instance, bound, j, (double)bound->trial[j] + change);
    }
    for (size_t i = 0; i < instance->rows; i++) {
        if (!(solution[i] > 0))
            continue;
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, cover_row(instance, i)[w])
                relax->held[64 * w + bit] += solution[i];
        }
    }
}

/* The weight covered by x, in units. */
static double seen_weight(const relaxing *relax) {
    const cover_instance *instance = relax->instance;
    double seen = 0;
    for (size_t j = 0; j < instance->columns; j++) {
        double part = relax->held[j] / instance->demands[j];
        seen += (part < 1 ? part : 1) * (double)instance->weights[j] / relax->unit;
    }
    return seen;
}

/* Raises K to the bound for the goal; false if the relaxation with K rows reaches it. */
static bool follow_least(relaxing *relax) {
    const cover_weight_bound *bound = relax->bound;
    if (bound->least == relax->limit)
        return seen_weight(relax) < (double)bound->goal / relax->unit;
    relax->limit = bound->least;
    Clp_rowUpper(relax->model)[0] = (double)relax->limit;
    return true;
}

static starg_status run_rounds(cover_run *run, relaxing *relax) {
    for (size_t round = 1; round <= MOST_ROUNDS; round++) {
        starg_status status = starg_check_cancel(run->context, "bound");
        if (status != STARG_OK || cover_time_is_over(run) ||
            !cover_run_simplex(run, relax->model, round == 1))
            return status;
        starg_progress_step(run->context, round, MOST_ROUNDS);
        read_solution(relax);
        cover_weight_bound_take(relax->instance, relax->bound);
        size_t limit = relax->limit;
        if (is_enough(relax) || (relax->by_goal && !follow_least(relax)))
            break;
        if (!add_overstated(relax) && relax->limit == limit)
            break;
    }
    return STARG_OK;
}

typedef struct clp_call {
    cover_run *run;
    relaxing *relax;
    starg_status status;
} clp_call;

/* An exception may leave this at any call of Clp: bounds of earlier rounds remain valid. */
static void run_clp(void *argument) {
    clp_call *call = argument;
    if (start_model(call->relax))
        call->status = run_rounds(call->run, call->relax);
}

/* After an exception the model is not used again. */
static starg_status run_clp_safely(cover_run *run, relaxing *relax) {
    clp_call call = {run, relax, STARG_OK};
    if (!cover_call_safely(run_clp, &call)) {
        relax->model = NULL;
        cover_solver_give_up();
    }
    return call.status;
}

starg_status cover_weight_bound_relax(cover_run *run, const cover_instance *instance, bool by_goal,
                                      uint64_t enough, cover_weight_bound *bound) {
    IN_STAGE(run->context, "bound");
    SCOPED_BY(cover_solver_unlock) bool held = false;
    SCOPED_BY(relaxing_free) relaxing relax = {0};
    TRY(relaxing_make(instance, bound, &relax));
    relax.by_goal = by_goal;
    relax.enough = enough;
    relax.tolerance = run->relaxed && !by_goal ? ROUGH_TOLERANCE : TOLERANCE;
    TRY(find_sides(run, &relax));
    if (is_enough(&relax))
        return STARG_OK;
    TRY(cover_solver_lock(run, &held));
    return held && instance->columns != 0 ? run_clp_safely(run, &relax) : STARG_OK;
}
