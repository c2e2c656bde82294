/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of faces for any processor. */
#define SIDES_RUN sides_run_plain
#define LANES_PLAIN
#include "visibility/sides_stages.h"
