/* SPDX-License-Identifier: Apache-2.0 */
/* The table of commands, used by main, the help and the suggestions. */
#pragma once

#include <stdio.h>

#include "session.h"

/* Meaning of the first operand, which is read before the command runs. */
typedef enum cli_input {
    CLI_INPUT_NONE,
    CLI_INPUT_MESH, /* session->mesh */
    CLI_INPUT_SOLID /* session->solid, a usable mesh */
} cli_input;

struct cli_command {
    const char *name;
    const char *usage;       /* after the name: "MODEL -o FILE [options]" */
    const char *summary;     /* one line, no full stop */
    const char *description; /* paragraphs separated by newlines */
    const char *examples;    /* lines: "# what it does", then the command */
    const cli_command *const
        *members; /* a group ("db") has commands ("db add") and nothing below; ends with NULL */
    const cli_option *options;
    size_t option_count;
    size_t least_operands, most_operands;
    /* Words allowed as first operand, for completion, ended by NULL. If absent: files. */
    const char *(*operand_word)(size_t index);
    size_t values_size; /* of the struct that the options fill */
    /* The library's options of the command, and their place in that struct. */
    const starg_fields *(*library)(void);
    size_t library_offset;
    cli_input input;
    bool in_place; /* an output may replace an input */
    /* Called in this order; all but `run` may be NULL. The struct is initialized with the tables'
     * defaults. */
    starg_status (*prepare)(cli_session *session,
                            void *values);                   /* checks options and output names */
    starg_status (*run)(cli_session *session, void *values); /* does the work, with its input */
    void (*release)(cli_session *session, void *values);     /* frees what `prepare` allocated */
};

/* Parts of the table's rows. */
#define CLI_OPERANDS(LEAST, MOST) .least_operands = LEAST, .most_operands = MOST
#define CLI_OPTIONS(TABLE)                                                                         \
    .options = TABLE, .option_count = sizeof TABLE / sizeof *TABLE, .values_size = sizeof(values)
#define CLI_LIBRARY(FIELDS, MEMBER) .library = FIELDS, .library_offset = offsetof(values, MEMBER)

/* Option number `index` of a command besides the common ones, or (NULL) of the common ones; NULL
 * after the last. */
const cli_option *cli_command_option(const cli_command *command, size_t index);

/* The option groups of a command and their values: its own, the library's, the common ones. */
enum { CLI_OWN, CLI_FROM_LIBRARY, CLI_COMMON, CLI_GROUPS };
void cli_command_groups(const cli_command *command, void *values, void *common,
                        cli_group groups[CLI_GROUPS]);

/* Sets the defaults of a command's own and its library's options. */
void cli_command_default(const cli_command *command, void *values);

/* The line that runs a command with these options: on the heap, also on failure. `model` may be
 * NULL. Errors: MEMORY. */
starg_status cli_command_print(cli_session *session, const cli_command *command, void *values,
                               uint64_t seed, const char *model, const char *output, char **line);

/* The command that makes a result again: likewise. */
struct starg_guards;
starg_status cli_guard_command(cli_session *session, const struct starg_guards *guards,
                               const char *output, char **line);
struct starg_decomposition;
typedef struct cli_pieces_files {
    const char *pieces, *report; /* names */
    bool binary;
} cli_pieces_files;
starg_status cli_decompose_command(cli_session *session, const struct starg_decomposition *pieces,
                                   const cli_pieces_files *files, char **line);
/* `distance` is an index of cli_distance_words. */
starg_status cli_matrix_command(cli_session *session, const char *database, int distance,
                                const char *output, char **line);

extern const cli_command cli_command_sample;
extern const cli_command cli_command_check;
extern const cli_command cli_command_repair;
extern const cli_command cli_command_skeleton;
extern const cli_command cli_command_visible;
extern const cli_command cli_command_kernel;
extern const cli_command cli_command_guard;
extern const cli_command cli_command_decompose;
extern const cli_command cli_command_describe;
extern const cli_command cli_command_match;
extern const cli_command cli_command_verify;
extern const cli_command cli_command_view;
extern const cli_command cli_command_export;
extern const cli_command cli_command_map;
extern const cli_command cli_command_morph;
extern const cli_command cli_command_completion;
extern const cli_command cli_command_db;
extern const cli_command cli_command_db_create;
extern const cli_command cli_command_db_add;
extern const cli_command cli_command_db_remove;
extern const cli_command cli_command_db_list;
extern const cli_command cli_command_db_query;
extern const cli_command cli_command_db_matrix;
extern const cli_command cli_command_db_evaluate;

/* All commands in the order of the help; ends with NULL. */
extern const cli_command *const cli_commands[];

/* The command of that name in a table; NULL if there is none. Members of a group are found by the
 * last word of their names. */
const cli_command *cli_command_find(const cli_command *const *table, const char *word);

/* The last word of a command's name. */
const char *cli_command_word(const cli_command *command);

/* ---- the help, generated from the table of commands and their options (help.c) ---- */

/* Texts about the program as a whole, for the help and the manual. */
extern const char *const cli_summary;
extern const char *const cli_about_program;
extern const char *const cli_about_files;
extern const char *const cli_first_steps; /* like the examples of a command */

typedef struct cli_exit_text {
    cli_exit status;
    const char *text;
} cli_exit_text;
extern const cli_exit_text cli_exit_texts[];
extern const size_t cli_exit_text_count;

/* A few lines for an incomplete command line. */
void cli_help_short(FILE *stream);

/* Describes the program and lists the commands. */
void cli_help_program(FILE *stream);

/* Help of one command: what most need (NULL), "all", or the options of a group. */
void cli_help_command(FILE *stream, const cli_command *command, const char *part);

/* Is it "all", or a group of the command's options? */
bool cli_help_has_part(const cli_command *command, const char *word);

/* All commands and options as one JSON object (docs/formats.md). False when out of memory. */
bool cli_help_json(FILE *stream);

/* A file below share/ that tools/manual.py has made, as a text on the heap; NULL if there is none.
 */
char *cli_installed_text(const char *name);
