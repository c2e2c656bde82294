/* Which faces of a changing surface are near? A tree whose boxes grow with the faces. */
#ifndef STARG_MESH_NEARBY_H
#define STARG_MESH_NEARBY_H

#include "geometry/bvh.h"
#include "mesh/surface.h"

typedef struct mesh_nearby {
    starg_context *context;
    const mesh_surface *surface;
    size_t listed;     /* faces when the tree was built  */
    bvh *tree;         /* over copies of those           */
    uint32_t *corners; /* listed x 3, what the tree read */
    uint32_t *face;    /* per triangle of the tree       */
    uint32_t *leaf;    /* per face of the surface        */
    uint32_t *parent;  /* per node; the root's is itself */
} mesh_nearby;

/* The surface is borrowed. Errors: MEMORY. */
starg_status nearby_create(starg_context *context, const mesh_surface *surface, mesh_nearby **out);
void nearby_free(mesh_nearby *nearby);

/* Tells that a face has moved. */
void nearby_update(mesh_nearby *nearby, uint32_t face);
/* Builds the tree anew once half of its faces are gone. Errors: MEMORY. */
starg_status nearby_renew(mesh_nearby *nearby);

/* Calls visit for every living face whose box meets `box`, until it returns false. Returns false
 * exactly if visit did. */
bool nearby_query(const mesh_nearby *nearby, const bvh_box *box, bvh_visit *visit, void *user);

bvh_box nearby_face_box(const mesh_surface *surface, const uint32_t corner[3]);
bool nearby_boxes_meet(const bvh_box *a, const bvh_box *b);

#endif
