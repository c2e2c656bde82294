/* SPDX-License-Identifier: Apache-2.0 */
/* Progress of the library's stages: a bar on a terminal, and the seconds of each stage. */
#ifndef STARGUARD_CLI_PROGRESS_H
#define STARGUARD_CLI_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

enum { CLI_STAGES = 32 };

typedef struct cli_stage {
    const char *name;
    double seconds; /* of all its finished runs */
    double began;   /* start of the current run */
    bool running;
} cli_stage;

typedef struct cli_progress {
    bool bar;   /* draw a bar on stderr */
    bool drawn; /* a bar is visible now */
    double drawn_at;
    cli_stage stages[CLI_STAGES]; /* in the order of their first run */
    size_t count;
} cli_progress;

/* Monotonic clock in seconds. */
double cli_clock(void);

/* A starg_progress_fn; `user` is a cli_progress. Never cancels: signals do. */
bool cli_progress_report(void *user, const char *stage, double fraction);

/* Erases the bar, so that a line can be written. */
void cli_progress_erase(cli_progress *progress);

#endif
