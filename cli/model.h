/* SPDX-License-Identifier: Apache-2.0 */
/* Reads and writes models and coloured models for several commands. */
#ifndef STARGUARD_CLI_MODEL_H
#define STARGUARD_CLI_MODEL_H

#include "session.h"
#include "starguard/bits.h"
#include "starguard/descriptor.h"
#include "starguard/mesh.h"
#include "starguard/solid.h"
#include "starguard/tetra.h"

/* Reads the first operand into the session, and starts the report with it. */
starg_status cli_input_read(cli_session *session);

/* Reads a surface or a tetrahedral mesh, recognized by content; the other one is NULL. */
starg_status cli_shape_read(cli_session *session, const char *file, starg_mesh **mesh,
                            starg_tetmesh **tetmesh);

/* Reads a model or its descriptor, recognized by content; the other one is NULL. */
starg_status cli_described_read(cli_session *session, const char *file, starg_mesh **mesh,
                                starg_descriptor **descriptor);

/* The format of an output mesh by its file extension; OFF for "-". Errors: ARGUMENT. */
starg_status cli_mesh_format(cli_session *session, const char *name, starg_mesh_format *format);

/* Writes a mesh with face colours (or NULL) to an announced output. */
starg_status cli_mesh_write(cli_session *session, const starg_mesh *mesh, starg_mesh_format format,
                            const uint8_t *colors, const char *name);

/* The same with options of any kind. */
starg_status cli_mesh_write_with(cli_session *session, const starg_mesh *mesh,
                                 const starg_mesh_write_options *options, const char *name);

/* Neutral colours for the faces of a mesh; NULL when out of memory. */
uint8_t *cli_colors_create(const starg_mesh *mesh);

/* Gives each face the colour of the first row of `seen` that contains it; leaves the others. */
void cli_colors_by_viewer(uint8_t *colors, const starg_bits *seen);

/* Areas of all faces as fractions of their sum; NULL when memory is out. */
double *cli_area_fractions(const starg_mesh *mesh, size_t count);

/* An array of the set columns of a row. */
json_t *cli_json_row(cli_session *session, const starg_bits *bits, size_t row);

/* An array of `count` indices. */
json_t *cli_json_indices(cli_session *session, const uint32_t *indices, size_t count);

/* "1 face" or "7 faces". */
typedef struct cli_amount {
    char text[64];
} cli_amount;
cli_amount cli_count_of(size_t count, const char *singular, const char *plural);

#endif
