/* SPDX-License-Identifier: Apache-2.0 */
/* Each script is a table in the shell's own syntax: for every command its options, their values,
 * and its operands. Values follow from the option's kind: a choice has its words, a text is a file
 * or one of the lower-case words of its form ("skeleton|medial|FILE"), and numbers have no
 * suggestions. */
#include "completion.h"

#include <string.h>

#include "completion_parts.h"

/* ---- values of options ---- */

void completion_visit_words(FILE *stream, const cli_option *o, completion_word_fn *visit) {
    if (o->kind == STARG_FIELD_CHOICE)
        for (size_t i = 0; o->words[i] != NULL; i++)
            visit(stream, o->words[i], (int)strlen(o->words[i]));
    if (o->kind != STARG_FIELD_TEXT && o->kind != STARG_FIELD_TEXTS)
        return;
    size_t size;
    for (const char *at = o->value, *word; (word = cli_option_next_word(&at, &size)) != NULL;)
        visit(stream, word, (int)size);
}

void completion_put_word(FILE *stream, const char *word, int size) {
    fprintf(stream, " %.*s", size, word);
}

void completion_put_brief(FILE *stream, const char *text, const char *special) {
    for (const char *c = text; *c != '\0'; c++) {
        bool end = (*c == '.' || *c == ';') && (c[1] == ' ' || c[1] == '\0');
        if (end || *c == '\n')
            return;
        if (*c == '\'') {
            fputs("'\\''", stream);
            continue;
        }
        if (strchr(special, *c) != NULL)
            fputc('\\', stream);
        fputc(*c, stream);
    }
}

/* ---- all commands, including members of groups ---- */

void completion_visit_commands(FILE *stream, const cli_command *const *table,
                               completion_command_fn *visit) {
    for (size_t i = 0; table[i] != NULL; i++) {
        visit(stream, table[i]);
        if (table[i]->members != NULL)
            completion_visit_commands(stream, table[i]->members, visit);
    }
}

void completion_put_table_words(FILE *stream, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++)
        fprintf(stream, " %s", cli_command_word(table[i]));
}

void completion_put_operand_words(FILE *stream, const cli_command *command) {
    for (size_t i = 0; command->operand_word(i) != NULL; i++)
        fprintf(stream, " %s", command->operand_word(i));
}

void cli_completion_write(FILE *stream, cli_shell shell) {
    switch (shell) {
    case CLI_BASH:
        completion_bash(stream);
        break;
    case CLI_ZSH:
        completion_zsh(stream);
        break;
    case CLI_FISH:
        completion_fish(stream);
        break;
    }
}
