/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the direction grid for AVX-512. */
#define GRID_RUN grid_run_avx512
#define LANES_AVX512
#include "visibility/grid_stages.h"
