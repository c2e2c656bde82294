/* SPDX-License-Identifier: Apache-2.0 */
/* The families of solids in the catalogue. Each takes the wanted number of vertices and comes as
 * close to it as its structure allows. Errors: MEMORY, CANCELLED. */
#ifndef STARG_SAMPLE_SOLIDS_H
#define STARG_SAMPLE_SOLIDS_H

#include "mesh/mesh.h"
#include "sample/figure.h"
#include "sample/ware.h"

/* Articulated figures (figure.h): an isosurface, posed. */
starg_status solid_figure(starg_context *context, figure_kind kind, int pose, size_t vertex_count,
                          starg_mesh **out);

/* Members of a family (ware.h): an isosurface. */
starg_status solid_ware(starg_context *context, ware_kind kind, int member, size_t vertex_count,
                        starg_mesh **out);

/* Vertical prisms over a plan of rectangles (prism.c). */
starg_status solid_l_room(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_gallery(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_labyrinth(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_plate(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Tubes around closed curves (tube.c). */
starg_status solid_torus(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_knot(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Subdivided polyhedra (polyhedron.c). */
starg_status solid_sphere(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_shell(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_star(starg_context *context, size_t vertex_count, starg_mesh **out);

/* Scenes (building.c): shells that touch, open sheets, shells that overlap. */
starg_status solid_office(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_level(starg_context *context, size_t vertex_count, starg_mesh **out);
starg_status solid_statue(starg_context *context, size_t vertex_count, starg_mesh **out);

#endif
