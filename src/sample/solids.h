/* SPDX-License-Identifier: Apache-2.0 */
/* The samples, and what they are made with. */
#pragma once

#include "mesh/mesh.h"

/* ---- numbers for 64-bit keys, in order of first insertion (builder.c) ---- */

/* All zero when empty. Open addressing over a power of two of slots, at most half full. */
typedef struct key_map {
    uint64_t *keys;    /* per slot */
    uint32_t *numbers; /* per slot; UINT32_MAX: free */
    size_t slots, count;
} key_map;

/* Sets *number to the number of `key`; a new key gets the number *count, and *added becomes true.
 * Errors: MEMORY. */
starg_status key_map_add(starg_context *context, key_map *map, uint64_t key, uint32_t *number,
                         bool *added);
/* The number of `key`, or UINT32_MAX. */
uint32_t key_map_find(const key_map *map, uint64_t key);
void key_map_free(key_map *map);

/* ---- a mesh under construction (builder.c) ---- */
/* Vertices are identified by keys, so that separate patches share the vertices on their common
 * borders. */

/* All zero when empty, except for the context. */
typedef struct mesh_builder {
    starg_context *context;
    key_map names;
    STARG_ARRAY(double) positions; /* 3 for each vertex */
    STARG_ARRAY(uint32_t) faces;   /* 3 for each face */
} mesh_builder;

/* The vertex with `key`, created at `position` if there is none yet. Errors: MEMORY. */
starg_status builder_vertex(mesh_builder *builder, uint64_t key, const double position[3],
                            uint32_t *vertex);
starg_status builder_triangle(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c);
/* Two triangles, cut along a c. */
starg_status builder_quad(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/* Makes the mesh; the builder must still be freed. */
starg_status builder_finish(mesh_builder *builder, starg_mesh **out);
void builder_free(mesh_builder *builder);

/* ---- a solid as an implicit function, negative inside (implicit.c) ---- */
/* The smooth union of round cones and of outlines that are revolved or extruded, less those that
 * are carved. */

enum { IMPLICIT_MAX_OUTLINE = 64 };

/* A simple polygon. Revolved, its points are (distance from the axis, height above a); those within
 * the solid at the axis may lie at negative distances. Extruded from a to b, they are coordinates
 * along `flat` and across it. */
typedef struct implicit_outline {
    size_t count;
    bool extruded;
    double points[IMPLICIT_MAX_OUTLINE][2];
} implicit_outline;

/* The convex hull of two balls, optionally flattened; or an outline about the axis from a to b,
 * grown by ra, `rb` thick. */
typedef struct implicit_part {
    double a[3], b[3]; /* centres of the balls */
    double ra, rb;     /* their radii, above 0 */
    double blend;      /* width over which the part blends with earlier ones, above 0 */
    double flat[3];    /* unit direction in which the part is thinner ... */
    double flatten;    /* ... by this factor, at least 1; 0 means 1 */
    const implicit_outline *outline; /* NULL: round cone */
    bool carve;                      /* taken away from what is before it */
    /* derived by implicit_prepare */
    double axis[3], length, sine, cosine; /* of the cone's half-angle */
    double center[3], reach;              /* ball that contains the part */
} implicit_part;

enum { IMPLICIT_MAX_PARTS = 128 };

typedef struct implicit_field {
    size_t count;
    implicit_part parts[IMPLICIT_MAX_PARTS];
} implicit_field;

typedef struct implicit_sample {
    double value;       /* at most the distance to the surface */
    double gradient[3]; /* length at most 1 */
    double radius;      /* of the nearest part: how thin the solid is there */
} implicit_sample;

/* Computes the derived members of a part. */
void implicit_prepare(implicit_part *part);
/* Value of one part alone; `gradient` may be NULL; *radius is that of its axis nearest to p. */
double implicit_part_value(const implicit_part *part, const double p[3], double gradient[3],
                           double *radius);
implicit_sample implicit_evaluate(const implicit_field *field, const double p[3]);
/* Moves p onto the surface by `steps` (> 0) Newton steps; `gradient` is that before the last. */
void implicit_project(const implicit_field *field, double p[3], int steps, double gradient[3]);
/* A box that contains the surface. */
void implicit_bounds(const implicit_field *field, double lower[3], double upper[3]);

/* ---- the zero set of an implicit field as a mesh, by marching tetrahedra (isosurface.c) ---- */

/* Fills `builder` with a closed 2-manifold, outward oriented, from cells of side `spacing`; its
 * triangles may be thin. Errors: MEMORY, CANCELLED. */
starg_status isosurface_extract(const implicit_field *field, double spacing, mesh_builder *builder);

/* ---- well-shaped triangles for the raw ones of an isosurface (remesh.c) ---- */

/* Coarsens `raw`, a closed 2-manifold on the zero set of `field`, to `vertex_count` vertices (more
 * if no further edge can be collapsed) and improves its triangles. Errors: MEMORY, CANCELLED. */
starg_status remesh_isosurface(starg_context *context, const implicit_field *field,
                               const starg_mesh *raw, size_t vertex_count, starg_mesh **out);

/* ---- folds that skinning makes on the inner side of a joint, smoothed (unfold.c) ---- */

/* Moves vertices of `posed` near folded or squeezed faces, unless the same faces are so in `rest`
 * (of the same connectivity). Errors: MEMORY, CANCELLED. */
starg_status unfold_mesh(starg_context *context, const starg_mesh *rest, starg_mesh *posed);

/* ---- families of man-made things (ware.c) ---- */
/* Members of random proportions, built of revolved and extruded outlines and round cones. */

typedef enum ware_kind { WARE_VASE, WARE_BUST, WARE_BEARING, WARE_TABLE, WARE_TOOL } ware_kind;

enum { WARE_MEMBERS = 10, WARE_MAX_OUTLINES = 16 };

typedef struct ware {
    implicit_field field;
    size_t outline_count;
    implicit_outline outlines[WARE_MAX_OUTLINES];
    int genus;
} ware;

/* Builds a member, 0 to WARE_MEMBERS - 1; the parts point into *out, which is not to be moved. */
void ware_build(ware_kind kind, int member, ware *out);

/* ---- an articulated figure: joints, the solid around them, and poses (figure.c) ---- */

enum { FIGURE_MAX_JOINTS = 40, FIGURE_MAX_TURNS = 160, FIGURE_POSES = 5 };

/* Rotation of one joint, with all its descendants, in one pose: about the direction of `degrees` in
 * the rest pose, by its length in degrees. */
typedef struct figure_turn {
    int pose, joint;
    double degrees[3];
} figure_turn;

/* x is forward, y up, z to the right. Joint 0 is the root; parents come before their children. */
typedef struct figure {
    int joint_count;
    int parents[FIGURE_MAX_JOINTS]; /* -1 for the root */
    double pivots[FIGURE_MAX_JOINTS][3];
    implicit_field field;
    int owners[IMPLICIT_MAX_PARTS]; /* joint that moves each part */
    figure_turn turns[FIGURE_MAX_TURNS];
    size_t turn_count;
} figure;

typedef enum figure_kind {
    FIGURE_HORSE,
    FIGURE_DOG,
    FIGURE_CAT,
    FIGURE_GIRAFFE,
    FIGURE_DINOSAUR,
    FIGURE_BIRD,
    FIGURE_HUMAN,
    FIGURE_OCTOPUS
} figure_kind;

void figure_build(figure_kind kind, figure *out);

/* ---- a mesh bent with the joints of a figure (skin.c) ---- */

/* Moves `vertices` (count x 3, on the figure's surface in its rest pose) into a pose.
 * Errors: MEMORY, CANCELLED. */
starg_status skin_pose(starg_context *context, const figure *f, int pose, double *vertices,
                       size_t count);

/* ---- the families of solids in the catalogue (catalogue.c) ---- */
/* Each takes the wanted number of vertices and comes as close to it as its structure allows.
 * Errors: MEMORY, CANCELLED. */

/* Articulated figures: an isosurface, posed. */
starg_status solid_figure(starg_context *context, figure_kind kind, int pose, size_t vertex_count,
                          starg_mesh **out);

/* Members of a family: an isosurface. */
starg_status solid_ware(starg_context *context, ware_kind kind, int member, size_t vertex_count,
                        starg_mesh **out);

/* Random solids of unit cubes (blocks.c): members 0 to BLOCKS_MEMBERS - 1. */
typedef enum blocks_kind { BLOCKS_POLYCUBE, BLOCKS_MAZE, BLOCKS_COMB, BLOCKS_SPIKES } blocks_kind;

enum { BLOCKS_MEMBERS = 1000 };

starg_status solid_blocks(starg_context *context, blocks_kind kind, int member, size_t vertex_count,
                          starg_mesh **out);

/* Vertical prisms over a plan of rectangles (prism.c). */
starg_status solid_l_room(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_gallery(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_labyrinth(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_plate(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_eight(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Moves a solid without joints into a pose, 0 (as made) to SOLID_BENDS - 1 (catalogue.c). */
enum { SOLID_BENDS = 3 };

/* Tubes around closed curves (tube.c). */
starg_status solid_torus(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_knot(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Subdivided polyhedra (polyhedron.c). */
starg_status solid_sphere(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_shell(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_star(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Scenes (building.c): shells that touch, open sheets, shells that overlap. */
starg_status solid_office(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_level(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_statue(starg_context *context, size_t vertex_count, starg_mesh **out);
