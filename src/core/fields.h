/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of field tables, and what the library does with a table: range checks. */
#ifndef STARG_CORE_FIELDS_H
#define STARG_CORE_FIELDS_H

#include "core/context.h"
#include "core/private.h"
#include "starguard/fields.h"

/* Where a member of struct T is. */
#define FIELD_MEMBER(T, MEMBER) .offset = offsetof(T, MEMBER), .size = sizeof(((T *)0)->MEMBER)

/* The rows of a table and their number. */
#define FIELD_ROWS(ROWS) .fields = (ROWS), .count = sizeof(ROWS) / sizeof *(ROWS)

/* Is a COUNT, CHOICE, FLAG or REAL within its range, or what null stands for? */
bool field_fits(const starg_field *field, const void *record);

/* Are all members that the record has within their ranges? Errors: ARGUMENT. */
starg_status fields_check(starg_context *context, const char *stage, const starg_fields *fields,
                          const void *record) STARG_PRIVATE(fields_check);

#endif
