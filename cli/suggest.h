/* SPDX-License-Identifier: Apache-2.0 */
/* Did you mean ...? Finds the name most similar to a mistyped word. */
#ifndef STARGUARD_CLI_SUGGEST_H
#define STARGUARD_CLI_SUGGEST_H

#include <stddef.h>

typedef struct cli_suggestion {
    const char *word;
    const char *best; /* NULL until a name is similar enough */
    size_t distance;  /* of the best */
} cli_suggestion;

void cli_suggest_begin(cli_suggestion *suggestion, const char *word);

/* Takes `name` if it is more similar than earlier ones; ties keep the first. */
void cli_suggest_try(cli_suggestion *suggestion, const char *name);

#endif
