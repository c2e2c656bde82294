/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a solid, for later stages. */
#pragma once

#include "core/bits.h"
#include "geometry/bvh.h"
#include "mesh/patches.h"
#include "mesh/zones.h"
#include "starguard/solid.h"
#include "starguard/space.h"

/* Guards that are bound to faces of the model (mesh/near_faces.c). */

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

/* Free space: winding number of the mesh plus `ambient` at least 1. */
struct starg_solid {
    starg_context *context;
    starg_mesh *mesh;   /* every shell faces out of the free space */
    starg_check *check; /* `embedded` promises that no face has free space outside */
    bvh *tree;

    starg_mesh *shared;    /* the same without copies of vertices where parts share some, or NULL */
    size_t model_vertices; /* as given; others follow: copies, those of obstacles */

    /* Scenes (mesh/space.c); all zero in a plain solid. */
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

/* Space that can be reached from a point, in cubes. */

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

/* Where the space that is reached from a point leaks. */

typedef struct flood_leak {
    bool outside;            /* it leads out of the model's box */
    bool gap;                /* through a gap hardly wider than a cube */
    double place[3];         /* of the gap, or the wider opening */
    STARG_ARRAY(double) way; /* 3 numbers for each point; none: there is no leak */
} flood_leak;

/* Free `way`. Errors: MEMORY, CANCELLED. */
starg_status flood_find_leak(const flood_cells *cells, const bvh_box *model, const double from[3],
                             flood_leak *out);

/* Vertices and faces that no free space touches where one would have to look from. */

/* True proves that no free space touches the vertex, so that nothing there is ever seen. False may
 * mean unknown: where other faces touch it, or a fold of its own ones does. */
bool solid_buries(const starg_solid *solid, uint32_t vertex);

/* True proves that the whole face is seen from nowhere: a corner of it is buried, or there is
 * matter right before the face beside one, as where furniture stands on a floor. */
bool solid_hides(const starg_solid *solid, uint32_t face);

STARG_DROP(starg_solid, starg_solid)
