/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of the engine by contours for AVX-512. */
#define CONTOURS_VARIANT contours_avx512
#define LANES_AVX512
#include "visibility/contours_stages.h"
