/* Guarding a solid [YL11, section 3]: candidates, what they see, the fewest that see everything.
 *
 * Stages: levels of detail; candidate points, of a large model from one of the levels
 * (guard/samples.c); their visibility rows; more candidates until every face that can be seen is
 * seen by one (guard/complete.c); the choice, by one cover problem or from coarse to fine
 * (guard/progressive.c); candidates added where they pay (guard/refine.c); what the chosen guards
 * see (guard/measure.c).
 *
 * The lower bound is that of the cover problem: it holds for guards taken from the final candidate
 * set. */
#include "starguard/guard.h"

#include <math.h>

#include "geometry/vec3.h"
#include "guard/job.h"
#include "guard/samples.h"

static const char STAGE[] = "guard";

void starg_guard_options_default(starg_guard_options *options) {
    *options = (starg_guard_options){.method = STARG_GUARD_PILP,
                                     .candidates = STARG_CANDIDATES_SKELETON,
                                     .candidate_count = 1000,
                                     .coverage = 1,
                                     .redundancy = 1,
                                     .max_nodes = STARG_DEFAULT_NODES,
                                     .coarsest = 5000,
                                     .step = STARG_DEFAULT_STEP,
                                     .significance = 0.1,
                                     .refine = true,
                                     .refine_lines = 10000000};
    starg_visibility_options_default(&options->visibility);
}

static void set_defaults(starg_guard_options *o, size_t vertices) {
    if (o->max_nodes == STARG_DEFAULT_NODES)
        o->max_nodes = o->method == STARG_GUARD_PILP ? 30 : 100000;
    if (o->step == STARG_DEFAULT_STEP)
        o->step = samples_step(vertices, o->coarsest);
}

static starg_status check_enums(starg_context *context, const starg_guard_options *o) {
    if (o->method > STARG_GUARD_PILP || o->candidates > STARG_CANDIDATES_SKELETON)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "an option holds a number that its enum does not have");
    return STARG_OK;
}

static starg_status check_progressive(starg_context *context, const starg_guard_options *o) {
    if (o->step == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "levels of detail must grow by one vertex at least");
    if (!(o->significance >= 0 && o->significance <= 1))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the significance is %g; it must be 0 to 1", o->significance);
    return STARG_OK;
}

static starg_status check_options(starg_context *context, const starg_guard_options *o) {
    starg_status status = STARG_OK;
    STARG_TRY(check_enums(context, o));
    if (o->candidates != STARG_CANDIDATES_GIVEN)
        STARG_TRY(candidates_check(context, o->candidates, o->candidate_count, o->clearance));
    STARG_TRY(check_progressive(context, o));
    if (!(o->coverage > 0 && o->coverage <= 1))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the coverage is %g; it must be above 0 and at most 1", o->coverage);
    if (o->redundancy < 1 || o->redundancy > 1000)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the redundancy is %u; it must be 1 to 1000", o->redundancy);
    if (!(o->clearance >= 0 && o->clearance < 1e100))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the clearance is %g; it must be zero or more", o->clearance);
done:
    return status;
}

/* Given points that may not be used are left out, with a notice. */
static starg_status take_given(guard_job *job, candidate_points *points) {
    starg_status status = STARG_OK;
    const starg_guard_options *options = job->options;
    size_t dropped = 0;
    for (size_t i = 0; i < options->point_count; i++) {
        const double *p = options->points + 3 * i;
        uint64_t index = i;
        if (!(fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100))
            return starg_fail_at(job->context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_CANDIDATE,
                                 &index, 1, "candidate %zu has a coordinate that is not finite", i);
        bool usable = candidates_allowed(job->solid, p, options->clearance);
        if (usable)
            STARG_TRY(candidates_push(job->context, points, p, NULL));
        dropped += !usable;
    }
    if (dropped > 0)
        starg_log(job->context, STARG_LOG_WARNING,
                  "%zu of %zu given candidates are left out: not inside, or too close to the wall",
                  dropped, options->point_count);
done:
    return status;
}

static bool needs_samples(const guard_job *job) {
    return job->options->candidates != STARG_CANDIDATES_GIVEN && samples_wanted(job->solid);
}

/* Levels of detail, for the method or as samples. Without the time to make them there is the model
 * alone. */
static starg_status make_levels(guard_job *job) {
    const starg_guard_options *options = job->options;
    if (options->method != STARG_GUARD_PILP && !needs_samples(job))
        return STARG_OK;
    starg_progress_begin(job->context, "levels");
    starg_status status = starg_mesh_levels(job->context, job->solid->mesh, options->coarsest,
                                            options->step, NULL, &job->detail);
    starg_progress_end(job->context);
    if (status != STARG_ERROR_TIME)
        return status;
    job->time_limited = true;
    return STARG_OK;
}

static starg_status choose_samples(guard_job *job) {
    starg_status status = STARG_OK;
    if (needs_samples(job) && job->detail != NULL)
        STARG_TRY(samples_of_levels(job->context, job->detail, &job->samples));
    job->shape = (candidate_shape){job->solid, job->samples ? job->samples : job->solid,
                                   job->options->clearance};
done:
    return status;
}

/* The first candidates, before completion. */
static starg_status make_candidates(guard_job *job) {
    starg_status status = STARG_OK;
    const starg_guard_options *options = job->options;
    candidate_points points = {0};
    if (options->candidates == STARG_CANDIDATES_GIVEN)
        STARG_TRY(take_given(job, &points));
    else
        STARG_TRY(candidates_find(job->context, &job->shape, options->candidates,
                                  options->candidate_count, &points));
    STARG_TRY(pool_add(&job->pool, &points));
done:
    candidates_free(job->context, &points);
    return status;
}

static starg_status complete_pool(guard_job *job) {
    starg_status status = STARG_OK;
    STARG_TRY(pool_complete(&job->pool, &job->weights));
    job->time_limited = job->time_limited || job->pool.time_limited;
    if (pool_count(&job->pool) > 0)
        goto done;
    if (job->time_limited)
        status = starg_fail(job->context, STARG_ERROR_TIME, STAGE,
                            "the time limit struck before any candidate was looked at");
    else
        status = starg_fail(job->context, STARG_ERROR_MESH, STAGE,
                            "there is no point inside the solid from which anything is seen; a "
                            "smaller clearance, a larger range or other candidates may help");
done:
    return status;
}

int job_level_of(const guard_job *job, uint32_t candidate, int otherwise) {
    for (size_t i = 0; i < job->chosen.count; i++)
        if (job->chosen.data[i] == candidate)
            return job->levels.data[i];
    return otherwise;
}

starg_status job_take_cover(guard_job *job, const starg_cover *cover, int level) {
    starg_status status = STARG_OK;
    int *levels = NULL;
    STARG_NEW(job->context, STAGE, levels, cover->count);
    for (size_t i = 0; i < cover->count; i++)
        levels[i] = job_level_of(job, cover->rows[i], level);
    job->chosen.count = job->levels.count = 0;
    for (size_t i = 0; i < cover->count; i++) {
        STARG_PUSH(job->context, STAGE, &job->chosen, cover->rows[i]);
        STARG_PUSH(job->context, STAGE, &job->levels, levels[i]);
    }
    job->lower_bound = cover->lower_bound;
    job->weight_bound = cover->weight_bound;
    job->time_limited = job->time_limited || cover->time_limited;
done:
    starg_release(job->context, levels);
    return status;
}

/* One cover problem over the model as it is. */
static starg_status choose_at_once(guard_job *job) {
    starg_status status = STARG_OK;
    starg_cover *cover = NULL;
    bool greedy = job->options->method == STARG_GUARD_GREEDY;
    const choice how = {.method = greedy ? STARG_COVER_GREEDY : STARG_COVER_ILP,
                        .max_nodes = job->options->max_nodes};
    STARG_TRY(choose_candidates(&job->pool, &job->weights, &how, &cover));
    STARG_TRY(job_take_cover(job, cover, 0));
done:
    starg_cover_free(cover);
    return status;
}

static starg_status choose(guard_job *job) {
    starg_status status = STARG_OK;
    const starg_guard_options *options = job->options;
    if (options->method != STARG_GUARD_PILP)
        return choose_at_once(job);
    STARG_TRY(progressive_guards(job));
    if (job->lower_bound > 0 && starg_time_is_over(job->context)) {
        job->time_limited = true; /* to build the whole problem once more takes seconds */
        return STARG_OK;
    }
    if (options->refine && options->coverage == 1 && options->max_guards == 0 &&
        options->candidates != STARG_CANDIDATES_GIVEN)
        STARG_TRY(refine_guards(job));
    else
        STARG_TRY(bound_guards(job));
done:
    return status;
}

static starg_status copy_choice(guard_job *job, starg_guards *result) {
    starg_status status = STARG_OK;
    STARG_NEW(job->context, STAGE, result->positions, 3 * job->chosen.count);
    if (job->options->visibility.cone < 360)
        STARG_NEW(job->context, STAGE, result->directions, 3 * job->chosen.count);
    STARG_NEW(job->context, STAGE, result->levels, job->chosen.count);
    STARG_NEW_ZERO(job->context, STAGE, result->seen_faces, job->chosen.count);
    result->count = job->chosen.count;
    for (size_t i = 0; i < result->count; i++) {
        vec3_copy(pool_point(&job->pool, job->chosen.data[i]), result->positions + 3 * i);
        if (result->directions != NULL)
            vec3_copy(pool_direction(&job->pool, job->chosen.data[i]), result->directions + 3 * i);
        result->levels[i] = job->levels.data[i];
    }
    result->level_list = job->records.data;
    result->level_count = job->records.count;
    job->records.data = NULL;
    job->records.count = job->records.capacity = 0;
done:
    return status;
}

/* Is the weight that was bounded the area that is seen? Not with vertices, nor where a face counts
 * only once it is seen by several. */
static bool bounds_area(const starg_guard_options *o) {
    return o->max_guards > 0 && o->redundancy == 1 && o->visibility.target == STARG_TARGET_FACES;
}

static starg_status report(guard_job *job, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guards *result = NULL;
    /* what was found is measured in full */
    starg_time_rule former = starg_time_begin(job->context, STARG_TIME_IGNORED);
    STARG_NEW_ZERO(job->context, STAGE, result, 1);
    result->vertex_count = job->solid->mesh->vertex_count;
    result->face_count = job->solid->mesh->face_count;
    result->options = *job->options;
    result->options.points = NULL;
    result->options.visibility.directions = NULL;
    result->candidate_count = pool_count(&job->pool);
    result->lines_tested = job->lines_tested;
    result->time_limited = job->time_limited;
    result->area_bound = 1;
    if (bounds_area(job->options))
        result->area_bound = (double)job->weight_bound / (double)job->weights.total;
    STARG_TRY(copy_choice(job, result));
    result->lower_bound = job->lower_bound;
    result->optimal = result->count == result->lower_bound;
    STARG_TRY(measure_guards(job, result));
    *out = result;
done:
    starg_time_end(job->context, former);
    if (status != STARG_OK)
        starg_guards_free(job->context, result);
    return status;
}

static void free_records(starg_context *context, starg_guard_level *records, size_t count) {
    for (size_t i = 0; i < count; i++)
        starg_release(context, records[i].positions);
    starg_release(context, records);
}

static void job_free(guard_job *job) {
    free_records(job->context, job->records.data, job->records.count);
    STARG_ARRAY_FREE(job->context, &job->chosen);
    STARG_ARRAY_FREE(job->context, &job->levels);
    column_weights_free(job->context, &job->weights);
    pool_free(&job->pool);
    starg_solid_free(job->samples);
    starg_levels_free(job->context, job->detail);
}

starg_status starg_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guard_options defaults;
    starg_guard_options_default(&defaults);
    starg_guard_options used = options ? *options : defaults;
    guard_job job = {.context = context, .solid = solid, .options = &used};
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    STARG_TRY(check_options(context, job.options));
    STARG_TRY(pool_create(context, solid, job.options, &job.pool));
    STARG_TRY(
        column_weights_create(context, solid->mesh, job.options->visibility.target, &job.weights));
    STARG_TRY(make_levels(&job));
    STARG_TRY(choose_samples(&job));
    STARG_TRY(make_candidates(&job));
    STARG_TRY(complete_pool(&job));
    STARG_TRY(choose(&job));
    STARG_TRY(report(&job, out));
done:
    job_free(&job);
    return status;
}

static starg_status choose_all(guard_job *job) {
    starg_status status = STARG_OK;
    size_t given = job->options->point_count;
    for (uint32_t i = 0; i < pool_count(&job->pool); i++) {
        STARG_PUSH(job->context, STAGE, &job->chosen, i);
        STARG_PUSH(job->context, STAGE, &job->levels, 0);
    }
    if (given == 0 || job->chosen.count != given)
        status = starg_fail(job->context, STARG_ERROR_ARGUMENT, STAGE,
                            "%zu of %zu given guards are strictly inside the solid; there must be "
                            "guards, and all of them inside",
                            job->chosen.count, given);
done:
    return status;
}

starg_status starg_guards_given(starg_context *context, const starg_solid *solid,
                                const double *points, size_t count, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guard_options used;
    starg_guard_options_default(&used);
    used.method = STARG_GUARD_ILP;
    used.candidates = STARG_CANDIDATES_GIVEN;
    used.candidate_count = used.point_count = count;
    used.points = points;
    guard_job job = {.context = context, .solid = solid, .options = &used};
    /* what stands already is measured in full */
    starg_time_rule former = starg_time_begin(context, STARG_TIME_IGNORED);
    *out = NULL;
    set_defaults(&used, solid->mesh->vertex_count);
    STARG_TRY(pool_create(context, solid, job.options, &job.pool));
    STARG_TRY(column_weights_create(context, solid->mesh, used.visibility.target, &job.weights));
    STARG_TRY(make_candidates(&job));
    STARG_TRY(choose_all(&job));
    STARG_TRY(report(&job, out));
done:
    starg_time_end(context, former);
    job_free(&job);
    return status;
}

void starg_guards_free(starg_context *context, starg_guards *guards) {
    if (guards == NULL)
        return;
    starg_release(context, guards->file);
    starg_release(context, guards->positions);
    starg_release(context, guards->directions);
    starg_release(context, guards->seen_faces);
    starg_release(context, guards->levels);
    free_records(context, guards->level_list, guards->level_count);
    starg_release(context, guards->curve_faces);
    starg_release(context, guards->curve_area);
    starg_release(context, guards->uncovered);
    starg_release(context, guards->uncovered_vertices);
    starg_release(context, guards);
}
