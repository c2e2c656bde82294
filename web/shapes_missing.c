/* SPDX-License-Identifier: Apache-2.0 */
/* In place of starguard-shapes and its tables of distances, which `view` would show. */
#include "commands.h"
#include "database.h"

const char *const cli_distance_words[] = {"star", "shape-dna", "paper", "d2", NULL};

starg_status cli_table_make(cli_session *session, const char *file, int kind, cli_table *t) {
    (void)kind, (void)t;
    return cli_fail(session, STARG_ERROR_READ,
                    "'%.300s' is a database, which this program cannot read", file);
}

void cli_table_free(cli_session *session, cli_table *t) {
    (void)session, (void)t;
}

/* Not reached: there is no table. */
starg_status cli_matrix_command(cli_session *session, const char *database, int distance,
                                const char *output, char **line) {
    (void)session, (void)database, (void)distance, (void)output;
    *line = NULL;
    return STARG_OK;
}
