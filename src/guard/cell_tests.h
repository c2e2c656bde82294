/* SPDX-License-Identifier: Apache-2.0 */
/* Which witnesses boxes may see, and what points in them see: the loop in which a search spends
 * most of its time. Other processes can help. */
#ifndef STARG_GUARD_CELL_TESTS_H
#define STARG_GUARD_CELL_TESTS_H

#include "core/parallel.h"
#include "guard/search_scene.h"

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

#endif
