/* SPDX-License-Identifier: Apache-2.0 */
/* The space of a search as a tree of boxes, and what each of them may see of the witnesses. */
#ifndef STARG_GUARD_CELLS_H
#define STARG_GUARD_CELLS_H

#include "core/memory.h"
#include "guard/witnesses.h"
#include "visibility/box.h"
#include "visibility/scene.h"

/* Where guards may stand, what hides, and what is to be seen. */
typedef struct search_scene {
    starg_context *context;
    const starg_solid *solid;
    const starg_visibility_options *view;
    double clearance;
    visibility_scene *points; /* what a point sees                                           */
    box_scene *boxes;         /* what a box may see                                          */
    uint32_t
        *places; /* by column: where `points` has it: rank of the face, or slot of the vertex */
    STARG_ARRAY(uint32_t) witnesses; /* columns: the faces or vertices that stand for all    */
    uint64_t work; /* vertices held against boxes and points, each about a microsecond       */
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

/* The middle of the face of witness j, or the vertex. */
void search_scene_centre(const search_scene *scene, size_t j, double centre[3]);

/* Does the point see witness j? Its place is in the free space. */
bool search_scene_sees(const search_scene *scene, const search_point *point, size_t j,
                       uint64_t *work);

/* False: a guard at p does not see witness j, which its plane tells. */
bool search_scene_may_see(const search_scene *scene, const double p[3], size_t j);

typedef STARG_ARRAY(search_point) search_points;

/* Looks from points that are no candidates at some witnesses. Errors: MEMORY, CANCELLED. */
starg_status points_look_at(search_scene *scene, search_point *points, size_t count,
                            const witness_row *among);

/* Looks from every point at the witnesses from `first` on. Errors: MEMORY, CANCELLED. */
starg_status points_look(search_scene *scene, search_points *points, size_t first);

/* A box and its parts: a point of the free space is in one leaf or more. */
typedef struct search_cell {
    bvh_box box;
    witness_row open;  /* all that any point of the box in the free space sees, and perhaps more */
    uint32_t children; /* the first of two, which follow one another; 0: a leaf                  */
} search_cell;

typedef STARG_ARRAY(search_cell) search_cells;

/* The box of all free space, of which nothing is known. Errors: MEMORY. */
starg_status cells_begin(const search_scene *scene, search_cells *cells);

/* Looks from the cells at the witnesses from `first` on. Errors: MEMORY, CANCELLED. */
starg_status cells_look(search_scene *scene, search_cells *cells, size_t first);

/* A cell is cut in the middle of this axis. */
int cell_cut_axis(const bvh_box *box);
/* Can the box be cut in half? */
bool cell_splits(const bvh_box *box);
bvh_box cell_half(const bvh_box *box, bool upper);

/* Is the whole box closer to the boundary than guards may stand? */
bool search_scene_bars(const search_scene *scene, const bvh_box *box);

/* Memory of a thread in parallel loops over cells, whose shared data begin with a pointer to the
 * scene. */
starg_status cells_worker_make(starg_context *context, void *shared, void **scratch);
void cells_worker_free(starg_context *context, void *scratch);

enum { MOST_TRIES = 12 };

/* Cuts leaves in the middle of their longest sides. Points of the parts where a guard may stand,
 * the centre and others at random, `tries` in all, are appended to `points`. Errors: MEMORY,
 * CANCELLED.
 */
starg_status cells_split(search_scene *scene, search_cells *cells, const uint32_t *leaves,
                         size_t count, int tries, search_points *points);

#endif
