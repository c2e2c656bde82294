/* SPDX-License-Identifier: Apache-2.0 */
/* Interactive result pages: one self-contained HTML file for any browser, without network
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
#include "space.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A model of a distance table. */
typedef struct starg_page_shape {
    const char *name;
    const void *png; /* thumbnail, or NULL */
    size_t png_size;
} starg_page_shape;

/* Contents of a page. Parts may be missing (NULL or 0), but not all. Names are text: a page never
 * executes them. The caller owns the structs. */
typedef struct starg_page {
    const char *title; /* NULL: the model's name, or "starguard" */
    const starg_mesh *model;
    const char *model_name;
    const starg_mesh *obstacles; /* all that stand in the way, in one mesh; with guards */
    const starg_guards *guards;
    const char *command;    /* line that makes the guards again, or NULL */
    const starg_bits *seen; /* with guards and model: one row per guard, one column per face */
    const starg_certificate_outline *proof; /* of the guards' bound, with guards and model */
    const starg_pieces_mesh *pieces;
    const starg_pieces_report *report; /* of the pieces */
    const char *pieces_command;        /* line that makes pieces and report again, or NULL */
    const starg_solid_map *map;        /* between solids */
    const starg_skeleton *skeleton;    /* uses positions, edges and radii; radii may be NULL */
    const starg_mesh *const *frames;   /* of a morph: 2 or more meshes with the same faces */
    size_t frame_count;
    const starg_guards *ends[2]; /* corresponding guards of its first and last frame, or NULL */
    const starg_page_shape *shapes;
    size_t shape_count;
    const double *distances;   /* shape_count x shape_count */
    const char *table_command; /* line that writes them as a table, or NULL */
} starg_page;

/* Whether the library was built with the viewer. Without it, no page can be written. */
STARG_API bool starg_page_available(void);

/* Writes a page; path "-" is standard output. The file is written completely or not at all; the
 * same input gives the same bytes. Coordinates are stored in single precision relative to the
 * common centre. Errors: ARGUMENT (no content; inconsistent parts), WRITE (also if the library has
 * no viewer), MEMORY, CANCELLED. */
STARG_API starg_status starg_page_write(starg_context *context, const starg_page *page,
                                        const char *path);

/* Contents of a sheet about guards. The caller owns all of it; names may be NULL. */
typedef struct starg_sheet {
    const char *title, *command; /* the latter: the line that makes the guards again */
    const starg_solid *scene;    /* of the guards, as starg_guards_scene makes it */
    const starg_guards *guards;
    const starg_mesh *obstacles;     /* all that stand in the way, in one mesh; or NULL */
    const starg_face_groups *groups; /* of the model's faces; or NULL */
} starg_sheet;

/* Writes a sheet to be printed and handed over, one HTML file without scripts (docs/viewer.md): a
 * plan from above, what is seen through each lens, and tables; path "-" is standard output. It
 * needs no viewer. Errors: ARGUMENT (no scene or guards; another model), those of starg_visibility,
 * WRITE. */
STARG_API starg_status starg_sheet_write(starg_context *context, const starg_sheet *sheet,
                                         const char *path);

#ifdef __cplusplus
}
#endif

#endif
