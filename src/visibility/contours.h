/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the contour engine (visibility/contours.c): its tables, and the stages compiled per
 * instruction set. */
#ifndef STARG_VISIBILITY_CONTOURS_H
#define STARG_VISIBILITY_CONTOURS_H

#include "visibility/cube.h"
#include "visibility/scene.h"

/* Suitability of a vertex as the start of a tree edge. */
typedef enum slot_grade {
    SLOT_FRONT, /* all its faces are front-facing */
    SLOT_MIXED, /* on a contour: the layers there must be counted */
    SLOT_BACK   /* no face is front-facing: hidden, and its own tree edge is irrelevant */
} slot_grade;

/* Number of contours that start a new row; padding of piece tables for vector reads. */
enum { ROW_LOAD = 48, PIECE_PADDING = 16 };

/* An edge between a front-facing face, where it runs from a to b, and one that is not
 * front-facing. */
typedef struct contour {
    double normal[3]; /* a x b, relative to p: positive on the front-facing face's side */
    uint32_t a, b;
    uint32_t tested_by; /* the last tree edge compared with it */
} contour;

/* A row of cells: pieces of contours at nearly the same v, divided evenly by the lower end of u. */
typedef struct contour_row {
    float v_low, v_high;
    float u_low, u_high, scale, last_cell; /* of the lower ends */
    float widest;                          /* extent in u of a piece */
    uint32_t first_cell, pieces;
} contour_row;

/* The part of a contour in a row. The ends are those on the whole cube face, NaN if unknown. */
typedef struct contour_piece {
    uint32_t row, label;
    float low, high;      /* of u in the row */
    float from[3], to[3]; /* u, v, nearness */
} contour_piece;

/* A label is the number of the contour plus flags. A plain piece is a whole contour on one cube
 * face, in few rows; a plain piece and a plain tree edge first meet in a row where one of them
 * starts. */
#define PIECE_COUNTS 0x80000000u /* is not plain, or starts in this row */
#define PIECE_PLAIN  0x40000000u
#define PIECE_NUMBER 0x3fffffffu

/* Pieces in the layout of the inner loop, with PIECE_PADDING arbitrary ones behind. */
typedef struct piece_table {
    float *low, *high, *au, *av, *an, *bu, *bv, *bn;
    uint32_t *a, *b, *label; /* a, b: the slots of its ends */
} piece_table;

/* Tree edges are followed in blocks. Segments of CONTOUR_TALL or more rows are followed row by
 * row. */
enum { LINK_BLOCK = 256, CONTOUR_TALL = 8 };

/* Extents of the tree edges of a block, by position in the block. */
typedef struct tree_edge_boxes {
    float u_low[LINK_BLOCK], u_high[LINK_BLOCK], v_low[LINK_BLOCK], v_high[LINK_BLOCK];
    uint32_t row[LINK_BLOCK], last_row[LINK_BLOCK];
    uint32_t plain[LINK_BLOCK]; /* a tree edge on one cube face; otherwise the rest is undefined */
} tree_edge_boxes;

typedef struct row_visit {
    uint32_t tree_edge, row, begin, end; /* position in the block; pieces from begin to end */
    uint32_t others; /* all ones in the first row, where every piece counts; otherwise 0 */
} row_visit;

typedef struct encounter {
    uint32_t to, piece, among;
} encounter;

typedef struct tree_edge_block {
    const uint32_t *to; /* the slots where the tree edges end */
    uint32_t count;
    uint32_t visit_count, encounter_count, end_count;
    tree_edge_boxes boxes;
    row_visit visits[CONTOUR_TALL * LINK_BLOCK + 1];
    encounter encounters[LINK_BLOCK];
    uint32_t ends[2 * LINK_BLOCK][2]; /* a mixed vertex, and the other end of the tree edge */
} tree_edge_block;

struct contours_scratch;

/* All stages for one point. Returns false without a result if the point is in a special position or
 * a table is full. */
typedef bool contours_run(const visibility_scene *scene, struct contours_scratch *s,
                          const double p[3], const int8_t *side, uint8_t *visible);

/* After a successful run: may anything cover a part of the front-facing face, whose three corners
 * are visible? */
typedef bool contours_face_test(const visibility_scene *scene, struct contours_scratch *s,
                                size_t rank);

typedef struct contours_variant {
    contours_run *run;
    contours_face_test *may_cover;
} contours_variant;

typedef struct contours_scratch {
    const contours_variant *variant;
    bool decided; /* the last point was decided by contours */
    const double *p;
    const int8_t *side; /* of that point */
    void *grid;         /* scratch of the grid, for points left undecided */
    cube_directions directions;
    uint8_t *grade;       /* by slot: a slot_grade */
    uint8_t *followed;    /* by slot: is its tree edge followed? */
    uint32_t *parent;     /* by slot: start of its tree edge */
    uint32_t *tree_edges; /* slots whose tree edges are followed, one more than slots */
    size_t tree_edge_count;
    contour *contours;
    uint32_t *contour_edges; /* indices into the adjacency's edges */
    size_t contour_count, contour_limit;
    uint32_t row_of_bin[CUBE_FACES * BINS]; /* by face of the cube, then by bin */
    contour_row *rows;
    size_t row_count, row_limit;
    uint32_t *cell_start; /* cell -> first of its pieces, and the end */
    size_t cell_limit;
    contour_piece *pieces; /* in order of discovery */
    size_t piece_count, piece_limit;
    piece_table sorted; /* by cell */
    int32_t *layers; /* by slot: front-facing layers before it, initially relative to its parent */
    tree_edge_block block; /* current tree edges; too large for a small stack */
} contours_scratch;

/* The stages for each instruction set. */
extern const contours_variant contours_plain;
#if defined(__aarch64__)
extern const contours_variant contours_neon;
#elif defined(__x86_64__)
extern const contours_variant contours_avx2, contours_avx512;
#endif

/* NULL if the processor lacks what the variant needs. */
const contours_variant *contours_choose_variant(visibility_isa wanted);

/* The number of front-facing layers before the vertex, by the BVH. False if the segment from p
 * meets an edge of the front-facing faces. */
bool contours_count_layers(const visibility_scene *scene, const double p[3], const int8_t *side,
                           uint32_t slot, int32_t *layers);

#endif
