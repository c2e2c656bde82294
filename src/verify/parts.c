/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a model that do not see each other: an outer shell and the cavities in it, with all
 * shells that touch these.
 *
 * A point sees a face from the face's inner side, with nothing in between. So all shells that do
 * not touch the face's own wind as often around the point as around any vertex of that, and which
 * of them hold the point tells the part: shells that lie in an odd number of others are cavities,
 * and belong to the innermost of these.
 *
 * Exact. Cost: for each pair of shells whose boxes meet, the faces of one of them. */
#include "verify/parts.h"

#include "core/memory.h"
#include "verify/hidden.h"
#include "verify/sets.h"
#include "verify/shells.h"

static const char STAGE[] = "verify";

typedef struct part_search {
    const verify_surface *surface;
    uint32_t *shell;     /* by face: a set of faces */
    uint32_t *part;      /* by face: a set of faces, of shells that belong together */
    uint32_t *roots;     /* lowest faces of all shells */
    uint32_t *list;      /* faces, shell by shell */
    size_t *first;       /* by shell: where its faces begin */
    double (*bounds)[6]; /* by shell */
    size_t *depth;       /* by shell: the number of others that it lies in */
    size_t count;        /* of shells */
    uint32_t face;       /* whose neighbours are visited */
} part_search;

static bool join_touching(void *data, uint32_t other) {
    part_search *own = data;
    if (own->shell[other] != own->shell[own->face] &&
        verify_faces_touch(own->surface, own->face, other))
        verify_join(own->part, own->face, other);
    return true;
}

static void find_bounds(const verify_surface *surface, size_t face, double bounds[6]) {
    const double *t[3];
    verify_corners(surface, face, t);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            bounds[k] = t[i][k] < bounds[k] ? t[i][k] : bounds[k];
            bounds[k + 3] = t[i][k] > bounds[k + 3] ? t[i][k] : bounds[k + 3];
        }
}

static starg_status list_shells(part_search *own) {
    starg_status status = STARG_OK;
    const verify_surface *surface = own->surface;
    starg_context *context = surface->context;
    uint32_t *number = NULL;
    size_t faces = surface->face_count;
    STARG_NEW(context, STAGE, number, faces);
    for (uint32_t f = 0; f < faces; f++) {
        own->shell[f] = verify_root(own->shell, f);
        own->part[f] = own->shell[f];
        if (own->shell[f] == f) {
            number[f] = (uint32_t)own->count;
            own->roots[own->count++] = f;
        }
    }
    STARG_NEW_ZERO(context, STAGE, own->first, own->count + 2);
    STARG_NEW(context, STAGE, own->bounds, own->count);
    STARG_NEW_ZERO(context, STAGE, own->depth, own->count);
    for (size_t s = 0; s < own->count; s++)
        for (int k = 0; k < 6; k++)
            own->bounds[s][k] =
                surface->vertices[3 * (size_t)surface->faces[3 * (size_t)own->roots[s]] +
                                  (size_t)k % 3];
    for (size_t f = 0; f < faces; f++) {
        own->first[number[own->shell[f]] + 2]++;
        find_bounds(surface, f, own->bounds[number[own->shell[f]]]);
    }
    for (size_t s = 2; s < own->count + 2; s++)
        own->first[s] += own->first[s - 1];
    for (size_t f = 0; f < faces; f++)
        own->list[own->first[number[own->shell[f]] + 1]++] = (uint32_t)f;
done:
    starg_release(context, number);
    return status;
}

/* Does shell `outer` wind around shell `inner`, which it does not touch? */
static bool holds(const part_search *own, size_t outer, size_t inner) {
    const verify_surface *surface = own->surface;
    const double *p = surface->vertices + 3 * (size_t)surface->faces[3 * (size_t)own->roots[inner]];
    bool on_surface;
    for (int k = 0; k < 3; k++)
        if (own->bounds[inner][k] < own->bounds[outer][k] ||
            own->bounds[inner][k + 3] > own->bounds[outer][k + 3])
            return false;
    return verify_winding(surface, own->list + own->first[outer],
                          own->first[outer + 1] - own->first[outer], p, &on_surface) != 0;
}

static bool are_joined(part_search *own, size_t a, size_t b) {
    return verify_root(own->part, own->roots[a]) == verify_root(own->part, own->roots[b]);
}

/* Cavities join the innermost shell around them. */
static starg_status join_cavities(part_search *own) {
    starg_status status = STARG_OK;
    starg_context *context = own->surface->context;
    STARG_ARRAY(uint32_t) around = {0}; /* pairs: a shell, and one that holds it */
    for (uint32_t s = 0; s < own->count; s++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        for (uint32_t t = 0; t < own->count; t++)
            if (!are_joined(own, s, t) && holds(own, t, s)) {
                STARG_PUSH(context, STAGE, &around, s);
                STARG_PUSH(context, STAGE, &around, t);
                own->depth[s]++;
            }
    }
    for (size_t i = 0, end; i < around.count; i = end) {
        uint32_t s = around.data[i], innermost = around.data[i + 1];
        for (end = i; end < around.count && around.data[end] == s; end += 2)
            if (own->depth[around.data[end + 1]] > own->depth[innermost])
                innermost = around.data[end + 1];
        if (own->depth[s] % 2 == 1)
            verify_join(own->part, own->roots[s], own->roots[innermost]);
    }
done:
    STARG_ARRAY_FREE(context, &around);
    return status;
}

static void number_parts(part_search *own) {
    uint32_t next = 0;
    for (uint32_t f = 0; f < own->surface->face_count; f++)
        own->part[f] = verify_root(own->part, own->shell[f]);
    for (uint32_t f = 0; f < own->surface->face_count; f++)
        own->shell[f] = own->part[f] == f ? next++ : own->shell[own->part[f]];
    memcpy(own->part, own->shell, own->surface->face_count * sizeof *own->part);
}

starg_status verify_find_parts(const verify_surface *surface, const verify_tree *tree,
                               uint32_t **part) {
    starg_status status = STARG_OK;
    starg_context *context = surface->context;
    part_search own = {.surface = surface};
    size_t faces = surface->face_count;
    STARG_TRY(verify_find_shells(surface, &own.shell));
    STARG_NEW(context, STAGE, own.part, faces);
    STARG_NEW(context, STAGE, own.roots, faces);
    STARG_NEW(context, STAGE, own.list, faces);
    STARG_TRY(list_shells(&own));
    for (own.face = 0; own.face < faces && own.count > 1; own.face++) {
        double bounds[6];
        for (int k = 0; k < 6; k++)
            bounds[k] =
                surface->vertices[3 * (size_t)surface->faces[3 * (size_t)own.face] + (size_t)k % 3];
        find_bounds(surface, own.face, bounds);
        verify_tree_visit(tree, bounds, bounds + 3, join_touching, &own);
    }
    STARG_TRY(join_cavities(&own));
    number_parts(&own);
    *part = own.part;
    own.part = NULL;
done:
    starg_release(context, own.shell);
    starg_release(context, own.part);
    starg_release(context, own.roots);
    starg_release(context, own.list);
    starg_release(context, own.first);
    starg_release(context, own.bounds);
    starg_release(context, own.depth);
    return status;
}
