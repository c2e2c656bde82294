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
 * a closed box, by the help of weights >= 0 for their normals (b - a) x (c - a), whose weighted sum
 * should be nearly zero. False proves nothing. Good weights prove whatever is true by more than
 * their rounding errors. */
bool half_spaces_apart_in_box(const half_space *spaces, const double *weights, int count,
                              const double lower[3], const double upper[3]);

/* True proves, in exact arithmetic, that `count` (1 to 4) open half-spaces have no common point.
 * False proves nothing: they may have one, or a part of them alone has none, or the coordinates
 * span more than 800 binary digits. By Helly's theorem four are enough if any number has none. */
bool half_spaces_apart(const half_space *spaces, int count);

#endif
