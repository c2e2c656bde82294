/* SPDX-License-Identifier: Apache-2.0 */
/* The largest ball inside of half-spaces that come one by one. */
#ifndef STARG_GEOMETRY_LARGEST_BALL_H
#define STARG_GEOMETRY_LARGEST_BALL_H

#include <stdbool.h>
#include <stdint.h>

/* Stands for no half-space of the caller. */
#define LARGEST_BALL_FAR UINT32_MAX

/* Half-spaces {x : normal . x <= offset} with normals of length one. Four of them, with weights
 * >= 0, hold the ball where it is; at the start those of a tetrahedron far away. */
typedef struct largest_ball {
    double normals[4][3], offsets[4];
    uint32_t names[4];    /* as the caller gave them, or LARGEST_BALL_FAR                       */
    double weights[4];    /* their sum is 1, the weighted sum of the normals 0                  */
    double inverse[4][4]; /* of the matrix with the rows (normal, 1) */
    int updates;          /* since it was computed anew               */
    double center[3], radius; /* a negative radius: how far the least bad point is outside    */
} largest_ball;

/* Everything that matters is within about a unit of the origin. */
void largest_ball_start(largest_ball *ball);

/* Adds a half-space that the ball is not inside of; it takes the place of another one, and the
 * radius falls or stays. False when the numbers do not allow it: the caller has to give up. */
bool largest_ball_add(largest_ball *ball, const double normal[3], double offset, uint32_t name);

/* Gives the half-space in a place another offset; the ball may then violate others. Far away is
 * LARGEST_BALL_DISTANCE. */
void largest_ball_move(largest_ball *ball, int place, double offset, uint32_t name);

#define LARGEST_BALL_DISTANCE 4.0

#endif
