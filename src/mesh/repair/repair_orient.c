/* SPDX-License-Identifier: Apache-2.0 */
/* Orients each patch by breadth-first search across manifold edges. A patch whose search returns to
 * a face with the opposite side is one-sided, like a Moebius strip: it bounds nothing and is
 * dropped. Of the two orientations of a patch, the one that reverses fewer faces is used. */
#include "geometry/vec3.h"
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
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED uint8_t *side = NULL;
    SCOPED uint32_t *queue = NULL;
    starg_mesh view = repair_view(state);
    TRY(topology_create(state->context, &view, &topology));
    NEW_ZERO(state->context, REPAIR_STAGE, side, view.face_count);
    NEW(state->context, REPAIR_STAGE, queue, view.face_count);
    walk w = {.state = state, .topology = topology, .side = side, .queue = queue};
    for (uint32_t f = 0; f < view.face_count; f++)
        if (side[f] == 0)
            orient_patch(&w, f);
    repair_compact(state);
    return STARG_OK;
}

/* -1 if all shells that lie in no others face inwards, 1 if none does, 0 if some do. */
static int outer_facing(const mesh_examination *all) {
    size_t inward = 0, outer = 0;
    for (size_t i = 0; i < all->topology->component_count; i++) {
        const mesh_shell *own = &all->shells[i];
        bool outermost = own->depth == 0 || own->crossed;
        outer += outermost;
        inward += outermost && own->volume < 0;
    }
    return inward == 0 ? 1 : inward == outer ? -1 : 0;
}

/* A shell in another bounds a cavity. Not so before a union, if it faces as that one does: then
 * both are solids, one in the other. */
static bool must_turn(const repair_state *state, const mesh_shell *shell, int outer) {
    if (!state->options.unite || shell->depth == 0 || shell->crossed)
        return shell->turn;
    return outer != 0 ? outer < 0 : shell->around < 0;
}

/* Largest part of the area of a shell that fills holes, where the rest still proves what is inside:
 * seen from there it covers most directions. */
static const double MOST_FILLED = 0.25;

/* The area of each shell, and how much of it fills holes. */
static void measure_fillings(const repair_state *state, const starg_mesh *view,
                             const mesh_topology *topology, double *area, double *filled) {
    for (size_t f = 0; f < view->face_count; f++) {
        const uint32_t *corner = view->faces + 3 * f;
        double own =
            vec3_triangle_area(repair_position(state, corner[0]), repair_position(state, corner[1]),
                               repair_position(state, corner[2]));
        area[topology->component[f]] += own;
        filled[topology->component[f]] += state->flags.data[f] & REPAIR_FILLED ? own : 0;
    }
}

static void tell_sheets(repair_state *state) {
    size_t count = state->report.sheets_kept;
    if (count > 0)
        starg_log(state->context, STARG_LOG_NOTICE,
                  "%zu open %s closed by faces of more than a quarter of the area: nothing proves "
                  "which side is out, and faces keep theirs, which point into the volume",
                  count, count == 1 ? "sheet was" : "sheets were");
}

starg_status repair_turn_shells(repair_state *state) {
    SCOPED_BY(mesh_examination_free) mesh_examination all = {0};
    starg_mesh view = repair_view(state);
    SCOPED double *area = NULL, *filled = NULL;
    TRY(mesh_examine(state->context, &view, &all));
    size_t shells = all.topology->component_count;
    NEW_ZERO(state->context, REPAIR_STAGE, area, shells);
    NEW_ZERO(state->context, REPAIR_STAGE, filled, shells);
    measure_fillings(state, &view, all.topology, area, filled);
    int outer = outer_facing(&all);
    for (size_t f = 0; f < view.face_count; f++) {
        uint32_t shell = all.topology->component[f];
        if (!must_turn(state, &all.shells[shell], outer))
            continue;
        if (all.shells[shell].depth > 0 || state->options.unite ||
            filled[shell] <= MOST_FILLED * area[shell])
            repair_turn(state, f);
        else
            state->report.sheets_kept += all.shells[shell].first_face == f;
    }
    tell_sheets(state);
    return STARG_OK;
}
