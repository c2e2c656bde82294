/* Delaunay tetrahedra of a set of points. */
#ifndef STARG_GEOMETRY_DELAUNAY_H
#define STARG_GEOMETRY_DELAUNAY_H

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

#endif
