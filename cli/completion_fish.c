/* SPDX-License-Identifier: Apache-2.0 */
/* fish: one line per suggestion, with its condition. */
#include "completion_parts.h"

/* Starts a line that applies after these words. */
static void fish_begin(FILE *stream, const char *words) {
    fprintf(stream, "complete -c starguard -n '__starguard_behind %s'", words);
}

/* The options of `of`, or (NULL) the common ones, after a command. */
static void fish_options(FILE *stream, const cli_command *command, const cli_command *of) {
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(of, i)) != NULL; i++) {
        fish_begin(stream, command->name);
        if (o->letter != 0)
            fprintf(stream, " -s %c", o->letter);
        fprintf(stream, " -l %s", o->option);
        if (o->kind != STARG_FIELD_FLAG) {
            fprintf(stream, " %s -a '",
                    o->kind == STARG_FIELD_TEXT || o->kind == STARG_FIELD_TEXTS ? "-rF" : "-x");
            completion_visit_words(stream, o, completion_put_word);
            fputc('\'', stream);
        }
        fputs(" -d '", stream);
        completion_put_brief(stream, o->help, "");
        fputs("'\n", stream);
    }
}

static void fish_word(FILE *stream, const char *word, const char *summary) {
    fprintf(stream, " -f -a %s -d '", word);
    completion_put_brief(stream, summary, "");
    fputs("'\n", stream);
}

/* Suggests the commands of a table after some words. */
static void fish_table(FILE *stream, const char *words, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++) {
        fprintf(stream, "complete -c starguard -n '__starguard_behind --next %s'", words);
        fish_word(stream, cli_command_word(table[i]), table[i]->summary);
    }
}

static void fish_command(FILE *stream, const cli_command *command) {
    if (command->members != NULL) {
        fish_table(stream, command->name, command->members);
        return;
    }
    fish_options(stream, command, command);
    fish_options(stream, command, NULL);
    if (command->operand_word == NULL)
        return;
    fish_begin(stream, command->name);
    fputs(" -f -a '", stream);
    completion_put_operand_words(stream, command);
    fputs("'\n", stream);
}

void completion_fish(FILE *stream) {
    fputs("# fish completion for starguard; made by 'starguard completion fish'\n"
          "# Does the command line, up to the cursor, begin with these words? With --next, and no "
          "more?\n"
          "function __starguard_behind\n"
          "    set -l typed (commandline -opc)[2..-1]\n"
          "    if test \"$argv[1]\" = --next\n"
          "        set -e argv[1]\n"
          "        test (count $typed) -eq (count $argv); or return 1\n"
          "    end\n"
          "    for i in (seq (count $argv))\n"
          "        test \"$typed[$i]\" = $argv[$i]; or return 1\n"
          "    end\n"
          "end\n",
          stream);
    fish_table(stream, "", cli_commands);
    fish_begin(stream, "--next");
    fish_word(stream, "help", "explain a command");
    fish_table(stream, "help", cli_commands);
    completion_visit_commands(stream, cli_commands, fish_command);
}
