/* SPDX-License-Identifier: Apache-2.0 */
/* A plane between two sets of triangles and their guards.
 *
 * Problem: a plane with one guard and some triangles strictly below it, the other guards and other
 * triangles strictly above it. Vertices that both sets of triangles have must be in the plane, at
 * most three of them.
 *
 * Method: between two sets of points it is perpendicular to the shortest segment between their
 * hulls (Kozinec's algorithm [Schlesinger and Hlavac 2002, 5.2.4]). Vertices of both sets are
 * projected away first.
 *
 * Invariants: all that it was decided on is at least `gap` away from the plane, but for shared
 * vertices, which it passes through. Cost: linear in the vertices, ten to a hundred times. */
#include "star/strict/search/search.h"

#include "geometry/vec3.h"

enum {
    STEPS_MOST = 150,
    STEPS_FINE = 20 /* through what is touched, where any plane will do then */
};

/* A plane is good enough if its distance to both sides is this share of what can be hoped for. */
static const double GOOD = 0.6;

void parting_free(parting *p) {
    RELEASE(p->low.data, p->high.data, p->marks.data);
}

/* ---- what is below and above ---- */

enum { IN_LOW = 1, IN_HIGH = 2, LISTED = 4 };

static starg_status add_point(const parting *p, parting_points *to, const double at[3]) {
    for (int k = 0; k < 3; k++)
        PUSH(p->scratch->context, PARTITION_STAGE, to, at[k]);
    return STARG_OK;
}

static void mark(const parting *p, const parting_triangles *triangles, uint32_t bit) {
    for (size_t i = 0; i < triangles->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t *at = &p->marks.data[p->r->triangles.data[triangles->data[i]].corners[k]];
            *at = bit == 0 ? 0 : *at | bit;
        }
}

/* Vertices of one side alone; those of both are touched. */
static starg_status list_vertices(parting *p, const parting_triangles *triangles, uint32_t bit,
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

static starg_status set_sides(parting *p, const parting_triangles *low,
                              const parting_triangles *high) {
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

/* ---- a plane between two sets ---- */

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
        double length = vec3_length(axes[count]);
        if (length < p->gap)
            return false;
        for (int k = 0; k < 3; k++)
            axes[count][k] /= length;
    }
    return find_plane_through(p, origin, axes, count, out);
}

starg_status parting_find(parting *p, const parting_triangles *low, const parting_triangles *high,
                          partition_plane *out, bool *found) {
    *found = false;
    TRY(set_sides(p, low, high));
    if (p->touched_count == 0)
        *found = find_free_plane(p, out);
    else if (p->touched_count <= PARTING_TOUCHED_MOST)
        *found = find_plane_touching(p, out);
    return STARG_OK;
}
