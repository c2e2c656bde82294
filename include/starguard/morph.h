/* SPDX-License-Identifier: Apache-2.0 */
/* Two surfaces: a map from one to the other, and the shapes between them [YL11, section 5.2]. */
#ifndef STARGUARD_MORPH_H
#define STARGUARD_MORPH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "decompose.h"
#include "fields.h"
#include "guard.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- maps ---- */

/* Most pairs of landmarks. */
enum { STARG_LANDMARKS_MOST = 500 };

typedef struct starg_map_options {
    const uint32_t *landmarks; /* landmark_count pairs: a vertex of A, a vertex of B */
    size_t landmark_count;
} starg_map_options;

/* No landmarks. */
STARG_API void starg_map_options_default(starg_map_options *options);

typedef enum starg_map_kind {
    STARG_MAP_SAME = 0,   /* the faces are the same: vertex i goes to vertex i            */
    STARG_MAP_SPHERE = 1, /* both surfaces were spread over the sphere                    */
    STARG_MAP_GIVEN = 2   /* read from a file                                             */
} starg_map_kind;

/* Where each vertex of A lies on B. How much the map distorts: for a face of A and its image the
 * singular values s >= r of the linear map between them, all scaled to surfaces of equal area; in
 * the mean over A's area. */
typedef struct starg_map {
    starg_map_kind kind;
    size_t vertex_count;          /* of A                                                       */
    size_t target_vertices;       /* of B                                                       */
    size_t target_faces;          /* of B                                                       */
    uint32_t *faces;              /* per vertex of A a face of B                                */
    double *coordinates;          /* vertex_count x 3, barycentric in that face, sum 1          */
    size_t landmark_count;        /* that it meets                                              */
    double mean_angle_distortion; /* (s/r + r/s) / 2, each at most 1000; 1 is best          */
    double mean_area_distortion;  /* (sr + 1/(sr)) / 2, each at most 1000; 1 is best        */
    size_t collapsed;             /* faces of A whose image has no area                         */
} starg_map;

/* Maps A onto B. With the same faces in the same order, up to one in twenty (poses of a model that
 * were cleaned singly, with a notice), vertex i goes to vertex i. Otherwise both must
 * be closed surfaces of genus 0 in one part: they are spread over the sphere, laid on one another
 * by the landmarks or, where these leave freedom, by their shapes, and A's vertices are found in B.
 * The map between the surfaces is then a bijection and meets the landmarks exactly. Landmarks of a
 * map between the same faces must agree with the identity. `options` may be NULL. Errors: ARGUMENT
 * (landmarks out of range or named twice), MESH (not usable, another genus, several parts,
 * landmarks that contradict one another), SOLVER (too uneven to be spread), MEMORY, CANCELLED. */
STARG_API starg_status starg_map_create(starg_context *context, const starg_mesh *a,
                                        const starg_mesh *b, const starg_map_options *options,
                                        starg_map **out);
STARG_API void starg_map_free(starg_context *context, starg_map *map);

/* Writes MAP.json; path "-" is standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_map_write(starg_context *context, const starg_map *map,
                                       const char *path);
/* The same in memory, with one zero byte behind the end. Free with starg_text_free. Errors: MEMORY.
 */
STARG_API starg_status starg_map_write_memory(starg_context *context, const starg_map *map,
                                              char **text, size_t *size);

/* Reads MAP.json as a map from A to B and measures it. Errors: READ, FORMAT (also where counts are
 * not those of the meshes, or coordinates not those of a point of a face), MEMORY. */
STARG_API starg_status starg_map_read(starg_context *context, const char *path, const starg_mesh *a,
                                      const starg_mesh *b, starg_map **out);

/* The images of A's vertices: vertex_count x 3 doubles of the caller. */
STARG_API void starg_map_positions(const starg_map *map, const starg_mesh *b, double *positions);

/* Reads landmarks: a pair a line, two vertex numbers (from 0), or six coordinates, of which the
 * nearest vertices are taken; '#' begins a comment. *pairs is count x 2, to be freed with
 * starg_landmarks_free. Errors: READ, FORMAT (with the line), MEMORY. */
STARG_API starg_status starg_landmarks_read(starg_context *context, const char *path,
                                            const starg_mesh *a, const starg_mesh *b,
                                            uint32_t **pairs, size_t *count);
STARG_API void starg_landmarks_free(starg_context *context, uint32_t *pairs);

/* ---- morphs ---- */

typedef enum starg_morph_method {
    STARG_MORPH_STAR = 0,     /* pieces with two guards each [YL11]                         */
    STARG_MORPH_ARAP = 1,     /* as rigid as possible, about one centre [ACOL00, BBA08]     */
    STARG_MORPH_LINEAR = 2,   /* every vertex on a line                                     */
    STARG_MORPH_SPHERICAL = 3 /* spherical coordinates about the guards [SR95]              */
} starg_morph_method;

typedef struct starg_morph_options {
    starg_morph_method method;
    size_t candidates; /* places tried for guards, 1 to 100,000 (star, spherical) */
} starg_morph_options;

/* Star; 1,000 candidates. */
STARG_API void starg_morph_options_default(starg_morph_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_morph_options_fields(void);

/* The way from one shape to another of the same faces, ready for any moment. */
typedef struct starg_morph starg_morph;

/* From A to B, given by the images of A's vertices (vertex_count x 3, copied). A is copied as well;
 * it must have faces. For star and spherical both ends must be closed surfaces that bound a solid
 * (they may intersect themselves). `options` may be NULL.
 * Errors: ARGUMENT, RANGE, MESH, SOLVER, MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_create(starg_context *context, const starg_mesh *a,
                                          const double *images, const starg_morph_options *options,
                                          starg_morph **out);
STARG_API void starg_morph_free(starg_morph *morph);

/* The shape at time t in [0, 1], vertex_count x 3 doubles of the caller; A itself at 0, the images
 * at 1. Errors: ARGUMENT, MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_frame(const starg_morph *morph, double t, double *positions);

/* Guards of star and spherical: of A, and their counterparts. 0 for other methods. */
STARG_API size_t starg_morph_guard_count(const starg_morph *morph);
STARG_API const double *starg_morph_guards(const starg_morph *morph, int end);
/* Per face of A the guard of its piece; NULL for other methods. */
STARG_API const uint32_t *starg_morph_pieces(const starg_morph *morph);
/* Faces whose guard is not seen to be on their inner side at both ends: no candidate is. */
STARG_API size_t starg_morph_unguarded(const starg_morph *morph);

/* The guards of one end (0: A, else the images) as a result of their own, in the order of
 * starg_morph_guards; its model has A's faces. `candidate_count`, `lower_bound` and `optimal` are
 * those of the common problem: no fewer pairs of candidates see at both ends all faces that some
 * pair sees at both. Errors: ARGUMENT (a method without guards), MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_guards_result(const starg_morph *morph, int end,
                                                 starg_guards **out);

/* What an end alone would need: guards chosen of the same candidates that see all that some
 * candidate sees there. Errors: as above. */
STARG_API starg_status starg_morph_guards_separate(const starg_morph *morph, int end,
                                                   starg_guards **out);

/* Cuts both ends, as solids, into the same pieces: the same tetrahedra with the same labels, each
 * piece strictly star-shaped in A (out[0]) and in the images (out[1]). A is filled by TetGen, and
 * the frames of the morph take the tetrahedra along. Free both with starg_decomposition_free.
 * Errors: MESH (an end that meets itself, or tetrahedra that cannot be kept positive on the way:
 * how many, and where), SOLVER (no TetGen), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_morph_solids(const starg_morph *morph, starg_decomposition *out[2]);

/* What a frame is like. */
typedef struct starg_frame_measures {
    size_t intersections; /* pairs of faces that pass through one another             */
    size_t inverted;      /* faces flipped over: against the sum of their neighbours'
                             normals, which at neither end they are                   */
    size_t collapsed;     /* faces of less than a millionth of their area at the ends */
    double volume, area;
    double volume_drift, area_drift; /* relative to the ends' values interpolated in t */
} starg_frame_measures;

/* Measures the shape at time t. Errors: MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_measure(const starg_morph *morph, double t,
                                           const double *positions, starg_frame_measures *out);

#ifdef __cplusplus
}
#endif

#endif
