/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurface stuffing: tetrahedra with bounded angles in any solid.
 *
 * Source: F. Labelle, J. R. Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good
 * dihedral angles, 2007, with a uniform lattice.
 *
 * Stages: a lattice fine enough to have points inside; its cuts and its warp (lattice.c); then each
 * lattice tetrahedron with an inside corner is cut down to its inside part:
 *
 *   corners outside       inside part
 *   0                     the tetrahedron
 *   all but one           a tetrahedron: outside corners move to their edges' cuts
 *   1, and 1 on it        a pyramid over the quadrilateral left of a face, two tetrahedra
 *   1, or 2 and 2         a triangular prism, three tetrahedra
 *
 * The quadrilateral left of a face is shared with the neighbouring tetrahedron, so its diagonal
 * depends on the face only. If its two cuts lie on a long and a short edge, the diagonal ends in
 * the cut of the long one; otherwise in the cut of the inside corner with the higher number. With
 * this choice the three diagonals of a prism are never cyclic, so it can be cut.
 *
 * A lattice tetrahedron joins the centres of two neighbouring cubes (a long edge) to two ends of an
 * edge of the square between them (the other long edge). Cost: linear in the lattice. */
#include <math.h>

#include "geometry/predicates.h"
#include "tetra/generate.h"

static const char STAGE[] = TETRA_STAGE;

enum { FINEST = 24 };             /* halvings of the spacing before a solid counts as too thin */
static const double TOO_THIN = 8; /* limit for the cube side over the solid's thickness */

/* A corner of a lattice tetrahedron. */
typedef struct corner {
    lattice_point point;
    size_t number;
    lattice_side side;
    bool odd; /* is it a centre? */
} corner;

typedef struct stuffer {
    starg_context *context;
    lattice lattice;
    uint32_t *vertex; /* per lattice point: vertex of the mesh, or UINT32_MAX */
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) tetrahedra;
} stuffer;

/* ---- vertices ---- */

static starg_status add_vertex(stuffer *s, const double p[3], uint32_t *vertex) {
    if (*vertex != UINT32_MAX)
        return STARG_OK;
    *vertex = (uint32_t)(s->vertices.count / 3);
    for (int k = 0; k < 3; k++)
        PUSH(s->context, STAGE, &s->vertices, p[k]);
    return STARG_OK;
}

static starg_status corner_vertex(stuffer *s, const corner *c, uint32_t *vertex) {
    const lattice *l = &s->lattice;
    double p[3];
    uint32_t node = l->node[c->number];
    lattice_position(l, &c->point, p);
    starg_status status =
        add_vertex(s, node != UINT32_MAX ? l->nodes.data[node].position : p, &s->vertex[c->number]);
    *vertex = s->vertex[c->number];
    return status;
}

/* The vertex of the cut between an inside and an outside corner. */
static starg_status cut_vertex(stuffer *s, const corner *a, const corner *b, uint32_t *vertex) {
    lattice_cut *cut = lattice_cut_between(&s->lattice, &a->point, &b->point);
    starg_status status = add_vertex(s, cut->position, &cut->vertex);
    *vertex = cut->vertex;
    return status;
}

/* ---- tetrahedra ---- */

static starg_status emit(stuffer *s, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const double *p = s->vertices.data;
    bool wrong =
        orient3d(p + 3 * (size_t)a, p + 3 * (size_t)b, p + 3 * (size_t)c, p + 3 * (size_t)d) > 0;
    const uint32_t v[4] = {a, b, wrong ? d : c, wrong ? c : d};
    for (int k = 0; k < 4; k++)
        PUSH(s->context, STAGE, &s->tetrahedra, v[k]);
    return STARG_OK;
}

static bool is_long(const corner *a, const corner *b) {
    return a->odd == b->odd;
}

/* In the face of the inside corners a and b and the outside corner o: does the diagonal of the
 * quadrilateral go from a to the cut of b? */
static bool diagonal_from(const corner *a, const corner *b, const corner *o) {
    if (is_long(a, o) != is_long(b, o))
        return is_long(b, o);
    int above = 0;
    for (int k = 0; k < 3; k++)
        above += a->point.x[k] > o->point.x[k];
    return above % 2 == 0;
}

/* Rails i join low[i] to high[i]. before[i][j]: the diagonal between rails i and j goes from low[i]
 * to high[j]. Without a cycle the rails have an order in which all diagonals go up. */
static starg_status emit_prism(stuffer *s, const uint32_t low[3], const uint32_t high[3],
                               bool first_before_second, bool second_before_third,
                               bool first_before_third) {
    int rank[3] = {0, 0, 0}, at[3] = {0, 0, 0};
    rank[first_before_second ? 1 : 0]++;
    rank[second_before_third ? 2 : 1]++;
    rank[first_before_third ? 2 : 0]++;
    for (int i = 0; i < 3; i++)
        at[rank[i]] = i;
    int i = at[0], j = at[1], k = at[2];
    TRY(emit(s, low[i], low[j], low[k], high[k]));
    TRY(emit(s, low[i], low[j], high[j], high[k]));
    return emit(s, low[i], high[i], high[j], high[k]);
}

static starg_status stuff_three(stuffer *s, const corner *const in[3], const corner *out) {
    uint32_t low[3], high[3];
    for (int i = 0; i < 3; i++) {
        TRY(corner_vertex(s, in[i], &low[i]));
        TRY(cut_vertex(s, in[i], out, &high[i]));
    }
    return emit_prism(s, low, high, diagonal_from(in[0], in[1], out),
                      diagonal_from(in[1], in[2], out), diagonal_from(in[0], in[2], out));
}

/* The rails are the edge a b and, for each outside corner, its cuts to a and to b. The third
 * quadrilateral is interior and takes the diagonal that avoids a cycle: determined if the first
 * rail is before one and after the other; otherwise either will do. */
static starg_status stuff_two(stuffer *s, const corner *a, const corner *b,
                              const corner *const out[2]) {
    uint32_t low[3], high[3];
    TRY(corner_vertex(s, a, &low[0]));
    TRY(corner_vertex(s, b, &high[0]));
    for (int i = 0; i < 2; i++) {
        TRY(cut_vertex(s, a, out[i], &low[1 + i]));
        TRY(cut_vertex(s, b, out[i], &high[1 + i]));
    }
    bool before_one = diagonal_from(a, b, out[0]), before_two = diagonal_from(a, b, out[1]);
    bool one_before_two = before_one == before_two ? out[0]->number < out[1]->number : before_two;
    return emit_prism(s, low, high, before_one, one_before_two, before_two);
}

static starg_status stuff_pyramid(stuffer *s, const corner *a, const corner *b, const corner *on,
                                  const corner *out) {
    uint32_t va, vb, apex, ca, cb;
    TRY(corner_vertex(s, a, &va));
    TRY(corner_vertex(s, b, &vb));
    TRY(corner_vertex(s, on, &apex));
    TRY(cut_vertex(s, a, out, &ca));
    TRY(cut_vertex(s, b, out, &cb));
    if (diagonal_from(a, b, out)) {
        TRY(emit(s, va, vb, cb, apex));
        TRY(emit(s, va, cb, ca, apex));
    } else {
        TRY(emit(s, va, vb, ca, apex));
        TRY(emit(s, vb, cb, ca, apex));
    }
    return STARG_OK;
}

/* One inside corner, or none outside: the inside part is a tetrahedron. */
static starg_status stuff_tetrahedron(stuffer *s, const corner c[4], const corner *inside) {
    uint32_t v[4];
    for (int k = 0; k < 4; k++)
        TRY(c[k].side == LATTICE_OUTSIDE ? cut_vertex(s, inside, &c[k], &v[k])
                                         : corner_vertex(s, &c[k], &v[k]));
    return emit(s, v[0], v[1], v[2], v[3]);
}

static starg_status stuff(stuffer *s, const corner c[4]) {
    const corner *in[4], *on[4], *out[4];
    int ins = 0, ons = 0, outs = 0;
    for (int k = 0; k < 4; k++) {
        if (c[k].side == LATTICE_INSIDE)
            in[ins++] = &c[k];
        else if (c[k].side == LATTICE_ON)
            on[ons++] = &c[k];
        else
            out[outs++] = &c[k];
    }
    if (ins == 0)
        return STARG_OK;
    if (outs == 0 || ins == 1)
        return stuff_tetrahedron(s, c, in[0]);
    if (ins == 3)
        return stuff_three(s, in, out[0]);
    return ons == 1 ? stuff_pyramid(s, in[0], in[1], on[0], out[0])
                    : stuff_two(s, in[0], in[1], out);
}

/* ---- the lattice ---- */

static corner load_corner(const lattice *l, const lattice_point *p) {
    size_t number = lattice_number(l, p);
    return (corner){*p, number, (lattice_side)l->side[number], (p->x[0] & 1) != 0};
}

/* The four tetrahedra between a centre and the next one along an axis. */
static starg_status stuff_pair(stuffer *s, const lattice_point *center, int axis) {
    static const int turn[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    lattice_point next = *center;
    corner square[4];
    next.x[axis] += 2;
    for (int i = 0; i < 4; i++) {
        lattice_point p = *center;
        p.x[axis] += 1;
        p.x[u] += turn[i][0];
        p.x[v] += turn[i][1];
        square[i] = load_corner(&s->lattice, &p);
    }
    for (int i = 0; i < 4; i++) {
        const corner c[4] = {load_corner(&s->lattice, center), load_corner(&s->lattice, &next),
                             square[i], square[(i + 1) % 4]};
        TRY(stuff(s, c));
    }
    return STARG_OK;
}

/* Pairs of centres; those at the lattice border contain nothing inside. */
static starg_status stuff_all(stuffer *s) {
    const int64_t *cubes = s->lattice.cubes;
    lattice_point c;
    for (c.x[0] = 1; c.x[0] < 2 * cubes[0] - 1; c.x[0] += 2) {
        for (c.x[1] = 1; c.x[1] < 2 * cubes[1] - 1; c.x[1] += 2)
            for (c.x[2] = 1; c.x[2] < 2 * cubes[2] - 1; c.x[2] += 2)
                for (int axis = 0; axis < 3; axis++)
                    TRY(stuff_pair(s, &c, axis));
        starg_progress_step(s->context, (size_t)c.x[0], (size_t)(2 * cubes[0]));
        TRY(starg_check_cancel(s->context, STAGE));
    }
    return STARG_OK;
}

static starg_status fail_thin(stuffer *s) {
    return starg_fail(
        s->context, STARG_ERROR_SOLVER, STAGE,
        "the solid is too thin to be filled: no lattice of at most %zu points has one "
        "inside; thicken it, or cut it where it is thin",
        LATTICE_LIMIT);
}

/* Is the solid much thinner than the lattice spacing? Then at most stray points are inside. Twice
 * the volume over the area is the thickness of a plate. */
static bool is_below_lattice(const tetra_shape *shape, double spacing) {
    double finest = lattice_spacing(shape, ldexp(spacing, -FINEST));
    return 2 * fabs(shape->volume) < finest / TOO_THIN * starg_mesh_area(shape->mesh);
}

/* Halves the spacing until a point remains inside after the warp. */
static starg_status make_lattice(stuffer *s, const tetra_shape *shape, double *spacing) {
    if (is_below_lattice(shape, *spacing))
        return fail_thin(s);
    for (int attempt = 0; attempt < FINEST; attempt++) {
        double taken = lattice_spacing(shape, *spacing);
        TRY(lattice_create(s->context, shape, taken, &s->lattice));
        if (s->lattice.inside > 0) {
            TRY(lattice_cut_edges(&s->lattice));
            lattice_warp(&s->lattice);
            for (size_t i = 0; i < s->lattice.points; i++)
                if (s->lattice.side[i] == LATTICE_INSIDE) {
                    *spacing = taken;
                    return STARG_OK;
                }
        }
        lattice_free(&s->lattice);
        if (taken > *spacing) /* a finer lattice does not fit into memory */
            break;
        *spacing *= 0.5;
    }
    return fail_thin(s);
}

starg_status tetra_by_stuffing(starg_context *context, const tetra_shape *shape, double *spacing,
                               starg_tetmesh **out) {
    starg_status status = STARG_OK;
    stuffer s = {.context = context, .lattice = {.context = context}};
    *out = NULL;
    STARG_TRY(make_lattice(&s, shape, spacing));
    STARG_NEW(context, STAGE, s.vertex, s.lattice.points);
    memset(s.vertex, 0xff, s.lattice.points * sizeof *s.vertex);
    STARG_TRY(stuff_all(&s));
    STARG_TRY(tetmesh_adopt(context, s.vertices.data, s.vertices.count / 3, s.tetrahedra.data,
                            s.tetrahedra.count / 4, NULL, true, out));
    s.vertices.data = NULL;
    s.tetrahedra.data = NULL;
done:
    lattice_free(&s.lattice);
    RELEASE(s.vertex, s.vertices.data, s.tetrahedra.data);
    return status;
}
