/* SPDX-License-Identifier: Apache-2.0 */
/* A piecewise linear homeomorphism from each star-shaped piece to a ball.
 *
 * Problem: map a piece, made of tetrahedra about its guard, to a polyhedron inscribed in the unit
 * sphere, linearly on each tetrahedron and without inversions, in doubles.
 *
 * Method: the guard goes to the origin and each boundary vertex along its ray to the sphere. A
 * determinant of three rays is scaled by positive numbers only, so that all tetrahedra stay
 * positive, but for rounding. Where rounding turns one over, the directions are those of a
 * spherical embedding of the piece's boundary (sphere/sphere.h) instead; where even shares are
 * wanted, the rays are relaxed. A closed surface whose triangles are all positive, seen from the
 * origin, covers the sphere without folds; the boundary of a star-shaped piece is a sphere, so that
 * it covers it once: the images of its tetrahedra fill a ball that is star-shaped about the origin,
 * once.
 *
 * Stages for each piece: take its faces, aim, spread where that is needed, store, measure.
 * Invariant: every image is positive by the exact predicate. Cost: O(n log n); spreading:
 * sphere/sphere.c. */
#include "star/decomposition.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/singular_values.h"
#include "geometry/vec3.h"
#include "sphere/sphere.h"
#include "star/piece_faces.h"

static const char STAGE[] = "balls";
/* Ratios of singular values: from where they count as high, and what stands for more. */
static const double HIGH = 10, HIGHEST = 1e300;
static const double ORIGIN[3];

typedef struct mapping {
    starg_decomposition *d;
    starg_balls kind;
    size_t *first;         /* by piece: of its tetrahedra in `order` */
    uint32_t *order;       /* tetrahedra by piece */
    double sum, all, high; /* of volumes: times the ratio, of all, of those with high ratios */
} mapping;

/* A piece on its own: face i is that of its i-th tetrahedron opposite the guard. */
typedef struct ball {
    mapping *all;
    size_t piece, count;
    const uint32_t *tetrahedra;
    uint32_t *names;    /* by vertex: in the mesh; ascending */
    starg_mesh *mesh;   /* of the boundary, the guard at the origin, in units of its radius */
    double *directions; /* by vertex */
} ball;

static int compare_names(const void *left, const void *right) {
    uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return (a > b) - (a < b);
}

/* The corner of a tetrahedron at the guard of its piece, or 4. */
static int guard_corner(const starg_decomposition *d, size_t t) {
    int k = 0;
    while (k < 4 && !vec3_equal(tetmesh_corner(d->mesh, t, k), d->pieces[d->labels[t]].guard))
        k++;
    return k;
}

/* ---- the piece ---- */

static size_t unique(uint32_t *names, size_t count) {
    size_t kept = 0;
    qsort(names, count, sizeof *names, compare_names);
    for (size_t i = 0; i < count; i++)
        if (kept == 0 || names[kept - 1] != names[i])
            names[kept++] = names[i];
    return kept;
}

static void place_vertices(const ball *b, size_t count, double *vertices) {
    const starg_decomposition *d = b->all->d;
    double radius = 0;
    for (size_t i = 0; i < count; i++) {
        const double *at = d->mesh->vertices + 3 * (size_t)b->names[i];
        vec3_subtract(at, d->pieces[b->piece].guard, vertices + 3 * i);
        for (size_t k = 0; k < 3; k++)
            radius = fmax(radius, fabs(vertices[3 * i + k]));
    }
    int exponent;
    frexp(radius, &exponent);
    for (size_t i = 0; i < 3 * count; i++)
        vertices[i] = ldexp(vertices[i], -exponent);
}

static starg_status take_faces(starg_context *context, ball *b) {
    const starg_decomposition *d = b->all->d;
    SCOPED uint32_t *faces = NULL;
    SCOPED double *vertices = NULL;
    NEW(context, STAGE, faces, 3 * b->count);
    NEW(context, STAGE, b->names, 3 * b->count);
    for (size_t i = 0; i < b->count; i++) {
        size_t t = b->tetrahedra[i];
        piece_face_corners(d->mesh, 4 * t + (size_t)guard_corner(d, t), faces + 3 * i);
    }
    memcpy(b->names, faces, 3 * b->count * sizeof *faces);
    size_t count = unique(b->names, 3 * b->count);
    for (size_t i = 0; i < 3 * b->count; i++) {
        const uint32_t *name = bsearch(&faces[i], b->names, count, sizeof *faces, compare_names);
        faces[i] = (uint32_t)(name - b->names);
    }
    NEW(context, STAGE, vertices, 3 * count);
    place_vertices(b, count, vertices);
    TRY(starg_mesh_adopt(context, vertices, count, faces, b->count, &b->mesh));
    vertices = NULL;
    faces = NULL;
    return STARG_OK;
}

/* ---- directions ---- */

static void aim(const ball *b) {
    for (size_t i = 0; i < b->mesh->vertex_count; i++) {
        const double *p = b->mesh->vertices + 3 * i;
        double length = vec3_length(p);
        for (size_t k = 0; k < 3; k++)
            b->directions[3 * i + k] = p[k] / length;
    }
}

static bool is_positive(const ball *b) {
    for (size_t f = 0; f < b->count; f++) {
        const uint32_t *c = b->mesh->faces + 3 * f;
        if (orient3d(b->directions + 3 * (size_t)c[0], b->directions + 3 * (size_t)c[1],
                     b->directions + 3 * (size_t)c[2], ORIGIN) != 1)
            return false;
    }
    return true;
}

static starg_status spread(starg_context *context, ball *b, bool aimed) {
    SCOPED_BY(sphere_drop) sphere *s = NULL;
    TRY(aimed ? sphere_even(context, b->mesh, b->directions, &s)
              : sphere_create(context, b->mesh, &s));
    memcpy(b->directions, s->directions, 3 * b->mesh->vertex_count * sizeof *b->directions);
    return STARG_OK;
}

/* ---- results ---- */

static void store(const ball *b) {
    const starg_decomposition *d = b->all->d;
    for (size_t i = 0; i < b->count; i++) {
        size_t t = b->tetrahedra[i];
        int guard = guard_corner(d, t);
        double *corners = d->ball_corners + 12 * t;
        vec3_copy(ORIGIN, corners + 3 * guard);
        for (int k = 0; k < 3; k++) {
            size_t v = b->mesh->faces[3 * i + (size_t)k];
            vec3_copy(b->directions + 3 * v, corners + 3 * TETMESH_FACE[guard][k]);
        }
    }
}

/* Volumes are in cubic units of the piece: all three sums are scaled by the piece's own. */
static void measure(const ball *b) {
    starg_decomposition *d = b->all->d;
    double all = 0, sum = 0, high = 0;
    for (size_t i = 0; i < b->count; i++) {
        double from[3][3], to[3][3], values[3];
        for (int k = 0; k < 3; k++) {
            size_t v = b->mesh->faces[3 * i + (size_t)k];
            vec3_copy(b->mesh->vertices + 3 * v, from[k]);
            vec3_copy(b->directions + 3 * v, to[k]);
        }
        double volume = fmax(vec3_triple(from[0], from[1], from[2]), 0);
        singular_values(from, to, values);
        double ratio = values[2] > 0 ? fmin(values[0] / values[2], HIGHEST) : HIGHEST;
        d->ball_worst = fmax(d->ball_worst, ratio);
        all += volume;
        sum += volume * ratio;
        high += ratio > HIGH ? volume : 0;
    }
    double unit = all > 0 ? d->pieces[b->piece].volume / all : 0;
    b->all->all += unit * all;
    b->all->sum += unit * sum;
    b->all->high += unit * high;
}

static starg_status map_piece(starg_context *context, mapping *all, size_t item) {
    starg_status status = STARG_OK;
    starg_piece *piece = &all->d->pieces[item];
    ball b = {.all = all,
              .piece = item,
              .count = all->first[item + 1] - all->first[item],
              .tetrahedra = all->order + all->first[item]};
    STARG_TRY(starg_check_cancel(context, STAGE));
    STARG_TRY(take_faces(context, &b));
    STARG_NEW(context, STAGE, b.directions, 3 * b.mesh->vertex_count);
    aim(&b);
    bool aimed = is_positive(&b);
    piece->spread = !aimed || all->kind == STARG_BALLS_EVEN;
    if (piece->spread)
        STARG_TRY(spread(context, &b, aimed));
    store(&b);
    measure(&b);
done:
    starg_mesh_free(b.mesh);
    RELEASE(b.names, b.directions);
    return status;
}

/* ---- all pieces ---- */

static starg_status check_fans(starg_context *context, const starg_decomposition *d) {
    for (size_t p = 0; p < d->piece_count; p++)
        if (!d->pieces[p].star)
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "piece %zu is not proven to be star-shaped; only such pieces are "
                              "mapped to balls (--mode strict)",
                              p);
    for (size_t t = 0; t < d->mesh->count; t++)
        if (guard_corner(d, t) == 4) {
            uint64_t index = t;
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                                 &index, 1,
                                 "tetrahedron %zu has no corner at the guard of its piece; only "
                                 "pieces of --mode strict are mapped to balls",
                                 t);
        }
    return STARG_OK;
}

static starg_status sort_tetrahedra(starg_context *context, mapping *all) {
    const starg_decomposition *d = all->d;
    NEW_ZERO(context, STAGE, all->first, d->piece_count + 2);
    NEW(context, STAGE, all->order, d->mesh->count);
    for (size_t t = 0; t < d->mesh->count; t++)
        all->first[d->labels[t] + 2]++;
    for (size_t p = 0; p < d->piece_count; p++)
        all->first[p + 2] += all->first[p + 1];
    for (size_t t = 0; t < d->mesh->count; t++)
        all->order[all->first[d->labels[t] + 1]++] = (uint32_t)t;
    return STARG_OK;
}

starg_status balls_make(starg_context *context, starg_decomposition *d, starg_balls kind) {
    starg_status status = STARG_OK;
    mapping all = {.d = d, .kind = kind};
    if (kind == STARG_BALLS_NONE)
        return STARG_OK;
    starg_progress_begin(context, STAGE);
    STARG_TRY(check_fans(context, d));
    STARG_NEW(context, STAGE, d->ball_corners, 12 * d->mesh->count);
    STARG_TRY(sort_tetrahedra(context, &all));
    for (size_t p = 0; p < d->piece_count; p++) {
        STARG_TRY(map_piece(context, &all, p));
        starg_progress_step(context, all.first[p + 1], d->mesh->count);
    }
    d->balls = kind;
    d->ball_mean = all.sum / all.all;
    d->ball_above_10 = fmin(all.high / all.all, 1);
done:
    starg_progress_end(context);
    RELEASE(all.first, all.order);
    return status;
}
