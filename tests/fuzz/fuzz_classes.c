/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a text of classes for four models: read or rejected with a message; every model has
 * a class that there is, or none, and class names ascend. */
#include <stdlib.h>
#include <string.h>

#include "starguard/database.h"
#include "support.h"

static void check_classes(const starg_classes *classes, size_t models) {
    fuzz_require(classes->model_count == models, "classes are of these models");
    for (size_t i = 0; i < models; i++)
        fuzz_require(classes->class_of[i] == STARG_NO_CLASS ||
                         classes->class_of[i] < classes->count,
                     "classes are in range");
    for (size_t i = 1; i < classes->count; i++)
        fuzz_require(strcmp(classes->names[i - 1], classes->names[i]) < 0, "names ascend");
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    static char paths[4][16] = {"a/cat_1.off", "b/cat_2.off", "dog.off", "a/dog.off"};
    starg_context *context = fuzz_context();
    starg_database_model items[4];
    const starg_database_models models = {4, items};
    starg_classes *classes = NULL;
    for (int i = 0; i < 4; i++) {
        const char *slash = strrchr(paths[i], '/');
        items[i] = (starg_database_model){
            .id = i, .path = paths[i], .name = slash != NULL ? slash + 1 : paths[i]};
    }
    starg_status status =
        starg_classes_read(context, fuzz_file(".txt", data, size), &models, &classes);
    if (status == STARG_OK)
        check_classes(classes, models.count);
    else
        fuzz_require_explained(context, status);
    starg_classes_free(context, classes);
    fuzz_context_end(context);
    return 0;
}
