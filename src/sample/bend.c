/* SPDX-License-Identifier: Apache-2.0 */
/* Poses of solids that have no joints: all of space is bent or twisted.
 *
 * Coordinates are taken about the middle of the box, in halves of its longest side. Both maps are
 * bijections of space that keep volumes, so a solid stays one, of the same genus, as long as its
 * faces are small against the bend. Cost: O(n). */
#include <math.h>

#include "sample/solids.h"

enum { BENT = 1 }; /* SOLID_BENDS - 1 is twisted; 0 is as made */

static const double BEND = 0.35;
static const double TWIST = 0.7; /* radians at the ends of x */

/* y rises with the square of x. */
static void bend(double p[3]) {
    p[1] += BEND * p[0] * p[0];
}

/* Turns about the x axis, in proportion to x. */
static void twist(double p[3]) {
    double c = cos(TWIST * p[0]), s = sin(TWIST * p[0]), y = p[1];
    p[1] = c * y - s * p[2];
    p[2] = s * y + c * p[2];
}

void solid_bend(starg_mesh *mesh, int pose) {
    double lower[3], upper[3], half = 0;
    if (pose == 0)
        return;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        half = fmax(half, 0.5 * (upper[k] - lower[k]));
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double *place = mesh->vertices + 3 * v, p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (place[k] - 0.5 * (lower[k] + upper[k])) / half;
        if (pose == BENT)
            bend(p);
        else
            twist(p);
        for (int k = 0; k < 3; k++)
            place[k] = 0.5 * (lower[k] + upper[k]) + half * p[k];
    }
}
