/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a solid's boundary of a mesh that is nearly one. */
#ifndef STARGUARD_REPAIR_H
#define STARGUARD_REPAIR_H

#include <stddef.h>

#include "check.h"
#include "context.h"
#include "fields.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_repair_options {
    double merge_distance; /* vertices this close become one; fraction of the diagonal       */
    size_t max_hole_edges; /* larger holes are left open; 0: no limit                        */
    size_t max_rounds;     /* attempts to resolve self-intersections                         */
} starg_repair_options;

/* 0 (exactly equal positions only), no limit, 10 rounds. */
STARG_API void starg_repair_options_default(starg_repair_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_repair_options_fields(void);

/* What was done. */
typedef struct starg_repair_report {
    size_t vertices_merged, vertices_dropped, vertices_split, vertices_moved, vertices_added;
    size_t faces_dropped, faces_turned, faces_added, holes_filled;
    size_t components_dropped; /* pieces without volume                                  */
    size_t intersections_before, intersections_after;
    double largest_move; /* of a vertex that was kept, in units of the coordinates */
} starg_repair_report;

/* Mends what can be mended; a mesh that needs nothing comes back as it is. Components that overlap
 * are left so. `options` may be NULL. *report is zero on failure. Errors: ARGUMENT (merge_distance
 * not in [0, 1]), MESH when the result would still not be a usable solid (the message says what is
 * left), MEMORY, CANCELLED. */
STARG_API starg_status starg_mesh_repair(starg_context *context, const starg_mesh *mesh,
                                         const starg_repair_options *options, starg_mesh **out,
                                         starg_repair_report *report);

#ifdef __cplusplus
}
#endif

#endif
