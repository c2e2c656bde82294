/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between solids: one set of tetrahedra, positive in both. The map itself, starg_solid_map, is
 * declared in verify.h with its reader and its check. */
#ifndef STARGUARD_SOLIDMAP_H
#define STARGUARD_SOLIDMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "morph.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_solid_map_options {
    size_t steps;   /* of descent in each solid, to lower the distortion, in proportion fewer for
                     * more than 10,000 tetrahedra; 0: none */
    double density; /* initial tetrahedra per vertex of A's surface */
} starg_solid_map_options;

/* 400 steps, density 1. */
STARG_API void starg_solid_map_options_default(starg_solid_map_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_solid_map_options_fields(void);

/* Maps the solid A to the solid whose surface has A's faces and its vertices at `images`
 * (vertex_count x 3), of any genus. TetGen fills A and keeps its surface; inner vertices then take
 * places in both solids such that every tetrahedron is positive in both, exactly. Since its
 * boundary is the surface of either, the map is a homeomorphism. Where the images meet themselves
 * or fold too much for that, as between different animals, vertices of the surface stand elsewhere
 * on it, or, as few as possible, near it (`strayed`, `farthest`): by 2 % of the diagonal at most.
 * `options` may be NULL. Errors: ARGUMENT, RANGE, MESH (an end is no solid, A meets itself;
 * tetrahedra cannot be made positive: how many; the image is farther off, or meets itself), SOLVER
 * (no TetGen), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_solid_map_create(starg_context *context, const starg_mesh *a,
                                              const double *images,
                                              const starg_solid_map_options *options,
                                              starg_solid_map **out);

/* Maps the solid A to the solid B by a map of their surfaces that has an overlay
 * (starg_map_overlay): the surface of the tetrahedra is A and B, subdivided in their faces. Where
 * no pieces are found along a map via the sphere without landmarks, another one takes its place,
 * by the limbs of both. What is left is A's tetrahedra, which go to B in A's connectivity first,
 * which may meet itself, and are then divided along the overlay. `options` may be NULL. Errors: as
 * above, and ARGUMENT (no overlay), MESH (parts of the overlay that are too thin for doubles). */
STARG_API starg_status starg_solid_map_overlay(starg_context *context, const starg_mesh *a,
                                               const starg_mesh *b, const starg_map *map,
                                               const starg_solid_map_options *options,
                                               starg_solid_map **out);

/* Measures how far the end of a map is from B: distances either way, and the volume that is missed,
 * which the map then tells (starg_solid_map). Errors: MEMORY, CANCELLED. */
STARG_API starg_status starg_solid_map_compare(starg_context *context, const starg_mesh *b,
                                               starg_solid_map *map);

typedef enum starg_solid_shape {
    STARG_SOLID_BALL = 0, /* of radius 1 about the origin */
    STARG_SOLID_CUBE = 1  /* of edge 2 about the origin */
} starg_solid_shape;

/* Maps the solid A, whose surface is connected and of genus 0, to a polyhedron inscribed in a ball
 * or a cube: every vertex of A's surface has its image on the ball's sphere (up to rounding) or on
 * the cube's surface, exactly; faces across an edge of the cube cut it off. `options` may be NULL.
 * Errors: ARGUMENT, MESH (also: not connected, another genus), SOLVER (no TetGen; too uneven for
 * the sphere), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_solid_map_to(starg_context *context, const starg_mesh *a,
                                          starg_solid_shape shape,
                                          const starg_solid_map_options *options,
                                          starg_solid_map **out);

/* The map of a morph of method solid, with its keys. Errors: ARGUMENT (another method), MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_morph_solid_map(const starg_morph *morph, starg_solid_map **out);

/* ---- fields ---- */

/* Points, and the values of a field there. */
typedef struct starg_samples {
    size_t count;
    size_t width;   /* of values at a point: 0, 1 (numbers, labels) or 3 (vectors) */
    double *points; /* count x 3 */
    double *values; /* count x width */
} starg_samples;

/* Reads a text with a point per line: x y z, x y z value, or x y z u v w; '#' begins a comment.
 * Errors: READ, FORMAT (with the line), MEMORY. */
STARG_API starg_status starg_samples_read(starg_context *context, const char *path,
                                          starg_samples **out);
/* Writes such a text. "-" is standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_samples_write(starg_context *context, const starg_samples *samples,
                                           const char *path);
STARG_API void starg_samples_free(starg_context *context, starg_samples *samples);

/* Carries points and values from A to B, or with `back` from B to A. Each point is found in a
 * tetrahedron by exact tests, and goes along linearly; numbers stay, vectors are multiplied by the
 * Jacobian there. Errors: MESH (points outside: which), MEMORY, CANCELLED. */
STARG_API starg_status starg_solid_map_carry(starg_context *context, const starg_solid_map *map,
                                             const starg_samples *samples, bool back,
                                             starg_samples **out);

/* ---- files ---- */

/* Writes MAP.vtu (docs/formats.md). "-" is standard output. Errors: WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_solid_map_write(starg_context *context, const starg_solid_map *map,
                                             const char *path);

#ifdef __cplusplus
}
#endif

#endif
