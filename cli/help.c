/* SPDX-License-Identifier: Apache-2.0 */
#include "commands.h"

#include <jansson.h>
#include <string.h>

#include "starguard/version.h"

enum { WIDTH = 79, OPTION_INDENT = 24, BRIEF_INDENT = 28 };

const char *const cli_summary = "fewest guards inside a solid, star-shaped pieces, shapes by both";
const char *const cli_about_program =
    "Places the fewest guards inside a solid that together see its whole boundary (the art gallery "
    "problem in 3D), with exact visibility and a proven lower bound.";
const char *const cli_about_files =
    "A MODEL is a triangle mesh: OFF, OBJ, PLY, STL or VTK (.vtk, .vtp), recognized by content. "
    "'-' is "
    "standard input or standard output. Lengths in options are in the unit of the model's "
    "coordinates. "
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

/* In a line. */
static void print_briefly(FILE *stream, const cli_option *o) {
    const char letter[] = {'-', o->letter, ',', ' ', '\0'};
    int column = fprintf(stream, "  %s--%s", o->letter != 0 ? letter : "", o->option);
    if (o->value != NULL && column + (int)strlen(o->value) < BRIEF_INDENT - 1)
        column += fprintf(stream, " %s", o->value);
    fprintf(stream, "%*s%s\n", BRIEF_INDENT - column, "", o->brief);
}

/* Which options of a command are printed. */
typedef struct selection {
    const char *group; /* NULL: of every group, and of none */
    bool briefly;      /* those that most need, a line each */
} selection;

static bool is_selected(const cli_option *o, const char *group, selection of) {
    if (of.briefly && o->brief == NULL)
        return false;
    return group == NULL ? o->group == NULL : o->group != NULL && strcmp(o->group, group) == 0;
}

/* The options of a group under its title, NULL: of none; for a command, or the common options. */
static void print_group(FILE *stream, const char *title, const cli_command *command,
                        const char *group, selection of) {
    const cli_option *o;
    bool first = true;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++) {
        if (!is_selected(o, group, of))
            continue;
        if (first && of.group == NULL && group != NULL)
            fprintf(stream, "\n%s%s%s (%s)\n", cli_style_on(stream, CLI_BOLD), title,
                    cli_style_off(stream), group);
        else if (first)
            heading(stream, title);
        first = false;
        if (of.briefly)
            print_briefly(stream, o);
        else
            print_option(stream, o);
    }
}

static void print_options(FILE *stream, const cli_command *command, selection of) {
    const char *group, *title = NULL;
    for (size_t i = 0; (group = starg_field_group(i, &title)) != NULL; i++)
        if (of.group == NULL || strcmp(group, of.group) == 0)
            print_group(stream, title, command, group, of);
    if (of.group == NULL)
        print_group(stream, "Options", command, NULL, of);
}

static void print_common(FILE *stream) {
    print_group(stream, "Common options", NULL, NULL, (selection){0});
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
    print_common(stream);
    heading(stream, "Models and files");
    wrap(stream, cli_about_files, 2, 0);
    heading(stream, "First steps");
    print_examples(stream, cli_first_steps);
    heading(stream, "Exit status");
    print_exit_texts(stream);
}

/* Does the help of the command have a short form? */
static bool has_brief(const cli_command *command) {
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++)
        if (o->brief != NULL)
            return true;
    return false;
}

bool cli_help_has_part(const cli_command *command, const char *word) {
    const cli_option *o;
    if (strcmp(word, "all") == 0)
        return true;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++)
        if (o->group != NULL && strcmp(o->group, word) == 0)
            return true;
    return false;
}

static void print_parts(FILE *stream, const cli_command *command) {
    const char *group, *title;
    fprintf(stream, "\nMore: starguard %s --help all", command->name);
    for (size_t i = 0; (group = starg_field_group(i, &title)) != NULL; i++)
        if (cli_help_has_part(command, group))
            fprintf(stream, "|%s", group);
    fprintf(stream, "\n");
}

/* The first paragraph, what most need, and where the rest is. */
static void print_short(FILE *stream, const cli_command *command) {
    char first[CLI_HELP_SIZE];
    snprintf(first, sizeof first, "%.*s", (int)strcspn(command->description, "\n"),
             command->description);
    wrap(stream, first, 0, 0);
    print_options(stream, command, (selection){.briefly = true});
    print_parts(stream, command);
}

void cli_help_command(FILE *stream, const cli_command *command, const char *part) {
    const bool whole = part != NULL && strcmp(part, "all") == 0;
    if (part != NULL && !whole) {
        print_options(stream, command, (selection){.group = part});
        return;
    }
    fprintf(stream, "Usage: starguard %s %s\n\n", command->name, command->usage);
    if (!whole && has_brief(command)) {
        print_short(stream, command);
        return;
    }
    wrap(stream, command->description, 0, 0);
    if (command->members != NULL) {
        heading(stream, "Commands");
        print_commands(stream, command->members);
    }
    print_options(stream, command, (selection){0});
    print_common(stream);
    heading(stream, "Examples");
    print_examples(stream, command->examples);
}

/* The table of commands as JSON, for generators of manual pages, documentation and graphical front
 * ends. */

/* What an option takes. */
static const char *kind_name(starg_field_kind kind) {
    static const char *const names[] = {
        [STARG_FIELD_FLAG] = "flag",   [STARG_FIELD_COUNT] = "count",
        [STARG_FIELD_REAL] = "real",   [STARG_FIELD_CHOICE] = "choice",
        [STARG_FIELD_TEXT] = "text",   [STARG_FIELD_PLACES] = "points",
        [STARG_FIELD_TEXTS] = "texts", [STARG_FIELD_NUMBERS] = "numbers"};
    return names[kind];
}

/* An incomplete list becomes NULL. */
static void append(json_t **list, json_t *value) {
    if (json_array_append_new(*list, value) == 0)
        return;
    json_decref(*list);
    *list = NULL;
}

static json_t *words_json(const char *const *words) {
    json_t *list = json_array();
    for (size_t i = 0; words[i] != NULL; i++)
        append(&list, json_string(words[i]));
    return list;
}

static json_t *option_json(const cli_option *o) {
    const char letter[] = {o->letter, '\0'};
    char help[CLI_HELP_SIZE];
    cli_option_help(o, help, sizeof help);
    json_t *option =
        json_pack("{s:s, s:s*, s:s, s:s*, s:s, s:s*, s:s*}", "name", o->option, "letter",
                  o->letter != 0 ? letter : NULL, "kind", kind_name(o->kind), "value", o->value,
                  "help", help, "group", o->group, "brief", o->brief);
    if (o->words == NULL || json_object_set_new(option, "choices", words_json(o->words)) == 0)
        return option;
    json_decref(option);
    return NULL;
}

/* For a command, or the common options. */
static json_t *options_json(const cli_command *command) {
    json_t *list = json_array();
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++)
        append(&list, option_json(o));
    return list;
}

/* The words of the first operand, where it is one of some. */
static json_t *operands_json(const cli_command *c) {
    json_t *list = c->operand_word != NULL ? json_array() : NULL;
    for (size_t i = 0; list != NULL && c->operand_word(i) != NULL; i++)
        append(&list, json_string(c->operand_word(i)));
    return list;
}

static json_t *command_json(const cli_command *c) {
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:b, s:o*, s:o}", "name", c->name, "usage",
                     c->usage, "summary", c->summary, "description", c->description, "examples",
                     c->examples, "group", c->members != NULL, "words", operands_json(c), "options",
                     options_json(c));
}

static json_t *groups_json(void) {
    json_t *list = json_array();
    const char *name, *title = NULL;
    for (size_t i = 0; (name = starg_field_group(i, &title)) != NULL; i++)
        append(&list, json_pack("{s:s, s:s}", "name", name, "title", title));
    return list;
}

static json_t *exit_statuses_json(void) {
    json_t *list = json_array();
    for (size_t i = 0; i < cli_exit_text_count; i++)
        append(&list, json_pack("{s:i, s:s}", "status", (int)cli_exit_texts[i].status, "text",
                                cli_exit_texts[i].text));
    return list;
}

/* Appends the commands of a table; the members of a group follow it. */
static void append_commands(json_t **list, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++) {
        append(list, command_json(table[i]));
        if (table[i]->members != NULL)
            append_commands(list, table[i]->members);
    }
}

bool cli_help_json(FILE *stream) {
    json_t *commands = json_array();
    append_commands(&commands, cli_commands);
    json_t *table =
        json_pack("{s:s, s:i, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o}", "format",
                  "starguard-help", "version", 1, "program", starg_version(), "summary",
                  cli_summary, "about", cli_about_program, "files", cli_about_files, "first_steps",
                  cli_first_steps, "groups", groups_json(), "commands", commands, "common_options",
                  options_json(NULL), "exit_statuses", exit_statuses_json());
    bool written = table != NULL && json_dumpf(table, stream, JSON_INDENT(1)) == 0;
    if (written)
        fputc('\n', stream);
    json_decref(table);
    return written;
}
