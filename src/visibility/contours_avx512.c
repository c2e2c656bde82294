/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the contour engine for AVX-512. */
#define CONTOURS_VARIANT contours_avx512
#define LANES_AVX512
#include "visibility/contours_stages.h"
