/* Options as tables. A table says for each option what it is called, what it takes and where the
 * value goes; the parser, the help and the messages all live on it.
 *
 * Why not argp: it takes abbreviations of option names (so that a new option can break an old
 * script), cannot suggest the name that was meant, and hides its tables from whatever else needs
 * them (help in our order, manual pages, completion). */
#ifndef STARGUARD_CLI_OPTIONS_H
#define STARGUARD_CLI_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The type of the variable that an option fills. */
typedef enum cli_kind {
    CLI_FLAG,   /* bool: set to true                                 */
    CLI_TEXT,   /* const char *                                      */
    CLI_COUNT,  /* uint64_t in [least, most]                         */
    CLI_REAL,   /* double in [low, high], or (low, high]             */
    CLI_CHOICE, /* int: the index of a word of `choices`             */
    CLI_POINTS, /* cli_points: every occurrence appends X,Y,Z        */
    CLI_BOXES   /* cli_points: every occurrence appends two corners  */
} cli_kind;

typedef struct cli_option {
    const char *name;  /* without the dashes                         */
    char letter;       /* short form, or 0                           */
    cli_kind kind;     /* of the value                               */
    size_t offset;     /* of the variable in the group's struct      */
    const char *value; /* what help calls the value; NULL for a flag */
    const char *help;
    const char *const *choices; /* CLI_CHOICE: ends with NULL        */
    uint64_t least, most;
    double low, high;
    bool above; /* low itself is out                                 */
} cli_option;

/* Entries of the table of a command, whose struct is called `values`. */
#define CLI_OPTION(NAME, KIND, MEMBER, VALUE, HELP)                                                \
    .name = NAME, .kind = KIND, .offset = offsetof(values, MEMBER), .value = VALUE, .help = HELP
#define CLI_FLAG_OPTION(NAME, MEMBER, HELP)                                                        \
    { CLI_OPTION(NAME, CLI_FLAG, MEMBER, NULL, HELP) }
#define CLI_TEXT_OPTION(NAME, MEMBER, VALUE, HELP)                                                 \
    { CLI_OPTION(NAME, CLI_TEXT, MEMBER, VALUE, HELP) }
#define CLI_POINTS_OPTION(NAME, MEMBER, VALUE, HELP)                                               \
    { CLI_OPTION(NAME, CLI_POINTS, MEMBER, VALUE, HELP) }
#define CLI_BOXES_OPTION(NAME, MEMBER, VALUE, HELP)                                                \
    { CLI_OPTION(NAME, CLI_BOXES, MEMBER, VALUE, HELP) }
#define CLI_CHOICE_OPTION(NAME, MEMBER, WORDS, VALUE, HELP)                                        \
    { CLI_OPTION(NAME, CLI_CHOICE, MEMBER, VALUE, HELP), .choices = WORDS }
#define CLI_COUNT_OPTION(NAME, MEMBER, VALUE, LEAST, MOST, HELP)                                   \
    { CLI_OPTION(NAME, CLI_COUNT, MEMBER, VALUE, HELP), .least = LEAST, .most = MOST }
#define CLI_REAL_OPTION(NAME, MEMBER, VALUE, LOW, HIGH, HELP)                                      \
    { CLI_OPTION(NAME, CLI_REAL, MEMBER, VALUE, HELP), .low = LOW, .high = HIGH }
#define CLI_POSITIVE_OPTION(NAME, MEMBER, VALUE, HIGH, HELP)                                       \
    { CLI_OPTION(NAME, CLI_REAL, MEMBER, VALUE, HELP), .high = HIGH, .above = true }
/* -o, for a member `output`. */
#define CLI_OUTPUT_OPTION(VALUE, HELP)                                                             \
    { CLI_OPTION("output", CLI_TEXT, output, VALUE, HELP), .letter = 'o' }

/* Points or boxes from the command line, count x 3 or x 6. */
typedef struct cli_points {
    double *values;
    size_t count;
} cli_points;

/* A table and the struct that it fills. */
typedef struct cli_group {
    const cli_option *options;
    size_t count;
    void *values;
} cli_group;

/* Why parsing failed: one line for the user. */
typedef struct cli_complaint {
    char text[512];
} cli_complaint;

/* Parses `argc` words. Options and operands may mix; "--" ends the options. Options are taken by
 * their whole name. Operands are moved to the front of argv, their number is returned; -1 with a
 * complaint on the first error. Later occurrences of an option replace earlier ones. */
int cli_options_parse(const cli_group *groups, size_t group_count, int argc, char **argv,
                      cli_complaint *complaint);

/* Frees what parsing has allocated. */
void cli_options_free(const cli_group *group);

#endif
