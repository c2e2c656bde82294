/* SPDX-License-Identifier: Apache-2.0 */
#include "guard/stages.h"

#include <math.h>

/* The weight that the coverage is a fraction of: that of everything that can be seen. If that is
 * unknown because the last faces were not tested, it is at most that of all columns. */
static double whole_weight(const guard_pool *pool, const column_weights *weights) {
    return (double)(pool->curtailed ? weights->total : pool_coverable_weight(pool, weights));
}

uint64_t choose_target(const guard_pool *pool, const column_weights *weights) {
    double coverage = pool->options->coverage, kept = (double)weights->kept;
    return coverage < 1
               ? (uint64_t)fmax(0, ceil(coverage * (whole_weight(pool, weights) + kept)) - kept)
               : UINT64_MAX;
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
    problem.needs = pool->solid->need;
    problem.given = how->given;
    problem.given_count = how->given_count;
    if (wanted->max_guards > 0)
        problem.max_rows = wanted->max_guards - how->given_count;
    if (wanted->coverage < 1 || wanted->max_guards > 0)
        problem.weights = weights->weights;
    problem.target = choose_target(pool, weights);
    options.method = how->method;
    options.max_nodes = how->max_nodes;
    options.prices = how->prices;
    return starg_cover_solve(pool->context, &problem, &options, out);
}
