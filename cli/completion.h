/* SPDX-License-Identifier: Apache-2.0 */
/* Completion for shells, made of the table of commands and their options. */
#ifndef STARGUARD_CLI_COMPLETION_H
#define STARGUARD_CLI_COMPLETION_H

#include <stdio.h>

typedef enum cli_shell { CLI_BASH, CLI_ZSH, CLI_FISH } cli_shell;

/* Writes the script that a shell reads to complete `starguard ...`. */
void cli_completion_write(FILE *stream, cli_shell shell);

#endif
