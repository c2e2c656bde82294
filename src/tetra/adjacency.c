/* SPDX-License-Identifier: Apache-2.0 */
/* Adjacency of tetrahedra across faces.
 *
 * Stages: group faces by their lowest vertex (counting sort) with the other two as key; sort within
 * each vertex; join equal neighbours. Two positive tetrahedra lie on different sides of a face
 * exactly if its vertices have opposite orientation in them, which is combinatorial: no arithmetic
 * here.
 *
 * Cost: O(n log d) for vertices of degree d. */
#include <stdlib.h>

#include "tetra/tetmesh.h"

static const char STAGE[] = "tetrahedra";

/* A face at its lowest vertex: the others in order, its place, and its orientation. */
typedef struct entry {
    uint32_t middle, highest;
    uint32_t face; /* 4 x tetrahedron + opposite vertex; top bit: odd permutation */
} entry;

typedef struct sorted_face {
    uint32_t v[3]; /* ascending */
    bool odd;      /* sorting takes an odd number of swaps */
} sorted_face;

static void order_pair(sorted_face *f, int i, int j) {
    if (f->v[i] <= f->v[j])
        return;
    uint32_t swap = f->v[i];
    f->v[i] = f->v[j];
    f->v[j] = swap;
    f->odd = !f->odd;
}

static sorted_face sort_face(const starg_tetmesh *mesh, size_t face) {
    const uint32_t *v = mesh->tetrahedra + (face & ~(size_t)3);
    const int *k = TETMESH_FACE[face & 3];
    sorted_face f = {{v[k[0]], v[k[1]], v[k[2]]}, false};
    order_pair(&f, 0, 1);
    order_pair(&f, 1, 2);
    order_pair(&f, 0, 1);
    return f;
}

static const uint32_t ODD = UINT32_C(1) << 31;

static uint32_t entry_face(const entry *e) {
    return e->face & ~ODD;
}

static int compare_entries(const void *left, const void *right) {
    const entry *a = left, *b = right;
    if (a->middle != b->middle)
        return a->middle < b->middle ? -1 : 1;
    if (a->highest != b->highest)
        return a->highest < b->highest ? -1 : 1;
    uint32_t i = entry_face(a), j = entry_face(b);
    return (i > j) - (i < j);
}

static bool same_face(const entry *a, const entry *b) {
    return a->middle == b->middle && a->highest == b->highest;
}

/* Counting sort; afterwards the entries of v begin at start[v + 1]. */
static void file_faces(const starg_tetmesh *mesh, size_t *start, entry *entries) {
    size_t faces = 4 * mesh->count;
    for (size_t f = 0; f < faces; f++)
        start[sort_face(mesh, f).v[0] + 1]++;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        start[v + 1] += start[v];
    for (size_t f = faces; f-- > 0;) {
        sorted_face key = sort_face(mesh, f);
        entries[--start[key.v[0] + 1]] =
            (entry){key.v[1], key.v[2], (uint32_t)f | (key.odd ? ODD : 0)};
    }
}

/* Folded: both tetrahedra are on the same side of the face and overlap. */
static starg_status fail_face(const starg_tetmesh *mesh, const entry *first, size_t count) {
    uint64_t tetrahedra[STARG_ERROR_INDICES];
    for (size_t i = 0; i < count && i < STARG_ERROR_INDICES; i++)
        tetrahedra[i] = entry_face(first + i) / 4;
    if (count > 2)
        return starg_fail_at(mesh->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON,
                             tetrahedra, count,
                             "%zu tetrahedra (first: %llu, %llu and %llu) share one face and "
                             "overlap; at most two may share a face",
                             count, (unsigned long long)tetrahedra[0],
                             (unsigned long long)tetrahedra[1], (unsigned long long)tetrahedra[2]);
    return starg_fail_at(mesh->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON,
                         tetrahedra, count,
                         "tetrahedra %llu and %llu lie on the same side of the face that they "
                         "share: they overlap, the mesh is folded there",
                         (unsigned long long)tetrahedra[0], (unsigned long long)tetrahedra[1]);
}

static starg_status join(starg_tetmesh *mesh, const entry *first, size_t count) {
    uint32_t a = entry_face(first), b = count > 1 ? entry_face(first + 1) : a;
    if (count > 2 || (count == 2 && (first[0].face & ODD) == (first[1].face & ODD)))
        return fail_face(mesh, first, count);
    mesh->neighbours[a] = count == 2 ? b / 4 : STARG_TETMESH_NONE;
    if (count == 2)
        mesh->neighbours[b] = a / 4;
    return STARG_OK;
}

static starg_status join_all(starg_tetmesh *mesh, const size_t *start, entry *entries) {
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        size_t low = start[v + 1];
        size_t high = v + 1 < mesh->vertex_count ? start[v + 2] : 4 * mesh->count;
        qsort(entries + low, high - low, sizeof *entries, compare_entries);
        while (low < high) {
            size_t count = 1;
            while (low + count < high && same_face(entries + low, entries + low + count))
                count++;
            TRY(join(mesh, entries + low, count));
            low += count;
        }
    }
    return STARG_OK;
}

starg_status tetmesh_connect(starg_tetmesh *mesh) {
    SCOPED size_t *start = NULL;
    SCOPED entry *entries = NULL;
    NEW(mesh->context, STAGE, mesh->neighbours, 4 * mesh->count);
    NEW_ZERO(mesh->context, STAGE, start, mesh->vertex_count + 2);
    NEW(mesh->context, STAGE, entries, 4 * mesh->count);
    file_faces(mesh, start, entries);
    return join_all(mesh, start, entries);
}
