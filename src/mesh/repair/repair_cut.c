/* SPDX-License-Identifier: Apache-2.0 */
/* Stages that cut faces: what touches becomes shared (mesh/union/conform.c), and a surface that
 * intersects itself becomes the boundary of what it encloses (mesh/union/union.c).
 *
 * Faces that stay come first, in order, then the parts of the others. */
#include "mesh/repair/repair.h"
#include "mesh/union/union.h"

enum { MOST_SUGGESTED = 20000 }; /* faces of a mesh for which distances are tried */

/* Appends new vertices after the existing ones. */
static starg_status take_vertices(repair_state *state, const union_surface *result) {
    for (size_t v = repair_vertex_count(state); v < result->vertices.count / 3; v++) {
        uint32_t vertex;
        TRY(repair_add_vertex(state, result->vertices.data + 3 * v, REPAIR_NEW, &vertex));
    }
    return STARG_OK;
}

static starg_status take_faces(repair_state *state, const union_surface *result,
                               size_t *cut_count) {
    size_t before = repair_face_count(state);
    SCOPED uint8_t *cut = NULL;
    NEW_ZERO(state->context, REPAIR_STAGE, cut, before);
    for (size_t f = 0; f < before; f++)
        state->flags.data[f] |= REPAIR_GONE;
    for (size_t f = 0; f < union_face_count(result); f++) {
        uint32_t origin = result->origin.data[f];
        const uint32_t *corner = result->faces.data + 3 * f;
        if (result->flags.data[f] & UNION_PART) {
            *cut_count += !cut[origin];
            cut[origin] = 1;
            TRY(repair_add_face(state, corner[0], corner[1], corner[2], REPAIR_ADDED));
        } else {
            state->flags.data[origin] &= (uint8_t)~REPAIR_GONE;
            memcpy(repair_face(state, origin), corner, 3 * sizeof *corner);
        }
    }
    repair_compact(state);
    return STARG_OK;
}

/* Replaces the surface by the boundary of what it encloses. Requires a closed surface with oriented
 * shells; leaves non-manifold edges and vertices to repair_split. */
starg_status repair_unite(repair_state *state) {
    SCOPED_BY(union_surface_free) union_surface result = {.context = state->context};
    union_report report;
    starg_mesh view = repair_view(state);
    TRY(union_of_mesh(state->context, &view, state->options.merge_distance, &result, &report));
    TRY(take_vertices(state, &result));
    TRY(take_faces(state, &result, &state->report.faces_cut));
    state->report.union_rounds = report.rounds;
    state->report.rounding = report.moved;
    return STARG_OK;
}

starg_status repair_conform(repair_state *state) {
    SCOPED_BY(union_surface_free) union_surface surface = {.context = state->context};
    conform_report report;
    starg_mesh view = repair_view(state);
    TRY(union_surface_make(state->context, &view, &surface));
    double distance = conform_distance(&surface, state->options.merge_distance);
    TRY(surface_conform(&surface, distance, &report));
    TRY(take_vertices(state, &surface));
    TRY(take_faces(state, &surface, &state->report.faces_divided));
    state->report.vertices_merged += report.merged;
    state->report.conforming = report.moved;
    return STARG_OK;
}

starg_status repair_suggest(const repair_state *state, double *distance) {
    bool closed = false;
    *distance = 0;
    if (state->input->face_count > MOST_SUGGESTED)
        return STARG_OK;
    for (double trial = 1e-11; trial < 2e-3 && !closed; trial *= 10) {
        TRY(conform_closes(state->context, state->input, trial, &closed));
        *distance = closed ? trial : 0;
    }
    return STARG_OK;
}
