/* SPDX-License-Identifier: Apache-2.0 */
/* One run of one command: its options, the library's context, the destinations of text, errors,
 * results and files, and the exit status. */
#ifndef STARGUARD_CLI_SESSION_H
#define STARGUARD_CLI_SESSION_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "options.h"
#include "outputs.h"
#include "progress.h"
#include "starguard/context.h"
#include "starguard/mesh.h"
#include "starguard/solid.h"

typedef struct cli_command cli_command;

typedef enum cli_exit {
    CLI_EXIT_DONE = 0,
    CLI_EXIT_USAGE = 1,      /* the command line is wrong */
    CLI_EXIT_INPUT = 2,      /* an input is missing, unreadable or not usable */
    CLI_EXIT_UNFINISHED = 3, /* output unwritable, out of memory, time limit */
    CLI_EXIT_FAILED = 4,     /* verification failed */
    CLI_EXIT_CANCELLED = 130
} cli_exit;

/* Options common to all commands. */
typedef struct cli_common {
    uint64_t threads, seed;
    double time_limit; /* seconds; 0: none */
    bool quiet, verbose, json, help, version;
} cli_common;

extern const cli_option cli_common_options[];
extern const size_t cli_common_option_count;

typedef struct cli_session {
    const cli_command *command;
    cli_common common;
    char **operands;
    size_t operand_count;
    starg_mesh *mesh; /* the first operand, as the command needs it */
    starg_solid *solid;

    starg_context *context;
    cli_progress progress;
    cli_outputs outputs;
    bool stdout_taken; /* a result goes to standard output, so text goes to standard error */
    cli_exit outcome;  /* without failure: DONE, INPUT (check) or FAILED (verify) */

    json_t *report; /* --json: the object to print at the end */
    json_t *log;    /* --json: log lines of the library */
    bool report_broken;
    double began;

    starg_error error; /* failure of the command line itself */
    char message[512];
} cli_session;

/* Evaluates EXPR; on failure jumps to `done` with `status` set. */
#define CLI_TRY(EXPR)                                                                              \
    do {                                                                                           \
        status = (EXPR);                                                                           \
        if (status != STARG_OK)                                                                    \
            goto done;                                                                             \
    } while (0)

void cli_session_init(cli_session *session, const cli_command *command);

/* Creates the context and installs signal handlers. */
starg_status cli_session_start(cli_session *session);

/* Ends the run: prints the report or the error, commits or removes the outputs, frees everything.
 * Returns the exit status. */
int cli_session_finish(cli_session *session, starg_status status);

/* Records a failure of the command line itself and returns `status`. */
starg_status cli_fail(cli_session *session, starg_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
starg_status cli_fail_memory(cli_session *session);

/* Registers a file that the run reads, which no output may then replace; NULL is allowed. Operands
 * and options that name inputs are registered automatically; use this for files named by those. */
starg_status cli_name_input(cli_session *session, const char *name);

/* Announces an output file; NULL is allowed. "-" takes standard output. */
starg_status cli_announce(cli_session *session, const char *name);

/* Same for a required output; `form` describes its name. */
starg_status cli_announce_needed(cli_session *session, const char *name, const char *form);

/* Announces a folder for outputs, which are then announced as files in it; NULL is allowed. */
starg_status cli_announce_folder(cli_session *session, const char *name);

/* Shows and logs a notice or warning of the command line, like those of the library. */
void cli_log(cli_session *session, starg_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Text for people: standard output, or standard error if a result goes there; nothing with --quiet
 * or --json. */
void cli_say(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Same on standard error whatever the options are. */
void cli_warn(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
