/* SPDX-License-Identifier: Apache-2.0 */
/* What the guards of a result see, found anew, and what is concluded from it. */
#ifndef STARG_VERIFY_FACTS_H
#define STARG_VERIFY_FACTS_H

#include "core/bits.h"
#include "starguard/verify.h"
#include "verify/sight.h"
#include "verify/surface.h"
#include "verify/tree.h"

typedef struct verify_facts {
    const verify_surface *surface;
    const starg_guards *guards;
    int scale;
    bool *inside;         /* each guard                                             */
    double *distance;     /* from each guard to the surface; only with a clearance  */
    double *standoff;     /* from each guard to the model; where that matters       */
    starg_bits *faces;    /* a row for each guard: the faces that it sees           */
    starg_bits *vertices; /* likewise; only where vertices are the target           */
    uint8_t *vertex;      /* 1: some guard sees the vertex; likewise                */
    uint8_t *face;        /* 1: some guard sees the face                            */
    uint8_t *wanted;      /* 1: the face is to be seen; others have the area 0 and count as seen */
    uint8_t *used;        /* vertices that such faces name                          */
    double *area;         /* of each face, in scaled units                          */
    verify_tree *tree;    /* of the surface                                         */

    size_t wanted_faces, covered_faces, used_vertices, covered_vertices;
    double covered_area, total_area;
} verify_facts;

static inline bool verify_targets_vertices(const verify_facts *known) {
    return known->guards->options.visibility.target == STARG_TARGET_VERTICES;
}

/* May guards stand in a part of the free space only? */
bool verify_space_is_narrow(const starg_space_options *space);

/* What must be seen: faces, or vertices. */
static inline const starg_bits *verify_rows(const verify_facts *known) {
    return verify_targets_vertices(known) ? known->vertices : known->faces;
}

/* In how many rows each column is; the caller releases `held`. Errors: MEMORY. */
starg_status verify_count_held(const verify_facts *known, uint32_t **held);

/* The view of a guard that looks all around. */
verify_view verify_view_around(const starg_guards *guards);

/* Does a guard look in one direction? */
static inline bool verify_is_aimed(const verify_facts *known) {
    return known->guards->options.visibility.cone < 360 ||
           known->guards->options.visibility.fov[0] > 0;
}

/* How many of the elements that no guard sees could be seen (verify/coverable.c)? The search ends
 * once there are more than `enough`. */
typedef struct verify_coverable {
    size_t proven; /* elements that a guard at some place would see */
    size_t first;  /* the first of them                             */
    double place[3];
} verify_coverable;
starg_status verify_find_coverable(const verify_facts *known, size_t enough,
                                   verify_coverable *found);

/* How many guards of the result, chosen among them, are as good as all (verify/needed.c)? */
starg_status verify_find_needed(const verify_facts *known, size_t *needed);

/* How many faces do two guards see that are the baseline apart (verify/baseline.c)? */
size_t verify_count_paired(const verify_facts *known);

/* Points that are drawn for that. */
enum { VERIFY_PLACES = 12 };

/* Columns that fewer guards see than redundancy asks for (verify/redundancy.c). */
typedef struct verify_lack {
    size_t lacking; /* seen by some guard, but by too few                   */
    size_t points;  /* places inside that were looked from; 0: none needed  */
    size_t meeting; /* of them those that see something that is lacking     */
} verify_lack;
starg_status verify_find_lack(const verify_facts *known, verify_lack *found);

/* Which level or guard contradicts the others (verify/levels.c)? */
typedef struct verify_levels {
    bool grow;   /* each has more vertices than the one before, the last those of the model */
    bool kept;   /* guards that are kept were guards of the level before                   */
    bool inside; /* all of their guards are strictly inside of the model                   */
    bool named;  /* a guard is among those of its level and of all that follow              */
} verify_levels;
verify_levels verify_check_levels(const verify_facts *known);

#endif
