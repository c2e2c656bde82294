/* SPDX-License-Identifier: Apache-2.0 */
/* Compatible decomposition, pieces that are star-shaped in two solids at once: consistent
 * decomposition [YL11, section 5.2].
 *
 * Problem: the same tetrahedra lie in two places, positive in both. Label them so that each set is
 * strictly star-shaped in both places, about a guard in either, with few labels.
 *
 * Stages: regions grown about pairs of guards (region_growing.c); of these, two neighbours at a
 * time whose union has a kernel with an interior in both places become one, those that touch over
 * the largest area first, until no two can be joined. Then a random group of pieces that hang
 * together is given up, its tetrahedra are grown and joined anew, and the outcome stays if there
 * are no more pieces than before (ruin and recreate: Schrimpf et al. 2000), until that has long
 * saved nothing. Where tetrahedra may be cut: several times parts between planes
 * (compatible_planes.c), joined in the same way; they stay if they are fewer. Then three and more
 * pieces that hang together become two by a random plane in one of the places (through.c), if the
 * kernels allow it. At last every guard goes to the middle of its kernel.
 *
 * Invariants: after each stage every set is proven to be star-shaped in both, by exact signs.
 *
 * Cost: that of the region growing, for the whole and for a fixed number of tetrahedra of groups,
 * and two linear programs for each pair of neighbours that is tried; a pair is tried again only
 * when one of the two has changed. */
#include "star/strict/start/compatible.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/rng.h"
#include "geometry/vec3.h"
#include "star/decomposition.h"
#include "star/piece_faces.h"
#include "star/strict/start/compatible_planes.h"
#include "star/strict/start/region_growing.h"
#include "star/strict/start/through.h"
#include "visibility/kernel.h"

static const char STAGE[] = "join";

enum {
    GROUP_MOST = 4,      /* pieces grown anew at a time, from 2 on                           */
    IDLE_MOST = 150,     /* groups in a row that saved nothing: then no more                 */
    WORK_LEAST = 400000, /* tetrahedra of all groups                                        */
    WORK_EACH = 30,      /* and as many more for each tetrahedron that there is             */
    PASSES = 60,         /* as many looked at once take as long as one of a group           */
    PLANE_STARTS = 3,    /* divisions by planes: the one of the fewest pieces stays          */
    CUT_MOST = 7,        /* pieces that become two at a time, from 3 on                     */
    CUT_TRIES = 8,       /* planes for a group                                              */
    CUT_IDLE = 250,      /* groups in a row that no plane divided: then no more             */
    CUT_WORK = 1500      /* tetrahedra of all planes, for each that there is                */
};

#define LAST UINT32_MAX /* ends a list */

/* Tetrahedra of a piece are a list: head, then next, to the tail. */
typedef struct compatible {
    starg_context *context;
    const starg_tetmesh *meshes[2];
    starg_tetmesh *own[2]; /* the same, if they were divided; else NULL */
    grown_regions pieces;
    uint32_t *next;          /* per tetrahedron */
    uint32_t *heads, *tails; /* per piece; a piece that was joined to another has LAST */
    uint8_t *fresh, *joined; /* per piece: changed in the last round of joins, in this one */
    STARG_ARRAY(uint32_t) faces;
} compatible;

/* Two pieces that share faces, and how much. */
typedef struct contact {
    uint32_t first, second;
    double area;
} contact;

typedef STARG_ARRAY(contact) contact_list;

static void compatible_free(compatible *w) {
    void *const blocks[] = {w->next, w->heads, w->tails, w->fresh, w->joined, w->faces.data};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(w->context, blocks[i]);
    for (int i = 0; i < 2; i++)
        starg_tetmesh_free(w->own[i]);
    grown_regions_free(w->context, &w->pieces);
}

static void swap(compatible *a, compatible *b) {
    compatible former = *a;
    *a = *b;
    *b = former;
}

static starg_status list_pieces(compatible *w) {
    starg_status status = STARG_OK;
    size_t count = w->pieces.count;
    STARG_NEW(w->context, STAGE, w->next, w->meshes[0]->count);
    STARG_NEW(w->context, STAGE, w->heads, count);
    STARG_NEW(w->context, STAGE, w->tails, count);
    STARG_NEW(w->context, STAGE, w->fresh, count);
    STARG_NEW_ZERO(w->context, STAGE, w->joined, count);
    memset(w->heads, 0xff, count * sizeof *w->heads);
    memset(w->fresh, 1, count);
    for (size_t t = w->meshes[0]->count; t-- > 0;) {
        uint32_t piece = w->pieces.labels[t];
        w->next[t] = w->heads[piece];
        if (w->heads[piece] == LAST)
            w->tails[piece] = (uint32_t)t;
        w->heads[piece] = (uint32_t)t;
    }
done:
    return status;
}

/* ---- kernels ---- */

/* Adds the faces of piece `piece` that bound its union with `other`. */
static starg_status add_faces(compatible *w, uint32_t piece, uint32_t other) {
    starg_status status = STARG_OK;
    const starg_tetmesh *mesh = w->meshes[0];
    for (uint32_t t = w->heads[piece]; t != LAST; t = w->next[t])
        for (size_t face = 4 * (size_t)t; face < 4 * (size_t)t + 4; face++) {
            uint32_t corners[3], u = mesh->neighbours[face];
            if (u != STARG_TETMESH_NONE &&
                (w->pieces.labels[u] == piece || w->pieces.labels[u] == other))
                continue;
            piece_face_corners(mesh, face, corners);
            for (int k = 0; k < 3; k++)
                STARG_PUSH(w->context, STAGE, &w->faces, corners[k]);
        }
done:
    return status;
}

/* Looks for a guard of two pieces together, or of one that is given twice, in both places. */
static starg_status find_guards(compatible *w, uint32_t piece, uint32_t other, double guards[2][3],
                                bool *found) {
    starg_status status = STARG_OK;
    *found = true;
    w->faces.count = 0;
    STARG_TRY(add_faces(w, piece, other));
    if (other != piece)
        STARG_TRY(add_faces(w, other, piece));
    for (int i = 0; i < 2 && *found; i++) {
        const kernel_faces surface = {w->meshes[i]->vertices, w->faces.data, w->faces.count / 3};
        starg_kernel_result kernel;
        STARG_TRY(kernel_find(w->context, &surface, &kernel));
        vec3_copy(kernel.guard, guards[i]);
        *found = kernel.verdict == STARG_KERNEL_INTERIOR;
    }
done:
    return status;
}

static void set_guards(compatible *w, uint32_t piece, double guards[2][3]) {
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
static starg_status find_contacts(const compatible *w, contact_list *out) {
    starg_status status = STARG_OK;
    const starg_tetmesh *mesh = w->meshes[0];
    out->count = 0;
    for (size_t face = 0; face < 4 * mesh->count; face++) {
        uint32_t u = mesh->neighbours[face], a = w->pieces.labels[face / 4], b = 0;
        if (u == STARG_TETMESH_NONE)
            continue;
        b = w->pieces.labels[u];
        if (a < b && (w->fresh[a] || w->fresh[b]))
            STARG_PUSH(w->context, STAGE, out, ((contact){a, b, area_of(mesh, face)}));
    }
    if (out->count == 0)
        goto done;
    qsort(out->data, out->count, sizeof *out->data, by_pieces);
    merge_contacts(out);
    qsort(out->data, out->count, sizeof *out->data, by_area);
done:
    return status;
}

/* ---- joins ---- */

static void append(compatible *w, uint32_t piece, uint32_t other) {
    for (uint32_t t = w->heads[other]; t != LAST; t = w->next[t])
        w->pieces.labels[t] = piece;
    w->next[w->tails[piece]] = w->heads[other];
    w->tails[piece] = w->tails[other];
    w->heads[other] = LAST;
    w->joined[piece] = w->joined[other] = 1;
}

/* One round: each piece changes once at most, so that contacts stay true. */
static starg_status join_round(compatible *w, const contact_list *contacts, size_t *joins) {
    starg_status status = STARG_OK;
    *joins = 0;
    for (size_t i = 0; i < contacts->count; i++) {
        const contact *c = &contacts->data[i];
        double guards[2][3];
        bool found;
        if (w->joined[c->first] || w->joined[c->second])
            continue;
        STARG_TRY(starg_check_cancel(w->context, STAGE));
        STARG_TRY(find_guards(w, c->first, c->second, guards, &found));
        if (!found)
            continue;
        append(w, c->first, c->second);
        set_guards(w, c->first, guards);
        (*joins)++;
    }
done:
    return status;
}

static starg_status join_all(compatible *w) {
    starg_status status = STARG_OK;
    contact_list contacts = {0};
    size_t joins;
    do {
        STARG_TRY(find_contacts(w, &contacts));
        STARG_TRY(join_round(w, &contacts, &joins));
        memcpy(w->fresh, w->joined, w->pieces.count);
        memset(w->joined, 0, w->pieces.count);
    } while (joins > 0);
done:
    STARG_ARRAY_FREE(w->context, &contacts);
    return status;
}

/* Of guards that see their pieces already: a program that fails by rounding changes nothing. */
static starg_status center_guards(compatible *w) {
    starg_status status = STARG_OK;
    for (uint32_t piece = 0; piece < w->pieces.count; piece++) {
        double guards[2][3];
        bool found;
        if (w->heads[piece] == LAST)
            continue;
        STARG_TRY(find_guards(w, piece, piece, guards, &found));
        if (found)
            set_guards(w, piece, guards);
    }
done:
    return status;
}

/* Numbers without gaps. */
static void renumber(compatible *w) {
    uint32_t count = 0;
    for (uint32_t piece = 0; piece < w->pieces.count; piece++) {
        if (w->heads[piece] == LAST)
            continue;
        for (uint32_t t = w->heads[piece]; t != LAST; t = w->next[t])
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

/* ---- some anew ---- */

/* Drops `wanted` pieces that hang together, from a random one on; says how many tetrahedra they
 * have. */
static starg_status drop_group(const compatible *w, size_t wanted, starg_rng *rng, uint8_t *dropped,
                               size_t *tetrahedra) {
    starg_status status = STARG_OK;
    const starg_tetmesh *mesh = w->meshes[0];
    const uint32_t *labels = w->pieces.labels;
    STARG_ARRAY(uint32_t) beside = {0}; /* the pieces at the group, as often as faces touch */
    memset(dropped, 0, w->pieces.count);
    dropped[starg_rng_below(rng, w->pieces.count)] = 1;
    for (size_t chosen = 1; chosen < wanted; chosen++) {
        beside.count = 0;
        for (size_t face = 0; face < 4 * mesh->count; face++) {
            uint32_t u = mesh->neighbours[face];
            if (u != STARG_TETMESH_NONE && dropped[labels[face / 4]] && !dropped[labels[u]])
                STARG_PUSH(w->context, STAGE, &beside, labels[u]);
        }
        if (beside.count == 0)
            break;
        dropped[beside.data[starg_rng_below(rng, beside.count)]] = 1;
    }
    *tetrahedra = 0;
    for (size_t t = 0; t < mesh->count; t++)
        *tetrahedra += dropped[labels[t]];
done:
    STARG_ARRAY_FREE(w->context, &beside);
    return status;
}

/* The pieces without those dropped, and what is grown in their stead. */
static starg_status replace_group(const compatible *w, const uint8_t *dropped, uint64_t round,
                                  compatible *out) {
    starg_status status = STARG_OK;
    STARG_TRY(grow_compatible_again(w->context, w->meshes[0], w->meshes[1], &w->pieces, dropped,
                                    round, &out->pieces));
    STARG_TRY(list_pieces(out));
    for (size_t p = 0, kept = 0; p < w->pieces.count; p++)
        if (!dropped[p])
            out->fresh[kept++] = 0;
    STARG_TRY(join_all(out));
    renumber(out);
done:
    return status;
}

/* Groups of pieces grown anew stay if they are no more than before. */
static starg_status renew_groups(compatible *w) {
    starg_status status = STARG_OK;
    starg_context *context = w->context;
    compatible next = {.context = context};
    uint8_t *dropped = NULL;
    starg_progress_begin(context, STAGE);
    STARG_NEW(context, STAGE, dropped, w->pieces.count);
    size_t idle = 0, work = 0, most = WORK_LEAST + WORK_EACH * w->meshes[0]->count;
    for (uint64_t round = 1; idle < IDLE_MOST && work < most && w->pieces.count > 1; round++) {
        starg_rng rng = starg_rng_make(context->seed, 0, round);
        size_t group = 0;
        STARG_TRY(drop_group(w, 2 + starg_rng_below(&rng, GROUP_MOST - 1), &rng, dropped, &group));
        compatible_free(&next);
        next = (compatible){.context = context, .meshes = {w->meshes[0], w->meshes[1]}};
        STARG_TRY(replace_group(w, dropped, round, &next));
        work += group + w->meshes[0]->count / PASSES;
        idle = next.pieces.count < w->pieces.count ? 0 : idle + 1;
        if (next.pieces.count <= w->pieces.count)
            swap(w, &next);
        starg_progress_step(context, work, most);
    }
done:
    starg_progress_end(context);
    compatible_free(&next);
    starg_release(context, dropped);
    return status;
}

/* ---- cuts ---- */

/* A plane about across from one piece of the group to another. */
static void choose_plane(const compatible *w, const uint8_t *dropped, starg_rng *rng,
                         double *levels) {
    int place = (int)starg_rng_below(rng, 2);
    const starg_tetmesh *mesh = w->meshes[place];
    const double *guards = place == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
    uint32_t pair[2];
    for (int i = 0; i < 2; i++)
        do
            pair[i] = (uint32_t)starg_rng_below(rng, w->pieces.count);
        while (!dropped[pair[i]] || (i == 1 && pair[1] == pair[0]));
    const double *from = guards + 3 * (size_t)pair[0], *to = guards + 3 * (size_t)pair[1];
    double normal[3], tilt[3], point[3], at = 1.4 * starg_rng_unit(rng) - 0.2;
    double most = 0.6 * starg_rng_unit(rng) * vec3_distance(from, to);
    vec3_subtract(to, from, normal);
    vec3_along(from, at, normal, point);
    for (int k = 0; k < 3; k++)
        tilt[k] = 2 * starg_rng_unit(rng) - 1;
    vec3_along(normal, most, tilt, normal);
    memset(levels, 0, mesh->vertex_count * sizeof *levels);
    for (size_t t = 0; t < mesh->count; t++)
        for (size_t k = 0; dropped[w->pieces.labels[t]] && k < 4; k++) {
            uint32_t v = mesh->tetrahedra[4 * t + k];
            double offset[3];
            vec3_subtract(mesh->vertices + 3 * (size_t)v, point, offset);
            levels[v] = vec3_dot(offset, normal);
        }
}

/* The pieces that are kept, and the two parts. */
static starg_status number_parts(const compatible *w, const uint8_t *dropped,
                                 double guards[2][2][3], compatible *out) {
    starg_status status = STARG_OK;
    uint32_t *numbers = NULL;
    grown_regions *pieces = &out->pieces;
    STARG_NEW(w->context, STAGE, numbers, w->pieces.count);
    for (size_t p = 0; p < w->pieces.count; p++) {
        if (dropped[p])
            continue;
        numbers[p] = (uint32_t)pieces->count++;
        for (size_t k = 3 * p; k < 3 * p + 3; k++) {
            STARG_PUSH(w->context, STAGE, &pieces->guards, w->pieces.guards.data[k]);
            STARG_PUSH(w->context, STAGE, &pieces->counterparts, w->pieces.counterparts.data[k]);
        }
    }
    for (int part = 0; part < 2; part++)
        for (int k = 0; k < 3; k++) {
            STARG_PUSH(w->context, STAGE, &pieces->guards, guards[part][0][k]);
            STARG_PUSH(w->context, STAGE, &pieces->counterparts, guards[part][1][k]);
        }
    for (size_t t = 0; t < out->meshes[0]->count; t++) {
        uint32_t label = pieces->labels[t];
        pieces->labels[t] = label >= THROUGH_PART ? (uint32_t)pieces->count + (label - THROUGH_PART)
                                                  : numbers[label];
    }
    pieces->count += 2;
done:
    starg_release(w->context, numbers);
    return status;
}

/* Are all pieces seen from their guards, in both places? Rounding of new vertices may spoil it. */
static starg_status prove_all(compatible *w, bool *proven) {
    starg_status status = STARG_OK;
    *proven = true;
    for (uint32_t piece = 0; piece < w->pieces.count && *proven; piece++) {
        w->faces.count = 0;
        STARG_TRY(add_faces(w, piece, piece));
        *proven = w->faces.count > 0;
        for (int i = 0; i < 2 && *proven; i++) {
            const double *guards = i == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
            const kernel_faces surface = {w->meshes[i]->vertices, w->faces.data,
                                          w->faces.count / 3};
            *proven = kernel_sees_all(&surface, guards + 3 * (size_t)piece);
        }
    }
done:
    return status;
}

/* Tries planes for a group; *out has no pieces if none will do. */
static starg_status divide_group(const compatible *w, const uint8_t *dropped, starg_rng *rng,
                                 through_cut *cut, compatible *out) {
    starg_status status = STARG_OK;
    double guards[2][2][3];
    bool found = false;
    for (int i = 0; i < CUT_TRIES && !found; i++) {
        choose_plane(w, dropped, rng, cut->levels);
        STARG_TRY(through_find(cut, guards, &found));
    }
    if (found)
        STARG_TRY(through_divide(cut, w->pieces.labels, out->own, &out->pieces.labels, &found));
    if (!found)
        goto done;
    for (int i = 0; i < 2; i++)
        out->meshes[i] = out->own[i];
    STARG_TRY(number_parts(w, dropped, guards, out));
    STARG_TRY(list_pieces(out));
    STARG_TRY(prove_all(out, &found));
    if (!found)
        out->pieces.count = 0;
done:
    return status;
}

/* One group: *saved says whether it has become two pieces. */
static starg_status cut_group(compatible *w, uint64_t round, size_t *work, bool *saved) {
    starg_status status = STARG_OK;
    starg_context *context = w->context;
    starg_rng rng = starg_rng_make(context->seed, 1, round);
    through_cut cut = {.context = context, .meshes = {w->meshes[0], w->meshes[1]}};
    compatible next = {.context = context};
    uint8_t *dropped = NULL, *inside = NULL;
    size_t tetrahedra = 0, group = 0;
    *saved = false;
    STARG_NEW(context, STAGE, dropped, w->pieces.count);
    STARG_NEW(context, STAGE, inside, w->meshes[0]->count);
    STARG_NEW(context, STAGE, cut.levels, w->meshes[0]->vertex_count);
    STARG_TRY(drop_group(w, 3 + starg_rng_below(&rng, CUT_MOST - 2), &rng, dropped, &tetrahedra));
    for (size_t p = 0; p < w->pieces.count; p++)
        group += dropped[p];
    for (size_t t = 0; t < w->meshes[0]->count; t++)
        inside[t] = dropped[w->pieces.labels[t]];
    cut.inside = inside;
    if (group > 2)
        STARG_TRY(divide_group(w, dropped, &rng, &cut, &next));
    *work += CUT_TRIES * tetrahedra + w->meshes[0]->count / 10;
    if (next.pieces.count > 0) {
        swap(w, &next);
        *saved = true;
    }
done:
    through_free(&cut);
    starg_release(context, cut.levels);
    starg_release(context, dropped);
    starg_release(context, inside);
    compatible_free(&next);
    return status;
}

static starg_status cut_groups(compatible *w) {
    starg_status status = STARG_OK;
    size_t idle = 0, work = 0, most = CUT_WORK * w->meshes[0]->count;
    starg_progress_begin(w->context, STAGE);
    for (uint64_t round = 1; idle < CUT_IDLE && work < most && w->pieces.count > 2; round++) {
        bool saved;
        STARG_TRY(starg_check_cancel(w->context, STAGE));
        STARG_TRY(cut_group(w, round, &work, &saved));
        idle = saved ? 0 : idle + 1;
        starg_progress_step(w->context, work, most);
    }
done:
    starg_progress_end(w->context);
    return status;
}

/* ---- the result ---- */

static starg_status finish(const compatible *w, int place, starg_decomposition **out) {
    starg_status status = STARG_OK;
    const double *guards = place == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
    starg_tetmesh *mesh = NULL;
    int32_t *labels = NULL;
    STARG_NEW(w->context, STAGE, labels, w->meshes[0]->count);
    for (size_t t = 0; t < w->meshes[0]->count; t++)
        labels[t] = (int32_t)w->pieces.labels[t];
    STARG_TRY(tetmesh_copy(w->context, w->meshes[place], &mesh));
    status = decomposition_finish(w->context, STARG_DECOMPOSE_STRICT, mesh, labels, guards,
                                  w->pieces.count, out);
    labels = NULL;
    if (status == STARG_OK)
        (*out)->flattest = (*out)->flattest_given = tetmesh_flattest((*out)->mesh);
done:
    starg_release(w->context, labels);
    return status;
}

static starg_status join_start(compatible *w) {
    starg_status status = STARG_OK;
    STARG_TRY(list_pieces(w));
    STARG_TRY(join_all(w));
    renumber(w);
done:
    return status;
}

/* Parts between planes, of several rounds the fewest. */
static starg_status start_by_planes(const compatible *from, compatible *best) {
    starg_status status = STARG_OK;
    compatible next = {.context = from->context};
    for (uint64_t round = 0; round < PLANE_STARTS; round++) {
        compatible_free(&next);
        next = (compatible){.context = from->context, .meshes = {from->meshes[0], from->meshes[1]}};
        STARG_TRY(compatible_planes(from->context, from->meshes, round, next.own, &next.pieces));
        for (int i = 0; i < 2; i++)
            if (next.own[i] != NULL)
                next.meshes[i] = next.own[i];
        STARG_TRY(join_start(&next));
        if (round == 0 || next.pieces.count < best->pieces.count)
            swap(best, &next);
    }
done:
    compatible_free(&next);
    return status;
}

/* Regions that are grown or, where tetrahedra may be cut and these are fewer, parts between planes.
 */
static starg_status start(compatible *w, bool cut) {
    starg_status status = STARG_OK;
    compatible other = {.context = w->context};
    STARG_TRY(grow_compatible_regions(w->context, w->meshes[0], w->meshes[1], &w->pieces));
    STARG_TRY(join_start(w));
    STARG_TRY(renew_groups(w));
    if (cut && w->pieces.count > 1)
        STARG_TRY(start_by_planes(w, &other));
    if (other.pieces.count > 0 && other.pieces.count < w->pieces.count)
        swap(w, &other);
done:
    compatible_free(&other);
    return status;
}

starg_status compatible_decompose(starg_context *context, const starg_tetmesh *mesh,
                                  const starg_tetmesh *image, bool cut,
                                  starg_decomposition *out[2]) {
    starg_status status = STARG_OK;
    compatible w = {.context = context, .meshes = {mesh, image}};
    out[0] = out[1] = NULL;
    STARG_TRY(start(&w, cut));
    if (cut)
        STARG_TRY(cut_groups(&w));
    STARG_TRY(center_guards(&w));
    for (int i = 0; i < 2; i++)
        STARG_TRY(finish(&w, i, &out[i]));
done:
    if (status != STARG_OK) {
        starg_decomposition_free(context, out[0]);
        out[0] = NULL;
    }
    compatible_free(&w);
    return status;
}
