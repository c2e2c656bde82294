/* SPDX-License-Identifier: Apache-2.0 */
/* Column generation for a search: which points are worth more than 1 at the current prices?
 *
 * Each priced witness is a source. It stores the most valuable known point that sees it, and moves
 * it:
 *   - around its place, by a step that shrinks from generation to generation;
 *   - towards the best point of another source nearby, into space that both could share;
 *   - in front of its own face, where the face is visible;
 *   - to the wall, near a face that it sees, at heights of all orders of magnitude. Places of great
 *     value are often small and touch the wall, where views along it begin: the twelve guards of
 *     horse_05's best result that were worth more than 1 when a search without such proposals had
 *     ended all stood within a three-hundredth of its diagonal.
 *
 * All proposals of a generation are evaluated together. A proposal replaces the point of any source
 * for which it is better or as good; ties let sources move across plateaus. At the end the new
 * points worth 1 or more join the points of the search: a point below 1 cannot help; a point at
 * exactly 1 may, together with others, because a program with several optima gives only one set of
 * prices.
 *
 * A proposal is first tested against the planes of the witnesses, then against the witnesses by
 * decreasing price, until it is clearly worth less than the source's point.
 *
 * Results depend only on the seed, the draw and the source. Cost: O(log n) per sight line; at most
 * PROPOSALS x GENERATIONS x sources x witnesses sight lines per call. */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { MOST_SOURCES = 512, GENERATIONS = 2, LEAST_PROPOSALS = 4000, NEIGHBOURS = 8 };

static const double LEAST_PRICE = 1e-3, WORTH = 1 - 2e-3, FIRST_STEP = 0.6, TIE = 1e-6,
                    STEP_FACTOR = 0.6;

/* The largest height above the wall, in diagonals, and its ratio to the smallest. */
static const double HIGHEST = 2e-3, HEIGHTS = 1000;

typedef struct source {
    uint32_t witness;
    double price;
    search_point best; /* the most valuable known point that sees it */
    double value;
    bool is_new;               /* `best` is not yet a point of the search */
    uint32_t near[NEIGHBOURS]; /* sources; count in near_count */
    int near_count;
} source;

typedef struct proposal {
    search_point point;
    double value; /* 0: less than `least` */
    double least;
    uint32_t by; /* witness of its source, which it must see */
    uint64_t work;
} proposal;

typedef struct moving {
    const search_scene *scene;
    const double *price; /* by witness */
    source *sources;
    size_t count;
    proposal *proposals; /* of a generation: `each` a source */
    size_t each;
    witness_row rest; /* witnesses that are not sources */
    search_points worthy;
} moving;

static int by_price(const void *a, const void *b) {
    const source *x = a, *y = b;
    if (x->price != y->price)
        return x->price > y->price ? -1 : 1;
    return (x->witness > y->witness) - (x->witness < y->witness);
}

/* Lists the sources by decreasing price, and the remaining witnesses. */
static starg_status list_sources(moving *m) {
    size_t all = m->scene->witnesses.count;
    NEW_ZERO(m->scene->context, STAGE, m->sources, all);
    for (size_t j = 0; j < all; j++)
        m->sources[j] = (source){.witness = (uint32_t)j, .price = m->price[j]};
    qsort(m->sources, all, sizeof *m->sources, by_price);
    while (m->count < all && m->count < MOST_SOURCES && m->sources[m->count].price > LEAST_PRICE)
        m->count++;
    for (size_t i = m->count; i < all; i++)
        starg_bit_set(m->rest.bits, m->sources[i].witness);
    return STARG_OK;
}

/* Offers a point to the sources that it sees. */
static void offer(moving *m, const search_point *point, double value, bool is_new) {
    for (size_t i = 0; i < m->count; i++) {
        source *n = &m->sources[i];
        if (value < (is_new ? n->value - TIE : n->value + TIE) ||
            !starg_bit_test(point->seen.bits, n->witness))
            continue;
        n->value = value;
        n->is_new = is_new;
        n->best = *point;
    }
}

static void offer_known(moving *m, const search_points *points) {
    for (size_t i = 0; i < points->count; i++)
        offer(m, &points->data[i], row_value(&points->data[i].seen, m->price), false);
}

/* The sources whose best points stand closest, nearest first. */
static void find_neighbours(moving *m) {
    for (size_t i = 0; i < m->count; i++) {
        source *n = &m->sources[i];
        double distance[NEIGHBOURS];
        n->near_count = 0;
        for (size_t j = 0; j < m->count; j++) {
            double d = vec3_distance(n->best.place, m->sources[j].best.place);
            int at = n->near_count;
            if (j == i || !(d > 0) || (at == NEIGHBOURS && d >= distance[at - 1]))
                continue;
            if (at < NEIGHBOURS)
                n->near_count++;
            else
                at--;
            for (; at > 0 && distance[at - 1] > d; at--) {
                distance[at] = distance[at - 1];
                n->near[at] = n->near[at - 1];
            }
            distance[at] = d;
            n->near[at] = (uint32_t)j;
        }
    }
}

/* A vector in the unit ball. */
static void random_ball(starg_rng *rng, double out[3]) {
    do {
        for (int k = 0; k < 3; k++)
            out[k] = 2 * starg_rng_unit(rng) - 1;
    } while (vec3_dot(out, out) > 1);
}

/* A random direction near the given one. */
static void turn(double step, starg_rng *rng, double direction[3]) {
    double shift[3];
    random_ball(rng, shift);
    vec3_along(direction, step, shift, direction);
    double length = vec3_length(direction);
    for (int k = 0; k < 3 && length > 0; k++)
        direction[k] /= length;
}

size_t search_draw(const witness_row *row, size_t none, starg_rng *rng) {
    size_t count = starg_bit_count(row->bits, WITNESS_WORDS);
    uint64_t left = count > 0 ? starg_rng_below(rng, count) : 0;
    for (size_t w = 0; w < WITNESS_WORDS && count > 0; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            if (left-- == 0)
                return 64 * w + bit;
    return none;
}

/* A number between 1 and `most`, all orders of magnitude alike. */
static double draw_scale(double most, starg_rng *rng) {
    return exp(starg_rng_unit(rng) * log(most));
}

/* A face near a witness: faces are in spatial order. */
static size_t draw_face(const search_scene *scene, size_t j, starg_rng *rng) {
    double faces = (double)scene->points->face_count;
    double offset = draw_scale(faces, rng), sign = starg_rng_unit(rng) < 0.5 ? -1 : 1;
    double rank = (double)search_scene_rank(scene, j) + sign * offset;
    return (size_t)fmin(fmax(rank, 0), faces - 1);
}

/* A place just inside a face. */
static void stand_at_wall(const search_scene *scene, size_t rank, starg_rng *rng, double place[3]) {
    const visibility_scene *points = scene->points;
    const double *a = scene_corner(points, rank, 0), *b = scene_corner(points, rank, 1);
    const double *c = scene_corner(points, rank, 2);
    double normal[3], u = starg_rng_unit(rng), v = starg_rng_unit(rng);
    double most = HIGHEST * vec3_distance(points->all.lower, points->all.upper);
    double height = most / draw_scale(HEIGHTS, rng);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    vec3_triangle_normal(a, b, c, normal);
    double length = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        place[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
    if (length > 0)
        vec3_along(place, -height / length, normal, place);
}

void search_propose(const search_scene *scene, const search_point *best, size_t j,
                    const double *other, search_stand stand, double step, starg_rng *rng,
                    search_point *out) {
    const double *from = best->place;
    double shift[3], centre[3];
    search_scene_centre(scene, j, centre);
    double reach = vec3_distance(from, centre);
    *out = (search_point){.candidate = UINT32_MAX};
    random_ball(rng, shift);
    if (stand == STAND_AT_WALL) {
        stand_at_wall(scene, draw_face(scene, search_draw(&best->seen, j, rng), rng), rng,
                      out->place);
    } else if (stand == STAND_BETWEEN && other != NULL) {
        double t = starg_rng_unit(rng);
        for (int k = 0; k < 3; k++)
            out->place[k] = from[k] + t * (other[k] - from[k]);
        vec3_along(out->place, 0.3 * step * vec3_distance(from, other), shift, out->place);
    } else if (stand == STAND_BEFORE) {
        double t = 0.3 + 1.2 * starg_rng_unit(rng);
        for (int k = 0; k < 3; k++)
            out->place[k] = centre[k] + t * (from[k] - centre[k]);
        vec3_along(out->place, step * t * reach, shift, out->place);
    } else {
        vec3_along(from, step * reach, shift, out->place);
    }
    vec3_copy(best->direction, out->direction);
    vec3_copy(best->up, out->up);
    if (vec3_dot(out->direction, out->direction) > 0)
        turn(step, rng, out->direction);
    if (sensor_is_directed(scene->view))
        sensor_tilt(scene->view, out->direction);
}

static bool look_at(const search_scene *scene, proposal *q, uint32_t witness) {
    uint64_t work = 0;
    bool sees = search_scene_sees(scene, &q->point, witness, &work);
    if (sees)
        starg_bit_set(q->point.seen.bits, witness);
    q->work += 2 * work;
    return sees;
}

/* Sets which of the sources' witnesses a proposal sees; stops as soon as its value falls below the
 * required one. */
static starg_status look_from(starg_context *context, void *shared, void *scratch, size_t item) {
    const moving *m = shared;
    const search_scene *scene = m->scene;
    proposal *q = &m->proposals[item];
    uint32_t left[MOST_WITNESSES];
    size_t count = 0;
    double open = 0;
    (void)context;
    (void)scratch;
    if (!candidates_allowed(scene->solid, q->point.place, scene->clearance) ||
        !look_at(scene, q, q->by))
        return STARG_OK;
    for (size_t i = 0; i < m->count; i++) {
        uint32_t j = m->sources[i].witness;
        if (!search_scene_may_see(scene, q->point.place, j))
            continue;
        left[count++] = j;
        open += m->price[j];
    }
    q->work += m->count / 50 + 1;
    for (size_t i = 0; i < count && open >= q->least; i++) {
        if (left[i] != q->by && !look_at(scene, q, left[i]))
            open -= m->price[left[i]];
    }
    q->value = open >= q->least ? row_value(&q->point.seen, m->price) : 0;
    return STARG_OK;
}

/* Every second proposal stands at the wall. */
static const int STANDS_IN_TURN[] = {STAND_AROUND,  STAND_AT_WALL, STAND_BETWEEN,
                                     STAND_AT_WALL, STAND_BEFORE,  STAND_AT_WALL};

/* Every source makes proposals, and takes better ones. */
static starg_status move_sources(moving *m, uint64_t stream, double step, uint64_t *work) {
    const search_scene *scene = m->scene;
    for (size_t i = 0; i < m->count; i++) {
        const source *n = &m->sources[i];
        starg_rng rng = starg_rng_make(scene->context->seed, STREAM_MOVES + stream,
                                       scene->witnesses.data[n->witness]);
        for (size_t kind = 0; kind < m->each; kind++) {
            proposal *q = &m->proposals[m->each * i + kind];
            search_stand stand = STANDS_IN_TURN[kind % (sizeof STANDS_IN_TURN / sizeof(int))];
            *q = (proposal){.by = n->witness, .least = fmin(n->value, WORTH) - TIE};
            const double *other =
                stand == STAND_BETWEEN && n->near_count > 0
                    ? m->sources[n->near[starg_rng_below(&rng, (uint64_t)n->near_count)]].best.place
                    : NULL;
            search_propose(scene, &n->best, n->witness, other, stand, step, &rng, &q->point);
        }
    }
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = m->each * m->count,
                                      .shared = m,
                                      .item = look_from,
                                      .silent = true};
    TRY(starg_parallel_for(scene->context, &loop));
    for (size_t k = 0; k < m->each * m->count; k++) {
        const proposal *q = &m->proposals[k];
        if (q->value > 0)
            offer(m, &q->point, q->value, true);
        if (q->value > 1 + SEARCH_GAP)
            PUSH(scene->context, STAGE, &m->worthy, q->point);
        *work += q->work;
    }
    return STARG_OK;
}

static bool stands_before(const moving *m, size_t index) {
    const search_point *p = &m->sources[index].best;
    for (size_t i = 0; i < index; i++)
        if (vec3_equal(m->sources[i].best.place, p->place) &&
            vec3_equal(m->sources[i].best.direction, p->direction))
            return true;
    return false;
}

/* Adds the points of the sources that are valuable enough. */
static starg_status take_best(moving *m, search_points *points, uint64_t *work, double *most) {
    starg_context *context = m->scene->context;
    size_t first = points->count;
    for (size_t i = 0; i < m->worthy.count; i++)
        TRY(points_add(context, &m->worthy.data[i], points));
    for (size_t i = 0; i < m->count; i++)
        if (m->sources[i].is_new && m->sources[i].value > WORTH && !stands_before(m, i)) {
            TRY(points_add(context, &m->sources[i].best, points));
            *most = fmax(*most, m->sources[i].value);
        }
    TRY(points_look_at(m->scene, points->data + first, points->count - first, &m->rest, work));
    points_prune(points, first, work);
    return STARG_OK;
}

static void moving_free(moving *m) {
    RELEASE(m->sources, m->worthy.data, m->proposals);
}

starg_status search_move(const search_scene *scene, const witness_prices *prices, uint64_t draw,
                         search_points *points, search_effort *effort, double *most) {
    SCOPED_BY(moving_free) moving m = {.scene = scene, .price = prices->price};
    double step = FIRST_STEP;
    *most = 0;
    TRY(list_sources(&m));
    m.each = 2 + LEAST_PROPOSALS / (m.count + 1);
    NEW(scene->context, STAGE, m.proposals, m.each * m.count);
    offer_known(&m, points);
    for (uint64_t g = 0; g < GENERATIONS && effort->work < effort->budget; g++) {
        find_neighbours(&m);
        TRY(move_sources(&m, draw * GENERATIONS + g, step, &effort->work));
        if (starg_time_is_over(scene->context))
            break;
        step *= STEP_FACTOR;
    }
    return take_best(&m, points, &effort->work, most);
}
