/* SPDX-License-Identifier: Apache-2.0 */
/* What the writers of scenes share: the parts, checked, and what is made of them once. */
#pragma once

#include "export/piece_surfaces.h"
#include "starguard/scene.h"

typedef struct scene_job {
    const starg_scene *scene;
    starg_piece_surfaces surfaces; /* empty without pieces                                      */
    int32_t *viewer;  /* per face of the model: the first guard that sees it, or -1; NULL
                         unless it is known what guards see                          */
    uint8_t *times;   /* per face: how many guards see it, at most SCENE_MOST_TIMES, or
                         SCENE_NOT_WANTED: none has to; NULL like `viewer` */
    double center[3]; /* of the box of all that is shown                                   */
    double size;      /* its largest side; above 0                                          */
    size_t model_vertices, model_faces, guards, nodes, edges; /* 0 where the part is not shown */
    size_t obstacle_vertices, obstacle_faces;
} scene_job;

enum { SCENE_MOST_TIMES = 3, SCENE_NOT_WANTED, SCENE_TIMES }; /* the last: how many values */

enum { SCENE_PARTS = 6 };
typedef enum scene_part {
    SCENE_MODEL,
    SCENE_PIECE,
    SCENE_GUARD,
    SCENE_SKELETON,
    SCENE_VIEW,
    SCENE_OBSTACLE
} scene_part;

extern const uint8_t SCENE_NEUTRAL[3], SCENE_UNSEEN[3], SCENE_CURVE[3], SCENE_IN_THE_WAY[3];

/* The colour of a face of the model: that of the guard that sees it first. */
void scene_face_color(const scene_job *job, size_t face, uint8_t rgb[3]);

/* The colour of what so many guards see, or, of SCENE_NOT_WANTED, of what need not be seen. */
void scene_count_color(size_t times, uint8_t rgb[3]);

/* The vertex of the tetrahedra that is vertex `index` of the surfaces of pieces. */
const double *scene_piece_vertex(const scene_job *job, size_t index);

/* A ball, to be put where a guard is: of radius 1, closed and outward. */
enum { BALL_VERTICES = 38, BALL_FACES = 72 };
typedef struct scene_ball {
    double vertices[3 * BALL_VERTICES];
    uint32_t faces[3 * BALL_FACES];
} scene_ball;
void scene_ball_make(scene_ball *ball);
/* The radius that balls are given. */
double scene_ball_radius(const scene_job *job);

/* Views of guards that look one way (export/scene_view.c): triangles from the guard to a rim. The
 * number of sides of each, 0 where guards look all around; corner 0 is the guard, the others follow
 * around the rim; the corners of a face, counted over all guards, with `sides` + 1 corners each. */
enum { VIEW_FRAME = 4, VIEW_SIDES = 24 };
size_t scene_view_sides(const scene_job *job);
void scene_view_corner(const scene_job *job, size_t guard, size_t corner, double p[3]);
void scene_view_face(const scene_job *job, size_t face, uint32_t corners[3]);

/* One writer for each format. */
starg_status scene_write_glb(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_vtu(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_ply(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_obj(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_3mf(starg_context *context, const scene_job *job, const char *path);
