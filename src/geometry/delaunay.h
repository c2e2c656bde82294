/* SPDX-License-Identifier: Apache-2.0 */
/* Delaunay tetrahedra of a set of points. */
#pragma once

#include "core/memory.h"

typedef struct delaunay {
    starg_context *context;
    size_t count;
    uint32_t (*tetrahedra)[4]; /* point indices, orient3d = 1 */
    uint32_t (*neighbours)[4]; /* across the face opposite each point, or DELAUNAY_NONE */
} delaunay;

/* Marks the outside of a hull face. */
#define DELAUNAY_NONE UINT32_MAX

/* Points are count x 3. Coincident points count once. The result is empty when all are coplanar.
 * Ties among cospherical points depend only on input and seed. Errors: MEMORY, CANCELLED. */
starg_status delaunay_create(starg_context *context, const double *points, size_t count,
                             delaunay **out);
void delaunay_free(delaunay *tetrahedra);
STARG_DROP(delaunay, delaunay)

/* Same in steps, for callers that inspect the tetrahedra and add points. */
typedef struct delaunay_builder delaunay_builder;

starg_status delaunay_begin(starg_context *context, const double *points, size_t count,
                            delaunay_builder **out);
/* Inserts the points that follow those inserted before. `points` is the whole array and may have
 * moved. If the first call has no four points that span a tetrahedron, its points are skipped for
 * good. */
starg_status delaunay_extend(delaunay_builder *builder, const double *points, size_t count);

/* The tetrahedra at a point, by their other three corners; none if an earlier point has the same
 * position. *corners is valid until the next call. */
starg_status delaunay_star(delaunay_builder *builder, uint32_t point, uint32_t (**corners)[3],
                           size_t *count);

/* Have the tetrahedra at a point changed since the caller last asked? Creating or deleting a
 * tetrahedron changes all of its points. */
bool delaunay_has_changed(const delaunay_builder *builder, uint32_t point);
bool delaunay_take_change(delaunay_builder *builder, uint32_t point);

/* Copies a builder. The copy can be extended by the points of the first followed by its own.
 * Errors: MEMORY. */
starg_status delaunay_copy(const delaunay_builder *builder, delaunay_builder **out);

/* Copies the tetrahedra out; do not extend the builder afterwards. */
starg_status delaunay_finish(delaunay_builder *builder, delaunay **out);
void delaunay_builder_free(delaunay_builder *builder);
STARG_DROP(delaunay_builder, delaunay_builder)
