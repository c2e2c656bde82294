/* SPDX-License-Identifier: Apache-2.0 */
/* The space of a search as a tree of boxes, with the witnesses that each may see. */
#ifndef STARG_GUARD_CELLS_H
#define STARG_GUARD_CELLS_H

#include "guard/search_scene.h"

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

#endif
