/* SPDX-License-Identifier: Apache-2.0 */
/* File extensions and their meaning. */
#ifndef STARGUARD_CLI_EXTENSIONS_H
#define STARGUARD_CLI_EXTENSIONS_H

#include "session.h"

/* An extension with its dot, and its meaning. */
typedef struct cli_extension {
    const char *text;
    int format;
} cli_extension;

/* Ignores case. */
bool cli_has_extension(const char *name, const char *extension);

/* The format of an output by its file extension; `standard` if that is not known. */
int cli_format_of(const char *name, const cli_extension *known, size_t count, int standard);

/* Refuses names of outputs whose extensions are not among those in the form of the option's value
 * ("FILE.csv|.json"), with what writes such files. Errors: ARGUMENT. */
starg_status cli_check_names(cli_session *session, const void *values);

#endif
