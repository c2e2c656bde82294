#include "guard/choose.h"

#include <math.h>

static uint64_t coverable_weight(const guard_pool *pool, const column_weights *weights) {
    uint64_t sum = 0;
    for (size_t j = 0; j < pool->columns; j++)
        if (starg_bit_test(pool->coverable, j))
            sum += weights->weights[j];
    return sum;
}

starg_status choose_candidates(const guard_pool *pool, const column_weights *weights,
                               const choice *how, starg_cover **out) {
    const starg_guard_options *wanted = pool->options;
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = pool->rows;
    problem.redundancy = wanted->redundancy;
    problem.given = how->given;
    problem.given_count = how->given_count;
    if (wanted->max_guards > 0)
        problem.max_rows = wanted->max_guards - how->given_count;
    if (wanted->coverage < 1 || wanted->max_guards > 0)
        problem.weights = weights->weights;
    if (wanted->coverage < 1)
        problem.target = (uint64_t)ceil(wanted->coverage * (double)coverable_weight(pool, weights));
    options.method = how->method;
    options.max_nodes = how->max_nodes;
    options.prices = how->prices;
    return starg_cover_solve(pool->context, &problem, &options, out);
}
