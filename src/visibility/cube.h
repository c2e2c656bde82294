/* SPDX-License-Identifier: Apache-2.0 */
/* Directions from a point, projected to the six faces of a cube around it. Included by the stages
 * that are compiled per instruction set. */
#ifndef STARG_VISIBILITY_CUBE_H
#define STARG_VISIBILITY_CUBE_H

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

enum { CUBE_FACES = 6, BINS = 1024, RIM = 8 };

/* Slots that are skipped together if none of them is in use. */
enum { SLOT_BLOCK = 64 };

/* Far above the rounding of a projected coordinate in single precision (2^-23). */
static const float CELL_MARGIN = 0x1p-20f;

/* The sides of a widened frustum, as planes through p: axis x SLACK - sign x coordinate k. */
static const double SLACK = 1 + 0x1p-18;

/* Intersections of directions with the cube, where slots are in use: face 2 k or 2 k + 1 for the
 * largest coordinate k, positive or negative; u and v in [-1, 1] are the next two coordinates
 * divided by it. All by slot. */
typedef struct cube_directions {
    double *x, *y, *z; /* relative to p */
    float *u, *v;
    float *nearness; /* the largest coordinate of all vertices over its own: 1 or more */
    uint32_t *face;  /* plus RIM if rounding could put it on another face */
    double extent;   /* the largest coordinate of these vertices */
    double bound;    /* error bound of determinants; infinite: always exact */
} cube_directions;

static inline void cube_free(cube_directions *d) {
    RELEASE(d->x, d->y, d->z, d->u, d->v, d->nearness, d->face);
}

/* False when out of memory; cube_free is required in any case. */
static inline bool cube_make(starg_context *context, size_t count, cube_directions *d) {
    d->x = starg_allocate(context, count, sizeof *d->x);
    d->y = starg_allocate(context, count, sizeof *d->y);
    d->z = starg_allocate(context, count, sizeof *d->z);
    d->u = starg_allocate(context, count, sizeof *d->u);
    d->v = starg_allocate(context, count, sizeof *d->v);
    d->nearness = starg_allocate(context, count, sizeof *d->nearness);
    d->face = starg_allocate(context, count, sizeof *d->face);
    return d->x && d->y && d->z && d->u && d->v && d->nearness && d->face;
}

/* Index among equal parts, the last of which has number `last`; values outside (and NaN) go to the
 * ends. Monotone, which is all that correctness requires; branch-free. */
static inline uint32_t part_of(float distance, float scale, float last) {
    float t = distance * scale;
    t = t > 0 ? t : 0;
    return (uint32_t)(int32_t)(t < last ? t : last);
}

static inline uint32_t bin_of(float v) {
    return part_of(v + 1, 0.5f * BINS, BINS - 1);
}

static inline double larger(double a, double b) {
    return a > b ? a : b; /* a single instruction, unlike fmax */
}

/* Returns the largest magnitude among the differences, as eight parallel maxima for
 * vectorization. */
static inline double subtract_all(const double *restrict from, double by, size_t count,
                                  double *restrict out) {
    enum { SIDE_BY_SIDE = 8 };
    double largest[SIDE_BY_SIDE] = {0};
    size_t i = 0;
    for (; i + SIDE_BY_SIDE <= count; i += SIDE_BY_SIDE)
        for (size_t k = 0; k < SIDE_BY_SIDE; k++) {
            double difference = from[i + k] - by;
            out[i + k] = difference;
            largest[k] = larger(fabs(difference), largest[k]);
        }
    for (; i < count; i++) {
        out[i] = from[i] - by;
        largest[0] = larger(fabs(out[i]), largest[0]);
    }
    for (size_t k = 1; k < SIDE_BY_SIDE; k++)
        largest[0] = larger(largest[k], largest[0]);
    return largest[0];
}

static inline bool block_in_use(const uint8_t *in_use, size_t first) {
    uint8_t any = 0;
    for (size_t i = 0; i < SLOT_BLOCK; i++)
        any |= in_use[first + i];
    return any != 0;
}

/* The next run of blocks with slots in use, from *end on; all slots at once if in_use is NULL. The
 * last slots, fewer than a block, count as in use. False: there is none. */
static inline bool next_run(const uint8_t *in_use, size_t count, size_t *first, size_t *end) {
    size_t i = *end;
    while (in_use != NULL && i + SLOT_BLOCK <= count && !block_in_use(in_use, i))
        i += SLOT_BLOCK;
    *first = i;
    while (in_use != NULL && i + SLOT_BLOCK <= count && block_in_use(in_use, i))
        i += SLOT_BLOCK;
    *end = in_use == NULL || i + SLOT_BLOCK > count ? count : i;
    return *first < *end;
}

/* With |x| <= mx, |y| <= my, |z| <= mz a determinant of three differences has a permanent of at
 * most 6 mx my mz and an error of at most 8 roundings of it; four of them sum to less than 30. One
 * whose last row is off by b in each coordinate is off by at most 6 m^2 b more, m being the largest
 * of the three. */
static inline void cube_make_relative(const visibility_scene *scene, const double p[3],
                                      const uint8_t *in_use, cube_directions *d) {
    double mx = 0, my = 0, mz = 0;
    for (size_t i, end = 0; next_run(in_use, scene->slot_count, &i, &end);) {
        mx = larger(subtract_all(scene->x + i, p[0], end - i, d->x + i), mx);
        my = larger(subtract_all(scene->y + i, p[1], end - i, d->y + i), my);
        mz = larger(subtract_all(scene->z + i, p[2], end - i, d->z + i), mz);
    }
    d->extent = larger(larger(mx, my), mz);
    d->bound = 6 * 40 * 0x1p-53 * mx * my * mz;
    if (scene->slot_count > scene->vertex_count)
        d->bound += 4 * 8 * scene->blur * d->extent * d->extent;
    if (!(d->bound > 1e-200))
        d->bound = INFINITY;
}

/* Projects vertices; branch-free and with restrict pointers, for vectorization. If the major
 * coordinate is so small that its inverse is infinite, u is NaN or infinite, and the rim flag is
 * set. */
static inline void project_run(size_t begin, size_t end, cube_directions *d) {
    const float rim = 1 - CELL_MARGIN;
    const double *restrict all_x = d->x, *restrict all_y = d->y, *restrict all_z = d->z;
    float *restrict all_u = d->u, *restrict all_v = d->v, *restrict nearness = d->nearness;
    uint32_t *restrict faces = d->face;
    double extent = d->extent;
    for (size_t i = begin; i < end; i++) {
        double x = all_x[i], y = all_y[i], z = all_z[i];
        double ax = fabs(x), ay = fabs(y), az = fabs(z);
        double most = larger(ay, az);
        double major = ay >= az ? y : z, first = ay >= az ? z : x, second = ay >= az ? x : y;
        major = ax >= most ? x : major;
        first = ax >= most ? y : first;
        second = ax >= most ? z : second;
        double scale = 1 / fabs(major);
        float u = (float)(first * scale), v = (float)(second * scale);
        float outer = fabsf(u) < fabsf(v) ? fabsf(v) : fabsf(u);
        uint32_t face = ay >= az ? 2 : 4, margin = outer < rim ? 0 : RIM;
        face = ax >= most ? 0 : face;
        face += major < 0 ? 1 : 0;
        all_u[i] = u;
        all_v[i] = v;
        nearness[i] = (float)(extent * scale);
        faces[i] = face + margin;
    }
}

static inline void cube_project(size_t count, const uint8_t *in_use, cube_directions *d) {
    for (size_t begin, end = 0; next_run(in_use, count, &begin, &end);)
        project_run(begin, end, d);
}

/* Permutes coordinates: the cube face's axis first, then u and v. */
static inline void cube_turn(const cube_directions *d, uint32_t slot, uint32_t cube_face,
                             double out[3]) {
    const double *const axis[3] = {d->x, d->y, d->z};
    uint32_t k = cube_face / 2;
    out[0] = cube_face % 2 ? -axis[k][slot] : axis[k][slot];
    out[1] = axis[(k + 1) % 3][slot];
    out[2] = axis[(k + 2) % 3][slot];
}

/* Anything closer to p than about this times its own size may have any direction, within rounding:
 * clipping it by a frustum could lose it. */
static const double NEAR = 0x1p-18;

static inline double size_of(const double v[3]) {
    return larger(larger(fabs(v[0]), fabs(v[1])), fabs(v[2]));
}

static inline void cube_relative(const cube_directions *d, uint32_t slot, double out[3]) {
    out[0] = d->x[slot];
    out[1] = d->y[slot];
    out[2] = d->z[slot];
}

/* May the segment from a to b come near p? Its distance is at least |a x b| / |b - a|; a short one
 * cannot, since it stays near its ends. The lower bound on the length guards the quotient. */
static inline bool segment_is_near(const cube_directions *d, uint32_t from, uint32_t to) {
    double a[3], b[3], along[3], area[3];
    cube_relative(d, from, a);
    cube_relative(d, to, b);
    vec3_subtract(b, a, along);
    vec3_cross(a, b, area);
    double size = larger(size_of(a), size_of(b)), length = size_of(along);
    return !(length < 0.25 * size) &&
           !(size_of(area) > 4 * NEAR * size * larger(length, NEAR * size));
}

/* Same for a triangle: the distance of its plane with normal n is |det(a, b, c)| / |n|. */
static inline bool triangle_is_near(const cube_directions *d, const uint32_t corner[3]) {
    double a[3], b[3], c[3], ab[3], ac[3], normal[3];
    cube_relative(d, corner[0], a);
    cube_relative(d, corner[1], b);
    cube_relative(d, corner[2], c);
    vec3_subtract(b, a, ab);
    vec3_subtract(c, a, ac);
    vec3_cross(ab, ac, normal);
    double size = larger(larger(size_of(a), size_of(b)), size_of(c));
    double length = larger(size_of(ab), size_of(ac)), area = size_of(normal);
    return !(length < 0.25 * size) &&
           !(fabs(vec3_dot(normal, a)) > 4 * NEAR * size * larger(area, NEAR * size * size));
}

/* Positive within one of the four sides of the frustum. */
static inline double beyond_side(const double v[3], int plane) {
    return SLACK * v[0] - (plane % 2 ? -v[1 + plane / 2] : v[1 + plane / 2]);
}

/* Bit 4 f + k: the vertex lies outside side k of the frustum of cube face f; bit 24 + f: it is not
 * in front of that cube face. */
static inline uint32_t cube_outside(const double v[3]) {
    uint32_t bits = 0;
    for (uint32_t face = 0; face < CUBE_FACES; face++) {
        double major = face % 2 ? -v[face / 2] : v[face / 2];
        double turned[3] = {major, v[(face / 2 + 1) % 3], v[(face / 2 + 2) % 3]};
        for (int plane = 0; plane < 4; plane++)
            bits |= (uint32_t)(beyond_side(turned, plane) < 0) << (4 * face + (uint32_t)plane);
        bits |= (uint32_t)(major <= 0) << (24 + face);
    }
    return bits;
}

/* Bit f: the face may project to cube face f. */
static inline uint32_t cube_faces_met(const cube_directions *d, const uint32_t corner[3]) {
    uint32_t outside = UINT32_MAX, met = 0;
    for (int k = 0; k < 3; k++) {
        double v[3];
        cube_relative(d, corner[k], v);
        outside &= cube_outside(v);
    }
    for (uint32_t face = 0; face < CUBE_FACES; face++)
        met |= (uint32_t)((outside & (UINT32_C(15) << 4 * face | UINT32_C(1) << (24 + face))) == 0)
               << face;
    return met;
}

/* A convex polygon on one cube face: a face, or its part in the frustum. */
typedef struct cube_polygon {
    int count;
    float corner[8][2]; /* u, v */
    double depth;       /* the largest coordinate along the axis */
} cube_polygon;

/* Vectors from p with the cube face's axis first, then u and v. */
typedef struct cone_polygon {
    int count;
    double corner[8][3];
} cone_polygon;

/* Clips by one side. */
static inline void clip_cone(const cone_polygon *in, int plane, cone_polygon *out) {
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->corner[i], *b = in->corner[(i + 1) % in->count];
        double at_a = beyond_side(a, plane), at_b = beyond_side(b, plane);
        if (at_a >= 0)
            memcpy(out->corner[out->count++], a, sizeof out->corner[0]);
        if ((at_a >= 0) == (at_b >= 0))
            continue;
        double t = at_a / (at_a - at_b);
        for (int j = 0; j < 3; j++)
            out->corner[out->count][j] = a[j] + t * (b[j] - a[j]);
        out->count++;
    }
}

/* The part of a face in the frustum of a cube face that it may meet: usually clipped by a single
 * side. */
static inline void clip_to_frustum(cone_polygon *polygon) {
    cone_polygon clipped;
    bool cut[4] = {false};
    for (int plane = 0; plane < 4; plane++)
        for (int i = 0; i < 3; i++)
            cut[plane] |= beyond_side(polygon->corner[i], plane) < 0;
    for (int plane = 0; plane < 4; plane++)
        if (cut[plane]) {
            clip_cone(polygon, plane, &clipped);
            *polygon = clipped;
        }
}

/* Same on a cube face that it may meet, for a face not near p. */
static inline void cube_clip_triangle(const cube_directions *d, const uint32_t corner[3],
                                      uint32_t cube_face, cube_polygon *polygon) {
    cone_polygon cone = {.count = 3};
    for (int i = 0; i < 3; i++)
        cube_turn(d, corner[i], cube_face, cone.corner[i]);
    clip_to_frustum(&cone);
    polygon->count = cone.count;
    polygon->depth = 0;
    for (int i = 0; i < cone.count; i++) {
        polygon->depth = larger(polygon->depth, cone.corner[i][0]);
        polygon->corner[i][0] = (float)(cone.corner[i][1] / cone.corner[i][0]);
        polygon->corner[i][1] = (float)(cone.corner[i][2] / cone.corner[i][0]);
    }
}

static inline float lesser(float a, float b) {
    return a < b ? a : b; /* a single instruction, unlike fminf */
}

static inline float greater(float a, float b) {
    return a > b ? a : b;
}

static inline void widen(float u, float span[2]) {
    span[0] = lesser(u, span[0]);
    span[1] = greater(u, span[1]);
}

/* Where one edge of a projected triangle lies within a row: its ends there, and where it enters and
 * leaves. The slack covers the rounding of the slope, which matters for nearly horizontal edges;
 * the ends bound it. */
static inline void span_edge(const float from[2], const float to[2], float v_low, float v_high,
                             float span[2]) {
    float u_low = lesser(from[0], to[0]), u_high = greater(from[0], to[0]);
    float slope = (to[0] - from[0]) / (to[1] - from[1]);
    float slack = (fabsf(slope) + 1) * CELL_MARGIN;
    if (from[1] >= v_low && from[1] <= v_high)
        widen(from[0], span);
    for (int side = 0; side < 2; side++) {
        float v = side ? v_high : v_low;
        if ((from[1] < v) == (to[1] < v))
            continue;
        float u = from[0] + (v - from[1]) * slope;
        widen(u - slack > u_low ? u - slack : u_low, span);
        widen(u + slack < u_high ? u + slack : u_high, span);
    }
}

#endif
