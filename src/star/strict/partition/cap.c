/* SPDX-License-Identifier: Apache-2.0 */
/* Triangulates the region that edges in a plane enclose.
 *
 * Problem: a plane meets the surface of a piece in a planar straight-line graph: loops, perhaps
 * nested, that may share vertices, and edges and vertices in which the surface only touches the
 * plane. Fill the region inside the piece with triangles on the vertices of the graph.
 *
 * Method: project along the axis closest to the normal, where signs are exact. Build a constrained
 * triangulation of the graph (geometry/constrained.c). The winding number, 0 outside, changes
 * between triangles only across edges of the graph, by an amount that the surface gives; the
 * triangles of winding number 1 are the cap.
 *
 * Invariants: the boundary of the triangles is always the chain of the edges. If vertices are
 * rounded off their plane, edges may cross: then there is no cap. Cost: that of the
 * triangulation. */
#include "star/strict/partition/partition.h"

#include <math.h>

static const int32_t UNKNOWN = INT32_MIN;

void cap_choose_view(const double normal[3], int *u, int *v) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    *u = (axis + (normal[axis] < 0 ? 2 : 1)) % 3;
    *v = (axis + (normal[axis] < 0 ? 1 : 2)) % 3;
}

typedef struct winder {
    starg_context *context;
    const constrained_triangle *triangles;
    size_t count;
    int32_t *winding; /* per triangle */
    cap_indices stack;
} winder;

/* Sets the winding number of a triangle, as seen across one of its edges; it must be consistent. */
static starg_status give(winder *w, uint32_t number, int32_t winding, bool *done) {
    if (w->winding[number] != UNKNOWN) {
        *done = *done && w->winding[number] == winding;
        return STARG_OK;
    }
    w->winding[number] = winding;
    *done = *done && (winding == 0 || winding == 1);
    PUSH(w->context, "decompose", &w->stack, number);
    return STARG_OK;
}

static starg_status wind(winder *w, bool *done) {
    for (uint32_t i = 0; i < w->count; i++)
        w->winding[i] = UNKNOWN;
    for (uint32_t i = 0; i < w->count; i++)
        for (int k = 0; k < 3; k++)
            if (w->triangles[i].beyond[k] == CONSTRAINED_NONE)
                TRY(give(w, i, w->triangles[i].turns[k], done));
    while (w->stack.count > 0) {
        uint32_t number = w->stack.data[--w->stack.count];
        const constrained_triangle *t = &w->triangles[number];
        for (int k = 0; k < 3; k++)
            if (t->beyond[k] != CONSTRAINED_NONE)
                TRY(give(w, t->beyond[k], w->winding[number] - t->turns[k], done));
    }
    return STARG_OK;
}

static starg_status take(const winder *w, cap_indices *triangles) {
    for (size_t i = 0; i < w->count; i++)
        for (int k = 0; k < 3 && w->winding[i] == 1; k++)
            PUSH(w->context, "decompose", triangles, w->triangles[i].corners[k]);
    return STARG_OK;
}

starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const cap_edges *edges, const cap_indices *loose, cap_indices *triangles,
                      bool *done) {
    starg_status status = STARG_OK;
    constrained_triangles all = {0};
    winder w = {.context = context};
    int u, v;
    cap_choose_view(normal, &u, &v);
    STARG_TRY(constrained_triangulate(context, points, u, v, edges->data, edges->count, loose->data,
                                      loose->count, &all, done));
    if (!*done || all.count == 0)
        goto done;
    w.triangles = all.data;
    w.count = all.count;
    STARG_NEW(context, "decompose", w.winding, w.count);
    STARG_TRY(wind(&w, done));
    if (*done)
        STARG_TRY(take(&w, triangles));
done:
    RELEASE(all.data, w.stack.data, w.winding);
    return status;
}
