/* SPDX-License-Identifier: Apache-2.0 */
/* Spectrum of a solid's boundary, and where it vibrates.
 *
 * Problem: numbers that do not change with a shape's pose, its decomposition or noise on its
 * surface: Shape-DNA [RWP06].
 *
 * Stages: the boundary; the smallest eigenvalues of its Laplacian and their eigenfunctions
 * (spectrum.c); the wave kernel signature of both (wks.c).
 *
 * Invariants: eigenvalues are multiplied by the area, hence independent of scale. Cost: that of
 * spectrum.c. */
#include "shape/measures.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "shape/spectrum.h"

static const char STAGE[] = "vibrations";

enum { EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES };

/* All but the first eigenvalue, clamped to at least 0. */
static void keep_behind_zero(double *eigenvalues, double *out) {
    for (size_t i = 0; i <= EIGENVALUES; i++)
        eigenvalues[i] = fmax(eigenvalues[i], 0);
    memcpy(out, eigenvalues + 1, EIGENVALUES * sizeof *out);
}

static starg_status take_surface(starg_context *context, const starg_mesh *surface, double *out,
                                 double *wks) {
    starg_status status = STARG_OK;
    laplacian l = {0};
    double eigenvalues[EIGENVALUES + 1], *functions = NULL;
    STARG_TRY(laplacian_create(context, surface, &l));
    STARG_NEW(context, STAGE, functions, (EIGENVALUES + 1) * l.count);
    STARG_TRY(spectrum_smallest(context, &l, EIGENVALUES + 1, eigenvalues, functions));
    keep_behind_zero(eigenvalues, out);
    STARG_TRY(wks_measure(context, &l, eigenvalues, functions, wks));
done:
    starg_release(context, functions);
    laplacian_free(context, &l);
    return status;
}

starg_status vibrations_measure(starg_context *context, const starg_tetmesh *mesh,
                                const starg_mesh *surface, starg_descriptor *out) {
    starg_status status = STARG_OK;
    starg_mesh *boundary = NULL;
    if (surface == NULL)
        STARG_TRY(starg_tetmesh_surface(context, mesh, &boundary, NULL));
    STARG_TRY(take_surface(context, surface != NULL ? surface : boundary, out->surface_spectrum,
                           &out->wave_kernel[0][0]));
done:
    starg_mesh_free(boundary);
    return status;
}
