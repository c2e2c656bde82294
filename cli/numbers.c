/* SPDX-License-Identifier: Apache-2.0 */
#include "numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool cli_number_count(const char *word, uint64_t *value) {
    uint64_t sum = 0;
    if (*word == '\0')
        return false;
    for (; *word != '\0'; word++) {
        if (*word < '0' || *word > '9')
            return false;
        uint64_t digit = (uint64_t)(*word - '0');
        if (sum > (UINT64_MAX - digit) / 10)
            return false;
        sum = 10 * sum + digit;
    }
    *value = sum;
    return true;
}

/* The program stays in the "C" locale, so strtod expects a decimal point. */
static bool read_real(const char *word, size_t size, double *value) {
    if (size == 0 || strspn(word, "+-.0123456789eE") < size)
        return false;
    char *end;
    *value = strtod(word, &end);
    return end == word + size && isfinite(*value);
}

bool cli_number_real(const char *word, double *value) {
    return read_real(word, strlen(word), value);
}

bool cli_number_list(const char *word, double *values, int count) {
    for (int i = 0; i < count; i++) {
        size_t size = strcspn(word, ",");
        if (!read_real(word, size, &values[i]) || (word[size] == ',') != (i < count - 1))
            return false;
        word += size + 1;
    }
    return true;
}

double cli_percent(double fraction) {
    double hundredths = floor(1e4 * fraction); /* the product is rounded and may be one off */
    if ((hundredths + 1) / 1e4 <= fraction)
        hundredths++;
    else if (hundredths / 1e4 > fraction)
        hundredths--;
    return hundredths / 100;
}
