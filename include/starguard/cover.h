/* SPDX-License-Identifier: Apache-2.0 */
/* Set cover on bit rows: the fewest rows whose union contains every column, with a proven lower
 * bound [YL11, sections 3.2 and 3.3]. Independent of geometry. */
#ifndef STARGUARD_COVER_H
#define STARGUARD_COVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A set cover problem. A column is coverable if at least one row contains it; all other columns are
 * ignored.
 *
 * With redundancy k, a column is covered when min(k, number of rows that contain it) of the chosen
 * rows contain it. The goal is the fewest rows that cover a coverable weight of at least `target`.
 * With max_rows > 0 and a target that max_rows rows cannot reach (as far as the method can tell),
 * the goal is the largest weight that max_rows rows can cover.
 *
 * Given rows are always in the cover. All statements below are about the other rows; weights,
 * targets and demands include the contribution of the given rows. */
typedef struct starg_cover_problem {
    const starg_bits *rows;
    const uint64_t *weights; /* one per column, sum below 2^62; NULL: 1 each             */
    uint64_t target;         /* weight to cover; UINT64_MAX: all that is coverable       */
    uint32_t redundancy;     /* 1 to 1,000                                               */
    const uint32_t *needs;   /* one per column, in place of the redundancy; 0: needs none; NULL: the
                                redundancy for each */
    size_t max_rows;         /* 0: no limit                                              */
    const uint32_t *given;   /* given_count rows, in any order                           */
    size_t given_count;
} starg_cover_problem;

/* Sets the defaults: no rows, weights 1, full coverage once, no limit, none given. */
STARG_API void starg_cover_problem_default(starg_cover_problem *problem);

typedef enum starg_cover_method {
    STARG_COVER_GREEDY = 0, /* largest gain first, with the bound of LP */
    STARG_COVER_ILP = 1,    /* reductions, Lagrangian bound, then branch and bound        */
    STARG_COVER_LP = 2, /* reductions, bound and prices of the LP relaxation, and an improved greedy
                           cover; same as ILP for partial targets */
    STARG_COVER_LOCAL = 3 /* reductions and a short local search, without a bound beyond what these
                             show; same as ILP for partial targets */
} starg_cover_method;

typedef struct starg_cover_options {
    starg_cover_method method;
    /* Branch-and-bound nodes per independent block of the reduced problem, and per number of rows
     * that is tried with a partial target; then the best cover and its bound are returned. 0:
     * bounds only. Counting nodes instead of time makes the result the same on every machine. */
    size_t max_nodes;
    bool prices; /* compute prices of the columns */
} starg_cover_options;

/* ILP with 100,000 nodes, no prices. */
STARG_API void starg_cover_options_default(starg_cover_options *options);

/* A cover. `rows` is ordered by marginal weight, largest first, ties by index: the weight of the
 * columns that the preceding rows do not cover (often enough, with redundancy above 1). `optimal`
 * refers to the number of rows; if max_rows rows cannot reach the target, `weight` is optimal if it
 * equals `weight_bound`. */
typedef struct starg_cover {
    size_t count;
    uint32_t *rows;
    uint64_t weight; /* weight of the columns that `rows` cover                              */
    uint64_t weight_bound; /* no choice of max_rows rows (0: of all) covers more */
    size_t lower_bound;    /* proven: no fewer rows cover min(target, coverable, weight) */
    bool optimal;        /* count == lower_bound                                                 */
    bool target_reached; /* weight is at least min(target, coverable weight)                     */
    bool time_limited;   /* the time limit stopped the search */
    size_t nodes;        /* branch-and-bound nodes used */
    /* One price per column, 0 or more: its dual value in the bound of the LP relaxation. A new row
     * can lower that bound only if the prices of its columns sum to more than 1. Only if requested,
     * with ILP or LP, where `rows` cover everything; else NULL. */
    double *prices;
} starg_cover;

/* Solves `problem`. `options` may be NULL for the defaults. Free the result with starg_cover_free.
 * Errors: ARGUMENT, MEMORY, CANCELLED. A failure of the solver library is not an error: the best
 * cover and bound so far are returned. */
STARG_API starg_status starg_cover_solve(starg_context *context, const starg_cover_problem *problem,
                                         const starg_cover_options *options, starg_cover **out);
STARG_API void starg_cover_free(starg_cover *cover);

#ifdef __cplusplus
}
#endif

#endif
