/* SPDX-License-Identifier: Apache-2.0 */
/* Which of many half-spaces a point is least inside of. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Half-spaces {normal . x <= offset} are kept in blocks of SCAN_BLOCK: first coordinates of all
 * normals, then second, third, then all offsets. */
enum { SCAN_BLOCK = 64, SCAN_SIZE = 4 * SCAN_BLOCK };

/* Of those in a block whose `lowest` is below the bound: the one whose plane the point is least
 * inside of, if that is less than `room`; SCAN_BLOCK if there is none. */
size_t scan_block(const double *block, const double *lowest, double bound, const double point[3],
                  double room);
