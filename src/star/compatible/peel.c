/* SPDX-License-Identifier: Apache-2.0 */
/* A cut of a piece that lies in two places, by a plane in one of them.
 *
 * Problem: a triangulated sphere bounds a solid in each place, and no point sees all of it in one
 * or in both (a blind place). Cut both alike so that less is unseen, and that a place that is seen
 * from a point g stays star-shaped.
 *
 * Method: a plane cuts off a leaf, the part D of the surface and a flat wall. Planes of faces at
 * notches are tried in a blind place, since they leave no ledges, planes by which two guards miss
 * little, and random ones. In the other place the rim of the wall is any loop. There
 *   - the wall is a fan about a point h on the way from g to D, if the rim goes round some
 *     direction from g: what is left is seen from g, and D from points beyond h;
 *   - else it is a web about g (web.c);
 *   - in a blind place it is a fan about a point that sees the rim, flat or not, or one side.
 * That cut is taken after which most of both sides is seen from a point of each in blind places,
 * and, in every other round, that cuts off most; triangles of the wall count against it. Webs are
 * for leaves that are star-shaped in the plane's place.
 *
 * Invariants: those of cones.c. What rounding makes of the pieces is checked by exact signs, as of
 * all others.
 *
 * Cost: linear programs in the faces of the piece for PLANES_LEAST to MORE * PLANES planes. */
#include "star/compatible/cone_builder.h"

#include <stdlib.h>

#include "geometry/linear_program.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

static const char STAGE[] = "cones";

enum { PLANES = 64, PLANES_LEAST = 16, MORE = 4, SEARCHED = 8, CHORDS = 12 };
enum { FACES = 2000 };             /* with so many there are PLANES */
static const double ROOMY = 0.02;  /* of feet, over the extent of walls */
static const double MARGIN = 1e-3; /* of points that see a leaf, over its size */
static const double DEPTH = 0.4;   /* of the way from g to where D is not seen: there walls turn */
static const double CUT = 10;      /* any cut is better than none */

/* The wall of a cut in the place where it is not flat. */
typedef struct cut_wall {
    enum { WALL_NONE, WALL_FAN, WALL_WEB } kind;
    int end;       /* the place of the plane */
    double hub[3]; /* of a fan */
} cut_wall;

typedef struct peeling {
    cone_builder *b;
    uint32_t which, leaf;
    int end; /* the place of the plane that is looked at */
    double g[3];
    number_list faces; /* of the piece */
    number_list side;  /* those on one side of a cut */
    edge_list edges;
    cut_loops loops, rim; /* of a cut, and around the leaf */
    loop_places wall;
    loop_places image; /* of the wall's loop, in the other place */
    bvh *trees[2];     /* of the faces, in both places */
    bool blind[2];     /* places that no point sees all of */
    bool star;         /* one of them is seen from g */
    double *heights;   /* per vertex: of the cut that is looked at */
    double *own;       /* the same where all but the leaf is below */
    uint32_t *part;    /* per vertex above it: the lowest vertex that is joined with it there */
    uint8_t *flat;     /* per vertex: of a face that lies in the cut */
    double score;      /* of that cut */
    cut_wall best;     /* its wall */
    cone_web web;
} peeling;

static void peeling_free(peeling *m) {
    bvh_free(m->trees[0]);
    bvh_free(m->trees[1]);
    cones_free_loops(&m->loops);
    cones_free_loops(&m->rim);
    cones_free_web(&m->web);
    RELEASE(m->faces.data, m->edges.data, m->wall.points.data, m->image.points.data, m->side.data,
            m->heights, m->part, m->flat, m->own);
}

/* ---- leaves ---- */

/* The part above a loop, or NOWHERE. */
static uint32_t part_above(peeling *m, const cut_node *loop, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (loop[i].to != NOWHERE)
            return sets_find(m->part, m->heights[loop[i].from] > 0 ? loop[i].from : loop[i].to);
    uint32_t t = cones_across(&m->edges, loop[1].from, loop[0].from), corners[3];
    if (t == NOWHERE)
        return NOWHERE;
    cones_corners_of(m->b, t, m->which, corners);
    for (int k = 0; k < 3; k++)
        if (m->heights[corners[k]] > 0)
            return sets_find(m->part, corners[k]);
    return sets_find(m->part, corners[0]);
}

/* Faces on one side, seen from there; in the place of the plane also the wall, with `vertex` on the
 * side of the leaf, in the other place from near the loop. */
static starg_status see_side(const peeling *m, int end, uint32_t vertex, bool beyond,
                             side_view *out) {
    const loop_places *wall = end == m->end ? &m->wall : &m->image;
    double rows[6][5] = {{0}}, way[3], down[3];
    vec3_subtract(cones_place_of(m->b, end, vertex), wall->mean, way);
    bool turned = (vec3_dot(way, wall->normal) < 0) != beyond;
    for (int k = 0; k < 3; k++)
        down[k] = turned ? wall->normal[k] : -wall->normal[k];
    if (end == m->end)
        cones_put_row(down, wall->mean, rows[0]);
    for (int k = 0; k < 6 && end != m->end; k++) { /* no farther from the loop than its extent */
        double sign = k < 3 ? 1 : -1;
        rows[k][k % 3] = sign;
        rows[k][4] = sign * wall->mean[k % 3] + wall->extent;
    }
    return cones_see(m->b, end, &m->side, rows[0], end == m->end ? 1 : 6, wall->mean, wall->extent,
                     out);
}

static starg_status list_side(peeling *m, bool below) {
    return cones_list_side(m->b, &m->faces, m->own, below, &m->side);
}

/* The directions of a loop's nodes from a point. */
static void list_ways(const peeling *m, const cut_node *loop, size_t count, const double from[3],
                      double *out) {
    for (size_t i = 0; i < count; i++) {
        const double *p = cones_place_of(m->b, 1 - m->end, loop[i].from), *q = p;
        if (loop[i].to != NOWHERE)
            q = cones_place_of(m->b, 1 - m->end, loop[i].to);
        for (int k = 0; k < 3; k++)
            out[3 * i + (size_t)k] = p[k] + loop[i].share * (q[k] - p[k]) - from[k];
        double length = vec3_length(out + 3 * i);
        for (int k = 0; k < 3; k++)
            out[3 * i + (size_t)k] /= length;
    }
}

/* A direction about which a loop goes round, seen from g: then points near g in that direction see
 * both sides of a fan about one of them. */
static starg_status find_direction(const peeling *m, const double *ways, size_t count,
                                   double direction[3], bool *found) {
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    NEW(m->b->context, STAGE, rows, 5 * count);
    NEW(m->b->context, STAGE, order, count);
    const double origin[3] = {0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        double normal[3];
        vec3_cross(ways + 3 * ((i + 1) % count), ways + 3 * i, normal);
        cones_put_row(normal, origin, rows + 5 * i);
    }
    const linear_program program = {
        .dimension = 4, .rows = rows, .count = count, .objective = {0, 0, 0, 1}, .radius = 1};
    linear_program_solve(&program, order, NULL, &solution);
    *found = solution.feasible && solution.point[3] > ROOMY;
    double length = vec3_length(solution.point);
    for (int k = 0; k < 3 && *found; k++)
        direction[k] = solution.point[k] / length;
    return STARG_OK;
}

/* In a blind place: a hub that sees the loop, as in the plane, or all on one side, or from the
 * middle of two nodes the loop, so that it goes round some direction. */
static starg_status find_hub(peeling *m, const cut_node *loop, size_t count, uint32_t part,
                             double hub[3], bool *found) {
    const bvh *tree = m->trees[1 - m->end];
    SCOPED double *ways = NULL;
    double room;
    TRY(cones_place_loop(m->b, 1 - m->end, loop, count, &m->image));
    TRY(cones_find_hub(m->b, &m->image, hub, &room));
    *found = room > ROOMY && cones_is_inside(tree, &m->image, hub);
    for (int side = 0; side < 2 && !*found; side++) {
        side_view view;
        TRY(list_side(m, side == 1));
        TRY(see_side(m, 1 - m->end, part, false, &view));
        vec3_copy(view.point, hub);
        *found = view.room > MARGIN && cones_is_inside(tree, &m->image, hub);
    }
    if (*found)
        return STARG_OK;
    NEW(m->b->context, STAGE, ways, 3 * count);
    for (int i = 0; i < CHORDS && !*found; i++) {
        double direction[3];
        const double *ends[2];
        for (int j = 0; j < 2; j++)
            ends[j] = m->image.points.data + 3 * starg_rng_below(&m->b->rng, count);
        for (int k = 0; k < 3; k++)
            hub[k] = (ends[0][k] + ends[1][k]) / 2;
        if (!cones_is_inside(tree, &m->image, hub))
            continue;
        list_ways(m, loop, count, hub, ways);
        TRY(find_direction(m, ways, count, direction, found));
    }
    return STARG_OK;
}

/* Part of the way from g, in a direction, to where points no longer see all of the leaf; false if
 * they do all the way. */
static bool go_from_g(const peeling *m, const double direction[3], double out[3]) {
    int end = m->blind[0] ? 1 : 0;
    double reach = INFINITY;
    for (size_t i = 0; i < m->side.count; i += 3) {
        double normal[3], way[3];
        cones_find_normal(m->b, end, m->side.data + i, normal);
        vec3_subtract(cones_place_of(m->b, end, m->side.data[i]), m->g, way);
        if (vec3_dot(normal, direction) > 0)
            reach = fmin(reach, vec3_dot(normal, way) / vec3_dot(normal, direction));
    }
    vec3_along(m->g, DEPTH * reach, direction, out);
    return reach < INFINITY;
}

/* Which wall does a loop have where it is not flat? */
static starg_status find_wall(peeling *m, const cut_node *loop, size_t count, uint32_t part,
                              cut_wall *out) {
    SCOPED double *ways = NULL;
    double direction[3];
    bool found;
    *out = (cut_wall){.kind = WALL_FAN, .end = m->end};
    if (!m->star) {
        TRY(find_hub(m, loop, count, part, out->hub, &found));
    } else {
        NEW(m->b->context, STAGE, ways, 3 * count);
        list_ways(m, loop, count, m->g, ways);
        TRY(find_direction(m, ways, count, direction, &found));
        TRY(list_side(m, false));
        found = found && go_from_g(m, direction, out->hub);
    }
    if (found || !m->star) {
        out->kind = found ? WALL_FAN : WALL_NONE;
        return STARG_OK;
    }
    TRY(cones_find_web(m->b->context, ways, count, &m->web, &found));
    out->kind = found ? WALL_WEB : WALL_NONE;
    return STARG_OK;
}

/* The share of both sides that is seen from a point of each, in places where no point sees all;
 * the room on the side of the leaf. */
static starg_status see_sides(peeling *m, uint32_t part, double *share, double *room) {
    *share = 0;
    for (int end = 0; end < 2; end++) {
        side_view view = {.room = 0}, all = {.room = 0};
        for (int side = 0; side < 2 && m->blind[end]; side++) { /* the leaf, and the rest */
            TRY(list_side(m, side == 1));
            TRY(see_side(m, end, part, side == 1, &view));
            all.seen += view.seen;
            all.area += view.area;
            if (side == 0 && end == m->end)
                *room = view.room;
        }
        if (all.area > 0)
            *share += (all.seen + m->b->balance * fmin(view.area, all.area - view.area)) / all.area;
    }
    return STARG_OK;
}

/* Cuts with a point for each side come first, but not those whose walls have many triangles. */
static starg_status weigh_leaf(peeling *m, uint32_t part) {
    const cut_node *loop = m->rim.nodes.data;
    size_t count = m->rim.nodes.count;
    double foot[3], room, share;
    cut_wall wall;
    TRY(cones_place_loop(m->b, m->end, loop, count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, foot, &room));
    if (!(room > ROOMY) || !cones_is_inside(m->trees[m->end], &m->wall, foot))
        return STARG_OK;
    TRY(find_wall(m, loop, count, part, &wall));
    if (wall.kind == WALL_NONE)
        return STARG_OK;
    TRY(see_sides(m, part, &share, &room));
    const double triangles = (double)(wall.kind == WALL_WEB ? 3 * count : count);
    double score = CUT + share - triangles / (double)(m->faces.count / 3);
    if ((wall.kind == WALL_WEB && !(room > MARGIN)) || !(score > m->score))
        return STARG_OK;
    m->score = score;
    m->best = wall;
    for (size_t i = 0; i < m->faces.count; i++)
        m->b->heights.data[m->faces.data[i]] = m->own[m->faces.data[i]];
    return STARG_OK;
}

/* Is a part above the cut bounded by one loop? Then it is weighed; all else is below. */
static starg_status try_part(peeling *m, uint32_t part) {
    bool simple;
    cones_keep_part(&m->faces, m->heights, m->part, part, m->own);
    TRY(cones_find_loops(m->b, m->which, &m->edges, m->own, &m->rim, &simple));
    return simple && m->rim.lengths.count == 1 ? weigh_leaf(m, part) : STARG_OK;
}

static starg_status weigh_cut(peeling *m) {
    const cut_node *loop;
    bool simple;
    cones_snap(&m->faces, m->heights);
    TRY(cones_find_loops(m->b, m->which, &m->edges, m->heights, &m->loops, &simple));
    if (!simple)
        return STARG_OK;
    cones_find_parts(&m->faces, m->heights, true, m->part, m->flat);
    loop = m->loops.nodes.data;
    for (size_t i = 0; i < m->loops.lengths.count; loop += m->loops.lengths.data[i++]) {
        uint32_t part = part_above(m, loop, m->loops.lengths.data[i]);
        if (part != NOWHERE)
            TRY(try_part(m, part));
    }
    return STARG_OK;
}

/* Fewer planes where each costs more. */
static int planes_for(size_t faces) {
    return faces < FACES                           ? PLANES
           : faces > FACES * PLANES / PLANES_LEAST ? PLANES_LEAST
                                                   : (int)(FACES * PLANES / faces);
}

static starg_status choose_leaf(peeling *m, bool *found) {
    cone_builder *b = m->b;
    TRY(cones_list_edges(b, m->which, &m->edges));
    NEW(b->context, STAGE, m->heights, b->about.count);
    NEW(b->context, STAGE, m->part, b->about.count);
    NEW(b->context, STAGE, m->own, b->about.count);
    NEW(b->context, STAGE, m->flat, b->about.count);
    for (int end = 0; end < 2; end++)
        TRY(bvh_create(b->context, b->places[end].data, m->faces.data, m->faces.count / 3,
                       &m->trees[end]));
    const int planes = planes_for(m->faces.count / 3);
    for (int i = 0; i < planes || (i < MORE * planes && m->best.kind == WALL_NONE); i++) {
        bool drawn = true;
        m->end = m->blind[0] && m->blind[1] ? (i / 2 + i / SEARCHED) % 2 : m->blind[1];
        if (i % 2 == 1)
            cones_draw_notch(b, m->which, m->end, &m->faces, &m->edges, m->heights, &drawn);
        else if (i % SEARCHED == 0)
            TRY(cones_search_plane(b, m->which, m->end, &m->faces, m->heights, &drawn));
        else
            cones_draw_plane(b, m->end, &m->faces, m->heights);
        if (drawn)
            TRY(weigh_cut(m));
    }
    *found = m->score > 0;
    return STARG_OK;
}

/* ---- the leaf ---- */

/* ---- walls ---- */

static starg_status add_triangle(peeling *m, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corners[3] = {b, a, c}, sides[2] = {m->leaf, m->which};
    return cones_add_triangle(m->b, corners, sides);
}

/* About a point of the plane, and the hub. */
static starg_status build_fan(peeling *m, const double foot[3]) {
    const cut_node *loop = m->rim.nodes.data;
    size_t count = m->rim.nodes.count;
    double hubs[2][3];
    uint32_t hub;
    vec3_copy(foot, hubs[m->end]);
    vec3_copy(m->best.hub, hubs[1 - m->end]);
    TRY(cones_add_vertex(m->b, (const double(*)[3])hubs, &hub));
    for (size_t i = 0; i < count; i++)
        TRY(add_triangle(m, loop[i].from, loop[(i + 1) % count].from, hub));
    return STARG_OK;
}

/* With a ring: a circle in the plane, and about g. */
static starg_status build_web(peeling *m, const double foot[3], double room, bool *done) {
    const cut_node *loop = m->rim.nodes.data;
    size_t count = m->rim.nodes.count;
    SCOPED double *ways = NULL;
    SCOPED uint32_t *corners = NULL;
    NEW(m->b->context, STAGE, ways, 3 * count);
    NEW(m->b->context, STAGE, corners, 2 * count);
    list_ways(m, loop, count, m->g, ways);
    TRY(cones_find_web(m->b->context, ways, count, &m->web, done));
    TRY(list_side(m, false));
    for (size_t i = 0; i < count && *done; i++) {
        double places[2][3], way[3];
        vec3_subtract(m->wall.points.data + 3 * i, foot, way);
        vec3_along(foot, 0.5 * room * m->wall.extent / vec3_length(way), way, places[m->end]);
        *done = go_from_g(m, m->web.ring.data + 3 * i, places[1 - m->end]);
        corners[i] = loop[i].from;
        TRY(cones_add_vertex(m->b, (const double(*)[3])places, &corners[count + i]));
    }
    for (size_t i = 0; i < m->web.triangles.count && *done; i += 3) {
        const uint32_t *t = m->web.triangles.data + i;
        TRY(add_triangle(m, corners[t[0]], corners[t[1]], corners[t[2]]));
    }
    return STARG_OK;
}

/* ---- all stages ---- */

/* One place is blind; does a point see all of the other one? */
static starg_status find_middle(peeling *m, int end) {
    const kernel_faces surface = {m->b->places[1 - end].data, m->faces.data, m->faces.count / 3};
    starg_kernel_result kernel;
    TRY(kernel_find(m->b->context, &surface, &kernel));
    vec3_copy(kernel.guard, m->g);
    m->star = kernel.verdict == STARG_KERNEL_INTERIOR;
    m->blind[end] = true;
    m->blind[1 - end] = !m->star;
    return STARG_OK;
}

static starg_status peel(peeling *m, int end, peel_verdict *out) {
    double foot[3], room;
    bool done;
    *out = PEEL_NOTHING;
    TRY(cones_list_faces(m->b, m->which, &m->faces));
    m->b->work += m->faces.count / 3;
    TRY(find_middle(m, end));
    TRY(choose_leaf(m, &done));
    if (!done)
        return STARG_OK;
    m->end = m->best.end;
    for (size_t i = 0; i < m->faces.count; i++)
        m->own[m->faces.data[i]] = m->b->heights.data[m->faces.data[i]];
    *out = PEEL_BROKEN;
    TRY(cones_part_leaf(m->b, m->which, &m->faces, &m->edges, &m->rim, &m->leaf, &done));
    if (!done)
        return STARG_OK;
    TRY(cones_place_loop(m->b, m->end, m->rim.nodes.data, m->rim.nodes.count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, foot, &room));
    TRY(m->best.kind == WALL_FAN ? build_fan(m, foot) : build_web(m, foot, room, &done));
    *out = done ? PEEL_DONE : PEEL_BROKEN;
    return STARG_OK;
}

starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out) {
    peeling m = {.b = b, .which = which};
    starg_status status = peel(&m, end, out);
    peeling_free(&m);
    return status;
}
