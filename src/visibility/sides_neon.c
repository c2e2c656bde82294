/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of faces for NEON. */
#define SIDES_RUN sides_run_neon
#define LANES_NEON
#include "visibility/sides_stages.h"
