/* L D L' without pivoting (LDL), in the order of AMD: stable for positive definite matrices. AMD
 * takes its memory from malloc; all other memory is the context's. LDL sums entries of one place.
 */
#include "morph/cholesky.h"

#include <stdlib.h>
#include <suitesparse/amd.h>
#include <suitesparse/ldl.h>

#include "core/memory.h"

static const char STAGE[] = "factorise";

struct cholesky {
    starg_context *context;
    int64_t size;
    int64_t *order, *starts, *rows;
    double *values, *diagonal;
};

/* What only the making needs. */
typedef struct making {
    int64_t *column_starts, *entry_rows, *inverse, *parents, *sizes, *flags, *pattern;
    double *entries, *row;
} making;

static void making_free(starg_context *context, making *m) {
    void *const blocks[] = {m->column_starts, m->entry_rows, m->inverse, m->parents, m->sizes,
                            m->flags,         m->pattern,    m->entries, m->row};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(context, blocks[i]);
}

matrix_entry *matrix_put_link(uint32_t a, uint32_t b, double w, matrix_entry *next) {
    *next++ = (matrix_entry){a, a, w};
    *next++ = (matrix_entry){b, b, w};
    *next++ = (matrix_entry){a, b, -w};
    *next++ = (matrix_entry){b, a, -w};
    return next;
}

void cholesky_free(cholesky *c) {
    if (c == NULL)
        return;
    starg_release(c->context, c->order);
    starg_release(c->context, c->starts);
    starg_release(c->context, c->rows);
    starg_release(c->context, c->values);
    starg_release(c->context, c->diagonal);
    starg_release(c->context, c);
}

static starg_status make_room(cholesky *c, making *m, size_t count) {
    starg_status status = STARG_OK;
    size_t n = (size_t)c->size;
    int64_t **const lists[] = {&c->order, &m->inverse, &m->parents,
                               &m->sizes, &m->flags,   &m->pattern};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        STARG_NEW(c->context, STAGE, *lists[i], n);
    STARG_NEW(c->context, STAGE, c->starts, n + 1);
    STARG_NEW(c->context, STAGE, c->diagonal, n);
    STARG_NEW(c->context, STAGE, m->row, n);
    STARG_NEW_ZERO(c->context, STAGE, m->column_starts, n + 2);
    STARG_NEW(c->context, STAGE, m->entry_rows, count);
    STARG_NEW(c->context, STAGE, m->entries, count);
done:
    return status;
}

/* By columns, in the order given: a counting sort whose starts are one place ahead while it runs.
 */
static void lay_out(making *m, const matrix_entry *entries, size_t count, size_t size) {
    for (size_t i = 0; i < count; i++)
        m->column_starts[entries[i].column + (size_t)2]++;
    for (size_t i = 0; i < size; i++)
        m->column_starts[i + 2] += m->column_starts[i + 1];
    for (size_t i = 0; i < count; i++) {
        int64_t at = m->column_starts[entries[i].column + (size_t)1]++;
        m->entry_rows[at] = entries[i].row;
        m->entries[at] = entries[i].value;
    }
}

static starg_status factorise(cholesky *c, making *m) {
    starg_status status = STARG_OK;
    double information[AMD_INFO];
    SuiteSparse_long result =
        amd_l_order(c->size, m->column_starts, m->entry_rows, c->order, NULL, information);
    if (result == AMD_OUT_OF_MEMORY)
        return starg_fail_memory(c->context, STAGE);
    if (result != AMD_OK && result != AMD_OK_BUT_JUMBLED)
        return starg_fail(c->context, STARG_ERROR_SOLVER, STAGE, "the matrix cannot be ordered");
    ldl_l_symbolic(c->size, m->column_starts, m->entry_rows, c->starts, m->parents, m->sizes,
                   m->flags, c->order, m->inverse);
    STARG_NEW(c->context, STAGE, c->rows, (size_t)c->starts[c->size]);
    STARG_NEW(c->context, STAGE, c->values, (size_t)c->starts[c->size]);
    if (ldl_l_numeric(c->size, m->column_starts, m->entry_rows, m->entries, c->starts, m->parents,
                      m->sizes, c->rows, c->values, c->diagonal, m->row, m->pattern, m->flags,
                      c->order, m->inverse) != c->size)
        status = starg_fail(c->context, STARG_ERROR_SOLVER, STAGE,
                            "the system of the faces cannot be factorised: their shapes are too "
                            "extreme; 'starguard repair' may help");
done:
    return status;
}

starg_status cholesky_create(starg_context *context, size_t size, const matrix_entry *entries,
                             size_t count, cholesky **out) {
    starg_status status = STARG_OK;
    cholesky *c = NULL;
    making m = {0};
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, c, 1);
    c->context = context;
    c->size = (int64_t)size;
    STARG_TRY(make_room(c, &m, count));
    lay_out(&m, entries, count, size);
    STARG_TRY(factorise(c, &m));
    *out = c;
    c = NULL;
done:
    making_free(context, &m);
    cholesky_free(c);
    return status;
}

void cholesky_solve(const cholesky *c, double *values, double *work) {
    /* LDL reads these only */
    ldl_l_perm(c->size, work, values, c->order);
    ldl_l_lsolve(c->size, work, c->starts, c->rows, c->values);
    ldl_l_dsolve(c->size, work, c->diagonal);
    ldl_l_ltsolve(c->size, work, c->starts, c->rows, c->values);
    ldl_l_permt(c->size, values, work, c->order);
}
