/* SPDX-License-Identifier: Apache-2.0 */
/* zsh: specifications for _arguments, with the first sentence of each help. */
#include <stdio.h>

#include "completion_parts.h"

static void zsh_option(FILE *stream, const cli_option *o, const char *name) {
    bool repeats = o->kind == STARG_FIELD_PLACES || o->kind == STARG_FIELD_TEXTS;
    fprintf(stream, "            '%s%s[", repeats ? "*" : "", name);
    completion_put_brief(stream, o->help, "[]:\\");
    fputc(']', stream);
    if (o->kind != STARG_FIELD_FLAG) {
        fputc(':', stream);
        completion_put_brief(stream, o->value, "[]:\\");
        fputc(':', stream);
    }
    if (o->kind == STARG_FIELD_CHOICE) {
        fputc('(', stream);
        completion_visit_words(stream, o, completion_put_word);
        fputc(')', stream);
    } else if (o->kind == STARG_FIELD_TEXT || o->kind == STARG_FIELD_TEXTS) {
        fputs("{_files; compadd --", stream);
        completion_visit_words(stream, o, completion_put_word);
        fputc('}', stream);
    } else if (o->kind != STARG_FIELD_FLAG) {
        fputc(' ', stream);
    }
    fputs("' \\\n", stream);
}

/* For a command, or the common options. */
static void zsh_options(FILE *stream, const cli_command *command) {
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++) {
        char name[64] = {'-', o->letter, '\0'};
        if (o->letter != 0)
            zsh_option(stream, o, name);
        snprintf(name, sizeof name, "--%s", o->option);
        zsh_option(stream, o, name);
    }
}

static void zsh_command(FILE *stream, const cli_command *command) {
    if (command->members != NULL)
        return;
    fprintf(stream, "    (\"%s\")\n        _arguments -S \\\n", command->name);
    zsh_options(stream, command);
    zsh_options(stream, NULL);
    if (command->operand_word != NULL) {
        fputs("            ':name:(", stream);
        completion_put_operand_words(stream, command);
        fputs(")' ;;\n", stream);
    } else {
        fputs("            '*:file:_files' ;;\n", stream);
    }
}

static void zsh_summaries(FILE *stream, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++) {
        fprintf(stream, "            '%s:", cli_command_word(table[i]));
        completion_put_brief(stream, table[i]->summary, "");
        fputs("'\n", stream);
    }
}

void completion_zsh(FILE *stream) {
    fputs("#compdef starguard\n"
          "# zsh completion for starguard; made by 'starguard completion zsh'\n"
          "_starguard() {\n"
          "    local -a commands\n"
          "    local command=$words[2]\n"
          "    if ((CURRENT == 2)); then\n"
          "        commands=(\n",
          stream);
    zsh_summaries(stream, cli_commands);
    fputs("            'help:explain a command'\n"
          "        )\n"
          "        _describe command commands\n"
          "        return\n"
          "    fi\n",
          stream);
    for (size_t i = 0; cli_commands[i] != NULL; i++) {
        const cli_command *group = cli_commands[i];
        if (group->members == NULL)
            continue;
        fprintf(stream,
                "    if [[ $command == %s ]]; then\n"
                "        if ((CURRENT == 3)); then\n"
                "            commands=(\n",
                group->name);
        zsh_summaries(stream, group->members);
        fprintf(stream,
                "            )\n"
                "            _describe '%s command' commands\n"
                "            return\n"
                "        fi\n"
                "        command=\"%s $words[3]\"\n"
                "        shift words\n"
                "        ((CURRENT--))\n"
                "    fi\n",
                group->name, group->name);
    }
    fputs("    shift words\n"
          "    ((CURRENT--))\n"
          "    case $command in\n",
          stream);
    completion_visit_commands(stream, cli_commands, zsh_command);
    fputs("    (help)\n        _arguments ':command:(", stream);
    completion_put_table_words(stream, cli_commands);
    fputs(")' ;;\n"
          "    esac\n"
          "}\n"
          "if [[ $funcstack[1] == _starguard ]]; then\n"
          "    _starguard \"$@\"\n"
          "else\n"
          "    compdef _starguard starguard\n"
          "fi\n",
          stream);
}
