/* SPDX-License-Identifier: Apache-2.0 */
/* The pruned graph as evenly spaced nodes on smooth branches. */
#ifndef STARG_SKELETON_CURVE_H
#define STARG_SKELETON_CURVE_H

#include "skeleton/complex.h"
#include "skeleton/graph.h"
#include "skeleton/prune.h"
#include "starguard/skeleton.h"

/* Fills positions, radii, edges and vertex_nodes with their counts.
 * Errors: MESH (no double strictly inside), MEMORY, CANCELLED. */
starg_status curve_create(starg_context *context, const starg_solid *solid,
                          const medial_complex *complex, const curve_graph *graph,
                          const pruned_graph *pruned, size_t wanted, starg_skeleton *skeleton);

#endif
