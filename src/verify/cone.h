/* SPDX-License-Identifier: Apache-2.0 */
/* Is a point within a cone of view? */
#ifndef STARG_VERIFY_CONE_H
#define STARG_VERIFY_CONE_H

#include <stdbool.h>

/* Is the angle at p between `direction` (not zero) and q at most that of the cosine? Exact for
 * finite doubles below 1e100; q = p counts as within. */
bool verify_in_cone(const double p[3], const double direction[3], double cosine, const double q[3]);

#endif
