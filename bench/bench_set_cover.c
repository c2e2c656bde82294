/* SPDX-License-Identifier: Apache-2.0 */
/* Set covers in the plain text of the public OCP/USCP benchmark, which `guard --matrix` writes too.
 *
 *     bench_set_cover make ELEMENTS SETS SMALLEST LARGEST SEED FILE
 *     bench_set_cover solve FILE SECONDS
 *
 * make writes caps of a sphere that cover SMALLEST to LARGEST of it, and random points of it as
 * elements, each of them in one cap at least. solve prints a line each for plain greedy, for the
 * cover of this library, and for CBC alone: method, sets, bound, seconds of the clock. One thread;
 * SECONDS limit each. */
#include <Cbc_C_Interface.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/context.h"
#include "core/rng.h"
#include "starguard/cover.h"

/* The sets of each element, and the elements of each set. */
typedef struct instance {
    size_t elements, sets, entries;
    int *start, *list;       /* by element */
    CoinBigIndex *set_start; /* by set     */
    int *set_list;
    double *ones;
} instance;

static void *need(void *block) {
    if (block != NULL)
        return block;
    fputs("bench_set_cover: out of memory\n", stderr);
    exit(EXIT_FAILURE);
}

/* ---- making ---- */

static void random_direction(starg_rng *rng, double v[3]) {
    double z = 2 * starg_rng_unit(rng) - 1, angle = 8 * atan(1) * starg_rng_unit(rng);
    double r = sqrt(1 - z * z);
    v[0] = r * cos(angle);
    v[1] = r * sin(angle);
    v[2] = z;
}

static int make(char **words) {
    size_t elements = strtoul(words[0], NULL, 10), sets = strtoul(words[1], NULL, 10);
    double smallest = strtod(words[2], NULL), largest = strtod(words[3], NULL);
    uint64_t seed = strtoul(words[4], NULL, 10);
    double *caps = need(malloc(4 * sets * sizeof *caps));
    size_t *held = need(malloc(sets * sizeof *held));
    FILE *out = fopen(words[5], "w");
    if (out == NULL)
        return EXIT_FAILURE;
    for (size_t i = 0; i < sets; i++) {
        starg_rng rng = starg_rng_make(seed, 1, i);
        random_direction(&rng, caps + 4 * i);
        caps[4 * i + 3] = 1 - 2 * (smallest + (largest - smallest) * starg_rng_unit(&rng));
    }
    fprintf(out, "%zu %zu\n", elements, sets);
    for (size_t e = 0, item = 0; e < elements; item++) {
        starg_rng rng = starg_rng_make(seed, 2, item);
        double v[3];
        size_t count = 0;
        random_direction(&rng, v);
        for (size_t i = 0; i < sets; i++)
            if (caps[4 * i] * v[0] + caps[4 * i + 1] * v[1] + caps[4 * i + 2] * v[2] >=
                caps[4 * i + 3])
                held[count++] = i;
        if (count == 0)
            continue;
        fprintf(out, "%zu %zu\n", e++, count);
        for (size_t i = 0; i < count; i++)
            fprintf(out, "%s%zu", i > 0 ? " " : "", held[i]);
        fputc('\n', out);
    }
    free(caps);
    free(held);
    return fclose(out) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* ---- reading ---- */

static size_t number(FILE *in) {
    size_t value;
    if (fscanf(in, "%zu", &value) == 1)
        return value;
    fputs("bench_set_cover: the file ends early, or is no set cover\n", stderr);
    exit(EXIT_FAILURE);
}

static instance read_instance(const char *name) {
    FILE *in = need(fopen(name, "r"));
    instance own = {.elements = number(in)};
    own.sets = number(in);
    size_t room = 1 << 20;
    own.start = need(calloc(own.elements + 1, sizeof *own.start));
    own.list = need(malloc(room * sizeof *own.list));
    own.set_start = need(calloc(own.sets + 2, sizeof *own.set_start));
    for (size_t e = 0; e < own.elements; e++) {
        (void)number(in);
        for (size_t count = number(in); count > 0; count--) {
            if (own.entries == room)
                own.list = need(realloc(own.list, (room *= 2) * sizeof *own.list));
            size_t set = number(in);
            if (set >= own.sets)
                exit(EXIT_FAILURE);
            own.list[own.entries++] = (int)set;
            own.set_start[set + 2]++;
        }
        own.start[e + 1] = (int)own.entries;
    }
    fclose(in);
    own.set_list = need(malloc((own.entries + 1) * sizeof *own.set_list));
    own.ones = need(malloc((own.entries + own.elements + own.sets + 1) * sizeof *own.ones));
    for (size_t i = 0; i < own.entries + own.elements + own.sets + 1; i++)
        own.ones[i] = 1;
    for (size_t i = 2; i < own.sets + 2; i++)
        own.set_start[i] += own.set_start[i - 1];
    for (size_t e = 0; e < own.elements; e++)
        for (int k = own.start[e]; k < own.start[e + 1]; k++)
            own.set_list[own.set_start[own.list[k] + 1]++] = (int)e;
    return own;
}

/* ---- solving ---- */

/* Whether the sets are a cover. */
static const char *check(const instance *in, const uint8_t *chosen) {
    for (size_t e = 0; e < in->elements; e++) {
        int k = in->start[e];
        while (k < in->start[e + 1] && !chosen[in->list[k]])
            k++;
        if (k == in->start[e + 1])
            return "not a cover";
    }
    return "cover";
}

/* The largest gain first, ties by number. */
static void greedy(const instance *in) {
    double start = starg_clock();
    size_t *gain = need(calloc(in->sets, sizeof *gain)), left = in->elements, count = 0;
    uint8_t *done = need(calloc(in->elements + 1, 1)), *chosen = need(calloc(in->sets + 1, 1));
    for (size_t i = 0; i < in->sets; i++)
        gain[i] = (size_t)(in->set_start[i + 1] - in->set_start[i]);
    while (left > 0) {
        size_t best = 0;
        for (size_t i = 1; i < in->sets; i++)
            best = gain[i] > gain[best] ? i : best;
        chosen[best] = 1;
        count++;
        for (CoinBigIndex k = in->set_start[best]; k < in->set_start[best + 1]; k++) {
            int e = in->set_list[k];
            for (int m = in->start[e]; !done[e] && m < in->start[e + 1]; m++)
                gain[in->list[m]]--;
            left -= !done[e];
            done[e] = 1;
        }
    }
    printf("greedy %zu 0 %.2f %s\n", count, starg_clock() - start, check(in, chosen));
    free(gain);
    free(done);
    free(chosen);
}

static void ours(const instance *in, double seconds) {
    starg_context *context;
    starg_bits *bits = NULL;
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover *cover = NULL;
    uint8_t *chosen = need(calloc(in->sets + 1, 1));
    starg_context_options used;
    starg_context_options_default(&used);
    used.threads = 1;
    if (starg_context_create(&used, &context) != STARG_OK)
        exit(EXIT_FAILURE);
    double start = starg_clock();
    starg_status status = starg_bits_create(context, in->sets, in->elements, &bits);
    for (size_t e = 0; status == STARG_OK && e < in->elements; e++)
        for (int k = in->start[e]; k < in->start[e + 1]; k++)
            starg_bits_set(bits, (size_t)in->list[k], e);
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = bits;
    starg_context_set_time_limit(context, seconds);
    if (status == STARG_OK)
        status = starg_cover_solve(context, &problem, &options, &cover);
    if (status != STARG_OK) {
        fprintf(stderr, "bench_set_cover: %s\n", starg_context_error(context)->message);
        exit(EXIT_FAILURE);
    }
    for (size_t i = 0; i < cover->count; i++)
        chosen[cover->rows[i]] = 1;
    printf("starguard %zu %zu %.2f %s\n", cover->count, cover->lower_bound, starg_clock() - start,
           check(in, chosen));
    free(chosen);
    starg_cover_free(cover);
    starg_bits_free(bits);
    starg_context_free(context);
}

static void cbc(const instance *in, double seconds) {
    double start = starg_clock(), *zeros = need(calloc(in->sets + 1, sizeof *zeros));
    double *most = need(malloc((in->elements + 1) * sizeof *most));
    char limit[32];
    Cbc_Model *model = Cbc_newModel();
    for (size_t e = 0; e < in->elements; e++)
        most[e] = INFINITY;
    Cbc_setLogLevel(model, 0);
    Cbc_setParameter(model, "log", "0");
    Cbc_setParameter(model, "timeMode", "elapsed");
    snprintf(limit, sizeof limit, "%g", seconds);
    Cbc_setParameter(model, "seconds", limit);
    Cbc_loadProblem(model, (int)in->sets, (int)in->elements, in->set_start, in->set_list, in->ones,
                    zeros, in->ones, in->ones, in->ones, most);
    for (size_t i = 0; i < in->sets; i++)
        Cbc_setInteger(model, (int)i);
    Cbc_solve(model);
    const double *solution = Cbc_bestSolution(model);
    uint8_t *chosen = need(calloc(in->sets + 1, 1));
    size_t count = 0;
    for (size_t i = 0; solution != NULL && i < in->sets; i++)
        count += chosen[i] = solution[i] > 0.5;
    double bound = ceil(Cbc_getBestPossibleObjValue(model) - 1e-6);
    printf("cbc %zu %.0f %.2f %s\n", count, bound > 0 && bound < 1e9 ? bound : 0,
           starg_clock() - start, solution == NULL ? "none" : check(in, chosen));
    Cbc_deleteModel(model);
    free(chosen);
    free(zeros);
    free(most);
}

static int solve(char **words) {
    instance in = read_instance(words[0]);
    double seconds = strtod(words[1], NULL);
    printf("size %zu %zu %zu\n", in.elements, in.sets, in.entries);
    fflush(stdout);
    greedy(&in);
    fflush(stdout);
    ours(&in, seconds);
    fflush(stdout);
    cbc(&in, seconds);
    free(in.start);
    free(in.list);
    free(in.set_start);
    free(in.set_list);
    free(in.ones);
    return EXIT_SUCCESS;
}

int main(int count, char **words) {
    if (count == 8 && strcmp(words[1], "make") == 0)
        return make(words + 2);
    if (count == 4 && strcmp(words[1], "solve") == 0)
        return solve(words + 2);
    fputs("bench_set_cover make ELEMENTS SETS SMALLEST LARGEST SEED FILE | solve FILE SECONDS\n",
          stderr);
    return EXIT_FAILURE;
}
