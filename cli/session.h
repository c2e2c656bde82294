/* SPDX-License-Identifier: Apache-2.0 */
/* One run of one command: its options, the library's context, the destinations of text, errors,
 * results and files, and the exit status. */
#pragma once

#include "options.h"
#include "starguard/bits.h"
#include "starguard/descriptor.h"
#include "starguard/ranks.h"
#include "starguard/tetra.h"

#include <jansson.h>
#include <stdio.h>
#include <sys/types.h>

/* ---- capabilities of a terminal (session.c) ---- */

typedef enum cli_style { CLI_BOLD, CLI_RED, CLI_GREEN, CLI_YELLOW } cli_style;

/* Is `stream` a terminal with cursor movement? */
bool cli_terminal(FILE *stream);

/* The sequences that start and end a style; empty unless `stream` is a terminal and NO_COLOR is not
 * set. */
const char *cli_style_on(FILE *stream, cli_style style);
const char *cli_style_off(FILE *stream);

/* ---- progress of the library's stages: a bar, and the seconds of each stage (session.c) ---- */
/* The bar is drawn on a terminal (progress_terminal.c), or by the page that runs this program
 * (web/progress_page.c). */

enum { CLI_STAGES = 32 };

typedef struct cli_stage {
    const char *name;
    double seconds; /* of all its finished runs */
    double began;   /* start of the current run */
    bool running;
} cli_stage;

typedef struct cli_progress {
    const starg_context *context;
    bool bar;   /* draw a bar */
    bool drawn; /* a bar is visible now */
    double drawn_at;
    cli_stage stages[CLI_STAGES]; /* in the order of their first run */
    size_t count;
} cli_progress;

/* Monotonic clock in seconds. */
double cli_clock(void);

/* Can anybody see a bar? */
bool cli_progress_visible(void);

/* Draws the bar of a stage that has run for `elapsed` seconds; 0 < fraction < 1. */
void cli_progress_draw(cli_progress *progress, const cli_stage *stage, const starg_context *context,
                       double fraction, double elapsed);

/* Erases the bar, so that a line can be written. */
void cli_progress_erase(cli_progress *progress);

/* ---- output files of a run (outputs.c) ---- */
/* Each is first written under another name beside its target; all are renamed together at the very
 * end, so that a failing run changes nothing. */

enum { CLI_OUTPUT_MESSAGE = 512 };

/* Identity of a file, independent of its name. */
typedef struct cli_file_id {
    dev_t device;
    ino_t inode;
    bool known; /* it exists and is a regular file */
} cli_file_id;

typedef struct cli_output {
    char *name;     /* as given by the user */
    char *target;   /* the same with symbolic links followed */
    char *staged;   /* where it is written first */
    cli_file_id id; /* of the current target */
    bool device;    /* the target is a device or a pipe: copied, not renamed */
} cli_output;

typedef struct cli_outputs {
    cli_output *items;
    size_t count, capacity;
    char *folder;        /* created for outputs, and still empty; NULL if there is none */
    cli_file_id *inputs; /* no output may replace these */
    size_t input_count;
    char message[CLI_OUTPUT_MESSAGE]; /* why the last call failed */
    bool clash;                       /* the failure is an output that is an input */
} cli_outputs;

/* Announces an output before the work starts; fails if it cannot be written. Not for "-". */
bool cli_outputs_add(cli_outputs *outputs, const char *name);

/* Announces a folder for outputs: creates it if missing, and removes it if the run fails. At most
 * one per run. */
bool cli_outputs_add_folder(cli_outputs *outputs, const char *name);

/* Registers a file that the run reads ("-": standard input); fails if it is an output. */
bool cli_outputs_add_input(cli_outputs *outputs, const char *name);

/* Is it one of the files that the run reads? */
bool cli_outputs_reads(const cli_outputs *outputs, const char *name);

/* Where to write the output announced as `name`; returns "-" and unknown names unchanged. */
const char *cli_outputs_place(const cli_outputs *outputs, const char *name);

/* Replaces names of staged files in a message by the user's names. */
void cli_outputs_translate(const cli_outputs *outputs, char *message, size_t size);

/* Moves all staged files to their targets. */
bool cli_outputs_commit(cli_outputs *outputs);

/* Removes what is staged and frees everything; also after commit. */
void cli_outputs_discard(cli_outputs *outputs);

typedef struct cli_command cli_command;

typedef enum cli_exit {
    CLI_EXIT_DONE = 0,
    CLI_EXIT_USAGE = 1,      /* the command line is wrong */
    CLI_EXIT_INPUT = 2,      /* an input is missing, unreadable or not usable */
    CLI_EXIT_UNFINISHED = 3, /* output unwritable, out of memory, time limit */
    CLI_EXIT_FAILED = 4,     /* verification failed */
    CLI_EXIT_CANCELLED = 130
} cli_exit;

/* Options common to all commands. */
typedef struct cli_common {
    uint64_t threads, seed;
    bool keep_best;
    double time_limit; /* seconds; 0: none */
    bool quiet, verbose, json, help, version;
} cli_common;

extern const cli_option cli_common_options[];
extern const size_t cli_common_option_count;

typedef struct cli_session {
    const cli_command *command;
    cli_common common;
    char **operands;
    size_t operand_count;
    starg_mesh *mesh; /* the first operand, as the command needs it */
    starg_solid *solid;

    starg_context *context;
    cli_progress progress;
    cli_outputs outputs;
    bool stdout_taken; /* a result goes to standard output, so text goes to standard error */
    cli_exit outcome;  /* without failure: DONE, INPUT (check) or FAILED (verify) */

    json_t *report; /* --json: the object to print at the end */
    json_t *log;    /* --json: log lines of the library */
    bool report_broken;
    double began;

    starg_error error; /* failure of the command line itself */
    char message[512];
} cli_session;

/* Evaluates EXPR; returns its status on failure. */
#define TRY(EXPR)                                                                                  \
    do {                                                                                           \
        starg_status cli_status_ = (EXPR);                                                         \
        if (cli_status_ != STARG_OK)                                                               \
            return cli_status_;                                                                    \
    } while (0)

/* Before a declaration: the variable's block is freed, or its address handed to F, on every way out
 * of its scope. */
#define SCOPED       SCOPED_BY(cli_free_scoped)
#define SCOPED_BY(F) __attribute__((cleanup(F)))
void cli_free_scoped(void *pointer);

/* Defines NAME_drop for SCOPED_BY, where NAME_free takes a context that it does not need. */
#define CLI_DROP(NAME, TYPE)                                                                       \
    static inline void NAME##_drop(TYPE **object) {                                                \
        NAME##_free(NULL, *object);                                                                \
    }

static inline void starg_mesh_drop(starg_mesh **mesh) {
    starg_mesh_free(*mesh);
}
static inline void starg_bits_drop(starg_bits **rows) {
    starg_bits_free(*rows);
}

/* The same for functions that clean up after `done`. */
#define CLI_TRY(EXPR)                                                                              \
    do {                                                                                           \
        status = (EXPR);                                                                           \
        if (status != STARG_OK)                                                                    \
            goto done;                                                                             \
    } while (0)

void cli_session_init(cli_session *session, const cli_command *command);

/* Creates the context and installs signal handlers. */
starg_status cli_session_start(cli_session *session);

/* Ends the run: prints the report or the error, commits or removes the outputs, frees everything.
 * Returns the exit status. */
int cli_session_finish(cli_session *session, starg_status status);

/* Records a failure of the command line itself and returns `status`. */
starg_status cli_fail(cli_session *session, starg_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
starg_status cli_fail_memory(cli_session *session);

/* Registers a file that the run reads, which no output may then replace; NULL is allowed. Operands
 * and options that name inputs are registered automatically; use this for files named by those. */
starg_status cli_name_input(cli_session *session, const char *name);

/* Announces an output file; NULL is allowed. "-" takes standard output. */
starg_status cli_announce(cli_session *session, const char *name);

/* Same for a required output; `form` describes its name. */
starg_status cli_announce_needed(cli_session *session, const char *name, const char *form);

/* Announces a folder for outputs, which are then announced as files in it; NULL is allowed. */
starg_status cli_announce_folder(cli_session *session, const char *name);

/* Shows and logs a notice or warning of the command line, like those of the library. */
void cli_log(cli_session *session, starg_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Text for people: standard output, or standard error if a result goes there; nothing with --quiet
 * or --json. */
void cli_say(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Says that a search ended early, and why. */
void cli_say_limited(cli_session *session);

/* Same on standard error whatever the options are. */
void cli_warn(cli_session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- --json: one object on standard output (report.c) ---- */
/* docs/formats.md describes the keys. */

/* Starts the report; all functions below do nothing without a report. */
void cli_report_begin(cli_session *session);
void cli_report_free(cli_session *session);

/* Adds a key and takes over `value`; NULL means out of memory. */
void cli_put(cli_session *session, json_t *object, const char *key, json_t *value);
void cli_append(cli_session *session, json_t *array, json_t *value);

/* Values. Invalid UTF-8 bytes in text are replaced; a real that is not finite becomes null. */
json_t *cli_json_text(const char *text);
json_t *cli_json_real(double value);
json_t *cli_json_point(const double point[3]);

/* "format", "version" and "model". */
void cli_report_head(cli_session *session, const char *format, const char *file,
                     const starg_mesh *mesh);

/* The same in any object. */
void cli_put_head(cli_session *session, json_t *object, const char *format, const char *file,
                  const starg_mesh *mesh);

/* Writes an object as the output announced as `name`. Errors: WRITE, MEMORY. */
starg_status cli_report_write(cli_session *session, const json_t *object, const char *name);

/* Takes over the members of the object in a text of the library; frees the text. */
void cli_report_take(cli_session *session, char *text, size_t size);

/* The members of a record that have keys, as an object; NULL when out of memory. */
json_t *cli_json_record(cli_session *session, const starg_fields *fields, const void *record);

/* Collects a log line of the library for "log". */
void cli_report_log(cli_session *session, starg_log_level level, const char *message);

/* Adds log, seconds and memory, and prints. Errors: WRITE, MEMORY. */
starg_status cli_report_print(cli_session *session);

/* Prints an error instead, unless a report has been printed. */
void cli_report_error(cli_session *session, const starg_error *error, int exit_status);

/* ---- file extensions and their meaning (extensions.c) ---- */

/* An extension with its dot, and its meaning. */
typedef struct cli_extension {
    const char *text;
    int format;
} cli_extension;

/* Ignores case. */
bool cli_has_extension(const char *name, const char *extension);

/* The format of an output by its file extension; `standard` for "-". Errors: ARGUMENT. */
starg_status cli_format_by_extension(cli_session *session, const char *name,
                                     const cli_extension *known, size_t count, int standard,
                                     int *format);

/* Refuses outputs of a command whose extension is that of another option or command, with advice;
 * `values` is the struct of its options. What an option writes, says its value: "FILE.obj|.ply".
 * Errors: ARGUMENT. */
starg_status cli_check_extensions(cli_session *session, const char *values);

/* Announces an output that must have the extension, for example ".ply"; NULL is allowed. */
starg_status cli_announce_with_extension(cli_session *session, const char *option, const char *name,
                                         const char *extension);

/* ---- models and coloured models, read and written for several commands (model.c) ---- */

/* Reads the first operand into the session, and starts the report with it. */
starg_status cli_input_read(cli_session *session);

/* Reads a surface or a tetrahedral mesh, recognized by content; the other one is NULL. */
starg_status cli_shape_read(cli_session *session, const char *file, starg_mesh **mesh,
                            starg_tetmesh **tetmesh);

/* Reads a model or its descriptor, recognized by content; the other one is NULL. */
starg_status cli_described_read(cli_session *session, const char *file, starg_mesh **mesh,
                                starg_descriptor **descriptor);

/* The format of an output mesh by its file extension; OFF for "-". Errors: ARGUMENT. */
starg_status cli_mesh_format(cli_session *session, const char *name, starg_mesh_format *format);

/* Writes a mesh to an announced output. */
starg_status cli_mesh_write(cli_session *session, const starg_mesh *mesh, starg_mesh_format format,
                            const char *name);

/* Announces an output of coloured faces, .ply or .vtp; NULL is allowed. */
starg_status cli_announce_marks(cli_session *session, const char *option, const char *name);

/* Writes it: colours, and in .vtp also numbers of faces, if there are any: `marks`, or the first
 * row of `seen` that contains the face, else -1. */
starg_status cli_marks_write(cli_session *session, const starg_mesh *mesh, const uint8_t *colors,
                             const int32_t *marks, const starg_bits *seen, const char *name);

/* The same with options of any kind. */
starg_status cli_mesh_write_with(cli_session *session, const starg_mesh *mesh,
                                 const starg_mesh_write_options *options, const char *name);

/* Neutral colours for the faces of a mesh; NULL when out of memory. */
uint8_t *cli_colors_create(const starg_mesh *mesh);

/* Gives each face the colour of the first row of `seen` that contains it; leaves the others. */
void cli_colors_by_viewer(uint8_t *colors, const starg_bits *seen);

/* Areas of all faces as fractions of their sum; NULL when memory is out. */
double *cli_area_fractions(const starg_mesh *mesh, size_t count);

/* An array of the set columns of a row. */
json_t *cli_json_row(cli_session *session, const starg_bits *bits, size_t row);

/* An array of `count` indices. */
json_t *cli_json_indices(cli_session *session, const uint32_t *indices, size_t count);

/* "1 face" or "7 faces". */
typedef struct cli_amount {
    char text[64];
} cli_amount;
cli_amount cli_count_of(size_t count, const char *singular, const char *plural);

/* ---- processes started by mpirun for one command (ranks_mpi.c, ranks_none.c) ---- */
/* Rank 0 runs it, the others help (starguard/ranks.h). Without MPI, or if started directly, there
 * is only this process. */

/* Connects to the other processes; call it first. */
void cli_ranks_begin(int *argc, char ***argv);

/* The connection; NULL without other processes. */
const starg_ranks *cli_ranks(void);

/* Default number of threads: the processors available to this process. */
int cli_ranks_threads(void);

/* Runs a helper and returns its exit status. */
int cli_ranks_serve(void);

/* Ends the run of rank 0 with the given exit status, and returns it. */
int cli_ranks_end(int result);
