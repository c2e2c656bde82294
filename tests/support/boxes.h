/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes in and about a solid, and points of them from which something might be seen after all. */
#ifndef TESTS_BOXES_H
#define TESTS_BOXES_H

#include <stddef.h>

#include "core/rng.h"
#include "geometry/bvh.h"
#include "starguard/solid.h"

/* By turns of `kind`: a cell of the bounding box, halved again and again about an inside point; a
 * random box about one; one between coordinates of vertices; one about a face; a flat one; a point;
 * one that holds all. */
bvh_box box_about(const starg_solid *solid, starg_rng *rng, size_t kind);

/* Up to `wanted` points of the closed box, by turns: uniform; on sides, edges and corners; on the
 * line through two vertices; close under a face; the centre. All are inside the solid, by the
 * library's word: a point that is not could not show anything. */
size_t box_points(const starg_solid *solid, const bvh_box *box, starg_rng *rng, size_t wanted,
                  double *points);

#endif
