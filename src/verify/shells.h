/* SPDX-License-Identifier: Apache-2.0 */
/* Shells: components of a surface connected through edges of exactly two faces. */
#ifndef STARG_VERIFY_SHELLS_H
#define STARG_VERIFY_SHELLS_H

#include "verify/sets.h"
#include "verify/surface.h"

/* Finds shells as disjoint sets of faces: *parent (face_count) is a block of the context. Errors:
 * MEMORY. */
starg_status verify_find_shells(const verify_surface *surface, uint32_t **parent);

#endif
