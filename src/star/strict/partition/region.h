/* SPDX-License-Identifier: Apache-2.0 */
/* The input of a search for cuts: the surface of a union of pieces and the half-spaces that a guard
 * must be in. */
#ifndef STARG_STAR_STRICT_PARTITION_REGION_H
#define STARG_STAR_STRICT_PARTITION_REGION_H

#include "star/strict/partition/partition.h"

/* A triangle, counter-clockwise seen from outside, or a segment along an earlier cut (then two
 * corners are the same). */
typedef struct region_triangle {
    uint32_t corners[3], row;
} region_triangle;

/* All in unit coordinates. A guard of the whole region is strictly inside every row. */
typedef struct region {
    STARG_ARRAY(double) vertices; /* x 3 */
    STARG_ARRAY(region_triangle) triangles;
    STARG_ARRAY(double) rows;   /* x 4: outward normal of length one, offset; one for each plane */
    STARG_ARRAY(double) blocks; /* the same for the scan (star/strict/search/scan.h) */
    size_t first_rows;          /* number of rows of the first piece, which come first */
} region;

/* How far a star-shaped part of a region reaches: below a plane with this `normal` at any height up
 * to `height`, the guard is inside every row by the margin (at least where it may stay). */
typedef struct region_reach {
    double height; /* -INFINITY: nowhere; INFINITY: all of the region has a kernel */
    double guard[3];
} region_reach;

typedef STARG_ARRAY(double) region_values;

/* Working memory of one thread. */
typedef struct region_scratch {
    starg_context *context;
    STARG_ARRAY(uint32_t) vertex_of; /* by the partition's vertex: 1 + the region's, or 0 */
    STARG_ARRAY(uint32_t) row_of;    /* by 2 * plane + side: likewise */
    STARG_ARRAY(uint32_t) piece_of;  /* by piece: likewise */
    region_values heights;           /* of vertices along a direction */
    region_values lowest;            /* of rows likewise: their lowest vertex */
    region_values lowest_back;       /* the same along the opposite direction */
    uint64_t work;                   /* vertices, facets and rows visited so far */
} region_scratch;

void region_scratch_free(region_scratch *scratch);

/* Makes room in the tables, which are all zero between calls, for the partition. Errors: MEMORY. */
starg_status region_scratch_fit(region_scratch *scratch, const partition *p);

/* For the threads of a parallel loop (core/parallel.h); nothing is shared. Errors: MEMORY. */
starg_status region_make_scratch(starg_context *context, void *shared, void **out);
void region_free_scratch(starg_context *context, void *scratch);

/* The union of `count` pieces of a partition with an index. Replaces the contents of `region`.
 * Errors: MEMORY. */
starg_status region_gather(const partition *p, const uint32_t *pieces, size_t count,
                           region_scratch *scratch, region *out);

/* The same from about `most` facets of each piece, evenly spaced in its list (fewer than twice as
 * many): if these leave no room for a guard, all facets leave none. */
starg_status region_gather_some(const partition *p, const uint32_t *pieces, size_t count,
                                uint32_t most, region_scratch *scratch, region *out);
void region_free(starg_context *context, region *r);

/* Of the box around all vertices. */
double region_diagonal(const region *r);

/* The blocks of the rows, after these were made. Errors: MEMORY. */
starg_status region_make_blocks(starg_context *context, region *r);

/* The part of a region above a plane, closed by it. Errors: MEMORY. */
starg_status region_clip(starg_context *context, const region *from, const double normal[3],
                         double height, region *out);

/* Volume of a part that region_clip has cut off by this plane. */
double region_volume_above(const region *part, const double normal[3], double height);

/* The highest plane along `normal` whose lower part has a kernel, with a guard inside by about
 * `margin` (at least half of it); and, unless `down` is NULL, the same for the upper part along the
 * opposite direction (its height is minus the lowest position of the plane), if the lower part
 * exists. Errors: MEMORY. */
starg_status region_find_reach(const region *r, const double normal[3], double margin,
                               region_scratch *scratch, region_reach *up, region_reach *down);

/* A place inside all rows whose distance to `center` is below the height of `out`, a squared
 * distance; the height is as large as possible. Errors: MEMORY. */
starg_status region_find_reach_about(const region *r, const double center[3], double margin,
                                     region_scratch *scratch, region_reach *out);

/* The same, but always inside all rows of the region's first piece. Errors: MEMORY. */
starg_status region_find_reach_beyond(const region *r, const double center[3], double margin,
                                      region_scratch *scratch, region_reach *out);

/* The same, but always inside all rows that `other` is not inside of by the margin. Errors: MEMORY.
 */
starg_status region_find_reach_for(const region *r, const double center[3], const double other[3],
                                   double margin, region_scratch *scratch, region_reach *out);

/* Centre and radius of the largest ball inside all rows or, if `normal` is not NULL, inside those
 * with a vertex below a plane and the plane itself. The radius is negative if there is none.
 * Errors: MEMORY. */
starg_status region_find_center(const region *r, const double *normal, double height,
                                region_scratch *scratch, double center[3], double *radius);

#endif
