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
 *   - else, for leaves that are star-shaped in P, the leaf is taken off in layers (layers.c), which
 *     suit every loop.
 * So g sees all of what is left of Q.
 *
 * Invariants: those of cones.c. What rounding makes of the pieces is checked by exact signs, as of
 * all others.
 *
 * Cost: PLANES linear programs in the faces of the piece. */
#include "star/compatible/peel.h"

#include <stdlib.h>

#include "geometry/linear_program.h"
#include "geometry/vec3.h"

static const char STAGE[] = "cones";

enum { PLANES = 64, SEARCHED = 8, TRIES = 100 };
static const double ROOMY = 0.02;  /* of feet, over the extent of walls */
static const double MARGIN = 1e-3; /* of points that see a leaf, over its size */
static const double TURN = 1e-3;   /* the sine of an angle at a notch, at least */
static const double LEVEL = 1e-9;  /* of the heights: those of vertices in a face's plane */

typedef struct peeling {
    cone_builder *b;
    uint32_t which, leaf;
    int end; /* P; Q is the other one */
    double g[3];
    number_list faces; /* of the piece */
    number_list side;  /* those on one side of a cut */
    edge_list edges;
    cut_loops loops;
    loop_places wall;
    loop_places image; /* of the wall's loop, in Q */
    bvh *trees[2];     /* of the faces, in both places */
    bool star;         /* g sees all of Q */
    double *heights;   /* per vertex: of the cut that is looked at */
    uint32_t *part;    /* per vertex above it: the lowest vertex that is joined with it there */
    uint8_t *above;    /* per vertex: above the best cut so far */
    uint8_t *flat;     /* per vertex: of a face that lies in the cut */
    double score;      /* of that cut */
    bool fan;          /* its wall may be a fan about a point near g ... */
    double toward[3];  /* ... in this direction */
    double reach;      /* so far points in that direction from g see all of Q */
} peeling;

static void peeling_free(peeling *m) {
    bvh_free(m->trees[0]);
    bvh_free(m->trees[1]);
    cones_free_loops(&m->loops);
    RELEASE(m->faces.data, m->edges.data, m->wall.points.data, m->image.points.data, m->side.data,
            m->heights, m->part, m->flat, m->above);
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

starg_status cones_see_side(const cone_builder *b, int end, const number_list *faces,
                            const loop_places *wall, uint32_t vertex, bool beyond, side_view *out) {
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    size_t count = 0;
    double way[3], normal[3], down[3];
    NEW(b->context, STAGE, rows, 5 * (faces->count / 3 + 1));
    NEW(b->context, STAGE, order, faces->count / 3 + 1);
    *out = (side_view){.room = 0};
    for (size_t i = 0; i < faces->count; i += 3) {
        const uint32_t *corner = faces->data + i;
        vec3_triangle_normal(cones_place_of(b, end, corner[0]), cones_place_of(b, end, corner[1]),
                             cones_place_of(b, end, corner[2]), normal);
        out->area += 0.5 * vec3_length(normal);
        put_row(normal, cones_place_of(b, end, corner[0]), rows + 5 * count++);
    }
    vec3_subtract(cones_place_of(b, end, vertex), wall->mean, way);
    bool turned = (vec3_dot(way, wall->normal) < 0) != beyond;
    for (int k = 0; k < 3; k++)
        down[k] = turned ? wall->normal[k] : -wall->normal[k];
    put_row(down, wall->mean, rows + 5 * count++);
    double size = sqrt(out->area);
    linear_program program = {.dimension = 4,
                              .rows = rows,
                              .count = count,
                              .objective = {0, 0, 0, 1},
                              .radius = 64 * (size + wall->extent)};
    vec3_copy(wall->mean, program.center);
    linear_program_solve(&program, order, NULL, &solution);
    out->room = solution.feasible && size > 0 ? solution.point[3] / size : 0;
    vec3_copy(solution.point, out->point);
    for (size_t i = 0; i < faces->count; i += 3) {
        const uint32_t *corner = faces->data + i;
        vec3_triangle_normal(cones_place_of(b, end, corner[0]), cones_place_of(b, end, corner[1]),
                             cones_place_of(b, end, corner[2]), normal);
        vec3_subtract(cones_place_of(b, end, corner[0]), out->point, way);
        out->seen += vec3_dot(way, normal) > 0 ? 0.5 * vec3_length(normal) : 0;
    }
    return STARG_OK;
}

/* The triangles of the piece on one side of a cut; those that it crosses are on both. */
static starg_status list_side(peeling *m, uint32_t part, bool beyond) {
    m->side.count = 0;
    for (size_t i = 0; i < m->faces.count; i += 3) {
        const uint32_t *corner = m->faces.data + i;
        bool leaf = false, rest = false;
        for (int k = 0; k < 3; k++) {
            double height = m->heights[corner[k]];
            bool above = height > 0 && root_of(m->part, corner[k]) == part;
            leaf = leaf || above;
            rest = rest || (height != 0 && !above);
        }
        for (int k = 0; k < 3 && (beyond ? rest : leaf); k++)
            PUSH(m->b->context, STAGE, &m->side, corner[k]);
    }
    return STARG_OK;
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
    double foot[3], direction[3] = {0}, room;
    side_view views[2];
    bool fan;
    TRY(cones_place_loop(m->b, m->end, loop, count, &m->wall));
    TRY(cones_find_hub(m->b, &m->wall, foot, &room));
    if (!(room > ROOMY) || !cones_is_inside(m->trees[m->end], &m->wall, foot))
        return STARG_OK;
    for (int side = 0; side < 2; side++) { /* the leaf, and the rest */
        TRY(list_side(m, part, side == 1));
        TRY(cones_see_side(m->b, m->end, &m->side, &m->wall, part, side == 1, &views[side]));
    }
    if (m->star)
        TRY(find_direction(m, loop, count, direction, &fan));
    else
        TRY(has_hub(m, loop, count, &fan));
    if (!fan && !m->star)
        return STARG_OK;
    double score =
        (fan ? 2 : 0) + (views[0].seen + views[1].seen) / (views[0].area + views[1].area);
    if ((!fan && !(views[0].room > MARGIN)) || !(score > m->score))
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
    return cones_part(b, m->which, &m->edges, m->loops.nodes.data, m->loops.nodes.count, m->leaf);
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

/* ---- fans ---- */

/* A wall about a point of its plane in P, and a point near g in Q. */
static starg_status build_fan(peeling *m) {
    const cut_node *loop = m->loops.nodes.data;
    size_t count = m->loops.nodes.count;
    double hubs[2][3], room;
    uint32_t hub;
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
    bool done;
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
    if (!done)
        return STARG_OK;
    TRY(cones_place_loop(m->b, m->end, m->loops.nodes.data, m->loops.nodes.count, &m->wall));
    const cone_leaf leaf = {m->b, m->which, m->leaf, m->end, m->g, &m->loops, &m->wall};
    TRY(m->fan ? build_fan(m) : cones_lay(&leaf, &done));
    *out = done ? PEEL_DONE : PEEL_BROKEN;
    return STARG_OK;
}

starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out) {
    peeling m = {.b = b, .which = which, .end = end};
    starg_status status = peel(&m, out);
    peeling_free(&m);
    return status;
}
