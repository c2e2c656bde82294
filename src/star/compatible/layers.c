/* SPDX-License-Identifier: Apache-2.0 */
/* A leaf taken off a piece in two layers, whatever its shape is in the place Q.
 *
 * Problem: the part D of a piece's surface and a flat wall W bound a leaf in the place P, where a
 * point p sees all of it and a foot f in W all of W. A point g sees all of the piece in Q. Span the
 * rim of W in Q so that g sees all of what is left, and fill the leaf.
 *
 * Method: in Q the wall is D drawn to g, and the leaf is cut into layers that are divided by the
 * cone K over the rim of W, whose apex is on the line from f through p, a little beyond p.
 *     1. Half-planes through the line and the corners of W divide D, the line itself gives a
 * vertex. Then the triangles of D, seen from p, lie in one side of K each, and so
 *     2. the layer between D and K is made of frusta: D drawn to p until it lies in K,
 *     3. the layer between K and W of prisms parallel to the line: K falls into W.
 * In Q the two layers are D drawn to g by a quarter, and by half. Frusta and prisms are convex in
 * both places. W takes the triangles of D.
 *
 * Invariants: those of cones.c; the rim of W stays where it is in both layers. What rounding makes
 * of the pieces is checked by exact signs, as of all others.
 *
 * Cost: a leaf of n triangles with a wall of k corners gives 2 (n + O(k sqrt(n))) pieces, which are
 * joined later where that is possible. */
#include "star/compatible/peel.h"

#include "geometry/vec3.h"

static const char STAGE[] = "cones";

enum { HALVINGS = 40 };
static const double MARGIN = 5e-4;   /* of p, over the leaf's size */
static const double SNAP = 1e-3;     /* of an edge: a half-plane that near an end goes through it */
static const double STRAIGHT = 1e-7; /* the sine of a corner of a wall that is none */
static const double NEAR = 0.9;      /* of the way from p to D: the cone ends there */
static const double DEPTHS[2] = {0.75, 0.5}; /* of the layers towards g */

typedef struct layering {
    cone_builder *b;
    const cone_leaf *leaf;
    const cut_node *rim;
    size_t rim_count;
    number_list faces; /* of the leaf */
    edge_list edges;
    number_list corners;                /* of the wall, in order */
    uint8_t *on_rim;                    /* per vertex */
    uint32_t *after;                    /* per vertex of the rim: the next one */
    double foot[3], center[3], axis[3]; /* f, p and the unit from f to p */
    uint32_t top;                       /* the vertex of D on the line */
} layering;

static void layering_free(layering *m) {
    RELEASE(m->faces.data, m->edges.data, m->corners.data, m->on_rim, m->after);
}

static const double *at(const layering *m, uint32_t vertex) {
    return cones_place_of(m->b, m->leaf->end, vertex);
}

/* ---- the line ---- */

/* f, p, and the line through them. */
static starg_status find_line(layering *m, bool *done) {
    double room;
    side_view view;
    TRY(cones_find_hub(m->b, m->leaf->wall, m->foot, &room));
    *done = room > 0;
    uint32_t vertex = m->faces.data[0];
    for (size_t i = 0; i < m->faces.count && *done; i++)
        if (m->b->heights.data[m->faces.data[i]] > m->b->heights.data[vertex])
            vertex = m->faces.data[i];
    TRY(cones_see_side(m->b, m->leaf->end, &m->faces, m->leaf->wall, vertex, false, &view));
    *done = *done && view.room > MARGIN;
    vec3_copy(view.point, m->center);
    vec3_subtract(m->center, m->foot, m->axis);
    double length = vec3_length(m->axis);
    for (int k = 0; k < 3; k++)
        m->axis[k] /= length;
    return STARG_OK;
}

/* Weights of the point in which the line meets the plane of a triangle; the least of them, or
 * -1 behind p. */
static double meet_line(const layering *m, const uint32_t corner[3], double weights[3]) {
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
static starg_status place_top(layering *m) {
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
static starg_status list_corners(layering *m) {
    const cut_node *loop = m->rim;
    size_t count = m->rim_count;
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
static void find_way_out(const layering *m, const double point[3], double out[3]) {
    vec3_subtract(point, m->foot, out);
    vec3_along(out, -vec3_dot(out, m->axis), m->axis, out);
}

/* Divides the edges of D that cross the half-plane through a corner. */
static starg_status divide_sector(layering *m, uint32_t corner) {
    cone_builder *b = m->b;
    double out[3], normal[3];
    find_way_out(m, at(m, corner), out);
    vec3_cross(m->axis, out, normal);
    TRY(cones_list_faces(b, m->leaf->leaf, &m->faces));
    cones_find_heights(b, m->leaf->end, &m->faces, normal, m->foot, b->heights.data);
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
static starg_status mark_rim(layering *m) {
    const cut_node *loop = m->rim;
    size_t count = m->rim_count, vertices = m->b->about.count;
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
static starg_status divide_chords(layering *m) {
    TRY(mark_rim(m));
    TRY(cones_list_faces(m->b, m->leaf->leaf, &m->faces));
    for (size_t i = 0; i < m->faces.count; i++) {
        uint32_t u = m->faces.data[i], v = m->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        if (u < v && m->on_rim[u] && m->on_rim[v] && m->after[u] != v && m->after[v] != u)
            TRY(cones_split_edge(m->b, u, v, 0.5));
    }
    return STARG_OK;
}

static starg_status divide_leaf(layering *m) {
    TRY(place_top(m));
    TRY(list_corners(m));
    for (size_t i = 0; i < m->corners.count; i++) {
        TRY(mark_rim(m));
        TRY(divide_sector(m, m->corners.data[i]));
    }
    TRY(divide_chords(m));
    TRY(mark_rim(m));
    return cones_list_faces(m->b, m->leaf->leaf, &m->faces);
}

/* ---- layers ---- */

/* The corner after which a vertex stands, as seen along the line: that of the sector in which it
 * lies deepest. */
static size_t sector_of(const layering *m, uint32_t vertex) {
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
static double meet_cone(const layering *m, uint32_t vertex, const double apex[3]) {
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
static bool find_apex(const layering *m, double apex[3], double *shares) {
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
static starg_status place_layers(layering *m, const double apex[3], const double *shares,
                                 uint32_t *down) {
    int end = m->leaf->end;
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
        vec3_along(m->center, shares[v], way, places[0][end]);
        /* how far up the side of the cone it is: the share of the apex */
        vec3_subtract(at(m, m->corners.data[sector]), m->foot, sides[0]);
        vec3_subtract(at(m, m->corners.data[(sector + 1) % m->corners.count]), m->foot, sides[1]);
        vec3_cross(sides[0], sides[1], across);
        vec3_subtract(places[0][end], m->foot, over);
        double up = vec3_dot(over, across) / vec3_dot(m->axis, across);
        up = v == m->top ? height : up;
        vec3_along(places[0][end], -up, m->axis, places[1][end]);
        const double *q = cones_place_of(m->b, 1 - end, v);
        double back[3];
        vec3_subtract(q, m->leaf->g, back);
        for (int layer = 0; layer < 2; layer++)
            vec3_along(m->leaf->g, DEPTHS[layer], back, places[layer][1 - end]);
        for (int layer = 0; layer < 2; layer++)
            TRY(cones_add_vertex(m->b, (const double(*)[3])places[layer],
                                 &down[2 * v + (size_t)layer]));
    }
    return STARG_OK;
}

static starg_status add_side(layering *m, uint32_t a, uint32_t b, uint32_t c, uint32_t own,
                             uint32_t other) {
    const uint32_t corners[3] = {a, b, c}, sides[2] = {own, other};
    return a == b || b == c || c == a ? STARG_OK : cones_add_triangle(m->b, corners, sides);
}

/* A vertex of D on the upper side of a layer, or with `layer` + 1 on its lower side. */
static uint32_t below(const uint32_t *down, uint32_t v, int layer) {
    return layer == 0 ? v : down[2 * v + (uint32_t)layer - 1];
}

/* The piece under a triangle of D in a layer; the first one is the leaf. */
static uint32_t piece_under(const layering *m, uint32_t first, size_t triangle, int layer) {
    size_t number = 2 * triangle + (size_t)layer;
    return number == 0 ? m->leaf->leaf : first + (uint32_t)number - 1;
}

/* Frusta and prisms under all triangles of D, one of each. */
static starg_status build_layers(layering *m, const uint32_t *down) {
    cone_builder *b = m->b;
    SCOPED uint32_t *number = NULL; /* of D's triangles, by triangle */
    SCOPED number_list own = {0};
    uint32_t which = m->leaf->leaf, first = (uint32_t)b->pieces.count, fresh;
    TRY(cones_list_edges(b, which, &m->edges));
    own = b->pieces.data[which].triangles;
    b->pieces.data[which].triangles = (number_list){0};
    NEW(b->context, STAGE, number, b->corners.count / 3);
    for (size_t i = 0; i < own.count; i++)
        number[own.data[i]] = (uint32_t)i;
    for (size_t i = 1; i < 2 * own.count; i++)
        TRY(cones_open_piece(b, 0, &fresh));
    for (size_t i = 0; i < own.count; i++) {
        uint32_t t = own.data[i], corner[3];
        cones_corners_of(b, t, which, corner);
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
                         layer == 0 ? piece_under(m, first, i, 1) : m->leaf->which, under));
        }
    }
    for (size_t i = 0; i < own.count; i++) {
        uint32_t t = own.data[i], under = piece_under(m, first, i, 0);
        b->sides.data[2 * (size_t)t + (b->sides.data[2 * (size_t)t] != which)] = under;
        PUSH(b->context, STAGE, &b->pieces.data[under].triangles, t);
    }
    return STARG_OK;
}

/* ---- all stages ---- */

static starg_status lay(layering *m, bool *done) {
    SCOPED double *shares = NULL;
    SCOPED uint32_t *down = NULL;
    double apex[3];
    TRY(cones_list_faces(m->b, m->leaf->leaf, &m->faces));
    TRY(find_line(m, done));
    if (!*done)
        return STARG_OK;
    TRY(divide_leaf(m));
    NEW(m->b->context, STAGE, shares, m->b->about.count);
    NEW(m->b->context, STAGE, down, 2 * m->b->about.count);
    *done = find_apex(m, apex, shares);
    if (!*done)
        return STARG_OK;
    TRY(place_layers(m, apex, shares, down));
    return build_layers(m, down);
}

starg_status cones_lay(const cone_leaf *leaf, bool *done) {
    layering m = {.b = leaf->b,
                  .leaf = leaf,
                  .rim = leaf->rim->nodes.data,
                  .rim_count = leaf->rim->nodes.count};
    starg_status status = lay(&m, done);
    layering_free(&m);
    return status;
}
