/* The star distance: what the pieces of a star decomposition tell of a shape whatever its pose and
 * however it was cut.
 *
 * Numbers, in three parts:
 * - the spectrum of the solid, as the shell of its thickness that guards measure (thickness.c);
 * - the spectrum of its boundary as a surface;
 * - views: logarithms of what is seen from points spread over the pieces (views.c), in units of the
 *   cube root of the shape's volume, so that a finger is as unlike an arm as the arm a trunk.
 *
 * Spectra differ by the mean difference of their eigenvalues, each divided by its place, because
 * they grow in proportion to it (Weyl's law); views by the mean difference. Each part is divided by
 * what it is on average between two shapes, and the mean of the three is the distance. That is a
 * weighted L1 norm of a difference, and so a metric.
 *
 * Cost: a few additions for each number. */
#include <math.h>

#include "core/memory.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "star distance";

enum {
    EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES,
    VIEWS = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
    SURFACE = EIGENVALUES,        /* where the surface's spectrum begins */
    SEEN = SURFACE + EIGENVALUES, /* where views begin */
    NUMBERS = SEEN + VIEWS
};
static const double SMALLEST = 1e-3; /* lengths below that are alike, in units of the shape's */

static const double LARGEST = 1e100; /* eigenvalue that is taken for one */

/* Mean differences between two models of the TOSCA set. */
static const double SOLID_UNIT = 1.27, SURFACE_UNIT = 1.19, VIEWS_UNIT = 0.146;

/* The cube root of the volume. Relative to the largest, so that volumes of any shape that has
 * coordinates can be summed. */
static double unit_of(const starg_descriptor *d) {
    double largest = 0, sum = 0;
    for (size_t i = 0; i < d->guard_count; i++)
        largest = fmax(largest, d->guards[i].volume);
    for (size_t i = 0; i < d->guard_count; i++)
        sum += largest > 0 ? d->guards[i].volume / largest : 0;
    return largest > 0 ? cbrt(largest) * cbrt(sum) : fmax(d->diagonal, 1e-300);
}

static starg_status derive(starg_context *context, const starg_descriptor *d, double **numbers,
                           size_t *count) {
    starg_status status = STARG_OK;
    double *all = NULL, unit = unit_of(d);
    STARG_NEW(context, STAGE, all, NUMBERS);
    memcpy(all, d->solid_spectrum, sizeof d->solid_spectrum);
    memcpy(all + SURFACE, d->surface_spectrum, sizeof d->surface_spectrum);
    for (size_t i = 0; i < VIEWS; i++)
        all[SEEN + i] = log(
            d->views[i / STARG_DESCRIPTOR_SPREAD][i % STARG_DESCRIPTOR_SPREAD] / unit + SMALLEST);
    *numbers = all;
    *count = NUMBERS;
done:
    return status;
}

static bool check(const double *numbers, size_t count) {
    if (count != NUMBERS)
        return false;
    for (size_t i = 0; i < SEEN; i++)
        if (!(numbers[i] >= (i % EIGENVALUES > 0 ? numbers[i - 1] : 0) && numbers[i] < LARGEST))
            return false;
    for (size_t i = SEEN; i < NUMBERS; i++)
        if (!(fabs(numbers[i]) < 1e3))
            return false;
    return true;
}

static double compare_spectra(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < EIGENVALUES; i++)
        sum += fabs(a[i] - b[i]) / (double)(i + 1);
    return sum / EIGENVALUES;
}

static double compare_views(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < VIEWS; i++)
        sum += fabs(a[i] - b[i]);
    return sum / VIEWS;
}

static starg_status compare(starg_context *context, const double *a, size_t a_count,
                            const double *b, size_t b_count, double *out) {
    (void)context, (void)a_count, (void)b_count;
    *out = (compare_spectra(a, b) / SOLID_UNIT +
            compare_spectra(a + SURFACE, b + SURFACE) / SURFACE_UNIT +
            compare_views(a + SEEN, b + SEEN) / VIEWS_UNIT) /
           3;
    return STARG_OK;
}

const signature_method signature_star = {
    .name = "star", .version = 2, .derive = derive, .check = check, .compare = compare};
