/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of the engine by contours for NEON. */
#define CONTOURS_VARIANT contours_neon
#define LANES_NEON
#include "visibility/contours_stages.h"
