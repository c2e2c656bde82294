/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a morph in binary glTF: read or rejected with a message, nothing lost. */
#include <stdlib.h>

#include "starguard/animation.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = NULL;
    starg_mesh **frames = NULL;
    size_t count = 0;
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 0;
    starg_status status =
        starg_animation_read_memory(context, data, size, "fuzz.glb", &frames, &count);
    bool told = status == STARG_OK || starg_context_error(context)->message[0] != '\0';
    if (status == STARG_OK)
        starg_animation_free(context, frames, count);
    if (!told || starg_context_live_blocks(context) != 0)
        abort();
    starg_context_free(context);
    return 0;
}
