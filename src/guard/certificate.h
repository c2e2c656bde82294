/* SPDX-License-Identifier: Apache-2.0 */
/* The proof of a bound for guards anywhere, as a text that verify checks (docs/formats.md). */
#ifndef STARG_GUARD_CERTIFICATE_H
#define STARG_GUARD_CERTIFICATE_H

#include "guard/bound.h"
#include "guard/cells.h"
#include "starguard/guard.h"

/* What proves the bound: prices, or rows that need a cover of this size, by branching. */
typedef struct bound_proof {
    size_t bound;
    whole_prices prices;           /* without rows */
    STARG_ARRAY(witness_row) rows; /* each leaf is within one of them */
    branch_record branches;
} bound_proof;

typedef struct guard_certificate {
    bound_proof proof;
    char *text; /* NULL until written */
    size_t size;
} guard_certificate;

void certificate_free(guard_certificate *why);

/* Records the prices that proved `bound`, if it improves on the previous one. `why` may be NULL. */
void certificate_note_prices(guard_certificate *why, size_t bound, const whole_prices *prices);
/* The same for rows; takes `branches` over. Errors: MEMORY. */
starg_status certificate_note_rows(starg_context *context, guard_certificate *why, size_t bound,
                                   const witness_row *const *rows, size_t count,
                                   branch_record *branches);

/* Writes the text from the record and the tree of cells, whose reasons are recomputed. Errors:
 * MEMORY, CANCELLED. */
starg_status certificate_of_search(const search_scene *scene, const search_cells *cells,
                                   const starg_guard_options *options, guard_certificate *why);

/* The text for a bound of 1, where `witness` must be seen, or of 0 where nothing must (UINT32_MAX).
 * Errors: MEMORY. */
starg_status certificate_of_one(starg_context *context, const starg_solid *solid,
                                const starg_guard_options *options, uint32_t witness,
                                guard_certificate *why);

#endif
