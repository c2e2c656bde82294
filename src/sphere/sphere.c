/* SPDX-License-Identifier: Apache-2.0 */
/* Spherical embedding of a surface of genus 0, coarse to fine.
 *
 * Source: E. Praun, H. Hoppe, Spherical parametrization and remeshing, 2003, on progressive
 * removals [Hop96].
 *
 * Stages: remove vertices until a tetrahedron is left; embed that; restore the vertices in reverse
 * order, each into the kernel of the spherical polygon of its neighbours; relax all whenever the
 * number of vertices has grown by a fifth, and again at the end.
 *
 * Invariants: all triangles are positive, by the exact predicate. A polygon that was a fan of
 * positive triangles about one of its corners has a kernel with nonempty interior near that corner.
 * The centre of the kernel, the point farthest from the great circles of the polygon's sides, is a
 * linear program in four variables. The map has degree one: a tetrahedron around the centre covers
 * the sphere once, and moving or adding a vertex within the kernel changes only its polygon.
 *
 * Cost: O(n log n + sweeps n); each level costs a sixth more than the next coarser one. */
#include "sphere/sphere.h"

#include "geometry/linear_program.h"
#include "geometry/vec3.h"

static const char STAGE[] = "sphere";
enum { BASE = 4, LEVEL_SWEEPS = 8, FINAL_SWEEPS = 40, HALVINGS = 40 };
static const double GROWTH = 1.2;
static const double FLOOR = 0.02; /* relative to the mean face area, added to squared edges */

/* ---- base ---- */

/* Any three neighbours of a corner are in counter-clockwise order. */
static void place_base(sphere *s) {
    static const double corners[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    uint32_t top = 0;
    while (s->rings->of[top].count == 0)
        top++;
    const uint32_t *around = s->rings->of[top].data;
    for (int k = 0; k < 3; k++) {
        double scale = sqrt(1.0 / 3);
        s->directions[3 * (size_t)top + (size_t)k] = scale * corners[0][k];
        for (size_t i = 0; i < 3; i++)
            s->directions[3 * (size_t)around[i] + (size_t)k] = scale * corners[i + 1][k];
    }
    s->alive[0] = top;
    for (size_t i = 0; i < 3; i++)
        s->alive[i + 1] = around[i];
}

/* ---- insertion ---- */

/* The side p q as a row of the program: x is on its inner side by at least the fourth variable. */
static void side_row(const double p[3], const double q[3], double row[5]) {
    vec3_cross(p, q, row);
    double length = vec3_length(row);
    for (int k = 0; k < 3; k++)
        row[k] = length > 0 ? -row[k] / length : 0;
    row[3] = 1;
    row[4] = 0;
}

static starg_status kernel_middle(const sphere *s, sphere_work *work, const ring *around,
                                  double out[3]) {
    linear_solution solution;
    work->rows.count = work->order.count = 0;
    for (size_t i = 0; i < around->count; i++) {
        double row[5];
        side_row(s->directions + 3 * (size_t)around->data[i],
                 s->directions + 3 * (size_t)around->data[(i + 1) % around->count], row);
        for (int k = 0; k < 5; k++)
            PUSH(s->context, STAGE, &work->rows, row[k]);
        PUSH(s->context, STAGE, &work->order, 0);
    }
    const linear_program program = {.dimension = 4,
                                    .rows = work->rows.data,
                                    .count = around->count,
                                    .objective = {0, 0, 0, 1},
                                    .radius = 1,
                                    .seed = s->context->seed};
    linear_program_solve(&program, work->order.data, NULL, &solution);
    double length = vec3_length(solution.point);
    for (int k = 0; k < 3; k++)
        out[k] = solution.feasible && length > 0 ? solution.point[k] / length : 0;
    return STARG_OK;
}

/* A place close to the vertex that b had been merged into, by halving: close enough to it the
 * kernel contains it, even if the kernel is too small for the program. */
static bool place_near(const sphere *s, const ring *around, double out[3]) {
    const double *a = s->directions + 3 * (size_t)around->data[0];
    double middle[3] = {0};
    for (size_t i = 1; i < around->count; i++)
        vec3_along(middle, 1.0 / (double)around->count, s->directions + 3 * (size_t)around->data[i],
                   middle);
    double step = 1;
    for (int i = 0; i < HALVINGS; i++) {
        double d[3];
        step *= 0.5;
        vec3_subtract(middle, a, d);
        vec3_along(a, step, d, out);
        double length = vec3_length(out);
        for (int k = 0; k < 3; k++)
            out[k] /= length;
        if (relax_is_positive(around, s->directions, out))
            return true;
    }
    return false;
}

void sphere_work_free(sphere_work *work) {
    RELEASE(work->rows.data, work->order.data);
}

starg_status sphere_insert(sphere *s, sphere_work *work) {
    uint32_t b = s->rings->removals.data[s->rings->removals.count - 1].vertex;
    double *x = s->directions + 3 * (size_t)b;
    TRY(rings_restore(s->rings));
    const ring *around = &s->rings->of[b];
    TRY(kernel_middle(s, work, around, x));
    if (!relax_is_positive(around, s->directions, x) && !place_near(s, around, x)) {
        uint64_t vertex = b;
        return starg_fail_at(s->context, STARG_ERROR_SOLVER, STAGE, STARG_ELEMENT_VERTEX, &vertex,
                             1,
                             "vertex %u does not fit on the sphere in double precision; try "
                             "'starguard repair' or a more even triangulation",
                             b);
    }
    s->alive[s->rings->left - 1] = b;
    return STARG_OK;
}

/* ---- levels ---- */

starg_status sphere_relax(sphere *s, const uint8_t *pinned, int sweeps) {
    const relaxation r = {.rings = s->rings,
                          .directions = s->directions,
                          .alive = s->alive,
                          .alive_count = s->rings->left,
                          .pinned = pinned,
                          .floor =
                              s->floor * (double)s->rings->vertex_count / (double)s->rings->left};
    for (int i = 0; i < sweeps; i++) {
        TRY(starg_check_cancel(s->context, STAGE));
        relax_sweep(&r);
    }
    return STARG_OK;
}

static starg_status refine(sphere *s, sphere_work *work) {
    double next = 4;
    IN_STAGE(s->context, STAGE);
    while (s->rings->removals.count > 0) {
        TRY(sphere_insert(s, work));
        if ((double)s->rings->left >= next) {
            TRY(sphere_relax(s, NULL, LEVEL_SWEEPS));
            next = GROWTH * (double)s->rings->left;
        }
        starg_progress_step(s->context, s->rings->left, s->rings->vertex_count);
    }
    TRY(sphere_relax(s, NULL, FINAL_SWEEPS));
    sphere_list_alive(s);
    return STARG_OK;
}

void sphere_list_alive(sphere *s) {
    size_t count = 0;
    for (size_t v = 0; v < s->rings->vertex_count; v++)
        if (s->rings->of[v].count > 0)
            s->alive[count++] = (uint32_t)v;
}

bool sphere_is_positive(const sphere *s) {
    for (size_t i = 0; i < s->rings->left; i++)
        if (!relax_is_positive(&s->rings->of[s->alive[i]], s->directions,
                               s->directions + 3 * (size_t)s->alive[i]))
            return false;
    return true;
}

/* With all vertices, and no directions yet. */
static starg_status begin(starg_context *context, const starg_mesh *mesh, sphere **out) {
    sphere *s = NULL;
    NEW_ZERO(context, STAGE, s, 1);
    *out = s;
    s->context = context;
    s->mesh = mesh;
    s->floor = FLOOR * starg_mesh_area(mesh) / (double)mesh->face_count;
    NEW_ZERO(context, STAGE, s->directions, 3 * mesh->vertex_count);
    NEW(context, STAGE, s->alive, mesh->vertex_count);
    return rings_create(context, mesh, &s->rings);
}

starg_status sphere_even(starg_context *context, const starg_mesh *mesh, const double *directions,
                         sphere **out) {
    SCOPED_BY(sphere_drop) sphere *s = NULL;
    *out = NULL;
    TRY(begin(context, mesh, &s));
    memcpy(s->directions, directions, 3 * mesh->vertex_count * sizeof *directions);
    sphere_list_alive(s);
    TRY(sphere_relax(s, NULL, FINAL_SWEEPS));
    *out = s;
    s = NULL;
    return STARG_OK;
}

starg_status sphere_create(starg_context *context, const starg_mesh *mesh, sphere **out) {
    SCOPED_BY(sphere_drop) sphere *s = NULL;
    SCOPED_BY(sphere_work_free) sphere_work work = {0};
    *out = NULL;
    TRY(begin(context, mesh, &s));
    TRY(rings_reduce(s->rings, &(rings_limits){.least = BASE}));
    place_base(s);
    TRY(refine(s, &work));
    if (!sphere_is_positive(s))
        return starg_fail(context, STARG_ERROR_SOLVER, STAGE,
                          "the surface cannot be mapped to the sphere in double precision");
    *out = s;
    s = NULL;
    return STARG_OK;
}

void sphere_free(sphere *s) {
    if (s == NULL)
        return;
    rings_free(s->rings);
    RELEASE(s->alive, s->directions, s);
}
