/* SPDX-License-Identifier: Apache-2.0 */
/* The points of a search: where guards may stand, as far as is known, and the witnesses that each
 * sees.
 *
 * They are the candidates, whose rows are known, places of the medial axis, and later moved points
 * and points of cells. A point that other steps want to know all about becomes a candidate.
 *
 * Invariant: `seen` of each point is exact for all witnesses. Cost: a sight line for each point and
 * new witness; pruning compares each new point with all. */
#include "core/parallel.h"
#include "geometry/vec3.h"
#include "guard/prices.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { COMPARED = 300 }; /* comparisons of points that take as long as a test */

typedef struct looking {
    const search_scene *scene;
    search_point *points;
    uint64_t *work; /* by item */
    const witness_row *among;
} looking;

static starg_status look_from_item(starg_context *context, void *shared, void *scratch,
                                   size_t item) {
    looking *l = shared;
    (void)context;
    (void)scratch;
    if (l->points[item].candidate == UINT32_MAX)
        l->work[item] = search_scene_look(l->scene, &l->points[item], l->among);
    return STARG_OK;
}

starg_status points_look_at(const search_scene *scene, search_point *points, size_t count,
                            const witness_row *among, uint64_t *work) {
    SCOPED uint64_t *of_items = NULL;
    NEW_ZERO(scene->context, STAGE, of_items, count);
    looking l = {scene, points, of_items, among};
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = &l, .item = look_from_item, .silent = true};
    TRY(starg_parallel_for(scene->context, &loop));
    for (size_t i = 0; i < count; i++)
        *work += of_items[i];
    return STARG_OK;
}

starg_status points_look(const search_scene *scene, const guard_pool *pool, size_t first,
                         search_points *points, uint64_t *work) {
    const witness_row among = search_scene_witnesses(scene, first);
    for (size_t i = 0; i < points->count; i++) {
        search_point *point = &points->data[i];
        for (size_t j = first; point->candidate != UINT32_MAX && j < scene->witnesses.count; j++)
            if (starg_bits_test(pool->rows, point->candidate, scene->witnesses.data[j]))
                starg_bit_set(point->seen.bits, j);
    }
    return points_look_at(scene, points->data, points->count, &among, work);
}

void points_prune(search_points *points, size_t first, uint64_t *work) {
    search_point *all = points->data;
    size_t kept = first;
    for (size_t i = first; i < points->count; i++) {
        bool needless = false;
        for (size_t j = 0; j < points->count && !needless; j++)
            needless = (j < kept || j > i) && row_is_within(&all[i].seen, &all[j].seen) &&
                       (j < kept || !row_is_within(&all[j].seen, &all[i].seen));
        if (!needless || all[i].candidate != UINT32_MAX)
            all[kept++] = all[i];
    }
    *work += (points->count - first) * points->count / COMPARED;
    points->count = kept;
}

starg_status points_add(starg_context *context, const search_point *point, search_points *points) {
    PUSH(context, STAGE, points, *point);
    return STARG_OK;
}

starg_status points_begin(const guard_problem *problem, const guard_detail *detail,
                          const guard_pool *pool, search_points *points) {
    starg_context *context = problem->context;
    const bool directed = sensor_is_directed(&problem->options->visibility);
    for (size_t i = 0; i < pool_count(pool); i++) {
        search_point point = {.candidate = (uint32_t)i};
        vec3_copy(pool_point(pool, i), point.place);
        if (directed) {
            vec3_copy(pool_direction(pool, i), point.direction);
            vec3_copy(pool_up(pool, i), point.up);
        }
        TRY(points_add(context, &point, points));
    }
    for (size_t i = 0; i < candidates_count(&detail->centres); i++) {
        search_point point = {.candidate = UINT32_MAX};
        vec3_copy(detail->centres.data.data + 3 * i, point.place);
        TRY(points_add(context, &point, points));
    }
    return STARG_OK;
}

starg_status points_hold(const search_scene *scene, const uint32_t *chosen, size_t count,
                         search_points *points, guard_pool *pool, uint64_t *work) {
    SCOPED_BY(candidates_free) candidate_points found = {0};
    TIME_RULE(scene->context, STARG_TIME_IGNORED);
    uint32_t next = (uint32_t)pool_count(pool);
    for (size_t i = 0; i < count; i++) {
        search_point *point = &points->data[chosen[i]];
        if (point->candidate != UINT32_MAX)
            continue;
        bool looks = sensor_is_directed(scene->view);
        TRY(candidates_push_pose(scene->context, &found, point->place,
                                 looks ? point->direction : NULL, point->up));
        point->candidate = next++;
    }
    *work += candidates_count(&found) * pool->columns / 20;
    return found.data.count > 0 ? pool_add(pool, &found) : STARG_OK;
}

void points_raise_bound(search_points *points, size_t bound) {
    points->bound = bound > points->bound ? bound : points->bound;
}

starg_status points_prove(const search_duals *d, search_points *points) {
    SCOPED const witness_row **rows = NULL;
    whole_prices whole;
    NEW(d->witnesses->scene.context, STAGE, rows, points->count);
    for (size_t i = 0; i < points->count; i++)
        rows[i] = &points->data[i].seen;
    bound_round(&d->prices, &d->odd, &whole);
    points->bound = bound_of_prices(rows, points->count, &whole, d->witnesses->redundancy);
    return STARG_OK;
}
