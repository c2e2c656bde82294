/* SPDX-License-Identifier: Apache-2.0 */
/* Adjacency of the boundary of a solid, in slots and ranks of its scene: edges, the faces at each
 * vertex, and candidate parents for trees along edges. Immutable once made. */
#ifndef STARG_VISIBILITY_ADJACENCY_H
#define STARG_VISIBILITY_ADJACENCY_H

#include "visibility/scene.h"

enum { FAN = 8, CHOICES = 3 };

/* An edge runs from a to b in the face `left`, and back in `right`. */
typedef struct adjacency_edge {
    uint32_t left, right, a, b;
} adjacency_edge;

typedef struct visibility_adjacency {
    starg_context *context;
    size_t edge_count;
    adjacency_edge *edges; /* sorted by the lower slot of their ends, for memory locality */
    /* The neighbours of a slot in counter-clockwise order seen from outside, and at the same
     * positions the ranks of the faces between each and the next one. */
    uint32_t *fan_start;            /* slot -> its first position; one more entry than slots */
    uint32_t *neighbour, *fan_face; /* FAN entries more */
    uint32_t *parents;    /* slot x CHOICES -> neighbours that come before it in the order, nearest
                             first, the last repeated; or itself for the root of a shell */
    uint32_t *first_face; /* slot -> one of its faces */
    uint32_t *order;      /* slots, shell by shell */
    size_t shell_count;
    uint32_t *shell_start; /* shell -> its first position in order, its root; and the end */
} visibility_adjacency;

/* Every vertex and edge must be manifold, as those of a solid are. O(n). Errors: MEMORY. */
starg_status adjacency_create(starg_context *context, const visibility_scene *scene,
                              visibility_adjacency **out);
void adjacency_free(visibility_adjacency *adjacency);
STARG_DROP(adjacency, visibility_adjacency)

#endif
