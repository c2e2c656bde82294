/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers 64-bit keys in order of first insertion. */
#ifndef STARG_SAMPLE_KEY_MAP_H
#define STARG_SAMPLE_KEY_MAP_H

#include <stdbool.h>
#include <stdint.h>

#include "core/context.h"

/* All zero when empty. Open addressing over a power of two of slots, at most half full. */
typedef struct key_map {
    uint64_t *keys;    /* per slot */
    uint32_t *numbers; /* per slot; UINT32_MAX: free */
    size_t slots, count;
} key_map;

/* Sets *number to the number of `key`; a new key gets the number *count, and *added becomes true.
 * Errors: MEMORY. */
starg_status key_map_add(starg_context *context, key_map *map, uint64_t key, uint32_t *number,
                         bool *added);
/* The number of `key`, or UINT32_MAX. */
uint32_t key_map_find(const key_map *map, uint64_t key);
void key_map_free(starg_context *context, key_map *map);

#endif
