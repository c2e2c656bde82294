/* SPDX-License-Identifier: Apache-2.0 */
#include "help.h"

#include <string.h>

#include "terminal.h"

enum { WIDTH = 79, OPTION_INDENT = 24 };

const char *const cli_summary = "fewest guards inside a solid, star-shaped pieces, shapes by both";
const char *const cli_about_program =
    "Places the fewest guards inside a solid that together see its whole boundary (the art gallery "
    "problem in 3D), with exact visibility and a proven lower bound.";
const char *const cli_about_files =
    "A MODEL is a triangle mesh: OFF, OBJ, PLY or STL, recognized by content. '-' is standard "
    "input or standard output. Lengths in options are in the unit of the model's coordinates. "
    "Output files are written completely or not at all, and only after the command succeeds.";
const char *const cli_first_steps =
    "# a horse, its guards, a picture of them, and the check of the result\n"
    "starguard sample horse -o horse.off\n"
    "starguard guard horse.off -o guards.json --picture guards.png\n"
    "starguard verify horse.off guards.json";

const cli_exit_text cli_exit_texts[] = {
    {CLI_EXIT_DONE, "done"},
    {CLI_EXIT_USAGE, "invalid command line"},
    {CLI_EXIT_INPUT, "input missing, unreadable or unusable"},
    {CLI_EXIT_UNFINISHED, "not finished: output unwritable, disk full, out of memory, or time "
                          "limit reached without a result"},
    {CLI_EXIT_FAILED, "verification failed"},
    {CLI_EXIT_CANCELLED, "cancelled"},
};
const size_t cli_exit_text_count = sizeof cli_exit_texts / sizeof *cli_exit_texts;

static void heading(FILE *stream, const char *text) {
    fprintf(stream, "\n%s%s%s\n", cli_style_on(stream, CLI_BOLD), text, cli_style_off(stream));
}

/* Writes paragraphs (separated by newlines) with every line indented; the first line starts at
 * `column`. Bytes are columns: the texts are ASCII. */
static void wrap(FILE *stream, const char *text, int indent, int column) {
    while (*text != '\0') {
        if (*text == '\n') {
            fputc('\n', stream);
            column = 0;
            text++;
            continue;
        }
        int size = (int)strcspn(text, " \n");
        if (column > indent && column + 1 + size > WIDTH) {
            fputc('\n', stream);
            column = 0;
        }
        column += column < indent   ? fprintf(stream, "%*s", indent - column, "")
                  : column > indent ? fprintf(stream, " ")
                                    : 0;
        column += fprintf(stream, "%.*s", size, text);
        text += size;
        text += *text == ' ';
    }
    fputc('\n', stream);
}

static void print_option(FILE *stream, const cli_option *o) {
    const char letter[] = {'-', o->letter, ',', ' ', '\0'};
    char text[CLI_HELP_SIZE];
    int column = fprintf(stream, "  %s--%s%s%s", o->letter != 0 ? letter : "", o->option,
                         o->value != NULL ? " " : "", o->value != NULL ? o->value : "");
    if (column > OPTION_INDENT - 2) {
        fputc('\n', stream);
        column = 0;
    }
    cli_option_help(o, text, sizeof text);
    wrap(stream, text, OPTION_INDENT, column);
}

/* For a command, or the common options. */
static void print_options(FILE *stream, const char *title, const cli_command *command) {
    const cli_option *o;
    if (cli_command_option(command, 0) != NULL)
        heading(stream, title);
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++)
        print_option(stream, o);
}

static void print_commands(FILE *stream, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++)
        fprintf(stream, "  %-10s %s\n", cli_command_word(table[i]), table[i]->summary);
}

void cli_help_short(FILE *stream) {
    fprintf(stream, "Usage: starguard COMMAND ... [options]\n\nCommands:\n");
    print_commands(stream, cli_commands);
    fprintf(stream, "\n"
                    "'starguard help' explains more, 'starguard help COMMAND' one command.\n");
}

/* Lines that start with '#' describe the next one. */
static void print_examples(FILE *stream, const char *examples) {
    while (*examples != '\0') {
        int size = (int)strcspn(examples, "\n");
        fprintf(stream, "  %.*s\n", size, examples);
        examples += size;
        examples += *examples == '\n';
    }
}

static void print_exit_texts(FILE *stream) {
    for (size_t i = 0; i < cli_exit_text_count; i++)
        wrap(stream, cli_exit_texts[i].text, 7,
             fprintf(stream, "  %d", (int)cli_exit_texts[i].status));
}

void cli_help_program(FILE *stream) {
    fprintf(stream, "Usage: starguard COMMAND ... [options]\n\n");
    wrap(stream, cli_about_program, 0, 0);
    heading(stream, "Commands");
    print_commands(stream, cli_commands);
    fprintf(stream, "  %-10s %s\n", "help", "explain a command: starguard help COMMAND");
    print_options(stream, "Common options", NULL);
    heading(stream, "Models and files");
    wrap(stream, cli_about_files, 2, 0);
    heading(stream, "First steps");
    print_examples(stream, cli_first_steps);
    heading(stream, "Exit status");
    print_exit_texts(stream);
}

void cli_help_command(FILE *stream, const cli_command *command) {
    fprintf(stream, "Usage: starguard %s %s\n\n", command->name, command->usage);
    wrap(stream, command->description, 0, 0);
    if (command->members != NULL) {
        heading(stream, "Commands");
        print_commands(stream, command->members);
    }
    print_options(stream, "Options", command);
    print_options(stream, "Common options", NULL);
    heading(stream, "Examples");
    print_examples(stream, command->examples);
}
