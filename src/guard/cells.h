/* SPDX-License-Identifier: Apache-2.0 */
/* The space of a search as boxes, and the witnesses that its points and boxes see. */
#pragma once

#include "core/bits.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "visibility/box.h"
#include "visibility/kernel.h"
#include "visibility/scene.h"

/* ---- rows of bits over the witnesses: faces (or vertices) that represent all of them ---- */

enum { MOST_WITNESSES = 2048, WITNESS_WORDS = MOST_WITNESSES / 64 };

typedef struct witness_row {
    uint64_t bits[WITNESS_WORDS];
} witness_row;

/* Is every witness of `a` in `b`? */
static inline bool row_is_within(const witness_row *a, const witness_row *b) {
    uint64_t outside = 0;
    for (int w = 0; w < WITNESS_WORDS; w++)
        outside |= a->bits[w] & ~b->bits[w];
    return outside == 0;
}

static inline double row_value(const witness_row *row, const double *prices) {
    double sum = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            sum += prices[64 * w + bit];
    return sum;
}

/* ---- what a search looks at: solid, witnesses, what points see of them (search_scene.c) ---- */

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

/* ---- the space as a tree of boxes, with the witnesses that each may see (cells.c) ---- */

/* A box, for guards in some parts of the solid, and its children: each point of the free space is
 * in at least one leaf for its part. */
typedef struct search_cell {
    bvh_box box;
    uint32_t first_part, end_part; /* parts from the first up to the end, without that */
    witness_row open;              /* superset of what points of the box in the free space see */
    uint32_t children;             /* the first of two consecutive ones; 0: a leaf */
    bool trimmed; /* one child is outside of the free space: only the other one is tested */
    bool parted;  /* the children are for some of the parts each, and have the same box */
} search_cell;

typedef STARG_ARRAY(search_cell) search_cells;

/* The root, the box of all free space, and a leaf of it for each part; with no witness yet. Errors:
 * MEMORY. */
starg_status cells_begin(const search_scene *scene, search_cells *cells);

/* Tests the cells against the witnesses from `first` on. Errors: MEMORY, CANCELLED, RANK. */
starg_status cells_look(const search_scene *scene, search_cells *cells, size_t first,
                        uint64_t *work);

/* The axis along which a cell is cut, in the middle. */
int cell_cut_axis(const bvh_box *box);
/* The length of the longest side. */
double cell_length(const bvh_box *box);
/* Can the box be cut in half? */
bool cell_splits(const bvh_box *box);
bvh_box cell_half(const bvh_box *box, bool upper);

enum { MOST_TRIES = 12 };

/* Cuts leaves in the middle of their longest sides. Appends points of the children where a guard
 * may stand to `points`: the centre and random points, `tries` in all. Errors: MEMORY,
 * CANCELLED, RANK. */
starg_status cells_split(const search_scene *scene, search_cells *cells, const uint32_t *leaves,
                         size_t count, int tries, search_points *points, uint64_t *work);

/* A leaf, the highest score first. */
typedef struct scored_leaf {
    double score;
    uint32_t cell;
} scored_leaf;

typedef STARG_ARRAY(scored_leaf) leaf_list;

/* By decreasing score, then by number. */
int cells_by_score(const void *a, const void *b);

/* Sorts the leaves and splits those at the front that can be split, about a quarter of them, with
 * `tries` points in each part, of which the useful ones stay. *any: there are some. Errors: those
 * of cells_split. */
starg_status cells_split_best(const search_scene *scene, search_cells *cells, leaf_list *list,
                              int tries, search_points *points, bool *any, uint64_t *work);

/* ---- what boxes and points in them see: the loop of most time (cell_tests.c) ---- */
/* Other processes can help (guard/cell_tests_remote.c). */

typedef struct cell_test {
    bvh_box box;
    witness_row among; /* the witnesses that are asked about */
} cell_test;

typedef struct cell_answer {
    witness_row open;       /* superset of what points of the box in the free space see */
    box_cut cuts[BOX_CUTS]; /* where parts outside of the free space were cut off before */
    int64_t cut_count;
    uint64_t work;
    uint64_t point_count; /* at most `tries` */
} cell_answer;

typedef struct cell_tests {
    const search_scene *scene; /* first member, as cells_worker_make requires */
    const cell_test *tests;
    size_t count;
    size_t first; /* number of the first test's box: with it random points are chosen */
    int tries;    /* points in each box: the centre and random ones; 0: boxes stay as they are */
    cell_answer *answers;
    search_point *points; /* `tries` for each box; those that may not be used are left out. Ignored
                             if tries is 0 */
} cell_tests;

/* The points of test i. */
static inline search_point *cell_tests_points(const cell_tests *tests, size_t i) {
    return tests->tries > 0 ? tests->points + i * (size_t)tests->tries : NULL;
}

/* Fills answers and points, which the caller has allocated. Errors: MEMORY, CANCELLED, RANK. */
starg_status cell_tests_run(starg_context *context, cell_tests *tests,
                            const starg_parallel_remote *remote);

/* Same, with the help of other processes where that pays. */
starg_status cell_tests_share(starg_context *context, cell_tests *tests);

/* Per-thread memory for parallel loops over boxes; their shared data begin with a pointer to the
 * scene. */
starg_status cells_worker_make(starg_context *context, void *shared, void **scratch);
void cells_worker_free(starg_context *context, void *scratch);

/* Tests boxes for another process. */
extern const ranks_work cells_ranks_work STARG_PRIVATE(cells_ranks_work);
