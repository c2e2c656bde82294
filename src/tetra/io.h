/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the readers of tetrahedral meshes: the builder, and numbers in text or binary data. */
#ifndef STARG_TETRA_IO_H
#define STARG_TETRA_IO_H

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

/* ---- numbers in text or binary data ---- */

typedef enum tet_encoding { TET_TEXT, TET_LITTLE, TET_BIG } tet_encoding;
typedef enum tet_type { TET_INT32, TET_INT64, TET_FLOAT32, TET_FLOAT64, TET_INT8 } tet_type;

typedef struct tet_numbers {
    starg_scan scan; /* binary data uses only its `at`, text lines in between all of it */
    tet_encoding encoding;
} tet_numbers;

starg_place tet_place(const tet_numbers *numbers);

/* The next number, of this type in binary data. `what` as in scan.h. Errors: FORMAT. */
starg_status tet_real(tet_numbers *numbers, tet_type type, const char *what, double *value);
starg_status tet_integer(tet_numbers *numbers, tet_type type, const char *what, int64_t *value);

/* Smallest size of a number: in text one digit and a blank. */
size_t tet_least_bytes(const tet_numbers *numbers, tet_type type);

/* Fails unless 0 <= count and `count` items of `bytes` each fit into the rest of the file. */
starg_status tet_check_count(const tet_numbers *numbers, int64_t count, size_t bytes,
                             const char *what);

/* ---- formats ---- */

bool tet_medit_matches(const starg_source *source);
bool tet_vtk_matches(const starg_source *source);
bool tet_gmsh_matches(const starg_source *source);
starg_status tet_medit_read(tet_builder *builder);
starg_status tet_vtk_read(tet_builder *builder);
starg_status tet_gmsh_read(tet_builder *builder);

/* TetGen's two files: the builder's source is the .node file. */
starg_status tet_tetgen_read(tet_builder *builder, const starg_source *elements);

#endif
