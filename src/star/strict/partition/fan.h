/* SPDX-License-Identifier: Apache-2.0 */
/* Distributes pieces by a fan of triangles. */
#ifndef STARG_STAR_STRICT_PARTITION_FAN_H
#define STARG_STAR_STRICT_PARTITION_FAN_H

#include "star/strict/partition/partition.h"

enum { FAN_PIECES_MOST = 4, FAN_TAKERS_MOST = 24 };

/* Every facet of the pieces' union goes to a taker, together with the tetrahedron between it and
 * the apex. Takers are neighbours, or the first `kept` pieces, which are thereby replaced. */
typedef struct fan_plan {
    uint32_t pieces[FAN_PIECES_MOST];
    size_t piece_count, kept;
    uint32_t takers[FAN_TAKERS_MOST]; /* each receives something */
    size_t taker_count;
    double apex[3];                /* in unit coordinates */
    STARG_ARRAY(uint32_t) entries; /* of the union's surface: 2 * facet + side */
    STARG_ARRAY(uint8_t) takes;    /* for each: the index of its taker */
    STARG_ARRAY(uint32_t) corners; /* for each, x 3: by which it is found again */
} fan_plan;

void fan_plan_free(starg_context *context, fan_plan *plan);

/* Notes the corners of all entries. Errors: MEMORY. */
starg_status fan_plan_mark(const partition *p, fan_plan *plan);

/* The entries of a marked plan by the numbers of a partition with an index that has changed since;
 * the plan's own numbers of pieces are those of now. *found is false if some facet is gone. Errors:
 * MEMORY. */
starg_status fan_plan_find(const partition *p, fan_plan *plan, bool *found);

/* Applies the plan to the partition for which it was made, without proof. Pieces that are not kept
 * end up without facets, and the index becomes stale. Errors: MEMORY. */
starg_status partition_fan(partition *p, const fan_plan *plan);

#endif
