/* SPDX-License-Identifier: Apache-2.0 */
/* Small linear programs, and questions about half-spaces that they answer. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/compiler.h"

/* ---- linear programs with up to four variables and many constraints (linear_program.c) ---- */

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

/* ---- proofs that half-spaces have no common point (half_spaces.c) ---- */

enum { HALF_SPACES_MOST = 4 };

/* The open half-space of the points d with orient3d(a, b, c, d) = 1. */
typedef struct half_space {
    const double *a, *b, *c;
} half_space;

/* True proves, in exact arithmetic, that `count` (1 to 4) open half-spaces have no common point in
 * a closed box. `weights` >= 0 apply to the normals (b - a) x (c - a); their weighted sum should be
 * nearly zero. False proves nothing. Good weights prove everything that holds by more than their
 * rounding errors. */
bool half_spaces_apart_in_box(const half_space *spaces, const double *weights, int count,
                              const double lower[3], const double upper[3]);

/* True proves, in exact arithmetic, that `count` (1 to 4) open half-spaces have no common point.
 * False proves nothing: they may have one, a proper subset may have none, or the coordinates may
 * span more than 800 bits. By Helly's theorem, if any number of half-spaces has no common point,
 * some four have none. */
bool half_spaces_apart(const half_space *spaces, int count);

/* ---- largest ball in half-spaces that are added one by one (largest_ball.c) ---- */

/* Name of the initial half-spaces, which are not the caller's. */
#define LARGEST_BALL_FAR UINT32_MAX

/* Half-spaces {x : normal . x <= offset} with unit normals. Four of them, with weights >= 0, bound
 * the ball; initially those of a tetrahedron far away. */
typedef struct largest_ball {
    double normals[4][3], offsets[4];
    uint32_t names[4];        /* given by the caller, or LARGEST_BALL_FAR */
    double weights[4];        /* they sum to 1, and the weighted normals to 0 */
    double inverse[4][4];     /* of the matrix with rows (normal, 1) */
    int updates;              /* since it was recomputed */
    double center[3], radius; /* if negative: violation at the least violating point */
} largest_ball;

/* The region of interest must be within about a unit of the origin. */
void largest_ball_start(largest_ball *ball);

/* Adds a half-space that the ball violates; it replaces another one, and the radius does not grow.
 * False on numerical failure: the caller has to give up. */
bool largest_ball_add(largest_ball *ball, const double normal[3], double offset, uint32_t name);

/* Changes the offset of the half-space in a slot; the ball may then violate others.
 * LARGEST_BALL_DISTANCE is far away. */
void largest_ball_move(largest_ball *ball, int place, double offset, uint32_t name);

#define LARGEST_BALL_DISTANCE 4.0
