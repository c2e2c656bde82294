/* The main job: a small set of points inside a solid that together see its whole boundary, with a
 * proven lower bound [YL11, section 3]. */
#ifndef STARGUARD_GUARD_H
#define STARGUARD_GUARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "simplify.h"
#include "solid.h"
#include "visibility.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_guard_method {
    STARG_GUARD_ILP = 0,    /* the fewest candidates, proven                                    */
    STARG_GUARD_GREEDY = 1, /* the candidate that sees most of the rest, again and again        */
    STARG_GUARD_PILP = 2    /* ILP from coarse to fine levels of detail [YL11, 3.3]             */
} starg_guard_method;

/* Branch-and-bound nodes: 100,000 for ILP, 30 for each solve of PILP. */
#define STARG_DEFAULT_NODES SIZE_MAX

/* Vertices that each finer level has more: 10,000, or STARG_QUARTERS for a model that has more than
 * 40,000 above the coarsest level: each level costs a row of bits for every candidate. */
#define STARG_DEFAULT_STEP SIZE_MAX

/* Where guards may stand. */
typedef enum starg_candidates {
    STARG_CANDIDATES_MEDIAL = 0,   /* centres of maximal balls                       */
    STARG_CANDIDATES_INTERIOR = 1, /* a lattice of points inside                     */
    STARG_CANDIDATES_GIVEN = 2,    /* the points of the options, and no others       */
    STARG_CANDIDATES_SKELETON = 3  /* nodes of the curve skeleton                    */
} starg_candidates;

typedef struct starg_guard_options {
    starg_guard_method method;
    starg_candidates candidates;
    size_t candidate_count; /* about how many to make, at least 1; more are added for faces
                               that none of them sees                                      */
    const double *points;   /* STARG_CANDIDATES_GIVEN: point_count x 3                     */
    size_t point_count;
    starg_visibility_options visibility;
    double coverage;     /* fraction in (0, 1] of the coverable area that must be seen
                            (of the coverable vertices, when they are the target)       */
    size_t max_guards;   /* 0: no limit; else the best area that so many guards see     */
    uint32_t redundancy; /* every face by so many guards, as far as candidates allow    */
    double clearance;    /* guards at least this far from the boundary                  */
    size_t max_nodes;    /* branch-and-bound nodes for each block, or STARG_DEFAULT_NODES */

    /* STARG_GUARD_PILP: the paper's constants */
    size_t coarsest;     /* vertices of the coarsest level                              */
    size_t step;         /* vertices that each finer level has more, at least 1, or
                            STARG_QUARTERS or STARG_DEFAULT_STEP                        */
    double significance; /* a guard that sees less than this fraction of a level's area is
                            chosen anew there, 0 to 1                                   */

    /* STARG_GUARD_PILP with all to be covered and candidates that are not given: once guards are
     * found, candidates are added where they pay, and guards chosen again */
    bool refine;
    uint64_t refine_lines; /* sight lines that may be tested for that                   */

    /* Guards anywhere: fewer guards are looked for at every point of the solid, and how few could
     * do, wherever they stand. With all to be covered once, no cone, and candidates that are not
     * given. */
    bool prove;
    uint64_t prove_work; /* that may be done for that: tests of a vertex against a box or a point,
                            and others in proportion; about microseconds                  */
} starg_guard_options;

/* PILP (5,000, STARG_DEFAULT_STEP, 0.1) with refinement (10 million lines), 1,000 skeletal
 * candidates, grid, faces by vertices, all of it once, no clearance, STARG_DEFAULT_NODES. */
STARG_API void starg_guard_options_default(starg_guard_options *options);

/* What each option is called, may hold and means. */
STARG_API const starg_fields *starg_guard_options_fields(void);

/* The guards of one level of detail, which see all of it that some candidate sees (or as much as
 * was asked for). */
typedef struct starg_guard_level {
    size_t vertex_count, face_count;
    size_t count;
    double *positions; /* count x 3, those kept from the coarser level first               */
    size_t kept;       /* from the coarser level, because they are significant              */
} starg_guard_level;

/* A set of guards and what is known about it. Faces are indices into the solid's mesh. */
typedef struct starg_guards {
    char *file; /* the model's path as given; NULL if made in memory          */
    size_t vertex_count, face_count; /* of the model                                          */
    starg_guard_options options;     /* as used; `points` is NULL                             */

    size_t count;
    double *positions;  /* count x 3                                                  */
    double *directions; /* count x 3, where each looks; NULL without a cone of view   */
    size_t *seen_faces; /* faces that each guard sees                                 */
    int *levels;        /* level of detail that asked for the guard; 0: the coarsest  */

    size_t level_count;            /* of STARG_GUARD_PILP, before refinement; else 0             */
    starg_guard_level *level_list; /* the coarsest first                              */

    double coverage_faces;  /* seen fraction of all faces                                 */
    double coverage_area;   /* seen fraction of the area of all faces                     */
    size_t coverable_faces; /* faces that some candidate sees                             */
    size_t uncovered_count;
    uint32_t *uncovered; /* faces that no guard sees, ascending                        */

    /* only for STARG_TARGET_VERTICES, else 0 */
    double coverage_vertices; /* seen fraction of the vertices that faces use               */
    size_t coverable_vertices;
    size_t uncovered_vertex_count;
    uint32_t *uncovered_vertices;

    double *curve_faces; /* count: seen fraction of all faces by the first 1, 2, ... guards */
    double *curve_area;  /* likewise of the area of all faces                             */

    size_t candidate_count;        /* in the end, with those added                               */
    uint64_t lines_tested;         /* by refinement                                              */
    size_t cells, witnesses;       /* of the search over every point                            */
    uint64_t prove_work;           /* done by it                                                */
    size_t lower_bound;            /* no fewer candidates see as much (of what was asked for)    */
    bool optimal;                  /* count == lower_bound                                       */
    size_t lower_bound_everywhere; /* no fewer guards see as much, wherever they stand; 0: this was
                                      not sought                                          */
    bool optimal_everywhere;       /* count == lower_bound_everywhere                     */
    double area_bound;             /* max_guards, for faces seen once: no choice of so many sees a
                                      larger fraction of all area; else 1                        */
    bool time_limited;             /* the time limit cut the search short                        */
} starg_guards;

/* Places guards. `options` may be NULL for the defaults. Faces that nothing can see are no error:
 * they are listed. Errors: ARGUMENT, MESH (no candidate inside), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_guard(starg_context *context, const starg_solid *solid,
                                   const starg_guard_options *options, starg_guards **out);
/* What guards see that stand already, `count` points in this order: a result whose candidates they
 * are. The lower bound is 0: nothing is chosen. Errors: ARGUMENT (one is not strictly inside),
 * MEMORY, CANCELLED. */
STARG_API starg_status starg_guards_given(starg_context *context, const starg_solid *solid,
                                          const double *points, size_t count, starg_guards **out);

STARG_API void starg_guards_free(starg_context *context, starg_guards *guards);

/* Points where guards may stand: count x 3 doubles in a block that starg_points_free frees, every
 * one strictly inside and at least `clearance` from the boundary. May give fewer than wanted. */
STARG_API starg_status starg_candidate_points(starg_context *context, const starg_solid *solid,
                                              starg_candidates source, size_t wanted,
                                              double clearance, double **points, size_t *count);
STARG_API void starg_points_free(starg_context *context, double *points);

/* Writes GUARDS.json (docs/formats.md); path "-" is standard output. Sets nothing in `guards`;
 * `model_file` is stored as the model's path, NULL leaves it empty. */
STARG_API starg_status starg_guards_write(starg_context *context, const starg_guards *guards,
                                          const char *model_file, const char *path);

/* The same text in memory: `size` bytes and a zero behind them, to be freed by starg_text_free.
 * Errors: MEMORY. */
STARG_API starg_status starg_guards_write_memory(starg_context *context, const starg_guards *guards,
                                                 const char *model_file, char **text, size_t *size);

/* Reads GUARDS.json. Errors: READ, FORMAT (what and which key), MEMORY. */
STARG_API starg_status starg_guards_read(starg_context *context, const char *path,
                                         starg_guards **out);

/* The same from `size` bytes in memory; `name` stands in messages. */
STARG_API starg_status starg_guards_read_memory(starg_context *context, const void *bytes,
                                                size_t size, const char *name, starg_guards **out);

/* Reads candidate points: text of three numbers a line (an optional leading "v", comments by #),
 * the nodes of a skeleton (OBJ, CG, VTK), or the positions in a GUARDS.json; the content tells
 * which. Free with starg_points_free. */
STARG_API starg_status starg_points_read(starg_context *context, const char *path, double **points,
                                         size_t *count);
STARG_API starg_status starg_points_read_memory(starg_context *context, const void *bytes,
                                                size_t size, const char *name, double **points,
                                                size_t *count);

#ifdef __cplusplus
}
#endif

#endif
