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

static starg_status fill(starg_context *context, const starg_mesh *const meshes[2],
                         limb_tree trees[2], compatible_cones *out, bool *found) {
    SCOPED limb_pairs pairs = {0};
    SCOPED_BY(limbs_free_cuts) limb_cuts cuts = {.context = context};
    SCOPED_BY(free_surface) limb_surface surface = {.faces = {0}};
    size_t left;
    TRY(limbs_pair(trees, &pairs));
    TRY(limbs_cut(context, meshes, trees, &pairs, &cuts));
    *found = cuts.piece_count > 1;
    for (uint32_t p = 0; p < cuts.piece_count && *found; p++)
        TRY(limbs_map_piece(&cuts, p, &surface, found));
    if (!*found)
        return STARG_OK;
    TRY(add_walls(&cuts, &surface));
    const compatible_surface input = {.places = {surface.places[0].data, surface.places[1].data},
                                      .vertex_count = surface.places[0].count / 3,
                                      .faces = surface.faces.data,
                                      .sides = surface.sides.data,
                                      .count = surface.faces.count / 3,
                                      .piece_count = cuts.piece_count};
    TRY(compatible_fill(context, &input, out, &left));
    *found = left == 0;
    return STARG_OK;
}

starg_status limbs_fill(starg_context *context, const starg_mesh *const meshes[2],
                        compatible_cones *out, bool *found) {
    starg_status status = STARG_OK;
    starg_solid *solids[2] = {NULL, NULL};
    limb_tree trees[2] = {{.context = context}, {.context = context}};
    const starg_mesh *outward[2];
    *found = true;
    for (int end = 0; end < 2 && *found; end++) {
        STARG_TRY(solid_make(context, meshes[end], &solids[end]));
        outward[end] = starg_solid_mesh(solids[end]);
        STARG_TRY(limbs_find_tree(context, solids[end], &trees[end], found));
    }
    if (*found)
        STARG_TRY(fill(context, outward, trees, out, found));
done:
    for (int end = 0; end < 2; end++) {
        limbs_free_tree(&trees[end]);
        starg_solid_free(solids[end]);
    }
    return status;
}
