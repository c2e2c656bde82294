/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates: points where guards may stand, and what each of them sees. */
#pragma once

#include "core/bits.h"
#include "core/json.h"
#include "core/memory.h"
#include "mesh/formats/io.h"
#include "mesh/solid.h"
#include "starguard/guard.h"
#include "starguard/simplify.h"
#include "starguard/visibility.h"
#include "visibility/sensor.h"

STARG_DROP_RESULT(starg_guards)
STARG_DROP_RESULT(starg_levels)

/* ---- weights of a pool's columns (weights.c) ---- */

typedef struct column_weights {
    double *areas; /* by face, in arbitrary units */
    double area;   /* of all faces */
    uint64_t *weights;
    uint64_t total;
    uint64_t kept; /* of the columns that guards that stay see often enough; not in the total */
    size_t faces;  /* number of target faces */
} column_weights;

/* Errors: MEMORY. */
starg_status column_weights_create(starg_context *context, const starg_solid *solid,
                                   starg_target target, column_weights *out);
void column_weights_free(column_weights *weights);

/* The weight of the columns in a row of so many words. */
static inline uint64_t column_weights_of(const column_weights *weights, const uint64_t *row,
                                         size_t words) {
    uint64_t sum = 0;
    for (size_t w = 0; w < words; w++)
        STARG_FOR_BITS (bit, row[w])
            sum += weights->weights[64 * w + bit];
    return sum;
}

/* ---- proxy level: source of the medial axis and the skeleton of a large model (proxy.c) ---- */

/* Is the model large enough to use a level of detail instead? */
bool proxy_wanted(const starg_solid *solid);

/* The solid of the proxy level, of the levels of `solid`; the caller owns it. An embedded one has
 * embedded levels, which are not checked again. Errors: MEMORY, CANCELLED. */
starg_status proxy_of_levels(starg_context *context, const starg_solid *solid,
                             const starg_levels *levels, starg_solid **out);

/* The same from levels built for the purpose. Errors: MEMORY, CANCELLED, TIME. */
starg_status proxy_make(starg_context *context, const starg_solid *solid, starg_solid **out);

/* ---- candidates: points where guards may stand (candidates.c) ---- */

/* Points of three doubles; data.count is three times their number. If views are directed, each
 * point also has a direction and an up vector (0: from the options); otherwise both are empty. */
typedef struct candidate_points {
    STARG_ARRAY(double) data, directions, ups;
} candidate_points;

/* Appends all points of `from`. Errors: MEMORY. */
starg_status candidates_append(starg_context *context, const candidate_points *from,
                               candidate_points *out);

static inline size_t candidates_count(const candidate_points *points) {
    return points->data.count / 3;
}

/* `direction` is NULL if views are not directed, `up` if the options define it. Errors: MEMORY. */
starg_status candidates_push_pose(starg_context *context, candidate_points *points,
                                  const double p[3], const double direction[3], const double up[3]);
starg_status candidates_push(starg_context *context, candidate_points *points, const double p[3],
                             const double direction[3]);
void candidates_free(candidate_points *points);

/* May a guard stand at p: strictly inside, with the clearance? */
bool candidates_allowed(const starg_solid *solid, const double p[3], double clearance);

/* What candidates are generated for. */
typedef struct candidate_shape {
    const starg_solid *solid; /* candidates must be inside it */
    const starg_solid *proxy; /* source of medial axis and skeleton: the solid or its proxy */
    double clearance;
} candidate_shape;

/* Errors: ARGUMENT (a number out of range, or candidates that cannot be made). */
starg_status candidates_check(starg_context *context, starg_candidates source, size_t wanted,
                              double clearance);

/* Adds about `wanted` points of a source, all allowed. Errors: MEMORY, CANCELLED, TIME. */
starg_status candidates_find(starg_context *context, const candidate_shape *shape,
                             starg_candidates source, size_t wanted, candidate_points *points);

/* ---- the same where guards are bound to faces (near_candidates.c) ---- */

starg_status near_candidates(starg_context *context, const candidate_shape *shape, size_t wanted,
                             candidate_points *points);

/* There, places nearest to patches that no candidate sees, at most two for each, if they see it in
 * some direction. */
starg_status near_candidates_before(starg_context *context, const candidate_shape *shape,
                                    const starg_visibility_options *view, const uint32_t *patches,
                                    size_t count, candidate_points *points);

/* ---- directions of views, for points (directions.c) ---- */

/* Points, each with a few directions whose views hold most of what the point sees; a large set of
 * points is thinned out. Errors: MEMORY, CANCELLED. */
starg_status candidates_turn(starg_context *context, const starg_solid *solid,
                             const starg_visibility_options *view, const candidate_points *points,
                             candidate_points *out);

/* ---- candidates for patches that no candidate sees (augment.c) ---- */

/* Adds candidates for such patches: `unseen` marks them (by index). Each appended point sees at
 * least one of them; a patch stays unseen only if none of the points tried sees it. Handles a
 * bounded number of patches per call: `pending` tells whether more remain. */
typedef struct augmentation {
    const starg_solid *solid;
    const starg_visibility_options *visibility;
    double clearance;
    uint8_t *tried; /* by patch: points were already tried */
} augmentation;

/* Tries all these patches at once. Those that some point sees are listed, with the deepest such
 * point of each, which is not added: `patches` has one for each pose. Errors: MEMORY, CANCELLED,
 * TIME.
 */
typedef struct augmentation_finds {
    candidate_points poses;
    STARG_ARRAY(uint32_t) patches;
} augmentation_finds;

starg_status augment_test(starg_context *context, const augmentation *augmentation,
                          const uint8_t *unseen, augmentation_finds *out);
void augment_finds_free(augmentation_finds *finds);

starg_status augment_candidates(starg_context *context, const augmentation *augmentation,
                                const uint8_t *unseen, candidate_points *points, bool *pending);

/* ---- readers of poses in the files of other programs, which append them (poses_read.c) ---- */
/* Errors: FORMAT (line and reason), MEMORY. */

/* A table with columns x, y, z, and for directions qx, qy, qz, qw or look_x, look_y, look_z. */
bool poses_are_table(const starg_source *source);
starg_status poses_read_table(const starg_source *source, candidate_points *points);

/* The JSON of starg_guards_write_poses. */
bool poses_are_json(const json_t *root);
starg_status poses_read_json(const starg_source *source, const json_t *root,
                             candidate_points *points);

/* The cameras of a binary glTF. */
bool poses_are_glb(const starg_source *source);
starg_status poses_read_glb(const starg_source *source, candidate_points *points);

/* ---- pool: the candidates of one job and what each sees (pool.c) ---- */

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
