/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the contour engine (visibility/contours.c), written once and compiled per instruction
 * set: the including file names the function and selects the lanes. */
#include <math.h>
#include <string.h>

#include "core/bits.h"
#include "geometry/predicates.h"
#include "visibility/contours.h"
#include "visibility/lanes.h"

/* Stage 1: the border edges of the front-facing faces. */
static bool find_contours(const visibility_scene *scene, const int8_t *side, contours_scratch *s) {
    const visibility_adjacency *adjacency = scene->adjacency;
    size_t count = 0;
    for (size_t e = 0; e < adjacency->edge_count; e++) {
        s->contour_edges[count] = (uint32_t)e;
        count += (side[adjacency->edges[e].left] > 0) != (side[adjacency->edges[e].right] > 0);
        if (count == s->contour_limit)
            return false;
    }
    for (size_t slot = 0; slot < scene->vertex_count; slot++)
        s->grade[slot] = side[adjacency->first_face[slot]] > 0 ? SLOT_FRONT : SLOT_BACK;
    for (size_t i = 0; i < count; i++) {
        const adjacency_edge *edge = &adjacency->edges[s->contour_edges[i]];
        bool turn = side[edge->left] <= 0;
        uint32_t a = turn ? edge->b : edge->a, b = turn ? edge->a : edge->b;
        s->grade[a] = s->grade[b] = SLOT_MIXED;
        s->contours[i].a = a;
        s->contours[i].b = b;
        s->contours[i].tested_by = SCENE_NONE;
    }
    s->contour_count = count;
    return true;
}

static void cross(const cube_directions *d, uint32_t a, uint32_t b, double out[3]) {
    out[0] = d->y[a] * d->z[b] - d->z[a] * d->y[b];
    out[1] = d->z[a] * d->x[b] - d->x[a] * d->z[b];
    out[2] = d->x[a] * d->y[b] - d->y[a] * d->x[b];
}

static double dot(const cube_directions *d, const double n[3], uint32_t slot) {
    return n[0] * d->x[slot] + n[1] * d->y[slot] + n[2] * d->z[slot];
}

static void measure_contours(contours_scratch *s) {
    for (size_t i = 0; i < s->contour_count; i++)
        cross(&s->directions, s->contours[i].a, s->contours[i].b, s->contours[i].normal);
}

#include "visibility/contours_sort.h"

/* These use the above. */
#include "visibility/contours_forest.h"

#include "visibility/contours_tree_edges.h"

#include "visibility/contours_cover.h"

/* The count where no layer is in front: from the first vertex that the BVH can decide. */
static bool find_base(const visibility_scene *scene, const double p[3], const int8_t *side,
                      const contours_scratch *s, const uint32_t *order, size_t count,
                      int32_t *none) {
    enum { ATTEMPTS = 8 };
    int32_t layers;
    for (size_t i = 0, attempt = 0; i < count && attempt < ATTEMPTS; i++) {
        if (!s->followed[order[i]])
            continue;
        if (contours_count_layers(scene, p, side, order[i], &layers)) {
            *none = s->layers[order[i]] - layers;
            return true;
        }
        attempt++;
    }
    return false;
}

/* Stage 5: sums the steps from each root, and calibrates them by one vertex of the shell. */
static bool sum_layers(const visibility_scene *scene, const double p[3], const int8_t *side,
                       contours_scratch *s, uint8_t *visible) {
    const visibility_adjacency *adjacency = scene->adjacency;
    for (size_t shell = 0; shell < adjacency->shell_count; shell++) {
        const uint32_t *order = adjacency->order + adjacency->shell_start[shell];
        size_t count = adjacency->shell_start[shell + 1] - adjacency->shell_start[shell];
        int32_t none = 0;
        for (size_t k = 1; k < count; k++)
            s->layers[order[k]] += s->layers[s->parent[order[k]]];
        if (s->followed[order[0]] && !find_base(scene, p, side, s, order, count, &none))
            return false;
        for (size_t k = 0; k < count; k++)
            visible[order[k]] = (s->layers[order[k]] == none) & (s->grade[order[k]] != SLOT_BACK);
    }
    return true;
}

static bool run(const visibility_scene *scene, contours_scratch *s, const double p[3],
                const int8_t *side, uint8_t *visible) {
    s->p = p;
    s->side = side;
    if (!find_contours(scene, side, s))
        return false;
    cube_make_relative(scene, p, NULL, &s->directions);
    if (!(s->directions.bound < INFINITY))
        return false; /* too small for the error bounds */
    cube_project(scene->vertex_count, NULL, &s->directions);
    measure_contours(s);
    choose_tree_edges(scene, s);
    return sort_contours(s) && follow_tree_edges(scene, p, side, s) &&
           sum_layers(scene, p, side, s, visible);
}

const contours_variant CONTOURS_VARIANT = {run, may_cover};
