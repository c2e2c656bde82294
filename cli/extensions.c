/* SPDX-License-Identifier: Apache-2.0 */
#include "extensions.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "outputs.h"

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

starg_status cli_announce_with_extension(cli_session *session, const char *option, const char *name,
                                         const char *extension) {
    if (name != NULL && strcmp(name, "-") != 0 && !cli_has_extension(name, extension))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "%s needs a name that ends in %s, not '%.200s'", option, extension, name);
    return cli_announce(session, name);
}
