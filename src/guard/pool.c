/* SPDX-License-Identifier: Apache-2.0 */
#include "guard/candidates.h"

#include "visibility/scene.h"

static const char STAGE[] = "guard";

enum { MOST_ADDED = 256 };

/* Columns behind the patches of the model, which come first, are never set. The search over every
 * point has them as its engines do. */
static size_t columns_of(const starg_solid *solid, const starg_guard_options *o) {
    bool part = (o->coverage < 1 || o->max_guards > 0) && !o->prove;
    return part && o->visibility.target == STARG_TARGET_FACES
               ? solid_first_patch(solid, starg_space_model_faces(solid))
               : target_columns(solid, o->visibility.target);
}

starg_status pool_create(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, guard_pool *pool) {
    *pool = (guard_pool){.context = context,
                         .solid = solid,
                         .options = options,
                         .columns = columns_of(solid, options)};
    NEW_ZERO(context, STAGE, pool->coverable, starg_bit_words(pool->columns));
    return STARG_OK;
}

void pool_free(guard_pool *pool) {
    if (pool->context == NULL)
        return;
    candidates_free(&pool->points);
    starg_release(pool->context, pool->coverable);
    starg_bits_free(pool->rows);
    *pool = (guard_pool){0};
}

static const double *direction_of(const candidate_points *points, size_t index) {
    return points->directions.count > 0 ? points->directions.data + 3 * index : NULL;
}

static const double *up_of(const candidate_points *points, size_t index) {
    return points->ups.count > 0 ? points->ups.data + 3 * index : NULL;
}

/* Compacts the finished rows to the columns of the pool and appends their points; drops empty rows
 * unless these are allowed. */
static starg_status keep_finished(guard_pool *pool, const candidate_points *points, bool empty,
                                  const uint8_t *finished, starg_bits *rows) {
    size_t kept = 0, words = starg_bit_words(pool->columns);
    for (size_t i = 0; i < rows->rows; i++) {
        pool->time_limited = pool->time_limited || !finished[i];
        if (!finished[i] || (!empty && starg_bits_count(rows, i) == 0))
            continue;
        TRY(candidates_push_pose(pool->context, &pool->points, points->data.data + 3 * i,
                                 direction_of(points, i), up_of(points, i)));
        memmove(rows->data + kept * words, starg_bits_row(rows, i), words * sizeof *rows->data);
        kept++;
    }
    rows->rows = kept;
    rows->columns = pool->columns;
    rows->words = words;
    return STARG_OK;
}

/* Appends rows, or takes them if they are the first. */
static starg_status append_rows(guard_pool *pool, starg_bits **from) {
    starg_bits *added = *from, *all;
    for (size_t i = 0; i < added->rows; i++)
        for (size_t w = 0; w < added->words; w++)
            pool->coverable[w] |= starg_bits_row(added, i)[w];
    if (pool->rows == NULL) {
        pool->rows = added;
        *from = NULL;
        return STARG_OK;
    }
    TRY(starg_bits_create(pool->context, pool->rows->rows + added->rows, added->columns, &all));
    memcpy(all->data, pool->rows->data, pool->rows->rows * all->words * sizeof *all->data);
    memcpy(starg_bits_row_mutable(all, pool->rows->rows), added->data,
           added->rows * all->words * sizeof *all->data);
    starg_bits_free(pool->rows);
    pool->rows = all;
    return STARG_OK;
}

/* Adds the rows of points whose poses are complete. */
static starg_status add_rows(guard_pool *pool, const candidate_points *points, bool empty) {
    starg_visibility_options view = pool->options->visibility;
    SCOPED_BY(starg_bits_drop) starg_bits *added = NULL;
    SCOPED uint8_t *finished = NULL;
    size_t count = candidates_count(points);
    view.directions = points->directions.data;
    view.ups = points->ups.data;
    NEW_ZERO(pool->context, STAGE, finished, count);
    TRY(visibility_rows(pool->context, pool->solid, points->data.data, count, &view, finished,
                        &added));
    TRY(keep_finished(pool, points, empty, finished, added));
    return append_rows(pool, &added);
}

starg_status pool_add(guard_pool *pool, const candidate_points *points) {
    SCOPED_BY(candidates_free) candidate_points turned = {0};
    if (!sensor_is_directed(&pool->options->visibility) || points->directions.count > 0)
        return add_rows(pool, points, true);
    TRY(candidates_turn(pool->context, pool->solid, &pool->options->visibility, points, &turned));
    TRY(add_rows(pool, &turned, false)); /* most directions of a point see no whole face */
    return STARG_OK;
}

void pool_truncate(guard_pool *pool, size_t count) {
    if (count >= pool_count(pool))
        return;
    pool->points.data.count = 3 * count;
    if (pool->points.directions.count > 0)
        pool->points.directions.count = pool->points.ups.count = 3 * count;
    pool->rows->rows = count;
    memset(pool->coverable, 0, pool->rows->words * sizeof *pool->coverable);
    for (size_t i = 0; i < count; i++)
        for (size_t w = 0; w < pool->rows->words; w++)
            pool->coverable[w] |= starg_bits_row(pool->rows, i)[w];
}

starg_status pool_on_level(const guard_pool *finest, const starg_solid *level, guard_pool *out) {
    starg_context *context = finest->context;
    SCOPED uint8_t *finished = NULL;
    size_t count = finest->first_count;
    TRY(pool_create(context, level, finest->options, out));
    NEW_ZERO(context, STAGE, finished, count);
    for (size_t i = 0; i < count; i++)
        TRY(candidates_push_pose(context, &out->points, pool_point(finest, i),
                                 pool_direction(finest, i), pool_up(finest, i)));
    starg_visibility_options view = out->options->visibility;
    view.directions = out->points.directions.data;
    view.ups = out->points.ups.data;
    TRY(visibility_rows(context, level, out->points.data.data, count, &view, finished, &out->rows));
    for (size_t i = 0; i < count; i++) {
        out->time_limited = out->time_limited || !finished[i];
        for (size_t w = 0; w < out->rows->words; w++)
            out->coverable[w] |= starg_bits_row(out->rows, i)[w];
    }
    return STARG_OK;
}

/* Is a vertex or a corner of the face a column that nothing covers? */
static bool lacks_corner(const guard_pool *pool, size_t face) {
    bool vertices = pool->options->visibility.target == STARG_TARGET_VERTICES, lacks = false;
    for (size_t k = 3 * face; k < 3 * face + 3; k++)
        lacks =
            lacks || !starg_bit_test(pool->coverable, vertices ? pool->solid->mesh->faces[k] : k);
    return lacks;
}

/* Marks the patches that are wanted but not coverable; with vertices or corners as the target, the
 * faces around each one that is not. */
static void mark_unseen(const guard_pool *pool, uint8_t *unseen) {
    bool patches = pool->options->visibility.target == STARG_TARGET_FACES;
    for (size_t j = 0; j < solid_patch_count(pool->solid); j++) {
        size_t face = solid_patch_face(pool->solid, j);
        unseen[j] = patches ? solid_wants(pool->solid, false, face, j) &&
                                  !starg_bit_test(pool->coverable, j)
                            : solid_is_target(pool->solid, false, face) && lacks_corner(pool, face);
    }
}

uint64_t pool_coverable_weight(const guard_pool *pool, const column_weights *weights) {
    uint64_t sum = 0;
    for (size_t j = 0; j < pool->columns; j++)
        if (starg_bit_test(pool->coverable, j))
            sum += weights->weights[j];
    return sum;
}

/* The last crevices of a large model would take thousands of candidates, for faces that need not be
 * seen. */
static bool sees_enough(const guard_pool *pool, const column_weights *weights) {
    const starg_guard_options *o = pool->options;
    if (o->coverage == 1 || o->redundancy > 1 || o->max_guards > 0)
        return false;
    double missing = (double)(weights->total - pool_coverable_weight(pool, weights));
    return missing <= 0.5 * (1 - o->coverage) * (double)weights->total;
}

/* Of a scene much may be hidden for ever: what lies on something, or behind what cannot be passed.
 * Where a part suffices, all of what no candidate sees is tried before any is added. */
static bool tests_first(const guard_pool *pool) {
    const starg_guard_options *o = pool->options;
    return pool->solid->scene && o->coverage < 1 && o->redundancy == 1 && o->max_guards == 0 &&
           o->candidates != STARG_CANDIDATES_GIVEN && o->visibility.target == STARG_TARGET_FACES;
}

/* The weight of the faces that could be seen and are not, and how many they are. */
static double weigh_missing(const guard_pool *pool, const column_weights *weights,
                            const augmentation_finds *finds, size_t *count) {
    double missing = 0;
    *count = 0;
    for (size_t i = 0; i < finds->patches.count; i++)
        if (!starg_bit_test(pool->coverable, finds->patches.data[i])) {
            missing += (double)weights->weights[finds->patches.data[i]];
            ++*count;
        }
    return missing;
}

/* Adds some of the points that see these faces, evenly. */
static starg_status add_some(guard_pool *pool, const augmentation_finds *finds, size_t count) {
    SCOPED_BY(candidates_free) candidate_points some = {0};
    size_t take = count < MOST_ADDED ? count : MOST_ADDED, index = 0, taken = 0;
    for (size_t i = 0; i < finds->patches.count; i++) {
        if (starg_bit_test(pool->coverable, finds->patches.data[i]))
            continue;
        if (index++ * take / count == taken) {
            TRY(candidates_push(pool->context, &some, finds->poses.data.data + 3 * i,
                                direction_of(&finds->poses, i)));
            taken++;
        }
    }
    return pool_add(pool, &some);
}

/* Adds points until candidates see enough of all that can be seen at all. What else could be seen
 * is coverable, too. */
static starg_status augment_part(guard_pool *pool, const column_weights *weights,
                                 const augmentation *all, uint8_t *unseen) {
    starg_status status = STARG_OK;
    augmentation_finds finds = {0};
    double allowed = 0.5 * (1 - pool->options->coverage);
    size_t count;
    mark_unseen(pool, unseen);
    STARG_TRY(augment_test(pool->context, all, unseen, &finds));
    double missing = weigh_missing(pool, weights, &finds, &count);
    double most = allowed * ((double)pool_coverable_weight(pool, weights) + missing);
    while (missing > most && !pool->time_limited) {
        double before = missing;
        STARG_TRY(add_some(pool, &finds, count));
        missing = weigh_missing(pool, weights, &finds, &count);
        if (!(missing < before))
            break; /* never: each point sees its face */
    }
    for (size_t i = 0; i < finds.patches.count; i++)
        starg_bit_set(pool->coverable, finds.patches.data[i]);
done:
    augment_finds_free(&finds);
    if (status == STARG_ERROR_TIME) {
        pool->time_limited = true;
        return STARG_OK;
    }
    return status;
}

starg_status pool_augment(guard_pool *pool, const column_weights *weights) {
    starg_status status = STARG_OK;
    uint8_t *unseen = NULL;
    candidate_points found = {0};
    augmentation all = {pool->solid, &pool->options->visibility, pool->options->clearance, NULL};
    bool pending = pool->options->candidates != STARG_CANDIDATES_GIVEN;
    pool->first_count = pool_count(pool);
    STARG_NEW_ZERO(pool->context, STAGE, all.tried, solid_patch_count(pool->solid));
    STARG_NEW(pool->context, STAGE, unseen, solid_patch_count(pool->solid));
    if (tests_first(pool)) {
        status = augment_part(pool, weights, &all, unseen);
        goto done;
    }
    while (pending && !pool->time_limited) {
        pool->curtailed = sees_enough(pool, weights);
        if (pool->curtailed)
            break;
        mark_unseen(pool, unseen);
        found.data.count = found.directions.count = found.ups.count = 0;
        status = augment_candidates(pool->context, &all, unseen, &found, &pending);
        if (status == STARG_ERROR_TIME) {
            status = STARG_OK;
            pool->time_limited = true;
            break;
        }
        STARG_TRY(status);
        if (found.data.count > 0)
            STARG_TRY(pool_add(pool, &found));
    }
done:
    candidates_free(&found);
    RELEASE(all.tried, unseen);
    return status;
}

starg_status pool_supply(const guard_pool *pool, uint32_t **supply) {
    NEW_ZERO(pool->context, STAGE, *supply, pool->columns);
    for (size_t i = 0; i < pool_count(pool); i++)
        for (size_t w = 0; w < pool->rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(pool->rows, i)[w])
                (*supply)[64 * w + bit]++;
    return STARG_OK;
}

starg_status pool_join_rows(starg_context *context, const starg_bits *rows, uint64_t **joined) {
    NEW_ZERO(context, STAGE, *joined, rows->words);
    for (size_t i = 0; i < rows->rows; i++)
        for (size_t w = 0; w < rows->words; w++)
            (*joined)[w] |= starg_bits_row(rows, i)[w];
    return STARG_OK;
}

starg_status pool_copy_rows(const guard_pool *pool, const uint32_t *list, size_t count,
                            starg_bits **rows) {
    TRY(starg_bits_create(pool->context, count, pool->columns, rows));
    for (size_t i = 0; i < count; i++)
        memcpy(starg_bits_row_mutable(*rows, i), starg_bits_row(pool->rows, list[i]),
               (*rows)->words * sizeof *(*rows)->data);
    return STARG_OK;
}
