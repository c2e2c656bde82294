/* SPDX-License-Identifier: Apache-2.0 */
/* Fans about vertices of many faces: caps of cylinders, cones, poles of spheres. The boxes of all
 * their faces meet at the hub, so that pairs of them would be quadratic in number; but they have no
 * area in common, and their edges do not cross.
 *
 * A fan is all faces at a vertex, if these hang together across the edges there, in one chain or
 * ring, and the sum of their normals sees each of them from the front, and each after the other in
 * less than one turn, or in one if they are a ring: seen along the sum, they lie side by side. Each
 * face belongs to one fan at most. Cost: n log n. */
#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "mesh/union/union.h"

enum { LEAST_FACES = 32 };

/* A corner at a hub: its face, and the next and the last corner of that. */
typedef struct spoke {
    uint32_t hub, from, to, face;
} spoke;

static int compare_spokes(const void *left, const void *right) {
    const spoke *a = left, *b = right;
    if (a->hub != b->hub)
        return a->hub < b->hub ? -1 : 1;
    if (a->from != b->from)
        return a->from < b->from ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

typedef struct fan_finder {
    const double *place;
    near_fans *out;
} fan_finder;

/* The position of the spoke that begins where `to` is, or `count`. */
static size_t find_next(const spoke *list, size_t count, uint32_t to) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (list[middle].from < to)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && list[low].from == to ? low : count;
}

/* Where the chain begins: at the only spoke that follows none; 0 for a ring; `count` where there
 * are several chains, or faces that share a spoke. */
static size_t find_start(const spoke *list, size_t count) {
    size_t followed = 0, sum = 0;
    for (size_t i = 0; i < count; i++) {
        size_t next = find_next(list, count, list[i].to);
        if (i > 0 && list[i].from == list[i - 1].from)
            return count;
        followed += next < count;
        sum += next < count ? next : 0;
    }
    if (followed == count)
        return 0;
    /* of the numbers 0 to count - 1 one is missing, if none stands twice; the walk tells */
    size_t all = count * (count - 1) / 2;
    return followed + 1 == count && sum <= all && all - sum < count ? all - sum : count;
}

static void normal_of(const fan_finder *f, const spoke *s, double normal[3]) {
    vec3_triangle_normal(f->place + 3 * (size_t)s->hub, f->place + 3 * (size_t)s->from,
                         f->place + 3 * (size_t)s->to, normal);
}

/* The angle of a face at the hub, seen along the axis; 0 or less: it is not seen from the front. */
static double angle_of(const fan_finder *f, const spoke *s, const double axis[3]) {
    double u[3], v[3], n[3], along = vec3_dot(axis, axis);
    vec3_subtract(f->place + 3 * (size_t)s->from, f->place + 3 * (size_t)s->hub, u);
    vec3_subtract(f->place + 3 * (size_t)s->to, f->place + 3 * (size_t)s->hub, v);
    vec3_along(u, -vec3_dot(u, axis) / along, axis, u);
    vec3_along(v, -vec3_dot(v, axis) / along, axis, v);
    vec3_cross(u, v, n);
    return atan2(vec3_dot(n, axis) / sqrt(along), vec3_dot(u, v));
}

static bool is_fan(const fan_finder *f, const spoke *list, size_t count) {
    static const double TURN = 6.283185307179586, ROUNDING = 1e-9;
    double axis[3] = {0, 0, 0}, sum = 0;
    size_t at = find_start(list, count), seen = 0;
    const size_t start = at;
    for (size_t i = 0; i < count; i++) {
        double normal[3];
        normal_of(f, &list[i], normal);
        vec3_along(axis, 1, normal, axis);
    }
    if (start == count || !(vec3_dot(axis, axis) > 0))
        return false;
    do {
        double angle = angle_of(f, &list[at], axis);
        if (!(angle > 0) || ++seen > count)
            return false;
        sum += angle;
        at = find_next(list, count, list[at].to);
    } while (at < count && at != start);
    return seen == count && sum < TURN + (at == start ? ROUNDING : -ROUNDING);
}

static void take_fan(fan_finder *f, const spoke *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (f->out->of[list[i].face] != 0)
            return;
    if (!is_fan(f, list, count))
        return;
    f->out->count++;
    for (size_t i = 0; i < count; i++)
        f->out->of[list[i].face] = (uint32_t)f->out->count;
}

/* The faces by fan. */
static starg_status sort_faces(starg_context *context, size_t face_count, near_fans *out) {
    NEW_ZERO(context, UNION_STAGE, out->start, out->count + 3);
    NEW(context, UNION_STAGE, out->faces, face_count);
    size_t *next = out->start + 1;
    for (size_t f = 0; f < face_count; f++)
        next[out->of[f] + 1]++;
    for (size_t k = 0; k <= out->count; k++)
        next[k + 1] += next[k];
    for (size_t f = 0; f < face_count; f++)
        out->faces[next[out->of[f]]++] = (uint32_t)f;
    return STARG_OK;
}

starg_status near_fans_find(starg_context *context, const double *place, const uint32_t *faces,
                            size_t face_count, near_fans *out) {
    SCOPED spoke *list = NULL;
    fan_finder f = {.place = place, .out = out};
    *out = (near_fans){0};
    NEW_ZERO(context, UNION_STAGE, out->of, face_count);
    NEW(context, UNION_STAGE, list, 3 * face_count);
    for (uint32_t h = 0; h < 3 * face_count; h++)
        list[h] =
            (spoke){faces[h], faces[corner_next(h)], faces[corner_next(corner_next(h))], h / 3};
    if (face_count > 0)
        qsort(list, 3 * face_count, sizeof *list, compare_spokes);
    for (size_t i = 0, end; i < 3 * face_count; i = end) {
        for (end = i + 1; end < 3 * face_count && list[end].hub == list[i].hub;)
            end++;
        if (end - i >= LEAST_FACES)
            take_fan(&f, list + i, end - i);
    }
    return sort_faces(context, face_count, out);
}

void near_fans_free(near_fans *fans) {
    RELEASE(fans->of, fans->start, fans->faces);
}
