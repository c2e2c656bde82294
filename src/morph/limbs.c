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

#include <stdio.h>
#include <stdlib.h>
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
    for (size_t i = 0; i < pairs.count; i++) fprintf(stderr, "pair %u%c(%.2f) %u%c(%.2f)\n", pairs.data[i].ways[0].limb, "+-"[pairs.data[i].ways[0].back], trees[0].limbs.data[pairs.data[i].ways[0].limb].length/trees[0].length, pairs.data[i].ways[1].limb, "+-"[pairs.data[i].ways[1].back], trees[1].limbs.data[pairs.data[i].ways[1].limb].length/trees[1].length);
    fprintf(stderr, "limbs %zu %zu pieces %zu walls %zu\n", trees[0].limbs.count, trees[1].limbs.count, cuts.piece_count, cuts.walls.count);
    *found = cuts.piece_count > 1;
    if (getenv("SG_DUMP")) for (int end = 0; end < 2; end++) for (uint32_t p = 0; p < cuts.piece_count; p++) { char name[99]; snprintf(name, 99, "/tmp/q/dump/p%u_%d.txt", p, end); FILE *f = fopen(name, "w"); const cone_builder *b = &cuts.sides[end];
      for (size_t i = 0; i < b->pieces.data[p].triangles.count; i++) { for (int k = 0; k < 3; k++) { const double *q = cones_place_of(b, 0, b->corners.data[3 * b->pieces.data[p].triangles.data[i] + k]); fprintf(f, "%.17g %.17g %.17g ", q[0], q[1], q[2]); } fprintf(f, "-1\n"); }
      for (size_t w = 0; w < cuts.walls.count; w++) for (int side = 0; side < 2; side++) if (cuts.walls.data[w].pieces[side] == p) { const number_list *l = &cuts.walls.data[w].loops[end]; for (size_t j = 0; j < l->count; j++) { uint32_t u = l->data[j], v = l->data[(j+1)%l->count]; const uint32_t t[3] = {side == 0 ? v : u, side == 0 ? u : v, cuts.walls.data[w].hubs[end]}; for (int k = 0; k < 3; k++) { const double *q = cones_place_of(b, 0, t[k]); fprintf(f, "%.17g %.17g %.17g ", q[0], q[1], q[2]); } fprintf(f, "%zu\n", w); } }
      fclose(f); }
    for (uint32_t p = 0; p < cuts.piece_count && *found; p++)
{        TRY(limbs_map_piece(&cuts, p, &surface, found));
    fprintf(stderr, "piece %u found %d faces %zu\n", p, *found, surface.faces.count/3); }
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
    *found = left == 0; fprintf(stderr, "left %zu\n", left);
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
