/* SPDX-License-Identifier: Apache-2.0 */
/* Partitions into closed surfaces against their definition, slowly, and partitions to test with. */
#ifndef TESTS_PARTITION_ORACLE_H
#define TESTS_PARTITION_ORACLE_H

#include "core/rng.h"
#include "star/strict/partition/partition.h"

/* Asserts what holds of every partition with an index: facets between two different pieces, or a
 * piece and the outside, none of them degenerate; every piece closed; no number unused; unit
 * coordinates and index as they are said to be. */
void partition_oracle_check(const partition *p);

/* The same, and that every guard is strictly inside of its piece's facets, in rationals, and wound
 * around once; volumes and radii as they are told. */
void partition_oracle_check_guards(const partition *p);

/* Asserts that the outer facets cover those of an earlier state of the partition, each by facets of
 * its own plane. */
void partition_oracle_check_surface(const partition *first, const partition *p);

/* In unit coordinates, from the facets. */
double partition_oracle_volume(const partition *p, uint32_t number);

/* The piece whose surface winds around a point (unit coordinates), by solid angles; OUTSIDE. */
uint32_t partition_oracle_locate(const partition *p, const double point[3]);

/* The same arrays, byte by byte, index included. */
bool partition_oracle_same(const partition *a, const partition *b);

/* A copy with an index. */
partition partition_oracle_copy(const partition *from);

/* The hull of random points as one piece, with a guard in it. */
partition random_hull(starg_context *context, uint64_t seed, size_t points);

/* A procedural sample of about so many tetrahedra, grown into regions
 * (star/strict/region_growing.h). */
partition grown_sample(starg_context *context, const char *name, size_t target);

/* Delaunay tetrahedra of random points (at most 100), with holes, each a piece of its own. */
partition random_cells(starg_context *context, uint64_t seed, size_t points);

/* A plane that has vertices of a piece on either side. */
partition_plane random_plane_across(const partition *p, uint32_t number, starg_rng *rng);

#endif
