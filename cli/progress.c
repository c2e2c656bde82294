/* SPDX-License-Identifier: Apache-2.0 */
#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { BAR = 28 };

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

static void format_time(double seconds, char *text, size_t size) {
    if (seconds < 99.5)
        snprintf(text, size, "%.0f s", seconds);
    else if (seconds < 5970)
        snprintf(text, size, "%.0f min", seconds / 60);
    else if (seconds < 1e6)
        snprintf(text, size, "%.0f h", seconds / 3600);
    else
        snprintf(text, size, "long");
}

static void draw(cli_progress *progress, const cli_stage *stage, double fraction, double now) {
    char cells[BAR + 1], left[16];
    double elapsed = now - stage->began;
    int full = (int)(fraction * BAR);
    memset(cells, ' ', BAR);
    memset(cells, '#', (size_t)full);
    cells[BAR] = '\0';
    format_time(elapsed * (1 - fraction) / fraction, left, sizeof left);
    fprintf(stderr, "\r\033[K%-12s [%s] %3.0f %%  %.2g %%/s  %s left", stage->name, cells,
            100 * fraction, 100 * fraction / elapsed, left);
    fflush(stderr);
    progress->drawn = true;
    progress->drawn_at = now;
}

void cli_progress_erase(cli_progress *progress) {
    if (!progress->drawn)
        return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    progress->drawn = false;
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
    if (progress->bar && due && fraction > 0)
        draw(progress, stage, fraction, now);
    return true;
}
