/* SPDX-License-Identifier: Apache-2.0 */
/* Minimum-area triangulation of a loop [Barequet, Sharir: Filling gaps in the boundary of a
 * polyhedron, 1995]: dynamic programming over pairs of loop vertices, O(n^3). Existing edges of the
 * mesh are forbidden. Triangles that cross the mesh or one another are banned and the table is
 * recomputed, a few times; the best result is kept.
 *
 * Loops of more than LIMIT vertices are filled hierarchically: every s-th vertex makes a coarse
 * loop, and the gaps between its edges and the loop are filled one by one. */
#include "mesh/repair/repair.h"

#include "geometry/vec3.h"

enum { LIMIT = 192, ATTEMPTS = 6 };

/* Cost of an existing edge. */
#define IMPOSSIBLE ((uint32_t)1 << 20)

/* The cheapest filling between loop vertices i < j is at i n + j. */
typedef struct table {
    const fill_job *job;
    const uint32_t *loop;
    size_t count;
    double *area;
    uint32_t *bad;    /* faults, compared before area */
    uint32_t *apex;   /* the third corner at i, j */
    repair_keys bans; /* triples of places in the loop */
} table;

static uint64_t triple_key(size_t i, size_t k, size_t j) {
    return (uint64_t)i << 40 | (uint64_t)k << 20 | j;
}

static void solve_cell(table *t, size_t i, size_t j, uint32_t start) {
    size_t n = t->count, best = 0;
    const repair_state *state = t->job->state;
    double least = 0;
    uint32_t fewest = UINT32_MAX;
    for (size_t k = i + 1; k < j; k++) {
        const uint32_t corner[3] = {t->loop[i], t->loop[k], t->loop[j]};
        uint32_t bad = start + t->bad[i * n + k] + t->bad[k * n + j];
        if (bad > fewest)
            continue;
        double area =
            t->area[i * n + k] + t->area[k * n + j] +
            vec3_triangle_area(repair_position(state, corner[0]), repair_position(state, corner[1]),
                               repair_position(state, corner[2]));
        if (bad == fewest && !(area < least))
            continue;
        bad += repair_has_no_area(state, corner) || repair_keys_have(&t->bans, triple_key(i, k, j));
        if (bad > fewest || (bad == fewest && !(area < least)))
            continue;
        fewest = bad;
        least = area;
        best = k;
    }
    t->bad[i * n + j] = fewest < IMPOSSIBLE ? fewest : IMPOSSIBLE;
    t->area[i * n + j] = least;
    t->apex[i * n + j] = (uint32_t)best;
}

static void solve(table *t) {
    size_t n = t->count;
    for (size_t i = 0; i + 1 < n; i++) {
        t->bad[i * n + i + 1] = 0;
        t->area[i * n + i + 1] = 0;
    }
    for (size_t width = 2; width < n; width++)
        for (size_t i = 0; i + width < n; i++) {
            size_t j = i + width;
            bool inner = width < n - 1;
            bool taken = inner && t->job->taken(t->job->user, t->loop[i], t->loop[j]);
            solve_cell(t, i, j, taken ? IMPOSSIBLE : 0);
        }
}

/* Lists the triangles of the solution as triples of places; `stack` has 2 n entries. */
static void trace(const table *t, uint32_t *stack, uint32_t *places) {
    size_t depth = 0;
    stack[depth++] = 0;
    stack[depth++] = (uint32_t)(t->count - 1);
    while (depth > 0) {
        uint32_t j = stack[--depth], i = stack[--depth];
        if (j - i < 2)
            continue;
        uint32_t k = t->apex[i * t->count + j];
        *places++ = i;
        *places++ = k;
        *places++ = j;
        stack[depth++] = i;
        stack[depth++] = k;
        stack[depth++] = k;
        stack[depth++] = j;
    }
}

static void corners_of(const table *t, const uint32_t *place, uint32_t corner[3]) {
    for (int k = 0; k < 3; k++)
        corner[k] = t->loop[place[k]];
}

/* Does triangle `own` of the solution cross the mesh or another one of the solution? */
static bool is_fault(const table *t, const uint32_t *places, size_t own) {
    uint32_t corner[3], other[3];
    corners_of(t, places + 3 * own, corner);
    if (repair_has_no_area(t->job->state, corner) || repair_index_crosses(t->job->index, corner))
        return true;
    for (size_t i = 0; i < t->count - 2; i++) {
        corners_of(t, places + 3 * i, other);
        if (i != own &&
            faces_contact(t->job->state->vertices.data, corner, other) == TRIANGLES_CROSS)
            return true;
    }
    return false;
}

/* Bans the faulty triangles of the solution; returns their number. */
static starg_status ban_faults(table *t, const uint32_t *places, size_t *faults) {
    *faults = 0;
    for (size_t i = 0; i < t->count - 2; i++) {
        if (!is_fault(t, places, i))
            continue;
        const uint32_t *p = places + 3 * i;
        TRY(repair_keys_add(t->job->state->context, &t->bans, triple_key(p[0], p[1], p[2])));
        ++*faults;
    }
    return STARG_OK;
}

/* Solves repeatedly; `best` keeps the places of the triangles with the fewest faults. */
static starg_status attempt(table *t, uint32_t *best, size_t *faults, bool *possible) {
    starg_context *context = t->job->state->context;
    size_t n = t->count;
    SCOPED uint32_t *stack = NULL, *places = NULL;
    NEW(context, REPAIR_STAGE, stack, 2 * n + 4);
    NEW(context, REPAIR_STAGE, places, 3 * (n - 2));
    *faults = SIZE_MAX;
    for (int i = 0; i<ATTEMPTS && * faults> 0; i++) {
        size_t found;
        solve(t);
        *possible = t->bad[n - 1] < IMPOSSIBLE;
        if (!*possible)
            break;
        trace(t, stack, places);
        TRY(ban_faults(t, places, &found));
        if (found < *faults) {
            *faults = found;
            memcpy(best, places, 3 * (n - 2) * sizeof *best);
        }
    }
    return STARG_OK;
}

static starg_status fill_small(const fill_job *job, const uint32_t *loop, size_t count,
                               fill_list *triangles, size_t *faults, bool *possible) {
    starg_status status = STARG_OK;
    starg_context *context = job->state->context;
    table t = {.job = job, .loop = loop, .count = count};
    uint32_t *best = NULL;
    STARG_NEW(context, REPAIR_STAGE, t.area, count * count);
    STARG_NEW(context, REPAIR_STAGE, t.bad, count * count);
    STARG_NEW(context, REPAIR_STAGE, t.apex, count * count);
    STARG_NEW(context, REPAIR_STAGE, best, 3 * (count - 2));
    STARG_TRY(attempt(&t, best, faults, possible));
    for (size_t i = 0; *possible && i < 3 * (count - 2); i++)
        STARG_PUSH(context, REPAIR_STAGE, triangles, loop[best[i]]);
done:
    RELEASE(t.area, t.bad, t.apex, t.bans.slots, best);
    return status;
}

/* Picks about LIMIT / 2 places of the loop such that no chord between consecutive ones is an
 * existing edge. */
static size_t pick_places(const fill_job *job, const uint32_t *loop, size_t count, size_t *places) {
    size_t step = 2 * count / LIMIT + 1, picked = 0, at = 0;
    while (at < count) {
        places[picked++] = at;
        size_t next = at + step;
        while (next < count && job->taken(job->user, loop[at], loop[next]))
            next++;
        at = next;
    }
    if (places[picked - 1] != count - 1)
        places[picked++] = count - 1;
    return picked;
}

static starg_status fill_large(const fill_job *job, const uint32_t *loop, size_t count,
                               fill_list *triangles, size_t *faults, bool *possible) {
    starg_context *context = job->state->context;
    SCOPED size_t *places = NULL;
    size_t before = triangles->count;
    SCOPED uint32_t *coarse = NULL;
    NEW(context, REPAIR_STAGE, places, count + 1);
    NEW(context, REPAIR_STAGE, coarse, count + 1);
    size_t picked = pick_places(job, loop, count, places);
    for (size_t i = 0; i < picked; i++)
        coarse[i] = loop[places[i]];
    *possible = picked > 2 && picked <= LIMIT &&
                (places[picked - 1] - places[picked - 2] == 1 ||
                 !job->taken(job->user, coarse[picked - 2], coarse[picked - 1]));
    if (*possible)
        TRY(fill_small(job, coarse, picked, triangles, faults, possible));
    for (size_t i = 0; *possible && i + 1 < picked; i++) {
        size_t length = places[i + 1] - places[i] + 1, more = 0;
        if (length > 2)
            TRY(repair_fill(job, loop + places[i], length, triangles, &more, possible));
        *faults += more;
    }
    if (!*possible)
        triangles->count = before;
    return STARG_OK;
}

starg_status repair_fill(const fill_job *job, const uint32_t *loop, size_t count,
                         fill_list *triangles, size_t *faults, bool *possible) {
    *faults = 0;
    return (count <= LIMIT ? fill_small : fill_large)(job, loop, count, triangles, faults,
                                                      possible);
}
