/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes: where guards may stand, what blocks their view, and what they are to see.
 *
 * The plainest scene is that of starg_solid_create: the boundary of a solid blocks the view and is
 * to be seen, and its inside is free. A scene is a starg_solid, too, and goes wherever one goes;
 * its mesh has the faces of the model first, then those of the obstacles. */
#ifndef STARGUARD_SPACE_H
#define STARGUARD_SPACE_H

#include <stdbool.h>
#include <stddef.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "solid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the orientation of closed shells means. */
typedef enum starg_orientation {
    STARG_ORIENTATION_NESTED = 0, /* nothing: shells bound matter and cavities by their nesting;
                                     where they overlap, their union is the solid */
    STARG_ORIENTATION_KEEP = 1    /* every face as given. The inside of the solid is where the
                                     winding number is at least 1, after all faces were reversed
                                     if the signed volume is negative */
} starg_orientation;

/* A part of space in which guards may stand, or may not; it blocks no view. Its border belongs to
 * it. */
typedef struct starg_zone {
    bool excludes;          /* guards may not stand in it */
    double box[6];          /* lower corner, upper corner */
    const starg_mesh *mesh; /* closed, in place of the box; NULL: the box */
} starg_zone;

typedef struct starg_space_options {
    starg_orientation orientation; /* of the model's shells */
    bool soup; /* the model is any triangles, closed or not: each blocks the view from both sides,
                  and is seen from its front, where its corners turn counter-clockwise; space is
                  free but for the triangles themselves */
    bool two_sided;          /* faces of a soup are seen from either side */
    bool outside;            /* guards stand outside of the model and see it from there */
    double standoff_least;   /* distance of guards from the model */
    double standoff_most;    /* may be INFINITY */
    double within[6];        /* guards stand in this box: lower corner, upper corner; all 0:
                                anywhere, or if the free space has no end and nothing else limits
                                where guards stand, in the model's box, wider by 0.1 diagonals (a
                                soup without `cell`) or 4 (outside) */
    const starg_zone *zones; /* zone_count of them: guards stand in the union of those that do not
                                exclude, if there are any, and in none of those that do */
    size_t zone_count;
    double cell; /* above 0: guards stand where one gets from `from` through cubes of that size
                    that no face meets */
    double from[3];
    uint32_t *over; /* over_count faces of the model, ascending: guards stand straight above
                             one of them, at most `height` high; NULL: anywhere */
    size_t over_count;
    double height;
    double up[3];    /* what is up there; 0, 0, 0: along y */
    uint32_t *mount; /* mount_count faces, ascending: guards stand at most `mount_distance`
                              from one of them; NULL: anywhere */
    size_t mount_count;
    double mount_distance;
    uint32_t *clear; /* clear_count faces, ascending, that block no view, as glass and fences, and
                        need not be seen. What is beyond is seen through them; nobody stands there
                        for that */
    size_t clear_count;
} starg_space_options;

/* All zero: NESTED, inside, anywhere. */
STARG_API void starg_space_options_default(starg_space_options *options);

/* Creates a scene from copies of a model and of obstacles, which may be none. A closed obstacle is
 * solid: its inside is not free. An open one blocks the view from both sides. Faces of obstacles
 * are not to be seen. Errors: those of starg_solid_create for the model; ARGUMENT (numbers out of
 * range; more than 2^30 cubes; `from` in a cube that a face meets; faces that are not of the model;
 * a zone that is no box; an obstacle that lies beyond the bounding box of the model, by its index:
 * not with `outside`). */
STARG_API starg_status starg_space_create(starg_context *context, const starg_mesh *model,
                                          const starg_mesh *const *obstacles, size_t obstacle_count,
                                          const starg_space_options *options, starg_solid **out);

/* How much each face of the model matters: its area counts so many times, and 0 means that it need
 * not be seen. `weights` has a number for each face of the model, or is NULL: all matter alike.
 * Errors: ARGUMENT (a weight that is negative or not finite, by its face; all 0), MEMORY. */
STARG_API starg_status starg_space_weigh(starg_solid *scene, const double *weights);

/* What a face needs, in place of what others do. */
typedef struct starg_face_need {
    uint32_t face;
    uint32_t times; /* guards that must see it, as far as candidates allow; 0: as many as others */
    double density; /* of pixels, as in starg_visibility_options; 0: as others */
} starg_face_need;

/* Faces that need more, or less, than the redundancy says, and a density of pixels of their own; of
 * a face that is given twice the last counts. Errors: ARGUMENT (no face of the model, more than
 * 1,000 guards), MEMORY. */
STARG_API starg_status starg_space_require(starg_solid *scene, const starg_face_need *needs,
                                           size_t count);

/* Weights from text files, for starg_space_weigh. Of a list of face numbers: 1 for those in it, 0
 * for the others. Of a list of weights: one for each face. # begins a comment. Free with
 * starg_weights_free. Errors: READ, FORMAT (line and reason), MEMORY. */
STARG_API starg_status starg_faces_read(starg_context *context, const char *path, size_t face_count,
                                        double **weights);
STARG_API starg_status starg_weights_read(starg_context *context, const char *path,
                                          size_t face_count, double **weights);
/* The same for a name that the model's own file gives to faces: 1 for those of a group, an object
 * or a material (OBJ), the values of a property of faces (PLY), or 1 where such a property has the
 * value, for `name=value`. In the name * stands for any characters and ? for one: all names that
 * fit; of several properties, the last value that is not 0. Errors: READ, ARGUMENT (no such name,
 * with those that there are; another model), those of starg_mesh_read. */
STARG_API starg_status starg_faces_named(starg_context *context, const char *model_file,
                                         const char *name, size_t face_count, double **weights);
/* The groups of a model's faces, by its own file: of an OBJ its groups, where there are none its
 * objects or materials; of a scene its nodes. Other files have none. Free with
 * starg_face_groups_free. Errors: those of starg_mesh_read. */
typedef struct starg_face_groups {
    size_t count;
    char **names;
    size_t face_count;
    uint32_t *of; /* by face, a group, or UINT32_MAX: none */
    char *text;   /* of the names */
} starg_face_groups;

STARG_API starg_status starg_face_groups_read(starg_context *context, const char *model_file,
                                              starg_face_groups *out);
STARG_API void starg_face_groups_free(starg_context *context, starg_face_groups *groups);

STARG_API void starg_weights_free(starg_context *context, double *weights);

/* Number of vertices and faces of the model: those before the obstacles' in the mesh. */
STARG_API size_t starg_space_model_vertices(const starg_solid *scene);
STARG_API size_t starg_space_model_faces(const starg_solid *scene);

/* Whether a guard may stand at p: starg_solid_contains, and within the distances and the box. */
STARG_API bool starg_space_admits(const starg_solid *scene, const double p[3]);

/* A way from `from` of a soup out of the model's box, or through a gap hardly wider than a cube:
 * `count` points, three numbers each, which the scene keeps; NULL: no leak was found. A warning
 * tells of it, too. */
STARG_API const double *starg_space_leak(const starg_solid *scene, size_t *count);

#ifdef __cplusplus
}
#endif

#endif
