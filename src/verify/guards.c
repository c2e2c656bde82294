/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a guards result. First recomputes visibility for each guard in parallel
 * (verify/sight.h), then compares the claims of the result with it, one by one. Claims that depend
 * on the candidates, which a result does not contain, can only be refuted by counterexamples: faces
 * that could be seen (verify/coverable.c), guards of the result that suffice (verify/needed.c),
 * redundancy (verify/redundancy.c). The rest is listed as not checked.
 *
 * Invariant: each guard has its own row, so the order of threads does not matter. Cost: see
 * verify/sight.h for each guard. */
#include <math.h>
#include <stdio.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "verify/claims.h"
#include "verify/everywhere.h"
#include "verify/measure.h"
#include "verify/sight.h"
#include "verify/signs.h"
#include "verify/space.h"

static const char STAGE[] = "verify";

static const double TOLERANCE = 1e-9; /* relative; for lengths, areas and fractions */

bool verify_space_is_narrow(const starg_space_options *o) {
    bool narrow = o->cell > 0 || o->standoff_least > 0 || o->standoff_most > 0 ||
                  o->over_count > 0 || o->mount_count > 0;
    for (int k = 0; k < 6; k++)
        narrow = narrow || o->within[k] != 0;
    return narrow;
}

/* ---- facts ---- */

static bool is_finite_point(const double p[3]) {
    return fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100;
}

static starg_status make_sight(starg_context *context, void *shared, void **scratch) {
    (void)context;
    const verify_facts *known = shared;
    verify_sight *sight;
    starg_status status = verify_sight_create(known->surface, &sight);
    *scratch = sight;
    return status;
}

static void free_sight(starg_context *context, void *scratch) {
    (void)context;
    verify_sight_free(scratch);
}

/* Stores the wanted ones; NULL: all. */
static void note_row(starg_bits *rows, size_t row, const uint8_t *seen, const uint8_t *wanted) {
    uint64_t *bits = starg_bits_row_mutable(rows, row);
    for (size_t j = 0; j < rows->columns; j++)
        if (seen[j] && (wanted == NULL || wanted[j]))
            starg_bit_set(bits, j);
}

verify_view verify_view_around(const starg_guards *guards) {
    const starg_visibility_options *o = &guards->options.visibility;
    return (verify_view){.range = o->range,
                         .near = o->near,
                         .rule = o->face_rule,
                         .steepest = starg_incidence_cosine(o->incidence)};
}

/* The view of a guard; a file without directions is wrong, which is told elsewhere. */
static verify_view view_of(const starg_guards *guards, size_t guard) {
    const starg_visibility_options *o = &guards->options.visibility;
    verify_view view = verify_view_around(guards);
    if (o->cone < 360 && guards->directions != NULL) {
        view.direction = guards->directions + 3 * guard;
        view.cosine = starg_cone_cosine(o->cone);
    }
    view.framed = o->fov[0] > 0 && guards->directions != NULL && guards->ups != NULL;
    if (view.framed)
        starg_frustum(guards->directions + 3 * guard, guards->ups + 3 * guard, o->fov, view.planes);
    return view;
}

/* Examines one guard. A guard that is not inside sees nothing. */
static starg_status examine_guard(starg_context *context, void *shared, void *scratch, size_t g) {
    (void)context;
    verify_facts *known = shared;
    const verify_surface *surface = known->surface;
    const starg_guard_options *options = &known->guards->options;
    const double *p = known->guards->positions + 3 * g;
    if (!is_finite_point(p))
        return STARG_OK;
    if (options->clearance > 0)
        known->distance[g] = verify_distance(surface, p, surface->face_count, known->scale);
    if (verify_space_is_narrow(&known->guards->space))
        known->standoff[g] = verify_distance(surface, p, surface->model_faces, known->scale);
    bool on_surface;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    known->inside[g] = !on_surface && winding + surface->ambient >= 1;
    if (!known->inside[g])
        return STARG_OK;

    const uint8_t *vertices, *faces;
    const verify_view view = view_of(known->guards, g);
    starg_status status = verify_look(scratch, p, &view, &vertices, &faces);
    if (status != STARG_OK)
        return status;
    note_row(known->faces, g, faces, known->wanted);
    if (known->vertices != NULL)
        note_row(known->vertices, g, vertices, known->used);
    return STARG_OK;
}

static void unite(const starg_bits *rows, uint8_t *all) {
    for (size_t g = 0; g < rows->rows; g++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, g)[w]) {
                all[64 * w + bit] = 1;
            }
}

starg_status verify_count_held(const verify_facts *known, uint32_t **held) {
    starg_status status = STARG_OK;
    const starg_bits *rows = verify_rows(known);
    STARG_NEW_ZERO(known->surface->context, STAGE, *held, rows->columns);
    for (size_t g = 0; g < rows->rows; g++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, g)[w]) {
                (*held)[64 * w + bit]++;
            }
done:
    return status;
}

static void sum_up(verify_facts *known) {
    const verify_surface *surface = known->surface;
    unite(known->faces, known->face);
    if (known->vertices != NULL)
        unite(known->vertices, known->vertex);
    for (size_t v = 0; v < surface->vertex_count; v++) {
        known->used_vertices += known->used[v];
        known->covered_vertices += known->vertex[v];
        known->vertex[v] = known->vertex[v] || !known->used[v];
    }
    for (size_t f = 0; f < surface->face_count; f++) {
        known->area[f] = verify_area(surface, f, known->scale);
        if (surface->importance != NULL)
            known->area[f] *= surface->importance[f];
        known->total_area += known->area[f];
        if (known->face[f]) {
            known->covered_faces++;
            known->covered_area += known->area[f];
        }
        known->face[f] = known->face[f] || !known->wanted[f];
    }
}

/* Marks the target faces and their vertices. */
static void mark_wanted(verify_facts *known) {
    const verify_surface *surface = known->surface;
    for (size_t f = 0; f < surface->face_count; f++) {
        known->wanted[f] = verify_is_target(surface, f);
        known->wanted_faces += known->wanted[f];
        for (size_t k = 0; known->wanted[f] && k < 3; k++)
            known->used[surface->faces[3 * f + k]] = 1;
    }
}

static starg_status find_facts(starg_context *context, verify_facts *known) {
    starg_status status = STARG_OK;
    size_t guards = known->guards->count;
    known->scale = verify_scale(known->surface);
    STARG_NEW_ZERO(context, STAGE, known->inside, guards);
    STARG_NEW_ZERO(context, STAGE, known->distance, guards);
    STARG_NEW_ZERO(context, STAGE, known->standoff, guards);
    STARG_TRY(starg_bits_create(context, guards, known->surface->face_count, &known->faces));
    if (verify_targets_vertices(known))
        STARG_TRY(
            starg_bits_create(context, guards, known->surface->vertex_count, &known->vertices));
    STARG_NEW_ZERO(context, STAGE, known->vertex, known->surface->vertex_count);
    STARG_NEW_ZERO(context, STAGE, known->used, known->surface->vertex_count);
    STARG_NEW_ZERO(context, STAGE, known->face, known->surface->face_count);
    STARG_NEW_ZERO(context, STAGE, known->wanted, known->surface->face_count);
    STARG_NEW(context, STAGE, known->area, known->surface->face_count);
    mark_wanted(known);
    STARG_TRY(verify_tree_create(known->surface, &known->tree));
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = guards,
                                      .shared = known,
                                      .item = examine_guard,
                                      .make_scratch = make_sight,
                                      .free_scratch = free_sight};
    STARG_TRY(starg_parallel_for(context, &loop));
    sum_up(known);
done:
    return status;
}

static void free_facts(starg_context *context, verify_facts *known) {
    starg_release(context, known->inside);
    starg_release(context, known->distance);
    starg_release(context, known->standoff);
    starg_bits_free(known->faces);
    starg_bits_free(known->vertices);
    starg_release(context, known->vertex);
    starg_release(context, known->used);
    starg_release(context, known->face);
    starg_release(context, known->wanted);
    starg_release(context, known->area);
    verify_tree_free(known->tree);
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

/* ---- claims about single guards ---- */

static void claim_inside(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    for (size_t g = guards->count; g-- > 0;)
        if (!known->inside[g]) {
            bad++;
            first = g;
        }
    if (bad == 0) {
        verify_claim(verdict, true, "all %zu guards are strictly inside", guards->count);
        return;
    }
    const double *p = guards->positions + 3 * first;
    verify_claim(verdict, false,
                 "all %zu guards are strictly inside: %zu are not, first guard %zu at "
                 "(%.17g, %.17g, %.17g)",
                 guards->count, bad, first, p[0], p[1], p[2]);
}

static void claim_clearance(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    double wanted = guards->options.clearance;
    size_t bad = 0, first = 0;
    if (!(wanted > 0))
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!(known->distance[g] >= wanted * (1 - TOLERANCE))) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "guards keep a clearance of %.17g", wanted);
    else
        verify_claim(verdict, false,
                     "guards keep a clearance of %.17g: %zu do not, first guard %zu at a distance "
                     "of %.17g",
                     wanted, bad, first, known->distance[first]);
}

static bool stands_within(const verify_facts *known, size_t g) {
    const starg_space_options *o = &known->guards->space;
    const double *p = known->guards->positions + 3 * g;
    double distance = known->standoff[g];
    bool in = distance >= o->standoff_least * (1 - TOLERANCE) &&
              (o->standoff_most == 0 || distance <= o->standoff_most * (1 + TOLERANCE));
    bool boxed = false;
    for (int k = 0; k < 6; k++)
        boxed = boxed || o->within[k] != 0;
    for (int k = 0; boxed && k < 3; k++)
        in = in && p[k] >= o->within[k] && p[k] <= o->within[k + 3];
    return in;
}

static void claim_standoff(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    if (!verify_space_is_narrow(&guards->space))
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!stands_within(known, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "guards keep their distances from the model, and to their box");
    else
        verify_claim(verdict, false,
                     "guards keep their distances from the model, and to their box: %zu do not, "
                     "first guard %zu at a distance of %.17g",
                     bad, first, known->standoff[first]);
}

/* Is the guard straight above a listed face, and near one? Lists are searched one by one. */
static bool stands_by_faces(const verify_facts *known, size_t g) {
    const starg_space_options *o = &known->guards->space;
    const double *p = known->guards->positions + 3 * g;
    double foot[3], up[3] = {0, 1, 0}, length = 0, least = INFINITY;
    bool over = o->over_count == 0;
    for (int k = 0; k < 3; k++)
        length = hypot(length, o->up[k]);
    for (int k = 0; k < 3; k++) {
        up[k] = length > 0 ? o->up[k] / length : up[k];
        foot[k] = p[k] - o->height * (1 + TOLERANCE) * up[k];
    }
    for (size_t i = 0; i < o->over_count && !over; i++) {
        const double *t[3];
        verify_corners(known->surface, o->over[i], t);
        over = verify_blocks(p, foot, t);
    }
    for (size_t i = 0; i < o->mount_count; i++)
        least = fmin(least, verify_squared_distance(known->surface, o->mount[i], p, known->scale));
    return over && (o->mount_count == 0 ||
                    ldexp(sqrt(least), -known->scale) <= o->mount_distance * (1 + TOLERANCE));
}

static starg_status claim_reached(starg_verdict *verdict, const verify_facts *known) {
    const double *from = known->guards->space.from;
    bool known_cubes;
    size_t bad, first;
    if (!(known->guards->space.cell > 0))
        return STARG_OK;
    starg_status status = verify_find_unreached(known, &known_cubes, &bad, &first);
    if (status != STARG_OK)
        return status;
    if (!known_cubes)
        verify_leave(verdict,
                     "that guards can be reached from (%.17g, %.17g, %.17g): the cubes are "
                     "too small",
                     from[0], from[1], from[2]);
    else if (bad == 0)
        verify_claim(verdict, true, "guards can be reached from (%.17g, %.17g, %.17g)", from[0],
                     from[1], from[2]);
    else
        verify_claim(
            verdict, false,
            "guards can be reached from (%.17g, %.17g, %.17g): %zu cannot, first guard %zu",
            from[0], from[1], from[2], bad, first);
    return STARG_OK;
}

static void claim_faces_near(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    if (guards->space.over_count == 0 && guards->space.mount_count == 0)
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!stands_by_faces(known, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true,
                     "guards stand over, or hang near, the faces that they are bound to");
    else
        verify_claim(verdict, false,
                     "guards stand over, or hang near, the faces that they are bound to: %zu do "
                     "not, first guard %zu",
                     bad, first);
}

static void claim_seen(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    for (size_t g = guards->count; g-- > 0;)
        if (guards->seen_faces[g] != starg_bits_count(known->faces, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "each guard sees as many faces as claimed");
    else
        verify_claim(verdict, false,
                     "each guard sees as many faces as claimed: %zu do not, first guard %zu, "
                     "claimed %zu, found %zu",
                     bad, first, guards->seen_faces[first], starg_bits_count(known->faces, first));
}

/* ---- claims about coverage ---- */

/* A list that should contain exactly the relevant unseen elements, ascending. */
typedef struct unseen_list {
    const char *name;
    const uint32_t *listed;
    size_t count, element_count;
    const uint8_t *seen;
    const uint8_t *relevant; /* NULL: all */
} unseen_list;

static bool must_be_listed(const unseen_list *list, size_t element) {
    return !list->seen[element] && (list->relevant == NULL || list->relevant[element]);
}

static void claim_unseen(starg_verdict *verdict, const unseen_list *list) {
    size_t missing = 0, extra = 0, next = 0, first_missing = 0, first_extra = 0;
    bool ascending = true;
    for (size_t i = 0; i < list->count; i++) {
        ascending = ascending && list->listed[i] < list->element_count &&
                    (i == 0 || list->listed[i - 1] < list->listed[i]);
    }
    if (!ascending) {
        verify_claim(verdict, false,
                     "%s that no guard sees: the list is not ascending, or names "
                     "one that does not exist",
                     list->name);
        return;
    }
    for (size_t element = 0; element < list->element_count; element++) {
        bool listed = next < list->count && list->listed[next] == element;
        bool expected = must_be_listed(list, element);
        next += listed;
        if (expected && !listed && missing++ == 0)
            first_missing = element;
        if (listed && !expected && extra++ == 0)
            first_extra = element;
    }
    char details[2][64] = {"", ""};
    if (missing != 0)
        snprintf(details[0], sizeof details[0], ": %zu more are not seen, first %zu", missing,
                 first_missing);
    if (extra != 0)
        snprintf(details[1], sizeof details[1], ": %zu of them are seen, first %zu", extra,
                 first_extra);
    verify_claim(verdict, missing == 0 && extra == 0, "%zu %s are seen by no guard%s%s",
                 list->count, list->name, details[0], details[1]);
}

static bool about_equal(double a, double b) {
    return fabs(a - b) <= TOLERANCE * fmax(fabs(a), fabs(b));
}

static void claim_fraction(starg_verdict *verdict, const char *name, double claimed, double found) {
    verify_claim(verdict, about_equal(claimed, found), "coverage by %s is %.17g (found: %.17g)",
                 name, claimed, found);
}

static double fraction(double part, double all) {
    return all > 0 ? part / all : 0;
}

static void claim_coverage(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const verify_surface *surface = known->surface;
    const unseen_list faces = {
        "faces", guards->uncovered, guards->uncovered_count, surface->model_faces, known->face,
        NULL};
    claim_unseen(verdict, &faces);
    claim_fraction(verdict, "faces", guards->coverage_faces,
                   fraction((double)known->covered_faces, (double)known->wanted_faces));
    claim_fraction(verdict, "area", guards->coverage_area,
                   fraction(known->covered_area, known->total_area));
    if (guards->options.visibility.target != STARG_TARGET_VERTICES)
        return;
    const unseen_list vertices = {"vertices",
                                  guards->uncovered_vertices,
                                  guards->uncovered_vertex_count,
                                  surface->model_vertices,
                                  known->vertex,
                                  known->used};
    claim_unseen(verdict, &vertices);
    claim_fraction(verdict, "vertices", guards->coverage_vertices,
                   fraction((double)known->covered_vertices, (double)known->used_vertices));
}

/* The curve is what the first 1, 2, ... guards see; older files have none. */
static starg_status claim_curve(starg_context *context, starg_verdict *verdict,
                                const verify_facts *known) {
    starg_status status = STARG_OK;
    const starg_guards *guards = known->guards;
    uint64_t *joined = NULL;
    size_t sum = 0, wrong = 0;
    double area = 0;
    if (guards->curve_faces == NULL || guards->curve_area == NULL) {
        verify_leave(verdict, "the curve of the first 1, 2, ... guards: the file has none");
        return STARG_OK;
    }
    STARG_NEW_ZERO(context, STAGE, joined, known->faces->words);
    for (size_t g = 0; g < guards->count; g++) {
        for (size_t w = 0; w < known->faces->words; w++) {
            uint64_t fresh = starg_bits_row(known->faces, g)[w] & ~joined[w];
            joined[w] |= fresh;
            STARG_FOR_BITS (bit, fresh) {
                sum++;
                area += known->area[64 * w + bit];
            }
        }
        wrong += !about_equal(guards->curve_faces[g],
                              fraction((double)sum, (double)known->wanted_faces)) ||
                 !about_equal(guards->curve_area[g], fraction(area, known->total_area));
    }
    verify_claim(verdict, wrong == 0, "the curve tells what the first guards see (wrong for %zu)",
                 wrong);
done:
    starg_release(context, joined);
    return status;
}

static void claim_levels(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    if (guards->level_count == 0 && guards->levels == NULL)
        return;
    const verify_levels found = verify_check_levels(known);
    verify_claim(
        verdict, found.grow && found.kept && found.named,
        "%zu levels grow up to the model%s, keep guards of the one before%s, and are those "
        "of the guards%s",
        guards->level_count, found.grow ? "" : " (no)", found.kept ? "" : " (no)",
        found.named ? "" : " (no)");
    if (guards->level_count == 0)
        return;
    verify_claim(verdict, found.inside, "the guards of levels are strictly inside of the model");
    verify_leave(verdict, "what guards see of coarser levels: their meshes are not in the file");
}

/* ---- claims about coverable elements ---- */

/* The target of the options. */
typedef struct target {
    const char *name;
    size_t all, covered, coverable;
} target;

static target target_of(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    if (guards->options.visibility.target == STARG_TARGET_VERTICES)
        return (target){"vertices", known->used_vertices, known->covered_vertices,
                        guards->coverable_vertices};
    return (target){"faces", known->wanted_faces, known->covered_faces, guards->coverable_faces};
}

/* The reason for not looking above the unseen faces; NULL: none. With a partial goal, the search
 * for candidates may end before the last faces; the goal is then relative to everything. */
static const char *reason_unchecked(const verify_facts *known) {
    const starg_guard_options *o = &known->guards->options;
    if (o->candidates == STARG_CANDIDATES_GIVEN)
        return "the candidates were given, and are not in the file";
    if (verify_space_is_narrow(&known->guards->space))
        return "guards may stand in a part of the free space only";
    if (known->guards->time_limited)
        return "a time limit cut the search for candidates short";
    double seen = verify_targets_vertices(known)
                      ? fraction((double)known->covered_vertices, (double)known->used_vertices)
                      : fraction(known->covered_area, known->total_area);
    if (o->coverage < 1 && o->redundancy < 2 && o->max_guards == 0 &&
        seen >= o->coverage * (1 - 1e-6))
        return "the part of all that was asked for is seen";
    return NULL;
}

static starg_status claim_coverable(starg_verdict *verdict, const verify_facts *known) {
    target goal = target_of(known);
    verify_claim(verdict, goal.covered <= goal.coverable && goal.coverable <= goal.all,
                 "%zu of %zu %s can be seen (at least those %zu that are)", goal.coverable,
                 goal.all, goal.name, goal.covered);
    if (goal.coverable < goal.covered || goal.coverable >= goal.all)
        return STARG_OK;
    const char *excuse = reason_unchecked(known);
    if (excuse != NULL) {
        verify_leave(verdict, "that the other %zu %s cannot be seen: %s", goal.all - goal.coverable,
                     goal.name, excuse);
        return STARG_OK;
    }
    verify_coverable found;
    size_t rest = goal.coverable - goal.covered;
    starg_status status = verify_find_coverable(known, rest, &found);
    if (status != STARG_OK)
        return status;
    if (found.proven > rest)
        verify_claim(verdict, false,
                     "%zu of %zu %s can be seen: more can, %zu of those that no guard sees, first "
                     "%zu from (%.17g, %.17g, %.17g)",
                     goal.coverable, goal.all, goal.name, found.proven, found.first, found.place[0],
                     found.place[1], found.place[2]);
    else
        verify_leave(verdict,
                     "that the other %zu %s cannot be seen: no point just above them was found "
                     "that does",
                     goal.all - goal.coverable, goal.name);
    return STARG_OK;
}

static starg_status claim_redundancy(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    verify_lack found;
    starg_status status = verify_find_lack(known, &found);
    if (status != STARG_OK || found.lacking == 0)
        return status;
    const char *name = target_of(known).name;
    bool anywhere = !verify_space_is_narrow(&guards->space);
    if (anywhere && 4 * found.meeting >= 3 * found.points && 2 * found.points > VERIFY_PLACES)
        verify_claim(verdict, false,
                     "what fewer than %u guards see, %zu %s, no other of %zu candidates sees: "
                     "%zu of %zu points drawn inside see some",
                     guards->options.redundancy, found.lacking, name, guards->candidate_count,
                     found.meeting, found.points);
    else
        verify_leave(verdict,
                     "that no other candidate sees the %zu %s that fewer than %u guards see",
                     found.lacking, name, guards->options.redundancy);
    return STARG_OK;
}

static void claim_baseline(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    if (!(guards->options.baseline > 0))
        return;
    size_t found = verify_count_paired(known);
    verify_claim(verdict, guards->baseline_faces == found,
                 "two guards that are %g degrees apart see %zu faces (found: %zu)",
                 guards->options.baseline, guards->baseline_faces, found);
    if (found < known->wanted_faces)
        verify_leave(verdict, "that no two candidates so far apart see the other %zu faces",
                     known->wanted_faces - found);
}

/* The least area that a number of faces that no guard sees can have: that number times the area of
 * the smallest of them. */
static double least_unseen_area(const verify_facts *known, size_t count) {
    double smallest = INFINITY;
    for (size_t f = 0; f < known->surface->face_count; f++)
        if (!known->face[f])
            smallest = fmin(smallest, known->area[f]);
    return count != 0 && smallest < INFINITY ? (double)count * smallest : 0;
}

/* Guards without a limit on their number reach the requested coverage. Which unseen faces are
 * coverable is unknown; the smallest possible area is compared with the claim. */
static void claim_goal(starg_verdict *verdict, const verify_facts *known) {
    const starg_guard_options *options = &known->guards->options;
    target goal = target_of(known);
    if (options->max_guards != 0 || goal.coverable < goal.covered)
        return;
    double reached, wanted;
    size_t rest = goal.coverable - goal.covered;
    if (options->coverage >= 1 || options->visibility.target == STARG_TARGET_VERTICES) {
        reached = (double)goal.covered;
        wanted = options->coverage * (double)goal.coverable;
    } else {
        reached = known->covered_area;
        wanted = options->coverage * (known->covered_area + least_unseen_area(known, rest));
    }
    verify_claim(verdict, reached >= wanted * (1 - TOLERANCE),
                 "guards see a fraction of at least %.17g of what can be seen (%zu of %zu %s)",
                 options->coverage, goal.covered, goal.coverable, goal.name);
}

/* ---- claims about the number of guards ---- */

/* A sufficient subset of the guards, which are candidates, refutes a larger lower bound. Not in
 * files of morph --guards, where `count` is the number of guards: those must suffice in another
 * shape, too. */
static starg_status claim_bound(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *certificate) {
    const starg_guards *guards = known->guards;
    size_t needed = guards->count;
    bool pairs = guards->options.candidates == STARG_CANDIDATES_GIVEN &&
                 guards->options.candidate_count == guards->count;
    starg_status status = pairs ? STARG_OK : verify_find_needed(known, &needed);
    if (status != STARG_OK)
        return status;
    if (needed < guards->lower_bound && guards->lower_bound <= guards->count)
        verify_claim(verdict, false,
                     "the lower bound %zu is at most the number of guards that would do: %zu of "
                     "the %zu guards do what was asked for",
                     guards->lower_bound, needed, guards->count);
    else
        verify_claim(verdict, guards->lower_bound <= guards->count,
                     "the lower bound %zu is at most the number of guards %zu", guards->lower_bound,
                     guards->count);
    bool follows = certificate != NULL && guards->lower_bound <= certificate->bound;
    if (guards->lower_bound > 0 && !follows)
        verify_leave(
            verdict, "that no fewer than %zu%s candidates would do%s", guards->lower_bound,
            guards->optimal ? " (\"optimal\")" : "",
            pairs ? ", nor fewer of the guards: in results of morph they stand for two shapes"
                  : "");
    return STARG_OK;
}

static starg_status claim_numbers(starg_verdict *verdict, const verify_facts *known,
                                  const starg_certificate *certificate) {
    starg_status status = STARG_OK;
    const starg_guards *guards = known->guards;
    target goal = target_of(known);
    /* with fewer guards than required per face, none may suffice */
    bool too_few =
        guards->options.max_guards != 0 && guards->options.max_guards < guards->options.redundancy;
    verify_claim(verdict, guards->count > 0 || goal.coverable == 0 || too_few,
                 "there are guards (%zu), unless nothing can be seen", guards->count);
    verify_claim(verdict, guards->count <= guards->candidate_count,
                 "%zu guards are among %zu candidates", guards->count, guards->candidate_count);
    if (guards->options.max_guards != 0)
        verify_claim(verdict, guards->count <= guards->options.max_guards,
                     "%zu guards are at most %zu", guards->count, guards->options.max_guards);
    verify_leave(verdict, "that there were %zu candidates: they are not in the file",
                 guards->candidate_count);
    STARG_TRY(claim_bound(verdict, known, certificate));
    bool equal = guards->lower_bound == guards->count;
    verify_claim(verdict, guards->optimal == equal,
                 "the result is called %s, with %zu guards and a lower bound of %zu",
                 guards->optimal ? "optimal" : "not proven optimal", guards->count,
                 guards->lower_bound);
    if (guards->lower_bound_everywhere > 0)
        verify_claim(
            verdict,
            guards->lower_bound_everywhere <= guards->lower_bound &&
                guards->optimal_everywhere == (guards->lower_bound_everywhere == guards->count),
            "the lower bound for guards anywhere, %zu, is at most that for candidates, and "
            "the result is called %s",
            guards->lower_bound_everywhere,
            guards->optimal_everywhere ? "the fewest possible" : "not proven such");
    if (certificate != NULL)
        STARG_TRY(verify_claim_everywhere(verdict, known, certificate));
    else if (guards->lower_bound_everywhere > 0)
        verify_leave(verdict,
                     "that at least %zu guards are needed, wherever they stand: the certificate "
                     "would say why",
                     guards->lower_bound_everywhere);
    double seen = fraction(known->covered_area, known->total_area);
    verify_claim(verdict, seen <= guards->area_bound * (1 + TOLERANCE),
                 "the area seen, %.17g, is within its bound %.17g", seen, guards->area_bound);
    if (guards->area_bound < 1)
        verify_leave(verdict, "that so many candidates see at most a fraction of %.17g of the area",
                     guards->area_bound);
    if (guards->area_bound_everywhere > 0) {
        verify_claim(verdict, seen <= guards->area_bound_everywhere * (1 + TOLERANCE),
                     "the area seen, %.17g, is within the bound for guards anywhere, %.17g", seen,
                     guards->area_bound_everywhere);
        verify_leave(verdict,
                     "that so many guards see at most a fraction of %.17g of the area, wherever "
                     "they stand",
                     guards->area_bound_everywhere);
    }
done:
    return status;
}

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
    STARG_TRY(find_facts(context, &known));

    STARG_TRY(verify_verdict_create(context, &verdict));
    claim_model(verdict, &known);
    claim_options(verdict, guards);
    claim_inside(verdict, &known);
    claim_clearance(verdict, &known);
    claim_standoff(verdict, &known);
    claim_faces_near(verdict, &known);
    STARG_TRY(claim_reached(verdict, &known));
    claim_seen(verdict, &known);
    claim_coverage(verdict, &known);
    STARG_TRY(claim_curve(context, verdict, &known));
    claim_levels(verdict, &known);
    STARG_TRY(claim_coverable(verdict, &known));
    claim_goal(verdict, &known);
    STARG_TRY(claim_redundancy(verdict, &known));
    claim_baseline(verdict, &known);
    STARG_TRY(claim_numbers(verdict, &known, evidence->certificate));
    *out = verdict;
    verdict = NULL;
done:
    starg_time_end(context, former);
    starg_verdict_free(context, verdict);
    free_facts(context, &known);
    verify_surface_free(surface);
    return status;
}
