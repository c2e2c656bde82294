/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a model that do not see each other. */
#ifndef STARG_VERIFY_PARTS_H
#define STARG_VERIFY_PARTS_H

#include "verify/tree.h"

/* By face, the part that it bounds, numbered by their lowest faces; *part is a block of the
 * context. The surface is that of a plain solid, and no point of this sees faces of two parts.
 * Errors: MEMORY, CANCELLED. */
starg_status verify_find_parts(const verify_surface *surface, const verify_tree *tree,
                               uint32_t **part);

#endif
