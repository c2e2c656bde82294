/* Sparse LDL' factorisation of a Laplacian plus masses.
 *
 * L + shift M is positive definite, because the masses are positive: a factorisation without
 * pivoting (LDL, in the order of AMD) is stable. AMD takes its memory from malloc; all other memory
 * is the context's.
 *
 * Cost: the fill-in, about 30 n to 60 n numbers for surfaces, for each solution. */
#include "shape/factor.h"

#include <suitesparse/amd.h>
#include <suitesparse/ldl.h>

#include "core/memory.h"

static const char STAGE[] = "spectrum";

void factor_free(starg_context *context, factor *f) {
    void *const blocks[] = {f->order,  f->inverse, f->parents, f->sizes,    f->flags, f->pattern,
                            f->starts, f->rows,    f->values,  f->diagonal, f->row};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(context, blocks[i]);
    *f = (factor){0};
}

static starg_status make_room(starg_context *context, factor *f) {
    starg_status status = STARG_OK;
    size_t n = (size_t)f->count;
    int64_t **const lists[] = {&f->order, &f->inverse, &f->parents,
                               &f->sizes, &f->flags,   &f->pattern};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        STARG_NEW(context, STAGE, *lists[i], n);
    STARG_NEW(context, STAGE, f->starts, n + 1);
    STARG_NEW(context, STAGE, f->diagonal, n);
    STARG_NEW(context, STAGE, f->row, n);
done:
    return status;
}

/* The same entries with the masses on the diagonal, which comes first by column. */
static starg_status shifted(starg_context *context, const laplacian *l, double shift,
                            double **values) {
    starg_status status = STARG_OK;
    size_t entries = (size_t)l->starts[l->count];
    STARG_NEW(context, STAGE, *values, entries);
    memcpy(*values, l->values, entries * sizeof **values);
    for (size_t i = 0; i < l->count; i++)
        (*values)[l->starts[i]] += shift * l->masses[i];
done:
    return status;
}

static starg_status order_rows(starg_context *context, const laplacian *l, factor *f) {
    double information[AMD_INFO];
    SuiteSparse_long result =
        amd_l_order(f->count, l->starts, l->rows, f->order, NULL, information);
    if (result == AMD_OUT_OF_MEMORY)
        return starg_fail_memory(context, STAGE);
    if (result != AMD_OK && result != AMD_OK_BUT_JUMBLED)
        return starg_fail(context, STARG_ERROR_SOLVER, STAGE, "the matrix cannot be ordered");
    return STARG_OK;
}

starg_status factor_fail(starg_context *context) {
    return starg_fail(
        context, STARG_ERROR_SOLVER, STAGE,
        "the spectrum cannot be found: the faces' shapes are too extreme; 'repair' may "
        "help");
}

starg_status factor_create(starg_context *context, const laplacian *l, double shift, factor *f) {
    starg_status status = STARG_OK;
    double *values = NULL;
    *f = (factor){.count = (int64_t)l->count};
    STARG_TRY(make_room(context, f));
    STARG_TRY(order_rows(context, l, f));
    STARG_TRY(shifted(context, l, shift, &values));
    ldl_l_symbolic(f->count, l->starts, l->rows, f->starts, f->parents, f->sizes, f->flags,
                   f->order, f->inverse);
    STARG_NEW(context, STAGE, f->rows, (size_t)f->starts[f->count]);
    STARG_NEW(context, STAGE, f->values, (size_t)f->starts[f->count]);
    if (ldl_l_numeric(f->count, l->starts, l->rows, values, f->starts, f->parents, f->sizes,
                      f->rows, f->values, f->diagonal, f->row, f->pattern, f->flags, f->order,
                      f->inverse) != f->count)
        status = factor_fail(context);
done:
    starg_release(context, values);
    if (status != STARG_OK)
        factor_free(context, f);
    return status;
}

void factor_solve(const factor *f, double *x, double *scratch) {
    ldl_l_perm(f->count, scratch, x, f->order);
    ldl_l_lsolve(f->count, scratch, f->starts, f->rows, f->values);
    ldl_l_dsolve(f->count, scratch, f->diagonal);
    ldl_l_ltsolve(f->count, scratch, f->starts, f->rows, f->values);
    ldl_l_permt(f->count, x, scratch, f->order);
}
