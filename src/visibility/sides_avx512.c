/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of faces for AVX-512. */
#define SIDES_RUN sides_run_avx512
#define LANES_AVX512
#include "visibility/sides_stages.h"
