/* SPDX-License-Identifier: Apache-2.0 */
/* The space of a search as a tree of boxes, with the witnesses that each may see. */
#ifndef STARG_GUARD_CELLS_H
#define STARG_GUARD_CELLS_H

#include "core/memory.h"
#include "guard/witnesses.h"
#include "visibility/box.h"
#include "visibility/scene.h"

/* Where guards may stand, what occludes, and what must be seen. */
typedef struct search_scene {
    starg_context *context;
    const starg_solid *solid;
    const starg_visibility_options *view;
    double clearance;
    visibility_scene *points; /* what a point sees */
    box_scene *boxes;         /* what a box may see */
    uint32_t
        *places; /* by column, its position in `points`: rank of the face, or slot of the vertex */
    STARG_ARRAY(uint32_t) witnesses; /* columns: the faces or vertices that stand for all */
    uint64_t work; /* tests of a vertex against a box or a point, each about a microsecond */
} search_scene;

/* Errors: MEMORY. */
starg_status search_scene_open(starg_context *context, const starg_solid *solid,
                               const starg_visibility_options *view, double clearance,
                               search_scene *out);
void search_scene_close(search_scene *scene);

/* A point where a guard may stand. */
typedef struct search_point {
    double place[3], direction[3], up[3]; /* the last two where views are directed */
    witness_row seen;
    uint32_t candidate; /* of the pool, or UINT32_MAX */
} search_point;

/* The centroid of the face of witness j, or the vertex. */
void search_scene_centre(const search_scene *scene, size_t j, double centre[3]);

/* Does the point see witness j? The point lies in the free space. */
bool search_scene_sees(const search_scene *scene, const search_point *point, size_t j,
                       uint64_t *work);

/* False if the plane of witness j already shows that a guard at p does not see it. */
bool search_scene_may_see(const search_scene *scene, const double p[3], size_t j);

typedef STARG_ARRAY(search_point) search_points;

/* Tests points that are not candidates against some witnesses. Errors: MEMORY, CANCELLED. */
starg_status points_look_at(search_scene *scene, search_point *points, size_t count,
                            const witness_row *among);

/* Tests every point against the witnesses from `first` on. Errors: MEMORY, CANCELLED. */
starg_status points_look(search_scene *scene, search_points *points, size_t first);

/* A box and its children: each point of the free space is in at least one leaf. */
typedef struct search_cell {
    bvh_box box;
    witness_row open;  /* superset of what points of the box in the free space see */
    uint32_t children; /* the first of two consecutive ones; 0: a leaf */
} search_cell;

typedef STARG_ARRAY(search_cell) search_cells;

/* The root: the box of all free space, with every witness open. Errors: MEMORY. */
starg_status cells_begin(const search_scene *scene, search_cells *cells);

/* Tests the cells against the witnesses from `first` on. Errors: MEMORY, CANCELLED. */
starg_status cells_look(search_scene *scene, search_cells *cells, size_t first);

/* The axis along which a cell is cut, in the middle. */
int cell_cut_axis(const bvh_box *box);
/* Can the box be cut in half? */
bool cell_splits(const bvh_box *box);
bvh_box cell_half(const bvh_box *box, bool upper);

/* Is the whole box closer to the boundary than guards may stand? */
bool search_scene_bars(const search_scene *scene, const bvh_box *box);

/* Per-thread memory for parallel loops over cells; their shared data begin with a pointer to the
 * scene. */
starg_status cells_worker_make(starg_context *context, void *shared, void **scratch);
void cells_worker_free(starg_context *context, void *scratch);

enum { MOST_TRIES = 12 };

/* Cuts leaves in the middle of their longest sides. Appends points of the children where a guard
 * may stand to `points`: the centre and random points, `tries` in all. Errors: MEMORY,
 * CANCELLED. */
starg_status cells_split(search_scene *scene, search_cells *cells, const uint32_t *leaves,
                         size_t count, int tries, search_points *points);

#endif
