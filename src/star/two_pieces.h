/* SPDX-License-Identifier: Apache-2.0 */
/* Can a solid be cut into two star-shaped pieces? */
#ifndef STARG_STAR_TWO_PIECES_H
#define STARG_STAR_TWO_PIECES_H

#include "mesh/solid.h"

typedef struct two_pieces {
    bool excluded;     /* proven: it cannot, nor is it one */
    char *certificate; /* of that, or NULL; docs/formats.md */
    size_t size;       /* of the certificate */
} two_pieces;

/* Looks for a proof that the solid, whose surface is embedded, is no union of two star-shaped
 * pieces. Gives up after `work` looks at faces (about half a microsecond each), or when time is
 * over. Errors: MEMORY, CANCELLED. */
starg_status two_pieces_exclude(starg_context *context, const starg_solid *solid, uint64_t work,
                                bool certified, two_pieces *out);

#endif
