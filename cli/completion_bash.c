/* SPDX-License-Identifier: Apache-2.0 */
/* bash: a function that examines the words before the cursor. */
#include "completion_parts.h"

static void bash_names(FILE *stream, const cli_option *o, const char *separator) {
    if (o->letter != 0)
        fprintf(stream, "-%c%s", o->letter, separator);
    fprintf(stream, "--%s", o->option);
}

/* For a command, or the common options. */
static void bash_list(FILE *stream, const cli_command *command) {
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++) {
        fputc(' ', stream);
        bash_names(stream, o, " ");
    }
}

/* Values of an option: words, files, or nothing. */
static void bash_values(FILE *stream, const cli_command *command) {
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++) {
        if (o->kind == STARG_FIELD_FLAG)
            continue;
        fputs("            ", stream);
        bash_names(stream, o, "|");
        fputs(") words=\"", stream);
        completion_visit_words(stream, o, completion_put_word);
        fprintf(stream, "\" files=%s ;;\n",
                o->kind == STARG_FIELD_TEXT || o->kind == STARG_FIELD_TEXTS ? "yes" : "");
    }
}

static void bash_command(FILE *stream, const cli_command *command) {
    fprintf(stream, "    \"%s\")\n        options=\"$common", command->name);
    bash_list(stream, command);
    fputs("\"\n        case $before in\n", stream);
    bash_values(stream, command);
    fputs("            *) options_apply=yes words=\"", stream);
    if (command->members != NULL)
        completion_put_table_words(stream, command->members);
    else if (command->operand_word != NULL)
        completion_put_operand_words(stream, command);
    fprintf(stream, "\" files=%s ;;\n        esac ;;\n",
            command->members != NULL || command->operand_word != NULL ? "" : "yes");
}

void completion_bash(FILE *stream) {
    fputs("# bash completion for starguard; made by 'starguard completion bash'\n"
          "_starguard() {\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
          "    local command=${COMP_WORDS[1]} options= words= files= options_apply=\n"
          "    local common=\"",
          stream);
    bash_list(stream, NULL);
    fputs("\"\n"
          "    COMPREPLY=()\n"
          "    if ((COMP_CWORD == 1)); then\n"
          "        COMPREPLY=($(compgen -W \"",
          stream);
    completion_put_table_words(stream, cli_commands);
    fputs(" help --help --version\" -- \"$word\"))\n"
          "        return\n"
          "    fi\n",
          stream);
    for (size_t i = 0; cli_commands[i] != NULL; i++)
        if (cli_commands[i]->members != NULL)
            fprintf(stream,
                    "    if [[ $command == %s ]] && ((COMP_CWORD > 2)); then\n"
                    "        command=\"%s ${COMP_WORDS[2]}\"\n"
                    "    fi\n",
                    cli_commands[i]->name, cli_commands[i]->name);
    fputs("    case $command in\n", stream);
    completion_visit_commands(stream, cli_commands, bash_command);
    fputs("    help) words=\"", stream);
    completion_put_table_words(stream, cli_commands);
    fputs("\" ;;\n"
          "    esac\n"
          "    case $before in\n",
          stream);
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(NULL, i)) != NULL; i++)
        if (o->kind != STARG_FIELD_FLAG)
            fprintf(stream, "        --%s) return ;;\n", o->option);
    fputs("    esac\n"
          "    if [[ $options_apply && $word == -* ]]; then\n"
          "        COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
          "        return\n"
          "    fi\n"
          "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
          "    if [[ $files ]]; then\n"
          "        local IFS=$'\\n'\n"
          "        COMPREPLY+=($(compgen -f -- \"$word\"))\n"
          "        compopt -o filenames\n"
          "    fi\n"
          "}\n"
          "complete -F _starguard starguard\n",
          stream);
}
