/* What the two ways to check a boundary share. */
#ifndef STARG_VERIFY_BOUNDARY_H
#define STARG_VERIFY_BOUNDARY_H

#include "verify/pieces.h"

/* How far the rounding of coordinates may move a point of the surface, generously. */
double verify_rounding(const verify_surface *surface);

/* Shells: faces connected by vertices. *parent (vertex_count) names for each vertex another one
 * of its shell; verify_shell_of follows that to the one that stands for the shell. Errors: MEMORY.
 */
starg_status verify_find_shells(const verify_surface *surface, uint32_t **parent);
uint32_t verify_shell_of(uint32_t *parent, uint32_t vertex);

#endif
