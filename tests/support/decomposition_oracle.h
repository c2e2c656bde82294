/* SPDX-License-Identifier: Apache-2.0 */
/* Checks star decompositions against their definition: by brute force, in rationals where signs
 * decide. */
#ifndef TESTS_DECOMPOSITION_ORACLE_H
#define TESTS_DECOMPOSITION_ORACLE_H

#include <stdbool.h>

#include "starguard/decompose.h"

/* Asserts everything in a result except what guards see: labels, counts, volumes, radii,
 * star-shapedness, and contacts. */
void decomposition_oracle_check(const starg_decomposition *d);

/* Asserts that the tetrahedra of each piece are connected by faces. */
void decomposition_oracle_check_connected(const starg_decomposition *d);

/* Asserts the fraction of the vertices that guards see. Takes O(vertices x faces) time. */
void decomposition_oracle_check_sight(const starg_decomposition *d);

#endif
