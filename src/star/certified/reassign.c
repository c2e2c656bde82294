/* SPDX-License-Identifier: Apache-2.0 */
/* Piece elimination: distributes pieces among their neighbours.
 *
 * Problem: eliminate a piece whose neighbours together see all of it: partition it so that each
 * part is visible from the guard of the neighbour that receives it. Unlike a cut of the whole union
 * (repartition.c), this keeps the rest of the neighbours' surfaces. The same for the union of a few
 * pieces, some of which may be created anew.
 *
 * Method: every facet of the union goes to a taker whose guard sees it, with the tetrahedron
 * between it and a common apex (apply.c). Between two facets that share an edge and go to different
 * takers there is then a triangle from that edge to the apex, and each guard must be on its own
 * side of it. For a given apex and given guards this is a labelling of the facets with conditions
 * on neighbours only (labelling.c).
 *
 * Stages: a guard for each neighbour: its own, or one that sees all of the neighbour and as much as
 * can be of the union about a random place; and one for each piece that is made anew; which takers
 * each facet may go to; then, for some random places of the apex, which guards are on which side at
 * each edge, and the labelling.
 *
 * Invariants: rounded throughout; surfaces that are no manifold are left alone. Cost: a search for
 * a guard for each neighbour, linear in its facets; for each apex linear in edges x takers, and the
 * labelling. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum {
    APEXES = 16,
    NEIGHBOURS_MOST = FAN_TAKERS_MOST - FAN_PIECES_MOST,
    OWN_GUARD = 3, /* one in so many times */
    /* in the work counted */
    SORTING = 45,
    LABELLING = 6
};

static const double FLAT = 1e-16; /* twice the area of a triangle that has no plane */

typedef struct taker {
    uint32_t piece;
    double guard[3];
} taker;

/* An edge of the union, from a to b in the first of its facets, which edge i of the labelling
 * names. */
typedef struct union_edge {
    uint32_t a, b;
} union_edge;

typedef struct reassigner {
    const partition *p;
    const reassign_task *task;
    starg_rng *rng;
    region_scratch *scratch;
    region own; /* triangle i is that of entry i */
    taker takers[FAN_TAKERS_MOST];
    size_t taker_count;
    STARG_ARRAY(uint32_t) entries;
    STARG_ARRAY(union_edge) edges;
    labelling labelling;
} reassigner;

static void reassigner_free(reassigner *d) {
    region_free(&d->own);
    RELEASE(d->entries.data, d->edges.data);
    labelling_free(&d->labelling);
}

static const double *corner(const reassigner *d, size_t facet_number, int k) {
    return d->own.vertices.data + 3 * (size_t)d->own.triangles.data[facet_number].corners[k];
}

static size_t random_facet(const reassigner *d) {
    return starg_rng_below(d->rng, d->own.triangles.count);
}

/* A random point of a facet. */
static void random_point(const reassigner *d, size_t facet_number, double out[3]) {
    double u = starg_rng_unit(d->rng), v = starg_rng_unit(d->rng);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    for (int k = 0; k < 3; k++)
        out[k] = (1 - u - v) * corner(d, facet_number, 0)[k] + u * corner(d, facet_number, 1)[k] +
                 v * corner(d, facet_number, 2)[k];
}

static bool is_own(const reassigner *d, uint32_t number) {
    return partition_lists(d->task->pieces, d->task->piece_count, number);
}

/* ---- guards ---- */

static void add_taker(reassigner *d, uint32_t number, const double guard[3]) {
    taker *fresh = &d->takers[d->taker_count];
    fresh->piece = number;
    vec3_copy(guard, fresh->guard);
    d->labelling.ranks[d->taker_count++] = is_own(d, number) ? 0 : d->p->pieces.data[number].volume;
}

/* That sees all of the neighbour, and of the union what is about a random place. */
static starg_status add_guard_beyond(reassigner *d, uint32_t neighbour) {
    uint32_t all[FAN_PIECES_MOST + 1] = {neighbour};
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    region_reach reach;
    double place[3];
    for (size_t i = 0; i < d->task->piece_count; i++)
        all[i + 1] = d->task->pieces[i];
    TRY(region_gather(d->p, all, d->task->piece_count + 1, d->scratch, &r));
    random_point(d, random_facet(d), place);
    TRY(region_find_reach_beyond(&r, place, d->task->margin, d->scratch, &reach));
    if (reach.height > -INFINITY)
        add_taker(d, neighbour, reach.guard);
    return STARG_OK;
}

static starg_status add_neighbour(reassigner *d, uint32_t neighbour) {
    double guard[3];
    if (starg_rng_below(d->rng, OWN_GUARD) != 0)
        return add_guard_beyond(d, neighbour);
    partition_to_unit(d->p, d->p->pieces.data[neighbour].guard, guard);
    add_taker(d, neighbour, guard);
    return STARG_OK;
}

/* A guard for a piece that is made anew, about a random place. */
static starg_status add_kept(reassigner *d, uint32_t number) {
    region_reach reach;
    double place[3];
    random_point(d, random_facet(d), place);
    TRY(region_find_reach_about(&d->own, place, d->task->margin, d->scratch, &reach));
    if (reach.height > -INFINITY)
        add_taker(d, number, reach.guard);
    return STARG_OK;
}

static starg_status add_takers(reassigner *d) {
    size_t count = d->task->neighbour_count, first = 0;
    if (count > NEIGHBOURS_MOST) {
        first = starg_rng_below(d->rng, count);
        count = NEIGHBOURS_MOST;
    }
    for (size_t i = 0; i < count; i++)
        TRY(add_neighbour(d, d->task->neighbours[(first + i) % d->task->neighbour_count]));
    for (size_t i = 0; i < d->task->kept; i++)
        TRY(add_kept(d, d->task->pieces[i]));
    return STARG_OK;
}

/* ---- the union ---- */

/* In the order of region_gather. */
static starg_status gather_entries(reassigner *d) {
    const partition *p = d->p;
    for (size_t i = 0; i < d->task->piece_count; i++) {
        uint32_t number = d->task->pieces[i];
        for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
            uint32_t entry = p->index.data[k];
            if (!is_own(d, p->facets.data[entry / 2].side[1 - entry % 2]))
                PUSH(p->context, PARTITION_STAGE, &d->entries, entry);
        }
    }
    return STARG_OK;
}

/* Takers that see a facet, or are beyond it: for these it vanishes. One that is beyond it and not
 * behind it must have it. */
static label_set takers_of(const reassigner *d, size_t facet_number) {
    const double *row = d->own.rows.data + 4 * (size_t)d->own.triangles.data[facet_number].row;
    uint32_t entry = d->entries.data[facet_number];
    uint32_t beyond = d->p->facets.data[entry / 2].side[1 - entry % 2];
    label_set set = 0;
    for (size_t k = 0; k < d->taker_count; k++) {
        double outside = vec3_dot(row, d->takers[k].guard) - row[3];
        bool is_beyond = d->takers[k].piece == beyond;
        if (is_beyond && outside < d->task->margin)
            return (label_set)1 << k;
        if (is_beyond || outside < -d->task->margin)
            set |= (label_set)1 << k;
    }
    return set;
}

/* *fine is false when no taker will do for some facet. */
static starg_status find_takers(reassigner *d, bool *fine) {
    *fine = true;
    d->scratch->work += d->entries.count * d->taker_count;
    for (size_t i = 0; i < d->entries.count && *fine; i++) {
        label_set set = takers_of(d, i);
        *fine = set != 0;
        PUSH(d->p->context, PARTITION_STAGE, &d->labelling.given, set);
    }
    return STARG_OK;
}

/* Two halves are an edge. *fine is false where an edge has other than two facets. */
static starg_status pair_edges(reassigner *d, const partition_edge *halves, size_t count,
                               bool *fine) {
    *fine = true;
    for (size_t i = 0; i < count && *fine; i += 2) {
        const partition_edge *x = &halves[i], *y = x + 1;
        *fine = i + 1 < count && x->a == y->b && x->b == y->a &&
                (i + 2 == count || !partition_same_edge(x, x + 2));
        if (!*fine)
            break;
        const union_edge edge = {x->a, x->b};
        const labelling_edge same = {.nodes = {x->facet, y->facet}};
        PUSH(d->p->context, PARTITION_STAGE, &d->edges, edge);
        PUSH(d->p->context, PARTITION_STAGE, &d->labelling.edges, same);
    }
    return STARG_OK;
}

static starg_status find_edges(reassigner *d, bool *fine) {
    starg_context *context = d->p->context;
    const size_t count = 3 * d->entries.count;
    SCOPED partition_edge *halves = NULL;
    d->scratch->work += SORTING * d->entries.count;
    NEW(context, PARTITION_STAGE, halves, count);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *c = d->own.triangles.data[i / 3].corners;
        halves[i] = (partition_edge){c[i % 3], c[(i + 1) % 3], i / 3};
    }
    TRY(partition_sort_edges(context, halves, count, d->own.vertices.count / 3));
    TRY(pair_edges(d, halves, count, fine));
    return *fine ? labelling_prepare(&d->labelling) : STARG_OK;
}

/* ---- the apex ---- */

/* Between a guard within the union and a random place on the surface: that of a piece that is made
 * anew, which then has the apex before it, or of one of those given. */
static void choose_apex(const reassigner *d, double apex[3]) {
    const taker *last = &d->takers[d->taker_count - 1];
    double guard[3], place[3], away[3];
    if (d->task->kept > 0 && is_own(d, last->piece)) {
        vec3_copy(last->guard, guard);
    } else {
        uint32_t number = d->task->pieces[starg_rng_below(d->rng, d->task->piece_count)];
        partition_to_unit(d->p, d->p->pieces.data[number].guard, guard);
    }
    random_point(d, random_facet(d), place);
    vec3_subtract(place, guard, away);
    vec3_along(guard, starg_rng_unit(d->rng), away, apex);
}

/* Takers by the side of the triangle between an edge and the apex on which their guards are. */
static void find_fits(const reassigner *d, const double apex[3], const union_edge *e,
                      labelling_edge *edge) {
    const double *a = d->own.vertices.data + 3 * (size_t)e->a;
    const double *b = d->own.vertices.data + 3 * (size_t)e->b;
    double normal[3];
    vec3_triangle_normal(b, a, apex, normal);
    double length = vec3_length(normal), offset = vec3_dot(normal, a);
    edge->fits[0] = edge->fits[1] = 0;
    if (length < FLAT)
        return;
    double room = 0.5 * d->task->margin * length;
    for (size_t k = 0; k < d->taker_count; k++) {
        double outside = vec3_dot(normal, d->takers[k].guard) - offset;
        edge->fits[0] |= (label_set)(outside < -room) << k;
        edge->fits[1] |= (label_set)(outside > room) << k;
    }
}

/* ---- the plan ---- */

static uint8_t number_of(label_set single) {
    uint8_t number = 0;
    while ((single >> number & 1) == 0)
        number++;
    return number;
}

static starg_status make_plan(const reassigner *d, fan_plan *plan) {
    uint8_t place[FAN_TAKERS_MOST];
    bool used[FAN_TAKERS_MOST] = {false};
    plan->piece_count = d->task->piece_count;
    plan->kept = d->task->kept;
    plan->taker_count = plan->takes.count = plan->entries.count = 0;
    for (size_t i = 0; i < d->task->piece_count; i++)
        plan->pieces[i] = d->task->pieces[i];
    for (size_t i = 0; i < d->entries.count; i++) {
        uint8_t label = number_of(d->labelling.left.data[i]);
        if (!used[label]) {
            used[label] = true;
            place[label] = (uint8_t)plan->taker_count;
            plan->takers[plan->taker_count++] = d->takers[label].piece;
        }
        PUSH(d->p->context, PARTITION_STAGE, &plan->takes, place[label]);
        PUSH(d->p->context, PARTITION_STAGE, &plan->entries, d->entries.data[i]);
    }
    return STARG_OK;
}

/* Does a move make the sum of the squares of volumes larger? */
static bool is_uneven(const reassigner *d, const fan_plan *plan) {
    double taken[FAN_TAKERS_MOST] = {0}, before = 0, after = 0;
    for (size_t i = 0; i < plan->takes.count; i++) {
        double edge[3][3];
        for (int k = 0; k < 3; k++)
            vec3_subtract(corner(d, i, k), plan->apex, edge[k]);
        taken[plan->takes.data[i]] += vec3_triple(edge[0], edge[1], edge[2]) / 6;
    }
    for (size_t i = 0; i < plan->taker_count; i++) {
        double volume = d->p->pieces.data[plan->takers[i]].volume;
        double now = taken[i] + (is_own(d, plan->takers[i]) ? 0 : volume);
        before += volume * volume;
        after += now * now;
    }
    return plan->taker_count > 1 && after > before * (1 + 1e-9);
}

/* All kept pieces are there, and a move is worth while. */
static bool will_do(const reassigner *d, const fan_plan *plan) {
    for (size_t i = 0; i < plan->kept; i++)
        if (!partition_lists(plan->takers, plan->taker_count, plan->pieces[i]))
            return false;
    return plan->kept < plan->piece_count || is_uneven(d, plan);
}

static starg_status try_apex(reassigner *d, fan_plan *plan, bool *found) {
    choose_apex(d, plan->apex);
    d->scratch->work += d->edges.count * (LABELLING + d->taker_count);
    for (size_t i = 0; i < d->edges.count; i++)
        find_fits(d, plan->apex, &d->edges.data[i], &d->labelling.edges.data[i]);
    TRY(labelling_solve(&d->labelling, d->rng, found));
    if (!*found)
        return STARG_OK;
    TRY(make_plan(d, plan));
    *found = will_do(d, plan);
    return STARG_OK;
}

starg_status reassign_find(const partition *p, const reassign_task *task, starg_rng *rng,
                           region_scratch *scratch, fan_plan *plan, bool *found) {
    starg_status status = STARG_OK;
    reassigner d = {
        .p = p, .task = task, .rng = rng, .scratch = scratch, .labelling = {.context = p->context}};
    bool fine;
    *found = false;
    *plan = (fan_plan){.piece_count = 0};
    STARG_TRY(region_gather(p, task->pieces, task->piece_count, scratch, &d.own));
    STARG_TRY(gather_entries(&d));
    STARG_TRY(add_takers(&d));
    STARG_TRY(find_takers(&d, &fine));
    fine = fine && d.taker_count > 0;
    if (fine)
        STARG_TRY(find_edges(&d, &fine));
    for (int i = 0; i < APEXES && fine && !*found; i++)
        STARG_TRY(try_apex(&d, plan, found));
done:
    if (status != STARG_OK || !*found)
        fan_plan_free(plan);
    reassigner_free(&d);
    return status;
}
