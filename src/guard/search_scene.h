/* SPDX-License-Identifier: Apache-2.0 */
/* What a search looks at: the solid, the witnesses that stand for all faces, and what points see
 * of them. */
#ifndef STARG_GUARD_SEARCH_SCENE_H
#define STARG_GUARD_SEARCH_SCENE_H

#include "core/memory.h"
#include "guard/witnesses.h"
#include "visibility/box.h"
#include "visibility/kernel.h"
#include "visibility/scene.h"

/* Where guards may stand, what occludes, and what must be seen. */
typedef struct search_scene {
    starg_context *context;
    const starg_solid *solid;
    const starg_visibility_options *view;
    double clearance;
    visibility_scene *points; /* what a point sees */
    box_scene *boxes;         /* what a box may see */
    uint32_t *places;  /* by column, its position in `points`: rank of the patch's face, or slot of
                          the vertex */
    uint32_t *ranks;   /* by slot, a rank of a face at the vertex */
    solid_parts parts; /* no point sees witnesses of two of them */
    STARG_ARRAY(uint32_t) witnesses; /* columns: the faces or vertices that stand for all */
    uint64_t number;                 /* of the context's scenes */
} search_scene;

/* The caller closes it even if this fails. Errors: MEMORY. */
starg_status search_scene_open(starg_context *context, const starg_solid *solid,
                               const starg_visibility_options *view, double clearance,
                               search_scene *out);
void search_scene_close(search_scene *scene);

/* How many microseconds a unit of work takes, within a factor of two: less in small models. */
double search_scene_unit(const search_scene *scene);

/* A point where a guard may stand. */
typedef struct search_point {
    double place[3], direction[3], up[3]; /* the last two where views are directed */
    witness_row seen;
    uint32_t candidate; /* of the pool, or UINT32_MAX */
} search_point;

/* The centroid of the face of witness j, or the vertex. */
void search_scene_centre(const search_scene *scene, size_t j, double centre[3]);

/* A rank of a face of `points` that is witness j or has its vertex. */
size_t search_scene_rank(const search_scene *scene, size_t j);

/* The part of the solid that a column bounds. */
uint32_t search_scene_part(const search_scene *scene, uint32_t column);

/* Does the point see witness j? The point lies in the free space. */
bool search_scene_sees(const search_scene *scene, const search_point *point, size_t j,
                       uint64_t *work);

/* False if the plane of witness j already shows that a guard at p does not see it. */
bool search_scene_may_see(const search_scene *scene, const double p[3], size_t j);

/* Is the whole box closer to the boundary than guards may stand? */
bool search_scene_bars(const search_scene *scene, const bvh_box *box);

/* Sets which witnesses in `among` the point sees; returns the number of tests. */
uint64_t search_scene_look(const search_scene *scene, search_point *point,
                           const witness_row *among);

/* The witnesses from `first` on. */
witness_row search_scene_witnesses(const search_scene *scene, size_t first);

/* A STARG_ARRAY of points, and a lower bound on how many of them are needed. */
typedef struct search_points {
    search_point *data;
    size_t count, capacity, bound;
} search_points;

/* Tests points that are not candidates against some witnesses. Errors: MEMORY, CANCELLED. */
starg_status points_look_at(const search_scene *scene, search_point *points, size_t count,
                            const witness_row *among, uint64_t *work);

/* Removes points from `first` on that see no more than another does, and are no candidates: these
 * stay, as new witnesses may raise their value. */
void points_prune(search_points *points, size_t first, uint64_t *work);

#endif
