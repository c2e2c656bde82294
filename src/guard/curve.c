/* SPDX-License-Identifier: Apache-2.0 */
/* How much of the area 1, 2, ... guards see, and the set cover that they come from.
 *
 * For each number up to that of the guards, the most weight that so many of the final candidates
 * see, as far as greedy choices and swaps find it, and an upper bound of it by a linear relaxation
 * (cover/weight_relax.c). The guards themselves are the choice for the last number. More
 * guards see no less, so that each number takes over what a smaller one found, and the bound of a
 * larger one. Guards that stay are not counted; what they see is in all values.
 *
 * Cost: a limited cover problem for each number. */
#include <math.h>

#include "core/file.h"
#include "core/json.h"
#include "guard/stages.h"

static const char STAGE[] = "curve";

static void describe(const guard_problem *problem, const guard_pool *pool,
                     starg_cover_problem *cover) {
    starg_cover_problem_default(cover);
    cover->rows = pool->rows;
    cover->redundancy = problem->options->redundancy;
    cover->needs = pool->solid->need;
    cover->weights = problem->weights.weights;
}

static starg_status solve(const guard_problem *problem, const starg_cover_problem *cover,
                          uint64_t *weight, uint64_t *bound) {
    starg_cover *found = NULL;
    starg_cover_options options;
    starg_cover_options_default(&options);
    options.method = STARG_COVER_GREEDY;
    TRY(starg_cover_solve(problem->context, cover, &options, &found));
    *weight = found->weight;
    *bound = found->weight_bound;
    starg_cover_free(found);
    return STARG_OK;
}

/* The most weight that `most` candidates see, as far as it is found, and its upper bound. */
static starg_status solve_number(const guard_problem *problem, const guard_pool *pool, size_t most,
                                 uint64_t *weight, uint64_t *bound) {
    starg_cover_problem cover;
    describe(problem, pool, &cover);
    cover.max_rows = most;
    return solve(problem, &cover, weight, bound);
}

/* The weight that all the guards see. */
static starg_status weigh_guards(const guard_problem *problem, const guard_outcome *outcome,
                                 uint64_t *weight) {
    starg_cover_problem cover;
    uint64_t bound;
    describe(problem, &outcome->pool, &cover);
    cover.given = outcome->selection.chosen.data;
    cover.given_count = outcome->selection.chosen.count;
    cover.target = 0;
    return solve(problem, &cover, weight, &bound);
}

starg_status curve_find(const guard_problem *problem, guard_outcome *outcome) {
    const guard_pool *pool = &outcome->pool;
    size_t count = outcome->selection.chosen.count;
    double kept = (double)problem->weights.kept, all = kept + (double)problem->weights.total;
    if (!problem->options->worth || count == 0)
        return STARG_OK;
    NEW_ZERO(problem->context, STAGE, outcome->worth.seen, count);
    NEW_ZERO(problem->context, STAGE, outcome->worth.bound, count);
    uint64_t seen = 0, last;
    TRY(weigh_guards(problem, outcome, &last));
    for (size_t k = 0; k < count; k++) {
        uint64_t weight, bound;
        TRY(solve_number(problem, pool, k + 1, &weight, &bound));
        if (k == count - 1 && last > weight)
            weight = last;
        if (weight > seen)
            seen = weight;
        outcome->worth.seen[k] = (kept + (double)seen) / all;
        outcome->worth.bound[k] = (kept + (double)bound) / all;
    }
    for (size_t k = count - 1; k > 0; k--)
        outcome->worth.bound[k - 1] = fmin(outcome->worth.bound[k - 1], outcome->worth.bound[k]);
    outcome->worth.count = count;
    return STARG_OK;
}

/* ---- files ---- */

static bool put_csv(FILE *stream, const void *what, const char *unused) {
    const starg_guards *g = what;
    (void)unused;
    fputs("guards,coverage,bound\n", stream);
    for (size_t k = 0; k < g->worth_count; k++)
        fprintf(stream, "%zu,%.17g,%.17g\n", k + 1, g->worth_seen[k], g->worth_bound[k]);
    return true;
}

/* Two lines of steps above an axis of numbers. */
static void put_line(FILE *stream, const double *values, size_t count, const char *style) {
    fputs("<polyline fill=\"none\" ", stream);
    fprintf(stream, "%s points=\"", style);
    for (size_t k = 0; k < count; k++)
        fprintf(stream, "%s%.2f,%.2f", k > 0 ? " " : "",
                60 + 520 * (count > 1 ? (double)k / (double)(count - 1) : 0.5),
                340 - 300 * values[k]);
    fputs("\"/>\n", stream);
}

static bool put_svg(FILE *stream, const void *what, const char *unused) {
    const starg_guards *g = what;
    size_t count = g->worth_count, step = count / 20 + 1;
    (void)unused;
    fputs("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 400\" "
          "font-family=\"sans-serif\" font-size=\"12\">\n"
          "<rect width=\"640\" height=\"400\" fill=\"#fff\"/>\n",
          stream);
    for (int i = 0; i <= 5; i++)
        fprintf(stream,
                "<line x1=\"60\" x2=\"580\" y1=\"%d\" y2=\"%d\" stroke=\"#ddd\"/>"
                "<text x=\"52\" y=\"%d\" text-anchor=\"end\">%d %%</text>\n",
                340 - 60 * i, 340 - 60 * i, 344 - 60 * i, 20 * i);
    for (size_t k = 0; k < count; k += step)
        fprintf(stream, "<text x=\"%.2f\" y=\"360\" text-anchor=\"middle\">%zu</text>\n",
                60 + 520 * (count > 1 ? (double)k / (double)(count - 1) : 0.5), k + 1);
    put_line(stream, g->worth_bound, count, "stroke=\"#999\" stroke-dasharray=\"5 4\"");
    put_line(stream, g->worth_seen, count, "stroke=\"#0072b2\" stroke-width=\"2\"");
    fputs("<text x=\"320\" y=\"385\" text-anchor=\"middle\">number of guards</text>\n"
          "<text x=\"60\" y=\"24\" fill=\"#0072b2\">area seen</text>\n"
          "<text x=\"140\" y=\"24\" fill=\"#777\">at most possible (dashed)</text>\n</svg>\n",
          stream);
    return true;
}

starg_status starg_guards_write_curve(starg_context *context, const starg_guards *guards, bool svg,
                                      const char *path) {
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_c_locale_enter(context, &locale));
    return starg_json_write(context, STAGE, path, svg ? put_svg : put_csv, guards, NULL);
}

/* Elements that some set holds, each with its sets. */
static bool put_matrix(FILE *stream, const void *what, const char *unused) {
    const starg_bits *rows = ((const starg_guards *)what)->rows;
    size_t elements = 0, sets = rows != NULL ? rows->rows : 0,
           columns = rows != NULL ? rows->columns : 0;
    (void)unused;
    for (int pass = 0; pass < 2; pass++) {
        size_t id = 0;
        for (size_t j = 0; j < columns; j++) {
            size_t count = 0;
            for (size_t i = 0; i < sets; i++)
                count += starg_bits_test(rows, i, j);
            elements += pass == 0 && count > 0;
            if (pass == 0 || count == 0)
                continue;
            fprintf(stream, "%zu %zu\n", id++, count);
            for (size_t i = 0, put = 0; i < sets; i++)
                if (starg_bits_test(rows, i, j))
                    fprintf(stream, "%s%zu", put++ > 0 ? " " : "", i);
            fputc('\n', stream);
        }
        if (pass == 0)
            fprintf(stream, "%zu %zu\n", elements, sets);
    }
    return true;
}

starg_status starg_guards_write_matrix(starg_context *context, const starg_guards *guards,
                                       const char *path) {
    return starg_json_write(context, STAGE, path, put_matrix, guards, NULL);
}
