/* SPDX-License-Identifier: Apache-2.0 */
/* Faces that the map flips, and their paths from A to B.
 *
 * Problem: where A's triangles are coarse for B's shape, B in A's connectivity intersects itself.
 * Faces there rotate and stretch arbitrarily, as the fold happens to lie, and would intersect long
 * before the end.
 *
 * Stages: faces that intersect others in B but not in A, with some rings around them, are called
 * flipped; their rotation vectors and stretches become harmonic on the graph of faces, with the
 * values of the faces around them. So the least squares transport A's shape with its surroundings
 * there. The remaining difference to B is part of the residual, and is added last (residual.c).
 *
 * Cost: two checks of a surface and a sparse system of the flipped faces. */

#include "mesh/examine.h"
#include "mesh/topology.h"
#include "morph/morph.h"

static const char STAGE[] = "morph";
enum {
    RINGS = 2,  /* around intersecting faces */
    PARTS = 12, /* numbers of a path: rotation and stretch */
    FACE_TRIPLETS = 7
};
static const double OWN = 1e-6; /* weight of a face's own path: decides if nothing is around */

#define NONE UINT32_MAX

/* ---- which ---- */

/* Marks the faces that intersect at one end with a value. */
static starg_status mark(const starg_morph *m, const double *positions, uint8_t value) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED_BY(starg_check_drop) starg_check *check = NULL;
    TRY(starg_mesh_create(m->context, positions, m->mesh->vertex_count, m->mesh->faces,
                          m->mesh->face_count, &mesh));
    TRY(starg_mesh_check(m->context, mesh, &check));
    for (size_t f = 0; f < m->mesh->face_count; f++)
        if (check->face_marks[f] == 1 + STARG_FINDING_SELF_INTERSECTION)
            m->flipped[f] = value;
    return STARG_OK;
}

/* Adds the faces that share a vertex with a flipped one. */
static starg_status widen(starg_morph *m) {
    SCOPED uint8_t *touched = NULL;
    NEW_ZERO(m->context, STAGE, touched, m->mesh->vertex_count);
    for (size_t i = 0; i < 3 * m->mesh->face_count; i++)
        if (m->flipped[i / 3])
            touched[m->mesh->faces[i]] = 1;
    for (size_t i = 0; i < 3 * m->mesh->face_count; i++)
        if (touched[m->mesh->faces[i]])
            m->flipped[i / 3] = 1;
    return STARG_OK;
}

/* Numbers the flipped faces. */
static starg_status find_flipped(starg_morph *m, uint32_t **number, size_t *count) {
    NEW_ZERO(m->context, STAGE, m->flipped, m->mesh->face_count);
    NEW(m->context, STAGE, *number, m->mesh->face_count);
    TRY(mark(m, m->images, 1));
    TRY(mark(m, m->mesh->vertices, 0));
    for (int ring = 0; ring < RINGS; ring++)
        TRY(widen(m));
    for (size_t f = 0; f < m->mesh->face_count; f++)
        (*number)[f] = m->flipped[f] ? (uint32_t)(*count)++ : NONE;
    return STARG_OK;
}

/* ---- filling ---- */

typedef struct filling {
    starg_morph *m;
    const mesh_topology *topology;
    const uint32_t *number; /* per face, NONE for given ones */
    size_t count;
} filling;

static double *part_of(const filling *f, size_t face, int part) {
    face_path *path = &f->m->faces[face];
    return part < 3 ? &path->rotation[part] : &path->stretch[part - 3];
}

static starg_status make_system(const filling *f, sparse_factors **out) {
    SCOPED triplet *triplets = NULL;
    triplet *next;
    NEW(f->m->context, STAGE, triplets, FACE_TRIPLETS * f->count);
    next = triplets;
    for (size_t h = 0; h < 3 * f->m->mesh->face_count; h++) {
        uint32_t own = f->number[h / 3], twin = f->topology->twin[h];
        if (own == NONE)
            continue;
        if (h % 3 == 0)
            *next++ = (triplet){own, own, OWN};
        if (twin == TOPOLOGY_NONE)
            continue;
        *next++ = (triplet){own, own, 1};
        if (f->number[twin / 3] != NONE)
            *next++ = (triplet){own, f->number[twin / 3], -1};
    }
    return triplets_factorise(f->m->context, f->count, triplets, (size_t)(next - triplets), out);
}

/* Sums the given values around the flipped faces, and a little of their own. */
static void sum_given(const filling *f, int part, double *sums) {
    memset(sums, 0, f->count * sizeof *sums);
    for (size_t h = 0; h < 3 * f->m->mesh->face_count; h++) {
        uint32_t own = f->number[h / 3], twin = f->topology->twin[h];
        if (own == NONE)
            continue;
        if (h % 3 == 0)
            sums[own] += OWN * *part_of(f, h / 3, part);
        if (twin != TOPOLOGY_NONE && f->number[twin / 3] == NONE)
            sums[own] += *part_of(f, twin / 3, part);
    }
}

static starg_status fill(const filling *f) {
    SCOPED double *values = NULL;
    SCOPED_BY(sparse_drop) sparse_factors *system = NULL;
    NEW(f->m->context, STAGE, values, 2 * f->count);
    TRY(make_system(f, &system));
    for (int part = 0; part < PARTS; part++) {
        sum_given(f, part, values);
        sparse_solve(system, values, values + f->count);
        for (size_t face = 0; face < f->m->mesh->face_count; face++)
            if (f->number[face] != NONE)
                *part_of(f, face, part) = values[f->number[face]];
    }
    return STARG_OK;
}

starg_status morph_fill_flipped(starg_morph *m) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED uint32_t *number = NULL;
    TRY(find_flipped(m, &number, &m->flipped_count));
    if (m->flipped_count == 0)
        return STARG_OK;
    TRY(topology_create(m->context, m->mesh, &topology));
    return fill(&(filling){m, topology, number, m->flipped_count});
}
