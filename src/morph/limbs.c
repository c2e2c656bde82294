/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids without handles, filled alike by way of their limbs.
 *
 * Problem: fill two solids with the same tetrahedra, positive in both. A surface map is not given:
 * one is made that suits the solids.
 *
 * Stages: limbs of both by their skeletons, in pairs (limbs_tree.c); flat walls across pairs of
 * limbs, which part both into pieces that correspond (limbs_cut.c), and further ones until the
 * pieces are star-shaped in both (limbs_part.c); the surfaces of each pair of pieces, mapped onto
 * each other so that the walls' loops correspond (limbs_map.c). Pieces are filled by cones; those
 * that resisted are cut further (star/compatible/cones.c).
 *
 * Where a surface map comes first and cuts follow, a flat wall in one solid has any loop in the
 * other. Here walls are flat in both. Cost: that of its stages. */
#include "morph/limbs.h"

#include "core/parallel.h"
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
    size_t piece_count, resisting;
    bool found;
} limb_trial;

typedef struct limb_trials {
    const limb_tree *trees;
    limb_trial trial[2];
} limb_trials;

static starg_status map_pieces(starg_context *context, limb_tree trees[2], limb_trial *out) {
    SCOPED limb_pairs pairs = {0};
    SCOPED_BY(limbs_free_cuts) limb_cuts cuts = {.context = context};
    TRY(limbs_pair(trees, &pairs));
    TRY(limbs_cut(context, trees, &pairs, &cuts));
    out->piece_count = cuts.piece_count;
    out->resisting = cuts.resisting;
    out->found = cuts.piece_count > 1;
    for (uint32_t p = 0; p < cuts.piece_count && out->found; p++)
        TRY(limbs_map_piece(&cuts, p, &out->surface, &out->found));
    return out->found ? add_walls(&cuts, &out->surface) : STARG_OK;
}

static void free_trees(limb_tree (*trees)[2]) {
    limbs_free_tree(&(*trees)[0]);
    limbs_free_tree(&(*trees)[1]);
}

static starg_status map_from(starg_context *context, void *shared, void *scratch, size_t first) {
    limb_trials *all = shared;
    limb_trial *out = &all->trial[first];
    SCOPED_BY(free_trees) limb_tree trees[2] = {{.context = context}, {.context = context}};
    (void)scratch;
    for (size_t i = 0; i < 2; i++)
        TRY(limbs_copy_tree(context, &all->trees[i ^ first], &trees[i]));
    TRY(map_pieces(context, trees, out));
    if (first == 1) {
        double *const former = out->surface.places[0].data;
        out->surface.places[0].data = out->surface.places[1].data;
        out->surface.places[1].data = former;
    }
    return STARG_OK;
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

static void free_trials(limb_trials *all) {
    free_surface(&all->trial[0].surface);
    free_surface(&all->trial[1].surface);
}

/* From the solid whose limbs leave fewer pieces that resist, or give fewer faces, else from the
 * other one. */
static starg_status fill_either(starg_context *context, const limb_tree trees[2],
                                compatible_cones *out, bool *found) {
    SCOPED_BY(free_trials) limb_trials all = {.trees = trees};
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = 2, .shared = &all, .item = map_from, .silent = true};
    TRY(starg_parallel_for(context, &loop));
    const limb_trial *a = &all.trial[0], *b = &all.trial[1];
    const bool fewer = a->resisting != b->resisting
                           ? b->resisting < a->resisting
                           : b->surface.faces.count < a->surface.faces.count;
    int best = b->found && (fewer || !a->found);
    for (int i = 0; i < 2 && !*found; i++, best = 1 - best)
        if (all.trial[best].found)
            TRY(fill(context, &all.trial[best], out, found));
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
        STARG_TRY(fill_either(context, trees, out, found));
done:
    free_trees(&trees);
    starg_solid_free(solids[0]);
    starg_solid_free(solids[1]);
    return status;
}
