/* SPDX-License-Identifier: Apache-2.0 */
/* How a linear map stretches space. */
#pragma once

#include "core/compiler.h"

/* The singular values, descending, of the linear map that takes the columns of `from` to those of
 * `to`: from[i] and to[i] are vectors, and det(from) is not 0. Rounded. */
void singular_values(double from[3][3], double to[3][3], double out[3])
    STARG_PRIVATE(singular_values);
