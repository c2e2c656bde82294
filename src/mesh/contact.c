/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/topology.h"

#include <string.h>

/* Swaps corner i of the triple with corner k. */
static void bring_to(uint32_t triple[3], int i, int k) {
    uint32_t swap = triple[i];
    triple[i] = triple[k];
    triple[k] = swap;
}

/* Moves the common corners to the front of both, in the same order; returns their number. */
static int align_shared(uint32_t u[3], uint32_t v[3]) {
    int shared = 0;
    for (int i = 0; i < 3; i++)
        for (int j = shared; j < 3; j++)
            if (u[i] == v[j]) {
                bring_to(u, i, shared);
                bring_to(v, j, shared);
                shared++;
                break;
            }
    return shared;
}

triangle_contact faces_contact(const double *vertices, const uint32_t a[3], const uint32_t b[3]) {
    uint32_t u[3], v[3];
    const double *s[3], *t[3];
    memcpy(u, a, sizeof u);
    memcpy(v, b, sizeof v);
    int shared = align_shared(u, v);
    for (int k = 0; k < 3; k++) {
        s[k] = vertices + 3 * (size_t)u[k];
        t[k] = vertices + 3 * (size_t)v[k];
    }
    return triangles_contact(s, t, shared);
}
