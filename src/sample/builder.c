/* SPDX-License-Identifier: Apache-2.0 */
#include "sample/solids.h"

#include "core/rng.h"

static const char STAGE[] = "sample";

enum { FIRST_SLOTS = 1024 };

/* The slot of `key`, or the free slot for it. */
static size_t find_slot(const key_map *map, uint64_t key) {
    size_t mask = map->slots - 1, slot = starg_hash64(key) & mask;
    while (map->numbers[slot] != UINT32_MAX && map->keys[slot] != key)
        slot = (slot + 1) & mask;
    return slot;
}

static starg_status grow(starg_context *context, key_map *map) {
    starg_status status = STARG_OK;
    key_map larger = {.slots = map->slots ? 2 * map->slots : FIRST_SLOTS, .count = map->count};
    STARG_NEW(context, STAGE, larger.keys, larger.slots);
    STARG_NEW(context, STAGE, larger.numbers, larger.slots);
    memset(larger.numbers, 0xff, larger.slots * sizeof *larger.numbers);
    for (size_t i = 0; i < map->slots; i++) {
        if (map->numbers[i] == UINT32_MAX)
            continue;
        size_t slot = find_slot(&larger, map->keys[i]);
        larger.keys[slot] = map->keys[i];
        larger.numbers[slot] = map->numbers[i];
    }
    key_map_free(map);
    *map = larger;
done:
    if (status != STARG_OK)
        key_map_free(&larger);
    return status;
}

starg_status key_map_add(starg_context *context, key_map *map, uint64_t key, uint32_t *number,
                         bool *added) {
    if (2 * map->count >= map->slots) {
        TRY(grow(context, map));
    }
    size_t slot = find_slot(map, key);
    *added = map->numbers[slot] == UINT32_MAX;
    if (*added) {
        map->keys[slot] = key;
        map->numbers[slot] = (uint32_t)map->count++;
    }
    *number = map->numbers[slot];
    return STARG_OK;
}

uint32_t key_map_find(const key_map *map, uint64_t key) {
    return map->slots == 0 ? UINT32_MAX : map->numbers[find_slot(map, key)];
}

void key_map_free(key_map *map) {
    RELEASE(map->keys, map->numbers);
    *map = (key_map){0};
}

starg_status builder_vertex(mesh_builder *builder, uint64_t key, const double position[3],
                            uint32_t *vertex) {
    bool added = false;
    TRY(key_map_add(builder->context, &builder->names, key, vertex, &added));
    if (added)
        for (int k = 0; k < 3; k++)
            PUSH(builder->context, STAGE, &builder->positions, position[k]);
    return STARG_OK;
}

starg_status builder_triangle(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c) {
    PUSH(builder->context, STAGE, &builder->faces, a);
    PUSH(builder->context, STAGE, &builder->faces, b);
    PUSH(builder->context, STAGE, &builder->faces, c);
    return STARG_OK;
}

starg_status builder_quad(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    starg_status status = builder_triangle(builder, a, b, c);
    return status != STARG_OK ? status : builder_triangle(builder, a, c, d);
}

starg_status builder_finish(mesh_builder *builder, starg_mesh **out) {
    return starg_mesh_create(builder->context, builder->positions.data,
                             builder->positions.count / 3, builder->faces.data,
                             builder->faces.count / 3, out);
}

void builder_free(mesh_builder *builder) {
    key_map_free(&builder->names);
    RELEASE(builder->positions.data, builder->faces.data);
    *builder = (mesh_builder){.context = builder->context};
}
