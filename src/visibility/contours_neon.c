/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the contour engine for NEON. */
#define CONTOURS_VARIANT contours_neon
#define LANES_NEON
#include "visibility/contours_stages.h"
