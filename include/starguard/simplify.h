/* SPDX-License-Identifier: Apache-2.0 */
/* Mesh simplification that preserves topology. */
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

/* Marks vertices without faces, which simplification drops. */
#define STARG_NO_VERTEX UINT32_MAX

typedef struct starg_simplify_options {
    bool allow_intersections; /* skip the test for new self-intersections: about four times as fast
                               */
} starg_simplify_options;

/* No intersections allowed. */
STARG_API void starg_simplify_options_default(starg_simplify_options *options);

/* Collapses edges of a closed, oriented 2-manifold in order of quadric error [Garland, Heckbert
 * 1997] until `target_vertex_count` vertices are left or no edge can be collapsed, which is not an
 * error. The result is a closed, oriented 2-manifold with the same components, each of the same
 * genus and at least a tetrahedron. Unless intersections are allowed, the result is embedded if the
 * input is; self-intersections of the input are kept. Vertices that do not move keep their bits.
 * The result does not depend on the number of threads.
 *
 * `vertex_map` is NULL or the caller's array with one entry per vertex of `mesh`: the vertex of
 * *out into which it was merged, or STARG_NO_VERTEX if it has no face. Its contents are undefined
 * on failure. `options` may be NULL. *out is NULL on failure. Errors: MESH (no faces, or not a
 * closed, oriented 2-manifold: with indices), MEMORY, CANCELLED, TIME. Cost: O(n log n) for n
 * vertices, about 400 bytes each. */
STARG_API starg_status starg_mesh_simplify(starg_context *context, const starg_mesh *mesh,
                                           size_t target_vertex_count,
                                           const starg_simplify_options *options,
                                           uint32_t *vertex_map, starg_mesh **out);

/* One level of detail. */
typedef struct starg_level {
    starg_mesh *mesh;
    uint32_t *vertex_map; /* per vertex of the next finer level, its vertex in this one, or
                             STARG_NO_VERTEX; NULL for the finest */
} starg_level;

/* Levels of detail, coarsest first; the last is a copy of the input. */
typedef struct starg_levels {
    size_t count;
    starg_level *levels;
} starg_levels;

/* As a step: each level has a quarter of the vertices of the next finer one, but at least
 * `coarsest`. */
#define STARG_QUARTERS (SIZE_MAX - 1)

/* Computes levels with about `coarsest`, `coarsest` + `step`, `coarsest` + 2 `step`, ... vertices,
 * and the input [YL11, section 3.3, with 5,000 and 10,000], or with a quarter of the input's
 * vertices, a sixteenth, ... (STARG_QUARTERS). Each level is simplified into the next coarser one.
 * A level that is less than a quarter of a step smaller than the next finer one is omitted, so
 * there may be only the input. The result owns levels, meshes and maps. `options` and errors as for
 * starg_mesh_simplify, and ARGUMENT (step is 0). */
STARG_API starg_status starg_mesh_levels(starg_context *context, const starg_mesh *mesh,
                                         size_t coarsest, size_t step,
                                         const starg_simplify_options *options, starg_levels **out);
/* Frees the levels with their meshes; NULL is allowed. */
STARG_API void starg_levels_free(starg_context *context, starg_levels *levels);

#ifdef __cplusplus
}
#endif

#endif
