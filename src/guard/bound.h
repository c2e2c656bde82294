/* How many guards are needed, proven in whole numbers. */
#ifndef STARG_GUARD_BOUND_H
#define STARG_GUARD_BOUND_H

#include "guard/witnesses.h"

#define BOUND_ONE ((uint64_t)1 << 40)

/* Prices as whole numbers of 1 / BOUND_ONE, rounded down; they must be below 16. */
void bound_round(const double price[MOST_WITNESSES], uint64_t whole[MOST_WITNESSES]);

/* No fewer rows than that hold all witnesses that have a price: one row holds at most the largest
 * sum of prices over a row, so that k of them hold at most k times that. 0 where no row holds
 * anything. */
size_t bound_of_prices(const witness_row *const *rows, size_t count,
                       const uint64_t price[MOST_WITNESSES]);

#endif
