/* SPDX-License-Identifier: Apache-2.0 */
/* Faces that no candidate sees, and the whole free space (guard/unseen.c). */
#ifndef STARG_GUARD_UNSEEN_H
#define STARG_GUARD_UNSEEN_H

#include "guard/candidates.h"

/* Which of these patches, ascending, does no place see where guards may stand, whatever they look
 * at? *faces counts the faces of which that is certain for all that are listed; `places` receives
 * points that see others. `work` is a budget as that of starg_unseen. Errors: MEMORY, CANCELLED. */
starg_status unseen_prove(starg_context *context, const starg_solid *solid,
                          const starg_guard_options *options, const uint32_t *patches, size_t count,
                          uint64_t work, size_t *faces, candidate_points *places);

#endif
