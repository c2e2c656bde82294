/* The star distance: what the pieces of a star decomposition tell of a shape whatever its pose and
 * however it was cut.
 *
 * Numbers, in four parts:
 * - the spectrum of the boundary as a surface, which is Shape-DNA [RWP06];
 * - the spectrum of the solid, as the shell of its thickness that guards measure (thickness.c), in
 *   units of its own growth: the scale is the surface's, counted once;
 * - views: what is seen from points spread over the pieces (views.c), in units of the cube root of
 *   the shape's volume;
 * - waves: where the surface vibrates (waves.c), as logarithms.
 *
 * Eigenvalues are divided by their place, because they grow in proportion to it (Weyl's law). Those
 * of the surface differ by the root of the mean square, as in Shape-DNA; those of the solid by the
 * mean. Rows of views and waves are quantiles, so that their mean difference is the cost of
 * transporting distributions into each other. Each part is divided by what it is on average between
 * two shapes, and the mean of the four is the distance: a sum of norms of a difference, and so a
 * metric.
 *
 * Cost: a few additions for each number. */
#include <math.h>

#include "core/memory.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "star distance";

enum {
    SURFACE_COUNT = STARG_DESCRIPTOR_SURFACE_EIGENVALUES,
    SOLID_COUNT = STARG_DESCRIPTOR_SOLID_EIGENVALUES,
    VIEWS_COUNT = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
    WAVES_COUNT = STARG_DESCRIPTOR_ENERGIES * STARG_DESCRIPTOR_SPREAD,
    SOLID = SURFACE_COUNT, /* where each part begins */
    VIEWS = SOLID + SOLID_COUNT,
    WAVES = VIEWS + VIEWS_COUNT,
    NUMBERS = WAVES + WAVES_COUNT
};

static const double FAINT = 0.05;    /* what is less than that is about as weak, 1 being average */
static const double LARGEST = 1e100; /* number that is taken for one */

/* Mean differences between two models of the TOSCA set. */
static const double SURFACE_UNIT = 1.21, SOLID_UNIT = 0.0875, VIEWS_UNIT = 0.041,
                    WAVES_UNIT = 0.179;

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

/* What eigenvalues grow by on average from one to the next; never 0. */
static double growth_of(const double *eigenvalues, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += eigenvalues[i] / (double)(i + 1);
    return sum > 0 ? sum / (double)count : 1;
}

static starg_status derive(starg_context *context, const starg_descriptor *d, double **numbers,
                           size_t *count) {
    starg_status status = STARG_OK;
    double *all = NULL, unit = unit_of(d), growth = growth_of(d->solid_spectrum, SOLID_COUNT);
    STARG_NEW(context, STAGE, all, NUMBERS);
    memcpy(all, d->surface_spectrum, sizeof d->surface_spectrum);
    for (size_t i = 0; i < SOLID_COUNT; i++)
        all[SOLID + i] = d->solid_spectrum[i] / growth;
    for (size_t i = 0; i < VIEWS_COUNT; i++)
        all[VIEWS + i] = d->views[i / STARG_DESCRIPTOR_SPREAD][i % STARG_DESCRIPTOR_SPREAD] / unit;
    for (size_t i = 0; i < WAVES_COUNT; i++)
        all[WAVES + i] =
            log(d->waves[i / STARG_DESCRIPTOR_SPREAD][i % STARG_DESCRIPTOR_SPREAD] + FAINT);
    *numbers = all;
    *count = NUMBERS;
done:
    return status;
}

static bool ascends(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(numbers[i] >= (i > 0 ? numbers[i - 1] : 0)))
            return false;
    return true;
}

static bool check(const double *numbers, size_t count) {
    if (count != NUMBERS)
        return false;
    for (size_t i = 0; i < NUMBERS; i++)
        if (!(fabs(numbers[i]) < LARGEST))
            return false;
    return ascends(numbers, SURFACE_COUNT) && ascends(numbers + SOLID, SOLID_COUNT);
}

static double compare_surfaces(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < SURFACE_COUNT; i++) {
        double difference = (a[i] - b[i]) / (double)(i + 1);
        sum += difference * difference;
    }
    return sqrt(sum / SURFACE_COUNT);
}

static double compare_solids(const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < SOLID_COUNT; i++)
        sum += fabs(a[i] - b[i]) / (double)(i + 1);
    return sum / SOLID_COUNT;
}

static double compare_quantiles(const double *a, const double *b, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += fabs(a[i] - b[i]);
    return sum / (double)count;
}

static starg_status compare(starg_context *context, const double *a, size_t a_count,
                            const double *b, size_t b_count, double *out) {
    (void)context, (void)a_count, (void)b_count;
    *out =
        (compare_surfaces(a, b) / SURFACE_UNIT + compare_solids(a + SOLID, b + SOLID) / SOLID_UNIT +
         compare_quantiles(a + VIEWS, b + VIEWS, VIEWS_COUNT) / VIEWS_UNIT +
         compare_quantiles(a + WAVES, b + WAVES, WAVES_COUNT) / WAVES_UNIT) /
        4;
    return STARG_OK;
}

const signature_method signature_star = {
    .name = "star", .version = 3, .derive = derive, .check = check, .compare = compare};
