/* SPDX-License-Identifier: Apache-2.0 */
/* Guarding: a small set of points inside a solid that together see its whole boundary, with a
 * proven lower bound [YL11, section 3]. */
#ifndef STARGUARD_GUARD_H
#define STARGUARD_GUARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "context.h"
#include "fields.h"
#include "simplify.h"
#include "solid.h"
#include "space.h"
#include "visibility.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_guard_method {
    STARG_GUARD_ILP = 0,    /* the fewest candidates, with proof */
    STARG_GUARD_GREEDY = 1, /* repeatedly the candidate that sees most of the rest */
    STARG_GUARD_PILP = 2    /* ILP from coarse to fine levels of detail [YL11, 3.3]             */
} starg_guard_method;

/* Branch-and-bound nodes: 100,000 for ILP, 30 for each solve of PILP. */
#define STARG_DEFAULT_NODES SIZE_MAX

/* For refine_lines: what suits the effort and the model. For the best effort that is 6,000,000 and,
 * for each guard of the candidates, 15 for each face, but at least 300,000. */
#define STARG_DEFAULT_LINES UINT64_MAX

/* Candidates to begin with: 1,000. With less than the best effort 200 where a search for better
 * guards follows that moves them (PILP with refinement), and, for a part of the area by directed
 * views, 300 (quick) or 600 (normal). */
#define STARG_DEFAULT_COUNT SIZE_MAX

/* Vertices that each finer level adds: 10,000, or STARG_QUARTERS for a model with more than 40,000
 * above the coarsest level. Each level costs a row of bits per candidate. */
#define STARG_DEFAULT_STEP SIZE_MAX

/* Candidate positions. */
typedef enum starg_candidates {
    STARG_CANDIDATES_MEDIAL = 0,   /* centres of maximal balls                       */
    STARG_CANDIDATES_INTERIOR = 1, /* an interior lattice */
    STARG_CANDIDATES_GIVEN = 2,    /* only the points of the options */
    STARG_CANDIDATES_SKELETON = 3  /* nodes of the curve skeleton                    */
} starg_candidates;

typedef struct starg_guard_options {
    starg_guard_method method;
    starg_candidates candidates;
    size_t candidate_count;   /* approximate number, at least 1, or STARG_DEFAULT_COUNT; more are
                                 added for faces that none of them sees */
    const double *points;     /* STARG_CANDIDATES_GIVEN: point_count x 3                     */
    const double *directions; /* of these, with a cone or a field of view: point_count x 3; NULL:
                                 they may look anywhere */
    const double *ups;        /* of these directions: what is up, as in starg_visibility_options */
    size_t point_count;
    /* Guards that stay: keep_count x 3, with directions and ups as above. They come first in the
     * result and are no candidates: bounds, limits of guards and refinement are of the others. */
    const double *keep, *keep_directions, *keep_ups;
    size_t keep_count;
    starg_visibility_options visibility;
    double coverage;     /* fraction in (0, 1] of the coverable area to cover (of the coverable
                            vertices, if they are the target) */
    size_t max_guards;   /* 0: no limit; else maximize the area with this many guards */
    uint32_t redundancy; /* guards per face, as far as candidates allow */
    double baseline;     /* above 0: two of these, which are 2 or more, at least so many degrees
                            apart as seen from the centroid of the face, as far as candidates allow;
                            only where everything is to be seen */
    bool worth;          /* find out what 1, 2, ... guards see (starg_guards_write_curve), and keep
                            what candidates see (starg_guards_write_matrix) */
    bool order;          /* put guards in the order of a short tour (starg_tour) */
    double clearance;    /* minimum distance from the boundary */
    size_t max_nodes;    /* branch-and-bound nodes per block, or STARG_DEFAULT_NODES */

    /* STARG_GUARD_PILP: as published */
    size_t coarsest;     /* vertices of the coarsest level                              */
    size_t step;         /* vertices that each finer level adds, at least 1, or STARG_QUARTERS or
                            STARG_DEFAULT_STEP */
    double significance; /* guards that see less than this fraction of a level's area are discarded,
                            0 to 1 */

    /* STARG_GUARD_PILP with full coverage and generated candidates: search fewer guards beside the
     * candidates */
    bool refine;
    uint64_t effort; /* of that search: STARG_EFFORT_QUICK, _NORMAL or _BEST (starguard/fields.h),
                        or as many units of work as refine_lines, as with the best effort */
    uint64_t refine_lines; /* budget in sight lines (about a microsecond each) and what takes as
                              long, or STARG_DEFAULT_LINES */

    /* Guards anywhere: search fewer guards at every point of the solid, and prove how many are
     * needed, wherever they stand, or with max_guards how much so many could see. Given candidates
     * stay: the fewest of them are chosen, beside a bound for guards anywhere. A bound with a cone
     * holds for guards that look in all directions. */
    bool prove;
    uint64_t prove_work; /* budget, in tests of a vertex against a box (about a microsecond each) */
} starg_guard_options;

/* PILP (5,000, STARG_DEFAULT_STEP, 0.1) with refinement (STARG_EFFORT_NORMAL), skeletal candidates,
 * as many as STARG_DEFAULT_COUNT, the fastest engine, faces by vertices, full coverage once, no
 * clearance, STARG_DEFAULT_NODES. */
STARG_API void starg_guard_options_default(starg_guard_options *options);

/* What STARG_DEFAULT_STEP stands for with so many vertices of the scene. */
STARG_API size_t starg_guard_default_step(size_t vertices, size_t coarsest);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_guard_options_fields(void);

/* The guards of one level of detail; they cover all that some candidate sees (or as much as
 * required). */
typedef struct starg_guard_level {
    size_t vertex_count, face_count;
    size_t count;
    double *positions; /* count x 3, those kept from the coarser level first               */
    size_t kept;       /* significant guards of the coarser level */
} starg_guard_level;

/* An obstacle of a scene. */
typedef struct starg_guard_obstacle {
    char *file; /* as given; NULL if made in memory */
    size_t vertex_count, face_count;
} starg_guard_obstacle;

/* A zone of a scene. */
typedef struct starg_guard_zone {
    bool excludes;
    double box[6];                   /* of a mesh: that holds it */
    char *file;                      /* of a mesh: as given; NULL if made in memory */
    size_t vertex_count, face_count; /* 0: it is the box */
} starg_guard_zone;

/* A way from the first guard to the last one, past all others in their order; those that stay come
 * before and are no part of it. No segment of it meets a face, but for the straight legs that are
 * blocked. */
typedef struct starg_tour {
    double length; /* of all segments, 0 for one guard */
    size_t point_count;
    double *points; /* point_count x 3; 0: there is no tour */
    size_t stop_count;
    uint32_t *stops; /* which of the points is each guard, ascending from 0 */
    size_t blocked_count;
    uint32_t *blocked; /* legs, from stop i to the next one, for which no free way was found */
} starg_tour;

/* A guarding result. Faces are indices into the model's mesh. */
typedef struct starg_guards {
    char *file; /* the model's path as given; NULL if made in memory          */
    size_t vertex_count, face_count; /* of the model                                          */
    starg_guard_options options;     /* as used; `points` is NULL                             */
    uint64_t seed;                   /* of the context */

    /* of a scene (starguard/space.h); the defaults and nothing for a plain solid */
    starg_space_options space; /* its lists belong to the result */
    size_t obstacle_count;
    starg_guard_obstacle *obstacles;
    size_t zone_count;
    starg_guard_zone *zones;
    size_t need_count;      /* of faces (starg_space_require) */
    starg_face_need *needs; /* ascending */
    size_t met_needs;       /* of those faces, that as many guards see as they need */
    size_t target_count;    /* faces to be seen; 0: all                              */
    uint32_t *targets;      /* ascending; NULL: all */
    double *importance;     /* of each target: starg_space_weigh, the largest is 1 */

    size_t count;
    double *positions;  /* count x 3                                                  */
    double *directions; /* count x 3, viewing directions; NULL where guards look all around */
    double *ups;        /* count x 3, what is up there; NULL without a field of view */
    size_t *seen_faces; /* number of faces visible from each guard */
    bool *kept;         /* by guard: it was given to stay, and comes first; NULL: none were */
    int *levels;        /* level of detail at which the guard was chosen; 0: the coarsest */

    size_t level_count;            /* of STARG_GUARD_PILP, before refinement; else 0             */
    starg_guard_level *level_list; /* the coarsest first                              */

    double coverage_faces;  /* covered fraction of all faces */
    double coverage_area;   /* covered fraction of the total area */
    size_t coverable_faces; /* number of faces that some candidate sees */
    size_t baseline_faces;  /* with a baseline: that two guards see from places so far apart */
    size_t uncovered_count;
    uint32_t *uncovered; /* faces of which no guard sees some or all, ascending */
    size_t partial_count;
    uint32_t *partial;     /* those of them of which guards see a part, ascending */
    double *partial_share; /* seen share of the area of each */
    size_t unseen_count; /* of them: proven to be seen from nowhere where guards may stand; only of
                            starg_guard, not of files */

    /* only for STARG_TARGET_POINTS, else 0: shares of the target area */
    double points_seen;   /* of which every point is proven to be seen; coverage_area is this */
    double points_open;   /* that is not decided */
    bool points_complete; /* everything is seen */

    /* only for STARG_TARGET_VERTICES, else 0 */
    double coverage_vertices; /* covered fraction of the vertices used by faces */
    size_t coverable_vertices;
    size_t uncovered_vertex_count;
    uint32_t *uncovered_vertices;

    starg_tour tour; /* only with `order` */

    double *curve_faces; /* count: fraction of all faces covered by the first 1, 2, ... guards */
    double *curve_area;  /* the same for the area */

    size_t worth_count;  /* only with `worth`, of starg_guard: numbers of guards beside those that
                            stay */
    double *worth_seen;  /* fraction of the area that so many candidates were found to see */
    double *worth_bound; /* and at most see */
    starg_bits
        *rows; /* what the final candidates see that is left to be seen, by patch or vertex */

    size_t candidate_count; /* including those added */
    size_t step_count;      /* the search began with step_guards[0] guards, and had found one with
                               step_guards[i] after about step_work[i] microseconds of counted work */
    uint64_t *step_work;
    size_t *step_guards;
    uint64_t lines_tested;         /* by refinement, and what takes as long */
    size_t cells, witnesses;       /* of the search over every point */
    uint64_t prove_work;           /* spent on it */
    size_t lower_bound;            /* no fewer candidates cover as much */
    bool optimal;                  /* count == lower_bound */
    size_t lower_bound_everywhere; /* no fewer guards cover as much, wherever they stand; 0: not
                                      sought */
    bool optimal_everywhere;       /* count == lower_bound_everywhere */
    double area_bound; /* max_guards, redundancy 1: upper bound on the area fraction that so many
                          guards cover; else 1 */
    double area_bound_everywhere; /* max_guards, prove, faces: so many guards cover no more of the
                                     area, wherever they stand; 0: not sought */
    bool time_limited;            /* the time limit stopped the search */
    size_t redundant_count;       /* with a redundancy above 1 that, else 0 */
    size_t *redundant_faces;      /* number of faces that at least 1, 2, ... guards see */
} starg_guards;

/* Places guards. `options` may be NULL for the defaults. Faces that no candidate sees are listed
 * and are not an error. Errors: ARGUMENT, MESH (no candidate inside), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_guard(starg_context *context, const starg_solid *solid,
                                   const starg_guard_options *options, starg_guards **out);
/* The same with `prove`, and the certificate of lower_bound_everywhere: a text (docs/formats.md) of
 * `size` bytes, followed by a zero byte, that starg_verify_guards_with checks. Free it with
 * starg_text_free. Errors: those of starg_guard, ARGUMENT (without `prove`, where
 * a part is to be seen, and for scenes). */
STARG_API starg_status starg_guard_certified(starg_context *context, const starg_solid *solid,
                                             const starg_guard_options *options, starg_guards **out,
                                             char **certificate, size_t *size);

/* Writes a certificate; path "-" is standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_certificate_write(starg_context *context, const char *certificate,
                                               size_t size, const char *path);

/* Evaluates `count` given guards in this order; they are the candidates of the result. The lower
 * bound is 0, since nothing is chosen. Errors: ARGUMENT (one is not strictly inside), MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_guards_given(starg_context *context, const starg_solid *solid,
                                          const double *points, size_t count, starg_guards **out);

/* The scene that a result is of, from the model and the obstacles that it names (space.h), without
 * zones that are meshes: it is there to see what guards see, not to place others. Errors:
 * ARGUMENT (another model), those of starg_space_create. */
STARG_API starg_status starg_guards_scene(starg_context *context, const starg_mesh *model,
                                          const starg_mesh *const *obstacles,
                                          const starg_guards *guards, starg_solid **out);

/* What each guard of a result sees there: a row for each, with a column for each face of the model;
 * of a face in patches it sees all. Errors: those of starg_visibility. */
STARG_API starg_status starg_guards_see(starg_context *context, const starg_solid *scene,
                                        const starg_guards *guards, starg_bits **out);

/* The same of the patches in which the result's faces are seen, and these as a mesh to be drawn,
 * face by face (corners rounded); of the faces where there are none. `missing` (may be NULL) lists
 * the patches of targets that no guard sees, ascending; free it with starg_patches_free. Errors:
 * those of starg_visibility. */
STARG_API starg_status starg_guards_patches(starg_context *context, const starg_solid *scene,
                                            const starg_guards *guards, starg_mesh **mesh,
                                            starg_bits **seen, uint32_t **missing, size_t *count);
/* The face of each of these patches; free it with starg_patches_free. Errors: MEMORY. */
STARG_API starg_status starg_guards_patch_faces(starg_context *context, const starg_solid *scene,
                                                const starg_guards *guards, uint32_t **faces,
                                                size_t *count);
STARG_API void starg_patches_free(starg_context *context, uint32_t *missing);

/* What is known of a face and the points of the free space. */
typedef enum starg_face_state {
    STARG_FACE_SEEN = 0,      /* one of them sees it */
    STARG_FACE_UNSEEN = 1,    /* proven: none of them does */
    STARG_FACE_UNDECIDED = 2, /* none was found that does */
    STARG_FACE_IGNORED = 3    /* it need not be seen */
} starg_face_state;

/* Which faces no point of the free space sees, at least `clearance` from the boundary: *out has a
 * starg_face_state for each face of the model; free it with starg_unseen_free. `view` may be NULL
 * for the defaults; views in one direction and vertices are not asked about. `work` is a budget, in
 * tests of a vertex against a box (about a microsecond each). Errors: ARGUMENT, MEMORY, CANCELLED,
 * TIME. */
STARG_API starg_status starg_unseen(starg_context *context, const starg_solid *scene,
                                    const starg_visibility_options *view, double clearance,
                                    uint64_t work, uint8_t **out);
STARG_API void starg_unseen_free(starg_context *context, uint8_t *faces);

STARG_API void starg_guards_free(starg_context *context, starg_guards *guards);

/* Candidate points: count x 3 doubles, each strictly inside and at least `clearance` from the
 * boundary. May return fewer than requested. Free with starg_points_free. */
STARG_API starg_status starg_candidate_points(starg_context *context, const starg_solid *solid,
                                              starg_candidates source, size_t wanted,
                                              double clearance, double **points, size_t *count);
STARG_API void starg_points_free(starg_context *context, double *points);

/* The same of zones: for those that are boxes the names are not used. */
STARG_API starg_status starg_guards_name_zones(starg_context *context, starg_guards *guards,
                                               const char *const *files);

/* Keeps the file names of the obstacles with the result, one for each in their order. Errors:
 * MEMORY. */
STARG_API starg_status starg_guards_name_obstacles(starg_context *context, starg_guards *guards,
                                                   const char *const *files);

/* Writes GUARDS.json (docs/formats.md); path "-" is standard output. `model_file` is stored as the
 * model's path and may be NULL. `guards` is not changed. */
STARG_API starg_status starg_guards_write(starg_context *context, const starg_guards *guards,
                                          const char *model_file, const char *path);

/* The same in memory: `size` bytes, followed by a zero byte. Free with starg_text_free. Errors:
 * MEMORY. */
STARG_API starg_status starg_guards_write_memory(starg_context *context, const starg_guards *guards,
                                                 const char *model_file, char **text, size_t *size);

/* How a camera that looks along -z with y up is turned to look where the guard does: a quaternion
 * (x, y, z, w). False: the guard looks all around. */
STARG_API bool starg_guards_rotation(const starg_guards *guards, size_t index, double rotation[4]);

/* The same in degrees: pan, clockwise seen from above (90: to the right); tilt, above the horizon;
 * roll, clockwise about the viewing direction. Up is that of the options. At pan 0 it looks along
 * frame[2] of starg_guards_level, and right of it is frame[0]: -z and x with y up, y and x with z
 * up; straight up and down, pan is where the top of the picture is. False: the guard looks all
 * around. */
STARG_API bool starg_guards_angles(const starg_guards *guards, size_t index, double angles[3]);
/* Right, up and ahead of pan 0 and no tilt, of unit length. */
STARG_API void starg_guards_level(const starg_guards *guards, double frame[3][3]);

/* Writes the poses of guards, as CSV or JSON (docs/formats.md); path "-" is standard output.
 * Errors: WRITE, MEMORY. */
STARG_API starg_status starg_guards_write_poses(starg_context *context, const starg_guards *guards,
                                                bool csv, const char *path);

/* Reads GUARDS.json. Errors: READ, FORMAT (what and which key), MEMORY. */
STARG_API starg_status starg_guards_read(starg_context *context, const char *path,
                                         starg_guards **out);

/* The same from `size` bytes in memory; `name` is used in messages. */
STARG_API starg_status starg_guards_read_memory(starg_context *context, const void *bytes,
                                                size_t size, const char *name, starg_guards **out);

/* Places, and where guards there look. */
typedef struct starg_poses {
    double *points;     /* count x 3 */
    double *directions; /* count x 3; NULL: there are none */
    double *ups;        /* of the directions: what is up, all 0 if it is not said; else NULL */
    size_t count;
} starg_poses;

/* Reads candidate poses: text with three numbers per line, six with a viewing direction, or nine
 * with what is up there (optionally after "v"; # begins a comment), the nodes of a skeleton (OBJ,
 * CG, VTK), the guards of a GUARDS.json, what starg_guards_write_poses writes, or the cameras of a
 * binary glTF, recognized by content. Errors: READ, FORMAT (line and reason), MEMORY. */
STARG_API starg_status starg_poses_read(starg_context *context, const char *path, starg_poses *out);
STARG_API starg_status starg_poses_read_memory(starg_context *context, const void *bytes,
                                               size_t size, const char *name, starg_poses *out);
STARG_API void starg_poses_free(starg_context *context, starg_poses *poses);

/* The same without directions. */
STARG_API starg_status starg_points_read(starg_context *context, const char *path, double **points,
                                         size_t *count);
STARG_API starg_status starg_points_read_memory(starg_context *context, const void *bytes,
                                                size_t size, const char *name, double **points,
                                                size_t *count);

/* What given guards see, without any choice: the result has all of them in their order. One that is
 * not in the free space sees nothing. The bounds are 0. Errors: ARGUMENT (no poses; views that look
 * in one direction, and poses that have none), those of starg_visibility. */
STARG_API starg_status starg_guards_audit(starg_context *context, const starg_solid *scene,
                                          const starg_poses *poses,
                                          const starg_visibility_options *view, starg_guards **out);

/* Tables of what guards see of their scene, as CSV (docs/formats.md); path "-" is standard output.
 * One has a row for each face to be seen, the other one for each guard, each group of faces, and
 * all of them. `groups` may be NULL. Errors: WRITE, those of starg_visibility. */
STARG_API starg_status starg_guards_write_table(starg_context *context, const starg_solid *scene,
                                                const starg_guards *guards,
                                                const starg_face_groups *groups, const char *path);
STARG_API starg_status starg_guards_write_summary(starg_context *context, const starg_solid *scene,
                                                  const starg_guards *guards,
                                                  const starg_face_groups *groups,
                                                  const char *path);

/* Writes what 1, 2, ... guards see and its upper bound, as CSV or as a picture (SVG); path "-" is
 * standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_guards_write_curve(starg_context *context, const starg_guards *guards,
                                                bool svg, const char *path);

/* Writes the set cover of the final candidates as text (docs/formats.md). Errors: WRITE, MEMORY. */
STARG_API starg_status starg_guards_write_matrix(starg_context *context, const starg_guards *guards,
                                                 const char *path);

#ifdef __cplusplus
}
#endif

#endif
