/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a star decomposition: facts are found one after the other, and every claim is
 * compared with them. Nothing is shared with what makes decompositions.
 *
 * What the claims prove together, for a model whose surface is embedded:
 *  1. Tetrahedra are positive, and a triangle is shared by two at most, on opposite sides. So a
 *     point off all triangles lies in as many tetrahedra as the outer boundary winds around it.
 *  2. The outer boundary is the model's surface, covered once (verify/boundary.c). So the number is
 *     one inside the model and zero outside: the tetrahedra fill it and do not overlap, and each
 *     belongs to one piece by its label.
 *  3. The walls of each piece are closed (verify/facets.c), its guard is strictly on the inner side
 *     of all of them, and they wind around it once (verify/claim_stars.c): the piece is star-shaped
 *     about its guard, which lies in the interior of its kernel.
 * Signs are exact. "On the model's surface" is within a billionth of the diagonal, so overlap is
 * ruled out but for a skin that thin. Edges that hang on the faces of others leave triangles alone
 * that then show up in the outer boundary, off the model.
 *
 * Cost: O(n) for all that concerns tetrahedra, O(n log n) for the boundary. */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";

/* ---- the input ---- */

/* Files have been checked while they were read; arrays of a caller have not. */
static starg_status check_tetrahedra(starg_context *context, const starg_pieces_mesh *mesh) {
    if (mesh->count == 0 || mesh->count > VERIFY_TETRAHEDRA)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu tetrahedra are none, or more than 2^29", mesh->count);
    for (size_t i = 0; i < 4 * mesh->count; i++)
        if (mesh->tetrahedra[i] >= mesh->vertex_count) {
            const uint64_t t = i / 4;
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                                 &t, 1, "tetrahedron %zu names vertex %u of %zu", i / 4,
                                 mesh->tetrahedra[i], mesh->vertex_count);
        }
    return STARG_OK;
}

static starg_status check_point(starg_context *context, starg_element element, size_t index,
                                const double p[3]) {
    const uint64_t i = index;
    if (fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100)
        return STARG_OK;
    return starg_fail_at(context, STARG_ERROR_RANGE, STAGE, element, &i, 1,
                         "%s %zu is not finite, or not below 1e100 in magnitude",
                         element == STARG_ELEMENT_GUARD ? "guard" : "vertex", index);
}

starg_status verify_check_arrays(starg_context *context, const starg_pieces_mesh *mesh,
                                 const starg_pieces_report *report) {
    TRY(check_tetrahedra(context, mesh));
    for (size_t v = 0; v < mesh->vertex_count; v++)
        TRY(check_point(context, STARG_ELEMENT_VERTEX, v, mesh->vertices + 3 * v));
    for (size_t p = 0; report != NULL && p < report->piece_count; p++)
        TRY(check_point(context, STARG_ELEMENT_GUARD, p, report->pieces[p].guard));
    return STARG_OK;
}

/* ---- all of it ---- */

/* `given` has the model, and what is to be compared with it. */
static starg_status verify_against(const verify_context *given, starg_verdict **out) {
    SCOPED_BY(verify_pieces_drop) verify_pieces *pieces = NULL;
    SCOPED_BY(starg_verdict_drop) starg_verdict *verdict = NULL;
    verify_context own = *given;
    starg_context *context = own.context;
    const starg_pieces_report *report = own.report;
    TRY(verify_check_arrays(context, own.mesh, report));
    TRY(verify_pieces_create(context, own.mesh, report, &pieces));
    TRY(verify_verdict_create(context, &verdict));
    own.pieces = pieces;
    own.verdict = verdict;
    TRY(verify_claim_tetrahedra(&own));
    TRY(verify_claim_boundary(&own));
    if (report != NULL) {
        TRY(verify_claim_numbers(&own));
        TRY(verify_claim_angles(&own));
        TRY(verify_claim_stars(&own));
        TRY(verify_claim_fewest(&own));
        TRY(verify_claim_balls(&own));
    } else {
        verify_leave(verdict, "guards, star-shapedness and numbers: there is no report");
    }
    *out = verdict;
    verdict = NULL;
    return STARG_OK;
}

/* The model as it is: where the boundary is only near it, it need not be closed. */
static starg_status wrap_model(starg_context *context, const starg_mesh *mesh,
                               verify_surface **out) {
    uint32_t *faces = NULL;
    size_t count = starg_mesh_face_count(mesh);
    if (count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the model has no faces");
    NEW(context, STAGE, faces, 3 * count);
    memcpy(faces, starg_mesh_faces(mesh), 3 * count * sizeof *faces);
    return verify_surface_wrap(context, starg_mesh_vertices(mesh), starg_mesh_vertex_count(mesh),
                               faces, count, out);
}

starg_status starg_verify_pieces_with(starg_context *context, const starg_mesh *model,
                                      const starg_certificate *certificate,
                                      const starg_pieces_mesh *pieces,
                                      const starg_pieces_report *report, starg_verdict **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *closed = NULL, *surface = NULL;
    verify_context own = {
        .context = context, .mesh = pieces, .report = report, .certificate = certificate};
    bool approximated = report != NULL && report->approximated;
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    starg_status status = verify_surface_create(context, model, &closed);
    if (status != STARG_ERROR_MESH || !approximated)
        TRY(status);
    if (approximated)
        TRY(wrap_model(context, model, &surface));
    own.model = approximated ? surface : closed;
    own.solid = closed;
    return verify_against(&own, out);
}

starg_status starg_verify_pieces(starg_context *context, const starg_mesh *model,
                                 const starg_pieces_mesh *pieces, const starg_pieces_report *report,
                                 starg_verdict **out) {
    return starg_verify_pieces_with(context, model, NULL, pieces, report, out);
}

/* The boundary of the model's tetrahedra. */
static starg_status wrap_boundary(starg_context *context, const starg_tetmesh *model,
                                  verify_surface **out) {
    SCOPED_BY(verify_facets_drop) verify_facets *facets = NULL;
    SCOPED uint32_t *outer = NULL;
    uint32_t *faces = NULL;
    size_t count;
    TRY(verify_facets_create(context, starg_tetmesh_tetrahedra(model), starg_tetmesh_count(model),
                             &facets));
    TRY(verify_facets_outer(facets, &outer, &faces, &count));
    return verify_surface_wrap(context, starg_tetmesh_vertices(model),
                               starg_tetmesh_vertex_count(model), faces, count, out);
}

starg_status starg_verify_pieces_of_tetmesh(starg_context *context, const starg_tetmesh *model,
                                            const starg_pieces_mesh *pieces,
                                            const starg_pieces_report *report,
                                            starg_verdict **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    verify_context own = {.context = context,
                          .mesh = pieces,
                          .report = report,
                          .model_tetrahedra = starg_tetmesh_count(model)};
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(wrap_boundary(context, model, &surface));
    own.model = own.solid = surface;
    return verify_against(&own, out);
}
