/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel of a closed surface, with a proof.
 *
 * Problem: the points strictly on the inner side of every face; of those, one as far as possible
 * from all planes (Chebyshev centre).
 *
 * Stages: check that every edge has equally many faces in either direction; make a row for each
 * face, scaled to unit size; solve the linear program in (x, y, z, radius) that maximizes the
 * radius; then the proof, which does not rely on the program's numbers: either the rounded centre
 * passes the certificate, or the tight rows are half-spaces without a common point in the box of
 * the surface. If neither succeeds, the program is solved again in another random order, which ends
 * with other tight rows.
 *
 * Certificate: if g is strictly on the inner side of every face of a closed surface, then the
 * central projection from g maps faces to the sphere without folds, so each ray from g meets the
 * surface as often as it winds around g. Once means that the surface is the graph of a function
 * over the sphere: embedded, connected, and entirely visible from g.
 *
 * Invariant: only the radius is rounded. Cost: O(n) expected; a few dozen flops per face for the
 * program, one orient3d and one crossing test per face for the certificate. */
#include "visibility/kernel.h"

#include <math.h>

#include "core/memory.h"
#include "core/rng.h"
#include "geometry/bvh.h"
#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

static const char STAGE[] = "kernel";

enum { ROW = 5, TRIES = 3 };

/* In unit size every kernel fits in a ball of radius 1; the centre of an empty one may lie
 * outside. */
static const double SEARCH_RADIUS = 16;

typedef struct finder {
    const kernel_faces *surface;
    double lower[3], upper[3]; /* box of the faces, which contains every kernel */
    double origin[3];          /* unit coordinates are (p - origin) / 2^exponent */
    int exponent;
    double *rows; /* ROW per face */
    uint32_t *order;
} finder;

void starg_kernel_options_default(starg_kernel_options *options) {
    *options = (starg_kernel_options){.trust_closed = false};
}

static const double *corner(const kernel_faces *surface, size_t face, size_t k) {
    return surface->vertices + 3 * (size_t)surface->faces[3 * face + k];
}

/* ---- rows ---- */

static void find_frame(finder *f) {
    double *lower = f->lower, *upper = f->upper, extent = 0;
    vec3_copy(corner(f->surface, 0, 0), lower);
    vec3_copy(lower, upper);
    for (size_t i = 0; i < 3 * f->surface->count; i++) {
        const double *p = corner(f->surface, i / 3, i % 3);
        for (int k = 0; k < 3; k++) {
            lower[k] = fmin(lower[k], p[k]);
            upper[k] = fmax(upper[k], p[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        f->origin[k] = 0.5 * lower[k] + 0.5 * upper[k];
        extent = fmax(extent, upper[k] - lower[k]);
    }
    frexp(extent, &f->exponent);
}

static void to_unit(const finder *f, const double p[3], double out[3]) {
    vec3_subtract(p, f->origin, out);
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(out[k], -f->exponent);
}

/* n . x + r <= n . a for the unit normal n. A normal too short to be computed stays zero: that row
 * only bounds r, and the exact tests decide its face. */
static void make_row(const finder *f, size_t face, double row[ROW]) {
    double a[3], b[3], c[3], n[3];
    to_unit(f, corner(f->surface, face, 0), a);
    to_unit(f, corner(f->surface, face, 1), b);
    to_unit(f, corner(f->surface, face, 2), c);
    vec3_triangle_normal(a, b, c, n);
    double length = vec3_length(n);
    for (int k = 0; k < 3; k++)
        row[k] = length > 0 ? n[k] / length : 0;
    row[3] = 1;
    row[4] = length > 0 ? vec3_dot(row, a) : SEARCH_RADIUS;
}

/* ---- candidates ---- */

static void solve(const finder *f, uint64_t seed, linear_solution *solution) {
    const linear_program program = {.dimension = 4,
                                    .rows = f->rows,
                                    .count = f->surface->count,
                                    .objective = {0, 0, 0, 1},
                                    .radius = SEARCH_RADIUS,
                                    .seed = seed};
    linear_program_solve(&program, f->order, NULL, solution);
}

/* The rounded centre, and its distance to the nearest plane. */
static void place_guard(const finder *f, const linear_solution *solution,
                        starg_kernel_result *result) {
    double unit[3], radius = INFINITY;
    for (int k = 0; k < 3; k++)
        result->guard[k] = f->origin[k] + ldexp(solution->point[k], f->exponent);
    to_unit(f, result->guard, unit);
    for (size_t face = 0; face < f->surface->count; face++) {
        const double *row = f->rows + ROW * face;
        radius = fmin(radius, row[4] - vec3_dot(row, unit));
    }
    result->radius = ldexp(radius, f->exponent);
}

/* ---- proofs ---- */

bool kernel_sees_all(const kernel_faces *surface, const double point[3]) {
    for (size_t face = 0; face < surface->count; face++)
        if (orient3d(corner(surface, face, 0), corner(surface, face, 1), corner(surface, face, 2),
                     point) <= 0)
            return false;
    return true;
}

int kernel_winding(const kernel_faces *surface, const double point[3]) {
    /* crossings read only the triangles of a tree */
    const bvh triangles = {.vertices = surface->vertices, .faces = surface->faces};
    int winding = 0;
    for (size_t face = 0; face < surface->count; face++)
        winding += bvh_crossing(&triangles, (uint32_t)face, point);
    return winding;
}

/* The points strictly inside all faces form a convex set off the surface, so the winding number is
 * the same for all of them: a number above one proves by itself that the kernel is empty. */
static bool prove_interior(const finder *f, starg_kernel_result *result) {
    if (!kernel_sees_all(f->surface, result->guard))
        return false;
    bool once = kernel_winding(f->surface, result->guard) == 1;
    result->verdict = once ? STARG_KERNEL_INTERIOR : STARG_KERNEL_EMPTY;
    return true;
}

/* Solves the square system a x = b in place; false if it is singular. */
static bool eliminate(double a[4][4], double b[4], int n) {
    for (int c = 0; c < n; c++) {
        int pivot = c;
        for (int i = c + 1; i < n; i++)
            if (fabs(a[i][c]) > fabs(a[pivot][c]))
                pivot = i;
        if (a[pivot][c] == 0)
            return false;
        for (int k = 0; k < n; k++) {
            double swap = a[c][k];
            a[c][k] = a[pivot][k];
            a[pivot][k] = swap;
        }
        double swap = b[c];
        b[c] = b[pivot];
        b[pivot] = swap;
        for (int i = 0; i < n; i++) {
            double factor = i == c ? 0 : a[i][c] / a[c][c];
            for (int k = c; k < n; k++)
                a[i][k] -= factor * a[c][k];
            b[i] -= factor * b[c];
        }
    }
    for (int c = 0; c < n; c++)
        b[c] /= a[c][c];
    return true;
}

/* Factors that combine the rows to the objective, by least squares, so that the normals cancel;
 * divided by the lengths of the faces' normals. */
static bool find_weights(const finder *f, const linear_solution *solution, double weights[4]) {
    double gram[4][4];
    int n = solution->tight_count;
    for (int i = 0; i < n; i++) {
        const double *row = f->rows + ROW * (size_t)solution->tight[i];
        for (int j = 0; j < n; j++)
            gram[i][j] = vec3_dot(row, f->rows + ROW * (size_t)solution->tight[j]) + 1;
        weights[i] = 1;
    }
    if (!eliminate(gram, weights, n))
        return false;
    for (int i = 0; i < n; i++) {
        double a[3], b[3], c[3], normal[3];
        to_unit(f, corner(f->surface, solution->tight[i], 0), a);
        to_unit(f, corner(f->surface, solution->tight[i], 1), b);
        to_unit(f, corner(f->surface, solution->tight[i], 2), c);
        vec3_triangle_normal(a, b, c, normal);
        weights[i] = fmax(0, weights[i]) / vec3_length(normal);
        if (!(weights[i] <= 0x1p900)) /* negligible normal */
            return false;
    }
    return true;
}

static half_space inner_side(const finder *f, uint32_t face) {
    return (half_space){corner(f->surface, face, 0), corner(f->surface, face, 1),
                        corner(f->surface, face, 2)};
}

/* The inner half-spaces of the tight rows in `subset`. */
static int choose(const finder *f, const linear_solution *solution, int subset,
                  half_space spaces[HALF_SPACES_MOST], uint32_t faces[HALF_SPACES_MOST]) {
    int count = 0;
    for (int i = 0; i < solution->tight_count && count < HALF_SPACES_MOST; i++)
        if (subset >> i & 1) {
            faces[count] = solution->tight[i];
            spaces[count++] = inner_side(f, solution->tight[i]);
        }
    return count;
}

/* The tight rows have no common point in the box of the faces; if that holds only within rounding,
 * one of their subsets may have no common point anywhere. */
static bool prove_empty(const finder *f, const linear_solution *solution,
                        starg_kernel_result *result) {
    half_space spaces[HALF_SPACES_MOST];
    double weights[4];
    int all = (1 << solution->tight_count) - 1, count = 0;
    if (!solution->feasible || all == 0)
        return false;
    count = choose(f, solution, all, spaces, result->witness);
    bool proven = find_weights(f, solution, weights) &&
                  half_spaces_apart_in_box(spaces, weights, count, f->lower, f->upper);
    for (int subset = 1; subset <= all && !proven; subset++) {
        count = choose(f, solution, subset, spaces, result->witness);
        proven = half_spaces_apart(spaces, count);
    }
    if (!proven)
        return false;
    result->witness_count = (size_t)count;
    result->verdict = STARG_KERNEL_EMPTY;
    return true;
}

/* A zero-area face settles the question and is reported before any program is solved. */
static bool find_flat_face(const finder *f, starg_kernel_result *result) {
    for (size_t face = 0; face < f->surface->count; face++) {
        const double *a = corner(f->surface, face, 0);
        const double *b = corner(f->surface, face, 1);
        const double *c = corner(f->surface, face, 2);
        if (!collinear(a, b, c))
            continue;
        *result = (starg_kernel_result){.verdict = STARG_KERNEL_EMPTY,
                                        .guard = {a[0], a[1], a[2]},
                                        .witness_count = 1,
                                        .witness = {(uint32_t)face}};
        return true;
    }
    return false;
}

starg_status kernel_find(starg_context *context, const kernel_faces *surface,
                         starg_kernel_result *result) {
    starg_status status = STARG_OK;
    finder f = {.surface = surface};
    *result = (starg_kernel_result){.verdict = STARG_KERNEL_UNDECIDED};
    STARG_NEW(context, STAGE, f.rows, ROW * surface->count);
    STARG_NEW(context, STAGE, f.order, surface->count);
    if (find_flat_face(&f, result))
        goto done;
    find_frame(&f);
    for (size_t face = 0; face < surface->count; face++)
        make_row(&f, face, f.rows + ROW * face);
    for (uint64_t attempt = 0; attempt < TRIES; attempt++) {
        linear_solution solution;
        STARG_TRY(starg_check_cancel(context, STAGE));
        solve(&f, starg_hash64(context->seed) + attempt, &solution);
        place_guard(&f, &solution, result);
        if (prove_interior(&f, result) || prove_empty(&f, &solution, result))
            goto done;
    }
done:
    RELEASE(f.rows, f.order);
    return status;
}

/* ---- meshes ---- */

/* Number of faces along an edge in one direction minus those in the other. */
static int edge_balance(const starg_mesh *mesh, const mesh_topology *topology, uint32_t halfedge) {
    int balance = 0;
    uint32_t h = halfedge;
    do {
        balance += mesh->faces[h] < mesh->faces[corner_next(h)] ? 1 : -1;
        h = topology->ring[h];
    } while (h != halfedge);
    return balance;
}

static starg_status check_closed(starg_context *context, const starg_mesh *mesh) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    TRY(topology_create(context, mesh, &topology));
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        uint32_t a = mesh->faces[h], b = mesh->faces[corner_next(h)], twin = topology->twin[h];
        bool balanced = a == b || (twin != TOPOLOGY_NONE ? mesh->faces[twin] == b && a != b
                                                         : edge_balance(mesh, topology, h) == 0);
        if (balanced)
            continue;
        uint64_t edge[2] = {a, b};
        return starg_fail_at(
            context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_EDGE, edge, 2,
            "the mesh is not closed: the faces at the edge between vertices %u and %u do not "
            "match; run 'starguard check' for details, or try 'starguard repair'",
            a, b);
    }
    return STARG_OK;
}

starg_status starg_kernel(starg_context *context, const starg_mesh *mesh,
                          const starg_kernel_options *options, starg_kernel_result *result) {
    starg_kernel_options defaults;
    starg_kernel_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    *result = (starg_kernel_result){.verdict = STARG_KERNEL_UNDECIDED};
    const kernel_faces surface = {mesh->vertices, mesh->faces, mesh->face_count};
    TIME_RULE(context, STARG_TIME_FAILS);
    IN_STAGE(context, STAGE);
    if (mesh->face_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the mesh has no faces");
    if (!options->trust_closed)
        TRY(check_closed(context, mesh));
    return kernel_find(context, &surface, result);
}
