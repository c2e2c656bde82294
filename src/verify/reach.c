/* SPDX-License-Identifier: Apache-2.0 */
/* Can guards be reached from a point? They are said to be where one gets from there through cubes
 * of some size that no face meets. Which cubes these are is not in the file, nor is it needed:
 * whatever grid they belong to, cubes of half the size of any other grid lie in each of them, and
 * the union of two that share a side holds a block of these. So a flood through free cubes of half
 * the size must lead from the point to each guard; at either end, a straight line leads from the
 * point to the middle of such a cube nearby.
 *
 * A cube is free if nothing is left of any face when the sides of the cube cut it, in doubles. It
 * is taken for a little larger, so that rounding opens no wall that runs along sides of cubes;
 * faces keep more than that from cubes that count as met by none. Cost: the cubes, and for each
 * face those about its box. */
#include <math.h>

#include "verify/facts.h"

static const char STAGE[] = "verify";

static const double MOST_CUBES = 0x1p30, LARGER = 1 + 0x1p-32;

enum { CANCEL_STEP = 1024, NEAR = 4 /* cubes along a side about a point, and half as many more */ };

typedef struct grid {
    const verify_facts *known;
    double lower[3], size;
    size_t count[3], all;
    uint64_t *taken, *reached;
} grid;

static size_t index_of(const grid *g, const size_t at[3]) {
    return at[0] + g->count[0] * (at[1] + g->count[1] * at[2]);
}

static void middle_of(const grid *g, const size_t at[3], double middle[3]) {
    for (int k = 0; k < 3; k++)
        middle[k] = g->lower[k] + ((double)at[k] + 0.5) * g->size;
}

/* The box in which guards may stand, and one cube more. */
static void find_box(const verify_facts *known, double lower[3], double upper[3]) {
    const starg_space_options *o = &known->guards->space;
    const verify_surface *surface = known->surface;
    bool open = o->outside || o->soup, boxed = false;
    double grow = open && o->standoff_most > 0 ? o->standoff_most
                  : o->outside                 ? 4 * verify_diagonal(surface)
                                               : 0;
    for (int k = 0; k < 6; k++)
        boxed = boxed || o->within[k] != 0;
    for (int k = 0; k < 3; k++) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
        for (size_t f = 0; f < surface->model_faces; f++) {
            const double *t[3];
            verify_corners(surface, f, t);
            for (int i = 0; i < 3; i++) {
                lower[k] = fmin(lower[k], t[i][k]);
                upper[k] = fmax(upper[k], t[i][k]);
            }
        }
        lower[k] -= grow;
        upper[k] += grow;
        if (boxed) {
            lower[k] = open ? o->within[k] : fmax(lower[k], o->within[k]);
            upper[k] = open ? o->within[k + 3] : fmin(upper[k], o->within[k + 3]);
        }
        upper[k] += o->cell;
    }
}

/* False: too many cubes, or none. */
static bool lay_out(const verify_facts *known, grid *g) {
    double lower[3], upper[3], all = 1;
    find_box(known, lower, upper);
    *g = (grid){.known = known, .size = 0.5 * known->guards->space.cell};
    for (int k = 0; k < 3; k++) {
        double count = floor((upper[k] - lower[k]) / g->size);
        all *= count;
        if (!(count >= 1) || !(all <= MOST_CUBES))
            return false;
        g->lower[k] = lower[k];
        g->count[k] = (size_t)count;
    }
    g->all = (size_t)all;
    return true;
}

/* ---- taken cubes ---- */

/* What is left of a polygon on the side of a plane: sign * x[axis] <= half. */
static int cut(double from[9][3], int count, int axis, double sign, double half, double to[9][3]) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const double *a = from[i], *b = from[(i + 1) % count];
        double da = half - sign * a[axis], db = half - sign * b[axis];
        if (da >= 0) {
            for (int k = 0; k < 3; k++)
                to[kept][k] = a[k];
            kept++;
        }
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            for (int k = 0; k < 3; k++)
                to[kept][k] = a[k] + da / (da - db) * (b[k] - a[k]);
            kept++;
        }
    }
    return kept;
}

static bool meets(const double *const t[3], const double middle[3], double half) {
    double polygon[2][9][3];
    int count = 3, now = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            polygon[0][i][k] = t[i][k] - middle[k];
    for (int side = 0; side < 6 && count > 0; side++, now = 1 - now)
        count = cut(polygon[now], count, side / 2, side % 2 ? -1 : 1, half, polygon[1 - now]);
    return count > 0;
}

/* The cubes along an axis that an interval may meet; false: none. */
static bool span(const grid *g, int k, double low, double high, size_t range[2]) {
    double first = floor((low - g->lower[k]) / g->size) - 1;
    double last = floor((high - g->lower[k]) / g->size) + 1;
    if (last < 0 || first >= (double)g->count[k])
        return false;
    range[0] = first > 0 ? (size_t)first : 0;
    range[1] = last < (double)g->count[k] ? (size_t)last : g->count[k] - 1;
    return true;
}

typedef void take_cube(grid *g, const size_t at[3], const double middle[3], void *data);

static void for_cubes(grid *g, size_t range[3][2], take_cube *take, void *data) {
    size_t at[3];
    for (at[2] = range[2][0]; at[2] <= range[2][1]; at[2]++)
        for (at[1] = range[1][0]; at[1] <= range[1][1]; at[1]++)
            for (at[0] = range[0][0]; at[0] <= range[0][1]; at[0]++) {
                double middle[3];
                middle_of(g, at, middle);
                take(g, at, middle, data);
            }
}

static void mark_cube(grid *g, const size_t at[3], const double middle[3], void *data) {
    const double *const *t = data;
    size_t cube = index_of(g, at);
    if (!starg_bit_test(g->taken, cube) && meets(t, middle, 0.5 * LARGER * g->size))
        starg_bit_set(g->taken, cube);
}

static starg_status mark_faces(grid *g) {
    const verify_surface *surface = g->known->surface;
    for (size_t f = 0; f < surface->face_count; f++) {
        const double *t[3];
        size_t range[3][2];
        bool near = true;
        verify_corners(surface, f, t);
        for (int k = 0; k < 3; k++)
            near = near && span(g, k, fmin(t[0][k], fmin(t[1][k], t[2][k])),
                                fmax(t[0][k], fmax(t[1][k], t[2][k])), range[k]);
        if (near)
            for_cubes(g, range, mark_cube, t);
        if (f % CANCEL_STEP == 0)
            TRY(starg_check_cancel(surface->context, STAGE));
    }
    return STARG_OK;
}

/* ---- ends ---- */

typedef struct visit {
    const double *p;
    uint64_t
        *mark; /* free cubes in a straight line are set here; NULL: `found` if one is reached */
    bool found;
} visit;

static void visit_cube(grid *g, const size_t at[3], const double middle[3], void *data) {
    visit *own = data;
    size_t cube = index_of(g, at);
    if (starg_bit_test(g->taken, cube) || own->found ||
        (own->mark == NULL && !starg_bit_test(g->reached, cube)) ||
        verify_tree_blocks(g->known->tree, own->p, middle))
        return;
    if (own->mark != NULL)
        starg_bit_set(own->mark, cube);
    else
        own->found = true;
}

/* Visits the cubes within two of their sides about a point. */
static bool visit_near(grid *g, const double p[3], uint64_t *mark) {
    visit own = {.p = p, .mark = mark};
    size_t range[3][2];
    for (int k = 0; k < 3; k++)
        if (!span(g, k, p[k] - 0.25 * NEAR * g->size, p[k] + 0.25 * NEAR * g->size, range[k]))
            return false;
    for_cubes(g, range, visit_cube, &own);
    return own.found;
}

/* ---- the flood ---- */

typedef STARG_ARRAY(size_t) cube_stack;

static starg_status flood(grid *g) {
    starg_context *context = g->known->surface->context;
    const size_t step[3] = {1, g->count[0], g->count[0] * g->count[1]};
    SCOPED cube_stack stack = {0};
    for (size_t w = 0; w < starg_bit_words(g->all); w++)
        STARG_FOR_BITS (bit, g->reached[w])
            PUSH(context, STAGE, &stack, 64 * w + bit);
    while (stack.count > 0) {
        size_t cube = stack.data[--stack.count];
        for (int side = 0; side < 6; side++) {
            size_t along = cube / step[side / 2] % g->count[side / 2];
            bool ends = side % 2 ? along == 0 : along + 1 == g->count[side / 2];
            size_t next = side % 2 ? cube - step[side / 2] : cube + step[side / 2];
            if (ends || starg_bit_test(g->taken, next) || starg_bit_test(g->reached, next))
                continue;
            starg_bit_set(g->reached, next);
            PUSH(context, STAGE, &stack, next);
        }
    }
    return STARG_OK;
}

starg_status verify_find_unreached(const verify_facts *known, bool *known_cubes, size_t *count,
                                   size_t *first) {
    starg_status status = STARG_OK;
    starg_context *context = known->surface->context;
    const starg_guards *guards = known->guards;
    grid g = {0};
    *count = *first = 0;
    *known_cubes = lay_out(known, &g);
    if (!*known_cubes)
        return STARG_OK;
    STARG_NEW_ZERO(context, STAGE, g.taken, starg_bit_words(g.all));
    STARG_NEW_ZERO(context, STAGE, g.reached, starg_bit_words(g.all));
    STARG_TRY(mark_faces(&g));
    visit_near(&g, guards->space.from, g.reached);
    STARG_TRY(flood(&g));
    for (size_t i = guards->count; i-- > 0;)
        if (!verify_is_kept(guards, i) &&
            (!known->inside[i] || !visit_near(&g, guards->positions + 3 * i, NULL))) {
            ++*count;
            *first = i;
        }
done:
    RELEASE(g.taken, g.reached);
    return status;
}
