/* SPDX-License-Identifier: Apache-2.0 */

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "commands.h"

bool cli_has_extension(const char *name, const char *extension) {
    size_t size = strlen(name), tail = strlen(extension);
    return size > tail && strcasecmp(name + size - tail, extension) == 0;
}

/* ".a, .b or .c" */
static void list_extensions(const cli_extension *known, size_t count, char *out, size_t room) {
    size_t at = 0;
    out[0] = '\0';
    for (size_t i = 0; i < count && at < room; i++)
        at += (size_t)snprintf(out + at, room - at, "%s%s",
                               i == 0           ? ""
                               : i + 1 == count ? " or "
                                                : ", ",
                               known[i].text);
}

starg_status cli_format_by_extension(cli_session *session, const char *name,
                                     const cli_extension *known, size_t count, int standard,
                                     int *format) {
    char list[100];
    *format = standard;
    if (strcmp(name, "-") == 0)
        return STARG_OK;
    for (size_t i = 0; i < count; i++)
        if (cli_has_extension(name, known[i].text)) {
            *format = known[i].format;
            return STARG_OK;
        }
    list_extensions(known, count, list, sizeof list);
    return cli_fail(session, STARG_ERROR_ARGUMENT,
                    "'%.200s' has no known format; use a name that ends in %s", name, list);
}

/* Is it an output whose value says what it writes: FILE.obj|.ply, or DIR? */
static bool is_output(const cli_option *o) {
    return o->kind == STARG_FIELD_TEXT && !(o->flags & STARG_FIELD_INPUT) &&
           (strchr(o->value, '.') != NULL || strcmp(o->value, "DIR") == 0);
}

static bool writes(const cli_option *o, const char *extension) {
    size_t size = strlen(extension);
    for (const char *at = is_output(o) ? o->value : ""; (at = strchr(at, '.')) != NULL; at++)
        if (strcspn(at, "|") == size && strncasecmp(at, extension, size) == 0)
            return true;
    return false;
}

/* The command of which -o, or with `any` whatever option, writes that extension; NULL: none. */
static const cli_command *find_writer(const cli_command *const *table, const char *extension,
                                      bool any, const cli_option **by) {
    for (size_t c = 0; table[c] != NULL; c++) {
        for (size_t i = 0; i < table[c]->option_count; i++)
            if ((any || table[c]->options[i].letter == 'o') &&
                writes(*by = &table[c]->options[i], extension))
                return table[c];
        const cli_command *member =
            table[c]->members != NULL ? find_writer(table[c]->members, extension, any, by) : NULL;
        if (member != NULL)
            return member;
    }
    return NULL;
}

static starg_status check_extension(cli_session *session, const cli_option *o, const char *name) {
    static const cli_command *const likely[] = {&cli_command_export, &cli_command_view,
                                                &cli_command_repair, &cli_command_decompose,
                                                &cli_command_guard,  NULL};
    const cli_command *command = session->command, *writer = NULL;
    const cli_option *by = NULL;
    const char letter[] = {o->letter, '\0'}, *slash = strrchr(name, '/');
    const char *extension = strrchr(slash != NULL ? slash : name, '.');
    const char *dashes = o->letter != 0 ? "-" : "--", *shown = o->letter != 0 ? letter : o->option;
    if (extension == NULL || writes(o, extension))
        return STARG_OK;
    for (size_t i = 0; i < command->option_count; i++)
        if (writes(&command->options[i], extension))
            return cli_fail(
                session, STARG_ERROR_ARGUMENT,
                "%s%s writes %s, not '%.200s'; such files are written by --%s %s%s", dashes, shown,
                o->value, name, command->options[i].option, command->options[i].value,
                o->letter == 'o' && find_writer(likely, extension, false, &by) == likely[0]
                    ? ", and of a whole result by 'starguard export'"
                    : "");
    writer = find_writer(likely, extension, false, &by);
    writer = writer != NULL ? writer : find_writer(cli_commands, extension, false, &by);
    writer = writer != NULL ? writer : find_writer(likely, extension, true, &by);
    writer = writer != NULL ? writer : find_writer(cli_commands, extension, true, &by);
    if (writer == NULL)
        return STARG_OK;
    if (by->letter != 'o')
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "%s%s writes %s, not '%.200s'; such files are written by --%s %s of "
                        "'starguard %s'",
                        dashes, shown, o->value, name, by->option, by->value, writer->name);
    return cli_fail(session, STARG_ERROR_ARGUMENT,
                    "%s%s writes %s, not '%.200s'; such files are written by 'starguard %s %s'",
                    dashes, shown, o->value, name, writer->name, writer->usage);
}

starg_status cli_check_extensions(cli_session *session, const char *values) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < session->command->option_count && status == STARG_OK; i++) {
        const cli_option *o = &session->command->options[i];
        const char *name = is_output(o) ? *(const char *const *)(values + o->offset) : NULL;
        if (name != NULL && strcmp(name, "-") != 0 &&
            !cli_outputs_reads(&session->outputs, name)) /* for which there is a better message */
            status = check_extension(session, o, name);
    }
    return status;
}

starg_status cli_announce_with_extension(cli_session *session, const char *option, const char *name,
                                         const char *extension) {
    if (name != NULL && strcmp(name, "-") != 0 && !cli_has_extension(name, extension))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "%s needs a name that ends in %s, not '%.200s'", option, extension, name);
    return cli_announce(session, name);
}
