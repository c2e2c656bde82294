/* SPDX-License-Identifier: Apache-2.0 */
/* Converts a struct to JSON and back by its field table (starguard/fields.h).
 *
 * Writing is lossless: reals have 17 significant digits, counts above 2^63 - 1 are texts. Reading
 * is strict: every key is checked against its type and range, so that reading a written file gives
 * the same struct, and writing that the same bytes. Members follow the order of the table; whether
 * one applies may depend on earlier ones. */
#include "core/json.h"

#include <math.h>

#include "core/memory.h"

static const double LIMIT = 1e100; /* of coordinates */

/* ---- where values are ---- */

static size_t load_size(const void *record, size_t offset) {
    size_t value;
    memcpy(&value, (const char *)record + offset, sizeof value);
    return value;
}

static void *load_pointer(const void *record, size_t offset) {
    void *value;
    memcpy(&value, (const char *)record + offset, sizeof value);
    return value;
}

static void store_pointer(void *record, size_t offset, void *value) {
    memcpy((char *)record + offset, &value, sizeof value);
}

static bool applies(const starg_field *f, const void *record) {
    return f->applies == NULL || f->applies(record);
}

/* A field of columns as a member of a single row. */
static starg_field in_column(const starg_field *f, const void *record) {
    starg_field own = *f;
    own.offset = f->within;
    if (f->flags & STARG_FIELD_COUNTED)
        own.length = load_size(record, f->length);
    if (f->kind == STARG_FIELD_POINT || f->kind == STARG_FIELD_NUMBERS)
        own.size = (f->kind == STARG_FIELD_POINT ? 3 : own.length) * sizeof(double);
    if (own.stride == 0)
        own.stride = own.size;
    return own;
}

/* Row i of the column that `own` describes. */
static char *row_of(const starg_field *f, const starg_field *own, const void *record, size_t i) {
    char *column = load_pointer(record, f->offset);
    return column + i * own->stride;
}

/* ---- writing ---- */

static json_t *fields_json(const starg_fields *fields, const void *record, size_t i);

static json_t *real_json(const starg_field *f, const char *at) {
    double value;
    memcpy(&value, at, sizeof value);
    if ((f->flags & STARG_FIELD_NULLABLE) && value == f->standard)
        return json_null();
    if (f->words != NULL && starg_field_real_word(f, value) != NULL)
        return json_string(starg_field_real_word(f, value));
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *count_json(const starg_field *f, const void *record) {
    uint64_t value = starg_field_count(f, record);
    if ((f->flags & STARG_FIELD_NULLABLE) && value == f->none)
        return json_null();
    const char *word = starg_field_word(f, value);
    if (word != NULL)
        return json_string(word);
    if (value <= INT64_MAX)
        return json_integer((json_int_t)value);
    char digits[32];
    snprintf(digits, sizeof digits, "%llu", (unsigned long long)value);
    return json_string(digits);
}

static json_t *reals_json(const char *at, size_t count) {
    json_t *list = json_array();
    for (size_t k = 0; k < count && list != NULL; k++) {
        double value;
        memcpy(&value, at + k * sizeof value, sizeof value);
        if (json_array_append_new(list, json_real(value)) != 0) {
            json_decref(list);
            list = NULL;
        }
    }
    return list;
}

static json_t *indices_json(const starg_field *f, const void *record) {
    const uint32_t *items = load_pointer(record, f->offset);
    size_t count = load_size(record, f->length);
    json_t *list = json_array();
    for (size_t i = 0; i < count && list != NULL; i++)
        if (json_array_append_new(list, json_integer(items[i])) != 0) {
            json_decref(list);
            list = NULL;
        }
    return list;
}

/* Item i of a list. */
static json_t *item_json(const starg_field *f, const void *record, size_t i) {
    if (f->of->columns)
        return fields_json(f->of, record, i);
    const char *items = load_pointer(record, f->offset);
    return fields_json(f->of, items + i * f->of->size, 0);
}

static json_t *list_json(const starg_field *f, const void *record) {
    size_t count = load_size(record, f->length);
    json_t *list = json_array();
    for (size_t i = 0; i < count && list != NULL; i++)
        if (json_array_append_new(list, item_json(f, record, i)) != 0) {
            json_decref(list);
            list = NULL;
        }
    return list;
}

static json_t *field_json(const starg_field *f, const void *record) {
    const char *at = (const char *)record + f->offset;
    switch (f->kind) {
    case STARG_FIELD_FLAG:
        return json_boolean(starg_field_count(f, record));
    case STARG_FIELD_COUNT:
        return count_json(f, record);
    case STARG_FIELD_REAL:
        return real_json(f, at);
    case STARG_FIELD_CHOICE:
        return json_string(starg_field_word(f, starg_field_count(f, record)));
    case STARG_FIELD_TEXT:
        at = load_pointer(record, f->offset);
        return at != NULL ? json_string(at) : json_null();
    case STARG_FIELD_POINT:
        return reals_json(at, 3);
    case STARG_FIELD_NUMBERS:
        return reals_json(at, f->length);
    case STARG_FIELD_INDICES:
        return indices_json(f, record);
    case STARG_FIELD_RECORD:
        return fields_json(f->of, at, 0);
    case STARG_FIELD_LIST:
        return list_json(f, record);
    case STARG_FIELD_CONSTANT:
        return f->value != NULL ? json_string(f->value) : json_integer((json_int_t)f->initial);
    default:
        return NULL;
    }
}

static bool is_written(const starg_field *f, const void *record);

static bool is_default(const starg_field *f, const void *record) {
    const char *at = (const char *)record + f->offset;
    bool same = true;
    double value;
    switch (f->kind) {
    case STARG_FIELD_REAL:
        memcpy(&value, at, sizeof value);
        return value == f->standard;
    case STARG_FIELD_NUMBERS:
        for (size_t i = 0; i < f->length; i++) {
            memcpy(&value, at + i * sizeof value, sizeof value);
            same = same && value == f->standard;
        }
        return same;
    case STARG_FIELD_INDICES:
        return load_size(record, f->length) == 0;
    case STARG_FIELD_RECORD:
        for (size_t i = 0; i < f->of->count; i++)
            same = same && !is_written(&f->of->fields[i], at);
        return same;
    default:
        return starg_field_count(f, record) == f->initial;
    }
}

/* Absent: a list that was never filled, or a default that a file cannot represent. */
static bool is_absent(const starg_field *f, const void *record) {
    if (!(f->flags & STARG_FIELD_OPTIONAL))
        return false;
    if (f->flags & STARG_FIELD_RARE)
        return is_default(f, record) || (f->kind <= STARG_FIELD_CHOICE && !field_fits(f, record));
    if (f->kind <= STARG_FIELD_CHOICE)
        return !field_fits(f, record);
    if (f->kind != STARG_FIELD_LIST)
        return false;
    if (!(f->flags & STARG_FIELD_MATCHING) && load_size(record, f->length) == 0)
        return true;
    return load_pointer(record, f->of->columns ? f->of->fields[0].offset : f->offset) == NULL;
}

static bool is_written(const starg_field *f, const void *record) {
    return f->key != NULL && applies(f, record) && !is_absent(f, record);
}

static bool add(json_t *to, const starg_fields *fields, const starg_field *f, json_t *value) {
    return fields->form == STARG_FORM_TUPLE ? json_array_append_new(to, value) == 0
                                            : json_object_set_new(to, f->key, value) == 0;
}

/* A record, or row i of columns. NULL when out of memory. */
static json_t *fields_json(const starg_fields *fields, const void *record, size_t i) {
    bool columns = fields->columns, done = true;
    json_t *result = fields->form == STARG_FORM_TUPLE ? json_array() : json_object();
    for (size_t k = 0; k < fields->count && result != NULL && done; k++) {
        const starg_field *f = &fields->fields[k], own = columns ? in_column(f, record) : *f;
        if (columns && (!applies(f, record) || load_pointer(record, f->offset) == NULL))
            continue;
        if (!columns && !is_written(f, record))
            continue;
        json_t *value = field_json(&own, columns ? row_of(f, &own, record, i) : record);
        if (fields->form == STARG_FORM_BARE) {
            json_decref(result);
            return value;
        }
        done = add(result, fields, f, value);
    }
    if (done)
        return result;
    json_decref(result);
    return NULL;
}

static bool put_lines(FILE *stream, const starg_field *f, const void *record, int margin) {
    size_t count = load_size(record, f->length);
    bool done = true;
    fputs("[\n", stream);
    for (size_t i = 0; i < count && done; i++) {
        fprintf(stream, "%*s", 2 * margin, "");
        done = starg_json_put(stream, "", item_json(f, record, i), i + 1 < count ? ",\n" : "\n");
    }
    fprintf(stream, "%*s]", margin, "");
    return done;
}

bool record_put(FILE *stream, const starg_fields *fields, const void *record, int margin) {
    bool done = true, first = true;
    fputs("{\n", stream);
    for (size_t k = 0; k < fields->count && done; k++) {
        const starg_field *f = &fields->fields[k];
        if (!is_written(f, record))
            continue;
        fprintf(stream, "%s%*s\"%s\": ", first ? "" : ",\n", margin, "", f->key);
        first = false;
        done = (f->flags & STARG_FIELD_LINES)
                   ? put_lines(stream, f, record, margin)
                   : starg_json_put(stream, "", field_json(f, record), "");
    }
    fputs("\n}\n", stream);
    return done;
}

typedef struct whole {
    const starg_fields *fields;
    const void *record;
} whole;

static bool put_whole(FILE *stream, const void *what, const char *unused) {
    const whole *w = what;
    (void)unused;
    return record_put(stream, w->fields, w->record, 0);
}

starg_status starg_fields_json(starg_context *context, const starg_fields *fields,
                               const void *record, char **text, size_t *size) {
    const whole w = {fields, record};
    return starg_json_write_memory(context, fields->name, put_whole, &w, NULL, text, size);
}

/* ---- reading ---- */

typedef struct reader {
    starg_context *context;
    const char *name;
    const starg_fields *file; /* of the whole file, for messages */
    const char *list;         /* the list whose entry `item` is being read; NULL: none */
    size_t item;
} reader;

static starg_status read_fields(reader *r, json_t *object, const starg_fields *fields,
                                void *record);

starg_status record_reject(starg_context *context, const char *name, const starg_fields *fields,
                           const char *key, const char *expected) {
    return starg_fail(context, STARG_ERROR_FORMAT, fields->name,
                      "'%.200s' is not a valid %s: \"%s\" must be %s", name, fields->name, key,
                      expected);
}

/* Position of the reader, for messages. */
typedef struct place {
    char text[128];
} place;

static place place_of(const reader *r) {
    place own = {""};
    if (r->list != NULL)
        snprintf(own.text, sizeof own.text, " in entry %zu of \"%s\"", r->item, r->list);
    return own;
}

static starg_status reject(const reader *r, const starg_field *f, const char *expected) {
    return starg_fail(r->context, STARG_ERROR_FORMAT, r->file->name,
                      "'%.200s' is not a valid %s: \"%s\"%s must be %s", r->name, r->file->name,
                      f->key, place_of(r).text, expected);
}

static starg_status reject_value(const reader *r, const starg_field *f) {
    char text[256];
    starg_field_expectation(f, text, sizeof text);
    if (f->flags & STARG_FIELD_NULLABLE)
        strncat(text, ", or null", sizeof text - strlen(text) - 1);
    return reject(r, f, text);
}

static void set_default(const starg_field *f, void *record) {
    const starg_fields one = {.fields = f, .count = 1};
    starg_fields_default(&one, record);
}

static void set_none(const starg_field *f, void *record) {
    if (f->kind == STARG_FIELD_REAL) {
        set_default(f, record);
        return;
    }
    starg_field own = *f;
    own.initial = f->none;
    set_default(&own, record);
}

static starg_status read_word(const reader *r, json_t *value, const starg_field *f, void *record) {
    bool good = json_is_string(value) && starg_field_set_word(f, record, json_string_value(value));
    return good ? STARG_OK : reject_value(r, f);
}

/* A count above 2^63 - 1, which JSON readers may not hold as a number: its digits. */
static bool read_digits(const char *digits, uint64_t *value) {
    *value = 0;
    for (const char *c = digits; *c != '\0'; c++) {
        uint64_t digit = (uint64_t)(*c - '0');
        if (*c < '0' || *c > '9' || *value > (UINT64_MAX - digit) / 10)
            return false;
        *value = 10 * *value + digit;
    }
    return *value > INT64_MAX;
}

static starg_status read_number(const reader *r, json_t *value, const starg_field *f,
                                void *record) {
    bool good = false;
    uint64_t large;
    if (f->kind == STARG_FIELD_FLAG && json_is_boolean(value))
        good = starg_field_set_count(f, record, json_is_true(value));
    else if (f->kind == STARG_FIELD_COUNT && json_is_integer(value) &&
             json_integer_value(value) >= 0)
        good = starg_field_set_count(f, record, (uint64_t)json_integer_value(value));
    else if (f->words != NULL && json_is_string(value))
        good = starg_field_set_word(f, record, json_string_value(value));
    else if (f->kind == STARG_FIELD_COUNT && json_is_string(value) &&
             read_digits(json_string_value(value), &large))
        good = starg_field_set_count(f, record, large);
    else if (f->kind == STARG_FIELD_REAL && json_is_number(value))
        good = starg_field_set_real(f, record, json_number_value(value));
    return good ? STARG_OK : reject_value(r, f);
}

static starg_status read_text(const reader *r, json_t *value, const starg_field *f, void *record) {
    char *copy = NULL;
    if (json_is_null(value)) {
        store_pointer(record, f->offset, NULL);
        return STARG_OK;
    }
    if (!json_is_string(value))
        return reject(r, f, "a text, or null");
    NEW(r->context, r->file->name, copy, json_string_length(value) + 1);
    memcpy(copy, json_string_value(value), json_string_length(value) + 1);
    store_pointer(record, f->offset, copy);
    return STARG_OK;
}

static starg_status read_point(const reader *r, json_t *value, const starg_field *f, void *record) {
    double point[3];
    bool good = json_array_size(value) == 3;
    for (size_t k = 0; k < 3 && good; k++) {
        json_t *x = json_array_get(value, k);
        point[k] = json_number_value(x);
        good = json_is_number(x) && fabs(point[k]) < LIMIT;
    }
    if (!good)
        return reject(r, f, "an array of three numbers below 1e100");
    memcpy((char *)record + f->offset, point, sizeof point);
    return STARG_OK;
}

static starg_status read_numbers(const reader *r, json_t *value, const starg_field *f,
                                 void *record) {
    starg_field number = *f;
    number.size = sizeof(double);
    bool good = json_is_array(value) && json_array_size(value) == f->length;
    for (size_t k = 0; k < f->length && good; k++, number.offset += number.size) {
        json_t *item = json_array_get(value, k);
        good =
            json_is_number(item) && starg_field_set_real(&number, record, json_number_value(item));
    }
    return good ? STARG_OK
                : reject(r, f, "an array of numbers in their range, as many as the format says");
}

static starg_status read_indices(const reader *r, json_t *value, const starg_field *f,
                                 void *record) {
    size_t count = json_array_size(value), limit = load_size(record, f->limit);
    uint32_t *items = NULL;
    if (!json_is_array(value))
        return reject(r, f, "an array of indices");
    NEW(r->context, r->file->name, items, count);
    store_pointer(record, f->offset, items);
    memcpy((char *)record + f->length, &count, sizeof count);
    for (size_t i = 0; i < count; i++) {
        json_t *item = json_array_get(value, i);
        json_int_t index = json_is_integer(item) ? json_integer_value(item) : -1;
        if (index < 0 || (uint64_t)index >= limit || (i > 0 && index <= (json_int_t)items[i - 1]))
            return reject(r, f, "an array of ascending indices of the model");
        items[i] = (uint32_t)index;
    }
    return STARG_OK;
}

/* Does column k share the block of the column before it? Members of structs do. */
static bool shares_block(const starg_fields *columns, size_t k) {
    return k > 0 && columns->fields[k].offset == columns->fields[k - 1].offset;
}

/* Zeroed blocks for `count` items: one block of structs, or one per applicable column. */
static starg_status make_items(const reader *r, const starg_field *f, void *record, size_t count) {
    bool columns = f->of->columns;
    for (size_t k = 0; k < (columns ? f->of->count : 1); k++) {
        const starg_field *column = columns ? &f->of->fields[k] : f;
        if (columns && (!applies(column, record) || shares_block(f->of, k)))
            continue;
        void *block = starg_allocate_zero(r->context, count,
                                          columns ? in_column(column, record).stride : f->of->size);
        if (block == NULL)
            return starg_fail_memory(r->context, r->file->name);
        store_pointer(record, column->offset, block);
    }
    return STARG_OK;
}

static starg_status read_field(reader *r, json_t *value, const starg_field *f, void *record);

/* The value of field k in an object, a tuple, or bare. */
static json_t *value_in(json_t *item, const starg_fields *fields, size_t k) {
    switch (fields->form) {
    case STARG_FORM_TUPLE:
        return json_array_get(item, k);
    case STARG_FORM_BARE:
        return item;
    default:
        return fields->fields[k].key != NULL ? json_object_get(item, fields->fields[k].key) : NULL;
    }
}

/* Checks the JSON type of the value called `what`. */
static starg_status check_form(const reader *r, json_t *value, const starg_fields *fields,
                               const char *what) {
    if (fields->form == STARG_FORM_BARE ||
        (fields->form == STARG_FORM_OBJECT ? json_is_object(value)
                                           : json_array_size(value) == fields->count))
        return STARG_OK;
    char expected[64] = "an object";
    if (fields->form == STARG_FORM_TUPLE)
        snprintf(expected, sizeof expected, "an array of %zu values", fields->count);
    return starg_fail(r->context, STARG_ERROR_FORMAT, r->file->name,
                      "'%.200s' is not a valid %s: %s%s must be %s", r->name, r->file->name, what,
                      place_of(r).text, expected);
}

/* Checks how many numbers each item has, before allocating: the allocation is then bounded by the
 * length of the file. */
static starg_status check_numbers(const reader *r, json_t *items, const starg_fields *fields,
                                  const void *record) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        for (size_t i = 0; f->kind == STARG_FIELD_NUMBERS && i < json_array_size(items); i++)
            if (json_array_size(value_in(json_array_get(items, i), fields, k)) !=
                in_column(f, record).length)
                return reject(r, f, "an array of as many numbers as the format says");
    }
    return STARG_OK;
}

/* Row i of columns. */
static starg_status read_row(reader *r, json_t *item, const starg_fields *fields, void *record,
                             size_t i) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k], own = in_column(f, record);
        if (applies(f, record))
            TRY(read_field(r, value_in(item, fields, k), &own, row_of(f, &own, record, i)));
    }
    return STARG_OK;
}

static starg_status read_items(reader *r, json_t *items, const starg_field *f, void *record) {
    const reader outside = *r;
    r->list = f->key;
    for (r->item = 0; r->item < json_array_size(items); r->item++) {
        json_t *item = json_array_get(items, r->item);
        TRY(check_form(r, item, f->of, "what stands"));
        if (f->of->columns)
            TRY(read_row(r, item, f->of, record, r->item));
        else
            TRY(read_fields(r, item, f->of,
                            (char *)load_pointer(record, f->offset) + r->item * f->of->size));
    }
    *r = outside;
    return STARG_OK;
}

static starg_status read_list(reader *r, json_t *value, const starg_field *f, void *record) {
    size_t count = json_array_size(value);
    if (!json_is_array(value) || count < f->least)
        return reject(r, f, f->least > 0 ? "an array that is not empty" : "an array");
    if ((f->flags & STARG_FIELD_MATCHING) && count != load_size(record, f->length))
        return reject(r, f, "an array with an item for each guard");
    if (f->of->columns)
        TRY(check_numbers(r, value, f->of, record));
    TRY(make_items(r, f, record, count));
    memcpy((char *)record + f->length, &count, sizeof count);
    return read_items(r, value, f, record);
}

static starg_status read_record(reader *r, json_t *value, const starg_field *f, void *record) {
    char what[64];
    snprintf(what, sizeof what, "\"%s\"", f->key);
    starg_status status = check_form(r, value, f->of, what);
    return status == STARG_OK ? read_fields(r, value, f->of, record) : status;
}

static starg_status read_constant(const reader *r, json_t *value, const starg_field *f) {
    char text[128];
    if (f->value != NULL && json_is_string(value) &&
        strcmp(json_string_value(value), f->value) == 0)
        return STARG_OK;
    uint64_t oldest = f->least > 0 ? f->least : f->initial;
    if (f->value == NULL && json_is_integer(value) &&
        json_integer_value(value) >= (json_int_t)oldest &&
        json_integer_value(value) <= (json_int_t)f->initial)
        return STARG_OK;
    if (f->value != NULL)
        snprintf(text, sizeof text, "\"%s\"", f->value);
    else if (oldest == f->initial)
        snprintf(text, sizeof text, "%llu, the only supported one", (unsigned long long)f->initial);
    else
        snprintf(text, sizeof text, "%llu to %llu", (unsigned long long)oldest,
                 (unsigned long long)f->initial);
    return reject(r, f, text);
}

static starg_status read_value(reader *r, json_t *value, const starg_field *f, void *record) {
    switch (f->kind) {
    case STARG_FIELD_CHOICE:
        return read_word(r, value, f, record);
    case STARG_FIELD_TEXT:
        return read_text(r, value, f, record);
    case STARG_FIELD_POINT:
        return read_point(r, value, f, record);
    case STARG_FIELD_NUMBERS:
        return read_numbers(r, value, f, record);
    case STARG_FIELD_INDICES:
        return read_indices(r, value, f, record);
    case STARG_FIELD_RECORD:
        return read_record(r, value, f, (char *)record + f->offset);
    case STARG_FIELD_LIST:
        return read_list(r, value, f, record);
    case STARG_FIELD_CONSTANT:
        return read_constant(r, value, f);
    default:
        return read_number(r, value, f, record);
    }
}

static starg_status read_field(reader *r, json_t *value, const starg_field *f, void *record) {
    if (value == NULL && (f->flags & STARG_FIELD_OPTIONAL)) {
        set_default(f, record);
        return STARG_OK;
    }
    if (value == NULL)
        return starg_fail(r->context, STARG_ERROR_FORMAT, r->file->name,
                          "'%.200s' is not a valid %s: key \"%s\"%s is missing", r->name,
                          r->file->name, f->key, place_of(r).text);
    if (json_is_null(value) && (f->flags & STARG_FIELD_NULLABLE)) {
        set_none(f, record);
        return STARG_OK;
    }
    return read_value(r, value, f, record);
}

static starg_status read_fields(reader *r, json_t *object, const starg_fields *fields,
                                void *record) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        json_t *value = value_in(object, fields, k);
        if (f->key == NULL && fields->form == STARG_FORM_OBJECT)
            set_default(f, record);
        else if (applies(f, record))
            TRY(read_field(r, value, f, record));
        else
            set_default(f, record);
    }
    return STARG_OK;
}

starg_status record_read(starg_context *context, const char *name, json_t *object,
                         const starg_fields *fields, void *record) {
    reader r = {.context = context, .name = name, .file = fields};
    starg_status status = check_form(&r, object, fields, "the whole");
    return status == STARG_OK ? read_fields(&r, object, fields, record) : status;
}
