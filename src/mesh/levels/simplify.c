/* SPDX-License-Identifier: Apache-2.0 */
/* Simplification by edge collapses.
 *
 * Source: M. Garland, P. S. Heckbert, Surface simplification using quadric error metrics, 1997,
 * with the edge collapses of H. Hoppe, Progressive meshes, 1996.
 *
 * Each vertex has a quadric: the area-weighted squared distances to the planes of all faces merged
 * into it, plus a very small share of the weight for their corners. The share keeps the linear
 * system of the best position away from singular and distributes vertices evenly where planes do
 * not determine the position. Edges wait in a queue by the error of their best placement: the
 * optimum of the two quadrics, the midpoint or an end. If the rules (collapse.c) reject a
 * placement, the edge returns with its next best; if they reject all, it waits until one of its
 * ends changes or the queue is empty. Then all edges enter again, as long as that gains enough.
 *
 * While a surface has more than LARGE vertices, errors within a factor of two count as equal. Then
 * successive collapses are mostly neighbours on the surface, and their data in the cache.
 *
 * Invariants: the surface stays a closed 2-manifold with the same components and genus; every edge
 * is in the queue or was rejected since its ends last changed. Ties go to the lower edge. Cost: O(n
 * log n), 5 to 15 us a collapse, mostly for nearby faces. */
#include "starguard/simplify.h"

#include "geometry/vec3.h"
#include "mesh/levels/heap.h"
#include "mesh/levels/levels.h"

/* Share of the weight for points: small compared with the planes of any real feature. */
static const double POINT_SHARE = 1e-6;

enum {
    PLACEMENTS = 4,       /* optimum, middle, start, end */
    CHECK_INTERVAL = 256, /* edges between two checks of the clock */
    LEAST_GAIN = 1000,    /* another round needs one collapse per this many vertices */
    LARGE = 100000        /* vertices above which the queue is coarse */
};

/* ---- quadric error metrics [Garland, Heckbert 1997] ---- */

/* Weighted sum of squared distances to planes and points, as a polynomial in the offset d from a
 * reference point: d.Ad + 2 b.d + c. */
typedef struct quadric {
    double xx, xy, xz, yy, yz, zz; /* A */
    double b[3], c;
} quadric;

/* Adds a plane through the reference point; the length of `normal` is the weight. Adds the point
 * itself with `share` of the weight. */
static void quadric_add_plane(quadric *q, const double normal[3], double share) {
    double weight = vec3_length(normal);
    if (!(weight > 0))
        return;
    q->xx += normal[0] * normal[0] / weight + share * weight;
    q->xy += normal[0] * normal[1] / weight;
    q->xz += normal[0] * normal[2] / weight;
    q->yy += normal[1] * normal[1] / weight + share * weight;
    q->yz += normal[1] * normal[2] / weight;
    q->zz += normal[2] * normal[2] / weight + share * weight;
}

/* out = A d */
static void quadric_apply(const quadric *q, const double d[3], double out[3]) {
    out[0] = q->xx * d[0] + q->xy * d[1] + q->xz * d[2];
    out[1] = q->xy * d[0] + q->yy * d[1] + q->yz * d[2];
    out[2] = q->xz * d[0] + q->yz * d[1] + q->zz * d[2];
}

static double quadric_error(const quadric *q, const double d[3]) {
    double ad[3];
    quadric_apply(q, d, ad);
    return vec3_dot(d, ad) + 2 * vec3_dot(q->b, d) + q->c;
}

/* Moves the reference point by d. */
static void quadric_shift(quadric *q, const double d[3]) {
    double ad[3];
    quadric_apply(q, d, ad);
    q->c += vec3_dot(d, ad) + 2 * vec3_dot(q->b, d);
    vec3_along(q->b, 1, ad, q->b);
}

/* Adds a quadric with the same reference point. */
static void quadric_add(quadric *q, const quadric *other) {
    q->xx += other->xx;
    q->xy += other->xy;
    q->xz += other->xz;
    q->yy += other->yy;
    q->yz += other->yz;
    q->zz += other->zz;
    vec3_along(q->b, 1, other->b, q->b);
    q->c += other->c;
}

/* The offset of least error, A d = -b by root-free Cholesky decomposition; false if A is too close
 * to singular. */
static bool quadric_optimum(const quadric *q, double d[3]) {
    double least = 1e-10 * (q->xx + q->yy + q->zz);
    double p0 = q->xx, l1 = q->xy / p0, l2 = q->xz / p0;
    double p1 = q->yy - l1 * q->xy, m = q->yz - l2 * q->xy, l3 = m / p1;
    double p2 = q->zz - l2 * q->xz - l3 * m;
    if (!(p0 > least && p1 > least && p2 > least))
        return false;
    double y0 = -q->b[0], y1 = -q->b[1] - l1 * y0, y2 = -q->b[2] - l2 * y0 - l3 * y1;
    d[2] = y2 / p2;
    d[1] = y1 / p1 - l3 * d[2];
    d[0] = y0 / p0 - l1 * d[1] - l2 * d[2];
    return true;
}

/* ---- the surface and its queue ---- */

typedef struct simplifier {
    starg_context *context;
    mesh_surface *surface;
    dynamic_bvh *tree; /* NULL: intersections are allowed */
    mesh_heap *queue;  /* of edges */
    quadric *quadrics; /* per vertex, about its position */
    uint8_t *attempt;  /* per edge: number of rejected placements */
    size_t gain;       /* collapses in this round */
    size_t handled;    /* edges taken from the queue */
} simplifier;

/* ---- placements ---- */

typedef struct placement {
    double error, position[3];
} placement;

/* Sum of the quadrics of an edge's ends, relative to its start. */
static quadric edge_quadric(const simplifier *s, uint32_t a, uint32_t b) {
    quadric sum = s->quadrics[a], other = s->quadrics[b];
    double back[3];
    surface_difference(s->surface, surface_at(s->surface, a), surface_at(s->surface, b), back);
    quadric_shift(&other, back);
    quadric_add(&sum, &other);
    return sum;
}

static double rounded_error(const quadric *q, const double offset[3]) {
    return fmax(quadric_error(q, offset), 0); /* 0 for NaN, too */
}

/* The optimum, unless it is farther from the midpoint than the edge is long. */
static double try_optimum(const mesh_surface *surface, const quadric *q, const double edge[3],
                          const double start[3], double position[3]) {
    double offset[3], from_middle[3];
    if (!quadric_optimum(q, offset))
        return INFINITY;
    vec3_along(offset, -0.5, edge, from_middle);
    if (!(vec3_dot(from_middle, from_middle) <= vec3_dot(edge, edge)))
        return INFINITY;
    vec3_along(start, 1 / surface->scale, offset, position);
    for (int k = 0; k < 3; k++)
        if (!(fabs(position[k]) < STARG_COORDINATE_LIMIT))
            return INFINITY;
    return rounded_error(q, offset);
}

/* The edge's placement of `rank` by error (0: the best); false if there is none. */
static bool place(const simplifier *s, uint32_t edge, int rank, placement *out) {
    const mesh_surface *surface = s->surface;
    uint32_t h = surface->halfedge[edge], a = halfedges_start(&surface->mesh, h),
             b = halfedges_end(&surface->mesh, h);
    const double *start = surface_at(surface, a), *end = surface_at(surface, b);
    quadric q = edge_quadric(s, a, b);
    double along[3], middle[3];
    placement all[PLACEMENTS];
    surface_difference(surface, end, start, along);
    all[0].error = try_optimum(surface, &q, along, start, all[0].position);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * along[k];
        all[1].position[k] = 0.5 * start[k] + 0.5 * end[k];
    }
    all[1].error = rounded_error(&q, middle);
    all[2].error = rounded_error(&q, (const double[3]){0, 0, 0});
    all[3].error = rounded_error(&q, along);
    vec3_copy(start, all[2].position);
    vec3_copy(end, all[3].position);
    for (int i = 0; i < PLACEMENTS; i++) {
        int better = 0;
        for (int j = 0; j < PLACEMENTS; j++)
            better += all[j].error < all[i].error || (j < i && all[j].error == all[i].error);
        if (better == rank) {
            *out = all[i];
            return all[i].error < INFINITY;
        }
    }
    return false;
}

/* ---- the queue ---- */

static double key_of(const simplifier *s, double error) {
    int exponent;
    if (s->surface->vertices_left <= LARGE || !(error > 0))
        return error;
    frexp(error, &exponent);
    return ldexp(1, exponent);
}

static void enter(simplifier *s, uint32_t edge, int attempt) {
    placement next;
    s->attempt[edge] = (uint8_t)attempt;
    if (place(s, edge, attempt, &next))
        heap_set(s->queue, edge, key_of(s, next.error));
    else
        heap_remove(s->queue, edge);
}

static void enter_all(simplifier *s) {
    for (uint32_t e = 0; e < s->surface->edge_count; e++)
        if (s->surface->halfedge[e] != TOPOLOGY_NONE)
            enter(s, e, 0);
    s->gain = 0;
}

static void make_quadrics(simplifier *s) {
    const mesh_surface *surface = s->surface;
    for (size_t f = 0; f < surface->face_count; f++) {
        const uint32_t *corner = surface_face(surface, f);
        double u[3], v[3], normal[3];
        surface_difference(surface, surface_at(surface, corner[1]), surface_at(surface, corner[0]),
                           u);
        surface_difference(surface, surface_at(surface, corner[2]), surface_at(surface, corner[0]),
                           v);
        vec3_cross(u, v, normal);
        for (int k = 0; k < 3; k++)
            quadric_add_plane(&s->quadrics[corner[k]], normal, POINT_SHARE);
    }
}

/* ---- collapses ---- */

static starg_status collapse(simplifier *s, const collapse_star *star, const double position[3]) {
    mesh_surface *surface = s->surface;
    uint32_t h = star->halfedge, twin = halfedges_twin(&surface->mesh, h), a = star->a;
    quadric sum = edge_quadric(s, a, star->b);
    double offset[3];
    surface_difference(surface, position, surface_at(surface, a), offset);
    quadric_shift(&sum, offset);
    s->quadrics[a] = sum;
    heap_remove(s->queue, surface->edge[h]);
    heap_remove(s->queue, surface->edge[corner_next(h)]);
    heap_remove(s->queue, surface->edge[corner_previous(twin)]);
    if (s->tree != NULL) {
        dynamic_bvh_remove(s->tree, h / 3);
        dynamic_bvh_remove(s->tree, twin / 3);
    }
    surface_collapse(surface, h, position);
    for (size_t i = 0; i < star->count; i++) {
        enter(s, surface->edge[star->kept[i]], 0);
        if (s->tree != NULL)
            dynamic_bvh_update(s->tree, star->kept[i] / 3);
    }
    s->gain++;
    return s->tree != NULL ? dynamic_bvh_renew(s->tree) : STARG_OK;
}

static starg_status try_collapse(simplifier *s, uint32_t edge) {
    collapse_star star;
    placement at;
    if (!collapse_gather(s->surface, s->surface->halfedge[edge], &star) ||
        !place(s, edge, s->attempt[edge], &at))
        return STARG_OK;
    if (collapse_keeps_shape(s->surface, &star, at.position) &&
        (s->tree == NULL || collapse_keeps_embedding(s->surface, s->tree, &star, at.position)))
        return collapse(s, &star, at.position);
    enter(s, edge, s->attempt[edge] + 1);
    return STARG_OK;
}

/* The next edge; false if nothing more can be gained. */
static bool next_edge(simplifier *s, uint32_t *edge) {
    if (heap_pop(s->queue, edge))
        return true;
    if (s->gain == 0 || s->gain < s->surface->vertices_left / LEAST_GAIN)
        return false;
    enter_all(s);
    return heap_pop(s->queue, edge);
}

static starg_status look_up(simplifier *s, size_t target) {
    const mesh_surface *surface = s->surface;
    starg_progress_step(s->context, surface->vertex_count - surface->vertices_left,
                        surface->vertex_count - target);
    if (starg_time_is_over(s->context))
        return starg_fail(s->context, STARG_ERROR_TIME, "simplify",
                          "time limit reached at %zu vertices, before the target of %zu",
                          surface->vertices_left, target);
    return starg_check_cancel(s->context, "simplify");
}

/* Collapses edges until `target` vertices are left or nothing more can be gained. */
static starg_status reduce(simplifier *s, size_t target) {
    uint32_t edge;
    IN_STAGE(s->context, "simplify");
    while (s->surface->vertices_left > target) {
        if (s->handled++ % CHECK_INTERVAL == 0)
            TRY(look_up(s, target));
        if (!next_edge(s, &edge))
            break;
        TRY(try_collapse(s, edge));
    }
    return STARG_OK;
}

/* ---- start and result ---- */

static starg_status begin(simplifier *s, starg_context *context, const starg_mesh *mesh,
                          const starg_simplify_options *options) {
    s->context = context;
    TRY(surface_create(context, mesh, &s->surface));
    TRY(heap_create(context, s->surface->edge_count, &s->queue));
    NEW_ZERO(context, "simplify", s->quadrics, mesh->vertex_count);
    NEW(context, "simplify", s->attempt, s->surface->edge_count);
    if (options == NULL || !options->allow_intersections)
        TRY(dynamic_bvh_create(context, s->surface, &s->tree));
    make_quadrics(s);
    enter_all(s);
    return STARG_OK;
}

static void end(simplifier *s) {
    surface_free(s->surface);
    dynamic_bvh_free(s->tree);
    heap_free(s->queue);
    RELEASE(s->quadrics, s->attempt);
}

/* Makes a mesh of the current surface, and maps each input vertex to its vertex there. */
static starg_status snapshot(const mesh_surface *surface, uint32_t *number, starg_mesh **out) {
    starg_context *context = surface->context;
    SCOPED double *vertices = NULL;
    SCOPED uint32_t *faces = NULL;
    *out = NULL;
    NEW(context, "simplify", vertices, 3 * surface->vertices_left);
    NEW(context, "simplify", faces, 3 * surface->faces_left);
    halfedges_compact(&surface->mesh, number, faces);
    for (size_t v = 0; v < surface->vertex_count; v++)
        if (surface->merged[v] == v)
            vec3_copy(surface_at(surface, (uint32_t)v), vertices + 3 * (size_t)number[v]);
    for (size_t v = 0; v < surface->vertex_count; v++) {
        uint32_t root = surface->merged[v];
        if (root == TOPOLOGY_NONE)
            number[v] = STARG_NO_VERTEX;
        else if (root != v)
            number[v] = number[sets_find(surface->merged, root)];
    }
    TRY(starg_mesh_adopt(context, vertices, surface->vertices_left, faces, surface->faces_left,
                         out));
    vertices = NULL;
    faces = NULL;
    return STARG_OK;
}

/* ---- public functions ---- */

void starg_simplify_options_default(starg_simplify_options *options) {
    *options = (starg_simplify_options){0};
}

starg_status starg_mesh_simplify(starg_context *context, const starg_mesh *mesh,
                                 size_t target_vertex_count, const starg_simplify_options *options,
                                 uint32_t *vertex_map, starg_mesh **out) {
    SCOPED_BY(end) simplifier s = {0};
    SCOPED uint32_t *own_map = NULL;
    *out = NULL;
    TRY(begin(&s, context, mesh, options));
    TRY(reduce(&s, target_vertex_count));
    if (vertex_map == NULL) {
        NEW(context, "simplify", own_map, mesh->vertex_count);
        vertex_map = own_map;
    }
    return snapshot(s.surface, vertex_map, out);
}

/* Levels built so far, from the finest on. */
typedef struct level_list {
    starg_levels *out;
    uint32_t *of_finest; /* per vertex of the input its vertex in the last level */
} level_list;

/* The sizes of the levels. */
typedef struct ladder {
    size_t coarsest, step;
} ladder;

/* Target vertex count below a level of `finer` vertices, more than the coarsest. */
static size_t next_target(const ladder *sizes, size_t finer) {
    if (sizes->step == STARG_QUARTERS)
        return finer / 4 > sizes->coarsest ? finer / 4 : sizes->coarsest;
    return sizes->coarsest + (finer - sizes->coarsest - 1) / sizes->step * sizes->step;
}

/* Smallest reduction that makes a level, given that the one above has `finer` vertices: a quarter
 * of a step. */
static size_t least_difference(const ladder *sizes, size_t finer) {
    size_t step = sizes->step == STARG_QUARTERS ? finer - finer / 4 : sizes->step;
    return step - 3 * (step / 4);
}

/* Upper bound on the levels: the input and one for each target below it. */
static size_t most_levels(const ladder *sizes, size_t vertices) {
    size_t count = 1;
    for (size_t left = vertices; left > sizes->coarsest; count++)
        left = next_target(sizes, left);
    return count;
}

/* Appends the surface as a level, unless it is too similar to the last one. */
static starg_status add_level(simplifier *s, level_list *list, const ladder *sizes,
                              uint32_t *number) {
    starg_context *context = s->context;
    size_t finer = list->out->levels[list->out->count - 1].mesh->vertex_count;
    SCOPED uint32_t *map = NULL;
    starg_mesh *mesh = NULL;
    if (finer - s->surface->vertices_left < least_difference(sizes, finer))
        return STARG_OK;
    NEW(context, "simplify", map, finer);
    TRY(snapshot(s->surface, number, &mesh));
    memset(map, 0xff, finer * sizeof *map); /* fills with STARG_NO_VERTEX */
    for (size_t v = 0; v < s->surface->vertex_count; v++) {
        if (list->of_finest[v] != STARG_NO_VERTEX)
            map[list->of_finest[v]] = number[v];
        list->of_finest[v] = number[v];
    }
    list->out->levels[list->out->count++] = (starg_level){mesh, map};
    map = NULL;
    return STARG_OK;
}

static starg_status add_levels(starg_context *context, const starg_mesh *mesh, const ladder *sizes,
                               const starg_simplify_options *options, level_list *list) {
    SCOPED_BY(end) simplifier s = {0};
    SCOPED uint32_t *number = NULL;
    TRY(begin(&s, context, mesh, options));
    NEW(context, "simplify", number, mesh->vertex_count);
    for (size_t target = mesh->vertex_count; target > sizes->coarsest;) {
        target = next_target(sizes, target);
        TRY(reduce(&s, target));
        TRY(add_level(&s, list, sizes, number));
    }
    return STARG_OK;
}

/* Reverses the list: coarsest first. */
static void reverse(starg_levels *levels) {
    for (size_t i = 0, j = levels->count; i + 1 < j--; i++) {
        starg_level swap = levels->levels[i];
        levels->levels[i] = levels->levels[j];
        levels->levels[j] = swap;
    }
}

starg_status starg_mesh_levels(starg_context *context, const starg_mesh *mesh, size_t coarsest,
                               size_t step, const starg_simplify_options *options,
                               starg_levels **out) {
    starg_status status = STARG_OK;
    level_list list = {0};
    const ladder sizes = {coarsest, step};
    *out = NULL;
    if (step == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "simplify",
                          "the step between levels is 0 vertices; it must be at least 1");
    STARG_NEW_ZERO(context, "simplify", list.out, 1);
    STARG_NEW_ZERO(context, "simplify", list.out->levels, most_levels(&sizes, mesh->vertex_count));
    STARG_NEW(context, "simplify", list.of_finest, mesh->vertex_count);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        list.of_finest[v] = (uint32_t)v;
    STARG_TRY(starg_mesh_create(context, mesh->vertices, mesh->vertex_count, mesh->faces,
                                mesh->face_count, &list.out->levels[0].mesh));
    list.out->count = 1;
    STARG_TRY(add_levels(context, mesh, &sizes, options, &list));
    reverse(list.out);
    *out = list.out;
    list.out = NULL;
done:
    starg_release(context, list.of_finest);
    starg_levels_free(context, list.out);
    return status;
}

void starg_levels_free(starg_context *context, starg_levels *levels) {
    (void)context;
    if (levels == NULL)
        return;
    for (size_t i = 0; i < levels->count; i++) {
        starg_mesh_free(levels->levels[i].mesh);
        RELEASE(levels->levels[i].vertex_map);
    }
    RELEASE(levels->levels, levels);
}
