/* SPDX-License-Identifier: Apache-2.0 */
#include "records.h"

#include <string.h>

#include "core/memory.h"

static void *pointer_at(const void *record, size_t offset) {
    void *value;
    memcpy(&value, (const char *)record + offset, sizeof value);
    return value;
}

static size_t size_at(const void *record, size_t offset) {
    size_t value;
    memcpy(&value, (const char *)record + offset, sizeof value);
    return value;
}

static void release_at(starg_context *context, void *record, size_t offset) {
    starg_release(context, pointer_at(record, offset));
    memset((char *)record + offset, 0, sizeof(void *));
}

static void release_list(starg_context *context, const starg_field *f, void *record) {
    char *items = pointer_at(record, f->offset);
    for (size_t k = 0; f->of->columns && k < f->of->count; k++)
        release_at(context, record, f->of->fields[k].offset);
    if (f->of->columns)
        return;
    for (size_t i = 0; items != NULL && i < size_at(record, f->length); i++)
        record_release(context, f->of, items + i * f->of->size);
    release_at(context, record, f->offset);
}

void record_release(starg_context *context, const starg_fields *fields, void *record) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        if (f->kind == STARG_FIELD_TEXT || f->kind == STARG_FIELD_INDICES)
            release_at(context, record, f->offset);
        else if (f->kind == STARG_FIELD_RECORD)
            record_release(context, f->of, (char *)record + f->offset);
        else if (f->kind == STARG_FIELD_LIST)
            release_list(context, f, record);
    }
}

starg_status record_parse(starg_context *context, const starg_fields *fields, const char *text,
                          size_t size, void *record) {
    json_t *root = NULL;
    starg_status status = starg_json_parse(context, "test", "text", text, size, &root);
    if (status == STARG_OK)
        status = record_read(context, "text", root, fields, record);
    json_decref(root);
    return status;
}

/* ---- comparison ---- */

static bool same_bytes(const void *a, const void *b, size_t size) {
    return size == 0 || (a == NULL) + (b == NULL) == 2 ||
           (a != NULL && b != NULL && memcmp(a, b, size) == 0);
}

/* Columns: compares whole blocks; members of structs are compared with the structs. */
static bool equal_columns(const starg_field *f, const void *a, const void *b) {
    for (size_t k = 0; k < f->of->count; k++) {
        const starg_field *c = &f->of->fields[k];
        size_t size = c->stride > 0                      ? c->stride
                      : c->kind == STARG_FIELD_POINT     ? 3 * sizeof(double)
                      : (c->flags & STARG_FIELD_COUNTED) ? size_at(a, c->length) * sizeof(double)
                      : c->kind == STARG_FIELD_LIST      ? 0
                                                         : c->size;
        if ((c->applies == NULL || c->applies(a)) &&
            !same_bytes(pointer_at(a, c->offset), pointer_at(b, c->offset),
                        size_at(a, f->length) * size))
            return false;
    }
    return true;
}

static bool equal_lists(const starg_field *f, const void *a, const void *b) {
    const char *first = pointer_at(a, f->offset), *second = pointer_at(b, f->offset);
    size_t count = size_at(a, f->length);
    if (count != size_at(b, f->length))
        return false;
    if (f->of->columns)
        return equal_columns(f, a, b);
    for (size_t i = 0; i < count; i++)
        if (!record_equal(f->of, first + i * f->of->size, second + i * f->of->size))
            return false;
    return true;
}

static bool equal_members(const starg_field *f, const void *a, const void *b) {
    const char *first = (const char *)a + f->offset, *second = (const char *)b + f->offset;
    switch (f->kind) {
    case STARG_FIELD_TEXT:
        first = pointer_at(a, f->offset);
        second = pointer_at(b, f->offset);
        return first == NULL || second == NULL ? first == second : strcmp(first, second) == 0;
    case STARG_FIELD_POINT:
        return same_bytes(first, second, 3 * sizeof(double));
    case STARG_FIELD_NUMBERS:
        return same_bytes(first, second, f->length * sizeof(double));
    case STARG_FIELD_INDICES:
        return size_at(a, f->length) == size_at(b, f->length) &&
               same_bytes(pointer_at(a, f->offset), pointer_at(b, f->offset),
                          size_at(a, f->length) * sizeof(uint32_t));
    case STARG_FIELD_RECORD:
        return record_equal(f->of, first, second);
    case STARG_FIELD_LIST:
        return equal_lists(f, a, b);
    case STARG_FIELD_CONSTANT:
        return true;
    default:
        return same_bytes(first, second, f->size);
    }
}

bool record_equal(const starg_fields *fields, const void *a, const void *b) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        if (f->key != NULL && (f->applies == NULL || f->applies(a)) && !equal_members(f, a, b))
            return false;
    }
    return true;
}
