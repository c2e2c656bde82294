/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes around the faces of a surface, for queries near a point, in a box, or along a segment. */
#ifndef STARG_VERIFY_TREE_H
#define STARG_VERIFY_TREE_H

#include "verify/surface.h"

typedef struct verify_tree verify_tree;

/* `surface` must outlive the tree. Errors: MEMORY. */
starg_status verify_tree_create(const verify_surface *surface, verify_tree **out);
void verify_tree_free(verify_tree *tree);

/* Called with a face; false ends the visit. */
typedef bool verify_visit(void *data, uint32_t face);

/* Visits every face whose bounds meet a closed box, in an order that depends only on the surface;
 * false if the visit was ended. */
bool verify_tree_visit(const verify_tree *tree, const double lower[3], const double upper[3],
                       verify_visit *visit, void *data);

/* Distance from p to the nearest face, rounded, in the model's own unit; infinite without faces. */
double verify_tree_distance(const verify_tree *tree, const double p[3], int scale);

/* Visits all faces that meet [p, q], and some others; false if the visit was ended. */
bool verify_tree_follow(const verify_tree *tree, const double p[3], const double q[3],
                        verify_visit *visit, void *data);

/* Does a face meet [p, q)? p lies on none. Exact. */
bool verify_tree_blocks(const verify_tree *tree, const double p[3], const double q[3]);

/* The surface of the tree. */
const verify_surface *verify_tree_surface(const verify_tree *tree);

/* verify_winding of all its faces, using only those near a segment (verify/winding.c). Exact. */
int verify_tree_winding(const verify_tree *tree, const double p[3], bool *on_surface);

#endif
