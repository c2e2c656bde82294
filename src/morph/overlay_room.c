/* SPDX-License-Identifier: Apache-2.0 */
/* Room between the corners of an overlay's cells.
 *
 * Problem: corners of cells are computed points. Rounding may order two that nearly coincide the
 * wrong way, and a triangle that is thinner than the rounding of coordinates may pass through its
 * neighbours. Move the corners, each within the face or on the edge of the mesh that it is on,
 * until every cell can be cut into triangles that are positive, exactly in the weights of corners,
 * and some hundred times as high as rounding.
 *
 * Corners in a face with a bad cell go half the way to the mean of their neighbours, points on
 * edges to that of their neighbours along it: the embedding of Tutte (1963), to which this tends,
 * has only convex cells. Few faces have bad cells, and a few steps do, so that the overlay stays
 * where it was in all others. Cost: O(cells) for each round. */
#include <float.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "morph/surface_map.h"

static const char STAGE[] = "overlay";
enum { ROUNDS = 100, STEPS = 4 };
static const double ROOM = 1e-12; /* least height over the size of coordinates */
static const double PART = 1e-4;  /* of the face's own height is enough */
static const double ORIGIN[3];

/* What moves the corners on one side. */
typedef struct room {
    sphere_overlay *own;
    double size[2];      /* of coordinates */
    double *position[2]; /* of nodes */
    uint8_t *bad[2];     /* faces with bad cells */
    double *sum;         /* by node: weights of its neighbours, and their number */
} room;

static void weights_in(const overlay_side *side, const overlay_place *place, uint32_t face,
                       double w[3]) {
    for (size_t k = 0; k < 3; k++) {
        w[k] = 0;
        for (size_t j = 0; j < 3; j++)
            if (place->weight[j] > 0 &&
                side->faces[3 * (size_t)place->face + j] == side->faces[3 * (size_t)face + k])
                w[k] = place->weight[j];
    }
}

static void place_node(const room *r, int s, uint32_t node) {
    const overlay_side *side = &r->own->side[s];
    const overlay_place *place = &r->own->nodes.data[node].place[s];
    double *out = r->position[s] + 3 * (size_t)node;
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < 3; k++)
        vec3_along(out, place->weight[k],
                   side->mesh->vertices + 3 * (size_t)side->faces[3 * (size_t)place->face + k],
                   out);
}

/* The least height of a triangle; 0 where it is flat. */
static double height_of(const double *a, const double *b, const double *c) {
    double longest = fmax(vec3_distance(a, b), fmax(vec3_distance(b, c), vec3_distance(c, a)));
    return longest > 0 ? 2 * vec3_triangle_area(a, b, c) / longest : 0;
}

/* The height that triangles in a face should have. */
static double height_wanted(const room *r, int s, uint32_t face) {
    const overlay_side *side = &r->own->side[s];
    const uint32_t *corner = side->faces + 3 * (size_t)face;
    double own = height_of(side->mesh->vertices + 3 * (size_t)corner[0],
                           side->mesh->vertices + 3 * (size_t)corner[1],
                           side->mesh->vertices + 3 * (size_t)corner[2]);
    return fmin(ROOM * r->size[s], PART * own);
}

/* The height of a triangle over the wanted one; negative if its weights are not positive. */
static double quality_of(const room *r, int s, uint32_t face, double wanted,
                         const uint32_t node[3]) {
    const overlay_side *side = &r->own->side[s];
    double w[3][3];
    for (int k = 0; k < 3; k++)
        weights_in(side, &r->own->nodes.data[node[k]].place[s], face, w[k]);
    if (orient3d(w[0], w[1], w[2], ORIGIN) <= 0)
        return -1;
    const double *p = r->position[s];
    double height =
        height_of(p + 3 * (size_t)node[0], p + 3 * (size_t)node[1], p + 3 * (size_t)node[2]);
    return wanted > 0 ? height / wanted : 1;
}

/* The least quality on one side of the triangles of a cell about its corner `apex`. */
static double fan_quality(const room *r, int s, const overlay_cell *cell, double wanted,
                          uint32_t apex) {
    double least = INFINITY;
    for (uint32_t i = 1; i + 1 < cell->count; i++) {
        const uint32_t node[3] = {cell->corner[apex], cell->corner[(apex + i) % cell->count],
                                  cell->corner[(apex + i + 1) % cell->count]};
        least = fmin(least, quality_of(r, s, cell->face[s], wanted, node));
    }
    return least;
}

/* Turns the cell to its best apex. Returns the least quality there by side. */
static void turn_cell(const room *r, overlay_cell *cell, double quality[2]) {
    uint32_t best = 0, turned[OVERLAY_CORNERS];
    double most = -INFINITY;
    const double wanted[2] = {height_wanted(r, 0, cell->face[0]),
                              height_wanted(r, 1, cell->face[1])};
    for (uint32_t apex = 0; apex < (cell->count == 3 ? 1 : cell->count); apex++) {
        const double found[2] = {fan_quality(r, 0, cell, wanted[0], apex),
                                 fan_quality(r, 1, cell, wanted[1], apex)};
        if (fmin(found[0], found[1]) <= most)
            continue;
        most = fmin(found[0], found[1]);
        best = apex;
        quality[0] = found[0];
        quality[1] = found[1];
    }
    for (uint32_t i = 0; i < cell->count; i++)
        turned[i] = cell->corner[(best + i) % cell->count];
    for (uint32_t i = 0; i < cell->count; i++)
        cell->corner[i] = turned[i];
}

/* Marks the faces of bad cells. Returns the number of cells that cannot be cut at all, and the
 * number of bad ones. */
static size_t examine(room *r, size_t *bad) {
    size_t broken = 0;
    *bad = 0;
    for (int s = 0; s < 2; s++)
        for (uint32_t i = 0; i < r->own->nodes.count; i++)
            place_node(r, s, i);
    for (size_t c = 0; c < r->own->cells.count; c++) {
        overlay_cell *cell = &r->own->cells.data[c];
        double quality[2] = {-1, -1};
        turn_cell(r, cell, quality);
        broken += fmin(quality[0], quality[1]) < 0;
        *bad += fmin(quality[0], quality[1]) < 1;
        for (int s = 0; s < 2; s++)
            if (quality[s] < 1)
                r->bad[s][cell->face[s]] = 1;
    }
    return broken;
}

static int zero_weights(const overlay_place *place) {
    return (place->weight[0] == 0) + (place->weight[1] == 0) + (place->weight[2] == 0);
}

/* Adds neighbour q to what p will move to. Points on an edge only know neighbours on it. */
static void add_neighbour(room *r, int s, uint32_t face, uint32_t p, uint32_t q) {
    const overlay_side *side = &r->own->side[s];
    const overlay_place *place = &r->own->nodes.data[p].place[s];
    const overlay_place *other = &r->own->nodes.data[q].place[s];
    int zeros = zero_weights(place);
    double own[3], w[3];
    if (zeros == 2)
        return;
    if (zeros == 1) {
        weights_in(side, place, face, own);
        weights_in(side, other, face, w);
        for (int k = 0; k < 3; k++)
            if (own[k] == 0 && w[k] != 0)
                return;
    }
    weights_in(side, other, place->face, w);
    double *sum = r->sum + 4 * (size_t)p;
    for (int k = 0; k < 3; k++)
        sum[k] += w[k];
    sum[3] += 1;
}

static void move_node(overlay_place *place, const double sum[4]) {
    double w[3], all = 0;
    for (int k = 0; k < 3; k++) {
        w[k] = 0.5 * (place->weight[k] + sum[k] / sum[3]);
        all += w[k];
    }
    for (int k = 0; k < 3; k++)
        place->weight[k] = w[k] > 0 ? fmax(w[k] / all, DBL_EPSILON * DBL_EPSILON) : 0;
}

/* Moves corners in bad faces, and on their edges, half the way to the mean of their neighbours. */
static void step(room *r, int s) {
    size_t count = r->own->nodes.count;
    for (size_t i = 0; i < 4 * count; i++)
        r->sum[i] = 0;
    for (size_t c = 0; c < r->own->cells.count; c++) {
        const overlay_cell *cell = &r->own->cells.data[c];
        uint32_t face = cell->face[s];
        for (uint32_t i = 0; i < cell->count && r->bad[s][face]; i++) {
            uint32_t p = cell->corner[i], q = cell->corner[(i + 1) % cell->count];
            add_neighbour(r, s, face, p, q);
            if (zero_weights(&r->own->nodes.data[q].place[s]) == 1)
                add_neighbour(r, s, face, q, p);
        }
    }
    for (size_t i = 0; i < count; i++)
        if (r->sum[4 * i + 3] > 0)
            move_node(&r->own->nodes.data[i].place[s], r->sum + 4 * i);
}

static double size_of(const starg_mesh *mesh) {
    double size = 0;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        size = fmax(size, fabs(mesh->vertices[i]));
    return size;
}

starg_status overlay_make_room(sphere_overlay *own, bool *moved) {
    starg_status status = STARG_OK;
    starg_context *context = own->context;
    room r = {.own = own};
    size_t broken = 0, bad = 1;
    *moved = false;
    for (int s = 0; s < 2; s++) {
        r.size[s] = size_of(own->side[s].mesh);
        STARG_NEW(context, STAGE, r.position[s], 3 * own->nodes.count);
        STARG_NEW_ZERO(context, STAGE, r.bad[s], own->side[s].mesh->face_count);
    }
    STARG_NEW(context, STAGE, r.sum, 4 * own->nodes.count);
    for (int round = 0; round < ROUNDS; round++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        broken = examine(&r, &bad);
        if (bad == 0)
            break;
        *moved = true;
        for (int i = 0; i < STEPS; i++) {
            step(&r, 0);
            step(&r, 1);
        }
    }
    if (bad > 0)
        broken = examine(&r, &bad);
    if (broken > 0)
        status = starg_fail(context, STARG_ERROR_SOLVER, STAGE,
                            "%zu of %zu parts of the overlay are too thin for doubles; a map with "
                            "less distortion (landmarks) has room for them",
                            broken, own->cells.count);
done:
    for (int s = 0; s < 2; s++) {
        RELEASE(r.position[s], r.bad[s]);
    }
    starg_release(context, r.sum);
    return status;
}
