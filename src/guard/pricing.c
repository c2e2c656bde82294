/* SPDX-License-Identifier: Apache-2.0 */
/* Column generation for guards: where would a new candidate pay?
 *
 * The linear relaxation of the cover pays a price for each face; a point lowers its bound only if
 * the prices of the faces that it sees sum to more than 1. Nearly all of the price lies on a few
 * hundred faces, those that are hard to see: the binding faces. Each binding face remembers the
 * most valuable point known that sees it, at first one of the pool, and lets it move:
 *   - about where it stands, by a step that shrinks from generation to generation;
 *   - towards the best point of another binding face nearby, into the space that both could share;
 *   - in front of its own face, where it is seen from.
 * The first round begins with places all over the solid, that binding faces do not only find what
 * is near. All proposals of a generation are looked at together, and a point that is better for any
 * binding face replaces that binding face's point; one that is as good does too, so that binding
 * faces wander over plateaus. At the end the binding faces' new points that are worth 1 or more are
 * the new candidates: with less than 1 a point cannot pay, with just 1 it may, together with
 * others, because the prices of a program with many optima are only some of those that would do.
 *
 * A proposal is looked at by the binding faces only, by the tree, and not at all if its own binding
 * face does not see it: that takes hardly longer on a large model than on a small one.
 *
 * Everything depends on the seed, the round and the binding face only. Cost: O(log n) for each
 * sight line; at most PROPOSALS x GENERATIONS x binding faces^2 of them a call. */
#include "guard/pricing.h"

#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

static const char STAGE[] = "refine";

enum {
    MOST_BINDING_FACES = 512,
    WORDS = MOST_BINDING_FACES / 64,
    GENERATIONS = 5,
    PROPOSALS = 6,
    NEIGHBOURS = 8
};

#define ANY_FACE UINT32_MAX

static const double LEAST_PRICE = 1e-3, WORTH = 1 - 1e-6, FIRST_STEP = 0.6, TIE = 1e-6,
                    STEP_FACTOR = 0.6;

typedef struct binding_face {
    uint32_t column;
    uint32_t place; /* in the scene: rank of the face, slot of the vertex */
    double price;
    double centre[3];    /* of the face; the vertex */
    double best[3];      /* the most valuable point known that sees it */
    double direction[3]; /* in which it looks, if views are cones */
    double value;
    bool is_new;               /* `best` is no candidate yet */
    uint32_t near[NEIGHBOURS]; /* binding faces; count in near_count */
    int near_count;
} binding_face;

/* A point that one binding face proposes. */
typedef struct proposal {
    double p[3], direction[3];
    uint32_t by;          /* the binding face, or ANY_FACE */
    uint32_t lines;       /* sight lines that it took to find out: */
    uint64_t seen[WORDS]; /* the binding faces that it sees; none if it does not see its own */
} proposal;

typedef struct work {
    pricing *all;
    visibility_scene *scene;
    binding_face *binding_faces;
    size_t count;
    proposal *proposals; /* of a generation: PROPOSALS a binding face */
} work;

static int by_price(const void *a, const void *b) {
    const binding_face *x = a, *y = b;
    if (x->price != y->price)
        return x->price > y->price ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

static void find_centre(const guard_pool *pool, binding_face *n) {
    const starg_mesh *mesh = pool->solid->mesh;
    if (pool->options->visibility.target == STARG_TARGET_VERTICES) {
        vec3_copy(mesh->vertices + 3 * (size_t)n->column, n->centre);
        return;
    }
    const uint32_t *c = mesh->faces + 3 * (size_t)n->column;
    for (int k = 0; k < 3; k++)
        n->centre[k] = mesh->vertices[3 * (size_t)c[0] + (size_t)k] / 3 +
                       mesh->vertices[3 * (size_t)c[1] + (size_t)k] / 3 +
                       mesh->vertices[3 * (size_t)c[2] + (size_t)k] / 3;
}

static starg_status list_binding_faces(work *w) {
    starg_status status = STARG_OK;
    const guard_pool *pool = w->all->pool;
    size_t priced = 0;
    for (size_t j = 0; j < pool->columns; j++)
        priced += w->all->prices[j] > LEAST_PRICE;
    STARG_NEW_ZERO(pool->context, STAGE, w->binding_faces, priced);
    for (size_t j = 0; j < pool->columns; j++)
        if (w->all->prices[j] > LEAST_PRICE)
            w->binding_faces[w->count++] =
                (binding_face){.column = (uint32_t)j, .price = w->all->prices[j]};
    qsort(w->binding_faces, w->count, sizeof *w->binding_faces, by_price);
    if (w->count > MOST_BINDING_FACES)
        w->count = MOST_BINDING_FACES;
    for (size_t i = 0; i < w->count; i++)
        find_centre(pool, &w->binding_faces[i]);
done:
    return status;
}

/* Looks up where the scene has the binding faces. */
static starg_status place_binding_faces(work *w) {
    starg_status status = STARG_OK;
    starg_context *context = w->all->pool->context;
    bool vertices = w->all->pool->options->visibility.target == STARG_TARGET_VERTICES;
    uint32_t *rank_of = NULL;
    STARG_NEW(context, STAGE, rank_of, w->scene->face_count);
    for (size_t rank = 0; rank < w->scene->face_count; rank++)
        rank_of[w->scene->face_of[rank]] = (uint32_t)rank;
    for (size_t i = 0; i < w->count; i++) {
        binding_face *n = &w->binding_faces[i];
        n->place = vertices ? w->scene->slot_of[n->column] : rank_of[n->column];
    }
done:
    starg_release(context, rank_of);
    return status;
}

/* Offers a point to the binding faces that it sees. */
static void offer(work *w, const double p[3], const double *direction, const uint64_t seen[WORDS],
                  bool is_new) {
    double value = 0;
    for (size_t i = 0; i < w->count; i++)
        if (starg_bit_test(seen, i))
            value += w->binding_faces[i].price;
    for (size_t i = 0; i < w->count; i++) {
        binding_face *n = &w->binding_faces[i];
        double least = is_new ? n->value - TIE : n->value + TIE;
        if (value < least || !starg_bit_test(seen, i))
            continue;
        n->value = value;
        n->is_new = is_new;
        vec3_copy(p, n->best);
        if (direction != NULL)
            vec3_copy(direction, n->direction);
    }
}

static void offer_pool(work *w) {
    const guard_pool *pool = w->all->pool;
    for (size_t i = 0; i < pool_count(pool); i++) {
        uint64_t seen[WORDS] = {0};
        for (size_t k = 0; k < w->count; k++)
            if (starg_bits_test(pool->rows, i, w->binding_faces[k].column))
                starg_bit_set(seen, k);
        offer(w, pool_point(pool, i), pool_direction(pool, i), seen, false);
    }
}

/* The binding faces whose best points stand closest, nearest first. */
static void find_neighbours(work *w) {
    for (size_t i = 0; i < w->count; i++) {
        binding_face *n = &w->binding_faces[i];
        double distance[NEIGHBOURS];
        n->near_count = 0;
        for (size_t j = 0; j < w->count; j++) {
            double d = vec3_distance(n->best, w->binding_faces[j].best);
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

static void propose(const work *w, const binding_face *n, int kind, double step, starg_rng *rng,
                    double p[3]) {
    double shift[3], reach = vec3_distance(n->best, n->centre);
    random_ball(rng, shift);
    if (kind == 1 && n->near_count > 0) {
        const binding_face *other =
            &w->binding_faces[n->near[starg_rng_below(rng, (uint64_t)n->near_count)]];
        double t = starg_rng_unit(rng);
        for (int k = 0; k < 3; k++)
            p[k] = n->best[k] + t * (other->best[k] - n->best[k]);
        reach = vec3_distance(n->best, other->best);
        vec3_along(p, 0.3 * step * reach, shift, p);
    } else if (kind == 2) {
        double t = 0.3 + 1.2 * starg_rng_unit(rng);
        for (int k = 0; k < 3; k++)
            p[k] = n->centre[k] + t * (n->best[k] - n->centre[k]);
        vec3_along(p, step * t * reach, shift, p);
    } else {
        vec3_along(n->best, step * reach, shift, p);
    }
}

/* A direction near that of the binding face's best. */
static void turn(const binding_face *n, double step, starg_rng *rng, double direction[3]) {
    double shift[3];
    random_ball(rng, shift);
    vec3_along(n->direction, step, shift, direction);
    double length = vec3_length(direction);
    for (int k = 0; k < 3 && length > 0; k++)
        direction[k] /= length;
}

static bool sees_binding_face(const work *w, proposal *q, size_t index) {
    starg_visibility_options options = w->all->pool->options->visibility;
    const binding_face *n = &w->binding_faces[index];
    options.directions = q->direction;
    q->lines++;
    if (options.target == STARG_TARGET_VERTICES)
        return scene_sees_vertex(w->scene, q->p, n->place, &options);
    return scene_sees_face(w->scene, q->p, n->place, &options);
}

static starg_status look_from(starg_context *context, void *shared, void *scratch, size_t item) {
    const work *w = shared;
    proposal *q = &w->proposals[item];
    const guard_pool *pool = w->all->pool;
    (void)context;
    (void)scratch;
    if (!candidates_allowed(pool->solid, q->p, pool->options->clearance) ||
        (q->by != ANY_FACE && !sees_binding_face(w, q, q->by)))
        return STARG_OK;
    for (size_t i = 0; i < w->count; i++)
        if (i == q->by || sees_binding_face(w, q, i))
            starg_bit_set(q->seen, i);
    return STARG_OK;
}

static void spend(pricing *all, size_t lines) {
    all->lines_left -= lines < all->lines_left ? lines : all->lines_left;
}

/* Looks from the first `count` proposals; the binding faces take what is better. */
static starg_status try_proposals(work *w, size_t count) {
    starg_status status = STARG_OK;
    starg_parallel_loop loop = {.stage = STAGE, .count = count, .shared = w, .item = look_from};
    STARG_TRY(starg_parallel_for(w->all->pool->context, &loop));
    for (size_t k = 0; k < count; k++) {
        const proposal *q = &w->proposals[k];
        offer(w, q->p, q->direction, q->seen, true);
        spend(w->all, q->lines);
    }
done:
    return status;
}

/* One generation: every binding face proposes. */
static starg_status move_binding_faces(work *w, uint64_t generation, double step) {
    starg_context *context = w->all->pool->context;
    for (size_t i = 0; i < w->count; i++) {
        starg_rng rng = starg_rng_make(context->seed, w->all->round * GENERATIONS + generation,
                                       w->binding_faces[i].column);
        for (size_t kind = 0; kind < PROPOSALS; kind++) {
            proposal *q = &w->proposals[PROPOSALS * i + kind];
            *q = (proposal){.by = (uint32_t)i};
            propose(w, &w->binding_faces[i], (int)kind % 3, step, &rng, q->p);
            turn(&w->binding_faces[i], step, &rng, q->direction);
        }
    }
    return try_proposals(w, PROPOSALS * w->count);
}

/* Places that nobody proposes: they belong to no binding face, and to all. */
static starg_status survey_places(work *w) {
    starg_status status = STARG_OK;
    const candidate_points *places = w->all->places;
    size_t room = PROPOSALS * w->count, count = 0;
    for (size_t i = 0; i < candidates_count(places) && count < room; i++) {
        const double *p = places->data.data + 3 * i;
        proposal *q = &w->proposals[count++];
        *q = (proposal){.by = ANY_FACE};
        vec3_copy(p, q->p);
    }
    STARG_TRY(try_proposals(w, count));
done:
    return status;
}

static bool stands_before(const work *w, size_t index) {
    for (size_t i = 0; i < index; i++)
        if (vec3_equal(w->binding_faces[i].best, w->binding_faces[index].best) &&
            vec3_equal(w->binding_faces[i].direction, w->binding_faces[index].direction))
            return true;
    return false;
}

starg_status price_candidates(pricing *all, candidate_points *found) {
    starg_status status = STARG_OK;
    starg_context *context = all->pool->context;
    work w = {.all = all};
    bool cone = all->pool->options->visibility.cone < 360;
    STARG_TRY(scene_create(context, all->pool->solid, &w.scene));
    STARG_TRY(list_binding_faces(&w));
    STARG_TRY(place_binding_faces(&w));
    STARG_NEW(context, STAGE, w.proposals, PROPOSALS * w.count);
    offer_pool(&w);
    if (!cone && all->round == 0)
        STARG_TRY(survey_places(&w));
    double step = FIRST_STEP;
    for (uint64_t g = 0; g < GENERATIONS && all->lines_left > 0; g++, step *= STEP_FACTOR) {
        find_neighbours(&w);
        STARG_TRY(move_binding_faces(&w, g, step));
        if (starg_time_is_over(context))
            break;
    }
    for (size_t i = 0; i < w.count; i++)
        if (w.binding_faces[i].is_new && w.binding_faces[i].value > WORTH && !stands_before(&w, i))
            STARG_TRY(candidates_push(context, found, w.binding_faces[i].best,
                                      cone ? w.binding_faces[i].direction : NULL));
done:
    starg_release(context, w.binding_faces);
    starg_release(context, w.proposals);
    scene_free(w.scene);
    return status;
}
