/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles that fill plane loops.
 *
 * Problem: the loops in which a plane meets the surface of a piece bound plane regions, perhaps
 * several and with holes; fill them with triangles on the loops' vertices.
 *
 * Stages: all is seen along the axis that the normal is nearest to, where signs are exact; loops by
 * the sign of their area; every hole goes to the smallest outline about it; a bridge, the shortest
 * segment from the hole to the rest that crosses nothing, makes one polygon of both; ears are cut
 * (mesh/formats/polygon.c); edges are flipped until all are locally Delaunay [Lawson 1977].
 *
 * Invariants: the triangles' boundary is the loops, whatever happens; rounding of the vertices off
 * their plane may at worst leave a triangle that turns the wrong way, which the certificate of the
 * pieces rejects. Cost: quadratic in the vertices of a region, cubic where it has
 * holes. */
#include "star/strict/partition/cap.h"

#include <math.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/formats/io.h"

typedef struct loop {
    uint32_t first, count;
    double area;   /* twice, signed */
    int32_t owner; /* of a hole: its outline, until a bridge leads to it */
} loop;

typedef struct filler {
    starg_context *context;
    const double *points;
    const uint32_t *corners;
    int u, v;
    STARG_ARRAY(loop) loops;
    cap_indices polygon; /* an outline with bridges to its holes so far */
    cap_indices *triangles;
} filler;

static const double *at(const filler *f, uint32_t vertex) {
    return f->points + 3 * (size_t)vertex;
}

static int turn(const filler *f, uint32_t a, uint32_t b, uint32_t c) {
    return orient2d(at(f, a), at(f, b), at(f, c), f->u, f->v);
}

static void choose_view(filler *f, const double normal[3]) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    f->u = (axis + (normal[axis] < 0 ? 2 : 1)) % 3;
    f->v = (axis + (normal[axis] < 0 ? 1 : 2)) % 3;
}

static double signed_area(const filler *f, uint32_t first, uint32_t count) {
    const double *o = at(f, f->corners[first]);
    double sum = 0;
    for (uint32_t i = 1; i + 1 < count; i++) {
        const double *a = at(f, f->corners[first + i]), *b = at(f, f->corners[first + i + 1]);
        sum +=
            (a[f->u] - o[f->u]) * (b[f->v] - o[f->v]) - (a[f->v] - o[f->v]) * (b[f->u] - o[f->u]);
    }
    return sum;
}

/* ---- nesting ---- */

/* Is a vertex inside a loop? By the edges that a ray along u meets. */
static bool is_inside(const filler *f, const loop *l, uint32_t vertex) {
    const double *q = at(f, vertex);
    bool inside = false;
    for (uint32_t i = 0; i < l->count; i++) {
        uint32_t a = f->corners[l->first + i];
        uint32_t b = f->corners[l->first + (i + 1 == l->count ? 0 : i + 1)];
        bool a_above = at(f, a)[f->v] > q[f->v], b_above = at(f, b)[f->v] > q[f->v];
        if (a_above != b_above && (turn(f, a, b, vertex) > 0) == b_above)
            inside = !inside;
    }
    return inside;
}

static bool find_owner(filler *f, loop *hole) {
    hole->owner = -1;
    for (size_t i = 0; i < f->loops.count; i++) {
        const loop *l = &f->loops.data[i];
        if (l->area <= 0 || !is_inside(f, l, f->corners[hole->first]))
            continue;
        if (hole->owner < 0 || l->area < f->loops.data[hole->owner].area)
            hole->owner = (int32_t)i;
    }
    return hole->owner >= 0;
}

/* ---- bridges ---- */

/* Does segment ab cross segment pq, or touch it otherwise than in a common end? */
static bool crosses(const filler *f, uint32_t a, uint32_t b, uint32_t p, uint32_t q) {
    if (a == p || a == q || b == p || b == q) {
        uint32_t far = a == p || b == p ? q : p;
        uint32_t shared = a == p || a == q ? a : b, other = shared == a ? b : a;
        if (turn(f, a, b, far) != 0)
            return false;
        double x[3], y[3];
        vec3_subtract(at(f, other), at(f, shared), x);
        vec3_subtract(at(f, far), at(f, shared), y);
        return x[f->u] * y[f->u] + x[f->v] * y[f->v] > 0;
    }
    return turn(f, a, b, p) * turn(f, a, b, q) <= 0 && turn(f, p, q, a) * turn(f, p, q, b) <= 0;
}

static bool crosses_ring(const filler *f, uint32_t a, uint32_t b, const uint32_t *ring,
                         size_t count) {
    for (size_t i = 0; i < count; i++)
        if (crosses(f, a, b, ring[i], ring[i + 1 == count ? 0 : i + 1]))
            return true;
    return false;
}

static bool crosses_holes(const filler *f, uint32_t a, uint32_t b, int32_t owner) {
    for (size_t i = 0; i < f->loops.count; i++) {
        const loop *l = &f->loops.data[i];
        if (l->area < 0 && l->owner == owner &&
            crosses_ring(f, a, b, f->corners + l->first, l->count))
            return true;
    }
    return false;
}

/* Is the bridge from corner i of the polygon to `to` inside the polygon at that corner? A vertex
 * with several corners has several wedges; only that wedge will do that the bridge leaves by. */
static bool leaves_inside(const filler *f, size_t i, uint32_t to) {
    const uint32_t *ring = f->polygon.data;
    size_t n = f->polygon.count;
    uint32_t before = ring[i == 0 ? n - 1 : i - 1], here = ring[i],
             after = ring[i + 1 == n ? 0 : i + 1];
    bool left_in = turn(f, before, here, to) > 0, left_out = turn(f, here, after, to) > 0;
    return turn(f, before, here, after) > 0 ? left_in && left_out : left_in || left_out;
}

static double flat_distance(const filler *f, uint32_t a, uint32_t b) {
    double u = at(f, a)[f->u] - at(f, b)[f->u], v = at(f, a)[f->v] - at(f, b)[f->v];
    return u * u + v * v;
}

/* The shortest bridge from the polygon to a hole: corner i of the polygon, corner j of the hole. */
static bool find_bridge(const filler *f, const loop *hole, size_t *i, size_t *j) {
    double shortest = INFINITY;
    for (size_t a = 0; a < f->polygon.count; a++)
        for (size_t b = 0; b < hole->count; b++) {
            uint32_t p = f->polygon.data[a], q = f->corners[hole->first + b];
            double length = flat_distance(f, p, q);
            if (length >= shortest || !leaves_inside(f, a, q) ||
                crosses_ring(f, p, q, f->polygon.data, f->polygon.count) ||
                crosses_holes(f, p, q, hole->owner))
                continue;
            shortest = length;
            *i = a;
            *j = b;
        }
    return shortest < INFINITY;
}

/* The polygon with the hole put in after corner i: there over the bridge, around, and back. */
static starg_status cross_bridge(filler *f, const loop *hole, size_t i, size_t j) {
    starg_status status = STARG_OK;
    cap_indices longer = {0};
    for (size_t k = 0; k < f->polygon.count; k++) {
        STARG_PUSH(f->context, "decompose", &longer, f->polygon.data[k]);
        if (k != i)
            continue;
        for (size_t m = 0; m <= hole->count; m++)
            STARG_PUSH(f->context, "decompose", &longer,
                       f->corners[hole->first + (j + m) % hole->count]);
        STARG_PUSH(f->context, "decompose", &longer, f->polygon.data[i]);
    }
    cap_indices old = f->polygon;
    f->polygon = longer;
    longer = old;
done:
    STARG_ARRAY_FREE(f->context, &longer);
    return status;
}

/* ---- triangles ---- */

/* The corner of a triangle opposite the edge from a to b, 3 when it has no such edge. */
static int opposite(const uint32_t *triangle, uint32_t a, uint32_t b) {
    for (int k = 0; k < 3; k++)
        if (triangle[k] == a && triangle[(k + 1) % 3] == b)
            return (k + 2) % 3;
    return 3;
}

/* Sum of the angles at c and d is above pi: the edge ab between them is not Delaunay. */
static bool is_obtuse(const filler *f, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    double ca[3], cb[3], da[3], db[3], n[3];
    vec3_subtract(at(f, a), at(f, c), ca);
    vec3_subtract(at(f, b), at(f, c), cb);
    vec3_subtract(at(f, a), at(f, d), da);
    vec3_subtract(at(f, b), at(f, d), db);
    vec3_cross(ca, cb, n);
    double sine_c = vec3_length(n), cosine_c = vec3_dot(ca, cb);
    vec3_cross(da, db, n);
    double sine_d = vec3_length(n), cosine_d = vec3_dot(da, db);
    double size = vec3_length(ca) * vec3_length(cb) * vec3_length(da) * vec3_length(db);
    return sine_c * cosine_d + cosine_c * sine_d < -1e-12 * size;
}

/* Flips the edge that triangles s and t share, if it is not Delaunay and the flip turns none. */
static bool try_flip(const filler *f, uint32_t *s, uint32_t *t) {
    for (int k = 0; k < 3; k++) {
        uint32_t a = s[k], b = s[(k + 1) % 3], c = s[(k + 2) % 3];
        int o = opposite(t, b, a);
        if (o == 3)
            continue;
        uint32_t d = t[o];
        if (!is_obtuse(f, a, b, c, d) || turn(f, a, d, c) <= 0 || turn(f, d, b, c) <= 0)
            return false;
        s[0] = a, s[1] = d, s[2] = c;
        t[0] = d, t[1] = b, t[2] = c;
        return true;
    }
    return false;
}

/* Quadratic a sweep, but only neighbours in the list of a vertex would be faster, and caps are
 * small beside everything else. */
static void make_delaunay(const filler *f, size_t first) {
    uint32_t *triangles = f->triangles->data;
    size_t count = f->triangles->count / 3;
    bool again = true;
    for (int sweep = 0; again && sweep < 8; sweep++) {
        again = false;
        for (size_t i = first; i < count; i++)
            for (size_t j = i + 1; j < count; j++)
                if (try_flip(f, triangles + 3 * i, triangles + 3 * j))
                    again = true;
    }
}

static starg_status fill_polygon(filler *f) {
    starg_status status = STARG_OK;
    size_t first = f->triangles->count / 3, count = 3 * (f->polygon.count - 2);
    for (size_t i = 0; i < count; i++)
        STARG_PUSH(f->context, "decompose", f->triangles, 0);
    STARG_TRY(starg_polygon_clip(f->context, f->points, f->polygon.data, f->polygon.count,
                                 f->triangles->data + 3 * first));
    make_delaunay(f, first);
done:
    return status;
}

/* Bridges from the polygon to the holes of outline i. A hole that sees nothing but other holes
 * waits for one of them. */
static starg_status bridge_holes(filler *f, size_t i, bool *done) {
    starg_status status = STARG_OK;
    bool any = true;
    for (*done = false; any && !*done;) {
        any = false;
        *done = true;
        for (size_t h = 0; h < f->loops.count; h++) {
            loop *hole = &f->loops.data[h];
            size_t a = 0, b = 0;
            if (hole->area >= 0 || hole->owner != (int32_t)i)
                continue;
            if (!find_bridge(f, hole, &a, &b)) {
                *done = false;
                continue;
            }
            STARG_TRY(cross_bridge(f, hole, a, b));
            hole->owner = -1; /* part of the polygon */
            any = true;
        }
    }
done:
    return status;
}

/* Fills outline i with its holes. */
static starg_status fill_outline(filler *f, size_t i, bool *done) {
    starg_status status = STARG_OK;
    f->polygon.count = 0;
    for (uint32_t k = 0; k < f->loops.data[i].count; k++)
        STARG_PUSH(f->context, "decompose", &f->polygon, f->corners[f->loops.data[i].first + k]);
    STARG_TRY(bridge_holes(f, i, done));
    if (*done)
        STARG_TRY(fill_polygon(f));
done:
    return status;
}

starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const uint32_t *corners, const uint32_t *starts, size_t loop_count,
                      cap_indices *triangles, bool *done) {
    starg_status status = STARG_OK;
    filler f = {.context = context, .points = points, .corners = corners, .triangles = triangles};
    choose_view(&f, normal);
    *done = true;
    for (size_t i = 0; i < loop_count; i++) {
        loop l = {.first = starts[i], .count = starts[i + 1] - starts[i]};
        l.area = signed_area(&f, l.first, l.count);
        *done = *done && l.count >= 3 && l.area != 0;
        STARG_PUSH(context, "decompose", &f.loops, l);
    }
    for (size_t i = 0; i < loop_count && *done; i++)
        if (f.loops.data[i].area < 0)
            *done = find_owner(&f, &f.loops.data[i]);
    for (size_t i = 0; i < loop_count && *done; i++)
        if (f.loops.data[i].area > 0)
            STARG_TRY(fill_outline(&f, i, done));
done:
    STARG_ARRAY_FREE(context, &f.loops);
    STARG_ARRAY_FREE(context, &f.polygon);
    return status;
}
