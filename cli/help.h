/* SPDX-License-Identifier: Apache-2.0 */
/* The help, generated from the table of commands and their options. */
#ifndef STARGUARD_CLI_HELP_H
#define STARGUARD_CLI_HELP_H

#include <stdio.h>

#include "commands.h"

/* Texts about the program as a whole, for the help and the manual. */
extern const char *const cli_summary;
extern const char *const cli_about_program;
extern const char *const cli_about_files;
extern const char *const cli_first_steps; /* like the examples of a command */

typedef struct cli_exit_text {
    cli_exit status;
    const char *text;
} cli_exit_text;
extern const cli_exit_text cli_exit_texts[];
extern const size_t cli_exit_text_count;

/* A few lines for an incomplete command line. */
void cli_help_short(FILE *stream);

/* Describes the program and lists the commands. */
void cli_help_program(FILE *stream);

/* Complete help of one command. */
void cli_help_command(FILE *stream, const cli_command *command);

/* All commands and options as one JSON object (docs/formats.md). False when out of memory. */
bool cli_help_json(FILE *stream);

/* A file below share/ that tools/manual.py has made, as a text on the heap; NULL if there is none.
 */
char *cli_installed_text(const char *name);

#endif
