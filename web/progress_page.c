/* SPDX-License-Identifier: Apache-2.0 */
/* The bar in a page: the worker that runs this program gets the stage and its fraction. */
#include <emscripten.h>

#include "session.h"

/* clang-format off */
EM_JS(void, show_progress, (const char *stage, double fraction), {
    if (Module["onProgress"]) Module["onProgress"](UTF8ToString(stage), fraction);
})
/* clang-format on */

bool cli_progress_visible(void) {
    return true;
}

void cli_progress_draw(cli_progress *progress, const cli_stage *stage, const starg_context *context,
                       double fraction, double elapsed) {
    (void)progress, (void)context, (void)elapsed;
    show_progress(stage->name, fraction);
}

void cli_progress_erase(cli_progress *progress) {
    (void)progress;
}
