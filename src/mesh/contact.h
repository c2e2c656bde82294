/* SPDX-License-Identifier: Apache-2.0 */
/* How two faces of a mesh meet. */
#ifndef STARG_MESH_CONTACT_H
#define STARG_MESH_CONTACT_H

#include "geometry/intersect.h"

#include <stdint.h>

/* Contact of two triangles given by their corners; equal vertices are shared corners. Exact. */
triangle_contact faces_contact(const double *vertices, const uint32_t a[3], const uint32_t b[3]);

#endif
