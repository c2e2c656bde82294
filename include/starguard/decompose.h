/* SPDX-License-Identifier: Apache-2.0 */
/* Star decomposition: cuts a solid into few pieces, each entirely visible from its guard. */
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
    STARG_DECOMPOSE_STRICT = 0, /* every piece is proven star-shaped */
    STARG_DECOMPOSE_PAPER = 1   /* section 4 of [YL11]: pieces are nearly star-shaped */
} starg_decompose_mode;

/* Which ball each piece is mapped to. */
typedef enum starg_balls {
    STARG_BALLS_NONE = 0,
    STARG_BALLS_RAYS = 1, /* along the rays from the guard */
    STARG_BALLS_EVEN = 2  /* faces get shares of the sphere nearer to those of the surface */
} starg_balls;

/* Default density of initial tetrahedra: that of [YL11] for PAPER, and low for STRICT, which needs
 * them only where the surface is not embedded. */
#define STARG_DECOMPOSE_DENSITY (-1.0)

typedef struct starg_decompose_options {
    starg_decompose_mode mode;
    starg_tetra_options tetra; /* how to tetrahedralize, where that is needed */
    /* STRICT: stop the search at this number of pieces. PAPER: at most this number, at the cost of
     * visibility (but one for each component). 0: as few as possible. */
    size_t max_pieces;
    const double *guards; /* guard_count x 3, or NULL. PAPER: seeds of the pieces; NULL: those of
                             starg_guard. STRICT: tried as guards, too */
    size_t guard_count;
    /* STRICT: STARG_EFFORT_QUICK, _NORMAL or _BEST (starguard/fields.h), a fixed amount of work
     * each, the same on every machine and for any number of threads, but unlimited if the context
     * has a time limit; or the number of trials of the search. 0: normal */
    uint64_t effort;
    /* starg_decompose_open_mesh: fill the surface even if the filled volume is far from it */
    bool fill;
    /* STRICT: spend more on guards away from the planes of their pieces' faces, and so on the
     * angles of tetrahedra */
    bool quality;
    /* STRICT, embedded surfaces: prove first how few star-shaped pieces can make up the solid,
     * however it is cut (lower_bound), in half of the time that the context allows; the search then
     * ends as soon as there are no more */
    bool prove;
    uint64_t prove_work; /* budget, in tests of a vertex against a box (about a microsecond each) */
    starg_balls balls;   /* STRICT: map each piece to a ball */
} starg_decompose_options;

/* One piece. If `star` is true, its guard is strictly inside its kernel, by exact tests: strictly
 * on the inner side of each boundary face, and the boundary winds around it once. */
typedef struct starg_piece {
    double guard[3];
    double radius; /* distance from the guard to the nearest plane of a boundary face, negative
                      behind it; rounded */
    double margin; /* the same by the diagonal of the piece's bounding box; -DBL_MAX: not told */
    size_t tetrahedra;
    double volume;
    bool star;
    bool spread; /* its map to the ball leaves the rays: rounding would turn a tetrahedron over, or
                    EVEN was wanted */
} starg_piece;

/* Two pieces that share faces. */
typedef struct starg_piece_contact {
    uint32_t first, second; /* first < second */
    double area;
} starg_piece_contact;

/* A partitioned solid. Every tetrahedron belongs to one piece; no piece is empty. */
typedef struct starg_decomposition {
    char *file; /* the model's path if read from a report; else NULL */
    starg_decompose_mode mode;
    /* Size of the model: a surface (no tetrahedra) or a tetrahedral mesh (no faces). */
    size_t model_vertices, model_faces, model_tetrahedra;
    starg_tetra_report tetra; /* how the model was filled; given tetrahedra, and pieces made from
                                 the surface alone, preserve the surface. If read from files: only
                                 whether it was preserved, and distances */
    /* Faces of the model that are in the boundary as they are or subdivided, where the surface is
     * not kept because it intersects itself: the others are cut at the intersections or lie inside.
     * 0: not counted. */
    size_t faces_kept;
    bool joined; /* the surface is closed once its faces share what they touch (T-junctions) */
    starg_tetmesh *mesh;
    size_t tetrahedra; /* of the mesh */
    int32_t *labels;   /* one per tetrahedron: its piece */
    size_t piece_count;
    starg_piece *pieces;
    size_t contact_count;
    starg_piece_contact *contacts; /* ascending; the edges of the guarding graph */
    size_t strictly_star;          /* number of pieces proven star-shaped */
    double visible_vertices; /* fraction of tetrahedron vertices visible from the guard of their
                                piece (counted once per piece) */
    double
        flattest; /* smallest ratio of height to longest edge of a tetrahedron (regular: 0.816) */
    double flattest_given; /* the same for the initial tetrahedra; -1: there were none */
    /* Of the smallest dihedral angle of each tetrahedron, in degrees: the least and the median; -1:
     * not told */
    double smallest_angle, median_angle;
    /* The least without tetrahedra over whole faces of the model that have an angle as small; -1:
     * the surface was not kept, or the model has tetrahedra */
    double smallest_angle_made;
    size_t lower_bound; /* no fewer star-shaped pieces make up the model; 0: not sought */
    bool optimal;       /* as many pieces as lower_bound */
    /* A piecewise linear homeomorphism from each piece to a polyhedral ball: the guard goes to the
     * origin, boundary vertices to points at a distance of 1 (up to rounding), and each tetrahedron
     * linearly; all images are positively oriented, exactly. */
    starg_balls balls;
    double *ball_corners; /* tetrahedra x 4 x 3: images of the corners; NULL for NONE */
    /* Largest over smallest singular value of a tetrahedron's map: the largest of all, the mean
     * weighted by volume, and the share of the volume where it is above 10. */
    double ball_worst, ball_mean, ball_above_10;
    bool time_limited; /* the time limit stopped the search: another run may differ */
    /* How it was made, unless it was read from a report of an earlier version: then nothing of
     * this is known. The guards are only counted, and the path of tetgen is left out. An effort
     * that only --time-limit makes unlimited is INT64_MAX where the usual one would have ended
     * earlier. */
    bool options_known;
    starg_decompose_options options;
    uint64_t seed;
} starg_decomposition;

/* STRICT, as few pieces as possible. */
STARG_API void starg_decompose_options_default(starg_decompose_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_decompose_options_fields(void);

/* Cuts a solid. STRICT cuts an embedded surface as it is: the boundary of the pieces is the
 * surface, possibly subdivided, whose new vertices are rounded. At the context's time limit the
 * search returns its best result; without any, the first one is finished in a hurry. A surface that
 * intersects itself is first replaced by the boundary of what it encloses
 * (starg_repair_options.unite). PAPER, and a surface of which that cannot be made, is
 * tetrahedralized first. `options` may be NULL. Errors: ARGUMENT, MESH (`prove`: the surface is not
 * embedded), SOLVER (tetrahedralization failed, or a piece does not fit on the sphere in double
 * precision), MEMORY, CANCELLED, TIME (not yet tetrahedralized). */
STARG_API starg_status starg_decompose(starg_context *context, const starg_solid *solid,
                                       const starg_decompose_options *options,
                                       starg_decomposition **out);

/* The same with `prove`, and the certificate of lower_bound: a text (docs/formats.md) of `size`
 * bytes, followed by a zero byte, that starg_verify_pieces_with checks. Free it with
 * starg_text_free. Errors: those of starg_decompose, ARGUMENT (without `prove`), TIME (no bound
 * yet). */
STARG_API starg_status starg_decompose_certified(starg_context *context, const starg_solid *solid,
                                                 const starg_decompose_options *options,
                                                 starg_decomposition **out, char **certificate,
                                                 size_t *size);

/* Cuts a tetrahedral mesh. STRICT returns new tetrahedra with the boundary of the mesh, possibly
 * subdivided; PAPER labels a copy of the mesh. Errors: as for starg_decompose, and MESH (STRICT: a
 * tetrahedron too thin to contain a point). */
STARG_API starg_status starg_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                               const starg_decompose_options *options,
                                               starg_decomposition **out);

/* Largest distance between a mesh with holes and the boundary of its filled volume, either way, as
 * a fraction of the diagonal, unless `fill` is set. */
#define STARG_DECOMPOSE_FILL_MOST 0.2

/* Cuts a mesh with open edges. Where they close once faces share what they touch (STRICT), that
 * surface is cut (`joined`), otherwise the volume that fills it (starg_tetmesh_from_open_mesh).
 * Errors: as for starg_decompose, and MESH, also if the volume is too far from the mesh. */
STARG_API starg_status starg_decompose_open_mesh(starg_context *context, const starg_mesh *surface,
                                                 const starg_decompose_options *options,
                                                 starg_decomposition **out);
STARG_API void starg_decomposition_free(starg_context *context, starg_decomposition *decomposition);

/* The closed outward surfaces of all pieces in one mesh, in order, without shared vertices;
 * `first_face` receives piece_count + 1 face indices (free with starg_tetmesh_map_free). Errors:
 * ARGUMENT (too many faces), MEMORY. */
STARG_API starg_status starg_decomposition_surfaces(starg_context *context,
                                                    const starg_decomposition *decomposition,
                                                    starg_mesh **out, uint32_t **first_face);

/* Writes the surfaces of all pieces as OBJ, one group each: "g piece_0000", ... Errors: ARGUMENT,
 * WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_decomposition_write_groups(starg_context *context,
                                                        const starg_decomposition *decomposition,
                                                        const char *path);

/* Writes PIECES.vtk (docs/formats.md). "-" is standard output. Errors: WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_decomposition_write(starg_context *context,
                                                 const starg_decomposition *decomposition,
                                                 const char *path, bool binary);

/* Writes PIECES.json; `model_file` is stored as the model's path and may be NULL. */
STARG_API starg_status starg_decomposition_write_report(starg_context *context,
                                                        const starg_decomposition *decomposition,
                                                        const char *model_file, const char *path);

/* The same in memory, followed by a zero byte. Free with starg_text_free. Errors: MEMORY. */
STARG_API starg_status starg_decomposition_write_report_memory(
    starg_context *context, const starg_decomposition *decomposition, const char *model_file,
    char **text, size_t *size);

/* Reads both files; writing the result gives the same bytes. `pieces_path` may be NULL: then mesh
 * and labels are left out (NULL). Errors: READ, FORMAT (also if the
 * files belong to different decompositions), MEMORY, CANCELLED, and those of starg_tetmesh_read. */
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
