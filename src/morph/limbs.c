/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids without handles, filled alike by way of their limbs.
 *
 * Problem: fill two solids with the same tetrahedra, positive in both. A surface map is not given:
 * one is made that suits the solids.
 *
 * Stages: limbs of both by their skeletons, in pairs (limbs_tree.c); flat walls across pairs of
 * limbs, which part both into pieces that correspond (limbs_cut.c); the surfaces of each pair of
 * pieces, mapped onto each other so that the walls' loops correspond (limbs_map.c); pieces with
 * kernels in both are filled by cones, others are cut further (star/compatible/cones.c).
 *
 * Where a surface map comes first and cuts follow, a flat wall in one solid has any loop in the
 * other. Here walls are flat in both. Cost: that of its stages. */
#include "morph/limbs.h"

#include "geometry/vec3.h"

static const char STAGE[] = "limbs";
enum { WORK = 30 }; /* faces that may be looked at for cuts, over the number of all */

static void free_surface(limb_surface *s) {
    RELEASE(s->places[0].data, s->places[1].data, s->faces.data, s->sides.data, s->at.data);
}

/* The walls between pieces. */
static starg_status add_walls(const limb_cuts *cuts, limb_surface *out) {
    for (size_t i = 0; i < cuts->walls.count; i++) {
        const limb_wall *wall = &cuts->walls.data[i];
        const number_list *loop = &wall->loops[0];
        uint32_t hub = (uint32_t)(out->places[0].count / 3);
        for (int end = 0; end < 2; end++)
            for (int k = 0; k < 3; k++)
                PUSH(cuts->context, STAGE, &out->places[end],
                     cones_place_of(&cuts->sides[end], 0, wall->hubs[end])[k]);
        for (size_t j = 0; j < loop->count; j++) {
            const uint32_t corners[3] = {out->at.data[loop->data[(j + 1) % loop->count]],
                                         out->at.data[loop->data[j]], hub};
            for (int k = 0; k < 3; k++)
                PUSH(cuts->context, STAGE, &out->faces, corners[k]);
            for (int side = 0; side < 2; side++)
                PUSH(cuts->context, STAGE, &out->sides, wall->pieces[side]);
        }
    }
    return STARG_OK;
}

/* What comes of beginning with the limbs of one solid, or of the other one. */
typedef struct limb_trial {
    limb_surface surface;
    size_t piece_count;
    bool found;
} limb_trial;

static starg_status map_pieces(limb_tree trees[2], limb_trial *out) {
    starg_context *context = trees[0].context;
    SCOPED limb_pairs pairs = {0};
    SCOPED_BY(limbs_free_cuts) limb_cuts cuts = {.context = context};
    TRY(limbs_pair(trees, &pairs));
    TRY(limbs_cut(context, trees, &pairs, &cuts));
    out->piece_count = cuts.piece_count;
    out->found = cuts.piece_count > 1;
    for (uint32_t p = 0; p < cuts.piece_count && out->found; p++)
        TRY(limbs_map_piece(&cuts, p, &out->surface, &out->found));
    return out->found ? add_walls(&cuts, &out->surface) : STARG_OK;
}

static void swap_trees(limb_tree trees[2]) {
    const limb_tree former = trees[0];
    trees[0] = trees[1];
    trees[1] = former;
}

/* Limbs that are added to the trees are taken away again. */
static starg_status map_pieces_from(limb_tree trees[2], int first, limb_trial *out) {
    const limb_tree before[2] = {trees[0], trees[1]};
    if (first == 1)
        swap_trees(trees);
    starg_status status = map_pieces(trees, out);
    if (first == 1) {
        swap_trees(trees);
        double *const former = out->surface.places[0].data;
        out->surface.places[0].data = out->surface.places[1].data;
        out->surface.places[1].data = former;
    }
    for (int end = 0; end < 2; end++) {
        trees[end].nodes.count = before[end].nodes.count;
        trees[end].points.count = before[end].points.count;
        trees[end].limbs.count = before[end].limbs.count;
    }
    return status;
}

static starg_status fill(starg_context *context, const limb_trial *trial, compatible_cones *out,
                         bool *found) {
    const limb_surface *s = &trial->surface;
    const compatible_surface input = {.places = {s->places[0].data, s->places[1].data},
                                      .vertex_count = s->places[0].count / 3,
                                      .faces = s->faces.data,
                                      .sides = s->sides.data,
                                      .count = s->faces.count / 3,
                                      .piece_count = trial->piece_count,
                                      .work = WORK * (s->faces.count / 3)};
    size_t left;
    TRY(compatible_fill(context, &input, out, &left));
    *found = left == 0;
    return STARG_OK;
}

static void free_trials(limb_trial (*trials)[2]) {
    for (int i = 0; i < 2; i++)
        free_surface(&(*trials)[i].surface);
}

/* From the solid whose limbs give fewer faces, else from the other one. */
static starg_status fill_either(limb_tree trees[2], compatible_cones *out, bool *found) {
    SCOPED_BY(free_trials) limb_trial trials[2] = {{.found = false}, {.found = false}};
    for (int first = 0; first < 2; first++)
        TRY(map_pieces_from(trees, first, &trials[first]));
    bool second = trials[1].surface.faces.count < trials[0].surface.faces.count;
    int best = trials[1].found && (second || !trials[0].found);
    for (int i = 0; i < 2 && !*found; i++, best = 1 - best)
        if (trials[best].found)
            TRY(fill(trees[0].context, &trials[best], out, found));
    return STARG_OK;
}

starg_status limbs_fill(starg_context *context, const starg_mesh *const meshes[2],
                        compatible_cones *out, bool *found) {
    starg_status status = STARG_OK;
    starg_solid *solids[2] = {NULL, NULL};
    limb_tree trees[2] = {{.context = context}, {.context = context}};
    bool good = true;
    *found = false;
    for (int end = 0; end < 2 && good; end++) {
        STARG_TRY(solid_make(context, meshes[end], &solids[end]));
        STARG_TRY(limbs_find_tree(context, solids[end], &trees[end], &good));
    }
    if (good)
        STARG_TRY(fill_either(trees, out, found));
done:
    for (int end = 0; end < 2; end++) {
        limbs_free_tree(&trees[end]);
        starg_solid_free(solids[end]);
    }
    return status;
}
