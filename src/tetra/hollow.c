/* SPDX-License-Identifier: Apache-2.0 */
/* Detects surfaces that enclose nothing.
 *
 * Problem: some meshes have winding number at most 1/2 everywhere: planar ones, and those whose
 * every face has a counterpart of opposite orientation. A lattice would be refined until memory
 * runs out.
 *
 * Stages: find three non-collinear positions and test all others against their plane; then sort the
 * faces as triples of positions with the sign of the permutation: the signs of equal triples must
 * sum to zero.
 *
 * Invariants: uses positions, not vertex numbers; both decisions are exact. Cost: O(faces log
 * faces). */
#include "tetra/generate.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const double *corner(const starg_mesh *mesh, size_t i) {
    return mesh->vertices + 3 * (size_t)mesh->faces[i];
}

static bool is_flat(const starg_mesh *mesh) {
    size_t count = 3 * mesh->face_count, first = 0;
    while (first < count &&
           collinear(corner(mesh, first), corner(mesh, first + 1), corner(mesh, first + 2)))
        first += 3;
    if (first == count)
        return true;
    for (size_t i = 0; i < count; i++)
        if (orient3d(corner(mesh, first), corner(mesh, first + 1), corner(mesh, first + 2),
                     corner(mesh, i)) != 0)
            return false;
    return true;
}

typedef struct place_triple {
    double at[9]; /* three positions, ascending */
    int sign;     /* of the permutation */
} place_triple;

static int compare_places(const double *a, const double *b, size_t count) {
    for (size_t k = 0; k < count; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_triples(const void *a, const void *b) {
    return compare_places(((const place_triple *)a)->at, ((const place_triple *)b)->at, 9);
}

static void put_in_order(place_triple *t, double *a, double *b) {
    double before[3];
    if (compare_places(a, b, 3) <= 0)
        return;
    vec3_copy(a, before);
    vec3_copy(b, a);
    vec3_copy(before, b);
    t->sign = -t->sign;
}

static void load_triple(const starg_mesh *mesh, size_t face, place_triple *out) {
    out->sign = 1;
    for (size_t k = 0; k < 3; k++)
        vec3_copy(corner(mesh, 3 * face + k), out->at + 3 * k);
    put_in_order(out, out->at, out->at + 3);
    put_in_order(out, out->at + 3, out->at + 6);
    put_in_order(out, out->at, out->at + 3);
    if (compare_places(out->at, out->at + 3, 3) == 0 ||
        compare_places(out->at + 3, out->at + 6, 3) == 0)
        out->sign = 0;
}

starg_status tetra_is_hollow(starg_context *context, const starg_mesh *mesh, bool *hollow) {
    SCOPED place_triple *triples = NULL;
    size_t count = mesh->face_count;
    *hollow = is_flat(mesh);
    if (*hollow)
        return STARG_OK;
    NEW(context, TETRA_STAGE, triples, count);
    for (size_t f = 0; f < count; f++)
        load_triple(mesh, f, &triples[f]);
    qsort(triples, count, sizeof *triples, compare_triples);
    *hollow = true;
    for (size_t i = 0, next; i < count && *hollow; i = next) {
        int sum = 0;
        for (next = i; next < count && compare_triples(&triples[i], &triples[next]) == 0; next++)
            sum += triples[next].sign;
        *hollow = sum == 0;
    }
    return STARG_OK;
}
