/* SPDX-License-Identifier: Apache-2.0 */
/* How the boundary of a solid hangs together, in slots and ranks of its scene: edges, the faces
 * about each vertex, and what trees along edges can be made of. Immutable once made. */
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
    adjacency_edge *edges; /* by the lower slot of their ends: near in memory is near in space */
    /* The neighbours of a slot in counter-clockwise order seen from outside, and in the same places
     * the ranks of the faces between each and the next one. */
    uint32_t *fan_start;            /* slot -> its first place; one more than there are slots */
    uint32_t *neighbour, *fan_face; /* FAN places more */
    uint32_t *parents; /* slot x CHOICES -> neighbours that come before it in the order, the nearest
                          first and the last repeated; or itself for the root of a shell */
    uint32_t *first_face; /* slot -> one of its faces */
    uint32_t *order;      /* slots, shell by shell */
    size_t shell_count;
    uint32_t *shell_start; /* shell -> its first place in order, its root; and the end */
} visibility_adjacency;

/* Every vertex and edge must be manifold, as those of a solid are. O(n). Errors: MEMORY. */
starg_status adjacency_create(starg_context *context, const visibility_scene *scene,
                              visibility_adjacency **out);
void adjacency_free(visibility_adjacency *adjacency);

#endif
