/* SPDX-License-Identifier: Apache-2.0 */
/* Guards where tetrahedra are less flat.
 *
 * Problem: the centre of a kernel is as far as possible from all planes, but a small angle depends
 * on the size and the form of a facet, too. Find a place of each guard where the angles of its
 * tetrahedra lack less (star/strict/finish/flatness.c).
 *
 * Method: pattern search [Hooke, Jeeves 1961] towards the 26 neighbours in a grid, whose step is
 * halved where none is better. The flattest facets are looked at first, so that most places are
 * given up after a few.
 *
 * Invariants: a guard stays strictly inside all facets of its piece, by exact signs, and so the
 * surface winds around it once as before: on the way between two points of a kernel no facet is
 * met. Cost: for each piece that lacks anything, some hundred passes over facets that are flat, a
 * few over all of them. */
#include "star/strict/finish/finish.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { HALVINGS = 8, NEIGHBOURS = 27 /* and the place itself */ };

/* What a step must save at least. */
static const double LEAST = 1e-2;

typedef struct ranked_entry {
    double lack;
    uint32_t entry; /* of the partition's index */
} ranked_entry;

typedef struct settler {
    partition *p;
    const double *margins;
    ranked_entry *entries; /* of the piece, the flattest first */
    size_t count;
    uint64_t looks; /* at facets that are left */
} settler;

static int by_lack(const void *x, const void *y) {
    const ranked_entry *a = x, *b = y;
    if (a->lack != b->lack)
        return a->lack > b->lack ? -1 : 1;
    return (a->entry > b->entry) - (a->entry < b->entry);
}

/* What the angles of the piece lack, or more than `enough`. */
static double lack_of_angles(settler *s, double enough) {
    double sum = 0;
    size_t i = 0;
    for (; i < s->count && sum <= enough; i++) {
        uint32_t entry = s->entries[i].entry;
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
        s->entries[s->count++] = (ranked_entry){lack, entry};
        sum += lack;
    }
    if (sum > 0)
        qsort(s->entries, s->count, sizeof *s->entries, by_lack);
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
        double now = lack_of_angles(s, *lack - LEAST);
        if (now < *lack - LEAST && flatness_room(p, number) >= s->margins[number]) {
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

starg_status settle_guards(partition *p, const double *margins, uint64_t *looks, bool *any) {
    starg_status status = STARG_OK;
    settler s = {.p = p, .margins = margins, .looks = *looks};
    STARG_NEW(p->context, PARTITION_STAGE, s.entries, p->index.count);
    for (uint32_t i = 0; i < p->pieces.count && s.looks > 0; i++) {
        STARG_TRY(starg_check_cancel(p->context, PARTITION_STAGE));
        if (settle(&s, i))
            *any = true;
    }
    *looks = s.looks;
done:
    starg_release(p->context, s.entries);
    return status;
}
