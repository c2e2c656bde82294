/* SPDX-License-Identifier: Apache-2.0 */
/* The bound of a search, in integers: however floating point found the prices, this sum and this
 * maximum are exact. No row is worth more than 1, so that no price is; any below BOUND_HIGHEST is
 * used as it is, and so low no sum overflows. */
#include "guard/prices.h"

static const char STAGE[] = "search";

_Static_assert((uint64_t)MOST_WITNESSES *BOUND_MOST_TIMES +
                       (uint64_t)MOST_ODD_SETS * ((BOUND_MOST_TIMES * ODD_SET_SIZE + 1) / 2) <=
                   UINT64_MAX / (BOUND_HIGHEST * BOUND_ONE),
               "sums of prices fit into 64 bits");

static uint64_t round_down(double price) {
    return price > 0 && price < BOUND_HIGHEST ? (uint64_t)(price * (double)BOUND_ONE) : 0;
}

void bound_round(const witness_prices *prices, const odd_sets *sets, whole_prices *whole) {
    memset(whole, 0, sizeof *whole);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        whole->price[j] = round_down(prices->price[j]);
    if (sets == NULL)
        return;
    whole->sets = *sets;
    for (size_t k = 0; k < sets->count; k++)
        whole->odd[k] = round_down(prices->odd[k]);
}

uint64_t bound_worth(const whole_prices *whole, const witness_row *row) {
    uint8_t halves[MOST_ODD_SETS];
    uint64_t sum = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            sum += whole->price[64 * w + bit];
    odd_sets_halves(&whole->sets, row, halves);
    for (size_t k = 0; k < whole->sets.count; k++)
        sum += halves[k] * whole->odd[k];
    return sum;
}

uint64_t bound_worth_of_all(const whole_prices *whole, size_t times) {
    uint64_t sum = 0;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        sum += times * whole->price[j];
    for (size_t k = 0; k < whole->sets.count; k++)
        sum += (times * whole->sets.set[k].count + 1) / 2 * whole->odd[k];
    return sum;
}

static uint64_t worth_most(const witness_row *const *rows, size_t count,
                           const whole_prices *whole) {
    uint64_t most = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t worth = bound_worth(whole, rows[i]);
        most = worth > most ? worth : most;
    }
    return most;
}

size_t bound_of_prices(const witness_row *const *rows, size_t count, const whole_prices *whole,
                       size_t times) {
    uint64_t all = bound_worth_of_all(whole, times), most = worth_most(rows, count, whole);
    return most == 0 ? 0 : (size_t)(all / most + (all % most != 0));
}

/* ---- branching ---- */

typedef struct branching {
    starg_context *context;
    const witness_row *const *rows;
    size_t count;
    uint8_t *gone;         /* by row: an earlier branch covers all solutions with this row */
    size_t nodes;          /* nodes left in the budget */
    branch_record *record; /* or NULL */
    uint64_t work;
} branching;

void branch_record_free(branch_record *record) {
    RELEASE(record->nodes.data);
    RELEASE(record->numbers.data);
    *record = (branch_record){0};
}

static starg_status record_prices(const branching *b, const uint64_t *price) {
    branch_record *record = b->record;
    if (record == NULL)
        return STARG_OK;
    branch_node node = {UINT32_MAX, record->numbers.count, 0};
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        if (price[j] > 0) {
            PUSH(b->context, STAGE, &record->numbers, j);
            PUSH(b->context, STAGE, &record->numbers, price[j]);
        }
    node.count = record->numbers.count - node.first;
    PUSH(b->context, STAGE, &record->nodes, node);
    return STARG_OK;
}

/* The rows still available, restricted to the wanted witnesses, without rows that another
 * contains. */
typedef struct rest {
    witness_row *cut;
    const witness_row **rows; /* `cut`, one by one */
    uint32_t *names;
    size_t count;
} rest;

static bool is_kept(rest *r, const witness_row *cut, size_t *hint) {
    if (*hint < r->count && row_is_within(cut, &r->cut[*hint]))
        return true;
    for (size_t k = 0; k < r->count; k++)
        if (row_is_within(cut, &r->cut[k])) {
            *hint = k;
            return true;
        }
    return false;
}

static size_t row_count(const witness_row *row) {
    return starg_bit_count(row->bits, WITNESS_WORDS);
}

static witness_row cut_row(const witness_row *row, const witness_row *wanted) {
    witness_row cut;
    for (int w = 0; w < WITNESS_WORDS; w++)
        cut.bits[w] = row->bits[w] & wanted->bits[w];
    return cut;
}

static void rest_free(rest *r) {
    RELEASE(r->cut);
    RELEASE(r->rows);
    RELEASE(r->names);
}

/* Large rows come first, so that no row is contained in a later one. */
static starg_status rest_make(const branching *b, const witness_row *wanted, rest *r) {
    size_t by_size[MOST_WITNESSES + 2] = {0}, hint = 0;
    SCOPED uint32_t *order = NULL;
    NEW(b->context, STAGE, order, b->count);
    NEW(b->context, STAGE, r->cut, b->count);
    NEW(b->context, STAGE, r->rows, b->count);
    NEW(b->context, STAGE, r->names, b->count);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < b->count; i++) {
            witness_row cut = cut_row(b->rows[i], wanted);
            size_t size = MOST_WITNESSES - row_count(&cut);
            if (pass == 0)
                by_size[size + 1]++;
            else
                order[by_size[size]++] = (uint32_t)i;
        }
        for (size_t k = 1; pass == 0 && k < MOST_WITNESSES + 2; k++)
            by_size[k] += by_size[k - 1];
    }
    for (size_t i = 0; i < b->count; i++) {
        witness_row cut = cut_row(b->rows[order[i]], wanted);
        if (b->gone[order[i]] || is_kept(r, &cut, &hint))
            continue;
        r->cut[r->count] = cut;
        r->rows[r->count] = &r->cut[r->count];
        r->names[r->count++] = order[i];
    }
    return STARG_OK;
}

/* The wanted witness in the fewest rows; *fewest: the number of those rows. */
static size_t rarest(const rest *r, const witness_row *wanted, size_t *fewest) {
    size_t best = MOST_WITNESSES, held[MOST_WITNESSES] = {0};
    for (size_t i = 0; i < r->count; i++)
        for (size_t w = 0; w < WITNESS_WORDS; w++)
            STARG_FOR_BITS (bit, r->cut[i].bits[w])
                held[64 * w + bit]++;
    *fewest = SIZE_MAX;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        if (starg_bit_test(wanted->bits, j) && held[j] < *fewest) {
            *fewest = held[j];
            best = j;
        }
    return best;
}

static starg_status record_rows(const branching *b, const rest *r, size_t witness) {
    branch_record *record = b->record;
    if (record == NULL)
        return STARG_OK;
    branch_node node = {(uint32_t)witness, record->numbers.count, 0};
    for (size_t i = 0; i < r->count; i++)
        if (starg_bit_test(r->cut[i].bits, witness))
            PUSH(b->context, STAGE, &record->numbers, r->names[i]);
    node.count = record->numbers.count - node.first;
    PUSH(b->context, STAGE, &record->nodes, node);
    return STARG_OK;
}

static starg_status bound_by_own_prices(branching *b, const rest *r, const witness_row *wanted,
                                        size_t most, bool *proven) {
    witness_prices prices;
    whole_prices whole;
    TRY(prices_find(b->context, r->rows, r->count, wanted, NULL, &prices));
    b->work += prices.work;
    bound_round(&prices, NULL, &whole);
    prices_free(&prices);
    *proven = bound_worth_of_all(&whole, 1) > most * worth_most(r->rows, r->count, &whole);
    if (*proven)
        TRY(record_prices(b, whole.price));
    return STARG_OK;
}

static starg_status branch(branching *b, const witness_row *wanted, size_t most, bool *proven);

/* One branch for each row with the witness; rows of earlier branches are excluded. */
static starg_status branch_on(branching *b, const rest *r, size_t witness,
                              const witness_row *wanted, size_t most, bool *proven) {
    starg_status status = STARG_OK;
    size_t ended = 0;
    *proven = true;
    STARG_TRY(record_rows(b, r, witness));
    for (size_t i = 0; i < r->count && *proven; i++) {
        witness_row left = *wanted;
        if (!starg_bit_test(r->cut[i].bits, witness))
            continue;
        for (int w = 0; w < WITNESS_WORDS; w++)
            left.bits[w] &= ~r->cut[i].bits[w];
        STARG_TRY(branch(b, &left, most - 1, proven));
        b->gone[r->names[i]] = 1;
        ended = i + 1;
    }
done:
    for (size_t i = 0; i < ended; i++)
        if (starg_bit_test(r->cut[i].bits, witness))
            b->gone[r->names[i]] = 0;
    return status;
}

static starg_status branch(branching *b, const witness_row *wanted, size_t most, bool *proven) {
    SCOPED_BY(rest_free) rest r = {0};
    size_t fewest;
    bool any = row_count(wanted) > 0;
    *proven = any && most == 0;
    if (*proven || !any || b->nodes == 0)
        return STARG_OK;
    b->nodes--;
    TRY(starg_check_cancel(b->context, STAGE));
    TRY(rest_make(b, wanted, &r));
    b->work += b->count / 10 + r.count * r.count / 100;
    size_t witness = rarest(&r, wanted, &fewest);
    if (fewest > 0)
        TRY(bound_by_own_prices(b, &r, wanted, most, proven));
    if (!*proven)
        TRY(branch_on(b, &r, witness, wanted, most, proven));
    return STARG_OK;
}

starg_status bound_by_branching(starg_context *context, const branch_question *question,
                                bool *proven, branch_record *record, uint64_t *work) {
    SCOPED uint8_t *gone = NULL;
    NEW_ZERO(context, STAGE, gone, question->count);
    branching b = {.context = context,
                   .rows = question->rows,
                   .count = question->count,
                   .nodes = question->nodes,
                   .gone = gone,
                   .record = record};
    *proven = false;
    starg_status status = branch(&b, question->wanted, question->most, proven);
    *work += b.work;
    return status;
}
