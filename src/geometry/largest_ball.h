/* SPDX-License-Identifier: Apache-2.0 */
/* Largest ball in an intersection of half-spaces that are added one by one. */
#ifndef STARG_GEOMETRY_LARGEST_BALL_H
#define STARG_GEOMETRY_LARGEST_BALL_H

#include <stdbool.h>
#include <stdint.h>

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

#endif
