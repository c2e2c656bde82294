/* SPDX-License-Identifier: Apache-2.0 */
/* Independent checks of results with separate, slow and simple arithmetic and algorithms. */
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
    char text[256]; /* what was checked, and what is wrong if it does not hold */
    bool holds;
} starg_claim;

/* Something that a result says and that its verdict does not answer for. */
typedef struct starg_unchecked {
    char text[256]; /* what, and why */
    bool asked;     /* the result was made to have it: a verdict that leaves it open says so */
} starg_unchecked;

typedef struct starg_verdict {
    bool passed; /* every claim holds that was checked */
    size_t count;
    starg_claim *claims;
    size_t not_checked_count;
    starg_unchecked *not_checked;
} starg_verdict;

/* Checks all claims of a guarding result that do not depend on its candidates: counts, every guard
 * strictly inside with its clearance, what each guard sees, the coverage, the uncovered faces, and
 * the consistency of bounds and counts. Claims about candidates are refuted where points just above
 * uncovered faces see them, where fewer guards of the result suffice, or where redundancy is not
 * met; otherwise they are listed in `not_checked`. The mesh is the model as read (inward shells are
 * reversed here as well). Errors: MESH (not closed and oriented), MEMORY, CANCELLED; a false claim
 * is not an error. */
STARG_API starg_status starg_verify_guards(starg_context *context, const starg_mesh *mesh,
                                           const starg_guards *guards, starg_verdict **out);
STARG_API void starg_verdict_free(starg_context *context, starg_verdict *verdict);

/* Why lower_bound_everywhere of guards or lower_bound of pieces holds, as read (docs/formats.md).
 */
typedef struct starg_certificate starg_certificate;

/* Reads a certificate; `name` is used in messages. Errors: FORMAT (with the line), MEMORY,
 * CANCELLED.
 */
STARG_API starg_status starg_certificate_read_memory(starg_context *context, const void *bytes,
                                                     size_t size, const char *name,
                                                     starg_certificate **out);
STARG_API void starg_certificate_free(starg_certificate *certificate);

/* What a certificate is about, to be looked at. A guard that is to be one of `bound` guards that
 * see all witnesses stands, on average, where it sees its share of them: 1 / bound of their prices
 * (of their number if branching proves the bound). Cells are the leaves from which that is not
 * ruled out. */
typedef struct starg_certificate_outline {
    size_t vertex_count, face_count; /* of the model */
    starg_target target;
    size_t bound;
    size_t witness_count;
    uint32_t *witnesses; /* faces or vertices; of corners and points their faces */
    size_t cell_count;
    double *cells; /* cell_count x 6: lower corner, upper corner */
} starg_certificate_outline;

/* Errors: MEMORY, CANCELLED. */
STARG_API starg_status starg_certificate_outline_create(starg_context *context,
                                                        const starg_certificate *certificate,
                                                        starg_certificate_outline **out);
STARG_API void starg_certificate_outline_free(starg_context *context,
                                              starg_certificate_outline *outline);

/* What a check of guards may use beside the model. */
typedef struct starg_guards_evidence {
    const starg_mesh *const *obstacles; /* the meshes that the result names, in its order */
    size_t obstacle_count;
    const starg_mesh *const *zones; /* one for each zone that the result names, NULL for boxes;
                                       NULL: all are boxes */
    const starg_certificate *certificate; /* of lower_bound_everywhere, or NULL: then it is listed
                                             in `not_checked`. Any text may stand in it: a false one
                                             fails, and no solver's word is taken */
    const starg_poses *keep; /* the poses that were given to stay, or NULL: then it is listed in
                                `not_checked` that they are unchanged */
    const char *table, *summary,
        *curve;                      /* names of files of starg_guards_write_table ..., or NULL */
    const starg_face_groups *groups; /* that the tables are by, or NULL */
} starg_guards_evidence;

/* The same with all of it. Errors: also ARGUMENT (other obstacles than those of the result), READ
 * (tables). */
STARG_API starg_status starg_verify_guards_with(starg_context *context, const starg_mesh *mesh,
                                                const starg_guards_evidence *evidence,
                                                const starg_guards *guards, starg_verdict **out);

/* ---- star decompositions ---- */

/* Labelled tetrahedra as read from PIECES.vtk, without any guarantee. */
typedef struct starg_pieces_mesh {
    size_t vertex_count, count;
    double *vertices;     /* vertex_count x 3           */
    uint32_t *tetrahedra; /* count x 4                  */
    int32_t *labels;      /* count: the piece of each   */
    double *corners;      /* count x 4 x 3: images of the corners in balls, or NULL */
} starg_pieces_mesh;

/* The contents of PIECES.json. */
typedef struct starg_pieces_report {
    char *file; /* the model's path as given; NULL if there is none */
    size_t model_vertices, model_faces, model_tetrahedra; /* 0: not given */
    starg_decompose_mode mode;
    size_t tetrahedra;
    size_t piece_count;
    starg_piece *pieces; /* a radius or margin that is no number: not told */
    size_t contact_count;
    starg_piece_contact *contacts;
    size_t strictly_star;
    double visible_vertices;
    bool approximated;    /* the boundary only approximates the model's surface; then: */
    double distance;      /* largest distance from the boundary to the model's surface */
    double distance_back; /* and back; infinite if not given */
    double flattest;      /* least height over longest edge of a tetrahedron; 0: not given */
    double smallest_angle, median_angle, smallest_angle_made; /* degrees; 0: not given */
    size_t lower_bound; /* no fewer star-shaped pieces make up the model; 0: not given   */
    bool optimal;       /* as many pieces as lower_bound; only with it                   */
    /* Maps to balls; the rest only if there are any. */
    bool balls;
    double ball_worst, ball_mean, ball_above_10;
} starg_pieces_report;

/* Reads PIECES.vtk as it stands: a legacy VTK unstructured grid of tetrahedra with the integers
 * `piece` (docs/formats.md), text or binary; `name` is used in messages. Errors: FORMAT
 * (with line or byte, or the tetrahedron), RANGE (with the vertex), MEMORY, CANCELLED. */
STARG_API starg_status starg_pieces_mesh_read_memory(starg_context *context, const void *bytes,
                                                     size_t size, const char *name,
                                                     starg_pieces_mesh **out);
STARG_API void starg_pieces_mesh_free(starg_context *context, starg_pieces_mesh *mesh);

/* Reads PIECES.json. Errors: FORMAT, MEMORY. */
STARG_API starg_status starg_pieces_report_read_memory(starg_context *context, const void *bytes,
                                                       size_t size, const char *name,
                                                       starg_pieces_report **out);
STARG_API void starg_pieces_report_free(starg_context *context, starg_pieces_report *report);

/* Checks all claims of a decomposition: tetrahedra are positive, conforming and labelled, pieces
 * are connected, boundary and volume match the model, nothing overlaps; and, with a report (may be
 * NULL), its numbers, and for each piece called star-shaped the exact certificate. Visibility from
 * guards is checked for all vertices, or for a random sample of 20,000. The mesh is the model as
 * read (inward shells are reversed here as well). Errors: ARGUMENT (an index out of range, more
 * than 2^29 tetrahedra), RANGE, MESH (the model is not closed and oriented), MEMORY, CANCELLED; a
 * false claim is not an error. */
STARG_API starg_status starg_verify_pieces(starg_context *context, const starg_mesh *model,
                                           const starg_pieces_mesh *pieces,
                                           const starg_pieces_report *report, starg_verdict **out);

/* The same with the certificate of lower_bound (or NULL: then it is listed in `not_checked`). Any
 * text may stand in it: a false one fails, and no solver's word is taken. */
STARG_API starg_status starg_verify_pieces_with(starg_context *context, const starg_mesh *model,
                                                const starg_certificate *certificate,
                                                const starg_pieces_mesh *pieces,
                                                const starg_pieces_report *report,
                                                starg_verdict **out);

/* The same for a tetrahedral model, against its boundary. */
STARG_API starg_status starg_verify_pieces_of_tetmesh(starg_context *context,
                                                      const starg_tetmesh *model,
                                                      const starg_pieces_mesh *pieces,
                                                      const starg_pieces_report *report,
                                                      starg_verdict **out);

/* ---- maps and morphs ---- */

/* MAP.json as read, without any guarantee (docs/formats.md). */
typedef struct starg_map_file starg_map_file;

/* Reads MAP.json with a separate reader; `name` is used in messages. Errors: FORMAT, MEMORY. */
STARG_API starg_status starg_map_file_read_memory(starg_context *context, const void *bytes,
                                                  size_t size, const char *name,
                                                  starg_map_file **out);
STARG_API void starg_map_file_free(starg_map_file *file);

/* Checks a map from A to B: counts, that its directions or its overlay make it a bijection,
 * exactly, that points are where these have them, landmarks, and distortion. What a file without
 * either does not say is listed in `not_checked`. The meshes are the models as read. Errors: MESH
 * (not closed and oriented), MEMORY, CANCELLED; a false claim is not an error. */
STARG_API starg_status starg_verify_map(starg_context *context, const starg_mesh *a,
                                        const starg_mesh *b, const starg_map_file *file,
                                        starg_verdict **out);

/* The report of a morph as read, without any guarantee (docs/formats.md). */
typedef struct starg_morph_report starg_morph_report;

/* Errors: FORMAT, MEMORY. */
STARG_API starg_status starg_morph_report_read_memory(starg_context *context, const void *bytes,
                                                      size_t size, const char *name,
                                                      starg_morph_report **out);
STARG_API void starg_morph_report_free(starg_morph_report *report);

/* Checks the frames of a morph, at least two: they have the same faces; the first is A, or A
 * subdivided in its faces; the last is B, or B subdivided, or has its vertices on B if the first is
 * A itself; and, with a report (may be NULL), each frame has the crossings, volume, area and drifts
 * that are reported. Errors: ARGUMENT, MESH, MEMORY, CANCELLED; a false claim is not an error. */
STARG_API starg_status starg_verify_morph(starg_context *context, const starg_mesh *a,
                                          const starg_mesh *b, const starg_mesh *const *frames,
                                          size_t frame_count, const starg_morph_report *report,
                                          starg_verdict **out);

/* ---- maps between solids ---- */

/* A piecewise linear map from one solid to another: tetrahedra with their corners in A and in B.
 * Made by starg_solid_map_create and the like (solidmap.h), which guarantee that all are positive
 * in both, or read from MAP.vtu, without any guarantee. */
typedef struct starg_solid_map {
    size_t vertex_count, count;
    double *vertices;     /* vertex_count x 3: in A */
    double *images;       /* vertex_count x 3: in B */
    uint32_t *tetrahedra; /* count x 4 */
    /* Pieces that are star-shaped in A and in B, about a guard in each. */
    int32_t *labels; /* count: the piece of each tetrahedron */
    size_t piece_count;
    double *guards, *guard_images; /* piece_count x 3 */
    /* Largest over smallest singular value of a tetrahedron's map: the largest of all, the mean
     * weighted by volume in A, and the share of that volume where it is above 10. */
    double worst, mean, above_10;
    /* Where A's surface folds in B, its image is only near to B in A's faces: how many vertices of
     * the surface are off that, and how far the farthest is, in diagonals. 0 if read from a file:
     * the check tells. */
    size_t strayed;
    double farthest;
    /* Where it ends at B in A's faces, and not at B (starg_solid_map_compare): no point of the
     * image's surface is farther from B's surface than `distance`, none of B's than `distance_back`
     * from the image's, and B has `missing` more volume than the image. */
    bool compared;
    double distance, distance_back, missing;
    /* What a file says beside that, for the check; NULL and 0 if made. */
    double *ratios;   /* count: of each tetrahedron; or NULL                                  */
    size_t misplaced; /* offsets that are not 4, 8, 12, ...; the first is of `first_misplaced` */
    size_t first_misplaced;
    /* Of a morph: where the vertices are at times between 0 and 1, key_count x vertex_count x 3.
     * They move straight from A's places through these to B's, and every tetrahedron is positive at
     * every time. */
    size_t key_count;
    double *times, *keys;
} starg_solid_map;

/* Reads MAP.vtu with a separate reader: a VTK XML unstructured grid of tetrahedra with numbers as
 * text (docs/formats.md); `name` is used in messages. Errors: FORMAT (with the line), RANGE (with
 * the vertex), MEMORY, CANCELLED. */
STARG_API starg_status starg_solid_map_read_memory(starg_context *context, const void *bytes,
                                                   size_t size, const char *name,
                                                   starg_solid_map **out);
STARG_API void starg_solid_map_free(starg_context *context, starg_solid_map *map);

/* Checks that a map takes the solid A to the solid B: the tetrahedra are positive and conforming in
 * both, their boundary is the surface of A there and that of B here, each covered once, so that
 * they fill both without overlap and the map is a homeomorphism; the pieces are star-shaped about
 * their guards in both, and the distortion is as stated. Models are taken as read (inward shells
 * are reversed). B may be NULL: then A's vertices go to the sphere of radius 1 or to the surface of
 * the cube of edge 2, about the origin, and A's faces with these corners are B. Where a map tells
 * how far its end is from B, that is checked instead of the same surface. Errors: ARGUMENT (an
 * index out of range), RANGE, MESH (a model is not closed and oriented), MEMORY, CANCELLED; a false
 * claim is not an error. */
STARG_API starg_status starg_verify_solid_map(starg_context *context, const starg_mesh *a,
                                              const starg_mesh *b, const starg_solid_map *map,
                                              starg_verdict **out);

/* ---- files of results ---- */

/* One of these is set. */
typedef struct starg_result {
    starg_guards *guards;
    starg_pieces_mesh *pieces;
    starg_pieces_report *report;
    starg_certificate *certificate;
    starg_map_file *map;
    starg_morph_report *morph;
    starg_solid_map *solid_map;
} starg_result;

/* Reads GUARDS.json, a certificate, PIECES.vtk, PIECES.json, MAP.json, MAP.vtu or the report of a
 * morph, recognized by content. "-" is standard input. Errors: READ, and those of the readers. */
STARG_API starg_status starg_result_read(starg_context *context, const char *path,
                                         starg_result **out);
STARG_API void starg_result_free(starg_context *context, starg_result *result);

#ifdef __cplusplus
}
#endif

#endif
