/* SPDX-License-Identifier: Apache-2.0 */
/* Set cover by exhaustive search: the tests' independent answer. */
#ifndef TESTS_COVER_ORACLE_H
#define TESTS_COVER_ORACLE_H

#include "starguard/cover.h"

enum { COVER_ORACLE_ROWS = 16 };

/* Weight covered by a choice of rows together with the given ones, column by column as defined in
 * cover.h. */
uint64_t cover_oracle_weight(const starg_cover_problem *problem, const uint32_t *rows,
                             size_t count);

/* Weight of all coverable columns. */
uint64_t cover_oracle_coverable(const starg_cover_problem *problem);

/* best[c]: the largest weight that exactly c further rows cover, for c from 0 to the number of
 * rows, at most COVER_ORACLE_ROWS. */
void cover_oracle_best(const starg_cover_problem *problem, uint64_t best[COVER_ORACLE_ROWS + 1]);

/* The fewest rows that cover `weight`, from cover_oracle_best's answer; more than `rows` if
 * impossible. */
size_t cover_oracle_fewest(const uint64_t *best, size_t rows, uint64_t weight);

/* Rows are the points of the affine space of `dimension` over three elements, columns its lines: a
 * Steiner triple system, hard for its size, whose linear relaxation is a third of the points. The
 * fewest points that meet all lines are 5 of 9, 18 of 27. */
starg_bits *cover_oracle_lines(starg_context *context, int dimension);

#endif
