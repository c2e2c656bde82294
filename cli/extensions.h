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

/* The format of an output by its file extension; `standard` for "-". Errors: ARGUMENT. */
starg_status cli_format_by_extension(cli_session *session, const char *name,
                                     const cli_extension *known, size_t count, int standard,
                                     int *format);

/* Refuses outputs of a command whose extension is that of another option or command, with advice;
 * `values` is the struct of its options. What an option writes, says its value: "FILE.obj|.ply".
 * Errors: ARGUMENT. */
starg_status cli_check_extensions(cli_session *session, const char *values);

/* Announces an output that must have the extension, for example ".ply"; NULL is allowed. */
starg_status cli_announce_with_extension(cli_session *session, const char *option, const char *name,
                                         const char *extension);

#endif
