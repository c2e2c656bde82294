/* SPDX-License-Identifier: Apache-2.0 */
/* Scanner for text in memory: words between blanks, with their lines. Callers can restrict a read
 * to the current line. Lines end with LF, CR LF or CR. */
#include "mesh/formats/scan.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

starg_scan starg_scan_make(const starg_source *source) {
    return (starg_scan){.source = source,
                        .at = source->bytes,
                        .end = source->bytes + source->size,
                        .line = 1,
                        .comments = true};
}

static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static void pass_line_end(starg_scan *scan) {
    if (*scan->at == '\r' && scan->end - scan->at > 1 && scan->at[1] == '\n')
        scan->at++;
    scan->at++;
    scan->line++;
}

/* True at a backslash that joins this line and the next. */
static bool at_continuation(const starg_scan *scan) {
    return scan->continuations && scan->end - scan->at > 1 && scan->at[0] == '\\' &&
           is_line_end(scan->at[1]);
}

static void skip_comment(starg_scan *scan) {
    while (scan->at < scan->end && !is_line_end(*scan->at))
        scan->at++;
}

/* Stops at a word, a line end or the end of the text. */
static void skip_blanks(starg_scan *scan) {
    while (scan->at < scan->end) {
        if (is_blank(*scan->at)) {
            scan->at++;
        } else if (at_continuation(scan)) {
            scan->at++;
            pass_line_end(scan);
        } else if (scan->comments && *scan->at == '#') {
            skip_comment(scan);
        } else {
            return;
        }
    }
}

static bool ends_word(const starg_scan *scan) {
    char c = *scan->at;
    return is_blank(c) || is_line_end(c) || (scan->comments && c == '#') || at_continuation(scan);
}

bool starg_scan_word_here(starg_scan *scan, starg_word *word) {
    skip_blanks(scan);
    if (scan->at == scan->end || is_line_end(*scan->at))
        return false;
    word->text = scan->at;
    word->line = scan->line;
    while (scan->at < scan->end && !ends_word(scan))
        scan->at++;
    word->length = (size_t)(scan->at - word->text);
    return true;
}

bool starg_scan_word(starg_scan *scan, starg_word *word) {
    while (!starg_scan_word_here(scan, word)) {
        if (scan->at == scan->end)
            return false;
        pass_line_end(scan);
    }
    return true;
}

bool starg_scan_next_line(starg_scan *scan) {
    for (;;) {
        skip_blanks(scan); /* in comments a backslash joins nothing */
        if (scan->at == scan->end)
            return false;
        if (is_line_end(*scan->at)) {
            pass_line_end(scan);
            return scan->at < scan->end;
        }
        scan->at++;
    }
}

starg_status starg_scan_expect(starg_scan *scan, const char *what, starg_word *word) {
    if (starg_scan_word(scan, word))
        return STARG_OK;
    return starg_source_fail(scan->source, starg_at_line(scan->line),
                             "the file ends where %s is expected; it seems to be truncated", what);
}

starg_status starg_scan_real(starg_scan *scan, const char *what, double *value) {
    starg_word word;
    starg_status status = starg_scan_expect(scan, what, &word);
    return status == STARG_OK ? starg_word_real(scan, word, what, value) : status;
}

starg_status starg_scan_integer(starg_scan *scan, const char *what, int64_t *value) {
    starg_word word;
    starg_status status = starg_scan_expect(scan, what, &word);
    return status == STARG_OK ? starg_word_integer(scan, word, what, value) : status;
}

bool starg_scan_peek(starg_scan scan, size_t passed, double numbers[3], bool *whole) {
    starg_word word;
    *whole = true;
    for (size_t i = 0; i < passed + 3; i++) {
        double number;
        if (!starg_scan_word_here(&scan, &word) ||
            !starg_parse_real(word.text, word.length, &number))
            return false;
        if (i < passed)
            continue;
        numbers[i - passed] = number;
        *whole = *whole && memchr(word.text, '.', word.length) == NULL;
    }
    return true;
}

starg_status starg_scan_extra_numbers(starg_scan *scan, size_t limit, const char *what) {
    starg_word word;
    for (size_t count = 0; starg_scan_word_here(scan, &word); count++) {
        double ignored;
        TRY(starg_word_real(scan, word, what, &ignored));
        if (count == limit)
            return starg_source_fail(scan->source, starg_at_line(word.line),
                                     "more than %zu numbers where %s is expected", limit, what);
    }
    return STARG_OK;
}

starg_status starg_scan_end(starg_scan *scan, const char *hint) {
    starg_word word;
    if (!starg_scan_word(scan, &word))
        return STARG_OK;
    return starg_source_fail(scan->source, starg_at_line(word.line),
                             "'%s' follows the end of the data; %s", starg_word_excerpt(word).text,
                             hint);
}

bool starg_word_is(starg_word word, const char *text) {
    return word.length == strlen(text) && memcmp(word.text, text, word.length) == 0;
}

starg_status starg_word_real(const starg_scan *scan, starg_word word, const char *what,
                             double *value) {
    if (starg_parse_real(word.text, word.length, value))
        return STARG_OK;
    return starg_source_fail(scan->source, starg_at_line(word.line),
                             "'%s' is not a number; expected %s", starg_word_excerpt(word).text,
                             what);
}

starg_status starg_word_integer(const starg_scan *scan, starg_word word, const char *what,
                                int64_t *value) {
    if (starg_parse_integer(word.text, word.length, value))
        return STARG_OK;
    return starg_source_fail(scan->source, starg_at_line(word.line),
                             "'%s' is not a whole number; expected %s",
                             starg_word_excerpt(word).text, what);
}

starg_excerpt starg_word_excerpt(starg_word word) {
    enum { SHOWN = 24 };
    starg_excerpt excerpt;
    size_t length = word.length < SHOWN ? word.length : SHOWN;
    for (size_t i = 0; i < length; i++) {
        char c = word.text[i];
        excerpt.text[i] = c > ' ' && c <= '~' ? c : '?';
    }
    memcpy(excerpt.text + length, word.length > SHOWN ? "..." : "", word.length > SHOWN ? 4 : 1);
    return excerpt;
}

/* A decimal number: mantissa x 10^exponent. */
typedef struct decimal {
    bool negative;
    bool rounded; /* the mantissa lost digits */
    uint64_t mantissa;
    int exponent;
} decimal;

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Reads digits into the mantissa while 19 of them fit; returns how many there were. */
static size_t take_digits(const char **at, const char *end, decimal *number, bool fraction) {
    const char *begin = *at;
    for (; *at < end && is_digit(**at); (*at)++) {
        if (number->mantissa < UINT64_C(1000000000000000000)) {
            number->mantissa = 10 * number->mantissa + (uint64_t)(**at - '0');
            number->exponent -= fraction;
        } else {
            number->rounded = true;
            number->exponent += !fraction;
        }
    }
    return (size_t)(*at - begin);
}

/* Reads an exponent if there is one; false if it is malformed. */
static bool take_exponent(const char **at, const char *end, decimal *number) {
    enum { HUGE_EXPONENT = 100000 }; /* beyond any double, far from overflow */
    if (*at == end || (**at != 'e' && **at != 'E'))
        return true;
    (*at)++;
    bool negative = *at < end && **at == '-';
    if (*at < end && (**at == '-' || **at == '+'))
        (*at)++;
    const char *begin = *at;
    int exponent = 0;
    for (; *at < end && is_digit(**at); (*at)++)
        if (exponent < HUGE_EXPONENT)
            exponent = 10 * exponent + (**at - '0');
    number->exponent += negative ? -exponent : exponent;
    return *at != begin;
}

/* True if all of the text is a decimal number. */
static bool take_decimal(const char *at, const char *end, decimal *number) {
    *number = (decimal){.negative = at < end && *at == '-'};
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    size_t digits = take_digits(&at, end, number, false);
    if (at < end && *at == '.') {
        at++;
        digits += take_digits(&at, end, number, true);
    }
    return digits != 0 && take_exponent(&at, end, number) && at == end;
}

static bool same_letters(const char *text, size_t length, const char *lower) {
    if (length != strlen(lower))
        return false;
    for (size_t i = 0; i < length; i++)
        if ((text[i] | 0x20) != lower[i])
            return false;
    return true;
}

static bool take_special(const char *text, size_t length, double *value) {
    bool negative = length != 0 && text[0] == '-';
    if (length != 0 && (text[0] == '-' || text[0] == '+')) {
        text++;
        length--;
    }
    if (same_letters(text, length, "nan"))
        *value = NAN;
    else if (same_letters(text, length, "inf") || same_letters(text, length, "infinity"))
        *value = negative ? -INFINITY : INFINITY;
    else
        return false;
    return true;
}

/* Longest number in characters: 767 digits determine any double. */
enum { LONGEST_NUMBER = 1000 };

/* strtod, which is exact, for numbers that the fast path cannot round. */
static double parse_slowly(const char *text, size_t length) {
    char copy[LONGEST_NUMBER + 1];
    memcpy(copy, text, length);
    copy[length] = '\0';
    return strtod(copy, NULL);
}

/* If mantissa and power of ten are exact doubles, one operation gives the correctly rounded
 * quotient or product (Clinger, How to read floating point numbers accurately, 1990). */
bool starg_parse_real(const char *text, size_t length, double *value) {
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    decimal number;
    if (length > LONGEST_NUMBER)
        return false;
    if (!take_decimal(text, text + length, &number))
        return take_special(text, length, value);
    if (FLT_EVAL_METHOD != 0 || number.rounded || number.mantissa > UINT64_C(1) << 53 ||
        number.exponent < -22 || number.exponent > 22) {
        *value = parse_slowly(text, length);
        return true;
    }
    double magnitude = (double)number.mantissa;
    if (number.exponent < 0)
        magnitude /= powers[-number.exponent];
    else
        magnitude *= powers[number.exponent];
    *value = number.negative ? -magnitude : magnitude;
    return true;
}

bool starg_parse_integer(const char *text, size_t length, int64_t *value) {
    const char *at = text, *end = text + length;
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    const char *begin = at;
    int64_t magnitude = 0;
    for (; at < end && is_digit(*at); at++) {
        int digit = *at - '0';
        if (magnitude > (INT64_MAX - digit) / 10)
            return false;
        magnitude = 10 * magnitude + digit;
    }
    *value = negative ? -magnitude : magnitude;
    return at != begin && at == end;
}
