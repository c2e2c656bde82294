/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a file of a skeleton: read or rejected with a message, nothing lost. */
#include <stdlib.h>

#include "starguard/skeleton.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = NULL;
    starg_skeleton *skeleton = NULL;
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 0;
    starg_status status = starg_skeleton_read_memory(context, data, size, "fuzz.cg", &skeleton);
    bool told = status == STARG_OK || starg_context_error(context)->message[0] != '\0';
    for (size_t i = 0; status == STARG_OK && i < 2 * skeleton->edge_count; i++)
        if (skeleton->edges[i] >= skeleton->node_count)
            abort();
    starg_skeleton_free(context, skeleton);
    if (!told || starg_context_live_blocks(context) != 0)
        abort();
    starg_context_free(context);
    return 0;
}
