/* The help, made of the table of commands and their options. */
#ifndef STARGUARD_CLI_HELP_H
#define STARGUARD_CLI_HELP_H

#include <stdio.h>

#include "commands.h"

/* A few lines for somebody who typed too little. */
void cli_help_short(FILE *stream);

/* What the program does and which commands there are. */
void cli_help_program(FILE *stream);

/* All about one command. */
void cli_help_command(FILE *stream, const cli_command *command);

#endif
