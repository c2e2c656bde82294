/* SPDX-License-Identifier: Apache-2.0 */
/* Shapes as rigid as possible: vertices by least squares [BBA08].
 *
 * Energy: for each face with the wanted Jacobian A(t), the cotangent-weighted squared errors of its
 * three edges, which is the error of its Jacobian within its plane, weighted by area; with guards,
 * for unflipped faces that their guard sees, also the error along the direction from the guard to
 * the face's centroid c, weighted by the face's area over the squared distance: the centroid minus
 * the guard should be A(t) (c - g). Guards are unknowns like vertices; edges of the guarding graph
 * prescribe their offsets (see guard_paths.c), each with the weight of one cotangent.
 *
 * The matrix does not depend on t and is factorized once. It only contains differences; one unknown
 * of each component is fixed, and the component is then translated so that its mean moves straight.
 * The difference to B at t = 1, the non-rigid part of [YL11], is added (residual.c).
 *
 * Cost of a frame: O(faces) and three solves. */

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/morph.h"

static const char STAGE[] = "morph";
static const double LEAST_AREA = 1e-10; /* of a face, relative to its squared longest edge */
static const double TREE_EDGE = 1;      /* weight of an edge of the tree of guards */
enum { FACE_TRIPLETS = 3 * EDGE_TRIPLETS + 16 };

/* ---- system ---- */

/* Half the cotangents of the corners, positive semidefinite for any area above 0, and the anchor's
 * weight. A face in one point has none. */
static void weigh_face(const starg_morph *m, size_t face, double weights[FACE_WEIGHTS]) {
    const uint32_t *corner = m->mesh->faces + 3 * face;
    double e[3][3], n[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        vec3_subtract(m->mesh->vertices + 3 * (size_t)corner[(k + 2) % 3],
                      m->mesh->vertices + 3 * (size_t)corner[(k + 1) % 3], e[k]);
        longest = fmax(longest, vec3_dot(e[k], e[k]));
    }
    vec3_cross(e[0], e[1], n);
    double area = fmax(0.5 * vec3_length(n), LEAST_AREA * longest);
    memset(weights, 0, FACE_WEIGHTS * sizeof *weights);
    if (!(area > 0))
        return;
    for (int k = 0; k < 3; k++)
        weights[k] = -vec3_dot(e[(k + 1) % 3], e[(k + 2) % 3]) / (4 * area);
    if (m->method != STARG_MORPH_STAR || !m->guarded[face] || m->flipped[face])
        return;
    double middle[3];
    morph_centroid(m->mesh->vertices, corner, middle);
    double d = vec3_distance_squared(middle, m->places[0] + 3 * (size_t)m->pieces[face]);
    weights[3] = area / fmax(d, area);
}

/* The quadratic form of w (x_0 / 3 + x_1 / 3 + x_2 / 3 - x_3)^2. */
static triplet *put_anchor(const uint32_t unknowns[4], double w, triplet *next) {
    static const double factors[4] = {1.0 / 3, 1.0 / 3, 1.0 / 3, -1};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            *next++ = (triplet){unknowns[i], unknowns[j], w * factors[i] * factors[j]};
    return next;
}

/* Guards follow the vertices. */
static uint32_t guard_unknown(const starg_morph *m, uint32_t guard) {
    return (uint32_t)m->mesh->vertex_count + guard;
}

static triplet *put_face(const starg_morph *m, size_t face, triplet *next) {
    const uint32_t *corner = m->mesh->faces + 3 * face;
    const double *weights = m->weights + FACE_WEIGHTS * face;
    for (size_t k = 0; k < 3; k++)
        next = triplets_put_edge(corner[(k + 1) % 3], corner[(k + 2) % 3], weights[k], next);
    if (m->method != STARG_MORPH_STAR)
        return next;
    const uint32_t unknowns[4] = {corner[0], corner[1], corner[2],
                                  guard_unknown(m, m->pieces[face])};
    return put_anchor(unknowns, weights[3], next);
}

static triplet *put_guards(const starg_morph *m, triplet *next) {
    for (uint32_t i = 0; i < m->tree_guards; i++)
        if (m->guard_paths[i].parent != i)
            next = triplets_put_edge(guard_unknown(m, i),
                                     guard_unknown(m, m->guard_paths[i].parent), TREE_EDGE, next);
    return next;
}

/* Components are named by their lowest unknown, which is fixed, as is any unknown without
 * weights. */
static starg_status name_parts(starg_morph *m, const triplet *triplets, size_t count) {
    NEW(m->context, STAGE, m->component, m->unknowns);
    sets_make(m->component, m->unknowns);
    for (size_t i = 0; i < count; i++)
        if (triplets[i].value != 0)
            sets_join(m->component, triplets[i].row, triplets[i].column);
    for (uint32_t v = 0; v < m->unknowns; v++)
        m->component[v] = sets_find(m->component, v);
    return STARG_OK;
}

static starg_status make_system(starg_morph *m) {
    size_t faces = m->mesh->face_count, most;
    SCOPED triplet *triplets = NULL;
    triplet *next;
    m->tree_guards = m->method == STARG_MORPH_STAR ? m->guard_count : 0;
    m->unknowns = m->mesh->vertex_count + m->tree_guards;
    most = FACE_TRIPLETS * faces + EDGE_TRIPLETS * m->tree_guards + m->unknowns;
    NEW(m->context, STAGE, m->weights, FACE_WEIGHTS * faces);
    NEW(m->context, STAGE, triplets, most);
    next = triplets;
    for (size_t f = 0; f < faces; f++) {
        weigh_face(m, f, m->weights + FACE_WEIGHTS * f);
        next = put_face(m, f, next);
    }
    next = put_guards(m, next);
    TRY(name_parts(m, triplets, (size_t)(next - triplets)));
    for (uint32_t v = 0; v < m->unknowns; v++)
        *next++ = (triplet){v, v, m->component[v] == v ? 1 : 0};
    return triplets_factorise(m->context, m->unknowns, triplets, (size_t)(next - triplets),
                              &m->system);
}

/* ---- frames ---- */

/* Right-hand sides, concatenated. */
typedef struct sides {
    double *values;
    size_t count;
} sides;

static void add(const sides *s, uint32_t unknown, double factor, const double d[3]) {
    for (size_t c = 0; c < 3; c++)
        s->values[c * s->count + unknown] += factor * d[c];
}

static void rotation_at(const double vector[3], double t, double out[9]) {
    const double w[3] = {t * vector[0], t * vector[1], t * vector[2]};
    rotation_from_vector(w, out);
}

/* R0(t) R(t) */
static void turn_at(const double vector[3], const double whole[9], double t, double out[9]) {
    double local[9];
    rotation_at(vector, t, local);
    matrix_multiply(whole, local, out);
}

/* The wanted edges R0(t) R(t) ((1 - t) I + t S) e and the wanted offset from the guard. */
static void add_face(const starg_morph *m, size_t face, const double whole[9], double t,
                     const sides *s) {
    const face_path *path = &m->faces[face];
    const uint32_t *corner = m->mesh->faces + 3 * face;
    const double *weights = m->weights + FACE_WEIGHTS * face;
    double turn[9], d[3];
    turn_at(path->rotation, whole, t, turn);
    for (int k = 0; k < 3; k++) {
        uint32_t a = corner[(k + 1) % 3], b = corner[(k + 2) % 3];
        double edge[3], stretched[3];
        vec3_subtract(m->mesh->vertices + 3 * (size_t)a, m->mesh->vertices + 3 * (size_t)b, edge);
        matrix_apply(path->stretch, edge, stretched);
        for (int c = 0; c < 3; c++)
            d[c] = (1 - t) * edge[c] + t * stretched[c];
        matrix_apply(turn, d, d);
        add(s, a, weights[k], d);
        add(s, b, -weights[k], d);
    }
    if (m->method != STARG_MORPH_STAR)
        return;
    for (int c = 0; c < 3; c++)
        d[c] = (1 - t) * path->anchor[0][c] + t * path->anchor[1][c];
    matrix_apply(turn, d, d);
    for (int k = 0; k < 3; k++)
        add(s, corner[k], weights[3] / 3, d);
    add(s, guard_unknown(m, m->pieces[face]), -weights[3], d);
}

static void add_guards(const starg_morph *m, const double whole[9], double t, const sides *s) {
    for (uint32_t i = 0; i < m->tree_guards; i++) {
        const guard_path *own = &m->guard_paths[i];
        double turn[9], d[3];
        if (own->parent == i)
            continue;
        turn_at(own->turn, whole, t, turn);
        vec3_along(own->offset, t, own->change, d);
        matrix_apply(turn, d, d);
        add(s, guard_unknown(m, i), TREE_EDGE, d);
        add(s, guard_unknown(m, own->parent), -TREE_EDGE, d);
    }
}

/* Translates every component so that the mean of its unknowns moves straight from A to B. */
static starg_status center_parts(const starg_morph *m, double t, const sides *s) {
    size_t count = m->mesh->vertex_count;
    SCOPED double *sums = NULL;
    NEW_ZERO(m->context, STAGE, sums, 4 * m->unknowns);
    for (size_t v = 0; v < m->unknowns; v++) {
        const double *p = v < count ? m->mesh->vertices + 3 * v : m->places[0] + 3 * (v - count);
        const double *q = v < count ? m->images + 3 * v : m->places[1] + 3 * (v - count);
        double *sum = sums + 4 * (size_t)m->component[v];
        for (size_t c = 0; c < 3; c++)
            sum[c] += (1 - t) * p[c] + t * q[c] - s->values[c * s->count + v];
        sum[3]++;
    }
    for (uint32_t v = 0; v < m->unknowns; v++) {
        const double *sum = sums + 4 * (size_t)m->component[v];
        add(s, v, 1 / sum[3], sum);
    }
    return STARG_OK;
}

/* All unknowns at t; `out` receives the vertices. */
static starg_status rigid_part(const starg_morph *m, double t, double *out) {
    starg_status status = STARG_OK;
    sides s = {.count = m->unknowns};
    double *work = NULL, whole[9];
    STARG_NEW_ZERO(m->context, STAGE, s.values, 3 * s.count);
    STARG_NEW(m->context, STAGE, work, s.count);
    rotation_at(m->turn, t, whole);
    for (size_t f = 0; f < m->mesh->face_count; f++)
        add_face(m, f, whole, t, &s);
    add_guards(m, whole, t, &s);
    for (size_t c = 0; c < 3; c++)
        sparse_solve(m->system, s.values + c * s.count, work);
    STARG_TRY(center_parts(m, t, &s));
    for (size_t v = 0; v < m->mesh->vertex_count; v++)
        for (size_t c = 0; c < 3; c++)
            out[3 * v + c] = s.values[c * s.count + v];
done:
    RELEASE(s.values, work);
    return status;
}

starg_status morph_prepare_rigid(starg_morph *m) {
    size_t size = 3 * m->mesh->vertex_count;
    TRY(make_system(m));
    NEW(m->context, STAGE, m->residual, size);
    TRY(rigid_part(m, 1, m->residual));
    for (size_t i = 0; i < size; i++)
        m->residual[i] = m->images[i] - m->residual[i];
    return morph_part_residual(m);
}

starg_status morph_frame_rigid(const starg_morph *m, double t, double *out) {
    TRY(rigid_part(m, t, out));
    morph_add_residual(m, t, out);
    return STARG_OK;
}
