/* SPDX-License-Identifier: Apache-2.0 */
/* A surface that intersects itself is replaced by the boundary of what it encloses (mesh/union),
 * and one whose faces touch without sharing edges by one whose do (mesh/union/conform.c): from
 * these strict pieces are made. The pieces then have that boundary: faces of the
 * model that meet no others, exactly, parts of the others up to the rounding of new vertices, and
 * nothing of what lies inside. How far the one is from the other is bounded for all points, to a
 * thousandth of the diagonal (star/decomposition.h). */
#include "star/decomposition.h"

#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/union/union.h"
#include "starguard/repair.h"

static const char STAGE[] = "pieces";

static const double STEP = 1e-3; /* of the diagonal */

/* ---- what is kept ---- */

/* A face by its positions, from the least corner on. */
typedef struct placed_face {
    double corner[9];
    uint32_t face;
} placed_face;

static placed_face place_face(const starg_mesh *mesh, uint32_t face) {
    placed_face out = {.face = face};
    const double *p[3];
    int first = 0;
    for (int k = 0; k < 3; k++)
        p[k] = mesh->vertices + 3 * (size_t)mesh->faces[3 * (size_t)face + (size_t)k];
    for (int k = 1; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (p[k][i] != p[first][i]) {
                first = p[k][i] < p[first][i] ? k : first;
                break;
            }
    for (int k = 0; k < 3; k++)
        vec3_copy(p[(first + k) % 3], out.corner + 3 * k);
    return out;
}

static int compare_faces(const void *left, const void *right) {
    const placed_face *a = left, *b = right;
    for (int i = 0; i < 9; i++)
        if (a->corner[i] != b->corner[i])
            return a->corner[i] < b->corner[i] ? -1 : 1;
    return 0;
}

/* The faces of the model that the boundary lacks, as a mesh on the model's vertices (borrowed). */
static starg_status find_lost(starg_context *context, const starg_mesh *model,
                              const starg_mesh *boundary, starg_mesh *lost) {
    SCOPED placed_face *sorted = NULL;
    *lost = *model;
    lost->face_count = 0;
    lost->faces = NULL;
    NEW(context, STAGE, sorted, boundary->face_count);
    NEW(context, STAGE, lost->faces, 3 * model->face_count);
    for (uint32_t f = 0; f < boundary->face_count; f++)
        sorted[f] = place_face(boundary, f);
    qsort(sorted, boundary->face_count, sizeof *sorted, compare_faces);
    for (uint32_t f = 0; f < model->face_count; f++) {
        placed_face own = place_face(model, f);
        if (bsearch(&own, sorted, boundary->face_count, sizeof *sorted, compare_faces) == NULL)
            memcpy(lost->faces + 3 * lost->face_count++, model->faces + 3 * (size_t)f,
                   3 * sizeof *lost->faces);
    }
    return STARG_OK;
}

starg_status united_report(starg_context *context, const starg_mesh *model,
                           const starg_solid *united, starg_decomposition *out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *boundary = NULL;
    SCOPED_BY(bvh_drop) bvh *tree = NULL, *model_tree = NULL;
    SCOPED uint32_t *lost_faces = NULL;
    starg_mesh lost = {0};
    double lower[3], upper[3];
    starg_mesh_bounds(model, lower, upper);
    double extent = vec3_distance(lower, upper);
    TRY(find_lost(context, model, united->mesh, &lost));
    lost_faces = lost.faces;
    out->faces_kept = model->face_count - lost.face_count;
    TRY(starg_tetmesh_surface(context, out->mesh, &boundary, NULL));
    TRY(bvh_create(context, boundary->vertices, boundary->faces, boundary->face_count, &tree));
    TRY(bvh_create(context, model->vertices, model->faces, model->face_count, &model_tree));
    out->tetra = (starg_tetra_report){0};
    TRY(deviation_bound(context, boundary, model_tree, extent, STEP * extent,
                        &out->tetra.distance));
    TRY(deviation_bound(context, model, tree, extent, STEP * extent, &out->tetra.distance_back));
    out->tetra.to_surface = out->tetra.distance;
    out->tetra.from_surface = out->tetra.distance_back;
    return STARG_OK;
}

/* ---- T-junctions ---- */

/* Errors that leave the lattice as a way out. */
static bool is_refusal(starg_status status) {
    return status == STARG_ERROR_MESH || status == STARG_ERROR_RANGE ||
           status == STARG_ERROR_SOLVER;
}

starg_status united_join(starg_context *context, const starg_mesh *surface, starg_solid **out,
                         bool *exact) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    starg_repair_report report;
    bool closed;
    *out = NULL;
    TRY(conform_closes(context, surface, 0, &closed));
    if (!closed)
        return STARG_OK;
    starg_status status = starg_mesh_repair(context, surface, NULL, &mesh, &report);
    if (status == STARG_OK && report.holes_filled > 0)
        return STARG_OK;
    if (status != STARG_OK)
        return is_refusal(status) ? STARG_OK : status;
    TRY(solid_make(context, mesh, out));
    *exact = report.conforming == 0;
    starg_log(context, STARG_LOG_NOTICE,
              "faces that touch without sharing edges (T-junctions) were joined: %zu of them "
              "divided, nothing moved farther than %.3g, no hole filled",
              report.faces_divided, report.conforming);
    return STARG_OK;
}

/* ---- details too small for pieces ---- */

starg_status united_merge(starg_context *context, const starg_mesh *surface, double distance,
                          starg_solid **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    starg_repair_options options;
    starg_repair_report report;
    *out = NULL;
    starg_repair_options_default(&options);
    options.merge_distance = distance;
    starg_status status = starg_mesh_repair(context, surface, &options, &mesh, &report);
    if (status != STARG_OK)
        return is_refusal(status) ? STARG_OK : status;
    return report.vertices_merged > 0 ? solid_make(context, mesh, out) : STARG_OK;
}

/* ---- the union ---- */

static starg_status make(starg_context *context, const starg_solid *solid, starg_solid **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    starg_repair_options options;
    starg_repair_report report;
    starg_repair_options_default(&options);
    options.unite = true;
    TRY(starg_mesh_repair(context, solid->mesh, &options, &mesh, &report));
    return solid_make(context, mesh, out);
}

starg_status united_make(starg_context *context, const starg_solid *solid, starg_solid **out) {
    const starg_finding *found = solid->check->findings;
    *out = NULL;
    if (found[STARG_FINDING_SELF_INTERSECTION].count == 0 &&
        found[STARG_FINDING_SELF_CONTACT].count == 0 &&
        found[STARG_FINDING_DEGENERATE_FACE].count == 0)
        return STARG_OK;
    starg_status status = make(context, solid, out);
    if (!is_refusal(status))
        return status;
    starg_log(context, STARG_LOG_NOTICE, "the surface cannot be cut where it intersects: %s",
              starg_context_error(context)->message);
    return STARG_OK;
}
