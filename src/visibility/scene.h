/* SPDX-License-Identifier: Apache-2.0 */
/* Data of a solid shared by all engines: its vertices and faces in spatial order, the faces'
 * planes, and on which side of them a point lies. Immutable once made. */
#pragma once

#include "core/compiler.h"
#include "core/parallel.h"
#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "mesh/solid.h"
#include "starguard/visibility.h"
#include "visibility/sensor.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define SCENE_NONE UINT32_MAX

/* Faces in a chunk of ranks. */
enum { SCENE_CHUNK = 128, SCENE_NEVER = 2 };

struct visibility_scene;

/* A point of a face that is to be seen and is no vertex. */
typedef struct scene_point {
    dyadic_point place;
    uint32_t support[3]; /* slots of the vertices that it lies between, or SCENE_NONE */
} scene_point;

/* ---- instruction sets ---- */

/* The stages of an engine are compiled once per instruction set and selected at run time. All
 * variants give the same bits: whatever floating point cannot decide within its error bound is
 * decided exactly. */

/* Variants for the processor's architecture, in this order after the plain one. */
typedef enum visibility_isa {
    ISA_PLAIN,
#if defined(__aarch64__)
    ISA_NEON,
#elif defined(__x86_64__)
    ISA_AVX2,
    ISA_AVX512,
#endif
    ISA_WIDEST
} visibility_isa;

/* The given variant, or for ISA_WIDEST the best one that the processor supports. */
visibility_isa isa_resolve(visibility_isa wanted);

bool isa_is_supported(visibility_isa isa);

/* side[rank] = 1 or -1 as in scene_sides if certain, otherwise 0, for ranks from `rank` to before
 * `end`. `bound` is larger than the rounding errors. */
typedef void sides_run(const struct visibility_scene *scene, const double p[3], double bound,
                       size_t rank, size_t end, int8_t *side);

/* The main loop of scene_sides, compiled per instruction set. */
sides_run sides_run_plain;
#if defined(__aarch64__)
sides_run sides_run_neon;
#elif defined(__x86_64__)
sides_run sides_run_avx2, sides_run_avx512;
#endif

/* ---- the scene: vertices and faces in spatial order, planes, sides of points (scene.c) ---- */

typedef struct visibility_scene {
    starg_context *context;
    const starg_solid *solid;
    const starg_mesh *mesh;

    /* Only faces with the point on their inner side can be the first to block a view, if the
     * boundary is embedded and the point strictly inside. Proof: let x be the first point of the
     * boundary on the segment from p; just before x the segment is inside the solid. The directions
     * from x into the solid form a spherical region whose sides are the faces at x, and the
     * direction d to p lies in its interior. Take a great-circle arc, shorter than pi, from d to an
     * inner point of a side: where it first meets the region's border it passes from the inner to
     * the outer side of the face there, and since it is shorter than pi, d lies strictly on the
     * inner side of that face; the face contains x. (Not all sides can lie on great circles through
     * d, because d is in the interior.) With x = q the same holds for a visible vertex. */
    bool cull;

    /* By rank: the least side at which a face has to be tested as a blocker. A triangle that stands
     * twice blocks the same with either side, so that the one that faces away may be left out: 0.
     * SCENE_NEVER: it blocks none. NULL: all alike, 1 if `cull`, else -1. */
    int8_t *least;

    size_t vertex_count, face_count; /* vertex_count: those that faces use */
    size_t slot_count;               /* slots of vertices, and of points that follow them */
    scene_point *points;
    uint32_t *patch_corners; /* slots of the corners of patches; NULL: patches are the faces */
    uint32_t *rank_of;       /* by face */
    uint32_t *vertex_of;     /* slot -> vertex of the mesh, in spatial order          */
    uint32_t *slot_of;       /* vertex of the mesh -> slot, or SCENE_NONE if unused   */
    const uint32_t *face_of; /* rank -> face of the mesh, in spatial order            */
    uint32_t *corners;       /* rank x 3 -> slots                                     */
    double *x, *y, *z;       /* by slot                                               */

    /* Plane of each face by rank: normal . (centre - p) + offset is positive where p is inside. */
    double *nx, *ny, *nz, *offset;
    bvh_box all;        /* of the mesh and all places where guards may stand */
    double centre[3];   /* of the box */
    double extent;      /* its longest side */
    double side_bound;  /* larger than the rounding error of that expression for p in the box */
    double blur;        /* what coordinates of points between vertices are off at most */
    double point_bound; /* the same as side_bound for such a point */
    sides_run *find_sides;

    double range;    /* vertices farther away need not be looked at; INFINITY: all are */
    bvh_box *chunks; /* where views are limited: boxes of SCENE_CHUNK faces each, by rank */

    struct visibility_adjacency *adjacency; /* for the engine by contours if `cull` */
    sight_tree *sights;                     /* for single sight lines, if they were prepared */
} visibility_scene;

/* Errors: MEMORY. */
starg_status scene_create(starg_context *context, const starg_solid *solid, visibility_scene **out);
void scene_free(visibility_scene *scene);
STARG_DROP(scene, visibility_scene)

/* Adds the adjacency, if the boundary is embedded. Errors: MEMORY. */
starg_status scene_add_adjacency(visibility_scene *scene);

/* Prepares it for many single sight lines (scene_sees_vertex, scene_sees_face). Errors: MEMORY. */
starg_status scene_add_sights(visibility_scene *scene);

/* Lets engines leave out what is farther than the range, and with directed views what they do not
 * hold. Errors: MEMORY. */
starg_status scene_limit(visibility_scene *scene, double range, bool directed);

/* What is looked at from a place: half-spaces about it; none: all around. */
typedef struct scene_view {
    int count;
    double normals[4][3]; /* unit, inwards */
} scene_view;

/* The view of an aimed sensor, or one around it. */
scene_view scene_view_of(const sensor *aimed);

/* Is all of a chunk of faces out of reach of p, or out of its view? Then it blocks no line of sight
 * that ends within, since ranges and views are convex. */
static inline bool scene_is_beyond(const visibility_scene *scene, size_t chunk, const double p[3],
                                   const scene_view *view) {
    double square = 0;
    if (scene->chunks == NULL)
        return false;
    for (int k = 0; k < 3; k++) {
        double below = scene->chunks[chunk].lower[k] - p[k];
        double above = p[k] - scene->chunks[chunk].upper[k];
        double gap = below > 0 ? below : above > 0 ? above : 0;
        square += gap * gap;
    }
    if (square > scene->range * scene->range * (1 + 1e-9)) /* more than its roundings */
        return true;
    double slack = 1e-9 * (scene->extent + sqrt(square)); /* more than roundings of planes */
    for (int i = 0; i < view->count; i++) {
        double most = slack;
        for (int k = 0; k < 3; k++) {
            double n = view->normals[i][k];
            most +=
                n * ((n > 0 ? scene->chunks[chunk].upper : scene->chunks[chunk].lower)[k] - p[k]);
        }
        if (most < 0)
            return true;
    }
    return false;
}

/* Can the face be the first to block a view from a point that has this side of it? */
static inline bool scene_may_block(const visibility_scene *scene, size_t rank, int8_t side) {
    return side >= (scene->least != NULL ? scene->least[rank] : scene->cull ? 1 : -1);
}

/* Does the face block no view? */
static inline bool scene_is_clear(const visibility_scene *scene, size_t rank) {
    return scene->least != NULL && scene->least[rank] == SCENE_NEVER;
}

/* On which side of a face is p? 0: within rounding of its plane. p lies in the box. */
static inline int scene_likely_side(const visibility_scene *scene, size_t rank, const double p[3]) {
    double value = scene->nx[rank] * (scene->centre[0] - p[0]) +
                   scene->ny[rank] * (scene->centre[1] - p[1]) +
                   scene->nz[rank] * (scene->centre[2] - p[2]) + scene->offset[rank];
    return (value > scene->side_bound) - (value < -scene->side_bound);
}

/* The same of a point between vertices, in the box. */
static inline int scene_likely_side_of(const visibility_scene *scene, size_t rank,
                                       const dyadic_point *q) {
    double value = scene->nx[rank] * (scene->centre[0] - q->at[0]) +
                   scene->ny[rank] * (scene->centre[1] - q->at[1]) +
                   scene->nz[rank] * (scene->centre[2] - q->at[2]) + scene->offset[rank];
    return (value > scene->point_bound) - (value < -scene->point_bound);
}

/* Is p in the box of the scene? */
bool scene_holds(const visibility_scene *scene, const double p[3]);

/* The exact side of the face on which p lies: 1 inner, -1 outer, 0 in its plane. */
int scene_side(const visibility_scene *scene, size_t rank, const double p[3]);

/* side[rank] = 1 where p lies strictly on the inner side of the face, -1 outer, 0 in its plane;
 * also 0 in chunks beyond the view, if that is not NULL. */
void scene_sides(const visibility_scene *scene, const double p[3], const scene_view *view,
                 int8_t *side);

static inline const double *scene_corner(const visibility_scene *scene, size_t rank, int k) {
    uint32_t vertex = scene->vertex_of[scene->corners[3 * rank + (size_t)k]];
    return scene->mesh->vertices + 3 * (size_t)vertex;
}

static inline bool scene_has_corner(const visibility_scene *scene, size_t rank, uint32_t slot) {
    const uint32_t *c = scene->corners + 3 * rank;
    return c[0] == slot || c[1] == slot || c[2] == slot;
}

/* Does the closed face hold a point of this or another face, as the mesh tells: has it all vertices
 * that the point lies between? */
static inline bool scene_has_point(const visibility_scene *scene, size_t rank,
                                   const scene_point *point) {
    bool has = true;
    for (int k = 0; k < 3 && has; k++)
        has = point->support[k] == SCENE_NONE || scene_has_corner(scene, rank, point->support[k]);
    return has;
}

/* Does the face block the view from p to the vertex or point in `slot`? Exact. `side` is that of p.
 * If p is off its plane, a face never blocks what it holds. */
bool scene_blocks(const visibility_scene *scene, size_t rank, int side, const double p[3],
                  uint32_t slot);
bool scene_blocks_point(const visibility_scene *scene, size_t rank, int side, const double p[3],
                        const scene_point *point);

/* Slots of the corners of a patch, and how many it has. */
static inline const uint32_t *scene_patch_corners(const visibility_scene *scene, size_t patch) {
    return scene->patch_corners != NULL
               ? scene->patch_corners + scene->solid->patches->corners * patch
               : scene->corners + 3 * (size_t)scene->rank_of[patch];
}

static inline size_t scene_patch_size(const visibility_scene *scene) {
    return scene->patch_corners != NULL ? scene->solid->patches->corners : 3;
}

/* The middle of a patch. */
void scene_patch_centre(const visibility_scene *scene, size_t patch, double centre[3]);

/* Is no corner of a patch in the face of `rank`, p being on its inner side, seen too obliquely? */
bool scene_faces_patch(const visibility_scene *scene, const sensor *looks, const double p[3],
                       size_t rank, size_t patch);

/* The sensor of some options, which must outlive it, for a scene: where faces have densities of
 * their own, those are asked about by face. */
sensor scene_sensor(const visibility_scene *scene, const starg_visibility_options *options);

/* Has an aimed sensor, at every corner of a patch, the density that its face needs, where faces
 * have needs of their own? */
bool scene_resolves_patch(const visibility_scene *scene, const sensor *looks, const double p[3],
                          size_t patch);

/* A corner of a part of a face. */
scene_point scene_point_of(const visibility_scene *scene, size_t rank, const patch_corner *corner);

/* The same for a corner of a patch, or for a vertex. */
scene_point scene_point_at(const visibility_scene *scene, uint32_t slot);

/* Where faces count from either side: the rank of the other side of a face, else SCENE_NONE. */
uint32_t scene_back(const visibility_scene *scene, size_t rank);

/* ---- engines: what a point sees (grid.c, tree.c, sweep.c, contours.c, fastest.c) ---- */

/* An algorithm that finds the vertices seen from a point. */
typedef struct visibility_engine {
    /* Memory for one thread; *scratch is freed by free_scratch. */
    starg_status (*make_scratch)(const visibility_scene *scene, void **scratch);
    void (*free_scratch)(const visibility_scene *scene, void *scratch);
    /* visible[slot] = 1 if p sees the vertex, otherwise 0; out of the view it may be either. p is
     * strictly inside. */
    void (*find)(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible);
    /* After find, for a face with p on its inner side and three visible vertices: true only if all
     * of it is visible; false may mean unknown. NULL: never known. */
    bool (*sees_plainly)(const visibility_scene *scene, void *scratch, size_t rank);
} visibility_engine;

extern const visibility_engine visibility_grid, visibility_tree, visibility_sweep,
    visibility_contours, visibility_fastest;

/* ---- what single points see, by the tree (tree.c) ---- */

/* Does p, strictly inside and with these sides, see the vertex or point in `slot`, by the tree? */
bool scene_sees_slot(const visibility_scene *scene, const double p[3], const int8_t *side,
                     uint32_t slot);

/* Does p, strictly inside, see the vertex or point in `slot`, by the tree? Where views are
 * directed, options->directions and ups have the one direction of p. */
bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options);

/* The same for a point of a face, and a sensor that is aimed. */
bool scene_sees_point(const visibility_scene *scene, const double p[3], const scene_point *point,
                      const sensor *looks);

/* Does p, strictly inside, see the one patch, from either side of it where the scene says so? The
 * rules of starg_visibility, by the tree. */
bool scene_sees_patch(const visibility_scene *scene, const double p[3], size_t patch,
                      const starg_visibility_options *options);

/* ---- is every point of a triangle visible? (whole.c) ---- */

/* Is every point of a triangle in the face of `rank` visible from p? Its three corners are, and p
 * is on the face's inner side. `side` holds the sides of p by rank, or is NULL. *blocker, if not
 * NULL, is a face that is tried first, SCENE_NONE for none, and then the one found. Exact. */
bool triangle_is_wholly_visible(const visibility_scene *scene, const double p[3],
                                const int8_t *side, size_t rank, const scene_point corner[3],
                                uint32_t *blocker);

/* The same of a patch in that face; points are. */
bool patch_is_wholly_visible(const visibility_scene *scene, const double p[3], const int8_t *side,
                             size_t rank, size_t patch);

/* ---- the boundary by slots and ranks: edges, faces at vertices, parents (adjacency.c) ---- */
/* Candidate parents are for trees along edges. Immutable once made. */

enum { FAN = 8, CHOICES = 3 };

/* An edge runs from a to b in the face `left`, and back in `right`. */
typedef struct adjacency_edge {
    uint32_t left, right, a, b;
} adjacency_edge;

typedef struct visibility_adjacency {
    starg_context *context;
    size_t edge_count;
    adjacency_edge *edges; /* sorted by the lower slot of their ends, for memory locality */
    /* The neighbours of a slot in counter-clockwise order seen from outside, and at the same
     * positions the ranks of the faces between each and the next one. */
    uint32_t *fan_start;            /* slot -> its first position; one more entry than slots */
    uint32_t *neighbour, *fan_face; /* FAN entries more */
    uint32_t *parents;    /* slot x CHOICES -> neighbours that come before it in the order, nearest
                             first, the last repeated; or itself for the root of a shell */
    uint32_t *first_face; /* slot -> one of its faces */
    uint32_t *order;      /* slots, shell by shell */
    size_t shell_count;
    uint32_t *shell_start; /* shell -> its first position in order, its root; and the end */
} visibility_adjacency;

/* Every vertex and edge must be manifold, as those of a solid are. O(n). Errors: MEMORY. */
starg_status adjacency_create(starg_context *context, const visibility_scene *scene,
                              visibility_adjacency **out);
void adjacency_free(visibility_adjacency *adjacency);
STARG_DROP(adjacency, visibility_adjacency)

/* ---- rows of the visibility matrix (visibility.c) ---- */

/* The columns of visibility rows. */

static inline size_t target_columns(const starg_solid *solid, starg_target target) {
    return target == STARG_TARGET_VERTICES  ? solid->mesh->vertex_count
           : target == STARG_TARGET_CORNERS ? 3 * solid->mesh->face_count
                                            : solid_patch_count(solid);
}

/* A matrix under construction: row i is what point i sees. */
typedef struct visibility_job {
    const visibility_scene *scene;
    const starg_visibility_options *options;
    const double *points;
    size_t count;
    starg_bits *rows;
    uint8_t *finished;               /* by point; may be NULL */
    const visibility_engine *engine; /* follows from the options; visibility_fill sets it */
    const size_t *starts; /* the first point of each place, if directions of one are done in turn */
} visibility_job;

/* Makes the scene that the options' engine needs for `count` points. Errors: MEMORY. */
starg_status visibility_scene_for(starg_context *context, const starg_solid *solid,
                                  const starg_visibility_options *options, size_t count,
                                  visibility_scene **out);

/* Fills the rows, initially zero, in this process or, with `remote`, in others as well. Errors:
 * MEMORY, CANCELLED, TIME, RANK. */
starg_status visibility_fill(starg_context *context, const visibility_job *job,
                             const starg_parallel_remote *remote);

/* starg_visibility for callers that can use a partial result: at the time limit, finished[i] = 1
 * marks the finished rows, and there is no error. */
starg_status visibility_rows(starg_context *context, const starg_solid *solid, const double *points,
                             size_t count, const starg_visibility_options *options,
                             uint8_t *finished, starg_bits **out);

/* ---- rows that other processes compute (rows_remote.c) ---- */

/* Is there enough work to share? */
bool visibility_is_shared(starg_context *context, const visibility_job *job);

/* Packs what points see in: the solid and the options. Errors: MEMORY. */
starg_status visibility_pack_scene(starg_context *context, const starg_solid *solid,
                                   const starg_visibility_options *options, size_t points,
                                   starg_bytes *out);

/* Reads it; *solid may be set even on failure. Errors: MEMORY, RANK. */
starg_status visibility_unpack_scene(starg_context *context, starg_bytes_reader *bytes,
                                     starg_solid **solid, starg_visibility_options *options);

/* Packs the job for helpers. Errors: MEMORY. */
starg_status visibility_pack(starg_context *context, const visibility_job *job, starg_bytes *out);

/* A starg_parallel_remote's take, with a visibility_job for `shared`. */
starg_status visibility_take(starg_context *context, void *shared, size_t first, size_t count,
                             starg_bytes_reader *reply);

/* Computes rows for another process. */
extern const ranks_work visibility_ranks_work STARG_PRIVATE(visibility_ranks_work);
