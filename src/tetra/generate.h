/* SPDX-License-Identifier: Apache-2.0 */
/* Generators of tetrahedra. */
#pragma once

#include "core/fields.h"
#include "core/process.h"
#include "mesh/solid.h"
#include "tetra/tetmesh.h"

/* ---- rows of the tetrahedra options, shared with the table of decompositions (generate.c) ---- */

#define TETRA_PAPER_DENSITY 17.5 /* tetrahedra per surface vertex [YL11] */

extern const char *const tetra_generator_words[];

/* The last of TETRA_FIELDS: where tetgen is, and how long it may take. Files leave them out. */
enum { TETRA_MACHINE_FIELDS = 2 };

/* All but the density, for a struct T with the options at PREFIX. */
#define TETRA_FIELDS(T, PREFIX)                                                                    \
    {.key = "generator",                                                                           \
     .option = "generator",                                                                        \
     .group = "search",                                                                            \
     .kind = STARG_FIELD_CHOICE,                                                                   \
     FIELD_MEMBER(T, PREFIX generator),                                                            \
     .words = tetra_generator_words,                                                               \
     .value = "auto|tetgen|stuffing",                                                              \
     .help = "Tetrahedra generator: isosurface stuffing (auto: with a warning that it "            \
             "approximates the surface), or the program tetgen, which preserves it."},             \
        {.key = "target",                                                                          \
         .kind = STARG_FIELD_COUNT,                                                                \
         FIELD_MEMBER(T, PREFIX target),                                                           \
         .most = TETMESH_LIMIT,                                                                    \
         .value = "N",                                                                             \
         .help = "Target number of tetrahedra; above 0 it replaces the density."},                 \
        {.key = "tetgen",                                                                          \
         .kind = STARG_FIELD_TEXT,                                                                 \
         FIELD_MEMBER(T, PREFIX tetgen),                                                           \
         .value = "FILE",                                                                          \
         .help = "Path of the program tetgen.",                                                    \
         .default_text = "found on the search path"},                                              \
    {                                                                                              \
        .key = "tetgen_limit", .kind = STARG_FIELD_REAL, .flags = STARG_FIELD_ABOVE,               \
        FIELD_MEMBER(T, PREFIX tetgen_limit), .high = 1e100, .standard = 30, .value = "S",         \
        .help = "Limit of tetgen in seconds of processor time."                                    \
    }

/* ---- the generators behind starg_tetmesh_from_solid (tetgen.c, stuffing.c, measure.c) ---- */

#define TETRA_STAGE "tetrahedra"

/* Input of the built-in generators. */
typedef struct tetra_shape {
    const starg_mesh *mesh;
    const bvh *tree;            /* of the surface's faces */
    const winding_field *field; /* NULL: the mesh is closed, and its winding number an integer */
    double volume;              /* approximate; negative if the faces of an open mesh face inward */
} tetra_shape;

/* Runs the program `tetgen` on the surface; `volume` is the largest allowed for a tetrahedron, or 0
 * for as few tetrahedra as possible. The boundary of the result equals the surface, face by face.
 * Errors: SOLVER (any failure of the program), MEMORY, CANCELLED. */
starg_status tetra_by_tetgen(starg_context *context, const starg_solid *solid, double volume,
                             const starg_tetra_options *options, starg_tetmesh **out);

/* Isosurface stuffing with cubes of side `spacing`, or smaller ones if no lattice point is inside;
 * *spacing receives the one used. Errors: SOLVER (none is small enough), MEMORY, CANCELLED. */
starg_status tetra_by_stuffing(starg_context *context, const tetra_shape *shape, double *spacing,
                               starg_tetmesh **out);

/* Largest distances between the boundary of a mesh and the surface of a shape, in both directions,
 * at points at most `step` apart. Errors: MEMORY, CANCELLED. */
starg_status tetra_measure(starg_context *context, const tetra_shape *shape,
                           const starg_tetmesh *mesh, double step, double *to_surface,
                           double *from_surface);

/* ---- does a surface enclose nothing, whatever its size? (hollow.c) ---- */

/* *hollow is true if the mesh is planar, or if its faces cancel: on any three positions, equally
 * many have either orientation. Exact. Errors: MEMORY. */
starg_status tetra_is_hollow(starg_context *context, const starg_mesh *mesh, bool *hollow);

/* ---- a body-centred cubic lattice around a solid (lattice.c) ---- */
/* Which points are inside, where the surface cuts edges, and the points moved onto the surface. */

/* Points have integer coordinates in units of half a cube, all even (corners of cubes) or all odd
 * (centres). An edge joins a point to the next of its kind along an axis (long), or to one of the
 * eight nearest of the other kind (short). */
typedef struct lattice_point {
    int64_t x[3];
} lattice_point;

enum { LATTICE_EDGES = 14, LATTICE_OWNED = 7 };

typedef enum lattice_side { LATTICE_OUTSIDE = -1, LATTICE_ON = 0, LATTICE_INSIDE = 1 } lattice_side;

/* Where the surface cuts an edge. A cut is dead once an end of its edge has moved onto the
 * surface. */
typedef struct lattice_cut {
    double position[3];
    uint32_t vertex; /* of the output mesh; UINT32_MAX: none yet */
    bool alive;
} lattice_cut;

/* A point with an edge that the surface cuts. */
typedef struct lattice_node {
    lattice_point point;
    double position[3]; /* moved if the point is on the surface */
    lattice_cut cuts[LATTICE_OWNED];
} lattice_node;

typedef struct lattice {
    starg_context *context;
    const tetra_shape *shape;
    double lower[3], upper[3]; /* box of the mesh: everything beyond is outside */
    double origin[3], half;    /* position of point 0, half the side of a cube */
    int64_t cubes[3];
    size_t corners, points; /* numbers: corners first, then centres */
    int16_t *winding;       /* of the surface about each point, within [-100, 100] */
    int8_t *side;           /* lattice_side per point */
    uint32_t *node;         /* per point: index into nodes, or UINT32_MAX */
    STARG_ARRAY(lattice_node) nodes;
    size_t inside; /* points inside */
} lattice;

/* Largest number of points; about 0.7 GB. */
#define LATTICE_LIMIT ((size_t)1 << 26)

/* Side of the cubes: `spacing`, or larger to respect LATTICE_LIMIT. */
double lattice_spacing(const tetra_shape *shape, double spacing);

/* Finds the inside points. Errors: MEMORY, CANCELLED. */
starg_status lattice_create(starg_context *context, const tetra_shape *shape, double spacing,
                            lattice *out);
void lattice_free(lattice *l);

/* Finds the cuts and warps points to cuts that are too close. Errors: MEMORY, CANCELLED. */
starg_status lattice_cut_edges(lattice *l);
void lattice_warp(lattice *l);

/* Number of a point, or SIZE_MAX outside the lattice. */
size_t lattice_number(const lattice *l, const lattice_point *p);
void lattice_position(const lattice *l, const lattice_point *p, double out[3]);

/* The cut on the edge between two neighbours, live or dead; NULL if there never was one. */
lattice_cut *lattice_cut_between(const lattice *l, const lattice_point *p, const lattice_point *q);
