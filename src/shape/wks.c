/* SPDX-License-Identifier: Apache-2.0 */
/* Wave kernel signatures of all points of a surface [ASC11], as distributions.
 *
 * Problem: a spectrum contains the energies at which a surface vibrates, but not where. On ears,
 * tails and limbs some energies are strong and others weak, in any pose.
 *
 * A particle on the surface with energy about e (normally distributed in its logarithm) is at a
 * point x with density sum_k g(e, k) phi_k(x)^2 / sum_k g(e, k), where phi_k are the eigenfunctions
 * of the Laplacian: 1 on average. Points are not matched; for each energy the quantiles over the
 * surface are taken, so the difference of two rows is the cost of transporting one distribution
 * into the other.
 *
 * Energies are in units of the mean increment of the eigenvalues, so the scale is the spectrum's
 * own, and in geometric progression.
 *
 * Stages: weights of the eigenfunctions at an energy; densities; quantiles by mass.
 *
 * Invariants: weights depend on eigenvalues only, so any basis of a complete eigenspace gives the
 * same result; eigenvalues that are 0 up to rounding (one per component) have no energy and no
 * weight.
 *
 * Cost: ENERGIES x (MODES x rows + a sort of the rows). */
#include "shape/spectrum.h"

#include <math.h>
#include <stdlib.h>

static const char STAGE[] = "wave kernel";

enum { ENERGIES = STARG_DESCRIPTOR_ENERGIES, SPREAD = STARG_DESCRIPTOR_SPREAD };

/* First and last energy in units of the increment; standard deviation of their logarithm; fraction
 * of the increment up to which an eigenvalue counts as 0. */
static const double LOWEST = 1.5, HIGHEST = 35, WIDTH = 0.35, NOTHING = 1e-6;

typedef struct place {
    double density, mass;
} place;

static int by_density(const void *left, const void *right) {
    double a = ((const place *)left)->density, b = ((const place *)right)->density;
    return (a > b) - (a < b);
}

/* Mean increment: by Weyl's law eigenvalues grow in proportion to their index. */
static double growth_of(const double *eigenvalues) {
    double sum = 0;
    for (size_t k = 1; k <= WKS_MODES; k++)
        sum += eigenvalues[k] / (double)k;
    return sum / WKS_MODES;
}

/* Weights of all eigenfunctions but the first, summing to 1; all 0 if no eigenvalue is near. */
static void weigh(const double *eigenvalues, double growth, size_t energy, double *weights) {
    double step = log(HIGHEST / LOWEST) / (ENERGIES - 1), sum = 0;
    double middle = log(LOWEST) + step * (double)energy;
    for (size_t k = 1; k <= WKS_MODES; k++) {
        bool vibrates = eigenvalues[k] > NOTHING * growth;
        double away = vibrates ? (log(eigenvalues[k] / growth) - middle) / WIDTH : 0;
        sum += weights[k] = vibrates ? exp(-away * away / 2) : 0;
    }
    for (size_t k = 1; k <= WKS_MODES; k++)
        weights[k] = sum > 0 ? weights[k] / sum : 0;
}

/* Uniform where nothing vibrates. */
static void spread(const laplacian *l, const double *functions, const double *weights,
                   place *places) {
    double sum = 0;
    for (size_t k = 1; k <= WKS_MODES; k++)
        sum += weights[k];
    for (size_t i = 0; i < l->count; i++)
        places[i] = (place){.density = sum > 0 ? 0 : 1, .mass = l->masses[i]};
    for (size_t k = 1; k <= WKS_MODES; k++)
        for (size_t i = 0; i < l->count && weights[k] > 0; i++) {
            double value = functions[k * l->count + i];
            places[i].density += weights[k] * value * value;
        }
}

/* At the midpoints of SPREAD equal shares of the mass. Masses sum to 1. */
static void take_quantiles(place *places, size_t count, double *out) {
    double before = 0;
    size_t next = 0;
    qsort(places, count, sizeof *places, by_density);
    for (size_t i = 0; i < SPREAD; i++) {
        double share = ((double)i + 0.5) / SPREAD;
        while (next + 1 < count && before + places[next].mass < share)
            before += places[next++].mass;
        out[i] = places[next].density;
    }
}

starg_status wks_measure(starg_context *context, const laplacian *l, const double *eigenvalues,
                         const double *functions, double *out) {
    SCOPED place *places = NULL;
    double weights[WKS_MODES + 1], growth = growth_of(eigenvalues);
    NEW(context, STAGE, places, l->count);
    for (size_t e = 0; e < ENERGIES; e++) {
        weigh(eigenvalues, growth, e, weights);
        spread(l, functions, weights, places);
        take_quantiles(places, l->count, out + e * SPREAD);
    }
    return STARG_OK;
}
