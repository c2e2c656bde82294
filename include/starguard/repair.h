/* SPDX-License-Identifier: Apache-2.0 */
/* Turns a defective mesh into the boundary of a solid. */
#ifndef STARGUARD_REPAIR_H
#define STARGUARD_REPAIR_H

#include <stdbool.h>
#include <stddef.h>

#include "check.h"
#include "context.h"
#include "fields.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_repair_options {
    double merge_distance; /* merge vertices within this fraction of the diagonal */
    size_t max_hole_edges; /* do not fill larger holes; 0: no limit */
    size_t max_rounds;     /* attempts to resolve self-intersections                         */
    double max_change;     /* refuse a larger change of the volume, a fraction of it */
    bool unite;            /* return the boundary of all that is enclosed, free of intersections */
} starg_repair_options;

/* 0 (only what rounding keeps apart), no limit, 10 rounds, 0.01, no union. */
STARG_API void starg_repair_options_default(starg_repair_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_repair_options_fields(void);

/* Changes made by a repair. */
typedef struct starg_repair_report {
    size_t vertices_merged, vertices_dropped, vertices_split, vertices_moved, vertices_added;
    size_t faces_dropped, faces_turned, faces_added, holes_filled;
    size_t faces_divided;      /* into parts, where other parts of the surface touch them */
    size_t components_dropped; /* components without volume */
    size_t intersections_before, intersections_after;
    double largest_move; /* of a kept vertex, in model units */
    double conforming;   /* how far apart things were at most that were joined */
    /* `unite` only: input faces of which only parts are left; how often faces were cut; how far a
     * new vertex lies at most from the exact intersection, in model units. */
    size_t faces_cut, union_rounds;
    double rounding;
    /* The volume that shells enclose, each by itself and in whatever way it is turned; that before,
     * with what touches joined, only where the surface is closed then. */
    bool closed_before;
    double enclosed_before, enclosed_after;
    size_t sheets_kept; /* open sheets that were closed, and not turned for want of a proof */
    bool in_vain;       /* it was a solid, and intersects itself as often as before */
    char grid[256];     /* starg_check_describe_grid of the result: empty unless it is coarse */
} starg_repair_report;

/* Repairs a mesh; a valid mesh is returned unchanged. Overlapping components are kept, unless
 * `unite` is set: then faces that meet are cut along what they share, and what bounds the region of
 * winding number 1 or more is returned. Faces that meet no others stay, all vertices keep their
 * coordinates, and no two faces of the result intersect. `options` may be NULL. *report is zero on
 * failure. Errors: ARGUMENT (merge_distance not in [0, 1]), MESH if the result is not a usable
 * solid (the message lists the remaining defects), MEMORY, CANCELLED; RANGE if intersecting faces
 * span too many powers of two. */
STARG_API starg_status starg_mesh_repair(starg_context *context, const starg_mesh *mesh,
                                         const starg_repair_options *options, starg_mesh **out,
                                         starg_repair_report *report);

#ifdef __cplusplus
}
#endif

#endif
