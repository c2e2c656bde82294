/* SPDX-License-Identifier: Apache-2.0 */
/* Words and numbers of a file in memory. */
#pragma once

#include "mesh/formats/io.h"

/* ---- words between blanks, with their lines (scan.c) ---- */

typedef struct starg_scan {
    const starg_source *source;
    const char *at, *end;
    size_t line;
    bool comments;      /* # starts a comment */
    bool continuations; /* a backslash before a line end joins lines */
} starg_scan;

typedef struct starg_word {
    const char *text; /* not terminated */
    size_t length;
    size_t line;
} starg_word;

starg_scan starg_scan_make(const starg_source *source);

/* The next word on the current line; false at its end. */
bool starg_scan_word_here(starg_scan *scan, starg_word *word);

/* The next word on this line or a later one; false at the end of the text. */
bool starg_scan_word(starg_scan *scan, starg_word *word);

/* Moves to the beginning of the next line; false at the end of the text. */
bool starg_scan_next_line(starg_scan *scan);

/* The next word, which must exist; messages call it `what` ("a face count"). Errors: FORMAT. */
starg_status starg_scan_expect(starg_scan *scan, const char *what, starg_word *word);
starg_status starg_scan_real(starg_scan *scan, const char *what, double *value);
starg_status starg_scan_integer(starg_scan *scan, const char *what, int64_t *value);

/* The three numbers that follow `passed` others on the line, which is not left; false if there are
 * fewer. *whole: none has a point. */
bool starg_scan_peek(starg_scan scan, size_t passed, double numbers[3], bool *whole);

/* Fails if the rest of the line has words that are not numbers, or more than `limit` numbers. */
starg_status starg_scan_extra_numbers(starg_scan *scan, size_t limit, const char *what);

/* Fails if anything but blanks and comments follows. */
starg_status starg_scan_end(starg_scan *scan, const char *hint);

bool starg_word_is(starg_word word, const char *text);
starg_status starg_word_real(const starg_scan *scan, starg_word word, const char *what,
                             double *value);
starg_status starg_word_integer(const starg_scan *scan, starg_word word, const char *what,
                                int64_t *value);

/* The beginning of a word for messages: printable, short, terminated. */
typedef struct starg_excerpt {
    char text[28];
} starg_excerpt;

starg_excerpt starg_word_excerpt(starg_word word);

/* The double nearest to a decimal number that fills the text; also accepts nan, inf and infinity in
 * any case, but no hexadecimal numbers. Requires the "C" locale. */
bool starg_parse_real(const char *text, size_t length, double *value);

/* A decimal integer that fills the text and fits. */
bool starg_parse_integer(const char *text, size_t length, int64_t *value);

/* ---- numbers in text or binary data (numbers.c) ---- */

typedef enum number_encoding { NUMBERS_TEXT, NUMBERS_LITTLE, NUMBERS_BIG } number_encoding;
typedef enum number_type {
    NUMBER_INT32,
    NUMBER_INT64,
    NUMBER_FLOAT32,
    NUMBER_FLOAT64,
    NUMBER_INT8,
    NUMBER_INT16,
    NUMBER_UINT8,
    NUMBER_UINT16,
    NUMBER_UINT32
} number_type;

typedef struct number_scan {
    starg_scan scan; /* binary data uses only its `at`, text lines in between all of it */
    number_encoding encoding;
} number_scan;

starg_place numbers_place(const number_scan *numbers);

/* The next number, of this type in binary data. `what` as in scan.h. Errors: FORMAT. */
starg_status numbers_real(number_scan *numbers, number_type type, const char *what, double *value);
starg_status numbers_integer(number_scan *numbers, number_type type, const char *what,
                             int64_t *value);

/* Size of a number in binary data. */
size_t numbers_bytes(number_type type);

/* Smallest size of a number: in text one digit and a blank. */
size_t numbers_least_bytes(const number_scan *numbers, number_type type);

/* Fails unless 0 <= count and `count` items of `bytes` each fit into the rest of the file. */
starg_status numbers_check_count(const number_scan *numbers, int64_t count, size_t bytes,
                                 const char *what);
