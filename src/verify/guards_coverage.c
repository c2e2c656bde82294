/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about what all guards see together, and about what could be seen. The result does not have
 * the candidates: that no other sees a face, or sees it often enough, is refuted by counterexamples
 * only (verify/coverable.c, verify/redundancy.c). */
#include <math.h>
#include <stdio.h>

#include "verify/facts.h"

static const char STAGE[] = "verify";

/* ---- what is seen ---- */

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
    return fabs(a - b) <= VERIFY_TOLERANCE * fmax(fabs(a), fabs(b));
}

static void claim_fraction(starg_verdict *verdict, const char *name, double claimed, double found) {
    verify_claim(verdict, about_equal(claimed, found), "coverage by %s is %.9g (found: %.9g)", name,
                 claimed, found);
}

/* Of a face, the share of the area that guards see. */
static double seen_share(const verify_facts *known, size_t face) {
    const verify_surface *surface = known->surface;
    double share = 0;
    for (size_t j = verify_first_patch(surface, face); j < verify_first_patch(surface, face + 1);
         j++)
        share += known->patch[j] ? verify_patch_share(surface, j) : 0;
    return share;
}

/* Faces that are seen in part are listed with the share. */
static void claim_partial(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t next = 0, wrong = 0, first = 0;
    if (known->surface->patches == NULL)
        return;
    for (size_t f = 0; f < known->surface->model_faces; f++) {
        bool listed = next < guards->partial_count && guards->partial[next] == f;
        double share = known->face[f] ? 0 : seen_share(known, f);
        bool right =
            listed ? about_equal(guards->partial_share[next], share) && share > 0 : share == 0;
        next += listed;
        if (!right && wrong++ == 0)
            first = f;
    }
    verify_claim_all(verdict, wrong, first,
                     "%zu faces are seen in part, and as much of each as told",
                     guards->partial_count);
    verify_claim(verdict, next == guards->partial_count,
                 "faces that are seen in part are listed once, ascending");
}

/* What is proven of every point. What is not proven to be seen is open. */
static void claim_points(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    bool complete = known->covered_faces == known->wanted_faces;
    double seen = complete ? 1 : verify_fraction(known->covered_area, known->total_area);
    if (!verify_targets_points(known))
        return;
    verify_claim(verdict,
                 fabs(guards->points_seen - seen) <= VERIFY_TOLERANCE &&
                     fabs(guards->points_open - (1 - seen)) <= VERIFY_TOLERANCE,
                 "every point of %.9g of the area is seen, and %.9g is open (found: %.9g and %.9g)",
                 guards->points_seen, guards->points_open, seen, 1 - seen);
    verify_claim(verdict, guards->points_complete == complete, "points are seen %s",
                 guards->points_complete ? "completely" : "in part");
}

static void claim_coverage(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const verify_surface *surface = known->surface;
    const unseen_list faces = {
        "faces", guards->uncovered, guards->uncovered_count, surface->model_faces, known->face,
        NULL};
    claim_unseen(verdict, &faces);
    claim_partial(verdict, known);
    claim_points(verdict, known);
    claim_fraction(verdict, "faces", guards->coverage_faces,
                   verify_fraction((double)known->covered_faces, (double)known->wanted_faces));
    claim_fraction(verdict, "area", guards->coverage_area,
                   verify_fraction(known->covered_area, known->total_area));
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
                   verify_fraction((double)known->covered_vertices, (double)known->used_vertices));
}

/* The curve is what the first 1, 2, ... guards see; older files have none. */
static starg_status claim_curve(starg_verdict *verdict, const verify_facts *known) {
    starg_context *context = known->surface->context;
    const starg_guards *guards = known->guards;
    SCOPED uint64_t *joined = NULL;
    size_t wrong = 0;
    double area = 0;
    if (guards->curve_faces == NULL || guards->curve_area == NULL) {
        verify_leave(verdict, "the curve of the first 1, 2, ... guards: the file has none");
        return STARG_OK;
    }
    NEW_ZERO(context, STAGE, joined, known->patches->words);
    for (size_t g = 0; g < guards->count; g++) {
        for (size_t w = 0; w < known->patches->words; w++) {
            uint64_t fresh = starg_bits_row(known->patches, g)[w] & ~joined[w];
            joined[w] |= fresh;
            STARG_FOR_BITS (bit, fresh) {
                area += known->area[64 * w + bit];
            }
        }
        size_t faces = verify_count_faces(known, joined);
        wrong += !about_equal(guards->curve_faces[g],
                              verify_fraction((double)faces, (double)known->wanted_faces)) ||
                 !about_equal(guards->curve_area[g], verify_fraction(area, known->total_area));
    }
    verify_claim(verdict, wrong == 0, "the curve tells what the first guards see (wrong for %zu)",
                 wrong);
    return STARG_OK;
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

/* ---- what could be seen ---- */

/* The reason for not looking above the unseen faces; NULL: none. With a partial goal, the search
 * for candidates may end before the last faces; the goal is then relative to everything. */
static const char *reason_unchecked(const verify_facts *known) {
    const starg_guard_options *o = &known->guards->options;
    if (o->candidates == STARG_CANDIDATES_GIVEN)
        return "the candidates were given, and are not in the file";
    if (verify_space_is_narrow(&known->guards->space) || known->zones != NULL)
        return "guards may stand in a part of the free space only";
    if (known->guards->time_limited)
        return "a time limit cut the search for candidates short";
    double seen =
        verify_targets_vertices(known)
            ? verify_fraction((double)known->covered_vertices, (double)known->used_vertices)
            : verify_fraction(known->covered_area, known->total_area);
    if (o->coverage < 1 && o->redundancy < 2 && o->max_guards == 0 &&
        seen >= o->coverage * (1 - 1e-6))
        return "the part of all that was asked for is seen";
    return NULL;
}

static starg_status claim_coverable(starg_verdict *verdict, const verify_facts *known) {
    verify_target goal = verify_target_of(known);
    verify_claim(verdict, goal.covered <= goal.coverable && goal.coverable <= goal.all,
                 "%zu of %zu %s can be seen (at least those %zu that are)", goal.coverable,
                 goal.all, goal.name, goal.covered);
    if (verify_targets_vertices(known))
        verify_claim(verdict,
                     known->covered_faces <= known->guards->coverable_faces &&
                         known->guards->coverable_faces <= known->wanted_faces,
                     "%zu of %zu faces can be seen (at least those %zu that are)",
                     known->guards->coverable_faces, known->wanted_faces, known->covered_faces);
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
    TRY(verify_find_coverable(known, rest, &found));
    if (found.proven > rest)
        verify_claim(verdict, false,
                     "%zu of %zu %s can be seen: more can, %zu of those that no guard sees, first "
                     "%zu from (%.9g, %.9g, %.9g)",
                     goal.coverable, goal.all, goal.name, found.proven, found.first, found.place[0],
                     found.place[1], found.place[2]);
    else
        verify_leave(verdict,
                     "that the other %zu %s cannot be seen: no point just above them was found "
                     "that does",
                     goal.all - goal.coverable, goal.name);
    return STARG_OK;
}

/* How many faces at least 1, 2, ... guards see; files before 0.2 do not tell. */
static starg_status claim_often(starg_verdict *verdict, const verify_facts *known) {
    starg_context *context = known->surface->context;
    const starg_guards *guards = known->guards;
    bool told = guards->redundant_count > 0;
    bool same = !told || guards->redundant_count == guards->options.redundancy;
    SCOPED size_t *often = NULL;
    size_t most = guards->count + 1;
    if (told || guards->options.redundancy < most)
        most = told ? guards->redundant_count : guards->options.redundancy;
    char list[96] = "";
    NEW(context, STAGE, often, most);
    TRY(verify_count_often(known, most, often));
    for (size_t k = 0, length = 0; k < most; k++) {
        same = same && (!told || guards->redundant_faces[k] == often[k]);
        if (length < sizeof list)
            length += (size_t)snprintf(list + length, sizeof list - length, "%s%zu",
                                       k > 0 ? ", " : "", often[k]);
    }
    verify_claim(verdict, same, "at least 1, 2, ... %zu guards see as many faces as told: %s%s",
                 most, list, told ? "" : " (the file does not tell)");
    return STARG_OK;
}

static starg_status claim_redundancy(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    verify_lack found = {0};
    starg_status status = guards->options.redundancy > 1 ? claim_often(verdict, known) : STARG_OK;
    if (status == STARG_OK)
        status = verify_find_lack(known, &found);
    if (status != STARG_OK || found.lacking == 0)
        return status;
    const char *name =
        known->surface->patches != NULL ? "parts of faces" : verify_target_of(known).name;
    if (found.shown != VERIFY_NO_COLUMN)
        verify_claim(verdict, false,
                     "what fewer than %u guards see, %zu %s, no other place would see: number %zu "
                     "is seen from many places beside a guard, one is (%.6g, %.6g, %.6g)",
                     guards->options.redundancy, found.lacking, name, found.shown, found.place[0],
                     found.place[1], found.place[2]);
    else
        verify_leave_asked(verdict,
                           "that no other candidate sees the %zu %s that fewer than %u guards see",
                           found.lacking, name, guards->options.redundancy);
    return STARG_OK;
}

static starg_status claim_needs(starg_verdict *verdict, const verify_facts *known) {
    size_t met;
    if (known->guards->need_count == 0)
        return STARG_OK;
    starg_status status = verify_count_met(known, &met);
    if (status == STARG_OK)
        verify_claim(verdict, known->guards->met_needs == met,
                     "%zu of %zu faces are seen as they need (found: %zu)",
                     known->guards->met_needs, known->guards->need_count, met);
    return status;
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
 * the smallest of their patches. */
static double least_unseen_area(const verify_facts *known, size_t count) {
    double smallest = INFINITY;
    for (size_t j = 0; j < verify_patch_count(known->surface); j++)
        if (!known->patch[j])
            smallest = fmin(smallest, known->area[j]);
    return count != 0 && smallest < INFINITY ? (double)count * smallest : 0;
}

/* Guards without a limit on their number reach the requested coverage. Which unseen faces are
 * coverable is unknown; the smallest possible area is compared with the claim. */
static void claim_goal(starg_verdict *verdict, const verify_facts *known) {
    const starg_guard_options *options = &known->guards->options;
    verify_target goal = verify_target_of(known);
    bool open = verify_targets_points(known) && !known->guards->points_complete;
    if (options->max_guards != 0 || goal.coverable < goal.covered || open)
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
    verify_claim(verdict, reached >= wanted * (1 - VERIFY_TOLERANCE),
                 "guards see a fraction of at least %.9g of what can be seen (%zu of %zu %s)",
                 options->coverage, goal.covered, goal.coverable, goal.name);
}

starg_status verify_claim_coverage(starg_verdict *verdict, const verify_facts *known) {
    claim_coverage(verdict, known);
    TRY(claim_curve(verdict, known));
    claim_levels(verdict, known);
    TRY(claim_coverable(verdict, known));
    claim_goal(verdict, known);
    TRY(claim_redundancy(verdict, known));
    TRY(claim_needs(verdict, known));
    claim_baseline(verdict, known);
    return STARG_OK;
}
