/* SPDX-License-Identifier: Apache-2.0 */
/* JSON Schemas (2020-12) of the documents.
 *
 * A schema describes what is written, strictly: types, ranges, and required keys. It leaves room
 * for keys of later versions. */
#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fields.h"

static json_t *needed(json_t *value) {
    if (value == NULL) {
        fprintf(stderr, "starguard_fields: out of memory\n");
        exit(EXIT_FAILURE);
    }
    return value;
}

static void put(json_t *object, const char *key, json_t *value) {
    needed(value);
    needed(json_object_set_new(object, key, value) == 0 ? object : NULL);
}

static void append(json_t *array, json_t *value) {
    needed(value);
    needed(json_array_append_new(array, value) == 0 ? array : NULL);
}

static json_t *typed(const char *type) {
    return needed(json_pack("{s:s}", "type", type));
}

static void put_type(json_t *schema, const char *type, bool nullable) {
    put(schema, "type", nullable ? json_pack("[ss]", type, "null") : json_string(type));
}

/* ---- values ---- */

static json_t *record_schema(const starg_fields *fields);

static json_t *count_schema(const starg_field *f) {
    json_t *schema = needed(json_object());
    put(schema, "minimum", json_integer((json_int_t)f->least));
    if (f->most <= INT64_MAX) {
        put_type(schema, "integer", f->flags & STARG_FIELD_NULLABLE);
        put(schema, "maximum", json_integer((json_int_t)f->most));
    } else { /* its digits, where it is above 2^63 - 1 */
        json_t *types = f->flags & STARG_FIELD_NULLABLE
                            ? json_pack("[sss]", "integer", "string", "null")
                            : json_pack("[ss]", "integer", "string");
        put(schema, "type", types);
        put(schema, "pattern", json_string("^[0-9]{19,20}$"));
    }
    return schema;
}

static json_t *real_schema(const starg_field *f) {
    json_t *schema = needed(json_object());
    put_type(schema, "number", f->flags & STARG_FIELD_NULLABLE);
    if (isfinite(f->low))
        put(schema, (f->flags & STARG_FIELD_ABOVE) ? "exclusiveMinimum" : "minimum",
            json_real(f->low));
    if (isfinite(f->high))
        put(schema, "maximum", json_real(f->high));
    return schema;
}

static json_t *choice_schema(const starg_field *f) {
    json_t *words = needed(json_array()), *schema = needed(json_object());
    for (size_t i = 0; f->words[i] != NULL; i++)
        append(words, json_string(f->words[i]));
    put(schema, "enum", words);
    return schema;
}

static json_t *array_schema(json_t *items, size_t length) {
    json_t *schema = typed("array");
    put(schema, "items", items);
    if (length > 0) {
        put(schema, "minItems", json_integer((json_int_t)length));
        put(schema, "maxItems", json_integer((json_int_t)length));
    }
    return schema;
}

static json_t *numbers_schema(const starg_field *f) {
    return array_schema(real_schema(f), (f->flags & STARG_FIELD_COUNTED) ? 0 : f->length);
}

static json_t *list_schema(const starg_field *f) {
    json_t *schema = array_schema(record_schema(f->of), 0);
    if (f->least > 0)
        put(schema, "minItems", json_integer((json_int_t)f->least));
    return schema;
}

static json_t *indices_schema(void) {
    json_t *schema = array_schema(json_pack("{s:s, s:i}", "type", "integer", "minimum", 0), 0);
    put(schema, "uniqueItems", json_true());
    return schema;
}

static json_t *constant_schema(const starg_field *f) {
    return f->value != NULL ? json_pack("{s:s}", "const", f->value)
                            : json_pack("{s:I}", "const", (json_int_t)f->initial);
}

static json_t *value_schema(const starg_field *f) {
    json_t *schema;
    switch (f->kind) {
    case STARG_FIELD_FLAG:
        return typed("boolean");
    case STARG_FIELD_COUNT:
        return f->words == NULL
                   ? count_schema(f)
                   : json_pack("{s:[o, o]}", "anyOf", count_schema(f), choice_schema(f));
    case STARG_FIELD_REAL:
        return real_schema(f);
    case STARG_FIELD_CHOICE:
        return choice_schema(f);
    case STARG_FIELD_TEXT:
        put_type(schema = needed(json_object()), "string", true);
        return schema;
    case STARG_FIELD_POINT:
        return array_schema(typed("number"), 3);
    case STARG_FIELD_NUMBERS:
        return numbers_schema(f);
    case STARG_FIELD_INDICES:
        return indices_schema();
    case STARG_FIELD_RECORD:
        return record_schema(f->of);
    case STARG_FIELD_LIST:
        return list_schema(f);
    case STARG_FIELD_CONSTANT:
        return constant_schema(f);
    default:
        return json_object();
    }
}

/* ---- records ---- */

static void put_members(const starg_fields *fields, json_t *properties, json_t *required) {
    for (size_t i = 0; i < fields->count; i++) {
        const starg_field *f = &fields->fields[i];
        if (f->key == NULL)
            continue;
        json_t *schema = needed(value_schema(f));
        if (f->help != NULL)
            put(schema, "description",
                json_sprintf("%s%s", is_cleared(f) ? "If false: " : "", f->help));
        put(properties, f->key, schema);
        if (is_required(f))
            append(required, json_string(f->key));
    }
}

static json_t *tuple_schema(const starg_fields *fields) {
    json_t *schema = typed("array"), *items = needed(json_array());
    for (size_t i = 0; i < fields->count; i++)
        append(items, value_schema(&fields->fields[i]));
    put(schema, "prefixItems", items);
    put(schema, "minItems", json_integer((json_int_t)fields->count));
    put(schema, "maxItems", json_integer((json_int_t)fields->count));
    return schema;
}

static json_t *record_schema(const starg_fields *fields) {
    if (fields->form == STARG_FORM_BARE)
        return value_schema(&fields->fields[0]);
    if (fields->form == STARG_FORM_TUPLE)
        return tuple_schema(fields);
    json_t *schema = typed("object");
    json_t *properties = needed(json_object()), *required = needed(json_array());
    put_members(fields, properties, required);
    put(schema, "properties", properties);
    put(schema, "required", required);
    return schema;
}

/* ---- files ---- */

static bool write_schema(const char *folder, const char *name, const char *title,
                         const char *description, json_t *record) {
    char path[4096], id[NAME_SIZE];
    snprintf(id, sizeof id, "%s.schema.json", name);
    snprintf(path, sizeof path, "%s/%s", folder, id);
    json_t *schema = needed(json_pack("{s:s, s:s, s:s, s:s}", "$schema",
                                      "https://json-schema.org/draft/2020-12/schema", "$id", id,
                                      "title", title, "description", description));
    needed(json_object_update(schema, record) == 0 ? schema : NULL);
    bool written = json_dump_file(schema, path, JSON_INDENT(2)) == 0;
    json_decref(schema);
    json_decref(record);
    return written;
}

/* The file's keys, those of its own, and those of every report. */
static json_t *report_schema(const document *d) {
    json_t *schema = record_schema(d->fields);
    put_members(d->report, json_object_get(schema, "properties"),
                json_object_get(schema, "required"));
    put(schema, "allOf", json_pack("[{s:s}]", "$ref", "common.schema.json#/$defs/report"));
    return schema;
}

bool write_schemas(const char *folder) {
    for (size_t i = 0; i < document_count; i++) {
        const document *d = &documents[i];
        char name[NAME_SIZE], title[NAME_SIZE], text[256];
        snprintf(text, sizeof text, "Written by starguard %s.", d->command);
        if (!write_schema(folder, d->name, d->title, text, record_schema(d->fields)))
            return false;
        if (d->report == NULL)
            continue;
        snprintf(name, sizeof name, "report-%s", d->command);
        snprintf(title, sizeof title, "starguard %s --json", d->command);
        snprintf(text, sizeof text, "Printed by starguard %s --json: what %s holds, and more.",
                 d->command, d->title);
        if (!write_schema(folder, name, title, text, report_schema(d)))
            return false;
    }
    return true;
}
