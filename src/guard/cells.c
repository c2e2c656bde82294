/* SPDX-License-Identifier: Apache-2.0 */
/* Cells: the space in which guards may stand, cut into boxes, each with the witnesses that it may
 * see, by visibility/box.h.
 *
 * The root is the box of the solid, rounded outwards to multiples of a power of two, and a cell is
 * cut in the middle of its longest side, so that corners of cells are short binary fractions. A
 * child is tested only for what its parent may see, and not for what one of its points is known to
 * see. Cells are numbered in the order of creation. Work is addressed by that number, and so is the
 * random point of a cell: nothing depends on the number of threads.
 *
 * Invariant: no point of a cell in the free space sees a witness that is not open in the cell.
 * Cost: a box test for each open vertex, about 10 sight lines for each vertex that it sees. */
#include "guard/cells.h"

#include <math.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "visibility/columns.h"

static const char STAGE[] = "search";

enum { RANDOM_STAGE = 27, ROOT_BITS = 20 };

/* ---- the scene ---- */

static void fill_places(search_scene *scene) {
    const visibility_scene *points = scene->points;
    const starg_mesh *mesh = scene->solid->mesh;
    if (scene->view->target == STARG_TARGET_VERTICES)
        for (size_t v = 0; v < mesh->vertex_count; v++)
            scene->places[v] = points->slot_of[v];
    else if (scene->view->target == STARG_TARGET_CORNERS)
        for (size_t j = 0; j < 3 * mesh->face_count; j++)
            scene->places[j] = points->slot_of[mesh->faces[j]];
    else
        for (size_t rank = 0; rank < points->face_count; rank++)
            scene->places[points->face_of[rank]] = (uint32_t)rank;
}

starg_status search_scene_open(starg_context *context, const starg_solid *solid,
                               const starg_visibility_options *view, double clearance,
                               search_scene *out) {
    starg_status status = STARG_OK;
    *out = (search_scene){.context = context, .solid = solid, .view = view, .clearance = clearance};
    STARG_TRY(scene_create(context, solid, &out->points));
    STARG_TRY(box_scene_create(context, solid, &out->boxes));
    STARG_NEW(context, STAGE, out->places, target_columns(solid->mesh, view->target));
    fill_places(out);
done:
    if (status != STARG_OK)
        search_scene_close(out);
    return status;
}

void search_scene_close(search_scene *scene) {
    if (scene->context == NULL)
        return;
    scene_free(scene->points);
    box_scene_free(scene->boxes);
    starg_release(scene->context, scene->places);
    STARG_ARRAY_FREE(scene->context, &scene->witnesses);
    *scene = (search_scene){0};
}

/* ---- points ---- */

void search_scene_centre(const search_scene *scene, size_t j, double centre[3]) {
    const visibility_scene *points = scene->points;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    if (scene->view->target != STARG_TARGET_FACES) {
        const double at[3] = {points->x[place], points->y[place], points->z[place]};
        vec3_copy(at, centre);
        return;
    }
    for (int k = 0; k < 3; k++)
        centre[k] = scene_corner(points, place, 0)[k] / 3 + scene_corner(points, place, 1)[k] / 3 +
                    scene_corner(points, place, 2)[k] / 3;
}

/* Is p strictly on the inner side of the face of a corner? */
static bool is_before(const search_scene *scene, uint32_t corner, const double p[3]) {
    const starg_mesh *mesh = scene->solid->mesh;
    const uint32_t *c = mesh->faces + 3 * (size_t)(corner / 3);
    return orient3d(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                    mesh->vertices + 3 * (size_t)c[2], p) > 0;
}

bool search_scene_sees(const search_scene *scene, const search_point *point, size_t j,
                       uint64_t *work) {
    starg_visibility_options view = *scene->view;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    bool whole = view.target == STARG_TARGET_FACES;
    view.directions = point->direction;
    view.ups = point->up;
    bool sees =
        whole ? scene_sees_face(scene->points, point->place, place, &view)
              : (view.target == STARG_TARGET_VERTICES || is_before(scene, column, point->place)) &&
                    scene_sees_vertex(scene->points, point->place, place, &view);
    *work += sees && whole ? 3 : 1;
    return sees;
}

bool search_scene_may_see(const search_scene *scene, const double p[3], size_t j) {
    const visibility_scene *points = scene->points;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    if (scene->view->target == STARG_TARGET_CORNERS)
        return is_before(scene, column, p);
    return scene->view->target == STARG_TARGET_VERTICES ||
           scene_back(points, place) != SCENE_NONE ||
           orient3d(scene_corner(points, place, 0), scene_corner(points, place, 1),
                    scene_corner(points, place, 2), p) > 0;
}

/* Sets which witnesses in `among` the point sees; returns the number of tests. */
static uint64_t look_from(const search_scene *scene, search_point *point,
                          const witness_row *among) {
    uint64_t work = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, among->bits[w])
            if (search_scene_sees(scene, point, 64 * w + bit, &work))
                starg_bit_set(point->seen.bits, 64 * w + bit);
    return work;
}

static witness_row witnesses_from(const search_scene *scene, size_t first) {
    witness_row row = {{0}};
    for (size_t j = first; j < scene->witnesses.count; j++)
        starg_bit_set(row.bits, j);
    return row;
}

typedef struct looking {
    const search_scene *scene;
    search_point *points;
    uint64_t *work; /* by item */
    witness_row among;
} looking;

static starg_status look_from_item(starg_context *context, void *shared, void *scratch,
                                   size_t item) {
    looking *l = shared;
    (void)context;
    (void)scratch;
    if (l->points[item].candidate == UINT32_MAX)
        l->work[item] = look_from(l->scene, &l->points[item], &l->among);
    return STARG_OK;
}

starg_status points_look_at(search_scene *scene, search_point *points, size_t count,
                            const witness_row *among) {
    starg_status status = STARG_OK;
    starg_context *context = scene->context;
    looking l = {scene, points, NULL, *among};
    STARG_NEW_ZERO(context, STAGE, l.work, count);
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = &l, .item = look_from_item, .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < count; i++)
        scene->work += l.work[i];
done:
    starg_release(context, l.work);
    return status;
}

starg_status points_look(search_scene *scene, search_points *points, size_t first) {
    const witness_row among = witnesses_from(scene, first);
    return points_look_at(scene, points->data, points->count, &among);
}

/* ---- cells ---- */

static double middle(const bvh_box *box, int k) {
    return 0.5 * box->lower[k] + 0.5 * box->upper[k];
}

/* Half the diagonal and the distance of the centre from the boundary have rounding errors, below a
 * thousandth of the clearance unless coordinates are huge relative to it. */
bool search_scene_bars(const search_scene *scene, const bvh_box *box) {
    double centre[3], reach = 0.5 * vec3_distance(box->lower, box->upper), largest = 0;
    if (!(scene->clearance > 0) || !(reach < scene->clearance))
        return false;
    for (int k = 0; k < 3; k++) {
        centre[k] = middle(box, k);
        largest = fmax(largest, fmax(fabs(box->lower[k]), fabs(box->upper[k])));
    }
    return largest < 1e9 * scene->clearance &&
           starg_solid_distance(scene->solid, centre) + reach < 0.999 * scene->clearance;
}

starg_status cells_begin(const search_scene *scene, search_cells *cells) {
    starg_status status = STARG_OK;
    bvh_box reach;
    solid_reach(scene->solid, &reach);
    const bvh_box *all = &reach;
    search_cell root = {.box = reach};
    double extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, all->upper[k] - all->lower[k]);
    int exponent;
    frexp(extent, &exponent);
    double unit = ldexp(1, exponent - ROOT_BITS);
    for (int k = 0; k < 3; k++) {
        double lower = floor(all->lower[k] / unit) * unit,
               upper = ceil(all->upper[k] / unit) * unit;
        if (lower <= all->lower[k])
            root.box.lower[k] = lower;
        if (upper >= all->upper[k])
            root.box.upper[k] = upper;
    }
    STARG_PUSH(scene->context, STAGE, cells, root);
done:
    return status;
}

int cell_cut_axis(const bvh_box *box) {
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (box->upper[k] - box->lower[k] > box->upper[longest] - box->lower[longest])
            longest = k;
    return longest;
}

bool cell_splits(const bvh_box *box) {
    int k = cell_cut_axis(box);
    double at = middle(box, k);
    return at > box->lower[k] && at < box->upper[k];
}

bvh_box cell_half(const bvh_box *box, bool upper) {
    bvh_box part = *box;
    int k = cell_cut_axis(box);
    if (upper)
        part.lower[k] = middle(box, k);
    else
        part.upper[k] = middle(box, k);
    return part;
}

starg_status cells_worker_make(starg_context *context, void *shared, void **scratch) {
    const search_scene *const *scene = shared;
    box_worker *worker = NULL;
    (void)context;
    starg_status status = box_worker_create((*scene)->boxes, &worker);
    *scratch = worker;
    return status;
}

void cells_worker_free(starg_context *context, void *scratch) {
    (void)context;
    box_worker_free(scratch);
}

/* Sets which witnesses in `among` the box may see; returns the number of tests. */
static uint64_t look_from_box(const search_scene *scene, box_worker *worker, const bvh_box *box,
                              const witness_row *among, const witness_row *known,
                              witness_row *open) {
    uint64_t before = box_worker_tests(worker);
    witness_row found = {{0}};
    const box_question question = {.box = *box,
                                   .target = scene->view->target,
                                   .targets = scene->witnesses.data,
                                   .count = scene->witnesses.count,
                                   .range = scene->view->range,
                                   .among = among->bits,
                                   .known = known != NULL ? known->bits : NULL};
    if (!search_scene_bars(scene, box))
        box_look(worker, &question, found.bits, NULL);
    for (int w = 0; w < WITNESS_WORDS; w++)
        open->bits[w] |= found.bits[w];
    return box_worker_tests(worker) - before;
}

/* ---- testing more witnesses ---- */

typedef struct asking {
    const search_scene *scene; /* first member, as cells_worker_make requires */
    search_cell *cells;
    const uint32_t *list, *parents; /* by item */
    witness_row among;
    uint64_t *work; /* by item */
} asking;

static starg_status ask_item(starg_context *context, void *shared, void *scratch, size_t item) {
    asking *a = shared;
    search_cell *cell = &a->cells[a->list[item]];
    witness_row among = a->among;
    (void)context;
    if (a->parents[item] != UINT32_MAX)
        for (int w = 0; w < WITNESS_WORDS; w++)
            among.bits[w] &= a->cells[a->parents[item]].open.bits[w];
    a->work[item] = look_from_box(a->scene, scratch, &cell->box, &among, NULL, &cell->open);
    return STARG_OK;
}

typedef STARG_ARRAY(uint32_t) numbers;

static bool sees_any(const search_cell *cell, const witness_row *among) {
    uint64_t any = 0;
    for (int w = 0; w < WITNESS_WORDS; w++)
        any |= cell->open.bits[w] & among->bits[w];
    return any != 0;
}

/* One generation after the other: children are tested for what their parents may see. */
starg_status cells_look(search_scene *scene, search_cells *cells, size_t first) {
    starg_status status = STARG_OK;
    starg_context *context = scene->context;
    numbers list = {0}, parents = {0}, next = {0}, next_parents = {0};
    asking a = {.scene = scene, .cells = cells->data, .among = witnesses_from(scene, first)};
    STARG_PUSH(context, STAGE, &list, 0);
    STARG_PUSH(context, STAGE, &parents, UINT32_MAX);
    while (list.count > 0) {
        STARG_NEW_ZERO(context, STAGE, a.work, list.count);
        a.list = list.data;
        a.parents = parents.data;
        const starg_parallel_loop loop = {.stage = STAGE,
                                          .count = list.count,
                                          .shared = &a,
                                          .item = ask_item,
                                          .make_scratch = cells_worker_make,
                                          .free_scratch = cells_worker_free,
                                          .silent = true};
        STARG_TRY(starg_parallel_for(context, &loop));
        next.count = next_parents.count = 0;
        for (size_t i = 0; i < list.count; i++) {
            uint32_t children = cells->data[list.data[i]].children;
            scene->work += a.work[i] + 1;
            for (uint32_t k = 0; k < 2 && children != 0; k++)
                if (sees_any(&cells->data[list.data[i]], &a.among)) {
                    STARG_PUSH(context, STAGE, &next, children + k);
                    STARG_PUSH(context, STAGE, &next_parents, list.data[i]);
                }
        }
        starg_release(context, a.work);
        a.work = NULL;
        numbers done_list = list, done_parents = parents;
        list = next;
        parents = next_parents;
        next = done_list;
        next_parents = done_parents;
    }
done:
    starg_release(context, a.work);
    STARG_ARRAY_FREE(context, &list);
    STARG_ARRAY_FREE(context, &parents);
    STARG_ARRAY_FREE(context, &next);
    STARG_ARRAY_FREE(context, &next_parents);
    return status;
}

/* ---- splitting ---- */

typedef struct part {
    search_cell cell;
    search_point points[MOST_TRIES];
    int count; /* of the points */
    uint64_t work;
} part;

typedef struct splitting {
    const search_scene *scene; /* first member, as cells_worker_make requires */
    const search_cell *cells;
    const uint32_t *leaves;
    size_t first; /* number of the first part among the cells */
    int tries;
    part *parts;
} splitting;

/* If views are directed: aims at a random witness among those that the cell may see. */
static void look_somewhere(const search_scene *scene, search_point *point, const witness_row *among,
                           starg_rng *rng) {
    size_t count = starg_bit_count(among->bits, WITNESS_WORDS), at = 0;
    if (!sensor_is_directed(scene->view) || count == 0)
        return;
    uint64_t chosen = starg_rng_below(rng, count);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, among->bits[w])
            at = chosen-- == 0 ? 64 * w + bit : at;
    double centre[3];
    search_scene_centre(scene, at, centre);
    vec3_subtract(centre, point->place, point->direction);
    double length = vec3_length(point->direction);
    for (int k = 0; k < 3 && length > 0; k++)
        point->direction[k] /= length;
}

static void add_point(const search_scene *scene, part *out, const double p[3],
                      const witness_row *among, starg_rng *rng) {
    search_point *point = &out->points[out->count];
    if (!candidates_allowed(scene->solid, p, scene->clearance))
        return;
    *point = (search_point){.candidate = UINT32_MAX};
    vec3_copy(p, point->place);
    look_somewhere(scene, point, among, rng);
    out->work += look_from(scene, point, among);
    out->count++;
}

static starg_status make_part(starg_context *context, void *shared, void *scratch, size_t item) {
    const splitting *s = shared;
    const search_cell *whole = &s->cells[s->leaves[item / 2]];
    part *out = &s->parts[item];
    starg_rng rng = starg_rng_make(context->seed, RANDOM_STAGE, s->first + item);
    witness_row known = {{0}};
    double p[3];
    *out = (part){.cell.box = cell_half(&whole->box, item % 2 != 0)};
    const bvh_box *box = &out->cell.box;
    for (int i = 0; i < s->tries; i++) {
        for (int k = 0; k < 3; k++)
            p[k] = i == 0 ? middle(box, k)
                          : box->lower[k] + starg_rng_unit(&rng) * (box->upper[k] - box->lower[k]);
        add_point(s->scene, out, p, &whole->open, &rng);
    }
    for (int i = 0; i < out->count; i++)
        for (int w = 0; w < WITNESS_WORDS; w++)
            known.bits[w] |= out->points[i].seen.bits[w];
    out->work += look_from_box(s->scene, scratch, box, &whole->open, &known, &out->cell.open);
    return STARG_OK;
}

starg_status cells_split(search_scene *scene, search_cells *cells, const uint32_t *leaves,
                         size_t count, int tries, search_points *points) {
    starg_status status = STARG_OK;
    starg_context *context = scene->context;
    splitting s = {.scene = scene,
                   .cells = cells->data,
                   .leaves = leaves,
                   .first = cells->count,
                   .tries = tries};
    STARG_NEW(context, STAGE, s.parts, 2 * count);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = 2 * count,
                                      .shared = &s,
                                      .item = make_part,
                                      .make_scratch = cells_worker_make,
                                      .free_scratch = cells_worker_free,
                                      .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < 2 * count; i++) {
        const part *p = &s.parts[i];
        STARG_PUSH(context, STAGE, cells, p->cell);
        if (i % 2 != 0) /* only after the second child: a cell has both children or none */
            cells->data[leaves[i / 2]].children = (uint32_t)(cells->count - 2);
        for (int k = 0; k < p->count; k++)
            STARG_PUSH(context, STAGE, points, p->points[k]);
        scene->work += p->work + 2;
    }
done:
    starg_release(context, s.parts);
    return status;
}
