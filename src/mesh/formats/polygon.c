/* SPDX-License-Identifier: Apache-2.0 */
/* Problem: triangulate a polygon of a mesh file. It is nearly planar as a rule and may be concave.
 *
 * Method: project the polygon along the dominant axis of its Newell normal. Use the fan about the
 * first corner if all its triangles are oriented like the polygon. Otherwise clip ears (Meisters,
 * Polygons have ears, 1975): a convex corner whose triangle contains no reflex or straight corner.
 *
 * Invariants: count - 2 triangles, oriented like the polygon, so that their union has the same
 * boundary edges whatever its shape. If the projection is simple, no triangles overlap. A
 * self-intersecting or zero-area polygon runs out of ears; the rest is then cut corner by corner,
 * and `check` reports the result. Signs are exact. Cost: linear for the fan, quadratic for ear
 * clipping. */
#include <math.h>

#include "geometry/predicates.h"
#include "mesh/formats/io.h"

/* The two coordinates in which the polygon is counter-clockwise. */
typedef struct plane_view {
    const double *vertices;
    const uint32_t *corners;
    int u, v;
} plane_view;

static const double *corner_at(const plane_view *view, size_t i) {
    return view->vertices + 3 * (size_t)view->corners[i];
}

static int turn(const plane_view *view, size_t a, size_t b, size_t c) {
    return orient2d(corner_at(view, a), corner_at(view, b), corner_at(view, c), view->u, view->v);
}

/* Largest distance of a corner from the first one along any axis. */
static double extent(const plane_view *view, size_t count) {
    const double *origin = corner_at(view, 0);
    double largest = 0;
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(corner_at(view, i)[k] - origin[k]));
    return largest;
}

/* Newell's normal of the polygon scaled to unit size, to avoid overflow and underflow. */
static void newell_normal(const plane_view *view, size_t count, double normal[3]) {
    const double *origin = corner_at(view, 0);
    double size = extent(view, count);
    normal[0] = normal[1] = normal[2] = 0;
    if (size == 0)
        return;
    for (size_t i = 1; i + 1 < count; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = (corner_at(view, i)[k] - origin[k]) / size;
            b[k] = (corner_at(view, i + 1)[k] - origin[k]) / size;
        }
        for (int k = 0; k < 3; k++)
            normal[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

static plane_view look_at(const double *vertices, const uint32_t *corners, size_t count) {
    plane_view view = {.vertices = vertices, .corners = corners};
    double normal[3];
    newell_normal(&view, count, normal);
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    view.u = (axis + (normal[axis] < 0 ? 2 : 1)) % 3;
    view.v = (axis + (normal[axis] < 0 ? 1 : 2)) % 3;
    return view;
}

static void put(uint32_t *triangle, uint32_t a, uint32_t b, uint32_t c) {
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

bool starg_polygon_fan(const double *vertices, const uint32_t *corners, size_t count,
                       uint32_t *triangles) {
    put(triangles, corners[0], corners[1], corners[2]);
    if (count == 3)
        return true;
    plane_view view = look_at(vertices, corners, count);
    for (size_t i = 1; i + 1 < count; i++) {
        if (turn(&view, 0, i, i + 1) <= 0)
            return false;
        put(triangles + 3 * (i - 1), corners[0], corners[i], corners[i + 1]);
    }
    return true;
}

/* The remaining corners, in a ring. */
typedef struct corner_ring {
    plane_view view;
    size_t left;
    uint32_t *before, *after;
    bool *outward; /* convex; only the others can block an ear */
    bool *ear;
} corner_ring;

static bool same_place(const plane_view *view, size_t a, size_t b) {
    const double *p = corner_at(view, a), *q = corner_at(view, b);
    return p[view->u] == q[view->u] && p[view->v] == q[view->v];
}

/* True if corner j lies in the closed triangle of corner i and its neighbours. Corners that
 * coincide with one of those three do not count: bridges to holes have them. */
static bool in_the_way(const corner_ring *ring, size_t i, size_t j) {
    const plane_view *view = &ring->view;
    size_t a = ring->before[i], b = ring->after[i];
    return turn(view, a, i, j) >= 0 && turn(view, i, b, j) >= 0 && turn(view, b, a, j) >= 0 &&
           !same_place(view, j, a) && !same_place(view, j, i) && !same_place(view, j, b);
}

static void look_again(corner_ring *ring, size_t i) {
    size_t before = ring->before[i], after = ring->after[i];
    ring->outward[i] = turn(&ring->view, before, i, after) > 0;
    ring->ear[i] = ring->outward[i];
    for (size_t j = ring->after[after]; j != before && ring->ear[i]; j = ring->after[j])
        if (!ring->outward[j] && in_the_way(ring, i, j))
            ring->ear[i] = false;
}

static void fill(corner_ring *ring, size_t count) {
    ring->left = count;
    for (size_t i = 0; i < count; i++) {
        ring->before[i] = (uint32_t)(i == 0 ? count - 1 : i - 1);
        ring->after[i] = (uint32_t)(i + 1 == count ? 0 : i + 1);
        ring->outward[i] = turn(&ring->view, ring->before[i], i, ring->after[i]) > 0;
    }
    for (size_t i = 0; i < count; i++)
        look_again(ring, i);
}

/* The next ear from corner i on, or i if there is none. */
static size_t next_ear(const corner_ring *ring, size_t i) {
    for (size_t step = 0; step < ring->left && !ring->ear[i]; step++)
        i = ring->after[i];
    return i;
}

/* Clips corner i. This affects only whether its neighbours are ears. */
static void cut(corner_ring *ring, size_t i, uint32_t *triangle) {
    size_t before = ring->before[i], after = ring->after[i];
    const uint32_t *corners = ring->view.corners;
    put(triangle, corners[before], corners[i], corners[after]);
    ring->after[before] = (uint32_t)after;
    ring->before[after] = (uint32_t)before;
    ring->left--;
    look_again(ring, before);
    look_again(ring, after);
}

starg_status starg_polygon_clip(starg_context *context, const double *vertices,
                                const uint32_t *corners, size_t count, uint32_t *triangles) {
    starg_status status = STARG_OK;
    corner_ring ring = {.view = look_at(vertices, corners, count)};
    STARG_NEW(context, STARG_MESH_FILE, ring.before, count);
    STARG_NEW(context, STARG_MESH_FILE, ring.after, count);
    STARG_NEW(context, STARG_MESH_FILE, ring.outward, count);
    STARG_NEW(context, STARG_MESH_FILE, ring.ear, count);
    fill(&ring, count);
    for (size_t i = 0; ring.left > 2; triangles += 3) {
        i = next_ear(&ring, i);
        size_t next = ring.after[i];
        cut(&ring, i, triangles);
        i = next;
    }
done:
    RELEASE(ring.before, ring.after, ring.outward, ring.ear);
    return status;
}
