/* SPDX-License-Identifier: Apache-2.0 */
/* How many points are needed to see all corners of a solid (STARG_TARGET_CORNERS)? */
#ifndef STARG_GUARD_CORNERS_H
#define STARG_GUARD_CORNERS_H

#include "mesh/solid.h"

typedef struct corner_guards {
    size_t bound; /* no fewer points, wherever they stand, see all that these see */
    size_t count;
    double *positions; /* count x 3 */
    char *certificate; /* of `bound`, or NULL if not requested */
    size_t size;       /* of the certificate */
} corner_guards;

/* `work` is starg_guard_options.prove_work. Errors: those of starg_guard. */
starg_status corner_guards_find(starg_context *context, const starg_solid *solid, uint64_t work,
                                bool certified, corner_guards *out);
void corner_guards_free(corner_guards *guards);

#endif
