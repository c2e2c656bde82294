/* The star distance: how far is each guard of one shape from the guard of the other that sees most
 * nearly the same? Unlike the paper's it does not know where guards stand, so that it hardly
 * changes when a shape is posed anew.
 *
 * Numbers: for each guard its mass, the cube root of the volume of its piece by the sum of all such
 * roots (limbs count for more than by their volume, crumbs for less than by their number), and a
 * view that no rotation changes: quantiles of its distances to the boundary, and quantiles of its
 * chords, which are the sums of the distances in opposite directions. Chords hardly depend on where
 * in its piece the guard stands. Both in units of the cube root of the shape's volume, and as
 * logarithms, so that a finger is as unlike an arm as the arm a trunk.
 *
 * The cost of a pair of guards is the mean difference of their views (L1). Each guard goes to the
 * cheapest one of the other shape; the mean cost by mass, averaged over both ways, is the distance.
 * That is optimal transport without its constraint on what arrives [KSKW15], and the better of both
 * relaxations: transport proper was measured to retrieve less well here, because how a trunk is
 * split into pieces changes with the pose, and the masses of its pieces with it.
 *
 * Cost: guards times guards times 32. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "geometry/kd_tree.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "star distance";

enum { QUANTILES = 16, VIEW = 2 * QUANTILES, GUARD = 1 + VIEW };
static const double SMALLEST = 1e-3; /* lengths below that are alike, in units of the shape's */

static int compare_reals(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* For each direction the one that is nearest to its opposite. */
static starg_status find_opposites(starg_context *context, size_t count, size_t *opposite) {
    starg_status status = STARG_OK;
    double *directions = NULL, squared;
    kd_tree tree = {0};
    STARG_NEW(context, STAGE, directions, 3 * count);
    for (size_t i = 0; i < count; i++)
        starg_descriptor_direction(count, i, directions + 3 * i);
    STARG_TRY(kd_tree_create(context, directions, count, 3, &tree));
    for (size_t i = 0; i < count; i++) {
        const double *d = directions + 3 * i, back[3] = {-d[0], -d[1], -d[2]};
        opposite[i] = kd_tree_nearest(&tree, back, &squared);
    }
done:
    kd_tree_free(context, &tree);
    starg_release(context, directions);
    return status;
}

static void put_quantiles(double *lengths, size_t count, double unit, double *out) {
    qsort(lengths, count, sizeof *lengths, compare_reals);
    for (size_t k = 0; k < QUANTILES; k++)
        out[k] = log(lengths[(2 * k + 1) * count / (2 * QUANTILES)] / unit + SMALLEST);
}

/* Cube roots, so that volumes of any shape that has coordinates can be summed. */
static double unit_of(const starg_descriptor *d) {
    double largest = 0, sum = 0;
    for (size_t i = 0; i < d->guard_count; i++)
        largest = fmax(largest, d->guards[i].volume);
    for (size_t i = 0; i < d->guard_count; i++)
        sum += largest > 0 ? d->guards[i].volume / largest : 0;
    return largest > 0 ? cbrt(largest) * cbrt(sum) : fmax(d->diagonal, 1e-300);
}

static void put_masses(const starg_descriptor *d, double *numbers) {
    double sum = 0;
    for (size_t i = 0; i < d->guard_count; i++)
        sum += cbrt(d->guards[i].volume);
    for (size_t i = 0; i < d->guard_count; i++)
        numbers[GUARD * i] = sum > 0 ? cbrt(d->guards[i].volume) / sum : 1 / (double)d->guard_count;
}

static starg_status derive(starg_context *context, const starg_descriptor *d, double **numbers,
                           size_t *count) {
    starg_status status = STARG_OK;
    size_t *opposite = NULL, width = d->direction_count;
    double *all = NULL, *lengths = NULL, unit = unit_of(d);
    STARG_NEW(context, STAGE, all, GUARD * d->guard_count);
    STARG_NEW(context, STAGE, lengths, width);
    STARG_NEW(context, STAGE, opposite, width);
    STARG_TRY(find_opposites(context, width, opposite));
    put_masses(d, all);
    for (size_t i = 0; i < d->guard_count; i++) {
        const double *distances = d->distances + i * width;
        memcpy(lengths, distances, width * sizeof *lengths);
        put_quantiles(lengths, width, unit, all + GUARD * i + 1);
        for (size_t k = 0; k < width; k++)
            lengths[k] = distances[k] + distances[opposite[k]];
        put_quantiles(lengths, width, unit, all + GUARD * i + 1 + QUANTILES);
    }
    *numbers = all;
    *count = GUARD * d->guard_count;
done:
    starg_release(context, lengths);
    starg_release(context, opposite);
    if (status != STARG_OK)
        starg_release(context, all);
    return status;
}

static bool check(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (i % GUARD == 0 ? !(numbers[i] >= 0 && numbers[i] <= 1) : !(fabs(numbers[i]) < 1e3))
            return false;
    return count > 0 && count % GUARD == 0;
}

/* The mean cost of sending a to b. */
static double send(const double *a, size_t a_count, const double *b, size_t b_count) {
    double sum = 0;
    for (size_t i = 0; i < a_count; i += GUARD) {
        double least = INFINITY;
        for (size_t j = 0; j < b_count; j += GUARD) {
            double cost = 0;
            for (size_t k = 1; k < GUARD; k++)
                cost += fabs(a[i + k] - b[j + k]);
            least = fmin(least, cost);
        }
        sum += a[i] * least / VIEW;
    }
    return sum;
}

static starg_status compare(starg_context *context, const double *a, size_t a_count,
                            const double *b, size_t b_count, double *out) {
    (void)context;
    *out = (send(a, a_count, b, b_count) + send(b, b_count, a, a_count)) / 2;
    return STARG_OK;
}

const signature_method signature_star = {
    .name = "star", .version = 1, .derive = derive, .check = check, .compare = compare};
