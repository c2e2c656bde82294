/* SPDX-License-Identifier: Apache-2.0 */
#include "morph/morph.h"

static const char STAGE[] = "factorise";

triplet *triplets_put_edge(uint32_t a, uint32_t b, double w, triplet *next) {
    *next++ = (triplet){a, a, w};
    *next++ = (triplet){b, b, w};
    *next++ = (triplet){a, b, -w};
    *next++ = (triplet){b, a, -w};
    return next;
}

/* Counting sort by columns, stable; its starts are one place ahead while it runs. */
static void assemble(const triplet *triplets, size_t count, sparse_matrix *m) {
    for (size_t i = 0; i < count; i++)
        m->starts[triplets[i].column + (size_t)2]++;
    for (size_t i = 0; i < m->size; i++)
        m->starts[i + 2] += m->starts[i + 1];
    for (size_t i = 0; i < count; i++) {
        int64_t at = m->starts[triplets[i].column + (size_t)1]++;
        m->rows[at] = triplets[i].row;
        m->values[at] = triplets[i].value;
    }
}

starg_status triplets_factorise(starg_context *context, size_t size, const triplet *triplets,
                                size_t count, sparse_factors **out) {
    starg_status status = STARG_OK;
    sparse_matrix m = {.size = size};
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, m.starts, size + 2);
    STARG_NEW(context, STAGE, m.rows, count);
    STARG_NEW(context, STAGE, m.values, count);
    assemble(triplets, count, &m);
    STARG_TRY(sparse_factorise(context, STAGE, &m, out));
done:
    RELEASE(m.starts, m.rows, m.values);
    return status;
}
