/* SPDX-License-Identifier: Apache-2.0 */
/* A border of several planes around what one of some guards sees.
 *
 * Problem: a guard g and others h1, h2, ... of a region; triangles A of its surface that only g is
 * strictly behind, and B that g is not. Which border leaves A to g and B to the others, such that
 * the part of g is star-shaped, and no facet of the border hides anything from the others?
 *
 * It must have g strictly below each of its facets and all h above. So if a point is g's, all of
 * the segment from g to it is; and if it is h's, all of the segment from h. Hence there is no
 * border where a segment from g to A meets one from h to B. With a single h that suffices: where
 * the cones conv(g, a) and conv(h, b) are disjoint for all a in A and b in B, there is a plane
 * between each two, with g and h on its sides. What is below any of several planes, or below all of
 * them, keeps that property (a monotone formula), and A is covered by the union over a of the
 * intersection over b of half-spaces.
 *
 * Method: few planes. A term, that is an intersection, starts with one triangle of A. Planes are
 * found until all of B is above one of them, each for as many triangles of B as possible; then the
 * term takes further triangles of A, as long as its planes can be turned so that nothing else
 * changes. Terms are added until A is covered. parting.c finds the planes.
 *
 * Invariants: every plane has g at least `gap` below and all h above it, and so all vertices on
 * which it was decided but the shared ones, which it passes through.
 *
 * Cost: some hundred planes, each linear in the vertices ten to a hundred times. */
#include "star/strict/search/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { MISSES_MOST = 12 };

/* A plane of the term that is being made, and the triangles of B above it. */
typedef struct fence {
    partition_plane plane;
    parting_triangles above;
} fence;

typedef struct ranked {
    double reach;
    uint32_t triangle;
} ranked;

typedef struct maker {
    const border_task *task;
    parting parting;
    fence fences[CUT_PLANES_MOST];
    int fence_count;
    parting_triangles members; /* of the term                              */
    parting_triangles left;    /* of A, in no term yet                     */
    parting_triangles rest;    /* of B, above no fence of the term yet     */
    STARG_ARRAY(ranked) order;
} maker;

static void maker_free(maker *m) {
    starg_context *context = m->parting.scratch->context;
    for (int i = 0; i < CUT_PLANES_MOST; i++)
        STARG_ARRAY_FREE(context, &m->fences[i].above);
    RELEASE(m->members.data, m->left.data, m->rest.data, m->order.data);
    parting_free(&m->parting);
}

/* ---- triangles in order ---- */

/* How far the triangle reaches above the plane, or below it. */
static double reach(const region *r, const partition_plane *plane, uint32_t triangle, double sign) {
    double most = -INFINITY;
    for (int k = 0; k < 3; k++)
        most = fmax(
            most, sign * (vec3_dot(plane->normal, parting_vertex(r, triangle, k)) - plane->offset));
    return most;
}

static double reach_of_term(const maker *m, uint32_t triangle) {
    double most = -INFINITY;
    for (int i = 0; i < m->fence_count; i++)
        most = fmax(most, reach(m->task->r, &m->fences[i].plane, triangle, 1));
    return most;
}

static int by_reach(const void *x, const void *y) {
    const ranked *a = x, *b = y;
    if (a->reach != b->reach)
        return a->reach < b->reach ? -1 : 1;
    return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static starg_status rank(maker *m, const parting_triangles *triangles, const fence *above) {
    m->order.count = 0;
    for (size_t i = 0; i < triangles->count; i++) {
        uint32_t t = triangles->data[i];
        const ranked fresh = {
            above != NULL ? reach(m->task->r, &above->plane, t, -1) : reach_of_term(m, t), t};
        PUSH(m->parting.scratch->context, PARTITION_STAGE, &m->order, fresh);
    }
    if (m->order.count > 1)
        qsort(m->order.data, m->order.count, sizeof *m->order.data, by_reach);
    return STARG_OK;
}

/* ---- a term ---- */

/* The rest of B, nearest first: what can be above the fence too is added there. */
static starg_status fill_fence(maker *m, fence *f) {
    int misses = 0;
    TRY(rank(m, &m->rest, f));
    m->rest.count = 0;
    for (size_t i = 0; i < m->order.count; i++) {
        uint32_t triangle = m->order.data[i].triangle;
        bool fits = reach(m->task->r, &f->plane, triangle, -1) < -m->task->gap;
        PUSH(m->parting.scratch->context, PARTITION_STAGE, &f->above, triangle);
        if (!fits && misses < MISSES_MOST) {
            partition_plane turned;
            TRY(parting_find(&m->parting, &m->members, &f->above, &turned, &fits));
            if (fits)
                f->plane = turned;
            misses += !fits;
        }
        if (!fits)
            m->rest.data[m->rest.count++] = f->above.data[--f->above.count];
    }
    return STARG_OK;
}

static uint32_t take_one(parting_triangles *from, starg_rng *rng) {
    size_t at = starg_rng_below(rng, from->count);
    uint32_t taken = from->data[at];
    from->data[at] = from->data[--from->count];
    return taken;
}

/* A fence, until all of B is above some. */
static starg_status fence_in(maker *m, uint32_t first, starg_rng *rng, bool *done) {
    starg_context *context = m->parting.scratch->context;
    m->fence_count = 0;
    m->members.count = m->rest.count = 0;
    *done = true;
    PUSH(context, PARTITION_STAGE, &m->members, first);
    for (size_t i = 0; i < m->task->others.count; i++)
        PUSH(context, PARTITION_STAGE, &m->rest, m->task->others.data[i]);
    do {
        *done = m->fence_count < CUT_PLANES_MOST;
        if (!*done)
            break;
        fence *f = &m->fences[m->fence_count++];
        f->above.count = 0;
        if (m->rest.count > 0)
            PUSH(context, PARTITION_STAGE, &f->above, take_one(&m->rest, rng));
        TRY(parting_find(&m->parting, &m->members, &f->above, &f->plane, done));
        if (*done)
            TRY(fill_fence(m, f));
    } while (*done && m->rest.count > 0);
    return STARG_OK;
}

/* Can the term have this triangle too? Then its planes are turned. */
static starg_status take(maker *m, uint32_t triangle, bool *taken) {
    partition_plane turned[CUT_PLANES_MOST];
    *taken = true;
    PUSH(m->parting.scratch->context, PARTITION_STAGE, &m->members, triangle);
    for (int i = 0; i < m->fence_count && *taken; i++) {
        turned[i] = m->fences[i].plane;
        if (reach(m->task->r, &turned[i], triangle, 1) >= -m->task->gap)
            TRY(parting_find(&m->parting, &m->members, &m->fences[i].above, &turned[i], taken));
    }
    for (int i = 0; i < m->fence_count && *taken; i++)
        m->fences[i].plane = turned[i];
    m->members.count -= !*taken;
    return STARG_OK;
}

/* What is left of A, nearest first. */
static starg_status take_more(maker *m) {
    int misses = 0;
    TRY(rank(m, &m->left, NULL));
    m->left.count = 0;
    for (size_t i = 0; i < m->order.count; i++) {
        uint32_t triangle = m->order.data[i].triangle;
        bool taken = reach_of_term(m, triangle) < -m->task->gap;
        if (taken)
            PUSH(m->parting.scratch->context, PARTITION_STAGE, &m->members, triangle);
        else if (misses < MISSES_MOST)
            TRY(take(m, triangle, &taken));
        if (taken)
            continue;
        misses++;
        m->left.data[m->left.count++] = triangle;
    }
    return STARG_OK;
}

/* ---- the border ---- */

static bool add_term(const maker *m, cut_plan *plan) {
    if (plan->count + m->fence_count > CUT_PLANES_MOST)
        return false;
    for (int i = 0; i < m->fence_count; i++) {
        plan->ends[plan->count] = i + 1 < m->fence_count ? CUT_GOES_ON : CUT_ENDS_TERM;
        plan->planes[plan->count++] = m->fences[i].plane;
    }
    return true;
}

static starg_status find(maker *m, starg_rng *rng, cut_plan *plan, bool *found) {
    int before = plan->count;
    *found = m->task->own.count > 0;
    for (size_t i = 0; i < m->task->own.count; i++)
        PUSH(m->parting.scratch->context, PARTITION_STAGE, &m->left, m->task->own.data[i]);
    while (*found && m->left.count > 0) {
        TRY(fence_in(m, take_one(&m->left, rng), rng, found));
        if (!*found)
            break;
        TRY(take_more(m));
        *found = add_term(m, plan);
    }
    if (*found)
        plan->ends[plan->count - 1] = CUT_ENDS_PART;
    else
        plan->count = before;
    return STARG_OK;
}

starg_status border_find(const border_task *task, starg_rng *rng, region_scratch *scratch,
                         cut_plan *plan, bool *found) {
    maker m = {.task = task, .parting = border_parting(task, scratch)};
    starg_status status = find(&m, rng, plan, found);
    maker_free(&m);
    return status;
}

bool border_holds(const region *r, const cut_plan *plan, uint32_t triangle) {
    bool below = true;
    for (int i = 0; i < plan->count; i++) {
        below = below && reach(r, &plan->planes[i], triangle, 1) <= 0;
        if (plan->ends[i] == CUT_GOES_ON)
            continue;
        if (below)
            return true;
        below = true;
    }
    return false;
}
