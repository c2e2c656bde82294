/* SPDX-License-Identifier: Apache-2.0 */
/* Walls in a piece that is star-shaped: fans about a point between its guard and the surface.
 *
 * Problem: part a set of a piece's walls from the others by a wall that leaves both sides
 * star-shaped.
 *
 * Method: let a loop on the surface go about a direction as the guard sees it. A fan from a point
 * in that direction to the loop is seen by the guard from behind, and if the point is near enough
 * to the guard, it sees what the loop encloses. So every cone about the guard will do that holds
 * the walls of the set, and no others; and there is always one for a single wall, just around it,
 * since the guard sees that about its hub. Without any wall it is a chip: what is near the middle
 * of an edge.
 *
 * Cost: O(f) for each of the cones in a piece of f faces. */
#include "morph/limbs.h"

#include "geometry/vec3.h"

enum { FANS = 64, HALVINGS = 20 }; /* cones; of the way from the guard to the surface */
static const double AROUND = 0.1;  /* of the way along edges from a wall */
static const double NOISE = 10;    /* doublings of the noise in directions */
static const double SEEN = 1e-6;   /* the sine of angles with faces that are seen, at least */
static const double FLAT = 0.25;   /* height of a fan or chip, over its extent, if that will do */
static const double LARGE = 0.1;   /* of the smaller triangle at an edge, over the largest */

/* ---- cones ---- */

/* A cone about a way from the guard, with the walls of a set and no others. *found: it is one. */
static void draw_cone(limb_side *s, uint64_t inside, double way[3], bool *found) {
    cone_builder *b = limb_side_builder(s);
    double noise[3], size = 0;
    starg_rng_direction(&b->rng, noise);
    way[0] = way[1] = way[2] = 0;
    for (size_t i = 0; i < s->walls.count; i++)
        if (inside >> i & 1) {
            double to[3];
            vec3_subtract(limb_side_at(s, limb_side_wall(s, i)->hubs[s->end]), s->guard, to);
            size = fmax(size, vec3_length(to));
            vec3_normalize(to);
            vec3_along(way, 1, to, way);
        }
    vec3_normalize(way);
    vec3_along(way, 0.5 * exp2(-NOISE * starg_rng_unit(&b->rng)), noise, way);
    vec3_normalize(way);
    for (size_t i = 0; i < s->vertices.count; i++) {
        double to[3];
        vec3_subtract(limb_side_at(s, s->vertices.data[i]), s->guard, to);
        vec3_normalize(to);
        s->heights[s->vertices.data[i]] = vec3_dot(to, way);
    }
    const double level = limb_side_draw_level(s, inside, true, found);
    *found = *found && level > 0;
    for (size_t i = 0; i < s->vertices.count; i++)
        s->own[s->vertices.data[i]] = s->heights[s->vertices.data[i]] - level;
    for (int k = 0; k < 3; k++)
        way[k] *= size;
}

/* Just around a wall. */
static void draw_around(limb_side *s, size_t wall, double way[3]) {
    const number_list *loop = &limb_side_wall(s, wall)->loops[s->end];
    for (size_t i = 0; i < s->vertices.count; i++)
        s->own[s->vertices.data[i]] = -1;
    for (size_t i = 0; i < loop->count; i++)
        s->own[loop->data[i]] = AROUND;
    vec3_subtract(limb_side_at(s, limb_side_wall(s, wall)->hubs[s->end]), s->guard, way);
}

/* Does a point see faces of the surface and walls, and is the guard behind the fan? */
static bool is_hub(const limb_side *s, const double hub[3], const number_list *seen) {
    const cone_builder *b = limb_side_builder(s);
    const size_t count = s->wall.points.count / 3;
    for (size_t i = 0; i < seen->count; i += 3) {
        double normal[3], way[3];
        cones_find_normal(b, 0, seen->data + i, normal);
        vec3_subtract(limb_side_at(s, seen->data[i]), hub, way);
        if (!(vec3_dot(way, normal) > SEEN * vec3_length(normal) * vec3_length(way)))
            return false;
    }
    for (size_t i = 0; i < count; i++) {
        double p[3], q[3], back[3];
        vec3_subtract(s->wall.points.data + 3 * i, hub, p);
        vec3_subtract(s->wall.points.data + 3 * ((i + 1) % count), hub, q);
        vec3_subtract(s->guard, hub, back);
        if (!(vec3_triple(back, p, q) <
              -SEEN * vec3_length(p) * vec3_length(q) * vec3_length(back)))
            return false;
    }
    return true;
}

/* Keeps a cut by a fan about a point on a way from the guard, if that sees what is above. */
static starg_status try_fan(limb_side *s, uint64_t inside, const double way[3]) {
    cone_builder *b = limb_side_builder(s);
    const uint64_t set = inside & 1 ? limb_side_all_walls(s) & ~inside : inside;
    bool good;
    const uint64_t above = limb_side_set_above(s, &good);
    if (good && above == inside)
        TRY(cones_find_loops(b, s->which, &s->edges, s->own, &s->rim, &good));
    if (!good || above != inside || s->rim.lengths.count != 1)
        return STARG_OK;
    TRY(cones_place_loop(b, 0, s->rim.nodes.data, s->rim.nodes.count, &s->wall));
    TRY(cones_list_side(b, &s->faces, s->own, false, &s->beside));
    for (size_t i = 0; i < s->walls.count; i++)
        if (inside >> i & 1)
            TRY(limb_side_add_wall(s, i));
    double part = 1 - fmin(0.5, FLAT * s->wall.extent / vec3_length(way)); /* of the way */
    for (int n = 0; n<HALVINGS; n++, part = part> 0.75 ? 2 * part - 1 : 0.5 * part) {
        double hub[3];
        vec3_along(s->guard, part, way, hub);
        if (is_hub(s, hub, &s->beside)) {
            if (set != inside)
                limb_side_turn(s, s->own);
            return limb_side_keep(s, set, 0, hub);
        }
    }
    return STARG_OK;
}

uint64_t limb_side_draw_near(limb_side *s) {
    cone_builder *b = limb_side_builder(s);
    const size_t first = starg_rng_below(&b->rng, s->walls.count);
    uint64_t set = 0;
    double way[3], level = 1 - 2 * starg_rng_unit(&b->rng);
    vec3_subtract(limb_side_at(s, limb_side_wall(s, first)->hubs[s->end]), s->guard, way);
    vec3_normalize(way);
    for (size_t i = 0; i < s->walls.count; i++) {
        double to[3];
        vec3_subtract(limb_side_at(s, limb_side_wall(s, i)->hubs[s->end]), s->guard, to);
        vec3_normalize(to);
        set |= (uint64_t)(vec3_dot(to, way) > level) << i;
    }
    return set;
}

starg_status limb_side_aim_fans(limb_side *s, uint64_t set) {
    const uint64_t sides[2] = {set, limb_side_all_walls(s) & ~set};
    double way[3];
    for (int n = 0; n < FANS && set != 0 && limb_side_cut_of(s, set) == NULL; n++) {
        bool found;
        draw_cone(s, sides[n % 2], way, &found);
        if (found)
            TRY(try_fan(s, sides[n % 2], way));
    }
    for (int side = 0; side < 2; side++)
        for (size_t i = 0; i < s->walls.count && limb_side_cut_of(s, set) == NULL; i++)
            if (sides[side] == (uint64_t)1 << i) {
                draw_around(s, i, way);
                TRY(try_fan(s, sides[side], way));
            }
    return STARG_OK;
}

/* ---- chips ---- */

/* Distances from a point to the walls around a piece, over their mean. */
static void find_distances(const limb_side *s, const double point[3], double *out) {
    double sum = 0;
    for (size_t i = 0; i < s->walls.count; i++) {
        out[i] = vec3_distance(point, limb_side_at(s, limb_side_wall(s, i)->hubs[s->end]));
        sum += out[i];
    }
    for (size_t i = 0; i < s->walls.count; i++)
        out[i] *= sum > 0 ? (double)s->walls.count / sum : 1;
}

/* How far a chip's place is from that of the cut in the other solid, as walls are concerned. */
static double misplaced(const limb_side *s, uint32_t u, uint32_t v, const double *wanted) {
    double point[3], own[LIMB_WALLS_MOST], sum = 0;
    for (int k = 0; k < 3; k++)
        point[k] = 0.5 * (limb_side_at(s, u)[k] + limb_side_at(s, v)[k]);
    find_distances(s, point, own);
    for (size_t i = 0; i < s->walls.count; i++)
        sum += (own[i] - wanted[i]) * (own[i] - wanted[i]);
    return sum;
}

/* The edge for a chip: of those between large triangles that whose place is like that of the cut in
 * the other solid. */
static void choose_edge(const limb_side *s, const limb_side *other, uint32_t out[2]) {
    const cone_builder *b = limb_side_builder(s);
    double wanted[LIMB_WALLS_MOST], largest = 0, best = INFINITY;
    find_distances(other, other->wall.mean, wanted);
    for (int round = 0; round < 2; round++)
        for (size_t i = 0; i < s->faces.count; i++) {
            const uint32_t *corner = s->faces.data + i - i % 3;
            const uint32_t u = s->faces.data[i], v = corner[(i + 1) % 3];
            double normal[3];
            uint32_t beyond = cones_across(&s->edges, u, v), across[3];
            if (beyond == NOWHERE)
                continue;
            cones_find_normal(b, 0, corner, normal);
            double size = vec3_length(normal);
            cones_corners_of(b, beyond, s->which, across);
            cones_find_normal(b, 0, across, normal);
            size = fmin(size, vec3_length(normal));
            if (round == 0)
                largest = fmax(largest, size);
            const double off = round == 1 && size >= LARGE * largest
                                   ? misplaced(s, u, v, wanted) - size / largest * 1e-3
                                   : INFINITY;
            if (off < best) {
                best = off;
                out[0] = u;
                out[1] = v;
            }
        }
}

/* A chip: what is near the middle of an edge, cut off by a fan about a point on the way to the
 * guard. That sees the fan, and what is between sees all of the chip. */
starg_status limb_side_find_chip(limb_side *s, const limb_side *other, double hub[3]) {
    cone_builder *b = limb_side_builder(s);
    uint32_t ends[2] = {0, 0}, middle = (uint32_t)b->about.count;
    choose_edge(s, other, ends);
    TRY(cones_split_edge(b, ends[0], ends[1], 0.5));
    TRY(cones_list_faces(b, s->which, &s->faces));
    for (size_t i = 0; i < s->faces.count; i++)
        b->heights.data[s->faces.data[i]] = s->faces.data[i] == middle ? 1 : -1;
    const double *at = limb_side_at(s, middle);
    double shortest = INFINITY, way[3];
    for (size_t i = 0; i < s->faces.count; i++) {
        const uint32_t v = s->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        if (s->faces.data[i] == middle)
            shortest = fmin(shortest, vec3_distance(at, limb_side_at(s, v)));
    }
    vec3_subtract(s->guard, at, way);
    vec3_along(at, fmin(0.5, FLAT * shortest / vec3_length(way)), way, hub);
    return STARG_OK;
}
