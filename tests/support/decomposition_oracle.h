/* SPDX-License-Identifier: Apache-2.0 */
/* Star decompositions against their definition: by brute force, in rationals where signs decide. */
#ifndef TESTS_DECOMPOSITION_ORACLE_H
#define TESTS_DECOMPOSITION_ORACLE_H

#include <stdbool.h>

#include "starguard/decompose.h"

/* Asserts everything that a result tells but what guards see: labels, counts, volumes, radii, which
 * pieces are star-shaped, and contacts. */
void decomposition_oracle_check(const starg_decomposition *d);

/* Asserts that the tetrahedra of each piece hang together by faces. */
void decomposition_oracle_check_connected(const starg_decomposition *d);

/* Asserts the fraction of the vertices that guards see. Takes time vertices x faces. */
void decomposition_oracle_check_sight(const starg_decomposition *d);

#endif
