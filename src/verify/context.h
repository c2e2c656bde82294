/* SPDX-License-Identifier: Apache-2.0 */
/* Verification context of a decomposition: the model, the report, and the claims to check. */
#ifndef STARG_VERIFY_CONTEXT_H
#define STARG_VERIFY_CONTEXT_H

#include "verify/claims.h"
#include "verify/measure.h"
#include "verify/pieces.h"

typedef struct verify_context {
    starg_context *context;
    const starg_pieces_mesh *mesh;
    const starg_pieces_report *report; /* or NULL */
    const verify_surface *model;
    size_t model_tetrahedra;     /* of a tetrahedral model, or 0 */
    const verify_surface *solid; /* the same, closed and oriented; NULL: it is not closed */
    const starg_certificate *certificate; /* of the report's lower bound, or NULL */
    verify_pieces *pieces;
    starg_verdict *verdict;
} verify_context;

/* Claims about the tetrahedra: positive, conforming, labelled, connected by piece. Errors: MEMORY,
 * CANCELLED. */
starg_status verify_claim_tetrahedra(const verify_context *own);

/* The boundary and the volume are those of the model. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_boundary(const verify_context *own);

/* The boundary does not cross itself and winds around its inside once, so that positive tetrahedra
 * do not overlap. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_once(const verify_context *own);

/* The report's numbers. Requires valid labels. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_numbers(const verify_context *own);

/* Star-shapedness, and what guards see. Requires valid labels. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_stars(const verify_context *own);

/* Dihedral angles. Errors: MEMORY. */
starg_status verify_claim_angles(const verify_context *own);

/* No fewer star-shaped pieces are possible. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_fewest(const verify_context *own);
/* Maps of pieces to balls, if there are any. Errors: MEMORY. */
starg_status verify_claim_balls(const verify_context *own);

/* Between the keys of a map no tetrahedron is ever inverted. Errors: CANCELLED. */
starg_status verify_claim_path(starg_context *context, const starg_solid_map *map,
                               starg_verdict *verdict);

/* ---- names of elements ---- */

typedef struct verify_words {
    char text[96];
} verify_words;

verify_words verify_facet_words(const verify_context *own, uint32_t facet);
verify_words verify_outer_words(const verify_context *own, size_t face);

#endif
