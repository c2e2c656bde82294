/* SPDX-License-Identifier: Apache-2.0 */
/* Simpler versions of a mesh: fewer vertices, the same topology, nearly the same shape. */
#ifndef STARGUARD_SIMPLIFY_H
#define STARGUARD_SIMPLIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where a vertex of no face went: it is not in the simplified mesh. */
#define STARG_NO_VERTEX UINT32_MAX

typedef struct starg_simplify_options {
    bool allow_intersections; /* do not look for new self-intersections: about four times as fast */
} starg_simplify_options;

/* No intersections allowed. */
STARG_API void starg_simplify_options_default(starg_simplify_options *options);

/* Collapses edges of a closed, oriented 2-manifold, the one of the least quadric error first
 * [Garland, Heckbert 1997], until `target_vertex_count` vertices are left or, which is no error,
 * no edge can be collapsed any more. The result is a closed, oriented 2-manifold with the same
 * components, each of the same genus (none gets smaller than a tetrahedron). Unless intersections
 * are allowed it is embedded if the input is; where the input meets itself, it stays as it is.
 * Vertices that are not moved keep their bits. The result is the same for any number of threads.
 *
 * `vertex_map` may be NULL, otherwise it is the caller's, with an entry per vertex of `mesh`: the
 * vertex of *out into which it has been merged, or STARG_NO_VERTEX if it has no face. Its contents
 * mean nothing on failure. `options` may be NULL. *out is NULL on failure.
 * Errors: MESH (no faces, or not a closed, oriented 2-manifold: with indices), MEMORY, CANCELLED,
 * TIME. Cost: O(n log n) for n vertices; about 400 bytes each. */
STARG_API starg_status starg_mesh_simplify(starg_context *context, const starg_mesh *mesh,
                                           size_t target_vertex_count,
                                           const starg_simplify_options *options,
                                           uint32_t *vertex_map, starg_mesh **out);

/* One level of detail. */
typedef struct starg_level {
    starg_mesh *mesh;
    uint32_t *vertex_map; /* per vertex of the next finer level its vertex of this one, or
                             STARG_NO_VERTEX; NULL for the finest                            */
} starg_level;

/* Levels of detail, the coarsest first; the last is a copy of the input. */
typedef struct starg_levels {
    size_t count;
    starg_level *levels;
} starg_levels;

/* As a step: each level has a quarter of the vertices of the next finer one, `coarsest` at least.
 */
#define STARG_QUARTERS (SIZE_MAX - 1)

/* Makes levels of about `coarsest`, `coarsest` + `step`, `coarsest` + 2 `step`, ... vertices, and
 * the input [YL11, section 3.3, with 5,000 and 10,000], or of a quarter of the input's vertices,
 * a sixteenth, ... (STARG_QUARTERS); every level is simplified further into the next coarser one. A
 * level that would be less than a quarter of a step smaller than the next finer one is left out,
 * also where the target cannot be reached; so there may be the input alone. Levels, meshes and maps
 * belong to the result. `options` and errors are those of starg_mesh_simplify, and ARGUMENT (step
 * is 0). */
STARG_API starg_status starg_mesh_levels(starg_context *context, const starg_mesh *mesh,
                                         size_t coarsest, size_t step,
                                         const starg_simplify_options *options, starg_levels **out);
/* Frees the levels with their meshes; NULL is fine. */
STARG_API void starg_levels_free(starg_context *context, starg_levels *levels);

#ifdef __cplusplus
}
#endif

#endif
