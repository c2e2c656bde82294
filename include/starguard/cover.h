/* SPDX-License-Identifier: Apache-2.0 */
/* Set cover on bit rows: the fewest rows whose union holds every column, with a proven lower
 * bound [YL11, sections 3.2 and 3.3]. Knows nothing of geometry. */
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

/* What is to be covered. A column that at least one row holds is coverable; columns that no row
 * holds are left out of everything below.
 *
 * With redundancy k a column counts as covered when min(k, number of rows that hold it) of the
 * chosen rows hold it. The goal is the fewest rows that cover coverable weight of at least
 * `target`. With max_rows > 0 and a goal that this many rows cannot reach (as far as the method
 * finds out), the most weight that max_rows rows can cover is sought instead.
 *
 * Rows may be given: they are in the cover in any case. What follows speaks of the further rows;
 * weights, targets and demands count what the given rows do towards them. */
typedef struct starg_cover_problem {
    const starg_bits *rows;
    const uint64_t *weights; /* one per column, sum below 2^62; NULL: 1 each             */
    uint64_t target;         /* weight to cover; UINT64_MAX: all that is coverable       */
    uint32_t redundancy;     /* 1 to 1,000                                               */
    size_t max_rows;         /* 0: no limit                                              */
    const uint32_t *given;   /* given_count rows, in any order                           */
    size_t given_count;
} starg_cover_problem;

/* Fills `problem` with: no rows, weights 1, everything covered once, no limit, none given. */
STARG_API void starg_cover_problem_default(starg_cover_problem *problem);

typedef enum starg_cover_method {
    STARG_COVER_GREEDY = 0, /* the largest gain first, as it stands, and LP's bound      */
    STARG_COVER_ILP = 1,    /* reductions, Lagrangian bound, then branch and bound        */
    STARG_COVER_LP = 2      /* reductions, the linear relaxation's bound and prices, and a
                               greedy cover that is improved; ILP's answer where not all
                               is to be covered                                           */
} starg_cover_method;

typedef struct starg_cover_options {
    starg_cover_method method;
    /* Branch-and-bound nodes for each independent block of the reduced problem, and for each number
     * of rows that is tried with a partial target; when they are spent the best cover found and
     * its bound are returned. 0: none, bounds only. Counted, so that the result is the same on
     * every machine. */
    size_t max_nodes;
    bool prices; /* ask for the columns' prices */
} starg_cover_options;

/* ILP with 100,000 nodes, no prices. */
STARG_API void starg_cover_options_default(starg_cover_options *options);

/* A cover. `rows` is ordered by what each row adds, largest first, ties by index: the weight of
 * its columns that the rows before it have not covered; with redundancy above 1, have not covered
 * often enough. `optimal` speaks of the number of rows; where max_rows rows cannot reach the
 * target, `weight` is the most that they can cover if it equals `weight_bound`. */
typedef struct starg_cover {
    size_t count;
    uint32_t *rows;
    uint64_t weight; /* weight of the columns that `rows` cover                              */
    uint64_t weight_bound; /* no choice of max_rows rows (0: of all) covers more than this */
    size_t lower_bound;  /* no fewer rows cover min(target, coverable, weight) : proven          */
    bool optimal;        /* count == lower_bound                                                 */
    bool target_reached; /* weight is at least min(target, coverable weight)                     */
    bool time_limited;   /* the context's time limit cut the search short                        */
    size_t nodes;        /* branch-and-bound nodes that were used                                */
    /* Where prices were asked for, by the methods ILP and LP and with everything to be covered;
     * else NULL. One per column, 0 or more: what the bound of the linear relaxation pays for
     * covering it. A new row whose columns' prices sum to more than 1 is one that can lower that
     * bound. */
    double *prices;
} starg_cover;

/* Solves `problem`. `options` may be NULL for the defaults. Free the result with
 * starg_cover_free. Errors: ARGUMENT, MEMORY, CANCELLED. The solver library's failure is none:
 * the incumbent and the bound that were known by then are returned. */
STARG_API starg_status starg_cover_solve(starg_context *context, const starg_cover_problem *problem,
                                         const starg_cover_options *options, starg_cover **out);
STARG_API void starg_cover_free(starg_cover *cover);

#ifdef __cplusplus
}
#endif

#endif
