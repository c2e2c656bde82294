/* The bound of a search, in whole numbers: whatever floating point has found the prices, this sum
 * and this maximum are exact. Prices are below 2^44 and witnesses at most 2^10, so that sums stay
 * below 2^54. */
#include "guard/bound.h"

void bound_round(const double price[MOST_WITNESSES], uint64_t whole[MOST_WITNESSES]) {
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        whole[j] = price[j] > 0 && price[j] < 16 ? (uint64_t)(price[j] * (double)BOUND_ONE) : 0;
}

static uint64_t sum_of(const witness_row *row, const uint64_t *price) {
    uint64_t sum = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            sum += price[64 * w + bit];
    return sum;
}

size_t bound_of_prices(const witness_row *const *rows, size_t count,
                       const uint64_t price[MOST_WITNESSES]) {
    uint64_t all = 0, most = 0;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        all += price[j];
    for (size_t i = 0; i < count; i++) {
        uint64_t sum = sum_of(rows[i], price);
        most = sum > most ? sum : most;
    }
    return most == 0 ? 0 : (size_t)((all + most - 1) / most);
}
