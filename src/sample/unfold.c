/* SPDX-License-Identifier: Apache-2.0 */
/* Linear blending makes the skin intersect itself where a joint closes. Such faces oppose the mean
 * normal at their corners, or degenerate. Their vertices, and neighbours of those, take over more
 * and more of their neighbours' motion from the rest pose, until no face is spoiled that was fine
 * there. Everything else stays in place. (Motions are smoothed because smoothing positions would
 * shrink thin limbs.) Rounds continue while the number of spoiled faces falls, and the best
 * positions are kept: on a very coarse mesh those may be the skinning's own.
 *
 * Cost: O(faces) per round; few rounds are needed, one for a mesh without folds. */
#include "sample/solids.h"

#include "geometry/vec3.h"

static const char STAGE[] = "sample";

/* A face is spoiled if the cosine of the angle between its normal and a corner's is lower, */
static const double MIN_COSINE = 0.0;
/* or if twice its area is below this fraction of its squared longest edge. */
static const double MIN_QUALITY = 0.06;

enum { MAX_IDLE_ROUNDS = 10, HALO = 2 };

typedef struct unfolder {
    starg_context *context;
    const uint32_t *faces;
    const double *rest;
    size_t vertex_count, face_count;
    double *normals; /* per vertex: the area-weighted sum of face normals */
    double *best;    /* positions with the fewest spoiled faces so far */
    double *sums;    /* of the neighbours' motions */
    uint32_t *degrees;
    uint8_t *moves;        /* vertices to move */
    uint8_t *spoiled_rest; /* faces that are no better in the rest pose */
} unfolder;

static const double *corner(const unfolder *u, const double *vertices, size_t i) {
    return vertices + 3 * (size_t)u->faces[i];
}

static void face_normal(const unfolder *u, const double *vertices, size_t f, double normal[3]) {
    vec3_triangle_normal(corner(u, vertices, 3 * f), corner(u, vertices, 3 * f + 1),
                         corner(u, vertices, 3 * f + 2), normal);
}

static void sum_normals(const unfolder *u, const double *vertices) {
    memset(u->normals, 0, 3 * u->vertex_count * sizeof *u->normals);
    for (size_t f = 0; f < u->face_count; f++) {
        double normal[3];
        face_normal(u, vertices, f, normal);
        for (size_t k = 0; k < 3; k++) {
            double *sum = u->normals + 3 * (size_t)u->faces[3 * f + k];
            vec3_along(sum, 1, normal, sum);
        }
    }
}

static bool is_spoiled(const unfolder *u, const double *vertices, size_t f) {
    double normal[3], longest = 0;
    face_normal(u, vertices, f, normal);
    double area = vec3_length(normal);
    for (size_t k = 0; k < 3; k++) {
        const double *at = u->normals + 3 * (size_t)u->faces[3 * f + k];
        if (!(vec3_dot(normal, at) > MIN_COSINE * area * vec3_length(at)))
            return true;
        longest = fmax(longest, vec3_distance_squared(corner(u, vertices, 3 * f + k),
                                                      corner(u, vertices, 3 * f + (k + 1) % 3)));
    }
    return area < MIN_QUALITY * longest;
}

/* Marks the corners of spoiled faces and counts these. */
static size_t mark_spoiled(const unfolder *u, const double *vertices) {
    size_t count = 0;
    sum_normals(u, vertices);
    memset(u->moves, 0, u->vertex_count);
    for (size_t f = 0; f < u->face_count; f++) {
        if (u->spoiled_rest[f] || !is_spoiled(u, vertices, f))
            continue;
        count++;
        for (size_t k = 0; k < 3; k++)
            u->moves[u->faces[3 * f + k]] = 1;
    }
    return count;
}

/* Marks the neighbours of vertices marked `level` with `level` + 1. */
static void widen(const unfolder *u, uint8_t level) {
    for (size_t i = 0; i < 3 * u->face_count; i++) {
        uint32_t a = u->faces[i], b = u->faces[i % 3 == 2 ? i - 2 : i + 1];
        if (u->moves[a] == level && u->moves[b] == 0)
            u->moves[b] = (uint8_t)(level + 1);
        if (u->moves[b] == level && u->moves[a] == 0)
            u->moves[a] = (uint8_t)(level + 1);
    }
}

static void move_marked(const unfolder *u, double *vertices) {
    memset(u->sums, 0, 3 * u->vertex_count * sizeof *u->sums);
    memset(u->degrees, 0, u->vertex_count * sizeof *u->degrees);
    for (size_t i = 0; i < 3 * u->face_count; i++) {
        uint32_t a = u->faces[i], b = u->faces[i % 3 == 2 ? i - 2 : i + 1];
        if (!u->moves[a])
            continue;
        double motion[3], *sum = u->sums + 3 * (size_t)a;
        vec3_subtract(vertices + 3 * (size_t)b, u->rest + 3 * (size_t)b, motion);
        vec3_along(sum, 1, motion, sum);
        u->degrees[a]++;
    }
    for (size_t v = 0; v < u->vertex_count; v++)
        for (size_t k = 3 * v; u->moves[v] && k < 3 * v + 3; k++)
            vertices[k] += 0.5 * (u->rest[k] + u->sums[k] / u->degrees[v] - vertices[k]);
}

static void unfolder_free(unfolder *u) {
    RELEASE(u->normals, u->best, u->sums, u->degrees, u->moves, u->spoiled_rest);
}

static starg_status unfolder_make(unfolder *u, const starg_mesh *rest) {
    NEW(u->context, STAGE, u->normals, 3 * u->vertex_count);
    NEW(u->context, STAGE, u->best, 3 * u->vertex_count);
    NEW(u->context, STAGE, u->sums, 3 * u->vertex_count);
    NEW(u->context, STAGE, u->degrees, u->vertex_count);
    NEW(u->context, STAGE, u->moves, u->vertex_count);
    NEW(u->context, STAGE, u->spoiled_rest, u->face_count);
    sum_normals(u, rest->vertices);
    for (size_t f = 0; f < u->face_count; f++)
        u->spoiled_rest[f] = is_spoiled(u, rest->vertices, f);
    return STARG_OK;
}

starg_status unfold_mesh(starg_context *context, const starg_mesh *rest, starg_mesh *posed) {
    SCOPED_BY(unfolder_free)
    unfolder u = {.context = context,
                  .faces = rest->faces,
                  .rest = rest->vertices,
                  .vertex_count = rest->vertex_count,
                  .face_count = rest->face_count};
    size_t size = 3 * u.vertex_count * sizeof *u.best;
    TRY(unfolder_make(&u, rest));
    size_t least = SIZE_MAX;
    for (int idle = 0; least != 0 && idle < MAX_IDLE_ROUNDS; idle++) {
        TRY(starg_check_cancel(context, STAGE));
        size_t spoiled = mark_spoiled(&u, posed->vertices);
        if (spoiled < least) {
            least = spoiled;
            idle = 0;
            memcpy(u.best, posed->vertices, size);
        }
        for (int level = 1; level <= HALO; level++)
            widen(&u, (uint8_t)level);
        move_marked(&u, posed->vertices);
    }
    memcpy(posed->vertices, u.best, size);
    return STARG_OK;
}
