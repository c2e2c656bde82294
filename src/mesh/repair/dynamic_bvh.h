/* SPDX-License-Identifier: Apache-2.0 */
/* Dynamic bounding volume hierarchy over the faces of a changing surface. */
#pragma once

#include "geometry/bvh.h"
#include "mesh/levels/surface.h"

typedef struct dynamic_bvh {
    starg_context *context;
    const mesh_surface *surface;
    size_t listed;     /* faces when the tree was built */
    bvh *tree;         /* over copies of these faces */
    uint32_t *corners; /* listed x 3, read by the tree */
    uint32_t *face;    /* leaf by leaf */
    uint32_t *leaf;    /* per face of the surface */
    uint32_t *parent;  /* per node; the root's is itself */
} dynamic_bvh;

/* The surface is borrowed. Errors: MEMORY. */
starg_status dynamic_bvh_create(starg_context *context, const mesh_surface *surface,
                                dynamic_bvh **out);
void dynamic_bvh_free(dynamic_bvh *tree);
STARG_DROP(dynamic_bvh, dynamic_bvh)

/* Updates the tree after a face has moved. */
void dynamic_bvh_update(dynamic_bvh *tree, uint32_t face);
/* Takes a face out that a collapse is about to remove. */
void dynamic_bvh_remove(dynamic_bvh *tree, uint32_t face);
/* Rebuilds the tree once half of its faces are dead. Errors: MEMORY. */
starg_status dynamic_bvh_renew(dynamic_bvh *tree);

/* Calls visit for every living face whose box meets `box`, until it returns false. Returns false
 * exactly if visit did. */
bool dynamic_bvh_query(const dynamic_bvh *tree, const bvh_box *box, bvh_visit *visit, void *user);

static inline bvh_box dynamic_bvh_face_box(const mesh_surface *surface, const uint32_t corner[3]) {
    bvh_box box;
    const double *a = surface_at(surface, corner[0]), *b = surface_at(surface, corner[1]);
    const double *c = surface_at(surface, corner[2]);
    for (int k = 0; k < 3; k++) {
        double low = a[k] < b[k] ? a[k] : b[k], high = a[k] < b[k] ? b[k] : a[k];
        box.lower[k] = low < c[k] ? low : c[k];
        box.upper[k] = high > c[k] ? high : c[k];
    }
    return box;
}
