/* SPDX-License-Identifier: Apache-2.0 */
/* Shape-DNA [RWP06]: the beginning of the spectrum of the surface's Laplacian, normalized by area.
 *
 * The numbers are the eigenvalues after the first one, which is 0, in ascending order (further
 * zeros mean further components). Isometric surfaces have the same spectrum, so bending a model
 * changes little; the area removes the scale.
 *
 * Eigenvalues grow roughly in proportion to their index (Weyl's law: by 4 pi each). Spectra are
 * compared by the Euclidean distance of the eigenvalues divided by their index, so that the high
 * ones do not drown the low ones, which describe the coarse shape.
 *
 * Cost: see spectrum.c; about 0.2 s for 5,000 vertices, 8 s for 200,000. */
#include <math.h>

#include "shape/signature_kinds.h"
#include "shape/spectrum.h"

static const char STAGE[] = "shape-dna";

enum { EIGENVALUES = 50 };

static starg_status compute(starg_context *context, const starg_mesh *mesh, double **numbers,
                            size_t *count) {
    SCOPED double *values = NULL;
    SCOPED_BY(laplacian_free) laplacian l = {0};
    TRY(laplacian_create(context, mesh, &l));
    NEW(context, STAGE, values, EIGENVALUES + 1);
    TRY(spectrum_smallest(context, &l, EIGENVALUES + 1, values, NULL));
    memmove(values, values + 1, EIGENVALUES * sizeof *values);
    for (size_t i = 0; i < EIGENVALUES; i++)
        values[i] = fmax(values[i], 0); /* rounding of zeros */
    *numbers = values;
    values = NULL;
    *count = EIGENVALUES;
    return STARG_OK;
}

static bool check(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(numbers[i] >= (i > 0 ? numbers[i - 1] : 0) && isfinite(numbers[i])))
            return false;
    return count == EIGENVALUES;
}

static void weigh(const double *numbers, double *out) {
    for (size_t i = 0; i < EIGENVALUES; i++)
        out[i] = numbers[i] / (double)(i + 1);
}

const signature_method signature_shape_dna = {.name = "shape-dna",
                                              .version = 2,
                                              .compute = compute,
                                              .check = check,
                                              .weigh = weigh,
                                              .count = EIGENVALUES,
                                              .run = 5,
                                              .euclidean = true};
