/* What the ending of a file's name tells. */
#ifndef STARGUARD_CLI_ENDINGS_H
#define STARGUARD_CLI_ENDINGS_H

#include "session.h"

/* An ending with its dot, and what it stands for. */
typedef struct cli_ending {
    const char *text;
    int format;
} cli_ending;

/* In capitals, too. */
bool cli_has_ending(const char *name, const char *ending);

/* The format for an output by its name's ending; `standard` for "-". Errors: ARGUMENT. */
starg_status cli_format_by_ending(cli_session *session, const char *name, const cli_ending *known,
                                  size_t count, int standard, int *format);

/* Announces an output that must have the ending, for example ".ply"; NULL is fine. */
starg_status cli_announce_with_ending(cli_session *session, const char *option, const char *name,
                                      const char *ending);

#endif
