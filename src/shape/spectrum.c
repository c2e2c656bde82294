/* SPDX-License-Identifier: Apache-2.0 */
/* Smallest eigenvalues of a Laplacian by shift-and-invert.
 *
 * Implicitly restarted Lanczos iterations (ARPACK) on M^1/2 (L + M)^-1 M^1/2, whose largest
 * eigenvalues 1 / (lambda + 1) belong to the smallest lambda. L + M is factorized once
 * (shape/sparse.h); each step costs one solve.
 *
 * ARPACK keeps its state in static variables: a lock admits one run at a time. The start vector is
 * fixed, so that the result depends only on the matrix.
 *
 * Cost: some 2 to 4 steps per eigenvalue. Each step is made orthogonal to all vectors kept: with
 * more of them it restarts less often but takes longer; half as many again as eigenvalues cost
 * least. */
#include "shape/spectrum.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <threads.h>

#include <arpack/arpack.h>

#include "core/memory.h"
#include "core/rng.h"

static const char STAGE[] = "spectrum";

enum { ITERATIONS = 300, SPARE_VECTORS = 20 };
static const double SHIFT = 1, TOLERANCE = 1e-7;

static once_flag lock_once = ONCE_FLAG_INIT;
static mtx_t arpack_lock;
static bool lock_made;

static void make_lock(void) {
    lock_made = mtx_init(&arpack_lock, mtx_plain) == thrd_success;
}

typedef struct iteration {
    const laplacian *l;
    const sparse_factors *f;
    double *roots; /* of the masses */
    double *solution, *residual, *vectors, *work, *small;
    a_int *chosen;
    bool functions; /* compute eigenvectors? */
} iteration;

/* y = M^1/2 (L + SHIFT M)^-1 M^1/2 x */
static void apply(const iteration *it, const double *x, double *y) {
    for (size_t i = 0; i < it->l->count; i++)
        y[i] = it->roots[i] * x[i];
    sparse_solve(it->f, y, it->solution);
    for (size_t i = 0; i < it->l->count; i++)
        y[i] *= it->roots[i];
}

static void start_vector(const iteration *it) {
    starg_rng rng = starg_rng_make(1, 0, 0);
    for (size_t i = 0; i < it->l->count; i++)
        it->residual[i] = starg_rng_unit(&rng) - 0.5;
}

/* The largest eigenvalues of the operator, in any order, and if wanted their vectors, in the first
 * columns of `vectors`. Requires the lock. */
static starg_status iterate(starg_context *context, const iteration *it, a_int wanted,
                            a_int vectors, double *largest) {
    starg_status status = STARG_OK;
    a_int n = (a_int)it->l->count, ido = 0, info = 1, small = vectors * (vectors + 8);
    size_t expected = 8 * (size_t)wanted; /* rough estimate, for progress only */
    a_int parameters[11] = {1, 0, ITERATIONS, 1, 0, 0, 1}, places[14] = {0};
    start_vector(it);
    starg_progress_begin(context, STAGE);
    for (size_t steps = 0; status == STARG_OK; steps++) {
        dsaupd_c(&ido, "I", n, "LM", wanted, TOLERANCE, it->residual, vectors, it->vectors, n,
                 parameters, places, it->work, it->small, small, &info);
        if (ido != 1 && ido != -1)
            break;
        apply(it, it->work + places[0] - 1, it->work + places[1] - 1);
        starg_progress_step(context, steps, expected);
        status = starg_check_cancel(context, STAGE);
    }
    starg_progress_end(context);
    if (status != STARG_OK)
        return status;
    if (info == 0 && parameters[4] >= wanted)
        dseupd_c(it->functions, "A", it->chosen, largest, it->vectors, n, 0, "I", n, "LM", wanted,
                 TOLERANCE, it->residual, vectors, it->vectors, n, parameters, places, it->work,
                 it->small, small, &info);
    if (info != 0)
        return starg_fail(context, STARG_ERROR_SOLVER, STAGE,
                          "the eigenvalues did not converge (ARPACK says %d)", (int)info);
    return STARG_OK;
}

static starg_status locked_iterate(starg_context *context, const iteration *it, a_int wanted,
                                   a_int vectors, double *largest) {
    call_once(&lock_once, make_lock);
    if (!lock_made || mtx_lock(&arpack_lock) != thrd_success)
        return starg_fail_memory(context, STAGE);
    starg_status status = iterate(context, it, wanted, vectors, largest);
    mtx_unlock(&arpack_lock);
    return status;
}

typedef struct mode {
    double eigenvalue;
    size_t column;
} mode;

static int by_eigenvalue(const void *left, const void *right) {
    const mode *a = left, *b = right;
    int order = (a->eigenvalue > b->eigenvalue) - (a->eigenvalue < b->eigenvalue);
    return order != 0 ? order : (a->column > b->column) - (a->column < b->column);
}

/* Converts the operator's solutions, `eigenvalues` and it->vectors, to those of the Laplacian. */
static starg_status sort_modes(starg_context *context, const iteration *it, mode *modes,
                               size_t wanted, double *eigenvalues, double *functions) {
    size_t n = it->l->count;
    for (size_t i = 0; i < wanted; i++) {
        modes[i] = (mode){.eigenvalue = 1 / eigenvalues[i] - SHIFT, .column = i};
        if (!(isfinite(modes[i].eigenvalue) && modes[i].eigenvalue > -0.5 * SHIFT))
            return starg_fail(
                context, STARG_ERROR_SOLVER, STAGE,
                "the spectrum cannot be computed: some faces are too thin; try 'starguard repair'");
    }
    qsort(modes, wanted, sizeof *modes, by_eigenvalue);
    for (size_t i = 0; i < wanted; i++) {
        const double *vector = it->vectors + modes[i].column * n;
        eigenvalues[i] = modes[i].eigenvalue;
        for (size_t k = 0; k < n && functions != NULL; k++)
            functions[i * n + k] = vector[k] / it->roots[k];
    }
    return STARG_OK;
}

starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues, double *functions) {
    starg_status status = STARG_OK;
    size_t n = l->count, vectors = wanted + wanted / 2 + SPARE_VECTORS;
    sparse_factors *factors = NULL;
    mode *modes = NULL;
    iteration it = {.l = l, .functions = functions != NULL};
    if (vectors > n)
        vectors = n;
    if (wanted >= n || n * sizeof(double) > INT_MAX)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "a mesh of %zu vertices has too %s for its spectrum", n,
                          wanted >= n ? "few" : "many");
    STARG_TRY(laplacian_factorise(context, l, SHIFT, &factors));
    it.f = factors;
    STARG_NEW(context, STAGE, it.roots, n);
    STARG_NEW(context, STAGE, it.solution, n);
    STARG_NEW(context, STAGE, it.residual, n);
    STARG_NEW(context, STAGE, it.vectors, n * vectors);
    STARG_NEW(context, STAGE, it.work, 3 * n);
    STARG_NEW_ZERO(context, STAGE, it.chosen, vectors);
    STARG_NEW(context, STAGE, it.small, vectors * (vectors + 8));
    STARG_NEW(context, STAGE, modes, wanted);
    for (size_t i = 0; i < n; i++)
        it.roots[i] = sqrt(l->masses[i]);
    STARG_TRY(locked_iterate(context, &it, (a_int)wanted, (a_int)vectors, eigenvalues));
    STARG_TRY(sort_modes(context, &it, modes, wanted, eigenvalues, functions));
done:
    starg_release(context, modes);
    starg_release(context, it.roots);
    starg_release(context, it.solution);
    starg_release(context, it.residual);
    starg_release(context, it.vectors);
    starg_release(context, it.work);
    starg_release(context, it.small);
    starg_release(context, it.chosen);
    sparse_free(factors);
    return status;
}
