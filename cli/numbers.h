/* SPDX-License-Identifier: Apache-2.0 */
/* Strict numbers: the whole word or nothing. */
#ifndef STARGUARD_CLI_NUMBERS_H
#define STARGUARD_CLI_NUMBERS_H

#include <stdbool.h>
#include <stdint.h>

/* Decimal digits only; false for anything else and for what does not fit. */
bool cli_number_count(const char *word, uint64_t *value);

/* A finite decimal number; no spaces, hexadecimal, "inf" or "nan". */
bool cli_number_real(const char *word, double *value);

/* `count` reals with commas between them. */
bool cli_number_list(const char *word, double *values, int count);

/* A fraction in percent with two digits, rounded down, so that only what is whole is called 100;
 * what is a hundredth of a percent as exactly as a double can be stays it. */
double cli_percent(double fraction);

#endif
