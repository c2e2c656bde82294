/* SPDX-License-Identifier: Apache-2.0 */
/* Nanoseconds per orient3d where the filter, the 128-bit step or the limbs decide. */
#include <stdint.h>
#include <stdio.h>
#include <time.h>

#include "core/rng.h"
#include "geometry/predicates.h"

enum { SETS = 1024, ROUNDS = 400 };

static double points[SETS][4][3];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void run(const char *name, int rounds) {
    int sum = 0;
    double start = now();
    for (int r = 0; r < rounds; r++)
        for (int i = 0; i < SETS; i++)
            sum += orient3d(points[i][0], points[i][1], points[i][2], points[i][3]);
    double seconds = now() - start;
    printf("%-34s %8.1f ns (sum %d)\n", name, 1e9 * seconds / ((double)rounds * SETS), sum);
}

/* Fills the sets with coordinates from `make`; the fourth point is the mean of two edges' ends, so
 * that it lies in the plane of the others if `coplanar` (and `make` gives short numbers). */
static void fill(double (*make)(starg_rng *), int coplanar) {
    starg_rng rng = starg_rng_make(3, 1, 4);
    for (int i = 0; i < SETS; i++)
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 3; k++)
                points[i][p][k] = p == 3 && coplanar
                                      ? points[i][0][k] + points[i][1][k] - points[i][2][k]
                                      : make(&rng);
}

static double unit(starg_rng *rng) {
    return starg_rng_unit(rng);
}

static double lattice(starg_rng *rng) {
    return (double)starg_rng_below(rng, 1000);
}

static double decimal(starg_rng *rng) {
    return (double)starg_rng_below(rng, 1u << 20) * 0x1p-50 + (double)starg_rng_below(rng, 4);
}

static double mixed(starg_rng *rng) {
    uint64_t draw = starg_rng_below(rng, 3);
    return starg_rng_unit(rng) * (draw == 0 ? 1e90 : draw == 1 ? 1 : 1e-290);
}

int main(void) {
    fill(unit, 0);
    run("random, filter", ROUNDS);
    fill(lattice, 1);
    run("coplanar on a lattice, 128 bits", ROUNDS);
    fill(decimal, 1);
    run("coplanar, long numbers, limbs", ROUNDS / 10);
    fill(mixed, 0);
    for (int i = 0; i < SETS; i++)
        for (int k = 0; k < 3; k++)
            points[i][3][k] = points[i][0][k]; /* differ in one bit, so that no shortcut applies */
    for (int i = 0; i < SETS; i++)
        points[i][3][0] = points[i][1][0];
    run("1e90 beside 1e-290", ROUNDS / 10);
    return 0;
}
