/* SPDX-License-Identifier: Apache-2.0 */
/* Progress of the library's stages: a bar, and the seconds of each stage. The bar is drawn on a
 * terminal (progress_terminal.c), or by the page that runs this program (web/progress_page.c). */
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
    bool bar;   /* draw a bar */
    bool drawn; /* a bar is visible now */
    double drawn_at;
    cli_stage stages[CLI_STAGES]; /* in the order of their first run */
    size_t count;
} cli_progress;

/* Monotonic clock in seconds. */
double cli_clock(void);

/* A starg_progress_fn; `user` is a cli_progress. Never cancels: signals do. */
bool cli_progress_report(void *user, const char *stage, double fraction);

/* Can anybody see a bar? */
bool cli_progress_visible(void);

/* Draws the bar of a stage that has run for `elapsed` seconds; 0 < fraction < 1. */
void cli_progress_draw(cli_progress *progress, const cli_stage *stage, double fraction,
                       double elapsed);

/* Erases the bar, so that a line can be written. */
void cli_progress_erase(cli_progress *progress);

#endif
