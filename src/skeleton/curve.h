/* SPDX-License-Identifier: Apache-2.0 */
/* The pruned graph as evenly spaced nodes on smooth branches. */
#pragma once

#include "skeleton/prune.h"
#include "starguard/skeleton.h"

/* Fills positions, radii, edges and vertex_nodes with their counts.
 * Errors: MESH (no double strictly inside), MEMORY, CANCELLED. */
starg_status curve_create(starg_context *context, const starg_solid *solid,
                          const medial_complex *complex, const curve_graph *graph,
                          const pruned_graph *pruned, size_t wanted, starg_skeleton *skeleton);
