/* CBC and Clp by their C interfaces. What one has to know of them:
 *   - Two solves at once in one process fail silently: a process-wide lock, waited for in slices so
 *     that cancellation and the time limit hold meanwhile.
 *   - The C interface has no way to stop a solve. A cut callback runs at every node: when we want
 *     to stop it adds the cut x0 >= 2, which makes every open node infeasible. CBC then ends at
 *     once, with claims that are worth nothing; its covers are still looked at.
 *   - Its preprocessing can crash on a model whose cutoff leaves no solution, and gains nothing
 *     after our reductions: off. Limits are by elapsed time. All printing is off.
 *
 * Trust: coefficients and costs are 1, demands at most 1,000, so the model is exact in doubles. A
 * cover from CBC is checked on the bits. Gaps are closed by our exact dual bound first (dual.h);
 * where that is not enough, CBC's word "no better cover exists" is accepted. A bound that it gives
 * without having finished is rounded up only where it exceeds a whole number by more than
 * BOUND_MARGIN, far above its tolerance of 1e-6. */
#include "cover/ilp.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <threads.h>
#include <time.h>

#include <Cbc_C_Interface.h>
#include <Clp_C_Interface.h>

static const double BOUND_MARGIN = 1e-3;

static mtx_t solver_lock;
static bool solver_lock_exists;
static once_flag solver_lock_once = ONCE_FLAG_INIT;

static void make_solver_lock(void) {
    solver_lock_exists = mtx_init(&solver_lock, mtx_timed) == thrd_success;
}

/* *held is false when the time limit struck first, or the system has no lock to give. */
static starg_status lock_solver(cover_run *run, bool *held) {
    *held = false;
    call_once(&solver_lock_once, make_solver_lock);
    while (solver_lock_exists && !*held && !cover_time_is_over(run)) {
        starg_status status = starg_check_cancel(run->context, "ilp");
        if (status != STARG_OK)
            return status;
        struct timespec until;
        timespec_get(&until, TIME_UTC);
        until.tv_nsec += 50000000;
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            until.tv_sec++;
        }
        *held = mtx_timedlock(&solver_lock, &until) == thrd_success;
    }
    return STARG_OK;
}

/* The model min sum x, sum over R(j) of x >= demand(j), 0 <= x <= 1, by variables. */
typedef struct model_data {
    CoinBigIndex *start;
    int *index;
    double *ones, *lower, *upper, *demand;
    int variables, constraints;
} model_data;

static void model_data_free(starg_context *context, model_data *data) {
    starg_release(context, data->start);
    starg_release(context, data->index);
    starg_release(context, data->ones);
    starg_release(context, data->lower);
    starg_release(context, data->upper);
    starg_release(context, data->demand);
}

static void fill_model(const cover_instance *instance, model_data *data) {
    CoinBigIndex filled = 0;
    for (size_t i = 0; i < instance->rows; i++) {
        data->start[i] = filled;
        data->lower[i] = 0;
        data->upper[i] = 1;
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, cover_row(instance, i)[w])
                data->index[filled++] = (int)(64 * w + bit);
        }
    }
    data->start[instance->rows] = filled;
    for (size_t j = 0; j < instance->columns; j++)
        data->demand[j] = instance->demands[j];
}

/* *fits is false when the model has more entries than the library's index type can count. */
static starg_status make_model(const cover_instance *instance, model_data *data, bool *fits) {
    starg_status status = STARG_OK;
    starg_context *context = instance->context;
    size_t entries = starg_bit_count(instance->row_bits, instance->rows * instance->row_words);
    *data = (model_data){0};
    *fits = entries < INT_MAX && instance->rows < INT_MAX && instance->columns < INT_MAX;
    if (!*fits)
        goto done;
    size_t most = entries > instance->rows ? entries : instance->rows;
    STARG_NEW(context, "ilp", data->start, instance->rows + 1);
    STARG_NEW(context, "ilp", data->index, entries);
    STARG_NEW(context, "ilp", data->ones, most);
    STARG_NEW(context, "ilp", data->lower, instance->rows);
    STARG_NEW(context, "ilp", data->upper, instance->rows);
    STARG_NEW(context, "ilp", data->demand, instance->columns);
    data->variables = (int)instance->rows;
    data->constraints = (int)instance->columns;
    for (size_t e = 0; e < most; e++)
        data->ones[e] = 1;
    fill_model(instance, data);
done:
    return status;
}

static double seconds_left(const starg_context *context) {
    double left = context->deadline - starg_clock();
    return left > 0.001 ? left : 0.001;
}

/* Runs Clp on the model; the duals stay owned by the returned model, NULL without a result. */
static Clp_Simplex *run_clp(const cover_run *run, const model_data *data) {
    Clp_Simplex *model = Clp_newModel();
    if (model == NULL)
        return NULL;
    Clp_setLogLevel(model, 0);
    if (run->context->deadline > 0)
        Clp_setMaximumSeconds(model, seconds_left(run->context));
    Clp_loadProblem(model, data->variables, data->constraints, data->start, data->index, data->ones,
                    data->lower, data->upper, data->ones, data->demand, NULL);
    Clp_initialDualSolve(model);
    if (Clp_status(model) == 0 && Clp_dualRowSolution(model) != NULL)
        return model;
    Clp_deleteModel(model);
    return NULL;
}

static int64_t round_multiplier(double value) {
    if (!(value > 0))
        return 0;
    if (value >= (double)COVER_MOST / (double)COVER_ONE)
        return COVER_MOST;
    return llround(value * (double)COVER_ONE);
}

starg_status cover_lp_multipliers(cover_run *run, const cover_instance *instance,
                                  int64_t *multipliers, bool *found) {
    starg_status status = STARG_OK;
    model_data data;
    bool fits, held = false;
    *found = false;
    STARG_TRY(make_model(instance, &data, &fits));
    if (!fits)
        goto done;
    STARG_TRY(lock_solver(run, &held));
    if (!held)
        goto done;
    Clp_Simplex *model = run_clp(run, &data);
    if (model != NULL) {
        const double *duals = Clp_dualRowSolution(model);
        for (size_t j = 0; j < instance->columns; j++)
            multipliers[j] = round_multiplier(duals[j]);
        *found = true;
        Clp_deleteModel(model);
    }
done:
    if (held)
        mtx_unlock(&solver_lock);
    model_data_free(run->context, &data);
    return status;
}

/* What the cut callback sees. */
typedef struct stop_request {
    cover_run *run;
    size_t calls;
    bool stopped;
} stop_request;

static void stop_if_asked(void *solver, void *cuts, void *user) {
    stop_request *request = user;
    (void)solver;
    /* How much is left is not known; being asked is what counts, it can cancel. */
    request->calls++;
    starg_progress_step(request->run->context, request->calls, 2 * request->calls);
    if (starg_check_cancel(request->run->context, "ilp") != STARG_OK ||
        cover_time_is_over(request->run))
        request->stopped = true;
    if (request->stopped) {
        int variable = 0;
        double one = 1;
        OsiCuts_addRowCut(cuts, 1, &variable, &one, 'G', 2);
    }
}

static void set_limits(const cover_run *run, Cbc_Model *model, size_t most) {
    Cbc_setLogLevel(model, 0);
    Cbc_setParameter(model, "log", "0");
    Cbc_setParameter(model, "timeMode", "elapsed");
    Cbc_setParameter(model, "preprocess", "off");
    Cbc_setCutoff(model, (double)most + 0.5);
    Cbc_setMaximumNodes(model, run->max_nodes < INT_MAX ? (int)run->max_nodes : INT_MAX);
    if (run->context->deadline > 0)
        Cbc_setMaximumSeconds(model, seconds_left(run->context));
}

/* Builds the rows with x near 1 into `trial`; true if they cover everything in at most `most`. */
static bool check_solution(const cover_instance *instance, const double *solution, size_t most,
                           cover_state *trial) {
    size_t count = 0;
    if (solution == NULL)
        return false;
    for (size_t i = 0; i < instance->rows; i++)
        count += solution[i] > 0.5;
    if (count > most)
        return false;
    cover_state_clear(trial);
    for (size_t i = 0; i < instance->rows; i++) {
        if (solution[i] > 0.5)
            cover_state_add(trial, i);
    }
    return trial->weight == instance->total;
}

/* What CBC has proven about the covers of at most `most` rows. */
static size_t proven_bound(const cover_run *run, Cbc_Model *model, size_t most, bool found,
                           size_t count) {
    if (Cbc_status(model) == 0 && found && Cbc_isProvenOptimal(model))
        return count;
    if (Cbc_status(model) == 0 && !found && Cbc_isProvenInfeasible(model))
        return most + 1;
    double best = Cbc_getBestPossibleObjValue(model);
    if (Cbc_status(model) != 1 || run->max_nodes == 0 || !(best > 0))
        return 0;
    /* It has not finished: a bound that claims the end is not believed. */
    size_t limit = found ? count : most + 1;
    return best < (double)limit - 0.5 ? (size_t)ceil(best - BOUND_MARGIN) : 0;
}

static void run_cbc(cover_run *run, const cover_instance *instance, const model_data *data,
                    size_t most, cover_state *trial, bool *found, size_t *bound) {
    Cbc_Model *model = Cbc_newModel();
    stop_request request = {.run = run};
    if (model == NULL)
        return;
    Cbc_loadProblem(model, data->variables, data->constraints, data->start, data->index, data->ones,
                    data->lower, data->upper, data->ones, data->demand, NULL);
    for (int i = 0; i < data->variables; i++)
        Cbc_setInteger(model, i);
    set_limits(run, model, most);
    Cbc_addCutCallback(model, stop_if_asked, "stop", &request);
    Cbc_solve(model);
    *found = check_solution(instance, Cbc_bestSolution(model), most, trial);
    if (!request.stopped)
        *bound = proven_bound(run, model, most, *found, trial->count);
    if (Cbc_isSecondsLimitReached(model))
        run->time_limited = true;
    int nodes = Cbc_getNodeCount(model);
    run->nodes += nodes > 0 ? (size_t)nodes : 0;
    Cbc_deleteModel(model);
}

starg_status cover_ilp_solve(cover_run *run, const cover_instance *instance, size_t most,
                             cover_state *best, bool *found, size_t *bound) {
    starg_status status = STARG_OK;
    model_data data;
    cover_state trial = {0};
    bool fits, held = false;
    *found = false;
    *bound = 0;
    STARG_TRY(make_model(instance, &data, &fits));
    STARG_TRY(cover_state_create(instance, &trial));
    if (!fits || run->max_nodes == 0)
        goto done;
    STARG_TRY(lock_solver(run, &held));
    if (!held)
        goto done;
    run_cbc(run, instance, &data, most, &trial, found, bound);
    STARG_TRY(starg_check_cancel(run->context, "ilp"));
    if (*found)
        cover_state_copy(best, &trial);
done:
    if (held)
        mtx_unlock(&solver_lock);
    cover_state_free(&trial);
    model_data_free(run->context, &data);
    return status;
}
