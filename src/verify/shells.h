/* Shells: the parts of a surface that hang together through edges of exactly two faces. */
#ifndef STARG_VERIFY_SHELLS_H
#define STARG_VERIFY_SHELLS_H

#include "verify/surface.h"

/* Finds shells: *parent (face_count, a block of the context) names for each face another one of its
 * shell; verify_shell_of follows that to the lowest. Errors: MEMORY. */
starg_status verify_find_shells(const verify_surface *surface, uint32_t **parent);

/* The face that stands for the shell of a face, the lowest one of it. */
uint32_t verify_shell_of(uint32_t *parent, uint32_t face);

#endif
