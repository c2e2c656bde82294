/* Any bytes as a DESCRIPTOR.json: read or rejected with a message; what is read can be written and
 * read again as the same bytes, and made into signatures at distance 0 from themselves. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "starguard/descriptor.h"
#include "support.h"

static char *written(starg_context *context, const starg_descriptor *descriptor, size_t *size) {
    const char *path = fuzz_path(".json");
    char *bytes = NULL;
    fuzz_require_ok(context, starg_descriptor_write(context, descriptor, descriptor->file, path),
                    "what was read can be written");
    fuzz_require_ok(context, starg_file_read(context, "fuzz", path, &bytes, size),
                    "a file can be read");
    return bytes;
}

static void check_round_trip(starg_context *context, const starg_descriptor *descriptor) {
    starg_descriptor *again = NULL;
    size_t size, size_again;
    char *bytes = written(context, descriptor, &size);
    fuzz_require_ok(context, starg_descriptor_read_memory(context, bytes, size, "again", &again),
                    "what was written can be read");
    char *bytes_again = written(context, again, &size_again);
    fuzz_require(size == size_again && memcmp(bytes, bytes_again, size) == 0,
                 "reading and writing keeps everything");
    starg_release(context, bytes);
    starg_release(context, bytes_again);
    starg_descriptor_free(context, again);
}

static void check_signature(starg_context *context, const starg_descriptor *descriptor,
                            starg_signature_kind kind) {
    starg_signature *signature = NULL;
    double distance = 0;
    starg_status status = starg_signature_of_descriptor(context, descriptor, kind, &signature);
    if (status == STARG_OK)
        status = starg_signature_distance(context, signature, signature, &distance);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_FORMAT, "signatures are made or not");
    fuzz_require(distance == 0, "nothing is unlike itself");
    starg_signature_free(context, signature);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    starg_descriptor *descriptor = NULL;
    starg_status status =
        starg_descriptor_read_memory(context, data, size, "fuzz.json", &descriptor);
    if (status == STARG_OK) {
        check_round_trip(context, descriptor);
        check_signature(context, descriptor, STARG_SIGNATURE_STAR);
        check_signature(context, descriptor, STARG_SIGNATURE_PAPER);
    } else {
        fuzz_require_explained(context, status);
    }
    starg_descriptor_free(context, descriptor);
    fuzz_context_end(context);
    return 0;
}
