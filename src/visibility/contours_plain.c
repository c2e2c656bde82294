/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the contour engine for any processor. */
#define CONTOURS_VARIANT contours_plain
#define LANES_PLAIN
#include "visibility/contours_stages.h"
