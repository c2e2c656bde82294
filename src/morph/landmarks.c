/* SPDX-License-Identifier: Apache-2.0 */
/* Warps a spherical embedding until its landmarks are met.
 *
 * Stages, repeated: compute the tangent field that moves every landmark towards its counterpart,
 * interpolated by radial functions of Matern type (1 + r) e^-r; move all vertices along the field
 * by at most STEP, less while any triangle would flip; where a triangle blocks even a short step,
 * move each vertex as far as its own triangles allow; then relax for some sweeps with the landmarks
 * fixed. A diffeomorphism of the sphere can map any points to any others; only the resolution
 * limits of relaxation prevent it, so the search gives up after ROUNDS.
 *
 * Invariant: the embedding is valid at all times, by the exact predicate. Cost: per round
 * O(landmarks^3 + landmarks n). */
#include "morph/surface_map.h"

#include "geometry/vec3.h"

static const char STAGE[] = "landmarks";
enum { ROUNDS = 400, PATIENCE = 12, SWEEPS = 3, HALVINGS = 5 };
static const double STEP = 0.12; /* radians */
static const double WIDTH = 0.5; /* of the radial functions */

typedef struct warp {
    sphere *from;
    const sphere *to;
    const landmark_list *marks;
    double *matrix; /* count x (count + 3): radial functions, then displacements, later weights */
    double *before; /* directions before a step */
    uint8_t *pinned;
} warp;

static double *mark_of(const warp *w, size_t i) {
    return w->from->directions + 3 * (size_t)w->marks->from[i];
}

static const double *goal_of(const warp *w, size_t i) {
    return w->to->directions + 3 * (size_t)w->marks->to[i];
}

static double radial(const double x[3], const double y[3]) {
    double r = vec3_distance(x, y) / WIDTH;
    return (1 + r) * exp(-r);
}

/* The tangent vector at x towards y whose length is the angle between them. */
static void towards(const double x[3], const double y[3], double out[3]) {
    double n[3];
    vec3_along(y, -vec3_dot(x, y), x, out);
    vec3_cross(x, y, n);
    double length = vec3_length(out), angle = atan2(vec3_length(n), vec3_dot(x, y));
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? out[k] * angle / length : 0;
}

/* Gaussian elimination with row pivots; false for a singular matrix. */
static bool eliminate(double *m, size_t n, size_t columns) {
    for (size_t j = 0; j < n; j++) {
        size_t pivot = j;
        for (size_t i = j + 1; i < n; i++)
            if (fabs(m[i * columns + j]) > fabs(m[pivot * columns + j]))
                pivot = i;
        if (!(fabs(m[pivot * columns + j]) > 1e-14))
            return false;
        for (size_t k = 0; k < columns; k++) {
            double swap = m[j * columns + k];
            m[j * columns + k] = m[pivot * columns + k];
            m[pivot * columns + k] = swap;
        }
        for (size_t i = 0; i < n; i++) {
            double factor = i == j ? 0 : m[i * columns + j] / m[j * columns + j];
            for (size_t k = j; factor != 0 && k < columns; k++)
                m[i * columns + k] -= factor * m[j * columns + k];
        }
    }
    for (size_t j = 0; j < n; j++)
        for (size_t k = n; k < columns; k++)
            m[j * columns + k] /= m[j * columns + j];
    return true;
}

/* Computes the field's weights; returns the longest displacement, or -1 if two landmarks
 * coincide. */
static double make_field(const warp *w) {
    size_t n = w->marks->count, columns = n + 3;
    double longest = 0;
    for (size_t i = 0; i < n; i++) {
        double *row = w->matrix + i * columns;
        for (size_t j = 0; j < n; j++)
            row[j] = radial(mark_of(w, i), mark_of(w, j));
        towards(mark_of(w, i), goal_of(w, i), row + n);
        longest = fmax(longest, vec3_length(row + n));
    }
    return eliminate(w->matrix, n, columns) ? longest : -1;
}

/* Image of a place after a step along the field. */
static void advance(const warp *w, const double x[3], double step, double out[3]) {
    size_t n = w->marks->count, columns = n + 3;
    double field[3] = {0};
    for (size_t i = 0; i < n; i++)
        vec3_along(field, radial(x, w->before + 3 * (size_t)w->marks->from[i]),
                   w->matrix + i * columns + n, field);
    vec3_along(field, -vec3_dot(field, x), x, field);
    vec3_along(x, step, field, out);
    double length = vec3_length(out);
    for (int k = 0; k < 3; k++)
        out[k] /= length;
}

/* Moves all vertices by the same step; a whole step ends exactly at the goals. */
static bool step_all(warp *w, double step) {
    const sphere *s = w->from;
    for (size_t i = 0; i < s->rings->left; i++) {
        size_t v = s->alive[i];
        advance(w, w->before + 3 * v, step, s->directions + 3 * v);
    }
    for (size_t i = 0; step == 1 && i < w->marks->count; i++)
        vec3_copy(goal_of(w, i), mark_of(w, i));
    if (sphere_is_positive(s))
        return true;
    memcpy(s->directions, w->before, 3 * s->mesh->vertex_count * sizeof *w->before);
    return false;
}

/* Moves each vertex as far as its own triangles allow. */
static bool step_each(warp *w, double step) {
    bool moved = false;
    for (size_t k = 0; k < w->from->rings->left; k++) {
        size_t v = w->from->alive[k];
        double part = step, at[3];
        for (int i = 0; i < HALVINGS; i++, part *= 0.5) {
            advance(w, w->before + 3 * v, part, at);
            if (!relax_is_positive(&w->from->rings->of[v], w->from->directions, at))
                continue;
            vec3_copy(at, w->from->directions + 3 * v);
            moved = moved || w->pinned[v] != 0;
            break;
        }
    }
    return moved;
}

/* One round; `moved` tells whether a landmark moved. */
static starg_status advance_round(warp *w, double longest, bool *moved) {
    size_t size = 3 * w->from->mesh->vertex_count * sizeof *w->before;
    double step = fmin(1, STEP / longest);
    memcpy(w->before, w->from->directions, size);
    *moved = false;
    for (int i = 0; i < HALVINGS && !*moved; i++, step *= 0.5)
        *moved = step_all(w, step);
    if (!*moved)
        *moved = step_each(w, step);
    return sphere_relax(w->from, w->pinned, SWEEPS);
}

static starg_status approach(warp *w, bool *met) {
    int stuck = 0;
    for (int round = 0; round < ROUNDS && stuck < PATIENCE; round++) {
        bool moved;
        double longest = make_field(w);
        *met = longest == 0;
        if (*met || longest < 0)
            break;
        TRY(advance_round(w, longest, &moved));
        stuck = moved ? 0 : stuck + 1;
    }
    return STARG_OK;
}

starg_status landmarks_meet(sphere *from, const sphere *to, const landmark_list *landmarks,
                            bool *met) {
    starg_context *context = from->context;
    starg_status status = STARG_OK;
    warp w = {.from = from, .to = to, .marks = landmarks};
    size_t n = landmarks->count, count = from->mesh->vertex_count;
    *met = n == 0;
    if (*met)
        return STARG_OK;
    STARG_NEW(context, STAGE, w.matrix, n * (n + 3));
    STARG_NEW(context, STAGE, w.before, 3 * count);
    STARG_NEW_ZERO(context, STAGE, w.pinned, count);
    for (size_t i = 0; i < n; i++)
        w.pinned[landmarks->from[i]] = 1;
    STARG_TRY(approach(&w, met));
done:
    RELEASE(w.matrix, w.before, w.pinned);
    return status;
}

starg_status landmarks_contradict(sphere *from, const sphere *to, const landmark_list *landmarks) {
    const warp w = {.from = from, .to = to, .marks = landmarks};
    size_t worst = 0;
    for (size_t i = 1; i < landmarks->count; i++)
        if (vec3_distance(mark_of(&w, i), goal_of(&w, i)) >
            vec3_distance(mark_of(&w, worst), goal_of(&w, worst)))
            worst = i;
    uint64_t vertex = landmarks->from[worst];
    return starg_fail_at(from->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_VERTEX, &vertex, 1,
                         "the landmarks cannot all be satisfied without folding the surface; the "
                         "worst is pair %zu (vertices %u and %u). They may contradict one another, "
                         "or mirror the model: check their order, or omit that pair",
                         worst, landmarks->from[worst], landmarks->to[worst]);
}
