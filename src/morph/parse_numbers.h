/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of numbers, with comments from '#' on. */
#ifndef STARG_MORPH_PARSE_NUMBERS_H
#define STARG_MORPH_PARSE_NUMBERS_H

#include <stddef.h>

/* The numbers of a line, apart by white space or commas, and how many there are; `most` + 1 if it
 * has more, or anything else. The line loses its comment. */
size_t parse_numbers(char *line, double *values, size_t most);

#endif
