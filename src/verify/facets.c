/* SPDX-License-Identifier: Apache-2.0 */
/* Matches facets in a hash table of triangles, keyed by their three vertices. The first facet of a
 * triangle takes a slot, the second becomes its mate if its orientation is opposite; any other
 * facet of the triangle counts as misuse and stays unmatched.
 *
 * Invariant: mates are mutual, and the sum of the facets without mates, as a chain of oriented
 * triangles, is the boundary of the sum of the tetrahedra. So it is closed (the boundary of a
 * boundary is zero), whatever the tetrahedra are. Cost: O(n). */
#include "verify/pieces.h"

#include "core/rng.h"

static const char STAGE[] = "verify";

enum { CANCEL_STEP = 1 << 16 };

typedef struct triangle {
    uint32_t least, middle, most;
    int parity; /* 1: the corners are in the cyclic order least, middle, largest */
} triangle;

static void exchange(uint32_t *a, uint32_t *b, int *parity) {
    if (*a <= *b)
        return;
    uint32_t c = *a;
    *a = *b;
    *b = c;
    *parity = !*parity;
}

static triangle triangle_of(const verify_facets *facets, uint32_t facet) {
    uint32_t v[3];
    int parity = 1;
    verify_facet_corners(facets->tetrahedra, facet, v);
    exchange(&v[0], &v[1], &parity);
    exchange(&v[1], &v[2], &parity);
    exchange(&v[0], &v[1], &parity);
    return (triangle){v[0], v[1], v[2], parity};
}

static void note(verify_misuse *misuse, uint32_t facet, uint32_t other) {
    if (misuse->count++ == 0)
        *misuse = (verify_misuse){1, facet, other};
}

/* Gives a facet its slot or its mate. Slots hold facet + 1. */
static void insert(verify_facets *facets, uint32_t *slots, size_t mask, uint32_t facet) {
    triangle own = triangle_of(facets, facet);
    uint64_t key = starg_hash64((uint64_t)own.least << 32 | own.middle) + own.most;
    for (size_t i = (size_t)starg_hash64(key) & mask;; i = (i + 1) & mask) {
        if (slots[i] == 0) {
            slots[i] = facet + 1;
            return;
        }
        uint32_t first = slots[i] - 1;
        triangle other = triangle_of(facets, first);
        if (other.least != own.least || other.middle != own.middle || other.most != own.most)
            continue;
        if (facets->mate[first] != VERIFY_NONE) {
            note(&facets->third, facet, first);
        } else if (other.parity == own.parity) {
            note(&facets->same_side, facet, first);
        } else {
            facets->mate[first] = facet;
            facets->mate[facet] = first;
        }
        return;
    }
}

starg_status verify_facets_create(starg_context *context, const uint32_t *tetrahedra, size_t count,
                                  verify_facets **out) {
    SCOPED_BY(verify_facets_drop) verify_facets *facets = NULL;
    SCOPED uint32_t *slots = NULL;
    size_t mask = 1;
    *out = NULL;
    while (mask < 6 * count)
        mask = 2 * mask + 1;
    NEW_ZERO(context, STAGE, facets, 1);
    *facets = (verify_facets){.context = context, .tetrahedra = tetrahedra, .count = count};
    NEW(context, STAGE, facets->mate, 4 * count);
    NEW_ZERO(context, STAGE, slots, mask + 1);
    for (size_t f = 0; f < 4 * count; f++)
        facets->mate[f] = VERIFY_NONE;
    for (size_t f = 0; f < 4 * count; f++) {
        if (f % CANCEL_STEP == 0)
            TRY(starg_check_cancel(context, STAGE));
        insert(facets, slots, mask, (uint32_t)f);
    }
    *out = facets;
    facets = NULL;
    return STARG_OK;
}

void verify_facets_free(verify_facets *facets) {
    if (facets == NULL)
        return;
    RELEASE(facets->mate, facets);
}

starg_status verify_facets_outer(const verify_facets *facets, uint32_t **outer, uint32_t **faces,
                                 size_t *count) {
    size_t n = 0;
    *count = 0;
    for (size_t f = 0; f < 4 * facets->count; f++)
        n += facets->mate[f] == VERIFY_NONE;
    NEW(facets->context, STAGE, *outer, n);
    NEW(facets->context, STAGE, *faces, 3 * n);
    for (size_t f = 0; f < 4 * facets->count; f++)
        if (facets->mate[f] == VERIFY_NONE) {
            verify_facet_corners(facets->tetrahedra, (uint32_t)f, *faces + 3 * *count);
            (*outer)[(*count)++] = (uint32_t)f;
        }
    return STARG_OK;
}
