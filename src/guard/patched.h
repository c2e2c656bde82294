/* SPDX-License-Identifier: Apache-2.0 */
/* A solid whose faces are seen in parts. */
#ifndef STARG_GUARD_PATCHED_H
#define STARG_GUARD_PATCHED_H

#include "mesh/solid.h"
#include "starguard/visibility.h"

/* `solid` is a copy that borrows everything but the patches, which it has if faces are cut. */
typedef struct patched_solid {
    starg_solid solid;
    mesh_patches *patches;
} patched_solid;

/* Cuts the faces as the options say; view->patch becomes the largest length of an edge, or
 * STARG_PATCH_OFF where auto leaves the faces whole. Errors: ARGUMENT (too many parts), MEMORY. */
starg_status patched_solid_make(starg_context *context, const starg_solid *solid,
                                starg_visibility_options *view, patched_solid *out);
void patched_solid_free(patched_solid *patched);

#endif
