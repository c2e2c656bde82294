/* SPDX-License-Identifier: Apache-2.0 */
/* Rotation and stretch of each face on its way from A to B [ACOL00; YL11, section 5.2].
 *
 * Stages: the rotation R0 that brings the whole of A closest to B; for each face the Jacobian J of
 * the affine map between its two shapes, relative to the two guards of its piece, or, if there are
 * none, they do not see it, or see it at a grazing angle, with its normals; the polar decomposition
 * R0^T J = R S; the rotation vectors of R.
 *
 * A rotation has many vectors, which differ by whole turns. Neighbours must rotate the same way, or
 * the surface tears between them: vectors are fixed face by face along a spanning tree of the dual
 * graph, most similar neighbours first (Prim), each nearest to that of the previous face. Angles
 * beyond pi are then possible: a limb may rotate by more than pi against the trunk. Where faces of
 * a poor map rotate wildly, the tree can wind a limb around a fold that does not rotate: vectors
 * shorter than pi are used instead if they tear less over all edges.
 *
 * Cost: O(faces log faces). */

#include "geometry/vec3.h"
#include "mesh/levels/heap.h"
#include "mesh/topology.h"
#include "morph/morph.h"

static const char STAGE[] = "morph";
static const double GRAZING = 0.6; /* least sine of the angle at which a guard sees a face */

/* ---- Jacobians ---- */

/* inverse of m by cofactors; false if singular */
static bool invert(const double m[9], double out[9]) {
    double c[9];
    for (int i = 0; i < 3; i++) {
        const double *p = m + 3 * ((i + 1) % 3), *q = m + 3 * ((i + 2) % 3);
        vec3_cross(p, q, c + 3 * i);
    }
    double det = vec3_dot(m, c);
    if (!(fabs(det) > 0))
        return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[3 * i + k] = c[3 * k + i] / det;
    return isfinite(1 / det);
}

/* The corners of a face at one end, relative to a point, as columns. */
static void corners_about(const double *positions, const uint32_t corner[3], const double about[3],
                          double out[9]) {
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++)
            out[3 * k + j] = positions[3 * (size_t)corner[j] + (size_t)k] - about[k];
}

/* Two edges, and the normal scaled to the square root of twice the area, as columns. */
static void frame_of(const double *positions, const uint32_t corner[3], double out[9]) {
    const double *p = positions + 3 * (size_t)corner[0];
    double u[3], v[3], n[3];
    vec3_subtract(positions + 3 * (size_t)corner[1], p, u);
    vec3_subtract(positions + 3 * (size_t)corner[2], p, v);
    vec3_cross(u, v, n);
    double length = sqrt(vec3_length(n));
    for (int k = 0; k < 3; k++) {
        out[3 * k] = u[k];
        out[3 * k + 1] = v[k];
        out[3 * k + 2] = length > 0 ? n[k] / length : 0;
    }
}

/* Does the point see the face at a good angle? */
static bool sees_well(const double *positions, const uint32_t corner[3], const double at[3]) {
    const double *p = positions + 3 * (size_t)corner[0];
    double n[3], d[3];
    vec3_triangle_normal(p, positions + 3 * (size_t)corner[1], positions + 3 * (size_t)corner[2],
                         n);
    vec3_subtract(p, at, d);
    return vec3_dot(n, d) > GRAZING * vec3_length(n) * vec3_length(d);
}

/* False if the face has no extent at the source. */
static bool jacobian(const starg_morph *m, size_t face, double out[9]) {
    const uint32_t *corner = m->mesh->faces + 3 * face;
    const double *source = m->mesh->vertices;
    double p[9], q[9], inverse[9];
    if (m->guard_count > 0 && m->guarded[face]) {
        const double *g = m->places[0] + 3 * (size_t)m->pieces[face];
        const double *h = m->places[1] + 3 * (size_t)m->pieces[face];
        if (sees_well(source, corner, g) && sees_well(m->images, corner, h)) {
            corners_about(source, corner, g, p);
            corners_about(m->images, corner, h, q);
            if (invert(p, inverse)) {
                matrix_multiply(q, inverse, out);
                return true;
            }
        }
    }
    frame_of(source, corner, p);
    frame_of(m->images, corner, q);
    if (!invert(p, inverse))
        return false;
    matrix_multiply(q, inverse, out);
    return true;
}

/* ---- global rotation ---- */

static void mean_of(const double *positions, size_t count, double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (size_t v = 0; v < count; v++)
        vec3_along(out, 1 / (double)count, positions + 3 * v, out);
}

static void whole_rotation(const starg_morph *m, double out[9]) {
    double from[3], to[3], sum[9] = {0};
    size_t count = m->mesh->vertex_count;
    mean_of(m->mesh->vertices, count, from);
    mean_of(m->images, count, to);
    for (size_t v = 0; v < count; v++) {
        double p[3], q[3];
        vec3_subtract(m->mesh->vertices + 3 * v, from, p);
        vec3_subtract(m->images + 3 * v, to, q);
        for (int k = 0; k < 9; k++)
            sum[k] += q[k / 3] * p[k % 3];
    }
    polar_rotation(sum, out);
}

/* ---- faces ---- */

/* From the guard to the face's middle at one end. */
static void offset_of(const starg_morph *m, size_t face, int end, double out[3]) {
    const double *positions = end ? m->images : m->mesh->vertices;
    const double *guard = m->places[end] + 3 * (size_t)m->pieces[face];
    for (size_t k = 0; k < 3; k++) {
        double sum = 0;
        for (size_t j = 0; j < 3; j++)
            sum += positions[3 * (size_t)m->mesh->faces[3 * face + j] + k];
        out[k] = sum / 3 - guard[k];
    }
}

static void decompose(const starg_morph *m, const double whole[9], size_t face, face_path *path) {
    double j[9], local[9], r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, turn[9], back[9];
    *path = (face_path){.stretch = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    if (jacobian(m, face, j)) {
        matrix_multiply_transposed(whole, j, local);
        polar_rotation(local, r);
        matrix_multiply_transposed(r, local, path->stretch);
        rotation_to_vector(r, path->rotation);
    }
    if (m->guard_count == 0)
        return;
    offset_of(m, face, 0, path->anchor[0]);
    offset_of(m, face, 1, path->anchor[1]);
    matrix_multiply(whole, r, turn);
    for (int k = 0; k < 9; k++)
        back[k] = turn[3 * (k % 3) + k / 3];
    matrix_apply(back, path->anchor[1], path->anchor[1]);
}

/* The angle between two faces' rotations. */
static double angle_between(const face_path *a, const face_path *b) {
    double near[3];
    vec3_copy(b->rotation, near);
    rotation_vector_near(a->rotation, near);
    return vec3_distance(a->rotation, near);
}

static size_t least_rotated(const starg_morph *m, const uint8_t *fixed) {
    size_t best = m->mesh->face_count;
    double least = INFINITY;
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        double angle = vec3_length(m->faces[f].rotation);
        if (!fixed[f] && angle < least) {
            least = angle;
            best = f;
        }
    }
    return best;
}

typedef struct prim {
    mesh_heap *heap;
    double *keys;
    uint32_t *before;
    uint8_t *fixed;
} prim;

static void offer_neighbours(const starg_morph *m, const mesh_topology *topology, prim *p,
                             uint32_t face) {
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++) {
        if (topology->twin[h] == TOPOLOGY_NONE)
            continue;
        uint32_t other = topology->twin[h] / 3;
        double key = angle_between(&m->faces[face], &m->faces[other]);
        if (p->fixed[other] || !(key < p->keys[other]))
            continue;
        p->keys[other] = key;
        p->before[other] = face;
        heap_set(p->heap, other, key);
    }
}

static void unwrap_part(starg_morph *m, const mesh_topology *topology, prim *p, uint32_t first) {
    uint32_t face = first;
    p->fixed[first] = 1;
    offer_neighbours(m, topology, p, first);
    while (heap_pop(p->heap, &face)) {
        p->fixed[face] = 1;
        rotation_vector_near(m->faces[p->before[face]].rotation, m->faces[face].rotation);
        offer_neighbours(m, topology, p, face);
    }
}

static starg_status unwrap(starg_morph *m) {
    starg_status status = STARG_OK;
    mesh_topology *topology = NULL;
    prim p = {0};
    size_t count = m->mesh->face_count, parts = 0;
    STARG_TRY(topology_create(m->context, m->mesh, &topology));
    STARG_TRY(heap_create(m->context, count, &p.heap));
    STARG_NEW(m->context, STAGE, p.keys, count);
    STARG_NEW(m->context, STAGE, p.before, count);
    STARG_NEW_ZERO(m->context, STAGE, p.fixed, count);
    for (size_t f = 0; f < count; f++)
        p.keys[f] = INFINITY;
    for (size_t f = 0; f < count; f++) {
        if (p.fixed[f])
            continue;
        size_t first = parts++ == 0 ? least_rotated(m, p.fixed) : f;
        unwrap_part(m, topology, &p, (uint32_t)first);
        if (!p.fixed[f])
            unwrap_part(m, topology, &p, (uint32_t)f);
    }
done:
    topology_free(topology);
    heap_free(p.heap);
    RELEASE(p.keys, p.before, p.fixed);
    return status;
}

/* Length-weighted difference of rotation vectors across edges. */
static double variation(const starg_morph *m, const mesh_topology *topology,
                        const double *vectors) {
    double sum = 0;
    for (uint32_t h = 0; h < 3 * m->mesh->face_count; h++) {
        uint32_t twin = topology->twin[h];
        if (twin == TOPOLOGY_NONE || twin < h)
            continue;
        const double *p = m->mesh->vertices + 3 * (size_t)m->mesh->faces[h];
        const double *q = m->mesh->vertices + 3 * (size_t)m->mesh->faces[corner_next(h)];
        sum += vec3_distance(p, q) *
               vec3_distance(vectors + 3 * (size_t)(h / 3), vectors + 3 * (size_t)(twin / 3));
    }
    return sum;
}

/* Uses the shortest vectors if those along the tree tear more. */
static starg_status keep_smoother(starg_morph *m) {
    static const double zero[3];
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED double *along = NULL, *shortest = NULL;
    size_t count = m->mesh->face_count;
    TRY(topology_create(m->context, m->mesh, &topology));
    NEW(m->context, STAGE, along, 3 * count);
    NEW(m->context, STAGE, shortest, 3 * count);
    for (size_t f = 0; f < count; f++) {
        vec3_copy(m->faces[f].rotation, along + 3 * f);
        vec3_copy(m->faces[f].rotation, shortest + 3 * f);
        rotation_vector_near(zero, shortest + 3 * f);
    }
    if (variation(m, topology, shortest) < variation(m, topology, along))
        for (size_t f = 0; f < count; f++)
            vec3_copy(shortest + 3 * f, m->faces[f].rotation);
    return STARG_OK;
}

starg_status morph_prepare_faces(starg_morph *m) {
    double whole[9];
    NEW(m->context, STAGE, m->faces, m->mesh->face_count);
    whole_rotation(m, whole);
    rotation_to_vector(whole, m->turn);
    for (size_t f = 0; f < m->mesh->face_count; f++)
        decompose(m, whole, f, &m->faces[f]);
    TRY(unwrap(m));
    return keep_smoother(m);
}
