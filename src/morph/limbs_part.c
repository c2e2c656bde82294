/* SPDX-License-Identifier: Apache-2.0 */
/* Divides pieces of two solids further where they are not star-shaped.
 *
 * Problem: two solids lie in pieces between flat walls, and the pieces correspond. Add walls, alike
 * in both, until every piece has a kernel in both solids. The surfaces of a piece are not mapped
 * onto each other yet, so that a loop in one solid does not tell where it is in the other.
 *
 * Method: a wall across a piece parts the walls around it into two sets, and walls in the two
 * solids correspond if the sets are the same. In a solid where the piece is blind the best plane is
 * sought for each of many sets (limbs_planes.c). The best set is cut for which there is also a wall
 * in the other solid; if the piece is star-shaped there, a plane or a fan (limbs_fans.c) after
 * which both sides remain so. There always is a fan for the empty set and for single walls, so that
 * whatever parts limbs of the blind solid one by one can be followed.
 *
 * So a piece is cut until all is star-shaped or resists, in several runs, of which that is taken
 * which leaves the least, with the fewest cuts; they differ in what star-shaped sides count, and in
 * whether the other solid's piece must remain star-shaped. What resists is divided anew if it is
 * no more than half, else joined with a piece beside it, and that is divided.
 *
 * Invariant: that of limbs_cut.c, but fans are not flat. */
#include <stdlib.h>

#include "geometry/vec3.h"
#include "morph/limbs.h"

static const char STAGE[] = "limbs";
enum { PROPOSED = 16 };              /* sets by which a star-shaped piece can be parted */
enum { RUNS = 8, CUTS_MOST = 250 };  /* for a piece; in a run */
enum { TRIED = 96 };                 /* cuts after which there is no further run */
enum { IDLE = 8 };                   /* cuts after which a piece is no smaller: it resists */
static const double REST_MOST = 0.5; /* of a piece's faces may resist, and are divided anew */
/* What two star-shaped sides count, beside shares that are seen: in every other run. */
static const double STAR[2] = {0.1, 0.5};

/* ---- a piece ---- */

static int by_score(const void *left, const void *right) {
    const set_cut *a = left, *b = right;
    if (a->score != b->score)
        return a->score < b->score ? 1 : -1;
    return (a->set > b->set) - (a->set < b->set);
}

/* One solid is blind, and whatever leaves the other one star-shaped is alike there: the best set in
 * the blind one that also has a plane or a fan in the other, or is empty, for which there is a
 * chip. Planes for some sets that have a fan are drawn, too. */
static starg_status choose_for_blind(limb_side *blind, limb_side *star, uint64_t *out,
                                     bool *found) {
    for (int n = 0; n < PROPOSED && star->walls.count > 2; n++) {
        const uint64_t all = limb_side_all_walls(star);
        uint64_t inside = limb_side_draw_near(star);
        inside = inside & 1 ? all & ~inside : inside;
        if (inside != 0 && limb_side_cut_of(star, inside) == NULL &&
            limb_side_cut_of(blind, inside) == NULL) {
            TRY(limb_side_aim_fans(star, inside));
            if (limb_side_cut_of(star, inside) != NULL)
                TRY(limb_side_aim_planes(blind, inside));
        }
    }
    if (blind->best.count > 0)
        qsort(blind->best.data, blind->best.count, sizeof *blind->best.data, by_score);
    for (size_t i = 0; i < blind->best.count && !*found; i++) {
        *out = blind->best.data[i].set;
        TRY(limb_side_aim_planes(star, *out));
        TRY(limb_side_aim_fans(star, *out));
        if (*out == 0 && limb_side_cut_of(star, 0) == NULL)
            PUSH(star->cuts->context, STAGE, &star->best, ((set_cut){.set = 0}));
        *found = limb_side_cut_of(star, *out) != NULL;
    }
    return STARG_OK;
}

/* Both are blind: the set with the best planes in both. */
static starg_status choose_for_both(limb_side sides[2], uint64_t *out, bool *found) {
    double most = 0;
    for (int end = 0; end < 2; end++)
        for (size_t i = 0; i < sides[end].best.count; i++)
            TRY(limb_side_aim_planes(&sides[1 - end], sides[end].best.data[i].set));
    for (size_t i = 0; i < sides[0].best.count; i++) {
        const set_cut *first = &sides[0].best.data[i],
                      *second = limb_side_cut_of(&sides[1], first->set);
        if (second != NULL && first->score + second->score > most) {
            most = first->score + second->score;
            *out = first->set;
        }
    }
    *found = most > 0;
    return STARG_OK;
}

/* Which walls to part from the others; *found: that can be done in both solids. */
static starg_status choose_set(limb_side sides[2], uint64_t *out, bool *found) {
    *found = false;
    for (int end = 0; end < 2; end++)
        if (sides[end].blind) {
            TRY(limb_side_draw_planes(&sides[end]));
            TRY(limb_side_aim_at_few(&sides[end]));
        }
    if (sides[0].loose && sides[1].loose)
        TRY(choose_for_both(sides, out, found));
    if (!*found && sides[0].blind != sides[1].blind)
        TRY(choose_for_blind(&sides[sides[1].blind], &sides[!sides[1].blind], out, found));
    return STARG_OK;
}

/* Cuts a piece in one solid; the wall's loop and hub. */
static starg_status cut_side(limb_side *s, const limb_side *other, const set_cut *cut,
                             number_list *loop, uint32_t *hub, bool *done) {
    cone_builder *b = limb_side_builder(s);
    uint32_t leaf;
    double places[2][3], room;
    if (cut->heights == NULL)
        TRY(limb_side_find_chip(s, other, places[0]));
    for (size_t i = 0; i < s->faces.count && cut->heights != NULL; i++)
        b->heights.data[s->faces.data[i]] = cut->heights[s->faces.data[i]];
    TRY(cones_part_leaf(b, s->which, &s->faces, &s->edges, &s->rim, &leaf, done));
    if (!*done)
        return STARG_OK;
    TRY(cones_place_loop(b, 0, s->rim.nodes.data, s->rim.nodes.count, &s->wall));
    if (cut->fan)
        vec3_copy(cut->hub, places[0]);
    else if (cut->heights != NULL)
        TRY(cones_find_hub(b, &s->wall, places[0], &room));
    vec3_copy(places[0], places[1]);
    TRY(cones_add_vertex(b, (const double(*)[3])places, hub));
    for (size_t i = 0; i < s->rim.nodes.count; i++)
        PUSH(b->context, STAGE, loop, s->rim.nodes.data[i].from);
    return STARG_OK;
}

/* *found: a wall was added. *good: the cut is one loop in both solids. */
static starg_status cut_piece(limb_cuts *cuts, limb_side sides[2], bool *found, bool *good) {
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
    const int first = limb_side_cut_of(&sides[0], set)->heights == NULL; /* a chip comes second */
    for (int i = 0; i < 2 && *good; i++) {
        const int end = i ^ first;
        TRY(cut_side(&sides[end], &sides[1 - end], limb_side_cut_of(&sides[end], set),
                     &wall->loops[end], &wall->hubs[end], good));
    }
    return STARG_OK;
}

static void free_sides(limb_side (*sides)[2]) {
    limb_side_free(&(*sides)[0]);
    limb_side_free(&(*sides)[1]);
}

/* What has become of a piece. */
typedef struct division {
    size_t cuts;
    size_t faces;     /* there were of the piece, in solids where it was blind */
    size_t resisting; /* faces of what no further cut was found for */
} division;

/* Cuts a piece, and what becomes of it, until all is star-shaped in both solids, or resists. *good:
 * all cuts are. */
static starg_status divide(limb_cuts *cuts, bvh *const surfaces[2], uint32_t which, size_t run,
                           size_t cuts_most, division *out, bool *good) {
    const size_t former = cuts->piece_count;
    *out = (division){.cuts = 0};
    *good = true;
    for (size_t next = former - 1; next < cuts->piece_count; next++) {
        size_t least = SIZE_MAX; /* faces of what is blind */
        size_t idle = 0;         /* cuts since there were so few */
        for (bool found = true; found;) {
            SCOPED_BY(free_sides) limb_side sides[2] = {{.cuts = cuts}, {.cuts = cuts}};
            size_t faces = 0;
            TRY(starg_check_cancel(cuts->context, STAGE));
            for (int end = 0; end < 2; end++) {
                limb_side *side = &sides[end];
                TRY(limb_side_open(cuts, surfaces[end], end, next < former ? which : (uint32_t)next,
                                   side));
                side->bonus = STAR[run % 2];
                side->loose = side->blind || run / 2 % 2 == 1;
                faces += side->blind ? side->faces.count / 3 : 0;
            }
            if (out->cuts == 0)
                out->faces = faces;
            idle = faces < least ? 0 : idle + 1;
            least = faces < least ? faces : least;
            found = faces > 0 && out->cuts < cuts_most && idle <= IDLE &&
                    sides[0].walls.count <= LIMB_WALLS_MOST;
            if (found)
                TRY(cut_piece(cuts, sides, &found, good));
            if (!*good)
                return STARG_OK;
            out->cuts += found;
            out->resisting += found ? 0 : faces;
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

/* Divides a piece so that as little as possible resists, by as few cuts, in several runs. *rest:
 * the share of its faces that resists; if that were more than `rest_most` it is left as it is: 1.
 */
static starg_status divide_best(limb_cuts *cuts, bvh *const surfaces[2], uint32_t which,
                                double rest_most, double *rest) {
    SCOPED_BY(free_state) part_state before = {.context = cuts->context};
    starg_rng best[2] = {0};
    size_t fewest = CUTS_MOST + 1, chosen = 0;
    division made;
    bool good;
    *rest = 1;
    TRY(save(cuts, &before));
    for (size_t run = 0, tried = 0; run < RUNS && tried < TRIED; run++) {
        const starg_rng begun[2] = {cuts->sides[0].rng, cuts->sides[1].rng};
        TRY(divide(cuts, surfaces, which, run, *rest == 0 ? fewest - 1 : CUTS_MOST, &made, &good));
        tried += made.cuts;
        const double left = made.faces > 0 ? (double)made.resisting / (double)made.faces : 0;
        if (good && left <= rest_most && (left < *rest || (left == *rest && made.cuts < fewest))) {
            *rest = left;
            fewest = made.cuts;
            chosen = run;
            memcpy(best, begun, sizeof best);
            if ((left == 0 && fewest < 2) || tried >= TRIED || run + 1 == RUNS)
                return STARG_OK;
        }
        TRY(restore(cuts, &before));
    }
    for (int end = 0; end < 2 && *rest < 1; end++)
        cuts->sides[end].rng = best[end];
    return *rest < 1 ? divide(cuts, surfaces, which, chosen, CUTS_MOST, &made, &good) : STARG_OK;
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
    double rest;
    *done = false;
    TRY(save(cuts, &before));
    for (size_t i = 0; i < before.walls.count && !*done; i++) {
        uint32_t joined;
        if (before.walls.data[i].pieces[0] != which && before.walls.data[i].pieces[1] != which)
            continue;
        TRY(open_wall(cuts, i, &joined));
        TRY(divide_best(cuts, surfaces, joined, 0, &rest));
        *done = rest == 0;
        if (!*done)
            TRY(restore(cuts, &before));
    }
    return STARG_OK;
}

/* What is left of a piece comes again; so does, with its number, what a joined piece displaces. */
starg_status limbs_part(limb_cuts *cuts, bvh *const surfaces[2]) {
    cuts->resisting = 0;
    for (uint32_t which = 0; which < cuts->piece_count;) {
        double rest;
        bool done = false;
        TRY(divide_best(cuts, surfaces, which, REST_MOST, &rest));
        if (rest == 1)
            TRY(divide_joined(cuts, surfaces, which, &done));
        which += rest == 0 || (rest == 1 && !done);
        cuts->resisting += rest == 1 && !done;
    }
    return STARG_OK;
}
