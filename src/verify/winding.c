/* SPDX-License-Identifier: Apache-2.0 */
/* Winding number by the crossings of a segment from p to a random point outside the bounds: plus
 * one where it leaves through a face, minus one where it enters. All by exact signs. A segment that
 * meets a face other than in its interior is replaced by another one, from a growing range, so that
 * models with very few representable points (subnormal ones) leave room for directions as well;
 * almost every direction is good. */

#include "core/rng.h"
#include "verify/signs.h"
#include "verify/surface.h"

enum { RNG_STAGE = 0x77696e64 };

static const double FARTHEST = 1e101; /* limit of the exact signs */

static bool in_bounds(const verify_surface *surface, const double p[3]) {
    for (int k = 0; k < 3; k++)
        if (!(surface->lower[k] <= p[k] && p[k] <= surface->upper[k]))
            return false;
    return true;
}

static void outside_point(const verify_surface *surface, uint64_t attempt, double q[3]) {
    starg_rng rng = starg_rng_make(0, RNG_STAGE, attempt);
    double extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, surface->upper[k] - surface->lower[k]);
    int growth = attempt < 1000 ? 2 * (int)attempt + 4 : 2004;
    double reach = fmin(ldexp(extent, growth), FARTHEST);
    for (int k = 0; k < 3; k++)
        q[k] = surface->lower[k] + reach * (2 * starg_rng_unit(&rng) - 1);
    size_t axis = (size_t)starg_rng_below(&rng, 3);
    q[axis] = fmax(surface->upper[axis] + reach, nextafter(surface->upper[axis], INFINITY));
}

/* Adds the crossing of [p, q] with t, on which neither end lies; false if it grazes t. */
static bool add_crossing(const double p[3], const double q[3], const double *const t[3],
                         int *winding) {
    int p_side = verify_side(t[0], t[1], t[2], p), q_side = verify_side(t[0], t[1], t[2], q);
    if (p_side * q_side > 0)
        return true;
    if (p_side * q_side == 0)
        return !verify_blocks(p, q, t);
    int plus = 0, minus = 0;
    for (int i = 0; i < 3; i++) {
        int side = verify_side(p, q, t[i], t[(i + 1) % 3]);
        plus += side > 0;
        minus += side < 0;
    }
    if (plus == 3 || minus == 3)
        *winding += p_side;
    return plus == 3 || minus == 3 || (plus != 0 && minus != 0);
}

static bool count_crossings(const verify_surface *surface, const uint32_t *faces, size_t count,
                            const double p[3], const double q[3], int *winding) {
    *winding = 0;
    for (size_t i = 0; i < count; i++) {
        const double *t[3];
        verify_corners(surface, faces != NULL ? faces[i] : i, t);
        if (!add_crossing(p, q, t, winding))
            return false;
    }
    return true;
}

int verify_winding(const verify_surface *surface, const uint32_t *faces, size_t count,
                   const double p[3], bool *on_surface) {
    *on_surface = false;
    if (!in_bounds(surface, p))
        return 0;
    for (size_t i = 0; i < count && !*on_surface; i++) {
        const double *t[3];
        verify_corners(surface, faces != NULL ? faces[i] : i, t);
        *on_surface = verify_on_triangle(p, t);
    }
    if (*on_surface)
        return 0;
    int winding;
    double q[3];
    for (uint64_t attempt = 0;; attempt++) {
        outside_point(surface, attempt, q);
        if (count_crossings(surface, faces, count, p, q, &winding))
            return winding;
    }
}

/* ---- by a tree ---- */

/* A point, or a segment from it, during a tree traversal. */
typedef struct ray {
    const verify_surface *surface;
    const double *p;
    double q[3];
    int winding;
} ray;

static bool misses_point(void *data, uint32_t face) {
    const ray *own = data;
    const double *t[3];
    verify_corners(own->surface, face, t);
    return !verify_on_triangle(own->p, t);
}

static bool passes_face(void *data, uint32_t face) {
    ray *own = data;
    const double *t[3];
    verify_corners(own->surface, face, t);
    return add_crossing(own->p, own->q, t, &own->winding);
}

int verify_tree_winding(const verify_tree *tree, const double p[3], bool *on_surface) {
    ray own = {.surface = verify_tree_surface(tree), .p = p};
    *on_surface = !verify_tree_visit(tree, p, p, misses_point, &own);
    if (*on_surface || !in_bounds(own.surface, p))
        return 0;
    for (uint64_t attempt = 0;; attempt++) {
        own.winding = 0;
        outside_point(own.surface, attempt, own.q);
        if (verify_tree_follow(tree, p, own.q, passes_face, &own))
            return own.winding;
    }
}
