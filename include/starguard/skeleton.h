/* SPDX-License-Identifier: Apache-2.0 */
/* The curve skeleton of a solid: a graph of points inside that runs along its middle and has its
 * topology. */
#ifndef STARGUARD_SKELETON_H
#define STARGUARD_SKELETON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "solid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_skeleton_options {
    size_t node_count; /* about how many nodes, 1 to 10,000,000; joints, ends and what loops need
                          are kept in any case                                              */
    double prune;      /* a branch must reach this many times as far from its joint as the solid is
                          wide there (half its width); 1 or more keeps fewer, the larger it is    */
} starg_skeleton_options;

/* 1,000 nodes; branches of 1.5 half widths. */
STARG_API void starg_skeleton_options_default(starg_skeleton_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_skeleton_options_fields(void);

/* A graph without parallel edges. Every node lies strictly inside the solid. */
typedef struct starg_skeleton {
    size_t node_count, edge_count, vertex_count;
    double *positions;      /* node_count x 3                                               */
    double *radii;          /* distance of each node from the surface                       */
    uint32_t *edges;        /* edge_count x 2                                               */
    uint32_t *vertex_nodes; /* of each of the solid's vertices: the node that stands for it */
    size_t components;      /* connected parts                                              */
    size_t loops;           /* edges - nodes + components                                   */
    size_t joints, ends;    /* nodes of three or more edges; of one                         */
    size_t cuts;            /* walls cut open: one for each cavity, and tiny voids          */
    size_t mends;           /* parts and loops cut that thin places gave and the solid has not */
    bool homotopic;         /* parts and loops are those of the solid, which is a handlebody, with
                               nothing cut or mended                                        */
} starg_skeleton;

/* Finds the skeleton; docs/skeleton.md tells how. A solid with cavities has no curve of its own
 * topology: what comes out then is that of the solid whose cavities are joined to the outside, with
 * a warning. `options` may be NULL.
 * Errors: ARGUMENT, MESH (too flat for tetrahedra), MEMORY, CANCELLED. */
STARG_API starg_status starg_skeleton_create(starg_context *context, const starg_solid *solid,
                                             const starg_skeleton_options *options,
                                             starg_skeleton **out);
STARG_API void starg_skeleton_free(starg_context *context, starg_skeleton *skeleton);

typedef enum starg_skeleton_format {
    STARG_SKELETON_AUTO = 0, /* by name                                      */
    STARG_SKELETON_OBJ = 1,  /* v and l                                      */
    STARG_SKELETON_CG = 2,   /* curve graph: a line of counts, v and e       */
    STARG_SKELETON_VTK = 3   /* legacy polydata; radii as data of the points */
} starg_skeleton_format;

/* Writes a skeleton; path "-" is standard output, for which a format must be named. A file appears
 * whole or not at all. Errors: ARGUMENT (no known file extension), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_skeleton_write(starg_context *context, const starg_skeleton *skeleton,
                                            const char *path, starg_skeleton_format format);

/* Reads what starg_skeleton_write has written; the content tells the format. Parts, loops, joints
 * and ends are counted; radii are NULL unless the file is VTK; what only the solid knows
 * (vertex_nodes, cuts, mends, homotopic) is missing. Errors: READ, FORMAT (with the line), MEMORY.
 */
STARG_API starg_status starg_skeleton_read(starg_context *context, const char *path,
                                           starg_skeleton **out);

/* The same from `size` bytes in memory; `name` stands in messages. */
STARG_API starg_status starg_skeleton_read_memory(starg_context *context, const void *bytes,
                                                  size_t size, const char *name,
                                                  starg_skeleton **out);

#ifdef __cplusplus
}
#endif

#endif
