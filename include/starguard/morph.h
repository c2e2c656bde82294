/* SPDX-License-Identifier: Apache-2.0 */
/* Maps and morphs between two surfaces [YL11, section 5.2]. */
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

/* Maximum number of landmark pairs. */
enum { STARG_LANDMARKS_MOST = 500 };

typedef struct starg_map_options {
    const uint32_t *landmarks; /* landmark_count pairs: a vertex of A, a vertex of B */
    size_t landmark_count;
    bool solid; /* of the solids inside: if both are star-shaped, points that are seen in the same
                   direction from a point of each kernel correspond (`centers`), unless there are
                   landmarks; the map then has its overlay. */
} starg_map_options;

/* No landmarks, not of solids. */
STARG_API void starg_map_options_default(starg_map_options *options);

typedef enum starg_map_kind {
    STARG_MAP_SAME = 0,   /* same faces: vertex i maps to vertex i */
    STARG_MAP_SPHERE = 1, /* via the sphere */
    STARG_MAP_GIVEN = 2   /* read from a file                                             */
} starg_map_kind;

/* The common refinement of the triangulations of two surfaces: each face lies in one face of A and
 * one of B. All zero: there is none. */
typedef struct starg_overlay {
    size_t vertex_count, face_count;
    uint32_t *faces; /* face_count x 3, oriented as A */
    /* Per vertex its places, on A and on B: a face, and vertex_count x 3 barycentric coordinates in
     * it, sum 1. Vertices of A and of B have one coordinate of 1, points on edges one of 0. */
    uint32_t *own_faces, *target_faces;
    double *own_coordinates, *target_coordinates;
} starg_overlay;

/* The image of each vertex of A on B. Distortion is computed from the singular values s >= r of the
 * linear map between a face of A and its image, both surfaces scaled to equal area, averaged over
 * A's area. */
typedef struct starg_map {
    starg_map_kind kind;
    size_t vertex_count;          /* of A                                                       */
    size_t target_vertices;       /* of B                                                       */
    size_t target_faces;          /* of B                                                       */
    uint32_t *faces;              /* per vertex of A, a face of B */
    double *coordinates;          /* vertex_count x 3, barycentric in that face, sum 1          */
    size_t landmark_count;        /* number of satisfied landmarks */
    double mean_angle_distortion; /* mean of (s/r + r/s) / 2, each at most 1000; 1 is best */
    double mean_area_distortion;  /* mean of (sr + 1/(sr)) / 2, each at most 1000; 1 is best */
    size_t collapsed;             /* faces of A with a degenerate image */
    /* What makes it a bijection of the whole surfaces, if that is known: directions of the vertices
     * of A (vertex_count x 3) and of B (target_vertices x 3), for which the spherical triangles of
     * either surface cover the sphere once. Points in the same direction correspond. NULL: not
     * known, or not needed, as vertex i maps to vertex i of the same faces. */
    double *directions, *target_directions;
    size_t direction_count, target_direction_count; /* as many as vertices, or 0 */
    size_t pair_count;
    uint32_t *pairs; /* pair_count x 2: the satisfied landmarks; NULL: none */
    double *centers; /* 2 x 3: in the kernels of A and of B, from where the directions are those of
                        the vertices; NULL: they are not */
    starg_overlay overlay;
} starg_map;

/* Maps A onto B. If both have the same faces in the same order (up to one in twenty may differ,
 * with a notice), vertex i maps to vertex i. Otherwise both must be closed connected surfaces of
 * genus 0: they are mapped to the sphere and aligned by the landmarks and, where these leave
 * freedom, by shape; then A's vertices are located in B. This map is a bijection and satisfies the
 * landmarks exactly. Landmarks between surfaces with the same faces must agree with the identity.
 * `options` may be NULL. Errors: ARGUMENT (landmarks out of range or repeated), MESH (not usable,
 * another genus, not connected, contradictory landmarks), SOLVER (too uneven to be mapped to the
 * sphere), MEMORY, CANCELLED. */
STARG_API starg_status starg_map_create(starg_context *context, const starg_mesh *a,
                                        const starg_mesh *b, const starg_map_options *options,
                                        starg_map **out);
STARG_API void starg_map_free(starg_context *context, starg_map *map);

/* Adds the overlay to a map from A to B, whose memory is then of this context, too, and moves the
 * images of A's vertices to where it has them, which is near. Points are rounded; exactly in
 * barycentric coordinates, its triangles are positive in their faces of A and of B, which they
 * fill. Errors: MESH (the map has no directions, or they fold: the face), SOLVER (points too close
 * for doubles), MEMORY, CANCELLED. */
STARG_API starg_status starg_map_overlay(starg_context *context, const starg_mesh *a,
                                         const starg_mesh *b, starg_map *map);

/* Computes the places of the overlay's vertices on A (end 0) or B (end 1) in the caller's array of
 * vertex_count x 3 doubles. Vertices of that mesh are at their exact coordinates. */
STARG_API void starg_overlay_positions(const starg_overlay *overlay, const starg_mesh *mesh,
                                       int end, double *positions);

/* Gives a mesh with the overlay's faces the colours and texture coordinates of A, as they are at
 * its places on A. Errors: ARGUMENT (another number of vertices or faces), MEMORY. */
STARG_API starg_status starg_overlay_look(starg_context *context, const starg_overlay *overlay,
                                          const starg_mesh *a, starg_mesh *refined);

/* Writes MAP.json; path "-" is standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_map_write(starg_context *context, const starg_map *map,
                                       const char *path);
/* The same in memory, followed by a zero byte. Free with starg_text_free. Errors: MEMORY. */
STARG_API starg_status starg_map_write_memory(starg_context *context, const starg_map *map,
                                              char **text, size_t *size);

/* Reads MAP.json as a map from A to B and measures its distortion. Errors: READ, FORMAT (also if
 * counts differ from the meshes, or coordinates are not barycentric), MEMORY. */
STARG_API starg_status starg_map_read(starg_context *context, const char *path, const starg_mesh *a,
                                      const starg_mesh *b, starg_map **out);

/* Computes the images of A's vertices in the caller's array of vertex_count x 3 doubles. */
STARG_API void starg_map_positions(const starg_map *map, const starg_mesh *b, double *positions);

/* Reads landmarks, one pair per line: two vertex indices (from 0), or six coordinates, which select
 * the nearest vertices; '#' begins a comment. *pairs is count x 2; free with starg_landmarks_free.
 * Errors: READ, FORMAT (with the line), MEMORY. */
STARG_API starg_status starg_landmarks_read(starg_context *context, const char *path,
                                            const starg_mesh *a, const starg_mesh *b,
                                            uint32_t **pairs, size_t *count);
STARG_API void starg_landmarks_free(starg_context *context, uint32_t *pairs);

/* ---- morphs ---- */

typedef enum starg_morph_method {
    STARG_MORPH_STAR = 0,      /* pieces with corresponding guards [YL11] */
    STARG_MORPH_ARAP = 1,      /* as rigid as possible, about one centre [ACOL00, BBA08]     */
    STARG_MORPH_LINEAR = 2,    /* straight vertex paths */
    STARG_MORPH_SPHERICAL = 3, /* spherical coordinates about the guards [SR95] */
    STARG_MORPH_SOLID = 4 /* tetrahedra that fill both, none of which is inverted at any time */
} starg_morph_method;

typedef struct starg_morph_options {
    starg_morph_method method;
    size_t candidates;     /* guard candidates, 1 to 100,000 (star, spherical) */
    const double *centers; /* solid: those of the map (starg_map); NULL: not known. */
} starg_morph_options;

/* Star; 1,000 candidates. */
STARG_API void starg_morph_options_default(starg_morph_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_morph_options_fields(void);

/* A morph between two shapes with the same faces, for evaluation at any time. */
typedef struct starg_morph starg_morph;

/* Prepares a morph from A to the images of A's vertices (vertex_count x 3); both are copied. A must
 * have faces. For star and spherical both ends must be closed surfaces that bound a solid
 * (self-intersections are allowed); for solid, which needs TetGen, they
 * must not intersect themselves. `options` may be NULL. Errors: ARGUMENT, RANGE, MESH, SOLVER,
 * MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_create(starg_context *context, const starg_mesh *a,
                                          const double *images, const starg_morph_options *options,
                                          starg_morph **out);
STARG_API void starg_morph_free(starg_morph *morph);

/* Computes the shape at time t in [0, 1] in the caller's array of vertex_count x 3 doubles; A
 * itself at 0, the images at 1. Errors: ARGUMENT, MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_frame(const starg_morph *morph, double t, double *positions);

/* Guards of A (end 0) and their counterparts (end 1). Star and spherical only; else 0. */
STARG_API size_t starg_morph_guard_count(const starg_morph *morph);
STARG_API const double *starg_morph_guards(const starg_morph *morph, int end);
/* The guard of each face of A; NULL for other methods. */
STARG_API const uint32_t *starg_morph_pieces(const starg_morph *morph);
/* Number of faces that no candidate sees from their inner side at both ends. */
STARG_API size_t starg_morph_unguarded(const starg_morph *morph);

/* Method solid, else 0: tetrahedra inside, none of which is inverted at any time, and moments
 * between which all vertices move on straight lines. */
STARG_API size_t starg_morph_tetrahedron_count(const starg_morph *morph);
STARG_API size_t starg_morph_key_count(const starg_morph *morph);

/* The guards of one end (0: A, else the images) as a guarding result, in the order of
 * starg_morph_guards; its model has A's faces. `candidate_count`, `lower_bound` and `optimal` refer
 * to the joint problem: no fewer pairs of candidates see, at both ends, all faces that some pair
 * sees at both. Errors: ARGUMENT (a method without guards), MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_guards_result(const starg_morph *morph, int end,
                                                 starg_guards **out);

/* Guards for one end alone: chosen from the same candidates, they cover all that some candidate
 * sees there. Errors: as above. */
STARG_API starg_status starg_morph_guards_separate(const starg_morph *morph, int end,
                                                   starg_guards **out);

/* Cuts both ends, as solids, into compatible pieces: the same tetrahedra with the same labels, each
 * piece strictly star-shaped in A (out[0]) and in the images (out[1]). TetGen fills A, and the
 * frames of the morph deform the tetrahedra. Free both with starg_decomposition_free. Errors: MESH
 * (an end intersects itself, or tetrahedra cannot be kept positive: how many, and where), SOLVER
 * (no TetGen), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_morph_solids(const starg_morph *morph, starg_decomposition *out[2]);

/* The largest distance of a corner of a face of either surface from the other surface; infinity if
 * one has no faces. Errors: MEMORY, CANCELLED. */
STARG_API starg_status starg_mesh_apart(starg_context *context, const starg_mesh *a,
                                        const starg_mesh *b, double *largest);

/* Quality of a frame. */
typedef struct starg_frame_measures {
    size_t intersections; /* pairs of intersecting faces */
    size_t inverted;  /* flipped faces: opposed to the sum of their neighbours' normals, unlike at
                         the ends */
    size_t collapsed; /* faces with less than a millionth of their area at the ends */
    double volume, area;
    double volume_drift, area_drift; /* relative to linear interpolation of the ends */
} starg_frame_measures;

/* Measures the shape at time t. Errors: MEMORY, CANCELLED. */
STARG_API starg_status starg_morph_measure(const starg_morph *morph, double t,
                                           const double *positions, starg_frame_measures *out);

#ifdef __cplusplus
}
#endif

#endif
