/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the contour engine for AVX2 with FMA. */
#define CONTOURS_VARIANT contours_avx2
#define LANES_AVX2
#include "visibility/contours_stages.h"
