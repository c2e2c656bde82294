/* SPDX-License-Identifier: Apache-2.0 */
/* A piece between walls in one of two solids, and the cuts that part its walls into two sets. */
#pragma once

#include "geometry/bvh.h"
#include "morph/limbs.h"

enum { LIMB_VIEWS = 64, LIMB_WALLS_MOST = 64 }; /* points inside a piece, walls around one */

/* The best cut for a set of walls: those on the side without the first one. */
typedef struct set_cut {
    uint64_t set;
    double score;
    double *heights; /* per vertex of the piece, above 0 on that side; NULL: a chip */
    bool fan;        /* about a hub that is given, else flat */
    double hub[3];
} set_cut;

/* A sharp edge at which the solid turns by more than half a turn; its length times the rest. */
typedef struct notch {
    uint32_t ends[2];
    double weight;
} notch;

/* A piece in one of the solids. */
typedef struct limb_side {
    limb_cuts *cuts;
    const bvh *surface; /* of the solid */
    uint32_t which;
    int end;
    double bonus; /* of star-shaped sides */
    double size;  /* the root of twice the area of its surface */
    bool blind;
    bool loose;                  /* cuts may leave less than two star-shaped sides */
    double guard[3];             /* sees all of it, with room to spare, if it is not blind */
    number_list walls;           /* around the piece */
    number_list faces, vertices; /* of the surface */
    number_list beside;          /* faces on one side of a cut, with walls */
    edge_list edges;
    cut_loops rim;
    loop_places wall;
    double *heights, *own;       /* per vertex: of a plane, and of one part above it */
    double views[LIMB_VIEWS][3]; /* points inside */
    float *shares;               /* of faces in the piece's area */
    float *fronts; /* faces x LIMB_VIEWS: the share of a face, 0 where it faces away */
    STARG_ARRAY(notch) notches;
    double notched; /* the sum of their weights */
    uint32_t *part;
    uint8_t *flat, *touched; /* per vertex: of faces in the plane; next to what is above it */
    STARG_ARRAY(set_cut) best;
} limb_side;

static inline cone_builder *limb_side_builder(const limb_side *s) {
    return &s->cuts->sides[s->end];
}

static inline const double *limb_side_at(const limb_side *s, uint32_t vertex) {
    return cones_place_of(limb_side_builder(s), 0, vertex);
}

static inline const limb_wall *limb_side_wall(const limb_side *s, size_t i) {
    return &s->cuts->walls.data[s->walls.data[i]];
}

static inline uint64_t limb_side_all_walls(const limb_side *s) {
    return s->walls.count > 0 ? UINT64_MAX >> (LIMB_WALLS_MOST - s->walls.count) : 0;
}

static inline void limb_side_turn(const limb_side *s, double *heights) {
    for (size_t i = 0; i < s->vertices.count; i++)
        heights[s->vertices.data[i]] *= -1;
}

/* ---- sides, and planes (limbs_planes.c) ---- */

/* All of a side but its cuts. Errors: MEMORY. */
starg_status limb_side_open(limb_cuts *cuts, const bvh *surface, int end, uint32_t which,
                            limb_side *s);
void limb_side_free(limb_side *s);

/* Adds the triangles of a wall, outward for the piece, to `beside`. */
starg_status limb_side_add_wall(limb_side *s, size_t i);

/* Which walls are above? *apart: none is on both sides, or met. */
uint64_t limb_side_set_above(const limb_side *s, bool *apart);

/* A level that meets no wall: a random one below those of a set, or one above all others, too.
 * *found: it is one. */
double limb_side_draw_level(limb_side *s, uint64_t set, bool above, bool *found);

/* The best cut for a set, or NULL. */
const set_cut *limb_side_cut_of(const limb_side *s, uint64_t set);

/* Keeps what is above in `own` if it is the best cut for its set. `hub`: that of a fan, or NULL. */
starg_status limb_side_keep(limb_side *s, uint64_t set, double score, const double *hub);

/* Weighs planes at notches, by what two points see, and random ones; planes that part one wall, or
 * two, from the others; and planes that part a set from the others. Errors: MEMORY. */
starg_status limb_side_draw_planes(limb_side *s);
starg_status limb_side_aim_at_few(limb_side *s);
starg_status limb_side_aim_planes(limb_side *s, uint64_t set);

/* ---- fans (limbs_fans.c) ---- */

/* Walls in directions next to that of one of them. */
uint64_t limb_side_draw_near(limb_side *s);

/* Seeks a fan that parts the walls of a set from the others in a piece that is star-shaped. Errors:
 * MEMORY. */
starg_status limb_side_aim_fans(limb_side *s, uint64_t set);

/* Cuts off a chip, with no wall, in a piece that is star-shaped: sets heights, and the hub. It is
 * put where the other solid's cut is, as walls are concerned. Errors: MEMORY. */
starg_status limb_side_find_chip(limb_side *s, const limb_side *other, double hub[3]);
