/* SPDX-License-Identifier: Apache-2.0 */
/* Star decompositions built from cells, with true reports, and files of them. */
#ifndef TESTS_CUT_H
#define TESTS_CUT_H

#include "shapes.h"
#include "starguard/verify.h"

enum { CUT_PIECES = 16, CUT_CONTACTS = 64, CUT_VERTICES = 1200, CUT_TETRAHEDRA = 4000 };

/* A decomposition with spare room for spoiling it. */
typedef struct cut {
    starg_pieces_mesh mesh;
    starg_pieces_report report;
    double vertices[3 * CUT_VERTICES];
    uint32_t tetrahedra[4 * CUT_TETRAHEDRA];
    int32_t labels[CUT_TETRAHEDRA];
    starg_piece pieces[CUT_PIECES];
    starg_piece_contact contacts[CUT_CONTACTS];
} cut;

/* Cells of letters: each letter is a piece, coned from the centre of the cell with its capital. */
typedef struct grid {
    const char *cells;
    int size[3];
} grid;

extern const grid GRID_HALVES, GRID_CORNER, GRID_BEND, GRID_RING, GRID_CAVITY;

/* Cones every piece of a grid from its guard, and recounts. The caller frees it. */
cut *cut_new(const grid *g);
cut *cut_copy(const cut *from);
void cut_assign(cut *to, const cut *from);

/* The surface of the cells as the model. */
shape grid_model(const grid *g);

static inline const double *cut_point(const cut *c, uint32_t vertex) {
    return c->vertices + 3 * (size_t)vertex;
}

/* The index of a point, added if it is new. */
uint32_t cut_add_vertex(cut *c, const double p[3]);
void cut_add_tetrahedron(cut *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e, int32_t label);

enum { CUT_ALL = -1, CUT_FIRST = -2 };

/* Splits the edge between two points at its midpoint: in all of its tetrahedra (CUT_ALL), in one
 * only (CUT_FIRST), or in those of one piece; then recounts. */
void cut_split_middle(cut *c, const double a[3], const double b[3], int32_t where);

/* Recomputes counts, volumes and contacts by comparing all tetrahedra with one another. */
void cut_recount(cut *c);

/* The outward side of a positive tetrahedron opposite one of its corners. */
void cut_side(const cut *c, size_t tetrahedron, int side, uint32_t v[3]);

/* Is the second triangle the reversed first one? */
bool cut_opposite(const uint32_t a[3], const uint32_t b[3]);

/* A file in memory; the caller frees bytes. */
typedef struct cut_file {
    char *bytes;
    size_t size;
} cut_file;

/* PIECES.vtk as text, as doubles or as floats. */
typedef enum coding { TEXT, DOUBLES, FLOATS, CODINGS } coding;

cut_file cut_write_vtk(const starg_pieces_mesh *mesh, coding code);
cut_file cut_write_report(const starg_pieces_report *report);

#endif
