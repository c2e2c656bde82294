/* SPDX-License-Identifier: Apache-2.0 */
/* One run of one command: its options, the library's context, where text, errors, results and
 * files go, and how all of it becomes an exit status. */
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
    CLI_EXIT_USAGE = 1,      /* the command line is wrong                          */
    CLI_EXIT_INPUT = 2,      /* an input is missing, unreadable or not usable      */
    CLI_EXIT_UNFINISHED = 3, /* output unwritable, out of memory, time over        */
    CLI_EXIT_FAILED = 4,     /* verification failed                                */
    CLI_EXIT_CANCELLED = 130
} cli_exit;

/* Options that every command has. */
typedef struct cli_common {
    uint64_t threads, seed;
    double time_limit; /* seconds; 0: none */
    bool quiet, json, help, version;
} cli_common;

extern const cli_option cli_common_options[];
extern const size_t cli_common_option_count;

typedef struct cli_session {
    const cli_command *command;
    cli_common common;
    char **operands;
    size_t operand_count;
    starg_mesh *mesh; /* the first operand, as the command wants it */
    starg_solid *solid;

    starg_context *context;
    cli_progress progress;
    cli_outputs outputs;
    bool stdout_taken; /* a result goes to standard output: text goes to standard error */
    cli_exit outcome;  /* when nothing failed: DONE, INPUT (check) or FAILED (verify)   */

    json_t *report; /* --json: the object that is printed at the end */
    json_t *log;    /* --json: what the library has said             */
    bool report_broken;
    double began;

    starg_error error; /* the command line's own failure, if any */
    char message[512];
} cli_session;

/* Runs EXPR and leaves by the label `done` when it fails; the function has a `status`. */
#define CLI_TRY(EXPR)                                                                              \
    do {                                                                                           \
        status = (EXPR);                                                                           \
        if (status != STARG_OK)                                                                    \
            goto done;                                                                             \
    } while (0)

void cli_session_init(cli_session *session, const cli_command *command);

/* Makes the context, catches signals, announces nothing yet. */
starg_status cli_session_start(cli_session *session);

/* Ends the run: prints the report or the error, puts the outputs in their places or removes them,
 * frees everything. The exit status. */
int cli_session_finish(cli_session *session, starg_status status);

/* Records a failure of the command line's own and returns `status`. */
starg_status cli_fail(cli_session *session, starg_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
starg_status cli_fail_memory(cli_session *session);

/* Names a file that the run reads, which no output may be then; NULL is fine. Operands and options
 * that name inputs are named by the frame of every command; this is for what these files name. */
starg_status cli_name_input(cli_session *session, const char *name);

/* Announces an output file; NULL is fine. "-" takes standard output. */
starg_status cli_announce(cli_session *session, const char *name);

/* The same for the output that a command cannot do without; `form` is what its name looks like. */
starg_status cli_announce_needed(cli_session *session, const char *name, const char *form);

/* Announces a folder for outputs, which are then announced as files in it; NULL is fine. */
starg_status cli_announce_folder(cli_session *session, const char *name);

/* A notice or warning of the command line's own, told and logged like those of the library. */
void cli_log(cli_session *session, starg_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Text for people: standard output, or standard error when a result goes there; nothing with
 * --quiet or --json. */
void cli_say(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same on standard error whatever the options are. */
void cli_warn(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
