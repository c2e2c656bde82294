/* SPDX-License-Identifier: Apache-2.0 */
/* Finds fewer guards of a result that are as good as all of them: this refutes a lower bound above
 * their number, since guards are candidates.
 *
 * As good: each column is in as many of their rows as redundancy requires, or in as many as with
 * all guards; or, with a partial goal, the columns seen often enough have that share of all columns
 * (what can be seen is no more than all). Guards are removed one by one while the rest stays good,
 * once those that see least first, once the last first (the result is then no more than the curve
 * says). The smaller number counts: an upper bound on the fewest, found without a search.
 *
 * Cost: the bits of all rows, twice. */
#include <math.h>
#include <stdlib.h>

#include "verify/facts.h"

static const char STAGE[] = "verify";

typedef struct removal {
    const verify_facts *known;
    const starg_bits *rows;
    const uint32_t *held; /* rows of each column, for all guards */
    uint32_t *count;      /* the same for the remaining ones */
    uint32_t *order;
    uint32_t *redundancy; /* by column */
    double goal, reached; /* weight; infinite goal: none */
} removal;

static double weight_of(const removal *own, size_t column) {
    return verify_targets_vertices(own->known) ? 1 : own->known->area[column];
}

static uint32_t needed_at(const removal *own, size_t column) {
    return own->held[column] < own->redundancy[column] ? own->held[column]
                                                       : own->redundancy[column];
}

/* Would the others be as good? */
static bool can_go(const removal *own, uint32_t guard) {
    const uint64_t *row = starg_bits_row(own->rows, guard);
    double lost = 0;
    bool same = true;
    for (size_t w = 0; w < own->rows->words; w++)
        STARG_FOR_BITS (bit, row[w]) {
            size_t column = 64 * w + bit;
            same = same && own->count[column] > needed_at(own, column);
            lost += own->count[column] == own->redundancy[column] ? weight_of(own, column) : 0;
        }
    return same || own->reached - lost >= own->goal;
}

static void remove_guard(removal *own, uint32_t guard) {
    const uint64_t *row = starg_bits_row(own->rows, guard);
    for (size_t w = 0; w < own->rows->words; w++)
        STARG_FOR_BITS (bit, row[w]) {
            size_t column = 64 * w + bit;
            if (own->count[column]-- == own->redundancy[column])
                own->reached -= weight_of(own, column);
        }
}

static size_t remove_guards(removal *own) {
    size_t left = own->known->guards->count;
    own->reached = 0;
    for (size_t j = 0; j < own->rows->columns; j++) {
        own->count[j] = own->held[j];
        own->reached += own->held[j] >= own->redundancy[j] ? weight_of(own, j) : 0;
    }
    for (size_t i = 0; i < own->known->guards->count; i++)
        if (!verify_is_kept(own->known->guards, own->order[i]) && can_go(own, own->order[i])) {
            remove_guard(own, own->order[i]);
            left--;
        }
    return left;
}

/* The weight that is enough whatever can be seen, with room for the rounding of areas and for the
 * solver's weights, which are integer multiples of 2^-40 of the total. */
static double find_goal(const verify_facts *known) {
    const starg_guard_options *options = &known->guards->options;
    if (!(options->coverage < 1))
        return INFINITY;
    if (verify_targets_vertices(known))
        return ceil(options->coverage * (double)known->surface->vertex_count);
    return known->total_area *
           (options->coverage * (1 + 1e-9) + 0x1p-39 * (double)verify_patch_count(known->surface));
}

static void order_guards(removal *own, bool by_sight) {
    size_t count = own->known->guards->count;
    for (uint32_t i = 0; i < count; i++)
        own->order[i] = (uint32_t)(count - 1 - i);
    for (size_t i = 1; by_sight && i < count; i++) { /* stable insertion sort */
        uint32_t guard = own->order[i];
        size_t at = i, seen = starg_bits_count(own->rows, guard);
        for (; at > 0 && starg_bits_count(own->rows, own->order[at - 1]) > seen; at--)
            own->order[at] = own->order[at - 1];
        own->order[at] = guard;
    }
}

starg_status verify_find_needed(const verify_facts *known, size_t *needed) {
    starg_status status = STARG_OK;
    starg_context *context = known->surface->context;
    uint32_t *held = NULL;
    removal own = {.known = known, .rows = verify_rows(known), .goal = find_goal(known)};
    *needed = known->guards->count;
    STARG_TRY(verify_count_held(known, own.rows, &held));
    own.held = held;
    STARG_NEW(context, STAGE, own.count, own.rows->columns);
    STARG_NEW(context, STAGE, own.redundancy, own.rows->columns);
    for (size_t j = 0; j < own.rows->columns; j++)
        own.redundancy[j] = verify_times(known, j);
    STARG_NEW(context, STAGE, own.order, known->guards->count);
    for (int by_sight = 0; by_sight < 2; by_sight++) {
        order_guards(&own, by_sight == 1);
        size_t left = remove_guards(&own);
        *needed = left < *needed ? left : *needed;
    }
done:
    RELEASE(held, own.count, own.redundancy, own.order);
    return status;
}
