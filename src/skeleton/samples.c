/* SPDX-License-Identifier: Apache-2.0 */
/* Surface samples by subdivision: edges are split at their midpoints, each independently, and a
 * face is cut into two, three or four according to its split edges. So the result is a closed mesh
 * of the same topology, whatever is split. In the end ties are broken: what is cocircular in a
 * drawn solid is not in a turned copy, whose coordinates are rounded.
 *
 * Cost: linear in the result for each round; a round halves long edges. */
#include "skeleton/skeleton.h"

#include "core/rng.h"
#include "core/streams.h"
#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "surface samples";

/* Long thin faces would need far more points than wanted. */
enum { MAX_ROUNDS = 24, MOST_ADDED = 2 };

/* How far points move, of the edges at them. */
static const double MOVE = 1e-5;

/* Numbers the edges to split, those longer than `longest`; each occurs in two faces and is tested
 * once. */
static starg_status number_splits(starg_context *context, const surface_samples *samples,
                                  double longest, edge_table *table) {
    starg_status status = edge_table_make(context, STAGE, samples->face_count * 3 / 2, table);
    for (size_t f = 0; status == STARG_OK && f < samples->face_count; f++)
        for (size_t k = 0; k < 3; k++) {
            uint32_t u = samples->faces[3 * f + k], v = samples->faces[3 * f + (k + 1) % 3];
            if (u < v && vec3_distance(samples->points + 3 * (size_t)u,
                                       samples->points + 3 * (size_t)v) > longest)
                edge_table_number(table, u, v);
        }
    return status;
}

static void place_points(const surface_samples *samples, const edge_table *table, double *points) {
    memcpy(points, samples->points, 3 * samples->point_count * sizeof *points);
    for (size_t slot = 0; slot <= table->mask; slot++) {
        if (table->keys[slot] == 0)
            continue;
        const double *a = samples->points + 3 * (table->keys[slot] >> 32);
        const double *b = samples->points + 3 * (table->keys[slot] & UINT32_MAX);
        double *p = points + 3 * (samples->point_count + table->numbers[slot]);
        for (int k = 0; k < 3; k++)
            p[k] = 0.5 * a[k] + 0.5 * b[k];
    }
}

static uint32_t *push_face(uint32_t *out, uint32_t a, uint32_t b, uint32_t c) {
    out[0] = a;
    out[1] = b;
    out[2] = c;
    return out + 3;
}

/* Cuts a quadrilateral along its shorter diagonal. */
static uint32_t *push_quad(uint32_t *out, const double *points, const uint32_t q[4]) {
    double first = vec3_distance_squared(points + 3 * (size_t)q[0], points + 3 * (size_t)q[2]);
    double second = vec3_distance_squared(points + 3 * (size_t)q[1], points + 3 * (size_t)q[3]);
    size_t s = second < first;
    out = push_face(out, q[s], q[s + 1], q[s + 2]);
    return push_face(out, q[s + 2], q[(s + 3) % 4], q[s]);
}

/* Cuts one face; m[k] is the new point on the edge from corner k, or EDGE_NONE. */
static uint32_t *cut_face(uint32_t *out, const double *points, const uint32_t v[3],
                          const uint32_t m[3]) {
    size_t count = 0, k = 0;
    for (size_t i = 0; i < 3; i++)
        count += m[i] != EDGE_NONE;
    if (count == 0)
        return push_face(out, v[0], v[1], v[2]);
    if (count == 3) {
        for (size_t i = 0; i < 3; i++)
            out = push_face(out, v[i], m[i], m[(i + 2) % 3]);
        return push_face(out, m[0], m[1], m[2]);
    }
    if (count == 1) {
        while (m[k] == EDGE_NONE)
            k++;
        out = push_face(out, v[k], m[k], v[(k + 2) % 3]);
        return push_face(out, m[k], v[(k + 1) % 3], v[(k + 2) % 3]);
    }
    while (m[k] != EDGE_NONE) /* to the edge that is not split */
        k++;
    uint32_t next = m[(k + 1) % 3], last = m[(k + 2) % 3];
    out = push_face(out, next, v[(k + 2) % 3], last);
    const uint32_t quad[4] = {v[k], v[(k + 1) % 3], next, last};
    return push_quad(out, points, quad);
}

static size_t cut_faces(const surface_samples *samples, const edge_table *table,
                        const double *points, uint32_t *faces) {
    uint32_t *out = faces;
    for (size_t f = 0; f < samples->face_count; f++) {
        const uint32_t *v = samples->faces + 3 * f;
        uint32_t m[3];
        for (size_t k = 0; k < 3; k++) {
            uint32_t number = edge_table_find(table, v[k], v[(k + 1) % 3]);
            m[k] = number == EDGE_NONE ? EDGE_NONE : (uint32_t)samples->point_count + number;
        }
        out = cut_face(out, points, v, m);
    }
    return (size_t)(out - faces) / 3;
}

/* How many faces more there will be: one for each edge of a face that is split. Where parts of a
 * solid share an edge, it has more than two faces. */
static size_t count_added(const surface_samples *samples, const edge_table *table) {
    size_t added = 0;
    for (size_t f = 0; f < samples->face_count; f++)
        for (size_t k = 0; k < 3; k++)
            added += edge_table_find(table, samples->faces[3 * f + k],
                                     samples->faces[3 * f + (k + 1) % 3]) != EDGE_NONE;
    return added;
}

/* Splits long edges at their midpoints, and their faces; *splits is their number. */
static starg_status refine(starg_context *context, surface_samples *samples, double longest,
                           size_t *splits) {
    SCOPED_BY(edge_table_free) edge_table table = {0};
    SCOPED_BY(samples_free) surface_samples finer = {0};
    *splits = 0;
    TRY(number_splits(context, samples, longest, &table));
    if (table.count == 0)
        return STARG_OK;
    finer.point_count = samples->point_count + table.count;
    finer.face_count = samples->face_count + count_added(samples, &table);
    NEW(context, STAGE, finer.points, 3 * finer.point_count);
    NEW(context, STAGE, finer.faces, 3 * finer.face_count);
    place_points(samples, &table, finer.points);
    finer.face_count = cut_faces(samples, &table, finer.points, finer.faces);
    *splits = table.count;
    samples_free(samples);
    *samples = finer;
    finer = (surface_samples){0};
    return STARG_OK;
}

static starg_status copy_mesh(starg_context *context, const starg_mesh *mesh,
                              surface_samples *samples) {
    samples->point_count = mesh->vertex_count;
    samples->face_count = mesh->face_count;
    NEW(context, STAGE, samples->points, 3 * mesh->vertex_count);
    NEW(context, STAGE, samples->faces, 3 * mesh->face_count);
    memcpy(samples->points, mesh->vertices, 3 * mesh->vertex_count * sizeof *samples->points);
    memcpy(samples->faces, mesh->faces, 3 * mesh->face_count * sizeof *samples->faces);
    return STARG_OK;
}

/* Moves the points a little along the edges and normals of faces, so that no four are cocircular
 * and no five cospherical: copies that are turned, or shaken by far less, then have the same
 * Delaunay tetrahedra. */
static void move_points(surface_samples *samples) {
    for (size_t f = 0; f < samples->face_count; f++) {
        double *p = samples->points + 3 * (size_t)samples->faces[3 * f];
        double *q = samples->points + 3 * (size_t)samples->faces[3 * f + 1];
        double *r = samples->points + 3 * (size_t)samples->faces[3 * f + 2];
        double n[3], d[3];
        vec3_triangle_normal(p, q, r, n);
        double length = sqrt(vec3_length(n));
        starg_rng rng = starg_rng_make(0, STREAM_SAMPLES, f);
        for (int j = 0; j < 3; j++) {
            double along = MOVE * starg_rng_unit(&rng);
            double up = MOVE * (starg_rng_unit(&rng) - 0.5) / length;
            vec3_subtract(q, p, d);
            for (int k = 0; k < 3 && length > 0 && length < INFINITY; k++)
                p[k] += along * d[k] + up * n[k];
            double *first = p;
            p = q;
            q = r;
            r = first;
        }
    }
}

starg_status samples_create(starg_context *context, const starg_solid *solid, size_t wanted,
                            bool moved, surface_samples *samples) {
    *samples = (surface_samples){0};
    TRY(copy_mesh(context, solid->mesh, samples));
    /* twice the edge of equilateral triangles that share the area evenly */
    double longest = 2 * sqrt(1.1547 * solid->check->area / (double)wanted);
    size_t splits = 1;
    size_t most = solid->mesh->vertex_count + MOST_ADDED * wanted;
    for (int round = 0; splits > 0 && samples->point_count < most && round < MAX_ROUNDS; round++) {
        TRY(starg_check_cancel(context, STAGE));
        TRY(refine(context, samples, longest, &splits));
    }
    if (moved)
        move_points(samples);
    return STARG_OK;
}

void samples_free(surface_samples *samples) {
    RELEASE(samples->points, samples->faces);
    *samples = (surface_samples){0};
}
