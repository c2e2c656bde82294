/* SPDX-License-Identifier: Apache-2.0 */
/* DESCRIPTOR.json: a descriptor as text (docs/formats.md). */

#include "core/file.h"
#include "core/json.h"
#include "shape/measures.h"

static const char STAGE[] = "descriptor file";

static bool put(FILE *stream, const void *result, const char *model_file) {
    starg_descriptor shown = *(const starg_descriptor *)result;
    shown.file = (char *)(uintptr_t)model_file;
    return record_put(stream, &descriptor_file_fields, &shown, 0);
}

starg_status starg_descriptor_write(starg_context *context, const starg_descriptor *descriptor,
                                    const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put, descriptor, model_file);
}

starg_status starg_descriptor_write_memory(starg_context *context,
                                           const starg_descriptor *descriptor,
                                           const char *model_file, char **text, size_t *size) {
    return starg_json_write_memory(context, STAGE, put, descriptor, model_file, text, size);
}

bool starg_descriptor_recognized(const void *bytes, size_t size) {
    const char *text = bytes;
    size_t i = 0;
    while (i < size && strchr(" \t\r\n", text[i]) != NULL && text[i] != '\0')
        i++;
    return i < size && text[i] == '{';
}

/* Conditions that the table does not express. */
static starg_status check_edges(starg_context *context, const char *name,
                                const starg_descriptor *d) {
    for (size_t i = 0; i < d->edge_count; i++) {
        const starg_descriptor_edge *e = &d->edges[i];
        bool ascending = i == 0 || e[-1].first < e->first ||
                         (e[-1].first == e->first && e[-1].second < e->second);
        if (e->first >= e->second || e->second >= d->guard_count || !ascending)
            return record_reject(context, name, &descriptor_file_fields, "guards",
                                 "two ascending guards in each edge, edges ascending");
    }
    return STARG_OK;
}

/* Numbers of an older version are read, but were made otherwise (of another level of detail). */
static void tell_version(starg_context *context, const char *name, const json_t *root) {
    json_int_t version = json_integer_value(json_object_get(root, "version"));
    if (version < DESCRIPTOR_VERSION)
        starg_log(context, STARG_LOG_WARNING,
                  "%s has version %d: its distances to descriptors of version %d mean little; "
                  "describe the model again",
                  name, (int)version, DESCRIPTOR_VERSION);
}

starg_status starg_descriptor_read_memory(starg_context *context, const void *bytes, size_t size,
                                          const char *name, starg_descriptor **out) {
    SCOPED_BY(starg_descriptor_drop) starg_descriptor *descriptor = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    *out = NULL;
    TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    NEW_ZERO(context, STAGE, descriptor, 1);
    TRY(record_read(context, name, root, &descriptor_file_fields, descriptor));
    TRY(check_edges(context, name, descriptor));
    tell_version(context, name, root);
    *out = descriptor;
    descriptor = NULL;
    return STARG_OK;
}

starg_status starg_descriptor_read(starg_context *context, const char *path,
                                   starg_descriptor **out) {
    SCOPED char *bytes = NULL;
    size_t size;
    *out = NULL;
    TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    return starg_descriptor_read_memory(context, bytes, size, path, out);
}
