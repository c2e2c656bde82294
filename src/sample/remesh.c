/* SPDX-License-Identifier: Apache-2.0 */
/* Coarsens and smooths an isosurface.
 *
 * Stages: half-edges; collapse of the shortest edges down to the wanted number of vertices; then
 * rounds of edge flips (towards Delaunay) and tangential smoothing, where each vertex moves to the
 * mean of its neighbours and back onto the surface.
 *
 * Edge length is relative to the square root of the solid's local thickness, so that thin limbs get
 * smaller triangles. Passes with a slowly rising limit collapse the shortest edges first: this
 * needs no priority queue and is as good here.
 *
 * Invariants: the mesh stays a closed 2-manifold of the same genus: an edge is collapsed only under
 * the link condition (its ends have exactly two common neighbours) and flipped only if the new edge
 * does not exist; neither rotates a normal by much.
 *
 * Cost: O(n) per pass; the number of passes grows with the logarithm of the coarsening. */
#include "sample/solids.h"

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "mesh/halfedges.h"

static const char STAGE[] = "sample";

enum { MAX_RING = 32, MAX_VALENCE = 10, ROUNDS = 5, BLOCK = 2048 };

static const double MIN_QUALITY = 0.1;

typedef struct surface {
    starg_context *context;
    const implicit_field *field;
    mesh_halfedges mesh;
    size_t vertex_count, halfedge_count; /* removed ones included */
    size_t live;                         /* vertices */
    double *positions, *moved;
    double *thickness; /* of the solid at each vertex */
} surface;

static const double *position(const surface *s, uint32_t v) {
    return s->positions + 3 * (size_t)v;
}

static uint32_t edge_end(const surface *s, uint32_t h) {
    return halfedges_end(&s->mesh, h);
}

static void surface_free(surface *s) {
    RELEASE(s->positions, s->moved, s->thickness);
    halfedges_free(&s->mesh);
}

static starg_status surface_make(surface *s, const starg_mesh *raw) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    s->vertex_count = s->live = raw->vertex_count;
    s->halfedge_count = 3 * raw->face_count;
    NEW(s->context, STAGE, s->positions, 3 * s->vertex_count);
    NEW(s->context, STAGE, s->moved, 3 * s->vertex_count);
    NEW(s->context, STAGE, s->thickness, s->vertex_count);
    memcpy(s->positions, raw->vertices, 3 * s->vertex_count * sizeof *s->positions);
    TRY(topology_create(s->context, raw, &topology));
    return halfedges_create(topology, raw, STAGE, &s->mesh);
}

/* The half-edges around v; 0 if there are more than MAX_RING. */
static size_t ring_of(const surface *s, uint32_t v, uint32_t ring[MAX_RING]) {
    return halfedges_ring(&s->mesh, v, ring, MAX_RING);
}

/* ---- work on all vertices ---- */

typedef void vertex_work(const surface *s, uint32_t v);

typedef struct vertex_job {
    const surface *s;
    vertex_work *work;
} vertex_job;

static starg_status run_block(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)context;
    (void)scratch;
    const vertex_job *job = shared;
    size_t end = (item + 1) * BLOCK;
    if (end > job->s->vertex_count)
        end = job->s->vertex_count;
    for (size_t v = item * BLOCK; v < end; v++)
        if (job->s->mesh.leaving.data[v] != TOPOLOGY_NONE)
            job->work(job->s, (uint32_t)v);
    return STARG_OK;
}

/* Every vertex writes only its own data, so the order does not matter. */
static starg_status for_vertices(const surface *s, vertex_work *work) {
    vertex_job job = {.s = s, .work = work};
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = (s->vertex_count + BLOCK - 1) / BLOCK,
                                .shared = &job,
                                .item = run_block};
    return starg_parallel_for(s->context, &loop);
}

static void measure_thickness(const surface *s, uint32_t v) {
    s->thickness[v] = implicit_evaluate(s->field, position(s, v)).radius;
}

/* ---- collapse ---- */

/* Squared length over thickness. */
static double edge_cost(const surface *s, uint32_t h) {
    uint32_t a = halfedges_start(&s->mesh, h), b = edge_end(s, h);
    return 2 * vec3_distance_squared(position(s, a), position(s, b)) /
           (s->thickness[a] + s->thickness[b]);
}

/* Quality of a face seen along the unit `normal`: the sine of the angle between its longest and its
 * shortest edge, negative if it faces the other way. Needles score well here, because collapsing
 * their short edge fixes them. */
static double shape_quality(const double *a, const double *b, const double *c,
                            const double normal[3]) {
    double own[3], ab = vec3_distance_squared(a, b), bc = vec3_distance_squared(b, c);
    double ca = vec3_distance_squared(c, a);
    vec3_triangle_normal(a, b, c, own);
    return vec3_dot(own, normal) / sqrt(fmax(ab, fmax(bc, ca)) * fmin(ab, fmin(bc, ca)));
}

/* If the vertex moved to p, would each face of its ring, except those with `gone`, be acceptable or
 * better than now? */
static bool ring_keeps_shape(const surface *s, const uint32_t *ring, size_t count, uint32_t gone,
                             const double p[3], const double normal[3]) {
    for (size_t i = 0; i < count; i++) {
        uint32_t b = edge_end(s, ring[i]), c = halfedges_apex(&s->mesh, ring[i]);
        if (b == gone || c == gone)
            continue;
        const double *pa = position(s, halfedges_start(&s->mesh, ring[i]));
        const double *pb = position(s, b), *pc = position(s, c);
        double before = shape_quality(pa, pb, pc, normal);
        if (!(shape_quality(p, pb, pc, normal) > fmin(MIN_QUALITY, before)))
            return false;
    }
    return true;
}

/* Where the ends of h can merge: at the midpoint, or else at one of them. */
static bool find_place(const surface *s, uint32_t h, const uint32_t *ring_a, size_t count_a,
                       const uint32_t *ring_b, size_t count_b, double p[3]) {
    static const double places[3] = {0.5, 0, 1};
    double normal[3];
    uint32_t a = halfedges_start(&s->mesh, h), b = edge_end(s, h);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            p[k] = (1 - places[i]) * position(s, a)[k] + places[i] * position(s, b)[k];
        implicit_project(s->field, p, 1, normal);
        if (ring_keeps_shape(s, ring_a, count_a, b, p, normal) &&
            ring_keeps_shape(s, ring_b, count_b, a, p, normal))
            return true;
    }
    return false;
}

/* Collapses the edge if topology and shape allow it; returns whether it did. */
static bool collapse_edge(surface *s, uint32_t h) {
    uint32_t ring_a[MAX_RING], ring_b[MAX_RING], ring_c[MAX_RING], ring_d[MAX_RING];
    uint32_t a = halfedges_start(&s->mesh, h), b = edge_end(s, h);
    uint32_t c = halfedges_apex(&s->mesh, h),
             d = halfedges_apex(&s->mesh, halfedges_twin(&s->mesh, h));
    size_t count_a = ring_of(s, a, ring_a), count_b = ring_of(s, b, ring_b);
    if (count_a == 0 || count_b == 0 || count_a + count_b > MAX_VALENCE + 4)
        return false;
    if (ring_of(s, c, ring_c) <= 3 || ring_of(s, d, ring_d) <= 3)
        return false;
    if (halfedges_common(&s->mesh, ring_a, count_a, ring_b, count_b) != 2)
        return false;
    double p[3];
    if (!find_place(s, h, ring_a, count_a, ring_b, count_b, p))
        return false;
    halfedges_collapse(&s->mesh, h);
    s->live--;
    vec3_copy(p, s->positions + 3 * (size_t)a);
    s->thickness[a] = 0.5 * (s->thickness[a] + s->thickness[b]);
    return true;
}

/* ---- flips ---- */

/* Cotangent of the angle at p. */
static double cotangent(const double p[3], const double a[3], const double b[3]) {
    double u[3], v[3], n[3];
    vec3_subtract(a, p, u);
    vec3_subtract(b, p, v);
    vec3_cross(u, v, n);
    double area = vec3_length(n);
    return area > 0 ? vec3_dot(u, v) / area : 1e9;
}

/* Do the faces (a, d, c) and (d, b, c) face the same way as (a, b, c) and (b, a, d) together? */
static bool flip_keeps_side(const double *a, const double *b, const double *c, const double *d) {
    double before[3], other[3], after[2][3];
    vec3_triangle_normal(a, b, c, before);
    vec3_triangle_normal(b, a, d, other);
    vec3_along(before, 1, other, before);
    vec3_triangle_normal(a, d, c, after[0]);
    vec3_triangle_normal(d, b, c, after[1]);
    for (int i = 0; i < 2; i++)
        if (!(vec3_dot(before, after[i]) > 0.6 * vec3_length(before) * vec3_length(after[i])))
            return false;
    return true;
}

static bool is_flip_wanted(const surface *s, uint32_t h) {
    uint32_t t = halfedges_twin(&s->mesh, h), a = halfedges_start(&s->mesh, h),
             b = halfedges_start(&s->mesh, t);
    uint32_t c = halfedges_apex(&s->mesh, h), d = halfedges_apex(&s->mesh, t);
    const double *pa = position(s, a), *pb = position(s, b);
    const double *pc = position(s, c), *pd = position(s, d);
    if (cotangent(pc, pa, pb) + cotangent(pd, pa, pb) >= -1e-9)
        return false;
    uint32_t ring[MAX_RING];
    size_t count_a = ring_of(s, a, ring), count_b = ring_of(s, b, ring);
    if (count_a == 0 || count_b == 0 || count_a <= 3 || count_b <= 3)
        return false;
    size_t count_c = ring_of(s, c, ring), count_d = ring_of(s, d, ring);
    if (count_c == 0 || count_d == 0 || count_c > MAX_VALENCE || count_d > MAX_VALENCE)
        return false;
    return halfedges_find(&s->mesh, c, d) == TOPOLOGY_NONE && flip_keeps_side(pa, pb, pc, pd);
}

/* An edge is represented by the lower of its two half-edges. */
static bool is_edge(const surface *s, uint32_t h) {
    uint32_t twin = halfedges_twin(&s->mesh, h);
    return twin != TOPOLOGY_NONE && h < twin;
}

/* The start of faces and rings determines the bytes of a sample: the first face begins at the start
 * of h, and the ring of the other opposite corner keeps its start in the second. */
static void flip_edge(surface *s, uint32_t h) {
    uint32_t twin = halfedges_twin(&s->mesh, h), x = halfedges_apex(&s->mesh, twin);
    halfedges_flip(&s->mesh, h);
    halfedges_begin_face(&s->mesh, h - h % 3 + 1);
    s->mesh.leaving.data[x] = twin - twin % 3;
}

static void flip_edges(surface *s) {
    for (uint32_t h = 0; h < s->halfedge_count; h++)
        if (is_edge(s, h) && is_flip_wanted(s, h))
            flip_edge(s, h);
}

/* ---- coarsening ---- */

static double mean_cost(const surface *s) {
    double sum = 0;
    for (uint32_t h = 0; h < s->halfedge_count; h++)
        sum += edge_cost(s, h);
    return s->halfedge_count ? sum / (double)s->halfedge_count : 0;
}

/* Passes over all edges with a rising limit, until the number is reached or nothing more can
 * collapse: at 10^6 times the mean cost every edge has been tried. */
static starg_status coarsen(surface *s, size_t vertex_count) {
    double mean = mean_cost(s);
    for (double limit = 0.02 * mean; s->live > vertex_count && limit < 1e6 * mean; limit *= 1.35) {
        TRY(starg_check_cancel(s->context, STAGE));
        for (uint32_t h = 0; h < s->halfedge_count && s->live > vertex_count; h++)
            if (is_edge(s, h) && edge_cost(s, h) < limit)
                collapse_edge(s, h);
        flip_edges(s);
    }
    return STARG_OK;
}

/* ---- smoothing ---- */

/* New place of v: towards the mean of its neighbours, along the surface, unless that would spoil a
 * face. Written to `moved`. */
static void propose_move(const surface *s, uint32_t v) {
    uint32_t ring[MAX_RING];
    size_t count = ring_of(s, v, ring);
    double *p = s->moved + 3 * (size_t)v, step[3] = {0, 0, 0}, normal[3];
    vec3_copy(position(s, v), p);
    if (count == 0)
        return;
    for (size_t i = 0; i < count; i++)
        vec3_along(step, 1 / (double)count, position(s, edge_end(s, ring[i])), step);
    vec3_subtract(step, p, step);
    implicit_sample here = implicit_evaluate(s->field, p);
    double square = vec3_dot(here.gradient, here.gradient);
    if (square < 1e-4)
        return;
    vec3_along(step, -vec3_dot(step, here.gradient) / square, here.gradient, step);
    vec3_along(p, 0.6, step, p);
    implicit_project(s->field, p, 2, normal);
    if (!ring_keeps_shape(s, ring, count, TOPOLOGY_NONE, p, normal))
        vec3_copy(position(s, v), p);
}

static starg_status smooth(surface *s) {
    starg_status status = for_vertices(s, propose_move);
    double *former = s->positions;
    s->positions = s->moved;
    s->moved = former;
    return status;
}

/* ---- result ---- */

/* Makes the mesh of the remaining vertices. */
static starg_status compact(const surface *s, starg_mesh **out) {
    size_t face_count = 0;
    SCOPED uint32_t *faces = NULL, *number = NULL;
    SCOPED double *vertices = NULL;
    for (size_t f = 0; f < s->halfedge_count / 3; f++)
        face_count += halfedges_face_lives(&s->mesh, f);
    NEW(s->context, STAGE, number, s->vertex_count);
    NEW(s->context, STAGE, vertices, 3 * s->live);
    NEW(s->context, STAGE, faces, 3 * face_count);
    uint32_t count = halfedges_compact(&s->mesh, number, faces);
    for (uint32_t v = 0; v < s->vertex_count; v++)
        if (s->mesh.leaving.data[v] != TOPOLOGY_NONE)
            vec3_copy(position(s, v), vertices + 3 * (size_t)number[v]);
    return starg_mesh_create(s->context, vertices, count, faces, face_count, out);
}

starg_status remesh_isosurface(starg_context *context, const implicit_field *field,
                               const starg_mesh *raw, size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(surface_free) surface s = {.context = context, .field = field};
    *out = NULL;
    TRY(surface_make(&s, raw));
    TRY(for_vertices(&s, measure_thickness));
    TRY(coarsen(&s, vertex_count));
    for (int round = 0; round < ROUNDS; round++) {
        flip_edges(&s);
        TRY(smooth(&s));
    }
    flip_edges(&s);
    return compact(&s, out);
}
