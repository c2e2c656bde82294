/* SPDX-License-Identifier: Apache-2.0 */
/* Welding: merges points at exactly equal positions. */
#include "mesh/formats/io.h"

#include "core/rng.h"

enum { FIRST_SIZE = 1024 };

static uint64_t hash_point(const double point[3]) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &point[k], sizeof bits);
        hash = starg_hash64(hash + bits + UINT64_C(0x9e3779b97f4a7c15));
    }
    return hash;
}

/* The slot of the vertex at `point`, or the free slot for it. */
static uint32_t *find(const starg_weld *weld, const double point[3]) {
    size_t mask = weld->size - 1;
    for (size_t i = (size_t)hash_point(point) & mask;; i = (i + 1) & mask) {
        uint32_t *slot = &weld->slots[i];
        if (*slot == 0)
            return slot;
        const double *other = weld->builder->vertices.data + 3 * (size_t)(*slot - 1);
        if (other[0] == point[0] && other[1] == point[1] && other[2] == point[2])
            return slot;
    }
}

static starg_status grow(starg_weld *weld) {
    starg_context *context = weld->builder->source->context;
    size_t size = weld->size == 0 ? FIRST_SIZE : 2 * weld->size;
    uint32_t *slots = starg_allocate_zero(context, size, sizeof *slots);
    if (slots == NULL)
        return starg_fail_memory(context, STARG_MESH_FILE);
    starg_release(context, weld->slots);
    weld->slots = slots;
    weld->size = size;
    size_t count = starg_builder_vertex_count(weld->builder);
    for (size_t i = 0; i < count; i++)
        *find(weld, weld->builder->vertices.data + 3 * i) = (uint32_t)(i + 1);
    return STARG_OK;
}

starg_status starg_weld_point(starg_weld *weld, const double point[3], starg_place place,
                              uint32_t *vertex) {
    /* adding 0 turns -0 into 0 and changes nothing else */
    const double p[3] = {point[0] + 0.0, point[1] + 0.0, point[2] + 0.0};
    size_t count = starg_builder_vertex_count(weld->builder);
    if (2 * (count + 1) > weld->size)
        TRY(grow(weld));
    uint32_t *slot = find(weld, p);
    if (*slot == 0) {
        TRY(starg_builder_vertex(weld->builder, p, place));
        *slot = (uint32_t)(count + 1);
    }
    *vertex = *slot - 1;
    return STARG_OK;
}

void starg_weld_free(starg_weld *weld) {
    starg_release(weld->builder->source->context, weld->slots);
}
