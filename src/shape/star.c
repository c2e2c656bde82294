/* SPDX-License-Identifier: Apache-2.0 */
/* Star distance: features of a star decomposition that do not depend on the pose or on how the
 * shape was cut.
 *
 * Numbers, in three parts:
 * - the spectrum of the boundary surface [RWP06], in units of its own growth, because among objects
 *   of a kind with different proportions, area does not measure scale;
 * - views: what is seen from points spread over the pieces (views.c), in units of the cube root of
 *   the shape's volume;
 * - wave kernel signature: where the surface vibrates (wks.c), as logarithms.
 *
 * Spectra are compared by the mean difference of their eigenvalues, each divided by its index,
 * because they grow in proportion to it (Weyl's law). Rows of views and of the wave kernel
 * signature are quantiles, so their mean difference is the optimal transport cost between
 * distributions. Each part is divided by its average between two shapes, and the distance is the
 * mean of the three: a weighted L1 norm of a difference, hence a metric.
 *
 * Cost: a few additions per number. */
#include <math.h>

#include "core/memory.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "star distance";

enum {
    EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES,
    VIEWS_COUNT = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
    WKS_COUNT = STARG_DESCRIPTOR_ENERGIES * STARG_DESCRIPTOR_SPREAD,
    VIEWS = EIGENVALUES, /* offsets of the views and of the wave kernel signature */
    WKS = VIEWS + VIEWS_COUNT,
    NUMBERS = WKS + WKS_COUNT
};

static const double FAINT = 0.05;    /* lower values count as equally weak; 1 is average */
static const double LARGEST = 1e100; /* upper bound of plausible numbers */

/* Mean differences between two models of the TOSCA set. */
static const double SPECTRUM_UNIT = 0.078, VIEWS_UNIT = 0.041, WKS_UNIT = 0.18;

/* Cube root of the volume. Summed relative to the largest volume, to avoid overflow and
 * underflow. */
static double unit_of(const starg_descriptor *d) {
    double largest = 0, sum = 0;
    for (size_t i = 0; i < d->guard_count; i++)
        largest = fmax(largest, d->guards[i].volume);
    for (size_t i = 0; i < d->guard_count; i++)
        sum += largest > 0 ? d->guards[i].volume / largest : 0;
    return largest > 0 ? cbrt(largest) * cbrt(sum) : fmax(d->diagonal, 1e-300);
}

/* Eigenvalues in units of their mean increment. */
static void put_spectrum(const double *eigenvalues, double *out) {
    double sum = 0;
    for (size_t i = 0; i < EIGENVALUES; i++)
        sum += eigenvalues[i] / (double)(i + 1);
    for (size_t i = 0; i < EIGENVALUES; i++)
        out[i] = sum > 0 ? eigenvalues[i] / (sum / EIGENVALUES) : 0;
}

static starg_status derive(starg_context *context, const starg_descriptor *d, double **numbers,
                           size_t *count) {
    double *all = NULL, unit = unit_of(d);
    NEW(context, STAGE, all, NUMBERS);
    put_spectrum(d->surface_spectrum, all);
    for (size_t i = 0; i < VIEWS_COUNT; i++)
        all[VIEWS + i] = d->views[i / STARG_DESCRIPTOR_SPREAD][i % STARG_DESCRIPTOR_SPREAD] / unit;
    for (size_t i = 0; i < WKS_COUNT; i++)
        all[WKS + i] =
            log(d->wave_kernel[i / STARG_DESCRIPTOR_SPREAD][i % STARG_DESCRIPTOR_SPREAD] + FAINT);
    *numbers = all;
    *count = NUMBERS;
    return STARG_OK;
}

static bool check(const double *numbers, size_t count) {
    if (count != NUMBERS)
        return false;
    for (size_t i = 0; i < EIGENVALUES; i++)
        if (!(numbers[i] >= (i > 0 ? numbers[i - 1] : 0)))
            return false;
    for (size_t i = 0; i < NUMBERS; i++)
        if (!(fabs(numbers[i]) < LARGEST))
            return false;
    return true;
}

static void weigh(const double *numbers, double *out) {
    for (size_t i = 0; i < VIEWS; i++)
        out[i] = numbers[i] / ((double)(i + 1) * 3 * SPECTRUM_UNIT * EIGENVALUES);
    for (size_t i = VIEWS; i < WKS; i++)
        out[i] = numbers[i] / (3 * VIEWS_UNIT * VIEWS_COUNT);
    for (size_t i = WKS; i < NUMBERS; i++)
        out[i] = numbers[i] / (3 * WKS_UNIT * WKS_COUNT);
}

const signature_method signature_star = {.name = "star",
                                         .version = 4,
                                         .derive = derive,
                                         .check = check,
                                         .weigh = weigh,
                                         .count = NUMBERS,
                                         .run = 8};
