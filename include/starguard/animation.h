/* SPDX-License-Identifier: Apache-2.0 */
/* Animated files of a mesh whose vertices move. */
#ifndef STARGUARD_ANIMATION_H
#define STARGUARD_ANIMATION_H

#include <stddef.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Most frames of an animation. */
enum { STARG_ANIMATION_FRAMES = 1000 };

/* Writes a binary glTF 2.0 file: `mesh`, and an animation of `seconds` through frame_count shapes
 * (each vertex_count x 3 doubles) in equal steps, of which the first is the mesh's own; each other
 * is a morph target. Positions are in single precision about the middle of the mesh's box, which
 * the node's translation adds. Path "-" is standard output.
 * Errors: ARGUMENT (fewer than 2 frames or too many, seconds not positive), RANGE (a coordinate
 * beyond single precision), MESH (no faces, or over 4 GiB), WRITE, MEMORY. */
STARG_API starg_status starg_animation_write(starg_context *context, const starg_mesh *mesh,
                                             const double *const *frames, size_t frame_count,
                                             double seconds, const char *path);

/* Reads the frames of such a file (binary glTF of one mesh with morph targets): *count meshes of
 * the same faces, to be freed with starg_animation_free. Errors: READ, FORMAT, RANGE, ARGUMENT (an
 * index out of range), MEMORY, CANCELLED. */
STARG_API starg_status starg_animation_read(starg_context *context, const char *path,
                                            starg_mesh ***frames, size_t *count);
/* The same from `size` bytes in memory; `name` stands in messages. */
STARG_API starg_status starg_animation_read_memory(starg_context *context, const void *bytes,
                                                   size_t size, const char *name,
                                                   starg_mesh ***frames, size_t *count);
STARG_API void starg_animation_free(starg_context *context, starg_mesh **frames, size_t count);

#ifdef __cplusplus
}
#endif

#endif
