/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids without handles, cut alike at their limbs. */
#pragma once

#include "geometry/bvh.h"
#include "mesh/solid.h"
#include "star/compatible/compatible.h"
#include "star/compatible/cone_builder.h"
#include "starguard/skeleton.h"

/* ---- limbs, by the skeleton (limbs_tree.c) ---- */

/* Between two joints or ends of the skeleton. */
typedef struct limb {
    uint32_t nodes[2];
    size_t first, count; /* its polygon in `points` of the tree */
    double length;
    double radii[2]; /* of the joints; 0 at ends */
} limb;

/* A joint or end. */
typedef struct limb_node {
    double place[3];
    double radius;   /* of a ball inside, also near an end */
    uint32_t vertex; /* at an end, near it; NOWHERE at a joint */
} limb_node;

/* The skeleton of a solid, a tree. Joints that lie in one another's balls are one. */
typedef struct limb_tree {
    starg_context *context;
    const starg_mesh *mesh; /* of the solid */
    STARG_ARRAY(limb_node) nodes;
    STARG_ARRAY(double) points; /* x 3 */
    STARG_ARRAY(limb) limbs;
    double length; /* of all */
    double lower[3], extent[3];
} limb_tree;

/* *found: there is a tree with a limb. Errors: those of the skeleton. */
starg_status limbs_find_tree(starg_context *context, const starg_solid *solid, limb_tree *out,
                             bool *found);
/* Errors: MEMORY. */
starg_status limbs_copy_tree(starg_context *context, const limb_tree *tree, limb_tree *out);
void limbs_free_tree(limb_tree *tree);

/* A limb and the end that it begins with. */
typedef struct limb_way {
    uint32_t limb;
    bool back;
} limb_way;

/* A limb of each tree, in ways that correspond; those nearer to the root come first. */
typedef struct limb_pair {
    limb_way ways[2];
} limb_pair;
typedef STARG_ARRAY(limb_pair) limb_pairs;

/* Pairs limbs of two trees so that pairs that meet in one meet in the other, and as much as
 * possible of both has a partner, of about its length and in about its place. What has none gets a
 * small one, which is added to the other tree: the cap at a convex vertex. Errors: MEMORY. */
starg_status limbs_pair(limb_tree trees[2], limb_pairs *out);

/* The point at a share of a limb's length, and the direction in which the limb runs there. */
void limbs_point_at(const limb_tree *tree, limb_way way, double share, double point[3],
                    double direction[3]);

/* Marks joints and ends that follow on a limb. */
void limbs_mark_beyond(const limb_tree *tree, limb_way way, uint8_t *marks);

/* ---- cuts (limbs_cut.c) ---- */

/* A flat wall in either solid, spanned from a hub. Its loops correspond vertex by vertex. */
typedef struct limb_wall {
    number_list loops[2]; /* vertices, with the far side on the left */
    uint32_t hubs[2];
    uint32_t pieces[2]; /* on the left, on the right */
} limb_wall;

/* The surfaces of two solids, in pieces between loops. The places of a builder are the same. */
typedef struct limb_cuts {
    starg_context *context;
    cone_builder sides[2];
    number_list mates; /* per vertex of the first surface: the one of the second, or NOWHERE */
    STARG_ARRAY(limb_wall) walls;
    size_t piece_count, resisting; /* the latter are not star-shaped in both */
} limb_cuts;

/* Cuts both at pairs of limbs, alike, opens walls between pieces whose union is star-shaped in
 * both, and divides those that are not. Errors: MEMORY, CANCELLED. */
starg_status limbs_cut(starg_context *context, const limb_tree trees[2], const limb_pairs *pairs,
                       limb_cuts *out);
void limbs_free_cuts(limb_cuts *cuts);
void limbs_free_loops(starg_context *context, limb_wall *walls, size_t count);

/* The normal of a wall in one of the solids, as long as twice its area. */
void limbs_find_normal(const limb_cuts *cuts, const limb_wall *wall, int end, double out[3]);

/* Adds walls until all pieces are star-shaped in both solids, or resist. `surfaces`: those of the
 * solids. Errors: MEMORY, CANCELLED. (limbs_part.c) */
starg_status limbs_part(limb_cuts *cuts, bvh *const surfaces[2]);

/* Divides edges of two paths, or loops, so that they have the same number of vertices, by their
 * lengths, and makes those mates. Errors: MEMORY. */
starg_status limbs_match_paths(limb_cuts *cuts, number_list paths[2], bool closed);

/* ---- surfaces (limbs_map.c) ---- */

/* Triangles in two places, between pieces. */
typedef struct limb_surface {
    STARG_ARRAY(double) places[2]; /* x 3 */
    number_list faces, sides;      /* x 3, x 2 */
    number_list at;                /* per vertex of the first surface: the one here, or NOWHERE */
} limb_surface;

/* Adds the overlay of the two surfaces of a piece, which are mapped onto each other so that loops
 * correspond. *found: it was mapped. Errors: MEMORY, CANCELLED. */
starg_status limbs_map_piece(limb_cuts *cuts, uint32_t piece, limb_surface *out, bool *found);

/* ---- all of it (limbs.c) ---- */

/* Fills two solids without handles with the same tetrahedra, positive in both. *found: it was
 * possible; else there is no result. Errors: MEMORY, CANCELLED. */
starg_status limbs_fill(starg_context *context, const starg_mesh *const meshes[2],
                        compatible_cones *out, bool *found);

/* ---- a piece between walls in one solid, and cuts that part these (limbs_part.c) ---- */

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
    double *normals;             /* of faces, x 3, as long as twice their areas */
    float *shares;               /* of faces in the piece's area */
    float *fronts; /* faces x LIMB_VIEWS: the share of a face, 0 where it faces away */
    float fronts_sum[LIMB_VIEWS]; /* over all faces */
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
