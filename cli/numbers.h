/* SPDX-License-Identifier: Apache-2.0 */
/* Strict number parsing: the whole word or nothing. */
#ifndef STARGUARD_CLI_NUMBERS_H
#define STARGUARD_CLI_NUMBERS_H

#include <stdbool.h>
#include <stdint.h>

/* Decimal digits only; false for anything else and on overflow. */
bool cli_number_count(const char *word, uint64_t *value);

/* A finite decimal number; no spaces, hexadecimal, "inf" or "nan". */
bool cli_number_real(const char *word, double *value);

/* `count` reals separated by commas. */
bool cli_number_list(const char *word, double *values, int count);

/* A fraction in percent with two digits, rounded down, so that only 1 becomes 100; exact hundredths
 * of a percent (within a double) keep their value. */
double cli_percent(double fraction);

#endif
