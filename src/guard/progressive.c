/* SPDX-License-Identifier: Apache-2.0 */
/* Progressive guarding: from a coarse level of detail to the model itself [YL11, section 3.3].
 *
 * Stages, for each level from the coarsest on:
 *   1. compute what the model's candidates, without those added for single faces of it, see of the
 *      level;
 *   2. keep the guards of the coarser level that are significant: they see at least the fraction
 *      `significance` of the level's area; what they see needs no further guard;
 *   3. choose guards for the rest by an ILP, with the reductions and blocks of cover/;
 *   4. drop guards that the others make redundant.
 * The guards of the last level are those of the model. A guard's level is the one that first chose
 * it and from which on every level kept it.
 *
 * The bound for the model is separate: bound_guards solves the whole problem without branching. If
 * that finds fewer guards than the levels did, they replace them.
 *
 * Invariant: the guards of every level see all of it that one of these candidates sees (or as much
 * as required).
 * Cost: visibility of all candidates on all levels, a third more than that of the model if each
 * level is a quarter of the next; an ILP per level on what is left of it. */
#include "guard/stages.h"
#include "mesh/solid.h"

static const char STAGE[] = "levels";

typedef struct level_work {
    const guard_problem *problem;
    const guard_pool *pool; /* of this level */
    column_weights weights;
    int level;
    STARG_ARRAY(uint32_t) kept;
} level_work;

static bool is_significant(const level_work *work, uint32_t candidate) {
    uint64_t seen = column_weights_of(&work->weights, starg_bits_row(work->pool->rows, candidate),
                                      work->pool->rows->words);
    double least = work->problem->options->significance * (double)work->weights.total;
    return (double)seen >= least;
}

static starg_status keep_significant(level_work *work, const guard_selection *before) {
    size_t limit = work->problem->options->max_guards;
    for (size_t i = 0; i < before->chosen.count; i++) {
        uint32_t candidate = before->chosen.data[i];
        if (limit > 0 && work->kept.count + 1 == limit)
            break; /* at least one slot stays free, so that the choice can respect the limit */
        if (is_significant(work, candidate))
            PUSH(work->problem->context, STAGE, &work->kept, candidate);
    }
    return STARG_OK;
}

static bool is_listed(uint32_t candidate, const uint32_t *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (list[i] == candidate)
            return true;
    return false;
}

/* Fills `kept` with those of a list that are chosen. */
static starg_status mark_kept(starg_context *context, const uint32_t *list, size_t count,
                              guard_selection *selection) {
    for (size_t i = 0; i < selection->chosen.count; i++)
        if (is_listed(selection->chosen.data[i], list, count))
            PUSH(context, STAGE, &selection->kept, selection->chosen.data[i]);
    return STARG_OK;
}

/* The fewest candidates of `all` that see as much as all of them together, or `weight` if a part
 * suffices. */
static starg_status cover_by(const level_work *work, const uint32_t *all, size_t count,
                             uint64_t weight, starg_cover **out) {
    const guard_problem *problem = work->problem;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    starg_cover_problem cover;
    TRY(pool_copy_rows(work->pool, all, count, &rows));
    starg_cover_problem_default(&cover);
    cover.rows = rows;
    cover.redundancy = problem->options->redundancy;
    cover.needs = work->pool->solid->need;
    if (problem->options->coverage < 1 || problem->options->max_guards > 0) {
        cover.weights = work->weights.weights;
        cover.target = weight;
    }
    return starg_cover_solve(problem->context, &cover, NULL, out);
}

/* The fewest of the kept and added candidates that see as much as all of them, ordered by what each
 * adds. The bounds are those of the whole problem if no guard was kept. */
static starg_status take_needed(const level_work *work, const starg_cover *added,
                                const guard_selection *before, guard_selection *out) {
    starg_context *context = work->problem->context;
    size_t count = work->kept.count + added->count;
    SCOPED uint32_t *all = NULL;
    SCOPED_BY(starg_cover_drop) starg_cover *needed = NULL;
    NEW(context, STAGE, all, count);
    for (size_t i = 0; i < count; i++)
        all[i] = i < work->kept.count ? work->kept.data[i] : added->rows[i - work->kept.count];
    TRY(cover_by(work, all, count, added->weight, &needed));
    for (size_t i = 0; i < needed->count; i++)
        needed->rows[i] = all[needed->rows[i]];
    TRY(selection_of_cover(context, needed, before, work->level, out));
    out->time_limited = before->time_limited || added->time_limited;
    out->lower_bound = work->kept.count == 0 ? added->lower_bound : 0;
    out->weight_bound = work->kept.count == 0 ? added->weight_bound : 0;
    return mark_kept(context, work->kept.data, work->kept.count, out);
}

starg_status record_level(const guard_pool *pool, const guard_selection *selection,
                          guard_records *records) {
    starg_status status = STARG_OK;
    size_t count = selection->chosen.count;
    starg_guard_level record = {starg_space_model_vertices(pool->solid),
                                starg_space_model_faces(pool->solid), 0, NULL, 0};
    STARG_NEW(pool->context, STAGE, record.positions, 3 * count);
    for (int kept = 1; kept >= 0; kept--) {
        for (size_t i = 0; i < count; i++) {
            uint32_t candidate = selection->chosen.data[i];
            if (is_listed(candidate, selection->kept.data, selection->kept.count) == (kept == 1))
                memcpy(record.positions + 3 * record.count++, pool_point(pool, candidate),
                       3 * sizeof *record.positions);
        }
        if (kept == 1)
            record.kept = record.count;
    }
    STARG_PUSH(pool->context, STAGE, records, record);
    record.positions = NULL;
done:
    starg_release(pool->context, record.positions);
    return status;
}

/* Guards for one level, from those of the level before. */
static starg_status guard_level(const guard_problem *problem, const guard_pool *pool, int level,
                                const guard_selection *before, guard_selection *out) {
    starg_status status = STARG_OK;
    starg_cover *added = NULL;
    level_work work = {.problem = problem, .pool = pool, .level = level};
    STARG_TRY(column_weights_create(problem->context, pool->solid,
                                    problem->options->visibility.target, &work.weights));
    STARG_TRY(keep_significant(&work, before));
    bool brief = guard_is_brief(problem->options);
    const choice how = {.method = brief ? STARG_COVER_LOCAL : STARG_COVER_ILP,
                        .max_nodes = problem->options->max_nodes,
                        .given = work.kept.data,
                        .given_count = work.kept.count};
    STARG_TRY(choose_candidates(pool, &work.weights, &how, &added));
    STARG_TRY(take_needed(&work, added, before, out));
done:
    starg_cover_free(added);
    column_weights_free(&work.weights);
    STARG_ARRAY_FREE(problem->context, &work.kept);
    return status;
}

/* The choice for a coarse level replaces the previous one and is recorded. A level is skipped if
 * time does not suffice. */
static starg_status guard_coarse_level(const guard_problem *problem, const guard_pool *finest,
                                       const starg_mesh *mesh, guard_records *records,
                                       guard_selection *chosen) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED_BY(pool_free) guard_pool pool = {0};
    SCOPED_BY(selection_free) guard_selection next = {0};
    starg_status status = solid_of_level(problem->context, problem->solid, mesh, &solid);
    chosen->time_limited = chosen->time_limited || status == STARG_ERROR_TIME;
    if (status == STARG_ERROR_TIME)
        return STARG_OK;
    TRY(status);
    TRY(pool_on_level(finest, solid, &pool));
    chosen->time_limited = chosen->time_limited || pool.time_limited;
    if (pool.time_limited)
        return STARG_OK;
    TRY(guard_level(problem, &pool, (int)records->count, chosen, &next));
    TRY(record_level(&pool, &next, records));
    selection_free(chosen);
    *chosen = next;
    next = (guard_selection){0};
    return STARG_OK;
}

starg_status bound_guards(const guard_problem *problem, const guard_pool *pool,
                          const guard_selection *first, guard_selection *out) {
    SCOPED_BY(starg_cover_drop) starg_cover *bound = NULL;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = 0};
    TRY(choose_candidates(pool, &problem->weights, &how, &bound));
    bool smaller = bound->target_reached && bound->count < first->chosen.count;
    if (smaller)
        TRY(selection_of_cover(problem->context, bound, first, first->level, out));
    else
        TRY(selection_copy(problem->context, first, out));
    if (smaller)
        TRY(mark_kept(problem->context, first->kept.data, first->kept.count, out));
    out->lower_bound = bound->lower_bound;
    out->weight_bound = bound->weight_bound;
    return STARG_OK;
}

starg_status progressive_guards(const guard_problem *problem, const guard_detail *detail,
                                const guard_pool *pool, guard_records *records,
                                guard_selection *out) {
    const starg_levels *levels = detail->levels;
    size_t coarse = levels == NULL || pool->first_count == 0 ? 0 : levels->count - 1;
    SCOPED_BY(selection_free)
    guard_selection chosen = {.time_limited = detail->time_limited || pool->time_limited};
    for (size_t i = 0; i < coarse && !chosen.time_limited; i++)
        TRY(guard_coarse_level(problem, pool, levels->levels[i].mesh, records, &chosen));
    /* skipped levels have no number */
    return guard_level(problem, pool, (int)records->count, &chosen, out);
}
