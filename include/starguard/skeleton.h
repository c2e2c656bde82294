/* SPDX-License-Identifier: Apache-2.0 */
/* The curve skeleton of a solid: an interior graph along its centre with the same topology. */
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
    size_t node_count; /* approximate number, 1 to 10,000,000; joints, ends and loops are always
                          kept */
    double prune; /* remove branches shorter than this multiple of the local half-width at their
                     joint; 1 or more */
} starg_skeleton_options;

/* 1,000 nodes; branches of 1.5 half-widths. */
STARG_API void starg_skeleton_options_default(starg_skeleton_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_skeleton_options_fields(void);

/* A graph without parallel edges. Every node is strictly inside the solid. */
typedef struct starg_skeleton {
    size_t node_count, edge_count, vertex_count;
    double *positions;      /* node_count x 3                                               */
    double *radii;          /* distance of each node from the surface                       */
    uint32_t *edges;        /* edge_count x 2                                               */
    uint32_t *vertex_nodes; /* per vertex of the solid: its node */
    size_t components;      /* connected components */
    size_t loops;           /* edges - nodes + components                                   */
    size_t joints, ends;    /* nodes of three or more edges; of one                         */
    size_t cuts;            /* cut walls: one per cavity, and tiny voids */
    size_t mends;           /* components and loops removed because the solid does not have them */
    bool
        homotopic; /* same components and loops as the solid, a handlebody, without cuts or mends */
} starg_skeleton;

/* Computes the skeleton (docs/skeleton.md). A solid with cavities has no curve of the same
 * topology: the result then belongs to the solid with its cavities joined to the outside, with a
 * warning. `options` may be NULL. Errors: ARGUMENT, MESH (too flat for tetrahedra), MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_skeleton_create(starg_context *context, const starg_solid *solid,
                                             const starg_skeleton_options *options,
                                             starg_skeleton **out);
STARG_API void starg_skeleton_free(starg_context *context, starg_skeleton *skeleton);

typedef enum starg_skeleton_format {
    STARG_SKELETON_AUTO = 0, /* by name                                      */
    STARG_SKELETON_OBJ = 1,  /* v and l                                      */
    STARG_SKELETON_CG = 2,   /* curve graph: a line of counts, v and e       */
    STARG_SKELETON_VTK = 3,  /* legacy polydata; radii as point data */
    STARG_SKELETON_SWC = 4   /* nodes with radius and parent; trees only */
} starg_skeleton_format;

/* Writes a skeleton; path "-" is standard output and needs a format. The file is written completely
 * or not at all. Errors: ARGUMENT (unknown file extension), MESH (a loop, which SWC cannot
 * hold), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_skeleton_write(starg_context *context, const starg_skeleton *skeleton,
                                            const char *path, starg_skeleton_format format);

/* Reads a file of starg_skeleton_write, recognized by content. Components, loops, joints and ends
 * are counted; radii are NULL unless the file is VTK or SWC; vertex_nodes, cuts, mends and
 * homotopic are not stored. Errors: READ, FORMAT (with the line), MEMORY. */
STARG_API starg_status starg_skeleton_read(starg_context *context, const char *path,
                                           starg_skeleton **out);

/* The same from `size` bytes in memory; `name` is used in messages. */
STARG_API starg_status starg_skeleton_read_memory(starg_context *context, const void *bytes,
                                                  size_t size, const char *name,
                                                  starg_skeleton **out);

#ifdef __cplusplus
}
#endif

#endif
