/* SPDX-License-Identifier: Apache-2.0 */
/* A first division of tetrahedra into star-shaped sets, few of them large.
 *
 * Problem: a valid start for the search that makes pieces few, for any tetrahedral mesh.
 *
 * The region of a guard g: a set of tetrahedra is strictly star-shaped about g exactly if every
 * face of its boundary has g strictly on the inner side; that is, if for every tetrahedron in it
 * and each of its faces that g is not strictly inside of, the neighbour across is in the set too
 * (the exact form of the visible dependency of [YL11, 4.1]). Grown from the tetrahedron that holds
 * g, a tetrahedron is added when all neighbours that it depends on are in. The set's winding number
 * about g is the number of its tetrahedra that hold g: one.
 *
 * With an image, the same tetrahedra in other places, a guard is a pair of points and a dependency
 * of either is one of the pair: sets are then star-shaped in both. The counterpart of a point is
 * where its tetrahedron takes it.
 *
 * Stages: the whole is a component; for each component, one guard if its kernel has an interior (a
 * linear program); else the best of several guards that start in random tetrahedra and climb, by
 * the volume of their regions; what is left falls into components, and so on.
 *
 * Invariants: finished regions never change; components are independent, so that their order does
 * not matter; every item's random numbers come from its component alone.
 *
 * Cost: growing a region is linear in the tetrahedra that it reaches; the number of guards tried
 * falls with the size of the component, so that a component costs at most about EFFORT steps. */
#include "star/certified/region_growing.h"

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/kernel.h"

static const char STAGE[] = "grow regions";

enum {
    CLIMBERS = 16,    /* guards that start and climb                                       */
    CLIMB_STEPS = 24, /* most steps of each                                                */
    STEPS_AGAIN = 6,  /* where a group is grown again: more groups save more than steps    */
    EFFORT = 4000000  /* tetrahedra that may be looked at for one component, about          */
};

#define UNASSIGNED UINT32_MAX

typedef STARG_ARRAY(uint32_t) index_list;

/* What a growing region knows of the tetrahedra that it met. */
typedef struct grower {
    uint32_t *epoch;  /* per tetrahedron: the region that met it last                    */
    uint8_t *missing; /* neighbours that it depends on and that are not in yet; 0xff: in */
    uint32_t now;
    index_list set;
} grower;

/* A point of the mesh, and its counterpart in the image. */
typedef struct guard_pair {
    double at[2][3];
} guard_pair;

typedef struct climber {
    guard_pair guard;
    double volume;
    uint32_t at; /* tetrahedron that holds the guard */
} climber;

typedef struct growing {
    starg_context *context;
    const starg_tetmesh *mesh, *image; /* no image: NULL */
    double *volumes;
    uint32_t *labels; /* finished regions; UNASSIGNED */
    uint32_t *region; /* per tetrahedron: the component that it belonged to last */
    uint32_t regions; /* numbered so far */
    uint64_t round;
    size_t assigned;    /* tetrahedra */
    index_list members; /* of the component at hand */
    double *running;    /* volumes of the members, added up */
    size_t running_size;
    climber climbers[CLIMBERS];
    const double *hints;
    uint32_t *hint_at; /* tetrahedron that holds each hint; UNASSIGNED: none */
    size_t hint_count;
} growing;

/* ---- one region ---- */

static bool looks_away(const starg_tetmesh *mesh, size_t t, int face, const double g[3]) {
    const int *k = TETMESH_FACE[face];
    return orient3d(tetmesh_corner(mesh, t, k[0]), tetmesh_corner(mesh, t, k[1]),
                    tetmesh_corner(mesh, t, k[2]), g) > 0;
}

static bool pair_looks_away(const growing *c, size_t t, int face, const guard_pair *g) {
    return looks_away(c->mesh, t, face, g->at[0]) &&
           (c->image == NULL || looks_away(c->image, t, face, g->at[1]));
}

static bool is_free(const growing *c, uint32_t t) {
    return t != STARG_TETMESH_NONE && c->labels[t] == UNASSIGNED;
}

/* Neighbours that t depends on for g; 0xfe if one of them can never be in. */
static uint8_t count_dependencies(const growing *c, uint32_t t, const guard_pair *g) {
    uint8_t count = 0;
    for (int face = 0; face < 4; face++) {
        if (pair_looks_away(c, t, face, g))
            continue;
        if (!is_free(c, c->mesh->neighbours[4 * (size_t)t + (size_t)face]))
            return 0xfe;
        count++;
    }
    return count;
}

static starg_status add(const growing *c, grower *grow, uint32_t t, double *volume) {
    grow->missing[t] = 0xff;
    *volume += c->volumes[t];
    PUSH(c->context, STAGE, &grow->set, t);
    return STARG_OK;
}

/* u depends on a tetrahedron that was added: it waits for one less. */
static starg_status reach(const growing *c, grower *grow, uint32_t u, const guard_pair *g,
                          double *volume) {
    if (grow->epoch[u] != grow->now) {
        grow->epoch[u] = grow->now;
        grow->missing[u] = count_dependencies(c, u, g);
    }
    if (grow->missing[u] >= 0xfe)
        return STARG_OK;
    return --grow->missing[u] == 0 ? add(c, grow, u, volume) : STARG_OK;
}

/* Grows the region of g from tetrahedron t, which holds it strictly inside. */
static starg_status grow_region(const growing *c, grower *grow, uint32_t t, const guard_pair *g,
                                double *volume) {
    grow->now++;
    grow->set.count = 0;
    *volume = 0;
    grow->epoch[t] = grow->now;
    TRY(add(c, grow, t, volume));
    for (size_t i = 0; i < grow->set.count; i++) {
        uint32_t s = grow->set.data[i];
        for (int face = 0; face < 4; face++) {
            /* where g is strictly inside of this face, it is strictly outside of it for u */
            uint32_t u = c->mesh->neighbours[4 * (size_t)s + (size_t)face];
            if (is_free(c, u) && pair_looks_away(c, s, face, g))
                TRY(reach(c, grow, u, g, volume));
        }
    }
    return STARG_OK;
}

/* ---- climbing ---- */

static void centroid(const starg_tetmesh *mesh, uint32_t t, double out[3]) {
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int v = 0; v < 4; v++)
            out[k] += 0.25 * tetmesh_corner(mesh, t, v)[k];
    }
}

/* Is g strictly inside t? */
static bool holds(const starg_tetmesh *mesh, uint32_t t, const double g[3]) {
    for (int face = 0; face < 4; face++)
        if (!looks_away(mesh, t, face, g))
            return false;
    return true;
}

static bool holds_pair(const growing *c, uint32_t t, const guard_pair *g) {
    return holds(c->mesh, t, g->at[0]) && (c->image == NULL || holds(c->image, t, g->at[1]));
}

/* Where tetrahedron t takes a point to in the image. */
static void find_counterpart(const growing *c, uint32_t t, guard_pair *g) {
    double edges[3][3], offset[3], share[3];
    if (c->image == NULL)
        return;
    for (int k = 0; k < 3; k++)
        vec3_subtract(tetmesh_corner(c->mesh, t, k + 1), tetmesh_corner(c->mesh, t, 0), edges[k]);
    vec3_subtract(g->at[0], tetmesh_corner(c->mesh, t, 0), offset);
    double whole = vec3_triple(edges[0], edges[1], edges[2]);
    for (int k = 0; k < 3; k++)
        share[k] = vec3_triple(offset, edges[(k + 1) % 3], edges[(k + 2) % 3]) / whole;
    vec3_copy(tetmesh_corner(c->image, t, 0), g->at[1]);
    for (int k = 0; k < 3; k++) {
        vec3_subtract(tetmesh_corner(c->image, t, k + 1), tetmesh_corner(c->image, t, 0), offset);
        vec3_along(g->at[1], share[k], offset, g->at[1]);
    }
}

/* Walks from tetrahedron t towards g through free ones; UNASSIGNED when the way is barred. */
static uint32_t walk(const growing *c, uint32_t t, const double g[3]) {
    for (size_t step = 0; step < 256; step++) {
        int face = 0;
        while (face < 4 && looks_away(c->mesh, t, face, g))
            face++;
        if (face == 4)
            return t;
        uint32_t next = c->mesh->neighbours[4 * (size_t)t + (size_t)face];
        if (!is_free(c, next))
            return UNASSIGNED;
        t = next;
    }
    return UNASSIGNED;
}

static uint32_t pick_member(const growing *c, starg_rng *rng) {
    double at = starg_rng_unit(rng) * c->running[c->members.count - 1];
    size_t low = 0, high = c->members.count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (c->running[middle] < at)
            low = middle + 1;
        else
            high = middle;
    }
    return c->members.data[low];
}

/* A place from which to climb: a hint that the component holds, else a random tetrahedron. */
static bool start(const growing *c, size_t item, starg_rng *rng, climber *out) {
    for (size_t i = item; i < c->hint_count; i += CLIMBERS)
        if (c->hint_at[i] != UNASSIGNED && c->region[c->hint_at[i]] == c->regions) {
            vec3_copy(c->hints + 3 * i, out->guard.at[0]);
            out->at = c->hint_at[i];
            return true;
        }
    out->at = pick_member(c, rng);
    centroid(c->mesh, out->at, out->guard.at[0]);
    if (c->image != NULL)
        centroid(c->image, out->at, out->guard.at[1]);
    return holds_pair(c, out->at, &out->guard);
}

static size_t steps_for(const growing *c) {
    size_t steps = EFFORT / CLIMBERS / c->members.count;
    size_t most = c->round > 0 ? STEPS_AGAIN : CLIMB_STEPS;
    if (starg_time_is_over(c->context))
        return 0;
    return steps > most ? most : steps;
}

static starg_status climb(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)context;
    starg_status status = STARG_OK;
    growing *c = shared;
    grower *grow = scratch;
    climber best = {.volume = 0};
    starg_rng rng = starg_rng_make(c->context->seed + starg_hash64(c->round), c->regions, item);
    if (!start(c, item, &rng, &best))
        goto done;
    STARG_TRY(grow_region(c, grow, best.at, &best.guard, &best.volume));
    double reach_out = cbrt(c->running[c->members.count - 1]);
    for (size_t step = 0; step < steps_for(c); step++) {
        climber next = {.volume = 0};
        for (int k = 0; k < 3; k++)
            next.guard.at[0][k] = best.guard.at[0][k] + reach_out * (starg_rng_unit(&rng) - 0.5);
        next.at = walk(c, best.at, next.guard.at[0]);
        reach_out *= 0.85;
        if (next.at == UNASSIGNED)
            continue;
        find_counterpart(c, next.at, &next.guard);
        if (!holds_pair(c, next.at, &next.guard))
            continue;
        STARG_TRY(grow_region(c, grow, next.at, &next.guard, &next.volume));
        if (next.volume > best.volume)
            best = next;
    }
done:
    c->climbers[item] = best;
    return status;
}

static void free_grower(starg_context *context, void *scratch) {
    (void)context;
    grower *grow = scratch;
    if (grow == NULL)
        return;
    RELEASE(grow->epoch, grow->missing, grow->set.data, grow);
}

static starg_status make_grower(starg_context *context, void *shared, void **out) {
    starg_status status = STARG_OK;
    const growing *c = shared;
    grower *grow = NULL;
    STARG_NEW_ZERO(context, STAGE, grow, 1);
    STARG_NEW_ZERO(context, STAGE, grow->epoch, c->mesh->count);
    STARG_NEW_ZERO(context, STAGE, grow->missing, c->mesh->count);
done:
    if (status != STARG_OK) {
        free_grower(context, grow);
        grow = NULL;
    }
    *out = grow;
    return status;
}

/* ---- components ---- */

static bool is_member(const growing *c, uint32_t t) {
    return is_free(c, t) && c->region[t] == c->regions;
}

/* Fills the members with the free tetrahedra that hang together with t, as a new region. */
static starg_status gather(growing *c, uint32_t t) {
    c->regions++;
    c->members.count = 0;
    c->region[t] = c->regions;
    PUSH(c->context, STAGE, &c->members, t);
    for (size_t i = 0; i < c->members.count; i++)
        for (size_t face = 0; face < 4; face++) {
            uint32_t u = c->mesh->neighbours[4 * (size_t)c->members.data[i] + face];
            if (!is_free(c, u) || is_member(c, u))
                continue;
            c->region[u] = c->regions;
            PUSH(c->context, STAGE, &c->members, u);
        }
    for (size_t i = 0; i < c->members.count; i++)
        c->running[i] = (i > 0 ? c->running[i - 1] : 0) + c->volumes[c->members.data[i]];
    return STARG_OK;
}

/* A guard that sees all of the component at hand, if there is one. */
static starg_status find_kernel(const growing *c, guard_pair *guard, bool *found) {
    const starg_tetmesh *const meshes[2] = {c->mesh, c->image};
    SCOPED index_list faces = {0};
    *found = true;
    for (size_t i = 0; i < c->members.count; i++)
        for (size_t face = 0; face < 4; face++) {
            uint32_t t = c->members.data[i];
            if (is_member(c, c->mesh->neighbours[4 * (size_t)t + face]))
                continue;
            for (int k = 0; k < 3; k++)
                PUSH(c->context, STAGE, &faces,
                     c->mesh->tetrahedra[4 * (size_t)t + (size_t)TETMESH_FACE[face][k]]);
        }
    for (int i = 0; i < 2 && meshes[i] != NULL && *found; i++) {
        const kernel_faces surface = {meshes[i]->vertices, faces.data, faces.count / 3};
        starg_kernel_result kernel;
        TRY(kernel_find(c->context, &surface, &kernel));
        vec3_copy(kernel.guard, guard->at[i]);
        *found = kernel.verdict == STARG_KERNEL_INTERIOR;
    }
    return STARG_OK;
}

static starg_status add_piece(grown_regions *out, growing *c, const guard_pair *guard,
                              const uint32_t *set, size_t count) {
    for (size_t i = 0; i < count; i++)
        c->labels[set[i]] = (uint32_t)out->count;
    c->assigned += count;
    for (int k = 0; k < 3; k++)
        PUSH(c->context, STAGE, &out->guards, guard->at[0][k]);
    for (int k = 0; k < 3 && c->image != NULL; k++)
        PUSH(c->context, STAGE, &out->counterparts, guard->at[1][k]);
    out->count++;
    return STARG_OK;
}

static const climber *best_climber(const growing *c) {
    const climber *best = &c->climbers[0];
    for (int i = 1; i < CLIMBERS; i++)
        if (c->climbers[i].volume > best->volume)
            best = &c->climbers[i];
    return best;
}

/* Grows one region of the component that holds t. */
static starg_status grow_from(growing *c, uint32_t t, grower *grow, grown_regions *out) {
    guard_pair guard = {.at = {{0}}};
    bool found;
    TRY(gather(c, t));
    TRY(find_kernel(c, &guard, &found));
    if (found) {
        return add_piece(out, c, &guard, c->members.data, c->members.count);
    }
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = CLIMBERS,
                                      .shared = c,
                                      .item = climb,
                                      .make_scratch = make_grower,
                                      .free_scratch = free_grower,
                                      .silent = true};
    TRY(starg_parallel_for(c->context, &loop));
    const climber *best = best_climber(c);
    if (best->volume > 0) {
        double volume;
        TRY(grow_region(c, grow, best->at, &best->guard, &volume));
        return add_piece(out, c, &best->guard, grow->set.data, grow->set.count);
    }
    /* centroids rounded out of slivers: a point of one tetrahedron, if doubles name any */
    c->region[t] = ++c->regions;
    c->members.data[0] = t;
    c->members.count = 1;
    TRY(find_kernel(c, &guard, &found));
    if (!found) {
        const uint64_t number = t;
        return starg_fail_at(c->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON,
                             &number, 1,
                             "tetrahedron %u is too thin to contain a point in double precision; "
                             "remove it or generate the mesh again",
                             (unsigned)t);
    }
    return add_piece(out, c, &guard, &t, 1);
}

/* ---- all ---- */

static void measure(growing *c) {
    for (size_t t = 0; t < c->mesh->count; t++) {
        double edge[3][3];
        for (int k = 0; k < 3; k++)
            vec3_subtract(tetmesh_corner(c->mesh, t, k + 1), tetmesh_corner(c->mesh, t, 0),
                          edge[k]);
        c->volumes[t] = fabs(vec3_triple(edge[0], edge[1], edge[2])) / 6;
    }
}

static void locate_hints(growing *c) {
    for (size_t i = 0; i < c->hint_count; i++) {
        c->hint_at[i] = UNASSIGNED;
        for (uint32_t t = 0; t < c->mesh->count && c->hint_at[i] == UNASSIGNED; t++)
            if (holds(c->mesh, t, c->hints + 3 * i))
                c->hint_at[i] = t;
    }
}

/* The regions of `former` that are kept, in their order. */
static starg_status keep(growing *c, const grown_regions *former, const uint8_t *dropped,
                         grown_regions *out) {
    SCOPED uint32_t *numbers = NULL;
    NEW(c->context, STAGE, numbers, former->count);
    for (size_t p = 0; p < former->count; p++) {
        numbers[p] = dropped[p] ? UNASSIGNED : (uint32_t)out->count;
        out->count += !dropped[p];
        for (size_t k = 3 * p; k < 3 * p + 3 && !dropped[p]; k++) {
            PUSH(c->context, STAGE, &out->guards, former->guards.data[k]);
            PUSH(c->context, STAGE, &out->counterparts, former->counterparts.data[k]);
        }
    }
    for (size_t t = 0; t < c->mesh->count; t++) {
        c->labels[t] = numbers[former->labels[t]];
        c->assigned += c->labels[t] != UNASSIGNED;
    }
    return STARG_OK;
}

/* Of `former`, NULL or regions without those dropped. */
static starg_status run(growing *c, const grown_regions *former, const uint8_t *dropped,
                        grown_regions *out) {
    starg_status status = STARG_OK;
    starg_context *context = c->context;
    size_t count = c->mesh->count;
    void *scratch = NULL;
    const bool tells = former == NULL; /* of its progress: what is grown again is small */
    *out = (grown_regions){.count = 0};
    if (tells)
        starg_progress_begin(context, STAGE);
    STARG_NEW(context, STAGE, c->volumes, count);
    STARG_NEW(context, STAGE, c->running, count);
    STARG_NEW_ZERO(context, STAGE, c->region, count);
    STARG_NEW(context, STAGE, c->hint_at, c->hint_count);
    STARG_NEW(context, STAGE, c->labels, count);
    memset(c->labels, 0xff, count * sizeof *c->labels);
    if (former != NULL)
        STARG_TRY(keep(c, former, dropped, out));
    STARG_TRY(make_grower(context, c, &scratch));
    measure(c);
    locate_hints(c);
    /* a component that a region leaves is found again from one of its tetrahedra */
    for (uint32_t t = 0; t < count; t++)
        while (c->labels[t] == UNASSIGNED) {
            STARG_TRY(starg_check_cancel(context, STAGE));
            if (tells)
                starg_progress_step(context, c->assigned, count);
            STARG_TRY(grow_from(c, t, scratch, out));
        }
    out->labels = c->labels;
    c->labels = NULL;
done:
    if (tells)
        starg_progress_end(context);
    free_grower(context, scratch);
    RELEASE(c->volumes, c->running, c->region, c->hint_at, c->labels, c->members.data);
    if (status != STARG_OK)
        grown_regions_free(out);
    return status;
}

starg_status grow_regions(starg_context *context, const starg_tetmesh *mesh, const double *hints,
                          size_t hint_count, grown_regions *out) {
    growing c = {.context = context, .mesh = mesh, .hints = hints, .hint_count = hint_count};
    return run(&c, NULL, NULL, out);
}

starg_status grow_compatible_regions(starg_context *context, const starg_tetmesh *mesh,
                                     const starg_tetmesh *image, grown_regions *out) {
    growing c = {.context = context, .mesh = mesh, .image = image};
    return run(&c, NULL, NULL, out);
}

starg_status grow_compatible_again(starg_context *context, const starg_tetmesh *mesh,
                                   const starg_tetmesh *image, const grown_regions *former,
                                   const uint8_t *dropped, uint64_t round, grown_regions *out) {
    growing c = {.context = context, .mesh = mesh, .image = image, .round = round};
    return run(&c, former, dropped, out);
}

void grown_regions_free(grown_regions *regions) {
    RELEASE(regions->labels, regions->guards.data, regions->counterparts.data);
    *regions = (grown_regions){.count = 0};
}
