/* SPDX-License-Identifier: Apache-2.0 */
/* Branch and bound by CBC on a subset of the columns, which grows until its best cover covers
 * everything:
 *   1. start with the columns that are tight in the linear relaxation;
 *   2. CBC solves the subset, starting from a known cover;
 *   3. if its answer leaves columns uncovered, add them and repeat 2.
 * A full cover covers the subset, so bounds for the subset hold for everything. Every round adds a
 * column, so the loop ends, usually after a few rounds.
 *
 * Properties of CBC's C interface:
 *   - Two simultaneous solves in one process fail silently: a lock (solver.h).
 *   - A solve cannot be stopped from outside. A cut callback runs at every node: to stop, it adds
 *     the cut x0 >= 2, which makes every open node infeasible. CBC then ends at once; its claims
 *     are worthless then, but its covers are still examined.
 *   - A known cover must be given as a start. With a mere cutoff CBC believes that it has no
 *     solution and searches for one throughout, in trees ten times as large.
 *   - Off: its heuristics, which find nothing beyond our local search; its preprocessing, which can
 *     crash on infeasible models and gains nothing after our reductions; all printing. Limits are
 *     by elapsed time.
 *   - It cannot continue without memory: it lives on a reserve until the next node, where it is
 *     stopped (exceptions.h). After an exception its model is lost, and it is not called again.
 *
 * Correctness: coefficients and costs are 1, demands at most 1,000, so the model is exact in
 * doubles. Covers from CBC are checked on the bits. Gaps are first closed by our exact dual bound
 * (dual.c); otherwise CBC's statement that no better cover exists is accepted. If CBC did not
 * finish, its bound is rounded up only where it exceeds an integer by more than BOUND_MARGIN, far
 * above its tolerance of 1e-6. */
#include "cover/cover.h"

#include <limits.h>
#include <math.h>

#include <Cbc_C_Interface.h>

#include "cover/exceptions.h"
#include "cover/solver.h"

static const double BOUND_MARGIN = 1e-3;

/* The first subset: columns whose surplus in the relaxation is at most this, so the tight ones. A
 * larger subset saves rounds, but nodes take longer and cuts are harder to find. */
static const double FIRST_SURPLUS = 0.01;

/* The model min sum x, sum over R(j) of x >= demand(j), 0 <= x <= 1, by variables. */
typedef struct model_data {
    CoinBigIndex *start;
    int *index;
    double *ones, *lower, *upper, *demand;
    int *start_index; /* room for a first solution */
    double *start_value;
    int variables, constraints;
} model_data;

static void model_data_free(model_data *data) {
    RELEASE(data->start, data->index, data->ones, data->lower, data->upper, data->demand,
            data->start_index, data->start_value);
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

/* *fits is false if the model has more entries than the library's index type can count. */
static starg_status make_model(const cover_instance *instance, model_data *data, bool *fits) {
    starg_context *context = instance->context;
    size_t entries = starg_bit_count(instance->row_bits, instance->rows * instance->row_words);
    *data = (model_data){0};
    *fits = entries < INT_MAX && instance->rows < INT_MAX && instance->columns < INT_MAX;
    if (!*fits)
        return STARG_OK;
    size_t most = entries > instance->rows ? entries : instance->rows;
    NEW(context, "ilp", data->start, instance->rows + 1);
    NEW(context, "ilp", data->index, entries);
    NEW(context, "ilp", data->ones, most);
    NEW(context, "ilp", data->lower, instance->rows);
    NEW(context, "ilp", data->upper, instance->rows);
    NEW(context, "ilp", data->demand, instance->columns);
    NEW(context, "ilp", data->start_index, instance->rows);
    NEW(context, "ilp", data->start_value, instance->rows);
    data->variables = (int)instance->rows;
    data->constraints = (int)instance->columns;
    for (size_t e = 0; e < most; e++)
        data->ones[e] = 1;
    fill_model(instance, data);
    return STARG_OK;
}

/* Argument of the cut callback. */
typedef struct stop_request {
    cover_run *run;
    size_t nodes; /* nodes of earlier searches plus calls since: about as many */
    bool stopped;
} stop_request;

static void stop_if_asked(void *solver, void *cuts, void *user) {
    stop_request *request = user;
    (void)solver;
    starg_progress_step(request->run->context, ++request->nodes, request->run->max_nodes);
    if (starg_check_cancel(request->run->context, "ilp") != STARG_OK ||
        cover_time_is_over(request->run) || cover_memory_is_low())
        request->stopped = true;
    if (request->stopped) {
        int variable = 0;
        double one = 1;
        OsiCuts_addRowCut(cuts, 1, &variable, &one, 'G', 2);
    }
}

/* A search on a growing subset of the columns. */
typedef struct part_search {
    cover_run *run;
    const cover_instance *instance;
    uint64_t *columns; /* mask of the subset */
    cover_state *best; /* the best full cover */
    cover_state trial; /* CBC's last choice, as a choice for everything */
    size_t bound;      /* no cover has fewer rows */
    size_t nodes;      /* used so far */
    bool answered;     /* the trial is an optimal cover of the subset */
} part_search;

static void set_limits(const part_search *search, Cbc_Model *model) {
    size_t nodes = search->run->max_nodes - search->nodes;
    Cbc_setLogLevel(model, 0);
    Cbc_setParameter(model, "log", "0");
    Cbc_setParameter(model, "timeMode", "elapsed");
    Cbc_setParameter(model, "preprocess", "off");
    Cbc_setParameter(model, "heuristicsOnOff", "off");
    Cbc_setMaximumNodes(model, nodes < INT_MAX ? (int)nodes : INT_MAX);
    if (starg_seconds_left(search->run->context) < INFINITY)
        Cbc_setMaximumSeconds(model, cover_seconds_left(search->run));
}

/* The best cover as CBC's first solution; `index` and `value` have room for all rows. */
static void set_start(const cover_state *best, Cbc_Model *model, int *index, double *value) {
    for (size_t c = 0; c < best->count; c++) {
        index[c] = (int)best->rows[c];
        value[c] = 1;
    }
    Cbc_setMIPStartI(model, (int)best->count, index, value);
}

/* Chooses the rows with x near 1. */
static void read_solution(const double *solution, cover_state *trial) {
    cover_state_clear(trial);
    for (size_t i = 0; i < trial->instance->rows; i++) {
        if (solution[i] > 0.5)
            cover_state_add(trial, i);
    }
}

static bool covers_part(const part_search *search) {
    for (size_t w = 0; w < search->instance->row_words; w++) {
        if (search->trial.open[w] & search->columns[w])
            return false;
    }
    return true;
}

/* The bound that CBC has proven for covers of the subset; `count` is the size of the cover
 * found. */
static size_t proven_bound(const part_search *search, Cbc_Model *model, size_t count) {
    if (search->answered)
        return count;
    double best = Cbc_getBestPossibleObjValue(model);
    if (Cbc_status(model) != 1 || !(best > 0))
        return 0;
    /* it has not finished: a bound that would close the gap is not trusted */
    return best < (double)count - 0.5 ? (size_t)ceil(best - BOUND_MARGIN) : 0;
}

/* Accepts CBC's choice, if it covers the subset, and its bound. */
static void take_answer(part_search *search, Cbc_Model *model, bool stopped) {
    cover_run *run = search->run;
    const double *solution = Cbc_bestSolution(model);
    int nodes = Cbc_getNodeCount(model);
    search->nodes += nodes > 0 ? (size_t)nodes : 0;
    run->nodes += nodes > 0 ? (size_t)nodes : 0;
    if (Cbc_isSecondsLimitReached(model))
        run->time_limited = true;
    if (solution == NULL)
        return;
    read_solution(solution, &search->trial);
    if (!covers_part(search))
        return;
    if (search->trial.weight == search->instance->total &&
        search->trial.count < search->best->count)
        cover_state_copy(search->best, &search->trial);
    if (stopped)
        return;
    search->answered = Cbc_status(model) == 0 && Cbc_isProvenOptimal(model);
    size_t bound = proven_bound(search, model, search->trial.count);
    if (bound > search->bound)
        search->bound = bound;
}

typedef struct cbc_call {
    part_search *search;
    model_data *data;
} cbc_call;

/* An exception may leave this at any call of CBC: results count only at the end. */
static void run_cbc(void *argument) {
    part_search *search = ((cbc_call *)argument)->search;
    const model_data *data = ((cbc_call *)argument)->data;
    stop_request request = {.run = search->run, .nodes = search->nodes};
    Cbc_Model *model = Cbc_newModel();
    if (model == NULL)
        return;
    Cbc_loadProblem(model, data->variables, data->constraints, data->start, data->index, data->ones,
                    data->lower, data->upper, data->ones, data->demand, NULL);
    for (int i = 0; i < data->variables; i++)
        Cbc_setInteger(model, i);
    set_limits(search, model);
    set_start(search->best, model, data->start_index, data->start_value);
    Cbc_addCutCallback(model, stop_if_asked, "stop", &request);
    Cbc_solve(model);
    take_answer(search, model, request.stopped);
    Cbc_deleteModel(model);
}

static starg_status solve_part(part_search *search) {
    cover_run *run = search->run;
    SCOPED_BY(cover_instance_free) cover_instance part = {.context = run->context};
    SCOPED_BY(model_data_free) model_data data = {0};
    SCOPED_BY(cover_solver_unlock) bool held = false;
    bool fits;
    search->answered = false;
    TRY(cover_instance_select(search->instance, NULL, search->columns, &part));
    TRY(make_model(&part, &data, &fits));
    if (!fits)
        return STARG_OK;
    TRY(cover_solver_lock(run, &held));
    if (held && !cover_call_safely(run_cbc, &(cbc_call){search, &data}))
        cover_solver_give_up();
    return starg_check_cancel(run->context, "ilp");
}

/* Adds the columns that the trial leaves open; false if there are none. */
static bool grow_part(part_search *search) {
    bool any = false;
    for (size_t w = 0; w < search->instance->row_words; w++) {
        any = any || search->trial.open[w] != 0;
        search->columns[w] |= search->trial.open[w];
    }
    return any;
}

static starg_status choose_first_part(part_search *search) {
    const cover_instance *instance = search->instance;
    SCOPED_BY(cover_relaxation_free) cover_relaxation relaxation = {0};
    bool found;
    TRY(cover_relax(search->run, instance, &relaxation, &found));
    for (size_t j = 0; j < instance->columns; j++) {
        if (!found || relaxation.surplus[j] <= FIRST_SURPLUS)
            starg_bit_set(search->columns, j);
    }
    return STARG_OK;
}

starg_status cover_ilp_solve(cover_run *run, const cover_instance *instance, cover_state *best,
                             size_t *bound) {
    starg_status status = STARG_OK;
    part_search search = {.run = run, .instance = instance, .best = best};
    *bound = 0;
    if (run->max_nodes == 0)
        return STARG_OK;
    STARG_TRY(cover_state_create(instance, &search.trial));
    STARG_NEW_ZERO(run->context, "ilp", search.columns, instance->row_words);
    STARG_TRY(choose_first_part(&search));
    while (search.nodes < run->max_nodes && search.bound < best->count &&
           !cover_time_is_over(run)) {
        STARG_TRY(solve_part(&search));
        if (!search.answered || !grow_part(&search))
            break;
    }
    *bound = search.bound < best->count ? search.bound : best->count;
done:
    starg_release(run->context, search.columns);
    cover_state_free(&search.trial);
    return status;
}
