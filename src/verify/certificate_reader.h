/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the words of a certificate (docs/formats.md). Each function fails with FORMAT, and the
 * line, where something else stands. */
#ifndef STARG_VERIFY_CERTIFICATE_READER_H
#define STARG_VERIFY_CERTIFICATE_READER_H

#include "verify/everywhere.h"

typedef struct certificate_reader {
    starg_context *context;
    const char *name;
    const char *at, *end;
    uint64_t line;
    starg_certificate *own;
} certificate_reader;

starg_status certificate_reject(const certificate_reader *r, const char *what);

/* Goes past a character if it is the next one. */
bool certificate_take(certificate_reader *r, char c);

starg_status certificate_take_text(certificate_reader *r, const char *text);
starg_status certificate_end_line(certificate_reader *r);

/* A whole number of at most `most`, without a sign and without needless zeros. */
starg_status certificate_take_number(certificate_reader *r, uint64_t most, uint64_t *value);

/* A line with a word and a number of things of at least `size` bytes each, which are still to come.
 */
starg_status certificate_take_count(certificate_reader *r, const char *word, size_t size,
                                    size_t *count);

/* M:K is M times 2 to the power of K. */
starg_status certificate_take_double(certificate_reader *r, double *value);

/* Three of them, with a blank before each. */
starg_status certificate_take_point(certificate_reader *r, double out[3]);

#endif
