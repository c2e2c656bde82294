/* SPDX-License-Identifier: Apache-2.0 */
/* Maps of tetrahedra without inversions, and with little distortion. */
#pragma once

#include "core/context.h"

/* Springs that draw the first vertices instead of fixing them. */
typedef struct unfold_springs {
    size_t count;          /* of vertices; 0: none */
    const double *targets; /* count x 3 */
    double strength; /* energy if all are off by `length`; that of all tetrahedra is about 3 */
    double length;
    void (*move)(void *user); /* may change the targets, between rounds */
    void *user;
} unfold_springs;

/* Tetrahedra in two places. All arrays are the caller's. */
typedef struct unfold_problem {
    starg_context *context;
    size_t vertex_count, fixed; /* the first `fixed` vertices do not move */
    size_t count;
    const uint32_t *tetrahedra; /* count x 4 */
    const double *rest;         /* vertex_count x 3: all tetrahedra are positive there */
    double *now;                /* vertex_count x 3: to be moved */
    double until;               /* on starg_clock(), where relaxation ends; 0: it does not */
    unfold_springs springs;     /* none, or fixed = 0 and one for each vertex of the surface */
} unfold_problem;

/* Is a tetrahedron positive where it is now, exactly? */
bool unfold_is_positive(const unfold_problem *p, size_t tetrahedron);

/* Moves vertices until all tetrahedra are positive, or for so many steps of descent; *inverted is
 * the number of those left. Errors: MEMORY, CANCELLED. */
starg_status unfold(const unfold_problem *p, size_t steps, size_t *inverted);

/* Lowers the distortion of tetrahedra that are all positive, and stay so, in at most so many steps
 * of descent. Errors: MEMORY, CANCELLED. */
starg_status unfold_relax(const unfold_problem *p, size_t steps);
