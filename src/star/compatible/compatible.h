/* SPDX-License-Identifier: Apache-2.0 */
/* Compatible decomposition: pieces that are star-shaped in two solids at once. */
#ifndef STARG_STAR_COMPATIBLE_COMPATIBLE_H
#define STARG_STAR_COMPATIBLE_COMPATIBLE_H

#include "core/context.h"
#include "core/private.h"
#include "starguard/decompose.h"

/* Labels the tetrahedra of a mesh so that every piece is strictly star-shaped in it and in its
 * image, the same tetrahedra in other places. out[0] is the mesh in pieces, out[1] the image in the
 * same pieces; copies of both. With `cut` tetrahedra may be divided, alike in both and positive,
 * which saves pieces; the given vertices come first. Errors: MESH (a tetrahedron so thin that no
 * point is found in it), MEMORY, CANCELLED. */
starg_status compatible_decompose(starg_context *context, const starg_tetmesh *mesh,
                                  const starg_tetmesh *image, bool cut, starg_decomposition *out[2])
    STARG_PRIVATE(compatible_decompose);

#endif
