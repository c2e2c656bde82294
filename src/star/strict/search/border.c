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
 * changes. Terms are added until A is covered. A plane between two sets of points is perpendicular
 * to the shortest segment between their hulls (Kozinec's algorithm [Schlesinger and Hlavac 2002,
 * 5.2.4]). Vertices that A and B share must be in the plane, at most three of them; those are
 * projected away first.
 *
 * Invariants: every plane has g at least `gap` below and all h above it, and so all vertices on
 * which it was decided but the shared ones, which it passes through.
 *
 * Cost: some hundred planes, each linear in the vertices ten to a hundred times. */
#include "star/strict/search/border.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/vec3.h"

enum {
    STEPS_MOST = 150,
    STEPS_FINE = 20, /* through what is touched, where any plane will do then */
    MISSES_MOST = 12,
    TOUCHED_MOST = 3,
    PAIR_WORK = 12 /* for two cones, in what a row costs */
};

/* A plane is good enough if its distance to both sides is this share of what can be hoped for. */
static const double GOOD = 0.6;

typedef STARG_ARRAY(double) points;

/* A plane of the term that is being made, and the triangles of B above it. */
typedef struct fence {
    partition_plane plane;
    border_triangles above;
} fence;

typedef struct ranked {
    double reach;
    uint32_t triangle;
} ranked;

typedef struct maker {
    const region *r;
    const border_task *task;
    region_scratch *scratch;
    fence fences[BORDER_PLANES_MOST];
    int fence_count;
    border_triangles members; /* of the term                              */
    border_triangles left;    /* of A, in no term yet                     */
    border_triangles rest;    /* of B, above no fence of the term yet     */
    STARG_ARRAY(ranked) order;
    points low, high;            /* what a plane must separate               */
    STARG_ARRAY(uint32_t) marks; /* by vertex; all zero between calls */
    uint32_t touched[TOUCHED_MOST];
    int touched_count; /* may exceed TOUCHED_MOST, where there is no plane */
} maker;

static void maker_free(maker *m) {
    starg_context *context = m->scratch->context;
    for (int i = 0; i < BORDER_PLANES_MOST; i++)
        STARG_ARRAY_FREE(context, &m->fences[i].above);
    STARG_ARRAY_FREE(context, &m->members);
    STARG_ARRAY_FREE(context, &m->left);
    STARG_ARRAY_FREE(context, &m->rest);
    STARG_ARRAY_FREE(context, &m->order);
    STARG_ARRAY_FREE(context, &m->low);
    STARG_ARRAY_FREE(context, &m->high);
    STARG_ARRAY_FREE(context, &m->marks);
}

static const double *vertex_of(const region *r, uint32_t triangle, int k) {
    return r->vertices.data + 3 * (size_t)r->triangles.data[triangle].corners[k];
}

/* ---- what is below and above ---- */

enum { IN_LOW = 1, IN_HIGH = 2, LISTED = 4 };

static starg_status add_point(const maker *m, points *to, const double at[3]) {
    starg_status status = STARG_OK;
    for (int k = 0; k < 3; k++)
        STARG_PUSH(m->scratch->context, PARTITION_STAGE, to, at[k]);
done:
    return status;
}

static void mark(const maker *m, const border_triangles *triangles, uint32_t bit) {
    for (size_t i = 0; i < triangles->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t *at = &m->marks.data[m->r->triangles.data[triangles->data[i]].corners[k]];
            *at = bit == 0 ? 0 : *at | bit;
        }
}

/* Vertices of one side alone; those of both are touched. */
static starg_status list_vertices(maker *m, const border_triangles *triangles, uint32_t bit,
                                  points *to) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < triangles->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = m->r->triangles.data[triangles->data[i]].corners[k];
            uint32_t is = m->marks.data[v];
            if (is & LISTED)
                continue;
            m->marks.data[v] |= LISTED;
            if (is == bit)
                STARG_TRY(add_point(m, to, vertex_of(m->r, triangles->data[i], k)));
            else if (m->touched_count++ < TOUCHED_MOST)
                m->touched[m->touched_count - 1] = v;
        }
done:
    return status;
}

static starg_status set_sides(maker *m, const border_triangles *low, const border_triangles *high) {
    starg_status status = STARG_OK;
    const border_task *task = m->task;
    m->low.count = m->high.count = 0;
    m->touched_count = 0;
    while (m->marks.count < m->r->vertices.count / 3)
        STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->marks, 0);
    STARG_TRY(add_point(m, &m->low, task->guards[0]));
    for (size_t i = 1; i < task->guard_count; i++)
        STARG_TRY(add_point(m, &m->high, task->guards[i]));
    mark(m, low, IN_LOW);
    mark(m, high, IN_HIGH);
    STARG_TRY(list_vertices(m, low, IN_LOW, &m->low));
    STARG_TRY(list_vertices(m, high, IN_HIGH, &m->high));
    mark(m, low, 0);
    mark(m, high, 0);
done:
    return status;
}

/* ---- a plane between two sets ---- */

/* The point that is farthest along a direction times `sign`, and how far. */
static const double *farthest(const points *of, const double along[3], double sign, double *far) {
    const double *found = of->data;
    *far = -INFINITY;
    for (size_t i = 0; i < of->count; i += 3) {
        double at = sign * vec3_dot(of->data + i, along);
        if (at > *far) {
            *far = at;
            found = of->data + i;
        }
    }
    return found;
}

/* From `from` towards `to`, as near to `target` as can be. */
static void step(double from[3], const double to[3], const double target[3]) {
    double along[3], away[3];
    vec3_subtract(to, from, along);
    vec3_subtract(from, target, away);
    double t = -vec3_dot(away, along) / vec3_dot(along, along);
    vec3_along(from, fmin(1, fmax(0, t)), along, from);
}

static void set_plane(const double normal[3], double length, double offset, partition_plane *out) {
    for (int k = 0; k < 3; k++)
        out->normal[k] = normal[k] / length;
    out->offset = offset / length;
}

/* Between sets that share nothing. */
static bool find_free_plane(maker *m, partition_plane *out) {
    double a[3], b[3], normal[3];
    vec3_copy(m->low.data, a);
    vec3_copy(m->high.data, b);
    for (int i = 0; i < STEPS_MOST; i++) {
        double low, high;
        vec3_subtract(b, a, normal);
        double length = vec3_length(normal);
        m->scratch->work += (m->low.count + m->high.count) / 6;
        if (length < 2 * m->task->gap)
            return false;
        const double *highest = farthest(&m->low, normal, 1, &low);
        const double *lowest = farthest(&m->high, normal, -1, &high);
        double between = (-high - low) / length;
        if (between >= GOOD * length && between >= 2 * m->task->gap) {
            set_plane(normal, length, 0.5 * (low - high), out);
            return true;
        }
        if (low - vec3_dot(a, normal) > high + vec3_dot(b, normal))
            step(a, highest, b);
        else
            step(b, lowest, a);
    }
    return false;
}

/* Makes a vector perpendicular to axes that are so to each other and of length one. */
static void project(double v[3], double axes[2][3], int count) {
    for (int i = 0; i < count; i++)
        vec3_along(v, -vec3_dot(v, axes[i]), axes[i], v);
}

/* Through a point and along axes: a normal that is positive on what is above minus the point, and
 * on the point minus what is below. */
static bool find_plane_through(maker *m, const double origin[3], double axes[2][3], int count,
                               partition_plane *out) {
    static const double zero[3] = {0, 0, 0};
    double normal[3], to[3];
    vec3_subtract(m->high.data, m->low.data, normal);
    project(normal, axes, count);
    for (int i = 0; i < (count == 2 ? 1 : STEPS_MOST); i++) {
        double low, high, length = vec3_length(normal), base = vec3_dot(origin, normal);
        m->scratch->work += (m->low.count + m->high.count) / 6;
        if (length < m->task->gap)
            return false;
        const double *highest = farthest(&m->low, normal, 1, &low);
        const double *lowest = farthest(&m->high, normal, -1, &high);
        double below = (base - low) / length, above = (-high - base) / length;
        double least = fmin(below, above);
        if (least >= m->task->gap && (count == 2 || i >= STEPS_FINE || least >= GOOD * length)) {
            set_plane(normal, length, base, out);
            return true;
        }
        if (below < above)
            vec3_subtract(origin, highest, to);
        else
            vec3_subtract(lowest, origin, to);
        project(to, axes, count);
        step(normal, to, zero);
    }
    return false;
}

static bool find_plane_touching(maker *m, partition_plane *out) {
    double axes[2][3];
    const double *origin = m->r->vertices.data + 3 * (size_t)m->touched[0];
    int count = 0;
    for (int i = 1; i < m->touched_count; i++, count++) {
        vec3_subtract(m->r->vertices.data + 3 * (size_t)m->touched[i], origin, axes[count]);
        project(axes[count], axes, count);
        double length = vec3_length(axes[count]);
        if (length < m->task->gap)
            return false;
        for (int k = 0; k < 3; k++)
            axes[count][k] /= length;
    }
    return find_plane_through(m, origin, axes, count, out);
}

/* A plane with the first guard and `low` below, the other guards and `high` above. */
static starg_status find_plane(maker *m, const border_triangles *low, const border_triangles *high,
                               partition_plane *out, bool *found) {
    starg_status status = STARG_OK;
    *found = false;
    STARG_TRY(set_sides(m, low, high));
    if (m->touched_count == 0)
        *found = find_free_plane(m, out);
    else if (m->touched_count <= TOUCHED_MOST)
        *found = find_plane_touching(m, out);
done:
    return status;
}

/* ---- triangles in order ---- */

/* How far the triangle reaches above the plane, or below it. */
static double reach(const region *r, const partition_plane *plane, uint32_t triangle, double sign) {
    double most = -INFINITY;
    for (int k = 0; k < 3; k++)
        most =
            fmax(most, sign * (vec3_dot(plane->normal, vertex_of(r, triangle, k)) - plane->offset));
    return most;
}

static double reach_of_term(const maker *m, uint32_t triangle) {
    double most = -INFINITY;
    for (int i = 0; i < m->fence_count; i++)
        most = fmax(most, reach(m->r, &m->fences[i].plane, triangle, 1));
    return most;
}

static int by_reach(const void *x, const void *y) {
    const ranked *a = x, *b = y;
    if (a->reach != b->reach)
        return a->reach < b->reach ? -1 : 1;
    return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static starg_status rank(maker *m, const border_triangles *triangles, const fence *above) {
    starg_status status = STARG_OK;
    m->order.count = 0;
    for (size_t i = 0; i < triangles->count; i++) {
        uint32_t t = triangles->data[i];
        const ranked fresh = {
            above != NULL ? reach(m->r, &above->plane, t, -1) : reach_of_term(m, t), t};
        STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->order, fresh);
    }
    if (m->order.count > 1)
        qsort(m->order.data, m->order.count, sizeof *m->order.data, by_reach);
done:
    return status;
}

/* ---- a term ---- */

/* The rest of B, nearest first: what can be above the fence too is added there. */
static starg_status fill_fence(maker *m, fence *f) {
    starg_status status = STARG_OK;
    int misses = 0;
    STARG_TRY(rank(m, &m->rest, f));
    m->rest.count = 0;
    for (size_t i = 0; i < m->order.count; i++) {
        uint32_t triangle = m->order.data[i].triangle;
        bool fits = reach(m->r, &f->plane, triangle, -1) < -m->task->gap;
        STARG_PUSH(m->scratch->context, PARTITION_STAGE, &f->above, triangle);
        if (!fits && misses < MISSES_MOST) {
            partition_plane turned;
            STARG_TRY(find_plane(m, &m->members, &f->above, &turned, &fits));
            if (fits)
                f->plane = turned;
            misses += !fits;
        }
        if (!fits)
            m->rest.data[m->rest.count++] = f->above.data[--f->above.count];
    }
done:
    return status;
}

static uint32_t take_one(border_triangles *from, starg_rng *rng) {
    size_t at = starg_rng_below(rng, from->count);
    uint32_t taken = from->data[at];
    from->data[at] = from->data[--from->count];
    return taken;
}

/* A fence, until all of B is above some. */
static starg_status fence_in(maker *m, uint32_t first, starg_rng *rng, bool *done) {
    starg_status status = STARG_OK;
    starg_context *context = m->scratch->context;
    m->fence_count = 0;
    m->members.count = m->rest.count = 0;
    *done = true;
    STARG_PUSH(context, PARTITION_STAGE, &m->members, first);
    for (size_t i = 0; i < m->task->others.count; i++)
        STARG_PUSH(context, PARTITION_STAGE, &m->rest, m->task->others.data[i]);
    do {
        *done = m->fence_count < BORDER_PLANES_MOST;
        if (!*done)
            break;
        fence *f = &m->fences[m->fence_count++];
        f->above.count = 0;
        if (m->rest.count > 0)
            STARG_PUSH(context, PARTITION_STAGE, &f->above, take_one(&m->rest, rng));
        STARG_TRY(find_plane(m, &m->members, &f->above, &f->plane, done));
        if (*done)
            STARG_TRY(fill_fence(m, f));
    } while (*done && m->rest.count > 0);
done:
    return status;
}

/* Can the term have this triangle too? Then its planes are turned. */
static starg_status take(maker *m, uint32_t triangle, bool *taken) {
    starg_status status = STARG_OK;
    partition_plane turned[BORDER_PLANES_MOST];
    *taken = true;
    STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->members, triangle);
    for (int i = 0; i < m->fence_count && *taken; i++) {
        turned[i] = m->fences[i].plane;
        if (reach(m->r, &turned[i], triangle, 1) >= -m->task->gap)
            STARG_TRY(find_plane(m, &m->members, &m->fences[i].above, &turned[i], taken));
    }
    for (int i = 0; i < m->fence_count && *taken; i++)
        m->fences[i].plane = turned[i];
    m->members.count -= !*taken;
done:
    return status;
}

/* What is left of A, nearest first. */
static starg_status take_more(maker *m) {
    starg_status status = STARG_OK;
    int misses = 0;
    STARG_TRY(rank(m, &m->left, NULL));
    m->left.count = 0;
    for (size_t i = 0; i < m->order.count; i++) {
        uint32_t triangle = m->order.data[i].triangle;
        bool taken = reach_of_term(m, triangle) < -m->task->gap;
        if (taken)
            STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->members, triangle);
        else if (misses < MISSES_MOST)
            STARG_TRY(take(m, triangle, &taken));
        if (taken)
            continue;
        misses++;
        m->left.data[m->left.count++] = triangle;
    }
done:
    return status;
}

/* ---- the border ---- */

static bool add_term(const maker *m, border_plan *plan) {
    if (plan->count + m->fence_count > BORDER_PLANES_MOST)
        return false;
    for (int i = 0; i < m->fence_count; i++) {
        plan->ends[plan->count] = i + 1 < m->fence_count ? BORDER_GOES_ON : BORDER_ENDS_TERM;
        plan->planes[plan->count++] = m->fences[i].plane;
    }
    return true;
}

static starg_status find(maker *m, starg_rng *rng, border_plan *plan, bool *found) {
    starg_status status = STARG_OK;
    int before = plan->count;
    *found = m->task->own.count > 0;
    for (size_t i = 0; i < m->task->own.count; i++)
        STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->left, m->task->own.data[i]);
    while (*found && m->left.count > 0) {
        STARG_TRY(fence_in(m, take_one(&m->left, rng), rng, found));
        if (!*found)
            break;
        STARG_TRY(take_more(m));
        *found = add_term(m, plan);
    }
    if (*found)
        plan->ends[plan->count - 1] = BORDER_ENDS_PART;
    else
        plan->count = before;
done:
    return status;
}

starg_status border_find(const region *r, const border_task *task, starg_rng *rng,
                         region_scratch *scratch, border_plan *plan, bool *found) {
    maker m = {.r = r, .task = task, .scratch = scratch};
    starg_status status = find(&m, rng, plan, found);
    maker_free(&m);
    return status;
}

bool border_holds(const region *r, const border_plan *plan, uint32_t triangle) {
    bool below = true;
    for (int i = 0; i < plan->count; i++) {
        below = below && reach(r, &plan->planes[i], triangle, 1) <= 0;
        if (plan->ends[i] == BORDER_GOES_ON)
            continue;
        if (below)
            return true;
        below = true;
    }
    return false;
}

/* ---- crossings ---- */

/* The planes of the four sides of a cone, outward. */
typedef struct cone_sides {
    partition_plane planes[4];
} cone_sides;

static void set_side(const double a[3], const double b[3], const double c[3], const double inner[3],
                     partition_plane *out) {
    double normal[3];
    vec3_triangle_normal(a, b, c, normal);
    double length = vec3_length(normal), offset = vec3_dot(normal, a);
    double sign = vec3_dot(normal, inner) > offset ? -1 : 1;
    set_plane(normal, length > 0 ? sign * length : INFINITY, offset, out);
}

static void find_cone(const maker *m, uint32_t triangle, cone_sides *out) {
    const double *guard = m->task->guards[0];
    const double *c[3] = {vertex_of(m->r, triangle, 0), vertex_of(m->r, triangle, 1),
                          vertex_of(m->r, triangle, 2)};
    for (int k = 0; k < 3; k++)
        set_side(guard, c[k], c[(k + 1) % 3], c[(k + 2) % 3], &out->planes[k]);
    set_side(c[0], c[1], c[2], guard, &out->planes[3]);
}

/* Is everything of the other cone, but for shared vertices, beyond this side of the cone? */
static bool is_beyond(const maker *m, const partition_plane *side, uint32_t own, uint32_t other) {
    const uint32_t *c = m->r->triangles.data[own].corners, *d = m->r->triangles.data[other].corners;
    double limit = side->offset + m->task->gap;
    for (size_t i = 1; i < m->task->guard_count; i++)
        if (vec3_dot(side->normal, m->task->guards[i]) <= limit)
            return false;
    for (int k = 0; k < 3; k++)
        if (d[k] != c[0] && d[k] != c[1] && d[k] != c[2] &&
            vec3_dot(side->normal, vertex_of(m->r, other, k)) <= limit)
            return false;
    return true;
}

static starg_status cross(maker *m, const cone_sides *cone, uint32_t own, uint32_t other,
                          bool *crossed) {
    starg_status status = STARG_OK;
    partition_plane plane;
    *crossed = false;
    for (int i = 0; i < 4; i++)
        if (is_beyond(m, &cone->planes[i], own, other))
            return STARG_OK;
    m->members.count = m->rest.count = 0;
    STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->members, own);
    STARG_PUSH(m->scratch->context, PARTITION_STAGE, &m->rest, other);
    STARG_TRY(find_plane(m, &m->members, &m->rest, &plane, crossed));
    *crossed = !*crossed;
done:
    return status;
}

static starg_status count_crossings(maker *m, size_t most, size_t *count) {
    starg_status status = STARG_OK;
    const border_task *task = m->task;
    *count = 0;
    for (size_t i = 0; i < task->own.count && *count < most; i++) {
        cone_sides cone;
        find_cone(m, task->own.data[i], &cone);
        m->scratch->work += PAIR_WORK * task->others.count;
        for (size_t k = 0; k < task->others.count && *count < most; k++) {
            bool crossed;
            STARG_TRY(cross(m, &cone, task->own.data[i], task->others.data[k], &crossed));
            *count += crossed;
        }
    }
done:
    return status;
}

starg_status border_count_crossings(const region *r, const border_task *task, size_t most,
                                    region_scratch *scratch, size_t *count) {
    maker m = {.r = r, .task = task, .scratch = scratch};
    starg_status status = count_crossings(&m, most, count);
    maker_free(&m);
    return status;
}
