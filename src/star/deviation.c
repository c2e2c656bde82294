/* SPDX-License-Identifier: Apache-2.0 */
/* How far points of one surface are at most from another, rounded up.
 *
 * The distance to a triangle is convex: of a convex part of a face, none is farther from a triangle
 * than one of the part's corners. That is exact where surfaces lie on each other, however finely
 * they are divided. A part is cut along the edges of the triangle that is nearest to its centre, as
 * far as it lies beyond them, and else halved, until the corner farthest from all of the surface is
 * nearly as far as the bound (within its double, or the step), or the part is as small as the step.
 * Where surfaces coincide, smaller parts are cut, too, but along edges only.
 * Feet of perpendiculars are found as points of the triangle, so that rounding where triangles are
 * slivers only raises distances.
 *
 * Invariants: the bound of a part is at most that of the part it was cut from, and which parts
 * there are depends on themselves alone; those whose bound is below the largest found are left out,
 * so that the result depends on no order of threads. Cost: look-ups of O(log n), a few for each
 * face where the surfaces coincide, at most area / step^2. */
#include "star/decomposition.h"

#include "core/parallel.h"
#include "geometry/vec3.h"

static const char STAGE[] = "pieces";

enum { MOST = 10, DEEPEST = 64 }; /* corners, of twice as many as a part that is cut; cuts */

static const double COINCIDENT = 1e-6; /* of the step: that near are surfaces that coincide */
static const double DOUBT =
    0x1p-44; /* of the extent: what distances may be off that are computed */

typedef struct part {
    double corner[MOST][3];
    int count, depth;
    double bound;
} part;

typedef struct survey {
    const starg_mesh *from;
    const bvh *to;
    double step, least;      /* below `least` nothing is worth a cut */
    _Atomic double greatest; /* so far */
} survey;

static void raise(survey *s, double distance) {
    double before = atomic_load(&s->greatest);
    while (distance > before && !atomic_compare_exchange_weak(&s->greatest, &before, distance))
        continue;
}

/* ---- distance to a triangle ---- */

static double distance_to_segment(const double p[3], const double a[3], const double b[3]) {
    double ab[3], ap[3], foot[3];
    vec3_subtract(b, a, ab);
    vec3_subtract(p, a, ap);
    double length = vec3_dot(ab, ab), t = length > 0 ? vec3_dot(ap, ab) / length : 0;
    vec3_along(a, fmin(fmax(t, 0), 1), ab, foot);
    return vec3_distance(p, foot);
}

static double distance_to_triangle(const double p[3], const double *const t[3]) {
    double n[3], weight[3], sum = 0, foot[3] = {0}, least = INFINITY;
    bool inside = true;
    vec3_triangle_normal(t[0], t[1], t[2], n);
    for (int k = 0; k < 3; k++) {
        double edge[3], to_p[3], s[3];
        least = fmin(least, distance_to_segment(p, t[k], t[(k + 1) % 3]));
        vec3_subtract(t[(k + 1) % 3], t[k], edge);
        vec3_subtract(p, t[k], to_p);
        vec3_cross(edge, to_p, s);
        weight[k] = vec3_dot(s, n);
        inside = inside && weight[k] >= 0;
        sum += weight[k];
    }
    if (!inside || !(sum > 0))
        return least;
    for (int i = 0; i < 3; i++)
        vec3_along(foot, weight[i] / sum, t[(i + 2) % 3], foot);
    return fmin(least, vec3_distance(p, foot));
}

/* ---- parts ---- */

static void center_of(const part *own, double center[3]) {
    for (int k = 0; k < 3; k++) {
        center[k] = 0;
        for (int i = 0; i < own->count; i++)
            center[k] += own->corner[i][k] / own->count;
    }
}

/* The parts on either side of where a linear function is 0 that is given at the corners. Rounded,
 * a part need not be convex: each edge may add a corner. */
static void cut(const part *own, const double *value, part halves[2]) {
    for (int side = 0; side < 2; side++)
        halves[side] = (part){.depth = own->depth + 1, .bound = own->bound};
    for (int i = 0; i < own->count; i++) {
        int next = (i + 1) % own->count;
        const double *a = own->corner[i], *b = own->corner[next];
        for (int side = 0; side < 2; side++)
            if (side == 0 ? value[i] >= 0 : value[i] <= 0)
                vec3_copy(a, halves[side].corner[halves[side].count++]);
        if (value[i] * value[next] >= 0)
            continue;
        double between[3], ab[3];
        vec3_subtract(b, a, ab);
        vec3_along(a, value[i] / (value[i] - value[next]), ab, between);
        for (int side = 0; side < 2; side++)
            vec3_copy(between, halves[side].corner[halves[side].count++]);
    }
}

/* How far do corners lie on either side? The smaller of the two. */
static double extent_of(const double *value, int count) {
    double above = 0, below = 0;
    for (int i = 0; i < count; i++) {
        above = fmax(above, value[i]);
        below = fmax(below, -value[i]);
    }
    return fmin(above, below);
}

/* Distances of the corners from the plane through an edge of a triangle, across the triangle;
 * returns the extent. */
static double beyond_edge(const part *own, const double *const t[3], int k, double *value) {
    double n[3], edge[3], across[3], off[3];
    vec3_triangle_normal(t[0], t[1], t[2], n);
    vec3_subtract(t[(k + 1) % 3], t[k], edge);
    vec3_cross(n, edge, across);
    double length = vec3_length(across);
    for (int i = 0; i < own->count; i++) {
        vec3_subtract(own->corner[i], t[k], off);
        value[i] = length > 0 ? vec3_dot(off, across) / length : 0;
    }
    return extent_of(value, own->count);
}

/* Distances from the middle between the two corners that are farthest apart. */
static void halve(const part *own, double *value) {
    double longest = -1, along[3] = {0}, middle[3] = {0}, off[3];
    for (int i = 0; i < own->count; i++)
        for (int j = i + 1; j < own->count; j++)
            if (vec3_distance(own->corner[i], own->corner[j]) > longest) {
                longest = vec3_distance(own->corner[i], own->corner[j]);
                vec3_subtract(own->corner[j], own->corner[i], along);
                vec3_along(own->corner[i], 0.5, along, middle);
            }
    for (int i = 0; i < own->count; i++) {
        vec3_subtract(own->corner[i], middle, off);
        value[i] = vec3_dot(off, along);
    }
}

/* The parts on either side of a diagonal. */
static void cut_at_corners(const part *own, part halves[2]) {
    const int middle = own->count / 2;
    for (int side = 0; side < 2; side++)
        halves[side] = (part){.depth = own->depth + 1, .bound = own->bound};
    for (int i = 0; i <= own->count; i++) {
        const double *a = own->corner[i % own->count];
        if (i <= middle)
            vec3_copy(a, halves[0].corner[halves[0].count++]);
        if (i >= middle)
            vec3_copy(a, halves[1].corner[halves[1].count++]);
    }
}

/* Cuts along the edge that leaves most on either side, if any does; else halves a large part.
 * False: it does neither. */
static bool divide(const survey *s, const part *own, const double *const t[3], bool large,
                   part halves[2]) {
    double value[MOST], best[MOST], most = s->least;
    bool found = false;
    if (own->count > MOST / 2) {
        cut_at_corners(own, halves);
        return true;
    }
    for (int k = 0; k < 3; k++) {
        double extent = beyond_edge(own, t, k, value);
        if (extent <= most)
            continue;
        most = extent;
        found = true;
        for (int i = 0; i < own->count; i++)
            best[i] = value[i];
    }
    if (!found && !large)
        return false;
    if (!found)
        halve(own, best);
    cut(own, best, halves);
    return true;
}

static void look_at(survey *s, part *own) {
    double center[3], radius = 0, nearest = 0, there = 0;
    const double *t[3];
    if (own->count < 3)
        return;
    center_of(own, center);
    uint32_t face = bvh_nearest_triangle(s->to, center);
    for (size_t k = 0; k < 3; k++)
        t[k] = s->to->vertices + 3 * (size_t)s->to->faces[3 * (size_t)face + k];
    for (int i = 0; i < own->count; i++) {
        radius = fmax(radius, vec3_distance(center, own->corner[i]));
        there = fmax(there, distance_to_triangle(own->corner[i], t));
    }
    own->bound = fmin(own->bound, fmin(there, distance_to_triangle(center, t) + radius));
    if (own->bound <= atomic_load(&s->greatest))
        return;
    for (int i = 0; i < own->count; i++)
        nearest = fmax(nearest, bvh_distance(s->to, own->corner[i]));
    part halves[2];
    const bool large = radius > s->step / 2, coincides = nearest <= COINCIDENT * s->step;
    if (own->bound - nearest <= fmax(s->least, fmin(nearest, s->step)) || own->depth == DEEPEST ||
        !(large || coincides) || !divide(s, own, t, large, halves)) {
        raise(s, own->bound);
        return;
    }
    look_at(s, &halves[0]);
    look_at(s, &halves[1]);
}

static starg_status survey_face(starg_context *context, void *shared, void *scratch, size_t face) {
    survey *s = shared;
    part whole = {.count = 3, .bound = INFINITY};
    (void)context;
    (void)scratch;
    for (size_t k = 0; k < 3; k++)
        vec3_copy(s->from->vertices + 3 * (size_t)s->from->faces[3 * face + k], whole.corner[k]);
    look_at(s, &whole);
    return STARG_OK;
}

starg_status deviation_bound(starg_context *context, const starg_mesh *from, const bvh *to,
                             double extent, double step, double *out) {
    survey s = {.from = from, .to = to, .step = step, .least = DOUBT * extent};
    starg_parallel_loop loop = {
        .stage = STAGE, .count = from->face_count, .shared = &s, .item = survey_face};
    starg_status status = starg_parallel_for(context, &loop);
    *out = atomic_load(&s.greatest) + DOUBT * extent;
    return status;
}
