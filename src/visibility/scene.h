/* SPDX-License-Identifier: Apache-2.0 */
/* Data of a solid shared by all engines: its vertices and faces in spatial order, the faces'
 * planes, and on which side of them a point lies. Immutable once made. */
#ifndef STARG_VISIBILITY_SCENE_H
#define STARG_VISIBILITY_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "geometry/sight_tree.h"
#include "mesh/solid.h"
#include "starguard/visibility.h"
#include "visibility/sensor.h"

#define SCENE_NONE UINT32_MAX

/* Faces in a chunk of ranks. */
enum { SCENE_CHUNK = 128 };

struct visibility_scene;

/* side[rank] = 1 or -1 as in scene_sides if certain, otherwise 0. */
typedef void sides_run(const struct visibility_scene *scene, const double p[3], int8_t *side);

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
     * NULL: all alike, 1 if `cull`, else -1. */
    int8_t *least;

    size_t vertex_count, face_count; /* vertex_count: those that faces use */
    uint32_t *vertex_of;             /* slot -> vertex of the mesh, in spatial order          */
    uint32_t *slot_of;               /* vertex of the mesh -> slot, or SCENE_NONE if unused   */
    const uint32_t *face_of;         /* rank -> face of the mesh, in spatial order            */
    uint32_t *corners;               /* rank x 3 -> slots                                     */
    uint32_t *backs;   /* rank -> rank of the other side, or SCENE_NONE; NULL: only fronts count */
    double *x, *y, *z; /* by slot                                               */

    /* Plane of each face by rank: normal . (centre - p) + offset is positive where p is inside. */
    double *nx, *ny, *nz, *offset;
    bvh_box all;       /* of the mesh and all places where guards may stand */
    double centre[3];  /* of the box */
    double extent;     /* its longest side */
    double side_bound; /* larger than the rounding error of that expression for p in the box */
    sides_run *find_sides;

    double range;    /* vertices farther away need not be looked at; INFINITY: all are */
    bvh_box *chunks; /* with a range: boxes of SCENE_CHUNK faces each, by rank */

    struct visibility_adjacency *adjacency; /* for the engine by contours if `cull` */
    sight_tree *sights;                     /* for single sight lines, if they were prepared */
} visibility_scene;

/* Errors: MEMORY. */
starg_status scene_create(starg_context *context, const starg_solid *solid, visibility_scene **out);
void scene_free(visibility_scene *scene);

/* Adds the adjacency, if the boundary is embedded. Errors: MEMORY. */
starg_status scene_add_adjacency(visibility_scene *scene);

/* Prepares it for many single sight lines (scene_sees_vertex, scene_sees_face). Errors: MEMORY. */
starg_status scene_add_sights(visibility_scene *scene);

/* Lets engines leave out what is farther than the range. Errors: MEMORY. */
starg_status scene_limit(visibility_scene *scene, double range);

/* Is all of a chunk of faces beyond the range of p? Then it blocks no view that ends within. */
static inline bool scene_is_beyond(const visibility_scene *scene, size_t chunk, const double p[3]) {
    double square = 0;
    if (scene->chunks == NULL)
        return false;
    for (int k = 0; k < 3; k++) {
        double below = scene->chunks[chunk].lower[k] - p[k];
        double above = p[k] - scene->chunks[chunk].upper[k];
        double gap = below > 0 ? below : above > 0 ? above : 0;
        square += gap * gap;
    }
    return square > scene->range * scene->range * (1 + 1e-9); /* more than its roundings */
}

/* Can the face be the first to block a view from a point that has this side of it? */
static inline bool scene_may_block(const visibility_scene *scene, size_t rank, int8_t side) {
    return side >= (scene->least != NULL ? scene->least[rank] : scene->cull ? 1 : -1);
}

/* On which side of a face is p? 0: within rounding of its plane. p lies in the box. */
static inline int scene_likely_side(const visibility_scene *scene, size_t rank, const double p[3]) {
    double value = scene->nx[rank] * (scene->centre[0] - p[0]) +
                   scene->ny[rank] * (scene->centre[1] - p[1]) +
                   scene->nz[rank] * (scene->centre[2] - p[2]) + scene->offset[rank];
    return (value > scene->side_bound) - (value < -scene->side_bound);
}

/* Is p in the box of the scene? */
bool scene_holds(const visibility_scene *scene, const double p[3]);

/* The exact side of the face on which p lies: 1 inner, -1 outer, 0 in its plane. */
int scene_side(const visibility_scene *scene, size_t rank, const double p[3]);

/* side[rank] = 1 where p lies strictly on the inner side of the face, -1 outer, 0 in its plane. */
void scene_sides(const visibility_scene *scene, const double p[3], int8_t *side);

static inline const double *scene_corner(const visibility_scene *scene, size_t rank, int k) {
    uint32_t vertex = scene->vertex_of[scene->corners[3 * rank + (size_t)k]];
    return scene->mesh->vertices + 3 * (size_t)vertex;
}

static inline bool scene_has_corner(const visibility_scene *scene, size_t rank, uint32_t slot) {
    const uint32_t *c = scene->corners + 3 * rank;
    return c[0] == slot || c[1] == slot || c[2] == slot;
}

/* Does the face block the view from p to the vertex in `slot`? Exact. `side` is that of p. If p is
 * off its plane, a face never blocks its own corners. */
bool scene_blocks(const visibility_scene *scene, size_t rank, int side, const double p[3],
                  uint32_t slot);

/* An algorithm that finds the vertices seen from a point. */
typedef struct visibility_engine {
    /* Memory for one thread; *scratch is freed by free_scratch. */
    starg_status (*make_scratch)(const visibility_scene *scene, void **scratch);
    void (*free_scratch)(const visibility_scene *scene, void *scratch);
    /* visible[slot] = 1 if p sees the vertex, otherwise 0. p is strictly inside. */
    void (*find)(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, uint8_t *visible);
    /* After find, for a face with p on its inner side and three visible vertices: true only if all
     * of it is visible; false may mean unknown. NULL: never known. */
    bool (*sees_plainly)(const visibility_scene *scene, void *scratch, size_t rank);
} visibility_engine;

extern const visibility_engine visibility_grid, visibility_tree, visibility_sweep,
    visibility_contours, visibility_fastest;

/* starg_visibility for callers that can use a partial result: at the time limit, finished[i] = 1
 * marks the finished rows, and there is no error. */
starg_status visibility_rows(starg_context *context, const starg_solid *solid, const double *points,
                             size_t count, const starg_visibility_options *options,
                             uint8_t *finished, starg_bits **out);

/* Does p, strictly inside, see the vertex in `slot`, by the tree? Where views are
 * directed, options->directions and ups have the one direction of p. */
bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options);

/* Does p, strictly inside, see the one face, from either side of it where the scene says so? The
 * rules of starg_visibility, by the tree. */
bool scene_sees_face(const visibility_scene *scene, const double p[3], size_t rank,
                     const starg_visibility_options *options);

/* Where faces count from either side: the rank of the other side of a face, else SCENE_NONE. */
uint32_t scene_back(const visibility_scene *scene, size_t rank);

/* Is every point of the face of `rank` visible from p? Its three vertices are, and p is on its
 * inner side. `side` holds the sides of p by rank, or is NULL. Exact. */
bool face_is_wholly_visible(const visibility_scene *scene, const double p[3], const int8_t *side,
                            size_t rank);

#endif
