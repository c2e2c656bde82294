/* SPDX-License-Identifier: Apache-2.0 */
/* Removes loops of an eroded graph that the solid does not have. */
#pragma once

#include "skeleton/complex.h"

/* Cuts the shortest loops (in links) one by one, until `excess` are cut or none is left. Errors:
 * MEMORY, CANCELLED. */
starg_status graph_repair_loops(starg_context *context, const medial_complex *complex,
                                bool *link_left, size_t excess);

/* Keeps the `wanted` largest components and marks their nodes. Errors: MEMORY. */
starg_status graph_repair_parts(starg_context *context, const medial_complex *complex,
                                bool *link_left, bool *node_left, size_t wanted);
