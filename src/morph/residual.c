/* SPDX-License-Identifier: Apache-2.0 */
/* Residual of the least squares to B at t = 1, and how it is added.
 *
 * In [YL11] all of it is added in proportion to t, which is right where whole limbs move. But where
 * faces are flipped at B (flipped_faces.c), the residual is the fold itself, and half a fold
 * intersects itself too: it must come last. So the residual is split: its smooth part, by one
 * implicit step of diffusion over the surface of A, is added in proportion to t, the rest with a
 * high power of t. Without folds the residual is rounding error and is not split.
 *
 * Cost: one more sparse factorization. */

#include "geometry/vec3.h"
#include "morph/morph.h"

static const char STAGE[] = "morph";
static const double REACH = 0.03;       /* of the diffusion, relative to the larger box */
static const double LEAST_MASS = 1e-18; /* of a vertex whose faces have no area */
enum { LATE = 8 };                      /* the power of t */

static starg_status make_system(const starg_morph *m, double *masses, sparse_factors **out) {
    const starg_mesh *mesh = m->mesh;
    SCOPED triplet *triplets = NULL;
    triplet *next;
    NEW(m->context, STAGE, triplets, 3 * EDGE_TRIPLETS * mesh->face_count + mesh->vertex_count);
    next = triplets;
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *c = mesh->faces + 3 * f;
        double area =
            vec3_triangle_area(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                               mesh->vertices + 3 * (size_t)c[2]);
        for (size_t k = 0; k < 3; k++) {
            masses[c[k]] += area / 3;
            next = triplets_put_edge(c[(k + 1) % 3], c[(k + 2) % 3],
                                     REACH * REACH * m->weights[FACE_WEIGHTS * f + k], next);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        masses[v] = fmax(masses[v], LEAST_MASS);
        *next++ = (triplet){v, v, masses[v]};
    }
    return triplets_factorise(m->context, mesh->vertex_count, triplets, (size_t)(next - triplets),
                              out);
}

starg_status morph_part_residual(starg_morph *m) {
    size_t count = m->mesh->vertex_count;
    SCOPED double *masses = NULL, *values = NULL;
    SCOPED_BY(sparse_drop) sparse_factors *system = NULL;
    if (m->flipped_count == 0)
        return STARG_OK;
    NEW_ZERO(m->context, STAGE, masses, count);
    NEW(m->context, STAGE, values, 2 * count);
    NEW(m->context, STAGE, m->late, 3 * count);
    TRY(make_system(m, masses, &system));
    for (size_t k = 0; k < 3; k++) {
        for (size_t v = 0; v < count; v++)
            values[v] = masses[v] * m->residual[3 * v + k];
        sparse_solve(system, values, values + count);
        for (size_t v = 0; v < count; v++) {
            m->late[3 * v + k] = m->residual[3 * v + k] - values[v];
            m->residual[3 * v + k] = values[v];
        }
    }
    return STARG_OK;
}

void morph_add_residual(const starg_morph *m, double t, double *out) {
    double late = pow(t, LATE);
    for (size_t i = 0; i < 3 * m->mesh->vertex_count; i++)
        out[i] += t * m->residual[i] + (m->late != NULL ? late * m->late[i] : 0);
}
