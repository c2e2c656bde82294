/* SPDX-License-Identifier: Apache-2.0 */
/* Laplacian smoothing of the inner borders of pieces [YL11, section 4].
 *
 * A vertex that lies between pieces, and not on the boundary of the solid, moves towards the mean
 * of its neighbours on the border: all the way, or half or a quarter of it. The first of these is
 * taken that does no harm: each tetrahedron around it stays positive (exactly) and keeps a tenth of
 * its volume; each guard of a piece at the vertex that sees it goes on to do so; each border face
 * that has the guard of its piece strictly on its inner side keeps it there. So neither fewer
 * vertices are seen nor are fewer pieces star-shaped afterwards.
 *
 * Vertices move one after the other, in their order, a fixed number of times. What they cover
 * together never changes. Cost: O(degree) and some look-ups a border vertex and round. */
#include "star/paper/state.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"

enum { ROUNDS = 8, STEPS = 3 };

/* Part of its volume that each tetrahedron keeps, through all moves. */
static const double LEAST_KEPT = 0.1;

typedef struct smoother {
    paper_state *state;
    int exponent;
    bool *fixed;     /* per vertex: on the boundary of the solid, or between no pieces */
    double *volumes; /* of all tetrahedra, in units of 2^exponent, before anything moves */
    bool *facing;    /* four for each tetrahedron around a vertex: a border face that its guard is
                        behind of, before the vertex moves */
} smoother;

static bool is_border(const paper_state *s, size_t face) {
    uint32_t next = s->mesh->neighbours[face];
    return next != PAPER_NONE && s->labels[next] != s->labels[face / 4];
}

static void mark_faces(smoother *m, bool value, bool boundary) {
    const paper_state *s = m->state;
    for (size_t f = 0; f < 4 * s->mesh->count; f++) {
        bool wanted = boundary ? s->mesh->neighbours[f] == PAPER_NONE : is_border(s, f);
        for (int k = 0; wanted && k < 3; k++)
            m->fixed[s->mesh->tetrahedra[(f & ~(size_t)3) + (size_t)TETMESH_FACE[f & 3][k]]] =
                value;
    }
}

/* Vertices on a border are free, unless they are on the boundary. */
static void find_fixed(smoother *m) {
    for (size_t v = 0; v < m->state->mesh->vertex_count; v++)
        m->fixed[v] = true;
    mark_faces(m, false, false);
    mark_faces(m, true, true);
}

static size_t widest_ring(const paper_state *s) {
    size_t widest = 0;
    for (size_t v = 0; v < s->mesh->vertex_count; v++) {
        size_t degree = s->rings.first[v + 1] - s->rings.first[v];
        widest = degree > widest ? degree : widest;
    }
    return widest;
}

/* ---- one vertex ---- */

static const uint32_t *ring_of(const smoother *m, uint32_t vertex, size_t *count) {
    const tet_rings *rings = &m->state->rings;
    *count = rings->first[vertex + 1] - rings->first[vertex];
    return rings->at + rings->first[vertex];
}

/* The mean of the border's vertices around one, in which a vertex counts as often as border faces
 * name it beside this one; false where there are none. */
static bool find_mean(const smoother *m, uint32_t vertex, double out[3]) {
    const starg_tetmesh *mesh = m->state->mesh;
    size_t count, names = 0;
    const uint32_t *ring = ring_of(m, vertex, &count);
    const double *own = mesh->vertices + 3 * (size_t)vertex;
    double sum[3] = {0};
    for (size_t i = 0; i < 4 * count; i++) {
        size_t face = 4 * (size_t)ring[i / 4] + i % 4;
        if (mesh->tetrahedra[face] == vertex || !is_border(m->state, face))
            continue;
        for (int k = 0; k < 3; k++) {
            uint32_t v = mesh->tetrahedra[(face & ~(size_t)3) + (size_t)TETMESH_FACE[face & 3][k]];
            if (v == vertex)
                continue;
            names++;
            for (int c = 0; c < 3; c++)
                sum[c] += mesh->vertices[3 * (size_t)v + (size_t)c] - own[c];
        }
    }
    for (int c = 0; c < 3 && names > 0; c++)
        out[c] = own[c] + sum[c] / (double)names;
    return names > 0;
}

/* Is the guard of the tetrahedron's piece strictly on the inner side of its face k? */
static bool faces_guard(const smoother *m, size_t tetrahedron, int k) {
    const paper_state *s = m->state;
    const int *c = TETMESH_FACE[k];
    return orient3d(tetmesh_corner(s->mesh, tetrahedron, c[0]),
                    tetmesh_corner(s->mesh, tetrahedron, c[1]),
                    tetmesh_corner(s->mesh, tetrahedron, c[2]),
                    s->guards.data + 3 * (size_t)s->labels[tetrahedron]) > 0;
}

static bool is_positive(const smoother *m, size_t tetrahedron) {
    const starg_tetmesh *mesh = m->state->mesh;
    return orient3d(tetmesh_corner(mesh, tetrahedron, 0), tetmesh_corner(mesh, tetrahedron, 1),
                    tetmesh_corner(mesh, tetrahedron, 2), tetmesh_corner(mesh, tetrahedron, 3)) < 0;
}

static bool sees(const smoother *m, size_t tetrahedron, const double p[3]) {
    const paper_state *s = m->state;
    return tet_sight_is_free(&s->sight, s->guards.data + 3 * (size_t)s->labels[tetrahedron], p);
}

/* Notes what must not be lost around a vertex. */
static void note(const smoother *m, uint32_t vertex) {
    size_t count;
    const uint32_t *ring = ring_of(m, vertex, &count);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 4; k++)
            m->facing[4 * i + k] =
                is_border(m->state, 4 * (size_t)ring[i] + k) && faces_guard(m, ring[i], (int)k);
    }
}

static bool keeps_tetrahedra(const smoother *m, uint32_t vertex) {
    size_t count;
    const uint32_t *ring = ring_of(m, vertex, &count);
    for (size_t i = 0; i < count; i++)
        if (tetmesh_scaled_volume(m->state->mesh, ring[i], m->exponent) <
                LEAST_KEPT * m->volumes[ring[i]] ||
            !is_positive(m, ring[i]))
            return false;
    for (size_t i = 0; i < 4 * count; i++)
        if (m->facing[i] && !faces_guard(m, ring[i / 4], (int)(i % 4)))
            return false;
    return true;
}

/* Each piece at the vertex is asked by the first of its tetrahedra there. */
static bool keeps_sight(const smoother *m, uint32_t vertex, const double before[3]) {
    const paper_state *s = m->state;
    size_t count;
    const uint32_t *ring = ring_of(m, vertex, &count);
    for (size_t i = 0; i < count; i++) {
        bool asked = false;
        for (size_t j = 0; j < i && !asked; j++)
            asked = s->labels[ring[j]] == s->labels[ring[i]];
        if (!asked && !sees(m, ring[i], s->mesh->vertices + 3 * (size_t)vertex) &&
            sees(m, ring[i], before))
            return false;
    }
    return true;
}

static void move_vertex(const smoother *m, uint32_t vertex) {
    double *at = m->state->mesh->vertices + 3 * (size_t)vertex, before[3], mean[3], way[3];
    if (!find_mean(m, vertex, mean))
        return;
    vec3_copy(at, before);
    vec3_subtract(mean, before, way);
    note(m, vertex);
    double part = 1;
    for (int step = 0; step < STEPS; step++, part /= 2) {
        vec3_along(before, part, way, at);
        if (keeps_tetrahedra(m, vertex) && keeps_sight(m, vertex, before))
            return;
    }
    vec3_copy(before, at);
}

starg_status smooth_borders(paper_state *s) {
    starg_status status = STARG_OK;
    smoother m = {.state = s, .exponent = tetmesh_exponent(s->mesh)};
    size_t widest = widest_ring(s);
    STARG_NEW(s->context, PAPER_STAGE, m.fixed, s->mesh->vertex_count);
    STARG_NEW(s->context, PAPER_STAGE, m.volumes, s->mesh->count);
    STARG_NEW(s->context, PAPER_STAGE, m.facing, 4 * widest);
    find_fixed(&m);
    for (size_t t = 0; t < s->mesh->count; t++)
        m.volumes[t] = tetmesh_scaled_volume(s->mesh, t, m.exponent);
    for (int round = 0; round < ROUNDS; round++) {
        STARG_TRY(starg_check_cancel(s->context, PAPER_STAGE));
        for (size_t v = 0; v < s->mesh->vertex_count; v++)
            if (!m.fixed[v])
                move_vertex(&m, (uint32_t)v);
    }
done:
    RELEASE(m.fixed, m.volumes, m.facing);
    return status;
}
