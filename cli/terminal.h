/* SPDX-License-Identifier: Apache-2.0 */
/* What a terminal can show. */
#ifndef STARGUARD_CLI_TERMINAL_H
#define STARGUARD_CLI_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

typedef enum cli_style { CLI_BOLD, CLI_RED, CLI_GREEN, CLI_YELLOW } cli_style;

/* A person reads `stream`, and the terminal moves its cursor. */
bool cli_terminal(FILE *stream);

/* The sequences that start and end a style; empty strings unless `stream` is a terminal and the
 * environment has no NO_COLOR. */
const char *cli_style_on(FILE *stream, cli_style style);
const char *cli_style_off(FILE *stream);

#endif
