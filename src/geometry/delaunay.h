/* SPDX-License-Identifier: Apache-2.0 */
/* Delaunay tetrahedra of a set of points. */
#ifndef STARG_GEOMETRY_DELAUNAY_H
#define STARG_GEOMETRY_DELAUNAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/context.h"

typedef struct delaunay {
    starg_context *context;
    size_t count;
    uint32_t (*tetrahedra)[4]; /* indices of points, orient3d = 1 */
    uint32_t (*neighbours)[4]; /* across the face opposite each point, or DELAUNAY_NONE */
} delaunay;

/* What lies beyond a face of the hull. */
#define DELAUNAY_NONE UINT32_MAX

/* Points are count x 3. Points at equal positions count once. The result is empty when all lie in
 * one plane. Among cospherical points one of the valid choices is made, always the same for the
 * same input and seed. Errors: MEMORY, CANCELLED. */
starg_status delaunay_create(starg_context *context, const double *points, size_t count,
                             delaunay **out);
void delaunay_free(delaunay *tetrahedra);

/* The same in steps, for callers that look at the tetrahedra and then add points. */
typedef struct delaunay_builder delaunay_builder;

starg_status delaunay_begin(starg_context *context, const double *points, size_t count,
                            delaunay_builder **out);
/* Adds the points behind those that were inserted before. `points` is the whole array, which may
 * have moved. Points that span no tetrahedron in the first call are skipped for good. */
starg_status delaunay_extend(delaunay_builder *builder, const double *points, size_t count);

/* The tetrahedra at a point, by their other three corners; none at a point that lies where an
 * earlier one does. *corners is valid until the next call. */
starg_status delaunay_star(delaunay_builder *builder, uint32_t point, uint32_t (**corners)[3],
                           size_t *count);

/* Have the tetrahedra at a point changed since their change was last taken? A tetrahedron that goes
 * or comes changes those at all of its points. */
bool delaunay_has_changed(const delaunay_builder *builder, uint32_t point);
bool delaunay_take_change(delaunay_builder *builder, uint32_t point);

/* A second builder in the same state. It needs no points before it is extended, and then those of
 * the first and its own behind them. Errors: MEMORY. */
starg_status delaunay_copy(const delaunay_builder *builder, delaunay_builder **out);

/* Copies the tetrahedra out; the builder must not be extended after that. */
starg_status delaunay_finish(delaunay_builder *builder, delaunay **out);
void delaunay_builder_free(delaunay_builder *builder);

#endif
