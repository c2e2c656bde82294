/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts off parts of a box in which no guard may stand.
 *
 * Many boxes of a subdivision hold a sliver of the solid at one side and nothing else. What a
 * smaller box about the sliver may see is less, and found at once.
 *   1. The triangles in the box are clipped to it: what of the solid is in the box lies within
 *      their bounds, unless a side of the box is inside.
 *   2. A side that is far from these bounds is cut off at a multiple of a fraction of the length,
 * so that coordinates stay short, if what is cut off is outside by the test that box_look makes.
 *
 * Invariant: rounding in the first stage costs a cut, never a point of the solid. Cost: the
 * triangles in the box, and a question of a box for each side. */
#include <math.h>
#include <string.h>

#include "geometry/vec3.h"
#include "visibility/box_parts.h"

enum { MOST_CORNERS = 9, FRACTION_BITS = 6 };

/* Of the length, what a cut has to take off. */
static const double LEAST_CUT = 1.0 / 8;

/* Clips a polygon to one side of a plane across an axis. */
static int clip(double polygon[MOST_CORNERS][3], int count, int axis, double at, double sign) {
    double left[MOST_CORNERS][3];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const double *a = polygon[i], *b = polygon[(i + 1) % count];
        double from = sign * (a[axis] - at), to = sign * (b[axis] - at);
        if (from >= 0)
            vec3_copy(a, left[kept++]);
        if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
            for (int k = 0; k < 3; k++)
                left[kept][k] = a[k] + from / (from - to) * (b[k] - a[k]);
            left[kept++][axis] = at;
        }
    }
    memcpy(polygon, left, (size_t)kept * sizeof *polygon);
    return kept;
}

/* Extends the bounds by what of the triangle is in the box. */
static void extend(const box_scene *scene, uint32_t rank, const bvh_box *box, bvh_box *bounds) {
    double polygon[MOST_CORNERS][3];
    int count = 3;
    for (int i = 0; i < 3; i++)
        vec3_copy(box_corner(scene, &scene->triangles[rank], i), polygon[i]);
    for (int k = 0; k < 3; k++) {
        count = clip(polygon, count, k, box->lower[k], 1);
        count = clip(polygon, count, k, box->upper[k], -1);
    }
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            bounds->lower[k] = fmin(bounds->lower[k], polygon[i][k]);
            bounds->upper[k] = fmax(bounds->upper[k], polygon[i][k]);
        }
}

/* Where to cut a side off, beyond the bounds: NAN if that is not worth it. */
static double place_cut(const bvh_box *box, const bvh_box *bounds, int axis, int above) {
    double length = box->upper[axis] - box->lower[axis];
    int exponent;
    frexp(length, &exponent);
    double unit = ldexp(1, exponent - FRACTION_BITS);
    double at = above ? (floor(bounds->upper[axis] / unit) + 1) * unit
                      : (ceil(bounds->lower[axis] / unit) - 1) * unit;
    double gap = above ? box->upper[axis] - at : at - box->lower[axis];
    return gap > LEAST_CUT * length && gap < length ? at : NAN;
}

int box_trim(box_worker *w, bvh_box *box, box_cut cuts[BOX_CUTS]) {
    const double all = INFINITY;
    bvh_box bounds = {{all, all, all}, {-all, -all, -all}};
    int count = 0;
    if (!box_enter(w, box) || w->crossing_count == 0)
        return 0;
    for (size_t i = 0; i < w->crossing_count; i++)
        extend(w->scene, w->crossing[i], box, &bounds);
    for (int side = 0; side < BOX_CUTS; side++) {
        const int axis = side / 2, above = side % 2;
        const box_cut cut = {place_cut(box, &bounds, axis, above), axis, above};
        bvh_box off = *box, left = *box;
        if (isnan(cut.at))
            continue;
        if (cut.above)
            off.lower[cut.axis] = left.upper[cut.axis] = cut.at;
        else
            off.upper[cut.axis] = left.lower[cut.axis] = cut.at;
        if (box_enter(w, &off))
            continue;
        *box = left;
        cuts[count++] = cut;
    }
    return count;
}
