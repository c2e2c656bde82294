/* SPDX-License-Identifier: Apache-2.0 */
/* Better tetrahedra by small changes of a finished partition.
 *
 * Problem: a cut that passes close to a vertex of the model makes short edges there, and thin
 * triangles on the other sides of these, in the faces of the model and in borders; so do borders
 * that meet at small angles. Make the tetrahedra on them less flat (widen.c).
 *
 * Method: local search, the flattest facet first. A vertex made by cuts moves part of the way
 * towards a neighbour, or onto it, where the facets at both vanish (edge collapse); or two
 * triangles exchange their common edge for the other diagonal (edge swap). Of all changes at a
 * facet the best is made, if what angles lack gets less and no facet lacks more than the worst did.
 * Rounds go on while anything changes; then guards move, and again. A guard moves by pattern search
 * [Hooke, Jeeves 1961] towards the 26 neighbours in a grid, whose step is halved where none is
 * better, the flattest facets looked at first.
 *
 * A vertex may move towards what is in all faces of the model that it is in, so that each of them
 * stays covered. Borders between pieces may bend.
 *
 * Why pieces stay star-shaped: let each guard be strictly inside all facets at the vertex that do
 * not vanish, before and after. The orientation of a facet with a guard is affine in the vertex, so
 * it is positive all the way, and no facet passes a guard; hence the surface winds around it once
 * as before. Likewise for a swap: guards see both pairs of triangles from the same side, so that
 * none is in the tetrahedron between them. And facets in a face of the model that are all seen from
 * the same side cover it once if they did so before.
 *
 * A guard stays strictly inside all facets of its piece: on the way between two points of a kernel
 * no facet is met.
 *
 * Invariants: those of the partition. Cost: a round is a pass over the facets, and for each that is
 * flat and each of its corners, some passes over the facets there times neighbours; `work` in
 * total. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { ROUNDS_MOST = 32, REPEATS = 2, LOOK_WORK = 64 };

static const uint32_t NONE = UINT32_MAX;

/* What a change must save at least; the least share of the way to a neighbour; of FLATNESS_MARGIN,
 * what is enough. */
static const double LEAST = 1e-3, SHARE_LEAST = 1.0 / 128, ENOUGH = 0.6;

typedef struct reshaper {
    partition *p;
    double *margins; /* by piece: what the guard's is not to fall below, in unit coordinates */
    bool *touched;   /* by point: some facet at it has changed in this round */
    uint64_t looks;  /* at facets that are left */
    STARG_ARRAY(flatness_rank) flat;
} reshaper;

/* What facets lack, in all and at most. */
typedef struct deficit {
    double sum, most;
} deficit;

/* A vertex moves, or else facets get other corners. */
typedef struct change {
    double saved;
    uint32_t from, to; /* vertices; NONE for a swap */
    double share;      /* of the way; 1: the edge between them is collapsed */
    uint32_t facets[2];
    facet swapped[2];
} change;

/* ---- angles and margins ---- */

static starg_status find_margins(reshaper *r) {
    const partition *p = r->p;
    NEW(p->context, PARTITION_STAGE, r->margins, p->pieces.count);
    for (uint32_t i = 0; i < p->pieces.count; i++)
        r->margins[i] =
            fmin(flatness_room(p, i), ENOUGH * FLATNESS_MARGIN * flatness_diagonal(p, i));
    return STARG_OK;
}

static bool keeps_margins(const reshaper *r, const facet *f) {
    partition_plane plane;
    partition_plane_of(r->p, f->corners, &plane);
    for (int side = 0; side < 2; side++) {
        double guard[3];
        if (f->side[side] == PARTITION_OUTSIDE)
            continue;
        partition_to_unit(r->p, r->p->pieces.data[f->side[side]].guard, guard);
        if (fabs(vec3_dot(plane.normal, guard) - plane.offset) < r->margins[f->side[side]])
            return false;
    }
    return true;
}

static void add_lack(const partition *p, const facet *f, deficit *to) {
    double of = flatness_of_facet(p, f);
    to->sum += of;
    to->most = fmax(to->most, of);
}

/* What a change would save, 0 if it must not be made. */
static double saving(const deficit *before, const deficit *after) {
    return after->most <= before->most ? before->sum - after->sum : 0;
}

/* ---- vertices ---- */

static bool has_corner(const facet *f, uint32_t vertex) {
    return f->corners[0] == vertex || f->corners[1] == vertex || f->corners[2] == vertex;
}

static bool is_outer(const facet *f) {
    return f->side[FACET_OUTER] == PARTITION_OUTSIDE;
}

/* Does a face of the model have a facet at a vertex? */
static bool is_in_face(const partition *p, uint32_t vertex, uint32_t plane) {
    for (uint32_t c = p->first_at.data[vertex]; c != PARTITION_NO_CORNER; c = p->next_at.data[c])
        if (is_outer(&p->facets.data[c / 3]) && p->facets.data[c / 3].plane == plane)
            return true;
    return false;
}

static bool may_move(const partition *p, uint32_t from, uint32_t to) {
    for (uint32_t c = p->first_at.data[from]; c != PARTITION_NO_CORNER; c = p->next_at.data[c]) {
        const facet *f = &p->facets.data[c / 3];
        if (is_outer(f) && !is_in_face(p, to, f->plane))
            return false;
    }
    return true;
}

static void put(partition *p, uint32_t vertex, const double at[3]) {
    vec3_copy(at, p->points.data + 3 * (size_t)vertex);
    partition_to_unit(p, at, p->unit.data + 3 * (size_t)vertex);
}

static void put_between(partition *p, uint32_t from, uint32_t to, double share) {
    double at[3];
    for (int k = 0; k < 3; k++) {
        double a = partition_point(p, from)[k], b = partition_point(p, to)[k];
        at[k] = share == 1 ? b : a + share * (b - a);
    }
    put(p, from, at);
}

/* Of the facets at a vertex but not at the other one. False if they must not be so. */
static bool measure(reshaper *r, uint32_t vertex, uint32_t other, deficit *out) {
    const partition *p = r->p;
    *out = (deficit){0, 0};
    for (uint32_t c = p->first_at.data[vertex]; c != PARTITION_NO_CORNER; c = p->next_at.data[c]) {
        const facet *f = &p->facets.data[c / 3];
        if (other != NONE && has_corner(f, other))
            continue;
        add_lack(p, f, out);
        r->looks -= r->looks > 0;
        if (out->sum == INFINITY || !keeps_margins(r, f))
            return false;
    }
    return true;
}

static void try_way(reshaper *r, uint32_t from, uint32_t to, const deficit *before, change *best) {
    double at[3];
    vec3_copy(partition_point(r->p, from), at);
    for (double share = 1; share >= SHARE_LEAST; share *= 0.5) {
        deficit after;
        put_between(r->p, from, to, share);
        bool valid = measure(r, from, share == 1 ? to : NONE, &after);
        double saved = valid ? saving(before, &after) : 0;
        if (saved > best->saved)
            *best = (change){.saved = saved, .from = from, .to = to, .share = share};
        put(r->p, from, at);
    }
}

/* All moves of a vertex. */
static void try_moves(reshaper *r, uint32_t vertex, change *best) {
    const partition *p = r->p;
    deficit before = {0, 0};
    if (vertex < p->first_points || r->touched[vertex])
        return;
    for (uint32_t c = p->first_at.data[vertex]; c != PARTITION_NO_CORNER; c = p->next_at.data[c])
        add_lack(p, &p->facets.data[c / 3], &before);
    for (uint32_t c = p->first_at.data[vertex]; c != PARTITION_NO_CORNER; c = p->next_at.data[c]) {
        /* each neighbour is the next corner of some facet */
        uint32_t to = p->facets.data[c / 3].corners[(c % 3 + 1) % 3];
        if (!r->touched[to] && may_move(p, vertex, to))
            try_way(r, vertex, to, &before, best);
    }
}

/* ---- edges ---- */

/* The facet beyond edge k of another one, if these two are all at the edge (so that they are
 * between the same pieces), and in the same face of the model if they are in any. */
static uint32_t find_beyond(const partition *p, uint32_t number, int k) {
    const facet *f = &p->facets.data[number];
    uint32_t from = f->corners[k], to = f->corners[(k + 1) % 3], found = NONE;
    for (uint32_t c = p->first_at.data[from]; c != PARTITION_NO_CORNER; c = p->next_at.data[c]) {
        const facet *g = &p->facets.data[c / 3];
        if (c / 3 == number || !has_corner(g, to))
            continue;
        if (found != NONE || (is_outer(f) && g->plane != f->plane))
            return NONE;
        found = c / 3;
    }
    return found;
}

static bool is_touched(const reshaper *r, const facet *f) {
    return r->touched[f->corners[0]] || r->touched[f->corners[1]] || r->touched[f->corners[2]];
}

static facet with_corners(const facet *like, uint32_t a, uint32_t b, uint32_t c) {
    return (facet){{a, b, c}, {like->side[0], like->side[1]}, like->plane};
}

/* Edge k of a facet. */
static void try_swap(const reshaper *r, uint32_t number, int k, change *best) {
    const facet *f = &r->p->facets.data[number];
    uint32_t beyond = is_touched(r, f) ? NONE : find_beyond(r->p, number, k);
    if (beyond == NONE || is_touched(r, &r->p->facets.data[beyond]))
        return;
    const facet *g = &r->p->facets.data[beyond];
    uint32_t a = f->corners[k], b = f->corners[(k + 1) % 3], c = f->corners[(k + 2) % 3];
    uint32_t d = g->corners[0] + g->corners[1] + g->corners[2] - a - b;
    change swap = {.from = NONE,
                   .facets = {number, beyond},
                   .swapped = {with_corners(f, a, d, c), with_corners(f, d, b, c)}};
    deficit before = {0, 0}, after = {0, 0};
    add_lack(r->p, f, &before);
    add_lack(r->p, g, &before);
    bool valid = true;
    for (int i = 0; i < 2; i++) {
        add_lack(r->p, &swap.swapped[i], &after);
        valid = valid && keeps_margins(r, &swap.swapped[i]);
    }
    swap.saved = valid ? saving(&before, &after) : 0;
    if (swap.saved > best->saved)
        *best = swap;
}

/* ---- changes ---- */

static void touch(reshaper *r, const facet *f) {
    for (int k = 0; k < 3; k++)
        r->touched[f->corners[k]] = true;
}

/* A facet between pieces that has changed gets a plane of its own. */
static starg_status give_plane(partition *p, facet *f) {
    partition_plane plane;
    if (is_outer(f))
        return STARG_OK;
    partition_plane_of(p, f->corners, &plane);
    f->plane = (uint32_t)p->planes.count;
    PUSH(p->context, PARTITION_STAGE, &p->planes, plane);
    return STARG_OK;
}

/* Facets that vanish keep their place until the end of the round, without pieces. */
static starg_status make_move(reshaper *r, const change *how) {
    partition *p = r->p;
    put_between(p, how->from, how->to, how->share);
    for (uint32_t c = p->first_at.data[how->from]; c != PARTITION_NO_CORNER;
         c = p->next_at.data[c]) {
        facet *f = &p->facets.data[c / 3];
        touch(r, f);
        if (how->share == 1 && has_corner(f, how->to)) {
            f->side[FACET_INNER] = f->side[FACET_OUTER] = PARTITION_OUTSIDE;
            continue;
        }
        if (how->share == 1)
            f->corners[c % 3] = how->to;
        TRY(give_plane(p, f));
    }
    return STARG_OK;
}

static starg_status make(reshaper *r, const change *how) {
    if (how->from != NONE)
        return make_move(r, how);
    for (int i = 0; i < 2; i++) {
        facet *f = &r->p->facets.data[how->facets[i]];
        *f = how->swapped[i];
        touch(r, f);
        TRY(give_plane(r->p, f));
    }
    return STARG_OK;
}

/* ---- rounds ---- */

/* Those with vertices of cuts. */
static starg_status rank_flat(reshaper *r) {
    const partition *p = r->p;
    r->flat.count = 0;
    for (uint32_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        bool made = false;
        for (int k = 0; k < 3; k++)
            made = made || f->corners[k] >= p->first_points;
        const flatness_rank one = {made ? flatness_of_facet(p, f) : 0, i};
        if (one.lack > 0)
            PUSH(p->context, PARTITION_STAGE, &r->flat, one);
    }
    if (r->flat.count > 1)
        qsort(r->flat.data, r->flat.count, sizeof *r->flat.data, flatness_compare);
    return STARG_OK;
}

static starg_status change_at(reshaper *r, uint32_t number, bool *any) {
    change best = {.saved = LEAST};
    for (int k = 0; k < 3; k++) {
        try_moves(r, r->p->facets.data[number].corners[k], &best);
        try_swap(r, number, k, &best);
    }
    if (best.saved <= LEAST)
        return STARG_OK;
    TRY(make(r, &best));
    *any = true;
    return STARG_OK;
}

/* What a round costs that changes nothing, index included: half a look for each facet. */
static void count_round(reshaper *r) {
    const uint64_t cost = r->p->facets.count / 2;
    r->looks -= cost < r->looks ? cost : r->looks;
}

static void drop_vanished(partition *p) {
    size_t kept = 0;
    for (size_t i = 0; i < p->facets.count; i++)
        if (p->facets.data[i].side[FACET_INNER] != PARTITION_OUTSIDE)
            p->facets.data[kept++] = p->facets.data[i];
    p->facets.count = kept;
}

static starg_status run_round(reshaper *r, bool *any) {
    starg_status status = STARG_OK;
    partition *p = r->p;
    *any = false;
    STARG_TRY(starg_check_cancel(p->context, PARTITION_STAGE));
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, r->touched, p->points.count / 3);
    STARG_TRY(rank_flat(r));
    count_round(r);
    for (size_t i = 0; i < r->flat.count && r->looks > 0; i++)
        STARG_TRY(change_at(r, r->flat.data[i].number, any));
    drop_vanished(p);
    STARG_TRY(partition_build_index(p));
done:
    starg_release(p->context, r->touched);
    r->touched = NULL;
    return status;
}

static bool may_go_on(const reshaper *r) {
    return r->looks > 0 && !starg_time_is_over(r->p->context);
}

static starg_status change_facets(reshaper *r, bool *any) {
    bool go_on = true;
    for (int i = 0; i < ROUNDS_MOST && go_on && may_go_on(r); i++) {
        TRY(run_round(r, &go_on));
        *any = *any || go_on;
    }
    return STARG_OK;
}

/* What pieces are known by. */
static starg_status measure_pieces(partition *p) {
    SCOPED partition_triangles triangles = {0};
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        piece *of = &p->pieces.data[i];
        triangles.count = 0;
        TRY(partition_gather(p, i, &triangles));
        of->volume = partition_volume(p, triangles.data, triangles.count / 3);
        of->radius = flatness_room(p, i);
        of->stamp = ++p->stamps;
    }
    return STARG_OK;
}

/* ---- guards ---- */

enum { HALVINGS = 8, NEIGHBOURS = 27 /* and the place itself */ };

/* What a step must save at least. */
static const double STEP_LEAST = 1e-2;

typedef struct settler {
    partition *p;
    const double *margins;
    flatness_rank *entries; /* of the partition's index, for the piece, the flattest first */
    size_t count;
    uint64_t looks; /* at facets that are left */
} settler;

/* What the angles of the piece lack, or more than `enough`. */
static double lack_of_angles(settler *s, double enough) {
    double sum = 0;
    size_t i = 0;
    for (; i < s->count && sum <= enough; i++) {
        uint32_t entry = s->entries[i].number;
        sum += flatness_of_side(s->p, &s->p->facets.data[entry / 2], (int)(entry % 2));
    }
    s->looks -= i < s->looks ? i : s->looks;
    return sum;
}

/* Returns what they lack. */
static double rank_entries(settler *s, uint32_t number) {
    const partition *p = s->p;
    double sum = 0;
    s->count = 0;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t entry = p->index.data[k];
        double lack = flatness_of_side(p, &p->facets.data[entry / 2], (int)(entry % 2));
        s->entries[s->count++] = (flatness_rank){lack, entry};
        sum += lack;
    }
    if (sum > 0)
        qsort(s->entries, s->count, sizeof *s->entries, flatness_compare);
    return sum;
}

/* Moves the guard to the first neighbour that is better, if there is one. */
static bool take_step(settler *s, uint32_t number, double step, double *lack) {
    partition *p = s->p;
    double *guard = p->pieces.data[number].guard, before[3], unit[3];
    vec3_copy(guard, before);
    partition_to_unit(p, before, unit);
    for (int i = 0; i < NEIGHBOURS && s->looks > 0; i++) {
        const double at[3] = {unit[0] + step * (i % 3 - 1), unit[1] + step * (i / 3 % 3 - 1),
                              unit[2] + step * (i / 9 - 1)};
        partition_from_unit(p, at, guard);
        double now = lack_of_angles(s, *lack - STEP_LEAST);
        if (now < *lack - STEP_LEAST && flatness_room(p, number) >= s->margins[number]) {
            *lack = now;
            return true;
        }
    }
    vec3_copy(before, guard);
    return false;
}

/* From twice the margin downwards. */
static bool settle(settler *s, uint32_t number) {
    double lack = rank_entries(s, number), step = 2 * flatness_room(s->p, number);
    bool any = false;
    for (int i = 0; i < HALVINGS && lack > 0; step *= 0.5, i++)
        while (take_step(s, number, step, &lack))
            any = true;
    return any;
}

/* Moves guards within their kernels, so that angles lack less, with at least these margins (one for
 * each piece, in unit coordinates). Looks at about `looks` facets at most, and subtracts how many
 * it looked at. The partition has an index. Errors: MEMORY, CANCELLED. */
static starg_status move_guards(partition *p, const double *margins, uint64_t *looks, bool *any) {
    SCOPED flatness_rank *entries = NULL;
    NEW(p->context, PARTITION_STAGE, entries, p->index.count);
    settler s = {.p = p, .margins = margins, .looks = *looks, .entries = entries};
    for (uint32_t i = 0; i < p->pieces.count && s.looks > 0; i++) {
        TRY(starg_check_cancel(p->context, PARTITION_STAGE));
        if (settle(&s, i))
            *any = true;
    }
    *looks = s.looks;
    return STARG_OK;
}

/* ---- all ---- */

starg_status reshape(partition *p, uint64_t work) {
    starg_status status = STARG_OK;
    reshaper r = {.p = p, .looks = work / LOOK_WORK};
    bool any = true;
    STARG_TRY(find_margins(&r));
    STARG_TRY(change_facets(&r, &any));
    for (int i = 0; i < REPEATS && any && may_go_on(&r); i++) {
        any = false;
        STARG_TRY(move_guards(p, r.margins, &r.looks, &any));
        STARG_TRY(change_facets(&r, &any));
    }
    STARG_TRY(measure_pieces(p));
done:
    p->context->work += (work / LOOK_WORK - r.looks) * LOOK_WORK / PARTITION_WORK;
    RELEASE(r.margins, r.flat.data);
    return status;
}
