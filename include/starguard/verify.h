/* SPDX-License-Identifier: Apache-2.0 */
/* Independent checks of results: arithmetic and algorithms of their own, slow and simple. */
#ifndef STARGUARD_VERIFY_H
#define STARGUARD_VERIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "decompose.h"
#include "guard.h"
#include "mesh.h"
#include "tetra.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One claim that was checked. */
typedef struct starg_claim {
    char text[256]; /* what was checked, and what was found where it does not hold */
    bool holds;
} starg_claim;

/* Something that a result says and that its verdict does not answer for. */
typedef struct starg_unchecked {
    char text[256]; /* what, and why */
} starg_unchecked;

typedef struct starg_verdict {
    bool passed; /* every claim holds that was checked */
    size_t count;
    starg_claim *claims;
    size_t not_checked_count;
    starg_unchecked *not_checked;
} starg_verdict;

/* Checks everything that a guards result claims about a mesh and that can be checked without its
 * candidates: counts, every guard strictly inside with its clearance, what each guard sees, the
 * coverage, the uncovered faces, and that bounds and counts are consistent. What the result says of
 * candidates is refuted where points just above unseen faces see them, where fewer guards of the
 * result would do, or where redundancy is far from kept; else it is `not_checked`. The mesh is the
 * model as read (inward shells are turned here as well).
 * Errors: MESH (not closed and oriented), MEMORY, CANCELLED; a claim that fails is no error. */
STARG_API starg_status starg_verify_guards(starg_context *context, const starg_mesh *mesh,
                                           const starg_guards *guards, starg_verdict **out);
STARG_API void starg_verdict_free(starg_context *context, starg_verdict *verdict);

/* ---- star decompositions ---- */

/* Labelled tetrahedra as they stand in PIECES.vtk; nothing about them is taken for granted. */
typedef struct starg_pieces_mesh {
    size_t vertex_count, count;
    double *vertices;     /* vertex_count x 3           */
    uint32_t *tetrahedra; /* count x 4                  */
    int32_t *labels;      /* count: the piece of each   */
} starg_pieces_mesh;

/* What PIECES.json says about them. */
typedef struct starg_pieces_report {
    char *file; /* the model's path as given; NULL if there is none */
    starg_decompose_mode mode;
    size_t tetrahedra;
    size_t piece_count;
    starg_piece *pieces; /* a radius that is no number: not told */
    size_t contact_count;
    starg_piece_contact *contacts;
    size_t strictly_star;
    double visible_vertices;
    bool approximated;    /* the boundary is near the model's surface only; then: */
    double distance;      /* no point of the boundary is farther from the model's surface ...   */
    double distance_back; /* ... and no point of the surface from it; infinite when not told    */
    double flattest;      /* least height over longest edge of a tetrahedron; 0: not told         */
} starg_pieces_report;

/* Reads PIECES.vtk with code of its own: a legacy VTK unstructured grid of tetrahedra with the
 * integers `piece` (docs/formats.md), text or binary; `name` is used in messages.
 * Errors: FORMAT (with line or byte, or the tetrahedron), RANGE (with the vertex), MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_pieces_mesh_read_memory(starg_context *context, const void *bytes,
                                                     size_t size, const char *name,
                                                     starg_pieces_mesh **out);
STARG_API void starg_pieces_mesh_free(starg_context *context, starg_pieces_mesh *mesh);

/* Reads PIECES.json. Errors: FORMAT, MEMORY. */
STARG_API starg_status starg_pieces_report_read_memory(starg_context *context, const void *bytes,
                                                       size_t size, const char *name,
                                                       starg_pieces_report **out);
STARG_API void starg_pieces_report_free(starg_context *context, starg_pieces_report *report);

/* Checks all that a decomposition claims about a model: tetrahedra positive, conforming and
 * labelled, pieces connected, boundary and volume those of the model, no overlap; and, with a
 * report (NULL: none), its numbers, and for each piece that is called star-shaped the certificate,
 * exactly. What a piece's guard sees is found for all vertices, or for 20,000 drawn at random.
 * The mesh is the model as read (inward shells are turned here as well).
 * Errors: ARGUMENT (an index out of range, more than 2^29 tetrahedra), RANGE, MESH (the model is
 * not closed and oriented), MEMORY, CANCELLED; a claim that fails is no error. */
STARG_API starg_status starg_verify_pieces(starg_context *context, const starg_mesh *model,
                                           const starg_pieces_mesh *pieces,
                                           const starg_pieces_report *report, starg_verdict **out);

/* The same where the model is a tetrahedral mesh: against its boundary. */
STARG_API starg_status starg_verify_pieces_of_tetmesh(starg_context *context,
                                                      const starg_tetmesh *model,
                                                      const starg_pieces_mesh *pieces,
                                                      const starg_pieces_report *report,
                                                      starg_verdict **out);

/* ---- files of results ---- */

/* One of these is set. */
typedef struct starg_result {
    starg_guards *guards;
    starg_pieces_mesh *pieces;
    starg_pieces_report *report;
} starg_result;

/* Reads GUARDS.json, PIECES.vtk or PIECES.json; the content tells which. "-" is standard input.
 * Errors: READ, and those of the readers. */
STARG_API starg_status starg_result_read(starg_context *context, const char *path,
                                         starg_result **out);
STARG_API void starg_result_free(starg_context *context, starg_result *result);

#ifdef __cplusplus
}
#endif

#endif
