/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates beside candidates, where several guards must see each face.
 *
 * Problem: a face that some candidate sees is to be seen by as many guards as the redundancy says,
 * but fewer candidates than that see it.
 *
 * Method: what a point sees strictly, points close enough to it see as well. Candidates that see
 * faces in short supply, chosen greedily, get companions at random around them, at distances that
 * are halved from round to round.
 *
 * Cost: ROUNDS times the rows of MOST_HOSTS x (redundancy - 1) points at most. */
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"

static const char STAGE[] = "guard";

enum { ROUNDS = 30, MOST_HOSTS = 256 };

static const double FIRST_DISTANCE = 1.0 / 64; /* of the diagonal */

/* Bits of the columns that some candidate sees, but fewer than the redundancy. */
static starg_status find_short(const guard_pool *pool, uint64_t *lacking, size_t *count) {
    SCOPED uint32_t *supply = NULL;
    *count = 0;
    memset(lacking, 0, starg_bit_words(pool->columns) * sizeof *lacking);
    TRY(pool_supply(pool, &supply));
    for (size_t j = 0; j < pool->columns; j++)
        if (supply[j] > 0 && supply[j] < pool->options->redundancy) {
            starg_bit_set(lacking, j);
            ++*count;
        }
    return STARG_OK;
}

/* The candidate that sees the most of these columns, which are taken out; false: none sees any. */
static bool take_host(const guard_pool *pool, uint64_t *lacking, size_t *host) {
    size_t most = 0;
    for (size_t i = 0; i < pool_count(pool); i++) {
        size_t seen = 0;
        for (size_t w = 0; w < pool->rows->words; w++)
            seen += starg_bits_in(starg_bits_row(pool->rows, i)[w] & lacking[w]);
        if (seen > most) {
            most = seen;
            *host = i;
        }
    }
    for (size_t w = 0; w < pool->rows->words && most > 0; w++)
        lacking[w] &= ~starg_bits_row(pool->rows, *host)[w];
    return most > 0;
}

static starg_status add_beside(const guard_pool *pool, size_t host, double distance, starg_rng *rng,
                               candidate_points *out) {
    for (uint32_t k = 1; k < pool->options->redundancy; k++) {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = pool_point(pool, host)[i] + distance * (2 * starg_rng_unit(rng) - 1);
        if (candidates_allowed(pool->solid, p, pool->options->clearance))
            TRY(candidates_push_pose(pool->context, out, p, pool_direction(pool, host),
                                     pool_up(pool, host)));
    }
    return STARG_OK;
}

starg_status pool_add_companions(guard_pool *pool) {
    SCOPED uint64_t *lacking = NULL;
    SCOPED_BY(candidates_free) candidate_points found = {0};
    size_t count = 0;
    double distance = FIRST_DISTANCE * pool->solid->check->diagonal;
    NEW(pool->context, STAGE, lacking, starg_bit_words(pool->columns));
    for (uint64_t round = 0; round < ROUNDS && !pool->time_limited; round++, distance /= 2) {
        starg_rng rng = starg_rng_make(pool->context->seed, STREAM_COMPANIONS, round);
        size_t host = 0;
        TRY(find_short(pool, lacking, &count));
        if (count == 0)
            break;
        found.data.count = found.directions.count = found.ups.count = 0;
        for (int hosts = 0; hosts < MOST_HOSTS && take_host(pool, lacking, &host); hosts++)
            TRY(add_beside(pool, host, distance, &rng, &found));
        if (found.data.count > 0)
            TRY(pool_add(pool, &found));
    }
    return STARG_OK;
}
