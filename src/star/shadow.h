/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes that guards of two pieces may stand in, and which faces their shadows are on. */
#ifndef STARG_STAR_SHADOW_H
#define STARG_STAR_SHADOW_H

#include "core/memory.h"
#include "visibility/box_parts.h"

#define SHADOW_NONE UINT32_MAX

/* A box of the tree of halves. */
typedef struct shadow_place {
    bvh_box box;
    uint32_t halves[2]; /* places, or NONE */
    bool outside;       /* no point of it is in the solid */
    double middle[3];   /* a point of the box, in the solid if one was found */
    uint64_t *blind;    /* bits by rank: no point of the box is strictly on the face's inner side */
    STARG_ARRAY(uint32_t) shadows; /* by point: see shadow_of */
} shadow_place;

typedef struct shadow_tables {
    starg_context *context;
    box_scene *scene;
    box_worker *worker;
    size_t words; /* of a row of bits by rank */
    double size;  /* of the solid: the longest side of its bounding box */
    STARG_ARRAY(shadow_place) places;
    STARG_ARRAY(double) points;    /* x 3 */
    STARG_ARRAY(uint32_t) patches; /* each as its number of faces and their ranks, the seed first */
    uint32_t *visit, *stack;       /* by rank: the last flood that came here; of a flood */
    uint32_t flood;
    uint64_t looks; /* at faces so far */
} shadow_tables;

/* The first place is a box about the solid, whose coordinates have few digits. The tables must be
 * freed in any case. Errors: MEMORY. */
starg_status shadow_tables_make(starg_context *context, const starg_solid *solid,
                                shadow_tables *out);
void shadow_tables_free(shadow_tables *t);

/* The axis that a place is halved across. */
int shadow_axis(const bvh_box *box);

/* The halves of a place, the lower one first. Errors: MEMORY. */
starg_status shadow_halve(shadow_tables *t, uint32_t place, uint32_t halves[2]);

/* Where the patch begins that all rays end on that begin in a point, seen from which they go away
 * from a point of the place, or NONE. The point is strictly on the inner side of all faces of the
 * patch. Errors: MEMORY. */
starg_status shadow_of(shadow_tables *t, uint32_t place, uint32_t point, uint32_t *patch);

/* Is no point of the place strictly on the inner side of any face of the patch? */
bool shadow_is_blind(const shadow_tables *t, uint32_t place, uint32_t patch);

/* The same for the face that one ray ends on: from x, away from the middle of a place. */
bool shadow_may_be_blind(const shadow_tables *t, uint32_t from, const double x[3], uint32_t place);

#endif
