/* SPDX-License-Identifier: Apache-2.0 */
/* The table of commands as JSON, for generators of manual pages, documentation and graphical front
 * ends. */
#include <jansson.h>

#include "help.h"
#include "starguard/version.h"

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
    json_t *option = json_pack("{s:s, s:s*, s:s, s:s*, s:s}", "name", o->option, "letter",
                               o->letter != 0 ? letter : NULL, "kind", kind_name(o->kind), "value",
                               o->value, "help", help);
    if (o->kind != STARG_FIELD_CHOICE ||
        json_object_set_new(option, "choices", words_json(o->words)) == 0)
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
    json_t *table = json_pack(
        "{s:s, s:i, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o}", "format", "starguard-help", "version",
        1, "program", starg_version(), "summary", cli_summary, "about", cli_about_program, "files",
        cli_about_files, "first_steps", cli_first_steps, "commands", commands, "common_options",
        options_json(NULL), "exit_statuses", exit_statuses_json());
    bool written = table != NULL && json_dumpf(table, stream, JSON_INDENT(1)) == 0;
    if (written)
        fputc('\n', stream);
    json_decref(table);
    return written;
}
