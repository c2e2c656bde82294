/* SPDX-License-Identifier: Apache-2.0 */
#include "options.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Decimal digits only; false for anything else and on overflow. */
static bool cli_number_count(const char *word, uint64_t *value) {
    uint64_t sum = 0;
    if (*word == '\0')
        return false;
    for (; *word != '\0'; word++) {
        if (*word < '0' || *word > '9')
            return false;
        uint64_t digit = (uint64_t)(*word - '0');
        if (sum > (UINT64_MAX - digit) / 10)
            return false;
        sum = 10 * sum + digit;
    }
    *value = sum;
    return true;
}

/* The program stays in the "C" locale, so strtod expects a decimal point. */
static bool read_real(const char *word, size_t size, double *value) {
    if (size == 0 || strspn(word, "+-.0123456789eE") < size)
        return false;
    char *end;
    *value = strtod(word, &end);
    return end == word + size && isfinite(*value);
}

bool cli_number_real(const char *word, double *value) {
    return read_real(word, strlen(word), value);
}

bool cli_number_list(const char *word, double *values, int count) {
    for (int i = 0; i < count; i++) {
        size_t size = strcspn(word, ",");
        if (!read_real(word, size, &values[i]) || (word[size] == ',') != (i < count - 1))
            return false;
        word += size + 1;
    }
    return true;
}

double cli_percent(double fraction) {
    double hundredths = floor(1e4 * fraction); /* the product is rounded and may be one off */
    if ((hundredths + 1) / 1e4 <= fraction)
        hundredths++;
    else if (hundredths / 1e4 > fraction)
        hundredths--;
    return hundredths / 100;
}

/* Similarity is the optimal string alignment distance: insertions, deletions, substitutions and
 * swaps of neighbours count one each. A name is similar enough if at most a third of it (at least
 * one letter) differs, or if the word is its prefix. */

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

/* ---- the parser ---- */

/* State of the parser. */
typedef struct parser {
    const cli_group *groups;
    size_t group_count;
    int argc, next;
    char **argv;
    cli_parse_error *error;
    bool *given; /* by option of the groups, one after the other */
} parser;

/* An option as given by the user. */
typedef struct match {
    const cli_option *option;
    const cli_group *group;
    char shown[64]; /* "--name" or "-n" */
} match;

__attribute__((format(printf, 2, 3))) static bool fail_parse(parser *p, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(p->error->text, sizeof p->error->text, format, arguments);
    va_end(arguments);
    return false;
}

/* ---- values ---- */

static bool set_choice(parser *p, const match *m, const char *word) {
    char list[256] = "";
    size_t used = 0;
    cli_suggestion near;
    if (starg_field_set_word(m->option, m->group->values, word))
        return true;
    cli_suggest_begin(&near, word);
    for (int i = 0; m->option->words[i] != NULL; i++) {
        const char *choice = m->option->words[i];
        cli_suggest_try(&near, choice);
        bool last = m->option->words[i + 1] == NULL && m->option->kind == STARG_FIELD_CHOICE;
        const char *comma = i == 0 ? "" : last ? " or " : ", ";
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", comma, choice);
        if (used >= sizeof list)
            used = sizeof list - 1;
    }
    if (m->option->kind != STARG_FIELD_CHOICE && used < sizeof list)
        snprintf(list + used, sizeof list - used,
                 m->option->kind == STARG_FIELD_COUNT ? " or a whole number" : " or a number");
    if (near.best != NULL)
        return fail_parse(p, "%s takes %s, not '%.100s'; did you mean '%s'?", m->shown, list, word,
                          near.best);
    return fail_parse(p, "%s takes %s, not '%.100s'", m->shown, list, word);
}

static bool set_count(parser *p, const match *m, const char *word) {
    const cli_option *o = m->option;
    uint64_t value;
    if (cli_number_count(word, &value) && value <= o->most &&
        starg_field_set_count(o, m->group->values, value))
        return true;
    if (o->words != NULL)
        return set_choice(p, m, word);
    if (o->most == UINT64_MAX)
        return fail_parse(p, "%s takes a whole number of at least %llu, not '%.100s'", m->shown,
                          (unsigned long long)o->least, word);
    return fail_parse(p, "%s takes a whole number from %llu to %llu, not '%.100s'", m->shown,
                      (unsigned long long)o->least, (unsigned long long)o->most, word);
}

static bool set_real(parser *p, const match *m, const char *word) {
    const cli_option *o = m->option;
    double value;
    if (cli_number_real(word, &value) && starg_field_set_real(o, m->group->values, value))
        return true;
    if (o->words != NULL)
        return set_choice(p, m, word);
    return fail_parse(p, "%s takes a number %s %g and at most %g, not '%.100s'", m->shown,
                      (o->flags & STARG_FIELD_ABOVE) ? "above" : "of at least", o->low, o->high,
                      word);
}

/* Numbers with commas between them. */
static bool set_numbers(parser *p, const match *m, const char *word) {
    const cli_option *o = m->option;
    double values[6];
    bool good = o->length <= 6 && cli_number_list(word, values, (int)o->length);
    for (size_t i = 0; i < o->length && good; i++) {
        starg_field one = *o;
        one.offset += i * sizeof *values;
        one.size = sizeof *values;
        good = starg_field_set_real(&one, m->group->values, values[i]);
    }
    if (good)
        return true;
    if (o->high >= 1e100)
        return fail_parse(p, "%s takes %s (numbers, no spaces), not '%.100s'", m->shown, o->value,
                          word);
    return fail_parse(p, "%s takes %s (numbers %s %g and at most %g, no spaces), not '%.100s'",
                      m->shown, o->value, (o->flags & STARG_FIELD_ABOVE) ? "above" : "of at least",
                      o->low, o->high, word);
}

static bool add_place(parser *p, const match *m, const char *word, starg_places *points) {
    size_t width = m->option->length;
    double place[6];
    if (!cli_number_list(word, place, (int)width))
        return fail_parse(p, "%s takes a %s as %s (%s numbers, no spaces), not '%.100s'", m->shown,
                          width == 3   ? "point"
                          : width == 6 ? "box"
                                       : "pair",
                          m->option->value,
                          width == 3   ? "three"
                          : width == 6 ? "six"
                                       : "two",
                          word);
    double *grown = realloc(points->values, (points->count + 1) * width * sizeof *place);
    if (grown == NULL)
        return fail_parse(p, "%s: out of memory", m->shown);
    memcpy(grown + width * points->count, place, width * sizeof *place);
    points->values = grown;
    points->count++;
    return true;
}

static bool add_text(parser *p, const match *m, const char *word, starg_texts *texts) {
    if (*word == '\0')
        return fail_parse(p, "%s takes a name, not an empty word", m->shown);
    const char **grown = realloc((void *)texts->values, (texts->count + 1) * sizeof *texts->values);
    if (grown == NULL)
        return fail_parse(p, "%s: out of memory", m->shown);
    texts->values = grown;
    texts->values[texts->count++] = word;
    return true;
}

/* A flag named "no-X" clears X. */
static bool set_flag(const match *m) {
    return starg_field_set_count(m->option, m->group->values,
                                 strncmp(m->option->option, "no-", 3) != 0);
}

/* Values of an option either add up, or there is one: none replaces another. Flags say the same
 * again. */
static bool note_given(parser *p, const match *m) {
    const cli_option *o = m->option;
    bool adds_up = o->kind == STARG_FIELD_PLACES || o->kind == STARG_FIELD_TEXTS;
    size_t at = (size_t)(o - m->group->options);
    for (const cli_group *g = p->groups; g != m->group; g++)
        at += g->count;
    bool again = p->given[at];
    p->given[at] = true;
    if (!again || o->kind == STARG_FIELD_FLAG || (adds_up && !(o->flags & STARG_FIELD_ONCE)))
        return true;
    return fail_parse(p, "%s is given more than once, and takes effect only once; leave one",
                      m->shown);
}

static bool set_value(parser *p, const match *m, const char *word) {
    void *variable = (char *)m->group->values + m->option->offset;
    switch (m->option->kind) {
    case STARG_FIELD_FLAG:
        return set_flag(m);
    case STARG_FIELD_COUNT:
        return set_count(p, m, word);
    case STARG_FIELD_REAL:
        return set_real(p, m, word);
    case STARG_FIELD_CHOICE:
        return set_choice(p, m, word);
    case STARG_FIELD_NUMBERS:
        return set_numbers(p, m, word);
    case STARG_FIELD_PLACES:
        return add_place(p, m, word, variable);
    case STARG_FIELD_TEXTS:
        return add_text(p, m, word, variable);
    default:
        *(const char **)variable = word;
        return *word != '\0' || fail_parse(p, "%s takes a name, not an empty word", m->shown);
    }
}

/* ---- names ---- */

static bool find_long(parser *p, const char *name, size_t size, match *m) {
    char word[64] = "";
    cli_suggestion near;
    if (size < sizeof word)
        memcpy(word, name, size);
    cli_suggest_begin(&near, word);
    for (size_t g = 0; g < p->group_count; g++) {
        for (size_t i = 0; i < p->groups[g].count; i++) {
            const cli_option *o = &p->groups[g].options[i];
            if (o->option == NULL)
                continue;
            if (strcmp(word, o->option) == 0) {
                *m = (match){.option = o, .group = &p->groups[g]};
                snprintf(m->shown, sizeof m->shown, "--%s", o->option);
                return true;
            }
            cli_suggest_try(&near, o->option);
        }
    }
    if (near.best != NULL)
        return fail_parse(p, "unknown option '--%s'; did you mean '--%s'?", word, near.best);
    return fail_parse(p, "unknown option '--%.*s'", (int)(size < 100 ? size : 100), name);
}

static bool find_short(parser *p, char letter, match *m) {
    for (size_t g = 0; g < p->group_count; g++) {
        for (size_t i = 0; i < p->groups[g].count; i++) {
            const cli_option *o = &p->groups[g].options[i];
            if (o->option == NULL || o->letter != letter)
                continue;
            *m = (match){.option = o, .group = &p->groups[g]};
            snprintf(m->shown, sizeof m->shown, "-%c", letter);
            return true;
        }
    }
    return fail_parse(p, "unknown option '-%c'", letter);
}

/* The next word as a value. If it looks like an option, the value was probably forgotten;
 * "--name=--value" states that it is meant. */
static bool next_value(parser *p, const match *m, const char **word) {
    if (p->next == p->argc || strncmp(p->argv[p->next], "--", 2) == 0)
        return fail_parse(p, "%s needs a value: %s %s", m->shown, m->shown, m->option->value);
    *word = p->argv[p->next++];
    return true;
}

/* Does none of the option's words follow, though it needs none? */
static bool stands_alone(const parser *p, const match *m) {
    bool alone = (m->option->flags & STARG_FIELD_ALONE) != 0;
    for (int i = 0; alone && m->option->words[i] != NULL; i++)
        alone = p->next == p->argc || strcmp(p->argv[p->next], m->option->words[i]) != 0;
    return alone;
}

static bool parse_long(parser *p, const char *text) {
    match m;
    const char *equals = strchr(text, '='), *word = NULL;
    size_t size = equals != NULL ? (size_t)(equals - text) : strlen(text);
    if (!find_long(p, text, size, &m))
        return false;
    if (!note_given(p, &m))
        return false;
    if (m.option->kind == STARG_FIELD_FLAG && equals != NULL)
        return fail_parse(p, "%s takes no value", m.shown);
    if (equals == NULL && stands_alone(p, &m))
        return starg_field_set_count(m.option, m.group->values, m.option->none);
    if (m.option->kind != STARG_FIELD_FLAG) {
        word = equals != NULL ? equals + 1 : NULL;
        if (word == NULL && !next_value(p, &m, &word))
            return false;
    }
    return set_value(p, &m, word);
}

/* "-o FILE" or "-oFILE"; letters cannot be combined. */
static bool parse_short(parser *p, const char *text) {
    match m;
    const char *word = NULL;
    if (!find_short(p, *text, &m) || !note_given(p, &m))
        return false;
    if (m.option->kind == STARG_FIELD_FLAG && text[1] != '\0')
        return fail_parse(p, "unknown option '-%.100s'", text);
    if (m.option->kind != STARG_FIELD_FLAG) {
        word = text + 1;
        if (*word == '\0' && !next_value(p, &m, &word))
            return false;
    }
    return set_value(p, &m, word);
}

/* The number of operands; -1: wrong. */
static int parse_words(parser *p) {
    int operands = 0;
    bool options_end = false;
    while (p->next < p->argc) {
        char *word = p->argv[p->next++];
        if (options_end || word[0] != '-' || word[1] == '\0')
            p->argv[operands++] = word;
        else if (strcmp(word, "--") == 0)
            options_end = true;
        else if (word[1] == '-' ? !parse_long(p, word + 2) : !parse_short(p, word + 1))
            return -1;
    }
    return operands;
}

int cli_options_parse(const cli_group *groups, size_t group_count, int argc, char **argv,
                      cli_parse_error *error) {
    parser p = {
        .groups = groups, .group_count = group_count, .argc = argc, .argv = argv, .error = error};
    size_t count = 1;
    for (size_t g = 0; g < group_count; g++)
        count += groups[g].count;
    p.given = calloc(count, sizeof *p.given);
    if (p.given == NULL) {
        fail_parse(&p, "out of memory");
        return -1;
    }
    int operands = parse_words(&p);
    free(p.given);
    return operands;
}

void cli_options_default(const cli_group *group) {
    const starg_fields table = {.fields = group->options, .count = group->count};
    starg_fields_default(&table, group->values);
}

const char *cli_option_next_word(const char **at, size_t *size) {
    while (**at != '\0') {
        const char *word = *at;
        *size = strcspn(word, "|");
        *at = word + *size + (word[*size] == '|');
        if (islower((unsigned char)*word))
            return word;
    }
    return NULL;
}

/* ---- printing ---- */

void cli_word_print(const char *word, FILE *stream) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-+=./,:@%";
    if (*word != '\0' && word[strspn(word, plain)] == '\0') {
        fputs(word, stream);
        return;
    }
    fputc('\'', stream);
    for (; *word != '\0'; word++)
        fputs(*word == '\'' ? "'\\''" : (const char[]){*word, '\0'}, stream);
    fputc('\'', stream);
}

/* With as few digits as name the number. */
void cli_print_real(double value, FILE *stream) {
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        double read;
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (cli_number_real(text, &read) && read == value)
            break;
    }
    fputs(text, stream);
}

static void print_reals(const double *values, size_t count, FILE *stream) {
    for (size_t i = 0; i < count; i++) {
        fputs(i > 0 ? "," : "", stream);
        cli_print_real(values[i], stream);
    }
}

static const char *word_of(const cli_option *o, const void *values) {
    double value = 0;
    if (o->kind != STARG_FIELD_REAL)
        return starg_field_word(o, starg_field_count(o, values));
    memcpy(&value, (const char *)values + o->offset, sizeof value);
    return starg_field_real_word(o, value);
}

/* One occurrence of an option; PLACES and TEXTS: number `i`. */
static void print_option(const cli_option *o, const void *values, size_t i, FILE *stream) {
    const void *at = (const char *)values + o->offset;
    fprintf(stream, " --%s", o->option);
    if (o->kind == STARG_FIELD_FLAG)
        return;
    fputc(' ', stream);
    if (o->words != NULL && word_of(o, values) != NULL)
        fputs(word_of(o, values), stream);
    else if (o->kind == STARG_FIELD_COUNT)
        fprintf(stream, "%llu", (unsigned long long)starg_field_count(o, values));
    else if (o->kind == STARG_FIELD_REAL)
        print_reals(at, 1, stream);
    else if (o->kind == STARG_FIELD_NUMBERS)
        print_reals(at, o->length, stream);
    else if (o->kind == STARG_FIELD_PLACES)
        print_reals(((const starg_places *)at)->values + i * o->length, o->length, stream);
    else if (o->kind == STARG_FIELD_TEXTS)
        cli_word_print(((const starg_texts *)at)->values[i], stream);
    else
        cli_word_print(*(const char *const *)at, stream);
}

static bool is_default(const cli_option *o, const void *at) {
    double standard[8] = {0}; /* room for any member */
    starg_field own = *o;
    const starg_fields table = {.fields = &own, .count = 1};
    own.offset = 0;
    starg_fields_default(&table, standard);
    return memcmp(at, standard, o->size) == 0;
}

void cli_options_print(const cli_group *group, FILE *stream) {
    for (size_t k = 0; k < group->count; k++) {
        const cli_option *o = &group->options[k];
        const void *at = (const char *)group->values + o->offset;
        if (o->option == NULL || is_default(o, at))
            continue;
        size_t count = o->kind == STARG_FIELD_PLACES  ? ((const starg_places *)at)->count
                       : o->kind == STARG_FIELD_TEXTS ? ((const starg_texts *)at)->count
                                                      : 1;
        for (size_t i = 0; i < count; i++)
            print_option(o, group->values, i, stream);
    }
}

void cli_options_free(const cli_group *group) {
    for (size_t i = 0; i < group->count; i++) {
        void *member = (char *)group->values + group->options[i].offset;
        if (group->options[i].kind == STARG_FIELD_PLACES) {
            free(((starg_places *)member)->values);
            *(starg_places *)member = (starg_places){0};
        } else if (group->options[i].kind == STARG_FIELD_TEXTS) {
            free((void *)((starg_texts *)member)->values);
            *(starg_texts *)member = (starg_texts){0};
        }
    }
}

void cli_option_help(const cli_option *option, char *text, size_t size) {
    char standard[256];
    starg_field_default_text(option, standard, sizeof standard);
    snprintf(text, size, "%s%s%s", option->help, standard[0] != '\0' ? " " : "", standard);
}
