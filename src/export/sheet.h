/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of a sheet: the plan, and what is seen through each lens (export/sheet_pictures.c). */
#pragma once

#include "guard/stages.h"
#include "starguard/page.h"

/* What is drawn. Faces of `shown` are the patches, columns of the table's rows. */
typedef struct sheet_scene {
    const seen_table *table;
    const starg_mesh *shown, *obstacles; /* the latter may be NULL */
    double level[3][3];                  /* right, up, ahead: of the plan, and of pan 0 */
} sheet_scene;

typedef struct sheet_picture {
    uint8_t *png; /* free with starg_release */
    size_t size, width, height;
} sheet_picture;

/* From above: x = origin + scale * (right . p), y likewise downwards, in pixels. */
typedef struct sheet_plan {
    sheet_picture picture;
    double x, y, scale;
} sheet_plan;

/* Faces that look up, below the highest guard, in the colours of how many guards see them. Errors:
 * MEMORY, CANCELLED. */
starg_status sheet_draw_plan(starg_context *context, const sheet_scene *scene, sheet_plan *out);

/* The view of a guard that looks in one direction, as wide as its field of view, or as its cone,
 * but no wider than SHEET_WIDEST degrees. What it sees has its colour. Errors: MEMORY, CANCELLED.
 */
#define SHEET_WIDEST 140.0
starg_status sheet_draw_lens(starg_context *context, const sheet_scene *scene, size_t guard,
                             sheet_picture *out);
