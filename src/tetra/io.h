/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the readers of tetrahedral meshes: the builder, and numbers in text or binary data. */
#pragma once

#include "mesh/formats/scan.h"
#include "tetra/tetmesh.h"

/* A tetrahedral mesh under construction. Zero-initialize all but points.source. */
typedef struct tet_builder {
    starg_mesh_builder points; /* vertices, ticks and source; has no faces */
    STARG_ARRAY(uint32_t) tetrahedra;
    STARG_ARRAY(int32_t) regions; /* one per tetrahedron */
    double *corners;              /* twelve numbers per tetrahedron, or NULL */
    bool labelled;                /* the file gives the regions */
} tet_builder;

/* Reserves space; the caller has checked the numbers against the size of the source. */
starg_status tet_builder_reserve(tet_builder *builder, size_t vertices, size_t tetrahedra);

/* Appends a tetrahedron with indices from 0, which may refer to later vertices. `region` is
 * truncated to 32 bits. Errors: FORMAT, MEMORY. */
starg_status tet_builder_add(tet_builder *builder, const int64_t corners[4], int64_t region,
                             starg_place place);

/* Rejects a solid cell that is not a 4-node tetrahedron. */
starg_status tet_builder_refuse(tet_builder *builder, const char *what, starg_place place);

static inline size_t tet_builder_count(const tet_builder *builder) {
    return builder->tetrahedra.count / 4;
}

/* Is there a tetrahedron, and are all of their vertices there? Errors: FORMAT. */
starg_status tet_builder_check(const tet_builder *builder);

/* The same, and returns the mesh. Errors: FORMAT, and those of starg_tetmesh_create. */
starg_status tet_builder_finish(tet_builder *builder, starg_tetmesh **out);
void tet_builder_free(tet_builder *builder);

/* ---- formats (a file for each) ---- */

bool tet_medit_matches(const starg_source *source);
bool tet_vtk_matches(const starg_source *source);
/* A surface, which mesh/formats/read_vtk.c reads. */
bool tet_vtk_is_surface(const starg_source *source);
bool tet_gmsh_matches(const starg_source *source);
starg_status tet_medit_read(tet_builder *builder);
starg_status tet_vtk_read(tet_builder *builder);
starg_status tet_gmsh_read(tet_builder *builder);

/* TetGen's two files: the builder's source is the .node file. */
starg_status tet_tetgen_read(tet_builder *builder, const starg_source *elements);
