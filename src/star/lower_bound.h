/* SPDX-License-Identifier: Apache-2.0 */
/* How few star-shaped pieces a solid can be cut into. */
#ifndef STARG_STAR_LOWER_BOUND_H
#define STARG_STAR_LOWER_BOUND_H

#include "mesh/solid.h"
#include "starguard/guard.h"

typedef struct piece_bound {
    size_t bound;         /* no fewer star-shaped pieces make up the solid; 0: the time was over */
    starg_guards *guards; /* points that see all vertices; NULL: the time was over */
    char *certificate;    /* of `bound`, if asked for */
    size_t size;          /* of the certificate */
} piece_bound;

/* `work` is that of starg_guard_options.prove_work. Errors: those of starg_guard but TIME, and MESH
 * (the surface is not embedded). */
starg_status piece_bound_find(starg_context *context, const starg_solid *solid, uint64_t work,
                              bool certified, piece_bound *out);
void piece_bound_free(starg_context *context, piece_bound *bound);

#endif
