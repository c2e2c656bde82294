/* SPDX-License-Identifier: Apache-2.0 */
/* Capabilities of a terminal. */
#ifndef STARGUARD_CLI_TERMINAL_H
#define STARGUARD_CLI_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

typedef enum cli_style { CLI_BOLD, CLI_RED, CLI_GREEN, CLI_YELLOW } cli_style;

/* Is `stream` a terminal with cursor movement? */
bool cli_terminal(FILE *stream);

/* The sequences that start and end a style; empty unless `stream` is a terminal and NO_COLOR is not
 * set. */
const char *cli_style_on(FILE *stream, cli_style style);
const char *cli_style_off(FILE *stream);

#endif
