/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the direction grid for NEON. */
#define GRID_RUN grid_run_neon
#define LANES_NEON
#include "visibility/grid_stages.h"
