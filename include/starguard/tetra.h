/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedral meshes: checked, positively oriented, with neighbours; files of them, and generators
 * that fill a solid. */
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

/* A conforming tetrahedral mesh. Every tetrahedron (a, b, c, d) is positive: det(b - a, c - a,
 * d - a) > 0, exactly. Two tetrahedra share a vertex, an edge, a face or nothing: their insides do
 * not overlap. Vertices of no tetrahedron are kept. */
typedef struct starg_tetmesh starg_tetmesh;

/* What lies beyond a face of the boundary. */
#define STARG_TETMESH_NONE UINT32_MAX

/* Copies the arrays: `vertices` is vertex_count x 3, `tetrahedra` is tetrahedron_count x 4 indices,
 * `regions` is NULL or a label for each tetrahedron (a material; it changes nothing but is kept).
 * Wrong-way tetrahedra are turned by swapping their last two vertices, with a notice.
 * Errors: ARGUMENT (no tetrahedra, an index out of range, more than 2^29), RANGE, MESH (zero
 * volume; a face of more than two tetrahedra, or of two on the same side; tetrahedra elsewhere that
 * overlap: with their indices), MEMORY, CANCELLED. */
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

/* How many tetrahedra had to be turned. */
STARG_API size_t starg_tetmesh_turned(const starg_tetmesh *mesh);
/* Sum of the volumes, in cubed units of the coordinates. */
STARG_API double starg_tetmesh_volume(const starg_tetmesh *mesh);

/* The boundary, outward oriented. Its vertices are those of the boundary faces, in the order of the
 * mesh; `vertex_map` is NULL or receives for each of them its index in the mesh (to be freed with
 * starg_tetmesh_map_free). Errors: MEMORY. */
STARG_API starg_status starg_tetmesh_surface(starg_context *context, const starg_tetmesh *mesh,
                                             starg_mesh **out, uint32_t **vertex_map);
STARG_API void starg_tetmesh_map_free(starg_context *context, uint32_t *vertex_map);

/* ---- generators ---- */

typedef enum starg_tetra_generator {
    STARG_TETRA_AUTO = 0, /* TetGen where it can be had, else stuffing, with a notice            */
    STARG_TETRA_TETGEN = 1,  /* the program tetgen: keeps the surface exactly  */
    STARG_TETRA_STUFFING = 2 /* isosurface stuffing: any solid, dihedral angles from 10.7 to 164.8
                                degrees, a surface near that of the solid */
} starg_tetra_generator;

typedef struct starg_tetra_options {
    starg_tetra_generator generator;
    double density; /* tetrahedra per vertex of the surface that are aimed at (default 17.5, the
                       density of [YL11]); 0: with TetGen as few as it can, else 17.5          */
    size_t target;  /* tetrahedra that are aimed at; above 0 it stands in for density          */
    const char *tetgen;  /* the program; NULL: "tetgen" of the search path  */
    double tetgen_limit; /* seconds that it may take (default 30)  */
} starg_tetra_options;

STARG_API void starg_tetra_options_default(starg_tetra_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_tetra_options_fields(void);

/* How a mesh was made. */
typedef struct starg_tetra_report {
    starg_tetra_generator generator; /* TETGEN or STUFFING */
    bool surface_kept; /* the boundary is the solid's surface, face by face          */
    double spacing;    /* of the lattice; 0 if there is none                         */
    /* Greatest distances found from the boundary to the solid's surface, and back: at points of
     * either that are at most `step` from all others, so that no distance is larger than the one
     * here plus `step`. All 0 when the surface was kept. */
    double to_surface, from_surface, step;
    /* With `step` added: no point of the boundary is farther from the solid's surface than
     * `distance`, and none of the surface farther from the boundary than `distance_back`. */
    double distance, distance_back;
} starg_tetra_report;

/* Fills a solid with tetrahedra. Where the surface is kept, the vertices of the solid that faces
 * use come first and in their order. `options` and `report` may be NULL. The program runs in a
 * private temporary folder (below TMPDIR or /tmp), which is removed; that it is missing, fails,
 * crashes or takes too long is no failure with AUTO. Errors: ARGUMENT, SOLVER (TETGEN alone: why it
 * was of no use; else a solid so thin that no lattice point is found in it), MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_from_solid(starg_context *context, const starg_solid *solid,
                                                const starg_tetra_options *options,
                                                starg_tetra_report *report, starg_tetmesh **out);

/* Fills what a mesh with holes winds around by more than a half (the generalised winding number;
 * holes are closed by surfaces of their own accord). Always by stuffing: generator and tetgen of
 * the options do not count. The distance `to_surface` tells how large the holes were. Errors:
 * ARGUMENT, MESH (no faces, or all in one plane), SOLVER, MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_from_open_mesh(starg_context *context, const starg_mesh *mesh,
                                                    const starg_tetra_options *options,
                                                    starg_tetra_report *report,
                                                    starg_tetmesh **out);

/* ---- files ---- */

/* Reads MEDIT .mesh (text), legacy VTK unstructured grids (text and binary, versions 1 to 5), Gmsh
 * .msh versions 2 and 4.1 (text and binary), or TetGen's .node with the .ele beside it (name
 * either). The content tells the format (TetGen: the name). Points, edges, triangles and
 * quadrilaterals among the cells are passed over; other solid cells than tetrahedra of four
 * vertices are refused. Labels are the reference of MEDIT, the first integer array of the cells of
 * VTK, the first tag of Gmsh 2 (physical group) or the entity of Gmsh 4, the first attribute of
 * TetGen; kept where any differs from the first. Errors: READ, FORMAT, RANGE, MEMORY, CANCELLED,
 * and those of starg_tetmesh_create. */
STARG_API starg_status starg_tetmesh_read(starg_context *context, const char *path,
                                          starg_tetmesh **out);
/* The same from memory, without TetGen's pair of files; `name` is used in messages. */
STARG_API starg_status starg_tetmesh_read_memory(starg_context *context, const void *bytes,
                                                 size_t size, const char *name,
                                                 starg_tetmesh **out);

/* Does the content (or, for TetGen's files, the name) say that this is a tetrahedral mesh? */
STARG_API bool starg_tetmesh_recognized(const void *bytes, size_t size, const char *name);

typedef struct starg_tetmesh_write_options {
    bool binary;           /* default: text                                              */
    const int32_t *labels; /* one per tetrahedron, or NULL: the mesh's own, if it has any */
    const char *name;      /* of the labels, one word; default "piece"                   */
} starg_tetmesh_write_options;

STARG_API void starg_tetmesh_write_options_default(starg_tetmesh_write_options *options);

/* Writes a legacy VTK unstructured grid; "-" is standard output. A file appears whole or not at
 * all. `options` may be NULL. Errors: ARGUMENT (a name with blanks), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_tetmesh_write(starg_context *context, const starg_tetmesh *mesh,
                                           const char *path,
                                           const starg_tetmesh_write_options *options);

#ifdef __cplusplus
}
#endif

#endif
