/* SPDX-License-Identifier: Apache-2.0 */
#include "adversarial.h"

#include <math.h>
#include <string.h>

const char *point_family_name(point_family family) {
    static const char *const names[POINT_FAMILIES] = {
        "uniform",   "lattice", "tiny", "plane", "line",      "sphere", "far lattice", "1e-300",
        "subnormal", "1e90",    "9e99", "mixed", "exponents", "ulps",   "between"};
    return names[family];
}

static double between(starg_rng *rng, double low, double high) {
    return low + (high - low) * starg_rng_unit(rng);
}

static double integer(starg_rng *rng, int low, int high) {
    return low + (double)starg_rng_below(rng, (uint64_t)(high - low + 1));
}

/* Moves x by one ulp up or down, or not at all. */
static double shaken(starg_rng *rng, double x) {
    switch (starg_rng_below(rng, 4)) {
    case 0:
        return nextafter(x, INFINITY);
    case 1:
        return nextafter(x, -INFINITY);
    default:
        return x;
    }
}

static double mixed(starg_rng *rng) {
    static const double scales[] = {1e90, 1e-300, 5e-324, 1, 1e8, 0};
    double scale = scales[starg_rng_below(rng, sizeof scales / sizeof *scales)];
    return scale * integer(rng, -3, 3);
}

static double any_exponent(starg_rng *rng) {
    return ldexp(between(rng, -1, 1), -1074 + (int)starg_rng_below(rng, 1074 + 329));
}

/* A few ulps from x. */
static double near(starg_rng *rng, double x) {
    for (uint64_t steps = starg_rng_below(rng, 3); steps > 0; steps--)
        x = shaken(rng, x);
    return x;
}

/* A weighted mean of earlier points, exact on a lattice. */
static void place_between(starg_rng *rng, double (*points)[3], size_t count) {
    static const double weights[6][3] = {{0.5, 0.5, 0}, {0.25, 0.25, 0.5},  {2, -1, 0},
                                         {1, 1, -1},    {0.75, 0.5, -0.25}, {1, 0, 0}};
    const double *w = weights[starg_rng_below(rng, 6)];
    const double *a = points[starg_rng_below(rng, count)];
    const double *b = points[starg_rng_below(rng, count)];
    const double *c = points[starg_rng_below(rng, count)];
    for (int k = 0; k < 3; k++) {
        double mean = w[0] * a[k] + w[1] * b[k] + w[2] * c[k];
        points[count][k] = starg_rng_below(rng, 8) == 0 ? shaken(rng, mean) : mean;
    }
}

/* frame: three points that define a family. */
static void place(starg_rng *rng, point_family family, double (*frame)[3], double out[3]) {
    double u = between(rng, -1, 1), v = family == POINTS_LINE ? 0 : between(rng, -1, 1);
    double z = between(rng, -1, 1), r = sqrt(1 - z * z);
    const double sphere[3] = {r * cos(3 * u), r * sin(3 * u), z};
    for (int k = 0; k < 3; k++)
        switch (family) {
        case POINTS_LATTICE:
            out[k] = integer(rng, 0, 3);
            break;
        case POINTS_TINY:
            out[k] = integer(rng, -1, 1);
            break;
        case POINTS_PLANE:
        case POINTS_LINE:
            out[k] = shaken(rng, frame[0][k] + u * frame[1][k] + v * frame[2][k]);
            break;
        case POINTS_SPHERE:
            out[k] = shaken(rng, frame[0][k] + sphere[k]);
            break;
        case POINTS_FAR_LATTICE:
            out[k] = 1e8 + 0.1 * integer(rng, 0, 3);
            break;
        case POINTS_1E_300:
            out[k] = 1e-300 * integer(rng, -3, 3);
            break;
        case POINTS_SUBNORMAL:
            out[k] = 5e-324 * integer(rng, -3, 3);
            break;
        case POINTS_1E90:
            out[k] = 1e90 * integer(rng, -3, 3);
            break;
        case POINTS_9E99:
            out[k] = 9e99 * between(rng, -1, 1);
            break;
        case POINTS_MIXED:
            out[k] = mixed(rng);
            break;
        case POINTS_EXPONENTS:
            out[k] = any_exponent(rng);
            break;
        case POINTS_ULPS:
            out[k] = near(rng, frame[0][k]);
            break;
        case POINTS_BETWEEN:
            out[k] = integer(rng, 0, 3);
            break;
        default:
            out[k] = between(rng, -1, 1);
        }
}

void adversarial_points(starg_rng *rng, point_family family, double (*points)[3], size_t count) {
    double frame[3][3];
    for (int i = 0; i < 9; i++)
        frame[i / 3][i % 3] = between(rng, -1, 1);
    for (size_t i = 0; i < count; i++) {
        if (family == POINTS_BETWEEN && i >= 3)
            place_between(rng, points, i);
        else
            place(rng, family, frame, points[i]);
        if (i == 0 || starg_rng_below(rng, 12) != 0)
            continue;
        const double *earlier = points[starg_rng_below(rng, i)];
        size_t coordinates = 1 + starg_rng_below(rng, 3);
        memcpy(points[i], earlier, coordinates * sizeof *earlier);
    }
}
