/* SPDX-License-Identifier: Apache-2.0 */
/* Fast winding numbers by a tree of dipoles.
 *
 * Sources: A. Jacobson, L. Kavan, O. Sorkine-Hornung, Robust inside-outside segmentation using
 * generalized winding numbers, 2013; G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, Fast
 * winding numbers for soups and clouds, 2018 (first order).
 *
 * Near triangles contribute their solid angles. A node farther away than twice its radius
 * contributes one dipole at its centre: the sum of its area vectors over the squared distance.
 *
 * Cost: O(n) to build, O(log n) per point. */
#include "geometry/bvh.h"

#include "geometry/vec3.h"

static const char STAGE[] = "winding";
static const double PI = 3.14159265358979323846;
static const double FAR = 2; /* radii */

enum { STACK_SIZE = 128 };

static void to_unit(const winding_field *field, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (p[k] - field->origin[k]) * field->scale;
}

static void unit_corner(const winding_field *field, size_t rank, size_t k, double out[3]) {
    const bvh *tree = field->tree;
    size_t face = tree->order[rank];
    to_unit(field, tree->vertices + 3 * (size_t)tree->faces[3 * face + k], out);
}

/* ---- moments ---- */

static void add_dipole(winding_moment *sum, double *weight, const double center[3],
                       const double normal[3], double area) {
    for (int k = 0; k < 3; k++) {
        sum->center[k] += area * center[k];
        sum->normal[k] += normal[k];
    }
    *weight += area;
}

static void add_triangles(const winding_field *field, const bvh_node *node, winding_moment *sum,
                          double *weight) {
    for (size_t rank = node->first; rank < node->first + node->count; rank++) {
        double p[3][3], n[3], center[3];
        for (size_t k = 0; k < 3; k++)
            unit_corner(field, rank, k, p[k]);
        vec3_triangle_normal(p[0], p[1], p[2], n);
        for (int k = 0; k < 3; k++) {
            n[k] *= 0.5;
            center[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
        }
        add_dipole(sum, weight, center, n, vec3_length(n));
    }
}

static bool is_leaf(const bvh *tree, const bvh_node *node) {
    return node->count > 0 || tree->node_count == 1;
}

/* Distance from the centre to the farthest corner of the node's box. */
static double reach(const winding_field *field, const bvh_box *box, const double center[3]) {
    double lower[3], upper[3], d[3];
    to_unit(field, box->lower, lower);
    to_unit(field, box->upper, upper);
    for (int k = 0; k < 3; k++)
        d[k] = fmax(center[k] - lower[k], upper[k] - center[k]);
    return vec3_length(d);
}

/* Children follow their parent in the array, so a backward loop handles them first. */
static void make_moment(const winding_field *field, double *weights, size_t index) {
    const bvh_node *node = &field->tree->nodes[index];
    winding_moment sum = {.radius = 0};
    double weight = 0;
    if (is_leaf(field->tree, node))
        add_triangles(field, node, &sum, &weight);
    for (size_t child = node->first; !is_leaf(field->tree, node) && child < node->first + 2U;
         child++)
        add_dipole(&sum, &weight, field->moments[child].center, field->moments[child].normal,
                   weights[child]);
    for (int k = 0; k < 3; k++)
        sum.center[k] = weight > 0 ? sum.center[k] / weight : 0;
    sum.radius = reach(field, &node->box, sum.center);
    field->moments[index] = sum;
    weights[index] = weight;
}

starg_status winding_create(starg_context *context, const bvh *tree, winding_field *out) {
    SCOPED double *weights = NULL;
    double extent = 0;
    int exponent;
    *out = (winding_field){.tree = tree};
    NEW(context, STAGE, out->moments, tree->node_count);
    NEW(context, STAGE, weights, tree->node_count);
    for (int k = 0; k < 3; k++) {
        const bvh_box *box = &tree->nodes[0].box;
        out->origin[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
        extent = fmax(extent, box->upper[k] - box->lower[k]);
    }
    frexp(extent, &exponent);
    out->scale = ldexp(1, -exponent);
    for (size_t index = tree->node_count; index-- > 0;)
        make_moment(out, weights, index);
    return STARG_OK;
}

void winding_free(winding_field *field) {
    RELEASE(field->moments);
    field->moments = NULL;
}

/* ---- numbers ---- */

/* Solid angle of a triangle [van Oosterom, Strackee 1983]. */
static double solid_angle(const winding_field *field, size_t rank, const double p[3]) {
    double v[3][3], length[3];
    for (size_t k = 0; k < 3; k++) {
        unit_corner(field, rank, k, v[k]);
        vec3_subtract(v[k], p, v[k]);
        length[k] = vec3_length(v[k]);
    }
    double volume = vec3_triple(v[0], v[1], v[2]);
    double plane = length[0] * length[1] * length[2] + vec3_dot(v[0], v[1]) * length[2] +
                   vec3_dot(v[1], v[2]) * length[0] + vec3_dot(v[2], v[0]) * length[1];
    return volume == 0 ? 0 : 2 * atan2(volume, plane);
}

double winding_number(const winding_field *field, const double p[3]) {
    uint32_t stack[STACK_SIZE];
    int depth = 0;
    double at[3], sum = 0;
    to_unit(field, p, at);
    stack[depth++] = 0;
    while (depth > 0) {
        uint32_t index = stack[--depth];
        const bvh_node *node = &field->tree->nodes[index];
        const winding_moment *moment = &field->moments[index];
        double d[3];
        vec3_subtract(moment->center, at, d);
        double distance = vec3_length(d);
        if (distance > FAR * moment->radius) {
            sum += vec3_dot(moment->normal, d) / (distance * distance * distance);
        } else if (is_leaf(field->tree, node)) {
            for (size_t rank = node->first; rank < node->first + node->count; rank++)
                sum += solid_angle(field, rank, at);
        } else {
            stack[depth++] = node->first + 1;
            stack[depth++] = node->first;
        }
    }
    return sum / (4 * PI);
}
