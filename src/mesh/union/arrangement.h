/* SPDX-License-Identifier: Apache-2.0 */
/* A surface cut along all its intersections: a complex of triangles with exact corners. */
#ifndef STARG_MESH_UNION_ARRANGEMENT_H
#define STARG_MESH_UNION_ARRANGEMENT_H

#include "mesh/union/contacts.h"

typedef struct union_triangle {
    uint32_t corner[3]; /* a vertex of the surface, or vertex count + index into `added`       */
    uint32_t face;      /* a face of the surface that holds it                                 */
    int layers;         /* faces on it that turn as it does, minus those that do not: above 0  */
    bool whole;         /* it is that face                                                     */
} union_triangle;

/* Triangles meet in common corners and edges only. */
typedef struct union_complex {
    starg_context *context;
    const union_surface *surface;
    exact_points points;
    STARG_ARRAY(union_triangle) triangles;
    STARG_ARRAY(uint32_t) added; /* points that are no vertices of the surface */
    STARG_ARRAY(uint32_t) name;  /* per point: as `corner` calls it            */
} union_complex;

/* Cuts a surface with these contacts, whose ends it fills in. Errors: RANGE, MEMORY, CANCELLED. */
starg_status union_arrange(const union_surface *surface, union_contacts *contacts,
                           union_complex *out);
void union_complex_free(union_complex *complex);

/* The exact place of a corner. */
void union_complex_place(const union_complex *complex, uint32_t corner, exact_point *out);
const double *union_complex_rounded(const union_complex *complex, uint32_t corner);

#endif
