/* SPDX-License-Identifier: Apache-2.0 */
/* Erosion in the order of the medial geodesic function [DS06, section 4].
 *
 * A sheet is the Voronoi facet between two sample points; its function value is the length of the
 * shortest path on the surface between them. A link that bounds exactly one remaining sheet is
 * free: removing both is a collapse and preserves the homotopy type, exactly, since no coordinates
 * are involved. The graph is what remains when no sheet is left.
 *
 * Values are computed during erosion. In the triangle dual to a free link the other two edges have
 * values, initially because they lie on the surface; together they are a path between the ends of
 * the third. Taking free links by the smallest sum is Dijkstra's algorithm in Knuth's generalized
 * form (edges as facts, triangles as rules), so every sheet gets the shortest path through
 * triangles, without a search over the surface from each point. On a plate the value is twice the
 * distance to the rim, on a tube half the girth.
 *
 * Interior points (of overlapping shells) are dual to 3-cells; those are first opened one by one
 * through a sheet that bounds only one of them, also a collapse.
 *
 * A closed wall around a cavity has no free link, nor have some knotted parts. Then the first
 * remaining sheet is cut, which is counted: this is not a collapse.
 *
 * Cost: O(n log n) for n links. */
#include "skeleton/skeleton.h"

#include "skeleton/edge_table.h"

static const char STAGE[] = "erosion";

typedef struct free_link {
    double value;
    uint32_t link, key; /* by the key where values are the same: of samples, not links */
} free_link;

typedef struct eroder {
    starg_context *context;
    const medial_complex *complex;
    bool *sheet;        /* has it not been removed? */
    double *values;     /* of removed edges */
    uint8_t *remaining; /* per link: number of sheets */
    bool *link_left;
    STARG_ARRAY(free_link) heap;
} eroder;

static bool before(free_link a, free_link b) {
    if (a.value != b.value)
        return a.value < b.value;
    return a.key < b.key || (a.key == b.key && a.link < b.link);
}

static starg_status push(eroder *e, free_link item) {
    PUSH(e->context, STAGE, &e->heap, item);
    free_link *heap = e->heap.data;
    size_t at = e->heap.count - 1;
    for (; at > 0 && before(item, heap[(at - 1) / 2]); at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = item;
    return STARG_OK;
}

static free_link pop(eroder *e) {
    free_link *heap = e->heap.data, first = heap[0], item = heap[--e->heap.count];
    size_t at = 0, count = e->heap.count;
    for (;;) {
        size_t child = 2 * at + 1;
        if (child >= count)
            break;
        if (child + 1 < count && before(heap[child + 1], heap[child]))
            child++;
        if (!before(heap[child], item))
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = item;
    return first;
}

/* To half of its digits: one path is the sum of the same lengths in different orders. */
static double rounded(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = (bits + (UINT64_C(1) << 25)) >> 26 << 26;
    memcpy(&value, &bits, sizeof bits);
    return value;
}

/* A link with one sheet left is queued by the sum of the values of its other two edges. */
static starg_status push_if_free(eroder *e, uint32_t link) {
    if (e->remaining[link] != 1 || !e->link_left[link])
        return STARG_OK;
    free_link item = {0, link, 0};
    for (int k = 0; k < 3; k++) {
        uint32_t edge = e->complex->link_edges[link][k];
        item.key += e->complex->ends[edge][0] + e->complex->ends[edge][1];
        if (!e->sheet[edge])
            item.value += e->values[edge];
    }
    item.value = rounded(item.value);
    return push(e, item);
}

static starg_status remove_sheet(eroder *e, uint32_t edge, double value) {
    const medial_complex *c = e->complex;
    e->sheet[edge] = false;
    e->values[edge] = value;
    for (uint32_t i = c->first_link[edge]; i < c->first_link[edge + 1]; i++) {
        e->remaining[c->edge_links[i]]--;
        TRY(push_if_free(e, c->edge_links[i]));
    }
    return STARG_OK;
}

static starg_status prepare(eroder *e) {
    const medial_complex *c = e->complex;
    NEW(e->context, STAGE, e->sheet, c->edge_count);
    NEW(e->context, STAGE, e->values, c->edge_count);
    NEW_ZERO(e->context, STAGE, e->remaining, c->link_count);
    NEW(e->context, STAGE, e->link_left, c->link_count);
    memcpy(e->sheet, c->sheet, c->edge_count * sizeof *e->sheet);
    memcpy(e->values, c->lengths, c->edge_count * sizeof *e->values);
    for (size_t l = 0; l < c->link_count; l++) {
        e->link_left[l] = true;
        for (int k = 0; k < 3; k++)
            e->remaining[l] += c->sheet[c->link_edges[l][k]];
    }
    return STARG_OK;
}

/* Opens volumes until a sweep finds none next to an open one. */
static starg_status open_volumes(eroder *e) {
    const medial_complex *c = e->complex;
    SCOPED bool *buried = NULL;
    bool changed = true;
    NEW(e->context, STAGE, buried, c->point_count);
    memcpy(buried, c->buried, c->point_count * sizeof *buried);
    while (changed) {
        TRY(starg_check_cancel(e->context, STAGE));
        changed = false;
        for (uint32_t edge = 0; edge < c->edge_count; edge++) {
            bool *a = &buried[c->ends[edge][0]], *b = &buried[c->ends[edge][1]];
            if (!e->sheet[edge] || *a == *b)
                continue;
            *a = *b = false;
            changed = true;
            TRY(remove_sheet(e, edge, c->lengths[edge]));
        }
    }
    return STARG_OK;
}

static starg_status collapse_all(eroder *e) {
    for (size_t steps = 0; e->heap.count > 0; steps++) {
        if (steps % 4096 == 0)
            TRY(starg_check_cancel(e->context, STAGE));
        free_link item = pop(e);
        if (e->remaining[item.link] != 1 || !e->link_left[item.link])
            continue;
        e->link_left[item.link] = false;
        for (int k = 0; k < 3; k++) {
            uint32_t edge = e->complex->link_edges[item.link][k];
            if (e->sheet[edge]) {
                TRY(remove_sheet(e, edge, item.value));
                break;
            }
        }
    }
    return STARG_OK;
}

starg_status erosion_run(starg_context *context, const medial_complex *complex, erosion *result) {
    starg_status status = STARG_OK;
    eroder e = {.context = context, .complex = complex};
    *result = (erosion){0};
    STARG_TRY(prepare(&e));
    STARG_TRY(open_volumes(&e));
    for (uint32_t l = 0; l < complex->link_count; l++)
        STARG_TRY(push_if_free(&e, l));
    STARG_TRY(collapse_all(&e));
    for (uint32_t edge = 0; edge < complex->edge_count; edge++) {
        if (!e.sheet[edge])
            continue;
        result->cut_count++;
        STARG_TRY(remove_sheet(&e, edge, complex->lengths[edge]));
        STARG_TRY(collapse_all(&e));
    }
    result->link_left = e.link_left;
    result->values = e.values;
    e.link_left = NULL;
    e.values = NULL;
done:
    RELEASE(e.heap.data, e.sheet, e.values, e.remaining, e.link_left);
    return status;
}

void erosion_free(erosion *result) {
    RELEASE(result->link_left, result->values);
    *result = (erosion){0};
}
