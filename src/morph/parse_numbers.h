/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of numbers, with comments from '#' on. */
#pragma once

#include <stddef.h>

/* The numbers of a line, apart by white space or commas, and how many there are; `most` + 1 if it
 * has more, or anything else. The line loses its comment. */
size_t parse_numbers(char *line, double *values, size_t most);
