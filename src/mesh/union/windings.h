/* SPDX-License-Identifier: Apache-2.0 */
/* Which triangles of a cut surface separate inside from outside. */
#ifndef STARG_MESH_UNION_WINDINGS_H
#define STARG_MESH_UNION_WINDINGS_H

#include "mesh/union/arrangement.h"

/* Sets keep[t] for every triangle t with a winding number below 1 in front and of 1 or more behind.
 * `tree` is over the complex's surface. Errors: MEMORY, CANCELLED, TIME. */
starg_status union_choose(const union_complex *complex, const bvh *tree, bool *keep);

#endif
