/* SPDX-License-Identifier: Apache-2.0 */
/* Checks partitions into closed surfaces against their definition, slowly, and makes partitions for
 * tests. */
#ifndef TESTS_PARTITION_ORACLE_H
#define TESTS_PARTITION_ORACLE_H

#include "core/rng.h"
#include "star/certified/partition.h"

/* Asserts the invariants of a partition with an index: facets lie between two different pieces, or
 * a piece and the outside, and are not degenerate; every piece is closed; all numbers are in use;
 * unit coordinates and index are consistent. */
void partition_oracle_check(const partition *p);

/* Same, and that every guard is strictly inside its piece's facets, in rationals, with winding
 * number one; that volumes and radii are correct. */
void partition_oracle_check_guards(const partition *p);

/* Asserts that the outer facets cover those of an earlier state of the partition, each by facets in
 * its plane. */
void partition_oracle_check_surface(const partition *first, const partition *p);

/* In unit coordinates, from the facets. */
double partition_oracle_volume(const partition *p, uint32_t number);

/* The piece whose surface winds around a point (unit coordinates), by solid angles; or OUTSIDE. */
uint32_t partition_oracle_locate(const partition *p, const double point[3]);

/* Are all arrays equal byte by byte, including the index? */
bool partition_oracle_same(const partition *a, const partition *b);

/* A copy with an index. */
partition partition_oracle_copy(const partition *from);

/* The hull of random points as one piece, with a guard. */
partition random_hull(starg_context *context, uint64_t seed, size_t points);

/* A procedural sample of about `target` tetrahedra, grown into regions
 * (star/certified/region_growing.h). */
partition grown_sample(starg_context *context, const char *name, size_t target);

/* Delaunay tetrahedra of random points (at most 100), with holes, each a separate piece. */
partition random_cells(starg_context *context, uint64_t seed, size_t points);

/* A plane with vertices of a piece on both sides. */
partition_plane random_plane_across(const partition *p, uint32_t number, starg_rng *rng);

#endif
