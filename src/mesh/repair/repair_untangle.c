/* SPDX-License-Identifier: Apache-2.0 */
/* Resolves local self-intersections of closed components.
 *
 * Each round collects faces that cross others of their own component into connected patches. For
 * each patch it first smooths the vertices a little; if that does not help, it removes the patch
 * with up to three rings around it and fills the hole. A change is kept only if fewer pairs of
 * faces cross in the whole mesh and the topology stays the same: patches that are not discs are not
 * removed. Changes of one round are disjoint, so that the tables of the round stay valid. Rounds
 * end when no crossing is left, when nothing helps, or at their limit. Intersections between
 * components are not local and stay.
 *
 * To evaluate a change, its faces are marked REPAIR_GONE and appended to the mesh again: first in
 * their old, then in their new form. */
#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "mesh/repair/repair.h"

/* Largest displacement of an input vertex, as a fraction of the diagonal. */
#define LARGEST_MOVE 0.01

enum { SMOOTHING_STEPS = 8, MAX_RINGS = 3, MAX_REGION = 1024, MAX_LOOP = 96 };

/* Total steps of all fillings: some seconds. */
#define MAX_WORK ((size_t)1 << 28)

typedef STARG_ARRAY(double) double_list;

typedef struct untangler {
    repair_state *state;
    repair_index index;
    mesh_topology *topology;
    repair_stars stars;
    uint8_t *crossing; /* per face of the round */
    uint32_t *patch;   /* disjoint sets of crossing faces */
    uint8_t *inside;   /* per face: in the current region */
    uint8_t *marked;   /* per vertex: in the current region */
    uint8_t *touched;  /* per vertex: changed in this round */
    uint32_t *next;    /* per vertex: the next one on the region's border */
    fill_list region;  /* its faces */
    fill_list points;  /* its vertices */
    fill_list loop, triangles;
    double_list before, best, moved; /* positions of `points` */
    double largest_move;
    size_t *work; /* steps of all fillings so far */
    size_t base;  /* first face of the region's replacement */
    bool changed;
} untangler;

/* ---- weighing ---- */

typedef struct crossing_count {
    size_t base, face, count;
} crossing_count;

static bool count_pair(void *user, uint32_t other) {
    crossing_count *c = user;
    c->count += other < c->base || other > c->face; /* counts each pair of replacement faces once */
    return true;
}

/* Number of crossing pairs with a face of the replacement. */
static size_t count_crossings(const untangler *u) {
    crossing_count c = {.base = u->base};
    for (c.face = u->base; c.face < repair_face_count(u->state); c.face++)
        repair_index_query(&u->index, repair_face(u->state, c.face), count_pair, &c);
    return c.count;
}

/* ---- regions ---- */

static starg_status add_face_to_region(untangler *u, uint32_t face) {
    if (u->inside[face])
        return STARG_OK;
    u->inside[face] = 1;
    PUSH(u->state->context, REPAIR_STAGE, &u->region, face);
    for (int k = 0; k < 3; k++) {
        uint32_t vertex = repair_face(u->state, face)[k];
        if (u->marked[vertex])
            continue;
        u->marked[vertex] = 1;
        PUSH(u->state->context, REPAIR_STAGE, &u->points, vertex);
    }
    return STARG_OK;
}

/* Adds every face that has a vertex in the region. */
static starg_status grow_region(untangler *u) {
    size_t points = u->points.count;
    for (size_t i = 0; i < points; i++) {
        uint32_t vertex = u->points.data[i];
        for (size_t k = u->stars.start[vertex]; k < u->stars.start[vertex + 1]; k++)
            TRY(add_face_to_region(u, u->stars.list[k]));
    }
    return STARG_OK;
}

static void clear_region(untangler *u) {
    for (size_t i = 0; i < u->region.count; i++)
        u->inside[u->region.data[i]] = 0;
    for (size_t i = 0; i < u->points.count; i++)
        u->marked[u->points.data[i]] = 0;
    u->region.count = u->points.count = 0;
}

static bool region_is_free(const untangler *u) {
    for (size_t i = 0; i < u->points.count; i++)
        if (u->touched[u->points.data[i]])
            return false;
    return u->region.count <= MAX_REGION;
}

/* Replaces the region's faces by copies at the end of the mesh. */
static starg_status stand_in(untangler *u) {
    u->base = repair_face_count(u->state);
    for (size_t i = 0; i < u->region.count; i++) {
        uint8_t *flags = &u->state->flags.data[u->region.data[i]];
        const uint32_t corner[3] = {repair_face(u->state, u->region.data[i])[0],
                                    repair_face(u->state, u->region.data[i])[1],
                                    repair_face(u->state, u->region.data[i])[2]};
        uint8_t old = *flags;
        *flags |= REPAIR_GONE;
        TRY(repair_add_face(u->state, corner[0], corner[1], corner[2], old));
    }
    return STARG_OK;
}

static void remove_stand_ins(untangler *u) {
    u->state->flags.count = u->base;
    u->state->faces.count = 3 * u->base;
}

/* Undoes a change that did not help. */
static void restore(untangler *u) {
    remove_stand_ins(u);
    for (size_t i = 0; i < u->region.count; i++)
        u->state->flags.data[u->region.data[i]] &= (uint8_t)~REPAIR_GONE;
}

static void keep_change(untangler *u) {
    for (size_t i = 0; i < u->points.count; i++)
        u->touched[u->points.data[i]] = 1;
    u->changed = true;
}

/* ---- smoothing ---- */

static starg_status save_positions(untangler *u, double_list *list, size_t count) {
    list->count = 0;
    for (size_t i = 0; i < 3 * count; i++)
        PUSH(u->state->context, REPAIR_STAGE, list,
             repair_position(u->state, u->points.data[i / 3])[i % 3]);
    return STARG_OK;
}

static void load_positions(untangler *u, const double_list *list) {
    for (size_t i = 0; i < list->count; i++)
        u->state->vertices.data[3 * (size_t)u->points.data[i / 3] + i % 3] = list->data[i];
}

static bool moves_too_far(const untangler *u, uint32_t vertex, const double to[3]) {
    uint32_t origin = u->state->origin.data[vertex];
    return origin != REPAIR_NEW &&
           vec3_distance(to, u->state->input->vertices + 3 * (size_t)origin) > u->largest_move;
}

/* Midpoint of a vertex and the mean of its neighbours, within LARGEST_MOVE. */
static void smooth_vertex(const untangler *u, uint32_t vertex, double out[3]) {
    const double *p = repair_position(u->state, vertex);
    double sum[3] = {0, 0, 0};
    size_t count = 0;
    for (size_t i = u->stars.start[vertex]; i < u->stars.start[vertex + 1]; i++) {
        const uint32_t *corner = repair_face(u->state, u->stars.list[i]);
        for (int k = 0; k < 3; k++) {
            if (corner[k] == vertex)
                continue;
            vec3_along(sum, 0.5, repair_position(u->state, corner[k]), sum);
            count++;
        }
    }
    for (int k = 0; k < 3; k++)
        out[k] = 0.5 * p[k] + sum[k] / (double)count;
    if (moves_too_far(u, vertex, out))
        vec3_copy(p, out);
}

static void smooth_points(untangler *u) {
    for (size_t i = 0; 3 * i < u->moved.count; i++)
        smooth_vertex(u, u->points.data[i], u->moved.data + 3 * i);
    load_positions(u, &u->moved);
}

/* Smooths the patch's vertices step by step and keeps the step with the fewest crossings if that at
 * least halves them. The region is the patch and one ring. */
static starg_status try_smoothing(untangler *u, size_t points, bool *helped) {
    TRY(stand_in(u));
    size_t start = count_crossings(u), fewest = start;
    TRY(save_positions(u, &u->before, points));
    TRY(save_positions(u, &u->best, points));
    TRY(save_positions(u, &u->moved, points));
    for (int step = 0; step < SMOOTHING_STEPS && fewest > 0; step++) {
        smooth_points(u);
        size_t now = count_crossings(u);
        if (now >= fewest)
            continue;
        fewest = now;
        TRY(save_positions(u, &u->best, points));
    }
    *helped = 2 * fewest <= start && fewest < start;
    load_positions(u, *helped ? &u->best : &u->before);
    if (*helped)
        keep_change(u);
    else
        restore(u);
    return STARG_OK;
}

/* ---- cutting out and filling ---- */

/* Collects the border of the region as a loop; false unless the region is a disc. */
static starg_status collect_border(untangler *u, bool *is_disc) {
    size_t border = 0;
    uint32_t first = TOPOLOGY_NONE;
    bool simple = true;
    u->loop.count = 0;
    for (size_t i = 0; i < u->points.count; i++)
        u->next[u->points.data[i]] = TOPOLOGY_NONE;
    for (size_t i = 0; i < 3 * u->region.count; i++) {
        uint32_t h = 3 * u->region.data[i / 3] + (uint32_t)(i % 3);
        uint32_t twin = u->topology->twin[h];
        if (twin != TOPOLOGY_NONE && u->inside[twin / 3])
            continue;
        first = u->state->faces.data[h];
        simple = simple && u->next[first] == TOPOLOGY_NONE;
        u->next[first] = u->state->faces.data[corner_next(h)];
        border++;
    }
    size_t edges = (3 * u->region.count + border) / 2;
    *is_disc = simple && border > 0 && border <= MAX_LOOP &&
               u->points.count + u->region.count == edges + 1;
    for (uint32_t v = first; *is_disc && u->loop.count < border; v = u->next[v])
        PUSH(u->state->context, REPAIR_STAGE, &u->loop, v);
    /* several loops would close before the whole border is listed */
    for (size_t i = 1; i < u->loop.count; i++)
        *is_disc = *is_disc && u->loop.data[i] != first;
    return STARG_OK;
}

static bool edge_is_taken(const void *user, uint32_t a, uint32_t b) {
    const untangler *u = user;
    for (size_t i = u->stars.start[a]; i < u->stars.start[a + 1]; i++) {
        const uint32_t *corner = repair_face(u->state, u->stars.list[i]);
        if (!(u->state->flags.data[u->stars.list[i]] & REPAIR_GONE) &&
            (corner[0] == b || corner[1] == b || corner[2] == b))
            return true;
    }
    return false;
}

static bool all_have_area(const untangler *u) {
    for (size_t i = 0; i < u->triangles.count; i += 3)
        if (repair_has_no_area(u->state, u->triangles.data + i))
            return false;
    return true;
}

/* Replaces the region, a disc, by a filling of its border if that has fewer crossings. */
static starg_status try_filling(untangler *u, bool *helped) {
    fill_job job = {u->state, &u->index, edge_is_taken, u};
    size_t faults;
    bool possible;
    TRY(stand_in(u));
    size_t start = count_crossings(u);
    remove_stand_ins(u);
    u->triangles.count = 0;
    *u->work += u->loop.count * u->loop.count * u->loop.count;
    TRY(repair_fill(&job, u->loop.data, u->loop.count, &u->triangles, &faults, &possible));
    for (size_t i = 0; i < u->triangles.count; i += 3)
        TRY(repair_add_face(u->state, u->triangles.data[i], u->triangles.data[i + 1],
                            u->triangles.data[i + 2], REPAIR_ADDED));
    *helped = possible && all_have_area(u) && count_crossings(u) < start;
    if (*helped)
        keep_change(u);
    else
        restore(u);
    return STARG_OK;
}

/* ---- patches ---- */

static starg_status start_region(untangler *u, const uint32_t *members, size_t count) {
    clear_region(u);
    for (size_t i = 0; i < count; i++)
        TRY(add_face_to_region(u, members[i]));
    return STARG_OK;
}

static starg_status mend_patch(untangler *u, const uint32_t *members, size_t count) {
    starg_status status = STARG_OK;
    bool helped = false, is_disc;
    STARG_TRY(start_region(u, members, count));
    size_t points = u->points.count; /* those of the patch come first */
    STARG_TRY(grow_region(u));
    if (region_is_free(u))
        STARG_TRY(try_smoothing(u, points, &helped));
    STARG_TRY(start_region(u, members, count));
    for (int ring = 0; ring <= MAX_RINGS && !helped && region_is_free(u); ring++) {
        STARG_TRY(collect_border(u, &is_disc));
        if (is_disc && *u->work < MAX_WORK)
            STARG_TRY(try_filling(u, &helped));
        STARG_TRY(grow_region(u));
    }
done:
    clear_region(u);
    return status;
}

/* Two crossing faces of one component. */
static bool note_pair(void *user, uint32_t a, uint32_t b) {
    untangler *u = user;
    if (u->topology->component[a] == u->topology->component[b] &&
        faces_contact(u->state->vertices.data, repair_face(u->state, a),
                      repair_face(u->state, b)) == TRIANGLES_CROSS)
        u->crossing[a] = u->crossing[b] = 1;
    return true;
}

/* Crossing faces that share a vertex belong to one patch. */
static void join_patches(untangler *u) {
    sets_make(u->patch, u->index.tracked);
    for (size_t v = 0; v < repair_vertex_count(u->state); v++) {
        uint32_t first = TOPOLOGY_NONE;
        for (size_t i = u->stars.start[v]; i < u->stars.start[v + 1]; i++) {
            uint32_t face = u->stars.list[i];
            if (!u->crossing[face])
                continue;
            if (first == TOPOLOGY_NONE)
                first = face;
            sets_join(u->patch, first, face);
        }
    }
}

static starg_status mend_patches(untangler *u) {
    SCOPED fill_list members = {0};
    size_t faces = u->index.tracked;
    /* groups the crossing faces by patch, starting at its lowest face */
    SCOPED uint32_t *chain = NULL;
    NEW(u->state->context, REPAIR_STAGE, chain, faces);
    for (size_t f = faces; f-- > 0;)
        chain[f] = TOPOLOGY_NONE;
    for (size_t f = faces; f-- > 0;) {
        uint32_t root = sets_find(u->patch, (uint32_t)f);
        if (!u->crossing[f] || root == f)
            continue;
        chain[f] = chain[root];
        chain[root] = (uint32_t)f;
    }
    for (uint32_t f = 0; f < faces; f++) {
        if (!u->crossing[f] || sets_find(u->patch, f) != f)
            continue;
        members.count = 0;
        for (uint32_t m = f; m != TOPOLOGY_NONE; m = chain[m])
            PUSH(u->state->context, REPAIR_STAGE, &members, m);
        TRY(mend_patch(u, members.data, members.count));
        TRY(starg_check_cancel(u->state->context, REPAIR_STAGE));
    }
    return STARG_OK;
}

static void free_round(untangler *u) {
    repair_index_free(&u->index);
    topology_free(u->topology);
    repair_stars_free(&u->stars);
    RELEASE(u->crossing, u->patch, u->inside, u->marked, u->touched, u->next, u->region.data,
            u->points.data, u->loop.data, u->triangles.data, u->before.data, u->best.data,
            u->moved.data);
}

static starg_status untangle_once(repair_state *state, size_t *work, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = state->context;
    untangler u = {
        .state = state, .work = work, .largest_move = LARGEST_MOVE * repair_diagonal(state)};
    size_t faces = repair_face_count(state), vertices = repair_vertex_count(state);
    starg_mesh view = repair_view(state);
    STARG_TRY(topology_create(context, &view, &u.topology));
    STARG_TRY(repair_stars_create(state, &u.stars));
    STARG_TRY(repair_index_create(state, &u.index));
    STARG_NEW_ZERO(context, REPAIR_STAGE, u.crossing, faces);
    STARG_NEW(context, REPAIR_STAGE, u.patch, faces);
    STARG_NEW_ZERO(context, REPAIR_STAGE, u.inside, faces);
    STARG_NEW_ZERO(context, REPAIR_STAGE, u.marked, vertices);
    STARG_NEW_ZERO(context, REPAIR_STAGE, u.touched, vertices);
    STARG_NEW(context, REPAIR_STAGE, u.next, vertices);
    STARG_TRY(face_pairs_visit(context, &view, u.index.tree, NULL, note_pair, &u));
    join_patches(&u);
    STARG_TRY(mend_patches(&u));
    *changed = u.changed;
    repair_compact(state);
done:
    free_round(&u);
    return status;
}

starg_status repair_untangle(repair_state *state) {
    bool changed = true;
    size_t work = 0;
    IN_STAGE(state->context, REPAIR_STAGE);
    for (size_t round = 0; round < state->options.max_rounds && changed; round++) {
        starg_progress_step(state->context, round, state->options.max_rounds);
        TRY(untangle_once(state, &work, &changed));
    }
    return STARG_OK;
}
