/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of field tables, and range checks by them. */
#pragma once

#include "core/context.h"
#include "starguard/fields.h"

/* Offset and size of a member of struct T. */
#define FIELD_MEMBER(T, MEMBER) .offset = offsetof(T, MEMBER), .size = sizeof(((T *)0)->MEMBER)

/* Rows of a table and their count. */
#define FIELD_ROWS(ROWS) .fields = (ROWS), .count = sizeof(ROWS) / sizeof *(ROWS)

/* Defines NAME_fields and NAME_default for options of type NAME, by their table. */
#define OPTIONS_BY(TABLE, NAME)                                                                    \
    const starg_fields *NAME##_fields(void) {                                                      \
        return &(TABLE);                                                                           \
    }                                                                                              \
    void NAME##_default(NAME *options) {                                                           \
        *options = (NAME){0};                                                                      \
        starg_fields_default(&(TABLE), options);                                                   \
    }

/* The words of an effort, from `most` = INT64_MAX on. */
extern const char *const effort_words[];

/* Is a COUNT, CHOICE, FLAG or REAL within its range or at the value that stands for null? */
bool field_fits(const starg_field *field, const void *record);

/* Checks the ranges of all applicable members. Errors: ARGUMENT. */
starg_status fields_check(starg_context *context, const char *stage, const starg_fields *fields,
                          const void *record) STARG_PRIVATE(fields_check);
