/* SPDX-License-Identifier: Apache-2.0 */
/* Baselines: two guards must see each face, at least a given angle apart as seen from its centroid,
 * because depth is measured from two directions.
 *
 * Input: guards that see every face as often as the redundancy requires, at least twice. A face is
 * paired if two guards that see it are that far apart. Stages:
 *   1. While unpaired faces remain, the candidate that pairs the most of them with existing guards
 *      is added. If no single candidate pairs any, two candidates that pair the first such face are
 *      added; a face that no two candidates pair is given up.
 *   2. Guards that neither redundancy nor a pair needs are removed, starting with those that see
 *      least. Both guards of a pair see the face, so the bound for redundancy stays valid. At most
 *      MOST_FACES unpaired faces are considered per round, to keep rounds fast; rounds repeat until
 *      none is left. Signs of angles are exact (compare_parallax).
 *
 * Cost: a round visits every candidate and guard of MOST_FACES faces. */
#include "guard/stages.h"

#include <stdlib.h>

#include "geometry/predicates.h"

static const char STAGE[] = "baseline";

enum { MOST_FACES = 2000 };

typedef struct pairing {
    const guard_problem *problem;
    const guard_pool *pool;
    guard_selection *selection;
    double cosine;
    STARG_ARRAY(uint32_t) lacking; /* unpaired faces, ascending */
    uint32_t *gain;                /* by candidate */
    uint8_t *chosen;               /* by candidate: is it a guard? */
} pairing;

bool baseline_holds(const starg_solid *solid, size_t patch, double cosine, const double p[3],
                    const double q[3]) {
    return compare_parallax(solid_patch_corner(solid, patch, 0),
                            solid_patch_corner(solid, patch, 1),
                            solid_patch_corner(solid, patch, 2), p, q, cosine) <= 0;
}

static bool pairs(const pairing *own, size_t face, uint32_t a, uint32_t b) {
    return baseline_holds(own->pool->solid, face, own->cosine, pool_point(own->pool, a),
                          pool_point(own->pool, b));
}

static bool sees(const pairing *own, uint32_t candidate, size_t face) {
    return starg_bits_test(own->pool->rows, candidate, face);
}

/* Does the candidate pair the face with a guard other than `without`? */
static bool pairs_with_guards(const pairing *own, size_t face, uint32_t candidate,
                              uint32_t without) {
    for (size_t i = 0; i < own->selection->chosen.count; i++) {
        uint32_t guard = own->selection->chosen.data[i];
        if (guard != without && sees(own, guard, face) && pairs(own, face, candidate, guard))
            return true;
    }
    return false;
}

static bool is_paired(const pairing *own, size_t face, uint32_t without) {
    for (size_t i = 0; i < own->selection->chosen.count; i++) {
        uint32_t guard = own->selection->chosen.data[i];
        if (guard != without && sees(own, guard, face) &&
            pairs_with_guards(own, face, guard, without))
            return true;
    }
    return false;
}

/* ---- adding guards ---- */

static starg_status list_lacking(pairing *own) {
    for (size_t f = 0; f < own->pool->columns; f++)
        if (starg_bit_test(own->pool->coverable, f) && !is_paired(own, f, UINT32_MAX))
            PUSH(own->problem->context, STAGE, &own->lacking, (uint32_t)f);
    return STARG_OK;
}

static starg_status join(pairing *own, uint32_t candidate) {
    starg_context *context = own->problem->context;
    PUSH(context, STAGE, &own->selection->chosen, candidate);
    PUSH(context, STAGE, &own->selection->levels, own->selection->level);
    own->chosen[candidate] = 1;
    return STARG_OK;
}

static size_t step_of(const pairing *own) {
    return (own->lacking.count + MOST_FACES - 1) / MOST_FACES;
}

/* The candidate that pairs the most faces, or UINT32_MAX. */
static uint32_t find_best(pairing *own) {
    uint32_t best = UINT32_MAX;
    memset(own->gain, 0, pool_count(own->pool) * sizeof *own->gain);
    for (size_t i = 0; i < own->lacking.count; i += step_of(own))
        for (uint32_t c = 0; c < pool_count(own->pool); c++)
            if (!own->chosen[c] && sees(own, c, own->lacking.data[i]))
                own->gain[c] += pairs_with_guards(own, own->lacking.data[i], c, UINT32_MAX);
    for (uint32_t c = 0; c < pool_count(own->pool); c++)
        if (own->gain[c] > (best == UINT32_MAX ? 0 : own->gain[best]))
            best = c;
    return best;
}

/* The first two candidates that pair the face. */
static bool find_pair(const pairing *own, size_t face, uint32_t pair[2]) {
    size_t count = pool_count(own->pool);
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = a + 1; sees(own, a, face) && b < count; b++)
            if (sees(own, b, face) && pairs(own, face, a, b)) {
                pair[0] = a;
                pair[1] = b;
                return true;
            }
    return false;
}

/* Adds two candidates for the first face that some two pair; gives up the faces before it. */
static starg_status join_pair(pairing *own) {
    uint32_t pair[2];
    size_t given_up = 0;
    bool found = false;
    while (given_up < own->lacking.count && !found) {
        TRY(starg_check_cancel(own->problem->context, STAGE));
        found = find_pair(own, own->lacking.data[given_up++], pair);
    }
    own->lacking.count -= given_up;
    memmove(own->lacking.data, own->lacking.data + given_up,
            own->lacking.count * sizeof *own->lacking.data);
    for (int i = 0; found && i < 2; i++)
        if (!own->chosen[pair[i]])
            TRY(join(own, pair[i]));
    return STARG_OK;
}

static void drop_paired(pairing *own) {
    size_t kept = 0;
    for (size_t i = 0; i < own->lacking.count; i++)
        if (!is_paired(own, own->lacking.data[i], UINT32_MAX))
            own->lacking.data[kept++] = own->lacking.data[i];
    own->lacking.count = kept;
}

static starg_status add(pairing *own) {
    TRY(list_lacking(own));
    while (own->lacking.count > 0) {
        TRY(starg_check_cancel(own->problem->context, STAGE));
        uint32_t best = find_best(own);
        if (best != UINT32_MAX)
            TRY(join(own, best));
        else
            TRY(join_pair(own));
        drop_paired(own);
    }
    return STARG_OK;
}

/* ---- removing guards ---- */

/* Do the other guards see each of its faces often enough, and pair those that are paired now? */
static bool can_leave(const pairing *own, uint32_t guard, const uint32_t *held,
                      const uint32_t *available) {
    const uint64_t *row = starg_bits_row(own->pool->rows, guard);
    uint32_t redundancy = own->problem->options->redundancy;
    for (size_t w = 0; w < own->pool->rows->words; w++)
        STARG_FOR_BITS (bit, row[w]) {
            size_t face = 64 * w + bit;
            uint32_t need = available[face] < redundancy ? available[face] : redundancy;
            if (held[face] <= need ||
                (is_paired(own, face, UINT32_MAX) && !is_paired(own, face, guard)))
                return false;
        }
    return true;
}

static void count_rows(const starg_bits *rows, uint32_t candidate, uint32_t by, uint32_t *counts) {
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, candidate)[w])
            counts[64 * w + bit] += by;
}

static void leave(guard_selection *selection, size_t at) {
    for (size_t i = at + 1; i < selection->chosen.count; i++) {
        selection->chosen.data[i - 1] = selection->chosen.data[i];
        selection->levels.data[i - 1] = selection->levels.data[i];
    }
    selection->chosen.count--;
    selection->levels.count--;
}

/* Positions in the selection, by how much the guard sees, ascending. */
static void order_by_sight(const pairing *own, uint32_t *order) {
    const guard_selection *s = own->selection;
    for (uint32_t i = 0; i < s->chosen.count; i++) {
        size_t at = i, seen = starg_bits_count(own->pool->rows, s->chosen.data[i]);
        for (; at > 0 && starg_bits_count(own->pool->rows, order[at - 1]) > seen; at--)
            order[at] = order[at - 1];
        order[at] = s->chosen.data[i];
    }
}

static starg_status remove_needless(pairing *own) {
    starg_context *context = own->problem->context;
    SCOPED uint32_t *held = NULL, *available = NULL, *order = NULL;
    size_t count = own->selection->chosen.count;
    NEW_ZERO(context, STAGE, held, own->pool->columns);
    NEW_ZERO(context, STAGE, available, own->pool->columns);
    NEW(context, STAGE, order, count);
    for (uint32_t c = 0; c < pool_count(own->pool); c++)
        count_rows(own->pool->rows, c, 1, available);
    for (size_t i = 0; i < count; i++)
        count_rows(own->pool->rows, own->selection->chosen.data[i], 1, held);
    order_by_sight(own, order);
    for (size_t i = 0; i < count; i++) {
        TRY(starg_check_cancel(context, STAGE));
        if (!can_leave(own, order[i], held, available))
            continue;
        count_rows(own->pool->rows, order[i], UINT32_MAX, held); /* one less */
        for (size_t k = 0; k < own->selection->chosen.count; k++)
            if (own->selection->chosen.data[k] == order[i])
                leave(own->selection, k);
    }
    return STARG_OK;
}

/* ---- the call ---- */

starg_status baseline_guards(const guard_problem *problem, const guard_pool *pool,
                             guard_selection *selection) {
    starg_status status = STARG_OK;
    starg_context *context = problem->context;
    pairing own = {.problem = problem,
                   .pool = pool,
                   .selection = selection,
                   .cosine = starg_cone_cosine(2 * problem->options->baseline)};
    if (!(problem->options->baseline > 0))
        return STARG_OK;
    STARG_NEW_ZERO(context, STAGE, own.gain, pool_count(pool));
    STARG_NEW_ZERO(context, STAGE, own.chosen, pool_count(pool));
    for (size_t i = 0; i < selection->chosen.count; i++)
        own.chosen[selection->chosen.data[i]] = 1;
    STARG_TRY(add(&own));
    STARG_TRY(remove_needless(&own));
done:
    RELEASE(own.lacking.data, own.gain, own.chosen);
    return status;
}
