/* SPDX-License-Identifier: Apache-2.0 */
/* Disjoint sets: parent[i] is another member of the set of i, or i if it is the lowest one. */
#ifndef STARG_VERIFY_SETS_H
#define STARG_VERIFY_SETS_H

#include <stdint.h>

/* The lowest member of the set of i. */
static inline uint32_t verify_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void verify_join(uint32_t *parent, uint32_t i, uint32_t j) {
    uint32_t a = verify_root(parent, i), b = verify_root(parent, j);
    parent[a > b ? a : b] = a > b ? b : a;
}

#endif
