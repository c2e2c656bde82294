/* SPDX-License-Identifier: Apache-2.0 */
/* Straight lines on a triangulated surface. */
#pragma once

#include "mesh/topology.h"

/* A point of a surface: barycentric coordinates in a face, each at least 0, summing to 1. */
typedef struct surface_point {
    uint32_t face;
    double coordinates[3];
} surface_point;

/* Its place in space. */
void surface_place(const starg_mesh *mesh, const surface_point *point, double out[3]);

/* The gradient, in the point's face, of a function with these slopes along the three coordinates;
 * false for a zero-area face. */
bool surface_gradient(const starg_mesh *mesh, const surface_point *point, const double slopes[3],
                      double out[3]);

/* Moves a point by a vector in its face's plane, unfolded over the edges it crosses; stops at a
 * zero-area face, at a border, and after a great many faces. */
void surface_walk(const starg_mesh *mesh, const mesh_topology *topology, const double step[3],
                  surface_point *point);
