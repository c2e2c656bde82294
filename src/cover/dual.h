/* SPDX-License-Identifier: Apache-2.0 */
/* Lower bound on the size of full covers: the Lagrangian dual, in integers.
 *
 * For any multipliers u >= 0, one per column,
 *     L(u) = sum_j demand(j) u(j) + sum_i min(0, 1 - sum of u over the columns of row i)
 * is at most the size of every cover: a cover pays at least demand(j) u(j) for each column j.
 * Multipliers are stored as integer multiples of 2^-20, so L is evaluated exactly however u was
 * found, and L rounded up to a whole number of rows is a proven bound. */
#pragma once

#include "cover/state.h"

/* 1 and the largest multiplier. With 2^32 columns, demands to 1,000 and multipliers of 16 rows the
 * terms stay below 2^32 x 2^10 x 2^24; instances that fit into memory (below 2^28 columns) stay
 * below 2^62. */
#define COVER_ONE  ((int64_t)1 << 20)
#define COVER_MOST (16 * COVER_ONE)

/* L(u) in units of COVER_ONE; `reduced` receives 1 - sum of u for each row, in the same units. */
int64_t cover_dual_value(const cover_instance *instance, const int64_t *multipliers,
                         int64_t *reduced);

/* The fewest rows that a dual value allows. */
static inline size_t cover_dual_rows(int64_t value) {
    return value <= 0 ? 0 : (size_t)((value + COVER_ONE - 1) / COVER_ONE);
}

/* The best known bound and its proof. */
typedef struct cover_dual {
    int64_t *multipliers;
    int64_t *reduced; /* of `multipliers` */
    int64_t value;    /* of `multipliers` */
} cover_dual;

/* Starts from the multipliers of dual ascent. Errors: MEMORY. */
starg_status cover_dual_create(const cover_instance *instance, cover_dual *out);
void cover_dual_free(cover_dual *dual);

/* Replaces the multipliers by others, with their reduced costs and value as from cover_dual_value,
 * if the value is larger. */
void cover_dual_offer(const cover_instance *instance, cover_dual *dual, const int64_t *multipliers,
                      const int64_t *reduced, int64_t value);

/* Improves the dual by the subgradient method, and `best`, a full cover, on the way; stops when
 * they meet. Errors: MEMORY, CANCELLED. */
starg_status cover_lagrange(cover_run *run, const cover_instance *instance, cover_dual *dual,
                            cover_state *best);

/* Reduced-cost fixing for covers of at most `most` rows: clears in `keep` the rows that no such
 * cover holds, sets in `take` the rows that all of them hold; true if there are any. */
bool cover_dual_fix(const cover_instance *instance, const cover_dual *dual, size_t most,
                    uint64_t *keep, uint64_t *take);
