/* SPDX-License-Identifier: Apache-2.0 */
/* The paper's four reductions [YL11, 3.3], stated for demands and with the modes they hold in.
 *
 * A column j asks for demand(j) of the rows that hold it; R(j) are these rows.
 *
 * (1) Essential rows: when demand(j) = |R(j)|, every cover takes all of R(j). Taking row i lowers
 *     the demand of each column it holds by one; columns of demand 0 are covered. Holds whenever
 *     everything must be covered; with a partial target column j may stay uncovered.
 * (2) Row dominance: let D be the largest demand among the columns of row i. If D other rows hold
 *     all columns of i, then i is needless: a choice with i either lacks one of these rows, which
 *     can then stand in for i, or has all D, which cover each column of i without it. With demand 1
 *     it is the paper's rule; with larger demands the paper's rule would lose covers that need
 *     both rows. The argument never uncovers a column, so it holds in every mode.
 * (3) Column dominance: if R(a) is part of R(b) and demand(a) >= demand(b), whoever covers a
 *     covers b. So b is needless whenever everything must be covered; with a partial target its
 *     weight counts.
 * (4) Blocks: rows and columns that share nothing are separate problems whenever everything must
 *     be covered; a partial target or a limit on the rows couples them.
 *
 * Each rule is exact for the instance it is given, so any order and any subset of them is. */
#ifndef STARG_COVER_REDUCE_H
#define STARG_COVER_REDUCE_H

#include "cover/instance.h"

/* (1) Sets the bits of the essential rows in a zeroed mask; returns their number. */
size_t cover_mark_essential(const cover_instance *instance, uint64_t *rows);

/* (2), (3) Clears the bits of needless rows or columns in a mask that holds all of them; returns
 * how many it cleared. When the time is over they stop early, which is harmless.
 * Errors: MEMORY (columns only), CANCELLED. */
starg_status cover_drop_dominated_rows(cover_run *run, const cover_instance *instance,
                                       uint64_t *rows, size_t *dropped);
starg_status cover_drop_dominated_columns(cover_run *run, const cover_instance *instance,
                                          uint64_t *columns, size_t *dropped);

/* Replaces the instance by what is left when the rows of `taken` are chosen (their names go to
 * `forced`) and only the rows of `keep` (NULL: all) may be chosen further. Errors: MEMORY. */
starg_status cover_take_rows(cover_instance *instance, const uint64_t *taken, const uint64_t *keep,
                             cover_names *forced);

/* Rules (1) to (3) to a fixpoint, for covering everything. Names of essential rows are appended
 * to `forced`; the columns that ask for them get the price 1 in `prices` (by name), if not NULL.
 * *feasible is false when some column has fewer rows left than it demands (possible only after rows
 * were dropped by other means). Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_full(cover_run *run, cover_instance *instance, cover_names *forced,
                               double *prices, bool *feasible);

/* Rule (2), for a partial target or a limit on the rows. Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_partial(cover_run *run, cover_instance *instance);

/* (4) Numbers the blocks from 0 in the order of their first rows: block[i] for each row. Every row
 * must hold a column. Errors: MEMORY. */
starg_status cover_find_blocks(const cover_instance *instance, uint32_t *block, size_t *count);

#endif
