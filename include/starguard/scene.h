/* SPDX-License-Identifier: Apache-2.0 */
/* A model with results about it in one file for other programs: guards, pieces, skeleton. */
#ifndef STARGUARD_SCENE_H
#define STARGUARD_SCENE_H

#include "bits.h"
#include "context.h"
#include "guard.h"
#include "mesh.h"
#include "skeleton.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the file holds. Every part may be missing (NULL), not all of them. */
typedef struct starg_scene {
    const starg_mesh *model;
    const starg_guards *guards;
    const starg_bits
        *seen; /* with guards and model: a row for each guard, a column for each face */
    const starg_pieces_mesh *pieces;
    const starg_pieces_report *report; /* of the pieces */
    const starg_skeleton *skeleton;    /* positions, edges and radii count; radii may be NULL */
} starg_scene;

typedef enum starg_scene_format {
    STARG_SCENE_AUTO = 0, /* by name                                                            */
    STARG_SCENE_GLB = 1,  /* binary glTF 2.0: a named node for each guard and each piece        */
    STARG_SCENE_VTU = 2,  /* VTK unstructured grid: cells of all kinds, with their parts as data */
    STARG_SCENE_PLY = 3,  /* coloured faces, and edges                                          */
    STARG_SCENE_OBJ = 4   /* an object for the model, each guard, each piece, the skeleton      */
} starg_scene_format;

/* Writes a scene (docs/formats.md); path "-" is standard output, for which a format must be named.
 * A file appears whole or not at all; the same input gives the same bytes. With pieces, whose
 * surfaces hold the model's, the model stands in VTU only. Coordinates are doubles, in GLB single
 * precision about the middle of all.
 * Errors: ARGUMENT (no known file extension; nothing to write; parts that do not fit one another:
 * which), RANGE (GLB: a coordinate beyond single precision), MESH (GLB: over 4 GiB), WRITE, MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_scene_write(starg_context *context, const starg_scene *scene,
                                         const char *path, starg_scene_format format);

#ifdef __cplusplus
}
#endif

#endif
