/* SPDX-License-Identifier: Apache-2.0 */
/* Directions of sensors with a limited view at a given place.
 *
 * Problem: a place sees faces all around, each with a weight. A view holds a face if it holds its
 * corners. Find a few directions whose views together hold as much weight as possible.
 *
 * Stages: find what every place sees all around; find the direction whose view holds the most
 * weight; then the one that holds the most of the rest, and so on: the greedy algorithm for maximum
 * coverage [Nemhauser, Wolsey, Fisher 1978]. Each direction is found by branch and bound over
 * rectangles of yaw and pitch about the up vector. A change of yaw and pitch by at most s in total
 * moves the view by an angle of at most s; so no view in a rectangle holds a face with a corner
 * farther than s outside the view at its centre. The bound of a rectangle is the weight of the
 * other faces, and its children consider only these.
 *
 * What is exact: nothing here decides what counts as seen; the views found are ordinary candidates,
 * whose rows come from visibility_rows. A search that ends within its budget is proven: no
 * direction holds more than 1 + GAP times as much of the faces considered, except in rectangles
 * below two degrees. If there are more than MOST_FACES faces, a subset represents them.
 *
 * Cost: for each place one look and at most LOOKS x NODES visits of its faces, most of them with
 * short lists. Parallel over places; independent of the number of threads. */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "visibility/scene.h"

enum {
    LOOKS = 10,
    NODES = 300,
    MOST_FACES = 768,
    MOST = 12000, /* directions; rows of more than MOST_BITS bits would not fit into memory */
    BATCH = 128,
    DEPTH = 16,
    START_YAWS = 8,
    START_PITCHES = 4
};

static const char STAGE[] = "directions";
static const double MOST_BITS = 0x1p33;
static const double PI = 3.14159265358979323846, GAP = 0.02, LEAST_SHARE = 0.01,
                    SMALLEST = 0.017; /* half side of a rectangle, in radians */

/* A face, or a vertex, as seen from a place. */
typedef struct aim_item {
    double corner[3][3]; /* unit directions; all equal for a vertex */
    double reach[3];     /* and how far each of them is */
    double depth;        /* largest; INFINITY: any */
    double weight;
} aim_item;

typedef struct aim_list {
    uint32_t item[MOST_FACES];
    size_t count;
} aim_list;

/* Memory for one thread. */
typedef struct aim_scratch {
    aim_item items[MOST_FACES];
    aim_list lists[DEPTH + 2]; /* of the rectangles on the path to the current one */
    size_t count, nodes;
    double best, direction[3];
} aim_scratch;

typedef struct rectangle {
    double yaw, pitch, half_yaw, half_pitch;
} rectangle;

typedef struct aiming {
    const starg_solid *solid;
    const starg_visibility_options *view;
    const double *points; /* of the batch */
    const starg_bits *seen;
    const double *weights; /* by column */
    double frame[3][3];    /* right, up, ahead at yaw and pitch 0 */
    double depth;          /* largest; INFINITY: any */
    double pitch[2];       /* least and most */
    double *found;         /* by place: LOOKS directions */
    size_t *counts;
} aiming;

/* ---- one direction ---- */

static void direction_of(const aiming *a, double yaw, double pitch, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = cos(pitch) * (sin(yaw) * a->frame[0][k] + cos(yaw) * a->frame[2][k]) +
                 sin(pitch) * a->frame[1][k];
}

/* The planes, or for a cone one bound on a cosine, that items are tested against. */
typedef struct aim_view {
    double normal[4][3], least,
        loose; /* n . q of all items is at least this: held; possibly held nearby */
    int count;
    double ahead[3], slack;
} aim_view;

static aim_view view_at(const aiming *a, const double direction[3], double slack) {
    const starg_visibility_options *o = a->view;
    aim_view v = {.count = 1, .slack = slack};
    vec3_copy(direction, v.ahead);
    vec3_copy(direction, v.normal[0]);
    if (o->fov[0] > 0) {
        v.count = 4;
        starg_frustum(direction, a->frame[1], o->fov, v.normal);
        v.loose = slack < 0.5 * PI ? -sin(slack) : -1;
    } else {
        double half = o->cone * PI / 360;
        v.least = cos(half);
        v.loose = half + slack < PI ? cos(half + slack) : -1;
    }
    return v;
}

static double depth_in(const aim_view *v, const aim_item *item) {
    double depth = 2;
    for (int side = 0; side < v->count; side++)
        for (int k = 0; k < 3; k++) {
            double d = vec3_dot(v->normal[side], item->corner[k]);
            depth = d < depth ? d : depth;
        }
    return depth;
}

/* Is no corner too deep in the view? In one turned by the slack, possibly. */
static bool is_near(const aim_view *v, const aim_item *item, double slack) {
    bool near = true;
    for (int k = 0; k < 3 && item->depth < INFINITY && near; k++) {
        double cosine = fmax(-1, fmin(1, vec3_dot(v->ahead, item->corner[k])));
        if (slack > 0)
            cosine = cos(fmin(acos(cosine) + slack, PI));
        near = item->reach[k] * cosine <= item->depth;
    }
    return near;
}

/* The bound of a rectangle; `left` receives the items that its views may hold. */
static double look(const aiming *a, aim_scratch *w, const rectangle *r, const aim_list *among,
                   aim_list *left, double *in_middle) {
    double direction[3], held = 0, most = 0;
    direction_of(a, r->yaw, r->pitch, direction);
    const aim_view v = view_at(a, direction, r->half_yaw + r->half_pitch);
    left->count = 0;
    for (size_t i = 0; i < among->count; i++) {
        const aim_item *item = &w->items[among->item[i]];
        double depth = depth_in(&v, item);
        if (depth < v.loose || !is_near(&v, item, v.slack))
            continue;
        held += depth >= v.least && is_near(&v, item, 0) ? item->weight : 0;
        most += item->weight;
        left->item[left->count++] = among->item[i];
    }
    w->nodes++;
    *in_middle = held;
    if (held > w->best) {
        w->best = held;
        vec3_copy(direction, w->direction);
    }
    return most;
}

/* A rectangle with its bound, and what the view at its centre holds. */
typedef struct part {
    rectangle at;
    double most, held;
} part;

static void look_at_part(const aiming *a, aim_scratch *w, const aim_list *among, aim_list *left,
                         part *p) {
    p->most = look(a, w, &p->at, among, left, &p->held);
}

/* The largest bound first. */
static int by_promise(const void *x, const void *y) {
    const part *a = x, *b = y;
    double first = a->most + a->held, second = b->most + b->held;
    if (first != second)
        return first > second ? -1 : 1;
    if (a->at.pitch != b->at.pitch)
        return a->at.pitch < b->at.pitch ? -1 : 1;
    return (a->at.yaw > b->at.yaw) - (a->at.yaw < b->at.yaw);
}

static void halve(const rectangle *r, part parts[2]) {
    bool across = r->half_yaw >= r->half_pitch;
    double half = 0.5 * (across ? r->half_yaw : r->half_pitch);
    for (int i = 0; i < 2; i++) {
        parts[i].at = *r;
        *(across ? &parts[i].at.yaw : &parts[i].at.pitch) += i == 0 ? -half : half;
        *(across ? &parts[i].at.half_yaw : &parts[i].at.half_pitch) = half;
    }
}

static bool may_be_better(const aim_scratch *w, const part *p) {
    return w->nodes < NODES && p->most > (1 + GAP) * w->best;
}

/* Searches a rectangle whose items are in the list of its depth. */
static void search(const aiming *a, aim_scratch *w, const rectangle *r, int depth) {
    part parts[2];
    aim_list *left = &w->lists[depth + 1];
    if (depth >= DEPTH || fmax(r->half_yaw, r->half_pitch) < SMALLEST)
        return;
    halve(r, parts);
    for (int i = 0; i < 2; i++)
        look_at_part(a, w, &w->lists[depth], left, &parts[i]);
    qsort(parts, 2, sizeof *parts, by_promise);
    for (int i = 0; i < 2; i++) {
        if (!may_be_better(w, &parts[i]))
            continue;
        look_at_part(a, w, &w->lists[depth], left, &parts[i]);
        search(a, w, &parts[i].at, depth + 1);
    }
}

/* The best direction for the items of the first list, starting from rectangles of 45 degrees. */
static void find_direction(const aiming *a, aim_scratch *w) {
    part parts[START_YAWS * START_PITCHES];
    const double half_yaw = PI / START_YAWS,
                 half_pitch = 0.5 * (a->pitch[1] - a->pitch[0]) / START_PITCHES;
    w->nodes = 0;
    w->best = 0;
    for (int i = 0; i < START_YAWS * START_PITCHES; i++) {
        int row = i / START_YAWS, column = i % START_YAWS;
        parts[i].at = (rectangle){(2 * column + 1) * half_yaw - PI,
                                  a->pitch[0] + (2 * row + 1) * half_pitch, half_yaw, half_pitch};
        look_at_part(a, w, &w->lists[0], &w->lists[1], &parts[i]);
    }
    qsort(parts, START_YAWS * START_PITCHES, sizeof *parts, by_promise);
    for (int i = 0; i < START_YAWS * START_PITCHES; i++) {
        if (!may_be_better(w, &parts[i]))
            continue;
        look_at_part(a, w, &w->lists[0], &w->lists[1], &parts[i]);
        search(a, w, &parts[i].at, 1);
    }
}

/* ---- a place ---- */

static double unit_towards(const double p[3], const double q[3], double out[3]) {
    vec3_subtract(q, p, out);
    double length = vec3_length(out);
    for (int k = 0; k < 3 && length > 0; k++)
        out[k] /= length;
    return length;
}

static void set_item(const aiming *a, const double p[3], size_t column, aim_item *item) {
    bool vertices = a->view->target == STARG_TARGET_VERTICES;
    for (size_t k = 0; k < 3; k++)
        item->reach[k] = unit_towards(p,
                                      vertices ? a->solid->mesh->vertices + 3 * column
                                               : solid_patch_corner(a->solid, column, k),
                                      item->corner[k]);
    item->weight = a->weights[column];
    item->depth = a->depth;
    if (a->solid->density != NULL && a->view->target == STARG_TARGET_FACES)
        item->depth =
            starg_density_depth(a->view, a->solid->density[solid_patch_face(a->solid, column)]);
}

/* If there are too many, takes every k-th. */
static void list_items(const aiming *a, aim_scratch *w, size_t place) {
    const uint64_t *row = starg_bits_row(a->seen, place);
    size_t all = starg_bits_count(a->seen, place), index = 0;
    size_t step = (all + MOST_FACES - 1) / MOST_FACES;
    w->count = 0;
    for (size_t word = 0; word < a->seen->words; word++)
        STARG_FOR_BITS (bit, row[word])
            if (index++ % step == 0)
                set_item(a, a->points + 3 * place, 64 * word + bit, &w->items[w->count++]);
}

/* Removes the items that the direction holds from the first list; returns their weight. */
static void drop_held(const aiming *a, aim_scratch *w) {
    const aim_view v = view_at(a, w->direction, 0);
    aim_list *list = &w->lists[0];
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (depth_in(&v, &w->items[list->item[i]]) < v.least ||
            !is_near(&v, &w->items[list->item[i]], 0))
            list->item[kept++] = list->item[i];
    list->count = kept;
}

static starg_status aim_place(starg_context *context, void *shared, void *scratch, size_t place) {
    aiming *a = shared;
    aim_scratch *w = scratch;
    double all = 0;
    (void)context;
    list_items(a, w, place);
    w->lists[0].count = w->count;
    for (size_t i = 0; i < w->count; i++) {
        w->lists[0].item[i] = (uint32_t)i;
        all += w->items[i].weight;
    }
    for (size_t *count = &a->counts[place]; *count < LOOKS; ++*count) {
        find_direction(a, w);
        if (!(w->best > LEAST_SHARE * all))
            break;
        vec3_copy(w->direction, a->found + 3 * (LOOKS * place + *count));
        drop_held(a, w);
    }
    return STARG_OK;
}

static starg_status make_scratch(starg_context *context, void *shared, void **scratch) {
    (void)shared;
    *scratch = starg_allocate_zero(context, 1, sizeof(aim_scratch));
    return *scratch != NULL ? STARG_OK : STARG_ERROR_MEMORY;
}

static void free_scratch(starg_context *context, void *scratch) {
    starg_release(context, scratch);
}

/* ---- all places ---- */

static void make_frame(const starg_visibility_options *view, double frame[3][3]) {
    const double none[3] = {0, 0, 0}, y[3] = {0, 1, 0};
    vec3_copy(vec3_equal(view->up, none) ? y : view->up, frame[1]);
    double length = vec3_length(frame[1]);
    for (int k = 0; k < 3; k++)
        frame[1][k] /= length;
    int axis = fabs(frame[1][2]) < 0.9 ? 2 : 0;
    double other[3] = {axis == 0, 0, axis == 2};
    vec3_cross(frame[1], other, frame[0]);
    length = vec3_length(frame[0]);
    for (int k = 0; k < 3; k++)
        frame[0][k] /= length;
    vec3_cross(frame[0], frame[1], frame[2]);
}

static void set_pitch(const starg_visibility_options *view, double pitch[2]) {
    bool any = view->tilt[0] == STARG_TILT_ANY;
    pitch[0] = any ? -0.5 * PI : view->tilt[0] * (PI / 180);
    pitch[1] = any ? 0.5 * PI : view->tilt[1] * (PI / 180);
}

/* Faces have their weights, vertices weigh the same. */
static starg_status weigh(starg_context *context, const starg_solid *solid,
                          const starg_visibility_options *view, double **out) {
    SCOPED_BY(column_weights_free) column_weights weights = {0};
    TRY(column_weights_create(context, solid, view->target, &weights));
    size_t columns = target_columns(solid, view->target);
    NEW(context, STAGE, *out, columns);
    for (size_t j = 0; j < columns; j++)
        (*out)[j] = (double)weights.weights[j];
    return STARG_OK;
}

static starg_status aim_batch(starg_context *context, aiming *a, size_t count,
                              candidate_points *out) {
    starg_status status = STARG_OK;
    starg_visibility_options around = *a->view;
    starg_bits *seen = NULL;
    uint8_t *finished = NULL;
    around.cone = 360;
    around.fov[0] = around.fov[1] = around.resolution[0] = around.resolution[1] = 0;
    around.density = 0;
    around.tilt[0] = around.tilt[1] = STARG_TILT_ANY;
    STARG_NEW_ZERO(context, STAGE, finished, count);
    STARG_NEW_ZERO(context, STAGE, a->counts, count);
    STARG_NEW(context, STAGE, a->found, 3 * LOOKS * count);
    STARG_TRY(visibility_rows(context, a->solid, a->points, count, &around, finished, &seen));
    a->seen = seen;
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = count,
                                      .shared = a,
                                      .item = aim_place,
                                      .make_scratch = make_scratch,
                                      .free_scratch = free_scratch,
                                      .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < a->counts[i]; k++)
            STARG_TRY(
                candidates_push(context, out, a->points + 3 * i, a->found + 3 * (LOOKS * i + k)));
done:
    starg_bits_free(seen);
    RELEASE(finished, a->counts, a->found);
    return status;
}

/* How many places may have directions. */
static size_t most_places(const starg_solid *solid, const starg_visibility_options *view) {
    double rows = MOST_BITS / (double)target_columns(solid, view->target);
    return (size_t)fmax(1, fmin(rows, MOST) / LOOKS);
}

starg_status candidates_turn(starg_context *context, const starg_solid *solid,
                             const starg_visibility_options *view, const candidate_points *points,
                             candidate_points *out) {
    SCOPED double *weights = NULL, *places = NULL;
    size_t count = candidates_count(points), most = most_places(solid, view);
    size_t used = count < most ? count : most;
    aiming a = {.solid = solid, .view = view};
    if (used < count)
        starg_log(context, STARG_LOG_NOTICE,
                  "using %zu of %zu candidates, each with up to %d "
                  "directions",
                  used, count, LOOKS);
    make_frame(view, a.frame);
    a.depth = starg_density_depth(view, 0);
    set_pitch(view, a.pitch);
    TRY(weigh(context, solid, view, &weights));
    a.weights = weights;
    NEW(context, STAGE, places, 3 * used);
    for (size_t i = 0; i < used; i++)
        vec3_copy(points->data.data + 3 * (i * count / used), places + 3 * i);
    for (size_t first = 0; first < used; first += BATCH) {
        a.points = places + 3 * first;
        TRY(aim_batch(context, &a, used - first < BATCH ? used - first : BATCH, out));
    }
    return STARG_OK;
}
