/* SPDX-License-Identifier: Apache-2.0 */
/* Writes, frees and compares records of any field table. */
#ifndef TESTS_RECORDS_H
#define TESTS_RECORDS_H

#include <stdbool.h>

#include "core/json.h"

enum { RECORD_BYTES = 1 << 15 };

/* Room for a struct of any table. */
typedef union record_space {
    double reals[RECORD_BYTES / sizeof(double)];
    void *pointers[RECORD_BYTES / sizeof(void *)];
} record_space;

/* Frees the blocks of a record that the context owns. */
void record_release(starg_context *context, const starg_fields *fields, void *record);

/* Reads a text. */
starg_status record_parse(starg_context *context, const starg_fields *fields, const char *text,
                          size_t size, void *record);

/* Are all members with keys equal in both records? */
bool record_equal(const starg_fields *fields, const void *a, const void *b);

#endif
