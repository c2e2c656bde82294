/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a file of candidate points: read or rejected with a message, nothing lost. */
#include <stdlib.h>

#include "starguard/guard.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = NULL;
    double *points = NULL;
    size_t count;
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 0;
    starg_status status =
        starg_points_read_memory(context, data, size, "fuzz.txt", &points, &count);
    bool told = status == STARG_OK || starg_context_error(context)->message[0] != '\0';
    starg_points_free(context, points);
    if (!told || starg_context_live_blocks(context) != 0)
        abort();
    starg_context_free(context);
    return 0;
}
