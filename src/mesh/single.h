/* SPDX-License-Identifier: Apache-2.0 */
/* What single precision, or another rounding, does to a surface; every writer of it asks
 * (mesh/single.c). */
#pragma once

#include "mesh/mesh.h"

/* Where a surface goes, for messages. */
typedef struct single_place {
    const char *stage;
    const char *file;   /* NULL: not known */
    const char *what;   /* "the model", "frame 3" */
    const char *how;    /* NULL: "in single precision" */
    const char *remedy; /* what keeps it: "write OFF, OBJ or PLY" */
} single_place;

/* Are the faces still those of the same surface with vertices at `rounded`, which is only read?
 * Errors: RANGE, with the element and the reason; MEMORY, CANCELLED. */
starg_status single_compare(starg_context *context, const starg_mesh *surface, double *rounded,
                            const single_place *place);

/* The same for vertices less `origin` (NULL: zero) as single precision holds them. */
starg_status single_check(starg_context *context, const starg_mesh *surface, const double origin[3],
                          const single_place *place);
