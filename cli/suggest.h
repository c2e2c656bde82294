/* SPDX-License-Identifier: Apache-2.0 */
/* Did you mean ...? The name nearest to a mistyped word. */
#ifndef STARGUARD_CLI_SUGGEST_H
#define STARGUARD_CLI_SUGGEST_H

#include <stddef.h>

typedef struct cli_suggestion {
    const char *word;
    const char *best; /* NULL until a name is near enough */
    size_t distance;  /* of the best                      */
} cli_suggestion;

void cli_suggest_begin(cli_suggestion *suggestion, const char *word);

/* Takes `name` if it is nearer than what was tried before; the first of equals stays. */
void cli_suggest_try(cli_suggestion *suggestion, const char *name);

#endif
