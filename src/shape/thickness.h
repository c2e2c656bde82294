/* How something would spread on the boundary of a solid, and through the solid. */
#ifndef STARG_SHAPE_THICKNESS_H
#define STARG_SHAPE_THICKNESS_H

#include "shape/rays.h"
#include "starguard/descriptor.h"

/* The smallest eigenvalues behind 0, ascending, times the area: of the surface, and of the shell
 * that stands for the solid; and where the surface vibrates (waves.h). Fills these fields of the
 * descriptor. `surface` is the boundary as it was before pieces cut it up, or NULL. Errors: MESH
 * (no area), SOLVER, MEMORY, CANCELLED. */
starg_status thickness_spectra(starg_context *context, const starg_tetmesh *mesh,
                               const starg_mesh *surface, const ray_caster *caster,
                               starg_descriptor *out);

#endif
