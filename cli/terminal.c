/* SPDX-License-Identifier: Apache-2.0 */
#include "terminal.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool cli_terminal(FILE *stream) {
    const char *type = getenv("TERM");
    return isatty(fileno(stream)) == 1 && type != NULL && strcmp(type, "dumb") != 0;
}

/* NO_COLOR counts if it is set and not empty (no-color.org). */
static bool has_colors(FILE *stream) {
    const char *refused = getenv("NO_COLOR");
    return (refused == NULL || *refused == '\0') && cli_terminal(stream);
}

const char *cli_style_on(FILE *stream, cli_style style) {
    static const char *const sequences[] = {"\033[1m", "\033[31m", "\033[32m", "\033[33m"};
    return has_colors(stream) ? sequences[style] : "";
}

const char *cli_style_off(FILE *stream) {
    return has_colors(stream) ? "\033[0m" : "";
}
