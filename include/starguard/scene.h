/* SPDX-License-Identifier: Apache-2.0 */
/* Exports a model with guards, pieces and skeleton for other programs. */
#ifndef STARGUARD_SCENE_H
#define STARGUARD_SCENE_H

#include "bits.h"
#include "context.h"
#include "guard.h"
#include "mesh.h"
#include "skeleton.h"
#include "space.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Contents of a scene. Parts may be NULL, but not all. */
typedef struct starg_scene {
    const starg_mesh *model;
    const starg_mesh *obstacles; /* all that stand in the way, in one mesh */
    const starg_guards *guards;
    const starg_bits *seen; /* with guards and model: one row per guard, one column per face */
    const starg_pieces_mesh *pieces;
    const starg_pieces_report *report; /* of the pieces */
    const starg_skeleton *skeleton;    /* uses positions, edges and radii; radii may be NULL */
    const starg_face_groups *groups;   /* of the model: nodes of a GLB; NULL: none */
} starg_scene;

typedef enum starg_scene_format {
    STARG_SCENE_AUTO = 0, /* by name                                                            */
    STARG_SCENE_GLB = 1,  /* binary glTF 2.0: one named node per guard and piece */
    STARG_SCENE_VTU = 2,  /* VTK unstructured grid with parts as cell data */
    STARG_SCENE_PLY = 3,  /* coloured faces, and edges                                          */
    STARG_SCENE_OBJ = 4,  /* one object each for model, guards, pieces, skeleton */
    STARG_SCENE_3MF = 5   /* an object for each piece, or the model, for printing; nothing else */
} starg_scene_format;

/* Writes a scene (docs/formats.md); path "-" is standard output and needs a format. The file is
 * written completely or not at all; the same input gives the same bytes. If there are pieces, whose
 * surfaces include the model's, only VTU contains the model. Coordinates are doubles; GLB stores
 * single precision relative to the common centre. Errors: ARGUMENT (unknown file extension; no
 * content; inconsistent parts), RANGE (GLB: a coordinate exceeds single precision), MESH (GLB, 3MF:
 * over 4 GiB), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_scene_write(starg_context *context, const starg_scene *scene,
                                         const char *path, starg_scene_format format);

#ifdef __cplusplus
}
#endif

#endif
