/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as comma-separated values (RFC 4180), reals with 17 significant digits. */
#ifndef STARGUARD_CLI_CSV_H
#define STARGUARD_CLI_CSV_H

#include "session.h"

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

#endif
