/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of witnesses: the linear program max sum w, sum of w over each row <= 1, w >= 0, and its
 * dual, the fractional cover min sum x, sum of x over the rows of each witness >= 1, x >= 0.
 *
 * Odd sets (guard/odd_sets.c) are further witnesses: a row holds as much of one as it holds halves,
 * divided by the halves that all rows together hold at least. So all coefficients are at most 1.
 *
 * A primal-dual interior-point method. It ends near the centre of the optimal prices, while the
 * simplex method ends at a vertex: prices spread over all faces that matter give better bounds in
 * the space between the known points. Both programs have known interior points to start from, and
 * all steps stay feasible, so the only task is to make the products of each variable with its slack
 * equal and small:
 *
 *     s = 1 - A'w,  t = A x - 1,  x s = mu,  w t = mu.
 *
 * Each step solves (A X S^-1 A' + T W^-1) dw = r by Cholesky factorization, with a predictor and a
 * corrector [Mehrotra 1992]. Witnesses that share rows get nearby numbers, so that the factor has a
 * small envelope. Cost of a step: the squares of the rows' sizes and of the envelope's row lengths;
 * about 15 steps. */
#include "guard/prices.h"

#include <math.h>

#include "core/compiler.h"
#include "core/parallel.h"

static const char STAGE[] = "search";

enum {
    MOST_STEPS = 60,
    FILL_ITEMS = 32,    /* parts in which the matrix is filled */
    FILL_LEAST = 50000, /* products; fewer take less long than to wake a thread */
    ABREAST = 4,        /* columns of the factor */
    WIDTH = 8           /* sums of each, for vector instructions */
};

static const double GAP = 1e-3; /* between the two objective values, where the iteration stops */

typedef struct program {
    starg_context *context;
    const witness_row *const *rows;
    const odd_sets *sets;         /* their columns stand behind those of the witnesses */
    size_t n, m;                  /* rows, wanted witnesses and sets */
    uint32_t *index;              /* columns of all rows, one row after the other, ascending */
    double *value;                /* what the row holds of the column */
    size_t *start;                /* by row, and the end */
    uint32_t *entry, *holder;     /* the same by column: entries, and the rows that hold them */
    size_t *column;               /* where a column begins there, and the end */
    size_t products;              /* of pairs of entries of a row, in all */
    double *x, *s, *dx, *ds, *rx; /* by row */
    double *w, *t, *dw, *dt, *rw; /* by witness */
    double *matrix;               /* m x m; only the lower half is used */
    size_t *first;                /* by matrix row: its first nonzero column */
    uint64_t work;
} program;

static void program_free(program *p) {
    RELEASE(p->index);
    RELEASE(p->value);
    RELEASE(p->start);
    RELEASE(p->entry);
    RELEASE(p->holder);
    RELEASE(p->column);
    RELEASE(p->x);
    RELEASE(p->w);
    RELEASE(p->matrix);
    RELEASE(p->first);
}

/* Half of the number, rounded up: what all rows of a cover sum to at least. */
static unsigned odd_set_need(const odd_set *set) {
    return (set->count + 1U) / 2;
}

/* Appends the columns of a row; returns their end. */
static size_t list_row(program *p, const uint32_t *number, const witness_row *wanted, size_t i,
                       size_t filled) {
    witness_row held = {{0}};
    uint8_t halves[MOST_ODD_SETS];
    size_t first_set = p->m - p->sets->count;
    for (size_t k = 0; k < WITNESS_WORDS; k++)
        STARG_FOR_BITS (bit, p->rows[i]->bits[k] & wanted->bits[k])
            starg_bit_set(held.bits, number[64 * k + bit]);
    for (size_t k = 0; k < WITNESS_WORDS; k++)
        STARG_FOR_BITS (bit, held.bits[k]) {
            p->index[filled] = (uint32_t)(64 * k + bit);
            p->value[filled++] = 1;
        }
    odd_sets_halves(p->sets, p->rows[i], halves);
    for (size_t k = 0; k < p->sets->count; k++)
        if (halves[k] > 0) {
            p->index[filled] = (uint32_t)(first_set + k);
            p->value[filled++] = (double)halves[k] / odd_set_need(&p->sets->set[k]);
        }
    return filled;
}

/* The entries of each column, in the order of the rows. */
static void list_by_column(program *p) {
    for (size_t e = 0; e < p->start[p->n]; e++)
        p->column[p->index[e] + 1]++;
    for (size_t f = 0; f < p->m; f++)
        p->column[f + 1] += p->column[f];
    for (size_t i = p->n;
         i-- > 0;) { /* from behind, so that starts are where they belong at last */
        const size_t count = p->start[i + 1] - p->start[i];
        p->products += count * count / 2;
        for (size_t e = p->start[i]; e < p->start[i + 1]; e++) {
            size_t at = --p->column[p->index[e] + 1];
            p->entry[at] = (uint32_t)e;
            p->holder[at] = (uint32_t)i;
        }
    }
    memmove(p->column, p->column + 1, p->m * sizeof *p->column);
    p->column[p->m] = p->start[p->n];
}

static void list_columns(program *p, const uint32_t *number, const witness_row *wanted) {
    size_t filled = 0;
    for (size_t i = 0; i < p->n; i++) {
        p->start[i] = filled;
        filled = list_row(p, number, wanted, i, filled);
    }
    p->start[p->n] = filled;
    list_by_column(p);
    for (size_t f = 0; f < p->m; f++)
        p->first[f] = f;
    for (size_t i = 0; i < p->n; i++) {
        size_t least = p->start[i] < p->start[i + 1] ? p->index[p->start[i]] : p->m;
        for (size_t e = p->start[i]; e < p->start[i + 1]; e++)
            p->first[p->index[e]] = least < p->first[p->index[e]] ? least : p->first[p->index[e]];
    }
}

/* ---- the order of the witnesses ---- */

typedef struct ordering {
    witness_row beside[MOST_WITNESSES]; /* by witness: those that share a row with it */
    uint32_t degree[MOST_WITNESSES];
    uint32_t queue[MOST_WITNESSES];
    witness_row left;
    size_t count; /* length of the queue */
} ordering;

static void find_beside(const program *p, const witness_row *wanted, ordering *o) {
    for (size_t i = 0; i < p->n; i++)
        for (size_t k = 0; k < WITNESS_WORDS; k++)
            STARG_FOR_BITS (bit, p->rows[i]->bits[k] & wanted->bits[k])
                for (size_t l = 0; l < WITNESS_WORDS; l++)
                    o->beside[64 * k + bit].bits[l] |= p->rows[i]->bits[l] & wanted->bits[l];
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        o->degree[j] = (uint32_t)starg_bit_count(o->beside[j].bits, WITNESS_WORDS);
}

/* Appends to the queue the remaining witness in `among` with the fewest neighbours. */
static bool take_least(ordering *o, const witness_row *among) {
    size_t best = MOST_WITNESSES;
    for (size_t k = 0; k < WITNESS_WORDS; k++)
        STARG_FOR_BITS (bit, among->bits[k] & o->left.bits[k])
            if (best == MOST_WITNESSES || o->degree[64 * k + bit] < o->degree[best])
                best = 64 * k + bit;
    if (best == MOST_WITNESSES)
        return false;
    starg_bit_clear(o->left.bits, best);
    o->queue[o->count++] = (uint32_t)best;
    return true;
}

/* Numbers the witnesses so that those that share rows are close to each other [Cuthill, McKee
 * 1969], which keeps the envelope small. */
static starg_status number_witnesses(starg_context *context, program *p, const witness_row *wanted,
                                     uint32_t *number) {
    SCOPED ordering *o = NULL;
    NEW_ZERO(context, STAGE, o, 1);
    o->left = *wanted;
    find_beside(p, wanted, o);
    for (size_t k = 0; k < o->count || take_least(o, wanted); k++)
        while (take_least(o, &o->beside[o->queue[k]]))
            continue;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        number[j] = UINT32_MAX;
    for (size_t k = 0; k < o->count; k++)
        number[o->queue[k]] = (uint32_t)(o->count - 1 - k);
    p->m = o->count + p->sets->count;
    return STARG_OK;
}

/* ---- steps ---- */

static size_t count_entries(const program *p, const witness_row *wanted) {
    uint8_t halves[MOST_ODD_SETS];
    size_t entries = 0;
    for (size_t i = 0; i < p->n; i++) {
        for (size_t k = 0; k < WITNESS_WORDS; k++)
            entries += starg_bits_in(p->rows[i]->bits[k] & wanted->bits[k]);
        odd_sets_halves(p->sets, p->rows[i], halves);
        for (size_t k = 0; k < p->sets->count; k++)
            entries += halves[k] > 0;
    }
    return entries;
}

static starg_status program_make(starg_context *context, program *p, const witness_row *wanted,
                                 const uint32_t *number) {
    size_t entries = count_entries(p, wanted);
    NEW(context, STAGE, p->index, entries);
    NEW(context, STAGE, p->value, entries);
    NEW(context, STAGE, p->start, p->n + 1);
    NEW(context, STAGE, p->entry, entries);
    NEW(context, STAGE, p->holder, entries);
    NEW_ZERO(context, STAGE, p->column, p->m + 1);
    NEW_ZERO(context, STAGE, p->x, 5 * p->n);
    NEW_ZERO(context, STAGE, p->w, 5 * p->m);
    NEW(context, STAGE, p->matrix, p->m * p->m);
    NEW(context, STAGE, p->first, p->m);
    p->s = p->x + p->n;
    p->dx = p->s + p->n;
    p->ds = p->dx + p->n;
    p->rx = p->ds + p->n;
    p->t = p->w + p->m;
    p->dw = p->t + p->m;
    p->dt = p->dw + p->m;
    p->rw = p->dt + p->m;
    list_columns(p, number, wanted);
    return STARG_OK;
}

/* out[f] = start[f] + the sum of `of` over the rows of f. */
static void sum_rows(const program *p, const double *of, double start, double *out) {
    for (size_t f = 0; f < p->m; f++)
        out[f] = start;
    for (size_t i = 0; i < p->n; i++)
        for (size_t e = p->start[i]; e < p->start[i + 1]; e++)
            out[p->index[e]] += p->value[e] * of[i];
}

static double sum_row(const program *p, size_t i, const double *of) {
    double sum = 0;
    for (size_t e = p->start[i]; e < p->start[i + 1]; e++)
        sum += p->value[e] * of[p->index[e]];
    return sum;
}

/* The least that all rows together hold of a column. */
static double least_held(const program *p) {
    double least = INFINITY;
    for (size_t f = 0; f < p->m; f++) {
        double held = 0;
        for (size_t k = p->column[f]; k < p->column[f + 1]; k++)
            held += p->value[p->entry[k]];
        least = fmin(least, held);
    }
    return least;
}

/* Covers every column twice, by equal shares of all rows; sets prices that keep each row's sum at
 * most one half. */
static void begin(program *p) {
    const double share = 2 / fmax(1, least_held(p));
    for (size_t f = 0; f < p->m; f++)
        p->w[f] = 0.5;
    for (size_t i = 0; i < p->n; i++)
        for (size_t e = p->start[i]; e < p->start[i + 1]; e++)
            p->w[p->index[e]] =
                fmin(p->w[p->index[e]], 0.5 / (double)(p->start[i + 1] - p->start[i]));
    for (size_t i = 0; i < p->n; i++) {
        p->x[i] = share;
        p->s[i] = 1 - sum_row(p, i, p->w);
    }
    sum_rows(p, p->x, -1, p->t);
}

static void fill_line(const program *p, size_t f) {
    double *line = p->matrix + f * p->m;
    memset(line, 0, (f + 1) * sizeof *line);
    for (size_t k = p->column[f]; k < p->column[f + 1]; k++) {
        const size_t i = p->holder[k], last = p->entry[k];
        const double d = p->value[last] * p->x[i] / p->s[i];
        for (size_t e = p->start[i]; e <= last; e++)
            line[p->index[e]] += d * p->value[e];
    }
    line[f] += p->t[f] / p->w[f];
}

/* Every so many lines, so that items take about as long. */
static starg_status fill_lines(starg_context *context, void *shared, void *scratch, size_t item) {
    const program *p = shared;
    (void)context;
    (void)scratch;
    for (size_t f = item; f < p->m; f += FILL_ITEMS)
        fill_line(p, f);
    return STARG_OK;
}

static starg_status fill_matrix(program *p) {
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = p->products > FILL_LEAST ? FILL_ITEMS : 0,
                                      .shared = p,
                                      .item = fill_lines,
                                      .silent = true};
    p->work += p->products;
    for (size_t f = 0; f < p->m; f++)
        p->work += (f - p->first[f]) * (f - p->first[f]) / 3;
    if (loop.count > 0)
        return starg_parallel_for(p->context, &loop);
    for (size_t f = 0; f < p->m; f++)
        fill_line(p, f);
    return STARG_OK;
}

/* The products of a row and ABREAST others, over columns from `from` to `to`. */
STARG_SEVERAL_VERSIONS
static void multiply_rows(const double *restrict row, const double *const others[ABREAST],
                          size_t from, size_t to, double out[ABREAST]) {
    double sums[ABREAST][WIDTH] = {{0}};
    size_t k = from;
    for (; k + WIDTH <= to; k += WIDTH)
        for (size_t q = 0; q < ABREAST; q++)
            for (size_t l = 0; l < WIDTH; l++)
                sums[q][l] += row[k + l] * others[q][k + l];
    for (size_t q = 0; q < ABREAST; q++) {
        out[q] = 0;
        for (size_t l = 0; l < WIDTH; l++)
            out[q] += sums[q][l];
        for (size_t n = k; n < to; n++)
            out[q] += row[n] * others[q][n];
    }
}

/* Overwrites the lower half by the Cholesky factor L, ABREAST columns of a row at a time. False:
 * rounding has made the matrix indefinite. */
static bool factor(program *p) {
    const size_t m = p->m;
    for (size_t i = 0; i < m; i++) {
        double *row = p->matrix + i * m;
        for (size_t j = p->first[i] / ABREAST * ABREAST; j <= i; j += ABREAST) {
            const size_t end = j + ABREAST <= i ? j + ABREAST : i + 1;
            const double *others[ABREAST];
            double sums[ABREAST];
            for (size_t q = 0; q < ABREAST; q++)
                others[q] = j + q < end ? p->matrix + (j + q) * m : row;
            multiply_rows(row, others, p->first[i], j, sums);
            for (size_t c = j; c < end; c++) {
                double left = row[c] - sums[c - j];
                for (size_t k = j; k < c; k++)
                    left -= row[k] * others[c - j][k];
                if (c < i)
                    row[c] = left / others[c - j][c];
                else if (!(left > 0))
                    return false;
                else
                    row[i] = sqrt(left);
            }
        }
    }
    return true;
}

static void solve(const program *p, double *v) {
    size_t m = p->m;
    for (size_t i = 0; i < m; i++) {
        for (size_t k = p->first[i]; k < i; k++)
            v[i] -= p->matrix[i * m + k] * v[k];
        v[i] /= p->matrix[i * m + i];
    }
    for (size_t i = m; i-- > 0;) {
        v[i] /= p->matrix[i * m + i];
        for (size_t k = p->first[i]; k < i; k++)
            v[k] -= p->matrix[i * m + k] * v[i];
    }
}

/* The step that changes x s by rx and w t by rw. */
static void find_step(program *p) {
    for (size_t i = 0; i < p->n; i++)
        p->dx[i] = p->rx[i] / p->s[i];
    sum_rows(p, p->dx, 0, p->dw);
    for (size_t f = 0; f < p->m; f++)
        p->dw[f] = p->rw[f] / p->w[f] - p->dw[f];
    solve(p, p->dw);
    for (size_t i = 0; i < p->n; i++) {
        p->ds[i] = -sum_row(p, i, p->dw);
        p->dx[i] = (p->rx[i] - p->x[i] * p->ds[i]) / p->s[i];
    }
    sum_rows(p, p->dx, 0, p->dt);
}

/* The largest a, at most 1, for which v + a dv stays positive. */
static double longest(const double *v, const double *dv, size_t count) {
    double a = 1;
    for (size_t k = 0; k < count; k++)
        if (v[k] + a * dv[k] < 0)
            a = -v[k] / dv[k];
    return a;
}

static void aim(program *p, double target, double corrected) {
    for (size_t i = 0; i < p->n; i++)
        p->rx[i] = target - p->x[i] * p->s[i] - corrected * p->dx[i] * p->ds[i];
    for (size_t f = 0; f < p->m; f++)
        p->rw[f] = target - p->w[f] * p->t[f] - corrected * p->dw[f] * p->dt[f];
}

static double gap_after(const program *p, double primal, double dual) {
    double gap = 0;
    for (size_t i = 0; i < p->n; i++)
        gap += (p->x[i] + primal * p->dx[i]) * (p->s[i] + dual * p->ds[i]);
    for (size_t f = 0; f < p->m; f++)
        gap += (p->w[f] + dual * p->dw[f]) * (p->t[f] + primal * p->dt[f]);
    return gap;
}

static void move(double *v, const double *dv, double a, size_t count) {
    for (size_t k = 0; k < count; k++)
        v[k] += a * dv[k];
}

static starg_status step(program *p, double gap, bool *made) {
    TRY(fill_matrix(p));
    *made = factor(p);
    if (!*made)
        return STARG_OK;
    aim(p, 0, 0);
    find_step(p);
    double primal = fmin(longest(p->x, p->dx, p->n), longest(p->t, p->dt, p->m));
    double dual = fmin(longest(p->s, p->ds, p->n), longest(p->w, p->dw, p->m));
    double ratio = gap_after(p, primal, dual) / gap;
    aim(p, ratio * ratio * ratio * gap / (double)(p->n + p->m), 1);
    find_step(p);
    primal = 0.98 * fmin(longest(p->x, p->dx, p->n), longest(p->t, p->dt, p->m));
    dual = 0.98 * fmin(longest(p->s, p->ds, p->n), longest(p->w, p->dw, p->m));
    move(p->x, p->dx, primal, p->n);
    move(p->t, p->dt, primal, p->m);
    move(p->s, p->ds, dual, p->n);
    move(p->w, p->dw, dual, p->m);
    return STARG_OK;
}

static starg_status run(program *p) {
    bool made = true;
    begin(p);
    for (size_t f = 0; f < p->m; f++)
        p->dw[f] = p->dt[f] = 0;
    for (int k = 0; k < MOST_STEPS && made; k++) {
        double gap = gap_after(p, 0, 0);
        if (gap < GAP)
            break;
        TRY(step(p, gap, &made));
    }
    return STARG_OK;
}

/* Rounding may leave a row's sum a little above 1. */
static void read_prices(const program *p, const uint32_t *number, witness_prices *out) {
    double most = 1;
    out->sum = 0;
    for (size_t i = 0; i < p->n; i++)
        most = fmax(most, sum_row(p, i, p->w));
    for (size_t j = 0; j < MOST_WITNESSES; j++) {
        out->price[j] = number[j] == UINT32_MAX ? 0 : p->w[number[j]] / most;
        out->sum += out->price[j];
    }
    for (size_t k = 0; k < p->sets->count; k++) {
        double price = p->w[p->m - p->sets->count + k] / most;
        out->odd[k] = price / odd_set_need(&p->sets->set[k]);
        out->sum += price;
    }
    memcpy(out->share, p->x, p->n * sizeof *p->x);
    out->work = p->work / 1000;
}

starg_status prices_find(starg_context *context, const witness_row *const *rows, size_t count,
                         const witness_row *wanted, const odd_sets *sets, witness_prices *out) {
    static const odd_sets NONE = {0};
    starg_status status = STARG_OK;
    program p = {.context = context, .rows = rows, .n = count, .sets = sets != NULL ? sets : &NONE};
    uint32_t number[MOST_WITNESSES];
    *out = (witness_prices){0};
    STARG_NEW(context, STAGE, out->share, count);
    STARG_TRY(number_witnesses(context, &p, wanted, number));
    STARG_TRY(program_make(context, &p, wanted, number));
    STARG_TRY(run(&p));
    read_prices(&p, number, out);
done:
    program_free(&p);
    if (status != STARG_OK)
        prices_free(out);
    return status;
}

void prices_free(witness_prices *prices) {
    RELEASE(prices->share);
    prices->share = NULL;
}
