/* SPDX-License-Identifier: Apache-2.0 */
/* What the readers of tetrahedral meshes share: the builder that they feed, and numbers in text or
 * binary data. */
#ifndef STARG_TETRA_IO_H
#define STARG_TETRA_IO_H

#include "mesh/formats/scan.h"
#include "tetra/tetmesh.h"

/* A tetrahedral mesh under construction. All zero but points.source to begin with. */
typedef struct tet_builder {
    starg_mesh_builder points; /* its vertices, ticks and source; it gets no faces */
    STARG_ARRAY(uint32_t) tetrahedra;
    STARG_ARRAY(int32_t) regions; /* one per tetrahedron */
    double *corners;              /* twelve numbers per tetrahedron, or NULL */
} tet_builder;

/* Room for so many, which the caller has checked against the size of the source. */
starg_status tet_builder_reserve(tet_builder *builder, size_t vertices, size_t tetrahedra);

/* Appends a tetrahedron with indices from 0, which may name vertices that come later. `region` is
 * cut to 32 bits. Errors: FORMAT, MEMORY. */
starg_status tet_builder_add(tet_builder *builder, const int64_t corners[4], int64_t region,
                             starg_place place);

/* Refuses a solid cell that is no tetrahedron of four vertices. */
starg_status tet_builder_refuse(tet_builder *builder, const char *what, starg_place place);

static inline size_t tet_builder_count(const tet_builder *builder) {
    return builder->tetrahedra.count / 4;
}

/* Checks the indices and hands the mesh over. Errors: FORMAT, and those of starg_tetmesh_create. */
starg_status tet_builder_finish(tet_builder *builder, starg_tetmesh **out);
void tet_builder_free(tet_builder *builder);

/* ---- numbers in text or binary data ---- */

typedef enum tet_encoding { TET_TEXT, TET_LITTLE, TET_BIG } tet_encoding;
typedef enum tet_type { TET_INT32, TET_INT64, TET_FLOAT32, TET_FLOAT64, TET_INT8 } tet_type;

typedef struct tet_numbers {
    starg_scan scan; /* in binary data only its `at` is used, between lines of text all of it */
    tet_encoding encoding;
} tet_numbers;

starg_place tet_place(const tet_numbers *numbers);

/* The next number; in binary data of this type. `what` as in scan.h. Errors: FORMAT. */
starg_status tet_real(tet_numbers *numbers, tet_type type, const char *what, double *value);
starg_status tet_integer(tet_numbers *numbers, tet_type type, const char *what, int64_t *value);

/* Bytes that a number takes at least: in text one digit and a blank. */
size_t tet_least_bytes(const tet_numbers *numbers, tet_type type);

/* Fails unless 0 <= count and `count` items of `bytes` each fit into what is left. */
starg_status tet_check_count(const tet_numbers *numbers, int64_t count, size_t bytes,
                             const char *what);

/* ---- formats ---- */

bool tet_medit_matches(const starg_source *source);
bool tet_vtk_matches(const starg_source *source);
bool tet_gmsh_matches(const starg_source *source);
starg_status tet_medit_read(tet_builder *builder);
starg_status tet_vtk_read(tet_builder *builder);
starg_status tet_gmsh_read(tet_builder *builder);

/* TetGen's two files: the builder's source is the .node. */
starg_status tet_tetgen_read(tet_builder *builder, const starg_source *elements);

#endif
