/* SPDX-License-Identifier: Apache-2.0 */
/* Orients each patch by breadth-first search across manifold edges. A patch whose search returns to
 * a face with the opposite side is one-sided, like a Moebius strip: it bounds nothing and is
 * dropped. Of the two orientations of a patch, the one that reverses fewer faces is used. */
#include "mesh/examine.h"
#include "mesh/repair/repair.h"

typedef struct walk {
    repair_state *state;
    mesh_topology *topology;
    uint8_t *side; /* per face: 0 unseen, 1 as given, 2 reversed */
    uint32_t *queue;
} walk;

/* Gives the neighbour across h the consistent side; false if it already has the other one. */
static bool visit_neighbour(walk *w, uint32_t h, size_t *count) {
    uint32_t twin = w->topology->twin[h];
    if (twin == TOPOLOGY_NONE)
        return true;
    bool against = w->state->faces.data[h] == w->state->faces.data[twin];
    uint8_t own = w->side[h / 3], wanted = against ? (uint8_t)(3 - own) : own;
    if (w->side[twin / 3] != 0)
        return w->side[twin / 3] == wanted;
    w->side[twin / 3] = wanted;
    w->queue[(*count)++] = twin / 3;
    return true;
}

static void orient_patch(walk *w, uint32_t first) {
    size_t count = 1, turned = 0;
    bool two_sided = true;
    w->side[first] = 1;
    w->queue[0] = first;
    for (size_t i = 0; i < count; i++)
        for (uint32_t h = 3 * w->queue[i]; h < 3 * w->queue[i] + 3; h++)
            two_sided = visit_neighbour(w, h, &count) && two_sided;
    for (size_t i = 0; i < count; i++)
        turned += w->side[w->queue[i]] == 2;
    uint8_t turn = 2 * turned > count ? 1 : 2;
    for (size_t i = 0; i < count; i++) {
        if (!two_sided)
            w->state->flags.data[w->queue[i]] |= REPAIR_GONE;
        else if (w->side[w->queue[i]] == turn)
            repair_turn(w->state, w->queue[i]);
    }
    if (!two_sided)
        w->state->one_sided_faces += count;
}

starg_status repair_orient(repair_state *state) {
    starg_status status = STARG_OK;
    walk w = {.state = state};
    starg_mesh view = repair_view(state);
    STARG_TRY(topology_create(state->context, &view, &w.topology));
    STARG_NEW_ZERO(state->context, REPAIR_STAGE, w.side, view.face_count);
    STARG_NEW(state->context, REPAIR_STAGE, w.queue, view.face_count);
    for (uint32_t f = 0; f < view.face_count; f++)
        if (w.side[f] == 0)
            orient_patch(&w, f);
    repair_compact(state);
done:
    topology_free(w.topology);
    starg_release(state->context, w.side);
    starg_release(state->context, w.queue);
    return status;
}

starg_status repair_turn_shells(repair_state *state) {
    starg_status status = STARG_OK;
    mesh_examination all = {0};
    starg_mesh view = repair_view(state);
    STARG_TRY(mesh_examine(state->context, &view, &all));
    for (size_t f = 0; f < view.face_count; f++)
        if (all.shells[all.topology->component[f]].turn)
            repair_turn(state, f);
done:
    mesh_examination_free(state->context, &all);
    return status;
}
