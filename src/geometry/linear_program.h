/* SPDX-License-Identifier: Apache-2.0 */
/* Linear programs with up to four variables and many constraints. */
#ifndef STARG_GEOMETRY_LINEAR_PROGRAM_H
#define STARG_GEOMETRY_LINEAR_PROGRAM_H

#include "core/private.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LINEAR_PROGRAM_MOST = 4 };

/* Maximize objective . x over the x with a . x <= b for every row (a, b) and |x - center| <=
 * radius. The ball bounds every program: choose it large enough to contain any solution of
 * interest. */
typedef struct linear_program {
    int dimension;      /* 1 to LINEAR_PROGRAM_MOST */
    const double *rows; /* count x (dimension + 1): a of length about 1, then b */
    size_t count;       /* below 2^32 */
    double objective[LINEAR_PROGRAM_MOST];
    double center[LINEAR_PROGRAM_MOST], radius;
    uint64_t seed; /* of the order in which rows are added */
} linear_program;

/* `tight` holds distinct rows. For a solution: at most `dimension` rows that determine it; the
 * objective is a combination of them with factors >= 0, unless the ball is tight too. For an
 * infeasible program: at most dimension + 1 rows that no point of the ball satisfies together. */
typedef struct linear_solution {
    bool feasible;
    double point[LINEAR_PROGRAM_MOST];
    int tight_count;
    uint32_t tight[LINEAR_PROGRAM_MOST + 1];
} linear_solution;

/* `order` is working memory for `count` entries. `start` is NULL or the solution of a similar
 * program: its tight rows are added first (numbers >= count are skipped). Rounded: rows hold up to
 * about 2^-44 of the radius, and a program that is feasible by less than that may be reported
 * infeasible. */
void linear_program_solve(const linear_program *program, uint32_t *order,
                          const linear_solution *start, linear_solution *solution)
    STARG_PRIVATE(linear_program_solve);

#endif
