/* SPDX-License-Identifier: Apache-2.0 */
/* Local search of a search: can fewer guards see all witnesses?
 *
 * Problem. Find points, anywhere, one fewer than the guards, that see all witnesses often enough.
 *
 * It starts from the guards without one of them. Each step follows Gao, Weise and Li (EJOR 246,
 * 2015), as in cover/local.c, but the set of points is not fixed:
 *   1. remove the guard whose loss leaves the least weight of witnesses short of guards;
 *   2. draw a witness that lacks guards. Of all known points that see it, add the one with the
 *      largest gain. Before that the point climbs: points around it, in front of the witness, at
 *      the wall, and towards the other guards replace it if they gain as much or more. If the climb
 *      ends higher, its point joins the known ones;
 *   3. add one to the weight of each witness that still lacks guards.
 * When no witness lacks guards, the points are tested against all faces: they are better guards, or
 * the faces that they miss become witnesses, of weight 1, and the search continues with these and
 * one guard fewer.
 *
 * A climb tests only the few witnesses that lack guards, so it costs less than testing one point
 * against all witnesses. The prices of the linear program show where a fractional cover lacks
 * points (guard/search_moves.c), the weights where an integral one does.
 *
 * Cost of a step: a row of each known point; CLIMB points, each tested against a few witnesses. It
 * ends after PATIENCE steps without better guards, or with the budget. */
#include <math.h>

#include "core/streams.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { CLIMB = 30, PATIENCE = 500, PATIENCE_PER_GUARD = 50 };

static const double FIRST_STEP = 0.5, STEP_FACTOR = 0.9;

typedef struct local_search {
    search *s;
    uint32_t *chosen; /* points of the search */
    size_t *moved;    /* by chosen point: the step that added it */
    size_t count;
    size_t step, last; /* the current one; the one that found better guards */
    uint32_t held[MOST_WITNESSES];
    double weight[MOST_WITNESSES];
    witness_row open; /* witnesses that lack guards */
    size_t fewest;    /* fewest that a step has left so far */
    size_t known;     /* number of witnesses already counted in `held` */
    starg_rng rng;
} local_search;

static void count_in(local_search *l, size_t j, size_t held) {
    l->held[j] = (uint32_t)held;
    if (held < l->s->witnesses.redundancy)
        starg_bit_set(l->open.bits, j);
    else
        starg_bit_clear(l->open.bits, j);
}

static const witness_row *row_of(const local_search *l, uint32_t point) {
    return &l->s->points.data[point].seen;
}

static void add_point(local_search *l, uint32_t point) {
    const witness_row *row = row_of(l, point);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            count_in(l, 64 * w + bit, l->held[64 * w + bit] + 1);
    l->moved[l->count] = l->step;
    l->chosen[l->count++] = point;
}

static uint32_t remove_point(local_search *l, size_t at) {
    uint32_t point = l->chosen[at];
    const witness_row *row = row_of(l, point);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            count_in(l, 64 * w + bit, l->held[64 * w + bit] - 1);
    l->count--;
    l->chosen[at] = l->chosen[l->count];
    l->moved[at] = l->moved[l->count];
    return point;
}

/* Counts new witnesses. */
static void take_witnesses(local_search *l) {
    for (; l->known < l->s->witnesses.scene.witnesses.count; l->known++) {
        size_t held = 0;
        for (size_t i = 0; i < l->count; i++)
            held += starg_bit_test(row_of(l, l->chosen[i])->bits, l->known);
        l->weight[l->known] = 1;
        count_in(l, l->known, held);
    }
}

/* The weight of the witnesses that would lack guards without this guard. */
static double loss_of(const local_search *l, size_t at) {
    const witness_row *row = row_of(l, l->chosen[at]);
    double loss = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            if (l->held[64 * w + bit] == l->s->witnesses.redundancy)
                loss += l->weight[64 * w + bit];
    return loss;
}

/* The guard of least loss, the oldest among equals; not the one just added. */
static size_t choose_to_remove(const local_search *l) {
    size_t best = SIZE_MAX;
    double least = INFINITY;
    for (size_t i = 0; i < l->count; i++) {
        double loss = loss_of(l, i);
        if (l->moved[i] + 1 == l->step && l->count > 1)
            continue;
        if (loss < least || (loss <= least && l->moved[i] < l->moved[best])) {
            least = loss;
            best = i;
        }
    }
    return best;
}

static double gain_of(const local_search *l, const witness_row *row) {
    double gain = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w] & l->open.bits[w])
            gain += l->weight[64 * w + bit];
    return gain;
}

/* How many witnesses lack guards once the point is added? */
static size_t count_left(const local_search *l, uint32_t point) {
    size_t left = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        left += starg_bits_in(l->open.bits[w] & ~row_of(l, point)->bits[w]);
    return left;
}

static bool is_chosen(const local_search *l, size_t point) {
    for (size_t i = 0; i < l->count; i++)
        if (l->chosen[i] == point)
            return true;
    return false;
}

/* Of the known points that see a witness, the one of largest gain, the latest among equals; not the
 * point just removed. */
static uint32_t choose_to_add(local_search *l, size_t witness, uint32_t gone, double *most) {
    uint32_t best = gone;
    *most = 0;
    for (size_t i = 0; i < l->s->points.count; i++) {
        const witness_row *row = &l->s->points.data[i].seen;
        if (i == gone || !starg_bit_test(row->bits, witness))
            continue;
        double gain = gain_of(l, row);
        if (gain >= *most && !is_chosen(l, i)) {
            *most = gain;
            best = (uint32_t)i;
        }
    }
    l->s->effort.work += 1 + l->s->points.count / 100;
    return best;
}

/* The gain of a point; 0 as soon as it falls below `least`. */
static double look_from(local_search *l, search_point *point, size_t witness, double least) {
    const search_scene *scene = &l->s->witnesses.scene;
    double left = gain_of(l, &l->open);
    uint64_t work = 1;
    bool sees = candidates_allowed(scene->solid, point->place, scene->clearance) &&
                search_scene_sees(scene, point, witness, &work);
    if (sees)
        starg_bit_set(point->seen.bits, witness);
    for (size_t w = 0; w < WITNESS_WORDS && sees && left >= least; w++)
        STARG_FOR_BITS (bit, l->open.bits[w]) {
            size_t j = 64 * w + bit;
            if (j == witness || left < least)
                continue;
            if (search_scene_may_see(scene, point->place, j) &&
                search_scene_sees(scene, point, j, &work))
                starg_bit_set(point->seen.bits, j);
            else
                left -= l->weight[j];
        }
    l->s->effort.work += 2 * work;
    return sees && left >= least ? left : 0;
}

/* Looks for a point of larger gain than `point`, which then joins the known points. */
static starg_status climb(local_search *l, uint32_t *point, size_t witness, double gain) {
    search *s = l->s;
    const search_scene *scene = &s->witnesses.scene;
    search_point best = s->points.data[*point];
    double most = gain, step = FIRST_STEP;
    for (int k = 0; k < CLIMB; k++, step *= STEP_FACTOR) {
        const double *other = NULL;
        search_point next;
        search_stand stand = (search_stand)(k % STANDS);
        if (stand == STAND_BETWEEN && l->count > 0)
            other = s->points.data[l->chosen[starg_rng_below(&l->rng, l->count)]].place;
        search_propose(scene, &best, witness, other, stand, step, &l->rng, &next);
        double found = look_from(l, &next, witness, most);
        if (found >= most) {
            most = found;
            best = next;
        }
    }
    if (most > gain) {
        witness_row rest = search_scene_witnesses(scene, 0);
        for (int w = 0; w < WITNESS_WORDS; w++)
            rest.bits[w] &= ~l->open.bits[w];
        TRY(points_look_at(scene, &best, 1, &rest, &s->effort.work));
        *point = (uint32_t)s->points.count;
        TRY(points_add(scene->context, &best, &s->points));
    }
    return STARG_OK;
}

static starg_status take_step(local_search *l) {
    double gain;
    l->step++;
    size_t out = choose_to_remove(l);
    uint32_t gone = out != SIZE_MAX ? remove_point(l, out) : UINT32_MAX;
    size_t witness = search_draw(&l->open, 0, &l->rng);
    uint32_t in = choose_to_add(l, witness, gone, &gain);
    if (in != UINT32_MAX) {
        size_t left = count_left(l, in);
        if (left <= l->fewest)
            TRY(climb(l, &in, witness, gain));
        l->fewest = left < l->fewest ? left : l->fewest;
        add_point(l, in);
    }
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, l->open.bits[w])
            l->weight[64 * w + bit]++;
    return STARG_OK;
}

/* Starts from the guards. */
static starg_status begin(local_search *l) {
    const search *s = l->s;
    const size_t guards = s->best.guards.count;
    NEW(s->problem->context, STAGE, l->chosen, guards);
    NEW_ZERO(s->problem->context, STAGE, l->moved, guards);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        l->weight[j] = 1;
    for (size_t i = 0; i < s->points.count; i++)
        for (size_t k = 0; k < guards; k++)
            if (s->points.data[i].candidate == s->best.guards.data[k])
                add_point(l, (uint32_t)i);
    take_witnesses(l);
    return STARG_OK;
}

/* The points see all witnesses: tests them against all faces. *more: there are fewer guards or more
 * witnesses. */
static starg_status try_guards(local_search *l, bool *changed, bool *more) {
    const search *s = l->s;
    size_t guards = s->best.guards.count, witnesses = s->witnesses.scene.witnesses.count;
    bool found;
    TRY(search_try_guards(l->s, l->chosen, l->count, &found));
    *changed = *changed || found;
    if (s->best.guards.count < guards)
        l->last = l->step;
    l->fewest = SIZE_MAX;
    take_witnesses(l);
    *more = s->witnesses.scene.witnesses.count > witnesses || s->best.guards.count < guards;
    return STARG_OK;
}

static bool may_go_on(const local_search *l) {
    const search *s = l->s;
    const size_t guards = s->best.guards.count;
    return l->step < l->last + PATIENCE + PATIENCE_PER_GUARD * guards &&
           s->effort.work < s->effort.budget && !starg_time_is_over(s->problem->context) &&
           guards > 1;
}

static void local_search_free(local_search *l) {
    RELEASE(l->chosen, l->moved);
}

starg_status search_fewer(search *s, uint64_t draw, bool *changed) {
    starg_context *context = s->problem->context;
    SCOPED_BY(local_search_free) local_search l = {.s = s, .fewest = SIZE_MAX};
    size_t first = s->points.count;
    bool more = true;
    *changed = false;
    l.rng = starg_rng_make(context->seed, STREAM_LOCAL_SEARCH, draw);
    TRY(begin(&l));
    while (more && may_go_on(&l)) {
        TRY(starg_check_cancel(context, STAGE));
        while (l.count >= s->best.guards.count)
            remove_point(&l, choose_to_remove(&l));
        if (starg_bit_count(l.open.bits, WITNESS_WORDS) > 0) {
            TRY(take_step(&l));
            continue;
        }
        TRY(try_guards(&l, changed, &more));
    }
    points_prune(&s->points, first, &s->effort.work);
    return STARG_OK;
}
