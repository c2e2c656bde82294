/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes in and around a solid, and points in them with a chance of seeing something. */
#ifndef TESTS_BOXES_H
#define TESTS_BOXES_H

#include <stddef.h>

#include "core/rng.h"
#include "geometry/bvh.h"
#include "starguard/solid.h"

/* By `kind`, cyclically: a cell of the bounding box, repeatedly halved around an inside point; a
 * random box around one; one between coordinates of vertices; one around a face; a flat one; a
 * point; one that contains everything. */
bvh_box box_about(const starg_solid *solid, starg_rng *rng, size_t kind);

/* Up to `wanted` points of the closed box, cyclically: uniform; on sides, edges and corners; on the
 * line through two vertices; just below a face; the centre. All are inside the solid according to
 * the library: other points could not show anything. */
size_t box_points(const starg_solid *solid, const bvh_box *box, starg_rng *rng, size_t wanted,
                  double *points);

#endif
