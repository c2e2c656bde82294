/* Any bytes as a GUARDS.json: read or rejected with a message, nothing lost. */
#include <stdlib.h>

#include "starguard/guard.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = NULL;
    starg_guards *guards = NULL;
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 0;
    starg_status status = starg_guards_read_memory(context, data, size, "fuzz.json", &guards);
    bool told = status == STARG_OK || starg_context_error(context)->message[0] != '\0';
    starg_guards_free(context, guards);
    if (!told || starg_context_live_blocks(context) != 0)
        abort();
    starg_context_free(context);
    return 0;
}
