/* SPDX-License-Identifier: Apache-2.0 */
/* Directions for two triangulations of the same vertices.
 *
 * Problem: poses of one model differ in some faces, as a rule flipped edges. Vertex i corresponds
 * to vertex i; find directions for which the faces of both are positive on the sphere. Those of A's
 * embedding are, for A; a flipped edge needs four vertices in convex position.
 *
 * In rounds, each corner of a face that is not positive moves to where the least distance from the
 * planes that bound its faces, of both surfaces, is greatest (a linear program in four variables),
 * if that is more than where it is. Then its neighbours follow. Cost: O(bad faces) for each round.
 */
#include "morph/surface_map.h"

#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "overlay";
enum { ROUNDS = 200 };
static const double ORIGIN[3];

/* The faces of both surfaces, outward, and those at each vertex. */
typedef struct common {
    starg_context *context;
    size_t vertex_count, face_count;
    uint32_t *faces;
    size_t *start;
    uint32_t *at; /* by vertex: corners */
    double *directions;
    STARG_ARRAY(double) rows;
    STARG_ARRAY(uint32_t) order;
    uint8_t *moving;
} common;

static void add_faces(common *c, const starg_mesh *mesh) {
    bool inward = starg_mesh_volume(mesh) < 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t *face = c->faces + 3 * c->face_count++;
        face[0] = mesh->faces[3 * f];
        face[1] = mesh->faces[3 * f + (inward ? 2 : 1)];
        face[2] = mesh->faces[3 * f + (inward ? 1 : 2)];
    }
}

static starg_status gather(common *c, const starg_mesh *a, const starg_mesh *b) {
    size_t count = a->face_count + b->face_count;
    NEW(c->context, STAGE, c->faces, 3 * count);
    add_faces(c, a);
    add_faces(c, b);
    NEW_ZERO(c->context, STAGE, c->start, c->vertex_count + 2);
    NEW(c->context, STAGE, c->at, 3 * count);
    NEW(c->context, STAGE, c->moving, c->vertex_count);
    for (size_t i = 0; i < 3 * count; i++)
        c->start[c->faces[i] + 2]++;
    for (size_t v = 2; v < c->vertex_count + 2; v++)
        c->start[v] += c->start[v - 1];
    for (size_t i = 0; i < 3 * count; i++)
        c->at[c->start[c->faces[i] + 1]++] = (uint32_t)i;
    return STARG_OK;
}

static const double *direction_of(const common *c, uint32_t corner) {
    return c->directions + 3 * (size_t)c->faces[corner];
}

/* Marks the corners of faces that are not positive; returns their number. */
static size_t mark_bad(common *c) {
    size_t bad = 0;
    memset(c->moving, 0, c->vertex_count);
    for (uint32_t f = 0; f < c->face_count; f++) {
        if (orient3d(direction_of(c, 3 * f), direction_of(c, 3 * f + 1), direction_of(c, 3 * f + 2),
                     ORIGIN) > 0)
            continue;
        bad++;
        for (size_t k = 0; k < 3; k++)
            c->moving[c->faces[3 * (size_t)f + k]] = 1;
    }
    return bad;
}

/* The vertices next to marked ones move as well: room has to come from somewhere. */
static void widen(common *c) {
    for (size_t f = 0; f < c->face_count; f++) {
        const uint32_t *face = c->faces + 3 * f;
        if (c->moving[face[0]] != 1 && c->moving[face[1]] != 1 && c->moving[face[2]] != 1)
            continue;
        for (int k = 0; k < 3; k++)
            if (c->moving[face[k]] == 0)
                c->moving[face[k]] = 2;
    }
}

/* The side of a face opposite to a corner: rows of "at least t from its plane, on the inner side".
 */
static starg_status add_row(common *c, uint32_t corner) {
    double n[3];
    vec3_cross(direction_of(c, corner_next(corner)), direction_of(c, corner_previous(corner)), n);
    double length = vec3_length(n);
    if (!(length > 0))
        return STARG_OK;
    double scale = -1 / (length * sqrt(2));
    const double row[5] = {scale * n[0], scale * n[1], scale * n[2], sqrt(0.5), 0};
    for (int k = 0; k < 5; k++)
        PUSH(c->context, STAGE, &c->rows, row[k]);
    PUSH(c->context, STAGE, &c->order, 0);
    return STARG_OK;
}

static double least_distance(const common *c, const double x[3]) {
    double least = INFINITY;
    for (size_t i = 0; i < c->order.count; i++)
        least = fmin(least, -vec3_dot(c->rows.data + 5 * i, x));
    return least;
}

static starg_status move(common *c, uint32_t v) {
    double *x = c->directions + 3 * (size_t)v, moved[3];
    linear_solution solution;
    c->rows.count = c->order.count = 0;
    for (size_t i = c->start[v]; i < c->start[v + 1]; i++)
        TRY(add_row(c, c->at[i]));
    const linear_program program = {.dimension = 4,
                                    .rows = c->rows.data,
                                    .count = c->order.count,
                                    .objective = {0, 0, 0, 1},
                                    .radius = 1,
                                    .seed = c->context->seed};
    linear_program_solve(&program, c->order.data, NULL, &solution);
    double length = vec3_length(solution.point);
    if (!solution.feasible || !(length > 0))
        return STARG_OK;
    for (int k = 0; k < 3; k++)
        moved[k] = solution.point[k] / length;
    if (least_distance(c, moved) > least_distance(c, x))
        vec3_copy(moved, x);
    return STARG_OK;
}

starg_status overlay_share(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                           double *directions) {
    starg_status status = STARG_OK;
    common c = {.context = context, .vertex_count = a->vertex_count, .directions = directions};
    STARG_TRY(gather(&c, a, b));
    for (int round = 0; round < ROUNDS && mark_bad(&c) > 0; round++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        widen(&c);
        for (uint32_t v = 0; v < c.vertex_count; v++)
            if (c.moving[v] > 0)
                STARG_TRY(move(&c, v));
    }
done:
    RELEASE(c.faces, c.start, c.at, c.moving, c.rows.data, c.order.data);
    return status;
}
