/* SPDX-License-Identifier: Apache-2.0 */
/* Small closed meshes for tests. Faces are counter-clockwise seen from outside. */
#ifndef TESTS_SHAPES_H
#define TESTS_SHAPES_H

#include <stddef.h>
#include <stdint.h>

typedef struct shape {
    size_t vertex_count, face_count;
    double *vertices;
    uint32_t *faces;
} shape;

/* The surface of nx x ny x nz unit cells, where cells[x + nx * (y + ny * z)] == '#' are solid: two
 * triangles per cell side, shared integer vertices. */
shape shape_cells(const char *cells, int nx, int ny, int nz);

/* Named shapes, all but the blob on a lattice. */
shape shape_tetrahedron(void);
shape shape_cube(int sides); /* sides^3 cells */
shape shape_room(void);      /* an L of cells, one cell high */
shape shape_cavity(void);    /* 3 x 3 x 3 cells without the middle one */
shape shape_columns(void);   /* a hall of 5 x 5 x 2 with columns */
shape shape_heap(int width,
                 uint64_t seed); /* random walk of width x width x 2 cells: reflex edges */
shape shape_blob(int levels,
                 uint64_t seed); /* a sphere with random radii: star-shaped about the origin */

/* Adds a translated copy of `other`; `turned` swaps its inside and outside. */
void shape_append(shape *out, const shape *other, const double offset[3], int turned);

/* Two shells that intersect and lie within one another in part: a room and a cube, or two blobs. */
enum { OVERLAPS = 8 };
shape shape_overlap(int number);

/* Multiplies by a scale, then adds the offset to every coordinate. */
void shape_place(shape *out, double scale, double offset);

void shape_free(shape *s);

#endif
