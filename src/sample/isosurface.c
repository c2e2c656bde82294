/* SPDX-License-Identifier: Apache-2.0 */
/* Marching tetrahedra on the body-centred cubic lattice.
 *
 * Problem: a closed 2-manifold near the zero set of a field, evaluating only space near it. Stages:
 * descend an octree and drop every cube that the surface cannot reach (|value at the centre| above
 * half the diagonal: the field has Lipschitz constant 1); for each remaining cube, cut the
 * tetrahedra that it shares with its six neighbours.
 *
 * A lattice tetrahedron joins the centres of two neighbouring cubes with an edge of the square
 * between them; all are congruent and nearly regular, which is why [LS07] uses them. Lattice points
 * have integer coordinates: all odd for centres, all even for corners.
 *
 * Invariants: a lattice point is inside exactly if its value is negative. Then the triangles cut
 * out of the tetrahedra form a closed 2-manifold (each tetrahedron contains at most one disc, and
 * discs meet along whole borders). A cut edge makes one vertex, identified by its ends.
 *
 * Cost: O(n) field values and look-ups for n cubes that the surface meets. */
#include "sample/solids.h"

#include "geometry/vec3.h"

static const char STAGE[] = "sample";
static const double CLAMP =
    1e-5; /* smallest distance of a cut from an end, as a fraction of the edge */

enum { BITS = 20, MAX_LEVELS = 16 };

typedef STARG_ARRAY(uint64_t) key_array;

typedef struct mesher {
    starg_context *context;
    const implicit_field *field;
    double origin[3], half; /* position of lattice point 0, and half the side of a cube */
    key_map cubes;          /* those that the surface may meet, by their centres */
    key_array cube_keys;
    key_map points; /* lattice points with known values */
    STARG_ARRAY(double) values;
    mesh_builder *builder;
} mesher;

typedef struct lattice_point {
    int64_t x[3];
} lattice_point;

static uint64_t point_key(const lattice_point *p) {
    return (uint64_t)p->x[0] | (uint64_t)p->x[1] << BITS | (uint64_t)p->x[2] << (2 * BITS);
}

static lattice_point key_point(uint64_t key) {
    const uint64_t mask = ((uint64_t)1 << BITS) - 1;
    return (lattice_point){
        {(int64_t)(key & mask), (int64_t)(key >> BITS & mask), (int64_t)(key >> (2 * BITS))}};
}

static void point_position(const mesher *m, const lattice_point *p, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = m->origin[k] + m->half * (double)p->x[k];
}

/* ---- cubes near the surface ---- */

/* A cube of the octree: its centre, and half its side in lattice units (a power of two). */
static starg_status descend(mesher *m, const lattice_point *center, int64_t half) {
    double p[3];
    point_position(m, center, p);
    if (fabs(implicit_evaluate(m->field, p).value) > 1.7320509 * m->half * (double)half)
        return STARG_OK;
    if (half == 1) {
        uint32_t number;
        bool added;
        TRY(key_map_add(m->context, &m->cubes, point_key(center), &number, &added));
        PUSH(m->context, STAGE, &m->cube_keys, point_key(center));
        return STARG_OK;
    }
    for (int octant = 0; octant < 8; octant++) {
        lattice_point child = *center;
        for (int k = 0; k < 3; k++)
            child.x[k] += (octant >> k & 1) ? half / 2 : -half / 2;
        TRY(descend(m, &child, half / 2));
    }
    return starg_check_cancel(m->context, STAGE);
}

static starg_status find_cubes(mesher *m, double spacing) {
    double lower[3], upper[3], span = 0;
    implicit_bounds(m->field, lower, upper);
    for (int k = 0; k < 3; k++)
        span = fmax(span, upper[k] - lower[k]);
    int64_t cubes = 1;
    while ((double)cubes * spacing < span + 4 * spacing && cubes < (int64_t)1 << MAX_LEVELS)
        cubes *= 2;
    m->half = 0.5 * spacing;
    lattice_point center = {{cubes + 2, cubes + 2, cubes + 2}}; /* 2: neighbours stay above 0 */
    for (int k = 0; k < 3; k++)
        m->origin[k] = 0.5 * (lower[k] + upper[k]) - m->half * (double)(cubes + 2);
    return descend(m, &center, cubes);
}

/* ---- tetrahedra ---- */

typedef struct corner {
    lattice_point point;
    double value;
} corner;

static starg_status load_corner(mesher *m, const lattice_point *point, corner *out) {
    uint32_t number;
    bool added;
    TRY(key_map_add(m->context, &m->points, point_key(point), &number, &added));
    if (added) {
        double p[3];
        point_position(m, point, p);
        PUSH(m->context, STAGE, &m->values, implicit_evaluate(m->field, p).value);
    }
    *out = (corner){.point = *point, .value = m->values.data[number]};
    return STARG_OK;
}

/* Lattice edges are identified by their midpoints, which are distinct. */
static uint64_t edge_key(const corner *a, const corner *b) {
    lattice_point sum;
    for (int k = 0; k < 3; k++)
        sum.x[k] = a->point.x[k] + b->point.x[k];
    return point_key(&sum);
}

/* The vertex where the surface cuts the edge from a (inside) to b (outside). */
static starg_status cut_edge(mesher *m, const corner *a, const corner *b, uint32_t *vertex) {
    double pa[3], pb[3], d[3], p[3];
    point_position(m, &a->point, pa);
    point_position(m, &b->point, pb);
    vec3_subtract(pb, pa, d);
    double t = a->value / (a->value - b->value);
    vec3_along(pa, fmax(CLAMP, fmin(1 - CLAMP, t)), d, p);
    return builder_vertex(m->builder, edge_key(a, b), p, vertex);
}

/* Cuts the tetrahedron c, of positive orientation: det(c1 - c0, c2 - c0, c3 - c0) > 0. */
static starg_status cut_tetrahedron(mesher *m, const corner *const c[4]) {
    /* even permutations that move the inside corners (or, for three, the outside one) to the
     * front */
    static const int order[16][4] = {{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3},
                                     {2, 0, 1, 3}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 0, 2, 1},
                                     {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 0, 1, 3},
                                     {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 1, 2, 3}};
    int inside = 0, count = 0;
    for (int k = 0; k < 4; k++)
        if (c[k]->value < 0) {
            inside |= 1 << k;
            count++;
        }
    if (count == 0 || count == 4)
        return STARG_OK;
    const int *o = order[inside];
    const corner *p = c[o[0]], *q = c[o[1]], *r = c[o[2]], *s = c[o[3]];
    uint32_t v[4];
    if (count == 2) { /* p, q inside */
        TRY(cut_edge(m, p, r, &v[0]));
        TRY(cut_edge(m, p, s, &v[1]));
        TRY(cut_edge(m, q, s, &v[2]));
        TRY(cut_edge(m, q, r, &v[3]));
        TRY(builder_quad(m->builder, v[0], v[1], v[2], v[3]));
    } else if (count == 1) { /* p inside */
        TRY(cut_edge(m, p, q, &v[0]));
        TRY(cut_edge(m, p, r, &v[1]));
        TRY(cut_edge(m, p, s, &v[2]));
        TRY(builder_triangle(m->builder, v[0], v[1], v[2]));
    } else { /* p outside */
        TRY(cut_edge(m, q, p, &v[0]));
        TRY(cut_edge(m, r, p, &v[1]));
        TRY(cut_edge(m, s, p, &v[2]));
        TRY(builder_triangle(m->builder, v[0], v[2], v[1]));
    }
    return STARG_OK;
}

/* Cuts the four tetrahedra between a cube and its neighbour along an axis. */
static starg_status cut_pair(mesher *m, const corner *center, const corner *neighbour, int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    static const int turn[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    corner square[4];
    for (int i = 0; i < 4; i++) {
        lattice_point p = center->point;
        p.x[axis] += 1;
        p.x[u] += turn[i][0];
        p.x[v] += turn[i][1];
        TRY(load_corner(m, &p, &square[i]));
    }
    for (int i = 0; i < 4; i++) {
        const corner *const c[4] = {center, neighbour, &square[i], &square[(i + 1) % 4]};
        TRY(cut_tetrahedron(m, c));
    }
    return STARG_OK;
}

/* Cuts all tetrahedra of a cube that no earlier cube has cut. */
static starg_status cut_cube(mesher *m, uint64_t key) {
    lattice_point p = key_point(key);
    corner center, neighbour;
    TRY(load_corner(m, &p, &center));
    for (int axis = 0; axis < 3; axis++)
        for (int step = -2; step <= 2; step += 4) {
            lattice_point q = p;
            q.x[axis] += step;
            /* a neighbour in the set cuts its upper side itself */
            if (step < 0 && key_map_find(&m->cubes, point_key(&q)) != UINT32_MAX)
                continue;
            TRY(load_corner(m, &q, &neighbour));
            if (step < 0)
                TRY(cut_pair(m, &neighbour, &center, axis));
            else
                TRY(cut_pair(m, &center, &neighbour, axis));
        }
    return STARG_OK;
}

starg_status isosurface_extract(const implicit_field *field, double spacing,
                                mesh_builder *builder) {
    starg_status status = STARG_OK;
    mesher m = {.context = builder->context, .field = field, .builder = builder};
    STARG_TRY(find_cubes(&m, spacing));
    for (size_t i = 0; i < m.cube_keys.count; i++) {
        STARG_TRY(cut_cube(&m, m.cube_keys.data[i]));
        STARG_TRY(starg_check_cancel(m.context, STAGE));
    }
done:
    key_map_free(&m.cubes);
    key_map_free(&m.points);
    RELEASE(m.cube_keys.data, m.values.data);
    return status;
}
