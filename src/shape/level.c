/* SPDX-License-Identifier: Apache-2.0 */
/* A model at a standard level of detail, so that noise, resolution and small defects of its mesh
 * have little influence on later measurements.
 *
 * Stages: simplify a very fine mesh to a multiple of the wanted vertices, which preserves noise;
 * volume-preserving smoothing [Taub95], with rounds proportional to the vertices, so that it
 * reaches equally far on fine and coarse meshes of a shape (coarse ones hardly change); simplify;
 * repair self-intersections, so that touching limbs do not merge.
 *
 * Invariants: closed 2-manifolds of the same topology throughout, except for what repair drops.
 *
 * Cost: O(n log n), mostly simplification. */
#include "shape/measures.h"

#include "starguard/repair.h"
#include "starguard/simplify.h"

static const char STAGE[] = "level of detail";

enum { MOST = 5, ROUNDS = 4 }; /* multiple of the wanted vertices; rounds at the wanted vertices */

/* Inward and outward steps [Taub95]: removes detail at the scale of the mesh, keeps variation over
 * more than about ten edges (below the pass band of 0.1). */
static const double INWARD = 0.5, OUTWARD = -0.5 / (1 - 0.1 * 0.5);

/* ---- smoothing ---- */

typedef struct smoother {
    const uint32_t *faces;
    size_t vertex_count, face_count;
    double *positions, *sums;
    uint32_t *neighbours; /* how many */
} smoother;

/* Moves each vertex a fraction of the way to the mean of its neighbours: in a closed, oriented mesh
 * each of them follows it in exactly one face. */
static void step(smoother *s, double part) {
    memset(s->sums, 0, 3 * s->vertex_count * sizeof *s->sums);
    for (size_t i = 0; i < s->face_count; i++)
        for (size_t k = 0; k < 3; k++) {
            size_t from = s->faces[3 * i + k], to = s->faces[3 * i + (k + 1) % 3];
            for (size_t c = 0; c < 3; c++)
                s->sums[3 * from + c] +=
                    (s->positions[3 * to + c] - s->positions[3 * from + c]) / s->neighbours[from];
        }
    for (size_t i = 0; i < 3 * s->vertex_count; i++)
        s->positions[i] += part * s->sums[i];
}

static starg_status smooth(starg_context *context, const starg_mesh *mesh, size_t rounds,
                           starg_mesh **out) {
    starg_status status = STARG_OK;
    smoother s = {.faces = starg_mesh_faces(mesh),
                  .vertex_count = starg_mesh_vertex_count(mesh),
                  .face_count = starg_mesh_face_count(mesh)};
    STARG_NEW(context, STAGE, s.positions, 3 * s.vertex_count);
    STARG_NEW(context, STAGE, s.sums, 3 * s.vertex_count);
    STARG_NEW_ZERO(context, STAGE, s.neighbours, s.vertex_count);
    memcpy(s.positions, starg_mesh_vertices(mesh), 3 * s.vertex_count * sizeof *s.positions);
    for (size_t i = 0; i < 3 * s.face_count; i++)
        s.neighbours[s.faces[i]]++;
    for (size_t i = 0; i < rounds; i++) {
        STARG_TRY(starg_check_cancel(context, STAGE));
        step(&s, INWARD);
        step(&s, OUTWARD);
    }
    STARG_TRY(starg_mesh_create(context, s.positions, s.vertex_count, s.faces, s.face_count, out));
done:
    RELEASE(s.positions, s.sums, s.neighbours);
    return status;
}

/* ---- public function ---- */

/* A mesh without a level is no error. */
static starg_status level_status(starg_status status) {
    return status == STARG_ERROR_MESH || status == STARG_ERROR_RANGE ? STARG_OK : status;
}

/* Replaces a mesh by another. */
static void replace(starg_mesh **mesh, starg_mesh *by) {
    starg_mesh_free(*mesh);
    *mesh = by;
}

/* Simplification need not keep intersections out, as they are repaired afterwards. */
static const starg_simplify_options SIMPLIFY = {.allow_intersections = true};

static starg_status refine(starg_context *context, const starg_mesh *mesh, size_t vertices,
                           starg_mesh **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *level = NULL;
    starg_mesh *next = NULL;
    TRY(starg_mesh_simplify(context, mesh, MOST * vertices, &SIMPLIFY, NULL, &level));
    size_t rounds = (ROUNDS * starg_mesh_vertex_count(level) + vertices / 2) / vertices;
    TRY(smooth(context, level, rounds, &next));
    replace(&level, next);
    return level_coarsen(context, level, vertices, out);
}

starg_status level_coarsen(starg_context *context, const starg_mesh *mesh, size_t vertices,
                           starg_mesh **out) {
    starg_status status = STARG_OK;
    starg_mesh *coarse = NULL;
    *out = NULL;
    STARG_TRY(starg_mesh_simplify(context, mesh, vertices, &SIMPLIFY, NULL, &coarse));
    status = starg_mesh_repair(context, coarse, NULL, out, &(starg_repair_report){0});
done:
    starg_mesh_free(coarse);
    return level_status(status);
}

starg_status level_create(starg_context *context, const starg_mesh *mesh, size_t vertices,
                          starg_mesh **out) {
    *out = NULL;
    return level_status(refine(context, mesh, vertices, out));
}
