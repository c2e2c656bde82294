/* SPDX-License-Identifier: Apache-2.0 */
#include "morph/surface_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t parse_numbers(char *line, double *values, size_t most) {
    size_t count = 0;
    char *comment = strchr(line, '#'), *end;
    if (comment != NULL)
        *comment = '\0';
    for (char *at = line;; at = end) {
        at += strspn(at, " \t\r,");
        if (*at == '\0')
            return count;
        double value = strtod(at, &end);
        if (end == at || count == most || !isfinite(value))
            return most + 1;
        values[count++] = value;
    }
}
