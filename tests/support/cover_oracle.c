/* SPDX-License-Identifier: Apache-2.0 */
#include "cover_oracle.h"

#include <stdlib.h>

#include "support.h"

static uint64_t weight_of_column(const starg_cover_problem *problem, size_t column) {
    return problem->weights ? problem->weights[column] : 1;
}

static size_t holders(const starg_cover_problem *problem, size_t column) {
    size_t count = 0;
    for (size_t i = 0; i < starg_bits_rows(problem->rows); i++)
        count += starg_bits_test(problem->rows, i, column);
    return count;
}

static bool is_given(const starg_cover_problem *problem, size_t row) {
    for (size_t k = 0; k < problem->given_count; k++)
        if (problem->given[k] == row)
            return true;
    return false;
}

uint64_t cover_oracle_weight(const starg_cover_problem *problem, const uint32_t *rows,
                             size_t count) {
    uint64_t sum = 0;
    for (size_t j = 0; j < starg_bits_columns(problem->rows); j++) {
        size_t supply = holders(problem, j), held = 0;
        size_t demand = supply < problem->redundancy ? supply : problem->redundancy;
        for (size_t c = 0; c < count; c++)
            held += starg_bits_test(problem->rows, rows[c], j);
        for (size_t i = 0; i < starg_bits_rows(problem->rows); i++)
            held += is_given(problem, i) && starg_bits_test(problem->rows, i, j);
        if (supply > 0 && held >= demand)
            sum += weight_of_column(problem, j);
    }
    return sum;
}

uint64_t cover_oracle_coverable(const starg_cover_problem *problem) {
    uint64_t sum = 0;
    for (size_t j = 0; j < starg_bits_columns(problem->rows); j++) {
        if (holders(problem, j) > 0)
            sum += weight_of_column(problem, j);
    }
    return sum;
}

/* A column with its rows as bits of a word. */
typedef struct oracle_column {
    uint32_t holders, demand;
    uint64_t weight;
} oracle_column;

static oracle_column look_at(const starg_cover_problem *problem, size_t column) {
    oracle_column result = {.weight = weight_of_column(problem, column)};
    for (size_t i = 0; i < starg_bits_rows(problem->rows); i++)
        result.holders |= (uint32_t)starg_bits_test(problem->rows, i, column) << i;
    uint32_t supply = (uint32_t)__builtin_popcount(result.holders);
    result.demand = supply < problem->redundancy ? supply : problem->redundancy;
    return result;
}

void cover_oracle_best(const starg_cover_problem *problem, uint64_t best[COVER_ORACLE_ROWS + 1]) {
    size_t rows = starg_bits_rows(problem->rows), columns = starg_bits_columns(problem->rows);
    uint32_t given = 0;
    for (size_t i = 0; i < rows; i++)
        given |= (uint32_t)is_given(problem, i) << i;
    oracle_column *all = malloc((columns + 1) * sizeof *all);
    assert_non_null(all);
    for (size_t j = 0; j < columns; j++)
        all[j] = look_at(problem, j);
    for (size_t c = 0; c <= rows; c++)
        best[c] = 0;
    for (uint32_t choice = 0; choice < (uint32_t)1 << rows; choice++) {
        uint64_t sum = 0;
        if ((choice & given) != 0)
            continue;
        for (size_t j = 0; j < columns; j++) {
            uint32_t held = (uint32_t)__builtin_popcount(all[j].holders & (choice | given));
            if (all[j].holders != 0 && held >= all[j].demand)
                sum += all[j].weight;
        }
        size_t count = (size_t)__builtin_popcount(choice);
        if (sum > best[count])
            best[count] = sum;
    }
    free(all);
}

size_t cover_oracle_fewest(const uint64_t *best, size_t rows, uint64_t weight) {
    size_t count = 0;
    while (count <= rows && best[count] < weight)
        count++;
    return count;
}

starg_bits *cover_oracle_lines(starg_context *context, int dimension) {
    size_t points = 1;
    for (int d = 0; d < dimension; d++)
        points *= 3;
    starg_bits *bits = NULL;
    size_t line = 0;
    test_ok(context, starg_bits_create(context, points, points * (points - 1) / 6, &bits));
    for (size_t a = 0; a < points; a++) {
        for (size_t b = a + 1; b < points; b++) {
            size_t c = 0, x = a, y = b; /* a + b + c = 0 in each coordinate */
            for (size_t unit = 1; unit < points; unit *= 3, x /= 3, y /= 3)
                c += (6 - x % 3 - y % 3) % 3 * unit;
            if (c < b)
                continue; /* each line once */
            starg_bits_set(bits, a, line);
            starg_bits_set(bits, b, line);
            starg_bits_set(bits, c, line++);
        }
    }
    assert_int_equal(line, starg_bits_columns(bits));
    return bits;
}
