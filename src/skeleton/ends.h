/* SPDX-License-Identifier: Apache-2.0 */
/* Where the ends of a curve skeleton lie. */
#pragma once

#include "starguard/solid.h"

#include <stddef.h>

/* The direction, of any length, in which a curve through three points runs `ahead` beyond the last
 * one if it bends on. `before` may equal `back`: then it runs straight. */
void ends_direction(const double before[3], const double back[3], const double at[3], double ahead,
                    double way[3]);

/* Moves the end of a curve, points[last], on to its last ball. The curve's points are last, last +
 * step, ..., `count` of them, inside of the solid as the end is before and after. */
void ends_advance(const starg_solid *solid, double (*points)[3], size_t last, ptrdiff_t step,
                  size_t count);
