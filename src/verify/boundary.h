/* What the two ways to check a boundary share. */
#ifndef STARG_VERIFY_BOUNDARY_H
#define STARG_VERIFY_BOUNDARY_H

#include "verify/pieces.h"

/* How far the rounding of coordinates may move a point of the surface, generously. */
double verify_rounding(const verify_surface *surface);

#endif
