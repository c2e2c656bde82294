/* SPDX-License-Identifier: Apache-2.0 */
/* map --solid: maps between solids. */
#ifndef STARGUARD_CLI_MAP_SOLID_H
#define STARGUARD_CLI_MAP_SOLID_H

#include "session.h"
#include "starguard/solidmap.h"

/* The options that concern solids. */
typedef struct cli_solid_map {
    bool solid, overlay;
    const char *output, *map, *landmarks, *points, *field, *carried;
    bool back;
    int shape; /* 0: B, else a starg_solid_shape plus 1 */
    const starg_solid_map_options *wanted;
} cli_solid_map;

/* Words of --to. */
extern const char *const cli_solid_shapes[];

/* Checks options, and announces outputs. */
starg_status cli_solid_map_prepare(cli_session *session, const cli_solid_map *v);

/* The first operand has been read into the session. */
starg_status cli_solid_map_run(cli_session *session, const cli_solid_map *v);

#endif
