/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility from a region: what is surely hidden from every point of an axis-aligned box?
 *
 * Problem. Given a box c (closed; its corners are doubles) and targets, say of which targets it is
 * certain that no point of c in the free space sees them. Never wrong about "hidden"; a target that
 * stays "open" may be hidden all the same. What a point sees is defined in docs/visibility.md.
 *
 * Three notions are kept apart: the *blockers*, triangles with their neighbours and a tree
 * of boxes; the *free space*, the side of the blockers to which their inner sides turn; and the
 * *targets*. Today a solid's boundary gives all of them.
 *
 * Reasons for which a target is hidden (proofs stand in the files):
 * - outside  no blocker meets c, and c lies outside the free space; or no face has the vertex;
 * - far      all of c is farther from a vertex than the range;
 * - plane    no point of c is on the inner side of the face;
 * - start    from a vertex of the face, all segments to c begin outside the free space
 *            (box_start.c);
 * - patch    all segments from a vertex of the face to c pass a patch of triangles (box_flood.c);
 * - fold     start and patch together (box_fold.c);
 * - entry    all blockers that meet c turn their outer sides to the vertex, and the patches that
 *            they lie on close (box_flood.c).
 * Of points between vertices, corners of patches, only far, plane, patch and entry are tried.
 * First c is cropped to the bounding box of the blockers. For a face, it is clipped to the face's
 * inner half-space. A face is hidden as soon as one of its vertices is: what sees a face, by either
 * rule, sees its three vertices.
 *
 * The result for a box depends on that box alone, not on what the worker was asked before. */
#ifndef STARG_VISIBILITY_BOX_H
#define STARG_VISIBILITY_BOX_H

#include "geometry/bvh.h"
#include "mesh/solid.h"
#include "starguard/visibility.h"

#define BOX_NONE UINT32_MAX

typedef struct box_scene box_scene;

/* Makes the tables of a solid, which is borrowed. Immutable; any number of workers may use them.
 * Errors: MEMORY. */
starg_status box_scene_create(starg_context *context, const starg_solid *solid, box_scene **out);
void box_scene_free(box_scene *scene);
STARG_DROP(box_scene, box_scene)

/* Memory for one thread. Errors: MEMORY (without detail: it is called by parallel loops). */
typedef struct box_worker box_worker;
starg_status box_worker_create(const box_scene *scene, box_worker **out);
void box_worker_free(box_worker *worker);

typedef enum box_reason_kind {
    BOX_OPEN = 0, /* not hidden, as far as is known */
    BOX_OUTSIDE,
    BOX_FAR,
    BOX_PLANE,
    BOX_START,
    BOX_PATCH,
    BOX_FOLD,
    BOX_ENTRY,
    BOX_KINDS
} box_reason_kind;

/* Why a target is hidden: enough for a checker to find the proof again. */
typedef struct box_reason {
    box_reason_kind kind;
    uint32_t vertex; /* from which: FAR, START, PATCH, FOLD, ENTRY; or BOX_NONE                  */
    uint32_t
        seed; /* PATCH, perhaps FOLD: a face that meets the segment from the vertex to the centre of
                 the box (or what is left of it), and whose flood closes; else BOX_NONE */
    bool clipped; /* c was clipped to the inner half-space of the face                    */
} box_reason;

typedef struct box_question {
    bvh_box box;             /* lower <= upper, below 1e100 in magnitude                      */
    starg_target target;     /* what the targets are                                          */
    const uint32_t *targets; /* faces, vertices or corners of the mesh; NULL: all, in order   */
    size_t count;
    double range;          /* vertices farther than that are not seen; INFINITY: any are    */
    const uint64_t *among; /* bits by target: ask about these only, the others are hidden (a
                              box asks about what the box around it left open); NULL: all   */
    const uint64_t *known; /* bits by target: open without asking, for instance because a
                              point of the box sees them; NULL: none                        */
} box_question;

/* open: bits by target, 0 where hidden from the box. reasons, by target, or NULL; it is written
 * for the targets that were asked about, and takes longer. */
void box_look(box_worker *worker, const box_question *question, uint64_t *open,
              box_reason *reasons);

/* A plane across an axis, and what is cut off there. */
typedef struct box_cut {
    double at;
    int axis, above; /* above 1: what is above the plane is cut off, 0: what is below */
} box_cut;

enum { BOX_CUTS = 6 };

/* Cuts off parts of the box that box_look finds to be outside of the free space; returns the number
 * of cuts, in this order. */
int box_trim(box_worker *worker, bvh_box *box, box_cut cuts[BOX_CUTS]);

/* How many vertices were compared with boxes so far (a face whose plane does not decide counts for
 * each of its vertices that was looked at). */
uint64_t box_worker_tests(const box_worker *worker);

/* The same with the triangles that were looked at, in units of about a microsecond, since the last
 * call. Rounded alone, so that sums do not depend on who does what. */
uint64_t box_worker_take_work(box_worker *worker);

#endif
