/* SPDX-License-Identifier: Apache-2.0 */
/* Space that can be reached from a point.
 *
 * Problem: a soup of triangles has no inside, but one can walk about in it. Guards should stand
 * where somebody could get to from a given point, at a resolution: gaps that are narrower than that
 * do not count, and nothing behind walls is reached.
 *
 * Stages: a grid of cubes over the box in which guards may stand; cubes that a face may meet are
 * taken (a separating-axis test with room for rounding: no cube that a face meets is left free); a
 * flood over sides from the cube of the point.
 *
 * Invariant: no face meets a cube that is reached, so a path along the centres of cubes leads
 * there. Cost: linear in the cubes, two bits each, and in the cubes about the boxes of the faces.
 */
#include "mesh/solid.h"

#include "geometry/vec3.h"

static const char STAGE[] = "scene";

static const double MOST_CELLS = 0x1p30;

enum { FACES_PER_CLOCK = 1024, MOST_ASKED = 4096 };

static size_t cell_at(const flood_cells *f, const size_t at[3]) {
    return at[0] + f->count[0] * (at[1] + f->count[1] * at[2]);
}

bool flood_locate(const flood_cells *f, const double p[3], size_t at[3]) {
    for (int k = 0; k < 3; k++) {
        double x = floor((p[k] - f->origin[k]) / f->size);
        if (!(x >= 0 && x < (double)f->count[k]))
            return false;
        at[k] = (size_t)x;
    }
    return true;
}

static starg_status make_grid(starg_context *context, const starg_solid *scene, double size,
                              flood_cells *f) {
    bvh_box reach;
    double cells = 1;
    solid_reach(scene, &reach);
    f->size = size;
    for (int k = 0; k < 3; k++) {
        double wanted = floor((reach.upper[k] - reach.lower[k]) / size) + 1;
        f->origin[k] = reach.lower[k];
        cells *= wanted;
        if (!(cells <= MOST_CELLS))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "cubes of the size %g would be more than 2^30; use larger ones",
                              size);
        f->count[k] = (size_t)wanted;
    }
    NEW_ZERO(context, STAGE, f->taken, starg_bit_words((size_t)cells));
    NEW_ZERO(context, STAGE, f->bits, starg_bit_words((size_t)cells));
    return STARG_OK;
}

/* ---- taken cubes ---- */

/* Is the triangle, relative to the centre of a cube with half side h, surely beyond it along an
 * axis? */
static bool parted(double t[3][3], const double axis[3], double h) {
    double a = vec3_dot(t[0], axis), b = vec3_dot(t[1], axis), c = vec3_dot(t[2], axis);
    double reach = h * (fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]));
    double room = reach * (1 + 1e-9);
    return fmin(a, fmin(b, c)) > room || fmax(a, fmax(b, c)) < -room;
}

static bool may_meet(double t[3][3], double h) {
    double edge[3][3], normal[3];
    for (int i = 0; i < 3; i++)
        vec3_subtract(t[(i + 1) % 3], t[i], edge[i]);
    vec3_cross(edge[0], edge[1], normal);
    if (parted(t, normal, h))
        return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double unit[3] = {k == 0, k == 1, k == 2}, axis[3];
            vec3_cross(edge[i], unit, axis);
            if (parted(t, axis, h))
                return false;
        }
    return true;
}

/* The range of cubes that an interval may meet. */
static bool find_range(const flood_cells *f, int k, double low, double high, size_t range[2]) {
    double first = floor((low - f->origin[k]) / f->size - 1e-9);
    double last = floor((high - f->origin[k]) / f->size + 1e-9);
    if (last < 0 || first >= (double)f->count[k])
        return false;
    range[0] = first > 0 ? (size_t)first : 0;
    range[1] = last < (double)f->count[k] ? (size_t)last : f->count[k] - 1;
    return true;
}

static void take_cell(flood_cells *f, const double *const corner[3], const size_t at[3]) {
    double t[3][3];
    for (int k = 0; k < 3; k++) {
        double centre = f->origin[k] + ((double)at[k] + 0.5) * f->size;
        for (int i = 0; i < 3; i++)
            t[i][k] = corner[i][k] - centre;
    }
    if (may_meet(t, 0.5 * f->size))
        starg_bit_set(f->taken, cell_at(f, at));
}

static void take_face(flood_cells *f, const double *const c[3]) {
    size_t range[3][2], at[3];
    for (int k = 0; k < 3; k++)
        if (!find_range(f, k, fmin(c[0][k], fmin(c[1][k], c[2][k])),
                        fmax(c[0][k], fmax(c[1][k], c[2][k])), range[k]))
            return;
    for (at[2] = range[2][0]; at[2] <= range[2][1]; at[2]++)
        for (at[1] = range[1][0]; at[1] <= range[1][1]; at[1]++)
            for (at[0] = range[0][0]; at[0] <= range[0][1]; at[0]++)
                take_cell(f, c, at);
}

static starg_status take_faces(starg_context *context, const starg_mesh *mesh, flood_cells *f) {
    for (size_t i = 0; i < mesh->face_count; i++) {
        const double *corner[3];
        for (size_t k = 0; k < 3; k++)
            corner[k] = mesh->vertices + 3 * (size_t)mesh->faces[3 * i + k];
        take_face(f, corner);
        if (i % FACES_PER_CLOCK == 0)
            TRY(starg_check_cancel(context, STAGE));
    }
    return STARG_OK;
}

/* ---- the flood ---- */

typedef STARG_ARRAY(size_t) cell_stack;

static starg_status reach(flood_cells *f, size_t cell, cell_stack *stack) {
    if (starg_bit_test(f->taken, cell) || starg_bit_test(f->bits, cell))
        return STARG_OK;
    starg_bit_set(f->bits, cell);
    f->reached++;
    PUSH(f->context, STAGE, stack, cell);
    return STARG_OK;
}

/* Limits may even leave an empty box. */
static starg_status check_from(starg_context *context, const starg_solid *scene,
                               const double from[3]) {
    bvh_box box;
    bool in = true;
    solid_reach(scene, &box);
    for (int k = 0; k < 3; k++)
        in = in && from[k] >= box.lower[k] && from[k] <= box.upper[k];
    if (in)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "nobody can stand at (%g, %g, %g): it is not in the box where guards may be, "
                      "from (%g, %g, %g) to (%g, %g, %g); choose a point in it, or another box "
                      "(--within)",
                      from[0], from[1], from[2], box.lower[0], box.lower[1], box.lower[2],
                      box.upper[0], box.upper[1], box.upper[2]);
}

static starg_status spread(flood_cells *f, const starg_solid *scene, const double from[3]) {
    SCOPED cell_stack stack = {0};
    size_t at[3] = {0};
    const size_t step[3] = {1, f->count[0], f->count[0] * f->count[1]};
    flood_locate(f, from, at); /* the cubes fill the box */
    if (starg_bit_test(f->taken, cell_at(f, at)))
        return starg_fail(f->context, STARG_ERROR_ARGUMENT, STAGE,
                          "nobody can stand at (%g, %g, %g): a face meets its cube of the size %g; "
                          "choose another point or smaller cubes",
                          from[0], from[1], from[2], f->size);
    if (!starg_solid_contains(scene, from))
        return starg_fail(f->context, STARG_ERROR_ARGUMENT, STAGE,
                          "nobody can stand at (%g, %g, %g): it is within matter, or outside of "
                          "everything; choose another point",
                          from[0], from[1], from[2]);
    TRY(reach(f, cell_at(f, at), &stack));
    while (stack.count > 0) {
        size_t cell = stack.data[--stack.count];
        for (int k = 0; k < 3; k++) {
            size_t x = cell / step[k] % f->count[k];
            if (x > 0)
                TRY(reach(f, cell - step[k], &stack));
            if (x + 1 < f->count[k])
                TRY(reach(f, cell + step[k], &stack));
        }
    }
    return STARG_OK;
}

starg_status flood_create(starg_context *context, const starg_solid *scene, const double from[3],
                          double size, flood_cells **out) {
    SCOPED_BY(flood_drop) flood_cells *f = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, f, 1);
    f->context = context;
    TRY(check_from(context, scene, from));
    TRY(make_grid(context, scene, size, f));
    TRY(take_faces(context, scene->mesh, f));
    TRY(spread(f, scene, from));
    *out = f;
    f = NULL;
    return STARG_OK;
}

void flood_free(flood_cells *f) {
    if (f == NULL)
        return;
    RELEASE(f->taken, f->bits, f);
}

bool flood_reaches(const flood_cells *f, const double p[3]) {
    size_t at[3];
    return flood_locate(f, p, at) && starg_bit_test(f->bits, cell_at(f, at));
}

bool flood_meets(const flood_cells *f, const bvh_box *box) {
    size_t range[3][2], at[3], count = 1;
    for (int k = 0; k < 3; k++) {
        if (!find_range(f, k, box->lower[k], box->upper[k], range[k]))
            return false;
        count *= range[k][1] - range[k][0] + 1;
    }
    if (count > MOST_ASKED)
        return true;
    for (at[2] = range[2][0]; at[2] <= range[2][1]; at[2]++)
        for (at[1] = range[1][0]; at[1] <= range[1][1]; at[1]++)
            for (at[0] = range[0][0]; at[0] <= range[0][1]; at[0]++)
                if (starg_bit_test(f->bits, cell_at(f, at)))
                    return true;
    return false;
}

double flood_volume(const flood_cells *f) {
    return (double)f->reached * f->size * f->size * f->size;
}
