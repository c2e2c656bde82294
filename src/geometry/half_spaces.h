/* SPDX-License-Identifier: Apache-2.0 */
/* Proofs that half-spaces have no common point. */
#ifndef STARG_GEOMETRY_HALF_SPACES_H
#define STARG_GEOMETRY_HALF_SPACES_H

#include <stdbool.h>
#include <stddef.h>

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

#endif
