/* SPDX-License-Identifier: Apache-2.0 */
/* Steps of a composed map that move all vertices together, as rigidly as possible.
 *
 * Problem: with vertex-by-vertex descent a limb twisted about its axis gets stuck; only together
 * can its vertices untwist. Source: local and global steps of L. Liu et al., A local/global
 * approach to mesh parameterization, 2008, here with a curved target.
 *
 * Stages of a step: rotate each triangle's edges in the plane of its image by the best-fitting
 * rotation; find the places in space whose edges come closest to these with cotangent weights,
 * landmarks fixed (one factorized matrix); move each vertex along the second surface towards its
 * place, halving the move while a spherical triangle would flip or become a needle; some sweeps of
 * descent, which even out compressed regions. The energy need not fall: untwisting may raise it
 * first.
 *
 * Cost: one factorization; per step three solves and O(edges). */

#include "geometry/vec3.h"
#include "morph/morph.h"
#include "morph/surface_map.h"

static const char STAGE[] = "map";
enum { HALVINGS = 5, SWEEPS = 2, TRIPLETS = 4 };
static const double PIN = 1e3, MASS = 1e-3; /* weights of staying, relative to cotangents */
static const double NEEDLE = 10;            /* largest roundness after a step */

typedef struct flow {
    composition *c;
    uint32_t *slot; /* per vertex its unknown */
    size_t count;   /* unknowns */
    double *sides;  /* 3 x count: right-hand sides, solutions */
    double *work;
    sparse_factors *system;
} flow;

static double weight_of_staying(const flow *f, uint32_t v) {
    return f->c->kept[v] ? PIN : MASS;
}

/* The i-th triangle at a vertex; false unless the vertex is its lowest corner: counts each once. */
static bool triangle_at(const sphere *s, uint32_t v, size_t i, uint32_t corner[3]) {
    const ring *around = &s->rings->of[v];
    corner[0] = v;
    corner[1] = around->data[i];
    corner[2] = around->data[(i + 1) % around->count];
    return v < corner[1] && v < corner[2];
}

/* Cotangent at a corner, for the opposite edge. */
static double cotangent(const flow *f, const uint32_t corner[3], int at) {
    const double *x = f->c->from->mesh->vertices;
    const triangle_form form =
        triangle_form_of(x + 3 * (size_t)corner[at], x + 3 * (size_t)corner[(at + 1) % 3],
                         x + 3 * (size_t)corner[(at + 2) % 3], f->c->floor);
    return form.area > 0 ? form.f / sqrt(form.area) : 0;
}

/* ---- system ---- */

static triplet *put_triangle(const flow *f, const uint32_t corner[3], triplet *next) {
    for (int k = 0; k < 3; k++) {
        double w = cotangent(f, corner, k);
        uint32_t p = f->slot[corner[(k + 1) % 3]], q = f->slot[corner[(k + 2) % 3]];
        *next++ = (triplet){p, p, w};
        *next++ = (triplet){q, q, w};
        *next++ = (triplet){p, q, -w};
        *next++ = (triplet){q, p, -w};
    }
    return next;
}

static starg_status make_system(flow *f) {
    const sphere *s = f->c->from;
    size_t triangles = 2 * f->count - 4; /* Euler, genus 0 */
    SCOPED triplet *triplets = NULL;
    triplet *next;
    uint32_t corner[3];
    NEW(s->context, STAGE, triplets, 3 * TRIPLETS * triangles + f->count);
    next = triplets;
    for (uint32_t k = 0; k < f->count; k++) {
        uint32_t v = s->alive[k];
        *next++ = (triplet){k, k, weight_of_staying(f, v)};
        for (size_t i = 0; i < s->rings->of[v].count; i++)
            if (triangle_at(s, v, i, corner))
                next = put_triangle(f, corner, next);
    }
    return triplets_factorise(s->context, f->count, triplets, (size_t)(next - triplets),
                              &f->system);
}

/* ---- local step ---- */

/* An orthonormal basis of a triangle's plane, the first vector along u; false without area. */
static bool plane_of(const double u[3], const double w[3], double basis[2][3]) {
    double n[3];
    vec3_cross(u, w, n);
    double length = vec3_length(u), area = vec3_length(n);
    if (!(length > 0 && area > 0))
        return false;
    vec3_cross(n, u, basis[1]);
    for (int k = 0; k < 3; k++) {
        basis[0][k] = u[k] / length;
        basis[1][k] /= length * area;
    }
    return true;
}

static void in_plane(double basis[2][3], const double v[3], double out[2]) {
    out[0] = vec3_dot(basis[0], v);
    out[1] = vec3_dot(basis[1], v);
}

/* Bases of a triangle and of its image, and the best-fitting rotation (cosine, sine) between them:
 * the rotation of the 2D polar decomposition. */
typedef struct fit {
    double from[2][3], to[2][3], turn[2];
} fit;

static bool fit_triangle(const flow *f, const uint32_t corner[3], fit *out) {
    const double *x = f->c->from->mesh->vertices, *y = f->c->images;
    double p[2], q[2], r[2];
    const triangle_form a = triangle_form_of(x + 3 * (size_t)corner[0], x + 3 * (size_t)corner[1],
                                             x + 3 * (size_t)corner[2], 0);
    const triangle_form b = triangle_form_of(y + 3 * (size_t)corner[0], y + 3 * (size_t)corner[1],
                                             y + 3 * (size_t)corner[2], 0);
    if (!plane_of(a.u, a.w, out->from) || !plane_of(b.u, b.w, out->to))
        return false;
    in_plane(out->from, a.w, q);
    in_plane(out->to, b.w, r);
    p[0] =
        vec3_length(b.u) / vec3_length(a.u); /* columns of the linear map: (p0, 0), (p1, r1/q1) */
    p[1] = (r[0] - p[0] * q[0]) / q[1];
    double cosine = p[0] + r[1] / q[1], sine = -p[1], length = hypot(cosine, sine);
    out->turn[0] = cosine / length;
    out->turn[1] = sine / length;
    return length > 0 && length < INFINITY;
}

static void add_triangle(const flow *f, const uint32_t corner[3]) {
    const double *x = f->c->from->mesh->vertices;
    fit own;
    if (!fit_triangle(f, corner, &own))
        return;
    for (int k = 0; k < 3; k++) {
        double w = cotangent(f, corner, k), edge[3], flat[2], wanted[3] = {0};
        uint32_t p = corner[(k + 1) % 3], q = corner[(k + 2) % 3];
        vec3_subtract(x + 3 * (size_t)p, x + 3 * (size_t)q, edge);
        in_plane(own.from, edge, flat);
        vec3_along(wanted, own.turn[0] * flat[0] - own.turn[1] * flat[1], own.to[0], wanted);
        vec3_along(wanted, own.turn[1] * flat[0] + own.turn[0] * flat[1], own.to[1], wanted);
        for (size_t j = 0; j < 3; j++) {
            f->sides[j * f->count + f->slot[p]] += w * wanted[j];
            f->sides[j * f->count + f->slot[q]] -= w * wanted[j];
        }
    }
}

/* ---- global step ---- */

static void find_places(const flow *f) {
    const sphere *s = f->c->from;
    uint32_t corner[3];
    for (size_t k = 0; k < f->count; k++)
        for (size_t j = 0; j < 3; j++)
            f->sides[j * f->count + k] =
                weight_of_staying(f, s->alive[k]) * f->c->images[3 * (size_t)s->alive[k] + j];
    for (size_t k = 0; k < f->count; k++)
        for (size_t i = 0; i < s->rings->of[s->alive[k]].count; i++)
            if (triangle_at(s, s->alive[k], i, corner))
                add_triangle(f, corner);
    for (size_t j = 0; j < 3; j++)
        sparse_solve(f->system, f->sides + j * f->count, f->work);
}

/* Moves a vertex towards its place, along the surface. */
static void approach(const flow *f, size_t k) {
    composition *c = f->c;
    const starg_mesh *mesh = c->to->sphere->mesh;
    uint32_t v = c->from->alive[k];
    const uint32_t *corner = mesh->faces + 3 * (size_t)c->points[v].face;
    double step[3], n[3];
    trial here, next;
    vec3_triangle_normal(mesh->vertices + 3 * (size_t)corner[0],
                         mesh->vertices + 3 * (size_t)corner[1],
                         mesh->vertices + 3 * (size_t)corner[2], n);
    for (size_t j = 0; j < 3; j++)
        step[j] = (f->sides[j * f->count + k] - c->images[3 * (size_t)v + j]) / c->scale;
    if (!(vec3_dot(n, n) > 0))
        return;
    vec3_along(step, -vec3_dot(step, n) / vec3_dot(n, n), n, step);
    trial_here(c, v, &here);
    double most = fmax(NEEDLE, trial_roundness(c, v, &here));
    for (int i = 0; i < HALVINGS; i++) {
        surface_point point = here.point;
        surface_walk(mesh, c->to->topology, step, &point);
        trial_at(c, &point, &next);
        if (trial_is_valid(c, v, &next) && trial_roundness(c, v, &next) <= most) {
            trial_accept(c, v, &next);
            return;
        }
        for (int j = 0; j < 3; j++)
            step[j] *= 0.5;
    }
}

static starg_status flow_step(const flow *f) {
    const composition *c = f->c;
    find_places(f);
    for (size_t k = 0; k < f->count; k++)
        if (!c->kept[c->from->alive[k]])
            approach(f, k);
    return composition_descend(f->c, SWEEPS);
}

starg_status composition_flow(composition *c, int steps) {
    starg_status status = STARG_OK;
    const sphere *s = c->from;
    starg_context *context = s->context;
    flow f = {.c = c, .count = s->rings->left};
    STARG_NEW(context, STAGE, f.slot, s->mesh->vertex_count);
    STARG_NEW(context, STAGE, f.sides, 3 * f.count);
    STARG_NEW(context, STAGE, f.work, f.count);
    for (uint32_t k = 0; k < f.count; k++)
        f.slot[s->alive[k]] = k;
    STARG_TRY(make_system(&f));
    for (int i = 0; i < steps; i++)
        STARG_TRY(flow_step(&f));
done:
    RELEASE(f.slot, f.sides, f.work);
    sparse_free(f.system);
    return status;
}
