/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the direction grid for any processor. */
#define GRID_RUN grid_run_plain
#define LANES_PLAIN
#include "visibility/grid_stages.h"
