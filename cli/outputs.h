/* SPDX-License-Identifier: Apache-2.0 */
/* Output files of a run. Each is written beside its place under another name first; all take
 * their places together at the very end, so that a run that fails leaves everything as it was. */
#ifndef STARGUARD_CLI_OUTPUTS_H
#define STARGUARD_CLI_OUTPUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { CLI_OUTPUT_MESSAGE = 512 };

/* Which file it is, whatever it is called. */
typedef struct cli_file_id {
    dev_t device;
    ino_t inode;
    bool known; /* it exists and is a regular file */
} cli_file_id;

typedef struct cli_output {
    char *name;     /* as the user gave it                                       */
    char *target;   /* the same with symbolic links followed                     */
    char *staged;   /* where it is written first                                 */
    cli_file_id id; /* of what stands there now                                */
    bool device;    /* the target is a device or a pipe: copied, not renamed     */
} cli_output;

typedef struct cli_outputs {
    cli_output *items;
    size_t count, capacity;
    char *folder;        /* made for outputs, and empty so far; NULL if there is none */
    cli_file_id *inputs; /* which no output may replace */
    size_t input_count;
    char message[CLI_OUTPUT_MESSAGE]; /* why the last call failed         */
    bool clash;                       /* because an output is an input    */
} cli_outputs;

/* Announces an output before the work begins: can it be written at all? Not for "-". */
bool cli_outputs_add(cli_outputs *outputs, const char *name);

/* A folder for outputs: it is made if it is not there, and taken away again when the run fails. At
 * most one in a run. */
bool cli_outputs_add_folder(cli_outputs *outputs, const char *name);

/* Names a file that the run reads ("-": standard input); fails if it is an output. */
bool cli_outputs_add_input(cli_outputs *outputs, const char *name);

/* Where to write what was announced as `name`; "-" and unknown names are returned as they are. */
const char *cli_outputs_place(const cli_outputs *outputs, const char *name);

/* Puts the names that the user knows into a message about a staged file. */
void cli_outputs_translate(const cli_outputs *outputs, char *message, size_t size);

/* Moves all staged files to their places. */
bool cli_outputs_commit(cli_outputs *outputs);

/* Removes what is staged and frees everything; also after commit. */
void cli_outputs_discard(cli_outputs *outputs);

#endif
