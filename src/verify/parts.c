/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a model that do not see each other: an outer shell and the cavities in it, with all
 * shells that touch these otherwise than in common vertices and edges.
 *
 * A point sees a face from the face's inner side, with nothing in between. So a shell that does not
 * cross the face's own winds as often around the point as around that, and which of them hold the
 * point tells the part: shells that lie in an odd number of others are cavities, and belong to the
 * innermost of these. Shells that touch in common vertices and edges alone do not cross if all
 * vertices of one that are off the other are on the same side: nothing else of a face meets it, so
 * faces on both sides of an edge that is not common are on one side, and there must be such a
 * vertex for each face or one that is reached from it over such edges.
 *
 * Exact. Cost: for each pair of shells whose boxes meet, the faces of one of them; of both, times
 * each other, if they have vertices in common. */
#include <stdlib.h>

#include "verify/everywhere.h"

static const char STAGE[] = "verify";

/* An edge of a face, from its lower vertex. */
typedef struct shell_edge {
    uint32_t a, b, face;
} shell_edge;

typedef struct part_search {
    const verify_surface *surface;
    uint32_t *shell;     /* by face: a set of faces */
    uint32_t *part;      /* by face: a set of faces, of shells that belong together */
    uint32_t *roots;     /* lowest faces of all shells */
    uint32_t *list;      /* faces, shell by shell */
    size_t *first;       /* by shell: where its faces begin */
    double (*bounds)[6]; /* by shell */
    size_t *depth;       /* by shell: the number of others that it lies in */
    uint8_t *sharing;    /* by face: has a vertex in common with another shell */
    uint8_t *shares;     /* by shell: one of its faces has */
    shell_edge *edges;   /* room for those of all faces */
    uint32_t *group;     /* by face: a set of faces on one side of another shell */
    uint8_t *placed;     /* by face of a group's number: one of its vertices is off that shell */
    size_t count;        /* of shells */
    uint32_t face;       /* whose neighbours are visited */
} part_search;

static bool join_touching(void *data, uint32_t other) {
    part_search *own = data;
    if (own->shell[other] == own->shell[own->face])
        return true;
    if (verify_faces_touch(own->surface, own->face, other))
        verify_join(own->part, own->face, other);
    if (verify_faces_share(own->surface, own->face, other))
        own->sharing[other] = own->sharing[own->face] = 1;
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
    const verify_surface *surface = own->surface;
    starg_context *context = surface->context;
    SCOPED uint32_t *number = NULL;
    size_t faces = surface->face_count;
    NEW(context, STAGE, number, faces);
    for (uint32_t f = 0; f < faces; f++) {
        own->shell[f] = verify_root(own->shell, f);
        own->part[f] = own->shell[f];
        if (own->shell[f] == f) {
            number[f] = (uint32_t)own->count;
            own->roots[own->count++] = f;
        }
    }
    NEW_ZERO(context, STAGE, own->first, own->count + 2);
    NEW(context, STAGE, own->bounds, own->count);
    NEW_ZERO(context, STAGE, own->depth, own->count);
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
    return STARG_OK;
}

/* Does the box of a shell meet that of another? */
static bool boxes_meet(const part_search *own, size_t s, size_t t) {
    for (int k = 0; k < 3; k++)
        if (own->bounds[s][k] > own->bounds[t][k + 3] || own->bounds[t][k] > own->bounds[s][k + 3])
            return false;
    return true;
}

static int compare_edges(const void *x, const void *y) {
    const shell_edge *e = x, *f = y;
    return e->a != f->a ? (e->a > f->a) - (e->a < f->a) : (e->b > f->b) - (e->b < f->b);
}

static bool has_corner(const double *const corners[3], const double *p) {
    bool found = false;
    for (int k = 0; k < 3; k++)
        found = found || (corners[k][0] == p[0] && corners[k][1] == p[1] && corners[k][2] == p[2]);
    return found;
}

/* Has a face of shell t this edge, by its place? */
static bool is_common(const part_search *own, const shell_edge *e, size_t t) {
    const double *p = own->surface->vertices + 3 * (size_t)e->a;
    const double *q = own->surface->vertices + 3 * (size_t)e->b;
    for (size_t i = own->first[t]; i < own->first[t + 1]; i++) {
        const double *corners[3];
        verify_corners(own->surface, own->list[i], corners);
        if (has_corner(corners, p) && has_corner(corners, q))
            return true;
    }
    return false;
}

/* Groups the faces of shell s that are connected over edges that shell t has not. */
static void group_faces(part_search *own, size_t s, size_t t) {
    size_t count = 0;
    for (size_t i = own->first[s]; i < own->first[s + 1]; i++) {
        uint32_t f = own->list[i];
        const uint32_t *v = own->surface->faces + 3 * (size_t)f;
        own->group[f] = f;
        own->placed[f] = 0;
        for (size_t k = 0; k < 3; k++) {
            uint32_t a = v[k], b = v[(k + 1) % 3];
            own->edges[count++] = (shell_edge){a < b ? a : b, a < b ? b : a, f};
        }
    }
    qsort(own->edges, count, sizeof *own->edges, compare_edges);
    for (size_t i = 1; i < count; i++)
        if (compare_edges(&own->edges[i - 1], &own->edges[i]) == 0 &&
            !is_common(own, &own->edges[i], t))
            verify_join(own->group, own->edges[i - 1].face, own->edges[i].face);
}

/* Does shell t wind around shell s? *crossing: that is not so for all of s, or not known. */
static bool holds(part_search *own, size_t t, size_t s, bool *crossing) {
    const verify_surface *surface = own->surface;
    const uint32_t *others = own->list + own->first[t];
    size_t count = own->first[t + 1] - own->first[t];
    int known = 0;
    bool any = false;
    *crossing = false;
    if (own->shares[s])
        group_faces(own, s, t);
    for (size_t i = own->first[s]; i < own->first[s + 1]; i++) {
        const double *corners[3];
        bool on_surface;
        verify_corners(surface, own->list[i], corners);
        for (int k = 0; k < 3; k++) {
            int winding = verify_winding(surface, others, count, corners[k], &on_surface);
            if (on_surface)
                continue;
            *crossing = *crossing || (any && winding != known);
            known = winding;
            any = true;
            if (!own->shares[s])
                return known != 0;
            own->placed[verify_root(own->group, own->list[i])] = 1;
        }
    }
    for (size_t i = own->first[s]; i < own->first[s + 1]; i++)
        *crossing =
            *crossing || !own->shares[s] || !own->placed[verify_root(own->group, own->list[i])];
    return known != 0;
}

static bool are_joined(part_search *own, size_t a, size_t b) {
    return verify_root(own->part, own->roots[a]) == verify_root(own->part, own->roots[b]);
}

/* Cavities join the innermost shell around them. */
static starg_status join_cavities(part_search *own) {
    starg_context *context = own->surface->context;
    /* pairs: a shell, and one that holds it */
    SCOPED STARG_ARRAY(uint32_t) around = {0};
    for (uint32_t s = 0; s < own->count; s++) {
        TRY(starg_check_cancel(context, STAGE));
        for (uint32_t t = 0; t < own->count; t++) {
            bool crossing = false;
            if (are_joined(own, s, t) || !boxes_meet(own, s, t))
                continue;
            bool within = holds(own, t, s, &crossing);
            if (crossing)
                verify_join(own->part, own->roots[s], own->roots[t]);
            if (crossing || !within)
                continue;
            PUSH(context, STAGE, &around, s);
            PUSH(context, STAGE, &around, t);
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
    return STARG_OK;
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
    STARG_NEW_ZERO(context, STAGE, own.sharing, faces);
    STARG_NEW(context, STAGE, own.edges, 3 * faces);
    STARG_NEW(context, STAGE, own.group, faces);
    STARG_NEW(context, STAGE, own.placed, faces);
    STARG_TRY(list_shells(&own));
    STARG_NEW_ZERO(context, STAGE, own.shares, own.count);
    for (own.face = 0; own.face < faces && own.count > 1; own.face++) {
        double bounds[6];
        for (int k = 0; k < 6; k++)
            bounds[k] =
                surface->vertices[3 * (size_t)surface->faces[3 * (size_t)own.face] + (size_t)k % 3];
        find_bounds(surface, own.face, bounds);
        verify_tree_visit(tree, bounds, bounds + 3, join_touching, &own);
    }
    for (size_t s = 0; s < own.count; s++)
        for (size_t i = own.first[s]; i < own.first[s + 1]; i++)
            own.shares[s] = own.shares[s] || own.sharing[own.list[i]];
    STARG_TRY(join_cavities(&own));
    number_parts(&own);
    *part = own.part;
    own.part = NULL;
done:
    RELEASE(own.shell, own.part, own.roots, own.list, own.first, own.bounds, own.depth, own.sharing,
            own.edges, own.group, own.placed, own.shares);
    return status;
}
