/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a guards result: computes anew what each guard sees (verify/facts.h), then
 * compares the claims of the result with it, one by one. What can neither be shown nor refuted is
 * listed as not checked. */
#include "verify/everywhere.h"

/* Claims about the number of guards, and bounds for it. A bound for candidates, which the result
 * does not have, can only be refuted: by guards of the result that suffice (verify/needed.c). */

/* A sufficient subset of the guards, which are candidates, refutes a larger lower bound. Not in
 * files of morph --guards, where `count` is the number of guards: those must suffice in another
 * shape, too. */
static starg_status claim_bound(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *certificate) {
    const starg_guards *guards = known->guards;
    size_t stay = verify_count_kept(guards), count = guards->count - stay, needed = guards->count;
    bool pairs = guards->options.candidates == STARG_CANDIDATES_GIVEN &&
                 guards->options.candidate_count == guards->count;
    /* guards that miss points may all see what the bound is about */
    bool open = verify_targets_points(known) && known->covered_faces < known->wanted_faces;
    TRY(pairs || open ? STARG_OK : verify_find_needed(known, &needed));
    needed -= stay;
    if (needed < guards->lower_bound && guards->lower_bound <= count)
        verify_claim(verdict, false,
                     "the lower bound %zu is at most the number of guards that would do: %zu of "
                     "the %zu guards do what was asked for",
                     guards->lower_bound, needed, count);
    else
        verify_claim(verdict, guards->lower_bound <= count,
                     "the lower bound %zu is at most the number of guards %zu", guards->lower_bound,
                     count);
    bool follows = certificate != NULL && guards->lower_bound <= certificate->bound;
    if (guards->lower_bound > 0 && !follows)
        verify_leave(
            verdict, "that no fewer than %zu%s candidates would do%s", guards->lower_bound,
            guards->optimal ? " (\"optimal\")" : "",
            pairs ? ", nor fewer of the guards: in results of morph they stand for two shapes"
                  : "");
    return STARG_OK;
}

static starg_status verify_claim_count(starg_verdict *verdict, const verify_facts *known,
                                       const starg_certificate *certificate) {
    const starg_guards *guards = known->guards;
    verify_target goal = verify_target_of(known);
    /* with fewer guards than required per face, none may suffice */
    bool too_few =
        guards->options.max_guards != 0 && guards->options.max_guards < guards->options.redundancy;
    verify_claim(verdict, guards->count > 0 || goal.coverable == 0 || too_few,
                 "there are guards (%zu), unless nothing can be seen", guards->count);
    size_t count = guards->count - verify_count_kept(guards); /* those that were sought */
    verify_claim(verdict, count <= guards->candidate_count, "%zu guards are among %zu candidates",
                 count, guards->candidate_count);
    if (guards->options.max_guards != 0)
        verify_claim(verdict, count <= guards->options.max_guards, "%zu guards are at most %zu",
                     count, guards->options.max_guards);
    verify_leave(verdict, "that there were %zu candidates: they are not in the file",
                 guards->candidate_count);
    TRY(claim_bound(verdict, known, certificate));
    bool equal = guards->lower_bound == count;
    verify_claim(verdict, guards->optimal == equal,
                 "the result is called %s, with %zu guards and a lower bound of %zu",
                 guards->optimal ? "optimal" : "not proven optimal", count, guards->lower_bound);
    if (guards->lower_bound_everywhere > 0)
        verify_claim(
            verdict,
            guards->lower_bound_everywhere <= guards->lower_bound &&
                guards->optimal_everywhere == (guards->lower_bound_everywhere == count),
            "the lower bound for guards anywhere, %zu, is at most that for candidates, and "
            "the result is called %s",
            guards->lower_bound_everywhere,
            guards->optimal_everywhere ? "the fewest possible" : "not proven such");
    if (certificate != NULL)
        TRY(verify_claim_everywhere(verdict, known, certificate));
    else if (guards->lower_bound_everywhere > 0)
        verify_leave_asked(
            verdict,
            "that at least %zu guards are needed, wherever they stand: the certificate "
            "would say why",
            guards->lower_bound_everywhere);
    double seen = verify_fraction(known->covered_area, known->total_area);
    verify_claim(verdict, seen <= guards->area_bound * (1 + VERIFY_TOLERANCE),
                 "the area seen, %.9g, is within its bound %.9g", seen, guards->area_bound);
    if (guards->area_bound < 1)
        verify_leave(verdict, "that so many candidates see at most a fraction of %.9g of the area",
                     guards->area_bound);
    if (guards->area_bound_everywhere > 0) {
        verify_claim(verdict, seen <= guards->area_bound_everywhere * (1 + VERIFY_TOLERANCE),
                     "the area seen, %.9g, is within the bound for guards anywhere, %.9g", seen,
                     guards->area_bound_everywhere);
        verify_leave_asked(
            verdict,
            "that so many guards see at most a fraction of %.9g of the area, wherever "
            "they stand",
            guards->area_bound_everywhere);
    }
    return STARG_OK;
}

/* Checks levels of detail for consistency with one another, the model and the guards. Their meshes
 * are not in the file, so what their guards see of them cannot be checked. Their guards are
 * candidates of the model, and so inside it. A guard belongs to the first level that chose it, as
 * long as all later ones choose it; refinement and baselines may add guards of the last level. */

static bool is_among(const double p[3], const starg_guard_level *level) {
    for (size_t i = 0; i < level->count; i++) {
        const double *q = level->positions + 3 * i;
        if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
            return true;
    }
    return false;
}

static bool is_inside(const verify_facts *known, const double p[3]) {
    bool on_surface;
    for (int k = 0; k < 3; k++)
        if (known->surface->ambient == 0 &&
            !(p[k] >= known->surface->lower[k] && p[k] <= known->surface->upper[k]))
            return false;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    return !on_surface && winding + known->surface->ambient >= 1;
}

/* Is the guard listed in its level and in the finer ones? */
static bool is_named(const starg_guards *guards, size_t guard) {
    int level = guards->levels[guard];
    if (level < 0 || (size_t)level >= guards->level_count)
        return false;
    bool may_add = guards->options.refine || guards->options.baseline > 0;
    bool last = (size_t)level + 1 == guards->level_count;
    for (size_t i = (size_t)level; i < guards->level_count && !(last && may_add); i++)
        if (!is_among(guards->positions + 3 * guard, &guards->level_list[i]))
            return false;
    return true;
}

static bool are_kept(const starg_guard_level *level, const starg_guard_level *before) {
    if (level->kept > level->count || level->kept > (before == NULL ? 0 : before->count))
        return false;
    for (size_t i = 0; i < level->kept; i++)
        if (!is_among(level->positions + 3 * i, before))
            return false;
    return true;
}

verify_levels verify_check_levels(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    verify_levels all = {true, true, true, true};
    for (size_t i = 0; i < guards->level_count; i++) {
        const starg_guard_level *level = &guards->level_list[i];
        const starg_guard_level *before = i > 0 ? level - 1 : NULL;
        all.grow = all.grow && (before == NULL || before->vertex_count < level->vertex_count);
        all.kept = all.kept && are_kept(level, before);
        for (size_t j = 0; j < level->count; j++)
            all.inside = all.inside && is_inside(known, level->positions + 3 * j);
    }
    if (guards->level_count > 0) {
        const starg_guard_level *last = &guards->level_list[guards->level_count - 1];
        all.grow = all.grow && last->vertex_count == guards->vertex_count &&
                   last->face_count == guards->face_count;
    }
    for (size_t g = 0; g < guards->count && guards->levels != NULL; g++)
        all.named = all.named && (guards->level_count > 0 && !verify_is_kept(guards, g)
                                      ? is_named(guards, g)
                                      : guards->levels[g] == 0);
    return all;
}

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
    return guards->obstacle_count == 0 && guards->target_count == 0 &&
           guards->space.clear_count == 0 && !guards->space.outside && !guards->space.soup &&
           guards->space.orientation == STARG_ORIENTATION_NESTED;
}

starg_status starg_verify_guards(starg_context *context, const starg_mesh *mesh,
                                 const starg_guards *guards, starg_verdict **out) {
    return starg_verify_guards_with(context, mesh, &(starg_guards_evidence){0}, guards, out);
}

starg_status starg_verify_guards_with(starg_context *context, const starg_mesh *mesh,
                                      const starg_guards_evidence *evidence,
                                      const starg_guards *guards, starg_verdict **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    SCOPED_BY(starg_verdict_drop) starg_verdict *verdict = NULL;
    SCOPED_BY(verify_zones_drop) verify_zones *zones = NULL;
    SCOPED_BY(verify_facts_free) verify_facts known = {.guards = guards};
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(is_plain(guards) && evidence->obstacle_count == 0
            ? verify_surface_create(context, mesh, &surface)
            : verify_space_create(context, mesh, evidence->obstacles, evidence->obstacle_count,
                                  guards, &surface));
    TRY(verify_zones_create(context, guards, evidence->zones, &zones));
    known.zones = zones;
    TRY(verify_facts_find(surface, &known));

    TRY(verify_verdict_create(context, &verdict));
    claim_model(verdict, &known);
    claim_options(verdict, guards);
    TRY(verify_claim_places(verdict, &known));
    verify_claim_tour(verdict, &known);
    TRY(verify_claim_coverage(verdict, &known));
    TRY(verify_claim_count(verdict, &known, evidence->certificate));
    TRY(verify_claim_tables(verdict, &known, evidence));
    *out = verdict;
    verdict = NULL;
    return STARG_OK;
}
