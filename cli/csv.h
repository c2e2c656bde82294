/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as comma-separated values (RFC 4180), reals with 17 significant digits. */
#ifndef STARGUARD_CLI_CSV_H
#define STARGUARD_CLI_CSV_H

#include "session.h"

typedef struct cli_csv {
    cli_session *session;
    const char *name; /* as it was announced */
    FILE *stream;
    bool line_begun;
} cli_csv;

/* Opens an announced output. Errors: WRITE. */
starg_status cli_csv_open(cli_session *session, const char *name, cli_csv *csv);

void cli_csv_text(cli_csv *csv, const char *text);
void cli_csv_real(cli_csv *csv, double value);
void cli_csv_end_line(cli_csv *csv);

/* Closes the table; finds the errors of all writes. Errors: WRITE. */
starg_status cli_csv_close(cli_csv *csv);

/* Takes the next field of a line (without its end), in place and without its quotes; `*at` begins
 * at the line and is NULL behind the last field, which then gives NULL. Fields do not go over
 * lines. */
char *cli_csv_field(char **at);

#endif
