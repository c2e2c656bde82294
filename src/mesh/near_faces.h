/* SPDX-License-Identifier: Apache-2.0 */
/* Guards that are bound to faces of the model (mesh/near_faces.c). */
#ifndef STARG_MESH_NEAR_FACES_H
#define STARG_MESH_NEAR_FACES_H

#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "starguard/space.h"

/* Some faces of a model; all zero: none. */
typedef struct near_faces {
    size_t count;
    uint32_t *list, *corners;
    bvh *tree; /* triangle i is that of `corners` at 3 i */
} near_faces;

/* Errors: ARGUMENT. */
starg_status near_faces_check(starg_context *context, const starg_space_options *options,
                              size_t faces);

/* Of a model whose vertices are the first of `vertices`, which must outlive them. Errors: MEMORY.
 */
starg_status near_faces_make(starg_context *context, const starg_mesh *model,
                             const double *vertices, const uint32_t *list, size_t count,
                             near_faces *out);
void near_faces_free(starg_context *context, near_faces *faces);

/* What is up, as a unit vector. */
void near_faces_up(const starg_space_options *options, double up[3]);

/* May a guard stand at p, as far as these faces are concerned? */
bool near_faces_admit(const near_faces *over, const near_faces *mount,
                      const starg_space_options *options, const double p[3]);

/* Is it certain that none may stand in the box? */
bool near_faces_bar(const near_faces *over, const near_faces *mount,
                    const starg_space_options *options, const bvh_box *box);

/* A box that holds all places where one may; false: there are no such faces. */
bool near_faces_box(const near_faces *over, const near_faces *mount,
                    const starg_space_options *options, bvh_box *out);

#endif
