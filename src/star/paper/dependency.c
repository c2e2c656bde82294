/* SPDX-License-Identifier: Apache-2.0 */
/* Visibly dependent tetrahedra [YL11, section 4].
 *
 * The paper: T_v(g, t) holds the tetrahedra that the segments from the guard g to the vertices of t
 * run through; of these, those that have a face of the ring around a vertex of t, on either side of
 * it, are the ones that t is to wait for. For a vertex v that means the tetrahedron s at v into
 * which the segment from v to g runs, and the one behind the face of s opposite v, unless g is in
 * s.
 *
 * What is kept is one predecessor for each vertex: s, where it is not t itself, else the one behind
 * the face. That is enough: s waits for the one behind the face by its own vertex v. So at most
 * four edges enter a node of the graph, and one number for each vertex and guard stores all of
 * them.
 *
 * A segment that runs along faces or edges enters several tetrahedra at once; the first in the
 * order of the mesh is taken. The first tetrahedron that holds the guard then waits for none: all
 * segments to g from its vertices run within it, and no earlier one holds any of their ends at g.
 *
 * Claim a), t is visible if its predecessors are: with "visible" for all points of a tetrahedron it
 * holds for the four vertices of t. A vertex of s is a point of s; and where s is t, the segment
 * runs within t to a point of the tetrahedron behind. With four visible vertices only, it may fail
 * where something reaches between them.
 *
 * All signs are exact. Cost: O(degree) for a vertex, O(1) for a predecessor. */
#include "star/paper/state.h"

#include "geometry/predicates.h"

/* Side of p on face k of a tetrahedron: 1 within, -1 beyond. */
static int side_of_face(const starg_tetmesh *mesh, size_t tetrahedron, int k, const double p[3]) {
    const int *c = TETMESH_FACE[k];
    return orient3d(tetmesh_corner(mesh, tetrahedron, c[0]),
                    tetmesh_corner(mesh, tetrahedron, c[1]),
                    tetmesh_corner(mesh, tetrahedron, c[2]), p);
}

/* Is p on the inner side of all faces but perhaps face `except`, or in their planes? */
static bool is_within(const starg_tetmesh *mesh, size_t tetrahedron, int except,
                      const double p[3]) {
    for (int k = 0; k < 4; k++)
        if (k != except && side_of_face(mesh, tetrahedron, k, p) < 0)
            return false;
    return true;
}

uint32_t dependency_home(const starg_tetmesh *mesh, const double p[3]) {
    for (size_t t = 0; t < mesh->count; t++)
        if (is_within(mesh, t, -1, p))
            return (uint32_t)t;
    return PAPER_NONE;
}

uint32_t dependency_toward(const paper_state *s, uint32_t vertex, const double p[3]) {
    for (size_t i = s->rings.first[vertex]; i < s->rings.first[vertex + 1]; i++) {
        uint32_t t = s->rings.at[i];
        const uint32_t *v = s->mesh->tetrahedra + 4 * (size_t)t;
        int own = v[0] == vertex ? 0 : v[1] == vertex ? 1 : v[2] == vertex ? 2 : 3;
        if (is_within(s->mesh, t, own, p))
            return t;
    }
    return PAPER_NONE;
}

uint32_t dependency_predecessor(const paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                                int k) {
    size_t corner = 4 * (size_t)tetrahedron + (size_t)k;
    uint32_t toward = g->toward[s->mesh->tetrahedra[corner]];
    if (toward != tetrahedron)
        return toward;
    bool beyond = side_of_face(s->mesh, tetrahedron, k, g->position) < 0;
    return beyond ? s->mesh->neighbours[corner] : PAPER_NONE;
}

int dependency_seen(const paper_state *s, const paper_guard *g, uint32_t tetrahedron) {
    int seen = 0;
    for (size_t k = 0; k < 4; k++)
        seen += g->toward[s->mesh->tetrahedra[4 * (size_t)tetrahedron + k]] != PAPER_NONE;
    return seen;
}
