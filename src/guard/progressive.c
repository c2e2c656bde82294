/* Progressive guarding: from a coarse level of detail to the model itself [YL11, section 3.3].
 *
 * Stages, for each level from the coarsest on:
 *   1. what the candidates, which are those of the model without those added for single faces of
 *      it, see of the level;
 *   2. guards of the coarser level are kept if they are significant: if they see at least the
 *      fraction `significance` of the level's area; what they see needs no further guard;
 *   3. an ILP, with the reductions and blocks of cover/, chooses guards for the rest;
 *   4. guards that the others make needless are dropped.
 * The guards of the last level are those of the model. A guard's level is the one that first asked
 * for it and from which on it was chosen at every level.
 *
 * A bound for the model is another matter: bound_guards solves the whole problem without branching.
 * Where that comes upon fewer guards than the levels did, they are taken instead.
 *
 * Invariant: the guards of every level see all of it that one of these candidates sees (or as much
 * as asked).
 * Cost: visibility of all candidates on all levels, which is a third more than that of the model
 * where each level is a quarter of the next; an ILP per level on what is left of it. */
#include "geometry/vec3.h"
#include "guard/job.h"
#include "mesh/solid.h"

static const char STAGE[] = "levels";

typedef struct level_work {
    guard_job *job;
    int level;
    const guard_pool *pool; /* of this level */
    column_weights weights;
    STARG_ARRAY(uint32_t) kept;
} level_work;

static bool is_significant(const level_work *work, uint32_t candidate) {
    const uint64_t *row = starg_bits_row(work->pool->rows, candidate);
    uint64_t seen = 0;
    for (size_t w = 0; w < work->pool->rows->words; w++) {
        STARG_FOR_BITS (bit, row[w])
            seen += work->weights.weights[64 * w + bit];
    }
    return (double)seen >= work->job->options->significance * (double)work->weights.total;
}

static starg_status keep_significant(level_work *work) {
    starg_status status = STARG_OK;
    size_t limit = work->job->options->max_guards;
    for (size_t i = 0; i < work->job->chosen.count; i++) {
        uint32_t candidate = work->job->chosen.data[i];
        if (limit > 0 && work->kept.count + 1 == limit)
            break; /* one at least is free, that the choice has a limit to keep */
        if (is_significant(work, candidate))
            STARG_PUSH(work->job->context, STAGE, &work->kept, candidate);
    }
done:
    return status;
}

/* Of the kept and the added candidates the fewest that see as much as all of them, in the order of
 * what they add; they become the chosen ones. */
static starg_status take_needed(level_work *work, const starg_cover *added) {
    starg_status status = STARG_OK;
    guard_job *job = work->job;
    size_t count = work->kept.count + added->count;
    uint32_t *all = NULL;
    int *levels = NULL;
    starg_bits *rows = NULL;
    starg_cover *needed = NULL;
    starg_cover_problem problem;
    STARG_NEW(job->context, STAGE, all, count);
    STARG_NEW(job->context, STAGE, levels, count);
    STARG_TRY(starg_bits_create(job->context, count, work->pool->columns, &rows));
    for (size_t i = 0; i < count; i++) {
        all[i] = i < work->kept.count ? work->kept.data[i] : added->rows[i - work->kept.count];
        levels[i] = job_level_of(job, all[i], work->level);
        memcpy(starg_bits_row_mutable(rows, i), starg_bits_row(work->pool->rows, all[i]),
               rows->words * sizeof *rows->data);
    }
    starg_cover_problem_default(&problem);
    problem.rows = rows;
    problem.redundancy = job->options->redundancy;
    if (job->options->coverage < 1 || job->options->max_guards > 0) {
        problem.weights = work->weights.weights;
        problem.target = added->weight;
    }
    STARG_TRY(starg_cover_solve(job->context, &problem, NULL, &needed));
    job->chosen.count = job->levels.count = 0;
    for (size_t i = 0; i < needed->count; i++) {
        STARG_PUSH(job->context, STAGE, &job->chosen, all[needed->rows[i]]);
        STARG_PUSH(job->context, STAGE, &job->levels, levels[needed->rows[i]]);
    }
done:
    starg_release(job->context, all);
    starg_release(job->context, levels);
    starg_bits_free(rows);
    starg_cover_free(needed);
    return status;
}

static bool is_kept(const level_work *work, uint32_t candidate) {
    for (size_t i = 0; i < work->kept.count; i++)
        if (work->kept.data[i] == candidate)
            return true;
    return false;
}

/* Writes down the guards of the level, the kept ones first. */
static starg_status record_level(level_work *work) {
    starg_status status = STARG_OK;
    guard_job *job = work->job;
    const starg_mesh *mesh = work->pool->solid->mesh;
    starg_guard_level record = {mesh->vertex_count, mesh->face_count, 0, NULL, 0};
    STARG_NEW(job->context, STAGE, record.positions, 3 * job->chosen.count);
    for (int kept = 1; kept >= 0; kept--) {
        for (size_t i = 0; i < job->chosen.count; i++)
            if (is_kept(work, job->chosen.data[i]) == (kept == 1))
                memcpy(record.positions + 3 * record.count++,
                       pool_point(&job->pool, job->chosen.data[i]), 3 * sizeof *record.positions);
        if (kept == 1)
            record.kept = record.count;
    }
    STARG_PUSH(job->context, STAGE, &job->records, record);
    record.positions = NULL;
done:
    starg_release(job->context, record.positions);
    return status;
}

/* Guards for one level, from those of the level before. */
static starg_status guard_level(guard_job *job, int level, const guard_pool *pool) {
    starg_status status = STARG_OK;
    starg_cover *added = NULL;
    level_work work = {.job = job, .level = level, .pool = pool};
    STARG_TRY(column_weights_create(job->context, pool->solid->mesh,
                                    job->options->visibility.target, &work.weights));
    STARG_TRY(keep_significant(&work));
    const choice how = {.method = STARG_COVER_ILP,
                        .max_nodes = job->options->max_nodes,
                        .given = work.kept.data,
                        .given_count = work.kept.count};
    STARG_TRY(choose_candidates(pool, &work.weights, &how, &added));
    job->time_limited = job->time_limited || added->time_limited;
    if (pool == &job->pool && work.kept.count == 0) { /* that was the whole problem */
        job->lower_bound = added->lower_bound;
        job->weight_bound = added->weight_bound;
    }
    STARG_TRY(take_needed(&work, added));
    STARG_TRY(record_level(&work));
done:
    starg_cover_free(added);
    column_weights_free(job->context, &work.weights);
    STARG_ARRAY_FREE(job->context, &work.kept);
    return status;
}

/* Without the time for a level, it is skipped. */
static starg_status guard_coarse_level(guard_job *job, int level, const starg_mesh *mesh) {
    starg_solid *solid = NULL;
    guard_pool pool = {0};
    starg_status status = solid_make_in_time(job->context, mesh, &solid);
    job->time_limited = job->time_limited || status == STARG_ERROR_TIME;
    if (status == STARG_ERROR_TIME)
        return STARG_OK;
    STARG_TRY(status);
    STARG_TRY(pool_on_level(&job->pool, solid, &pool));
    if (!pool.time_limited)
        STARG_TRY(guard_level(job, level, &pool));
    job->time_limited = job->time_limited || pool.time_limited;
done:
    pool_free(&pool);
    starg_solid_free(solid);
    return status;
}

/* Fewer guards matter more than keeping some: the cover becomes that of the last level. */
static starg_status take_smaller(guard_job *job, const starg_cover *cover) {
    starg_status status = STARG_OK;
    int last = (int)job->records.count - 1;
    level_work work = {.job = job, .level = last, .pool = &job->pool};
    starg_guard_level *record = &job->records.data[last];
    for (size_t i = 0; i < record->kept; i++)
        for (size_t k = 0; k < job->chosen.count; k++)
            if (vec3_equal(pool_point(&job->pool, job->chosen.data[k]), record->positions + 3 * i))
                STARG_PUSH(job->context, STAGE, &work.kept, job->chosen.data[k]);
    STARG_TRY(job_take_cover(job, cover, last));
    starg_release(job->context, record->positions);
    record->positions = NULL;
    job->records.count--;
    STARG_TRY(record_level(&work));
done:
    STARG_ARRAY_FREE(job->context, &work.kept);
    return status;
}

starg_status bound_guards(guard_job *job) {
    starg_status status = STARG_OK;
    starg_cover *bound = NULL;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = 0};
    STARG_TRY(choose_candidates(&job->pool, &job->weights, &how, &bound));
    if (bound->target_reached && bound->count < job->chosen.count)
        STARG_TRY(take_smaller(job, bound));
    job->lower_bound = bound->lower_bound;
    job->weight_bound = bound->weight_bound;
done:
    starg_cover_free(bound);
    return status;
}

starg_status progressive_guards(guard_job *job) {
    starg_status status = STARG_OK;
    const starg_levels *levels = job->detail;
    int last = levels == NULL ? 0 : (int)levels->count - 1;
    for (int level = 0; level < last && !job->time_limited && job->pool.first_count > 0; level++)
        STARG_TRY(guard_coarse_level(job, level, levels->levels[level].mesh));
    /* levels that were skipped have no number */
    STARG_TRY(guard_level(job, (int)job->records.count, &job->pool));
done:
    return status;
}
