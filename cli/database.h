/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the database commands. */
#pragma once

#include "session.h"
#include "starguard/database.h"

/* Tables as comma-separated values (RFC 4180), reals with 17 significant digits. */

typedef struct cli_csv {
    cli_session *session;
    const char *name; /* as announced */
    FILE *stream;
    bool line_begun;
} cli_csv;

/* Opens an announced output. Errors: WRITE. */
starg_status cli_csv_open(cli_session *session, const char *name, cli_csv *csv);

void cli_csv_text(cli_csv *csv, const char *text);
void cli_csv_real(cli_csv *csv, double value);
void cli_csv_end_line(cli_csv *csv);

/* Closes the table and reports write errors. Errors: WRITE. */
starg_status cli_csv_close(cli_csv *csv);

/* Returns the next field of a line (without its end), in place and unquoted; `*at` starts at the
 * line and is NULL after the last field, and then the result is NULL. Fields cannot contain line
 * breaks. */
char *cli_csv_field(char **at);

/* The words of --distance, in the order of starg_signature_kind; end with NULL. */
extern const char *const cli_distance_words[];

#define CLI_DISTANCE_OPTION                                                                        \
    CLI_CHOICE_OPTION(                                                                             \
        "distance", distance, cli_distance_words, STARG_SIGNATURE_DEFAULT,                         \
        "star|shape-dna|paper|d2",                                                                 \
        "What models are compared by: star, what is seen from the pieces of a star "               \
        "decomposition and how they conduct, whatever the pose; shape-dna, the spectrum of the "   \
        "surface; paper, the deformation of one guarding graph into the other; or d2, the "        \
        "distances between points of the surface.")

/* Opens the database given by the first operand. */
starg_status cli_database_open(cli_session *session, starg_database **out);

/* The models of a database with all their distances (models->count squared). */
typedef struct cli_table {
    starg_database *database;
    starg_database_models *models;
    double *distances;
} cli_table;

/* `kind` is an index of cli_distance_words; `t` must be zero, and must be freed on failure as well.
 * An empty database is an error. */
starg_status cli_table_make(cli_session *session, const char *file, int kind, cli_table *t);
void cli_table_free(cli_session *session, cli_table *t);

/* {"id", "name", "path", "vertices", "faces"} */
json_t *cli_json_model(const starg_database_model *model);
