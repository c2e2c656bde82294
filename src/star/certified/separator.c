/* SPDX-License-Identifier: Apache-2.0 */
/* A border of several planes around what one of some guards sees.
 *
 * Problem: a guard g and others h1, h2, ... of a region; triangles A of its surface that only g is
 * strictly behind, and B that g is not. Which border leaves A to g and B to the others, such that
 * the part of g is star-shaped, and no facet of the border hides anything from the others?
 *
 * It must have g strictly below each of its facets and all h above it. So if a point is g's, all of
 * the segment from g to it is; and if it is h's, all of the segment from h. Hence there is no
 * border where a segment from g to A meets one from h to B. With a single h that suffices: where
 * the cones conv(g, a) and conv(h, b) are disjoint for all a in A and b in B, there is a plane
 * between each two, with g and h on its sides. What is below any of several planes, or below all of
 * them, keeps that property (a monotone formula), and A is covered by the union over a of the
 * intersection over b of half-spaces.
 *
 * Planes: one between two sets of points is perpendicular to the shortest segment between their
 * hulls (Kozinec's algorithm [Schlesinger and Hlavac 2002, 5.2.4]). Vertices of both sets, at most
 * three, must be in the plane, and are projected away first.
 *
 * Crossings: pairs of cones without such a plane. The sides of one cone part most pairs, and else a
 * search decides. A pair counts unless there is a plane that keeps the gap: a few that touch count,
 * too.
 *
 * The border has few planes. A term, that is an intersection, starts with one triangle of A. Planes
 * are found until all of B is above one of them, each for as many triangles of B as possible; then
 * the term takes further triangles of A, as long as its planes can be turned so that nothing else
 * changes. Terms are added until A is covered.
 *
 * Invariants: every plane has g at least `gap` below and all h above it, and so all vertices on
 * which it was decided but the shared ones, which it passes through.
 *
 * Cost: some hundred planes, each linear in the vertices ten to a hundred times; to count
 * crossings, four planes for each pair, and a search for few of them. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "geometry/vec3.h"

enum { PARTING_TOUCHED_MOST = 3 };

typedef STARG_ARRAY(double) parting_points;

typedef struct parting {
    const region *r;
    const double (*guards)[3]; /* the first one is below, all others above */
    size_t guard_count;
    double gap; /* that planes keep to guards and triangles, in unit coordinates */
    region_scratch *scratch;

    /* of the current pair of sets */
    parting_points low, high;
    separator_triangles marks; /* by vertex; all zero between calls */
    uint32_t touched[PARTING_TOUCHED_MOST];
    int touched_count; /* may be larger: then there is no plane */
} parting;

static const double *parting_vertex(const region *r, uint32_t triangle, int k) {
    return r->vertices.data + 3 * (size_t)r->triangles.data[triangle].corners[k];
}

/* For planes between triangles of a task. */
static parting make_parting(const separator_task *task, region_scratch *scratch) {
    return (parting){.r = task->r,
                     .guards = task->guards,
                     .guard_count = task->guard_count,
                     .gap = task->gap,
                     .scratch = scratch};
}

enum {
    /* of the search for a plane */
    STEPS_MOST = 150,
    STEPS_FINE = 20 /* through what is touched, where any plane will do then */
};

/* A plane is good enough if its distance to both sides is this share of what can be hoped for. */
static const double GOOD = 0.6;

static void parting_free(parting *p) {
    RELEASE(p->low.data, p->high.data, p->marks.data);
}

/* ---- separating planes: what is below and above ---- */

enum { IN_LOW = 1, IN_HIGH = 2, LISTED = 4 };

static starg_status add_point(const parting *p, parting_points *to, const double at[3]) {
    for (int k = 0; k < 3; k++)
        PUSH(p->scratch->context, PARTITION_STAGE, to, at[k]);
    return STARG_OK;
}

static void mark(const parting *p, const separator_triangles *triangles, uint32_t bit) {
    for (size_t i = 0; i < triangles->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t *at = &p->marks.data[p->r->triangles.data[triangles->data[i]].corners[k]];
            *at = bit == 0 ? 0 : *at | bit;
        }
}

/* Vertices of one side alone; those of both are touched. */
static starg_status list_vertices(parting *p, const separator_triangles *triangles, uint32_t bit,
                                  parting_points *to) {
    for (size_t i = 0; i < triangles->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = p->r->triangles.data[triangles->data[i]].corners[k];
            uint32_t is = p->marks.data[v];
            if (is & LISTED)
                continue;
            p->marks.data[v] |= LISTED;
            if (is == bit)
                TRY(add_point(p, to, parting_vertex(p->r, triangles->data[i], k)));
            else if (p->touched_count++ < PARTING_TOUCHED_MOST)
                p->touched[p->touched_count - 1] = v;
        }
    return STARG_OK;
}

static starg_status set_sides(parting *p, const separator_triangles *low,
                              const separator_triangles *high) {
    p->low.count = p->high.count = 0;
    p->touched_count = 0;
    while (p->marks.count < p->r->vertices.count / 3)
        PUSH(p->scratch->context, PARTITION_STAGE, &p->marks, 0);
    TRY(add_point(p, &p->low, p->guards[0]));
    for (size_t i = 1; i < p->guard_count; i++)
        TRY(add_point(p, &p->high, p->guards[i]));
    mark(p, low, IN_LOW);
    mark(p, high, IN_HIGH);
    TRY(list_vertices(p, low, IN_LOW, &p->low));
    TRY(list_vertices(p, high, IN_HIGH, &p->high));
    mark(p, low, 0);
    mark(p, high, 0);
    return STARG_OK;
}

/* ---- separating planes: the search ---- */

/* The point that is farthest along a direction times `sign`, and how far. */
static const double *farthest(const parting_points *of, const double along[3], double sign,
                              double *far) {
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
static bool find_free_plane(parting *p, partition_plane *out) {
    double a[3], b[3], normal[3];
    vec3_copy(p->low.data, a);
    vec3_copy(p->high.data, b);
    for (int i = 0; i < STEPS_MOST; i++) {
        double low, high;
        vec3_subtract(b, a, normal);
        double length = vec3_length(normal);
        p->scratch->work += (p->low.count + p->high.count) / 6;
        if (length < 2 * p->gap)
            return false;
        const double *highest = farthest(&p->low, normal, 1, &low);
        const double *lowest = farthest(&p->high, normal, -1, &high);
        double between = (-high - low) / length;
        if (between >= GOOD * length && between >= 2 * p->gap) {
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
static bool find_plane_through(parting *p, const double origin[3], double axes[2][3], int count,
                               partition_plane *out) {
    static const double zero[3] = {0, 0, 0};
    double normal[3], to[3];
    vec3_subtract(p->high.data, p->low.data, normal);
    project(normal, axes, count);
    for (int i = 0; i < (count == 2 ? 1 : STEPS_MOST); i++) {
        double low, high, length = vec3_length(normal), base = vec3_dot(origin, normal);
        p->scratch->work += (p->low.count + p->high.count) / 6;
        if (length < p->gap)
            return false;
        const double *highest = farthest(&p->low, normal, 1, &low);
        const double *lowest = farthest(&p->high, normal, -1, &high);
        double below = (base - low) / length, above = (-high - base) / length;
        double least = fmin(below, above);
        if (least >= p->gap && (count == 2 || i >= STEPS_FINE || least >= GOOD * length)) {
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

static bool find_plane_touching(parting *p, partition_plane *out) {
    double axes[2][3];
    const double *origin = p->r->vertices.data + 3 * (size_t)p->touched[0];
    int count = 0;
    for (int i = 1; i < p->touched_count; i++, count++) {
        vec3_subtract(p->r->vertices.data + 3 * (size_t)p->touched[i], origin, axes[count]);
        project(axes[count], axes, count);
        if (vec3_normalize(axes[count]) < p->gap)
            return false;
    }
    return find_plane_through(p, origin, axes, count, out);
}

/* Looks for a plane with the first guard and `low` below, the other guards and `high` above.
 * Errors: MEMORY. */
static starg_status parting_find(parting *p, const separator_triangles *low,
                                 const separator_triangles *high, partition_plane *out,
                                 bool *found) {
    *found = false;
    TRY(set_sides(p, low, high));
    if (p->touched_count == 0)
        *found = find_free_plane(p, out);
    else if (p->touched_count <= PARTING_TOUCHED_MOST)
        *found = find_plane_touching(p, out);
    return STARG_OK;
}

/* ---- cones that meet ---- */

enum { PAIR_WORK = 12 /* for two cones, in what a row costs */ };

/* The planes of the four sides of a cone, outward. */
typedef struct cone_sides {
    partition_plane planes[4];
} cone_sides;

static void set_side(const double a[3], const double b[3], const double c[3], const double inner[3],
                     partition_plane *out) {
    double normal[3];
    vec3_triangle_normal(a, b, c, normal);
    double length = vec3_length(normal), offset = vec3_dot(normal, a);
    double scale = length > 0 ? (vec3_dot(normal, inner) > offset ? -1 : 1) / length : 0;
    for (int k = 0; k < 3; k++)
        out->normal[k] = scale * normal[k];
    out->offset = scale * offset;
}

static void find_cone(const parting *p, uint32_t triangle, cone_sides *out) {
    const double *guard = p->guards[0];
    const double *c[3] = {parting_vertex(p->r, triangle, 0), parting_vertex(p->r, triangle, 1),
                          parting_vertex(p->r, triangle, 2)};
    for (int k = 0; k < 3; k++)
        set_side(guard, c[k], c[(k + 1) % 3], c[(k + 2) % 3], &out->planes[k]);
    set_side(c[0], c[1], c[2], guard, &out->planes[3]);
}

/* Is everything of the other cone, but for shared vertices, beyond this side of the cone? */
static bool is_beyond(const parting *p, const partition_plane *side, uint32_t own, uint32_t other) {
    const uint32_t *c = p->r->triangles.data[own].corners, *d = p->r->triangles.data[other].corners;
    double limit = side->offset + p->gap;
    for (size_t i = 1; i < p->guard_count; i++)
        if (vec3_dot(side->normal, p->guards[i]) <= limit)
            return false;
    for (int k = 0; k < 3; k++)
        if (d[k] != c[0] && d[k] != c[1] && d[k] != c[2] &&
            vec3_dot(side->normal, parting_vertex(p->r, other, k)) <= limit)
            return false;
    return true;
}

static starg_status cross(parting *p, const cone_sides *cone, uint32_t own, uint32_t other,
                          bool *crossed) {
    const separator_triangles low = {.data = &own, .count = 1}, high = {.data = &other, .count = 1};
    partition_plane plane;
    *crossed = false;
    for (int i = 0; i < 4; i++)
        if (is_beyond(p, &cone->planes[i], own, other))
            return STARG_OK;
    TRY(parting_find(p, &low, &high, &plane, crossed));
    *crossed = !*crossed;
    return STARG_OK;
}

/* Crossings are counted wave by wave: of each, some triangles of A with all of B, side by side. The
 * first wave has one item, each next one twice as many, for often the first crossings decide. */
enum { WAVE_ITEMS = 16, ITEM_PAIRS = 2000 };

typedef struct wave {
    const separator_task *task;
    size_t first, each; /* the first triangle of A, and how many an item looks at */
    size_t most;
    size_t count[WAVE_ITEMS];  /* crossings that an item has found, */
    uint64_t work[WAVE_ITEMS]; /* and its work */
} wave;

static starg_status count_item(starg_context *context, void *shared, void *scratch, size_t item) {
    wave *w = shared;
    const separator_task *task = w->task;
    region_scratch *own = scratch;
    const uint64_t before = own->work;
    SCOPED_BY(parting_free) parting p = make_parting(task, own);
    const size_t first = w->first + item * w->each, end = first + w->each;
    (void)context;
    for (size_t i = first; i < end && i < task->own.count && w->count[item] < w->most; i++) {
        cone_sides cone;
        find_cone(&p, task->own.data[i], &cone);
        own->work += PAIR_WORK * task->others.count;
        for (size_t k = 0; k < task->others.count && w->count[item] < w->most; k++) {
            bool crossed;
            TRY(cross(&p, &cone, task->own.data[i], task->others.data[k], &crossed));
            w->count[item] += crossed;
        }
    }
    w->work[item] = own->work - before;
    return STARG_OK;
}

starg_status crossings_count(const separator_task *task, size_t most, region_scratch *scratch,
                             size_t *count) {
    const size_t each = ITEM_PAIRS / (task->others.count + 1) + 1;
    size_t first = 0;
    *count = 0;
    for (size_t items = 1; first < task->own.count && *count < most;
         items = items < WAVE_ITEMS ? 2 * items : WAVE_ITEMS) {
        wave w = {.task = task, .first = first, .each = each, .most = most - *count};
        const size_t left = (task->own.count - first + each - 1) / each;
        const starg_parallel_loop loop = {.stage = PARTITION_STAGE,
                                          .count = left < items ? left : items,
                                          .shared = &w,
                                          .item = count_item,
                                          .make_scratch = region_make_scratch,
                                          .free_scratch = region_free_scratch,
                                          .silent = true};
        TRY(starg_parallel_for(scratch->context, &loop));
        for (size_t n = 0; n < loop.count && *count < most; n++) {
            *count += w.count[n];
            scratch->work += w.work[n];
        }
        first += loop.count * each;
    }
    *count = *count < most ? *count : most;
    return STARG_OK;
}

/* ---- terms ---- */

enum { MISSES_MOST = 12 };

/* A plane of the term that is being made, and the triangles of B above it. */
typedef struct fence {
    partition_plane plane;
    separator_triangles above;
} fence;

typedef struct ranked {
    double reach;
    uint32_t triangle;
} ranked;

typedef struct maker {
    const separator_task *task;
    parting parting;
    fence fences[CUT_PLANES_MOST];
    int fence_count;
    separator_triangles members; /* of the term                              */
    separator_triangles left;    /* of A, in no term yet                     */
    separator_triangles rest;    /* of B, above no fence of the term yet     */
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

static starg_status rank(maker *m, const separator_triangles *triangles, const fence *above) {
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

static uint32_t take_one(separator_triangles *from, starg_rng *rng) {
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

starg_status separator_find(const separator_task *task, starg_rng *rng, region_scratch *scratch,
                            cut_plan *plan, bool *found) {
    maker m = {.task = task, .parting = make_parting(task, scratch)};
    starg_status status = find(&m, rng, plan, found);
    maker_free(&m);
    return status;
}

bool separator_holds(const region *r, const cut_plan *plan, uint32_t triangle) {
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
