/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy of eight boxes a node, for many single segments. */
#pragma once

#include "geometry/bvh.h"

typedef struct sight_tree sight_tree;

/* Made from a tree, which must outlive it, for segments within a box that contains the tree.
 * Errors: MEMORY. */
starg_status sight_tree_create(starg_context *context, const bvh *tree, const bvh_box *all,
                               sight_tree **out);
void sight_tree_free(sight_tree *tree);
STARG_DROP(sight_tree, sight_tree)

/* Calls visit with the rank of every triangle that the segment p q may meet, those near p first as
 * far as boxes tell, until it returns false; returns false exactly if visit did. p and q lie in
 * the box. */
bool sight_tree_query(const sight_tree *tree, const double p[3], const double q[3],
                      bvh_visit_rank *visit, void *user);
