/* SPDX-License-Identifier: Apache-2.0 */
/* Small set covers with weights, targets, redundancy, limits and given rows, by every method: what
 * is returned covers what it says, bounds are bounds, and with nodes enough the best is found, as
 * trying all choices of rows shows. */
#include "cover_oracle.h"
#include "starguard/cover.h"
#include "support.h"

enum { ROWS = 12, COLUMNS = 40 };

typedef struct instance {
    starg_cover_problem problem;
    starg_bits *bits;
    uint64_t weights[COLUMNS];
    uint32_t given[2];
} instance;

static void choose_target(fuzz_input *in, starg_cover_problem *problem) {
    uint64_t coverable = cover_oracle_coverable(problem);
    switch (fuzz_below(in, 4)) {
    case 0:
        problem->target = coverable - coverable / 10;
        break;
    case 1:
        problem->target = coverable / 256 * fuzz_byte(in);
        break;
    default:
        problem->target = UINT64_MAX;
    }
}

static void choose_instance(starg_context *context, fuzz_input *in, instance *out) {
    uint32_t rows = fuzz_below(in, ROWS + 1), columns = fuzz_below(in, COLUMNS + 1);
    starg_cover_problem_default(&out->problem);
    fuzz_require_ok(context, starg_bits_create(context, rows, columns, &out->bits),
                    "a matrix can be made");
    out->problem.rows = out->bits;
    out->problem.redundancy = 1 + fuzz_below(in, 3);
    out->problem.max_rows = fuzz_below(in, 3) == 0 ? 1 + fuzz_below(in, ROWS) : 0;
    if (fuzz_below(in, 3) == 0)
        out->problem.weights = out->weights;
    uint32_t shift = fuzz_below(in, 48);
    for (uint32_t j = 0; j < columns; j++)
        out->weights[j] = out->problem.weights == NULL ? 1 : (uint64_t)fuzz_byte(in) << shift;
    out->problem.given = out->given;
    out->problem.given_count = rows > 0 && fuzz_below(in, 4) == 0 ? 1 + fuzz_below(in, 2) : 0;
    for (size_t k = 0; k < out->problem.given_count; k++)
        out->given[k] = fuzz_below(in, rows);
    uint32_t byte = 0;
    for (uint32_t i = 0; i < rows * columns; i++) {
        byte = i % 8 == 0 ? fuzz_byte(in) : byte >> 1;
        if (byte & 1)
            starg_bits_set(out->bits, i / columns, i % columns);
    }
    choose_target(in, &out->problem);
}

static uint64_t smaller(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

/* What holds of every result. */
static void check_cover(const instance *own, const starg_cover *cover, const uint64_t *best,
                        uint64_t heaviest) {
    const starg_cover_problem *problem = &own->problem;
    size_t rows = starg_bits_rows(own->bits);
    uint64_t coverable = cover_oracle_coverable(problem);
    uint64_t goal = smaller(problem->target, coverable);
    size_t fewest = cover_oracle_fewest(best, rows, smaller(goal, cover->weight));
    fuzz_require(cover->count <= rows, "rows are used once");
    fuzz_require(problem->max_rows == 0 || cover->count <= problem->max_rows, "limits are kept");
    fuzz_require(cover->weight == cover_oracle_weight(problem, cover->rows, cover->count),
                 "the weight is that of the rows");
    fuzz_require(cover->weight <= heaviest && heaviest <= cover->weight_bound,
                 "the bound of the weight is one");
    fuzz_require(cover->target_reached == (cover->weight >= goal), "the target is reached or not");
    fuzz_require(problem->max_rows > 0 || cover->target_reached, "without a limit it is reached");
    fuzz_require(cover->lower_bound <= fewest && fewest <= cover->count, "the lower bound is one");
    fuzz_require(cover->optimal == (cover->count == cover->lower_bound), "optimal means that");
}

static void solve(starg_context *context, const instance *own, starg_cover_method method,
                  const uint64_t *best) {
    starg_cover_options options;
    starg_cover *cover = NULL;
    size_t rows = starg_bits_rows(own->bits), most = own->problem.max_rows;
    uint64_t heaviest = 0,
             goal = smaller(own->problem.target, cover_oracle_coverable(&own->problem));
    for (size_t c = 0; c <= rows && (most == 0 || c <= most); c++)
        heaviest = best[c] > heaviest ? best[c] : heaviest;
    starg_cover_options_default(&options);
    options.method = method;
    fuzz_require_ok(context, starg_cover_solve(context, &own->problem, &options, &cover),
                    "every problem can be solved");
    check_cover(own, cover, best, heaviest);
    if (method == STARG_COVER_ILP && heaviest >= goal)
        fuzz_require(cover->optimal, "small problems are solved");
    else if (method == STARG_COVER_ILP)
        fuzz_require(cover->weight == heaviest, "small problems are solved, the heaviest cover");
    starg_cover_free(cover);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    static const starg_cover_method methods[] = {STARG_COVER_GREEDY, STARG_COVER_ILP,
                                                 STARG_COVER_LP, STARG_COVER_LOCAL};
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    instance own = {0};
    uint64_t best[COVER_ORACLE_ROWS + 1];
    choose_instance(context, &in, &own);
    cover_oracle_best(&own.problem, best);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        solve(context, &own, methods[i], best);
    starg_bits_free(own.bits);
    fuzz_context_end(context);
    return 0;
}
