/* SPDX-License-Identifier: Apache-2.0 */
/* Similarity is the optimal string alignment distance: insertions, deletions, substitutions and
 * swaps of neighbours count one each. A name is similar enough if at most a third of it (at least
 * one letter) differs, or if the word is its prefix. */
#include "suggest.h"

#include <stdint.h>
#include <string.h>

enum { LONGEST = 48 };

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t distance(const char *a, size_t a_size, const char *b, size_t b_size) {
    uint8_t table[LONGEST + 1][LONGEST + 1];
    for (size_t i = 0; i <= a_size; i++)
        table[i][0] = (uint8_t)i;
    for (size_t j = 0; j <= b_size; j++)
        table[0][j] = (uint8_t)j;
    for (size_t i = 1; i <= a_size; i++) {
        for (size_t j = 1; j <= b_size; j++) {
            size_t best = table[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            best = least(best, least(table[i - 1][j], table[i][j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = least(best, table[i - 2][j - 2] + 1);
            table[i][j] = (uint8_t)best;
        }
    }
    return table[a_size][b_size];
}

void cli_suggest_begin(cli_suggestion *suggestion, const char *word) {
    *suggestion = (cli_suggestion){.word = word};
}

void cli_suggest_try(cli_suggestion *suggestion, const char *name) {
    size_t word_size = strlen(suggestion->word), size = strlen(name);
    if (word_size > LONGEST || size > LONGEST)
        return;
    size_t d = distance(suggestion->word, word_size, name, size);
    size_t limit = size < 6 ? 1 + (size > 3) : size / 3;
    if (word_size >= 2 && strncmp(suggestion->word, name, word_size) == 0)
        d = least(d, 1);
    if (d > limit || (suggestion->best != NULL && d >= suggestion->distance))
        return;
    suggestion->best = name;
    suggestion->distance = d;
}
