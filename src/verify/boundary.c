/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that the boundary of a decomposition is the surface of the model.
 *
 * An outer face must be a face of the model, corner for corner, or have its corners on one within a
 * billionth of the diagonal (which allows for rounding of points constructed on it) with the same
 * orientation. The model's face is searched near the outer face's centroid.
 *
 * Why this is enough together with the area of each shell: the boundary is closed (verify/facets.c)
 * and lies on the model, so on each shell it is an integer multiple of that shell: whatever covers
 * one face n times must cover its neighbour across an edge of two faces as often
 * (verify/surface.h). All faces are oriented like the model, so areas add up without cancelling,
 * and the area shows that the multiple is one.
 *
 * Cost: O(n log n). Signs do not depend on tolerances here; only "on" does. */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-9; /* relative to the diagonal, and of areas */

enum { CANCEL_STEP = 256 };

/* ---- one face ---- */

typedef enum place { OFF = 0, TURNED = 1, ON = 2, EQUAL = 3 } place;

typedef struct matcher {
    const verify_surface *outer, *model;
    const verify_tree *tree;
    int scale;
    double near;  /* tolerance of "on", in the model's unit */
    double close; /* the same squared, in scaled units */

    size_t face; /* the boundary face being placed; and its best place so far */
    place best;
    uint32_t on;
} matcher;

static bool same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool is_equal(const double *const s[3], const double *const t[3]) {
    for (int i = 0; i < 3; i++)
        if (same_point(s[0], t[i]) && same_point(s[1], t[(i + 1) % 3]) &&
            same_point(s[2], t[(i + 2) % 3]))
            return true;
    return false;
}

/* Sum of the sides of a triangle's box, scaled: an upper bound for its edges. */
static double extent_of(const double *const t[3], int scale) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += fmax(fmax(t[0][k], t[1][k]), t[2][k]) - fmin(fmin(t[0][k], t[1][k]), t[2][k]);
    return ldexp(sum, scale);
}

/* Is the outer face oriented like the model's? True for faces so thin that rounding of the corners
 * may have flipped them. */
static bool looks_alike(const matcher *own, uint32_t face, const double *const s[3]) {
    double n[3], m[3], along = 0, length = 0;
    verify_normal(own->outer, own->face, own->scale, n);
    verify_normal(own->model, face, own->scale, m);
    for (int k = 0; k < 3; k++) {
        along += n[k] * m[k];
        length = hypot(length, n[k]);
    }
    return along > 0 || length <= 8 * ldexp(own->near, own->scale) * extent_of(s, own->scale);
}

static bool consider(void *data, uint32_t face) {
    matcher *own = data;
    const double *s[3], *t[3];
    verify_corners(own->outer, own->face, s);
    verify_corners(own->model, face, t);
    place found = is_equal(s, t) ? EQUAL : ON;
    for (int i = 0; i < 3 && found == ON; i++)
        if (!(verify_squared_distance(own->model, face, s[i], own->scale) <= own->close))
            found = OFF;
    if (found == ON && !looks_alike(own, face, s))
        found = TURNED;
    if (found > own->best) {
        own->best = found;
        own->on = face;
    }
    return found != EQUAL;
}

static void find_place(matcher *own, size_t face) {
    const double *s[3];
    double lower[3], upper[3];
    verify_corners(own->outer, face, s);
    for (int k = 0; k < 3; k++) {
        double center = s[0][k] / 3 + s[1][k] / 3 + s[2][k] / 3;
        lower[k] = center - own->near;
        upper[k] = center + own->near;
    }
    own->face = face;
    own->best = OFF;
    verify_tree_visit(own->tree, lower, upper, consider, own);
}

/* ---- shells ---- */

/* Areas of the model's shells, each stored at its lowest face. */
typedef struct shell {
    double area, covered, slack;
} shell;

typedef struct shells {
    uint32_t *parent;
    shell *of;
} shells;

static shell *shell_at(const shells *all, size_t face) {
    return &all->of[verify_root(all->parent, (uint32_t)face)];
}

static void compare_shells(const shells *all, const verify_surface *model, verify_match *match) {
    for (size_t f = 0; f < model->face_count; f++) {
        const shell *own = &all->of[f];
        if (all->parent[f] != f)
            continue;
        bool even = fabs(own->covered - own->area) <= TOLERANCE * own->area + own->slack;
        match->shells++;
        match->area += own->covered;
        match->model_area += own->area;
        if (!even && match->uneven++ == 0) {
            match->shell = f;
            match->shell_area = own->area;
            match->shell_covered = own->covered;
        }
    }
}

/* ---- all faces ---- */

static void record_face(const matcher *own, const shells *all, double rounding,
                        verify_match *match) {
    const double *s[3];
    verify_corners(own->outer, own->face, s);
    match->equal += own->best == EQUAL;
    if (own->best == OFF && match->off++ == 0)
        match->first_off = own->face;
    if (own->best == TURNED && match->turned++ == 0)
        match->first_turned = own->face;
    if (own->best == OFF || own->best == TURNED)
        return;
    shell *under = shell_at(all, own->on);
    under->covered += verify_area(own->outer, own->face, own->scale);
    if (own->best == ON)
        under->slack += ldexp(rounding, own->scale) * extent_of(s, own->scale);
}

starg_status verify_match_surfaces(const verify_surface *outer, const verify_surface *model,
                                   verify_match *match) {
    starg_status status = STARG_OK;
    starg_context *context = outer->context;
    double rounding = verify_rounding(model);
    matcher own = {.outer = outer, .model = model, .scale = verify_scale(outer)};
    verify_tree *tree = NULL;
    shells all = {0};
    *match = (verify_match){0};
    own.near = TOLERANCE * verify_diagonal(model) + rounding;
    own.close = pow(ldexp(own.near, own.scale), 2);
    STARG_TRY(verify_tree_create(model, &tree));
    own.tree = tree;
    STARG_TRY(verify_find_shells(model, &all.parent));
    STARG_NEW_ZERO(context, STAGE, all.of, model->face_count);
    for (size_t f = 0; f < model->face_count; f++)
        shell_at(&all, f)->area += verify_area(model, f, own.scale);
    for (size_t f = 0; f < own.outer->face_count; f++) {
        if (f % CANCEL_STEP == 0)
            STARG_TRY(starg_check_cancel(context, STAGE));
        find_place(&own, f);
        record_face(&own, &all, rounding, match);
    }
    compare_shells(&all, model, match);
done:
    RELEASE(all.parent, all.of);
    verify_tree_free(tree);
    return status;
}
