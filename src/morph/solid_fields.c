/* SPDX-License-Identifier: Apache-2.0 */
/* The options of maps between solids, as a table (starguard/fields.h). */
#include "core/fields.h"
#include "morph/solid_map.h"
#include "starguard/solidmap.h"

enum { STEPS = 400, STEPS_MOST = 1000000 };
#define DENSITY_MOST 1000.0

static const starg_field OPTIONS[] = {
    {.key = "steps",
     .option = "steps",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_solid_map_options, steps),
     .most = STEPS_MOST,
     .initial = STEPS,
     .value = "N",
     .help = "With --solid: steps of descent in each solid that lower the distortion, fewer in "
             "proportion for more than 10,000 tetrahedra."},
    {.key = "density",
     .option = "density",
     .group = "search",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_solid_map_options, density),
     .high = DENSITY_MOST,
     .flags = STARG_FIELD_ABOVE,
     .standard = SOLIDS_DENSITY,
     .value = "T",
     .help = "With --solid: tetrahedra per vertex of A to begin with."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "solid map options", .size = sizeof(starg_solid_map_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_solid_map_options)
