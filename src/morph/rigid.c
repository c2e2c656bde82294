/* Shapes that are as rigid as possible: vertices by least squares [BBA08].
 *
 * Energy: for each face with the wanted Jacobian A(t), its cotangents times the squared errors of
 * its three edges, which is the error of its Jacobian within its plane, weighted by area; with
 * guards also the error along the direction from the guard to the face's middle c, weighted by the
 * face's area over the square of that distance: the middle shall be at g(t) + A(t) (c - g), with
 * which the piece holds on to its guard.
 *
 * The matrix does not depend on t: it is factorised once. Without guards it knows differences
 * only; a vertex of each part is held, and the part is then moved so that its mean goes straight.
 * What is missing to B at t = 1 is added in proportion to t: the non-rigid part of [YL11].
 *
 * Cost of a frame: O(faces) and three solutions with the factor. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/morph.h"
#include "morph/rotation.h"

static const char STAGE[] = "morph";
static const double LEAST_AREA = 1e-10; /* of a face, to the square of its longest edge */
enum { FACE_ENTRIES = 9, WEIGHTS = 4 };

/* ---- system ---- */

static void middle_of(const double *positions, const uint32_t corner[3], double out[3]) {
    for (size_t k = 0; k < 3; k++)
        out[k] = (positions[3 * (size_t)corner[0] + k] + positions[3 * (size_t)corner[1] + k] +
                  positions[3 * (size_t)corner[2] + k]) /
                 3;
}

/* Half the cotangents of the corners, which make a positive form for any area above 0, and the
 * anchor's weight. A face in one point has none. */
static void weigh_face(const starg_morph *m, size_t face, double weights[WEIGHTS]) {
    const uint32_t *corner = m->mesh->faces + 3 * face;
    double e[3][3], n[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        vec3_subtract(m->mesh->vertices + 3 * (size_t)corner[(k + 2) % 3],
                      m->mesh->vertices + 3 * (size_t)corner[(k + 1) % 3], e[k]);
        longest = fmax(longest, vec3_dot(e[k], e[k]));
    }
    vec3_cross(e[0], e[1], n);
    double area = fmax(0.5 * vec3_length(n), LEAST_AREA * longest);
    memset(weights, 0, WEIGHTS * sizeof *weights);
    if (!(area > 0))
        return;
    for (int k = 0; k < 3; k++)
        weights[k] = -vec3_dot(e[(k + 1) % 3], e[(k + 2) % 3]) / (4 * area);
    if (m->method != STARG_MORPH_STAR)
        return;
    double middle[3];
    middle_of(m->mesh->vertices, corner, middle);
    double d = vec3_distance_squared(middle, m->places[0] + 3 * (size_t)m->pieces[face]);
    weights[3] = area / fmax(d, area);
}

static void put_face(const uint32_t corner[3], const double weights[WEIGHTS],
                     matrix_entry *entries) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double value = weights[3] / 9;
            value += i == j ? weights[(i + 1) % 3] + weights[(i + 2) % 3] : -weights[3 - i - j];
            *entries++ = (matrix_entry){corner[i], corner[j], value};
        }
}

/* One vertex of each connected part, and all that no weight holds, stay where they are put. */
static void hold_parts(const starg_morph *m, matrix_entry *entries) {
    bool free_parts = m->method != STARG_MORPH_STAR;
    for (uint32_t v = 0; v < m->mesh->vertex_count; v++) {
        bool held = m->loose[v] || (free_parts && m->component[v] == v);
        entries[v] = (matrix_entry){v, v, held ? 1 : 0};
    }
}

static starg_status name_parts(starg_morph *m) {
    starg_status status = STARG_OK;
    size_t count = m->mesh->vertex_count;
    STARG_NEW(m->context, STAGE, m->component, count);
    sets_make(m->component, count);
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        if (m->weights[WEIGHTS * f] == 0 && m->weights[WEIGHTS * f + 1] == 0 &&
            m->weights[WEIGHTS * f + 2] == 0)
            continue;
        const uint32_t *corner = m->mesh->faces + 3 * f;
        sets_join(m->component, corner[0], corner[1]);
        sets_join(m->component, corner[1], corner[2]);
    }
    for (uint32_t v = 0; v < count; v++)
        m->component[v] = sets_find(m->component, v);
done:
    return status;
}

static starg_status make_system(starg_morph *m) {
    starg_status status = STARG_OK;
    size_t faces = m->mesh->face_count, vertices = m->mesh->vertex_count;
    matrix_entry *entries = NULL;
    STARG_NEW(m->context, STAGE, m->weights, WEIGHTS * faces);
    STARG_NEW(m->context, STAGE, entries, FACE_ENTRIES * faces + vertices);
    STARG_NEW(m->context, STAGE, m->loose, vertices);
    memset(m->loose, 1, vertices);
    for (size_t f = 0; f < faces; f++) {
        weigh_face(m, f, m->weights + WEIGHTS * f);
        put_face(m->mesh->faces + 3 * f, m->weights + WEIGHTS * f, entries + FACE_ENTRIES * f);
        for (size_t k = 0; k < 3; k++)
            if (entries[FACE_ENTRIES * f + 4 * k].value > 0)
                m->loose[m->mesh->faces[3 * f + k]] = 0;
    }
    STARG_TRY(name_parts(m));
    hold_parts(m, entries + FACE_ENTRIES * faces);
    STARG_TRY(cholesky_create(m->context, vertices, entries, FACE_ENTRIES * faces + vertices,
                              &m->system));
done:
    starg_release(m->context, entries);
    return status;
}

/* ---- frames ---- */

/* A(t) = R0(t) R(t) ((1 - t) I + t S) */
static void wanted_jacobian(const face_path *path, const double whole[9], double t, double out[9]) {
    double w[3], r[9], stretch[9], local[9];
    for (int k = 0; k < 3; k++)
        w[k] = t * path->rotation[k];
    rotation_from_vector(w, r);
    for (int k = 0; k < 9; k++)
        stretch[k] = t * path->stretch[k] + (k % 4 == 0 ? 1 - t : 0);
    matrix_multiply(r, stretch, local);
    matrix_multiply(whole, local, out);
}

/* `sides` holds the three right-hand sides one behind the other. */
static void add_face(const starg_morph *m, size_t face, const double jacobian[9],
                     const double *guards, double *sides) {
    const uint32_t *corner = m->mesh->faces + 3 * face;
    const double *weights = m->weights + WEIGHTS * face;
    size_t count = m->mesh->vertex_count;
    for (int k = 0; k < 3; k++) {
        uint32_t a = corner[(k + 1) % 3], b = corner[(k + 2) % 3];
        double edge[3];
        vec3_subtract(m->mesh->vertices + 3 * (size_t)a, m->mesh->vertices + 3 * (size_t)b, edge);
        matrix_apply(jacobian, edge, edge);
        for (size_t c = 0; c < 3; c++) {
            sides[c * count + a] += weights[k] * edge[c];
            sides[c * count + b] -= weights[k] * edge[c];
        }
    }
    if (guards == NULL)
        return;
    double place[3];
    size_t guard = m->pieces[face];
    middle_of(m->mesh->vertices, corner, place);
    vec3_subtract(place, m->places[0] + 3 * guard, place);
    matrix_apply(jacobian, place, place);
    vec3_along(guards + 3 * guard, 1, place, place);
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            sides[c * count + corner[k]] += weights[3] / 3 * place[c];
}

/* Moves every part so that the mean of its vertices goes straight from A to B. */
static starg_status center_parts(const starg_morph *m, double t, double *out) {
    starg_status status = STARG_OK;
    size_t count = m->mesh->vertex_count;
    double *sums = NULL;
    STARG_NEW_ZERO(m->context, STAGE, sums, 4 * count);
    for (size_t v = 0; v < count; v++) {
        double *sum = sums + 4 * (size_t)m->component[v];
        for (size_t k = 0; k < 3; k++)
            sum[k] +=
                (1 - t) * m->mesh->vertices[3 * v + k] + t * m->images[3 * v + k] - out[3 * v + k];
        sum[3]++;
    }
    for (size_t v = 0; v < count; v++) {
        const double *sum = sums + 4 * (size_t)m->component[v];
        vec3_along(out + 3 * v, 1 / sum[3], sum, out + 3 * v);
    }
done:
    starg_release(m->context, sums);
    return status;
}

static starg_status solve(const starg_morph *m, double t, const double *guards, double *out) {
    starg_status status = STARG_OK;
    size_t count = m->mesh->vertex_count;
    double *sides = NULL, *work = NULL, w[3], whole[9];
    STARG_NEW_ZERO(m->context, STAGE, sides, 3 * count);
    STARG_NEW(m->context, STAGE, work, count);
    for (int k = 0; k < 3; k++)
        w[k] = t * m->turn[k];
    rotation_from_vector(w, whole);
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        double jacobian[9];
        wanted_jacobian(&m->faces[f], whole, t, jacobian);
        add_face(m, f, jacobian, guards, sides);
    }
    for (size_t v = 0; v < count; v++)
        for (size_t c = 0; c < 3 && m->loose[v]; c++)
            sides[c * count + v] =
                (1 - t) * m->mesh->vertices[3 * v + c] + t * m->images[3 * v + c];
    for (size_t c = 0; c < 3; c++) {
        cholesky_solve(m->system, sides + c * count, work);
        for (size_t v = 0; v < count; v++)
            out[3 * v + c] = sides[c * count + v];
    }
done:
    starg_release(m->context, sides);
    starg_release(m->context, work);
    return status;
}

static starg_status rigid_part(const starg_morph *m, double t, double *out) {
    starg_status status = STARG_OK;
    double *guards = NULL;
    if (m->method == STARG_MORPH_STAR) {
        STARG_NEW(m->context, STAGE, guards, 3 * m->guard_count);
        morph_guards_at(m, t, guards);
    }
    STARG_TRY(solve(m, t, guards, out));
    if (m->method != STARG_MORPH_STAR)
        STARG_TRY(center_parts(m, t, out));
done:
    starg_release(m->context, guards);
    return status;
}

starg_status morph_prepare_rigid(starg_morph *m) {
    starg_status status = STARG_OK;
    size_t size = 3 * m->mesh->vertex_count;
    STARG_TRY(make_system(m));
    STARG_NEW(m->context, STAGE, m->remainder, size);
    STARG_TRY(rigid_part(m, 1, m->remainder));
    for (size_t i = 0; i < size; i++)
        m->remainder[i] = m->images[i] - m->remainder[i];
done:
    return status;
}

starg_status morph_frame_rigid(const starg_morph *m, double t, double *out) {
    starg_status status = STARG_OK;
    STARG_TRY(rigid_part(m, t, out));
    for (size_t i = 0; i < 3 * m->mesh->vertex_count; i++)
        out[i] += t * m->remainder[i];
done:
    return status;
}
