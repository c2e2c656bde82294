/* SPDX-License-Identifier: Apache-2.0 */
/* Shell completion, generated from the table of commands and their options. */
#ifndef STARGUARD_CLI_COMPLETION_H
#define STARGUARD_CLI_COMPLETION_H

#include <stdio.h>

typedef enum cli_shell { CLI_BASH, CLI_ZSH, CLI_FISH } cli_shell;

/* Writes the completion script of a shell. */
void cli_completion_write(FILE *stream, cli_shell shell);

#endif
