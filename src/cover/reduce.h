/* SPDX-License-Identifier: Apache-2.0 */
/* The paper's four reductions [YL11, 3.3], generalized to demands, and the modes in which they
 * hold.
 *
 * A column j demands demand(j) of the rows that contain it; R(j) are these rows.
 *
 * (1) Essential rows: if demand(j) = |R(j)|, every cover takes all of R(j). Taking row i lowers the
 *     demand of each of its columns by one; columns of demand 0 are covered. Holds for full covers;
 *     with a partial target column j may stay uncovered.
 * (2) Row dominance: let D be the largest demand among the columns of row i. If D other rows
 *     contain all columns of i, then i is redundant: a choice with i either lacks one of these
 *     rows, which can replace i, or has all D, which cover each column of i without it. With demand
 *     1 this is the paper's rule; with larger demands the paper's rule would lose covers that need
 *     both rows. No column gets uncovered, so it holds in every mode.
 * (3) Column dominance: if R(a) is a subset of R(b) and demand(a) >= demand(b), covering a covers
 *     b. So b is redundant for full covers; with a partial target its weight counts.
 * (4) Blocks: connected components of rows and columns are separate problems for full covers; a
 *     partial target or a limit on the rows couples them.
 *
 * Each rule is exact for any instance, so they can be applied in any order and combination. */
#pragma once

#include "cover/instance.h"

/* (1) Sets the bits of the essential rows in a zeroed mask; returns their number. */
size_t cover_mark_essential(const cover_instance *instance, uint64_t *rows);

/* (2), (3) Clears the bits of redundant rows or columns in a full mask; returns how many it
 * cleared. At the time limit they stop early, which is harmless. Errors: MEMORY (columns only),
 * CANCELLED. */
starg_status cover_drop_dominated_rows(cover_run *run, const cover_instance *instance,
                                       uint64_t *rows, size_t *dropped);
starg_status cover_drop_dominated_columns(cover_run *run, const cover_instance *instance,
                                          uint64_t *columns, size_t *dropped);

/* Replaces the instance by the rest after choosing the rows of `taken` (their names go to
 * `forced`), keeping only the rows of `keep` (NULL: all). Errors: MEMORY. */
starg_status cover_take_rows(cover_instance *instance, const uint64_t *taken, const uint64_t *keep,
                             cover_names *forced);

/* Rules (1) to (3) to a fixpoint, for full covers. Appends the names of essential rows to `forced`;
 * the columns that force them get price 1 in `prices` (by name), if not NULL. *feasible is false if
 * some column has fewer rows than it demands (possible only if rows were dropped for other
 * reasons). Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_full(cover_run *run, cover_instance *instance, cover_names *forced,
                               double *prices, bool *feasible);

/* Rule (2), for a partial target or a limit on the rows. Errors: MEMORY, CANCELLED. */
starg_status cover_reduce_partial(cover_run *run, cover_instance *instance);

/* (4) Numbers the blocks from 0 by their first rows: block[i] for each row. Every row must have a
 * column. Errors: MEMORY. */
starg_status cover_find_blocks(const cover_instance *instance, uint32_t *block, size_t *count);
