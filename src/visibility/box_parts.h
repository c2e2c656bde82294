/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of visibility from a box: the tables of a scene, what a worker keeps, and the three proofs
 * that a vertex is hidden. */
#ifndef STARG_VISIBILITY_BOX_PARTS_H
#define STARG_VISIBILITY_BOX_PARTS_H

#include "geometry/predicates.h"
#include "visibility/box.h"
#include "visibility/box_shaft.h"
#include "visibility/box_tree.h"

/* A blocker, by its rank in the order of the tree; one line of cache. */
typedef struct box_triangle {
    uint32_t corner[3];
    uint32_t twin[3]; /* 3 x rank + edge of the neighbour; edge k runs from corner k to the next */
    double normal[3], offset; /* offset - normal . (p - centre) is positive on the inner side,  */
    double bound;             /* beyond this                                                    */
} box_triangle;

struct box_scene {
    starg_context *context;
    const starg_solid *solid;
    const bvh *tree;
    box_tree *boxes;      /* for segments */
    const double *points; /* of the mesh */
    size_t vertex_count, face_count;
    box_triangle *triangles; /* by rank                                                      */
    uint32_t *rank_of;       /* by face of the mesh                                          */
    uint32_t *outgoing;      /* by vertex: 3 x rank + corner of one triangle, or BOX_NONE    */
    bvh_box all;             /* of the blockers and of places where guards may be */
    double centre[3], extent;
    uint8_t *sound;       /* by rank: nonzero if it bounds the free space cleanly (box_sound.c) */
    uint8_t *sound_about; /* by vertex: do all of its triangles? */
};

struct box_worker {
    const box_scene *scene;
    bvh_box box;      /* of the question                                              */
    double centre[3]; /* of the box that is looked at, which may be a clipped one     */
    const bvh_box *current;
    uint32_t vertex;    /* that is asked about */
    uint32_t *crossing; /* ranks of the triangles that may meet the box of the question */
    size_t crossing_count;
    uint32_t *crossing_mark; /* by rank: the number of the question, if among them     */
    uint32_t question;
    uint32_t *visit;       /* by rank: number of the last flood that came here */
    uint32_t flood;        /* number of the last flood                         */
    uint32_t *stack;       /* 2 numbers an entry               */
    uint32_t *seed;        /* by vertex: rank of the seed that was last good   */
    uint32_t *answer_mark; /* by vertex: the number of the question, if known */
    uint8_t *answer;       /* by vertex: a box_reason_kind                    */
    uint64_t meeting; /* 1 + twice the last question of which the whole box was asked whether some
                         triangle meets it, 2 + that if one does */
    uint64_t tests, steps; /* vertices, and triangles looked at */
};

static inline const double *box_corner(const box_scene *scene, const box_triangle *t, int k) {
    return scene->points + 3 * (size_t)t->corner[k];
}

/* Side of the triangle's plane on which p, in the bounding box, lies: 1 inner, -1 outer, 0 in it.
 */
static inline int box_side(const box_scene *scene, const box_triangle *t, const double p[3]) {
    double sum = t->offset;
    for (int k = 0; k < 3; k++)
        sum -= t->normal[k] * (p[k] - scene->centre[k]);
    if (sum > t->bound)
        return 1;
    if (sum < -t->bound)
        return -1;
    return orient3d(box_corner(scene, t, 0), box_corner(scene, t, 1), box_corner(scene, t, 2), p);
}

/* Fills `sound` and `sound_about` from the rest of the scene. Errors: MEMORY. */
starg_status box_find_sound(box_scene *scene);

/* May the triangle meet the box? False only if it surely does not. */
bool box_may_cross(const box_scene *scene, const box_triangle *t, const bvh_box *box);

/* What becomes of a flood at triangles that meet the box, or hold v. */
typedef enum box_flood_kind {
    FLOOD_PATCH, /* it fails at both                */
    FLOOD_ENTRY, /* it fails at those that hold v   */
    FLOOD_FOLD   /* it stops before those that do; it fails at those that meet the box */
} box_flood_kind;

/* Does the flood of this seed close, with v on `side` of every triangle? Floods after number
 * `first` were made for the same v, box and kind. */
bool box_flood_closes(box_worker *worker, const box_shaft *shaft, uint32_t seed, int side,
                      box_flood_kind kind, uint32_t first);

/* Begins a question about the box: lists the triangles that may meet it. False: the box is surely
 * outside of the free space. */
bool box_enter(box_worker *worker, const bvh_box *box);

/* The next triangle around its vertex: corner numbers are 3 x rank + corner. */
static inline uint32_t box_turn(const box_scene *scene, uint32_t corner) {
    uint32_t k = corner % 3;
    return scene->triangles[corner / 3].twin[k == 0 ? 2 : k - 1];
}

/* May the directions of the triangle of this corner, v, meet those of the box? */
bool box_arc_may_meet(const box_scene *scene, const box_shaft *shaft, uint32_t corner);

/* Does the direction from v to the centre, which is not on the link, surely lead out of the solid?
 */
bool box_starts_outside(const box_worker *worker, const box_shaft *shaft);

/* Each of these is true only if no point of the shaft's box in the free space sees v. */

/* By a patch with a triangle that the segment from v to the centre meets, whose rank *seed becomes
 * (else BOX_NONE). If `recorded`, it is the first of them in the order of the tree. */
bool box_patch_hides(box_worker *worker, const box_shaft *shaft, box_flood_kind kind, bool recorded,
                     uint32_t *seed);
/* By the patches on which all triangles lie that meet the box. */
bool box_entry_hides(box_worker *worker, const box_shaft *shaft);
/* By where segments begin. */
bool box_start_hides(box_worker *worker, const box_shaft *shaft);
/* By where segments begin, and patches that begin next to the triangles around v. */
bool box_fold_hides(box_worker *worker, const box_shaft *shaft, bool recorded, uint32_t *seed);

#endif
