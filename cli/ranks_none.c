/* SPDX-License-Identifier: Apache-2.0 */
/* A build without MPI: this process is alone. */
#include "session.h"

void cli_ranks_begin(int *argc, char ***argv) {
    (void)argc, (void)argv;
}

const starg_ranks *cli_ranks(void) {
    return NULL;
}

int cli_ranks_threads(void) {
    return 0;
}

int cli_ranks_serve(void) {
    return 0;
}

int cli_ranks_end(int result) {
    return result;
}
