/* SPDX-License-Identifier: Apache-2.0 */
/* Local search for smaller full covers. */
#pragma once

#include "cover/state.h"

/* Improves `best`, a full cover, until it has at most `enough` rows or the search finds nothing for
 * long. Errors: MEMORY, CANCELLED. */
starg_status cover_local_search(cover_run *run, size_t enough, cover_state *best);
