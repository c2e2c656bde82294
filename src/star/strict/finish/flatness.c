/* SPDX-License-Identifier: Apache-2.0 */
/* How flat the tetrahedra between guards and facets are.
 *
 * A tetrahedron lacks what its smallest angle is short of FLATNESS_ANGLE, as a share of that and
 * squared, so that one that is very flat counts more than two that are a little. A piece lacks what
 * its margin is short of FLATNESS_MARGIN, which weighs as much as a hundred angles, for a piece
 * with a thin kernel has many that are small, and other cuts of its neighbours cannot mend these.
 * Rounded: it says which cut is better, never whether one is valid. Cost: linear in the facets. */
#include "star/strict/finish/finish.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/piece_faces.h"

/* Of a margin, in angles. */
static const double WEIGHT = 100;

typedef struct box {
    double lower[3], upper[3];
} box;

static const box EMPTY = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void add_facet(const partition *p, const facet *f, box *to) {
    for (int c = 0; c < 3; c++) {
        const double *at = partition_unit(p, f->corners[c]);
        for (int i = 0; i < 3; i++) {
            to->lower[i] = fmin(to->lower[i], at[i]);
            to->upper[i] = fmax(to->upper[i], at[i]);
        }
    }
}

static double lack_of_margin(const partition *p, uint32_t number, double diagonal) {
    double margin = p->pieces.data[number].radius / diagonal;
    return WEIGHT * fmax(0, 1 - margin / FLATNESS_MARGIN);
}

/* The smallest dihedral angle of the tetrahedron on a triangle of a piece, whose corners are
 * counter-clockwise from outside; negative if its guard is not strictly inside. Degrees. */
static double angle_over(const partition *p, uint32_t number, const uint32_t corners[3]) {
    const double *guard = p->pieces.data[number].guard, *origin = partition_point(p, corners[0]);
    double place[4][3] = {{0}};
    const int exponent = partition_exponent(p);
    if (orient3d(origin, partition_point(p, corners[1]), partition_point(p, corners[2]), guard) <=
        0)
        return -1;
    for (int i = 1; i < 4; i++) {
        vec3_subtract(i == 3 ? guard : partition_point(p, corners[i]), origin, place[i]);
        for (int k = 0; k < 3; k++)
            place[i][k] = ldexp(place[i][k], -exponent);
    }
    return angles_smallest((const double(*)[3])place);
}

double flatness_of_side(const partition *p, const facet *f, int side) {
    uint32_t corners[3];
    facet_outward(f, side, corners);
    const double angle = angle_over(p, f->side[side], corners);
    const double lack = fmax(0, 1 - angle / FLATNESS_ANGLE);
    return angle < 0 ? INFINITY : lack * lack;
}

double flatness_of_facet(const partition *p, const facet *f) {
    double sum = 0;
    for (int side = 0; side < 2; side++)
        if (f->side[side] != PARTITION_OUTSIDE)
            sum += flatness_of_side(p, f, side);
    return sum;
}

double flatness_diagonal(const partition *p, uint32_t number) {
    box all = EMPTY;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++)
        add_facet(p, &p->facets.data[p->index.data[k] / 2], &all);
    return vec3_distance(all.lower, all.upper);
}

double flatness_room(const partition *p, uint32_t number) {
    double guard[3], least = INFINITY;
    partition_to_unit(p, p->pieces.data[number].guard, guard);
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t corners[3], entry = p->index.data[k];
        partition_plane plane;
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), corners);
        partition_plane_of(p, corners, &plane);
        least = fmin(least, plane.offset - vec3_dot(plane.normal, guard));
    }
    return least;
}

double flatness_of_piece(const partition *p, uint32_t number) {
    double sum = lack_of_margin(p, number, flatness_diagonal(p, number));
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t entry = p->index.data[k];
        sum += flatness_of_side(p, &p->facets.data[entry / 2], (int)(entry % 2));
    }
    return sum;
}

double flatness_of_first(const partition *p, size_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        box all = EMPTY;
        for (size_t f = 0; f < p->facets.count; f++)
            if (p->facets.data[f].side[0] == i || p->facets.data[f].side[1] == i)
                add_facet(p, &p->facets.data[f], &all);
        sum += lack_of_margin(p, i, vec3_distance(all.lower, all.upper));
    }
    for (size_t f = 0; f < p->facets.count; f++)
        sum += flatness_of_facet(p, &p->facets.data[f]);
    return sum;
}
