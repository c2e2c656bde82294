/* SPDX-License-Identifier: Apache-2.0 */
/* Manual pages, generated from the table of commands and their options. */
#ifndef STARGUARD_CLI_MANUAL_H
#define STARGUARD_CLI_MANUAL_H

#include <stdio.h>

#include "commands.h"

/* The page of a command, or of the program (NULL), in the man(7) macros: starguard-guard.1 and so
 * on, starguard.1. */
void cli_manual_page(FILE *stream, const cli_command *command);

#endif
