/* SPDX-License-Identifier: Apache-2.0 */
/* The bar on a terminal. */
#include <stdio.h>
#include <string.h>

#include "session.h"

enum { BAR = 28 };

bool cli_progress_visible(void) {
    return cli_terminal(stderr);
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

void cli_progress_draw(cli_progress *progress, const cli_stage *stage, const starg_context *context,
                       double fraction, double elapsed) {
    char cells[BAR + 1], left[16];
    const char *what;
    size_t best = starg_context_best(context, &what);
    int full = (int)(fraction * BAR);
    memset(cells, ' ', BAR);
    memset(cells, '#', (size_t)full);
    cells[BAR] = '\0';
    format_time(elapsed * (1 - fraction) / fraction, left, sizeof left);
    fprintf(stderr, "\r\033[K%-12s [%s] %3.0f %%  %.2g %%/s  %s left", stage->name, cells,
            100 * fraction, 100 * fraction / elapsed, left);
    if (best > 0)
        fprintf(stderr, "  %zu %s so far", best, what);
    fflush(stderr);
    progress->drawn = true;
}

void cli_progress_erase(cli_progress *progress) {
    if (!progress->drawn)
        return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    progress->drawn = false;
}
