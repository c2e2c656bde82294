/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/repair/repair.h"

#include <math.h>

enum { FEW = 256 };

starg_status repair_index_create(const repair_state *state, repair_index *index) {
    *index = (repair_index){.state = state, .tracked = repair_face_count(state)};
    NEW(state->context, REPAIR_STAGE, index->vertices, state->vertices.count);
    NEW(state->context, REPAIR_STAGE, index->faces, state->faces.count);
    if (index->tracked != 0) { /* otherwise the arrays may be NULL */
        memcpy(index->vertices, state->vertices.data, state->vertices.count * sizeof(double));
        memcpy(index->faces, state->faces.data, state->faces.count * sizeof(uint32_t));
    }
    return bvh_create(state->context, index->vertices, index->faces, index->tracked, &index->tree);
}

void repair_index_free(repair_index *index) {
    if (index->state == NULL)
        return;
    RELEASE(index->vertices, index->faces);
    bvh_free(index->tree);
    *index = (repair_index){0};
}

bool repair_index_is_stale(const repair_index *index) {
    size_t added = repair_face_count(index->state) - index->tracked;
    return added > FEW && added > index->tracked / 8;
}

typedef struct query {
    const repair_index *index;
    const uint32_t *corner;
    bvh_visit *visit;
    void *user;
} query;

static bool visit_face(void *user, uint32_t face) {
    query *q = user;
    const repair_state *state = q->index->state;
    const uint32_t *other = repair_face(state, face);
    if ((state->flags.data[face] & REPAIR_GONE) || other == q->corner)
        return true;
    if (faces_contact(state->vertices.data, q->corner, other) != TRIANGLES_CROSS)
        return true;
    return q->visit(q->user, face);
}

static bvh_box box_of(const repair_state *state, const uint32_t corner[3]) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        double a = repair_position(state, corner[0])[k], b = repair_position(state, corner[1])[k];
        double c = repair_position(state, corner[2])[k];
        box.lower[k] = fmin(a, fmin(b, c));
        box.upper[k] = fmax(a, fmax(b, c));
    }
    return box;
}

void repair_index_query(const repair_index *index, const uint32_t corner[3], bvh_visit *visit,
                        void *user) {
    query q = {index, corner, visit, user};
    bvh_box box = box_of(index->state, corner);
    if (!bvh_query_box(index->tree, &box, visit_face, &q))
        return;
    for (size_t f = index->tracked; f < repair_face_count(index->state); f++) {
        bvh_box other = box_of(index->state, repair_face(index->state, f));
        if (bvh_boxes_meet(&box, &other) && !visit_face(&q, (uint32_t)f))
            return;
    }
}

static bool stop_at_first(void *user, uint32_t face) {
    (void)face;
    *(bool *)user = true;
    return false;
}

bool repair_index_crosses(const repair_index *index, const uint32_t corner[3]) {
    bool found = false;
    repair_index_query(index, corner, stop_at_first, &found);
    return found;
}
