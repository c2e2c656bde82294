/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of completion.c: common parts of the scripts. */
#ifndef STARGUARD_CLI_COMPLETION_PARTS_H
#define STARGUARD_CLI_COMPLETION_PARTS_H

#include <stdio.h>

#include "commands.h"

/* One script per shell. */
void completion_bash(FILE *stream);
void completion_zsh(FILE *stream);
void completion_fish(FILE *stream);

/* Calls `visit` with each word that an option accepts. */
typedef void completion_word_fn(FILE *stream, const char *word, int size);
void completion_visit_words(FILE *stream, const cli_option *o, completion_word_fn *visit);

/* Writes a blank and the word; a completion_word_fn. */
void completion_put_word(FILE *stream, const char *word, int size);

/* The first sentence of a text, for use in single quotes; `special` are characters with a meaning
 * in the shell's table. */
void completion_put_brief(FILE *stream, const char *text, const char *special);

/* Calls `visit` with each command of a table, including members of groups. */
typedef void completion_command_fn(FILE *stream, const cli_command *command);
void completion_visit_commands(FILE *stream, const cli_command *const *table,
                               completion_command_fn *visit);

/* The last words of a table's commands, and the words of a command's first operand. */
void completion_put_table_words(FILE *stream, const cli_command *const *table);
void completion_put_operand_words(FILE *stream, const cli_command *command);

#endif
