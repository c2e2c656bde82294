/* SPDX-License-Identifier: Apache-2.0 */
/* Walls between two loops, one star-shaped in a plane, the other any loop on a sphere.
 *
 * Problem: triangles with few vertices inside that span both, positive in either. A fan about one
 * point does where both loops go round a point; here the second need not.
 *
 * Method: there is a ring inside the loop, a vertex for each of its nodes. In the plane it is a
 * circle about a point that sees the loop, and each of its vertices stands before its node: what
 * is between is positive, and the polygon within is convex, so that all triangulations of it are
 * valid. On the sphere the ring is the loop, moved to the left by so little that what is between is
 * positive, and what is within is triangulated by cutting off ears.
 *
 * Invariant: all triangles on the sphere are positive as seen from its middle. Cost: O(n^2) for
 * most loops of n nodes, 3 n triangles. */
#include "star/compatible/cone_builder.h"

#include "geometry/vec3.h"

static const char STAGE[] = "cones";
enum { HALVINGS = 10 };
static const double WIDTH = 0.5; /* of the ring, over the shorter edge at a node */

void cones_free_web(cone_web *web) {
    RELEASE(web->ring.data, web->triangles.data);
}

/* A loop on its sphere, and the ring that is looked for. */
typedef struct weaving {
    starg_context *context;
    const double *directions;
    size_t count;
    cone_web *web;
} weaving;

static const double *at(const weaving *w, uint32_t corner) {
    return corner < w->count ? w->directions + 3 * (size_t)corner
                             : w->web->ring.data + 3 * ((size_t)corner - w->count);
}

static bool is_positive(const weaving *w, uint32_t a, uint32_t b, uint32_t c) {
    return vec3_triple(at(w, a), at(w, b), at(w, c)) > 0;
}

static starg_status add(const weaving *w, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corners[3] = {a, b, c};
    for (int k = 0; k < 3; k++)
        PUSH(w->context, STAGE, &w->web->triangles, corners[k]);
    return STARG_OK;
}

/* The unit vector across an arc, to its left. */
static void left_of(const weaving *w, size_t node, double out[3]) {
    vec3_cross(at(w, (uint32_t)node), at(w, (uint32_t)((node + 1) % w->count)), out);
    double size = vec3_length(out);
    for (int k = 0; k < 3; k++)
        out[k] /= size > 0 ? size : 1;
}

/* The ring, and what is between it and the loop. */
static starg_status place_ring(const weaving *w, double width, bool *good) {
    uint32_t count = (uint32_t)w->count;
    w->web->ring.count = w->web->triangles.count = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t former = (i + count - 1) % count, next = (i + 1) % count;
        double left[2][3], way[3], point[3];
        double room =
            fmin(vec3_distance(at(w, former), at(w, i)), vec3_distance(at(w, i), at(w, next)));
        left_of(w, former, left[0]);
        left_of(w, i, left[1]);
        for (int k = 0; k < 3; k++)
            way[k] = left[0][k] + left[1][k];
        double size = vec3_length(way);
        vec3_along(at(w, i), size > 0 ? width * room / size : 0, way, point);
        size = vec3_length(point);
        for (int k = 0; k < 3; k++)
            PUSH(w->context, STAGE, &w->web->ring, point[k] / size);
    }
    *good = true;
    for (uint32_t i = 0; i < count && *good; i++) {
        uint32_t next = (i + 1) % count;
        *good = is_positive(w, i, next, count + i) && is_positive(w, count + i, next, count + next);
        TRY(add(w, i, next, count + i));
        TRY(add(w, count + i, next, count + next));
    }
    return STARG_OK;
}

/* May the corner after one of the polygon be cut off? */
static bool is_ear(const weaving *w, const uint32_t *polygon, size_t count, size_t first) {
    uint32_t a = polygon[first], b = polygon[(first + 1) % count], c = polygon[(first + 2) % count];
    if (!is_positive(w, a, b, c))
        return false;
    for (size_t i = 0; i < count; i++) {
        uint32_t v = polygon[i];
        if (v != a && v != b && v != c && !is_positive(w, b, a, v) && !is_positive(w, c, b, v) &&
            !is_positive(w, a, c, v))
            return false;
    }
    return true;
}

static starg_status cut_ears(const weaving *w, bool *good) {
    SCOPED uint32_t *polygon = NULL;
    size_t count = w->count, at_corner = 0, refused = 0;
    NEW(w->context, STAGE, polygon, count);
    for (uint32_t i = 0; i < count; i++)
        polygon[i] = (uint32_t)w->count + i;
    while (count > 3 && refused < count) {
        at_corner %= count;
        refused++;
        if (is_ear(w, polygon, count, at_corner)) {
            size_t cut = (at_corner + 1) % count;
            TRY(add(w, polygon[at_corner], polygon[cut], polygon[(cut + 1) % count]));
            memmove(polygon + cut, polygon + cut + 1, (count - cut - 1) * sizeof *polygon);
            count--;
            refused = 0;
        }
        at_corner++;
    }
    *good = count == 3 && is_positive(w, polygon[0], polygon[1], polygon[2]);
    return *good ? add(w, polygon[0], polygon[1], polygon[2]) : STARG_OK;
}

starg_status cones_find_web(starg_context *context, const double *directions, size_t count,
                            cone_web *out, bool *found) {
    const weaving w = {context, directions, count, out};
    double width = WIDTH;
    out->count = count;
    *found = false;
    for (int i = 0; i < HALVINGS && !*found; i++, width /= 2) {
        TRY(place_ring(&w, width, found));
        if (*found)
            TRY(cut_ears(&w, found));
    }
    return STARG_OK;
}
