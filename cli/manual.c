/* SPDX-License-Identifier: Apache-2.0 */
/* Plain man(7), which every man program can show. Dashes, quotes and the like are escaped:
 * otherwise they are set as typographic characters, which cannot be copied into a shell; a line
 * must not start with a control character. */
#include "manual.h"

#include <string.h>

#include "help.h"
#include "starguard/version.h"

enum { LONGEST = 78 };

/* ---- text ---- */

/* Escapes characters that would be set as others. */
static void put_escaped(FILE *stream, char c) {
    static const char plain[] = "\\-'`^~";
    static const char *const escaped[] = {"\\e", "\\-", "\\(aq", "\\(ga", "\\(ha", "\\(ti"};
    const char *found = c != '\0' ? strchr(plain, c) : NULL;
    if (found != NULL)
        fputs(escaped[found - plain], stream);
    else
        fputc(c, stream);
}

/* `size` characters of text at the start of a line. */
static void put_line(FILE *stream, const char *text, size_t size) {
    if (size > 0 && *text == '.')
        fputs("\\&", stream);
    for (size_t i = 0; i < size; i++)
        put_escaped(stream, text[i]);
    fputc('\n', stream);
}

/* Same, with long lines broken between words. */
static void put_filled(FILE *stream, const char *text, size_t size) {
    while (size > LONGEST) {
        size_t cut = LONGEST;
        while (cut > 0 && text[cut] != ' ')
            cut--;
        if (cut == 0)
            break;
        put_line(stream, text, cut);
        text += cut + 1;
        size -= cut + 1;
    }
    put_line(stream, text, size);
}

static void put_text(FILE *stream, const char *text) {
    put_filled(stream, text, strlen(text));
}

/* Paragraphs, separated by newlines. */
static void put_paragraphs(FILE *stream, const char *text) {
    for (bool first = true; *text != '\0'; first = false) {
        size_t size = strcspn(text, "\n");
        if (!first)
            fputs(".PP\n", stream);
        put_filled(stream, text, size);
        text += size;
        text += strspn(text, "\n");
    }
}

static void put_section(FILE *stream, const char *name) {
    fprintf(stream, ".SH %s\n", name);
}

/* Lines that start with '#' describe the ones after them. */
static void put_examples(FILE *stream, const char *examples) {
    bool in_command = false;
    for (const char *line = examples; *line != '\0';) {
        size_t size = strcspn(line, "\n");
        bool is_command = *line != '#';
        if (is_command != in_command)
            fputs(is_command ? ".PP\n.RS 4\n.EX\n" : ".EE\n.RE\n.PP\n", stream);
        in_command = is_command;
        if (is_command)
            put_line(stream, line, size);
        else
            put_filled(stream, line + 2, size - 2);
        line += size;
        line += *line == '\n';
    }
    if (in_command)
        fputs(".EE\n.RE\n", stream);
}

/* ---- parts of pages ---- */

/* "db add" becomes starguard-db-add. */
static void put_page_name(FILE *stream, const cli_command *command, bool upper) {
    fputs(upper ? "STARGUARD" : "starguard", stream);
    if (command == NULL)
        return;
    fputs("\\-", stream);
    for (const char *c = command->name; *c != '\0'; c++) {
        if (*c == ' ')
            fputs("\\-", stream);
        else
            fputc(upper && *c >= 'a' && *c <= 'z' ? *c - 'a' + 'A' : *c, stream);
    }
}

static void put_head(FILE *stream, const cli_command *command, const char *summary) {
    fputs(".TH ", stream);
    put_page_name(stream, command, true);
    fprintf(stream, " 1 \"\" \"starguard %s\" \"starguard manual\"\n", starg_version());
    put_section(stream, "NAME");
    put_page_name(stream, command, false);
    fputs(" \\- ", stream);
    put_text(stream, summary);
    put_section(stream, "SYNOPSIS");
}

/* For a command, or the common options. */
static void put_options(FILE *stream, const cli_command *command) {
    const cli_option *o;
    char help[CLI_HELP_SIZE];
    for (size_t i = 0; (o = cli_command_option(command, i)) != NULL; i++) {
        fputs(".TP\n", stream);
        if (o->letter != 0)
            fprintf(stream, "\\fB\\-%c\\fR, ", o->letter);
        fputs("\\fB\\-\\-", stream);
        for (const char *c = o->option; *c != '\0'; c++)
            put_escaped(stream, *c);
        fputs("\\fR", stream);
        if (o->value != NULL) {
            fputs(" \\fI", stream);
            for (const char *c = o->value; *c != '\0'; c++)
                put_escaped(stream, *c);
            fputs("\\fR", stream);
        }
        fputc('\n', stream);
        cli_option_help(o, help, sizeof help);
        put_text(stream, help);
    }
}

/* A list of commands, each with its manual page. */
static void put_commands(FILE *stream, const cli_command *const *table) {
    for (size_t i = 0; table[i] != NULL; i++) {
        fputs(".TP\n\\fB", stream);
        put_page_name(stream, table[i], false);
        fputs("\\fR(1)\n", stream);
        put_text(stream, table[i]->summary);
    }
}

static void put_exit_status(FILE *stream) {
    put_section(stream, "EXIT STATUS");
    for (size_t i = 0; i < cli_exit_text_count; i++) {
        fprintf(stream, ".TP\n\\fB%d\\fR\n", (int)cli_exit_texts[i].status);
        put_text(stream, cli_exit_texts[i].text);
    }
}

static void put_common_options(FILE *stream) {
    put_section(stream, "COMMON OPTIONS");
    put_options(stream, NULL);
}

/* ---- pages ---- */

static void put_program(FILE *stream) {
    put_head(stream, NULL, "fewest guards inside a solid, star-shaped pieces, shapes by both");
    fputs("\\fBstarguard\\fR \\fICOMMAND\\fR ... [\\fIoptions\\fR]\n", stream);
    put_section(stream, "DESCRIPTION");
    put_paragraphs(stream, cli_about_program);
    put_section(stream, "COMMANDS");
    put_commands(stream, cli_commands);
    put_common_options(stream);
    put_section(stream, "MODELS AND FILES");
    put_paragraphs(stream, cli_about_files);
    put_section(stream, "EXAMPLES");
    put_examples(stream, cli_first_steps);
    put_exit_status(stream);
    put_section(stream, "ENVIRONMENT");
    fputs(".TP\n"
          "\\fBNO_COLOR\\fR\n"
          "Disables colours if set and not empty.\n",
          stream);
}

static void put_command(FILE *stream, const cli_command *command) {
    put_head(stream, command, command->summary);
    fprintf(stream, "\\fBstarguard %s\\fR ", command->name);
    put_text(stream, command->usage);
    put_section(stream, "DESCRIPTION");
    put_paragraphs(stream, command->description);
    if (command->members != NULL) {
        put_section(stream, "COMMANDS");
        put_commands(stream, command->members);
    }
    if (cli_command_option(command, 0) != NULL) {
        put_section(stream, "OPTIONS");
        put_options(stream, command);
    }
    put_common_options(stream);
    put_section(stream, "EXAMPLES");
    put_examples(stream, command->examples);
    put_exit_status(stream);
    put_section(stream, "SEE ALSO");
    fputs("\\fBstarguard\\fR(1)\n", stream);
}

void cli_manual_page(FILE *stream, const cli_command *command) {
    if (command == NULL)
        put_program(stream);
    else
        put_command(stream, command);
}
