/* SPDX-License-Identifier: Apache-2.0 */
/* Finds odd sets of witnesses of which a fractional cover holds too little.
 *
 * Let the cover hold each witness once, or a little more: by an excess. Of a set T it holds enough
 * unless the shares of all rows that hold an odd number of T, with the excesses in T, sum to less
 * than 1; what is missing is the violation.
 *   1. All threes are looked at: their odd share follows from those of the pairs and of the three.
 *   2. The most violated ones grow by two witnesses at a time, while that lowers the sum.
 *   3. They are taken in the order of their violation, but no witness more than a few times.
 *
 * Only witnesses with a price and rows with a share matter. Cost: n^3 / 6 comparisons for n such
 * witnesses, some 10^6; for each set that grows the squares of n and of the rows' sizes. */
#include "guard/prices.h"

#include <math.h>
#include <stdlib.h>

static const char STAGE[] = "search";

enum { MOST_PRICED = 256, MOST_FOUND = 4096, MOST_GROWN = 48, MOST_USES = 4, MOST_TAKEN = 64 };

static const double LEAST_PRICE = 1e-4, LEAST_SHARE = 1e-4, LEAST_VIOLATION = 0.05;
static const double LEAST_GAIN = 1e-3;

typedef struct found_set {
    double violation;
    odd_set set; /* of numbers among the priced witnesses, while it is looked for */
} found_set;

typedef struct finding {
    const odd_sets_question *question;
    uint16_t priced[MOST_PRICED]; /* ascending */
    size_t n;
    uint16_t *held; /* the priced witnesses of each row with a share, one row after the other */
    size_t *start;  /* by such row, and the end */
    double *share, *sign;
    size_t rows;
    double *pair;               /* n x n: the shares of the rows that hold both */
    double excess[MOST_PRICED]; /* by priced witness */
    found_set *found;
    size_t found_count;
    uint64_t work;
} finding;

static void index_sets(odd_sets *sets) {
    uint16_t next[MOST_WITNESSES + 1];
    memset(sets->first, 0, sizeof sets->first);
    for (size_t k = 0; k < sets->count; k++)
        for (size_t i = 0; i < sets->set[k].count; i++)
            sets->first[sets->set[k].witness[i] + 1]++;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        sets->first[j + 1] = (uint16_t)(sets->first[j + 1] + sets->first[j]);
    memcpy(next, sets->first, sizeof next);
    for (size_t k = 0; k < sets->count; k++)
        for (size_t i = 0; i < sets->set[k].count; i++)
            sets->of[next[sets->set[k].witness[i]]++] = (uint16_t)k;
}

static void drop_worthless(odd_sets *sets, double *price) {
    size_t kept = 0;
    for (size_t k = 0; k < sets->count; k++)
        if (price[k] >= LEAST_PRICE) {
            sets->set[kept] = sets->set[k];
            price[kept++] = price[k];
        }
    sets->count = kept;
}

/* ---- the fractional cover ---- */

static int descending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Those with the highest prices. */
static void list_priced(finding *f) {
    const double *price = f->question->price;
    double sorted[MOST_WITNESSES];
    memcpy(sorted, price, sizeof sorted);
    qsort(sorted, MOST_WITNESSES, sizeof *sorted, descending);
    double least = fmax(sorted[MOST_PRICED], LEAST_PRICE);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        if (price[j] > least)
            f->priced[f->n++] = (uint16_t)j;
}

static starg_status list_rows(starg_context *context, finding *f) {
    const odd_sets_question *q = f->question;
    size_t filled = 0, most = 0;
    for (size_t i = 0; i < q->count; i++)
        most += q->share[i] >= LEAST_SHARE;
    NEW(context, STAGE, f->held, most * f->n);
    NEW(context, STAGE, f->start, most + 1);
    NEW(context, STAGE, f->share, most);
    NEW(context, STAGE, f->sign, most);
    for (size_t i = 0; i < q->count; i++) {
        if (q->share[i] < LEAST_SHARE)
            continue;
        f->share[f->rows] = q->share[i];
        f->start[f->rows++] = filled;
        for (size_t a = 0; a < f->n; a++)
            if (starg_bit_test(q->rows[i]->bits, f->priced[a]))
                f->held[filled++] = (uint16_t)a;
    }
    f->start[f->rows] = filled;
    return STARG_OK;
}

/* to[a, b] = the sum over rows that hold both; the diagonal: that hold a. */
static void sum_pairs(finding *f, const double *of, double *to) {
    memset(to, 0, f->n * f->n * sizeof *to);
    f->work += f->n * f->n;
    for (size_t i = 0; i < f->rows; i++) {
        size_t first = f->start[i], end = f->start[i + 1];
        for (size_t j = first; j < end; j++)
            for (size_t k = first; k < end; k++)
                to[f->held[j] * f->n + f->held[k]] += of[i];
        f->work += (end - first) * (end - first);
    }
}

/* ---- threes ---- */

static bool row_holds(const finding *f, size_t row, size_t a) {
    for (size_t k = f->start[row]; k < f->start[row + 1]; k++)
        if (f->held[k] == a)
            return true;
    return false;
}

/* third[c] = the shares of the rows that hold a, b and c. */
static void sum_threes(finding *f, size_t a, size_t b, double third[MOST_PRICED]) {
    memset(third, 0, f->n * sizeof *third);
    for (size_t i = 0; i < f->rows; i++)
        if (row_holds(f, i, a) && row_holds(f, i, b))
            for (size_t k = f->start[i]; k < f->start[i + 1]; k++)
                third[f->held[k]] += f->share[i];
    f->work += f->start[f->rows] / 4;
}

static void note_three(finding *f, size_t a, size_t b, size_t c, double violation) {
    if (violation < LEAST_VIOLATION || f->found_count == MOST_FOUND)
        return;
    f->found[f->found_count++] =
        (found_set){violation, {{(uint16_t)a, (uint16_t)b, (uint16_t)c}, 3}};
}

static void find_threes(finding *f) {
    double third[MOST_PRICED];
    size_t n = f->n;
    for (size_t a = 0; a < n; a++)
        for (size_t b = a + 1; b < n; b++) {
            double ab = f->pair[a * n + b];
            bool summed = false;
            for (size_t c = b + 1; c < n && ab >= LEAST_VIOLATION; c++) {
                double pairs = ab + f->pair[a * n + c] + f->pair[b * n + c];
                if (pairs < 1 + LEAST_VIOLATION / 2)
                    continue;
                if (!summed)
                    sum_threes(f, a, b, third);
                summed = true;
                double excess = f->excess[a] + f->excess[b] + f->excess[c];
                note_three(f, a, b, c, 2 * (pairs - 2 * third[c]) - 2 - 2 * excess);
            }
        }
    f->work += n * n * n / 6;
}

/* ---- larger sets ---- */

static bool is_in(const odd_set *set, size_t a) {
    for (size_t i = 0; i < set->count; i++)
        if (set->witness[i] == a)
            return true;
    return false;
}

/* The shares of rows, negative where they hold an odd number of the set: what two more witnesses
 * change. */
static void set_signs(finding *f, const odd_set *set) {
    for (size_t i = 0; i < f->rows; i++) {
        bool odd = false;
        for (size_t k = f->start[i]; k < f->start[i + 1]; k++)
            odd ^= is_in(set, f->held[k]);
        f->sign[i] = odd ? -f->share[i] : f->share[i];
    }
}

/* Adds the two witnesses that lower the sum of odd rows and excesses most. False: none do. */
static bool grow(finding *f, double *change, found_set *one) {
    size_t n = f->n, best_a = 0, best_b = 0;
    double best = -LEAST_GAIN;
    set_signs(f, &one->set);
    sum_pairs(f, f->sign, change);
    for (size_t a = 0; a < n; a++) {
        double alone = change[a * n + a] + f->excess[a];
        for (size_t b = a + 1; b < n && !is_in(&one->set, a); b++) {
            double both = alone + change[b * n + b] + f->excess[b] - 2 * change[a * n + b];
            if (both < best && !is_in(&one->set, b)) {
                best = both;
                best_a = a;
                best_b = b;
            }
        }
    }
    if (best_a == best_b)
        return false;
    one->violation -= best;
    one->set.witness[one->set.count++] = (uint16_t)best_a;
    one->set.witness[one->set.count++] = (uint16_t)best_b;
    return true;
}

static int by_violation(const void *a, const void *b) {
    const found_set *x = a, *y = b;
    if (x->violation != y->violation)
        return x->violation > y->violation ? -1 : 1;
    return memcmp(x->set.witness, y->set.witness, sizeof x->set.witness);
}

static starg_status grow_best(starg_context *context, finding *f) {
    SCOPED double *change = NULL;
    NEW(context, STAGE, change, f->n * f->n);
    for (size_t k = 0; k < f->found_count && k < MOST_GROWN; k++)
        while (f->found[k].set.count + 2 <= ODD_SET_SIZE && grow(f, change, &f->found[k]))
            continue;
    return STARG_OK;
}

/* ---- the choice ---- */

static int ascending(const void *a, const void *b) {
    return *(const uint16_t *)a - *(const uint16_t *)b;
}

/* From numbers among the priced witnesses to their own. */
static void name_witnesses(const finding *f, odd_set *set) {
    for (size_t i = 0; i < set->count; i++)
        set->witness[i] = f->priced[set->witness[i]];
    qsort(set->witness, set->count, sizeof *set->witness, ascending);
}

static bool is_known(const odd_sets *sets, const odd_set *one) {
    for (size_t k = 0; k < sets->count; k++)
        if (sets->set[k].count == one->count &&
            memcmp(sets->set[k].witness, one->witness, one->count * sizeof *one->witness) == 0)
            return true;
    return false;
}

static bool may_be_used(const uint8_t *uses, const odd_set *set) {
    for (size_t i = 0; i < set->count; i++)
        if (uses[set->witness[i]] >= MOST_USES)
            return false;
    return true;
}

static void take_sets(finding *f, odd_sets *sets, double *price, size_t *added) {
    uint8_t uses[MOST_WITNESSES] = {0};
    qsort(f->found, f->found_count, sizeof *f->found, by_violation);
    for (size_t k = 0; k < f->found_count && sets->count < MOST_ODD_SETS && *added < MOST_TAKEN;
         k++) {
        odd_set set = f->found[k].set;
        name_witnesses(f, &set);
        if (!may_be_used(uses, &set) || is_known(sets, &set))
            continue;
        for (size_t i = 0; i < set.count; i++)
            uses[set.witness[i]]++;
        price[sets->count] = 0;
        sets->set[sets->count++] = set;
        ++*added;
    }
}

starg_status odd_sets_renew(starg_context *context, const odd_sets_question *question,
                            odd_sets *sets, double price[MOST_ODD_SETS], size_t *added,
                            uint64_t *work) {
    starg_status status = STARG_OK;
    finding f = {.question = question};
    *added = 0;
    drop_worthless(sets, price);
    list_priced(&f);
    STARG_TRY(list_rows(context, &f));
    STARG_NEW(context, STAGE, f.pair, f.n * f.n);
    STARG_NEW(context, STAGE, f.found, MOST_FOUND);
    sum_pairs(&f, f.share, f.pair);
    for (size_t a = 0; a < f.n; a++)
        f.excess[a] = fmax(0, f.pair[a * f.n + a] - 1);
    find_threes(&f);
    qsort(f.found, f.found_count, sizeof *f.found, by_violation);
    STARG_TRY(grow_best(context, &f));
    take_sets(&f, sets, price, added);
    *work += f.work / 1000;
done:
    index_sets(sets);
    RELEASE(f.held, f.start, f.share, f.sign, f.pair, f.found);
    return status;
}
