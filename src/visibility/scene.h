/* SPDX-License-Identifier: Apache-2.0 */
/* Data of a solid shared by all engines: its vertices and faces in spatial order, the faces'
 * planes, and on which side of them a point lies. Immutable once made. */
#ifndef STARG_VISIBILITY_SCENE_H
#define STARG_VISIBILITY_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "mesh/solid.h"
#include "starguard/visibility.h"

#define SCENE_NONE UINT32_MAX

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

    size_t vertex_count, face_count; /* vertex_count: vertices in use */
    uint32_t *vertex_of;             /* slot -> vertex of the mesh, in spatial order */
    uint32_t *slot_of;               /* vertex of the mesh -> slot, or SCENE_NONE if unused */
    const uint32_t *face_of;         /* rank -> face of the mesh, in spatial order */
    uint32_t *corners;               /* rank x 3 -> slots */
    double *x, *y, *z;               /* by slot */

    /* Plane of each face by rank: normal . (centre - p) + offset is positive where p is inside. */
    double *nx, *ny, *nz, *offset;
    bvh_box all;       /* of the mesh and all places where guards may stand */
    double centre[3];  /* of the box */
    double extent;     /* its longest side */
    double side_bound; /* larger than the rounding error of that expression for p in the box */
    sides_run *find_sides;

    struct visibility_adjacency *adjacency; /* for the contour engine if `cull` */
} visibility_scene;

/* Errors: MEMORY. */
starg_status scene_create(starg_context *context, const starg_solid *solid, visibility_scene **out);
void scene_free(visibility_scene *scene);

/* Adds the adjacency, if the boundary is embedded. Errors: MEMORY. */
starg_status scene_add_adjacency(visibility_scene *scene);

/* side[rank] = 1 if p lies strictly on the inner side of the face, -1 outer, 0 in its plane. */
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

/* Does p, strictly inside, see the vertex in `slot`? By the BVH. With a cone, options->directions
 * has the single direction of p. */
bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options);

/* Does p, strictly inside, see this face? The rules of starg_visibility, by the BVH. */
bool scene_sees_face(const visibility_scene *scene, const double p[3], size_t rank,
                     const starg_visibility_options *options);

/* Is every point of the face visible from p? Requires that its three vertices are, and p is on its
 * inner side. `side` holds the sides of p by rank, or is NULL. Exact. */
bool face_is_wholly_visible(const visibility_scene *scene, const double p[3], const int8_t *side,
                            size_t rank);

#endif
