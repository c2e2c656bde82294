/* SPDX-License-Identifier: Apache-2.0 */
/* A pool: the candidates of one job and what each sees. */
#ifndef STARG_GUARD_POOL_H
#define STARG_GUARD_POOL_H

#include "core/bits.h"
#include "guard/candidates.h"
#include "guard/weights.h"

typedef struct guard_pool {
    starg_context *context;
    const starg_solid *solid;
    const starg_guard_options *options; /* visibility, clearance, where guards may stand */
    candidate_points points;
    size_t first_count; /* candidates before augmentation, set by pool_augment */
    starg_bits *rows;   /* by candidate; columns are faces or vertices; NULL before the first */
    size_t columns;     /* of the rows */
    uint64_t
        *coverable;    /* bits of the columns that some row holds, or that a point not kept sees */
    size_t unseen;     /* faces proven to be seen from nowhere where guards may stand */
    bool curtailed;    /* augmentation stopped before all faces were tried: enough can be seen */
    bool time_limited; /* candidates were left out because time ran out */
} guard_pool;

/* An empty pool. Errors: MEMORY. */
starg_status pool_create(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, guard_pool *pool);
void pool_free(guard_pool *pool);

static inline size_t pool_count(const guard_pool *pool) {
    return candidates_count(&pool->points);
}

static inline const double *pool_point(const guard_pool *pool, size_t candidate) {
    return pool->points.data.data + 3 * candidate;
}

/* The direction of a candidate and its up vector, or NULL if views are not directed. */
static inline const double *pool_direction(const guard_pool *pool, size_t candidate) {
    return pool->points.directions.count > 0 ? pool->points.directions.data + 3 * candidate : NULL;
}

static inline const double *pool_up(const guard_pool *pool, size_t candidate) {
    return pool->points.ups.count > 0 ? pool->points.ups.data + 3 * candidate : NULL;
}

/* Adds points and their rows. If views are directed, points without directions get several
 * (guard/directions.c). Points that the time limit leaves unfinished are dropped. Errors: MEMORY,
 * CANCELLED. */
starg_status pool_add(guard_pool *pool, const candidate_points *points);

/* The candidates before augmentation, with the same indices, and what they see of another solid:
 * one level of detail. Rows that the time limit leaves unfinished are empty. Errors: MEMORY,
 * CANCELLED. */
starg_status pool_on_level(const guard_pool *finest, const starg_solid *level, guard_pool *out);

/* Adds candidates for unseen faces until one sees every face that can be seen (guard/augment.c) or,
 * if a part of the area suffices, until the unseen weight is at most half of what may be left over;
 * given candidates stay as they are. Errors: MEMORY, CANCELLED. */
starg_status pool_augment(guard_pool *pool, const column_weights *weights);

/* Adds candidates until, where that can be, as many see each column as the redundancy asks
 * (guard/companions.c). Errors: MEMORY, CANCELLED. */
starg_status pool_add_companions(guard_pool *pool);

/* By column, how many candidates see it; release with starg_release. Errors: MEMORY. */
starg_status pool_supply(const guard_pool *pool, uint32_t **supply);

/* The rows of some candidates; release with starg_bits_free. Errors: MEMORY. */
starg_status pool_copy_rows(const guard_pool *pool, const uint32_t *list, size_t count,
                            starg_bits **rows);

/* The weight of the columns that some candidate covers. */
uint64_t pool_coverable_weight(const guard_pool *pool, const column_weights *weights);

/* Removes all candidates but the first `count`. */
void pool_truncate(guard_pool *pool, size_t count);

/* The union of the rows of a matrix: the bit of each column that one of them holds; starg_release
 * frees it. Errors: MEMORY. */
starg_status pool_join_rows(starg_context *context, const starg_bits *rows, uint64_t **joined);

#endif
