/* SPDX-License-Identifier: Apache-2.0 */
/* Paths of the guards from A to B, along the guarding graph.
 *
 * Guards whose pieces share an edge are neighbours. A spanning tree of short edges (Prim) is rooted
 * at the guard of the largest piece. Each guard's offset from its parent should rotate with the
 * mean of the two pieces' rotations and gain the rest of its change in proportion to t. Guard
 * positions are solved for together with the vertices (rigid.c), so that neither drags the other
 * along.
 *
 * Cost: O(guards^2 + faces). */

#include "core/bits.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/morph.h"

static const char STAGE[] = "consistent guards";
static const double APART = 1e3; /* added to the length of edges between pieces without contact */

static void add_pieces(starg_morph *m) {
    double total = 0;
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        const uint32_t *c = m->mesh->faces + 3 * f;
        const double *v = m->mesh->vertices;
        guard_path *own = &m->guard_paths[m->pieces[f]];
        double area =
            vec3_triangle_area(v + 3 * (size_t)c[0], v + 3 * (size_t)c[1], v + 3 * (size_t)c[2]);
        vec3_along(own->rotation, area, m->faces[f].rotation, own->rotation);
        own->weight += area;
        total += area;
    }
    for (size_t i = 0; i < m->guard_count; i++) {
        guard_path *own = &m->guard_paths[i];
        for (int k = 0; k < 3 && own->weight > 0; k++)
            own->rotation[k] /= own->weight;
        own->weight /= total;
    }
}

static starg_status find_neighbours(const starg_morph *m, starg_bits **out) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    TRY(topology_create(m->context, m->mesh, &topology));
    TRY(starg_bits_create(m->context, m->guard_count, m->guard_count, out));
    for (size_t h = 0; h < 3 * m->mesh->face_count; h++)
        if (topology->twin[h] != TOPOLOGY_NONE)
            starg_bits_set(*out, m->pieces[h / 3], m->pieces[topology->twin[h] / 3]);
    return STARG_OK;
}

/* Offset and change of a guard from its parent. */
static void attach_guard(starg_morph *m, uint32_t guard, uint32_t parent) {
    guard_path *own = &m->guard_paths[guard], *above = &m->guard_paths[parent];
    double local[9], whole[9], rotation[9], target[3];
    own->parent = parent;
    for (int k = 0; k < 3; k++)
        own->turn[k] = 0.5 * (own->rotation[k] + above->rotation[k]);
    rotation_from_vector(own->turn, local);
    rotation_from_vector(m->turn, whole);
    matrix_multiply(whole, local, rotation);
    vec3_subtract(m->places[0] + 3 * (size_t)guard, m->places[0] + 3 * (size_t)parent, own->offset);
    vec3_subtract(m->places[1] + 3 * (size_t)guard, m->places[1] + 3 * (size_t)parent, target);
    for (int k = 0; k < 3; k++)
        own->change[k] = rotation[k] * target[0] + rotation[3 + k] * target[1] +
                         rotation[6 + k] * target[2] - own->offset[k];
}

static uint32_t largest_piece(const starg_morph *m) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < m->guard_count; i++)
        if (m->guard_paths[i].weight > m->guard_paths[best].weight)
            best = i;
    return best;
}

static starg_status grow_tree(starg_morph *m, const starg_bits *neighbours) {
    SCOPED double *least = NULL;
    SCOPED uint32_t *above = NULL;
    uint32_t last = largest_piece(m);
    NEW(m->context, STAGE, least, m->guard_count);
    NEW(m->context, STAGE, above, m->guard_count);
    for (size_t i = 0; i < m->guard_count; i++)
        least[i] = INFINITY;
    m->guard_paths[last].parent = last;
    for (size_t placed = 1; placed < m->guard_count; placed++) {
        least[last] = -1;
        uint32_t next = UINT32_MAX;
        for (uint32_t i = 0; i < m->guard_count; i++) {
            double length =
                vec3_distance(m->places[0] + 3 * (size_t)i, m->places[0] + 3 * (size_t)last) +
                (starg_bits_test(neighbours, last, i) ? 0 : APART);
            if (least[i] < 0)
                continue;
            if (length < least[i]) {
                least[i] = length;
                above[i] = last;
            }
            if (next == UINT32_MAX || least[i] < least[next])
                next = i;
        }
        attach_guard(m, next, above[next]);
        last = next;
    }
    return STARG_OK;
}

starg_status morph_prepare_guards(starg_morph *m) {
    SCOPED_BY(starg_bits_drop) starg_bits *neighbours = NULL;
    NEW_ZERO(m->context, STAGE, m->guard_paths, m->guard_count);
    add_pieces(m);
    TRY(find_neighbours(m, &neighbours));
    return grow_tree(m, neighbours);
}
