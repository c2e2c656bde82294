/* SPDX-License-Identifier: Apache-2.0 */
/* Union-find over faces. A hash table holds the first directed edge of every vertex pair; the
 * second one becomes its partner, a third one invalidates the pair. Faces that touch only in a
 * vertex, or in an edge of more than two faces, stay separate: facts about one say nothing about
 * the other. Cost: O(n). */
#include "verify/surface.h"

#include "core/rng.h"

static const char STAGE[] = "verify";

#define ALONE  UINT32_MAX
#define SPOILT (UINT32_MAX - 1)

/* Edge e runs from corner e % 3 of face e / 3 to the next; its ends, the lower one first. */
static uint64_t ends_of(const verify_surface *surface, uint32_t e) {
    uint64_t a = surface->faces[e], b = surface->faces[e % 3 == 2 ? e - 2 : e + 1];
    return a < b ? a << 32 | b : b << 32 | a;
}

/* Slots hold edge + 1. */
static void insert(const verify_surface *surface, uint32_t *slots, size_t mask, uint32_t *partner,
                   uint32_t e) {
    uint64_t ends = ends_of(surface, e);
    for (size_t i = (size_t)starg_hash64(ends) & mask;; i = (i + 1) & mask) {
        if (slots[i] == 0) {
            slots[i] = e + 1;
            return;
        }
        uint32_t first = slots[i] - 1;
        if (ends_of(surface, first) == ends) {
            partner[first] = partner[first] == ALONE ? e : SPOILT;
            return;
        }
    }
}

starg_status verify_find_shells(const verify_surface *surface, uint32_t **parent) {
    starg_context *context = surface->context;
    SCOPED uint32_t *slots = NULL, *partner = NULL;
    size_t edges = 3 * surface->face_count, mask = 1;
    while (mask < 2 * edges)
        mask = 2 * mask + 1;
    if (edges >= SPOILT)
        return starg_fail_memory(context, STAGE);
    NEW(context, STAGE, *parent, surface->face_count);
    NEW(context, STAGE, partner, edges);
    NEW_ZERO(context, STAGE, slots, mask + 1);
    for (size_t f = 0; f < surface->face_count; f++)
        (*parent)[f] = (uint32_t)f;
    for (size_t e = 0; e < edges; e++)
        partner[e] = ALONE;
    for (size_t e = 0; e < edges; e++)
        insert(surface, slots, mask, partner, (uint32_t)e);
    for (size_t e = 0; e < edges; e++)
        if (partner[e] < SPOILT)
            verify_join(*parent, (uint32_t)(e / 3), partner[e] / 3);
    return STARG_OK;
}
