/* SPDX-License-Identifier: Apache-2.0 */
/* What the guards of a result see: visibility of each guard anew, in parallel (verify/sight.h).
 *
 * Invariant: each guard has its own row, so the order of threads does not matter. Cost: that of
 * verify/sight.h for each guard. */
#include "verify/facts.h"

#include <math.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "verify/sight.h"
#include "verify/surface.h"

static const char STAGE[] = "verify";

/* How many faces do two guards see that are the baseline apart? All pairs of guards of all faces.
 */

static bool is_paired(const verify_facts *known, size_t face, double cosine) {
    const double *t[3], *places = known->guards->positions;
    verify_corners(known->surface, face, t);
    for (size_t g = 0; g < known->guards->count; g++)
        for (size_t h = g + 1; starg_bits_test(known->faces, g, face) && h < known->guards->count;
             h++)
            if (starg_bits_test(known->faces, h, face) &&
                verify_apart(t, places + 3 * g, places + 3 * h, cosine))
                return true;
    return false;
}

size_t verify_count_paired(const verify_facts *known) {
    double cosine = starg_cone_cosine(2 * known->guards->options.baseline);
    size_t count = 0;
    for (size_t f = 0; f < known->surface->face_count; f++)
        count += is_paired(known, f, cosine);
    return count;
}

bool verify_space_is_narrow(const starg_space_options *o) {
    bool narrow = o->cell > 0 || o->standoff_least > 0 || o->standoff_most > 0 ||
                  o->over_count > 0 || o->mount_count > 0;
    for (int k = 0; k < 6; k++)
        narrow = narrow || o->within[k] != 0;
    return narrow;
}

verify_target verify_target_of(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    if (guards->options.visibility.target == STARG_TARGET_VERTICES)
        return (verify_target){"vertices", known->used_vertices, known->covered_vertices,
                               guards->coverable_vertices};
    return (verify_target){"faces", known->wanted_faces, known->covered_faces,
                           guards->coverable_faces};
}

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
verify_view verify_view_of(const starg_guards *guards, size_t guard) {
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
    const verify_view view = verify_view_of(known->guards, g);
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

starg_status verify_facts_find(starg_context *context, verify_facts *known) {
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

void verify_facts_free(starg_context *context, verify_facts *known) {
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
