/* SPDX-License-Identifier: Apache-2.0 */
/* A page to look at results: one HTML file with everything in it, for any browser, without network
 * (docs/viewer.md). */
#ifndef STARGUARD_PAGE_H
#define STARGUARD_PAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "context.h"
#include "guard.h"
#include "mesh.h"
#include "skeleton.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A model of a table of distances. */
typedef struct starg_page_shape {
    const char *name;
    const void *png; /* a small picture, or NULL */
    size_t png_size;
} starg_page_shape;

/* What a page shows. Every part may be missing (NULL or 0), not all of them. Names are text: a page
 * never runs what they hold. The structs are the caller's. */
typedef struct starg_page {
    const char *title; /* NULL: the model's name, or "starguard" */
    const starg_mesh *model;
    const char *model_name;
    const starg_guards *guards;
    const starg_bits
        *seen; /* with guards and model: a row for each guard, a column for each face */
    const starg_pieces_mesh *pieces;
    const starg_pieces_report *report; /* of the pieces */
    const starg_skeleton *skeleton;    /* positions, edges and radii count; radii may be NULL */
    const starg_mesh *const *frames;   /* of a morph: 2 or more meshes of the same faces */
    size_t frame_count;
    const starg_page_shape *shapes;
    size_t shape_count;
    const double *distances; /* shape_count x shape_count */
} starg_page;

/* Was the viewer there when this library was built? If not, no page can be written. */
STARG_API bool starg_page_available(void);

/* Writes a page; path "-" is standard output. A file appears whole or not at all; the same input
 * gives the same bytes. Coordinates are in single precision about the middle of all.
 * Errors: ARGUMENT (nothing to show; parts that do not fit one another: which), WRITE (also when
 * the library has no viewer), MEMORY, CANCELLED. */
STARG_API starg_status starg_page_write(starg_context *context, const starg_page *page,
                                        const char *path);

#ifdef __cplusplus
}
#endif

#endif
