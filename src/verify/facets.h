/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of tetrahedra: those shared by two tetrahedra, and those of a single one. */
#ifndef STARG_VERIFY_FACETS_H
#define STARG_VERIFY_FACETS_H

#include <stddef.h>
#include <stdint.h>

#include "core/context.h"

#define VERIFY_NONE UINT32_MAX

/* Limit on tetrahedra, so that facet numbers are below VERIFY_NONE. */
#define VERIFY_TETRAHEDRA ((size_t)1 << 29)

/* An invalid use of a triangle: how often, and the first two conflicting facets. */
typedef struct verify_misuse {
    size_t count;
    uint32_t facet, other;
} verify_misuse;

/* Facet 4 t + i is the side of tetrahedron t opposite its corner i. */
typedef struct verify_facets {
    starg_context *context;
    const uint32_t *tetrahedra;
    size_t count;            /* of tetrahedra */
    uint32_t *mate;          /* per facet: the other one of its triangle, or VERIFY_NONE */
    verify_misuse third;     /* a triangle with more than two tetrahedra */
    verify_misuse same_side; /* a triangle with two facets of the same orientation */
} verify_facets;

/* `tetrahedra` (count x 4) must outlive the facets. Errors: MEMORY, CANCELLED. */
starg_status verify_facets_create(starg_context *context, const uint32_t *tetrahedra, size_t count,
                                  verify_facets **out);
void verify_facets_free(verify_facets *facets);

/* The corners of a facet, counter-clockwise seen from outside of a positive tetrahedron. */
static inline void verify_facet_corners(const uint32_t *tetrahedra, uint32_t facet,
                                        uint32_t corners[3]) {
    static const uint8_t opposite[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (int i = 0; i < 3; i++)
        corners[i] = tetrahedra[(size_t)(facet & ~UINT32_C(3)) + opposite[facet % 4][i]];
}

/* The facets without a mate, ascending, and their triangles (count x 3). Errors: MEMORY. */
starg_status verify_facets_outer(const verify_facets *facets, uint32_t **outer, uint32_t **faces,
                                 size_t *count);

#endif
