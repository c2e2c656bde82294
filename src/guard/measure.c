/* SPDX-License-Identifier: Apache-2.0 */
/* The result: what a set of guards sees, recomputed from their positions. */
#include "geometry/vec3.h"
#include "guard/baseline.h"
#include "guard/stages.h"
#include "visibility/scene.h"

static const char STAGE[] = "guard";

/* Uses the fastest engine, whichever chose the guards: all give the same bits, and results are
 * measured in full even after the time limit. */
static starg_visibility_options view_of(const guard_problem *problem, starg_target target,
                                        const double *directions, const double *ups) {
    starg_visibility_options view = problem->options->visibility;
    view.engine = STARG_VISIBILITY_FASTEST;
    view.target = target;
    view.directions = directions;
    view.ups = ups;
    return view;
}

/* Lists the targets that are not in `joined`; `skip` (may be NULL) leaves some out. */
static starg_status list_missing(const guard_problem *problem, const uint64_t *joined,
                                 starg_target target, const uint64_t *skip, uint32_t **missing,
                                 size_t *count) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = problem->solid->mesh;
    bool vertices = target == STARG_TARGET_VERTICES;
    size_t columns = vertices ? mesh->vertex_count : mesh->face_count;
    STARG_NEW(problem->context, STAGE, *missing, columns);
    for (size_t j = 0; j < columns; j++)
        if (!starg_bit_test(joined, j) && solid_is_target(problem->solid, vertices, j) &&
            (skip == NULL || !starg_bit_test(skip, j)))
            (*missing)[(*count)++] = (uint32_t)j;
done:
    return status;
}

/* The faces and the area that the first k guards see together, for each k; `joined` ends as what
 * all of them see. */
static starg_status measure_curve(const guard_problem *problem, const starg_bits *seen,
                                  uint64_t *joined, starg_guards *result) {
    starg_status status = STARG_OK;
    size_t faces = 0;
    double area = 0;
    STARG_NEW(problem->context, STAGE, result->curve_faces, result->count);
    STARG_NEW(problem->context, STAGE, result->curve_area, result->count);
    for (size_t i = 0; i < result->count; i++) {
        for (size_t w = 0; w < seen->words; w++) {
            uint64_t fresh = starg_bits_row(seen, i)[w] & ~joined[w];
            joined[w] |= fresh;
            STARG_FOR_BITS (bit, fresh) {
                faces++;
                area += problem->weights.areas[64 * w + bit];
            }
        }
        bool all = faces == problem->weights.faces;
        result->curve_faces[i] = (double)faces / (double)problem->weights.faces;
        result->curve_area[i] =
            all || !(problem->weights.area > 0) ? 1 : area / problem->weights.area;
    }
done:
    return status;
}

/* The number of faces that two guards at least the baseline apart see. */
static size_t count_paired(const guard_problem *problem, const starg_bits *seen,
                           const starg_guards *result) {
    double cosine = starg_cone_cosine(2 * problem->options->baseline);
    size_t paired = 0;
    for (size_t f = 0; problem->options->baseline > 0 && f < seen->columns; f++) {
        bool found = false;
        for (size_t i = 0; i < result->count && !found; i++)
            for (size_t j = i + 1; starg_bits_test(seen, i, f) && j < result->count && !found; j++)
                found = starg_bits_test(seen, j, f) &&
                        baseline_holds(problem->solid->mesh, f, cosine, result->positions + 3 * i,
                                       result->positions + 3 * j);
        paired += found;
    }
    return paired;
}

/* The numbers of faces that at least 1, 2, ... guards see, up to the redundancy. */
static starg_status measure_redundancy(const guard_problem *problem, const starg_bits *seen,
                                       starg_guards *result) {
    starg_status status = STARG_OK;
    size_t most = problem->options->redundancy;
    if (most < 2)
        return STARG_OK;
    STARG_NEW_ZERO(problem->context, STAGE, result->redundant_faces, most);
    result->redundant_count = most;
    for (size_t f = 0; f < seen->columns; f++) {
        size_t times = 0;
        for (size_t i = 0; i < result->count; i++)
            times += starg_bits_test(seen, i, f);
        for (size_t k = 0; k < most && k < times; k++)
            result->redundant_faces[k]++;
    }
done:
    return status;
}

static starg_status measure_faces(const guard_problem *problem, starg_guards *result) {
    starg_status status = STARG_OK;
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_FACES, result->directions, result->ups);
    starg_bits *seen = NULL;
    uint64_t *joined = NULL;
    STARG_TRY(starg_visibility(problem->context, problem->solid, result->positions, result->count,
                               &options, &seen));
    for (size_t i = 0; i < result->count; i++)
        result->seen_faces[i] = starg_bits_count(seen, i);
    STARG_NEW_ZERO(problem->context, STAGE, joined, seen->words);
    STARG_TRY(measure_curve(problem, seen, joined, result));
    STARG_TRY(list_missing(problem, joined, STARG_TARGET_FACES, NULL, &result->uncovered,
                           &result->uncovered_count));
    result->baseline_faces = count_paired(problem, seen, result);
    STARG_TRY(measure_redundancy(problem, seen, result));
    result->coverage_faces = result->count > 0 ? result->curve_faces[result->count - 1] : 0;
    result->coverage_area = result->count > 0 ? result->curve_area[result->count - 1] : 0;
done:
    starg_bits_free(seen);
    starg_release(problem->context, joined);
    return status;
}

/* Bits of the vertices that no face uses: they are not targets. *used_count: number of used
 * vertices. */
static starg_status find_unused(const guard_problem *problem, uint64_t **unused,
                                size_t *used_count) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = problem->solid->mesh;
    size_t words = starg_bit_words(mesh->vertex_count);
    STARG_NEW(problem->context, STAGE, *unused, words);
    memset(*unused, 0xff, words * sizeof **unused);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        starg_bit_clear(*unused, mesh->faces[i]);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        *used_count += !starg_bit_test(*unused, v) && solid_is_target(problem->solid, true, v);
done:
    return status;
}

static starg_status measure_vertices(const guard_problem *problem, const guard_pool *pool,
                                     starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *seen = NULL;
    uint64_t *joined = NULL, *unused = NULL;
    size_t used = 0;
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_VERTICES, result->directions, result->ups);
    STARG_TRY(find_unused(problem, &unused, &used));
    STARG_TRY(visibility_rows(problem->context, problem->solid, result->positions, result->count,
                              &options, NULL, &seen));
    STARG_TRY(pool_join_rows(problem->context, seen, &joined));
    STARG_TRY(list_missing(problem, joined, STARG_TARGET_VERTICES, unused,
                           &result->uncovered_vertices, &result->uncovered_vertex_count));
    result->coverage_vertices = (double)(used - result->uncovered_vertex_count) / (double)used;
    result->coverable_vertices = starg_bit_count(pool->coverable, pool->rows->words);
done:
    starg_bits_free(seen);
    starg_release(problem->context, joined);
    starg_release(problem->context, unused);
    return status;
}

/* The number of faces that some candidate sees; with vertices as the target the rows do not
 * tell. */
static starg_status count_coverable_faces(const guard_problem *problem, const guard_pool *pool,
                                          starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *rows = NULL;
    uint64_t *joined = NULL;
    if (problem->options->visibility.target == STARG_TARGET_FACES) {
        result->coverable_faces = starg_bit_count(pool->coverable, pool->rows->words);
        return STARG_OK;
    }
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_FACES, pool->points.directions.data, pool->points.ups.data);
    STARG_TRY(starg_visibility(problem->context, problem->solid, pool->points.data.data,
                               pool_count(pool), &options, &rows));
    STARG_TRY(pool_join_rows(problem->context, rows, &joined));
    result->coverable_faces = starg_bit_count(joined, rows->words);
done:
    starg_bits_free(rows);
    starg_release(problem->context, joined);
    return status;
}

static starg_status measure_guards(const guard_problem *problem, const guard_pool *pool,
                                   starg_guards *result) {
    starg_status status = STARG_OK;
    STARG_TRY(measure_faces(problem, result));
    STARG_TRY(count_coverable_faces(problem, pool, result));
    if (problem->options->visibility.target == STARG_TARGET_VERTICES)
        STARG_TRY(measure_vertices(problem, pool, result));
done:
    return status;
}

/* The up vector of a candidate, as it is written to the file. */
static void resolve_up(const starg_visibility_options *view, const double *given, double up[3]) {
    const double y[3] = {0, 1, 0}, none[3] = {0, 0, 0};
    vec3_copy(!vec3_equal(given, none) ? given : !vec3_equal(view->up, none) ? view->up : y, up);
}

static starg_status copy_choice(const guard_problem *problem, const guard_pool *pool,
                                const guard_selection *selection, starg_guards *result) {
    starg_status status = STARG_OK;
    size_t count = selection->chosen.count;
    STARG_NEW(problem->context, STAGE, result->positions, 3 * count);
    const starg_visibility_options *view = &problem->options->visibility;
    if (sensor_is_directed(view))
        STARG_NEW(problem->context, STAGE, result->directions, 3 * count);
    if (view->fov[0] > 0)
        STARG_NEW(problem->context, STAGE, result->ups, 3 * count);
    STARG_NEW(problem->context, STAGE, result->levels, count);
    STARG_NEW_ZERO(problem->context, STAGE, result->seen_faces, count);
    result->count = count;
    for (size_t i = 0; i < count; i++) {
        uint32_t candidate = selection->chosen.data[i];
        vec3_copy(pool_point(pool, candidate), result->positions + 3 * i);
        if (result->directions != NULL)
            vec3_copy(pool_direction(pool, candidate), result->directions + 3 * i);
        if (result->ups != NULL)
            resolve_up(view, pool_up(pool, candidate), result->ups + 3 * i);
        result->levels[i] = selection->levels.data[i];
    }
done:
    return status;
}

/* Is the bounded weight the visible area? Not with vertices, nor if a face counts only once several
 * guards see it. */
static bool bounds_area(const starg_guard_options *o) {
    return o->max_guards > 0 && o->redundancy == 1 && o->visibility.target == STARG_TARGET_FACES;
}

static void copy_facts(const guard_problem *problem, const guard_outcome *outcome,
                       starg_guards *result) {
    const guard_selection *selection = &outcome->selection;
    result->vertex_count = starg_space_model_vertices(problem->solid);
    result->face_count = starg_space_model_faces(problem->solid);
    result->options = *problem->options;
    result->seed = problem->context->seed;
    result->options.points = result->options.directions = result->options.ups = NULL;
    result->options.visibility.directions = result->options.visibility.ups = NULL;
    result->candidate_count = pool_count(&outcome->pool);
    result->unseen_count = outcome->pool.unseen;
    result->lines_tested = outcome->search.improve_work;
    result->time_limited = selection->time_limited;
    result->area_bound = 1;
    if (bounds_area(problem->options))
        result->area_bound = (double)selection->weight_bound / (double)problem->weights.total;
    if (problem->options->visibility.target == STARG_TARGET_FACES)
        result->area_bound_everywhere =
            (double)outcome->search.weight_bound / (double)problem->weights.total;
    result->lower_bound = selection->lower_bound;
    result->optimal = selection->chosen.count == selection->lower_bound;
    result->lower_bound_everywhere = outcome->search.bound;
    result->optimal_everywhere = selection->chosen.count == outcome->search.bound;
    result->cells = outcome->search.cells;
    result->witnesses = outcome->search.witnesses;
    result->prove_work = outcome->search.prove_work;
}

/* The faces that had to be seen, unless all count alike. */
static starg_status list_targets(const guard_problem *problem, starg_guards *result) {
    starg_status status = STARG_OK;
    const double *importance = problem->solid->importance;
    bool alike = true;
    for (size_t f = 0; importance != NULL && f < result->face_count; f++)
        alike = alike && importance[f] == 1;
    if (alike)
        return STARG_OK;
    STARG_NEW(problem->context, STAGE, result->targets, problem->weights.faces);
    STARG_NEW(problem->context, STAGE, result->importance, problem->weights.faces);
    for (size_t f = 0; f < result->face_count; f++)
        if (importance[f] > 0) {
            result->targets[result->target_count] = (uint32_t)f;
            result->importance[result->target_count++] = importance[f];
        }
done:
    return status;
}

static starg_status copy_list(starg_context *context, const near_faces *faces, uint32_t **out) {
    starg_status status = STARG_OK;
    uint32_t *list = NULL;
    if (faces->count == 0)
        return STARG_OK;
    STARG_NEW(context, STAGE, list, faces->count);
    memcpy(list, faces->list, faces->count * sizeof *list);
    *out = list;
done:
    return status;
}

static starg_status copy_scene(const guard_problem *problem, starg_guards *result) {
    starg_status status = STARG_OK;
    const starg_solid *scene = problem->solid;
    starg_space_options_default(&result->space);
    if (scene->scene)
        result->space = scene->space;
    result->space.over = result->space.mount = NULL;
    STARG_TRY(copy_list(problem->context, &scene->over, &result->space.over));
    STARG_TRY(copy_list(problem->context, &scene->mount, &result->space.mount));
    if (scene->obstacle_count > 0)
        STARG_NEW_ZERO(problem->context, STAGE, result->obstacles, scene->obstacle_count);
    result->obstacle_count = scene->obstacle_count;
    for (size_t i = 0; i < scene->obstacle_count; i++) {
        result->obstacles[i].vertex_count = scene->obstacle_sizes[2 * i];
        result->obstacles[i].face_count = scene->obstacle_sizes[2 * i + 1];
    }
    status = list_targets(problem, result);
done:
    return status;
}

starg_status report_guards(const guard_problem *problem, guard_outcome *outcome,
                           starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guards *result = NULL;
    /* results so far are measured in full */
    starg_time_rule former = starg_time_begin(problem->context, STARG_TIME_IGNORED);
    STARG_NEW_ZERO(problem->context, STAGE, result, 1);
    copy_facts(problem, outcome, result);
    STARG_TRY(copy_scene(problem, result));
    STARG_TRY(copy_choice(problem, &outcome->pool, &outcome->selection, result));
    STARG_TRY(measure_guards(problem, &outcome->pool, result));
    result->level_list = outcome->records.data;
    result->level_count = outcome->records.count;
    outcome->records.data = NULL;
    outcome->records.count = outcome->records.capacity = 0;
    *out = result;
done:
    starg_time_end(problem->context, former);
    if (status != STARG_OK)
        starg_guards_free(problem->context, result);
    return status;
}
