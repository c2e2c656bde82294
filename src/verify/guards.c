/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a guards result: computes anew what each guard sees (verify/facts.h), then
 * compares the claims of the result with it, one by one. What can neither be shown nor refuted is
 * listed as not checked. */
#include "core/memory.h"
#include "verify/claims.h"
#include "verify/facts.h"
#include "verify/space.h"

/* ---- claims about the input ---- */

static void claim_model(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const verify_surface *surface = known->surface;
    verify_claim(verdict,
                 guards->vertex_count == surface->model_vertices &&
                     guards->face_count == surface->model_faces,
                 "the model has %zu vertices and %zu faces (the mesh: %zu and %zu)",
                 guards->vertex_count, guards->face_count, surface->model_vertices,
                 surface->model_faces);
}

/* Is every guard told where to look, if it looks in one direction? */
static bool are_aimed(const starg_guards *guards) {
    const starg_visibility_options *o = &guards->options.visibility;
    bool framed = o->fov[0] > 0 || o->fov[1] > 0, good = true;
    if (framed && (!(o->fov[0] > 0 && o->fov[1] > 0 && o->fov[0] < 180 && o->fov[1] < 180) ||
                   o->cone < 360 || guards->ups == NULL))
        return false;
    if (o->cone == 360 && !framed)
        return true;
    for (size_t i = 0; guards->directions != NULL && i < guards->count; i++) {
        const double *d = guards->directions + 3 * i;
        good = good && (d[0] != 0 || d[1] != 0 || d[2] != 0);
    }
    return good && guards->directions != NULL;
}

static void claim_options(starg_verdict *verdict, const starg_guards *guards) {
    const starg_guard_options *options = &guards->options;
    const starg_visibility_options *view = &options->visibility;
    verify_claim(verdict,
                 view->range >= 0 && view->near >= 0 && view->near < view->range &&
                     view->incidence >= 0 && view->incidence <= 90 && options->coverage > 0 &&
                     options->coverage <= 1 && options->clearance >= 0 && view->cone > 0 &&
                     view->cone <= 360 && are_aimed(guards),
                 "the options make sense: range %g, cone %g, coverage %g, clearance %g",
                 view->range, view->cone, options->coverage, options->clearance);
}

/* ---- all claims ---- */

static bool is_plain(const starg_guards *guards) {
    return guards->obstacle_count == 0 && guards->target_count == 0 && !guards->space.outside &&
           !guards->space.soup && guards->space.orientation == STARG_ORIENTATION_NESTED;
}

starg_status starg_verify_guards(starg_context *context, const starg_mesh *mesh,
                                 const starg_guards *guards, starg_verdict **out) {
    return starg_verify_guards_with(context, mesh, &(starg_guards_evidence){0}, guards, out);
}

starg_status starg_verify_guards_with(starg_context *context, const starg_mesh *mesh,
                                      const starg_guards_evidence *evidence,
                                      const starg_guards *guards, starg_verdict **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    starg_verdict *verdict = NULL;
    verify_facts known = {.guards = guards};
    *out = NULL;
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    STARG_TRY(is_plain(guards) && evidence->obstacle_count == 0
                  ? verify_surface_create(context, mesh, &surface)
                  : verify_space_create(context, mesh, evidence->obstacles,
                                        evidence->obstacle_count, guards, &surface));
    known.surface = surface;
    STARG_TRY(verify_facts_find(context, &known));

    STARG_TRY(verify_verdict_create(context, &verdict));
    claim_model(verdict, &known);
    claim_options(verdict, guards);
    STARG_TRY(verify_claim_places(verdict, &known));
    STARG_TRY(verify_claim_coverage(verdict, &known));
    STARG_TRY(verify_claim_count(verdict, &known, evidence->certificate));
    *out = verdict;
    verdict = NULL;
done:
    starg_time_end(context, former);
    starg_verdict_free(context, verdict);
    verify_facts_free(context, &known);
    verify_surface_free(surface);
    return status;
}
