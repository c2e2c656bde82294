/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of faces for AVX2 with FMA. */
#define SIDES_RUN sides_run_avx2
#define LANES_AVX2
#include "visibility/sides_stages.h"
