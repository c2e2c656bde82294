/* SPDX-License-Identifier: Apache-2.0 */
/* Faces that no candidate sees, and the whole free space (guard/unseen.c). */
#ifndef STARG_GUARD_UNSEEN_H
#define STARG_GUARD_UNSEEN_H

#include "guard/candidates.h"

/* Which of these faces does no place see where guards may stand, whatever they look at? *proven
 * counts those for which that is certain; `places` receives points that see others. `work` is a
 * budget as that of starg_unseen. Errors: MEMORY, CANCELLED. */
starg_status unseen_prove(starg_context *context, const starg_solid *solid,
                          const starg_guard_options *options, const uint32_t *faces, size_t count,
                          uint64_t work, size_t *proven, candidate_points *places);

#endif
