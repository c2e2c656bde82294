/* SPDX-License-Identifier: Apache-2.0 */
/* Cotangent Laplacian: linear finite elements with lumped masses.
 *
 * Stages: scale by the extent, so that squares do not overflow; drop faces without extent;
 * subdivide at edge midpoints until there are enough vertices; number the vertices in use; sum the
 * triangles' contributions to edges, diagonal and masses; assemble the matrix by columns.
 *
 * A triangle with edge vectors e0, e1, e2 and area A adds e_i . e_j / (4 A) for the corners i and
 * j, a third of A to each corner's mass. This is a Gram matrix for any A > 0: clamping the area of
 * needles to a tiny fraction of their squared longest edge keeps the sum semidefinite.
 *
 * Cost: O(faces). */
#include "shape/spectrum.h"

#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "spectrum";

/* At this resolution the smallest eigenvalues are accurate to about one percent. */
enum { ENOUGH_VERTICES = 2000, ENOUGH_FACES = 20 * ENOUGH_VERTICES };
static const double LEAST_AREA = 1e-10;    /* of a triangle, relative to its squared longest edge */
static const double LEAST_EXTENT = 1e-200; /* squared: anything smaller counts as a point */

typedef struct surface {
    starg_context *context;
    size_t vertex_count, face_count;
    double *positions; /* in a unit cube */
    uint32_t *faces;
} surface;

static void surface_free(surface *s) {
    RELEASE(s->positions, s->faces);
}

/* ---- the surface ---- */

static bool has_extent(const surface *s, const uint32_t f[3]) {
    double u[3], v[3];
    if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0])
        return false;
    vec3_subtract(s->positions + 3 * (size_t)f[1], s->positions + 3 * (size_t)f[0], u);
    vec3_subtract(s->positions + 3 * (size_t)f[2], s->positions + 3 * (size_t)f[0], v);
    return vec3_dot(u, u) + vec3_dot(v, v) > LEAST_EXTENT;
}

static starg_status copy_surface(const starg_mesh *mesh, surface *s) {
    const double *vertices = starg_mesh_vertices(mesh);
    const uint32_t *faces = starg_mesh_faces(mesh);
    double lower[3], upper[3], extent = 0;
    s->vertex_count = starg_mesh_vertex_count(mesh);
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, upper[k] - lower[k]);
    if (!(extent > 0))
        return starg_fail(s->context, STARG_ERROR_MESH, STAGE, "the mesh has no area");
    NEW(s->context, STAGE, s->positions, 3 * s->vertex_count);
    NEW(s->context, STAGE, s->faces, 3 * starg_mesh_face_count(mesh));
    for (size_t i = 0; i < s->vertex_count; i++)
        for (size_t k = 0; k < 3; k++)
            s->positions[3 * i + k] = (vertices[3 * i + k] - lower[k]) / extent;
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++)
        if (has_extent(s, faces + 3 * f))
            memcpy(s->faces + 3 * s->face_count++, faces + 3 * f, 3 * sizeof *faces);
    if (s->face_count == 0)
        return starg_fail(s->context, STARG_ERROR_MESH, STAGE, "the mesh has no area");
    return STARG_OK;
}

/* Four triangles per face: those at corners, then the middle one. */
static void split_face(const uint32_t f[3], const uint32_t middle[3], uint32_t *out) {
    for (size_t k = 0; k < 3; k++) {
        out[3 * k] = f[k];
        out[3 * k + 1] = middle[k];
        out[3 * k + 2] = middle[(k + 2) % 3];
        out[9 + k] = middle[k];
    }
}

static starg_status subdivide(surface *s) {
    size_t edges = 3 * s->face_count;
    SCOPED_BY(surface_free) surface fine = {.context = s->context, .face_count = 4 * s->face_count};
    SCOPED_BY(edge_table_free) edge_table table = {0};
    TRY(edge_table_make(s->context, STAGE, edges, &table));
    NEW(s->context, STAGE, fine.positions, 3 * (s->vertex_count + edges));
    NEW(s->context, STAGE, fine.faces, 3 * fine.face_count);
    memcpy(fine.positions, s->positions, 3 * s->vertex_count * sizeof *fine.positions);
    for (size_t i = 0; i < s->face_count; i++) {
        const uint32_t *f = s->faces + 3 * i;
        uint32_t middle[3];
        for (size_t k = 0; k < 3; k++) {
            uint32_t a = f[k], b = f[(k + 1) % 3];
            middle[k] = (uint32_t)s->vertex_count + edge_table_number(&table, a, b);
            for (size_t c = 0; c < 3; c++)
                fine.positions[3 * (size_t)middle[k] + c] =
                    0.5 * (s->positions[3 * (size_t)a + c] + s->positions[3 * (size_t)b + c]);
        }
        split_face(f, middle, fine.faces + 12 * i);
    }
    fine.vertex_count = s->vertex_count + table.count;
    surface_free(s);
    *s = fine;
    fine = (surface){0};
    return STARG_OK;
}

/* Renumbers the vertices in use from 0, in order. */
static starg_status renumber(surface *s, uint32_t **row_of) {
    uint32_t *numbers = NULL;
    size_t used = 0;
    NEW(s->context, STAGE, numbers, s->vertex_count);
    *row_of = numbers;
    memset(numbers, 0xff, s->vertex_count * sizeof *numbers);
    for (size_t i = 0; i < 3 * s->face_count; i++)
        numbers[s->faces[i]] = 0;
    for (size_t v = 0; v < s->vertex_count; v++) {
        if (numbers[v] == LAPLACIAN_NO_ROW)
            continue;
        memmove(s->positions + 3 * used, s->positions + 3 * v, 3 * sizeof *s->positions);
        numbers[v] = (uint32_t)used++;
    }
    for (size_t i = 0; i < 3 * s->face_count; i++)
        s->faces[i] = numbers[s->faces[i]];
    s->vertex_count = used;
    return STARG_OK;
}

/* ---- the matrix ---- */

typedef struct sums {
    edge_table edges;
    double *weights;  /* per edge: the negated matrix entry */
    double *diagonal; /* per vertex */
    double area;
} sums;

/* Adds one triangle. */
static void add_face(const surface *s, const uint32_t f[3], sums *sum, double *masses) {
    double e[3][3], normal[3], longest = 0;
    for (size_t k = 0; k < 3; k++) {
        vec3_subtract(s->positions + 3 * (size_t)f[(k + 2) % 3],
                      s->positions + 3 * (size_t)f[(k + 1) % 3], e[k]);
        longest = fmax(longest, vec3_dot(e[k], e[k]));
    }
    vec3_cross(e[0], e[1], normal);
    double area = fmax(0.5 * sqrt(vec3_dot(normal, normal)), LEAST_AREA * longest);
    for (size_t k = 0; k < 3; k++) {
        size_t i = (k + 1) % 3, j = (k + 2) % 3;
        double weight = -vec3_dot(e[i], e[j]) / (4 * area);
        sum->weights[edge_table_number(&sum->edges, f[i], f[j])] += weight;
        sum->diagonal[f[i]] += weight;
        sum->diagonal[f[j]] += weight;
        masses[f[k]] += area / 3;
    }
    sum->area += area;
}

static void put(laplacian *l, int64_t *next, uint32_t row, uint32_t column, double value) {
    l->rows[next[column]] = row;
    l->values[next[column]++] = value;
}

/* By columns: the diagonal, then the edges in the order of their numbers. */
static starg_status store_columns(starg_context *context, const sums *sum, laplacian *l) {
    SCOPED int64_t *next = NULL;
    size_t entries = l->count + 2 * (size_t)sum->edges.count;
    NEW_ZERO(context, STAGE, l->starts, l->count + 1);
    NEW(context, STAGE, l->rows, entries);
    NEW(context, STAGE, l->values, entries);
    NEW(context, STAGE, next, l->count);
    for (size_t slot = 0; slot <= sum->edges.mask; slot++) {
        uint64_t key = sum->edges.keys[slot];
        if (key != 0) {
            l->starts[(key >> 32) + 1]++;
            l->starts[(key & UINT32_MAX) + 1]++;
        }
    }
    for (size_t i = 0; i < l->count; i++) {
        l->starts[i + 1] += l->starts[i] + 1;
        next[i] = l->starts[i];
        put(l, next, (uint32_t)i, (uint32_t)i, sum->diagonal[i]);
    }
    for (size_t slot = 0; slot <= sum->edges.mask; slot++) {
        uint64_t key = sum->edges.keys[slot];
        if (key == 0)
            continue;
        uint32_t u = (uint32_t)(key >> 32), v = (uint32_t)key;
        double weight = sum->weights[sum->edges.numbers[slot]];
        put(l, next, u, v, -weight);
        put(l, next, v, u, -weight);
    }
    return STARG_OK;
}

static starg_status assemble(const surface *s, laplacian *l) {
    starg_context *context = s->context;
    starg_status status = STARG_OK;
    sums sum = {0};
    l->count = s->vertex_count;
    STARG_TRY(edge_table_make(context, STAGE, 3 * s->face_count, &sum.edges));
    STARG_NEW_ZERO(context, STAGE, sum.weights, 3 * s->face_count);
    STARG_NEW_ZERO(context, STAGE, sum.diagonal, l->count);
    STARG_NEW_ZERO(context, STAGE, l->masses, l->count);
    for (size_t i = 0; i < s->face_count; i++)
        add_face(s, s->faces + 3 * i, &sum, l->masses);
    for (size_t i = 0; i < l->count; i++)
        l->masses[i] /= sum.area;
    STARG_TRY(store_columns(context, &sum, l));
done:
    edge_table_free(&sum.edges);
    RELEASE(sum.weights, sum.diagonal);
    return status;
}

starg_status laplacian_create(starg_context *context, const starg_mesh *mesh, laplacian *out) {
    SCOPED_BY(surface_free) surface s = {.context = context};
    *out = (laplacian){0};
    TRY(copy_surface(mesh, &s));
    TRY(renumber(&s, &out->row_of));
    while (s.vertex_count < ENOUGH_VERTICES && s.face_count < ENOUGH_FACES) {
        TRY(starg_check_cancel(context, STAGE));
        TRY(subdivide(&s));
    }
    return assemble(&s, out);
}

/* The matrix plus masses on the diagonal, which comes first in each column. */
starg_status laplacian_factorise(starg_context *context, const laplacian *l, double shift,
                                 sparse_factors **out) {
    size_t entries = (size_t)l->starts[l->count];
    SCOPED double *values = NULL;
    *out = NULL;
    NEW(context, STAGE, values, entries);
    memcpy(values, l->values, entries * sizeof *values);
    for (size_t i = 0; i < l->count; i++)
        values[l->starts[i]] += shift * l->masses[i];
    const sparse_matrix matrix = {l->count, l->starts, l->rows, values};
    return sparse_factorise(context, STAGE, &matrix, out);
}

void laplacian_free(laplacian *l) {
    RELEASE(l->starts, l->rows, l->values, l->masses, l->row_of);
    *l = (laplacian){0};
}
