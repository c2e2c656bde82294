/* SPDX-License-Identifier: Apache-2.0 */
/* Have coordinates lost what edges are made of?
 *
 * Problem: files of single precision, and texts of six or seven digits, hold map coordinates in
 * steps that may be as large as walls are thick. The steps remain in the coordinates when they are
 * doubles.
 *
 * Method: on each axis, the lowest bit that any coordinate uses, and the lowest decimal digit. The
 * larger one is the step. It is coarse where the shortest edge, or the diagonal, has few of them,
 * and the digits went to the distance from the origin: a model of few steps about the origin was
 * drawn so. Cost: linear.
 */
#include "mesh/examine.h"

#include <math.h>

#include "core/bits.h"

static const double DIGITS = 1e5;    /* steps from the origin */
static const double SINGLE = 0x1p24; /* and at most as many in single precision, or seven digits */
static const double FAR = 8;         /* extents from the origin */
static const double SHORT = 10;      /* an edge of fewer steps is short */
static const double FEW = 1000;      /* steps in the diagonal */

enum { POWERS = 10 };
static const double TEN_TO[POWERS] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/* The lowest bit of a number that is not 0. */
static double lowest_bit(double x) {
    int exponent;
    uint64_t digits = (uint64_t)ldexp(frexp(fabs(x), &exponent), 53);
    return ldexp(1, exponent - 53 + starg_bit_lowest(digits));
}

static bool is_multiple(double x, int power) {
    return power >= 0 ? fmod(x, TEN_TO[power]) == 0
                      : round(x * TEN_TO[-power]) / TEN_TO[-power] == x;
}

static double step_on_axis(const starg_mesh *mesh, size_t axis) {
    double bit = INFINITY;
    int power = POWERS - 1;
    for (size_t i = axis; i < 3 * mesh->vertex_count; i += 3) {
        double x = mesh->vertices[i];
        if (x == 0)
            continue;
        bit = fmin(bit, lowest_bit(x));
        while (power > -POWERS && !is_multiple(x, power))
            power--;
    }
    if (!(bit < INFINITY))
        return 0;
    return fmax(bit, power >= 0 ? TEN_TO[power] : power > -POWERS ? 1 / TEN_TO[-power] : 0);
}

/* The axis of the largest coordinates has the fewest digits behind them. */
static bool is_of_few_digits(const double step[3], const double most[3]) {
    int far = most[1] > most[0];
    far = most[2] > most[far] ? 2 : far;
    return most[far] <= SINGLE * step[far];
}

static bool is_coarse(const starg_mesh *mesh, const double step[3], double edge) {
    double lower[3], upper[3], most[3];
    double large = fmin(edge / SHORT, mesh_diagonal(mesh) / FEW);
    bool coarse = false;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        most[k] = fmax(fabs(lower[k]), fabs(upper[k]));
        coarse |= step[k] > large && most[k] >= DIGITS * step[k] &&
                  most[k] >= FAR * (upper[k] - lower[k]);
    }
    return coarse && is_of_few_digits(step, most);
}

void check_steps(const starg_mesh *mesh, starg_check *check) {
    double edge = mesh_shortest_edge(mesh);
    check->shortest_edge = edge < INFINITY ? edge : 0;
    for (size_t axis = 0; axis < 3; axis++)
        check->grid[axis] = step_on_axis(mesh, axis);
    check->coarse = is_coarse(mesh, check->grid, edge);
}
