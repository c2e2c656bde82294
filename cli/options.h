/* SPDX-License-Identifier: Apache-2.0 */
/* Options as tables: rows of the library's field tables (starguard/fields.h), and rows of the same
 * type for options of a command. The parser, the help, the manual, completion and messages all use
 * them.
 *
 * Why not argp: it accepts abbreviated option names (so that a new option can break an old script),
 * cannot suggest the intended name, and hides its tables from other users (help in our order,
 * manual pages, completion). */
#pragma once

#include <stdio.h>

#include "starguard/fields.h"

/* ---- strict number parsing: the whole word or nothing (options.c) ---- */

/* A finite decimal number; no spaces, hexadecimal, "inf" or "nan". */
bool cli_number_real(const char *word, double *value);

/* `count` of them separated by commas. */
bool cli_number_list(const char *word, double *values, int count);

/* A fraction in percent with two digits, rounded down, so that only 1 becomes 100; exact hundredths
 * of a percent (within a double) keep their value. */
double cli_percent(double fraction);

/* ---- did you mean ...? The name most similar to a mistyped word (options.c) ---- */

typedef struct cli_suggestion {
    const char *word;
    const char *best; /* NULL until a name is similar enough */
    size_t distance;  /* of the best */
} cli_suggestion;

void cli_suggest_begin(cli_suggestion *suggestion, const char *word);

/* Takes `name` if it is more similar than earlier ones; ties keep the first. */
void cli_suggest_try(cli_suggestion *suggestion, const char *name);

/* Rows with a NULL `option` are not options. */
typedef starg_field cli_option;

/* Entries of a command's table, whose struct type is `values`. After the help other members of the
 * row may follow: .group, .brief. */
#define CLI_OPTION(NAME, KIND, MEMBER, VALUE, ...)                                                 \
    .option = NAME, .kind = KIND, .offset = offsetof(values, MEMBER),                              \
    .size = sizeof(((values *)0)->MEMBER), .value = VALUE, .help = __VA_ARGS__
#define CLI_FLAG_OPTION(NAME, MEMBER, ...)                                                         \
    { CLI_OPTION(NAME, STARG_FIELD_FLAG, MEMBER, NULL, __VA_ARGS__) }
#define CLI_TEXT_OPTION(NAME, MEMBER, VALUE, ...)                                                  \
    { CLI_OPTION(NAME, STARG_FIELD_TEXT, MEMBER, VALUE, __VA_ARGS__) }
/* Same for an input file. */
#define CLI_INPUT_OPTION(NAME, MEMBER, VALUE, ...)                                                 \
    { CLI_OPTION(NAME, STARG_FIELD_TEXT, MEMBER, VALUE, __VA_ARGS__), .flags = STARG_FIELD_INPUT }
/* Input files, or names; each occurrence adds one. */
#define CLI_INPUTS_OPTION(NAME, MEMBER, VALUE, ...)                                                \
    { CLI_OPTION(NAME, STARG_FIELD_TEXTS, MEMBER, VALUE, __VA_ARGS__), .flags = STARG_FIELD_INPUT }
#define CLI_POINTS_OPTION(NAME, MEMBER, VALUE, ...)                                                \
    { CLI_OPTION(NAME, STARG_FIELD_PLACES, MEMBER, VALUE, __VA_ARGS__), .length = 3 }
#define CLI_BOXES_OPTION(NAME, MEMBER, VALUE, ...)                                                 \
    { CLI_OPTION(NAME, STARG_FIELD_PLACES, MEMBER, VALUE, __VA_ARGS__), .length = 6 }
#define CLI_CHOICE_OPTION(NAME, MEMBER, WORDS, DEFAULT, VALUE, ...)                                \
    {                                                                                              \
        CLI_OPTION(NAME, STARG_FIELD_CHOICE, MEMBER, VALUE, __VA_ARGS__), .words = WORDS,          \
                                                                          .initial = DEFAULT       \
    }
#define CLI_COUNT_OPTION(NAME, MEMBER, VALUE, LEAST, MOST, DEFAULT, TEXT, ...)                     \
    {                                                                                              \
        CLI_OPTION(NAME, STARG_FIELD_COUNT, MEMBER, VALUE, __VA_ARGS__),                           \
            .least = LEAST, .most = MOST, .initial = DEFAULT, .default_text = TEXT                 \
    }
#define CLI_REAL_OPTION(NAME, MEMBER, VALUE, LOW, HIGH, DEFAULT, TEXT, ...)                        \
    {                                                                                              \
        CLI_OPTION(NAME, STARG_FIELD_REAL, MEMBER, VALUE, __VA_ARGS__),                            \
            .low = LOW, .high = HIGH, .standard = DEFAULT, .default_text = TEXT                    \
    }
#define CLI_POSITIVE_OPTION(NAME, MEMBER, VALUE, HIGH, DEFAULT, TEXT, ...)                         \
    {                                                                                              \
        CLI_OPTION(NAME, STARG_FIELD_REAL, MEMBER, VALUE, __VA_ARGS__),                            \
            .high = HIGH, .flags = STARG_FIELD_ABOVE, .standard = DEFAULT, .default_text = TEXT    \
    }
/* -o, for a member `output`. */
#define CLI_OUTPUT_OPTION(VALUE, ...)                                                              \
    { CLI_OPTION("output", STARG_FIELD_TEXT, output, VALUE, __VA_ARGS__), .letter = 'o' }

/* A table and the struct that it fills; `values` is NULL for help. */
typedef struct cli_group {
    const cli_option *options;
    size_t count;
    void *values;
} cli_group;

/* Why parsing failed: one line for the user. */
typedef struct cli_parse_error {
    char text[512];
} cli_parse_error;

/* Parses `argc` words. Options and operands may be mixed; "--" ends the options. Option names
 * cannot be abbreviated. Moves operands to the front of argv and returns their number; -1 with a
 * message on the first error. Options of several values add up when they are repeated; a second
 * value for an option that has one is an error. */
int cli_options_parse(const cli_group *groups, size_t group_count, int argc, char **argv,
                      cli_parse_error *error);

/* Sets the defaults of a group. */
void cli_options_default(const cli_group *group);

/* The next lower-case word in the value form of a TEXT option, searching from *at, which starts as
 * `value`; NULL after the last. */
const char *cli_option_next_word(const char **at, size_t *size);

/* Writes the options whose values are not the defaults, as a shell takes them: " --name value". */
void cli_options_print(const cli_group *group, FILE *stream);

/* Writes a word for a shell, in quotes if it needs them. */
void cli_word_print(const char *word, FILE *stream);

/* Frees what parsing allocated. */
void cli_options_free(const cli_group *group);

/* Help text of an option, with its default; truncated to `size` bytes. */
void cli_option_help(const cli_option *option, char *text, size_t size);
enum { CLI_HELP_SIZE = 1024 };

/* With as few digits as tell it. */
void cli_print_real(double value, FILE *stream);
