/* Samples of a surface that their own Delaunay tetrahedra follow. */
#ifndef STARG_SKELETON_CONFORM_H
#define STARG_SKELETON_CONFORM_H

#include "geometry/delaunay.h"
#include "skeleton/samples.h"

typedef struct conform_report {
    size_t rounds, flips, added; /* edges turned, points inserted                     */
    size_t lost;                 /* faces that are no faces of tetrahedra in the end  */
} conform_report;

/* How points are added; no way does best on all meshes. The first is the one to try first. */
typedef enum conform_manner {
    CONFORM_BISECT = 0,        /* longest-edge bisection of lost faces, no folds flipped     */
    CONFORM_PIERCE = 1,        /* in the middle of lost edges, and where faces are pierced   */
    CONFORM_BISECT_UNFOLD = 2, /* the same, with folds                                       */
    CONFORM_MANNERS = 3
} conform_manner;

/* Changes the samples, a closed manifold mesh, until each of its faces is a face of the Delaunay
 * tetrahedra of its points or the work is over. Errors: MEMORY, CANCELLED. */
starg_status conform_samples(starg_context *context, surface_samples *samples,
                             conform_manner manner, delaunay **tetrahedra, conform_report *report);

#endif
