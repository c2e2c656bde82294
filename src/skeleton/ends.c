/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of a curve. The end of a limb is the centre of its last ball: no ball beyond reaches farther
 * in the direction of the limb. Pruning finds it among the nodes of the complex and leaves some
 * slack, so that no limb hooks into the rim of a cap; on a coarse model the end is then too early.
 * Here it moves on in that direction, but not quite to the surface:
 *
 *   1. The direction: that of the curve, over two steps of a radius each, bent on.
 *   2. The way to the surface, in steps of the distance from it, which never cross it.
 *   3. A ball at s reaches s + (its radius), which does not fall as s grows. The least s that
 *      reaches the surface up to a share of the radius, by bisection.
 *
 * Cost: some distances for each end. */
#include "skeleton/skeleton.h"

#include "geometry/vec3.h"

static const double SHORT = 0.01; /* of a radius, by which a limb may end early */
static const double CLOSE = 0.01; /* of a radius, from the surface */
static const double MOST = 0.95;  /* of the way to the surface, as at the tip of a cone */
enum { STEPS = 64, HALVINGS = 10 };

typedef struct mover {
    const starg_solid *solid;
    double *end;    /* the point that moves */
    ptrdiff_t step; /* from it to the one before, in coordinates */
    size_t count;
    double start[3], way[3]; /* where it was; a unit vector */
} mover;

static const double *point(const mover *m, size_t i) {
    return m->end + (ptrdiff_t)i * m->step;
}

void ends_direction(const double before[3], const double back[3], const double at[3], double ahead,
                    double way[3]) {
    double last[3];
    vec3_subtract(at, back, way);
    vec3_subtract(back, before, last);
    double length = vec3_length(way), length_before = vec3_length(last);
    if (!(length_before > 0))
        return;
    double share = (length + 2 * ahead) / (length + length_before);
    for (int k = 0; k < 3; k++)
        way[k] += share * (way[k] - last[k] * length / length_before);
}

/* The distance from the surface, s ahead of the end. */
static double radius_at(const mover *m, double s) {
    double p[3];
    vec3_along(m->start, s, m->way, p);
    return starg_solid_contains(m->solid, p) ? starg_solid_distance(m->solid, p) : 0;
}

/* The number of steps back from step i to a point at some distance from it, or to the first. */
static size_t walk_back(const mover *m, size_t i, double away) {
    size_t back = i;
    while (back + 1 < m->count && vec3_distance(point(m, back), point(m, i)) < away)
        back++;
    return back;
}

static bool find_direction(mover *m, double radius) {
    size_t back = walk_back(m, 0, radius), before = walk_back(m, back, radius);
    ends_direction(point(m, before), point(m, back), m->start, 0.5 * radius, m->way);
    return vec3_normalize(m->way) > 0;
}

void ends_advance(const starg_solid *solid, double (*points)[3], size_t last, ptrdiff_t step,
                  size_t count) {
    mover m = {.solid = solid, .end = points[last], .step = 3 * step, .count = count};
    vec3_copy(m.end, m.start);
    double radius = starg_solid_distance(solid, m.start), r = radius, surface = 0;
    if (!find_direction(&m, radius))
        return;
    for (int i = 0; i < STEPS && r > CLOSE * radius; i++) {
        surface += r;
        r = radius_at(&m, surface);
    }
    if (surface - radius <= SHORT * radius)
        return;
    double low = 0, high = MOST * surface;
    for (int i = 0; i < HALVINGS; i++) {
        double s = 0.5 * (low + high);
        *(surface - s - radius_at(&m, s) <= SHORT * radius ? &high : &low) = s;
    }
    if (radius_at(&m, high) > 0)
        vec3_along(m.start, high, m.way, m.end);
}
