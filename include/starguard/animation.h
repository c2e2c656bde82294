/* SPDX-License-Identifier: Apache-2.0 */
/* Animation files: meshes with moving vertices. */
#ifndef STARGUARD_ANIMATION_H
#define STARGUARD_ANIMATION_H

#include <stddef.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Maximum number of frames of an animation. */
enum { STARG_ANIMATION_FRAMES = 1000 };

/* Writes a binary glTF 2.0 file: `mesh` with an animation of `seconds` through frame_count shapes
 * (each vertex_count x 3 doubles) in equal steps. The first frame is the mesh itself; the others
 * are morph targets. Positions are stored in single precision relative to the centre of the
 * bounding box, which the node's translation adds. Path "-" is standard output. Errors: ARGUMENT
 * (fewer than 2 frames or too many, seconds not positive), RANGE (a coordinate exceeds single
 * precision), MESH (no faces, or over 4 GiB), WRITE, MEMORY. */
STARG_API starg_status starg_animation_write(starg_context *context, const starg_mesh *mesh,
                                             const double *const *frames, size_t frame_count,
                                             double seconds, const char *path);

/* Reads the frames of such a file (binary glTF of one mesh with morph targets): *count meshes with
 * the same faces. Free with starg_animation_free. Errors: READ, FORMAT, RANGE, ARGUMENT (an index
 * out of range), MEMORY, CANCELLED. */
STARG_API starg_status starg_animation_read(starg_context *context, const char *path,
                                            starg_mesh ***frames, size_t *count);
/* The same from `size` bytes in memory; `name` is used in messages. */
STARG_API starg_status starg_animation_read_memory(starg_context *context, const void *bytes,
                                                   size_t size, const char *name,
                                                   starg_mesh ***frames, size_t *count);
STARG_API void starg_animation_free(starg_context *context, starg_mesh **frames, size_t count);

#ifdef __cplusplus
}
#endif

#endif
