/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces that are star-shaped in two solids: lists of their tetrahedra, joins.
 *
 * Invariant: a join is made only if a guard in either place is proven, by exact signs. Cost: two
 * linear programs for each pair of neighbours that is tried; a pair is tried again only when one of
 * the two has changed. Threads try the next few pairs at once, and what they find is taken in
 * order, so that it is the same for any number of them. */
#include "star/compatible/twin_pieces.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "geometry/vec3.h"

static const char STAGE[] = "join";

enum { AT_ONCE = 4 }; /* pairs that each of several threads may try, before any is joined */

/* Two pieces that share faces, and how much. */
typedef struct contact {
    uint32_t first, second;
    double area;
} contact;

typedef STARG_ARRAY(contact) contact_list;

void twin_pieces_free(twin_pieces *w) {
    void *const blocks[] = {w->next, w->heads, w->tails, w->fresh, w->joined};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(w->context, blocks[i]);
    for (int i = 0; i < 2; i++)
        starg_tetmesh_free(w->own[i]);
    grown_regions_free(&w->pieces);
}

void twin_pieces_swap(twin_pieces *a, twin_pieces *b) {
    twin_pieces former = *a;
    *a = *b;
    *b = former;
}

starg_status twin_pieces_list(twin_pieces *w) {
    size_t count = w->pieces.count;
    NEW(w->context, STAGE, w->next, w->meshes[0]->count);
    NEW(w->context, STAGE, w->heads, count);
    NEW(w->context, STAGE, w->tails, count);
    NEW(w->context, STAGE, w->fresh, count);
    NEW_ZERO(w->context, STAGE, w->joined, count);
    memset(w->heads, 0xff, count * sizeof *w->heads);
    memset(w->fresh, 1, count);
    for (size_t t = w->meshes[0]->count; t-- > 0;) {
        uint32_t piece = w->pieces.labels[t];
        w->next[t] = w->heads[piece];
        if (w->heads[piece] == TWIN_LAST)
            w->tails[piece] = (uint32_t)t;
        w->heads[piece] = (uint32_t)t;
    }
    return STARG_OK;
}

/* ---- kernels ---- */

/* Adds the faces of piece `piece` that bound its union with `other`. */
static starg_status add_faces(const twin_pieces *w, uint32_t piece, uint32_t other,
                              face_corners *out) {
    const starg_tetmesh *mesh = w->meshes[0];
    for (uint32_t t = w->heads[piece]; t != TWIN_LAST; t = w->next[t])
        for (size_t face = 4 * (size_t)t; face < 4 * (size_t)t + 4; face++)
            TRY(piece_faces_add(w->context, mesh, w->pieces.labels, face, piece, other, out));
    return STARG_OK;
}

/* Looks for a guard of two pieces together, or of one that is given twice, in both places. */
static starg_status find_guards(const twin_pieces *w, uint32_t piece, uint32_t other,
                                double guards[2][3], bool *found) {
    SCOPED face_corners faces = {0};
    *found = true;
    TRY(add_faces(w, piece, other, &faces));
    if (other != piece)
        TRY(add_faces(w, other, piece, &faces));
    for (int i = 0; i < 2 && *found; i++) {
        const kernel_faces surface = {w->meshes[i]->vertices, faces.data, faces.count / 3};
        starg_kernel_result kernel;
        TRY(kernel_find(w->context, &surface, &kernel));
        vec3_copy(kernel.guard, guards[i]);
        *found = kernel.verdict == STARG_KERNEL_INTERIOR;
    }
    return STARG_OK;
}

static void set_guards(twin_pieces *w, uint32_t piece, double guards[2][3]) {
    vec3_copy(guards[0], w->pieces.guards.data + 3 * (size_t)piece);
    vec3_copy(guards[1], w->pieces.counterparts.data + 3 * (size_t)piece);
}

/* ---- contacts ---- */

static int by_pieces(const void *left, const void *right) {
    const contact *a = left, *b = right;
    if (a->first != b->first)
        return a->first < b->first ? -1 : 1;
    return (a->second > b->second) - (a->second < b->second);
}

static int by_area(const void *left, const void *right) {
    const contact *a = left, *b = right;
    if (a->area != b->area)
        return a->area > b->area ? -1 : 1;
    return by_pieces(left, right);
}

static double area_of(const starg_tetmesh *mesh, size_t face) {
    uint32_t corners[3];
    piece_face_corners(mesh, face, corners);
    return vec3_triangle_area(mesh->vertices + 3 * (size_t)corners[0],
                              mesh->vertices + 3 * (size_t)corners[1],
                              mesh->vertices + 3 * (size_t)corners[2]);
}

/* Equal contacts are neighbours; the first of each takes the area of all. */
static void merge_contacts(contact_list *list) {
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (kept > 0 && by_pieces(&list->data[kept - 1], &list->data[i]) == 0)
            list->data[kept - 1].area += list->data[i].area;
        else
            list->data[kept++] = list->data[i];
    list->count = kept;
}

/* Pairs of pieces of which one is fresh, the largest contact first. The area is that of the first
 * mesh. */
static starg_status find_contacts(const twin_pieces *w, contact_list *out) {
    const starg_tetmesh *mesh = w->meshes[0];
    out->count = 0;
    for (size_t face = 0; face < 4 * mesh->count; face++) {
        uint32_t u = mesh->neighbours[face], a = w->pieces.labels[face / 4], b = 0;
        if (u == STARG_TETMESH_NONE)
            continue;
        b = w->pieces.labels[u];
        if (a < b && (w->fresh[a] || w->fresh[b]))
            PUSH(w->context, STAGE, out, ((contact){a, b, area_of(mesh, face)}));
    }
    if (out->count == 0)
        return STARG_OK;
    qsort(out->data, out->count, sizeof *out->data, by_pieces);
    merge_contacts(out);
    qsort(out->data, out->count, sizeof *out->data, by_area);
    return STARG_OK;
}

/* ---- joins ---- */

static void append(twin_pieces *w, uint32_t piece, uint32_t other) {
    for (uint32_t t = w->heads[other]; t != TWIN_LAST; t = w->next[t])
        w->pieces.labels[t] = piece;
    w->next[w->tails[piece]] = w->heads[other];
    w->tails[piece] = w->tails[other];
    w->heads[other] = TWIN_LAST;
    w->joined[piece] = w->joined[other] = 1;
}

/* A pair that is tried, and the guards of its union. */
typedef struct join_trial {
    uint32_t first, second;
    double guards[2][3];
    bool found;
} join_trial;

typedef struct join_trials {
    const twin_pieces *w;
    join_trial *list;
} join_trials;

static starg_status try_join(starg_context *context, void *shared, void *scratch, size_t item) {
    const join_trials *all = shared;
    join_trial *t = &all->list[item];
    (void)context;
    (void)scratch;
    return find_guards(all->w, t->first, t->second, t->guards, &t->found);
}

/* One round: each piece changes once at most, so that contacts stay true. */
static starg_status join_round(twin_pieces *w, const contact_list *contacts, size_t *joins) {
    const size_t threads = (size_t)w->context->threads, most = threads > 1 ? AT_ONCE * threads : 1;
    SCOPED join_trial *list = NULL;
    join_trials trials = {.w = w};
    starg_parallel_loop loop = {
        .stage = STAGE, .shared = &trials, .item = try_join, .silent = true};
    NEW(w->context, STAGE, list, most);
    trials.list = list;
    *joins = 0;
    for (size_t i = 0; i < contacts->count;) {
        TRY(starg_check_cancel(w->context, STAGE));
        for (loop.count = 0; i < contacts->count && loop.count < most; i++) {
            const contact *c = &contacts->data[i];
            if (!w->joined[c->first] && !w->joined[c->second])
                list[loop.count++] = (join_trial){.first = c->first, .second = c->second};
        }
        TRY(starg_parallel_for(w->context, &loop));
        for (join_trial *t = list; t < list + loop.count; t++) {
            if (!t->found || w->joined[t->first] || w->joined[t->second])
                continue;
            append(w, t->first, t->second);
            set_guards(w, t->first, t->guards);
            (*joins)++;
        }
    }
    return STARG_OK;
}

/* Numbers without gaps. */
static void renumber(twin_pieces *w) {
    uint32_t count = 0;
    for (uint32_t piece = 0; piece < w->pieces.count; piece++) {
        if (w->heads[piece] == TWIN_LAST)
            continue;
        for (uint32_t t = w->heads[piece]; t != TWIN_LAST; t = w->next[t])
            w->pieces.labels[t] = count;
        vec3_copy(w->pieces.guards.data + 3 * (size_t)piece,
                  w->pieces.guards.data + 3 * (size_t)count);
        vec3_copy(w->pieces.counterparts.data + 3 * (size_t)piece,
                  w->pieces.counterparts.data + 3 * (size_t)count);
        w->heads[count] = w->heads[piece];
        w->tails[count] = w->tails[piece];
        count++;
    }
    w->pieces.count = count;
}

starg_status twin_pieces_join(twin_pieces *w) {
    SCOPED contact_list contacts = {0};
    size_t joins = 0;
    do {
        TRY(find_contacts(w, &contacts));
        TRY(join_round(w, &contacts, &joins));
        memcpy(w->fresh, w->joined, w->pieces.count);
        memset(w->joined, 0, w->pieces.count);
    } while (joins > 0);
    renumber(w);
    return STARG_OK;
}

/* Of guards that see their pieces already: a program that fails by rounding changes nothing. */
starg_status twin_pieces_center(twin_pieces *w) {
    for (uint32_t piece = 0; piece < w->pieces.count; piece++) {
        double guards[2][3];
        bool found;
        if (w->heads[piece] == TWIN_LAST)
            continue;
        TRY(find_guards(w, piece, piece, guards, &found));
        if (found)
            set_guards(w, piece, guards);
    }
    return STARG_OK;
}

/* ---- choices ---- */

starg_status twin_pieces_drop(const twin_pieces *w, size_t wanted, starg_rng *rng, uint8_t *dropped,
                              size_t *tetrahedra) {
    const starg_tetmesh *mesh = w->meshes[0];
    const uint32_t *labels = w->pieces.labels;
    SCOPED STARG_ARRAY(uint32_t)
        beside = {0}; /* the pieces at the group, as often as faces touch */
    memset(dropped, 0, w->pieces.count);
    dropped[starg_rng_below(rng, w->pieces.count)] = 1;
    for (size_t chosen = 1; chosen < wanted; chosen++) {
        beside.count = 0;
        for (size_t face = 0; face < 4 * mesh->count; face++) {
            uint32_t u = mesh->neighbours[face];
            if (u != STARG_TETMESH_NONE && dropped[labels[face / 4]] && !dropped[labels[u]])
                PUSH(w->context, STAGE, &beside, labels[u]);
        }
        if (beside.count == 0)
            break;
        dropped[beside.data[starg_rng_below(rng, beside.count)]] = 1;
    }
    *tetrahedra = 0;
    for (size_t t = 0; t < mesh->count; t++)
        *tetrahedra += dropped[labels[t]];
    return STARG_OK;
}

starg_status twin_pieces_prove(const twin_pieces *w, bool *proven) {
    SCOPED face_corners faces = {0};
    *proven = true;
    for (uint32_t piece = 0; piece < w->pieces.count && *proven; piece++) {
        faces.count = 0;
        TRY(add_faces(w, piece, piece, &faces));
        *proven = faces.count > 0;
        for (int i = 0; i < 2 && *proven; i++) {
            const double *guards = i == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
            const kernel_faces surface = {w->meshes[i]->vertices, faces.data, faces.count / 3};
            *proven = kernel_sees_all(&surface, guards + 3 * (size_t)piece);
        }
    }
    return STARG_OK;
}
