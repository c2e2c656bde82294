/* SPDX-License-Identifier: Apache-2.0 */
#include "progress.h"

#include <string.h>
#include <time.h>

static const double PATIENCE = 1.0; /* seconds before a stage gets a bar */
static const double REDRAW = 0.1;

double cli_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* NULL if there are too many stages: the excess is not timed and has no bar. */
static cli_stage *find_stage(cli_progress *progress, const char *name) {
    for (size_t i = 0; i < progress->count; i++)
        if (strcmp(progress->stages[i].name, name) == 0)
            return &progress->stages[i];
    if (progress->count == CLI_STAGES)
        return NULL;
    cli_stage *stage = &progress->stages[progress->count++];
    *stage = (cli_stage){.name = name};
    return stage;
}

bool cli_progress_report(void *user, const char *name, double fraction) {
    cli_progress *progress = user;
    cli_stage *stage = find_stage(progress, name);
    if (stage == NULL)
        return true;
    double now = cli_clock();
    if (fraction >= 1) {
        cli_progress_erase(progress);
        if (stage->running)
            stage->seconds += now - stage->began;
        stage->running = false;
        return true;
    }
    if (!stage->running) {
        stage->began = now;
        stage->running = true;
    }
    bool due = now - stage->began >= PATIENCE && now - progress->drawn_at >= REDRAW;
    if (progress->bar && due && fraction > 0) {
        cli_progress_draw(progress, stage, fraction, now - stage->began);
        progress->drawn_at = now;
    }
    return true;
}
