/* SPDX-License-Identifier: Apache-2.0 */
/* Star decomposition: cuts a solid into few pieces, each wholly visible from its guard. */
#ifndef STARGUARD_DECOMPOSE_H
#define STARGUARD_DECOMPOSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "solid.h"
#include "tetra.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_decompose_mode {
    STARG_DECOMPOSE_STRICT = 0, /* every piece is proven to be star-shaped          */
    STARG_DECOMPOSE_PAPER = 1   /* section 4 of [YL11]: pieces are nearly star-shaped */
} starg_decompose_mode;

/* One piece. Its guard is strictly inside its kernel whenever `star` is true: strictly on the inner
 * side of each face of the piece's boundary, which winds around the guard once (both exact). */
typedef struct starg_piece {
    double guard[3];
    double radius; /* distance of the guard to the nearest plane of a boundary face, negative where
                      it is behind that plane; rounded */
    size_t tetrahedra;
    double volume;
    bool star;
} starg_piece;

/* Two pieces that share faces. */
typedef struct starg_piece_contact {
    uint32_t first, second; /* first < second */
    double area;
} starg_piece_contact;

/* A solid in pieces. Every tetrahedron belongs to one piece, none is empty. */
typedef struct starg_decomposition {
    char *file; /* the model's path in the report that was read; else NULL */
    starg_decompose_mode mode;
    /* Size of the model that was cut: a surface (no tetrahedra) or a tetrahedral mesh (no faces).
     */
    size_t model_vertices, model_faces, model_tetrahedra;
    starg_tetra_report tetra; /* how the model was filled; given tetrahedra keep the surface. Of
                                 what was read: whether it was kept, and distances */
    starg_tetmesh *mesh;
    size_t tetrahedra; /* of the mesh */
    int32_t *labels;   /* one per tetrahedron: its piece */
    size_t piece_count;
    starg_piece *pieces;
    size_t contact_count;
    starg_piece_contact *contacts; /* ascending; the guarding graph's edges */
    size_t strictly_star;          /* pieces that are star-shaped, proven */
    double visible_vertices; /* fraction of the vertices of tetrahedra that the guard of each piece
                                that they belong to sees (counted once per piece) */
    double flattest; /* least height over longest edge of a tetrahedron (0.816: the regular one) */
    double flattest_given; /* the same for the tetrahedra to begin with */
    bool time_limited;     /* the time limit cut the search short: another run may differ */
} starg_decomposition;

/* A density of tetrahedra that leaves the choice to the mode: few for STRICT, which makes its own
 * in the end, and that of [YL11] for PAPER. */
#define STARG_DECOMPOSE_DENSITY (-1.0)

typedef struct starg_decompose_options {
    starg_decompose_mode mode;
    starg_tetra_options tetra; /* how tetrahedra are made */
    /* STRICT: the search ends when there are no more than that. PAPER: no more than that, at the
     * cost of vertices that their guards do not see (but one for each part of the model).
     * 0: as few as can be found. */
    size_t max_pieces;
    const double *guards; /* guard_count x 3, or NULL. PAPER: to grow from; NULL: those of
                             starg_guard. STRICT: points that are tried as guards first */
    size_t guard_count;
    /* STRICT: trials after which the search ends. 0: a fixed amount of work, the same on every
     * machine and at any number of threads; no bound where the context has a time limit */
    uint64_t effort;
    /* starg_decompose_open_mesh: fill the surface even where what it winds around is far from it */
    bool fill;
} starg_decompose_options;

/* STRICT, tetrahedra as they come, as few pieces as can be found. */
STARG_API void starg_decompose_options_default(starg_decompose_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_decompose_options_fields(void);

/* Cuts a solid; its tetrahedra are made as the options say. The search stops at the time limit of
 * the context with the best that it has. `options` may be NULL.
 * Errors: ARGUMENT, SOLVER (no tetrahedra could be made), MEMORY, CANCELLED, TIME (with nothing
 * valid yet). */
STARG_API starg_status starg_decompose(starg_context *context, const starg_solid *solid,
                                       const starg_decompose_options *options,
                                       starg_decomposition **out);

/* Cuts what a tetrahedral mesh fills. STRICT gives tetrahedra of its own in return, whose boundary
 * is that of the mesh, possibly subdivided; PAPER labels those of the mesh (a copy). Errors: as of
 * starg_decompose, and MESH (STRICT: a tetrahedron so thin that no point is found in it). */
STARG_API starg_status starg_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                               const starg_decompose_options *options,
                                               starg_decomposition **out);

/* How far the surface of what a mesh with holes winds around may be from the mesh, either way, as a
 * fraction of the diagonal of its box, unless `fill` is said. */
#define STARG_DECOMPOSE_FILL_MOST 0.2

/* Cuts what a mesh with holes winds around (starg_tetmesh_from_open_mesh). Errors: as of
 * starg_decompose, and MESH, also when that is farther from the mesh than it may be. */
STARG_API starg_status starg_decompose_open_mesh(starg_context *context, const starg_mesh *surface,
                                                 const starg_decompose_options *options,
                                                 starg_decomposition **out);
STARG_API void starg_decomposition_free(starg_context *context, starg_decomposition *decomposition);

/* The closed outward surface of each piece, one after the other in one mesh, each with vertices of
 * its own, which follow one another likewise: `first_face` receives piece_count + 1 face numbers
 * (free with starg_tetmesh_map_free). Errors: ARGUMENT (more faces than can be numbered), MEMORY.
 */
STARG_API starg_status starg_decomposition_surfaces(starg_context *context,
                                                    const starg_decomposition *decomposition,
                                                    starg_mesh **out, uint32_t **first_face);

/* Writes the surfaces of all pieces as OBJ, a group for each: "g piece_0000" and so on. Errors:
 * ARGUMENT, WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_decomposition_write_groups(starg_context *context,
                                                        const starg_decomposition *decomposition,
                                                        const char *path);

/* Writes PIECES.vtk (docs/formats.md). "-" is standard output. Errors: WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_decomposition_write(starg_context *context,
                                                 const starg_decomposition *decomposition,
                                                 const char *path, bool binary);

/* Writes PIECES.json; `model_file` is stored as the model's path, NULL leaves it empty. */
STARG_API starg_status starg_decomposition_write_report(starg_context *context,
                                                        const starg_decomposition *decomposition,
                                                        const char *model_file, const char *path);

/* The same in memory, with one zero byte behind the end. Free with starg_text_free. Errors: MEMORY.
 */
STARG_API starg_status starg_decomposition_write_report_memory(
    starg_context *context, const starg_decomposition *decomposition, const char *model_file,
    char **text, size_t *size);

/* Reads both files back: writing the result gives the same bytes. Errors: READ, FORMAT (also where
 * the files are not of one decomposition), MEMORY, CANCELLED, and those of starg_tetmesh_read. */
STARG_API starg_status starg_decomposition_read(starg_context *context, const char *pieces_path,
                                                const char *report_path, starg_decomposition **out);

/* The same from memory; names are used in messages. */
typedef struct starg_file_bytes {
    const void *bytes;
    size_t size;
    const char *name;
} starg_file_bytes;
STARG_API starg_status starg_decomposition_read_memory(starg_context *context,
                                                       const starg_file_bytes *pieces,
                                                       const starg_file_bytes *report,
                                                       starg_decomposition **out);

#ifdef __cplusplus
}
#endif

#endif
