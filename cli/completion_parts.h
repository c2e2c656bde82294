/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of the completion (completion.c): what the scripts of all shells are made of. */
#ifndef STARGUARD_CLI_COMPLETION_PARTS_H
#define STARGUARD_CLI_COMPLETION_PARTS_H

#include <stdio.h>

#include "commands.h"

/* One script each. */
void completion_bash(FILE *stream);
void completion_zsh(FILE *stream);
void completion_fish(FILE *stream);

/* Calls `visit` with each word that an option takes. */
typedef void completion_word_fn(FILE *stream, const char *word, int size);
void completion_visit_words(FILE *stream, const cli_option *o, completion_word_fn *visit);

/* A blank and the word: to be called with each. */
void completion_put_word(FILE *stream, const char *word, int size);

/* The first sentence of a text, so that it stands in single quotes; `special` are characters that
 * the shell's table gives a meaning of their own. */
void completion_put_brief(FILE *stream, const char *text, const char *special);

/* Calls `visit` with each command of a table, the members of groups too. */
typedef void completion_command_fn(FILE *stream, const cli_command *command);
void completion_visit_commands(FILE *stream, const cli_command *const *table,
                               completion_command_fn *visit);

/* The last words of a table's commands, and the words of a command's first operand. */
void completion_put_table_words(FILE *stream, const cli_command *const *table);
void completion_put_operand_words(FILE *stream, const cli_command *command);

#endif
