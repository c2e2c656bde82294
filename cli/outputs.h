/* SPDX-License-Identifier: Apache-2.0 */
/* Output files of a run. Each is first written under another name beside its target; all are
 * renamed together at the very end, so that a failing run changes nothing. */
#ifndef STARGUARD_CLI_OUTPUTS_H
#define STARGUARD_CLI_OUTPUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

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

#endif
