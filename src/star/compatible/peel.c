/* SPDX-License-Identifier: Apache-2.0 */
/* A cut of a piece that lies in two places, P and Q, by a plane in P.
 *
 * Problem: a triangulated sphere bounds P in one place and Q in the other, and no point sees all of
 * P. Cut both alike so that less of P is unseen, and that Q stays star-shaped if a point g sees all
 * of it: then P alone has to be cut further.
 *
 * Method: a plane cuts a leaf off P, the part D of the surface and a flat wall W. Planes of faces
 * at notches are tried, since they leave no ledges, planes by which two guards miss little, and
 * random ones; that one is taken after which most of both sides is seen from a point of each. In Q
 *   - the wall is a fan about a point h near g, if the rim of W goes round some direction from g:
 *     points before and behind h then see one side each;
 *   - if g sees not all of Q, it is a fan about a point inside that sees the rim;
 *   - else, for leaves that are star-shaped in P, it is D drawn to g, whatever the shape of D as
 * seen from g, and the leaf is cut into layers. A point p sees all of the leaf, a foot f in W all
 * of W. The layers are divided by the cone K over the rim of W, whose apex is on the line from f
 *     through p, a little beyond p.
 *     1. Half-planes through the line and the corners of W divide D, the line itself gives a
 * vertex. Then the triangles of D, seen from p, lie in one side of K each, and so
 *     2. the layer between D and K is made of frusta: D drawn to p until it lies in K,
 *     3. the layer between K and W of prisms parallel to the line: K falls into W.
 *     In Q the two layers are D drawn to g by a quarter, and by half. Frusta and prisms are convex
 * in both places. W takes the triangles of D, and g sees all of what is left of Q.
 *
 * Invariants: those of cones.c; the rim of W stays where it is in all layers. What rounding makes
 * of the pieces is checked by exact signs, as of all others.
 *
 * Cost: PLANES linear programs in the faces of the piece; layers of n triangles with a wall of k
 * corners give 2 (n + O(k sqrt(n))) pieces, which are joined later where that is possible. */
#include "star/compatible/peel.h"

#include <stdlib.h>

#include "geometry/linear_program.h"
#include "geometry/vec3.h"

static const char STAGE[] = "cones";

enum { PLANES = 64, SEARCHED = 8, TRIES = 100, HALVINGS = 40 };
static const double ROOMY = 0.02;    /* of feet, over the extent of walls */
static const double MARGIN = 1e-3;   /* of points that see a leaf, over its size */
static const double TURN = 1e-3;     /* the sine of an angle at a notch, at least */
static const double LEVEL = 1e-9;    /* of the heights: those of vertices in a face's plane */
static const double SNAP = 1e-3;     /* of an edge: a half-plane that near an end goes through it */
static const double STRAIGHT = 1e-7; /* the sine of a corner of a wall that is none */
static const double NEAR = 0.9;      /* of the way from p to D: the cone ends there */
static const double DEPTHS[2] = {0.75, 0.5}; /* of the layers towards g */

typedef struct peeling {
    cone_builder *b;
    uint32_t which, leaf;
    int end; /* P; Q is the other one */
    double g[3];
    number_list faces; /* of the piece, later of the leaf */
    edge_list edges;
    cut_loops loops;
    loop_places wall;
    loop_places image;   /* of the wall's loop, in Q */
    bvh *trees[2];       /* of the faces, in both places */
    bool star;           /* g sees all of Q */
    double *heights;     /* per vertex: of the cut that is looked at */
    uint32_t *part;      /* per vertex above it: the lowest vertex that is joined with it there */
    uint8_t *above;      /* per vertex: above the best cut so far */
    uint8_t *flat;       /* per vertex: of a face that lies in the cut */
    double score;        /* of that cut */
    bool fan;            /* its wall may be a fan about a point near g ... */
    double toward[3];    /* ... in this direction */
    double reach;        /* so far points in that direction from g see all of Q */
    number_list corners; /* of the wall, in order */
    uint8_t *on_rim;     /* per vertex */
    uint32_t *after;     /* per vertex of the rim: the next one */
    double foot[3], center[3], axis[3]; /* f, p and the unit from f to p */
    uint32_t top;                       /* the vertex of D on the line */
} peeling;

static void peeling_free(peeling *m) {
    bvh_free(m->trees[0]);
    bvh_free(m->trees[1]);
    cones_free_loops(&m->loops);
    RELEASE(m->faces.data, m->edges.data, m->wall.points.data, m->image.points.data,
            m->corners.data, m->heights, m->part, m->flat, m->above, m->on_rim, m->after);
}

static const double *at(const peeling *m, uint32_t vertex) {
    return cones_place_of(m->b, m->end, vertex);
}

/* ---- leaves ---- */

static uint32_t root_of(uint32_t *part, uint32_t v) {
    while (part[v] != v)
        v = part[v] = part[part[v]];
    return v;
}

static void join(uint32_t *part, uint32_t u, uint32_t v) {
    uint32_t a = root_of(part, u), c = root_of(part, v);
    part[a > c ? a : c] = a > c ? c : a;
}

/* What is joined above the cut, also through faces that lie in it. */
static void find_parts(peeling *m) {
    const number_list *faces = &m->faces;
    for (size_t i = 0; i < faces->count; i++) {
        m->part[faces->data[i]] = faces->data[i];
        m->flat[faces->data[i]] = 0;
    }
    for (size_t i = 0; i < faces->count; i += 3) {
        const uint32_t *corner = faces->data + i;
        bool flat =
            m->heights[corner[0]] == 0 && m->heights[corner[1]] == 0 && m->heights[corner[2]] == 0;
        for (int k = 0; k < 3 && flat; k++) {
            m->flat[corner[k]] = 1;
            join(m->part, corner[k], corner[(k + 1) % 3]);
        }
    }
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        double p = m->heights[u], q = m->heights[v];
        if ((p > 0 && (q > 0 || m->flat[v])) || (q > 0 && m->flat[u]))
            join(m->part, u, v);
    }
}

/* The part above a loop, or NOWHERE. */
static uint32_t part_above(peeling *m, const cut_node *loop, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (loop[i].to != NOWHERE)
            return root_of(m->part, m->heights[loop[i].from] > 0 ? loop[i].from : loop[i].to);
    uint32_t t = cones_across(&m->edges, loop[1].from, loop[0].from), corners[3];
    if (t == NOWHERE)
        return NOWHERE;
    cones_corners_of(m->b, t, m->which, corners);
    for (int k = 0; k < 3; k++)
        if (m->heights[corners[k]] > 0)
            return root_of(m->part, corners[k]);
    return root_of(m->part, corners[0]);
}

/* Half-space below a plane with an outward normal, with `room` for the last variable. */
static void put_row(const double normal[3], const double point[3], double *row) {
    double size = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        row[k] = size > 0 ? normal[k] / size : 0;
    row[3] = size > 0 ? 1 : 0;
    row[4] = size > 0 ? vec3_dot(normal, point) / size : 1;
}

/* The triangles of a piece on one side of a cut; those that it crosses are on both. */
typedef enum cut_side { SIDE_LEAF, SIDE_REST, SIDE_ALL } cut_side;

static bool is_on(const peeling *m, const uint32_t corner[3], uint32_t part, cut_side side) {
    bool leaf = side == SIDE_ALL, rest = false;
    for (int k = 0; k < 3 && side != SIDE_ALL; k++) {
        double height = m->heights[corner[k]];
        bool above = height > 0 && root_of(m->part, corner[k]) == part;
        leaf = leaf || above;
        rest = rest || (height != 0 && !above);
    }
    return side == SIDE_REST ? rest : leaf;
}

/* The point with the most room below the planes of faces on a side, and on that side of the wall.
 * The room is a share of the size of the faces, the root of their area. */
static starg_status see_side(const peeling *m, uint32_t part, cut_side side, const double up[3],
                             double point[3], double *room, double area[2]) {
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    size_t count = 0;
    NEW(m->b->context, STAGE, rows, 5 * (m->faces.count / 3 + 1));
    NEW(m->b->context, STAGE, order, m->faces.count / 3 + 1);
    area[0] = area[1] = 0;
    for (size_t i = 0; i < m->faces.count; i += 3) {
        const uint32_t *corner = m->faces.data + i;
        double normal[3];
        if (!is_on(m, corner, part, side))
            continue;
        vec3_triangle_normal(at(m, corner[0]), at(m, corner[1]), at(m, corner[2]), normal);
        area[0] += 0.5 * vec3_length(normal);
        put_row(normal, at(m, corner[0]), rows + 5 * count++);
    }
    double wall[3];
    for (int k = 0; k < 3; k++)
        wall[k] = side == SIDE_REST ? up[k] : -up[k];
    put_row(wall, m->wall.mean, rows + 5 * count++);
    double size = sqrt(area[0]);
    linear_program program = {.dimension = 4,
                              .rows = rows,
                              .count = count,
                              .objective = {0, 0, 0, 1},
                              .radius = 64 * (size + m->wall.extent)};
    vec3_copy(m->wall.mean, program.center);
    linear_program_solve(&program, order, NULL, &solution);
    *room = solution.feasible && size > 0 ? solution.point[3] / size : 0;
    vec3_copy(solution.point, point);
    for (size_t i = 0; i < m->faces.count; i += 3) {
        const uint32_t *corner = m->faces.data + i;
        double normal[3], way[3];
        if (!is_on(m, corner, part, side))
            continue;
        vec3_triangle_normal(at(m, corner[0]), at(m, corner[1]), at(m, corner[2]), normal);
        vec3_subtract(at(m, corner[0]), point, way);
        area[1] += vec3_dot(way, normal) > 0 ? 0.5 * vec3_length(normal) : 0;
    }
    return STARG_OK;
}

/* The unit normal of the wall, to the side of a vertex above it. */
static void turn_up(const peeling *m, uint32_t vertex, double up[3]) {
    double way[3];
    vec3_subtract(at(m, vertex), m->wall.mean, way);
    double sign = vec3_dot(way, m->wall.normal) < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        up[k] = sign * m->wall.normal[k];
}

/* A direction about which a loop goes round, seen from g: then points near g in that direction see
 * both sides of a fan about one of them. */
static starg_status find_direction(const peeling *m, const cut_node *loop, size_t count,
                                   double direction[3], bool *found) {
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    SCOPED double *points = NULL;
    linear_solution solution;
    NEW(m->b->context, STAGE, rows, 5 * count);
    NEW(m->b->context, STAGE, order, count);
    NEW(m->b->context, STAGE, points, 3 * count);
    for (size_t i = 0; i < count; i++) {
        const double *p = cones_place_of(m->b, 1 - m->end, loop[i].from), *q = p;
        if (loop[i].to != NOWHERE)
            q = cones_place_of(m->b, 1 - m->end, loop[i].to);
        for (int k = 0; k < 3; k++)
            points[3 * i + (size_t)k] = p[k] + loop[i].share * (q[k] - p[k]) - m->g[k];
    }
    const double origin[3] = {0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        double normal[3];
        vec3_cross(points + 3 * ((i + 1) % count), points + 3 * i, normal);
        put_row(normal, origin, rows + 5 * i);
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

/* Where no point sees all of Q: is there a hub in it, as in P? */
static starg_status has_hub(peeling *m, const cut_node *loop, size_t count, bool *found) {
    double hub[3], room;
    TRY(cones_place_loop(m->b, 1 - m->end, loop, count, &m->image));
    TRY(cones_find_hub(m->b, &m->image, hub, &room));
    *found = room > ROOMY && cones_is_inside(m->trees[1 - m->end], &m->image, hub);
    return STARG_OK;
}

/* Walls that are fans come first, then cuts with a point for each side, then cuts in the middle. */
static starg_status weigh_leaf(peeling *m, const cut_node *loop, size_t count, uint32_t part) {
    double foot[3], up[3], point[3], direction[3] = {0}, room, rooms[2], areas[2][2];
    bool fan;
    TRY(cones_place_loop(m->b, m->end, loop, count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, foot, &room));
    if (!(room > ROOMY) || !cones_is_inside(m->trees[m->end], &m->wall, foot))
        return STARG_OK;
    turn_up(m, part, up);
    for (int side = SIDE_LEAF; side <= SIDE_REST; side++)
        TRY(see_side(m, part, (cut_side)side, up, point, &rooms[side], areas[side]));
    if (m->star)
        TRY(find_direction(m, loop, count, direction, &fan));
    else
        TRY(has_hub(m, loop, count, &fan));
    if (!fan && !m->star)
        return STARG_OK;
    double score = (fan ? 2 : 0) + (areas[0][1] + areas[1][1]) / (areas[0][0] + areas[1][0]);
    if ((!fan && !(rooms[SIDE_LEAF] > MARGIN)) || !(score > m->score))
        return STARG_OK;
    m->score = score;
    m->fan = fan;
    vec3_copy(direction, m->toward);
    memset(m->above, 0, m->b->about.count);
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t v = m->faces.data[i];
        m->b->heights.data[v] = m->heights[v];
        m->above[v] = m->heights[v] > 0 && root_of(m->part, v) == part;
    }
    return STARG_OK;
}

/* Leaves of a cut: parts above it with one loop only. */
static starg_status weigh_cut(peeling *m) {
    const cut_node *loop;
    bool simple;
    cones_snap(&m->faces, m->heights);
    TRY(cones_find_loops(m->b, m->which, &m->edges, m->heights, &m->loops, &simple));
    if (!simple)
        return STARG_OK;
    find_parts(m);
    loop = m->loops.nodes.data;
    for (size_t i = 0; i < m->loops.lengths.count; loop += m->loops.lengths.data[i++]) {
        uint32_t part = part_above(m, loop, m->loops.lengths.data[i]);
        const cut_node *other = m->loops.nodes.data;
        bool alone = part != NOWHERE;
        for (size_t j = 0; j < m->loops.lengths.count; other += m->loops.lengths.data[j++])
            alone = alone && (j == i || part_above(m, other, m->loops.lengths.data[j]) != part);
        if (alone)
            TRY(weigh_leaf(m, loop, m->loops.lengths.data[i], part));
    }
    return STARG_OK;
}

/* Heights over the plane of a face at a notch, an edge where the solid turns by more than half a
 * turn: such cuts leave no ledges. What looks up to the plane is above, and so are the faces in it,
 * which the loops then pass on the side of the notch. */
static void draw_notch(peeling *m, bool *found) {
    *found = false;
    for (int i = 0; i < TRIES && !*found; i++) {
        size_t f = 3 * (size_t)starg_rng_below(&m->b->rng, m->faces.count / 3), k = i % 3;
        const uint32_t *corner = m->faces.data + f;
        uint32_t beyond = cones_across(&m->edges, corner[k], corner[(k + 1) % 3]), other[3];
        double normal[3], way[3];
        vec3_triangle_normal(at(m, corner[0]), at(m, corner[1]), at(m, corner[2]), normal);
        double size = vec3_length(normal);
        if (beyond == NOWHERE || !(size > 0))
            continue;
        cones_corners_of(m->b, beyond, m->which, other);
        double rise = 0, reach = 0;
        for (int j = 0; j < 3; j++) {
            vec3_subtract(at(m, other[j]), at(m, corner[0]), way);
            rise = fmax(rise, vec3_dot(normal, way) / size);
            reach = fmax(reach, vec3_length(way));
        }
        *found = rise > TURN * reach;
        for (int j = 0; j < 3; j++)
            normal[j] /= -size;
        if (*found)
            cones_find_heights(m->b, m->end, &m->faces, normal, at(m, corner[0]), m->heights);
    }
    double most = 0;
    for (size_t i = 0; i < m->faces.count && *found; i++)
        most = fmax(most, fabs(m->heights[m->faces.data[i]]));
    for (size_t i = 0; i < m->faces.count && *found; i++)
        if (fabs(m->heights[m->faces.data[i]]) < LEVEL * most)
            m->heights[m->faces.data[i]] = 0;
}

static starg_status choose_leaf(peeling *m, bool *found) {
    cone_builder *b = m->b;
    TRY(cones_list_edges(b, m->which, &m->edges));
    NEW(b->context, STAGE, m->heights, b->about.count);
    NEW(b->context, STAGE, m->part, b->about.count);
    NEW(b->context, STAGE, m->above, b->about.count);
    NEW(b->context, STAGE, m->flat, b->about.count);
    for (int end = 0; end < 2; end++)
        TRY(bvh_create(b->context, b->places[end].data, m->faces.data, m->faces.count / 3,
                       &m->trees[end]));
    for (int i = 0; i < PLANES; i++) {
        bool drawn = true;
        if (i % 2 == 1)
            draw_notch(m, &drawn);
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

/* Divides the edges that cross the cut on the leaf's side, and gives the leaf its triangles. */
static starg_status part_leaf(peeling *m, bool *done) {
    cone_builder *b = m->b;
    double *heights = b->heights.data;
    size_t former = b->about.count;
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t v = m->faces.data[i];
        if (heights[v] > 0 && !m->above[v])
            heights[v] = -heights[v];
    }
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t u = m->faces.data[i], v = m->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        double p = heights[u], q = heights[v];
        if (u < v && p * q < 0) {
            TRY(cones_split_edge(b, u, v, p / (p - q)));
            heights = b->heights.data;
        }
    }
    for (size_t v = former; v < b->about.count; v++)
        heights[v] = 0;
    TRY(cones_list_edges(b, m->which, &m->edges));
    TRY(cones_find_loops(b, m->which, &m->edges, heights, &m->loops, done));
    *done = *done && m->loops.lengths.count == 1;
    if (!*done)
        return STARG_OK;
    TRY(cones_open_piece(b, 0, &m->leaf));
    TRY(cones_part(b, m->which, &m->edges, m->loops.nodes.data, m->loops.nodes.count, m->leaf));
    return cones_list_faces(b, m->leaf, &m->faces);
}

/* f, p, and the line through them. */
static starg_status find_line(peeling *m, bool *done) {
    double up[3], room, area[2];
    TRY(cones_place_loop(m->b, m->end, m->loops.nodes.data, m->loops.nodes.count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, m->foot, &room));
    *done = room > 0;
    uint32_t vertex = m->faces.data[0];
    for (size_t i = 0; i < m->faces.count && *done; i++)
        if (m->b->heights.data[m->faces.data[i]] > m->b->heights.data[vertex])
            vertex = m->faces.data[i];
    turn_up(m, vertex, up);
    TRY(see_side(m, 0, SIDE_ALL, up, m->center, &room, area));
    *done = *done && room > 0.5 * MARGIN;
    vec3_subtract(m->center, m->foot, m->axis);
    double length = vec3_length(m->axis);
    for (int k = 0; k < 3; k++)
        m->axis[k] /= length;
    return STARG_OK;
}

/* Weights of the point in which the line meets the plane of a triangle; the least of them, or
 * -1 behind p. */
static double meet_line(const peeling *m, const uint32_t corner[3], double weights[3]) {
    double from[3][3], volume[3], sum = 0, least = 1;
    for (int k = 0; k < 3; k++)
        vec3_subtract(at(m, corner[k]), m->center, from[k]);
    for (int k = 0; k < 3; k++) {
        double cross[3];
        vec3_cross(from[(k + 1) % 3], from[(k + 2) % 3], cross);
        volume[k] = vec3_dot(cross, m->axis);
        sum += volume[k];
    }
    if (!(sum > 0)) /* p sees the triangle: its corners go round outward */
        return -1;
    for (int k = 0; k < 3; k++) {
        weights[k] = volume[k] / sum;
        least = fmin(least, weights[k]);
    }
    return least;
}

/* The vertex of D on the line, which divides a triangle or an edge unless it stands already. */
static starg_status place_top(peeling *m) {
    cone_builder *b = m->b;
    double best = -INFINITY, weights[3] = {0}, others[3];
    uint32_t corner[3] = {0};
    for (size_t i = 0; i < m->faces.count; i += 3) {
        double least = meet_line(m, m->faces.data + i, others);
        if (!(least > best) || least == -1)
            continue;
        best = least;
        memcpy(weights, others, sizeof weights);
        memcpy(corner, m->faces.data + i, sizeof corner);
    }
    int most = weights[0] > weights[1] ? 0 : 1, least;
    most = weights[2] > weights[most] ? 2 : most;
    least = weights[0] < weights[1] ? 0 : 1;
    least = weights[2] < weights[least] ? 2 : least;
    m->top = corner[most];
    if (weights[most] > 1 - SNAP)
        return STARG_OK;
    int u = (least + 1) % 3, v = (least + 2) % 3;
    double share = weights[v] / (weights[u] + weights[v]);
    uint32_t middle = (uint32_t)b->about.count;
    TRY(cones_split_edge(b, corner[u], corner[v], share));
    m->top = middle;
    if (weights[least] > SNAP) {
        m->top = (uint32_t)b->about.count;
        TRY(cones_split_edge(b, middle, corner[least], weights[least]));
    }
    return STARG_OK;
}

/* ---- sectors ---- */

/* The corners of the wall: where its rim turns. */
static starg_status list_corners(peeling *m) {
    const cut_node *loop = m->loops.nodes.data;
    size_t count = m->loops.nodes.count;
    m->corners.count = 0;
    for (size_t i = 0; i < count; i++) {
        double u[3], v[3], cross[3];
        vec3_subtract(at(m, loop[i].from), at(m, loop[(i + count - 1) % count].from), u);
        vec3_subtract(at(m, loop[(i + 1) % count].from), at(m, loop[i].from), v);
        vec3_cross(u, v, cross);
        if (vec3_length(cross) > STRAIGHT * vec3_length(u) * vec3_length(v))
            PUSH(m->b->context, STAGE, &m->corners, loop[i].from);
    }
    return STARG_OK;
}

/* Across the line, from it to a point. */
static void find_way_out(const peeling *m, const double point[3], double out[3]) {
    vec3_subtract(point, m->foot, out);
    vec3_along(out, -vec3_dot(out, m->axis), m->axis, out);
}

/* Divides the edges of D that cross the half-plane through a corner. */
static starg_status divide_sector(peeling *m, uint32_t corner) {
    cone_builder *b = m->b;
    double out[3], normal[3];
    find_way_out(m, at(m, corner), out);
    vec3_cross(m->axis, out, normal);
    TRY(cones_list_faces(b, m->leaf, &m->faces));
    cones_find_heights(b, m->end, &m->faces, normal, m->foot, b->heights.data);
    b->heights.data[m->top] = b->heights.data[corner] = 0;
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t u = m->faces.data[i], v = m->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        double p = b->heights.data[u], q = b->heights.data[v], share = p / (p - q), way[3], x[3];
        if (u > v || !(p * q < 0) || share < SNAP || share > 1 - SNAP || m->after[u] == v ||
            m->after[v] == u)
            continue;
        for (int k = 0; k < 3; k++)
            x[k] = (1 - share) * at(m, u)[k] + share * at(m, v)[k];
        vec3_subtract(x, m->foot, way);
        if (vec3_dot(way, out) > 0)
            TRY(cones_split_edge(b, u, v, share));
    }
    return STARG_OK;
}

/* The rim as marks; vertices that are added later have none. */
static starg_status mark_rim(peeling *m) {
    const cut_node *loop = m->loops.nodes.data;
    size_t count = m->loops.nodes.count, vertices = m->b->about.count;
    RELEASE(m->on_rim, m->after);
    m->on_rim = NULL, m->after = NULL;
    NEW_ZERO(m->b->context, STAGE, m->on_rim, vertices);
    NEW(m->b->context, STAGE, m->after, vertices);
    memset(m->after, 0xff, vertices * sizeof *m->after);
    for (size_t i = 0; i < count; i++) {
        m->on_rim[loop[i].from] = 1;
        m->after[loop[i].from] = loop[(i + 1) % count].from;
    }
    return STARG_OK;
}

/* Edges across D from rim to rim get a vertex that layers can move. */
static starg_status divide_chords(peeling *m) {
    TRY(mark_rim(m));
    TRY(cones_list_faces(m->b, m->leaf, &m->faces));
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t u = m->faces.data[i], v = m->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        if (u < v && m->on_rim[u] && m->on_rim[v] && m->after[u] != v && m->after[v] != u)
            TRY(cones_split_edge(m->b, u, v, 0.5));
    }
    return STARG_OK;
}

static starg_status divide_leaf(peeling *m) {
    TRY(place_top(m));
    TRY(list_corners(m));
    for (size_t i = 0; i < m->corners.count; i++) {
        TRY(mark_rim(m));
        TRY(divide_sector(m, m->corners.data[i]));
    }
    TRY(divide_chords(m));
    TRY(mark_rim(m));
    return cones_list_faces(m->b, m->leaf, &m->faces);
}

/* How far from g points in a direction see all of Q. */
static double reach_of(const peeling *m, const double direction[3]) {
    const double *places = m->b->places[1 - m->end].data;
    double reach = INFINITY;
    for (size_t i = 0; i < m->faces.count; i += 3) {
        const double *corner[3];
        double normal[3], way[3];
        for (size_t k = 0; k < 3; k++)
            corner[k] = places + 3 * (size_t)m->faces.data[i + k];
        vec3_triangle_normal(corner[0], corner[1], corner[2], normal);
        vec3_subtract(corner[0], m->g, way);
        if (vec3_dot(normal, direction) > 0)
            reach = fmin(reach, vec3_dot(normal, way) / vec3_dot(normal, direction));
    }
    return reach;
}

/* ---- layers ---- */

/* The corner after which a vertex stands, as seen along the line: that of the sector in which it
 * lies deepest. */
static size_t sector_of(const peeling *m, uint32_t vertex) {
    double way[3], best = -INFINITY;
    size_t found = 0, count = m->corners.count;
    find_way_out(m, at(m, vertex), way);
    for (size_t i = 0; i < count; i++) {
        double out[2][3], depth = INFINITY;
        for (size_t j = 0; j < 2; j++) {
            double cross[3];
            find_way_out(m, at(m, m->corners.data[(i + j) % count]), out[j]);
            vec3_cross(out[j], way, cross);
            double turn = vec3_dot(cross, m->axis) / vec3_length(out[j]);
            depth = fmin(depth, j == 0 ? turn : -turn);
        }
        double across[3];
        vec3_cross(out[0], out[1], across);
        if (vec3_dot(across, m->axis) < 0)
            depth = -INFINITY;
        if (depth > best) {
            best = depth;
            found = i;
        }
    }
    return found;
}

/* The share of the way from p to a vertex at which the cone with this apex is met. */
static double meet_cone(const peeling *m, uint32_t vertex, const double apex[3]) {
    size_t i = sector_of(m, vertex);
    double u[3], v[3], normal[3], way[3], rise[3];
    vec3_subtract(at(m, m->corners.data[i]), apex, u);
    vec3_subtract(at(m, m->corners.data[(i + 1) % m->corners.count]), apex, v);
    vec3_cross(u, v, normal);
    vec3_subtract(apex, m->center, rise);
    vec3_subtract(at(m, vertex), m->center, way);
    return vertex == m->top ? vec3_length(rise) / vec3_length(way)
                            : vec3_dot(normal, rise) / vec3_dot(normal, way);
}

/* The apex, as far beyond p as all of the cone stays before D. */
static bool find_apex(const peeling *m, double apex[3], double *shares) {
    double rise =
        0.5 * fmin(vec3_distance(m->center, at(m, m->top)), vec3_distance(m->center, m->foot));
    for (int i = 0; i < HALVINGS; i++, rise /= 2) {
        bool fits = true;
        vec3_along(m->center, rise, m->axis, apex);
        for (size_t j = 0; j < m->faces.count && fits; j++) {
            uint32_t v = m->faces.data[j];
            if (m->on_rim[v])
                continue;
            shares[v] = meet_cone(m, v, apex);
            fits = shares[v] > 0 && shares[v] < NEAR;
        }
        if (fits)
            return true;
    }
    return false;
}

/* The vertices of both layers below D. `down` is x 2 per vertex; on the rim the vertex itself. */
static starg_status place_layers(peeling *m, const double apex[3], const double *shares,
                                 uint32_t *down) {
    size_t vertices = m->b->about.count;
    double height = vec3_distance(apex, m->foot);
    memset(down, 0xff, 2 * vertices * sizeof *down);
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t v = m->faces.data[i];
        if (down[2 * v] != NOWHERE)
            continue;
        down[2 * v] = down[2 * v + 1] = v;
        if (m->on_rim[v])
            continue;
        size_t sector = sector_of(m, v);
        double places[2][2][3], way[3], sides[2][3], across[3], over[3];
        vec3_subtract(at(m, v), m->center, way);
        vec3_along(m->center, shares[v], way, places[0][m->end]);
        /* how far up the side of the cone it is: the share of the apex */
        vec3_subtract(at(m, m->corners.data[sector]), m->foot, sides[0]);
        vec3_subtract(at(m, m->corners.data[(sector + 1) % m->corners.count]), m->foot, sides[1]);
        vec3_cross(sides[0], sides[1], across);
        vec3_subtract(places[0][m->end], m->foot, over);
        double up = vec3_dot(over, across) / vec3_dot(m->axis, across);
        up = v == m->top ? height : up;
        vec3_along(places[0][m->end], -up, m->axis, places[1][m->end]);
        const double *q = cones_place_of(m->b, 1 - m->end, v);
        double back[3];
        vec3_subtract(q, m->g, back);
        for (int layer = 0; layer < 2; layer++)
            vec3_along(m->g, DEPTHS[layer], back, places[layer][1 - m->end]);
        for (int layer = 0; layer < 2; layer++)
            TRY(cones_add_vertex(m->b, (const double(*)[3])places[layer],
                                 &down[2 * v + (size_t)layer]));
    }
    return STARG_OK;
}

static starg_status add_side(peeling *m, uint32_t a, uint32_t b, uint32_t c, uint32_t own,
                             uint32_t other) {
    const uint32_t corners[3] = {a, b, c}, sides[2] = {own, other};
    return a == b || b == c || c == a ? STARG_OK : cones_add_triangle(m->b, corners, sides);
}

/* A vertex of D on the upper side of a layer, or with `layer` + 1 on its lower side. */
static uint32_t below(const uint32_t *down, uint32_t v, int layer) {
    return layer == 0 ? v : down[2 * v + (uint32_t)layer - 1];
}

/* The piece under a triangle of D in a layer; the first one is the leaf. */
static uint32_t piece_under(const peeling *m, uint32_t first, size_t triangle, int layer) {
    size_t number = 2 * triangle + (size_t)layer;
    return number == 0 ? m->leaf : first + (uint32_t)number - 1;
}

/* Frusta and prisms under all triangles of D, one of each. */
static starg_status build_layers(peeling *m, const uint32_t *down) {
    cone_builder *b = m->b;
    SCOPED uint32_t *number = NULL; /* of D's triangles, by triangle */
    SCOPED number_list own = {0};
    uint32_t first = (uint32_t)b->pieces.count, fresh;
    TRY(cones_list_edges(b, m->leaf, &m->edges));
    own = b->pieces.data[m->leaf].triangles;
    b->pieces.data[m->leaf].triangles = (number_list){0};
    NEW(b->context, STAGE, number, b->corners.count / 3);
    for (size_t i = 0; i < own.count; i++)
        number[own.data[i]] = (uint32_t)i;
    for (size_t i = 1; i < 2 * own.count; i++)
        TRY(cones_open_piece(b, 0, &fresh));
    for (size_t i = 0; i < own.count; i++) {
        uint32_t t = own.data[i], corner[3];
        cones_corners_of(b, t, m->leaf, corner);
        for (int layer = 0; layer < 2; layer++) {
            uint32_t under = piece_under(m, first, i, layer);
            for (int k = 0; k < 3; k++) {
                uint32_t u = corner[k], v = corner[(k + 1) % 3];
                uint32_t beyond = cones_across(&m->edges, u, v);
                if (u > v || beyond == NOWHERE)
                    continue;
                uint32_t other = piece_under(m, first, number[beyond], layer);
                uint32_t u0 = below(down, u, layer), u1 = below(down, u, layer + 1);
                uint32_t v0 = below(down, v, layer), v1 = below(down, v, layer + 1);
                TRY(add_side(m, v0, u0, v1, under, other));
                TRY(add_side(m, u0, u1, v1, under, other));
            }
            TRY(add_side(m, below(down, corner[0], layer + 1), below(down, corner[1], layer + 1),
                         below(down, corner[2], layer + 1),
                         layer == 0 ? piece_under(m, first, i, 1) : m->which, under));
        }
    }
    for (size_t i = 0; i < own.count; i++) {
        uint32_t t = own.data[i], under = piece_under(m, first, i, 0);
        b->sides.data[2 * (size_t)t + (b->sides.data[2 * (size_t)t] != m->leaf)] = under;
        PUSH(b->context, STAGE, &b->pieces.data[under].triangles, t);
    }
    return STARG_OK;
}

/* ---- fans ---- */

/* A wall about a point of its plane in P, and a point near g in Q. */
static starg_status build_fan(peeling *m) {
    const cut_node *loop = m->loops.nodes.data;
    size_t count = m->loops.nodes.count;
    double hubs[2][3], room;
    uint32_t hub;
    TRY(cones_place_loop(m->b, m->end, loop, count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, hubs[m->end], &room));
    if (m->star) {
        vec3_along(m->g, 0.4 * m->reach, m->toward, hubs[1 - m->end]);
    } else {
        TRY(cones_place_loop(m->b, 1 - m->end, loop, count, &m->image));
        TRY(cones_find_hub(m->b, &m->image, hubs[1 - m->end], &room));
    }
    TRY(cones_add_vertex(m->b, (const double(*)[3])hubs, &hub));
    for (size_t i = 0; i < count; i++) {
        const uint32_t corners[3] = {loop[(i + 1) % count].from, loop[i].from, hub};
        const uint32_t sides[2] = {m->leaf, m->which};
        TRY(cones_add_triangle(m->b, corners, sides));
    }
    return STARG_OK;
}

/* ---- all stages ---- */

/* A point that sees all of Q. */
static starg_status find_middle(peeling *m) {
    const kernel_faces surface = {m->b->places[1 - m->end].data, m->faces.data, m->faces.count / 3};
    starg_kernel_result kernel;
    TRY(kernel_find(m->b->context, &surface, &kernel));
    vec3_copy(kernel.guard, m->g);
    m->star = kernel.verdict == STARG_KERNEL_INTERIOR;
    return STARG_OK;
}

static starg_status peel(peeling *m, peel_verdict *out) {
    double apex[3];
    bool done;
    SCOPED double *shares = NULL;
    SCOPED uint32_t *down = NULL;
    *out = PEEL_NOTHING;
    TRY(cones_list_faces(m->b, m->which, &m->faces));
    m->b->work += m->faces.count / 3;
    TRY(find_middle(m));
    if (!m->star)
        m->end = m->b->first_end;
    TRY(choose_leaf(m, &done));
    if (!done)
        return STARG_OK;
    m->reach = reach_of(m, m->toward);
    *out = PEEL_BROKEN;
    TRY(part_leaf(m, &done));
    if (done && m->fan) {
        *out = PEEL_DONE;
        return build_fan(m);
    }
    if (done)
        TRY(find_line(m, &done));
    if (!done)
        return STARG_OK;
    TRY(divide_leaf(m));
    NEW(m->b->context, STAGE, shares, m->b->about.count);
    NEW(m->b->context, STAGE, down, 2 * m->b->about.count);
    if (!find_apex(m, apex, shares))
        return STARG_OK;
    TRY(place_layers(m, apex, shares, down));
    *out = PEEL_DONE;
    return build_layers(m, down);
}

starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out) {
    peeling m = {.b = b, .which = which, .end = end};
    starg_status status = peel(&m, out);
    peeling_free(&m);
    return status;
}
