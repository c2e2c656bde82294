/* Carrying out a plan of cuts, with proof. */
#ifndef STARG_STAR_STRICT_APPLY_H
#define STARG_STAR_STRICT_APPLY_H

#include "star/strict/recut.h"

/* Joins `count` pieces and cuts their union as planned. Every piece that results, and every other
 * one whose facets were split, is certified; if one fails, or if the sum of squares of the new
 * pieces is not above `least`, *done is false and the partition as it was. Guards of the new pieces
 * are the centres of their kernels, at least `margin` (unit coordinates) inside. The index is built
 * again. Errors: MEMORY. */
starg_status apply_plan(partition *p, const uint32_t *pieces, size_t count, const recut_plan *plan,
                        double margin, double least, region_scratch *scratch, bool *done);

/* Of the volumes of pieces (unit coordinates): the larger, the more uneven they are. */
double sum_of_squares(const partition *p, const uint32_t *pieces, size_t count);

#endif
