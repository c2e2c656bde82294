/* SPDX-License-Identifier: Apache-2.0 */
/* Smallest eigenvalues of a Laplacian by shift-and-invert.
 *
 * Implicitly restarted Lanczos iterations (shape/lanczos.h) on M^1/2 (L + M)^-1 M^1/2, whose
 * largest eigenvalues 1 / (lambda + 1) belong to the smallest lambda. L + M is factorized once
 * (shape/spectrum.h); each step costs one solve. The start vector is fixed, so that the result
 * depends only on the matrix.
 *
 * Cost: some 2 to 3 steps per eigenvalue. Each step is made orthogonal to all vectors kept: with
 * more of them it restarts less often but takes longer; slightly more than twice as many as
 * eigenvalues suffice without a restart, and cost least. */
#include "shape/spectrum.h"

#include "core/rng.h"
#include "shape/lanczos.h"

static const char STAGE[] = "spectrum";

enum { RESTARTS = 300, SPARE_VECTORS = 20 };
static const double SHIFT = 1, TOLERANCE = 1e-7;

typedef struct iteration {
    starg_context *context;
    const laplacian *l;
    sparse_factors *factors;
    double *roots; /* of the masses */
    double *solution, *start;
    size_t steps, expected; /* the latter a rough estimate, for progress only */
    starg_status status;
} iteration;

/* y = M^1/2 (L + SHIFT M)^-1 M^1/2 x */
static bool apply(void *shared, const double *x, double *y) {
    iteration *it = shared;
    for (size_t i = 0; i < it->l->count; i++)
        y[i] = it->roots[i] * x[i];
    sparse_solve(it->factors, y, it->solution);
    for (size_t i = 0; i < it->l->count; i++)
        y[i] *= it->roots[i];
    starg_progress_step(it->context, it->steps++, it->expected);
    it->status = starg_check_cancel(it->context, STAGE);
    return it->status == STARG_OK;
}

/* The largest eigenvalues of the operator, descending, and if wanted their vectors. */
static starg_status iterate(iteration *it, size_t wanted, double *largest, double *vectors) {
    size_t n = it->l->count, kept = 2 * wanted + SPARE_VECTORS;
    const lanczos_problem problem = {.count = n,
                                     .wanted = wanted,
                                     .kept = kept < n ? kept : n,
                                     .restarts = RESTARTS,
                                     .tolerance = TOLERANCE,
                                     .start = it->start,
                                     .apply = apply,
                                     .shared = it};
    it->expected = 3 * wanted;
    starg_progress_begin(it->context, STAGE);
    lanczos_end end = lanczos_largest(&problem, largest, vectors);
    starg_progress_end(it->context);
    if (end == LANCZOS_STOPPED)
        return it->status;
    if (end == LANCZOS_MEMORY)
        return starg_fail_memory(it->context, STAGE);
    if (end == LANCZOS_OPEN)
        return starg_fail(it->context, STARG_ERROR_SOLVER, STAGE,
                          "the eigenvalues did not converge");
    return STARG_OK;
}

/* Converts the operator's eigenvalues and vectors to those of the Laplacian. */
static starg_status convert(const iteration *it, size_t wanted, double *eigenvalues,
                            double *functions) {
    size_t n = it->l->count;
    for (size_t i = 0; i < wanted; i++) {
        eigenvalues[i] = 1 / eigenvalues[i] - SHIFT;
        if (!(isfinite(eigenvalues[i]) && eigenvalues[i] > -0.5 * SHIFT))
            return starg_fail(
                it->context, STARG_ERROR_SOLVER, STAGE,
                "the spectrum cannot be computed: some faces are too thin; try 'starguard repair'");
        for (size_t k = 0; k < n && functions != NULL; k++)
            functions[i * n + k] /= it->roots[k];
    }
    return STARG_OK;
}

starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues, double *functions) {
    starg_status status = STARG_OK;
    size_t n = l->count;
    iteration it = {.context = context, .l = l};
    starg_rng rng = starg_rng_make(1, 0, 0);
    if (wanted >= n)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "a mesh of %zu vertices has too few for its spectrum", n);
    STARG_TRY(laplacian_factorise(context, l, SHIFT, &it.factors));
    STARG_NEW(context, STAGE, it.roots, n);
    STARG_NEW(context, STAGE, it.solution, n);
    STARG_NEW(context, STAGE, it.start, n);
    for (size_t i = 0; i < n; i++) {
        it.roots[i] = sqrt(l->masses[i]);
        it.start[i] = starg_rng_unit(&rng) - 0.5;
    }
    STARG_TRY(iterate(&it, wanted, eigenvalues, functions));
    STARG_TRY(convert(&it, wanted, eigenvalues, functions));
done:
    RELEASE(it.roots, it.solution, it.start);
    sparse_free(it.factors);
    return status;
}
