/* SPDX-License-Identifier: Apache-2.0 */
/* All field tables, of options and of results: a random record stays the same when written, read
 * and written again; each key that is missing or of another type is reported or gets its default;
 * and the range check, the JSON reader and the setter agree about every number. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/rng.h"
#include "guard/stages.h"
#include "morph/surface_map.h"
#include "records.h"
#include "shape/measures.h"
#include "star/decomposition.h"
#include "starguard/starguard.h"

enum { TABLES = 13, MOST_ITEMS = 4 };

static const starg_fields *table(size_t i) {
    const starg_fields *const all[TABLES] = {&guards_file_fields,
                                             &decomposition_file_fields,
                                             &descriptor_file_fields,
                                             &map_file_fields,
                                             starg_guard_options_fields(),
                                             starg_decompose_options_fields(),
                                             starg_descriptor_options_fields(),
                                             starg_morph_options_fields(),
                                             starg_repair_options_fields(),
                                             starg_sample_options_fields(),
                                             starg_skeleton_options_fields(),
                                             starg_tetra_options_fields(),
                                             starg_visibility_options_fields()};
    return all[i];
}

/* ---- random records ---- */

typedef struct maker {
    starg_context *context;
    starg_rng rng;
    const starg_fields *file;
} maker;

static size_t below(maker *m, size_t bound) {
    return (size_t)starg_rng_below(&m->rng, bound);
}

static void *make(maker *m, size_t count, size_t size) {
    void *block = starg_allocate_zero(m->context, count, size);
    assert_non_null(block);
    return block;
}

static void put_pointer(void *record, size_t offset, void *pointer) {
    memcpy((char *)record + offset, &pointer, sizeof pointer);
}

static size_t size_at(const void *record, size_t offset) {
    size_t value;
    memcpy(&value, (const char *)record + offset, sizeof value);
    return value;
}

static void put_size(void *record, size_t offset, size_t value) {
    memcpy((char *)record + offset, &value, sizeof value);
}

/* Is this member the length of a list's columns? Then it must be small. */
static bool is_length(const starg_fields *fields, size_t offset) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        for (size_t c = 0; f->kind == STARG_FIELD_LIST && c < f->of->count; c++)
            if ((f->of->fields[c].flags & STARG_FIELD_COUNTED) && f->of->fields[c].length == offset)
                return true;
    }
    return false;
}

static uint64_t random_count(maker *m, const starg_field *f) {
    uint64_t span = f->most - f->least;
    if (f->kind == STARG_FIELD_FLAG)
        return below(m, 2);
    if (f->kind == STARG_FIELD_CHOICE) {
        size_t words = 0;
        while (f->words[words] != NULL)
            words++;
        return below(m, words);
    }
    if (is_length(m->file, f->offset))
        return f->least + below(m, MOST_ITEMS);
    switch (below(m, 4)) {
    case 0:
        return f->least;
    case 1:
        return f->most;
    case 2:
        return f->flags & STARG_FIELD_NULLABLE ? f->none
               : f->words != NULL              ? f->most + 1 /* its first word */
                                               : f->least;
    default:
        return f->least + starg_rng_next(&m->rng) % (span < UINT64_MAX ? span + 1 : span);
    }
}

static double random_real(maker *m, const starg_field *f) {
    double u = starg_rng_unit(&m->rng), low = f->low;
    switch (below(m, 5)) {
    case 0:
        return f->flags & STARG_FIELD_ABOVE ? nextafter(low, INFINITY) : low;
    case 1:
        return f->high;
    case 2:
        return f->flags & STARG_FIELD_NULLABLE ? f->standard : f->high;
    case 3: /* of any size */
        return fmin(f->high, fmax(nextafter(low, INFINITY), ldexp(u, (int)below(m, 60) - 30)));
    default:
        return (1 - u) * f->high + u * low;
    }
}

static void put_reals(maker *m, const starg_field *f, char *at, size_t count) {
    for (size_t k = 0; k < count; k++) {
        double value = random_real(m, f);
        memcpy(at + k * sizeof value, &value, sizeof value);
    }
}

static void put_text(maker *m, const starg_field *f, void *record) {
    static const char *const texts[] = {"", "m.off", "a \"name\"\\.off", "\xc3\xa4\n\t\x7f\x01"};
    const char *text = texts[below(m, 4)];
    char *copy = NULL;
    if (below(m, 4) > 0)
        copy = strcpy(make(m, strlen(text) + 1, 1), text);
    put_pointer(record, f->offset, copy);
}

static void put_indices(maker *m, const starg_field *f, void *record) {
    size_t limit = size_at(record, f->limit), count = 0;
    uint32_t *items = make(m, MOST_ITEMS, sizeof *items);
    for (size_t next = below(m, 3); count < MOST_ITEMS && next < limit; next += 1 + below(m, 9))
        items[count++] = (uint32_t)next;
    put_pointer(record, f->offset, items);
    put_size(record, f->length, count);
}

static void fill(maker *m, const starg_fields *fields, void *record);
static void fill_field(maker *m, const starg_field *f, void *record);

static void fill_columns(maker *m, const starg_fields *fields, void *record, size_t count) {
    for (size_t k = 0; k < fields->count; k++) {
        starg_field own = fields->fields[k];
        if (own.applies != NULL && !own.applies(record))
            continue;
        if (own.flags & STARG_FIELD_COUNTED)
            own.length = size_at(record, own.length);
        size_t size = own.kind == STARG_FIELD_POINT     ? 3 * sizeof(double)
                      : own.kind == STARG_FIELD_NUMBERS ? own.length * sizeof(double)
                                                        : own.size;
        size_t stride = own.stride > 0 ? own.stride : size;
        if (k == 0 || own.offset != fields->fields[k - 1].offset)
            put_pointer(record, own.offset, make(m, count, stride));
        char *column;
        memcpy(&column, (char *)record + own.offset, sizeof column);
        own.offset = own.within;
        for (size_t i = 0; i < count; i++)
            fill_field(m, &own, column + i * stride);
    }
}

static void fill_list(maker *m, const starg_field *f, void *record) {
    bool matching = f->flags & STARG_FIELD_MATCHING;
    size_t count = f->least + below(m, MOST_ITEMS);
    if (matching)
        count = size_at(record, f->length);
    if ((f->flags & STARG_FIELD_OPTIONAL) && below(m, 3) == 0)
        return;
    put_size(record, f->length, count);
    if (f->of->columns) {
        fill_columns(m, f->of, record, count);
        return;
    }
    char *items = make(m, count, f->of->size);
    put_pointer(record, f->offset, items);
    for (size_t i = 0; i < count; i++)
        fill(m, f->of, items + i * f->of->size);
}

static void fill_field(maker *m, const starg_field *f, void *record) {
    char *at = (char *)record + f->offset;
    const starg_field point = {.low = nextafter(-1e100, 0), .high = nextafter(1e100, 0)};
    if (f->kind <= STARG_FIELD_CHOICE && (f->flags & STARG_FIELD_OPTIONAL) && below(m, 4) == 0)
        return;
    switch (f->kind) {
    case STARG_FIELD_REAL:
        put_reals(m, f, at, 1);
        break;
    case STARG_FIELD_TEXT:
        put_text(m, f, record);
        break;
    case STARG_FIELD_POINT:
        put_reals(m, &point, at, 3);
        break;
    case STARG_FIELD_NUMBERS:
        put_reals(m, f, at, f->length);
        break;
    case STARG_FIELD_INDICES:
        put_indices(m, f, record);
        break;
    case STARG_FIELD_RECORD:
        fill(m, f->of, at);
        break;
    case STARG_FIELD_LIST:
        fill_list(m, f, record);
        break;
    case STARG_FIELD_CONSTANT:
        break;
    default: {
        starg_field any = *f; /* the value that stands for null is out of range */
        uint64_t value = random_count(m, f);
        if (!starg_field_set_count(f, record, value)) {
            assert_true((f->flags & STARG_FIELD_NULLABLE) && value == f->none);
            any.least = 0;
            any.most = UINT64_MAX;
            assert_true(starg_field_set_count(&any, record, value));
        }
    }
    }
}

static void fill(maker *m, const starg_fields *fields, void *record) {
    starg_fields_default(fields, record);
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        if (f->key != NULL && (f->applies == NULL || f->applies(record)))
            fill_field(m, f, record);
    }
}

/* Pieces with the options of their run: the reader of files finds out whether they are there. */
static void tell(const starg_fields *fields, void *record) {
    if (fields == &decomposition_file_fields)
        ((starg_decomposition *)record)->options_known = true;
}

static void make_record(starg_context *context, const starg_fields *fields, uint64_t seed,
                        record_space *record) {
    maker m = {context, starg_rng_make(seed, 26, 0), fields};
    assert_true(fields->size <= sizeof *record);
    *record = (record_space){{0}};
    tell(fields, record);
    fill(&m, fields, record);
}

/* ---- round trips ---- */

static char *write_text(const starg_fields *fields, const void *record, int margin, size_t *size) {
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    assert_non_null(stream);
    assert_true(record_put(stream, fields, record, margin));
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void check_round_trip(starg_context *context, const starg_fields *fields, uint64_t seed) {
    record_space made, read = {{0}};
    size_t size, size_again;
    int margin = (int)(seed % 3);
    make_record(context, fields, seed, &made);
    char *text = write_text(fields, &made, margin, &size);
    tell(fields, &read);
    test_ok(context, record_parse(context, fields, text, size, &read));
    char *again = write_text(fields, &read, margin, &size_again);
    assert_string_equal(text, again);
    if (!record_equal(fields, &made, &read))
        print_error("%s: %s\n", fields->name, text);
    assert_true(record_equal(fields, &made, &read));
    record_release(context, fields, &made);
    record_release(context, fields, &read);
    free(text);
    free(again);
}

static void test_round_trips(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t t = 0; t < TABLES; t++)
        for (uint64_t seed = 0; seed < test_rounds(1000, 20000); seed++)
            check_round_trip(context, table(t), seed);
    test_context_free(context);
}

/* ---- corrupted keys ---- */

typedef struct spoiler {
    starg_context *context;
    const starg_fields *file;
    json_t *root;
    size_t count; /* number of attempts */
} spoiler;

static starg_status read_root(spoiler *s) {
    record_space record = {{0}};
    tell(s->file, &record);
    starg_status status = record_read(s->context, "spoilt", s->root, s->file, &record);
    assert_true(status == STARG_OK || status == STARG_ERROR_FORMAT);
    record_release(s->context, s->file, &record);
    s->count++;
    return status;
}

static void expect_named(spoiler *s, const char *key, starg_status status) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\"", key);
    if (status != STARG_ERROR_FORMAT)
        fail_msg("%s of a %s may be anything", quoted, s->file->name);
    if (strstr(starg_context_error(s->context)->message, quoted) == NULL)
        fail_msg("%s is not named: %s", quoted, starg_context_error(s->context)->message);
}

/* Removes a key: an error that names it, unless it is optional. */
static void remove_key(spoiler *s, const starg_field *f, json_t *object) {
    json_t *kept = json_incref(json_object_get(object, f->key));
    json_object_del(object, f->key);
    starg_status status = read_root(s);
    if (!(f->flags & STARG_FIELD_OPTIONAL))
        expect_named(s, f->key, status);
    json_object_set_new(object, f->key, kept);
}

static void replace_key(spoiler *s, const starg_field *f, json_t *object, json_t *value) {
    json_t *kept = json_incref(json_object_get(object, f->key));
    json_object_set_new(object, f->key, value);
    expect_named(s, f->key, read_root(s));
    json_object_set_new(object, f->key, kept);
}

static void spoil_field(spoiler *s, const starg_field *f, json_t *object) {
    remove_key(s, f, object);
    replace_key(s, f, object,
                f->kind == STARG_FIELD_RECORD ? json_pack("[i]", 1)
                                              : json_pack("{s:i}", "made", 1));
    replace_key(s, f, object,
                f->kind == STARG_FIELD_TEXT ? json_integer(7) : json_string("made up"));
    if (!(f->flags & STARG_FIELD_NULLABLE) && f->kind != STARG_FIELD_TEXT)
        replace_key(s, f, object, json_null());
    if (f->kind == STARG_FIELD_COUNT || f->kind == STARG_FIELD_REAL) {
        replace_key(s, f, object, json_true());
        if (f->low >= 0)
            replace_key(s, f, object, json_integer(-1));
    }
    if (f->kind == STARG_FIELD_COUNT && f->most <= UINT32_MAX)
        replace_key(s, f, object, json_integer((json_int_t)UINT32_MAX + 2));
    if (f->kind == STARG_FIELD_COUNT)
        replace_key(s, f, object, json_real(1.5));
}

static void spoil(spoiler *s, const starg_fields *fields, json_t *object) {
    for (size_t k = 0; k < fields->count && fields->form == STARG_FORM_OBJECT; k++) {
        const starg_field *f = &fields->fields[k];
        json_t *value = f->key != NULL ? json_object_get(object, f->key) : NULL;
        if (value == NULL)
            continue;
        spoil_field(s, f, object);
        if (f->kind == STARG_FIELD_RECORD)
            spoil(s, f->of, value);
        else if (f->kind == STARG_FIELD_LIST && json_array_size(value) > 0)
            spoil(s, f->of, json_array_get(value, json_array_size(value) - 1));
    }
}

static void test_spoilt_keys(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    spoiler s = {.context = context};
    for (size_t t = 0; t < TABLES; t++)
        for (uint64_t seed = 0; seed < test_rounds(60, 1000); seed++) {
            record_space made;
            size_t size;
            s.file = table(t);
            make_record(context, s.file, seed, &made);
            char *text = write_text(s.file, &made, 0, &size);
            test_ok(context, starg_json_parse(context, "test", "text", text, size, &s.root));
            spoil(&s, s.file, s.root);
            assert_int_equal(read_root(&s), STARG_OK); /* unchanged */
            json_decref(s.root);
            record_release(context, s.file, &made);
            free(text);
        }
    assert_true(s.count > 10000);
    test_context_free(context);
}

/* ---- ranges ---- */

/* The field alone in a struct. */
typedef struct single {
    starg_field field;
    starg_fields fields;
} single;

static void make_single(const starg_field *f, single *out) {
    out->field = *f;
    out->field.key = f->key != NULL ? f->key : f->option;
    out->field.offset = 0;
    out->field.applies = NULL;
    out->fields =
        (starg_fields){.name = "single", .size = sizeof(double), .fields = &out->field, .count = 1};
}

static void agree(starg_context *context, const single *one, json_t *value, bool set,
                  const void *forced) {
    double place = 0;
    json_t *object = json_pack("{s:o}", one->field.key, value);
    starg_status status = record_read(context, "single", object, &one->fields, &place);
    assert_int_equal(status == STARG_OK, set);
    if (set)
        assert_memory_equal(&place, forced, one->field.size);
    if (forced != NULL)
        assert_int_equal(fields_check(context, "test", &one->fields, forced) == STARG_OK, set);
    json_decref(object);
}

static void check_count(starg_context *context, const single *one, uint64_t value) {
    const starg_field *f = &one->field;
    uint64_t wide = 0, all = f->size >= 8 ? UINT64_MAX : ((uint64_t)1 << 8 * f->size) - 1;
    starg_field any = *f;
    any.least = 0;
    any.most = UINT64_MAX;
    any.kind = STARG_FIELD_COUNT;
    if (value > INT64_MAX || value == f->initial || value == f->none)
        return; /* not a JSON number, or a value that stands for something */
    bool set = starg_field_set_count(f, &wide, value);
    if (!set)
        starg_field_set_count(&any, &wide, value);
    if (set)
        assert_true(value <= all); /* nothing is truncated */
    agree(context, one, json_integer((json_int_t)value), set, value <= all ? &wide : NULL);
}

static void check_real(starg_context *context, const single *one, double value) {
    const starg_field *f = &one->field;
    double place = 0;
    if (!isfinite(value) || value == f->standard || starg_field_real_word(f, value) != NULL)
        return; /* or a value that stands for something */
    bool set = starg_field_set_real(f, &place, value);
    agree(context, one, json_real(value), set, &value);
}

static void check_field(starg_context *context, const starg_field *f) {
    const uint64_t counts[] = {0,
                               1,
                               2,
                               f->least,
                               f->least - 1,
                               f->most,
                               f->most + 1,
                               UINT32_MAX,
                               (uint64_t)UINT32_MAX + 1,
                               4294967298,
                               INT32_MAX,
                               (uint64_t)INT32_MAX + 1,
                               INT64_MAX};
    const double reals[] = {f->low,
                            nextafter(f->low, INFINITY),
                            nextafter(f->low, -INFINITY),
                            f->high,
                            nextafter(f->high, INFINITY),
                            nextafter(f->high, -INFINITY),
                            0,
                            -0.5,
                            0.5,
                            1e99,
                            -1e99,
                            DBL_MAX,
                            -DBL_MAX,
                            DBL_TRUE_MIN,
                            (f->low + f->high) / 2};
    single one;
    make_single(f, &one);
    for (size_t i = 0; f->kind == STARG_FIELD_COUNT && i < sizeof counts / sizeof *counts; i++)
        check_count(context, &one, counts[i]);
    for (size_t i = 0; f->kind == STARG_FIELD_REAL && i < sizeof reals / sizeof *reals; i++)
        check_real(context, &one, reals[i]);
}

/* A default is a valid value, or the one that stands for null. */
static void check_default(starg_context *context, const starg_field *f) {
    single one;
    double place = 0, again = 0;
    size_t size;
    char *text;
    make_single(f, &one);
    if (f->key == NULL || (f->flags & STARG_FIELD_OPTIONAL))
        return; /* it is the value used for a missing key */
    starg_fields_default(&one.fields, &place);
    test_ok(context, fields_check(context, "test", &one.fields, &place));
    test_ok(context, starg_fields_json(context, &one.fields, &place, &text, &size));
    test_ok(context, record_parse(context, &one.fields, text, size, &again));
    assert_memory_equal(&place, &again, f->size);
    starg_text_free(context, text);
}

static void check_ranges(starg_context *context, const starg_fields *fields, bool options) {
    for (size_t k = 0; k < fields->count; k++) {
        const starg_field *f = &fields->fields[k];
        if (f->kind == STARG_FIELD_COUNT || f->kind == STARG_FIELD_REAL)
            check_field(context, f);
        if (options && f->kind <= STARG_FIELD_CHOICE)
            check_default(context, f);
        if (f->of != NULL)
            check_ranges(context, f->of, options);
    }
}

static void test_ranges(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t t = 0; t < TABLES; t++)
        check_ranges(context, table(t), t >= 4);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_round_trips),
                                       cmocka_unit_test(test_spoilt_keys),
                                       cmocka_unit_test(test_ranges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
