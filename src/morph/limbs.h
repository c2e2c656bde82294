/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids without handles, cut alike at their limbs. */
#pragma once

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
