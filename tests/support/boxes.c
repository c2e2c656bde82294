/* SPDX-License-Identifier: Apache-2.0 */
#include "boxes.h"

#include <math.h>
#include <string.h>

static double between(starg_rng *rng, double low, double high) {
    return fmin(fmax(low + (high - low) * starg_rng_unit(rng), low), high);
}

static const double *any_vertex(const starg_mesh *mesh, starg_rng *rng) {
    return starg_mesh_vertices(mesh) + 3 * starg_rng_below(rng, starg_mesh_vertex_count(mesh));
}

static bvh_box bounds(const starg_mesh *mesh) {
    bvh_box box;
    starg_mesh_bounds(mesh, box.lower, box.upper);
    return box;
}

static void inside_point(const starg_solid *solid, starg_rng *rng, double p[3]) {
    const bvh_box all = bounds(starg_solid_mesh(solid));
    for (int attempt = 0; attempt < 1000; attempt++) {
        for (int k = 0; k < 3; k++)
            p[k] = between(rng, all.lower[k], all.upper[k]);
        if (starg_solid_contains(solid, p))
            return;
    }
}

static bvh_box halved(const starg_solid *solid, starg_rng *rng) {
    bvh_box box = bounds(starg_solid_mesh(solid));
    double p[3];
    inside_point(solid, rng, p);
    for (uint64_t halvings = 2 + starg_rng_below(rng, 14); halvings > 0; halvings--) {
        int k = 0;
        for (int j = 1; j < 3; j++)
            if (box.upper[j] - box.lower[j] > box.upper[k] - box.lower[k])
                k = j;
        double middle = 0.5 * box.lower[k] + 0.5 * box.upper[k];
        *(p[k] < middle ? &box.upper[k] : &box.lower[k]) = middle;
    }
    return box;
}

static bvh_box about_point(const starg_solid *solid, starg_rng *rng) {
    const bvh_box all = bounds(starg_solid_mesh(solid));
    double p[3], size = pow(0.5, 6 * starg_rng_unit(rng));
    bvh_box box;
    inside_point(solid, rng, p);
    for (int k = 0; k < 3; k++) {
        double extent = size * (all.upper[k] - all.lower[k]);
        box.lower[k] = p[k] - extent * starg_rng_unit(rng);
        box.upper[k] = p[k] + extent * starg_rng_unit(rng);
    }
    return box;
}

static bvh_box about_points(const double *a, const double *b) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        box.lower[k] = fmin(a[k], b[k]);
        box.upper[k] = fmax(a[k], b[k]);
    }
    return box;
}

static bvh_box about_face(const starg_mesh *mesh, starg_rng *rng) {
    const uint32_t *face =
        starg_mesh_faces(mesh) + 3 * starg_rng_below(rng, starg_mesh_face_count(mesh));
    const double *v = starg_mesh_vertices(mesh);
    bvh_box box = about_points(v + 3 * (size_t)face[0], v + 3 * (size_t)face[1]);
    for (int k = 0; k < 3; k++) {
        box.lower[k] = fmin(box.lower[k], v[3 * (size_t)face[2] + (size_t)k]);
        box.upper[k] = fmax(box.upper[k], v[3 * (size_t)face[2] + (size_t)k]);
    }
    return box;
}

static bvh_box between_vertices(const starg_mesh *mesh, starg_rng *rng) {
    const double *a = any_vertex(mesh, rng);
    return about_points(a, any_vertex(mesh, rng));
}

bvh_box box_about(const starg_solid *solid, starg_rng *rng, size_t kind) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    bvh_box box;
    switch (kind % 8) {
    case 0:
    case 1:
        return halved(solid, rng);
    case 2:
        return about_point(solid, rng);
    case 3:
        return between_vertices(mesh, rng);
    case 4:
        return about_face(mesh, rng);
    case 5:
        box = halved(solid, rng);
        int k = (int)starg_rng_below(rng, 3);
        box.upper[k] = box.lower[k];
        return box;
    case 6:
        inside_point(solid, rng, box.lower);
        memcpy(box.upper, box.lower, sizeof box.upper);
        return box;
    default:
        return bounds(mesh);
    }
}

static void on_side(const bvh_box *box, starg_rng *rng, double p[3]) {
    uint64_t fixed = 1 + starg_rng_below(rng, 7), upper = starg_rng_below(rng, 8);
    for (int k = 0; k < 3; k++)
        p[k] = !(fixed >> k & 1) ? between(rng, box->lower[k], box->upper[k])
               : upper >> k & 1  ? box->upper[k]
                                 : box->lower[k];
}

/* A point where the line through two vertices crosses the box: anywhere, or close to an end. */
static void on_line(const starg_mesh *mesh, const bvh_box *box, starg_rng *rng, double p[3]) {
    for (int attempt = 0; attempt < 30; attempt++) {
        const double *a = any_vertex(mesh, rng), *b = any_vertex(mesh, rng);
        double enter = -INFINITY, leave = INFINITY;
        for (int k = 0; k < 3; k++) {
            double low = (box->lower[k] - a[k]) / (b[k] - a[k]);
            double high = (box->upper[k] - a[k]) / (b[k] - a[k]);
            enter = fmax(enter, fmin(low, high));
            leave = fmin(leave, fmax(low, high));
        }
        if (!(enter <= leave && leave < INFINITY && enter > -INFINITY))
            continue;
        double t = between(rng, enter, leave);
        for (int k = 0; k < 3; k++)
            p[k] = a[k] + t * (b[k] - a[k]);
        return;
    }
}

/* A point of a face in the box, moved to the inner side by much or by little. */
static void under_face(const starg_mesh *mesh, const bvh_box *box, starg_rng *rng, double p[3]) {
    const double *v = starg_mesh_vertices(mesh);
    for (int attempt = 0; attempt < 300; attempt++) {
        const uint32_t *face =
            starg_mesh_faces(mesh) + 3 * starg_rng_below(rng, starg_mesh_face_count(mesh));
        const double *a = v + 3 * (size_t)face[0], *b = v + 3 * (size_t)face[1];
        const double *c = v + 3 * (size_t)face[2];
        double s = starg_rng_unit(rng), t = (1 - s) * starg_rng_unit(rng);
        double depth = pow(0.1, 1 + 11 * starg_rng_unit(rng)), normal[3], size = 0;
        bool holds = true;
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, w = (k + 2) % 3;
            normal[k] = (b[u] - a[u]) * (c[w] - a[w]) - (b[w] - a[w]) * (c[u] - a[u]);
            size = fmax(size, fabs(normal[k]));
        }
        for (int k = 0; k < 3; k++) {
            p[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]);
            p[k] -= depth * normal[k] / (size > 0 ? sqrt(size) : 1);
            holds = holds && p[k] >= box->lower[k] && p[k] <= box->upper[k];
        }
        if (holds)
            return;
    }
}

size_t box_points(const starg_solid *solid, const bvh_box *box, starg_rng *rng, size_t wanted,
                  double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    size_t count = 0;
    for (size_t attempt = 0; attempt < 6 * wanted && count < wanted; attempt++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = attempt == 0 ? 0.5 * box->lower[k] + 0.5 * box->upper[k]
                                : between(rng, box->lower[k], box->upper[k]);
        if (attempt % 4 == 1)
            on_side(box, rng, p);
        if (attempt % 4 == 2)
            on_line(mesh, box, rng, p);
        if (attempt % 4 == 3)
            under_face(mesh, box, rng, p);
        for (int k = 0; k < 3; k++)
            p[k] = fmin(fmax(p[k], box->lower[k]), box->upper[k]);
        if (starg_solid_contains(solid, p))
            memcpy(points + 3 * count++, p, sizeof p);
    }
    return count;
}
