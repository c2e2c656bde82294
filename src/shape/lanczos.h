/* SPDX-License-Identifier: Apache-2.0 */
/* Largest eigenvalues of a symmetric operator, by the Spectra library. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lanczos_problem {
    size_t count; /* rows of the operator */
    size_t wanted;
    size_t kept; /* vectors of the basis, wanted < kept <= count */
    int restarts;
    double tolerance;
    const double *start; /* count numbers, not all zero */
    /* Sets y to the operator times x; false: stop. Called by this thread only. */
    bool (*apply)(void *shared, const double *x, double *y);
    void *shared;
} lanczos_problem;

typedef enum lanczos_end {
    LANCZOS_FOUND,
    LANCZOS_OPEN,
    LANCZOS_STOPPED,
    LANCZOS_MEMORY
} lanczos_end;

/* `largest`: wanted numbers, descending. `vectors`: NULL, or their vectors, of length 1, one after
 * the other. OPEN: not converged after the restarts. */
lanczos_end lanczos_largest(const lanczos_problem *problem, double *largest, double *vectors);

#ifdef __cplusplus
}
#endif
