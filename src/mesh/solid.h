/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a solid, for later stages: what is to be seen of it, and where guards may stand. */
#pragma once

#include "core/bits.h"
#include "geometry/bvh.h"
#include "geometry/dyadic.h"
#include "mesh/mesh.h"
#include "starguard/solid.h"
#include "starguard/space.h"

/* ---- what is to be seen of each face: all of it, parts of it, or points (patches.c) ---- */
/* A *patch* is a triangle in a face, or a point of it. Its corners are points between the face's
 * vertices with weights that are whole multiples of 2^-PATCH_DEPTH (geometry/dyadic.h): those of a
 * triangle come from halving edges. Faces still block as a whole. Where a solid has patches, they
 * are the columns of visibility rows in place of faces, face by face. */

enum { PATCH_DEPTH = 28, ALL_EDGES = 7, MOST_PATCHES = 10000000 };
#define PATCH_UNIT (UINT32_C(1) << PATCH_DEPTH)

/* Weights of a corner by the vertices of its face, in the order of the mesh; their sum is
 * PATCH_UNIT. */
typedef struct patch_corner {
    uint32_t weight[3];
} patch_corner;

typedef struct patch_triangle {
    patch_corner corner[3];
} patch_triangle;

/* A point that is no vertex, on an edge or inside a face: two or three vertices, ascending, and
 * their weights, above 0 and not all even. The last vertex of a point on an edge is UINT32_MAX. */
typedef struct patch_point {
    uint32_t vertex[3], weight[3];
    int depth; /* the sum of the weights is 2^depth */
} patch_point;

typedef struct mesh_patches {
    starg_context *context;
    size_t corners; /* of each patch: 3, or 1: a point of the face */
    size_t vertex_count;
    size_t *first;              /* by face, and one more: the number of its first patch */
    STARG_ARRAY(uint32_t) face; /* by patch */
    STARG_ARRAY(uint32_t)
    corner; /* `corners` a patch: a vertex, or vertex_count + number of a point */
    STARG_ARRAY(double) share; /* by patch, of the area of its face */
    STARG_ARRAY(patch_point) points;
    STARG_ARRAY(double) places; /* of the points, rounded, 3 each */
    uint32_t *slots;            /* number of a point + 1, or 0; open addressing */
    size_t slot_count;
} mesh_patches;

static inline patch_triangle patch_whole(void) {
    return (patch_triangle){{{{PATCH_UNIT, 0, 0}}, {{0, PATCH_UNIT, 0}}, {{0, 0, PATCH_UNIT}}}};
}

/* The edge that halving cuts, from corner k to the next: the longest of those with bit k in `among`
 * (ALL_EDGES), the first of equals. The
 * square of its length is computed in doubles from the weights: with (e1, e2) the difference of the
 * weights of corners 1 and 2, times 2^-PATCH_DEPTH, of e1 (b - a) + e2 (c - a). */
int patch_longest_edge(const patch_triangle *t, const double *const corner[3], unsigned among,
                       double *square);

/* Halves edge k; child 0 keeps its first end. False: the corners lie too close for that. */
bool patch_halve(const patch_triangle *t, int k, patch_triangle child[2]);

/* The point of a corner of a face, in the common form; false: *vertex of the mesh. */
bool patch_point_of(const uint32_t face[3], const patch_corner *corner, patch_point *point,
                    uint32_t *vertex);

dyadic_point patch_point_dyadic(const patch_point *point, const double *vertices);

/* Cuts each of the first `faces` faces until no edge of its parts is longer than `longest` (above
 * 0); other faces are a patch each. Where `other_side` (may be NULL) names an earlier face with the
 * opposite orientation, the patches are those, turned around. *out = NULL: no face is cut. Errors:
 * ARGUMENT (more than MOST_PATCHES), MEMORY. */
starg_status patches_divide(starg_context *context, const starg_mesh *mesh, size_t faces,
                            double longest, const uint32_t *other_side, mesh_patches **out);

/* A point of a face. */
typedef struct face_point {
    uint32_t face;
    patch_corner at;
} face_point;

typedef STARG_ARRAY(face_point) face_points;

/* By faces; for qsort and bsearch. */
int face_points_compare(const void *a, const void *b);

/* Adds the corners of the patches of a face. Errors: MEMORY. */
starg_status patches_list_corners(const mesh_patches *patches, const starg_mesh *mesh,
                                  uint32_t face, face_points *out);

/* Each point is a patch; sorts the points, and leaves one of equal ones. Backs, as above, have the
 * points of their fronts, and none of their own. Errors: MEMORY. */
starg_status patches_of_points(starg_context *context, const starg_mesh *mesh, face_points *points,
                               const uint32_t *other_side, mesh_patches **out);

/* How many that would be; stops counting above `most`. */
size_t patches_count(const starg_mesh *mesh, size_t faces, double longest, size_t most);

void patches_free(mesh_patches *patches);
STARG_DROP(patches, mesh_patches)

/* Corner k of a patch; a point has but one. */
static inline uint32_t patches_corner(const mesh_patches *patches, size_t patch, size_t k) {
    return patches->corner.data[patches->corners * patch + k % patches->corners];
}

/* The position of a corner of a patch, rounded. */
static inline const double *patches_place(const mesh_patches *patches, const starg_mesh *mesh,
                                          uint32_t corner) {
    return corner < patches->vertex_count
               ? mesh->vertices + 3 * (size_t)corner
               : patches->places.data + 3 * (corner - patches->vertex_count);
}

/* ---- zones in which guards may stand, and zones in which they may not (zones.c) ---- */

typedef struct zone {
    bool excludes;
    bvh_box box;            /* the zone, or that of its mesh */
    starg_solid *solid;     /* of the mesh; NULL: the box is the zone */
    size_t vertices, faces; /* of the mesh as given */
} zone;

typedef struct zones {
    size_t count;
    zone *list;
    bool limits; /* some of them do not exclude; then */
    bvh_box all; /* holds these */
} zones;

/* Errors: ARGUMENT (a box without an inside), MESH (a mesh that is not closed), MEMORY. */
starg_status zones_make(starg_context *context, const starg_zone *list, size_t count, zones *out);
void zones_free(zones *all);

/* May a guard stand at p, as far as they are concerned? */
bool zones_admit(const zones *all, const double p[3]);

/* Is it certain that none may stand in the box? */
bool zones_bar(const zones *all, const bvh_box *box);

/* ---- guards that are bound to faces of the model (near_faces.c) ---- */

/* Some faces of a model; all zero: none. */
typedef struct near_faces {
    size_t count;
    uint32_t *list, *corners;
    bvh *tree; /* triangle i is that of `corners` at 3 i */
} near_faces;

/* Errors: ARGUMENT. */
starg_status near_faces_check(starg_context *context, const starg_space_options *options,
                              size_t faces);

/* Of a model whose vertices are the first of `vertices`, which must outlive them. Errors: MEMORY.
 */
starg_status near_faces_make(starg_context *context, const starg_mesh *model,
                             const double *vertices, const uint32_t *list, size_t count,
                             near_faces *out);
void near_faces_free(near_faces *faces);

/* What is up, as a unit vector. */
void near_faces_up(const starg_space_options *options, double up[3]);

/* May a guard stand at p, as far as these faces are concerned? */
bool near_faces_admit(const near_faces *over, const near_faces *mount,
                      const starg_space_options *options, const double p[3]);

/* Is it certain that none may stand in the box? */
bool near_faces_bar(const near_faces *over, const near_faces *mount,
                    const starg_space_options *options, const bvh_box *box);

/* A box that holds all places where one may; false: there are no such faces. */
bool near_faces_box(const near_faces *over, const near_faces *mount,
                    const starg_space_options *options, bvh_box *out);

/* ---- the solid (solid.c), with what a scene adds (space.c) ---- */

/* Free space: winding number of the mesh plus `ambient` at least 1. */
struct starg_solid {
    starg_context *context;
    starg_mesh *mesh;   /* every shell faces out of the free space */
    starg_check *check; /* `embedded` promises that no face has free space outside */
    bvh *tree;

    starg_mesh *shared;    /* the same without copies of vertices where parts share some, or NULL */
    size_t model_vertices; /* as given; others follow: copies, those of obstacles */

    /* Scenes (space.c); all zero in a plain solid. */
    bool scene;
    int ambient;
    size_t model_faces; /* those of obstacles follow */
    size_t obstacle_count;
    size_t *obstacle_sizes; /* vertices and faces of each, as given */
    uint32_t *other_side;   /* by face: of a triangle that stands twice, front and back, the other
                               one, else TOPOLOGY_NONE; NULL: there are none */
    size_t once_faces;      /* those before the backs, and their halfedges across edges of two
                               of them; NULL: there are no backs */
    uint32_t *once_twin;
    struct flood_cells *reached; /* where guards may stand; NULL: anywhere */
    double *leak;                /* a way out of there, leak_points x 3; NULL: none is known */
    size_t leak_points;
    zones zones;            /* in which they may stand, or may not */
    near_faces over, mount; /* faces that guards are bound to */
    double *importance;     /* by face; NULL: 1 each */
    uint64_t *targets[2];   /* bits of the faces, and of the vertices, to be seen; NULL: all */
    uint64_t *clear;        /* bits of the faces that block no view; NULL: none */
    uint32_t *clear_list;
    uint32_t *times; /* by face: how many guards must see it; 0: as many as others; NULL: all so */
    double *density; /* by face: pixels for each unit of length, as in starg_visibility_options;
                        0: as others; NULL: all so */
    const uint32_t *need; /* by column of the target: how many more guards must see it, borrowed; 0:
                             it is no target; NULL: of all targets that is asked for */
    const mesh_patches *patches; /* what is to be seen of each face, borrowed; NULL: all of it */
    starg_space_options space;
    bool own_box;      /* space.within is what solid_reach says of a space without an end */
    starg_mesh *model; /* the model that distances are measured from, and its tree; NULL: `mesh` */
    bvh *model_tree;
};

/* Is a face, or a vertex, a target? */
static inline bool solid_is_target(const starg_solid *solid, bool vertices, size_t index) {
    return solid->targets[vertices] == NULL || starg_bit_test(solid->targets[vertices], index);
}

/* The same of a column that is no vertex, and of a vertex; and are more guards needed there? */
static inline bool solid_wants(const starg_solid *solid, bool vertices, size_t index,
                               size_t column) {
    return solid_is_target(solid, vertices, index) &&
           (solid->need == NULL || solid->need[column] > 0);
}

/* Does a face block no view? */
static inline bool solid_is_clear(const starg_solid *solid, size_t face) {
    return solid->clear != NULL && starg_bit_test(solid->clear, face);
}

/* The columns of visibility rows are patches where the solid has some, else faces. */
static inline size_t solid_patch_count(const starg_solid *solid) {
    return solid->patches != NULL ? solid->patches->face.count : solid->mesh->face_count;
}

/* The face of a patch. */
static inline size_t solid_patch_face(const starg_solid *solid, size_t patch) {
    return solid->patches != NULL ? solid->patches->face.data[patch] : patch;
}

/* The first patch of a face; that of the next face follows its last. */
static inline size_t solid_first_patch(const starg_solid *solid, size_t face) {
    return solid->patches != NULL ? solid->patches->first[face] : face;
}

/* Are all patches of the face in a row? */
static inline bool solid_holds_face(const starg_solid *solid, const uint64_t *row, size_t face) {
    bool all = true;
    for (size_t j = solid_first_patch(solid, face); j < solid_first_patch(solid, face + 1); j++)
        all = all && starg_bit_test(row, j);
    return all;
}

/* Corner k of a patch, rounded; a point has but one. */
static inline const double *solid_patch_corner(const starg_solid *solid, size_t patch, size_t k) {
    const starg_mesh *mesh = solid->mesh;
    return solid->patches != NULL
               ? patches_place(solid->patches, mesh, patches_corner(solid->patches, patch, k))
               : mesh->vertices + 3 * (size_t)mesh->faces[3 * patch + k];
}

/* Do faces that stand twice count as seen from either side? */
static inline bool solid_is_two_sided(const starg_solid *solid) {
    return solid->space.two_sided && solid->other_side != NULL;
}

/* Gives patches that count from either side the bits of their other sides, and clears the bits of a
 * row, by patch or by vertex, that are no targets. */
void solid_finish_row(const starg_solid *solid, bool vertices, uint64_t *row);

/* Bounding box of all places where guards may stand. */
void solid_reach(const starg_solid *solid, bvh_box *out);

/* Is it certain that no place of a box is at a distance, and in a part of the free space, that
 * guards are bound to? */
bool solid_bars(const starg_solid *solid, const bvh_box *box);

/* A box that holds them and the mesh. */
void solid_extent(const starg_solid *solid, bvh_box *out);

/* The halfedge on the other side of one, by the topology of the mesh. Sheets go on over edges of
 * two triangles, each side on its own; at their borders, and where more meet, it is that of the
 * triangle's other side. So every halfedge has one that runs back. */
uint32_t solid_twin(const starg_solid *solid, const uint32_t *twins, uint32_t halfedge);

/* Logs the defects of a solid's surface, with face numbers of the given mesh. `whose` introduces
 * messages ("A: "). */
void solid_tell(starg_context *context, const char *whose, const starg_check *check)
    STARG_PRIVATE(solid_tell);

/* starg_solid_create without logging, as a step of a longer computation. solid_make_in_time fails
 * at the time limit; solid_make leaves the caller's time rule in force. */
starg_status solid_make(starg_context *context, const starg_mesh *mesh, starg_solid **out)
    STARG_PRIVATE(solid_make);
/* Same, with shells that face out of the solid, or all outward: then the outside is what is outside
 * of all of them, without cavities. */
typedef enum shell_facing { SHELLS_NESTED, SHELLS_OUTWARD, SHELLS_AS_GIVEN } shell_facing;
starg_status solid_make_facing(starg_context *context, const starg_mesh *mesh, shell_facing facing,
                               starg_solid **out);
starg_status solid_make_in_time(starg_context *context, const starg_mesh *mesh, starg_solid **out)
    STARG_PRIVATE(solid_make_in_time);

/* A solid of a simplification of `fine`, within the time limit. If that is embedded, so is the
 * level, since simplification keeps it so, and its shells and loops are the same: they are not
 * looked for again. Errors: those of solid_make_in_time. */
starg_status solid_of_level(starg_context *context, const starg_solid *fine,
                            const starg_mesh *level, starg_solid **out);

/* Errors: MESH (parts of the surface share vertices, which maps of vertices do not allow). */
starg_status solid_must_not_share(starg_context *context, const starg_solid *solid,
                                  const char *stage) STARG_PRIVATE(solid_must_not_share);

/* Rebuilds a solid that another process examined: its mesh after examination, and the needed part
 * of the check. Copies everything. Errors: those of starg_mesh_create. */
starg_status solid_of_parts(starg_context *context, const double *vertices, size_t vertex_count,
                            const uint32_t *faces, size_t face_count, const starg_check *check,
                            starg_solid **out);

/* ---- space that can be reached from a point, in cubes (flood.c) ---- */

typedef struct flood_cells {
    starg_context *context;
    double origin[3], size;
    size_t count[3], reached;
    uint64_t *taken, *bits; /* met by a face; reached */
} flood_cells;

/* The cube of p; false where p is out of the grid. */
bool flood_locate(const flood_cells *cells, const double p[3], size_t at[3]);

/* The cubes of `size` in the reach of a scene (solid_reach) that are connected to that of `from`
 * over sides, through cubes that no face meets. Errors: ARGUMENT (`from` is out of reach or in a
 * cube that a face meets; too many cubes), MEMORY, CANCELLED. */
starg_status flood_create(starg_context *context, const starg_solid *scene, const double from[3],
                          double size, flood_cells **out);
void flood_free(flood_cells *cells);
STARG_DROP(flood, flood_cells)

/* Is p in one of them? */
bool flood_reaches(const flood_cells *cells, const double p[3]);

/* Is a point of the box in one of them, as far as is known? */
bool flood_meets(const flood_cells *cells, const bvh_box *box);

/* Their volume. */
double flood_volume(const flood_cells *cells);

/* ---- where the space that is reached from a point leaks (leak.c) ---- */

typedef struct flood_leak {
    bool outside;            /* it leads out of the model's box */
    bool gap;                /* through a gap hardly wider than a cube */
    double place[3];         /* of the gap, or the wider opening */
    STARG_ARRAY(double) way; /* 3 numbers for each point; none: there is no leak */
} flood_leak;

/* Free `way`. Errors: MEMORY, CANCELLED. */
starg_status flood_find_leak(const flood_cells *cells, const bvh_box *model, const double from[3],
                             flood_leak *out);

/* ---- what no free space touches where one would have to look from (buried.c) ---- */

/* True proves that no free space touches the vertex, so that nothing there is ever seen. False may
 * mean unknown: where other faces touch it, or a fold of its own ones does. */
bool solid_buries(const starg_solid *solid, uint32_t vertex);

/* True proves that the whole face is seen from nowhere: a corner of it is buried, or there is
 * matter right before the face beside one, as where furniture stands on a floor. */
bool solid_hides(const starg_solid *solid, uint32_t face);

STARG_DROP(starg_solid, starg_solid)
