/* SPDX-License-Identifier: Apache-2.0 */
/* Times the set cover on random caps of a sphere: rows are caps, columns are points.
 *
 *     bench_cover [ROWS [COLUMNS [SMALLEST [LARGEST [TARGET [REDUNDANCY [SECONDS]]]]]]]
 *
 * SMALLEST and LARGEST are the fractions of the sphere covered by a cap, TARGET the fraction of the
 * weight to cover. Prints a line per method. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/context.h"
#include "core/rng.h"
#include "starguard/cover.h"

typedef struct setup {
    size_t rows, columns;
    double smallest, largest, target;
    uint32_t redundancy;
    double seconds;
} setup;

static void random_direction(starg_rng *rng, double v[3]) {
    double z = 2 * starg_rng_unit(rng) - 1, angle = 8 * atan(1) * starg_rng_unit(rng);
    double r = sqrt(1 - z * z);
    v[0] = r * cos(angle);
    v[1] = r * sin(angle);
    v[2] = z;
}

static starg_status make_caps(starg_context *context, const setup *with, starg_bits **out) {
    starg_status status = starg_bits_create(context, with->rows, with->columns, out);
    if (status != STARG_OK)
        return status;
    for (size_t i = 0; i < with->rows; i++) {
        starg_rng cap = starg_rng_make(1, 1, i);
        double axis[3];
        random_direction(&cap, axis);
        double share = with->smallest + (with->largest - with->smallest) * starg_rng_unit(&cap);
        for (size_t j = 0; j < with->columns; j++) {
            starg_rng point = starg_rng_make(1, 2, j);
            double v[3];
            random_direction(&point, v);
            if (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2] >= 1 - 2 * share)
                starg_bits_set(*out, i, j);
        }
    }
    return STARG_OK;
}

static starg_status run(starg_context *context, const setup *with, const starg_bits *bits,
                        starg_cover_method method) {
    static const char *const names[] = {"greedy", "ilp"};
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover *cover;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = bits;
    problem.redundancy = with->redundancy;
    if (with->target < 1)
        problem.target = (uint64_t)(with->target * (double)with->columns);
    options.method = method;
    starg_context_set_time_limit(context, with->seconds);
    double start = starg_clock();
    starg_status status = starg_cover_solve(context, &problem, &options, &cover);
    if (status != STARG_OK)
        return status;
    printf("%-6s  %.3f s  %zu rows  bound %zu  %s  weight %llu  nodes %zu\n", names[method],
           starg_clock() - start, cover->count, cover->lower_bound,
           cover->optimal        ? "optimal"
           : cover->time_limited ? "time limit"
                                 : "open",
           (unsigned long long)cover->weight, cover->nodes);
    starg_cover_free(cover);
    return STARG_OK;
}

static double argument(int count, char **values, int index, double otherwise) {
    return index < count ? strtod(values[index], NULL) : otherwise;
}

int main(int count, char **values) {
    setup with = {.rows = (size_t)argument(count, values, 1, 1000),
                  .columns = (size_t)argument(count, values, 2, 20000),
                  .smallest = argument(count, values, 3, 0.02),
                  .largest = argument(count, values, 4, 0.2),
                  .target = argument(count, values, 5, 1),
                  .redundancy = (uint32_t)argument(count, values, 6, 1),
                  .seconds = argument(count, values, 7, 60)};
    starg_context *context;
    starg_bits *bits = NULL;
    starg_status status = starg_context_create(NULL, &context);
    if (status != STARG_OK)
        return EXIT_FAILURE;
    status = make_caps(context, &with, &bits);
    if (status == STARG_OK)
        status = run(context, &with, bits, STARG_COVER_GREEDY);
    if (status == STARG_OK)
        status = run(context, &with, bits, STARG_COVER_ILP);
    if (status != STARG_OK)
        fprintf(stderr, "bench_cover: %s\n", starg_context_error(context)->message);
    starg_bits_free(bits);
    starg_context_free(context);
    return status == STARG_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
