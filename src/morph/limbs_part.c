/* SPDX-License-Identifier: Apache-2.0 */
/* Divides pieces of two solids further where they are not star-shaped.
 *
 * Problem: two solids lie in pieces between flat walls, and the pieces correspond. Add walls, alike
 * in both, until every piece has a kernel in both solids. The surfaces of a piece are not mapped
 * onto each other yet, so that a loop in one solid does not tell where it is in the other.
 *
 * Method: a wall across a piece parts the walls around it into two sets, and walls in the two
 * solids correspond if the sets are the same. In a solid where the piece is blind, planes of faces
 * at notches, random ones, and planes drawn between one wall or two and the others are weighed: for
 * each set that is kept after which most of both sides is seen from a point of each. The best set
 * is cut for which there is also a plane in the other solid; if the piece is star-shaped there,
 * both sides remain so. For the empty set there is always a wall then: a chip, what is near the
 * middle of an edge, cut off by a fan about a point on the way to the guard.
 *
 * So a piece is cut until all is star-shaped, in several runs, of which that with the fewest cuts
 * is taken; in every other one star-shaped sides count more. A piece that resists is joined with
 * one beside it, and that is divided.
 *
 * Invariant: that of limbs_cut.c, but chips are not flat. Cost: a linear program in the faces of
 * the piece for each plane. */
#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/limbs.h"
#include "visibility/kernel.h"

static const char STAGE[] = "limbs";
enum { DRAWN = 64, AIMED = 24, AIMED_MORE = 96, SEARCHED = 32 }; /* planes for a piece, for a set */
enum { WALLS_MOST = 64, PAIRED = 8, LEVELS = 8 };
enum { RUNS = 8, CUTS_MOST = 8 };  /* for a piece */
static const double ROOMY = 0.02;  /* of hubs, over the extent of loops */
static const double STEEPEST = 10; /* doublings of the noise in directions of planes */
/* What a star-shaped side counts, beside shares that are seen: in every other run. */
static const double STAR[2] = {0.1, 0.5};
static const double MARGIN = 1e-3; /* of points that see a side, over its size */

/* The best cut for a set of walls: those on the side without the first one. */
typedef struct set_cut {
    uint64_t set;
    double score;
    double *heights; /* per vertex of the piece, above 0 on that side; NULL: a chip */
} set_cut;

/* A piece in one of the solids. */
typedef struct piece_side {
    limb_cuts *cuts;
    const bvh *surface; /* of the solid */
    uint32_t which;
    int end;
    double bonus; /* of star-shaped sides */
    bool blind;
    double guard[3];             /* sees all of it if it is not blind */
    number_list walls;           /* around the piece */
    number_list faces, vertices; /* of the surface */
    number_list beside;          /* faces on one side of a cut, with walls */
    edge_list edges;
    cut_loops rim;
    loop_places wall;
    double *heights, *own; /* per vertex: of a plane, and of one part above it */
    uint32_t *part;
    uint8_t *flat;
    STARG_ARRAY(set_cut) best;
} piece_side;

static void free_side(piece_side *s) {
    for (size_t i = 0; i < s->best.count; i++)
        starg_release(s->cuts->context, s->best.data[i].heights);
    cones_free_loops(&s->rim);
    RELEASE(s->walls.data, s->faces.data, s->vertices.data, s->beside.data, s->edges.data,
            s->wall.points.data, s->heights, s->own, s->part, s->flat, s->best.data);
}

static cone_builder *builder(const piece_side *s) {
    return &s->cuts->sides[s->end];
}

static const double *at(const piece_side *s, uint32_t vertex) {
    return cones_place_of(builder(s), 0, vertex);
}

static const limb_wall *wall_at(const piece_side *s, size_t i) {
    return &s->cuts->walls.data[s->walls.data[i]];
}

/* ---- a cut ---- */

/* Adds the triangles of a wall, outward for the piece. */
static starg_status add_wall(piece_side *s, size_t i) {
    const limb_wall *wall = wall_at(s, i);
    const number_list *loop = &wall->loops[s->end];
    const bool left = wall->pieces[0] == s->which;
    for (size_t j = 0; j < loop->count; j++) {
        uint32_t u = loop->data[j], v = loop->data[(j + 1) % loop->count];
        const uint32_t corners[3] = {left ? v : u, left ? u : v, wall->hubs[s->end]};
        for (int k = 0; k < 3; k++)
            PUSH(s->cuts->context, STAGE, &s->beside, corners[k]);
    }
    return STARG_OK;
}

static uint64_t all_walls(const piece_side *s) {
    return s->walls.count > 0 ? UINT64_MAX >> (WALLS_MOST - s->walls.count) : 0;
}

static void turn(const piece_side *s, double *heights) {
    for (size_t i = 0; i < s->vertices.count; i++)
        heights[s->vertices.data[i]] *= -1;
}

/* Which walls are above? *apart: none is on both sides, or met. */
static uint64_t set_above(const piece_side *s, bool *apart) {
    uint64_t set = 0;
    *apart = true;
    for (size_t i = 0; i < s->walls.count && *apart; i++) {
        const number_list *loop = &wall_at(s, i)->loops[s->end];
        const bool above = s->own[loop->data[0]] > 0;
        for (size_t j = 0; j < loop->count && *apart; j++)
            *apart = above ? s->own[loop->data[j]] > 0 : s->own[loop->data[j]] < 0;
        set |= (uint64_t)above << i;
    }
    return set;
}

/* What is seen of both sides from a point of each, as a share. *star: of how many sides all is. */
static starg_status see_both(piece_side *s, uint64_t set, double *share, int *star) {
    double seen = 0, area = 0;
    *star = 0;
    for (int below = 0; below < 2; below++) {
        side_view view;
        double down[3], row[5];
        for (int k = 0; k < 3; k++)
            down[k] = below ? s->wall.normal[k] : -s->wall.normal[k];
        cones_put_row(down, s->wall.mean, row);
        TRY(cones_list_side(builder(s), &s->faces, s->own, below, &s->beside));
        for (size_t i = 0; i < s->walls.count; i++)
            if ((set >> i & 1) == !below)
                TRY(add_wall(s, i));
        TRY(cones_see(builder(s), 0, &s->beside, row, 1, s->wall.mean, s->wall.extent, &view));
        seen += view.seen;
        area += view.area;
        *star += view.room > MARGIN;
    }
    *share = area > 0 ? seen / area : 0;
    return STARG_OK;
}

/* Keeps the cut if it is the best for its set. */
static starg_status keep(piece_side *s, uint64_t set, double score) {
    starg_context *context = s->cuts->context;
    const size_t size = builder(s)->about.count;
    size_t i = 0;
    while (i < s->best.count && s->best.data[i].set != set)
        i++;
    if (i == s->best.count) {
        PUSH(context, STAGE, &s->best, ((set_cut){.set = set, .score = -1}));
        NEW(context, STAGE, s->best.data[i].heights, size);
    }
    if (score > s->best.data[i].score) {
        s->best.data[i].score = score;
        memcpy(s->best.data[i].heights, s->own, size * sizeof *s->own);
    }
    return STARG_OK;
}

/* Weighs one part above a plane; all else is below. */
static starg_status weigh_part(piece_side *s, uint32_t root, bool through) {
    cone_builder *b = builder(s);
    double hub[3], room, share;
    int star;
    bool good;
    cones_keep_part(&s->faces, s->heights, s->part, root, s->own);
    if (!through)
        cones_drop_flat(&s->faces, s->flat, s->own);
    uint64_t set = set_above(s, &good);
    if (set & 1) { /* the other side is the one without the first wall */
        set = all_walls(s) & ~set;
        turn(s, s->own);
    }
    if (good)
        TRY(cones_find_loops(b, s->which, &s->edges, s->own, &s->rim, &good));
    if (!good || s->rim.lengths.count != 1)
        return STARG_OK;
    TRY(cones_place_loop(b, 0, s->rim.nodes.data, s->rim.nodes.count, &s->wall));
    TRY(cones_find_hub(b, &s->wall, hub, &room));
    if (!(room > ROOMY) || !cones_is_inside(s->surface, &s->wall, hub))
        return STARG_OK;
    TRY(see_both(s, set, &share, &star));
    return s->blind || star == 2 ? keep(s, set, share + s->bonus * star) : STARG_OK;
}

/* Weighs all parts on both sides of a plane. */
static starg_status weigh_plane(piece_side *s) {
    cones_snap(&s->faces, s->heights);
    for (int side = 0; side < 2; side++) {
        cones_find_parts(&s->faces, s->heights, side == 0, s->part, s->flat);
        for (size_t i = 0; i < s->vertices.count; i++) {
            const uint32_t v = s->vertices.data[i];
            if (s->heights[v] > 0 && s->part[v] == v)
                TRY(weigh_part(s, v, side == 0));
        }
        turn(s, s->heights);
    }
    return STARG_OK;
}

/* ---- planes ---- */

/* Planes at notches, by what two points see, and random ones. */
static starg_status draw_planes(piece_side *s) {
    cone_builder *b = builder(s);
    for (int i = 0; i < DRAWN; i++) {
        bool drawn = true;
        if (i % 2 == 1)
            cones_draw_notch(b, s->which, 0, &s->faces, &s->edges, s->heights, &drawn);
        else if (i % SEARCHED == 0)
            TRY(cones_search_plane(b, s->which, 0, &s->faces, s->heights, &drawn));
        else
            cones_draw_plane(b, 0, &s->faces, s->heights);
        if (drawn)
            TRY(weigh_plane(s));
    }
    return STARG_OK;
}

/* From the middle of the other walls to that of a set's, or across one of the walls, upward; of
 * length 0 if there is none. */
static void draw_way(piece_side *s, uint64_t set, bool across, double out[3]) {
    double sums[2][3] = {{0}}, counts[2] = {0, 0};
    const size_t chosen =
        s->walls.count > 0 ? starg_rng_below(&builder(s)->rng, s->walls.count) : 0;
    for (size_t i = 0; i < s->walls.count; i++) {
        const size_t above = set >> i & 1;
        vec3_along(sums[above], 1, at(s, wall_at(s, i)->hubs[s->end]), sums[above]);
        counts[above]++;
    }
    for (int k = 0; k < 3; k++)
        out[k] =
            counts[0] > 0 && counts[1] > 0 ? sums[1][k] / counts[1] - sums[0][k] / counts[0] : 0;
    if (across && s->walls.count > 0) {
        const limb_wall *wall = wall_at(s, chosen);
        double normal[3];
        limbs_find_normal(s->cuts, wall, s->end, normal);
        const bool left = wall->pieces[0] == s->which, above = set >> chosen & 1;
        for (int k = 0; k < 3; k++) /* outward if it is above */
            out[k] = left == above ? -normal[k] : normal[k];
    }
    vec3_normalize(out);
}

/* From the lowest to the highest height of vertices. */
static void find_span(const double *heights, const uint32_t *vertices, size_t count,
                      double out[2]) {
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        out[0] = fmin(out[0], heights[vertices[i]]);
        out[1] = fmax(out[1], heights[vertices[i]]);
    }
}

/* A level that meets no wall: a random one below those of a set, or one above all others, too.
 * *found: it is one. */
static double draw_level(piece_side *s, uint64_t set, bool above, bool *found) {
    double level = 0, span[2], all[2];
    find_span(s->heights, s->vertices.data, s->vertices.count, all);
    for (size_t i = 0; i < s->walls.count; i++) {
        const number_list *loop = &wall_at(s, i)->loops[s->end];
        find_span(s->heights, loop->data, loop->count, span);
        if (set >> i & 1)
            all[1] = fmin(all[1], span[0]);
        else if (above)
            all[0] = fmax(all[0], span[1]);
    }
    *found = false;
    for (int n = 0; n < LEVELS && !*found && all[0] < all[1]; n++) {
        level = all[0] + starg_rng_unit(&builder(s)->rng) * (all[1] - all[0]);
        *found = true;
        for (size_t i = 0; i < s->walls.count && *found; i++) {
            const number_list *loop = &wall_at(s, i)->loops[s->end];
            find_span(s->heights, loop->data, loop->count, span);
            *found = level < span[0] || level > span[1];
        }
    }
    return level;
}

static const set_cut *cut_of(const piece_side *s, uint64_t set) {
    for (size_t i = 0; i < s->best.count; i++)
        if (s->best.data[i].set == set)
            return &s->best.data[i];
    return NULL;
}

/* Planes below the walls of a set, in directions about that from the other ones. */
static starg_status aim_planes(piece_side *s, uint64_t set) {
    cone_builder *b = builder(s);
    const double origin[3] = {0, 0, 0};
    const int planes = s->blind ? AIMED : AIMED_MORE;
    for (int n = 0; n < planes && (s->blind || cut_of(s, set) == NULL); n++) {
        double normal[3], noise[3];
        bool found;
        starg_rng_direction(&b->rng, noise);
        draw_way(s, set, n / 2 % 2 == 1, normal);
        double most = vec3_length(normal) > 0 ? exp2(-STEEPEST * starg_rng_unit(&b->rng)) : 1;
        vec3_along(normal, 2 * most, noise, normal);
        cones_find_heights(b, 0, &s->faces, normal, origin, s->heights);
        const double level = draw_level(s, set, n % 2 == 0, &found);
        for (size_t i = 0; i < s->vertices.count; i++)
            s->heights[s->vertices.data[i]] -= level;
        if (found)
            TRY(weigh_plane(s));
    }
    return STARG_OK;
}

/* Planes that part one wall, or two, from the other ones. */
static starg_status aim_at_few(piece_side *s) {
    const size_t count = s->walls.count;
    const uint64_t all = all_walls(s);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i; j < count && (j == i || count <= PAIRED); j++) {
            uint64_t set = (uint64_t)1 << i | (uint64_t)1 << j;
            set = i == 0 ? all & ~set : set;
            if (set > 0)
                TRY(aim_planes(s, set));
        }
    return STARG_OK;
}

/* ---- a piece ---- */

static starg_status open_side(limb_cuts *cuts, const bvh *surface, int end, uint32_t which,
                              piece_side *s) {
    starg_kernel_result kernel;
    *s = (piece_side){.cuts = cuts, .surface = surface, .which = which, .end = end};
    cone_builder *b = builder(s);
    for (uint32_t i = 0; i < cuts->walls.count; i++)
        if (cuts->walls.data[i].pieces[0] == which || cuts->walls.data[i].pieces[1] == which)
            PUSH(cuts->context, STAGE, &s->walls, i);
    TRY(cones_list_faces(b, which, &s->faces));
    TRY(cones_list_faces(b, which, &s->beside));
    for (size_t i = 0; i < s->walls.count; i++)
        TRY(add_wall(s, i));
    const kernel_faces all = {b->places[0].data, s->beside.data, s->beside.count / 3};
    TRY(kernel_find(cuts->context, &all, &kernel));
    s->blind = kernel.verdict != STARG_KERNEL_INTERIOR;
    vec3_copy(kernel.guard, s->guard);
    TRY(cones_list_edges(b, which, &s->edges));
    NEW(cuts->context, STAGE, s->heights, b->about.count);
    NEW(cuts->context, STAGE, s->own, b->about.count);
    NEW(cuts->context, STAGE, s->part, b->about.count);
    NEW_ZERO(cuts->context, STAGE, s->flat, b->about.count);
    for (size_t i = 0; i < s->faces.count; i++)
        if (s->flat[s->faces.data[i]] == 0) {
            s->flat[s->faces.data[i]] = 1;
            PUSH(cuts->context, STAGE, &s->vertices, s->faces.data[i]);
        }
    return STARG_OK;
}

static int by_score(const void *left, const void *right) {
    const set_cut *a = left, *b = right;
    if (a->score != b->score)
        return a->score < b->score ? 1 : -1;
    return (a->set > b->set) - (a->set < b->set);
}

/* One solid is blind, and whatever leaves the other one star-shaped is alike there: the best set in
 * the blind one that also has a plane in the other, or is empty, for which there is a chip. */
static starg_status choose_for_blind(piece_side *blind, piece_side *star, uint64_t *out,
                                     bool *found) {
    if (blind->best.count > 0)
        qsort(blind->best.data, blind->best.count, sizeof *blind->best.data, by_score);
    for (size_t i = 0; i < blind->best.count && !*found; i++) {
        *out = blind->best.data[i].set;
        TRY(aim_planes(star, *out));
        if (*out == 0 && cut_of(star, 0) == NULL)
            PUSH(star->cuts->context, STAGE, &star->best, ((set_cut){.set = 0}));
        *found = cut_of(star, *out) != NULL;
    }
    return STARG_OK;
}

/* Both are blind: the set with the best planes in both. */
static starg_status choose_for_both(piece_side sides[2], uint64_t *out, bool *found) {
    double most = 0;
    for (int end = 0; end < 2; end++)
        for (size_t i = 0; i < sides[end].best.count; i++)
            TRY(aim_planes(&sides[1 - end], sides[end].best.data[i].set));
    for (size_t i = 0; i < sides[0].best.count; i++) {
        const set_cut *first = &sides[0].best.data[i], *second = cut_of(&sides[1], first->set);
        if (second != NULL && first->score + second->score > most) {
            most = first->score + second->score;
            *out = first->set;
        }
    }
    *found = most > 0;
    return STARG_OK;
}

/* Which walls to part from the others; *found: planes or a chip do that in both solids. */
static starg_status choose_set(piece_side sides[2], uint64_t *out, bool *found) {
    *found = false;
    for (int end = 0; end < 2; end++)
        if (sides[end].blind) {
            TRY(draw_planes(&sides[end]));
            TRY(aim_at_few(&sides[end]));
        }
    if (sides[0].blind && sides[1].blind)
        return choose_for_both(sides, out, found);
    const int blind = sides[0].blind ? 0 : 1;
    return choose_for_blind(&sides[blind], &sides[1 - blind], out, found);
}

/* A chip: what is near the middle of an edge, cut off by a fan about a point on the way to the
 * guard. That sees the fan, and what is between sees all of the chip. */
static starg_status find_chip(piece_side *s, double hub[3]) {
    cone_builder *b = builder(s);
    double most = -1;
    uint32_t ends[2] = {0, 0}, middle = (uint32_t)b->about.count;
    for (size_t i = 0; i < s->faces.count; i += 3) {
        const uint32_t *corner = s->faces.data + i;
        for (int k = 0; k < 3; k++) {
            double normal[3], size = 0;
            uint32_t u = corner[k], v = corner[(k + 1) % 3], other[3];
            uint32_t beyond = cones_across(&s->edges, u, v);
            if (beyond == NOWHERE)
                continue;
            cones_find_normal(b, 0, corner, normal);
            size = vec3_length(normal);
            cones_corners_of(b, beyond, s->which, other);
            cones_find_normal(b, 0, other, normal);
            size = fmin(size, vec3_length(normal));
            if (size > most) {
                most = size;
                ends[0] = u;
                ends[1] = v;
            }
        }
    }
    TRY(cones_split_edge(b, ends[0], ends[1], 0.5));
    TRY(cones_list_faces(b, s->which, &s->faces));
    for (size_t i = 0; i < s->faces.count; i++)
        b->heights.data[s->faces.data[i]] = s->faces.data[i] == middle ? 1 : -1;
    for (int k = 0; k < 3; k++)
        hub[k] = 0.5 * (at(s, middle)[k] + s->guard[k]);
    return STARG_OK;
}

/* Cuts a piece in one solid; the wall's loop and hub. */
static starg_status cut_side(piece_side *s, const set_cut *cut, number_list *loop, uint32_t *hub,
                             bool *done) {
    cone_builder *b = builder(s);
    uint32_t leaf;
    double places[2][3], room;
    if (cut->heights == NULL)
        TRY(find_chip(s, places[0]));
    for (size_t i = 0; i < s->faces.count && cut->heights != NULL; i++)
        b->heights.data[s->faces.data[i]] = cut->heights[s->faces.data[i]];
    TRY(cones_part_leaf(b, s->which, &s->faces, &s->edges, &s->rim, &leaf, done));
    if (!*done)
        return STARG_OK;
    TRY(cones_place_loop(b, 0, s->rim.nodes.data, s->rim.nodes.count, &s->wall));
    if (cut->heights != NULL)
        TRY(cones_find_hub(b, &s->wall, places[0], &room));
    vec3_copy(places[0], places[1]);
    TRY(cones_add_vertex(b, (const double(*)[3])places, hub));
    for (size_t i = 0; i < s->rim.nodes.count; i++)
        PUSH(b->context, STAGE, loop, s->rim.nodes.data[i].from);
    return STARG_OK;
}

/* *found: a wall was added. *good: the cut is one loop in both solids. */
static starg_status cut_piece(limb_cuts *cuts, piece_side sides[2], bool *found, bool *good) {
    uint64_t set = 0;
    *good = true;
    TRY(choose_set(sides, &set, found));
    if (!*found)
        return STARG_OK;
    const uint32_t which = sides[0].which, leaf = (uint32_t)cuts->piece_count++;
    for (size_t i = 0; i < sides[0].walls.count; i++)
        for (int side = 0; side < 2 && (set >> i & 1); side++) {
            uint32_t *beside = &cuts->walls.data[sides[0].walls.data[i]].pieces[side];
            *beside = *beside == which ? leaf : *beside;
        }
    PUSH(cuts->context, STAGE, &cuts->walls, ((limb_wall){.pieces = {leaf, which}}));
    limb_wall *wall = &cuts->walls.data[cuts->walls.count - 1];
    for (int end = 0; end < 2 && *good; end++)
        TRY(cut_side(&sides[end], cut_of(&sides[end], set), &wall->loops[end], &wall->hubs[end],
                     good));
    return STARG_OK;
}

static void free_sides(piece_side (*sides)[2]) {
    free_side(&(*sides)[0]);
    free_side(&(*sides)[1]);
}

/* Cuts a piece, and what becomes of it, until all is star-shaped in both solids. *cuts_left falls
 * by the cuts; *done: all is. */
static starg_status divide(limb_cuts *cuts, bvh *const surfaces[2], uint32_t which, double bonus,
                           size_t *cuts_left, bool *done) {
    const size_t former = cuts->piece_count;
    *done = true;
    for (size_t next = former - 1; next < cuts->piece_count && *done; next++) {
        bool blind = true;
        while (blind && *done) {
            SCOPED_BY(free_sides) piece_side sides[2] = {{.cuts = cuts}, {.cuts = cuts}};
            bool found = false, good;
            TRY(starg_check_cancel(cuts->context, STAGE));
            for (int end = 0; end < 2; end++)
                TRY(open_side(cuts, surfaces[end], end, next < former ? which : (uint32_t)next,
                              &sides[end]));
            sides[0].bonus = sides[1].bonus = bonus;
            blind = sides[0].blind || sides[1].blind;
            *done = !blind || (*cuts_left > 0 && sides[0].walls.count <= WALLS_MOST);
            if (blind && *done) {
                TRY(cut_piece(cuts, sides, &found, &good));
                *done = found && good;
                (*cuts_left)--;
            }
        }
    }
    return STARG_OK;
}

/* ---- what was tried, and is taken back ---- */

/* The walls and pieces there were. */
typedef struct part_state {
    starg_context *context;
    cone_state sides[2];
    STARG_ARRAY(limb_wall) walls;
    size_t piece_count;
} part_state;

static void free_state(part_state *s) {
    limbs_free_loops(s->context, s->walls.data, s->walls.count);
    cones_free_state(&s->sides[0]);
    cones_free_state(&s->sides[1]);
    RELEASE(s->walls.data);
}

static starg_status copy_wall(starg_context *context, const limb_wall *wall, limb_wall *out) {
    *out = *wall;
    for (int end = 0; end < 2; end++)
        out->loops[end] = (number_list){0};
    for (int end = 0; end < 2; end++)
        for (size_t i = 0; i < wall->loops[end].count; i++)
            PUSH(context, STAGE, &out->loops[end], wall->loops[end].data[i]);
    return STARG_OK;
}

static starg_status save(const limb_cuts *cuts, part_state *out) {
    out->piece_count = cuts->piece_count;
    for (int end = 0; end < 2; end++)
        TRY(cones_save(&cuts->sides[end], &out->sides[end]));
    for (size_t i = 0; i < cuts->walls.count; i++) {
        PUSH(cuts->context, STAGE, &out->walls, ((limb_wall){.hubs = {0, 0}}));
        TRY(copy_wall(cuts->context, &cuts->walls.data[i], &out->walls.data[i]));
    }
    return STARG_OK;
}

static starg_status restore(limb_cuts *cuts, const part_state *state) {
    cuts->piece_count = state->piece_count;
    limbs_free_loops(cuts->context, cuts->walls.data, cuts->walls.count);
    cuts->walls.count = 0;
    for (size_t i = 0; i < state->walls.count; i++) {
        PUSH(cuts->context, STAGE, &cuts->walls, ((limb_wall){.hubs = {0, 0}}));
        TRY(copy_wall(cuts->context, &state->walls.data[i], &cuts->walls.data[i]));
    }
    for (int end = 0; end < 2; end++)
        TRY(cones_restore(&cuts->sides[end], &state->sides[end]));
    return STARG_OK;
}

/* ---- all pieces ---- */

/* Divides a piece by as few cuts as are found in several runs; *done: there are such, else it is
 * left as it is. */
static starg_status divide_best(limb_cuts *cuts, bvh *const surfaces[2], uint32_t which,
                                bool *done) {
    SCOPED_BY(free_state) part_state before = {.context = cuts->context};
    starg_rng best[2];
    size_t fewest = CUTS_MOST + 1;
    int chosen = 0;
    TRY(save(cuts, &before));
    for (int run = 0; run < RUNS && fewest > 1; run++) {
        const starg_rng begun[2] = {cuts->sides[0].rng, cuts->sides[1].rng};
        size_t left = fewest - 1;
        TRY(divide(cuts, surfaces, which, STAR[run % 2], &left, done));
        if (*done) {
            fewest = fewest - 1 - left;
            memcpy(best, begun, sizeof best);
            chosen = run;
            if (fewest == 0)
                return STARG_OK;
        }
        TRY(restore(cuts, &before));
    }
    *done = fewest <= CUTS_MOST;
    for (int end = 0; end < 2 && *done; end++)
        cuts->sides[end].rng = best[end];
    return *done ? divide(cuts, surfaces, which, STAR[chosen % 2], &fewest, done) : STARG_OK;
}

static starg_status rename_piece(limb_cuts *cuts, uint32_t from, uint32_t to) {
    for (int end = 0; end < 2 && from != to; end++) {
        cone_builder *b = &cuts->sides[end];
        number_list *own = &b->pieces.data[from].triangles;
        for (size_t i = 0; i < own->count; i++) {
            b->sides.data[2 * (size_t)own->data[i]] = to;
            PUSH(cuts->context, STAGE, &b->pieces.data[to].triangles, own->data[i]);
        }
        own->count = 0;
    }
    for (size_t i = 0; i < 2 * cuts->walls.count; i++) {
        uint32_t *beside = &cuts->walls.data[i / 2].pieces[i % 2];
        *beside = *beside == from ? to : *beside;
    }
    return STARG_OK;
}

/* Opens a wall: the two pieces become the one with the lower number, and the last one takes the
 * other number. */
static starg_status open_wall(limb_cuts *cuts, size_t which, uint32_t *joined) {
    limb_wall *wall = &cuts->walls.data[which];
    const uint32_t last = (uint32_t)--cuts->piece_count;
    const uint32_t low = wall->pieces[0] < wall->pieces[1] ? wall->pieces[0] : wall->pieces[1];
    const uint32_t high = wall->pieces[0] + wall->pieces[1] - low;
    limbs_free_loops(cuts->context, wall, 1);
    cuts->walls.count--;
    memmove(wall, wall + 1, (cuts->walls.count - which) * sizeof *wall);
    TRY(rename_piece(cuts, high, low));
    TRY(rename_piece(cuts, last, high));
    for (int end = 0; end < 2; end++) {
        STARG_ARRAY_FREE(cuts->context, &cuts->sides[end].pieces.data[last].triangles);
        cuts->sides[end].pieces.count = last;
    }
    *joined = low;
    return STARG_OK;
}

/* Divides a piece together with one beside it. */
static starg_status divide_joined(limb_cuts *cuts, bvh *const surfaces[2], uint32_t which,
                                  bool *done) {
    SCOPED_BY(free_state) part_state before = {.context = cuts->context};
    TRY(save(cuts, &before));
    for (size_t i = 0; i < before.walls.count && !*done; i++) {
        uint32_t joined;
        if (before.walls.data[i].pieces[0] != which && before.walls.data[i].pieces[1] != which)
            continue;
        TRY(open_wall(cuts, i, &joined));
        TRY(divide_best(cuts, surfaces, joined, done));
        if (!*done)
            TRY(restore(cuts, &before));
    }
    return STARG_OK;
}

starg_status limbs_part(limb_cuts *cuts, bvh *const surfaces[2]) {
    cuts->resisting = 0;
    for (uint32_t which = 0; which < cuts->piece_count; which++) {
        bool done;
        TRY(divide_best(cuts, surfaces, which, &done));
        if (!done)
            TRY(divide_joined(cuts, surfaces, which, &done));
        cuts->resisting += !done;
    }
    return STARG_OK;
}
