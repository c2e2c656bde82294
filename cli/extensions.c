/* SPDX-License-Identifier: Apache-2.0 */
#include "extensions.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "commands.h"

bool cli_has_extension(const char *name, const char *extension) {
    size_t size = strlen(name), tail = strlen(extension);
    return size > tail && strcasecmp(name + size - tail, extension) == 0;
}

/* The next extension in the form of a value, such as "FILE.csv|.json"; NULL after the last. */
static const char *next_extension(const char **at, size_t *size) {
    const char *dot = *at != NULL ? strchr(*at, '.') : NULL;
    if (dot == NULL)
        return NULL;
    *size = 1 + strspn(dot + 1, "abcdefghijklmnopqrstuvwxyz");
    *at = dot + *size;
    return dot;
}

static bool form_has(const char *form, const char *extension) {
    size_t size;
    for (const char *at = form, *e; (e = next_extension(&at, &size)) != NULL;)
        if (strlen(extension) == size && strncasecmp(e, extension, size) == 0)
            return true;
    return false;
}

/* ".a, .b or .c"; returns how many there are. */
static size_t list_extensions(const char *form, char *out, size_t room) {
    size_t count = 0, known = 0, used = 0, size;
    for (const char *at = form; next_extension(&at, &size) != NULL;)
        count++;
    out[0] = '\0';
    for (const char *at = form, *e; (e = next_extension(&at, &size)) != NULL && used < room;)
        used += (size_t)snprintf(out + used, room - used, "%s%.*s",
                                 known++ == 0     ? ""
                                 : known == count ? " or "
                                                  : ", ",
                                 (int)size, e);
    return count;
}

static bool is_output(const cli_option *o) {
    return o->option != NULL && o->kind == STARG_FIELD_TEXT && !(o->flags & STARG_FIELD_INPUT);
}

static const cli_option *main_output(const cli_command *command) {
    for (size_t i = 0; i < command->option_count; i++)
        if (command->options[i].letter == 'o')
            return &command->options[i];
    return NULL;
}

/* As the user writes it. */
static const char *shown(const cli_option *o, char text[64]) {
    snprintf(text, 64, "%s%s", o->letter != 0 ? "-" : "--", o->letter != 0 ? "o" : o->option);
    return text;
}

/* The option of a command that writes files of a kind; NULL: none. */
static const cli_option *find_output(const cli_command *command, const char *extension) {
    for (size_t i = 0; i < command->option_count; i++)
        if (is_output(&command->options[i]) && form_has(command->options[i].value, extension))
            return &command->options[i];
    return NULL;
}

/* What writes files of this kind: another option; a command that reads the result; --json; or any
 * command. */
static void advise(const cli_command *command, const char *name, const char *extension, char *out,
                   size_t room) {
    const cli_option *other = find_output(command, extension), *own = main_output(command);
    char option[64];
    size_t used = 0;
    if (other != NULL) {
        snprintf(out, room, "; %s %.150s writes such a file", shown(other, option), name);
        return;
    }
    for (size_t i = 0; own != NULL && cli_commands[i] != NULL; i++) {
        const cli_option *o = main_output(cli_commands[i]);
        if (o == NULL || !form_has(o->value, extension) ||
            strstr(cli_commands[i]->description, own->value) == NULL)
            continue;
        snprintf(out, room, "; write %s, then run 'starguard %s %s -o %.150s'", own->value,
                 cli_commands[i]->name, own->value, name);
        return;
    }
    if (strcasecmp(extension, ".json") == 0) {
        snprintf(out, room, "; --json prints what the command finds as JSON");
        return;
    }
    for (size_t i = 0; cli_commands[i] != NULL && used < room; i++) {
        const cli_option *o = main_output(cli_commands[i]);
        if (o != NULL && form_has(o->value, extension))
            used += (size_t)snprintf(out + used, room - used, "%s%s",
                                     used == 0 ? "; such files are written by " : ", ",
                                     cli_commands[i]->name);
    }
}

/* A result whose format does not depend on its name needs no extension ("MAP[.json]"), and a folder
 * may be called anything but a file of another output. */
static starg_status check_name(cli_session *session, const cli_option *o, const char *name) {
    const char *slash = strrchr(name, '/'), *base = slash != NULL ? slash + 1 : name;
    const char *extension = strrchr(base, '.');
    char formats[100], advice[400] = "", option[64];
    size_t count = list_extensions(o->value, formats, sizeof formats);
    if (extension == NULL || extension == base)
        extension = "";
    if (strcmp(name, "-") == 0 || form_has(o->value, extension) ||
        (*extension == '\0' && *base != '.' && (count == 1 || strchr(o->value, '[') != NULL)) ||
        (count == 0 &&
         (strcmp(o->value, "DIR") != 0 || find_output(session->command, extension) == NULL)))
        return STARG_OK;
    if (*extension != '\0')
        advise(session->command, name, extension, advice, sizeof advice);
    return cli_fail(session, STARG_ERROR_ARGUMENT, "%s needs %s%s, not '%.150s'%s",
                    shown(o, option), count == 0 ? "the name of a folder" : "a name that ends in ",
                    formats, name, advice);
}

starg_status cli_check_names(cli_session *session, const void *values) {
    const cli_command *command = session->command;
    starg_status status = STARG_OK;
    for (size_t i = 0; i < command->option_count && status == STARG_OK; i++) {
        const cli_option *o = &command->options[i];
        const char *name =
            is_output(o) ? *(const char *const *)((const char *)values + o->offset) : NULL;
        if (name != NULL)
            status = check_name(session, o, name);
    }
    return status;
}

int cli_format_of(const char *name, const cli_extension *known, size_t count, int standard) {
    for (size_t i = 0; i < count; i++)
        if (cli_has_extension(name, known[i].text))
            return known[i].format;
    return standard;
}
