/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/repair/repair.h"

#include "core/rng.h"
#include "geometry/predicates.h"

enum { FIRST_KEYS = 64 };

starg_status repair_begin(repair_state *state, starg_context *context, const starg_mesh *input,
                          const starg_repair_options *options) {
    *state = (repair_state){.context = context, .input = input, .options = *options};
    for (size_t v = 0; v < input->vertex_count; v++) {
        uint32_t copy;
        TRY(repair_add_vertex(state, input->vertices + 3 * v, (uint32_t)v, &copy));
    }
    for (size_t f = 0; f < input->face_count; f++) {
        const uint32_t *corner = input->faces + 3 * f;
        TRY(repair_add_face(state, corner[0], corner[1], corner[2], 0));
    }
    return STARG_OK;
}

void repair_end(repair_state *state) {
    RELEASE(state->vertices.data, state->origin.data, state->faces.data, state->flags.data);
}

starg_mesh repair_view(const repair_state *state) {
    return (starg_mesh){.context = state->context,
                        .vertex_count = repair_vertex_count(state),
                        .face_count = repair_face_count(state),
                        .vertices = state->vertices.data,
                        .faces = state->faces.data};
}

double repair_diagonal(const repair_state *state) {
    double lower[3], upper[3];
    starg_mesh_bounds(state->input, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

bool repair_has_no_area(const repair_state *state, const uint32_t corner[3]) {
    return collinear(repair_position(state, corner[0]), repair_position(state, corner[1]),
                     repair_position(state, corner[2]));
}

starg_status repair_add_vertex(repair_state *state, const double p[3], uint32_t origin,
                               uint32_t *vertex) {
    const double copy[3] = {p[0], p[1], p[2]}; /* p may point into the array that grows */
    for (int k = 0; k < 3; k++)
        PUSH(state->context, REPAIR_STAGE, &state->vertices, copy[k]);
    PUSH(state->context, REPAIR_STAGE, &state->origin, origin);
    *vertex = (uint32_t)(repair_vertex_count(state) - 1);
    return STARG_OK;
}

starg_status repair_add_face(repair_state *state, uint32_t a, uint32_t b, uint32_t c,
                             uint8_t flags) {
    PUSH(state->context, REPAIR_STAGE, &state->faces, a);
    PUSH(state->context, REPAIR_STAGE, &state->faces, b);
    PUSH(state->context, REPAIR_STAGE, &state->faces, c);
    PUSH(state->context, REPAIR_STAGE, &state->flags, flags);
    return STARG_OK;
}

void repair_turn(repair_state *state, size_t face) {
    uint32_t *corner = repair_face(state, face), swap = corner[1];
    corner[1] = corner[2];
    corner[2] = swap;
    state->flags.data[face] ^= REPAIR_TURNED;
}

void repair_compact(repair_state *state) {
    size_t kept = 0;
    for (size_t f = 0; f < repair_face_count(state); f++) {
        if (state->flags.data[f] & REPAIR_GONE)
            continue;
        memmove(repair_face(state, kept), repair_face(state, f), 3 * sizeof(uint32_t));
        state->flags.data[kept++] = state->flags.data[f];
    }
    state->flags.count = kept;
    state->faces.count = 3 * kept;
}

starg_status repair_drop_isolated(repair_state *state) {
    size_t count = repair_vertex_count(state), kept = 0;
    SCOPED uint32_t *place = NULL;
    NEW_ZERO(state->context, REPAIR_STAGE, place, count);
    for (size_t i = 0; i < state->faces.count; i++)
        place[state->faces.data[i]] = 1;
    for (size_t v = 0; v < count; v++) {
        if (place[v] == 0)
            continue;
        place[v] = (uint32_t)kept;
        memmove(state->vertices.data + 3 * kept, state->vertices.data + 3 * v, 3 * sizeof(double));
        state->origin.data[kept++] = state->origin.data[v];
    }
    for (size_t i = 0; i < state->faces.count; i++)
        state->faces.data[i] = place[state->faces.data[i]];
    state->origin.count = kept;
    state->vertices.count = 3 * kept;
    return STARG_OK;
}

starg_status repair_stars_create(const repair_state *state, repair_stars *stars) {
    size_t count = repair_vertex_count(state);
    *stars = (repair_stars){0};
    NEW_ZERO(state->context, REPAIR_STAGE, stars->start, count + 1);
    NEW(state->context, REPAIR_STAGE, stars->list, state->faces.count);
    for (size_t i = 0; i < state->faces.count; i++)
        stars->start[state->faces.data[i]]++;
    for (size_t v = 0; v < count; v++)
        stars->start[v + 1] += stars->start[v];
    /* start[v] is the end of v's range; filling backward moves it to the beginning */
    for (size_t i = state->faces.count; i-- > 0;)
        stars->list[--stars->start[state->faces.data[i]]] = (uint32_t)(i / 3);
    return STARG_OK;
}

void repair_stars_free(repair_stars *stars) {
    RELEASE(stars->start, stars->list);
}

/* The slot of a key, or the free slot for it. */
static uint64_t *find_slot(const repair_keys *keys, uint64_t key) {
    size_t mask = keys->size - 1;
    size_t i = (size_t)starg_hash64(key) & mask;
    while (keys->slots[i] != 0 && keys->slots[i] != key + 1)
        i = (i + 1) & mask;
    return &keys->slots[i];
}

static starg_status grow_keys(starg_context *context, repair_keys *keys) {
    repair_keys grown = {.size = keys->size ? 2 * keys->size : FIRST_KEYS, .count = keys->count};
    NEW_ZERO(context, REPAIR_STAGE, grown.slots, grown.size);
    for (size_t i = 0; i < keys->size; i++)
        if (keys->slots[i] != 0)
            *find_slot(&grown, keys->slots[i] - 1) = keys->slots[i];
    starg_release(context, keys->slots);
    *keys = grown;
    return STARG_OK;
}

starg_status repair_keys_add(starg_context *context, repair_keys *keys, uint64_t key) {
    if (2 * (keys->count + 1) > keys->size)
        TRY(grow_keys(context, keys));
    uint64_t *slot = find_slot(keys, key);
    keys->count += *slot == 0;
    *slot = key + 1;
    return STARG_OK;
}

bool repair_keys_have(const repair_keys *keys, uint64_t key) {
    return keys->size != 0 && *find_slot(keys, key) != 0;
}
