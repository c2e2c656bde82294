/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the direction grid for AVX2 with FMA. */
#define GRID_RUN grid_run_avx2
#define LANES_AVX2
#include "visibility/grid_stages.h"
