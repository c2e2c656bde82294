/* SPDX-License-Identifier: Apache-2.0 */
/* Replaces a self-intersecting surface by the boundary of what it encloses (mesh/union). Kept faces
 * come first, in order, then the parts of the others. The result may touch itself along edges or at
 * vertices and must then be split. */
#include "mesh/repair/repair.h"
#include "mesh/union/union.h"

/* Appends new vertices after the existing ones. */
static starg_status take_vertices(repair_state *state, const union_surface *result) {
    starg_status status = STARG_OK;
    for (size_t v = repair_vertex_count(state); v < result->vertices.count / 3; v++) {
        uint32_t vertex;
        STARG_TRY(repair_add_vertex(state, result->vertices.data + 3 * v, REPAIR_NEW, &vertex));
    }
done:
    return status;
}

static starg_status take_faces(repair_state *state, const union_surface *result) {
    starg_status status = STARG_OK;
    size_t before = repair_face_count(state);
    uint8_t *cut = NULL;
    STARG_NEW_ZERO(state->context, REPAIR_STAGE, cut, before);
    for (size_t f = 0; f < before; f++)
        state->flags.data[f] |= REPAIR_GONE;
    for (size_t f = 0; f < union_face_count(result); f++) {
        uint32_t origin = result->origin.data[f];
        const uint32_t *corner = result->faces.data + 3 * f;
        if (result->flags.data[f] & UNION_PART) {
            state->report.faces_cut += !cut[origin];
            cut[origin] = 1;
            STARG_TRY(repair_add_face(state, corner[0], corner[1], corner[2], REPAIR_ADDED));
        } else {
            state->flags.data[origin] &= (uint8_t)~REPAIR_GONE;
            memcpy(repair_face(state, origin), corner, 3 * sizeof *corner);
        }
    }
    repair_compact(state);
done:
    starg_release(state->context, cut);
    return status;
}

starg_status repair_unite(repair_state *state) {
    starg_status status = STARG_OK;
    union_surface result = {.context = state->context};
    union_report report;
    starg_mesh view = repair_view(state);
    STARG_TRY(union_of_mesh(state->context, &view, &result, &report));
    STARG_TRY(take_vertices(state, &result));
    STARG_TRY(take_faces(state, &result));
    state->report.union_rounds = report.rounds;
    state->report.rounding = report.moved;
done:
    union_surface_free(&result);
    return status;
}
