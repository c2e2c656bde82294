/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility by its definition: every segment against every triangle. Doubles with an error bound
 * answer first, then exact_oracle.h. Works on any mesh, including self-intersecting and degenerate
 * ones, whose shells are oriented like those of a solid; a point that is not strictly inside
 * (winding number at least one, off the surface) sees nothing. */
#ifndef TESTS_VISIBILITY_ORACLE_H
#define TESTS_VISIBILITY_ORACLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* visible[v]: does [p, v) meet no triangle? */
void visibility_oracle_vertices(const double *vertices, size_t vertex_count, const uint32_t *faces,
                                size_t face_count, const double p[3], bool *visible);

/* visible[f]: are the three vertices of f visible and is p strictly on its inner side? With
 * `whole`, also: does no triangle have a point in the tetrahedron (p, f) off the face f? */
void visibility_oracle_faces(const double *vertices, size_t vertex_count, const uint32_t *faces,
                             size_t face_count, const double p[3], bool whole, bool *visible);

/* Same from the visible vertices. */
void visibility_oracle_faces_from(const double *vertices, const uint32_t *faces, size_t face_count,
                                  const double p[3], bool whole, const bool *vertex, bool *visible);

#endif
