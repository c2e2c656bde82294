/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fields.h"
#include "core/memory.h"

#include <math.h>
#include <stdio.h>

/* ---- members ---- */

static void *member(const starg_field *f, void *record) {
    return (char *)record + f->offset;
}

static const void *member_const(const starg_field *f, const void *record) {
    return (const char *)record + f->offset;
}

static void store_count(const starg_field *f, void *record, uint64_t value) {
    uint32_t narrow = (uint32_t)value;
    bool flag = value != 0;
    if (f->size == sizeof flag)
        memcpy(member(f, record), &flag, sizeof flag);
    else if (f->size == sizeof narrow)
        memcpy(member(f, record), &narrow, sizeof narrow);
    else
        memcpy(member(f, record), &value, sizeof value);
}

uint64_t starg_field_count(const starg_field *field, const void *record) {
    uint64_t value;
    uint32_t narrow;
    bool flag;
    if (field->size == sizeof flag) {
        memcpy(&flag, member_const(field, record), sizeof flag);
        return flag;
    }
    if (field->size == sizeof narrow) {
        memcpy(&narrow, member_const(field, record), sizeof narrow);
        return narrow;
    }
    memcpy(&value, member_const(field, record), sizeof value);
    return value;
}

static double real_of(const starg_field *f, const void *record) {
    double value;
    memcpy(&value, member_const(f, record), sizeof value);
    return value;
}

/* ---- ranges ---- */

const char *const effort_words[] = {"quick", "normal", "best", NULL};

static size_t word_count(const starg_field *f) {
    size_t count = 0;
    while (f->words != NULL && f->words[count] != NULL)
        count++;
    return count;
}

/* The number of its first word. */
static uint64_t first_word(const starg_field *f) {
    return f->kind == STARG_FIELD_COUNT ? f->most + 1 : 0;
}

const char *starg_field_real_word(const starg_field *field, double value) {
    for (size_t i = 0; i < word_count(field); i++)
        if (value == -(double)(i + 1))
            return field->words[i];
    return NULL;
}

const char *starg_field_word(const starg_field *field, uint64_t number) {
    uint64_t at = number - first_word(field);
    return number >= first_word(field) && at < word_count(field) ? field->words[at] : NULL;
}

bool starg_field_set_word(const starg_field *field, void *record, const char *word) {
    for (size_t i = 0; i < word_count(field); i++)
        if (strcmp(field->words[i], word) == 0) {
            double value = -(double)(i + 1);
            if (field->kind == STARG_FIELD_REAL)
                memcpy(member(field, record), &value, sizeof value);
            else
                store_count(field, record, first_word(field) + i);
            return true;
        }
    return false;
}

const char *starg_fields_word(const starg_fields *fields, const char *key, uint64_t number) {
    for (size_t i = 0; i < fields->count; i++) {
        const starg_field *f = &fields->fields[i];
        if (f->kind == STARG_FIELD_CHOICE && f->key != NULL && strcmp(f->key, key) == 0)
            return starg_field_word(f, number);
    }
    return NULL;
}

static bool count_fits(const starg_field *f, uint64_t value) {
    if (f->kind == STARG_FIELD_FLAG)
        return value <= 1;
    if (f->kind == STARG_FIELD_CHOICE)
        return value < word_count(f);
    return (value >= f->least && value <= f->most) ||
           (word_count(f) > 0 && starg_field_word(f, value) != NULL);
}

static bool real_fits(const starg_field *f, double value) {
    return value <= f->high && ((f->flags & STARG_FIELD_ABOVE) ? value > f->low : value >= f->low);
}

bool starg_field_set_count(const starg_field *field, void *record, uint64_t value) {
    if (!count_fits(field, value))
        return false;
    store_count(field, record, value);
    return true;
}

bool starg_field_set_real(const starg_field *field, void *record, double value) {
    if (!real_fits(field, value))
        return false;
    memcpy(member(field, record), &value, sizeof value);
    return true;
}

static void list_words(const starg_field *f, char *text, size_t size) {
    bool number = f->kind != STARG_FIELD_CHOICE;
    size_t used = (size_t)snprintf(text, size, number ? "" : "one of ");
    for (size_t i = 0; f->words[i] != NULL && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i > 0 ? ", " : "", f->words[i]);
    if (number && used < size)
        snprintf(text + used, size - used, " or a number");
}

void starg_field_expectation(const starg_field *field, char *text, size_t size) {
    const starg_field *f = field;
    bool unlimited = f->kind == STARG_FIELD_COUNT ? f->most >= UINT32_MAX : f->high >= 1e100;
    if (f->kind == STARG_FIELD_FLAG)
        snprintf(text, size, "true or false");
    else if (word_count(f) > 0)
        list_words(f, text, size);
    else if (f->kind == STARG_FIELD_COUNT && unlimited)
        snprintf(text, size, f->least == 0 ? "a whole number, zero or more" : "%llu or more",
                 (unsigned long long)f->least);
    else if (f->kind == STARG_FIELD_COUNT)
        snprintf(text, size, "%llu to %llu", (unsigned long long)f->least,
                 (unsigned long long)f->most);
    else if (unlimited && f->low <= -1e100)
        snprintf(text, size, "a number");
    else if (unlimited)
        snprintf(text, size, (f->flags & STARG_FIELD_ABOVE) ? "above %g" : "zero or more", f->low);
    else if (f->flags & STARG_FIELD_ABOVE)
        snprintf(text, size, "above %g and at most %g", f->low, f->high);
    else
        snprintf(text, size, "%g to %g", f->low, f->high);
}

/* Name of a member in messages: "face_rule" becomes "face rule". */
static void spell_name(const starg_field *f, char *text, size_t size) {
    snprintf(text, size, "%s", f->key != NULL ? f->key : f->option);
    for (char *c = text; *c != '\0'; c++)
        if (*c == '_' || *c == '-')
            *c = ' ';
}

bool field_fits(const starg_field *field, const void *record) {
    const starg_field *f = field;
    bool nullable = f->flags & STARG_FIELD_NULLABLE;
    if (f->kind == STARG_FIELD_REAL) {
        double value = real_of(f, record);
        return real_fits(f, value) || (nullable && value == f->standard) ||
               starg_field_real_word(f, value) != NULL;
    }
    uint64_t value = starg_field_count(f, record);
    return count_fits(f, value) || (nullable && value == f->none);
}

static starg_status check_field(starg_context *context, const char *stage, const starg_field *f,
                                const void *record) {
    char name[64], expected[256];
    bool real = f->kind == STARG_FIELD_REAL;
    double value = real ? real_of(f, record) : 0;
    uint64_t number = real ? 0 : starg_field_count(f, record);
    if (field_fits(f, record) || (real ? value == f->standard : number == f->initial))
        return STARG_OK;
    spell_name(f, name, sizeof name);
    starg_field_expectation(f, expected, sizeof expected);
    if (real)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage, "the %s is %g; it must be %s", name,
                          value, expected);
    return starg_fail(context, STARG_ERROR_ARGUMENT, stage, "the %s is %llu; it must be %s", name,
                      (unsigned long long)number, expected);
}

starg_status fields_check(starg_context *context, const char *stage, const starg_fields *fields,
                          const void *record) {
    for (size_t i = 0; i < fields->count; i++) {
        const starg_field *f = &fields->fields[i];
        if (f->kind <= STARG_FIELD_CHOICE && (f->applies == NULL || f->applies(record)))
            TRY(check_field(context, stage, f, record));
    }
    return STARG_OK;
}

/* ---- defaults ---- */

const char *starg_field_group(size_t index, const char **title) {
    static const char *const groups[][2] = {{"input", "What goes in"},
                                            {"targets", "What to see"},
                                            {"places", "Where guards may stand"},
                                            {"cameras", "Cameras"},
                                            {"number", "How many"},
                                            {"search", "Effort and method"},
                                            {"output", "What comes out"}};
    if (index >= sizeof groups / sizeof *groups)
        return NULL;
    *title = groups[index][1];
    return groups[index][0];
}

void starg_fields_default(const starg_fields *fields, void *record) {
    for (size_t i = 0; i < fields->count; i++) {
        const starg_field *f = &fields->fields[i];
        if (f->kind == STARG_FIELD_REAL)
            memcpy(member(f, record), &f->standard, sizeof f->standard);
        else if (f->kind <= STARG_FIELD_CHOICE)
            store_count(f, record, f->initial);
        else if (f->kind == STARG_FIELD_TEXT || f->kind == STARG_FIELD_PLACES ||
                 f->kind == STARG_FIELD_TEXTS)
            memset(member(f, record), 0, f->size);
        else if (f->kind == STARG_FIELD_NUMBERS && (f->flags & STARG_FIELD_RARE))
            for (size_t k = 0; k < f->length; k++)
                memcpy((char *)member(f, record) + k * sizeof f->standard, &f->standard,
                       sizeof f->standard);
        else if (f->kind == STARG_FIELD_RECORD)
            starg_fields_default(f->of, member(f, record));
    }
}

/* Integer with thousands separators. */
static void put_count(char *text, size_t size, uint64_t value) {
    char digits[32];
    size_t length = (size_t)snprintf(digits, sizeof digits, "%llu", (unsigned long long)value);
    size_t used = 0;
    for (size_t i = 0; i < length && used + 2 < size; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            text[used++] = ',';
        text[used++] = digits[i];
    }
    text[used] = '\0';
}

void starg_field_default_text(const starg_field *field, char *text, size_t size) {
    char number[64] = "";
    const char *words = field->default_text;
    text[0] = '\0';
    if (words != NULL && words[0] == '\0')
        return;
    if (words == NULL && word_count(field) > 0)
        words = field->kind == STARG_FIELD_REAL ? starg_field_real_word(field, field->standard)
                                                : starg_field_word(field, field->initial);
    if (words == NULL && field->kind == STARG_FIELD_COUNT)
        put_count(number, sizeof number, field->initial);
    else if (words == NULL && field->kind == STARG_FIELD_REAL)
        snprintf(number, sizeof number, "%g", field->standard);
    if (words != NULL || number[0] != '\0')
        snprintf(text, size, "Default: %s.", words != NULL ? words : number);
}
