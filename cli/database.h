/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the database commands. */
#pragma once

#include <stdbool.h>

#include "session.h"
#include "starguard/database.h"
#include "starguard/shape.h"

/* ---- tables as comma-separated values (csv.c) ---- */
/* RFC 4180, reals with 17 significant digits. */

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

/* Options of the commands that compare scale and hand, members of a struct with `cli_weights`
 * WEIGHTS. */
typedef struct cli_weights {
    bool align;
    double scale, mirror;
} cli_weights;

#define CLI_ALIGN_OPTIONS(WEIGHTS)                                                                 \
    {CLI_OPTION("align", STARG_FIELD_FLAG, WEIGHTS.align, NULL,                                    \
                "Tell the scale, too, and whether one is a mirror image of the other, where a "    \
                "motion and scaling make copies of them.")},                                       \
        CLI_REAL_OPTION("weigh-scale", WEIGHTS.scale, "W", 0, 1e6, 0, NULL,                        \
                        "--align: add W for each doubling or halving of the size."),               \
        CLI_REAL_OPTION("weigh-mirror", WEIGHTS.mirror, "W", 0, 1e6, 0, NULL,                      \
                        "--align: add W where one is the mirror image of the other.")

/* Errors: ARGUMENT (a weight without --align). */
starg_status cli_weights_check(cli_session *session, const cli_weights *weights);
/* The distance with what the weights add. */
double cli_weigh(const cli_weights *weights, const starg_alignment *alignment, double distance);
/* "scale 2, mirrored (0.1 % of the diagonal; same 3 %)" */
void cli_say_alignment(cli_session *session, const starg_alignment *alignment);
/* {"scale", "hand", "same", "mirrored"} */
json_t *cli_json_alignment(const starg_alignment *alignment);

/* Opens the database given by the first operand. */
starg_status cli_database_open(cli_session *session, starg_database **out);
static inline void cli_database_drop(starg_database **database) {
    starg_database_close(*database);
}

/* The models of a database with all their distances (models->count squared). */
typedef struct cli_table {
    starg_database *database;
    starg_database_models *models;
    double *distances;
} cli_table;

/* `kind` is an index of cli_distance_words; `t` must be zero, and must be freed on failure as well.
 * An empty database is an error. */
starg_status cli_table_make(cli_session *session, const char *file, int kind, cli_table *t);
void cli_table_free(cli_table *t);

/* {"id", "name", "path", "vertices", "faces"} */
json_t *cli_json_model(const starg_database_model *model);
