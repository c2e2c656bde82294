/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles that a segment may meet, four boxes at a time in single precision. */
#ifndef STARG_VISIBILITY_BOX_TREE_H
#define STARG_VISIBILITY_BOX_TREE_H

#include "geometry/bvh.h"

typedef struct box_tree box_tree;

/* Folds two levels of the tree into one; triangles keep their ranks. `centre` and `extent` are
 * those of the bounding box. Errors: MEMORY. */
starg_status box_tree_create(starg_context *context, const bvh *tree, const double centre[3],
                             double extent, box_tree **out);
void box_tree_free(box_tree *tree);

/* bvh_query_segment for p and q in the bounding box; triangles come one by one where their own
 * boxes may be met, in an order that the tree and the segment give. */
bool box_tree_query(const box_tree *tree, const double p[3], const double q[3],
                    bvh_visit_rank *visit, void *user);

#endif
