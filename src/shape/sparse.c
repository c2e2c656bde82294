/* SPDX-License-Identifier: Apache-2.0 */
/* L D L' without pivoting (LDL), in the order of AMD: stable for positive definite matrices. AMD
 * uses malloc; all other memory is the context's.
 *
 * Cost: determined by the fill-in, about 30 n to 60 n numbers for surfaces of n vertices; each
 * solve is linear in it. */
#include "shape/spectrum.h"

#include <suitesparse/amd.h>
#include <suitesparse/ldl.h>

struct sparse_factors {
    starg_context *context;
    int64_t size;
    int64_t *order, *starts, *rows;
    double *values, *diagonal;
};

/* Working data of the factorization. */
typedef struct making {
    int64_t *inverse, *parents, *sizes, *flags, *pattern;
    double *row;
} making;

static void making_free(making *m) {
    void *const blocks[] = {m->inverse, m->parents, m->sizes, m->flags, m->pattern, m->row};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        RELEASE(blocks[i]);
}

void sparse_free(sparse_factors *f) {
    if (f == NULL)
        return;
    RELEASE(f->order, f->starts, f->rows, f->values, f->diagonal, f);
}

static starg_status make_room(sparse_factors *f, const char *stage, making *m) {
    size_t n = (size_t)f->size;
    int64_t **const lists[] = {&f->order, &m->inverse, &m->parents,
                               &m->sizes, &m->flags,   &m->pattern};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        NEW(f->context, stage, *lists[i], n);
    NEW(f->context, stage, f->starts, n + 1);
    NEW(f->context, stage, f->diagonal, n);
    NEW(f->context, stage, m->row, n);
    return STARG_OK;
}

static starg_status choose_order(sparse_factors *f, const char *stage, const sparse_matrix *a) {
    double information[AMD_INFO];
    SuiteSparse_long result = amd_l_order(f->size, a->starts, a->rows, f->order, NULL, information);
    if (result == AMD_OUT_OF_MEMORY)
        return starg_fail_memory(f->context, stage);
    if (result != AMD_OK && result != AMD_OK_BUT_JUMBLED)
        return starg_fail(f->context, STARG_ERROR_SOLVER, stage, "the matrix cannot be ordered");
    return STARG_OK;
}

static starg_status fill_factors(sparse_factors *f, const char *stage, const sparse_matrix *a,
                                 making *m) {
    ldl_l_symbolic(f->size, a->starts, a->rows, f->starts, m->parents, m->sizes, m->flags, f->order,
                   m->inverse);
    NEW(f->context, stage, f->rows, (size_t)f->starts[f->size]);
    NEW(f->context, stage, f->values, (size_t)f->starts[f->size]);
    if (ldl_l_numeric(f->size, a->starts, a->rows, a->values, f->starts, m->parents, m->sizes,
                      f->rows, f->values, f->diagonal, m->row, m->pattern, m->flags, f->order,
                      m->inverse) != f->size)
        return starg_fail(
            f->context, STARG_ERROR_SOLVER, stage,
            "a linear system cannot be solved: some faces are too thin; try 'starguard repair'");
    return STARG_OK;
}

starg_status sparse_factorise(starg_context *context, const char *stage,
                              const sparse_matrix *matrix, sparse_factors **out) {
    SCOPED_BY(sparse_drop) sparse_factors *f = NULL;
    SCOPED_BY(making_free) making m = {0};
    *out = NULL;
    NEW_ZERO(context, stage, f, 1);
    f->context = context;
    f->size = (int64_t)matrix->size;
    TRY(make_room(f, stage, &m));
    TRY(choose_order(f, stage, matrix));
    TRY(fill_factors(f, stage, matrix, &m));
    *out = f;
    f = NULL;
    return STARG_OK;
}

void sparse_solve(const sparse_factors *f, double *values, double *work) {
    ldl_l_perm(f->size, work, values, f->order);
    ldl_l_lsolve(f->size, work, f->starts, f->rows, f->values);
    ldl_l_dsolve(f->size, work, f->diagonal);
    ldl_l_ltsolve(f->size, work, f->starts, f->rows, f->values);
    ldl_l_permt(f->size, values, work, f->order);
}
