/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedral meshes: checked, positively oriented, with neighbours; readers, writers and
 * generators. */
#ifndef STARGUARD_TETRA_H
#define STARGUARD_TETRA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "solid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A conforming tetrahedral mesh. Every tetrahedron (a, b, c, d) is positive: det(b - a, c - a, d -
 * a) > 0, exactly. Two tetrahedra share a vertex, an edge, a face or nothing: their interiors do
 * not overlap. Unused vertices are kept. */
typedef struct starg_tetmesh starg_tetmesh;

/* The neighbour across a boundary face. */
#define STARG_TETMESH_NONE UINT32_MAX

/* Copies the arrays: `vertices` is vertex_count x 3, `tetrahedra` is tetrahedron_count x 4 indices,
 * `regions` is NULL or a label per tetrahedron (stored only). Negative tetrahedra are reoriented by
 * swapping their last two vertices, with a notice. Errors: ARGUMENT (no tetrahedra, an index out of
 * range, more than 2^29), RANGE, MESH (zero volume; a face with more than two tetrahedra, or two on
 * the same side; overlapping tetrahedra: with their indices), MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_create(starg_context *context, const double *vertices,
                                            size_t vertex_count, const uint32_t *tetrahedra,
                                            size_t tetrahedron_count, const int32_t *regions,
                                            starg_tetmesh **out);
STARG_API void starg_tetmesh_free(starg_tetmesh *mesh);

STARG_API size_t starg_tetmesh_vertex_count(const starg_tetmesh *mesh);
STARG_API size_t starg_tetmesh_count(const starg_tetmesh *mesh);
/* All owned by the mesh: vertex_count x 3; count x 4; count x 4 neighbours across the face opposite
 * each vertex, or STARG_TETMESH_NONE; count labels, or NULL if there are none. */
STARG_API const double *starg_tetmesh_vertices(const starg_tetmesh *mesh);
STARG_API const uint32_t *starg_tetmesh_tetrahedra(const starg_tetmesh *mesh);
STARG_API const uint32_t *starg_tetmesh_neighbours(const starg_tetmesh *mesh);
STARG_API const int32_t *starg_tetmesh_regions(const starg_tetmesh *mesh);

/* Number of reoriented tetrahedra. */
STARG_API size_t starg_tetmesh_turned(const starg_tetmesh *mesh);
/* Sum of the volumes. */
STARG_API double starg_tetmesh_volume(const starg_tetmesh *mesh);

/* The outward oriented boundary. Its vertices are those of the boundary faces, in the order of the
 * mesh; `vertex_map` is NULL or receives their indices in the mesh (free with
 * starg_tetmesh_map_free). Errors: MEMORY. */
STARG_API starg_status starg_tetmesh_surface(starg_context *context, const starg_tetmesh *mesh,
                                             starg_mesh **out, uint32_t **vertex_map);
STARG_API void starg_tetmesh_map_free(starg_context *context, uint32_t *vertex_map);

/* ---- generators ---- */

typedef enum starg_tetra_generator {
    STARG_TETRA_AUTO = 0,    /* stuffing, with a warning that it approximates the surface */
    STARG_TETRA_TETGEN = 1,  /* the program tetgen: preserves the surface, or fails */
    STARG_TETRA_STUFFING = 2 /* isosurface stuffing: any solid, dihedral angles from 10.7 to 164.8
                                degrees, approximates the surface */
} starg_tetra_generator;

typedef struct starg_tetra_options {
    starg_tetra_generator generator;
    double density; /* target number of tetrahedra per surface vertex (default 17.5, as in [YL11]);
                       0: as few as possible with TetGen, else 17.5 */
    size_t target;  /* target number of tetrahedra; above 0 it replaces density */
    const char *tetgen;  /* path of the program; NULL: "tetgen" on the search path */
    double tetgen_limit; /* its limit in seconds of processor time (default 30) */
} starg_tetra_options;

STARG_API void starg_tetra_options_default(starg_tetra_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_tetra_options_fields(void);

/* How a mesh was generated. */
typedef struct starg_tetra_report {
    starg_tetra_generator generator; /* TETGEN or STUFFING */
    bool surface_kept; /* the boundary is the solid's surface, face by face          */
    double spacing;    /* lattice spacing; 0 without a lattice */
    /* Largest sampled distances from the boundary to the solid's surface, and back; sample points
     * are at most `step` apart, so that true distances exceed these by at most `step`. All 0 if the
     * surface was preserved. */
    double to_surface, from_surface, step;
    /* With `step` added: upper bounds on the distance from the boundary to the solid's surface, and
     * back. */
    double distance, distance_back;
} starg_tetra_report;

/* Fills a solid with tetrahedra. If the surface is preserved, the solid's vertices used by faces
 * come first, in order. `options` and `report` may be NULL. The program runs in a private temporary
 * folder (in TMPDIR or /tmp), which is removed. Errors: ARGUMENT, SOLVER (TETGEN: why it failed;
 * else a solid so thin that it contains no lattice point), MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_from_solid(starg_context *context, const starg_solid *solid,
                                                const starg_tetra_options *options,
                                                starg_tetra_report *report, starg_tetmesh **out);

/* Fills the region where the generalized winding number of a mesh with holes exceeds 1/2. Always
 * uses stuffing: generator and tetgen of the options are ignored. `to_surface` indicates the size
 * of the holes. Errors: ARGUMENT, MESH (no faces, or planar), SOLVER, MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_from_open_mesh(starg_context *context, const starg_mesh *mesh,
                                                    const starg_tetra_options *options,
                                                    starg_tetra_report *report,
                                                    starg_tetmesh **out);

/* ---- files ---- */

/* Reads MEDIT .mesh (text), legacy VTK unstructured grids (text and binary, versions 1 to 5), Gmsh
 * .msh versions 2 and 4.1 (text and binary), or TetGen's .node with the .ele beside it (either
 * name). The format is recognized by content (TetGen: by name). Points, edges, triangles and
 * quadrilaterals are skipped; solid cells other than four-vertex tetrahedra are rejected. Labels
 * are the reference of MEDIT, the first integer cell array of VTK, the first tag of Gmsh 2
 * (physical group), the entity of Gmsh 4, or the first attribute of TetGen; they are kept unless
 * all are equal. Errors: READ, FORMAT, RANGE, MEMORY, CANCELLED, and those of starg_tetmesh_create.
 */
STARG_API starg_status starg_tetmesh_read(starg_context *context, const char *path,
                                          starg_tetmesh **out);
/* The same from memory, without TetGen's pair of files; `name` is used in messages. */
STARG_API starg_status starg_tetmesh_read_memory(starg_context *context, const void *bytes,
                                                 size_t size, const char *name,
                                                 starg_tetmesh **out);

/* Whether the content (for TetGen's files, the name) is that of a tetrahedral mesh. */
STARG_API bool starg_tetmesh_recognized(const void *bytes, size_t size, const char *name);

typedef struct starg_tetmesh_write_options {
    bool binary;           /* default: text                                              */
    const int32_t *labels; /* one per tetrahedron, or NULL: the mesh's own, if it has any */
    const char *name;      /* of the labels, one word; default "piece"                   */
    const double *corners; /* count x 4 x 3: a point for each corner of each tetrahedron, or NULL;
                              written as an array "ball" of 12 numbers a cell, behind labels */
} starg_tetmesh_write_options;

STARG_API void starg_tetmesh_write_options_default(starg_tetmesh_write_options *options);

/* Writes a legacy VTK unstructured grid; "-" is standard output. The file is written completely or
 * not at all. `options` may be NULL. Errors: ARGUMENT (a name with blanks), WRITE, MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_tetmesh_write(starg_context *context, const starg_tetmesh *mesh,
                                           const char *path,
                                           const starg_tetmesh_write_options *options);

#ifdef __cplusplus
}
#endif

#endif
