/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts two solids alike at their limbs.
 *
 * Problem: limbs of two solids correspond. Divide both by flat walls across them into pieces that
 * correspond, few of them, and as many as can be star-shaped in both.
 *
 * Stages: at shares of the lengths of two limbs, planes across them meet the surfaces in loops. A
 * loop about its limb is a wall if some point of its plane sees all of it from inside, and if it
 * meets no other wall; where there is one in both solids, both are cut. What is between walls are
 * the pieces. From the ends of limbs inward, walls are opened between pieces whose union has a
 * kernel in both solids. Then all is done once more with the walls that are left, and pieces that
 * are not star-shaped in both solids are divided further (limbs_part.c).
 *
 * Invariant: the walls of a solid without handles part it into a tree of pieces, and the trees are
 * the same. Cost: O(n log n) for each plane, a linear program in both solids for each wall. */
#include <stdlib.h>

#include "core/streams.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/limbs.h"
#include "visibility/kernel.h"

static const char STAGE[] = "limbs";
enum { PLANES_MOST = 32, CAPS = 14, LEANS = 5 }; /* across a limb; a cap; at a point */
static const double LEAN = 0.5;    /* tangent of the angle by which planes are inclined */
static const double CAP = 0.6;     /* heights of caps fall so */
static const double SPACING = 0.2; /* of planes, in radii at the ends of limbs */
static const double CLEAR = 0.9;   /* of a joint's radius: no plane is that near */
static const double TIP = 0.05;    /* of a limb's length: no plane is that near to its end */
static const double ROOMY = 0.02;  /* of hubs, over the extent of loops */
static const double ALIKE = 1.0;   /* of the mean length of edges: that near are mates */

/* A plane at a share of a limb's length: across it, or inclined to one of four sides. */
typedef struct cut_plane {
    double share;
    int lean; /* 0: not */
} cut_plane;

/* Where a wall may be, in both solids. */
typedef struct cut_place {
    size_t pair;
    cut_plane planes[2];
    bool open;
} cut_place;
typedef STARG_ARRAY(cut_place) cut_places;
typedef STARG_ARRAY(cut_plane) plane_list;

/* A loop that may bound a wall. */
typedef struct section {
    cut_loops loops;
    const cut_node *nodes; /* of the one that was chosen */
    size_t count;
    double hub[3];
    loop_places wall;
} section;

static void free_section(section *s) {
    cones_free_loops(&s->loops);
    RELEASE(s->wall.points.data);
}

void limbs_free_loops(starg_context *context, limb_wall *walls, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (int end = 0; end < 2; end++)
            starg_release(context, walls[i].loops[end].data);
}

void limbs_free_cuts(limb_cuts *cuts) {
    limbs_free_loops(cuts->context, cuts->walls.data, cuts->walls.count);
    for (int end = 0; end < 2; end++)
        cones_free(&cuts->sides[end]);
    RELEASE(cuts->mates.data, cuts->walls.data);
}

/* ---- the surfaces ---- */

static starg_status begin_side(starg_context *context, const starg_mesh *mesh, cone_builder *b) {
    uint32_t whole, number;
    *b = (cone_builder){.context = context,
                        .scratch = {.context = context},
                        .rng = starg_rng_make(context->seed, STREAM_TWIN_CONES, 1)};
    TRY(cones_open_piece(b, 0, &whole));
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double from[2][3];
        for (int end = 0; end < 2; end++)
            vec3_copy(mesh->vertices + 3 * v, from[end]);
        TRY(cones_add_vertex(b, (const double(*)[3])from, &number));
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t sides[2] = {whole, NOWHERE};
        TRY(cones_add_triangle(b, mesh->faces + 3 * f, sides));
    }
    return STARG_OK;
}

/* ---- planes across limbs ---- */

/* What cuts are made of. */
typedef struct limb_plan {
    const limb_tree *trees;
    const limb_pairs *pairs;
    bvh *surfaces[2];
    edge_list edges[2]; /* of the surfaces, once they are cut */
} limb_plan;

static void free_limb_plan(limb_plan *plan) {
    bvh_free(plan->surfaces[0]);
    bvh_free(plan->surfaces[1]);
    RELEASE(plan->edges[0].data, plan->edges[1].data);
}

static bool is_on_wall(const limb_cuts *cuts, int end, uint32_t vertex) {
    for (size_t i = 0; i < cuts->walls.count; i++)
        for (size_t j = 0; j < cuts->walls.data[i].loops[end].count; j++)
            if (cuts->walls.data[i].loops[end].data[j] == vertex)
                return true;
    return false;
}

static bool meets_walls(const limb_cuts *cuts, int end, const section *s) {
    for (size_t i = 0; i < s->count; i++) {
        const cut_node *node = &s->nodes[i];
        if (is_on_wall(cuts, end, node->from) &&
            (node->to == NOWHERE || is_on_wall(cuts, end, node->to)))
            return true;
    }
    return false;
}

/* Does a loop go round a point, in its plane? */
static bool goes_round(const loop_places *loop, const double point[3]) {
    double angle = 0;
    size_t count = loop->points.count / 3;
    for (size_t i = 0; i < count; i++) {
        double p[3], q[3], cross[3];
        vec3_subtract(loop->points.data + 3 * i, point, p);
        vec3_subtract(loop->points.data + 3 * ((i + 1) % count), point, q);
        vec3_cross(p, q, cross);
        angle += atan2(vec3_dot(cross, loop->normal), vec3_dot(p, q));
    }
    return fabs(angle) > 3;
}

/* The smallest loop about a point of a limb. *found: it may bound a wall. */
static starg_status find_section(limb_cuts *cuts, int end, const limb_plan *plan,
                                 const double point[3], const double direction[3], section *out,
                                 bool *found) {
    cone_builder *b = &cuts->sides[end];
    const number_list *faces = &b->corners; /* all are outward */
    double least = INFINITY, room;
    size_t first = 0, chosen = 0;
    *found = false;
    cones_find_heights(b, 0, faces, direction, point, b->heights.data);
    cones_snap(faces, b->heights.data);
    TRY(cones_find_loops(b, 0, &plan->edges[end], b->heights.data, &out->loops, found));
    for (size_t i = 0; i < out->loops.lengths.count && *found; i++) {
        size_t count = out->loops.lengths.data[i];
        TRY(cones_place_loop(b, 0, out->loops.nodes.data + first, count, &out->wall));
        if (out->wall.extent < least && goes_round(&out->wall, point)) {
            least = out->wall.extent;
            chosen = first;
            out->count = count;
        }
        first += count;
    }
    *found = *found && least < INFINITY;
    if (!*found)
        return STARG_OK;
    out->nodes = out->loops.nodes.data + chosen;
    TRY(cones_place_loop(b, 0, out->nodes, out->count, &out->wall));
    TRY(cones_find_hub(b, &out->wall, out->hub, &room));
    *found = room > ROOMY && cones_is_inside(plan->surfaces[end], &out->wall, out->hub) &&
             !meets_walls(cuts, end, out);
    return STARG_OK;
}

/* Sets of vertices that are joined by edges that a loop does not cross; *left: the one above it. */
static starg_status find_left(const limb_cuts *cuts, int end, const section *s, uint32_t *sets,
                              uint32_t *left) {
    const cone_builder *b = &cuts->sides[end];
    SCOPED STARG_ARRAY(uint64_t) crossed = {0};
    SCOPED uint8_t *on = NULL;
    NEW_ZERO(cuts->context, STAGE, on, b->about.count);
    for (size_t i = 0; i < s->count; i++) {
        const cut_node *node = &s->nodes[i];
        if (node->to == NOWHERE)
            on[node->from] = 1;
        else
            PUSH(cuts->context, STAGE, &crossed, cones_edge_name(node->from, node->to));
    }
    if (crossed.count > 0)
        qsort(crossed.data, crossed.count, sizeof *crossed.data, cones_by_edge_name);
    sets_make(sets, b->about.count);
    *left = NOWHERE;
    for (size_t i = 0; i < b->corners.count; i++) {
        uint32_t u = b->corners.data[i], v = b->corners.data[i % 3 == 2 ? i - 2 : i + 1];
        const double p = b->heights.data[u], q = b->heights.data[v];
        const uint64_t name = cones_edge_name(u, v);
        bool opposite = cones_are_opposite(p, q);
        bool crosses =
            opposite && crossed.count > 0 &&
            bsearch(&name, crossed.data, crossed.count, sizeof name, cones_by_edge_name) != NULL;
        if (!crosses && !on[u] && !on[v])
            sets_join(sets, u, v);
        if (crosses)
            *left = p > 0 ? u : v;
        else if (on[u] && q > 0)
            *left = v;
    }
    if (*left != NOWHERE)
        *left = sets_find(sets, *left);
    return STARG_OK;
}

/* Has a loop on its left the ends of limbs that follow on its own, and the other ones on its right?
 * sides[i]: is wall i on the left? */
static starg_status look_beyond(const limb_cuts *cuts, int end, const limb_tree *tree, limb_way way,
                                const section *s, uint8_t *sides, bool *good) {
    SCOPED uint32_t *sets = NULL;
    SCOPED uint8_t *beyond = NULL;
    uint32_t left = NOWHERE;
    NEW(cuts->context, STAGE, sets, cuts->sides[end].about.count);
    NEW_ZERO(cuts->context, STAGE, beyond, tree->nodes.count);
    TRY(find_left(cuts, end, s, sets, &left));
    limbs_mark_beyond(tree, way, beyond);
    for (size_t i = 0; i < tree->nodes.count && *good; i++)
        if (tree->nodes.data[i].vertex != NOWHERE)
            *good = (sets_find(sets, tree->nodes.data[i].vertex) == left) == (beyond[i] == 1);
    for (size_t i = 0; i < cuts->walls.count; i++)
        sides[i] = sets_find(sets, cuts->walls.data[i].loops[end].data[0]) == left;
    return STARG_OK;
}

static starg_status add_hub(cone_builder *b, const double hub[3], uint32_t *out) {
    double from[2][3];
    for (int end = 0; end < 2; end++)
        vec3_copy(hub, from[end]);
    return cones_add_vertex(b, (const double(*)[3])from, out);
}

/* Divides the edges that the loop crosses. */
static starg_status take_section(cone_builder *b, const section *s, number_list *loop,
                                 uint32_t *hub) {
    for (size_t i = 0; i < s->count; i++) {
        const cut_node node = s->nodes[i];
        if (node.to != NOWHERE)
            TRY(cones_split_edge(b, node.from, node.to, node.share));
        PUSH(b->context, STAGE, loop,
             node.to == NOWHERE ? node.from : (uint32_t)b->about.count - 1);
    }
    return add_hub(b, s->hub, hub);
}

static void incline(const double normal[3], int lean, double out[3]) {
    double axes[2][3];
    vec3_copy(normal, out);
    vec3_normalize(out);
    if (lean == 0)
        return;
    vec3_axes_across(out, axes);
    vec3_along(out, lean % 2 == 0 ? LEAN : -LEAN, axes[(lean - 1) / 2], out);
}

/* By a plane across a limb. sides[i]: is wall i beyond it? */
static starg_status find_clear_section(limb_cuts *cuts, limb_plan *plan, int end, limb_way way,
                                       const cut_plane *plane, section *out, uint8_t *sides,
                                       bool *found) {
    cone_builder *b = &cuts->sides[end];
    edge_list *edges = &plan->edges[end];
    double point[3], direction[3];
    if (edges->count != b->corners.count)
        TRY(cones_list_edges(b, 0, edges));
    limbs_point_at(&plan->trees[end], way, plane->share, point, direction);
    incline(direction, plane->lean, direction);
    TRY(find_section(cuts, end, plan, point, direction, out, found));
    if (*found)
        TRY(look_beyond(cuts, end, &plan->trees[end], way, out, sides, found));
    return STARG_OK;
}

static starg_status cut_at(limb_cuts *cuts, limb_plan *plan, cut_place *place) {
    const limb_pair *pair = &plan->pairs->data[place->pair];
    SCOPED_BY(free_section) section first = {.count = 0};
    SCOPED_BY(free_section) section second = {.count = 0};
    section *const sections[2] = {&first, &second};
    SCOPED uint8_t *sides = NULL;
    const size_t walls = cuts->walls.count;
    bool found = true;
    NEW(cuts->context, STAGE, sides, 2 * walls);
    for (int end = 0; end < 2 && found; end++)
        TRY(find_clear_section(cuts, plan, end, pair->ways[end], &place->planes[end], sections[end],
                               sides + walls * (size_t)end, &found));
    found = found && memcmp(sides, sides + walls, walls) == 0;
    place->open = !found;
    if (!found)
        return STARG_OK;
    PUSH(cuts->context, STAGE, &cuts->walls, ((limb_wall){.pieces = {NOWHERE, NOWHERE}}));
    limb_wall *wall = &cuts->walls.data[walls];
    for (int end = 0; end < 2; end++)
        TRY(take_section(&cuts->sides[end], sections[end], &wall->loops[end], &wall->hubs[end]));
    return STARG_OK;
}

/* Planes of walls that may be across a limb in one solid, outward. */
static starg_status list_planes(limb_cuts *cuts, limb_plan *plan, int end, limb_way way,
                                plane_list *out) {
    const limb_tree *tree = &plan->trees[end];
    const limb *own = &tree->limbs.data[way.limb];
    SCOPED uint8_t *sides = NULL;
    NEW(cuts->context, STAGE, sides, cuts->walls.count);
    const bool cap = own->radii[way.back] < 0;
    const double near = own->radii[way.back] / own->length;
    const double far = own->radii[!way.back] / own->length;
    const double from = near > 0 ? CLEAR * near : TIP, to = 1 - (far > 0 ? CLEAR * far : TIP);
    const double radius =
        fmax(tree->nodes.data[own->nodes[0]].radius, tree->nodes.data[own->nodes[1]].radius) /
        own->length;
    size_t count = cap ? CAPS : 1;
    if (to > from && radius > 0 && !cap)
        count += (size_t)fmin((to - from) / (SPACING * radius), PLANES_MOST - 1);
    for (size_t i = 0; i < count; i++) {
        double part = to > from && count > 1 ? (double)i / (double)(count - 1) : 0.5;
        double share = cap ? 1 - pow(CAP, (double)i) : from + part * (to - from);
        bool found = false;
        for (int lean = 0; lean < LEANS && !found; lean++) {
            const cut_plane plane = {share, lean};
            SCOPED_BY(free_section) section trial = {.count = 0};
            TRY(find_clear_section(cuts, plan, end, way, &plane, &trial, sides, &found));
            if (found)
                PUSH(cuts->context, STAGE, out, plane);
        }
    }
    return STARG_OK;
}

/* Cuts at as many places as either limb has, from the first to the last one. */
static starg_status cut_pair(limb_cuts *cuts, limb_plan *plan, size_t pair, cut_places *places) {
    SCOPED plane_list first = {0}, second = {0};
    plane_list *const lists[2] = {&first, &second};
    for (int end = 0; end < 2; end++)
        TRY(list_planes(cuts, plan, end, plan->pairs->data[pair].ways[end], lists[end]));
    const size_t count = first.count < second.count ? first.count : second.count;
    for (size_t i = 0; i < count; i++) {
        cut_place place = {.pair = pair};
        for (int end = 0; end < 2; end++) {
            size_t last = lists[end]->count - 1;
            place.planes[end] = lists[end]->data[count > 1 ? i * last / (count - 1) : 0];
        }
        TRY(cut_at(cuts, plan, &place));
        PUSH(cuts->context, STAGE, places, place);
    }
    return STARG_OK;
}

/* ---- mates ---- */

/* The shares of a path's length at its vertices. */
static starg_status list_shares(const cone_builder *b, const number_list *path, bool closed,
                                double **out) {
    double sum = 0;
    NEW(b->context, STAGE, *out, path->count + 1);
    for (size_t i = 0; i < path->count; i++) {
        (*out)[i] = sum;
        sum += vec3_distance(cones_place_of(b, 0, path->data[i]),
                             cones_place_of(b, 0, path->data[(i + 1) % path->count]));
        if (!closed && i + 1 == path->count)
            sum = (*out)[i];
    }
    (*out)[path->count] = sum;
    for (size_t i = 0; i <= path->count; i++)
        (*out)[i] /= sum > 0 ? sum : 1;
    return STARG_OK;
}

static starg_status make_mates(limb_cuts *cuts, uint32_t a, uint32_t b) {
    while (cuts->mates.count <= a)
        PUSH(cuts->context, STAGE, &cuts->mates, NOWHERE);
    cuts->mates.data[a] = b;
    return STARG_OK;
}

starg_status limbs_match_paths(limb_cuts *cuts, number_list paths[2], bool closed) {
    SCOPED double *first = NULL, *second = NULL;
    SCOPED number_list joined = {0}, others = {0};
    number_list *const results[2] = {&joined, &others};
    TRY(list_shares(&cuts->sides[0], &paths[0], closed, &first));
    TRY(list_shares(&cuts->sides[1], &paths[1], closed, &second));
    const double *const shares[2] = {first, second};
    const size_t edges[2] = {paths[0].count - !closed, paths[1].count - !closed};
    const double alike = ALIKE / (double)(edges[0] > edges[1] ? edges[0] : edges[1]);
    double at[2] = {0, 0};
    size_t next[2] = {1, 1};
    for (int end = 0; end < 2; end++)
        PUSH(cuts->context, STAGE, results[end], paths[end].data[0]);
    while (next[0] < edges[0] || next[1] < edges[1]) {
        double ahead[2] = {next[0] < edges[0] ? shares[0][next[0]] : 1,
                           next[1] < edges[1] ? shares[1][next[1]] : 1};
        bool both = next[0] < edges[0] && next[1] < edges[1] && fabs(ahead[0] - ahead[1]) < alike;
        int taken = next[1] == edges[1] || (next[0] < edges[0] && ahead[0] < ahead[1]) ? 0 : 1;
        for (int end = 0; end < 2; end++) {
            number_list *out = results[end];
            uint32_t vertex;
            if (both || end == taken) {
                vertex = paths[end].data[next[end]++];
            } else {
                uint32_t beyond = paths[end].data[next[end] % paths[end].count];
                double gap = ahead[end] - at[end];
                double share = gap > 0 ? (ahead[taken] - at[end]) / gap : 0.5;
                share = share > 0.05 && share < 0.95 ? share : share < 0.5 ? 0.05 : 0.95;
                TRY(cones_split_edge(&cuts->sides[end], out->data[out->count - 1], beyond, share));
                vertex = (uint32_t)cuts->sides[end].about.count - 1;
                at[end] += share * gap;
            }
            if (both || end == taken)
                at[end] = ahead[end];
            PUSH(cuts->context, STAGE, out, vertex);
        }
    }
    for (int end = 0; end < 2 && !closed; end++)
        PUSH(cuts->context, STAGE, results[end], paths[end].data[paths[end].count - 1]);
    for (size_t i = 0; i < joined.count; i++)
        TRY(make_mates(cuts, joined.data[i], others.data[i]));
    for (int end = 0; end < 2; end++) {
        const number_list former = paths[end];
        paths[end] = *results[end];
        *results[end] = former;
    }
    return STARG_OK;
}

void limbs_find_normal(const limb_cuts *cuts, const limb_wall *wall, int end, double out[3]) {
    const cone_builder *b = &cuts->sides[end];
    const number_list *loop = &wall->loops[end];
    const double *hub = cones_place_of(b, 0, wall->hubs[end]);
    out[0] = out[1] = out[2] = 0;
    for (size_t i = 0; i < loop->count; i++) {
        double p[3], q[3], cross[3];
        vec3_subtract(cones_place_of(b, 0, loop->data[i]), hub, p);
        vec3_subtract(cones_place_of(b, 0, loop->data[(i + 1) % loop->count]), hub, q);
        vec3_cross(p, q, cross);
        vec3_along(out, 1, cross, out);
    }
}

/* Turns two loops so that both begin farthest in the direction of an axis across both. */
static void turn_loops(const limb_cuts *cuts, limb_wall *wall) {
    double normals[2][3];
    for (int end = 0; end < 2; end++) {
        limbs_find_normal(cuts, wall, end, normals[end]);
        vec3_normalize(normals[end]);
    }
    size_t axis = 0;
    for (size_t k = 1; k < 3; k++)
        if (fabs(normals[0][k]) + fabs(normals[1][k]) <
            fabs(normals[0][axis]) + fabs(normals[1][axis]))
            axis = k;
    for (int end = 0; end < 2; end++) {
        number_list *loop = &wall->loops[end];
        size_t first = 0;
        for (size_t i = 1; i < loop->count; i++)
            if (cones_place_of(&cuts->sides[end], 0, loop->data[i])[axis] >
                cones_place_of(&cuts->sides[end], 0, loop->data[first])[axis])
                first = i;
        for (; first > 0; first--) {
            uint32_t kept = loop->data[0];
            memmove(loop->data, loop->data + 1, (loop->count - 1) * sizeof kept);
            loop->data[loop->count - 1] = kept;
        }
    }
}

/* ---- pieces ---- */

/* Numbers what is between loops, and the triangles of the surface by that. */
static starg_status number_parts(limb_cuts *cuts, int end, const edge_list *edges,
                                 uint32_t *labels) {
    const cone_builder *b = &cuts->sides[end];
    SCOPED STARG_ARRAY(uint64_t) rims = {0};
    for (size_t i = 0; i < cuts->walls.count; i++) {
        const number_list *loop = &cuts->walls.data[i].loops[end];
        for (size_t j = 0; j < loop->count; j++)
            PUSH(cuts->context, STAGE, &rims,
                 cones_edge_name(loop->data[j], loop->data[(j + 1) % loop->count]));
    }
    if (rims.count > 0)
        qsort(rims.data, rims.count, sizeof *rims.data, cones_by_edge_name);
    sets_make(labels, b->corners.count / 3);
    for (size_t i = 0; i < edges->count; i++) {
        uint32_t u = (uint32_t)(edges->data[i].edge >> 32), v = (uint32_t)edges->data[i].edge;
        uint64_t name = cones_edge_name(u, v);
        uint32_t beyond = cones_across(edges, u, v);
        if (beyond != NOWHERE &&
            (rims.count == 0 ||
             bsearch(&name, rims.data, rims.count, sizeof name, cones_by_edge_name) == NULL))
            sets_join(labels, edges->data[i].triangle, beyond);
    }
    for (uint32_t t = 0; t < b->corners.count / 3; t++)
        labels[t] = sets_find(labels, t);
    return STARG_OK;
}

/* The part on the left of a loop, or on the right. */
static uint32_t part_beside(const edge_list *edges, const uint32_t *labels, const number_list *loop,
                            bool right) {
    uint32_t t = right ? cones_across(edges, loop->data[0], loop->data[1])
                       : cones_across(edges, loop->data[1], loop->data[0]);
    return t != NOWHERE ? labels[t] : NOWHERE;
}

/* Numbers the pieces of both, those that correspond alike; *good: they do. labels[end]: by
 * triangle. */
static starg_status number_pieces(limb_cuts *cuts, uint32_t *const labels[2], bool *good) {
    cuts->piece_count = cuts->walls.count + 1;
    *good = true;
    for (int end = 0; end < 2 && *good; end++) {
        cone_builder *b = &cuts->sides[end];
        SCOPED edge_list edges = {0};
        SCOPED uint32_t *names = NULL;
        size_t count = b->corners.count / 3;
        TRY(cones_list_edges(b, 0, &edges));
        TRY(number_parts(cuts, end, &edges, labels[end]));
        NEW(cuts->context, STAGE, names, count);
        memset(names, 0xff, count * sizeof *names);
        uint32_t next = 0;
        for (size_t t = 0; t < count && end == 0; t++)
            if (labels[0][t] == t)
                names[t] = next++;
        for (size_t i = 0; i < cuts->walls.count && *good; i++) {
            limb_wall *wall = &cuts->walls.data[i];
            for (int side = 0; side < 2; side++) {
                uint32_t part = part_beside(&edges, labels[end], &wall->loops[end], side == 1);
                *good = *good && part != NOWHERE;
                if (!*good)
                    break;
                if (end == 0)
                    wall->pieces[side] = names[part];
                else if (names[part] == NOWHERE)
                    names[part] = wall->pieces[side];
                *good = names[part] == wall->pieces[side];
            }
            *good = *good && wall->pieces[0] != wall->pieces[1];
        }
        *good = *good && (end == 1 || next == cuts->piece_count);
        for (size_t t = 0; t < count && *good; t++) {
            labels[end][t] = names[labels[end][t]];
            *good = labels[end][t] != NOWHERE;
        }
    }
    return STARG_OK;
}

/* ---- walls that are not needed ---- */

/* The boundary of the union of two pieces. */
static starg_status list_union(const limb_cuts *cuts, int end, const uint32_t *labels,
                               uint32_t *sets, const uint32_t pieces[2], number_list *out) {
    const cone_builder *b = &cuts->sides[end];
    out->count = 0;
    for (size_t t = 0; t < b->corners.count / 3; t++) {
        uint32_t own = sets_find(sets, labels[t]);
        for (size_t k = 0; k < 3 && (own == pieces[0] || own == pieces[1]); k++)
            PUSH(cuts->context, STAGE, out, b->corners.data[3 * t + k]);
    }
    for (size_t i = 0; i < cuts->walls.count; i++) {
        const limb_wall *wall = &cuts->walls.data[i];
        const number_list *loop = &wall->loops[end];
        bool inside[2];
        for (int side = 0; side < 2; side++) {
            uint32_t own = sets_find(sets, wall->pieces[side]);
            inside[side] = own == pieces[0] || own == pieces[1];
        }
        for (size_t j = 0; j < loop->count && inside[0] != inside[1]; j++) {
            uint32_t u = loop->data[j], v = loop->data[(j + 1) % loop->count];
            PUSH(cuts->context, STAGE, out, inside[0] ? v : u);
            PUSH(cuts->context, STAGE, out, inside[0] ? u : v);
            PUSH(cuts->context, STAGE, out, wall->hubs[end]);
        }
    }
    return STARG_OK;
}

/* From the ends of limbs inward. */
static starg_status open_walls(limb_cuts *cuts, uint32_t *const labels[2], cut_places *places) {
    SCOPED uint32_t *sets = NULL;
    SCOPED number_list faces = {0};
    NEW(cuts->context, STAGE, sets, cuts->piece_count);
    sets_make(sets, cuts->piece_count);
    size_t i = cuts->walls.count;
    for (size_t p = places->count; p-- > 0;) {
        if (places->data[p].open)
            continue;
        const limb_wall *wall = &cuts->walls.data[--i];
        const uint32_t pieces[2] = {sets_find(sets, wall->pieces[0]),
                                    sets_find(sets, wall->pieces[1])};
        bool open = true;
        for (int end = 0; end < 2 && open; end++) {
            starg_kernel_result kernel;
            TRY(list_union(cuts, end, labels[end], sets, pieces, &faces));
            const kernel_faces surface = {cuts->sides[end].places[0].data, faces.data,
                                          faces.count / 3};
            TRY(kernel_find(cuts->context, &surface, &kernel));
            open = kernel.verdict == STARG_KERNEL_INTERIOR;
        }
        if (open)
            sets_join(sets, pieces[0], pieces[1]);
        places->data[p].open = open;
    }
    return STARG_OK;
}

/* ---- all stages ---- */

/* At all pairs of limbs, or once more at the places that are not open. */
static starg_status cut_at_places(starg_context *context, limb_plan *plan, cut_places *places,
                                  limb_cuts *out) {
    const bool again = places->count > 0;
    limbs_free_cuts(out);
    *out = (limb_cuts){.context = context};
    for (int end = 0; end < 2; end++)
        TRY(begin_side(context, plan->trees[end].mesh, &out->sides[end]));
    plan->edges[0].count = plan->edges[1].count = 0;
    for (size_t i = 0; i < (again ? places->count : plan->pairs->count); i++) {
        TRY(starg_check_cancel(context, STAGE));
        if (!again)
            TRY(cut_pair(out, plan, i, places));
        else if (!places->data[i].open)
            TRY(cut_at(out, plan, &places->data[i]));
    }
    return STARG_OK;
}

/* Gives the pieces their triangles. */
static starg_status part(limb_cuts *cuts, uint32_t *const labels[2]) {
    for (int end = 0; end < 2; end++) {
        cone_builder *b = &cuts->sides[end];
        b->pieces.data[0].triangles.count = 0;
        for (uint32_t number; b->pieces.count < cuts->piece_count;)
            TRY(cones_open_piece(b, 0, &number));
        for (uint32_t t = 0; t < b->corners.count / 3; t++) {
            b->sides.data[2 * (size_t)t] = labels[end][t];
            PUSH(cuts->context, STAGE, &b->pieces.data[labels[end][t]].triangles, t);
        }
    }
    return STARG_OK;
}

starg_status limbs_cut(starg_context *context, const limb_tree trees[2], const limb_pairs *pairs,
                       limb_cuts *out) {
    SCOPED_BY(free_limb_plan) limb_plan plan = {.trees = trees, .pairs = pairs};
    SCOPED cut_places places = {0};
    bool good = true;
    for (int end = 0; end < 2; end++) {
        const starg_mesh *mesh = trees[end].mesh;
        TRY(bvh_create(context, mesh->vertices, mesh->faces, mesh->face_count,
                       &plan.surfaces[end]));
    }
    for (int round = 0; round < 2 && good; round++) {
        SCOPED uint32_t *first = NULL, *second = NULL;
        TRY(cut_at_places(context, &plan, &places, out));
        NEW(context, STAGE, first, out->sides[0].corners.count / 3);
        NEW(context, STAGE, second, out->sides[1].corners.count / 3);
        uint32_t *const labels[2] = {first, second};
        TRY(number_pieces(out, labels, &good));
        if (good)
            TRY(round == 0 ? open_walls(out, labels, &places) : part(out, labels));
    }
    if (good)
        TRY(limbs_part(out, plan.surfaces));
    for (size_t i = 0; i < out->walls.count && good; i++) {
        turn_loops(out, &out->walls.data[i]);
        TRY(limbs_match_paths(out, out->walls.data[i].loops, true));
    }
    if (!good)
        out->piece_count = 0;
    return STARG_OK;
}
