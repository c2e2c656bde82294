/* SPDX-License-Identifier: Apache-2.0 */
/* The result: what a set of guards sees, recomputed from their positions. */
#include "geometry/vec3.h"
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

static size_t count_faces(const starg_solid *solid, const uint64_t *row) {
    size_t count = 0, faces = starg_space_model_faces(solid); /* others are no targets */
    if (solid->patches == NULL)
        return starg_bit_count(row, starg_bit_words(faces));
    for (size_t f = 0; f < faces; f++)
        count += solid_is_target(solid, false, f) && solid_holds_face(solid, row, f);
    return count;
}

/* Of a face, the share of the area in a row. */
static double share_of_face(const starg_solid *solid, const uint64_t *row, size_t face) {
    double share = 0;
    for (size_t j = solid_first_patch(solid, face); j < solid_first_patch(solid, face + 1); j++)
        if (starg_bit_test(row, j))
            share += solid->patches != NULL ? solid->patches->share.data[j] : 1;
    return share;
}

/* Lists the faces of which the guards do not see all, and shares where they see something. */
static starg_status list_uncovered(const guard_problem *problem, const uint64_t *joined,
                                   starg_guards *result) {
    const starg_solid *solid = problem->solid;
    size_t faces = starg_space_model_faces(solid);
    NEW(problem->context, STAGE, result->uncovered, faces);
    NEW(problem->context, STAGE, result->partial, faces);
    NEW(problem->context, STAGE, result->partial_share, faces);
    for (size_t f = 0; f < faces; f++) {
        if (!solid_is_target(solid, false, f) || solid_holds_face(solid, joined, f))
            continue;
        double share = share_of_face(solid, joined, f);
        result->uncovered[result->uncovered_count++] = (uint32_t)f;
        if (share > 0) {
            result->partial_share[result->partial_count] = share;
            result->partial[result->partial_count++] = (uint32_t)f;
        }
    }
    return STARG_OK;
}

/* The faces and the area that the first k guards see together, for each k; `joined` ends as what
 * all of them see. */
static starg_status measure_curve(const guard_problem *problem, const starg_bits *seen,
                                  uint64_t *joined, starg_guards *result) {
    double area = 0;
    NEW(problem->context, STAGE, result->curve_faces, result->count);
    NEW(problem->context, STAGE, result->curve_area, result->count);
    for (size_t i = 0; i < result->count; i++) {
        for (size_t w = 0; w < seen->words; w++) {
            uint64_t fresh = starg_bits_row(seen, i)[w] & ~joined[w];
            joined[w] |= fresh;
            STARG_FOR_BITS (bit, fresh)
                area += problem->weights.areas[64 * w + bit];
        }
        size_t faces = count_faces(problem->solid, joined);
        bool all = faces == problem->weights.faces;
        result->curve_faces[i] = (double)faces / (double)problem->weights.faces;
        result->curve_area[i] =
            all || !(problem->weights.area > 0) ? 1 : fmin(area / problem->weights.area, 1);
    }
    return STARG_OK;
}

/* Do two guards at least the baseline apart see the patch? */
static bool is_paired(const guard_problem *problem, const starg_bits *seen, size_t patch,
                      double cosine, const starg_guards *result) {
    for (size_t i = 0; i < result->count; i++)
        for (size_t j = i + 1; starg_bits_test(seen, i, patch) && j < result->count; j++)
            if (starg_bits_test(seen, j, patch) &&
                baseline_holds(problem->solid, patch, cosine, result->positions + 3 * i,
                               result->positions + 3 * j))
                return true;
    return false;
}

/* The number of faces of which such guards see each patch. */
static size_t count_paired(const guard_problem *problem, const starg_bits *seen,
                           const starg_guards *result) {
    const starg_solid *solid = problem->solid;
    double cosine = starg_cone_cosine(2 * problem->options->baseline);
    size_t paired = 0;
    for (size_t f = 0; problem->options->baseline > 0 && f < starg_space_model_faces(solid); f++) {
        bool all = true;
        for (size_t j = solid_first_patch(solid, f); j < solid_first_patch(solid, f + 1); j++)
            all = all && is_paired(problem, seen, j, cosine, result);
        paired += all;
    }
    return paired;
}

/* How many guards see each patch of the face. */
static size_t least_times(const starg_solid *solid, const starg_bits *seen, size_t face) {
    size_t least = SIZE_MAX;
    for (size_t j = solid_first_patch(solid, face); j < solid_first_patch(solid, face + 1); j++) {
        size_t times = 0;
        for (size_t i = 0; i < seen->rows; i++)
            times += starg_bits_test(seen, i, j);
        least = times < least ? times : least;
    }
    return least;
}

/* The numbers of faces that at least 1, 2, ... guards see, up to the redundancy. */
static starg_status measure_redundancy(const guard_problem *problem, const starg_bits *seen,
                                       starg_guards *result) {
    size_t most = problem->options->redundancy;
    if (most < 2)
        return STARG_OK;
    NEW_ZERO(problem->context, STAGE, result->redundant_faces, most);
    result->redundant_count = most;
    for (size_t f = 0; f < starg_space_model_faces(problem->solid); f++) {
        size_t times = least_times(problem->solid, seen, f);
        for (size_t k = 0; k < most && k < times; k++)
            result->redundant_faces[k]++;
    }
    return STARG_OK;
}

/* How many of the faces with needs of their own have what they need? */
static size_t count_met(const guard_problem *problem, const starg_bits *seen,
                        const starg_guards *result) {
    size_t met = 0;
    for (size_t i = 0; i < result->need_count; i++) {
        uint32_t times = result->needs[i].times;
        times = times > 0 ? times : problem->options->redundancy;
        met += least_times(problem->solid, seen, result->needs[i].face) >= times;
    }
    return met;
}

static starg_status measure_faces(const guard_problem *problem, const guard_pool *pool,
                                  starg_guards *result) {
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_FACES, result->directions, result->ups);
    SCOPED_BY(starg_bits_drop) starg_bits *found = NULL;
    SCOPED uint64_t *joined = NULL;
    if (!problem->audited)
        TRY(starg_visibility(problem->context, problem->solid, result->positions, result->count,
                             &options, &found));
    const starg_bits *seen = problem->audited ? pool->rows : found;
    for (size_t i = 0; i < result->count; i++)
        result->seen_faces[i] = count_faces(problem->solid, starg_bits_row(seen, i));
    NEW_ZERO(problem->context, STAGE, joined, seen->words);
    TRY(measure_curve(problem, seen, joined, result));
    TRY(list_uncovered(problem, joined, result));
    result->baseline_faces = count_paired(problem, seen, result);
    TRY(measure_redundancy(problem, seen, result));
    result->met_needs = count_met(problem, seen, result);
    result->coverage_faces = result->count > 0 ? result->curve_faces[result->count - 1] : 0;
    result->coverage_area = result->count > 0 ? result->curve_area[result->count - 1] : 0;
    return STARG_OK;
}

/* Bits of the vertices that no face uses: they are not targets. *used_count: number of used
 * vertices. */
static starg_status find_unused(const guard_problem *problem, uint64_t **unused,
                                size_t *used_count) {
    const starg_mesh *mesh = problem->solid->mesh;
    size_t words = starg_bit_words(mesh->vertex_count);
    NEW(problem->context, STAGE, *unused, words);
    memset(*unused, 0xff, words * sizeof **unused);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        starg_bit_clear(*unused, mesh->faces[i]);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        *used_count += !starg_bit_test(*unused, v) && solid_is_target(problem->solid, true, v);
    return STARG_OK;
}

/* The target vertices that are neither in `joined` nor unused. */
static starg_status list_missing_vertices(const guard_problem *problem, const uint64_t *joined,
                                          const uint64_t *unused, starg_guards *result) {
    size_t count = problem->solid->mesh->vertex_count;
    NEW(problem->context, STAGE, result->uncovered_vertices, count);
    for (size_t v = 0; v < count; v++)
        if (!starg_bit_test(joined, v) && !starg_bit_test(unused, v) &&
            solid_is_target(problem->solid, true, v))
            result->uncovered_vertices[result->uncovered_vertex_count++] = (uint32_t)v;
    return STARG_OK;
}

static starg_status measure_vertices(const guard_problem *problem, const guard_pool *pool,
                                     starg_guards *result) {
    SCOPED_BY(starg_bits_drop) starg_bits *seen = NULL;
    SCOPED uint64_t *joined = NULL, *unused = NULL;
    size_t used = 0;
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_VERTICES, result->directions, result->ups);
    TRY(find_unused(problem, &unused, &used));
    TRY(visibility_rows(problem->context, problem->solid, result->positions, result->count,
                        &options, NULL, &seen));
    TRY(pool_join_rows(problem->context, seen, &joined));
    TRY(list_missing_vertices(problem, joined, unused, result));
    result->coverage_vertices = (double)(used - result->uncovered_vertex_count) / (double)used;
    result->coverable_vertices = starg_bit_count(pool->coverable, starg_bit_words(pool->columns));
    return STARG_OK;
}

/* The number of faces that some candidate sees; with vertices as the target the rows do not
 * tell. */
static starg_status count_coverable_faces(const guard_problem *problem, const guard_pool *pool,
                                          starg_guards *result) {
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    SCOPED uint64_t *joined = NULL;
    if (problem->options->visibility.target == STARG_TARGET_FACES) {
        result->coverable_faces = count_faces(pool->solid, pool->coverable);
        return STARG_OK;
    }
    const starg_visibility_options options =
        view_of(problem, STARG_TARGET_FACES, pool->points.directions.data, pool->points.ups.data);
    TRY(starg_visibility(problem->context, problem->solid, pool->points.data.data, pool_count(pool),
                         &options, &rows));
    TRY(pool_join_rows(problem->context, rows, &joined));
    result->coverable_faces = starg_bit_count(joined, rows->words);
    return STARG_OK;
}

static starg_status measure_guards(const guard_problem *problem, const guard_pool *pool,
                                   starg_guards *result) {
    TRY(measure_faces(problem, pool, result));
    TRY(count_coverable_faces(problem, pool, result));
    if (problem->options->visibility.target == STARG_TARGET_VERTICES)
        TRY(measure_vertices(problem, pool, result));
    return STARG_OK;
}

/* The up vector of a candidate, as it is written to the file. */
static void resolve_up(const starg_visibility_options *view, const double *given, double up[3]) {
    const double y[3] = {0, 1, 0}, none[3] = {0, 0, 0};
    vec3_copy(!vec3_equal(given, none) ? given : !vec3_equal(view->up, none) ? view->up : y, up);
}

static void copy_pose(const starg_visibility_options *view, const double *p,
                      const double *direction, const double *up, size_t i, starg_guards *result) {
    vec3_copy(p, result->positions + 3 * i);
    if (result->directions != NULL)
        vec3_copy(direction, result->directions + 3 * i);
    if (result->ups != NULL)
        resolve_up(view, up, result->ups + 3 * i);
}

static starg_status copy_choice(const guard_problem *problem, const guard_pool *pool,
                                const guard_selection *selection, starg_guards *result) {
    const kept_guards *kept = problem->kept;
    size_t stay = kept != NULL ? candidates_count(&kept->poses) : 0;
    size_t count = stay + selection->chosen.count;
    NEW(problem->context, STAGE, result->positions, 3 * count);
    const starg_visibility_options *view = &problem->options->visibility;
    if (sensor_is_directed(view))
        NEW(problem->context, STAGE, result->directions, 3 * count);
    if (view->fov[0] > 0)
        NEW(problem->context, STAGE, result->ups, 3 * count);
    NEW(problem->context, STAGE, result->levels, count);
    NEW_ZERO(problem->context, STAGE, result->seen_faces, count);
    result->count = count;
    if (stay > 0)
        NEW_ZERO(problem->context, STAGE, result->kept, count);
    for (size_t i = 0; i < stay; i++) {
        copy_pose(view, kept->poses.data.data + 3 * i, kept->poses.directions.data + 3 * i,
                  kept->poses.ups.data + 3 * i, i, result);
        result->levels[i] = 0;
        result->kept[i] = true;
    }
    for (size_t i = stay; i < count; i++) {
        uint32_t candidate = selection->chosen.data[i - stay];
        copy_pose(view, pool_point(pool, candidate), pool_direction(pool, candidate),
                  pool_up(pool, candidate), i, result);
        result->levels[i] = selection->levels.data[i - stay];
    }
    return STARG_OK;
}

/* Is the bounded weight the visible area? Not with vertices, nor if a face counts only once several
 * guards see it. */
static bool bounds_area(const guard_problem *problem) {
    const starg_guard_options *o = problem->options;
    return o->max_guards > 0 && o->redundancy == 1 && problem->solid->times == NULL &&
           o->visibility.target == STARG_TARGET_FACES;
}

static void copy_facts(const guard_problem *problem, const guard_outcome *outcome,
                       starg_guards *result) {
    const guard_selection *selection = &outcome->selection;
    uint64_t kept = problem->kept != NULL ? problem->kept->weight : 0;
    result->vertex_count = starg_space_model_vertices(problem->solid);
    result->face_count = starg_space_model_faces(problem->solid);
    result->options = *problem->options;
    result->seed = problem->context->seed;
    result->options.points = result->options.directions = result->options.ups = NULL;
    result->options.keep = result->options.keep_directions = result->options.keep_ups = NULL;
    result->options.visibility.directions = result->options.visibility.ups = NULL;
    result->candidate_count = pool_count(&outcome->pool);
    result->unseen_count = outcome->pool.unseen;
    result->lines_tested = outcome->search.improve_work;
    result->time_limited = selection->time_limited;
    result->area_bound = 1;
    if (bounds_area(problem))
        result->area_bound =
            (double)(kept + selection->weight_bound) / (double)problem->weights.total;
    if (bounds_area(problem) && outcome->search.weight_bound > 0)
        result->area_bound_everywhere =
            (double)(kept + outcome->search.weight_bound) / (double)problem->weights.total;
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
    const double *importance = problem->solid->importance;
    bool alike = true;
    for (size_t f = 0; importance != NULL && f < result->face_count; f++)
        alike = alike && importance[f] == 1;
    if (alike)
        return STARG_OK;
    NEW(problem->context, STAGE, result->targets, problem->weights.faces);
    NEW(problem->context, STAGE, result->importance, problem->weights.faces);
    for (size_t f = 0; f < result->face_count; f++)
        if (importance[f] > 0) {
            result->targets[result->target_count] = (uint32_t)f;
            result->importance[result->target_count++] = importance[f];
        }
    return STARG_OK;
}

static starg_status copy_list(starg_context *context, const near_faces *faces, uint32_t **out) {
    uint32_t *list = NULL;
    if (faces->count == 0)
        return STARG_OK;
    NEW(context, STAGE, list, faces->count);
    memcpy(list, faces->list, faces->count * sizeof *list);
    *out = list;
    return STARG_OK;
}

static starg_status copy_needs(starg_context *context, const starg_solid *scene,
                               starg_guards *result) {
    size_t faces = starg_space_model_faces(scene);
    if (scene->times == NULL)
        return STARG_OK;
    NEW(context, STAGE, result->needs, faces);
    for (uint32_t f = 0; f < faces; f++)
        if (scene->times[f] > 0 || scene->density[f] != 0)
            result->needs[result->need_count++] =
                (starg_face_need){f, scene->times[f], scene->density[f]};
    return STARG_OK;
}

static starg_status copy_zones(starg_context *context, const zones *from, starg_guards *result) {
    if (from->count == 0)
        return STARG_OK;
    NEW_ZERO(context, STAGE, result->zones, from->count);
    result->zone_count = from->count;
    for (size_t i = 0; i < from->count; i++) {
        starg_guard_zone *own = &result->zones[i];
        own->excludes = from->list[i].excludes;
        vec3_copy(from->list[i].box.lower, own->box);
        vec3_copy(from->list[i].box.upper, own->box + 3);
        own->vertex_count = from->list[i].vertices;
        own->face_count = from->list[i].faces;
    }
    return STARG_OK;
}

static starg_status copy_scene(const guard_problem *problem, starg_guards *result) {
    const starg_solid *scene = problem->solid;
    starg_space_options_default(&result->space);
    if (scene->scene)
        result->space = scene->space;
    result->space.over = result->space.mount = NULL;
    result->space.zone_count = 0;
    result->space.clear = NULL;
    const near_faces clear = {.count = scene->clear != NULL ? scene->space.clear_count : 0,
                              .list = scene->clear_list};
    TRY(copy_list(problem->context, &clear, &result->space.clear));
    TRY(copy_needs(problem->context, scene, result));
    TRY(copy_zones(problem->context, &scene->zones, result));
    TRY(copy_list(problem->context, &scene->over, &result->space.over));
    TRY(copy_list(problem->context, &scene->mount, &result->space.mount));
    if (scene->obstacle_count > 0)
        NEW_ZERO(problem->context, STAGE, result->obstacles, scene->obstacle_count);
    result->obstacle_count = scene->obstacle_count;
    for (size_t i = 0; i < scene->obstacle_count; i++) {
        result->obstacles[i].vertex_count = scene->obstacle_sizes[2 * i];
        result->obstacles[i].face_count = scene->obstacle_sizes[2 * i + 1];
    }
    return list_targets(problem, result);
}

static starg_status copy_steps(starg_context *context, const search_record *from,
                               starg_guards *result) {
    NEW(context, STAGE, result->step_work, from->step_count);
    NEW(context, STAGE, result->step_guards, from->step_count);
    result->step_count = from->step_count;
    for (size_t i = 0; i < from->step_count; i++) {
        result->step_work[i] = from->steps[i].work;
        result->step_guards[i] = from->steps[i].count;
    }
    return STARG_OK;
}

/* What is proven of every point, in place of what is seen of faces by their corners. */
static starg_status measure_points(const guard_problem *problem, const point_coverage *coverage,
                                   starg_guards *result) {
    const starg_solid *solid = problem->solid;
    size_t faces = starg_space_model_faces(solid), all = solid->mesh->face_count;
    const column_weights *weights = &problem->weights;
    SCOPED double *share = NULL;
    double area = 0, open = 0;
    NEW_ZERO(problem->context, STAGE, share, faces);
    result->uncovered_count = result->partial_count = 0;
    for (size_t g = 0; g < result->count; g++) {
        size_t whole = 0;
        for (size_t f = 0; f < faces; f++) {
            share[f] += coverage->share[g * all + f];
            area += weights->areas[f] * coverage->share[g * all + f];
            whole += solid_is_target(solid, false, f) && share[f] == 1;
        }
        result->curve_faces[g] = (double)whole / (double)weights->faces;
        result->curve_area[g] =
            whole == weights->faces || !(weights->area > 0) ? 1 : fmin(area / weights->area, 1);
    }
    for (size_t f = 0; f < faces; f++) {
        if (!solid_is_target(solid, false, f) || share[f] == 1)
            continue;
        open += weights->areas[f] * coverage->open[f];
        result->uncovered[result->uncovered_count++] = (uint32_t)f;
        if (share[f] > 0) {
            result->partial_share[result->partial_count] = share[f];
            result->partial[result->partial_count++] = (uint32_t)f;
        }
    }
    result->coverage_faces = result->count > 0 ? result->curve_faces[result->count - 1] : 0;
    result->coverage_area = result->count > 0 ? result->curve_area[result->count - 1] : 0;
    result->points_complete = result->uncovered_count == 0;
    result->points_seen = result->coverage_area;
    result->points_open =
        result->points_complete || !(weights->area > 0) ? 0 : fmin(open / weights->area, 1);
    return STARG_OK;
}

starg_status report_guards(const guard_problem *problem, guard_outcome *outcome,
                           const point_coverage *coverage, starg_guards **out) {
    SCOPED_BY(starg_guards_drop) starg_guards *result = NULL;
    /* results so far are measured in full */
    TIME_RULE(problem->context, STARG_TIME_IGNORED);
    NEW_ZERO(problem->context, STAGE, result, 1);
    copy_facts(problem, outcome, result);
    TRY(copy_scene(problem, result));
    TRY(copy_choice(problem, &outcome->pool, &outcome->selection, result));
    TRY(measure_guards(problem, &outcome->pool, result));
    if (coverage != NULL)
        TRY(measure_points(problem, coverage, result));
    TRY(copy_steps(problem->context, &outcome->search, result));
    result->level_list = outcome->records.data;
    result->level_count = outcome->records.count;
    outcome->records.data = NULL;
    result->worth_count = outcome->worth.count;
    result->worth_seen = outcome->worth.seen;
    result->worth_bound = outcome->worth.bound;
    outcome->worth = (guard_worth){0};
    result->tour = outcome->tour;
    outcome->tour = (starg_tour){0};
    if (problem->options->worth) {
        result->rows = outcome->pool.rows;
        outcome->pool.rows = NULL;
    }
    outcome->records.count = outcome->records.capacity = 0;
    *out = result;
    result = NULL;
    return STARG_OK;
}
